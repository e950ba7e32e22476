//! From rigs and values of ours to their descriptions on the wire, for several families of methods.

use crate::engine::{EngineError, Extents, LoadedRig, RigRef};
use crate::formats::{self, FileRef, Source};
use crate::limits::Limits;
use crate::pose::Clamped;
use crate::protocol::pose as wire_pose;
use crate::protocol::rig as wire;
use crate::rig::{
    Channel, Clip, Dof, DofKind, FileLight, FileLightKind, Joint, Limit, Material, Mesh, Morph,
    Opacity, Part, Rig, RotationOrder,
};
use crate::scene::Bounds;
use glam::DMat4;

/// What `rig.describe` would answer for these files, without keeping them and without a renderer.
///
/// # Errors
/// As loading has them.
pub fn describe_files(
    files: &[FileRef],
    source: &Source,
    limits: &Limits,
) -> Result<wire::RigDescription, EngineError> {
    let loaded = formats::load(files, source, limits)?;
    Ok(description(&RigRef::at_rest(LoadedRig::new(loaded, None)?)))
}

pub(super) fn summary(loaded: &LoadedRig) -> wire::RigSummary {
    let rig = &loaded.rig;
    wire::RigSummary {
        name: loaded.name.to_string(),
        digest: loaded.digest.clone(),
        dialects: loaded
            .dialects
            .iter()
            .map(|&dialect| dialect.to_owned())
            .collect(),
        joint_count: rig.skeleton().joints().len() as u64,
        dof_count: rig.dofs().all().len() as u64,
        vertex_count: rig.vertex_count() as u64,
        triangle_count: rig.triangle_count() as u64,
        morph_count: rig.morphs().len() as u64,
        clip_count: rig.clips().len() as u64,
        warnings: rig.warnings().to_vec(),
    }
}

/// What `rig.describe` answers.
pub fn description(found: &RigRef) -> wire::RigDescription {
    let rig = &*found.loaded.rig;
    let joints = rig.skeleton().joints();
    let values = found.stored.dof_values();
    wire::RigDescription {
        summary: summary(&found.loaded),
        joints: joints
            .iter()
            .map(|described| joint(described, joints))
            .collect(),
        dofs: rig
            .dofs()
            .all()
            .iter()
            .zip(values)
            .map(|(described, value)| dof(described, joints, value))
            .collect(),
        meshes: rig.meshes().iter().map(|it| mesh(it, rig)).collect(),
        materials: rig.materials().iter().map(material).collect(),
        variants: rig.variants().to_vec(),
        lights: rig
            .lights()
            .iter()
            .map(|described| light(described, joints))
            .collect(),
        morphs: rig.morphs().iter().map(|it| morph(it, rig)).collect(),
        clips: rig.clips().iter().map(clip).collect(),
        bounds: rig_bounds(&found.loaded.extents),
        joint_bounds: found.loaded.extents.joints().as_ref().map(bounds),
    }
}

fn mesh(mesh: &Mesh, rig: &Rig) -> wire::MeshDescription {
    wire::MeshDescription {
        name: mesh.name().to_owned(),
        vertex_count: mesh.vertex_count() as u64,
        triangle_count: mesh.triangles().len() as u64,
        material: material_name(rig, mesh.parts()[0].material),
        parts: parts(rig, mesh),
        has_texcoords: mesh.texcoords().is_some(),
    }
}

fn material(material: &Material) -> wire::MaterialDescription {
    let texture = material.texture.as_ref();
    wire::MaterialDescription {
        name: material.name.clone(),
        texture: texture.map(|place| place.texture.file().to_owned()),
        color: material.color.map(|color| color.as_dvec4().to_array()),
        opacity: match material.opacity {
            Opacity::Opaque => wire::Opacity::Opaque,
            Opacity::Mask(_) => wire::Opacity::Mask,
            Opacity::Blend => wire::Opacity::Blend,
        },
        single_sided: material.is_single_sided,
        unlit: material.is_unlit,
    }
}

