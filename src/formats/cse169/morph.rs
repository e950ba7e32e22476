//! Reads a CSE 169 `.morph`: where a morph target takes some of a skin's vertices.
//! Never lives here: what a vertex is moved by, which is up to [`Draft::build`](crate::rig::Draft::build).
//!
//! ```text
//! morph   := section*                                                             each at most once, in any order
//! section := "positions" N "{" (vertex x y z){N} "}"
//!          | "normals" N "{" (vertex nx ny nz){N} "}"                             may be missing
//! ```
//! Vertices are counted from 0 and listed at most once in a section, in any order; the two sections may list different ones. Values
//! are not differences: they are where the vertex is, and its normal, at weight 1. A vertex that is not listed stays.

use super::common::second;
use super::keywords::{Keywords, PassedOver};
use super::sections::{Brace, Section};
use crate::formats::contribution::KnownMesh;
use crate::formats::error::LoadError;
use crate::formats::text::lexer::{Lexer, Token};
use crate::limits::Limits;
use crate::rig::{MorphDraft, Warnings};
use glam::{DVec3, Vec3};

const SECTION: Keywords = Keywords(&["positions", "normals"]);

/// The target has no name and no mesh yet.
///
/// # Errors
/// [`LoadError::Invalid`] at the word that does not fit, [`LoadError::Limit`] where more vertices are announced than targets may move.
pub(super) fn read(
    lexer: Lexer,
    mesh: KnownMesh,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<MorphDraft, LoadError> {
    let mut reader = Reader {
        lexer,
        mesh,
        limits,
        warnings,
        positions: None,
        normals: None,
    };
    reader.read_sections()?;
    Ok(MorphDraft {
        positions: reader.positions.unwrap_or_default(),
        normals: reader.normals.unwrap_or_default(),
        ..MorphDraft::default()
    })
}

struct Reader<'a, 'w> {
    lexer: Lexer<'a>,
    mesh: KnownMesh<'w>,
    limits: &'w Limits,
    warnings: &'w mut Warnings,
    positions: Option<Vec<(u32, Vec3)>>,
    normals: Option<Vec<(u32, Vec3)>>,
}

impl<'a> Reader<'a, '_> {
    fn read_sections(&mut self) -> Result<(), LoadError> {
        let first = self.lexer.peek();
        let mut passed_over = PassedOver::default();
        loop {
            let word = SECTION.next(&mut self.lexer, self.warnings);
            match word.text {
                "positions" if self.positions.is_some() => {
                    return Err(second(&self.lexer, word).into());
                }
                "normals" if self.normals.is_some() => {
                    return Err(second(&self.lexer, word).into());
                }
                "positions" => self.positions = Some(self.read_positions(word)?),
                "normals" => self.normals = Some(self.read_normals(word)?),
                "" if self.positions.is_some() => return Ok(()),
                "" => {
                    // Where nothing is known, it is no morph target from its first word on.
                    let otherwise = if self.normals.is_some() { word } else { first };
                    let reported_at = passed_over.of("positions").unwrap_or(otherwise);
                    return Err(self.lexer.fault(reported_at, "`positions`").into());
                }
                _ => {
                    let near = SECTION.skip_unknown(&mut self.lexer, word, self.warnings)?;
                    passed_over.note(near, word);
                }
            }
        }
    }

    fn read_positions(&mut self, keyword: Token<'a>) -> Result<Vec<(u32, Vec3)>, LoadError> {
        let rows = self.read_rows(keyword, ("position", "positions"))?;
        let rows = rows.into_iter();
        Ok(rows
            .map(|(vertex, position, _)| (vertex, position.as_vec3()))
            .collect())
    }

    /// Normals of length 1. One of no length says nothing and is left out.
    fn read_normals(&mut self, keyword: Token<'a>) -> Result<Vec<(u32, Vec3)>, LoadError> {
        let rows = self.read_rows(keyword, ("normal", "normals"))?;
        let mut normals = Vec::with_capacity(rows.len());
        for (vertex, normal, token) in rows {
            match normal.try_normalize() {
                Some(normal) => normals.push((vertex, normal.as_vec3())),
                None => self.warnings.push(|| {
                    let place = self.lexer.place(token);
                    format!("{place}: the normal of vertex {vertex} has no length; it stays as it is in the skin")
                }),
            }
        }
        Ok(normals)
    }

    /// Vertex, value, and the word that names the vertex.
    fn read_rows(
        &mut self,
        keyword: Token<'a>,
        nouns: (&'static str, &'static str),
    ) -> Result<Vec<(u32, DVec3, Token<'a>)>, LoadError> {
        let limits = self.limits;
        let so_far = [&self.positions, &self.normals].map(|rows| rows.as_ref().map_or(0, Vec::len));
        let so_far = so_far.iter().sum::<usize>() as u64;
        let check_limit = |count: u64| limits.morph_displacements(count.saturating_add(so_far));
        let section = Section::open(&mut self.lexer, keyword, nouns, Brace::Needed, check_limit)?;
        let mut listed = Listed::of(self.mesh);
        section.read_rows(&mut self.lexer, 8, |lexer, row| {
            let place = || section.in_row(row);
            let (vertex, token) = lexer.whole(place)?;
            let vertex = listed
                .add(vertex)
                .map_err(|expected| lexer.fault(token, format!("{expected} {}", place())))?;
            let mut value = DVec3::ZERO;
            for axis in 0..3 {
                value[axis] = lexer.number(place)?;
            }
            Ok((vertex, value, token))
        })
    }
}

/// Which vertices a section has listed.
struct Listed<'a> {
    mesh: KnownMesh<'a>,
    seen: Vec<bool>,
}

impl<'a> Listed<'a> {
    fn of(mesh: KnownMesh<'a>) -> Self {
        Self {
            mesh,
            seen: vec![false; mesh.vertex_count],
        }
    }

    /// # Errors
    /// What was expected instead.
    fn add(&mut self, vertex: u64) -> Result<u32, String> {
        let index = usize::try_from(vertex).unwrap_or(usize::MAX);
        match self.seen.get_mut(index) {
            // No skin has four thousand million vertices.
            Some(seen) if !*seen => {
                *seen = true;
                Ok(vertex as u32)
            }
            Some(_) => Err("a vertex that was not listed before".to_owned()),
            None => {
                let KnownMesh { file, vertex_count } = self.mesh;
                Err(format!(
                    "a vertex below {vertex_count}, the number of positions in `{file}`,"
                ))
            }
        }
    }
}

#[cfg(test)]
mod tests;
