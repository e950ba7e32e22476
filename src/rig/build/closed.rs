//! Whether a surface encloses a volume, so that its far side can never be seen. Found once at load.

use crate::rig::Mesh;
use glam::DVec3;
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

/// Of the size of a mesh: vertices this close are one, where they also move alike.
const WELD: f64 = 1e-6;
/// Of what a volume is a sum of: less is rounding.
const LEAST_VOLUME: f64 = 1e-9;

/// Of each draw triangle whether its front is the outside; `None` of a surface that encloses nothing. Draw triangles are still in the
/// order of the file's own.
pub(super) fn are_outward(mesh: &Mesh) -> Option<Vec<bool>> {
    let welded = weld(mesh)?;
    // The file's own winding hangs together even where a normal says otherwise; some files have no other order than their normals.
    let by_file = fronts_outside(mesh, &welded, &mesh.triangles);
    match by_file {
        Some(fronts_outside) => {
            let own = mesh.triangles.iter().zip(&mesh.draw_triangles);
            let is_turned = own.map(|(file, draw)| file != draw);
            let fronts = fronts_outside.iter().zip(is_turned);
            Some(
                fronts
                    .map(|(front, is_turned)| *front != is_turned)
                    .collect(),
            )
        }
        None => fronts_outside(mesh, &welded, &mesh.draw_triangles),
    }
}

/// Of each triangle whether it is seen counter-clockwise from outside; `None` of a surface that is not closed.
///
/// It is made of parts that hang together by edges between two triangles; where more meet, parts only touch. A part is closed if along
/// each edge as many triangles run one way as run the other: then its boundary is nothing. The sign of its volume, a sum of
/// tetrahedra, gives the side that is outside.
fn fronts_outside(mesh: &Mesh, welded: &[u32], triangles: &[[u32; 3]]) -> Option<Vec<bool>> {
    let edges = edges(triangles, welded);
    if edges.is_empty() {
        return None;
    }
    let mut parts = Parts::each_alone(triangles.len());
    for edge in edges.chunk_by(|a, b| a.between == b.between) {
        if let [one, other] = edge {
            parts.join(one.triangle, other.triangle);
        }
    }
    for edge in edges.chunk_by(|a, b| a.between == b.between) {
        let mut ways: Vec<(u32, i32)> = edge
            .iter()
            .map(|edge| (parts.of(edge.triangle), if edge.is_upward { 1 } else { -1 }))
            .collect();
        ways.sort_unstable();
        let mut of_parts = ways.chunk_by(|a, b| a.0 == b.0);
        if !of_parts.all(|ways| ways.iter().map(|(_, way)| way).sum::<i32>() == 0) {
            return None;
        }
    }
    let mut volumes = vec![[0.0; 2]; triangles.len()];
    // From a point of the mesh itself: far from the origin little would be left of the sum.
    let origin = mesh.positions[welded[0] as usize].as_dvec3();
    for (index, triangle) in triangles.iter().enumerate() {
        let corner = |vertex: u32| mesh.positions[welded[vertex as usize] as usize].as_dvec3();
        let [a, b, c] = triangle.map(|vertex| corner(vertex) - origin);
        let volume = a.dot(b.cross(c));
        let [sum, sum_of_sizes] = &mut volumes[parts.of(index as u32) as usize];
        *sum += volume;
        *sum_of_sizes += volume.abs();
    }
    let front_is_outside = |index: usize| {
        if !has_sides(triangles[index], welded) {
            // Nobody sees it.
            return Some(true);
        }
        let [volume, of] = volumes[parts.of(index as u32) as usize];
        (volume.abs() > LEAST_VOLUME * of).then_some(volume > 0.0)
    };
    (0..triangles.len()).map(front_is_outside).collect()
}

/// One of the three of a triangle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// Two welded vertices, as one number.
    between: u64,
    triangle: u32,
    /// From the lower vertex to the higher one.
    is_upward: bool,
}

