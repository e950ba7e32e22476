//! Which format a file is of: content decides, and the extension where two formats look alike.
//! Never lives here: what speaks for one format, and reading past the first words.

use super::error::quoted;
use super::format::{Evidence, Format, Opening};
use super::names::extension;
use super::text::comments::{self, End};
use super::text::without_bom;
use std::ops::Range;

/// All formats that are read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Formats(pub &'static [&'static Format]);

/// What a file was found to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Recognised {
    As(&'static Format, Evidence),
    /// A rig file of a kind that is not read: what it is.
    NotRead(&'static str),
    /// A picture or a buffer perhaps, if a file refers to it.
    Other,
}

impl Formats {
    pub(super) fn recognise(self, file: &str, bytes: &[u8]) -> Recognised {
        let opening = Opening {
            extension: &extension(file),
            bytes,
            words: first_words(bytes),
        };
        if let "skel" | "skin" = opening.extension
            && opening.words[0].starts_with(b"<")
        {
            return Recognised::NotRead("XML (DART keeps skeletons in it)");
        }
        let mut found = Recognised::Other;
        let mut strongest = None;
        for &format in self.0 {
            let by_extension = || {
                let is_own = format.extensions.contains(&opening.extension);
                is_own.then_some(Evidence::Extension)
            };
            let evidence = (format.sniff)(&opening).or_else(by_extension);
            if let Some(evidence) = evidence.filter(|_| evidence > strongest) {
                strongest = Some(evidence);
                found = Recognised::As(format, evidence);
            }
        }
        found
    }

    /// What is due where a file of no format was given, by families in the order of the table.
    pub(super) fn expected(self) -> String {
        let mut families: Vec<(&str, Vec<String>)> = Vec::new();
        for format in self.0 {
            let files = format.extensions.iter().map(|it| format!("`.{it}`"));
            match families.iter_mut().find(|(name, _)| *name == format.family) {
                Some((_, known)) => known.extend(files),
                None => families.push((format.family, files.collect())),
            }
        }
        let families = families.into_iter().map(|(name, files)| {
            let files = alternatives(&files, " or ");
            format!("{name} {files}").trim_start().to_owned()
        });
        let families: Vec<String> = families.collect();
        format!("a rig file ({})", alternatives(&families, ", or "))
    }
}

/// `a, b or c`, with `or` as the last separator.
fn alternatives(all: &[String], or: &str) -> String {
    match all {
        [others @ .., last] if !others.is_empty() => format!("{}{or}{last}", others.join(", ")),
        _ => all.concat(),
    }
}

impl Recognised {
    pub(super) fn format(self) -> Option<&'static Format> {
        match self {
            Self::As(format, _) => Some(format),
            Self::NotRead(_) | Self::Other => None,
        }
    }

    /// What a file is: `a CSE 169 skin`.
    pub(super) fn described(self, bytes: &[u8]) -> String {
        match self {
            Self::As(format, _) => format.what.to_owned(),
            Self::NotRead(what) => format!("{what}, which is not supported"),
            Self::Other => describe_other(bytes),
        }
    }
}

/// What a file of no known format looks like.
fn describe_other(bytes: &[u8]) -> String {
    let pictures: [(&[u8], &str); 4] = [
        (b"BM", "a BMP picture"),
        (b"\x89PNG", "a PNG picture"),
        (b"\xFF\xD8\xFF", "a JPEG picture"),
        (b"GIF8", "a GIF picture"),
    ];
    if let Some((_, what)) = pictures.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return (*what).to_owned();
    }
    let bytes = without_bom(bytes);
    match std::str::from_utf8(&bytes[word_from(bytes, 0)]) {
        Ok("") => "an empty file".to_owned(),
        Ok(word) if !word.contains('\0') => format!("a file that starts with {}", quoted(word)),
        _ => "a binary file".to_owned(),
    }
}

/// As in [`Opening::words`].
fn first_words(bytes: &[u8]) -> [Vec<u8>; 3] {
    /// Longer than any keyword. A file may be one word of many megabytes.
    const MOST_BYTES: usize = 32;
    let bytes = without_bom(bytes);
    let mut at = 0;
    [(); 3].map(|()| {
        loop {
            let word = word_from(bytes, at);
            at = match comments::end(bytes, word.start) {
                Some(End::At(end)) => end,
                Some(End::Missing) => bytes.len(),
                None => {
                    at = word.end;
                    let word = &bytes[word];
                    return word[..word.len().min(MOST_BYTES)].to_ascii_lowercase();
                }
            };
        }
    })
}

/// The first word that starts at or after `at`.
fn word_from(bytes: &[u8], at: usize) -> Range<usize> {
    let separates = |byte: &u8| (1..=b' ').contains(byte);
    let blank = bytes[at..].iter().take_while(|byte| separates(byte));
    let start = at + blank.count();
    let word = &bytes[start..];
    let ends = |byte: &u8| separates(byte) || b"{}".contains(byte);
    let length = match word.first() {
        Some(b'{' | b'}') => 1,
        _ => word.iter().position(ends).unwrap_or(word.len()),
    };
    start..start + length
}
