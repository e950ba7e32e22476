//! Words of a text with their line and column: what separates them, what a number is, how a fault at one is reported.
//! Never lives here: any word's meaning.

use super::Position;
use crate::formats::error::{FileFault, quoted};
use crate::rig::LARGEST_COORDINATE;
use std::cell::Cell;
use std::ops::Range;

/// A word, a brace, the end of a line where lines are asked for, or the empty text at the end of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::formats) struct Token<'a> {
    pub text: &'a str,
    /// In bytes. Line and column are counted only for a message.
    pub offset: usize,
}

impl Token<'_> {
    pub(in crate::formats) fn is_end(self) -> bool {
        self.text.is_empty()
    }

    /// Whether the line, or the file with it, ends here: only [`Lexer::next_in_line`] tells of lines.
    pub(in crate::formats) fn ends_line(self) -> bool {
        self.is_end() || self.text.starts_with(LINE_ENDS)
    }

    pub(in crate::formats) fn described(self) -> String {
        if self.is_end() {
            "the end of the file".to_owned()
        } else if self.ends_line() {
            "the end of the line".to_owned()
        } else {
            quoted(self.text)
        }
    }
}

const LINE_ENDS: [char; 2] = ['\n', '\r'];

/// Walks over a text. Every byte up to the space separates words, so that no kind of line end is special; braces are words of
/// their own also where they are glued to one.
#[derive(Debug, Clone)]
pub(in crate::formats) struct Lexer<'a> {
    file: &'a str,
    text: &'a str,
    at: usize,
    /// Up to where lines were counted last: warnings come in the order of the text, so counting goes on from there.
    counted: Cell<Position>,
}

