//! Reads a CSE 169 `.skin`: one mesh, what it is bound to, and at most one material.
//! Never lives here: opening the texture, and bringing weights to a sum of 1.
//!
//! ```text
//! skin    := section*                                                             each at most once, in any order
//! section := "positions" N "{" (x y z){N} "}"                                     N > 0
//!          | "normals" N "{" (x y z){N} "}" | "texcoords" N "{" (u v){N} "}"
//!          | "skinweights" N ["{"] (k (joint weight){k}){N} "}"
//!          | "triangles" M "{" (v v v){M} "}"
//!          | "bindings" J ["{"] ("matrix" "{" a a a b b b c c c d d d "}"){J} "}"
//!          | "material" [NAME] "{" ["texture" FILE] "}"
//! ```
//! Vertices and joints are counted from 0. `positions` and `triangles` must be there; `skinweights` and `bindings` stand together,
//! and must be there where the mesh is read with a skeleton. The four rows of a matrix are its columns a, b, c and d: it takes
//! points from the joint's space to the space of the bind pose.

mod rows;
#[cfg(test)]
mod tests;

use super::common::{name_and_brace, second};
use super::keywords::{Keywords, PassedOver};
use super::sections::{Brace, Section};
use crate::formats::contribution::{KnownSkeleton, MeshPart};
use crate::formats::error::{FileFault, LoadError};
use crate::formats::text::lexer::{Lexer, Token};
use crate::formats::text::mention::Mention;
use crate::limits::Limits;
use crate::rig::{
    BindPose, BindingDraft, Material, MeshDraft, PartDraft, Texture, TexturePlace, Warnings,
};
use glam::DAffine3;
use std::sync::Arc;

const SECTION: Keywords = Keywords(&[
    "positions",
    "normals",
    "texcoords",
    "skinweights",
    "triangles",
    "bindings",
    "material",
]);
const IN_MATERIAL: Keywords = Keywords(&["texture"]);

/// A skin as its file has it; every index in it is in range.
#[derive(Debug, Default)]
pub(super) struct Skin {
    /// Its influences name `bindings`; no weight is negative.
    pub mesh: MeshDraft,
    /// `bind_from_joint` of every joint.
    pub bindings: Vec<DAffine3>,
    pub material: Option<SkinMaterial>,
}

impl Skin {
    /// `texture` looks up the texture of its material.
    pub(super) fn into_part(
        self,
        is_bound: bool,
        texture: impl FnOnce(&Mention) -> Option<Arc<Texture>>,
    ) -> MeshPart {
        let material = self.material.map(|material| Material {
            texture: (material.texture.as_ref())
                .and_then(texture)
                .map(TexturePlace::plain),
            ..Material::named(material.name)
        });
        let part = PartDraft {
            triangle_count: self.mesh.triangles.len(),
            material: material.as_ref().map(|_| 0),
            is_flat: false,
        };
        let mut mesh = MeshDraft {
            parts: vec![part],
            ..self.mesh
        };
        let mut bindings = Vec::new();
        if is_bound {
            let of_joints = self.bindings.into_iter().enumerate();
            bindings.extend(of_joints.map(|(joint, bind_from_joint)| BindingDraft {
                file: None,
                joint: Some(joint),
                bind_pose: BindPose::BindFromJoint(bind_from_joint),
            }));
        } else {
            // Without a skeleton the mesh stays as it was modelled.
            mesh.influence_counts.clear();
            mesh.influences.clear();
        }
        MeshPart {
            mesh,
            materials: material.into_iter().collect(),
            bindings,
        }
    }
}

/// Whether a word, in lower case, starts a section.
pub(super) fn is_keyword(word: &[u8]) -> bool {
    SECTION.0.iter().any(|keyword| keyword.as_bytes() == word)
}

#[derive(Debug)]
pub(super) struct SkinMaterial {
    pub name: String,
    /// Its file.
    pub texture: Option<Mention>,
}

