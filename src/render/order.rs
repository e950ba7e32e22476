//! In which order surfaces that blend are drawn. Never lives here: what is drawn of them.

use super::Plan;
use crate::rig::Opacity;
use crate::scene::Camera;
use glam::DVec3;

/// A part of a mesh of an instance of a plan, each by its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct PartPlace {
    pub instance: usize,
    pub mesh: usize,
    pub part: usize,
}

/// Those that are laid over what is behind them one after another, farthest first: of an opaque skin the parts whose material blends, by the
/// distance of their middle from the eye, where that is the same in their own order.
pub(super) fn blending_parts(plan: &Plan, into: &mut Vec<(f64, PartPlace)>) {
    into.clear();
    let Some(image) = &plan.image else {
        return;
    };
    let opaque = plan.drawn().filter(|(_, it)| !it.is_translucent());
    for (instance, of_plan) in opaque {
        let rig = of_plan.rig();
        for (mesh, of_rig) in rig.meshes().iter().enumerate() {
            for (part, of_mesh) in of_rig.parts().iter().enumerate() {
                let material = rig.material_of(of_mesh, of_plan.appearance().surface.variant);
                if material.is_some_and(|material| material.opacity == Opacity::Blend) {
                    let center_in_model = of_plan.skin().center_of(of_mesh);
                    let center = of_plan.world_from_model().transform_point3(center_in_model);
                    let distance = distance(&image.scene.camera, center);
                    into.push((
                        distance,
                        PartPlace {
                            instance,
                            mesh,
                            part,
                        },
                    ));
                }
            }
        }
    }
    // By place where it is the same, rather than stably: that would ask for memory, each time.
    into.sort_unstable_by(|(one, place), (other, other_place)| {
        other.total_cmp(one).then_with(|| place.cmp(other_place))
    });
}

/// What grows with the distance from the eye, which may be infinitely far.
fn distance(camera: &Camera, position_in_world: DVec3) -> f64 {
    let eye = camera.eye();
    if eye.w == 0.0 {
        -eye.truncate().dot(position_in_world)
    } else {
        (eye.truncate() / eye.w).distance_squared(position_in_world)
    }
}
