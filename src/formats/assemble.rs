//! From the files of a rig to its draft: each one read, and what they say brought together.
//! Never lives here: any file's grammar, and which files a rig is made of.

use super::cse169::anim::{self, Moves};
use super::cse169::morph::{self, Changes};
use super::cse169::skel;
use super::cse169::skin::{self, BoundTo, SkinMaterial};
use super::error::LoadError;
use super::files::{Files, Gathered};
use super::gltf;
use super::lexer::Lexer;
use super::materials::MaterialLookup;
use super::mit;
use super::mit::attach::AttachedTo;
use super::parts::Parts;
use super::recognise::{Kind, stem};
use super::textures::Textures;
use crate::limits::Limits;
use crate::rig::{
    BindPose, BindingDraft, Draft, Material, MeshDraft, PartDraft, TexturePlace, Warnings,
};

/// Meshes, morph targets and clips stand in the draft as their files stand in `parts`.
///
/// # Errors
/// The first fault in a file, or the first ceiling that one exceeds.
pub(super) fn assemble(
    parts: &Parts,
    files: &mut Files,
    limits: &Limits,
    warnings: Warnings,
) -> Result<Draft, LoadError> {
    if let Some(document) = &parts.document {
        return gltf::read(document, files, limits, warnings);
    }
    let draft = Draft {
        warnings,
        ..Draft::default()
    };
    let mut assembly = Assembly {
        parts,
        files,
        limits,
        textures: Textures::new(limits),
        draft,
    };
    assembly.read_skeleton()?;
    for file in &parts.meshes {
        match file.kind {
            Kind::Obj => assembly.add_obj(file)?,
            _ => assembly.add_skin(file)?,
        }
    }
    for file in &parts.morphs {
        assembly.add_morph(file)?;
    }
    for file in &parts.clips {
        assembly.add_clip(file)?;
    }
    Ok(assembly.draft)
}

struct Assembly<'a, 'f> {
    parts: &'a Parts,
    files: &'a mut Files<'f>,
    limits: &'a Limits,
    textures: Textures<'a>,
    draft: Draft,
}

impl Assembly<'_, '_> {
    fn read_skeleton(&mut self) -> Result<(), LoadError> {
        if let Some(file) = &self.parts.skeleton {
            let warnings = &mut self.draft.warnings;
            let text = file.uncommented(warnings)?;
            let lexer = Lexer::new(&file.name, &text);
            self.draft.joints = match file.kind {
                Kind::MitSkel => mit::skel::read(lexer, self.limits, warnings)?,
                _ => skel::read(lexer, self.limits, warnings)?,
            };
        }
        Ok(())
    }

    /// Adds a skin as a mesh of its own, bound joint by joint where there is a skeleton.
    fn add_skin(&mut self, file: &Gathered) -> Result<(), LoadError> {
        let bound_to = self.parts.skeleton.as_ref().map(|skeleton| BoundTo {
            file: &skeleton.name,
            joint_count: self.draft.joints.len(),
        });
        let warnings = &mut self.draft.warnings;
        let text = file.uncommented(warnings)?;
        let lexer = Lexer::new(&file.name, &text);
        let skin = skin::read(lexer, bound_to, self.limits, warnings)?;
        let material = skin
            .material
            .map(|material| self.add_material(file, material));
        let part = PartDraft {
            triangle_count: skin.mesh.triangles.len(),
            material,
            is_flat: false,
        };
        let mut mesh = MeshDraft {
            parts: vec![part],
            ..skin.mesh
        };
        if self.draft.joints.is_empty() {
            // Nothing to be bound to: it stays as it was modelled.
            mesh.influence_counts.clear();
            mesh.influences.clear();
        } else {
            let bindings = skin.bindings.into_iter().enumerate();
            let bindings = bindings.map(|(joint, bind_from_joint)| BindingDraft {
                joint: Some(joint),
                stood: BindPose::BindFromJoint(bind_from_joint),
            });
            self.add_bindings(bindings.collect(), &mut mesh);
        }
        self.draft.meshes.push(mesh);
        Ok(())
    }

