//! Solids that views of a skeleton are put together from, laid out as one mesh in model space: both renderers draw it as they draw any
//! other. Not as instances of a few shapes, which software drivers take one at a time. Never lives here: where solids stand.

use glam::{DAffine3, DMat3, Vec3};
use std::sync::LazyLock;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum SolidShape {
    /// From -1 to 1 on each axis.
    Box,
    /// Of radius 1 about the origin, its surface so finely divided.
    Ball(Fineness),
    /// A box from y = 0, where its sides are at 1, to y = 1, where they are closer.
    Taper,
    /// Six-sided, about the y axis from 0 to 1, corners at radius 1.
    Cylinder,
}

/// How many triangles a ball is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Fineness {
    /// 32: of thousands of balls none is seen closely.
    Coarse,
    /// 128.
    Medium,
    /// 512: round also where it fills the picture.
    Fine,
}

impl Fineness {
    /// The more there are, the smaller each is in the picture: a dozen may be looked at closely, thousands are not.
    pub(super) fn for_balls(count: usize) -> Self {
        match count {
            0..=12 => Self::Fine,
            13..=2048 => Self::Medium,
            _ => Self::Coarse,
        }
    }
}

/// A corner of a solid, in model space.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct SolidVertex {
    pub position: Vec3,
    /// Unit length.
    pub normal: Vec3,
    /// Linear RGB that it scatters.
    pub color: Vec3,
}

/// Solids side by side. Triangles are wound counter-clockwise seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Solids {
    /// Each solid has its own, even where it touches others.
    pub vertices: Vec<SolidVertex>,
    /// Indices into `vertices`, three to a triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Solids {
    /// `world_from_shape` does not mirror.
    pub(super) fn add(&mut self, shape: SolidShape, world_from_shape: &DAffine3, color: Vec3) {
        let mesh = shape.mesh();
        // As many solids as there may be joints, at their finest, stay far below four thousand million vertices.
        let first = self.vertices.len() as u32;
        let [a, b, c] = world_from_shape
            .matrix3
            .to_cols_array_2d()
            .map(glam::DVec3::from_array);
        let cofactors = DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b));
        self.vertices
            .extend(mesh.vertices.iter().map(|[position, normal]| {
                SolidVertex {
                    position: world_from_shape
                        .transform_point3(position.as_dvec3())
                        .as_vec3(),
                    normal: (cofactors * normal.as_dvec3())
                        .normalize_or(normal.as_dvec3())
                        .as_vec3(),
                    color,
                }
            }));
        let triangles = mesh.triangles.iter();
        self.triangles
            .extend(triangles.map(|triangle| triangle.map(|corner| first + corner)));
    }
}

/// A shape in its own space: position and unit normal of each corner.
#[derive(Debug, Clone, Default, PartialEq)]
struct ShapeMesh {
    vertices: Vec<[Vec3; 2]>,
    triangles: Vec<[u32; 3]>,
}

/// How far from the axis the sides of a taper are at its end.
const TAPER_END: f32 = 0.35;

impl SolidShape {
    /// Made once.
    fn mesh(self) -> &'static ShapeMesh {
        static BOX: LazyLock<ShapeMesh> = LazyLock::new(|| prism(&SQUARE, -1.0, 1.0, 1.0));
        static TAPER: LazyLock<ShapeMesh> = LazyLock::new(|| prism(&SQUARE, 0.0, 1.0, TAPER_END));
        static CYLINDER: LazyLock<ShapeMesh> = LazyLock::new(|| prism(&hexagon(), 0.0, 1.0, 1.0));
        static COARSE: LazyLock<ShapeMesh> = LazyLock::new(|| ball(1));
        static MEDIUM: LazyLock<ShapeMesh> = LazyLock::new(|| ball(2));
        static FINE: LazyLock<ShapeMesh> = LazyLock::new(|| ball(3));
        match self {
            Self::Box => &BOX,
            Self::Taper => &TAPER,
            Self::Cylinder => &CYLINDER,
            Self::Ball(Fineness::Coarse) => &COARSE,
            Self::Ball(Fineness::Medium) => &MEDIUM,
            Self::Ball(Fineness::Fine) => &FINE,
        }
    }
}

const SQUARE: [(f32, f32); 4] = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];

fn hexagon() -> [(f32, f32); 6] {
    let side = 3f32.sqrt() / 2.0;
    [
        (1.0, 0.0),
        (0.5, side),
        (-0.5, side),
        (-1.0, 0.0),
        (-0.5, -side),
        (0.5, -side),
    ]
}

/// Over a convex outline in (x, z), with flat sides; the outline at the `top` is scaled by `end`.
fn prism(outline: &[(f32, f32)], bottom: f32, top: f32, end: f32) -> ShapeMesh {
    let low = |&(x, z): &(f32, f32)| Vec3::new(x, bottom, z);
    let high = |&(x, z): &(f32, f32)| Vec3::new(x * end, top, z * end);
    let mut mesh = ShapeMesh::default();
    let next = outline.iter().cycle().skip(1);
    for (corner, next) in outline.iter().zip(next) {
        mesh.add_face(&[low(corner), low(next), high(next), high(corner)]);
    }
    let floor: Vec<Vec3> = outline.iter().map(low).collect();
    let roof: Vec<Vec3> = outline.iter().map(high).collect();
    mesh.add_face(&floor);
    mesh.add_face(&roof);
    mesh
}

