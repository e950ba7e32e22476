//! From bytes to text: which encodings are read, and where in a text an offset is.
//! Never lives here: words and grammar.

use super::error::FileFault;

pub(super) const UTF8_BOM: &[u8] = b"\xEF\xBB\xBF";

/// The text of a rig file: UTF-8 without NUL, of which plain ASCII is a part. A byte order mark is left out.
///
/// # Errors
/// [`FileFault`] at the first byte that is no text.
pub(super) fn decode<'a>(file: &str, bytes: &'a [u8]) -> Result<&'a str, FileFault> {
    const EXPECTED: &str = "UTF-8 text";
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(FileFault::whole(file, EXPECTED, "UTF-16 text"));
    }
    let bytes = without_bom(bytes);
    let (text, invalid) = match std::str::from_utf8(bytes) {
        Ok(text) => (text, None),
        Err(error) => {
            let end = error.valid_up_to();
            let valid = std::str::from_utf8(&bytes[..end]).unwrap_or_default();
            (valid, Some(bytes[end]))
        }
    };
    let (offset, byte) = match (text.as_bytes().iter().position(|&byte| byte == 0), invalid) {
        (Some(offset), _) => (offset, 0),
        (None, Some(byte)) => (text.len(), byte),
        (None, None) => return Ok(text),
    };
    let (line, column) = Place::START.advanced(text, offset).line_column(text);
    Err(FileFault {
        line,
        column,
        ..FileFault::whole(file, EXPECTED, format!("the byte 0x{byte:02X}"))
    })
}

pub(super) fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(UTF8_BOM).unwrap_or(bytes)
}

/// How far into a text, counted in lines. CR LF, a lone CR and a lone LF each end one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    offset: usize,
    line: usize,
    line_start: usize,
}

impl Place {
    pub(super) const START: Self = Self {
        offset: 0,
        line: 1,
        line_start: 0,
    };

    pub(super) fn offset(self) -> usize {
        self.offset
    }

    /// Counts on to `offset`, which lies ahead of this place and not between a CR and its LF.
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

    fn decoded(bytes: &[u8]) -> Result<&str, String> {
        decode("a.skel", bytes).map_err(|fault| fault.to_string())
    }

    #[test]
    fn utf8_is_text_with_or_without_a_mark() {
        assert_eq!(decoded("knie_größe".as_bytes()), Ok("knie_größe"));
        assert_eq!(decoded(b"\xEF\xBB\xBFballjoint"), Ok("balljoint"));
        assert_eq!(decoded(b""), Ok(""));
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
                b"balljoint\r\n  n\xE9 {",
                "a.skel:2:4: expected UTF-8 text, but found the byte 0xE9",
            ),
            (
                b"\n\0\xFF",
                "a.skel:2:1: expected UTF-8 text, but found the byte 0x00",
            ),
            (
                "é\u{1F600}\0".as_bytes(),
                "a.skel:1:3: expected UTF-8 text, but found the byte 0x00",
            ),
        ] {
            assert_eq!(decoded(bytes), Err(wanted.to_owned()));
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
            let place = Place::START.advanced(text, offset);
            assert_eq!(place.line_column(text), wanted, "{word}");
        }
    }
}
