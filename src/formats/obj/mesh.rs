//! Reads an OBJ: one mesh, whose vertices are the `v` lines in their order, for an `.attach` counts them.
//! Never lives here: what a material looks like, and which vertices are drawn besides the file's own.
//!
//! No crate: `tobj` renumbers vertices by first use, `obj-rs` panics at curves, `wavefront_obj` splits objects; none tells a column.
//!
//! ```text
//! obj    := (v | vt | vn | f | s | mtllib | usemtl | other)*     one v at least
//! v      := "v" x y z number{0,4}                                three of them or more are a color
//! vt     := "vt" u [v [w]]                                       w is read over
//! vn     := "vn" x y z
//! f      := ("f" | "fo") corner*
//! corner := vertex ["/" [texcoord] ["/" [normal]]]               counted from 1, or back from -1
//! s      := "s" (GROUP | "off")
//! mtllib := "mtllib" FILE+
//! usemtl := "usemtl" NAME
//! ```
//! Statements end with their line, and so do names. A corner names what stands above it.

#[cfg(test)]
mod tests;

use super::corner::{Above, Corner};
use super::draw_vertices::{CornerAttributes, DrawVertices, Normal};
use super::oddities::Oddities;
use super::polygon::{self, NotTriangulated, Triangulator};
use super::statements::{Statements, is_not_a_number};
use crate::formats::error::{FileFault, LoadError, quoted};
use crate::formats::text::lexer::Token;
use crate::formats::text::mention::{Mention, Mentions};
use crate::limits::Limits;
use crate::rig::{MeshDraft, PartDraft, Warnings, linear_from_srgb};
use glam::{Vec2, Vec3, Vec4};

/// An OBJ as its file has it.
#[derive(Debug)]
pub(super) struct Obj {
    /// Every index of it is in range; it has no name and no weights. Materials of its parts are indices into `materials`.
    pub mesh: MeshDraft,
    /// Files of materials, in the order of the file.
    pub libraries: Vec<Mention>,
    /// Names of materials that faces have.
    pub materials: Vec<Mention>,
}

/// # Errors
/// [`LoadError::Invalid`] at the word or line end that does not fit, [`LoadError::Limit`] at the first vertex or triangle too many.
pub(super) fn read(
    file: &str,
    text: &str,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Obj, LoadError> {
    let mut reader = Reader {
        statements: Statements::new(file, text),
        limits,
        positions: Vec::new(),
        colors: Vec::new(),
        normals: Vec::new(),
        texcoords: Vec::new(),
        draw_vertices: DrawVertices::default(),
        triangles: Vec::new(),
        parts: Vec::new(),
        material: None,
        smoothing: Smoothing::Unsaid,
        libraries: Mentions::default(),
        materials: Mentions::default(),
        triangulator: Triangulator::new(),
        face: Face::default(),
        oddities: Oddities::default(),
    };
    reader.read_statements()?;
    reader.finish(warnings)
}

struct Reader<'a> {
    statements: Statements<'a>,
    limits: &'a Limits,
    positions: Vec<Vec3>,
    /// Linear, one for each position up to the last that has one.
    colors: Vec<Vec4>,
    normals: Vec<Vec3>,
    texcoords: Vec<Vec2>,
    draw_vertices: DrawVertices,
    /// Of draw vertices as [`DrawVertices::of_corner`] gives them.
    triangles: Vec<[u32; 3]>,
    parts: Vec<PartDraft>,
    /// Of the faces that follow.
    material: Option<usize>,
    smoothing: Smoothing,
    libraries: Mentions,
    materials: Mentions,
    triangulator: Triangulator,
    face: Face,
    oddities: Oddities<'a>,
}

/// How faces are lit whose corners have no normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Smoothing {
    /// Smoothly: many programs write no `s` at all.
    Unsaid,
    Off,
    Group(u32),
}