fn morph(morph: &Morph, rig: &Rig) -> wire::MorphDescription {
    wire::MorphDescription {
        name: morph.name.clone(),
        mesh: rig.meshes()[morph.mesh].name().to_owned(),
        vertex_count: morph.vertex_count as u64,
    }
}

fn clip(clip: &Clip) -> wire::ClipDescription {
    wire::ClipDescription {
        name: clip.name.clone(),
        range: clip.range,
        channel_count: clip.channels.iter().map(dofs_set).sum(),
    }
}

fn dofs_set(channel: &Channel) -> u64 {
    match channel {
        Channel::Dof { .. } => 1,
        Channel::Rotation { .. } => 3,
    }
}

pub(super) fn parts(rig: &Rig, mesh: &Mesh) -> Vec<wire::MeshPart> {
    let part = |part: &Part| wire::MeshPart {
        triangle_count: part.triangles.len() as u64,
        material: material_name(rig, part.material),
    };
    mesh.parts().iter().map(part).collect()
}

pub(super) fn material_name(rig: &Rig, material: Option<usize>) -> Option<String> {
    material.map(|index| rig.materials()[index].name.clone())
}

fn rig_bounds(extents: &Extents) -> wire::RigBounds {
    let of = match extents.skin() {
        Some(_) => wire::BoundsOf::Vertices,
        None => wire::BoundsOf::Joints,
    };
    wire::RigBounds {
        of,
        bounds: bounds(&extents.bounds()),
    }
}

pub(super) fn bounds(bounds: &Bounds) -> wire::Bounds {
    wire::Bounds {
        min: bounds.min.to_array(),
        max: bounds.max.to_array(),
    }
}

pub(super) fn clamped(rig: &Rig, clamped: &[Clamped]) -> Vec<wire_pose::Clamped> {
    clamped
        .iter()
        .map(|&Clamped { dof, asked, used }| wire_pose::Clamped {
            dof: rig.dofs().all()[dof].name.clone(),
            asked,
            used,
        })
        .collect()
}

pub(super) fn parent_name(joint: &Joint, joints: &[Joint]) -> Option<String> {
    joint.parent.map(|parent| joints[parent].name.clone())
}

fn joint(joint: &Joint, joints: &[Joint]) -> wire::JointDescription {
    wire::JointDescription {
        name: joint.name.clone(),
        parent: parent_name(joint, joints),
        offset: joint.offset.to_array(),
        rotation_order: match joint.rotation_order {
            RotationOrder::Zyx => wire::RotationOrder::Zyx,
            RotationOrder::Xyz => wire::RotationOrder::Xyz,
        },
        bounding_box: joint
            .bounding_box
            .map(|[min, max]| bounds(&Bounds { min, max })),
    }
}

fn light(light: &FileLight, joints: &[Joint]) -> wire::LightDescription {
    let (kind, cone) = match light.kind {
        FileLightKind::Directional => (wire::LightKind::Directional, None),
        FileLightKind::Point => (wire::LightKind::Point, None),
        FileLightKind::Spot { inner, outer } => (wire::LightKind::Spot, Some([inner, outer])),
    };
    wire::LightDescription {
        name: light.name.clone(),
        kind,
        joint: light.joint.map(|joint| joints[joint].name.clone()),
        joint_from_light: DMat4::from(light.joint_from_light).to_cols_array(),
        color: light.color.as_dvec3().to_array(),
        intensity: light.intensity,
        cone,
    }
}

fn dof(dof: &Dof, joints: &[Joint], value: f64) -> wire::DofDescription {
    let Limit { min, max } = dof.limit;
    wire::DofDescription {
        name: dof.name.clone(),
        kind: match dof.kind {
            DofKind::Translation { .. } => wire::DofKind::Translation,
            DofKind::Rotation { .. } => wire::DofKind::Rotation,
            DofKind::Scale { .. } => wire::DofKind::Scale,
            DofKind::Morph { .. } => wire::DofKind::Morph,
        },
        joint: dof.kind.joint().map(|joint| joints[joint].name.clone()),
        min: Some(min).filter(|min| min.is_finite()),
        max: Some(max).filter(|max| max.is_finite()),
        rest: dof.rest,
        value,
    }
}
