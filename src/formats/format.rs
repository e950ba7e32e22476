//! What a kind of file is called and how one is recognised. Never lives here: what is in a file beyond its first words.

/// A kind of file that is read. No two have one name.
#[derive(Debug)]
pub(super) struct Format {
    /// In the words of [`FORMATS`](super::FORMATS).
    pub name: &'static str,
    /// Whose format it is, for people: `CSE 169`. May be empty.
    pub family: &'static str,
    /// In lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// A file of it, with the article: `a CSE 169 skin`.
    pub what: &'static str,
    /// A file of it in one word or two, without an article: `skin`.
    pub noun: &'static str,
    /// Whether content speaks for this format. That the extension may be one of `extensions` is considered besides.
    pub sniff: fn(&Opening) -> Option<Evidence>,
}

impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// What a file is recognised by, from the weakest to the strongest. Of formats with equal evidence the first in the table is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Evidence {
    Extension,
    /// The file would be of that format under any name.
    Content,
    /// The content would mean another format, or none, under another extension.
    ContentAndExtension,
}

/// What [`Format::sniff`] looks at.
#[derive(Debug)]
pub(super) struct Opening<'a> {
    /// In lower case, without the dot.
    pub extension: &'a str,
    pub bytes: &'a [u8],
    /// In lower case, for readers take keywords in any case. Comments are left out and braces are words of their own; past the end of the
    /// file come empty words.
    pub words: [Vec<u8>; 3],
}

impl Opening<'_> {
    pub(super) fn starts_with_number(&self) -> bool {
        let first = self.words[0].iter().find(|byte| !b"+-.".contains(byte));
        first.is_some_and(u8::is_ascii_digit)
    }
}