/// The one that is being read; its memory is used again for the next one.
#[derive(Debug, Default)]
struct Face {
    corners: Vec<Corner>,
    positions: Vec<Vec3>,
    draw_vertices: Vec<u32>,
}

impl<'a> Reader<'a> {
    fn read_statements(&mut self) -> Result<(), LoadError> {
        loop {
            let keyword = self.statements.next();
            match keyword.text {
                "" => return Ok(()),
                "v" => self.read_position(keyword)?,
                "vn" => self.read_normal(keyword)?,
                "vt" => self.read_texcoord(keyword)?,
                "f" | "fo" => self.read_face(keyword)?,
                "s" => self.read_smoothing(keyword),
                "usemtl" => match self.read_name(keyword) {
                    Some(name) => {
                        self.material = Some(self.materials.add(name, &self.statements.lexer));
                    }
                    None => self.material = None,
                },
                "mtllib" => {
                    if let Some(name) = self.read_name(keyword) {
                        self.libraries.add(name, &self.statements.lexer);
                    }
                }
                text => {
                    if !is_read_over(text) {
                        self.oddities.unknown.get_or_insert(keyword);
                    }
                    self.statements.skip_rest();
                }
            }
        }
    }

    fn finish(mut self, warnings: &mut Warnings) -> Result<Obj, LoadError> {
        let lexer = &self.statements.lexer;
        let end = lexer.peek();
        if self.positions.is_empty() {
            // A file of another kind is at fault from its first unknown word on, not only at its end.
            return Err(lexer
                .fault(self.oddities.unknown.unwrap_or(end), "`v x y z`")
                .into());
        }
        self.oddities.warn(lexer, warnings);
        if let Some(glued) = self.statements.glued {
            warnings.push(|| {
                let (place, word) = (lexer.place(glued), quoted(glued.text));
                format!("{place}: {word} ends in a comment, and so do others like it")
            });
        }
        if self.triangles.is_empty() {
            warnings.push(|| format!("{}: there are no faces", lexer.place(end)));
        }
        let vertex_count = self.positions.len();
        let split = self.draw_vertices.finish(vertex_count, &mut self.triangles);
        let colors = (!self.colors.is_empty()).then(|| {
            let mut colors = self.colors;
            colors.resize(vertex_count, Vec4::ONE);
            let of_copies = split.copies.iter();
            let of_copies: Vec<_> = of_copies.map(|&vertex| colors[vertex as usize]).collect();
            colors.extend(of_copies);
            colors
        });
        Ok(Obj {
            mesh: MeshDraft {
                positions: self.positions,
                copies: split.copies,
                normals: split.normals,
                texcoords: split.texcoords,
                colors,
                triangles: self.triangles,
                parts: self.parts,
                ..MeshDraft::default()
            },
            libraries: self.libraries.into_inner(),
            materials: self.materials.into_inner(),
        })
    }

    fn read_position(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        /// Red, green, blue and opacity, or a `w` of a rational curve before the three.
        const SURPLUS: usize = 4;
        self.limits.vertices(self.positions.len() + 1)?;
        let mut position = Vec3::ZERO;
        for axis in 0..3 {
            let word = self.statements.next_value();
            position[axis] = self.number_at(word, keyword)?;
        }
        let mut surplus = [keyword; SURPLUS];
        let mut count = 0;
        let word = loop {
            let word = self.statements.next_value();
            if word.ends_line() || count == SURPLUS {
                break word;
            }
            surplus[count] = word;
            count += 1;
        };
        self.positions.push(position);
        match surplus[..count] {
            [r, g, b, ..] => {
                let [r, g, b] = [r, g, b].map(|word| self.channel_at(word, keyword));
                self.colors.resize(self.positions.len() - 1, Vec4::ONE);
                self.colors.push(Vec3::new(r?, g?, b?).extend(1.0));
            }
            ref others => {
                for &word in others {
                    self.loose_number_at(word, keyword)?;
                }
            }
        }
        Ok(self.check_line_end(word, "at most 7 numbers")?)
    }