/// Those of all triangles that have sides, sorted.
fn edges(triangles: &[[u32; 3]], welded: &[u32]) -> Vec<Edge> {
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for (index, &triangle) in triangles.iter().enumerate() {
        if !has_sides(triangle, welded) {
            continue;
        }
        let [a, b, c] = triangle.map(|corner| welded[corner as usize]);
        edges.extend([(a, b), (b, c), (c, a)].map(|(from, to)| Edge {
            between: u64::from(from.min(to)) << 32 | u64::from(from.max(to)),
            triangle: index as u32,
            is_upward: from < to,
        }));
    }
    edges.sort_unstable();
    edges
}

/// What fell into a line or a point has none.
fn has_sides(triangle: [u32; 3], welded: &[u32]) -> bool {
    let [a, b, c] = triangle.map(|corner| welded[corner as usize]);
    a != b && b != c && c != a
}

/// Which triangles hang together, as a forest: each names another of its part, and one of them itself.
struct Parts(Vec<u32>);

impl Parts {
    fn each_alone(triangles: usize) -> Self {
        Self((0..triangles as u32).collect())
    }

    /// The triangle that stands for the part.
    fn of(&mut self, mut triangle: u32) -> u32 {
        let named = &mut self.0;
        while named[triangle as usize] != triangle {
            // Shortens the way for whoever asks next.
            named[triangle as usize] = named[named[triangle as usize] as usize];
            triangle = named[triangle as usize];
        }
        triangle
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.of(one), self.of(other));
        self.0[other as usize] = one;
    }
}

/// Of each vertex the first one that it is one with; `None` where there are none.
fn weld(mesh: &Mesh) -> Option<Vec<u32>> {
    let positions = || mesh.positions.iter().map(|position| position.as_dvec3());
    let min = positions().reduce(DVec3::min)?;
    let size = positions().reduce(DVec3::max)?.distance(min);
    let distance = if size > 0.0 { WELD * size } else { 1.0 };
    // Cells a few times as wide as the distance: a point rarely has to be looked for in more than one, and no cell holds many points
    // that are not one.
    let cell = |position: DVec3| ((position - min) / (4.0 * distance)).floor().as_i64vec3();
    let mut firsts: HashMap<(glam::I64Vec3, u64), Vec<u32>> = HashMap::new();
    let mut welded = Vec::with_capacity(mesh.positions.len());
    for (vertex, position) in positions().enumerate() {
        let following = following(mesh, vertex);
        let (low, high) = (cell(position - distance), cell(position + distance));
        let is_one = |first: u32| {
            let other = mesh.positions[first as usize].as_dvec3();
            (other - position).abs().max_element() <= distance
                && moves_alike(mesh, first as usize, vertex)
        };
        let found = cells(low, high).find_map(|near| {
            let firsts = firsts.get(&(near, following))?;
            firsts.iter().copied().find(|&first| is_one(first))
        });
        let first = found.unwrap_or_else(|| {
            let own = firsts.entry((cell(position), following)).or_default();
            own.push(vertex as u32);
            vertex as u32
        });
        welded.push(first);
    }
    Some(welded)
}

fn cells(low: glam::I64Vec3, high: glam::I64Vec3) -> impl Iterator<Item = glam::I64Vec3> {
    (low.x..=high.x).flat_map(move |x| {
        (low.y..=high.y)
            .flat_map(move |y| (low.z..=high.z).map(move |z| glam::I64Vec3::new(x, y, z)))
    })
}

/// What a vertex moves by, as one number.
fn following(mesh: &Mesh, vertex: usize) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytemuck::cast_slice::<_, u8>(mesh.influences_of(vertex)).hash(&mut hasher);
    for moved in mesh.morph_displacements_of(vertex) {
        (moved.morph, bytemuck::bytes_of(&moved.position)).hash(&mut hasher);
    }
    hasher.finish()
}

