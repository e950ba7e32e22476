//! Words where a reader wants a keyword: known, known in another case, or unknown and passed over.
//! Never lives here: what a keyword means, and names.

use crate::formats::error::FileFault;
use crate::formats::text::lexer::{Lexer, Token};
use crate::rig::Warnings;
use crate::spelling::nearest;

/// All that may stand in one place of a file, braces aside.
#[derive(Debug, Clone, Copy)]
pub(super) struct Keywords(pub &'static [&'static str]);

impl Keywords {
    /// The next word. In place of a keyword in another case stands the keyword, with a warning.
    pub(super) fn next<'a>(self, lexer: &mut Lexer<'a>, warnings: &mut Warnings) -> Token<'a> {
        let word = lexer.next();
        let Some(keyword) = self.find(word.text).filter(|known| *known != word.text) else {
            return word;
        };
        warnings.push(|| {
            let (place, found) = (lexer.place(word), word.described());
            format!("{place}: {found} is taken for `{keyword}`")
        });
        Token {
            text: keyword,
            ..word
        }
    }

    /// The keyword that a word is in any case.
    pub(super) fn find(self, word: &str) -> Option<&'static str> {
        let mut known = self.0.iter().copied();
        known.find(|keyword| keyword.eq_ignore_ascii_case(word))
    }

    /// Goes on, with a warning, to the next known keyword or brace; a block that stands before one is skipped whole.
    /// `word` is the unknown one, which has been taken. Returns the keyword that it may have been meant for.
    pub(super) fn skip_unknown(
        self,
        lexer: &mut Lexer,
        word: Token,
        warnings: &mut Warnings,
    ) -> Result<Option<&'static str>, FileFault> {
        let near = nearest(word.text, self.0.iter().copied());
        warnings.push(|| {
            let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            format!(
                "{}: skipped {}, which is not known here{hint}",
                lexer.place(word),
                word.described()
            )
        });
        if word.text == "{" {
            skip_block(lexer, word)?;
            return Ok(near);
        }
        loop {
            let token = lexer.peek();
            match token.text {
                "" | "}" => return Ok(near),
                "{" => {
                    lexer.next();
                    skip_block(lexer, token)?;
                    return Ok(near);
                }
                text if self.find(text).is_some() => return Ok(near),
                _ => lexer.next(),
            };
        }
    }
}

fn skip_block(lexer: &mut Lexer, open: Token) -> Result<(), FileFault> {
    let mut depth = 1_usize;
    while depth > 0 {
        let token = lexer.next();
        match token.text {
            "{" => depth += 1,
            "}" => depth -= 1,
            "" => {
                let (line, column) = lexer.line_column(open);
                return Err(lexer.fault(token, format!("`}}` for the `{{` at {line}:{column}")));
            }
            _ => {}
        }
    }
    Ok(())
}

/// What stands where a keyword may have been meant, the first such word for each: if the keyword is missed, its place tells more than the
/// end of the file.
#[derive(Debug, Default)]
pub(super) struct PassedOver<'a>(Vec<(&'static str, Token<'a>)>);

impl<'a> PassedOver<'a> {
    pub(super) fn note(&mut self, keyword: Option<&'static str>, word: Token<'a>) {
        if let Some(keyword) = keyword
            && self.of(keyword).is_none()
        {
            self.0.push((keyword, word));
        }
    }

    pub(super) fn of(&self, keyword: &str) -> Option<Token<'a>> {
        let mut all = self.0.iter();
        all.find(|(meant, _)| *meant == keyword)
            .map(|(_, word)| *word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSE: Keywords = Keywords(&["pose"]);

    #[test]
    fn unknown_words_are_skipped_to_a_keyword_or_past_a_block() {
        for (text, left) in [
            ("pos 0 0 1.57 pose 1", "pose"),
            ("pos 0 0 POSE 1", "POSE"),
            ("pos 0 0 }", "}"),
            ("pos 1 2", ""),
            ("cone a { { pose } { } } next", "next"),
            ("{ pose } next", "next"),
        ] {
            let mut lexer = Lexer::new("a", text);
            let mut warnings = Warnings::default();
            let word = lexer.next();
            let skipped = POSE.skip_unknown(&mut lexer, word, &mut warnings);
            assert_eq!((skipped.is_ok(), lexer.next().text), (true, left), "{text}");
            assert_eq!(warnings.into_sentences().len(), 1);
        }
    }

    #[test]
    fn an_unknown_block_without_an_end_is_a_fault() {
        let mut lexer = Lexer::new("a", "x\n { {} ");
        let word = lexer.next();
        let fault = POSE.skip_unknown(&mut lexer, word, &mut Warnings::default());
        let message = fault
            .map_err(|fault| fault.to_string())
            .err()
            .unwrap_or_default();
        assert_eq!(
            message,
            "a:2:7: expected `}` for the `{` at 2:2, but found the end of the file"
        );
    }
}
