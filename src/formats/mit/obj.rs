//! Reads an OBJ as MIT 6.837 uses it: one mesh, whose vertices are the `v` lines in their order, for an `.attach` counts them.
//! Never lives here: materials, and computing normals.
//!
//! No crate: `tobj` renumbers vertices by first use, `obj-rs` panics at curves, `wavefront_obj` splits objects; none tells a column.
//!
//! ```text
//! obj    := (v | vt | vn | f | other)*                     one v at least
//! v      := "v" x y z number{0,4}                          a weight or a colour, read over
//! vt     := "vt" u [v [w]]                                 w is read over
//! vn     := "vn" x y z
//! f      := ("f" | "fo") corner corner corner corner*
//! corner := vertex ["/" [texcoord] ["/" [normal]]]         counted from 1, or back from -1
//! ```
//! Statements end with their line. A corner names what stands above it. Faces of more than three corners are cut into a fan, which
//! is right for convex ones.

#[cfg(test)]
mod tests;

use super::attribute::Attribute;
use super::statements::Statements;
use crate::formats::error::{FileFault, LoadError, quoted};
use crate::formats::lexer::{Lexer, Token};
use crate::limits::Limits;
use crate::rig::{MeshDraft, Warnings};
use glam::{Vec2, Vec3};

/// Every index of the mesh is in range; it has no name, weights or material. Normals and texture coordinates are kept where each
/// vertex has but one.
///
/// # Errors
/// [`LoadError::Invalid`] at the word or line end that does not fit, [`LoadError::Limit`] at the first vertex or triangle too many.
pub(in crate::formats) fn read(
    file: &str,
    text: &str,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<MeshDraft, LoadError> {
    let mut reader = Reader {
        statements: Statements {
            lexer: Lexer::new(file, text),
        },
        limits,
        positions: Vec::new(),
        normals: Attribute::new(("normal", "normals")),
        texcoords: Attribute::new(("texture coordinate", "texture coordinates")),
        triangles: Vec::new(),
        unknown: None,
    };
    reader.read_statements()?;
    reader.finish(warnings)
}

struct Reader<'a> {
    statements: Statements<'a>,
    limits: &'a Limits,
    positions: Vec<Vec3>,
    normals: Attribute<'a, Vec3>,
    texcoords: Attribute<'a, Vec2>,
    triangles: Vec<[u32; 3]>,
    /// The first statement that is not read and not to be expected either.
    unknown: Option<Token<'a>>,
}

impl<'a> Reader<'a> {
    fn read_statements(&mut self) -> Result<(), LoadError> {
        loop {
            let keyword = self.statements.next();
            match keyword.text {
                "" => return Ok(()),
                "v" => self.read_position(keyword)?,
                "vn" => {
                    let normal = self.read_vector(keyword)?;
                    self.normals.push(normal);
                    self.read_line_end("`vn x y z`")?;
                }
                "vt" => self.read_texcoord(keyword)?,
                "f" | "fo" => self.read_face(keyword)?,
                text => {
                    if !is_read_over(text) {
                        self.unknown.get_or_insert(keyword);
                    }
                    self.statements.skip_rest();
                }
            }
        }
    }

    fn finish(self, warnings: &mut Warnings) -> Result<MeshDraft, LoadError> {
        let lexer = &self.statements.lexer;
        let end = lexer.peek();
        if self.positions.is_empty() {
            // A file of another kind is told at its first word, not only at its end.
            return Err(lexer.fault(self.unknown.unwrap_or(end), "`v x y z`").into());
        }
        if let Some(word) = self.unknown {
            warnings.push(|| {
                let (place, word) = (lexer.place(word), quoted(word.text));
                format!("{place}: skipped {word}, which is not read here, and its like")
            });
        }
        if self.triangles.is_empty() {
            warnings.push(|| format!("{}: there are no faces", lexer.place(end)));
        }
        let vertex_count = self.positions.len();
        Ok(MeshDraft {
            normals: self.normals.finish(vertex_count, lexer, warnings),
            texcoords: self.texcoords.finish(vertex_count, lexer, warnings),
            positions: self.positions,
            triangles: self.triangles,
            ..MeshDraft::default()
        })
    }

    fn read_position(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        /// `w` of a rational curve, and a colour that some programs write: `v x y z w r g b` at the longest.
        const SURPLUS: usize = 4;
        self.limits.vertices(self.positions.len() + 1)?;
        let position = self.read_vector(keyword)?;
        self.positions.push(position);
        for _ in 0..SURPLUS {
            if self.read_optional(keyword)?.is_none() {
                return Ok(());
            }
        }
        Ok(self.read_line_end("at most 7 numbers")?)
    }

    fn read_texcoord(&mut self, keyword: Token<'a>) -> Result<(), FileFault> {
        let u = self.read_number(keyword)?;
        let v = self.read_optional(keyword)?;
        self.texcoords.push(Vec2::new(u, v.unwrap_or(0.0)));
        if v.is_none() || self.read_optional(keyword)?.is_none() {
            return Ok(());
        }
        self.read_line_end("`vt u v w`")
    }

