//! Corners of faces as indices of what stands above them. Never lives here: what becomes of a face.

use super::oddities::Oddities;
use crate::formats::error::FileFault;
use crate::formats::text::lexer::{Lexer, Token};

/// Indices of what is in range.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub vertex: u32,
    pub texcoord: Option<usize>,
    pub normal: Option<usize>,
}

/// How many there are above a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Above {
    pub vertices: usize,
    pub texcoords: usize,
    pub normals: usize,
}

impl Corner {
    pub(super) fn read<'a>(
        word: Token<'a>,
        above: Above,
        lexer: &Lexer<'a>,
        oddities: &mut Oddities<'a>,
    ) -> Result<Self, FileFault> {
        let mut offset = word.offset;
        let mut parts = word.text.split('/').map(|text| {
            let part = Token { text, offset };
            offset += text.len() + 1;
            part
        });
        let [vertex, texcoord, normal] = std::array::from_fn(|_| parts.next());
        if parts.next().is_some() {
            let expected = "a corner of at most 3 parts, `v/vt/vn`";
            return Err(lexer.fault(word, expected));
        }
        let present = |part: Option<Token<'a>>| part.filter(|part| !part.text.is_empty());
        let vertex = present(vertex).unwrap_or(word);
        let vertex = index_at(vertex, above.vertices, "vertices", lexer)?;
        let mut texcoord = present(texcoord);
        if above.texcoords == 0 && texcoord.take().is_some() {
            oddities.no_texcoords.get_or_insert(word);
        }
        let mut normal = present(normal);
        if above.normals == 0 && normal.take().is_some() {
            oddities.no_normals.get_or_insert(word);
        }
        let texcoord_at = |part| index_at(part, above.texcoords, "texture coordinates", lexer);
        let normal_at = |part| index_at(part, above.normals, "normals", lexer);
        Ok(Self {
            // The limit of vertices is below 2^32.
            vertex: vertex as u32,
            texcoord: texcoord.map(texcoord_at).transpose()?,
            normal: normal.map(normal_at).transpose()?,
        })
    }
}

/// The index from 0 that `part` stands for, where `count` things are above it.
fn index_at(part: Token, count: usize, many: &str, lexer: &Lexer) -> Result<usize, FileFault> {
    let index = part.text.parse().ok().and_then(|given: isize| {
        if given < 0 {
            count.checked_add_signed(given)
        } else {
            given.unsigned_abs().checked_sub(1)
        }
    });
    index.filter(|&index| index < count).ok_or_else(|| {
        let expected = format!("one of the {count} {many} above, counted from 1");
        lexer.fault(part, expected)
    })
}
