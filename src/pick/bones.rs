//! Rays against bones. Never lives here: where bones are and how thick, which the pose knows.

use super::{Bones, Hit, What, nearer};
use crate::pose::Bone;
use crate::scene::Ray;
use glam::DVec3;

pub(super) fn nearest(ray: &Ray, bones: Bones) -> Option<Hit> {
    let hit = |bone: Bone| {
        let radius = bones.radius.map_or(bone.radius, |radius| radius.length());
        let (distance, along) = crossing(ray, bone.from, bone.to, radius)?;
        Some(Hit {
            distance,
            position: ray.at(distance),
            what: What::Bone {
                joint: bone.owner,
                child: bone.child,
                along,
            },
        })
    };
    bones.posed.bones().filter_map(hit).reduce(nearer)
}

/// The distance at which a ray first passes the surface of a cylinder between two points, and how far along the cylinder that is, 0..1.
///
/// A cylinder is where an endless one and the space between its caps overlap. Cutting the two stretches of the ray that lie in them leaves
/// no gap at the rims, which testing wall and discs one by one would.
fn crossing(ray: &Ray, from: DVec3, to: DVec3, radius: f64) -> Option<(f64, f64)> {
    let length = from.distance(to);
    let axis = (to - from).try_normalize()?;
    let start = ray.origin - from;
    let (start_along, along_rate) = (start.dot(axis), ray.direction.dot(axis));
    let [cap_in, cap_out] = between_caps(start_along, along_rate, length)?;
    let [wall_in, wall_out] = within_wall(
        start - axis * start_along,
        ray.direction - axis * along_rate,
        radius,
    )?;
    let (enters, leaves) = (cap_in.max(wall_in), cap_out.min(wall_out));
    if enters > leaves {
        return None;
    }
    let met = [enters, leaves].into_iter().find(|&met| ray.reaches(met))?;
    let along = (start_along + along_rate * met) / length;
    Some((met, along.clamp(0.0, 1.0)))
}

/// The stretch of a line, as far as it runs between two planes at heights 0 and `length`.
fn between_caps(start: f64, rate: f64, length: f64) -> Option<[f64; 2]> {
    if rate == 0.0 {
        return (0.0..=length).contains(&start).then_some(EVERYWHERE);
    }
    let (bottom, top) = (-start / rate, (length - start) / rate);
    Some([bottom.min(top), bottom.max(top)])
}

/// The stretch of a line that runs no further than `radius` from the axis; `start` and `rate` are square to the axis.
fn within_wall(start: DVec3, rate: DVec3, radius: f64) -> Option<[f64; 2]> {
    let rate_squared = rate.length_squared();
    if rate_squared == 0.0 {
        return (start.length() <= radius).then_some(EVERYWHERE);
    }
    let closest = -start.dot(rate) / rate_squared;
    // By the distance at the closest point, not by b² − ac: seen from afar, both of those are so large that nothing is left of the radius.
    let squared_inside = radius * radius - (start + rate * closest).length_squared();
    let half = (squared_inside >= 0.0).then(|| (squared_inside / rate_squared).sqrt())?;
    Some([closest - half, closest + half])
}

