//! Rays against skinned triangles. Never lives here: skinning.
//!
//! The test is that of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (2013): space is sheared so that the ray becomes the
//! z axis, and a triangle is met where its shadow on the xy plane covers the origin. A corner's shadow is the same for every triangle
//! that shares it, and the side of an edge is exact, so that no ray slips between two triangles.

use super::{Hit, Skin, What};
use crate::frame::SkinnedVertices;
use crate::rig::{Influence, Mesh, Part, Rig, Sides};
use crate::scene::{Cull, Ray, Shape};
use glam::{DMat3, DVec3, Vec3};
use std::collections::BTreeMap;

pub(super) fn nearest(ray: &Ray, skin: Skin) -> Option<Hit> {
    let ray_space = RaySpace::new(ray);
    let mut reach = *ray;
    let mut nearest = None;
    let rig = skin.posed.rig();
    for (index, (mesh, vertices)) in rig.meshes().iter().zip(skin.meshes).enumerate() {
        let Some(positions) = vertices.positions.as_deref() else {
            continue;
        };
        let (positions, _) = positions.as_chunks();
        for part in mesh.parts() {
            let triangles = &mesh.triangles()[part.triangles.clone()];
            let side = side_met(&skin, mesh, part);
            if let Some(met) = ray_space.nearest(&reach, triangles, positions, side) {
                // Of those after this one only what is nearer still counts.
                reach.to = met.distance.next_down();
                let triangle = part.triangles.start + met.triangle;
                let smooth = (!part.is_flat).then_some(vertices);
                nearest = Some((index, mesh, smooth, Met { triangle, ..met }));
            }
        }
    }
    let (index, mesh, smooth, met) = nearest?;
    Some(Hit {
        distance: met.distance,
        position: ray.at(met.distance),
        what: What::Skin {
            mesh: index,
            triangle: met.triangle,
            barycentric: met.barycentric,
            normal: normal(ray, mesh, smooth, &met),
            joint: heaviest_joint(rig, mesh, &met),
        },
    })
}

/// From where the triangles of a part are met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Any,
    /// From where their corners run counter-clockwise in the file's winding.
    Front,
    Back,
}

fn side_met(skin: &Skin, mesh: &Mesh, part: &Part) -> Side {
    let is_single_sided = matches!(part.look(skin.variant).sides, Sides::Front { .. });
    if !is_single_sided || skin.cull == Cull::Never {
        Side::Any
    } else if skin.shape == Shape::Posed && skin.posed.mirrors(mesh) {
        Side::Back
    } else {
        Side::Front
    }
}

/// Where a ray meets a triangle of a mesh.
#[derive(Debug, Clone, Copy)]
struct Met {
    distance: f64,
    triangle: usize,
    barycentric: [f64; 3],
    /// Half of its length is the area of the triangle, in world space; its direction is that of the file's winding. Not zero.
    area_vector: DVec3,
}

/// The space in which a ray runs up the z axis from the origin, and z is the distance along it.
struct RaySpace {
    origin: DVec3,
    ray_from_world: DMat3,
}

impl RaySpace {
    fn new(ray: &Ray) -> Self {
        let steepest = ray.direction.abs().max_position();
        let [x, y, z] = [1, 2, 0].map(|after| DVec3::AXES[(steepest + after) % 3]);
        let [across, up, ahead] = [x, y, z].map(|axis| axis.dot(ray.direction));
        // Sheared and not turned: what is level with an axis stays exactly so, and a floor seen edge-on is a line.
        let rows = [x - z * (across / ahead), y - z * (up / ahead), z / ahead];
        Self {
            origin: ray.origin,
            ray_from_world: DMat3::from_cols(rows[0], rows[1], rows[2]).transpose(),
        }
    }

    fn nearest(
        &self,
        reach: &Ray,
        triangles: &[[u32; 3]],
        positions: &[[f32; 3]],
        side: Side,
    ) -> Option<Met> {
        let mut reach = *reach;
        let mut nearest = None;
        for (triangle, corners) in triangles.iter().enumerate() {
            let Some(corners) = corners_of(positions, corners) else {
                continue;
            };
            let Some((distance, barycentric)) = self.crossing(corners.map(|at| self.place(at)))
            else {
                continue;
            };
            if !reach.reaches(distance) {
                continue;
            }
            let area_vector = area_vector(corners);
            // Rounding can make a needle of what is a line in the file; it has no side to be seen from.
            if area_vector == DVec3::ZERO {
                continue;
            }
            let toward_us = -area_vector.dot(reach.direction);
            let is_met = match side {
                Side::Any => true,
                Side::Front => toward_us > 0.0,
                Side::Back => toward_us < 0.0,
            };
            if !is_met {
                continue;
            }
            reach.to = distance.next_down();
            nearest = Some(Met {
                distance,
                triangle,
                barycentric,
                area_vector,
            });
        }
        nearest
    }

