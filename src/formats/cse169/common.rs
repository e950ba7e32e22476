//! What all files of the course have: names before braces, keywords that stand once, an end. Never lives here: keywords.

use crate::formats::error::FileFault;
use crate::formats::text::lexer::{Lexer, Token};
use crate::rig::Warnings;

/// A name of `what`, up to an opening brace, which is taken too. Exporters leave names empty, so `{` may come at once.
pub(super) fn name_and_brace<'a>(lexer: &mut Lexer<'a>, what: Token) -> Result<&'a str, FileFault> {
    /// A name stands in each DOF's name again and in replies; the longest real one has 30 bytes.
    const NAME_BYTES: usize = 256;
    if lexer.take("{") {
        return Ok("");
    }
    let name = lexer.next_name();
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

/// The fault of a keyword that stands a second time where it may stand once.
pub(super) fn second(lexer: &Lexer, keyword: Token) -> FileFault {
    let expected = format!("`{}` once", keyword.text);
    lexer.fault_found(keyword, expected, "a second one")
}

/// A warning where the file goes on after all that it is read for.
pub(super) fn warn_of_rest(lexer: &Lexer, after: &str, warnings: &mut Warnings) {
    let word = lexer.peek();
    if !word.is_end() {
        warnings.push(|| format!("{}: what follows {after} is not used", lexer.place(word)));
    }
}
