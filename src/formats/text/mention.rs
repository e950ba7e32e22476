//! What a file names elsewhere, and where it does so first. Never lives here: finding it.

use super::lexer::{Lexer, Token};
use std::collections::HashMap;

/// A name, and where it stands for the first time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::formats) struct Mention {
    pub name: String,
    /// `file:line:column`.
    pub place: String,
}

/// Each name once, by first mention.
#[derive(Debug, Default)]
pub(in crate::formats) struct Mentions {
    all: Vec<Mention>,
    numbers: HashMap<String, usize>,
}

impl Mention {
    pub(crate) fn new(name: Token, lexer: &Lexer) -> Self {
        Self {
            name: name.text.to_owned(),
            place: lexer.place(name),
        }
    }
}

impl Mentions {
    /// Returns its number among them.
    pub(crate) fn add(&mut self, name: Token, lexer: &Lexer) -> usize {
        if let Some(&number) = self.numbers.get(name.text) {
            return number;
        }
        let number = self.all.len();
        self.numbers.insert(name.text.to_owned(), number);
        self.all.push(Mention::new(name, lexer));
        number
    }

    pub(crate) fn into_inner(self) -> Vec<Mention> {
        self.all
    }
}