    fn read_vector(&mut self, keyword: Token<'a>) -> Result<Vec3, FileFault> {
        let mut vector = Vec3::ZERO;
        for axis in 0..3 {
            vector[axis] = self.read_number(keyword)?;
        }
        Ok(vector)
    }

    fn read_number(&mut self, keyword: Token<'a>) -> Result<f32, FileFault> {
        let word = self.statements.next_word();
        self.number_at(word, keyword)
    }

    /// `None` where the line ends.
    fn read_optional(&mut self, keyword: Token<'a>) -> Result<Option<f32>, FileFault> {
        let word = self.statements.next_word();
        if word.ends_line() {
            return Ok(None);
        }
        self.number_at(word, keyword).map(Some)
    }

    fn number_at(&self, word: Token<'a>, keyword: Token<'a>) -> Result<f32, FileFault> {
        let place = || format!("after `{}`", keyword.text);
        let number = self.statements.lexer.number_at(word, place)?;
        Ok(number as f32)
    }

    fn read_line_end(&mut self, after: &str) -> Result<(), FileFault> {
        let word = self.statements.next_word();
        if word.ends_line() {
            return Ok(());
        }
        let expected = format!("the end of the line after {after}");
        Err(self.statements.lexer.fault(word, expected))
    }

    fn read_face(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        let mut corners = 0_usize;
        let (mut first, mut last) = (0, 0);
        loop {
            let word = self.statements.next_word();
            if word.ends_line() {
                break self.check_corners(corners, word, keyword);
            }
            let vertex = self.read_corner(word)?;
            if corners == 0 {
                first = vertex;
            } else if corners > 1 {
                self.limits.triangles(self.triangles.len() + 1)?;
                self.triangles.push([first, last, vertex]);
            }
            last = vertex;
            corners += 1;
        }
    }

    fn check_corners(
        &self,
        corners: usize,
        line_end: Token<'a>,
        keyword: Token<'a>,
    ) -> Result<(), LoadError> {
        if corners >= 3 {
            return Ok(());
        }
        let expected = format!("at least 3 corners after `{}`", keyword.text);
        let found = corners.to_string();
        Err(self
            .statements
            .lexer
            .fault_found(line_end, expected, found)
            .into())
    }

    /// The vertex of a corner; what else it names is noted.
    fn read_corner(&mut self, word: Token<'a>) -> Result<u32, FileFault> {
        let mut offset = word.offset;
        let mut parts = word.text.split('/').map(|text| {
            let part = Token { text, offset };
            offset += text.len() + 1;
            part
        });
        let [vertex, texcoord, normal] = std::array::from_fn(|_| parts.next());
        if parts.next().is_some() {
            let expected = "a corner of at most 3 parts, `v/vt/vn`";
            return Err(self.statements.lexer.fault(word, expected));
        }
        let present = |part: Option<Token<'a>>| part.filter(|part| !part.text.is_empty());
        let vertex = self.index_at(
            present(vertex).unwrap_or(word),
            self.positions.len(),
            "vertices",
        )?;
        let texcoord = present(texcoord)
            .map(|part| self.index_at(part, self.texcoords.value_count(), self.texcoords.many()))
            .transpose()?;
        let normal = present(normal)
            .map(|part| self.index_at(part, self.normals.value_count(), self.normals.many()))
            .transpose()?;
        self.texcoords.note(vertex, texcoord, word);
        self.normals.note(vertex, normal, word);
        Ok(vertex)
    }

    /// The index from 0 that `part` stands for, where `count` things are above it.
    fn index_at(&self, part: Token<'a>, count: usize, many: &str) -> Result<u32, FileFault> {
        let index = part.text.parse().ok().and_then(|told: isize| {
            if told < 0 {
                count.checked_add_signed(told)
            } else {
                told.unsigned_abs().checked_sub(1)
            }
        });
        index
            .filter(|&index| index < count)
            .and_then(|index| u32::try_from(index).ok())
            .ok_or_else(|| {
                let expected = format!("one of the {count} {many} above, counted from 1");
                self.statements.lexer.fault(part, expected)
            })
    }
}

/// What a file for many purposes may well hold and a skinned mesh has no use for. Not here: curved surfaces and what calls other
/// files, for without them something of the model is missing.
fn is_read_over(keyword: &str) -> bool {
    const NAMES_AND_GROUPS: &[&str] = &["o", "g", "s", "mg"];
    const MATERIALS: &[&str] = &["mtllib", "usemtl", "maplib", "usemap"];
    const POINTS_AND_LINES: &[&str] = &["p", "l", "vp"];
    const DISPLAY: &[&str] = &[
        "bevel",
        "c_interp",
        "d_interp",
        "lod",
        "shadow_obj",
        "trace_obj",
    ];
    [NAMES_AND_GROUPS, MATERIALS, POINTS_AND_LINES, DISPLAY]
        .iter()
        .any(|keywords| keywords.contains(&keyword))
}