impl<'a> Lexer<'a> {
    /// `file` is what faults call the text.
    pub(in crate::formats) fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            text,
            at: 0,
            counted: Cell::new(Position::START),
        }
    }

    pub(in crate::formats) fn offset(&self) -> usize {
        self.at
    }

    pub(in crate::formats) fn remaining_bytes(&self) -> usize {
        self.text.len() - self.at
    }

    /// The same text from `offset` on, where a word starts or a separator stands.
    pub(in crate::formats) fn from(&self, offset: usize) -> Self {
        Self {
            at: offset,
            ..self.clone()
        }
    }

    /// What stands between two words of the text, with their own bytes.
    pub(in crate::formats) fn slice(&self, range: Range<usize>) -> &'a str {
        &self.text[range]
    }

    #[allow(
        clippy::should_implement_trait,
        reason = "the end is a token with a place, not a None"
    )]
    pub(in crate::formats) fn next(&mut self) -> Token<'a> {
        let bytes = self.text.as_bytes();
        let mut start = self.at;
        while start < bytes.len() && bytes[start] <= b' ' {
            start += 1;
        }
        let mut end = start;
        while end < bytes.len() && !ends_word(bytes[end]) {
            end += 1;
        }
        if end == start && end < bytes.len() {
            end += 1; // A brace.
        }
        self.at = end;
        Token {
            text: &self.text[start..end],
            offset: start,
        }
    }

    /// [`Lexer::next`] where lines count: the end of the line is a token of its own, whichever kind it is of, and what comes after
    /// it belongs to the next line.
    pub(in crate::formats) fn next_in_line(&mut self) -> Token<'a> {
        let rest = &self.text.as_bytes()[self.at..];
        let is_blank = |byte: &&u8| **byte <= b' ' && !matches!(byte, b'\r' | b'\n');
        let start = self.at + rest.iter().take_while(is_blank).count();
        let end = match self.text.as_bytes()[start..] {
            [b'\r', b'\n', ..] => start + 2,
            [b'\r' | b'\n', ..] => start + 1,
            _ => return self.next(),
        };
        self.at = end;
        Token {
            text: &self.text[start..end],
            offset: start,
        }
    }

    /// [`Lexer::next`] where a name is wanted: one in double quotes may hold anything but a line end. The quotes are no part of it.
    pub(in crate::formats) fn next_name(&mut self) -> Token<'a> {
        let word = self.next();
        self.unquoted(word)
    }

    /// The whole of a name whose first word has been taken.
    pub(in crate::formats) fn unquoted(&mut self, word: Token<'a>) -> Token<'a> {
        match quotation_end(self.text.as_bytes(), word.offset) {
            // A token without text would be the end of the file.
            Some(end) if end > word.offset + 2 => {
                self.at = end;
                Token {
                    text: &self.text[word.offset + 1..end - 1],
                    ..word
                }
            }
            _ => word,
        }
    }

    pub(in crate::formats) fn peek(&self) -> Token<'a> {
        self.clone().next()
    }

    /// Takes the next word where it is `wanted`.
    pub(in crate::formats) fn take(&mut self, wanted: &str) -> bool {
        let mut ahead = self.clone();
        let found = ahead.next().text == wanted;
        if found {
            self.at = ahead.at;
        }
        found
    }

    /// A number no larger than a rig takes: `.5`, `+1` and exponents are fine. `place` says where one is wanted: `after …`.
    pub(in crate::formats) fn number(
        &mut self,
        place: impl Fn() -> String,
    ) -> Result<f64, FileFault> {
        let token = self.next();
        self.number_at(token, place)
    }

    /// What [`Lexer::number`] makes of a word that has been taken.
    pub(in crate::formats) fn number_at(
        &self,
        token: Token,
        place: impl Fn() -> String,
    ) -> Result<f64, FileFault> {
        let Some(number) = parse_number(token.text) else {
            return Err(self.fault(token, format!("a number {}", place())));
        };
        // Told here, where it stands; a rig would only know that there is one.
        if number.abs() > LARGEST_COORDINATE {
            return Err(self.fault(
                token,
                format!("a number of at most 1e9 in size {}", place()),
            ));
        }
        Ok(number)
    }

    pub(in crate::formats) fn numbers<const N: usize>(
        &mut self,
        place: impl Fn() -> String,
    ) -> Result<[f64; N], FileFault> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.number(&place)?;
        }
        Ok(numbers)
    }

    /// A whole number from 0. One beyond 64 bits is `u64::MAX`: over every ceiling and every count as well.
    pub(in crate::formats) fn whole(
        &mut self,
        place: impl Fn() -> String,
    ) -> Result<(u64, Token<'a>), FileFault> {
        let token = self.next();
        match parse_whole(token.text) {
            Some(whole) => Ok((whole, token)),
            None => Err(self.fault(token, format!("a whole number from 0 {}", place()))),
        }
    }

    pub(in crate::formats) fn expect(
        &mut self,
        wanted: &str,
        place: impl Fn() -> String,
    ) -> Result<Token<'a>, FileFault> {
        let token = self.next();
        if token.text == wanted {
            return Ok(token);
        }
        Err(self.fault(token, format!("`{wanted}` {}", place())))
    }

    pub(in crate::formats) fn fault(&self, token: Token, expected: impl Into<String>) -> FileFault {
        self.fault_found(token, expected, token.described())
    }

    pub(in crate::formats) fn fault_found(
        &self,
        token: Token,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> FileFault {
        let (line, column) = self.line_column(token);
        FileFault {
            line,
            column,
            ..FileFault::whole(self.file, expected, found)
        }
    }

    /// `file:line:column` of a token.
    pub(in crate::formats) fn place(&self, token: Token) -> String {
        let (line, column) = self.line_column(token);
        format!("{}:{line}:{column}", self.file)
    }

    pub(in crate::formats) fn line_column(&self, token: Token) -> (usize, usize) {
        let from = Some(self.counted.get()).filter(|counted| counted.offset() <= token.offset);
        let from = from.unwrap_or(Position::START);
        let position = from.advanced(self.text, token.offset);
        self.counted.set(position);
        position.line_column(self.text)
    }
}

pub(in crate::formats) fn ends_word(byte: u8) -> bool {
    byte <= b' ' || byte == b'{' || byte == b'}'
}

/// Behind the closing one of two double quotes, the first of which stands at `at`: it has to follow in the same line.
pub(in crate::formats) fn quotation_end(text: &[u8], at: usize) -> Option<usize> {
    let inside = text[at..].strip_prefix(b"\"")?;
    let length = inside.iter().position(|byte| b"\"\r\n".contains(byte))?;
    (inside[length] == b'"').then_some(at + length + 2)
}

pub(in crate::formats) fn parse_number(word: &str) -> Option<f64> {
    let unsigned = word.strip_prefix(['-', '+']).unwrap_or(word);
    // The standard parser also reads `inf`, `infinity` and `nan`.
    if !unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    word.parse().ok()
}