    /// A channel of a color, linear. What is no number leaves the color as it is without it.
    fn channel_at(&mut self, word: Token<'a>, keyword: Token<'a>) -> Result<f32, FileFault> {
        let channel = self.loose_number_at(word, keyword)?.unwrap_or(1.0);
        if !(0.0..=1.0).contains(&channel) {
            self.oddities.color_out_of_range.get_or_insert(word);
        }
        Ok(linear_from_srgb(channel.clamp(0.0, 1.0).into()))
    }

    fn read_normal(&mut self, keyword: Token<'a>) -> Result<(), FileFault> {
        let mut normal = Vec3::ZERO;
        for axis in 0..3 {
            let word = self.statements.next_value();
            normal[axis] = self.loose_number_at(word, keyword)?.unwrap_or(0.0);
        }
        self.normals.push(normal);
        let word = self.statements.next_value();
        self.check_line_end(word, "`vn x y z`")
    }

    fn read_texcoord(&mut self, keyword: Token<'a>) -> Result<(), FileFault> {
        let word = self.statements.next_value();
        let mut texcoord = Vec2::new(self.loose_number_at(word, keyword)?.unwrap_or(0.0), 0.0);
        let mut word = self.statements.next_value();
        if !word.ends_line() {
            texcoord.y = self.loose_number_at(word, keyword)?.unwrap_or(0.0);
            word = self.statements.next_value();
        }
        if !word.ends_line() {
            self.loose_number_at(word, keyword)?;
            word = self.statements.next_value();
        }
        self.texcoords.push(texcoord);
        self.check_line_end(word, "`vt u v w`")
    }

    /// `None` of what programs print for a number that is none.
    fn loose_number_at(
        &mut self,
        word: Token<'a>,
        keyword: Token<'a>,
    ) -> Result<Option<f32>, FileFault> {
        if is_not_a_number(word) {
            self.oddities.not_a_number.get_or_insert(word);
            return Ok(None);
        }
        self.number_at(word, keyword).map(Some)
    }

    fn number_at(&self, word: Token<'a>, keyword: Token<'a>) -> Result<f32, FileFault> {
        let place = || format!("after `{}`", keyword.text);
        let number = self.statements.lexer.number_at(word, place)?;
        Ok(number as f32)
    }

    fn check_line_end(&self, word: Token<'a>, after: &str) -> Result<(), FileFault> {
        if word.ends_line() {
            return Ok(());
        }
        let expected = format!("the end of the line after {after}");
        Err(self.statements.lexer.fault(word, expected))
    }