const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// In units, of cylinders about 1 in size.
    const ROUNDING: f64 = 1e-9;

    fn ray(origin: DVec3, toward: DVec3) -> Ray {
        Ray {
            origin,
            direction: toward.normalize_or_zero(),
            from: 0.0,
            to: f64::INFINITY,
        }
    }

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    /// From the origin 2 up, 0.5 in radius.
    fn upright(ray: &Ray) -> Option<(f64, f64)> {
        crossing(ray, DVec3::ZERO, DVec3::Y * 2.0, 0.5)
    }

    #[test]
    fn rays_from_outside_meet_the_near_wall_or_cap() {
        let (x, y) = (DVec3::X, DVec3::Y);
        for (origin, toward, wanted) in [
            (v(-3.0, 1.5, 0.0), x, Some((2.5, 0.75))),
            (v(3.0, 0.5, 0.3), -x, Some((2.6, 0.25))),
            (v(0.2, 5.0, 0.2), -y, Some((3.0, 1.0))),
            (v(0.2, -1.0, 0.2), y, Some((1.0, 0.0))),
            // Above the cap, and slanting down through it.
            (v(-1.0, 3.0, 0.0), x - y, Some((2f64.sqrt(), 1.0))),
            (v(-3.0, 2.1, 0.0), x, None),
            (v(-3.0, 1.0, 0.6), x, None),
            (v(0.6, 5.0, 0.0), -y, None),
            (v(-3.0, 1.0, 0.0), -x, None),
        ] {
            let found = upright(&ray(origin, toward));
            assert_eq!(found.is_some(), wanted.is_some(), "{origin} {toward}");
            if let (Some(found), Some(wanted)) = (found, wanted) {
                assert!(
                    (found.0 - wanted.0).abs() < ROUNDING,
                    "{found:?} {wanted:?}"
                );
                assert!(
                    (found.1 - wanted.1).abs() < ROUNDING,
                    "{found:?} {wanted:?}"
                );
            }
        }
    }

    #[test]
    fn grazing_rays_meet_it() {
        // Along the wall, across a cap, on a rim: exactly on the surface.
        for (origin, toward) in [
            (v(-3.0, 1.0, 0.5), DVec3::X),
            (v(0.5, 5.0, 0.0), DVec3::NEG_Y),
            (v(-3.0, 2.0, 0.0), DVec3::X),
            (v(-3.0, 0.0, 0.5), DVec3::X),
        ] {
            assert!(upright(&ray(origin, toward)).is_some(), "{origin} {toward}");
        }
        assert_eq!(upright(&ray(v(-3.0, 1.0, 0.5 + 1e-9), DVec3::X)), None);
    }

    #[test]
    fn from_inside_the_far_wall_is_met() {
        let inside = v(0.1, 0.5, 0.0);
        assert_eq!(upright(&ray(inside, DVec3::X)), Some((0.4, 0.25)));
        assert_eq!(upright(&ray(inside, DVec3::Y)), Some((1.5, 1.0)));
        // The near plane cuts the near wall away.
        let cut = Ray {
            from: 3.0,
            ..ray(v(-3.0, 1.0, 0.0), DVec3::X)
        };
        assert_eq!(upright(&cut), Some((3.5, 0.5)));
        for (from, to) in [(4.0, f64::INFINITY), (2.6, 3.4), (0.0, 2.4)] {
            assert_eq!(upright(&Ray { from, to, ..cut }), None, "{from} {to}");
        }
    }

    #[test]
    fn looking_along_a_bone_meets_its_end() {
        // Neither direction is exact, so that the ray is nearly but not quite parallel to the bone.
        let (from, to) = (v(0.3, -0.7, 0.2), v(1.7, 0.4, -0.9));
        for (near, far, wanted) in [(from, to, 0.0), (to, from, 1.0)] {
            let along_it = ray(near - (far - near) * 3.0, far - near);
            let (distance, along) = crossing(&along_it, from, to, 0.1).expect("it is aimed at");
            let wanted_distance = 3.0 * from.distance(to);
            assert!((distance - wanted_distance).abs() < ROUNDING, "{distance}");
            assert!((along - wanted).abs() < ROUNDING, "{along}");
        }
    }

    #[test]
    fn a_bone_without_length_is_not_met() {
        for length in [0.0, 1e-200] {
            let ray = ray(v(-3.0, 0.0, 0.0), DVec3::X);
            assert_eq!(crossing(&ray, DVec3::ZERO, DVec3::Y * length, 0.5), None);
        }
    }

    #[test]
    fn a_far_eye_meets_what_a_near_one_does() {
        let (from, to, radius) = (v(0.0, 0.0, 0.0), v(0.1, 0.4, 0.05), 0.015);
        let aim = from.lerp(to, 0.3);
        let direction = v(0.4, -0.2, -1.0).normalize_or_zero();
        let near = ray(aim - direction, direction);
        let (near_distance, near_along) =
            crossing(&near, from, to, radius).expect("it is aimed at");
        let far = ray(aim - direction * 1e6, direction);
        let (distance, along) = crossing(&far, from, to, radius).expect("it is aimed at");
        // A coordinate of a million holds ten digits behind the point.
        assert!((along - near_along).abs() < 1e-8, "{along} {near_along}");
        let nearer_by = distance - near_distance;
        assert!((nearer_by - (1e6 - 1.0)).abs() < 1e-8, "{nearer_by}");
    }

    #[test]
    fn walking_along_the_ray_finds_the_same() {
        // Inside or outside is asked of points, which shares nothing with the formulas but the meaning.
        let is_inside = |point: DVec3, from: DVec3, to: DVec3, radius: f64| {
            let share = (point - from).dot(to - from) / (to - from).length_squared();
            (0.0..=1.0).contains(&share) && point.distance(from.lerp(to, share)) <= radius
        };
        let mut random = Random(1);
        let (mut met, mut from_inside) = (0, 0);
        for count in 0..2000 {
            let (from, to) = (DVec3::from(random.point()), DVec3::from(random.point()));
            let radius = 0.05 + 0.4 * random.unit();
            let origin = match count % 4 {
                0 => from.lerp(to, random.unit()),
                _ => DVec3::from(random.point()) * 2.0,
            };
            let ray = ray(origin, DVec3::from(random.point()) * 0.7 - origin);
            let starts_inside = is_inside(ray.origin, from, to, radius);
            let step = 0.002;
            let changes = (1..4000)
                .map(|count| f64::from(count) * step)
                .find(|&distance| is_inside(ray.at(distance), from, to, radius) != starts_inside);
            let found = crossing(&ray, from, to, radius);
            match (found, changes) {
                (Some((distance, along)), Some(walked)) => {
                    let is_between =
                        walked - step - ROUNDING <= distance && distance <= walked + ROUNDING;
                    assert!(is_between, "{ray:?}: {distance} {walked}");
                    let point = ray.at(distance);
                    let share = (point - from).dot(to - from) / (to - from).length_squared();
                    assert!((along - share).abs() < ROUNDING, "{along} {share}");
                    met += 1;
                    from_inside += usize::from(starts_inside);
                }
                // A chord shorter than the step can be walked over; a ray can be there and gone between two steps.
                (Some((distance, _)), None) => {
                    let beyond = ray.at(distance + step);
                    assert!(!is_inside(beyond, from, to, radius), "{ray:?} {distance}");
                }
                (None, None) => {}
                (None, Some(walked)) => panic!("{ray:?} is inside at {walked}"),
            }
        }
        assert!(met > 800 && from_inside > 400, "{met} {from_inside}");
    }
}
