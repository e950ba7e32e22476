//! What an OBJ has that could be worked with, but should not be there: a warning for each kind. Never lives here: finding it.

use crate::formats::error::quoted;
use crate::formats::text::lexer::{Lexer, Token};
use crate::rig::Warnings;

/// Where something is for the first time that could be worked with, but should not be there.
#[derive(Debug, Default)]
pub(super) struct Oddities<'a> {
    /// A statement that is not read and not to be expected either.
    pub unknown: Option<Token<'a>>,
    pub not_a_number: Option<Token<'a>>,
    pub color_out_of_range: Option<Token<'a>>,
    pub no_texcoords: Option<Token<'a>>,
    pub no_normals: Option<Token<'a>>,
    pub too_few_corners: Option<Token<'a>>,
    pub crosses_itself: Option<Token<'a>>,
    pub too_much_work: Option<Token<'a>>,
    pub group: Option<Token<'a>>,
    pub nameless: Option<Token<'a>>,
}

impl Oddities<'_> {
    pub(super) fn warn(&self, lexer: &Lexer, warnings: &mut Warnings) {
        let mut found = [
            (
                self.unknown,
                "is not read here; it is skipped, and so are others like it",
            ),
            (
                self.not_a_number,
                "is no number; it is passed over, and so are others like it",
            ),
            (
                self.color_out_of_range,
                "is no part of a color, which goes from 0 to 1; it is clamped, and so are others like it",
            ),
            (
                self.no_texcoords,
                "names a texture coordinate, but there are none above; it is passed over, and so are others like it",
            ),
            (
                self.no_normals,
                "names a normal, but there are none above; it is passed over, and so are others like it",
            ),
            (
                self.too_few_corners,
                "has fewer than 3 corners; it is left out, and so are others like it",
            ),
            (
                self.crosses_itself,
                "is a face that crosses itself; it is cut into a fan, and so are others like it",
            ),
            (
                self.too_much_work,
                "is a concave face, and the file has more corners of concave faces than are triangulated exactly; it is cut into a fan, and so are others like it",
            ),
            (
                self.group,
                "is no smoothing group; it is taken for `off`, and so are others like it",
            ),
            (
                self.nameless,
                "names nothing; it is passed over, and so are others like it",
            ),
        ];
        found.sort_by_key(|(token, _)| token.map(|token| token.offset));
        for (token, what) in found {
            if let Some(token) = token {
                warnings.push(|| format!("{}: {} {what}", lexer.place(token), quoted(token.text)));
            }
        }
    }
}
