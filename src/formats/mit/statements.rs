//! Words of an OBJ file, line by line, without its comments and with its continued lines joined.
//! Never lives here: what any statement means.

use crate::formats::lexer::{Lexer, Token};

/// Walks over the words of statements. `#` at the start of a word comments out the rest of its line; `\` at the end of a line
/// joins the next one to it.
#[derive(Debug)]
pub(super) struct Statements<'a> {
    pub lexer: Lexer<'a>,
}

impl<'a> Statements<'a> {
    /// The next statement's first word, or the end of the file. What is left of the statement before must have been taken.
    pub(super) fn next(&mut self) -> Token<'a> {
        loop {
            let word = self.next_word();
            if word.is_end() || !word.ends_line() {
                return word;
            }
        }
    }

    /// The next word of the statement, or the end of its line.
    pub(super) fn next_word(&mut self) -> Token<'a> {
        loop {
            let word = self.lexer.next_in_line();
            if word.text.starts_with('#') {
                return self.line_end();
            }
            let Some(text) = word.text.strip_suffix('\\') else {
                return word;
            };
            let mut ahead = self.lexer.clone();
            if !ahead.next_in_line().ends_line() {
                return word;
            }
            self.lexer = ahead;
            if !text.is_empty() {
                return Token { text, ..word };
            }
        }
    }

    pub(super) fn skip_rest(&mut self) {
        while !self.next_word().ends_line() {}
    }

    /// The end of this very line: comments are not continued.
    fn line_end(&mut self) -> Token<'a> {
        loop {
            let word = self.lexer.next_in_line();
            if word.ends_line() {
                return word;
            }
        }
    }
}