/// # Errors
/// [`LoadError::Invalid`] at the word that does not fit, [`LoadError::Limit`] where the file claims more than a ceiling allows.
pub(super) fn read(
    lexer: Lexer,
    skeleton: Option<KnownSkeleton>,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Skin, LoadError> {
    let mut reader = Reader {
        lexer,
        limits,
        warnings,
        skin: Skin::default(),
        sections: [None; Part::ALL.len()],
        first_word: None,
        passed_over: PassedOver::default(),
    };
    reader.read_sections()?;
    reader.leave_out_empty();
    reader.check_presence(skeleton.is_some())?;
    reader.check_counts(skeleton)?;
    reader.check_triangles()?;
    reader.check_influences()?;
    Ok(reader.skin)
}

struct Reader<'a, 'w> {
    lexer: Lexer<'a>,
    limits: &'w Limits,
    warnings: &'w mut Warnings,
    skin: Skin,
    /// By [`Part`].
    sections: [Option<Section<'a>>; Part::ALL.len()],
    first_word: Option<Token<'a>>,
    passed_over: PassedOver<'a>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Positions,
    Normals,
    Texcoords,
    Skinweights,
    Triangles,
    Bindings,
}

impl Part {
    const ALL: [Self; 6] = [
        Self::Positions,
        Self::Normals,
        Self::Texcoords,
        Self::Skinweights,
        Self::Triangles,
        Self::Bindings,
    ];

    fn keyword(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Normals => "normals",
            Self::Texcoords => "texcoords",
            Self::Skinweights => "skinweights",
            Self::Triangles => "triangles",
            Self::Bindings => "bindings",
        }
    }

    fn of(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.keyword() == word)
    }

    fn nouns(self) -> (&'static str, &'static str) {
        match self {
            Self::Positions => ("position", "positions"),
            Self::Normals => ("normal", "normals"),
            Self::Texcoords => ("texture coordinate", "texture coordinates"),
            Self::Skinweights => ("vertex", "vertices with weights"),
            Self::Triangles => ("triangle", "triangles"),
            Self::Bindings => ("binding", "bindings"),
        }
    }

    fn brace(self) -> Brace {
        match self {
            Self::Skinweights | Self::Bindings => Brace::Optional,
            _ => Brace::Needed,
        }
    }
}