    /// Returns its index.
    fn add_material(&mut self, file: &Gathered, material: SkinMaterial) -> usize {
        let warnings = &mut self.draft.warnings;
        let texture = material.texture.and_then(|name| {
            let mention = (name.file.as_str(), name.place.as_str());
            self.textures.look_up(self.files, file, mention, warnings)
        });
        self.draft.materials.push(Material {
            texture: texture.map(TexturePlace::plain),
            ..Material::named(material.name)
        });
        self.draft.materials.len() - 1
    }

    /// Gives a mesh, whose influences name joints, bindings of its own.
    fn add_bindings(&mut self, bindings: Vec<BindingDraft>, mesh: &mut MeshDraft) {
        // Four thousand million of them would not fit any file.
        let first = self.draft.bindings.len() as u32;
        self.draft.bindings.extend(bindings);
        for (binding, _) in &mut mesh.influences {
            *binding += first;
        }
    }

    fn add_obj(&mut self, file: &Gathered) -> Result<(), LoadError> {
        let warnings = &mut self.draft.warnings;
        let text = file.text(warnings)?;
        let obj = mit::obj::read(&file.name, &text, self.limits, warnings)?;
        let mut lookup = MaterialLookup {
            files: self.files,
            textures: &mut self.textures,
            materials: &mut self.draft.materials,
            warnings,
        };
        let mut mesh = lookup.resolve(file, obj);
        if let (Some(attachments), Some(skeleton)) = (&self.parts.attachments, &self.parts.skeleton)
        {
            let to = AttachedTo {
                mesh_file: &file.name,
                vertex_count: mesh.positions.len(),
                skeleton_file: &skeleton.name,
                joint_count: self.draft.joints.len(),
            };
            let text = attachments.uncommented(warnings)?;
            let lexer = Lexer::new(&attachments.name, &text);
            let read = mit::attach::read(lexer, to, self.limits)?;
            mesh.influence_counts = read.influence_counts;
            mesh.influences = read.influences;
            self.add_bindings(mit::bindings(&self.draft.joints), &mut mesh);
        }
        self.draft.meshes.push(mesh);
        Ok(())
    }

    fn add_morph(&mut self, file: &Gathered) -> Result<(), LoadError> {
        // There is one skin wherever there is a morph target.
        let is_skin = |file: &&std::sync::Arc<Gathered>| file.kind == Kind::Cse169Skin;
        let mut meshes = self.parts.meshes.iter().zip(&self.draft.meshes).enumerate();
        let Some((mesh, (skin, draft))) = meshes.find(|(_, (file, _))| is_skin(file)) else {
            return Ok(());
        };
        let changes = Changes {
            file: &skin.name,
            mesh,
            vertex_count: draft.positions.len(),
        };
        let warnings = &mut self.draft.warnings;
        let text = file.uncommented(warnings)?;
        let lexer = Lexer::new(&file.name, &text);
        let mut morph = morph::read(lexer, changes, self.limits, warnings)?;
        morph.name = stem(&file.name).to_owned();
        self.draft.morphs.push(morph);
        Ok(())
    }

    fn add_clip(&mut self, file: &Gathered) -> Result<(), LoadError> {
        let Some(skeleton) = &self.parts.skeleton else {
            return Ok(());
        };
        let moves = Moves {
            file: &skeleton.name,
            joints: &self.draft.joints,
        };
        let warnings = &mut self.draft.warnings;
        let text = file.uncommented(warnings)?;
        let lexer = Lexer::new(&file.name, &text);
        let mut clip = anim::read(lexer, moves, self.limits, warnings)?;
        clip.name = stem(&file.name).to_owned();
        self.draft.clips.push(clip);
        Ok(())
    }
}
