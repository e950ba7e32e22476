//! From bytes to text: which encodings are read, and where in a text an offset is.
//! Never lives here: words and grammar.

pub(super) mod comments;
pub(super) mod lexer;
pub(super) mod mention;

use super::error::FileFault;
use crate::rig::Warnings;
use std::borrow::Cow;

pub(super) const UTF8_BOM: &[u8] = b"\xEF\xBB\xBF";

/// The text of a rig file. A byte order mark is left out. Bytes that are not UTF-8 are taken for Latin-1, which older editors write, and
/// NUL bytes at the end are left out, which some programs write as the end of a string: a warning each.
///
/// # Errors
/// [`FileFault`] for UTF-16, and at a NUL byte before the end: such a file is no text.
pub(super) fn decode<'a>(
    file: &str,
    bytes: &'a [u8],
    warnings: &mut Warnings,
) -> Result<Cow<'a, str>, FileFault> {
    const EXPECTED: &str = "UTF-8 text";
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(FileFault::whole(file, EXPECTED, "UTF-16 text"));
    }
    let (bytes, nul_count) = without_nuls_at_end(without_bom(bytes));
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(decode_mixed(file, bytes, warnings)),
    };
    if let Some(offset) = text.bytes().position(|byte| byte == 0) {
        let (line, column) = line_column(&text, offset);
        return Err(FileFault {
            line,
            column,
            ..FileFault::whole(file, EXPECTED, "the byte 0x00")
        });
    }
    if nul_count > 0 {
        warnings.push(|| {
            let (line, column) = line_column(&text, text.len());
            let bytes = if nul_count == 1 { "byte" } else { "bytes" };
            format!("{file}:{line}:{column}: passed over {nul_count} NUL {bytes} at the end")
        });
    }
    Ok(text)
}

/// UTF-8 as far as it is any, each other byte the character of that number, as Latin-1 has it.
fn decode_mixed(file: &str, bytes: &[u8], warnings: &mut Warnings) -> String {
    let mut text = String::with_capacity(bytes.len());
    let (mut count, mut first) = (0_usize, 0);
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        if count == 0 {
            first = text.len();
        }
        count += chunk.invalid().len();
        text.extend(chunk.invalid().iter().map(|&byte| char::from(byte)));
    }
    warnings.push(|| {
        let (line, column) = line_column(&text, first);
        let bytes = match count {
            1 => "1 byte here is".to_owned(),
            _ => format!("{count} bytes from here on are"),
        };
        format!("{file}:{line}:{column}: {bytes} not UTF-8 and taken for Latin-1")
    });
    text
}

/// What stands before a run of NUL bytes and separators that ends the file, and how many NUL bytes it has.
pub(super) fn without_nuls_at_end(bytes: &[u8]) -> (&[u8], usize) {
    let last = bytes.iter().rposition(|&byte| byte > b' ');
    let (_, tail) = bytes.split_at(last.map_or(0, |last| last + 1));
    let nuls = tail.iter().filter(|&&byte| byte == 0).count();
    let first = tail.iter().position(|&byte| byte == 0);
    let cut = first.map_or(0, |first| tail.len() - first);
    (&bytes[..bytes.len() - cut], nuls)
}

pub(super) fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(UTF8_BOM).unwrap_or(bytes)
}

/// Line and column of a byte offset, both from 1, the column in characters.
pub(super) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    Position::START.advanced(text, offset).line_column(text)
}

/// An offset into a text, and the line that it is in. CR LF, a lone CR and a lone LF each end one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Position {
    offset: usize,
    line: usize,
    line_start: usize,
}

impl Position {
    pub(super) const START: Self = Self {
        offset: 0,
        line: 1,
        line_start: 0,
    };

    pub(super) fn offset(self) -> usize {
        self.offset
    }

    /// Counts on to `offset`, which lies ahead of this position and not between a CR and its LF.
    pub(super) fn advanced(mut self, text: &str, offset: usize) -> Self {
        let bytes = text.as_bytes();
        for at in self.offset..offset {
            let ends_line = match bytes[at] {
                b'\n' => true,
                b'\r' => bytes.get(at + 1) != Some(&b'\n'),
                _ => false,
            };
            if ends_line {
                self.line += 1;
                self.line_start = at + 1;
            }
        }
        self.offset = offset;
        self
    }

