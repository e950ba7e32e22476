//! A quaternion against the limits of three angles.

use crate::rig::{Limit, RotationOrder};
use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// Radians by which a quaternion may miss a limit and still be kept as it is: what float32 on the wire loses.
const LIMIT_TOLERANCE: f64 = 1e-6;
/// The cosine of a middle angle below which the two others are told apart no better than a limit is held.
const QUARTER_TURN_TOLERANCE: f64 = 1e-7;

/// How a quaternion stands to the limits of its joint.
pub(super) enum Fit {
    /// These angles make it and are inside, those that missed a limit by the tolerance moved onto it.
    Inside(DVec3),
    /// None are; `used` are those nearest to the limits, clamped.
    Clamped { asked: DVec3, used: DVec3 },
}

/// Tries both triples of angles that make `quaternion`, each angle also a full turn up or down; where the middle axis lines up the two
/// others, so that only their sum or difference counts, also that share of it which the limits allow. Where none is inside, the one
/// that clamping turns away least is taken.
pub(super) fn fit(quaternion: DQuat, order: RotationOrder, limits: &[Limit; 3]) -> Fit {
    let first = order.angles_of(quaternion);
    // The same rotation the other way around the middle axis, in either order.
    let second = DVec3::new(first.x + PI, PI - first.y, first.z + PI);
    let triples = [first, second].map(|triple| {
        let asked = nearest_turns(shared_out(triple, order, limits), limits);
        let clamp = |i: usize| limits[i].clamp(asked[i]);
        (asked, DVec3::new(clamp(0), clamp(1), clamp(2)))
    });
    let is_inside = |(asked, used): &(DVec3, DVec3)| asked.abs_diff_eq(*used, LIMIT_TOLERANCE);
    if let Some((_, used)) = triples.iter().find(|triple| is_inside(triple)) {
        return Fit::Inside(*used);
    }
    let turned_away =
        |(_, used): (DVec3, DVec3)| quaternion.angle_between(order.quaternion_of(used));
    let [first, second] = triples;
    let (asked, used) = if turned_away(second) < turned_away(first) {
        second
    } else {
        first
    };
    Fit::Clamped { asked, used }
}

/// Each angle at the turn that comes nearest to its limits.
fn nearest_turns(angles: DVec3, limits: &[Limit; 3]) -> DVec3 {
    let nearest = |i: usize| nearest_turn(angles[i], limits[i]);
    DVec3::new(nearest(0), nearest(1), nearest(2))
}

/// Of several turns within the limit, the one of the smallest angle.
fn nearest_turn(angle: f64, limit: Limit) -> f64 {
    let smallest = -libm::round(angle / TAU);
    let first = libm::ceil((limit.min - LIMIT_TOLERANCE - angle) / TAU);
    let last = libm::floor((limit.max + LIMIT_TOLERANCE - angle) / TAU);
    if first <= last {
        return angle + TAU * smallest.clamp(first, last);
    }
    // The last turn below the limit, and the first above it.
    let [below, above] = [last, first].map(|turns| angle + TAU * turns);
    if limit.min - below < above - limit.max {
        below
    } else {
        above
    }
}

/// The triple as it is, but where its middle angle is a quarter turn: there `x` and `z` turn about one line, and only `z + sign * x` is
/// known. Of the pairs that make it, one within limits, with `z` near where it is; as it is where there is none.
fn shared_out(triple: DVec3, order: RotationOrder, limits: &[Limit; 3]) -> DVec3 {
    if libm::cos(triple.y).abs() > QUARTER_TURN_TOLERANCE {
        return triple;
    }
    let sign = match order {
        RotationOrder::Zyx => -libm::sin(triple.y).signum(),
        RotationOrder::Xyz => libm::sin(triple.y).signum(),
    };
    let [of_x, _, of_z] = limits;
    let sum = triple.z + sign * triple.x;
    // Where `z` stands while `x` is within its limits, in the round that `sum` is in.
    let ends = [sum - sign * of_x.min, sum - sign * of_x.max];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    let first = libm::ceil((of_z.min - LIMIT_TOLERANCE - high) / TAU);
    let last = libm::floor((of_z.max + LIMIT_TOLERANCE - low) / TAU);
    if first > last {
        return triple;
    }
    let turns = TAU * 0f64.clamp(first, last);
    let z = triple.z.max(of_z.min).max(low + turns);
    let z = z.min(of_z.max).min(high + turns);
    DVec3::new(sign * (sum + turns - z), triple.y, z)
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
            Fit::Inside(_)
        ));
        // 3.5 radians read back as 3.5 - 2 pi.
        let limits = [Limit::NONE, Limit::NONE, range(3.0, 4.0)];
        assert!(matches!(
            fit(DQuat::from_rotation_z(3.5), RotationOrder::Zyx, &limits),
            Fit::Inside(_)
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

    #[test]
    fn limits_are_met_whichever_turn_they_lie_in() {
        let range = |min, max| Limit { min, max };
        for (angle, limit, wanted) in [
            (0.5, Limit::NONE, 0.5),
            (0.5 + 3.0 * TAU, Limit::NONE, 0.5),
            (0.5, range(12.0, 14.0), 0.5 + 2.0 * TAU),
            (0.5, range(-20.0, -18.0), 0.5 - 3.0 * TAU),
            // A hair below where the limit begins is no reason for another turn.
            (1.0 - 1e-12, range(1.0, 100.0), 1.0 - 1e-12),
            (2.0, range(0.0, 1.0), 2.0),
            (4.0, range(0.0, 1.0), 4.0 - TAU),
        ] {
            let found = nearest_turn(angle, limit);
            assert!((found - wanted).abs() < 1e-9, "{angle} {limit:?}: {found}");
        }
    }

    #[test]
    fn at_a_quarter_turn_the_limits_choose_what_each_of_the_outer_axes_takes() {
        let lock = Limit { min: 0.0, max: 0.0 };
        let range = |min, max| Limit { min, max };
        for order in [RotationOrder::Zyx, RotationOrder::Xyz] {
            for y in [PI / 2.0, -PI / 2.0] {
                for (asked, limits) in [
                    (DVec3::new(0.7, y, 0.0), [Limit::NONE, Limit::NONE, lock]),
                    (DVec3::new(0.0, y, -0.7), [lock, Limit::NONE, Limit::NONE]),
                    (
                        DVec3::new(2.9, y, -2.8),
                        [range(2.5, 3.0), Limit::NONE, range(-3.0, -2.5)],
                    ),
                ] {
                    let quaternion = order.quaternion_of(asked);
                    let Fit::Inside(found) = fit(quaternion, order, &limits) else {
                        panic!("{order:?} {asked} is inside");
                    };
                    let back = order.quaternion_of(found);
                    assert!(back.angle_between(quaternion) < 1e-6, "{asked} {found}");
                    for i in 0..3 {
                        assert!(limits[i].contains(found[i]), "{asked} {found}");
                    }
                }
            }
        }
    }
}
