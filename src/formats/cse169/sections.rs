//! A heading with a count, then that many rows: the form that all sections of a `.skin` have, and others.
//! Never lives here: what the rows mean.

use crate::formats::error::{FileFault, LoadError};
use crate::formats::text::lexer::{Lexer, Token, parse_number};
use crate::limits::LimitExceeded;

/// Keyword, count and, as a rule, an opening brace.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section<'a> {
    pub count: usize,
    pub count_token: Token<'a>,
    /// Where the rows start.
    rows_at: usize,
    /// What its rows are called, of one and of many.
    nouns: (&'static str, &'static str),
    braced: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Brace {
    Needed,
    /// The course's own text leaves it out in places, its files do not.
    Optional,
}

impl<'a> Section<'a> {
    /// Reads what follows `keyword`. `check_limit` holds the count against its ceiling.
    pub(super) fn open(
        lexer: &mut Lexer<'a>,
        keyword: Token<'a>,
        nouns: (&'static str, &'static str),
        brace: Brace,
        check_limit: impl Fn(u64) -> Result<(), LimitExceeded>,
    ) -> Result<Self, LoadError> {
        let (count, count_token) = lexer.whole(|| format!("after `{}`", keyword.text))?;
        check_limit(count)?;
        let braced = lexer.take("{");
        if !braced && brace == Brace::Needed {
            let place = || format!("after `{} {}`", keyword.text, count_token.text);
            lexer.expect("{", place)?;
        }
        Ok(Self {
            // Where a count does not fit, neither does a file with so many rows.
            count: usize::try_from(count).unwrap_or(usize::MAX),
            count_token,
            rows_at: lexer.offset(),
            nouns,
            braced,
        })
    }

    /// Where a number of a row is wanted.
    pub(super) fn in_row(&self, row: usize) -> String {
        format!("in {} {row}", self.nouns.0)
    }

    /// The word that stands `index` words after the heading, found by reading once more: no place is kept for words that are right.
    pub(super) fn word(&self, lexer: &Lexer<'a>, index: usize) -> Token<'a> {
        let mut lexer = lexer.from(self.rows_at);
        for _ in 0..index {
            lexer.next();
        }
        lexer.next()
    }

    /// Reads as many rows as were announced and the brace after them. A row takes `row_bytes` of text at the least.
    pub(super) fn read_rows<T>(
        &self,
        lexer: &mut Lexer<'a>,
        row_bytes: usize,
        mut read_row: impl FnMut(&mut Lexer<'a>, usize) -> Result<T, LoadError>,
    ) -> Result<Vec<T>, LoadError> {
        // Memory follows what the file holds, not what it claims.
        let most = lexer.remaining_bytes() / row_bytes + 1;
        let mut rows = Vec::with_capacity(self.count.min(most));
        for row in 0..self.count {
            let start = lexer.offset();
            match read_row(lexer, row) {
                Ok(read) => rows.push(read),
                Err(LoadError::Invalid(fault)) => {
                    return Err(self.too_few(lexer, start, row).unwrap_or(fault).into());
                }
                Err(error) => return Err(error),
            }
        }
        let end = lexer.peek();
        if end.text == "}" {
            lexer.next();
        } else if self.braced || parse_number(end.text).is_some() {
            return Err(self.too_many(lexer, read_row).into());
        }
        Ok(rows)
    }

    fn announced(&self) -> String {
        let (one, many) = self.nouns;
        let noun = if self.count == 1 { one } else { many };
        format!("{} {noun} as announced", self.count)
    }

    /// The fault to tell where the row at `start` failed because there are no more rows.
    fn too_few(&self, lexer: &Lexer<'a>, start: usize, complete: usize) -> Option<FileFault> {
        let mut ahead = lexer.from(start);
        let mut token = ahead.next();
        while !matches!(token.text, "" | "{" | "}") && ahead.offset() < lexer.offset() {
            token = ahead.next();
        }
        if !matches!(token.text, "" | "}") {
            return None;
        }
        let found = if token.is_end() {
            "the end of the file"
        } else {
            "`}`"
        };
        let expected = self.announced();
        Some(lexer.fault_found(token, expected, format!("{found} after {complete}")))
    }

    fn too_many<T>(
        &self,
        lexer: &Lexer<'a>,
        mut read_row: impl FnMut(&mut Lexer<'a>, usize) -> Result<T, LoadError>,
    ) -> FileFault {
        let token = lexer.peek();
        let expected = format!("`}}` after {}", self.announced());
        let fault = lexer.fault(token, expected);
        let mut ahead = lexer.clone();
        let mut total = self.count;
        while read_row(&mut ahead, total).is_ok() {
            total += 1;
        }
        if total == self.count {
            return fault;
        }
        let found = format!("{}: {total} {} in all", fault.found, self.nouns.1);
        FileFault { found, ..fault }
    }
}