    /// Line and column from 1, the column in characters.
    pub(super) fn line_column(self, text: &str) -> (usize, usize) {
        (
            self.line,
            text[self.line_start..self.offset].chars().count() + 1,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> Result<(String, Vec<String>), String> {
        let mut warnings = Warnings::default();
        decode("a.skel", bytes, &mut warnings)
            .map(|text| (text.into_owned(), warnings.into_sentences()))
            .map_err(|fault| fault.to_string())
    }

    #[test]
    fn utf8_is_text_with_or_without_a_mark() {
        let plain = |text: &str| Ok((text.to_owned(), Vec::new()));
        assert_eq!(decoded("knie_größe".as_bytes()), plain("knie_größe"));
        assert_eq!(decoded(b"\xEF\xBB\xBFballjoint"), plain("balljoint"));
        assert_eq!(decoded(b""), plain(""));
    }

    #[test]
    fn other_bytes_are_taken_for_latin_1() {
        for (bytes, text, warning) in [
            (
                &b"balljoint\r\n  n\xE9 {"[..],
                "balljoint\r\n  né {",
                "a.skel:2:4: 1 byte here is not UTF-8 and taken for Latin-1",
            ),
            (
                b"\xC3\xA9 \xE4\xF6 \xC3\xA9\xFF",
                "é äö éÿ",
                "a.skel:1:3: 3 bytes from here on are not UTF-8 and taken for Latin-1",
            ),
            // A name cut to so many bytes in the middle of a character.
            (
                b"n\xF0\x9F {",
                "n\u{F0}\u{9F} {",
                "a.skel:1:2: 2 bytes from here on are not UTF-8 and taken for Latin-1",
            ),
        ] {
            let wanted = (text.to_owned(), vec![warning.to_owned()]);
            assert_eq!(decoded(bytes), Ok(wanted));
        }
    }

    #[test]
    fn nul_bytes_at_the_end_are_passed_over() {
        for (bytes, text, nuls) in [
            (&b"a }\n\0"[..], "a }\n", "1 NUL byte"),
            (b"a\0\0 \0\r\n", "a", "3 NUL bytes"),
            (b"\0", "", "1 NUL byte"),
        ] {
            let (found, warnings) = decoded(bytes).unwrap_or_default();
            assert_eq!(found, text);
            let wanted = format!("passed over {nuls} at the end");
            assert!(
                warnings.len() == 1 && warnings[0].ends_with(&wanted),
                "{warnings:?}"
            );
        }
    }

    #[test]
    fn what_is_no_text_is_refused_where_it_stands() {
        for (bytes, wanted) in [
            (
                &b"\xFF\xFEb\0a\0"[..],
                "a.skel:1:1: expected UTF-8 text, but found UTF-16 text",
            ),
            (
                b"\xFE\xFF\0b",
                "a.skel:1:1: expected UTF-8 text, but found UTF-16 text",
            ),
            (
                b"b\0a\0",
                "a.skel:1:2: expected UTF-8 text, but found the byte 0x00",
            ),
            (
                b"\n\xFF\0\xFF",
                "a.skel:2:2: expected UTF-8 text, but found the byte 0x00",
            ),
            (
                "é\u{1F600}\0a".as_bytes(),
                "a.skel:1:3: expected UTF-8 text, but found the byte 0x00",
            ),
        ] {
            assert_eq!(decoded(bytes).map(|_| ()), Err(wanted.to_owned()));
        }
    }

    #[test]
    fn every_kind_of_line_end_ends_one_line() {
        let text = "a\nb\rc\r\nd\r\r\ne\té f";
        for (word, wanted) in [
            ('a', (1, 1)),
            ('b', (2, 1)),
            ('c', (3, 1)),
            ('d', (4, 1)),
            ('e', (6, 1)),
            ('f', (6, 5)),
        ] {
            let offset = text.find(word).unwrap_or(0);
            let position = Position::START.advanced(text, offset);
            assert_eq!(position.line_column(text), wanted, "{word}");
        }
    }
}