    fn place(&self, position: [f32; 3]) -> DVec3 {
        self.ray_from_world * (in_f64(position) - self.origin)
    }

    /// Distance along the ray and shares of the corners, for a triangle that has an area as the ray sees it. Edges and corners belong to
    /// it.
    fn crossing(&self, [a, b, c]: [DVec3; 3]) -> Option<(f64, [f64; 3])> {
        let is_aside = |a: f64, b: f64, c: f64| {
            (a > 0.0 && b > 0.0 && c > 0.0) || (a < 0.0 && b < 0.0 && c < 0.0)
        };
        // Nearly all triangles of a mesh end here.
        if is_aside(a.x, b.x, c.x) || is_aside(a.y, b.y, c.y) {
            return None;
        }
        let sides = [wedge(b, c), wedge(c, a), wedge(a, b)];
        let [u, v, w] = sides;
        let is_inside =
            sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0);
        let sum = u + v + w;
        if !is_inside || sum == 0.0 {
            return None;
        }
        let barycentric @ [u, v, w] = sides.map(|side| side / sum);
        Some((u * a.z + v * b.z + w * c.z, barycentric))
    }
}

/// `None` where there are fewer positions than the mesh has.
fn corners_of(positions: &[[f32; 3]], &[a, b, c]: &[u32; 3]) -> Option<[[f32; 3]; 3]> {
    let at = |corner: u32| positions.get(corner as usize).copied();
    Some([at(a)?, at(b)?, at(c)?])
}

fn area_vector(corners: [[f32; 3]; 3]) -> DVec3 {
    let [a, b, c] = corners.map(in_f64);
    (b - a).cross(c - a)
}

fn in_f64(vector: [f32; 3]) -> DVec3 {
    Vec3::from_array(vector).as_dvec3()
}

/// On which side of the line from the origin to `a` the point `b` stands: `a.x·b.y − a.y·b.x`, its sign exact.
fn wedge(a: DVec3, b: DVec3) -> f64 {
    let (left, right) = (a.x * b.y, a.y * b.x);
    let difference = left - right;
    // Each product is off by less than an epsilon of itself, so that a larger difference has its sign right.
    if difference.abs() > 2.0 * f64::EPSILON * (left.abs() + right.abs()) {
        return difference;
    }
    // Kahan's difference of products, off by at most 1.5 units in the last place (Jeannerod, Louvet and Muller, 2013).
    let lost = (-a.y).mul_add(b.x, right);
    a.x.mul_add(b.y, -right) + lost
}

/// Interpolated where there are normals, the part is not lit flat and they do not cancel out, else the triangle's own. Which side of the triangle is seen decides
/// its sign, as it does where the skin is lit: near an outline an interpolated normal may well lean away from the viewer.
fn normal(ray: &Ray, mesh: &Mesh, smooth: Option<&SkinnedVertices>, met: &Met) -> DVec3 {
    let toward_viewer = if met.area_vector.dot(ray.direction) > 0.0 {
        -met.area_vector
    } else {
        met.area_vector
    };
    let normals = smooth.and_then(|vertices| vertices.normals.as_deref());
    let (normals, _) = normals.map_or(&[][..], Vec::as_slice).as_chunks();
    let interpolated = corners_of(normals, &mesh.triangles()[met.triangle]).and_then(|corners| {
        let shared = corners.map(in_f64).into_iter().zip(met.barycentric);
        shared
            .map(|(normal, share)| normal * share)
            .sum::<DVec3>()
            .try_normalize()
    });
    match interpolated {
        Some(normal) if normal.dot(toward_viewer) < 0.0 => -normal,
        Some(normal) => normal,
        None => toward_viewer.normalize_or_zero(),
    }
}

