//! Reads a CSE 169 `.rig`: a list of the files that one character is made of.
//! Never lives here: looking for these files, and what is in them.
//!
//! ```text
//! rig  := "rig" [NAME] "{" item* "}"
//! item := "skeleton" FILE | "skin" FILE                                           each at most once
//!       | "morphs" N "{" (["morph"] FILE){N} "}"                                  at most once
//! ```
//! Items come in any order and each may be missing, but a list of nothing is a fault. The name is not used: a rig is called as its
//! request says. There is one official file of this kind, without morph targets; that an entry of `morphs` is a file's name is taken
//! from the two other entries.

use super::common::{name_and_brace, second, warn_of_rest};
use super::formats::{MORPH, SKEL, SKIN};
use super::keywords::Keywords;
use super::sections::{Brace, Section};
use crate::formats::contribution::ListEntry;
use crate::formats::error::{FileFault, LoadError};
use crate::formats::format::Format;
use crate::formats::text::lexer::{Lexer, Token};
use crate::limits::Limits;
use crate::rig::Warnings;

const ITEM: Keywords = Keywords(&["skeleton", "skin", "morphs"]);

/// Entries in file order.
///
/// # Errors
/// [`LoadError::Invalid`] at the word that does not fit, [`LoadError::Limit`] where more morph targets are announced than a rig may have.
pub(super) fn read(
    lexer: Lexer,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Vec<ListEntry>, LoadError> {
    let mut reader = Reader {
        lexer,
        limits,
        entries: Vec::new(),
        seen: Vec::new(),
    };
    reader.read(warnings)?;
    Ok(reader.entries)
}

struct Reader<'a, 'w> {
    lexer: Lexer<'a>,
    limits: &'w Limits,
    entries: Vec<ListEntry>,
    /// Keywords met so far; each of the three is there at most once.
    seen: Vec<&'a str>,
}

impl<'a> Reader<'a, '_> {
    fn read(&mut self, warnings: &mut Warnings) -> Result<(), LoadError> {
        let rig = Keywords(&["rig"]).next(&mut self.lexer, warnings);
        if rig.text != "rig" {
            return Err(self.lexer.fault(rig, "`rig`").into());
        }
        name_and_brace(&mut self.lexer, rig)?;
        let mut first_unknown = None;
        loop {
            let word = ITEM.next(&mut self.lexer, warnings);
            match word.text {
                "skeleton" => self.read_entry(word, &SKEL)?,
                "skin" => self.read_entry(word, &SKIN)?,
                "morphs" => self.read_morphs(word)?,
                "}" if self.entries.is_empty() => {
                    let expected = "`skeleton`, `skin` or `morphs` with a file's name";
                    let reported_at = first_unknown.unwrap_or(word);
                    return Err(self.lexer.fault(reported_at, expected).into());
                }
                "}" => break,
                "" => return Err(self.lexer.fault(word, "`}` to end the `rig`").into()),
                _ => {
                    first_unknown.get_or_insert(word);
                    ITEM.skip_unknown(&mut self.lexer, word, warnings)?;
                }
            }
        }
        warn_of_rest(&self.lexer, "the `rig`", warnings);
        Ok(())
    }

    fn once(&mut self, keyword: Token<'a>) -> Result<(), FileFault> {
        if self.seen.contains(&keyword.text) {
            return Err(second(&self.lexer, keyword));
        }
        self.seen.push(keyword.text);
        Ok(())
    }

    fn read_entry(&mut self, keyword: Token<'a>, format: &'static Format) -> Result<(), FileFault> {
        self.once(keyword)?;
        let place = || format!("after `{}`", keyword.text);
        let entry = read_file_name(&mut self.lexer, format, place)?;
        self.entries.push(entry);
        Ok(())
    }

    fn read_morphs(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        self.once(keyword)?;
        let (nouns, limits) = (("morph target", "morph targets"), self.limits);
        let check_limit = |count| limits.morph_targets(count);
        let section = Section::open(&mut self.lexer, keyword, nouns, Brace::Needed, check_limit)?;
        let entries = section.read_rows(&mut self.lexer, 2, |lexer, row| {
            // The word is free to stand there, but a file may also be called that.
            let mut ahead = lexer.clone();
            if ahead.take("morph") && ahead.peek().text != "}" {
                *lexer = ahead;
            }
            Ok(read_file_name(lexer, &MORPH, || section.in_row(row))?)
        })?;
        self.entries.extend(entries);
        Ok(())
    }
}

fn read_file_name(
    lexer: &mut Lexer,
    format: &'static Format,
    place: impl Fn() -> String,
) -> Result<ListEntry, FileFault> {
    let token = lexer.next_name();
    if matches!(token.text, "" | "{" | "}") {
        return Err(lexer.fault(token, format!("a file name {}", place())));
    }
    let (line, column) = lexer.line_column(token);
    Ok(ListEntry {
        format,
        file: token.text.to_owned(),
        line,
        column,
    })
}

#[cfg(test)]
mod tests;
