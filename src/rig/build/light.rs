//! Lights of the file: what drawing relies on, checked again.

use super::{finite, is_usable};
use crate::rig::{FileLight, FileLightKind, RigProblem, names};
use std::f64::consts::FRAC_PI_2;

pub(super) fn build(
    drafts: Vec<FileLight>,
    joint_count: usize,
) -> Result<Vec<FileLight>, RigProblem> {
    let unique_names = names::unique("light", drafts.iter().map(|light| light.name.as_str()));
    let mut lights = Vec::with_capacity(drafts.len());
    for (index, (light, name)) in drafts.into_iter().zip(unique_names).enumerate() {
        if let Some(found) = light.joint.filter(|&joint| joint >= joint_count) {
            return Err(RigProblem::OutOfRange {
                what: format!("light {index}"),
                target: "joint",
                found,
                count: joint_count,
            });
        }
        let is_cone = match light.kind {
            FileLightKind::Directional | FileLightKind::Point => true,
            FileLightKind::Spot { inner, outer } => {
                0.0 <= inner && inner < outer && outer <= FRAC_PI_2
            }
        };
        let is_color = light
            .color
            .to_array()
            .iter()
            .all(|it| (0.0..=1.0).contains(it));
        let is_bright = (0.0..=FileLight::MOST_INTENSITY).contains(&light.intensity);
        let stands = is_usable(&light.joint_from_light.to_cols_array());
        finite(stands, || format!("the transform of light `{name}`"))?;
        if !(is_cone && is_color && is_bright) {
            return Err(RigProblem::LightOutOfRange { light: name });
        }
        lights.push(FileLight { name, ..light });
    }
    Ok(lights)
}