/// An octahedron whose faces were divided in four, so many times over, and puffed up.
fn ball(halvings: usize) -> ShapeMesh {
    let corners = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let mut faces: Vec<[Vec3; 3]> = (0..8)
        .map(|octant| [0, 1, 2].map(|axis| corners[axis + 3 * (octant >> axis & 1)]))
        .collect();
    for _ in 0..halvings {
        let middle = |a: Vec3, b: Vec3| (a + b).normalize_or(a);
        let divided = |[a, b, c]: [Vec3; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(divided).collect();
    }
    let mut mesh = ShapeMesh::default();
    for face in faces {
        let triangle = face.map(|corner| mesh.shared(corner));
        mesh.add_triangle(triangle);
    }
    mesh
}

impl ShapeMesh {
    /// The vertex at this point of the unit sphere, made where it is not there yet.
    fn shared(&mut self, point: Vec3) -> u32 {
        // Middles of an edge come out alike from both of its sides, but for rounding.
        let there = |[position, _]: &[Vec3; 2]| position.abs_diff_eq(point, 1e-5);
        let found = self.vertices.iter().position(there);
        let index = found.unwrap_or_else(|| {
            self.vertices.push([point, point]);
            self.vertices.len() - 1
        });
        index as u32
    }

    /// A flat convex face with corners of its own; the shape's middle is behind it.
    fn add_face(&mut self, corners: &[Vec3]) {
        let first = self.vertices.len() as u32;
        let flat = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let outward = if flat.dot(corners[0] - MIDDLE) < 0.0 {
            -flat
        } else {
            flat
        };
        let normal = outward.normalize_or(Vec3::Y);
        self.vertices
            .extend(corners.iter().map(|&corner| [corner, normal]));
        for corner in 1..corners.len() as u32 - 1 {
            self.add_triangle([first, first + corner, first + corner + 1]);
        }
    }

    /// Wound about its normals.
    fn add_triangle(&mut self, [a, b, c]: [u32; 3]) {
        let [p, q, r] = [a, b, c].map(|corner| self.vertices[corner as usize]);
        let wound = (q[0] - p[0]).cross(r[0] - p[0]).dot(p[1] + q[1] + r[1]) > 0.0;
        self.triangles
            .push(if wound { [a, b, c] } else { [a, c, b] });
    }
}

/// Inside of every prism.
const MIDDLE: Vec3 = Vec3::new(0.0, 0.3, 0.0);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_is_closed_and_faces_outward() {
        for (shape, volume) in [
            (SolidShape::Box, 8.0),
            (
                SolidShape::Taper,
                4.0 * (1.0 + TAPER_END + TAPER_END * TAPER_END) / 3.0,
            ),
            (SolidShape::Cylinder, 1.5 * 3f32.sqrt()),
            // A little less than the sphere's 4.19.
            (SolidShape::Ball(Fineness::Fine), 4.09),
            (SolidShape::Ball(Fineness::Medium), 3.81),
            (SolidShape::Ball(Fineness::Coarse), 2.94),
        ] {
            let ShapeMesh {
                vertices,
                triangles,
            } = shape.mesh();
            let corners = triangles
                .iter()
                .map(|t| t.map(|corner| vertices[corner as usize]));
            let mut total = 0.0;
            for [a, b, c] in corners {
                // By tetrahedra from the origin: right for a closed surface only, and positive where it faces outward.
                total += a[0].dot(b[0].cross(c[0])) / 6.0;
                let flat = (b[0] - a[0]).cross(c[0] - a[0]);
                assert!(
                    [a, b, c].iter().all(|vertex| vertex[1].dot(flat) > 0.0),
                    "{shape:?}"
                );
            }
            assert!((total - volume).abs() < 0.02, "{shape:?}: {total}");
            assert!(
                vertices
                    .iter()
                    .all(|[_, normal]| (normal.length() - 1.0).abs() < 1e-5)
            );
        }
    }

    #[test]
    fn a_ball_shares_its_vertices() {
        for (fineness, vertices, triangles) in [
            (Fineness::Coarse, 18, 32),
            (Fineness::Medium, 66, 128),
            (Fineness::Fine, 258, 512),
        ] {
            let mesh = SolidShape::Ball(fineness).mesh();
            assert_eq!(
                (mesh.vertices.len(), mesh.triangles.len()),
                (vertices, triangles)
            );
        }
    }

    #[test]
    fn solids_stand_where_they_are_put_and_keep_their_normals_upright() {
        let mut solids = Solids::default();
        solids.add(SolidShape::Box, &DAffine3::IDENTITY, Vec3::X);
        let flattened = DAffine3::from_scale_rotation_translation(
            glam::DVec3::new(3.0, 0.1, 2.0),
            glam::DQuat::from_rotation_z(0.5),
            glam::DVec3::new(7.0, 8.0, 9.0),
        );
        solids.add(SolidShape::Ball(Fineness::Fine), &flattened, Vec3::Y);
        assert_eq!(
            (solids.vertices.len(), solids.triangles.len()),
            (24 + 258, 12 + 512)
        );
        for &[a, b, c] in &solids.triangles[12..] {
            let [a, b, c] = [a, b, c].map(|corner| solids.vertices[corner as usize]);
            let flat = (b.position - a.position).cross(c.position - a.position);
            assert!(a.normal.dot(flat) > 0.0 && (a.normal.length() - 1.0).abs() < 1e-5);
            assert_eq!(a.color, Vec3::Y);
        }
    }
}