fn parse_whole(word: &str) -> Option<u64> {
    let digits = word.strip_prefix('+').unwrap_or(word);
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    Some(digits.parse().unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<&str> {
        let mut lexer = Lexer::new("a", text);
        std::iter::from_fn(|| Some(lexer.next().text).filter(|word| !word.is_empty())).collect()
    }

    #[test]
    fn separators_and_braces_end_words() {
        for (text, wanted) in [
            ("", vec![]),
            (" \t\r\n\x0b\x0c\x1a", vec![]),
            ("a b\tc\rd\r\re\r\n", vec!["a", "b", "c", "d", "e"]),
            ("leg{}}{x", vec!["leg", "{", "}", "}", "{", "x"]),
            ("größe.L{", vec!["größe.L", "{"]),
        ] {
            assert_eq!(words(text), wanted, "{text:?}");
        }
    }

    #[test]
    fn the_end_comes_again_and_again() {
        let mut lexer = Lexer::new("a", "x ");
        lexer.next();
        assert!(lexer.next().is_end() && lexer.next().is_end());
    }

    #[test]
    fn every_kind_of_line_end_is_a_token_where_lines_are_asked_for() {
        let mut lexer = Lexer::new("a", "a\t b \r\n\rc\x0b{\n\n d");
        let tokens = [(); 10].map(|()| lexer.next_in_line());
        assert_eq!(
            tokens.map(|token| token.text),
            ["a", "b", "\r\n", "\r", "c", "{", "\n", "\n", "d", ""]
        );
        for token in tokens {
            assert_eq!(token.ends_line(), token.text.trim().is_empty(), "{token:?}");
        }
    }

    #[test]
    fn a_number_that_the_line_lacks_is_told_where_the_line_ends() {
        let mut lexer = Lexer::new("a", "1\n2 \r\n3");
        lexer.next();
        lexer.next();
        let end = lexer.next_in_line();
        let found = lexer.number_at(end, || "here".to_owned());
        let wanted = "a:2:3: expected a number here, but found the end of the line".to_owned();
        assert_eq!(found.map_err(|fault| fault.to_string()), Err(wanted));
        assert_eq!(lexer.next().text, "3");
    }

    #[test]
    fn numbers_are_decimal_and_finite() {
        for (text, wanted) in [
            ("1", 1.0),
            ("-0.00000", 0.0),
            (".5", 0.5),
            ("-.07", -0.07),
            ("5.", 5.0),
            ("+1", 1.0),
            ("1e-3", 1e-3),
            ("2.5E+2", 250.0),
            ("1e-999", 0.0),
            ("-1e9", -1e9),
        ] {
            assert_eq!(
                Lexer::new("a", text).number(String::new),
                Ok(wanted),
                "{text}"
            );
        }
        for text in [
            "", "nan", "NaN", "inf", "-inf", "infinity", "1e999", "-1.1e9", "0x10", "1_0", "1,5",
            "1.0f", "--1", "+-1", "e5", ".", "-", "1e", "1-2", "²",
        ] {
            assert!(
                Lexer::new("a", text).number(String::new).is_err(),
                "{text:?}"
            );
        }
    }

    #[test]
    fn whole_numbers_have_digits_only() {
        for (text, wanted) in [
            ("0", 0),
            ("007", 7),
            ("+3", 3),
            ("99999999999999999999999", u64::MAX),
        ] {
            let whole = Lexer::new("a", text).whole(String::new);
            assert_eq!(whole.map(|(whole, _)| whole), Ok(wanted));
        }
        for text in ["", "-1", "-0", "1.0", "1e3", "+", "x", "٣"] {
            assert!(
                Lexer::new("a", text).whole(String::new).is_err(),
                "{text:?}"
            );
        }
    }

    #[test]
    fn names_in_quotes_may_hold_spaces_and_braces() {
        for (text, name, rest) in [
            ("\"left arm\" {", "left arm", "{"),
            ("\"a{b\"c", "a{b", "c"),
            // Not in quotes.
            ("\"\" x", "\"\"", "x"),
            ("left arm", "left", "arm"),
            ("\"left\narm\"", "\"left", "arm\""),
            ("\"left", "\"left", ""),
            ("a\"b c\"", "a\"b", "c\""),
        ] {
            let mut lexer = Lexer::new("a", text);
            assert_eq!(lexer.next_name().text, name, "{text:?}");
            assert_eq!(lexer.next().text, rest, "{text:?}");
        }
    }

    #[test]
    fn faults_are_told_backwards_and_forwards_alike() {
        let lexer = Lexer::new("a", "1\n22\n333");
        let place = |offset| lexer.line_column(Token { text: "", offset });
        assert_eq!([place(5), place(2), place(6)], [(3, 1), (2, 1), (3, 2)]);
    }

    #[test]
    fn what_is_quoted_is_short_and_on_one_line() {
        let long = "x".repeat(1_000_000);
        let mut lexer = Lexer::new("a", &long);
        let token = lexer.next();
        assert!(lexer.fault(token, "y").to_string().len() < 100);
        assert_eq!(quoted("a\u{7f}b\u{85}"), "`a\\u{7f}b\\u{85}`");
    }
}