fn heaviest_joint(rig: &Rig, mesh: &Mesh, met: &Met) -> Option<usize> {
    let mut weights: BTreeMap<usize, f64> = BTreeMap::new();
    for (corner, share) in mesh.triangles()[met.triangle]
        .into_iter()
        .zip(met.barycentric)
    {
        for &Influence { binding, weight } in mesh.influences_of(corner as usize) {
            if let Some(joint) = rig.bindings()[binding as usize].joint {
                *weights.entry(joint).or_default() += share * f64::from(weight);
            }
        }
    }
    let heavier = |first: (usize, f64), second: (usize, f64)| {
        if second.1 > first.1 { second } else { first }
    };
    let weigh_something = weights.into_iter().filter(|&(_, weight)| weight > 0.0);
    weigh_something.reduce(heavier).map(|(joint, _)| joint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn the_side_of_an_edge_is_exact() {
        let mut random = Random(5);
        let mut rounded_wrong = 0;
        for _ in 0..20_000 {
            // Whole numbers of up to 52 bits, `b` as nearly in line with `a` as whole numbers can be.
            let whole = |share: f64| (share * 4e15) as i64;
            let [a_x, a_y] = [whole(random.unit()), whole(random.unit())];
            let near = |number: i64, share: f64| (number as f64 * share) as i64;
            let share = random.unit();
            let [b_x, b_y] = [near(a_x, share), near(a_y, share)];
            let exact = i128::from(a_x) * i128::from(b_y) - i128::from(a_y) * i128::from(b_x);
            let [a_x, a_y, b_x, b_y] = [a_x, a_y, b_x, b_y].map(|number| number as f64);
            let (a, b) = (DVec3::new(a_x, a_y, 1.0), DVec3::new(b_x, b_y, 1.0));
            let sign = |number: f64| number.partial_cmp(&0.0);
            assert_eq!(sign(wedge(a, b)), Some(exact.cmp(&0)), "{a} {b}");
            assert_eq!(sign(wedge(b, a)), Some(0.cmp(&exact)), "{b} {a}");
            rounded_wrong += usize::from(sign(a_x * b_y - a_y * b_x) != Some(exact.cmp(&0)));
        }
        assert!(
            rounded_wrong > 10,
            "plain arithmetic is tried too: {rounded_wrong}"
        );
    }

    fn ray(origin: DVec3, toward: DVec3) -> Ray {
        Ray {
            origin,
            direction: toward.normalize_or_zero(),
            from: 0.0,
            to: f64::INFINITY,
        }
    }

    /// A closed surface about the origin: an octahedron, each triangle split in four `depth` times, pushed onto a sphere of radius 1.
    fn ball(depth: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let mut triangles: Vec<[Vec3; 3]> = Vec::new();
        for x in [Vec3::X, Vec3::NEG_X] {
            for y in [Vec3::Y, Vec3::NEG_Y] {
                triangles.extend([Vec3::Z, Vec3::NEG_Z].map(|z| [x, y, z]));
            }
        }
        for _ in 0..depth {
            triangles = triangles
                .iter()
                .flat_map(|&[a, b, c]| {
                    let [ab, bc, ca] = [a + b, b + c, c + a].map(|sum| sum.normalize_or_zero());
                    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                })
                .collect();
        }
        // Corners that triangles share are one vertex, as in a file.
        let mut positions: Vec<Vec3> = Vec::new();
        let mut index_of = |corner: Vec3| {
            let known = positions.iter().position(|&position| position == corner);
            known.unwrap_or_else(|| {
                positions.push(corner);
                positions.len() - 1
            }) as u32
        };
        let triangles = triangles
            .iter()
            .map(|corners| corners.map(&mut index_of))
            .collect();
        (positions, triangles)
    }

    #[test]
    fn no_ray_slips_into_or_out_of_a_closed_surface() {
        let (positions, triangles) = ball(3);
        let corners: Vec<[f32; 3]> = positions.iter().map(Vec3::to_array).collect();
        let met = |ray: &Ray| RaySpace::new(ray).nearest(ray, &triangles, &corners, Side::Any);
        let mut random = Random(2);
        // Corners, edges cut at exact and inexact points, and the inside of triangles, as seen from without and from within.
        let mut aims = Vec::new();
        for corners in &triangles {
            let [a, b, c] = corners.map(|corner| positions[corner as usize].as_dvec3());
            let share = random.unit();
            aims.extend([a, b, c, a.midpoint(b), b.lerp(c, share), (a + b + c) / 3.0]);
        }
        let inner = DVec3::new(0.11, -0.2, 0.07);
        let mut rays = 0;
        for &aim in &aims {
            for _ in 0..4 {
                let from_within = ray(inner + DVec3::from(random.point()) * 0.3, aim - inner);
                assert!(met(&from_within).is_some(), "out of it: {from_within:?}");
                // Straight in: through the aimed at point, whatever side it is seen from, the surface is closed around the ray.
                let origin = aim + (aim + DVec3::from(random.point()) * 0.3) * 3.0;
                let from_without = ray(origin, aim * 0.999_999 - origin);
                assert!(met(&from_without).is_some(), "into it: {from_without:?}");
                rays += 2;
            }
            let exactly_there = ray(inner, aim - inner);
            assert!(met(&exactly_there).is_some(), "at {aim}: {exactly_there:?}");
            rays += 1;
        }
        // And a grid of parallel rays that lie in the planes of symmetry, where edges line up with them.
        for x in -16..=16 {
            for y in -16..=16 {
                let at = DVec3::new(f64::from(x) / 24.0, f64::from(y) / 24.0, 4.0);
                let met = met(&ray(at, DVec3::NEG_Z)).expect("it is in the way");
                assert!((3.0..4.0).contains(&met.distance), "{met:?}");
                rays += 1;
            }
        }
        assert!(rays > 28_000, "{rays}");
    }
}
