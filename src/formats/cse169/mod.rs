//! The file family of the UCSD course CSE 169: one reader per extension, the grammar in its module doc.
//! Never lives here: other dialects that use the same extensions.

mod sections;
pub(super) mod skel;
pub(super) mod skin;
#[cfg(test)]
mod tests;

use super::error::FileFault;
use super::lexer::{Lexer, Token};

/// A name of `what`, up to an opening brace, which is taken too. Exporters leave names empty, so `{` may come at once.
fn name_and_brace<'a>(lexer: &mut Lexer<'a>, what: Token) -> Result<&'a str, FileFault> {
    /// A name stands in each DOF's name again and in replies; the longest real one has 30 bytes.
    const NAME_BYTES: usize = 256;
    if lexer.take("{") {
        return Ok("");
    }
    let name = lexer.next();
    if name.is_end() || name.text == "}" {
        return Err(lexer.fault(name, format!("a name or `{{` after `{}`", what.text)));
    }
    if name.text.len() > NAME_BYTES {
        let expected = format!("a name of at most {NAME_BYTES} bytes after `{}`", what.text);
        let found = format!("one of {} bytes", name.text.len());
        return Err(lexer.fault_found(name, expected, found));
    }
    lexer.expect("{", || format!("after `{} {}`", what.text, name.text))?;
    Ok(name.text)
}