    fn read_name(&mut self, keyword: Token<'a>) -> Option<Token<'a>> {
        let name = self.statements.rest();
        if name.is_none() {
            self.oddities.nameless.get_or_insert(keyword);
        }
        name
    }

    fn read_smoothing(&mut self, keyword: Token<'a>) {
        let word = self.statements.next_value();
        self.smoothing = match (word.text, word.text.parse()) {
            ("off", _) | (_, Ok(0)) => Smoothing::Off,
            ("on", _) => Smoothing::Group(1),
            (_, Ok(group)) => Smoothing::Group(group),
            (_, Err(_)) => {
                let what = if word.ends_line() { keyword } else { word };
                self.oddities.group.get_or_insert(what);
                Smoothing::Off
            }
        };
        if !word.ends_line() {
            self.statements.skip_rest();
        }
    }

    fn read_face(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        let mut face = std::mem::take(&mut self.face);
        face.corners.clear();
        let above = Above {
            vertices: self.positions.len(),
            texcoords: self.texcoords.len(),
            normals: self.normals.len(),
        };
        loop {
            let word = self.statements.next_value();
            if word.ends_line() {
                break;
            }
            let (lexer, oddities) = (&self.statements.lexer, &mut self.oddities);
            face.corners
                .push(Corner::read(word, above, lexer, oddities)?);
            // A triangle for each corner after the second.
            let triangles = self.triangles.len() + face.corners.len().saturating_sub(2);
            self.limits.triangles(triangles)?;
        }
        if face.corners.len() < 3 {
            self.oddities.too_few_corners.get_or_insert(keyword);
        } else {
            self.add_face(&mut face, keyword)?;
        }
        self.face = face;
        Ok(())
    }

    fn add_face(&mut self, face: &mut Face, keyword: Token<'a>) -> Result<(), LoadError> {
        let Face {
            corners,
            positions,
            draw_vertices,
        } = face;
        positions.clear();
        let position = |corner: &Corner| self.positions[corner.vertex as usize];
        positions.extend(corners.iter().map(position));
        let smooth = match self.smoothing {
            Smoothing::Unsaid | Smoothing::Off => Normal::Smooth,
            Smoothing::Group(group) => {
                let area_vector = polygon::area_vector(positions);
                for corner in corners.iter().filter(|corner| corner.normal.is_none()) {
                    self.draw_vertices
                        .add_to_group(corner.vertex, group, area_vector);
                }
                Normal::OfGroup(group)
            }
        };
        draw_vertices.clear();
        for corner in &*corners {
            let given = corner.normal.map(|index| self.normals[index]);
            let attributes = CornerAttributes {
                texcoord: corner.texcoord.map(|index| self.texcoords[index]),
                // One of no length says nothing.
                normal: match given.filter(|normal| *normal != Vec3::ZERO) {
                    Some(normal) => Normal::Given(normal),
                    None => smooth,
                },
            };
            let of_file = self.positions.len();
            let drawn = &mut self.draw_vertices;
            draw_vertices.push(drawn.of_corner(corner.vertex, attributes, of_file, self.limits)?);
        }
        let before = self.triangles.len();
        if let [a, b, c] = draw_vertices[..] {
            self.triangles.push([a, b, c]);
        } else {
            self.add_polygon(positions, draw_vertices, keyword);
        }
        let has_normals = corners.iter().any(|corner| corner.normal.is_some());
        let part = PartDraft {
            triangle_count: self.triangles.len() - before,
            material: self.material,
            is_flat: self.smoothing == Smoothing::Off && !has_normals,
        };
        match self.parts.last_mut() {
            Some(last) if (last.material, last.is_flat) == (part.material, part.is_flat) => {
                last.triangle_count += part.triangle_count;
            }
            _ => self.parts.push(part),
        }
        Ok(())
    }

    fn add_polygon(&mut self, positions: &[Vec3], draw_vertices: &[u32], keyword: Token<'a>) {
        let numbered = |triangle: [usize; 3]| triangle.map(|corner| draw_vertices[corner]);
        let reason = match self.triangulator.triangulate(positions) {
            Ok(triangles) => {
                self.triangles.extend(triangles.into_iter().map(numbered));
                return;
            }
            Err(reason) => reason,
        };
        let slot = match reason {
            NotTriangulated::CrossesItself => &mut self.oddities.crosses_itself,
            NotTriangulated::TooMuchWork => &mut self.oddities.too_much_work,
        };
        slot.get_or_insert(keyword);
        let fan = polygon::fan(positions.len());
        self.triangles.extend(fan.map(numbered));
    }
}

/// What a file for many purposes may well hold and a skinned mesh has no use for. Not here: curved surfaces, maps of materials' own and
/// what calls other files, for without them something of the model is missing.
fn is_read_over(keyword: &str) -> bool {
    const NAMES_AND_GROUPS: &[&str] = &["o", "g", "mg"];
    const POINTS_AND_LINES: &[&str] = &["p", "l", "vp"];
    const DISPLAY: &[&str] = &[
        "bevel",
        "c_interp",
        "d_interp",
        "lod",
        "shadow_obj",
        "trace_obj",
    ];
    [NAMES_AND_GROUPS, POINTS_AND_LINES, DISPLAY]
        .iter()
        .any(|keywords| keywords.contains(&keyword))
}