fn moves_alike(mesh: &Mesh, a: usize, b: usize) -> bool {
    let displacement = |vertex: usize| {
        let displacements = mesh.morph_displacements_of(vertex).iter();
        displacements.map(|moved| (moved.morph, moved.position))
    };
    mesh.influences_of(a) == mesh.influences_of(b) && displacement(a).eq(displacement(b))
}

#[cfg(test)]
mod tests {
    use crate::limits::Limits;
    use crate::rig::{BindPose, BindingDraft, Draft, JointDraft, Mesh, MeshDraft};
    use glam::{DAffine3, DVec3, Vec3};

    /// A cube about a point, each face with corners of its own, wound outward.
    fn cube(middle: Vec3, half: f32) -> MeshDraft {
        let mut mesh = MeshDraft::default();
        let mut normals = Vec::new();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let mut normal = Vec3::ZERO;
                normal[axis] = side;
                let (mut right, mut up) = (Vec3::ZERO, Vec3::ZERO);
                right[(axis + 1) % 3] = side;
                up[(axis + 2) % 3] = 1.0;
                let first = mesh.positions.len() as u32;
                for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    mesh.positions
                        .push(middle + half * (normal + x * right + y * up));
                    normals.push(normal);
                }
                mesh.triangles.extend(
                    [[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|corner| first + corner)),
                );
            }
        }
        mesh.normals = Some(normals);
        mesh
    }

    fn and(mut one: MeshDraft, other: MeshDraft) -> MeshDraft {
        let first = one.positions.len() as u32;
        one.positions.extend(other.positions);
        if let (Some(normals), Some(more)) = (&mut one.normals, other.normals) {
            normals.extend(more);
        }
        one.triangles.extend(
            other
                .triangles
                .iter()
                .map(|t| t.map(|corner| first + corner)),
        );
        one
    }

    fn turned_in(mut mesh: MeshDraft) -> MeshDraft {
        mesh.normals
            .iter_mut()
            .flatten()
            .for_each(|normal| *normal = -*normal);
        mesh
    }

    fn built(mesh: MeshDraft) -> Mesh {
        let joint = |parent| JointDraft {
            parent,
            offset: DVec3::Y,
            ..JointDraft::default()
        };
        let binding = |joint| BindingDraft {
            joint: Some(joint),
            file: None,
            bind_pose: BindPose::BindFromJoint(DAffine3::IDENTITY),
        };
        let draft = Draft {
            joints: vec![joint(None), joint(Some(0))],
            bindings: vec![binding(0), binding(1)],
            meshes: vec![mesh],
            ..Draft::default()
        };
        let rig = draft.build(&Limits::default()).unwrap();
        let mut meshes = rig.meshes;
        meshes.remove(0)
    }

    /// Every vertex follows the joint that `choose` gives it by its number.
    fn bound(mut mesh: MeshDraft, choose: impl Fn(usize) -> u32) -> MeshDraft {
        let vertices = mesh.positions.len();
        mesh.influence_counts = vec![1; vertices];
        mesh.influences = (0..vertices).map(|vertex| (choose(vertex), 1.0)).collect();
        mesh
    }

    /// The other way round in the file, the normals as they are.
    fn wound_backward(mut mesh: MeshDraft) -> MeshDraft {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        mesh
    }

    #[test]
    fn only_what_encloses_a_volume_is_closed() {
        let whole = || cube(Vec3::new(3.0, -2.0, 50.0), 0.5);
        let mut open = whole();
        open.triangles.pop();
        let mut torn = whole();
        torn.positions[0] += Vec3::X * 0.01;
        let mut nearly = whole();
        nearly.positions[0] += Vec3::X * 1e-6;
        let mut folded = whole();
        folded.triangles.push([0, 0, 5]);
        let mixed = || {
            let mut mesh = whole();
            mesh.triangles[3].swap(0, 1);
            mesh
        };
        let mut both_mixed = mixed();
        both_mixed
            .normals
            .iter_mut()
            .flatten()
            .skip(4)
            .take(4)
            .for_each(|n| *n = -*n);
        let far = || cube(Vec3::ZERO, 1.0);
        let at_corner = || cube(Vec3::new(4.0, -1.0, 51.0), 0.5);
        let at_edge = || cube(Vec3::new(4.0, -1.0, 50.0), 0.5);
        let within = || cube(Vec3::new(3.0, -2.0, 50.0), 0.25);
        for (what, mesh, wanted) in [
            ("a cube", whole(), Some(12)),
            (
                "wound the other way in the file",
                wound_backward(whole()),
                Some(12),
            ),
            ("lit from within", turned_in(whole()), Some(0)),
            (
                "wound every way in the file, by its normals",
                mixed(),
                Some(12),
            ),
            ("with no order at all", both_mixed, None),
            ("without a triangle", open, None),
            ("with a corner that is off", torn, None),
            ("with a corner that is hardly off", nearly, Some(12)),
            ("with a triangle that is a line", folded, Some(13)),
            ("two cubes", and(whole(), far()), Some(24)),
            (
                "two that are lit otherwise",
                and(whole(), turned_in(far())),
                Some(12),
            ),
            (
                "two that are wound otherwise",
                and(whole(), wound_backward(turned_in(far()))),
                Some(12),
            ),
            (
                "meeting in a corner",
                and(whole(), turned_in(wound_backward(at_corner()))),
                Some(12),
            ),
            (
                "meeting along an edge",
                and(whole(), turned_in(wound_backward(at_edge()))),
                Some(12),
            ),
            ("one in the other", and(whole(), within()), Some(24)),
            (
                "nothing",
                MeshDraft {
                    positions: vec![Vec3::X; 3],
                    ..MeshDraft::default()
                },
                None,
            ),
            ("following one joint", bound(whole(), |_| 1), Some(12)),
            (
                "a face that follows another joint",
                bound(whole(), |vertex| u32::from(vertex < 4)),
                None,
            ),
        ] {
            assert_eq!(built(mesh).parts[0].sides.outward_count(), wanted, "{what}");
        }
    }

    #[test]
    fn triangles_that_a_normal_turned_come_last() {
        let mut mesh = cube(Vec3::ZERO, 1.0);
        // Those of the first face.
        mesh.normals
            .iter_mut()
            .flatten()
            .take(4)
            .for_each(|normal| *normal = -*normal);
        let mesh = built(mesh);
        assert_eq!(mesh.parts[0].sides.outward_count(), Some(10));
        assert_eq!(mesh.draw_triangles()[..10], mesh.triangles()[2..]);
        let turned = [0, 1].map(|index: usize| {
            let [a, b, c] = mesh.triangles()[index];
            [a, c, b]
        });
        assert_eq!(mesh.draw_triangles()[10..], turned);
    }

    #[test]
    fn a_flat_bag_is_not_closed() {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let mesh = MeshDraft {
            positions: square.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
            normals: Some(vec![Vec3::Z; 4]),
            triangles: vec![[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]],
            ..MeshDraft::default()
        };
        assert_eq!(built(mesh).parts[0].sides.outward_count(), None);
    }

    #[test]
    fn many_vertices_in_one_place_do_not_take_long() {
        // All of them together, each with weights of its own: none is one with another.
        let count = 60_000u32;
        let mut mesh = MeshDraft {
            positions: (0..count)
                .map(|vertex| Vec3::splat(if vertex == 0 { 1.0 } else { 0.0 }))
                .collect(),
            triangles: (0..count - 2)
                .map(|vertex| [vertex, vertex + 1, vertex + 2])
                .collect(),
            ..MeshDraft::default()
        };
        mesh.influence_counts = vec![2; count as usize];
        mesh.influences = (0..count)
            .flat_map(|vertex| [(0, 1.0), (1, f64::from(vertex))])
            .collect();
        assert_eq!(built(mesh).parts[0].sides.outward_count(), None);
    }
}
