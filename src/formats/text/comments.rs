//! Comments in the files of the courses. Neither course defines any; hand-edited files have them all the same.
//! Never lives here: OBJ, which defines comments of its own.
//!
//! A word that starts with `//` or `#` hides the rest of its line, and so does `;` as the first word of a line: elsewhere it may end a
//! statement. `/*` hides everything up to `*/`. A comment may touch the number before it. In double quotes there is none.

use super::lexer::{ends_word, parse_number, quotation_end};
use super::line_column;
use crate::formats::error::FileFault;
use crate::rig::Warnings;
use std::borrow::Cow;

/// Where a comment ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::formats) enum End {
    At(usize),
    /// There is no `*/` up to the end of the file.
    Missing,
}

/// Of the comment that starts at `at`, where a word would start; `None` where none does.
pub(in crate::formats) fn end(text: &[u8], at: usize) -> Option<End> {
    let rest = &text[at..];
    if rest.starts_with(b"/*") {
        let inside = &rest[2..];
        let length = inside.windows(2).position(|two| two == b"*/");
        return Some(length.map_or(End::Missing, |length| End::At(at + length + 4)));
    }
    let hides_line = rest.starts_with(b"//")
        || rest.starts_with(b"#")
        || (rest.starts_with(b";") && is_first_in_line(text, at));
    hides_line.then(|| {
        let length = rest.iter().position(|byte| b"\r\n".contains(byte));
        End::At(at + length.unwrap_or(rest.len()))
    })
}

fn is_first_in_line(text: &[u8], at: usize) -> bool {
    let before = text[..at].iter().rev();
    before
        .take_while(|byte| !b"\r\n".contains(byte))
        .all(|byte| *byte <= b' ')
}

/// The text with spaces in place of its comments, so that all else stands in its line and column. Warns of how many there are.
///
/// # Errors
/// [`FileFault`] at a `/*` that nothing ends.
pub(in crate::formats) fn blanked<'a>(
    file: &str,
    text: Cow<'a, str>,
    warnings: &mut Warnings,
) -> Result<Cow<'a, str>, FileFault> {
    let Some((first, _)) = next_comment(&text, 0) else {
        return Ok(text);
    };
    let mut blanked = String::with_capacity(text.len());
    let mut count = 0_usize;
    // How far the text has been copied.
    let mut copied = 0;
    while let Some((start, end)) = next_comment(&text, copied) {
        let End::At(end) = end else {
            let (line, column) = line_column(&text, start);
            return Err(FileFault {
                line,
                column,
                ..FileFault::whole(file, "`*/` after this `/*`", "the end of the file")
            });
        };
        blanked.push_str(&text[copied..start]);
        let blank = |c| if matches!(c, '\r' | '\n') { c } else { ' ' };
        blanked.extend(text[start..end].chars().map(blank));
        copied = end;
        count += 1;
    }
    blanked.push_str(&text[copied..]);
    warnings.push(|| {
        let (line, column) = line_column(&text, first);
        let comments = match count {
            1 => "a comment".to_owned(),
            _ => format!("{count} comments, of which this is the first"),
        };
        format!("{file}:{line}:{column}: passed over {comments}")
    });
    Ok(Cow::Owned(blanked))
}

/// The first comment at or after `at`, which no word reaches across: where it starts and ends.
fn next_comment(text: &str, mut at: usize) -> Option<(usize, End)> {
    let bytes = text.as_bytes();
    while let Some(&byte) = bytes.get(at) {
        if ends_word(byte) {
            at += 1;
        } else if let Some(end) = end(bytes, at) {
            return Some((at, end));
        } else if let Some(end) = quotation_end(bytes, at) {
            at = end;
        } else {
            let length = bytes[at..].iter().position(|&byte| ends_word(byte));
            let word_end = length.map_or(bytes.len(), |length| at + length);
            if let Some(mark) = mark_behind_number(&text[at..word_end]) {
                at += mark;
                return end(bytes, at).map(|end| (at, end));
            }
            at = word_end;
        }
    }
    None
}

/// Where a word that starts as a number goes on as a comment. A name may be a number as well, and `2#2` is how repeated names are
/// told apart: digits alone after a `#` are no comment.
fn mark_behind_number(word: &str) -> Option<usize> {
    let mark = word.find(['/', '#'])?;
    let (number, rest) = word.split_at(mark);
    let is_mark = match rest.strip_prefix('#') {
        Some(rest) => rest.is_empty() || !rest.bytes().all(|byte| byte.is_ascii_digit()),
        None => rest.starts_with("//") || rest.starts_with("/*"),
    };
    (is_mark && parse_number(number).is_some()).then_some(mark)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<(String, Vec<String>), String> {
        let mut warnings = Warnings::default();
        blanked("a", Cow::Borrowed(text), &mut warnings)
            .map(|text| (text.into_owned(), warnings.into_sentences()))
            .map_err(|fault| fault.to_string())
    }

    #[test]
    fn comments_are_hidden_and_all_else_stays_where_it_is() {
        for (text, left) in [
            ("// pose 1\rpose 2", "         \rpose 2"),
            ("a{// }\n}#}", "a{    \n}  "),
            ("a ## b\r\n/// c\r\nd", "a     \r\n     \r\nd"),
            ("#\u{e4}\u{1F600} x\ny", "     \ny"),
            ("a /* b\n } */ c", "a     \n      c"),
            ("/**/a/*b", "    a/*b"),
            ("// /* a\nb */", "       \nb */"),
            ("/* // */ a", "         a"),
            ("1 2 3// x\n4#x 5", "1 2 3    \n4    "),
            ("-.5/* x */1", "-.5       1"),
            (" ; pose 1\n0 ; pose 1", "         \n0 ; pose 1"),
        ] {
            let (found, warnings) = of(text).unwrap_or_default();
            assert_eq!(found, left, "{text:?}");
            assert_eq!(warnings.len(), 1, "{text:?}");
        }
    }

    #[test]
    fn what_only_looks_like_a_comment_stays() {
        for text in [
            "knee#2 2#2 {",
            "a//b http://c",
            "0; 1 ; 2",
            "1/2 / *",
            "\"my // #1.bmp\" x",
            "",
        ] {
            assert_eq!(of(text), Ok((text.to_owned(), Vec::new())));
        }
        // A quotation ends in its line.
        assert_eq!(of("\"a #b\nc\"").unwrap_or_default().0, "\"a   \nc\"");
    }

    #[test]
    fn comments_are_counted_and_the_first_one_is_placed() {
        let one = of("a\n b # c").unwrap_or_default().1;
        assert_eq!(one, ["a:2:4: passed over a comment"]);
        let many = of("a // b // c\n# d\n/* e\nf */").unwrap_or_default().1;
        let wanted = "a:1:3: passed over 3 comments, of which this is the first";
        assert_eq!(many, [wanted]);
    }

    #[test]
    fn a_comment_that_nothing_ends_is_a_fault_where_it_starts() {
        let wanted = "a:2:3: expected `*/` after this `/*`, but found the end of the file";
        assert_eq!(of("a\n  /*/ b"), Err(wanted.to_owned()));
    }
}
