//! A quaternion against the limits of three angles.

use crate::rig::{Limit, RotationOrder};
use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// Radians by which a quaternion may miss a limit and still be kept as it is: what float32 on the wire loses.
const LIMIT_TOLERANCE: f64 = 1e-6;

/// How a quaternion stands to the limits of its joint.
pub(super) enum Fit {
    /// One of its triples of angles is inside.
    Inside,
    /// None is; `used` is the one nearest to the limits, clamped.
    Clamped { asked: DVec3, used: DVec3 },
}

/// Tries both triples of angles that make `quaternion`, each angle also a full turn up or down. Where neither is inside, the one that
/// clamping turns away least is taken.
pub(super) fn fit(quaternion: DQuat, order: RotationOrder, limits: &[Limit; 3]) -> Fit {
    let first = order.angles_of(quaternion);
    // The same rotation the other way around the middle axis, in either order.
    let second = DVec3::new(first.x + PI, PI - first.y, first.z + PI);
    let [first, second] = [first, second].map(|triple| {
        let asked = nearest_turns(triple, limits);
        let clamp = |i: usize| limits[i].clamp(asked[i]);
        (asked, DVec3::new(clamp(0), clamp(1), clamp(2)))
    });
    let is_inside = |(asked, used): (DVec3, DVec3)| asked.abs_diff_eq(used, LIMIT_TOLERANCE);
    if is_inside(first) || is_inside(second) {
        return Fit::Inside;
    }
    let turned_away =
        |(_, used): (DVec3, DVec3)| quaternion.angle_between(order.quaternion_of(used));
    let nearer = if turned_away(second) < turned_away(first) {
        second
    } else {
        first
    };
    Fit::Clamped {
        asked: nearer.0,
        used: nearer.1,
    }
}

/// Each angle at the turn that comes nearest to its limits.
fn nearest_turns(angles: DVec3, limits: &[Limit; 3]) -> DVec3 {
    let excess = |limit: Limit, angle: f64| (angle - limit.clamp(angle)).abs();
    let nearest = |i: usize| {
        let angle = angles[i] - TAU * libm::round(angles[i] / TAU);
        let turns = [angle, angle - TAU, angle + TAU];
        turns.into_iter().fold(angle, |best, turn| {
            if excess(limits[i], turn) < excess(limits[i], best) {
                turn
            } else {
                best
            }
        })
    };
    DVec3::new(nearest(0), nearest(1), nearest(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_triple_and_full_turns_are_tried() {
        let range = |min, max| Limit { min, max };
        // (0.1, 2, 0.1) has its middle angle past pi/2, so only the second triple is inside.
        let limits = [range(0.0, 0.2), range(1.5, 2.5), range(0.0, 0.2)];
        let quaternion = RotationOrder::Zyx.quaternion_of(DVec3::new(0.1, 2.0, 0.1));
        assert!(matches!(
            fit(quaternion, RotationOrder::Zyx, &limits),
            Fit::Inside
        ));
        // 3.5 radians read back as 3.5 - 2 pi.
        let limits = [Limit::NONE, Limit::NONE, range(3.0, 4.0)];
        assert!(matches!(
            fit(DQuat::from_rotation_z(3.5), RotationOrder::Zyx, &limits),
            Fit::Inside
        ));
    }

    #[test]
    fn clamping_turns_away_no_further_than_it_must() {
        let within = |most: f64| Limit {
            min: -most,
            max: most,
        };
        let limits = [within(0.4), within(0.7), within(0.35)];
        // Half a turn about z, nearly: the other triple has smaller excesses, each, and ends far off.
        for degrees in [170f64, 178.0] {
            let asked = DQuat::from_rotation_z(degrees.to_radians());
            let Fit::Clamped { used, .. } = fit(asked, RotationOrder::Zyx, &limits) else {
                panic!("it is outside");
            };
            let best = DVec3::new(0.0, 0.0, 0.35);
            assert!(used.abs_diff_eq(best, 1e-9), "{degrees}: {used}");
        }
    }
}
