//! Unit shapes that views of a skeleton are put together from, as meshes. Never lives here: where they stand.

use glam::{DAffine3, Vec3, Vec4};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SolidShape {
    /// From -1 to 1 on each axis.
    Box,
    /// Of radius 1 about the origin.
    Ball,
    /// A box from y = 0, where its sides are at 1, to y = 1, where they are closer.
    Taper,
    /// Six-sided, about the y axis from 0 to 1, corners at radius 1.
    Cylinder,
}

/// Solids of one shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Solids {
    pub shape: SolidShape,
    pub instances: Vec<Solid>,
}

/// A shape where it stands.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Solid {
    /// Rows of an affine matrix.
    pub world_from_shape: [Vec4; 3],
    /// Linear RGB that it scatters, and 0.
    pub color: Vec4,
}

impl Solid {
    pub(super) fn new(world_from_shape: DAffine3, color: Vec3) -> Self {
        let DAffine3 {
            matrix3,
            translation,
        } = world_from_shape;
        let row = |i: usize| matrix3.row(i).extend(translation[i]).as_vec4();
        Self {
            world_from_shape: [row(0), row(1), row(2)],
            color: color.extend(0.0),
        }
    }
}

/// Triangles are wound counter-clockwise seen from outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SolidMesh {
    /// Position and unit normal.
    pub vertices: Vec<[Vec3; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

/// How far from the axis the sides of a taper are at its end.
const TAPER_END: f32 = 0.35;

impl SolidShape {
    pub const ALL: [Self; 4] = [Self::Box, Self::Ball, Self::Taper, Self::Cylinder];

    pub fn mesh(self) -> SolidMesh {
        match self {
            Self::Box => {
                let square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
                prism(&square, -1.0, 1.0, 1.0)
            }
            Self::Taper => {
                let square = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
                prism(&square, 0.0, 1.0, TAPER_END)
            }
            Self::Cylinder => {
                let half = 0.5;
                let side = 3f32.sqrt() / 2.0;
                let hexagon = [
                    (1.0, 0.0),
                    (half, side),
                    (-half, side),
                    (-1.0, 0.0),
                    (-half, -side),
                    (half, -side),
                ];
                prism(&hexagon, 0.0, 1.0, 1.0)
            }
            Self::Ball => ball(),
        }
    }
}

/// Over a convex outline in (x, z), with flat sides; the outline at the `top` is scaled by `end`.
fn prism(outline: &[(f32, f32)], bottom: f32, top: f32, end: f32) -> SolidMesh {
    let low = |&(x, z): &(f32, f32)| Vec3::new(x, bottom, z);
    let high = |&(x, z): &(f32, f32)| Vec3::new(x * end, top, z * end);
    let mut mesh = SolidMesh::default();
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

/// An octahedron whose faces were divided in four, three times over, and puffed up.
fn ball() -> SolidMesh {
    const HALVINGS: usize = 3;
    let corners = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let mut faces: Vec<[Vec3; 3]> = (0..8)
        .map(|octant| [0, 1, 2].map(|axis| corners[axis + 3 * (octant >> axis & 1)]))
        .collect();
    for _ in 0..HALVINGS {
        let middle = |a: Vec3, b: Vec3| (a + b).normalize_or(a);
        let divided = |[a, b, c]: [Vec3; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(divided).collect();
    }
    let mut mesh = SolidMesh::default();
    for face in faces {
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(face.map(|corner| [corner, corner]));
        mesh.add_triangle([first, first + 1, first + 2]);
    }
    mesh
}

impl SolidMesh {
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
            (SolidShape::Ball, 4.09),
        ] {
            let SolidMesh {
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
}
