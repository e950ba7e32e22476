//! From the files of a rig to its draft: each one read, and their contributions put together.
//! Never lives here: any file's grammar, and which files a rig is made of.

use super::context::Context;
use super::contribution::{KnownMesh, KnownSkeleton, LooseClip, MeshPart};
use super::error::LoadError;
use super::files::Gathered;
use super::names::stem;
use super::parts::{Part, Parts};
use super::reader::{MeshReader, MorphReader, WeightsReader};
use crate::rig::{
    Axis, BindingDraft, ChannelDraft, ChannelTarget, DofKind, Draft, JointDraft, Warnings,
};
use std::sync::Arc;

/// Meshes, morph targets and clips stand in the draft as their files stand in `parts`. Warnings are left in `context`.
///
/// # Errors
/// The first fault in a file, or the first ceiling that one exceeds.
pub(super) fn assemble(parts: &Parts, context: &mut Context) -> Result<Draft, LoadError> {
    let mut assembly = Assembly {
        parts,
        draft: Draft::default(),
    };
    if let Some(whole) = &parts.whole {
        assembly.draft = (whole.read)(&whole.file, context)?;
        assembly.draft.file = Some(name_of(&whole.file));
    }
    if let Some(skeleton) = &parts.skeleton {
        assembly.draft.joints = (skeleton.read)(&skeleton.file, context)?;
        assembly.draft.file = Some(name_of(&skeleton.file));
    }
    for mesh in &parts.meshes {
        assembly.add_mesh(mesh, context)?;
    }
    if let Some(weights) = &parts.weights {
        assembly.add_weights(weights, context)?;
    }
    for morph in &parts.morphs {
        assembly.add_morph(morph, context)?;
    }
    for clip in &parts.clips {
        let read = (clip.read)(&clip.file, context)?;
        assembly.add_clip(&clip.file, read, &mut context.warnings);
    }
    Ok(assembly.draft)
}

struct Assembly<'a> {
    parts: &'a Parts,
    draft: Draft,
}

impl Assembly<'_> {
    fn skeleton(&self) -> Option<KnownSkeleton<'_>> {
        let skeleton = self.parts.skeleton.as_ref()?;
        Some(KnownSkeleton {
            file: &skeleton.file.name,
            joints: &self.draft.joints,
        })
    }

    fn mesh(&self, index: usize) -> KnownMesh<'_> {
        KnownMesh {
            file: &self.parts.meshes[index].file.name,
            vertex_count: self.draft.meshes[index].positions.len(),
        }
    }

    fn add_mesh(
        &mut self,
        part: &Part<MeshReader>,
        context: &mut Context,
    ) -> Result<(), LoadError> {
        let MeshPart {
            mut mesh,
            materials,
            bindings,
        } = match part.read {
            MeshReader::Bound(read) => read(&part.file, context, self.skeleton())?,
            MeshReader::Unbound(read) => read(&part.file, context)?,
        };
        let file = name_of(&part.file);
        let first_material = self.draft.materials.len();
        for material in mesh.parts.iter_mut().filter_map(|it| it.material.as_mut()) {
            *material += first_material;
        }
        self.draft.materials.extend(materials);
        let bindings = bindings.into_iter().map(|binding| BindingDraft {
            file: Some(file.clone()),
            ..binding
        });
        self.add_bindings(bindings.collect(), &mut mesh.influences);
        mesh.file = Some(file);
        self.draft.meshes.push(mesh);
        Ok(())
    }

    fn add_weights(
        &mut self,
        part: &Part<WeightsReader>,
        context: &mut Context,
    ) -> Result<(), LoadError> {
        let index = self.parts.mesh_of_weights(part)?;
        let skeleton = KnownSkeleton {
            file: &self.parts.skeleton_of_weights(part)?.name,
            joints: &self.draft.joints,
        };
        let mut weights = (part.read.read)(&part.file, context, self.mesh(index), skeleton)?;
        // Their bind pose is that of the skeleton's file.
        self.add_bindings(weights.bindings, &mut weights.influences);
        let mesh = &mut self.draft.meshes[index];
        mesh.influence_counts = weights.influence_counts;
        mesh.influences = weights.influences;
        Ok(())
    }

    /// Adds bindings to the draft, and renumbers influences that were indices into `bindings`.
    fn add_bindings(&mut self, bindings: Vec<BindingDraft>, influences: &mut [(u32, f64)]) {
        // Four thousand million of them would not fit any file.
        let first = self.draft.bindings.len() as u32;
        self.draft.bindings.extend(bindings);
        for (binding, _) in influences {
            *binding += first;
        }
    }

    fn add_morph(
        &mut self,
        part: &Part<MorphReader>,
        context: &mut Context,
    ) -> Result<(), LoadError> {
        let index = self.parts.mesh_of_morph(part)?;
        let mut morph = (part.read.read)(&part.file, context, self.mesh(index))?;
        morph.file = Some(name_of(&part.file));
        morph.name = stem(&part.file.name).to_owned();
        morph.mesh = index;
        self.draft.morphs.push(morph);
        Ok(())
    }

    fn add_clip(&mut self, file: &Gathered, loose: LooseClip, warnings: &mut Warnings) {
        let LooseClip {
            mut clip,
            channels_counted_at,
        } = loose;
        if let (Some(place), Some(skeleton)) = (channels_counted_at, self.skeleton()) {
            let (found, wanted) = (clip.channels.len(), dof_count(skeleton.joints));
            clip.channels
                .retain(|channel| moves(channel, skeleton.joints));
            if found != wanted {
                let skeleton = skeleton.file;
                warnings.push(|| {
                    format!(
                        "{place}: there are {found} channels, but `{skeleton}` takes {wanted}; those that fit are used"
                    )
                });
            }
        }
        clip.file = Some(name_of(file));
        clip.name = stem(&file.name).to_owned();
        self.draft.clips.push(clip);
    }
}

fn name_of(file: &Gathered) -> Arc<str> {
    file.name.as_str().into()
}

/// How many DOFs the joints of a skeleton have that a clip can set.
fn dof_count(joints: &[JointDraft]) -> usize {
    let of_joint = |joint: &JointDraft| {
        let vectors = 1 + usize::from(joint.translates) + usize::from(joint.scales);
        vectors * Axis::ALL.len()
    };
    joints.iter().map(of_joint).sum()
}

/// Whether a skeleton has what a channel sets.
fn moves(channel: &ChannelDraft, joints: &[JointDraft]) -> bool {
    match channel {
        ChannelDraft::Dof { target, .. } => match target {
            ChannelTarget::Dof(DofKind::Translation { joint, .. }) => {
                joints.get(*joint).is_some_and(|joint| joint.translates)
            }
            ChannelTarget::Dof(DofKind::Scale { joint, .. }) => {
                joints.get(*joint).is_some_and(|joint| joint.scales)
            }
            ChannelTarget::Dof(DofKind::Rotation { joint, .. }) => *joint < joints.len(),
            // Left to the rig, which knows their names.
            ChannelTarget::Dof(DofKind::Morph { .. }) | ChannelTarget::Named(_) => true,
        },
        ChannelDraft::Rotation { joint, .. } => *joint < joints.len(),
    }
}
