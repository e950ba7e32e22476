//! Words of an OBJ file and its material libraries, line by line, without comments and with continued lines joined.
//! Never lives here: what any statement means.

use crate::formats::text::lexer::{Lexer, Token};

/// Walks over the words of statements. `#` at the start of a word comments out the rest of its line; `\` at the end of a line
/// joins the next one to it.
#[derive(Debug)]
pub(super) struct Statements<'a> {
    pub lexer: Lexer<'a>,
    /// The first value that a comment is glued to.
    pub glued: Option<Token<'a>>,
}

impl<'a> Statements<'a> {
    pub(super) fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            lexer: Lexer::new(file, text),
            glued: None,
        }
    }

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

    /// [`Statements::next_word`] where a number or a corner is due: neither has a `#` in it, so that a comment starts there.
    pub(super) fn next_value(&mut self) -> Token<'a> {
        let word = self.next_word();
        match word.text.find('#').filter(|_| !is_not_a_number(word)) {
            Some(end) => {
                self.glued.get_or_insert(word);
                self.lexer = self.lexer.from(word.offset + end);
                Token {
                    text: &word.text[..end],
                    ..word
                }
            }
            None => word,
        }
    }

    /// What is left of the line as one name, which may have spaces in it; `None` where nothing is.
    pub(super) fn rest(&mut self) -> Option<Token<'a>> {
        let first = self.next_word();
        if first.ends_line() {
            return None;
        }
        let mut end = first.offset + first.text.len();
        loop {
            let word = self.next_word();
            if word.ends_line() {
                let text = self.lexer.slice(first.offset..end);
                return Some(Token { text, ..first });
            }
            end = word.offset + word.text.len();
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

/// Whether a word is what programs print for a number that is none, or for one without bound: `nan`, `-inf`, `1.#IND`.
pub(super) fn is_not_a_number(word: Token) -> bool {
    let unsigned = word.text.trim_start_matches(['-', '+']);
    let starts = |with: &str| {
        let start = unsigned.get(..with.len());
        start.is_some_and(|start| start.eq_ignore_ascii_case(with))
    };
    ["nan", "inf", "1.#"].into_iter().any(starts)
}