impl<'a> Reader<'a, '_> {
    fn section(&self, part: Part) -> Option<Section<'a>> {
        self.sections[part as usize]
    }

    fn read_sections(&mut self) -> Result<(), LoadError> {
        loop {
            let word = SECTION.next(&mut self.lexer, self.warnings);
            self.first_word.get_or_insert(word);
            match (word.text, Part::of(word.text)) {
                ("", _) => return Ok(()),
                (_, Some(part)) => self.read_section(part, word)?,
                ("material", _) => self.read_material(word)?,
                _ => {
                    let near = SECTION.skip_unknown(&mut self.lexer, word, self.warnings)?;
                    self.passed_over.note(near, word);
                }
            }
        }
    }

    fn read_section(&mut self, part: Part, keyword: Token<'a>) -> Result<(), LoadError> {
        if self.section(part).is_some() {
            return Err(second(&self.lexer, keyword).into());
        }
        let limits = self.limits;
        let check_limit = |count| match part {
            Part::Triangles => limits.triangles(count),
            Part::Bindings => limits.joints(count),
            _ => limits.vertices(count),
        };
        let lexer = &mut self.lexer;
        let section = Section::open(lexer, keyword, part.nouns(), part.brace(), check_limit)?;
        self.sections[part as usize] = Some(section);
        let skin = &mut self.skin;
        match part {
            Part::Positions => skin.mesh.positions = rows::vectors(&section, lexer)?,
            Part::Normals => skin.mesh.normals = Some(rows::vectors(&section, lexer)?),
            Part::Texcoords => skin.mesh.texcoords = Some(rows::texcoords(&section, lexer)?),
            Part::Triangles => skin.mesh.triangles = rows::triangles(&section, lexer)?,
            Part::Bindings => skin.bindings = rows::bindings(&section, lexer)?,
            Part::Skinweights => {
                let influences = &mut skin.mesh.influences;
                skin.mesh.influence_counts = rows::weights(&section, lexer, influences, limits)?;
            }
        }
        Ok(())
    }

    fn read_material(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        if self.skin.material.is_some() {
            return Err(second(&self.lexer, keyword).into());
        }
        let name = name_and_brace(&mut self.lexer, keyword)?.to_owned();
        let mut texture = None;
        loop {
            let word = IN_MATERIAL.next(&mut self.lexer, self.warnings);
            match word.text {
                "}" => break,
                "texture" if texture.is_some() => return Err(second(&self.lexer, word).into()),
                "texture" => texture = Some(self.read_texture_name()?),
                "" => return Err(self.lexer.fault(word, "`}` to end the `material`").into()),
                _ => {
                    IN_MATERIAL.skip_unknown(&mut self.lexer, word, self.warnings)?;
                }
            }
        }
        self.skin.material = Some(SkinMaterial { name, texture });
        Ok(())
    }

    fn read_texture_name(&mut self) -> Result<Mention, FileFault> {
        let token = self.lexer.next_name();
        if matches!(token.text, "" | "{" | "}") {
            return Err(self.lexer.fault(token, "a file name after `texture`"));
        }
        Ok(Mention::new(token, &self.lexer))
    }

    /// Some exporters write a section of no rows for what a mesh does not have.
    fn leave_out_empty(&mut self) {
        for part in [Part::Normals, Part::Texcoords, Part::Skinweights] {
            self.leave_out_if_empty(part);
        }
        if self.section(Part::Skinweights).is_none() {
            self.leave_out_if_empty(Part::Bindings);
        }
        let mesh = &mut self.skin.mesh;
        mesh.normals.take_if(|normals| normals.is_empty());
        mesh.texcoords.take_if(|texcoords| texcoords.is_empty());
    }

    fn leave_out_if_empty(&mut self, part: Part) {
        let section = &mut self.sections[part as usize];
        if let Some(empty) = section.take_if(|section| section.count == 0) {
            self.passed_over
                .note(Some(part.keyword()), empty.count_token);
        }
    }

    fn check_presence(&self, has_skeleton: bool) -> Result<(), FileFault> {
        let has = |part| self.section(part).is_some();
        let end = self.lexer.peek();
        let nothing_known =
            self.sections.iter().all(Option::is_none) && self.skin.material.is_none();
        let otherwise = self.first_word.filter(|_| nothing_known).unwrap_or(end);
        let missing = |part: Part, reason: &str| {
            let keyword = part.keyword();
            let reported_at = self.passed_over.of(keyword).unwrap_or(otherwise);
            let expected = format!("`{keyword}`{reason}");
            Err(self.lexer.fault(reported_at, expected))
        };
        if !has(Part::Positions) {
            return missing(Part::Positions, "");
        }
        if !has(Part::Triangles) {
            return missing(Part::Triangles, "");
        }
        match (has(Part::Skinweights), has(Part::Bindings)) {
            (true, true) => Ok(()),
            (false, true) => missing(Part::Skinweights, ", as there are bindings"),
            (true, false) => missing(Part::Bindings, ", as there are skinweights"),
            (false, false) if has_skeleton => {
                missing(Part::Skinweights, ", as there is a skeleton")
            }
            (false, false) => Ok(()),
        }
    }

    fn check_counts(&self, skeleton: Option<KnownSkeleton>) -> Result<(), FileFault> {
        let positions = self.skin.mesh.positions.len();
        let differs = |section: &Section<'a>, expected: String| {
            Err(self.lexer.fault(section.count_token, expected))
        };
        if let Some(section) = self.section(Part::Positions).filter(|it| it.count == 0) {
            return differs(&section, "at least one position".to_owned());
        }
        for part in [Part::Normals, Part::Texcoords, Part::Skinweights] {
            if let Some(section) = self.section(part).filter(|it| it.count != positions) {
                let many = part.nouns().1;
                return differs(
                    &section,
                    format!("{positions} {many}, as many as positions"),
                );
            }
        }
        if let (Some(section), Some(skeleton)) = (self.section(Part::Bindings), skeleton)
            && section.count != skeleton.joints.len()
        {
            let (joints, file) = (skeleton.joints.len(), skeleton.file);
            return differs(
                &section,
                format!("{joints} bindings, one for each joint of `{file}`"),
            );
        }
        Ok(())
    }

    fn check_triangles(&self) -> Result<(), FileFault> {
        let vertex_count = self.skin.mesh.positions.len();
        let corners = self.skin.mesh.triangles.as_flattened();
        let bad = corners
            .iter()
            .position(|&vertex| vertex as usize >= vertex_count);
        match (bad, self.section(Part::Triangles)) {
            (Some(corner), Some(section)) => {
                let expected = format!("a vertex below {vertex_count}, the number of positions");
                Err(self
                    .lexer
                    .fault(section.word(&self.lexer, corner), expected))
            }
            _ => Ok(()),
        }
    }

    fn check_influences(&self) -> Result<(), FileFault> {
        let binding_count = self.skin.bindings.len();
        let mut influences = self.skin.mesh.influences.iter();
        let bad = influences.position(|&(binding, _)| binding as usize >= binding_count);
        let (Some(influence), Some(section)) = (bad, self.section(Part::Skinweights)) else {
            return Ok(());
        };
        // Before it stand two words of each influence and the count of each vertex, its own vertex included.
        let mut counts = 0;
        let mut influences_so_far = 0;
        while influences_so_far <= influence {
            influences_so_far += self.skin.mesh.influence_counts[counts] as usize;
            counts += 1;
        }
        let expected = match binding_count {
            0 => "no joint, as there are no bindings".to_owned(),
            _ => format!("a joint below {binding_count}, the number of bindings"),
        };
        let token = section.word(&self.lexer, 2 * influence + counts);
        Err(self.lexer.fault(token, expected))
    }
}
