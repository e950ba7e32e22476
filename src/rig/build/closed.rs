//! Whether a surface encloses a volume, so that its far side can never be seen. Found once at load.

use crate::rig::{Facing, Mesh};
use glam::DVec3;
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};

/// Of the size of a mesh: vertices this close are one, where they also move alike.
const WELD: f64 = 1e-6;

/// `None` of a surface that has an edge, or whose parts do not all face the same way.
///
/// It is closed if along each edge as many triangles run one way as run the other: then the boundary is nothing. Which way it faces is
/// told by the sign of the volume, a sum of tetrahedra, of each part by itself.
pub(super) fn facing(mesh: &Mesh) -> Option<Facing> {
    let welded = weld(mesh)?;
    let triangles: Vec<[u32; 3]> = mesh
        .draw_triangles
        .iter()
        .map(|triangle| triangle.map(|corner| welded[corner as usize]))
        // What fell into a line or a point has no side.
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    if triangles.is_empty() || !has_no_boundary(&triangles) {
        return None;
    }
    let volumes = volumes(mesh, &triangles);
    let mut volumes = volumes.into_iter();
    if volumes.clone().all(|volume| volume > 0.0) {
        Some(Facing::Outward)
    } else if volumes.all(|volume| volume < 0.0) {
        Some(Facing::Inward)
    } else {
        None
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

fn has_no_boundary(triangles: &[[u32; 3]]) -> bool {
    // An edge as one number, its lower vertex first, and which way it is run.
    let mut edges: Vec<(u64, i64)> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(from, to)| {
            let (low, high) = (from.min(to), from.max(to));
            let way = if from == low { 1 } else { -1 };
            (u64::from(low) << 32 | u64::from(high), way)
        })
        .collect();
    edges.sort_unstable();
    edges
        .chunk_by(|a, b| a.0 == b.0)
        .all(|edge| edge.iter().map(|(_, way)| way).sum::<i64>() == 0)
}

/// Six times the volume of each part that hangs together.
fn volumes(mesh: &Mesh, triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut parts: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for &[a, b, c] in triangles {
        for other in [b, c] {
            let (one, other) = (root(&mut parts, a), root(&mut parts, other));
            parts[other as usize] = one;
        }
    }
    // From a point of the mesh itself: far from the origin little would be left of the sum.
    let origin = mesh.positions[triangles[0][0] as usize].as_dvec3();
    let mut volumes: Vec<Option<f64>> = vec![None; mesh.positions.len()];
    for triangle in triangles {
        let part = root(&mut parts, triangle[0]) as usize;
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize].as_dvec3() - origin);
        *volumes[part].get_or_insert(0.0) += a.dot(b.cross(c));
    }
    volumes.into_iter().flatten().collect()
}

/// Of the part that a vertex is of, shortening the way there.
fn root(parts: &mut [u32], mut vertex: u32) -> u32 {
    while parts[vertex as usize] != vertex {
        parts[vertex as usize] = parts[parts[vertex as usize] as usize];
        vertex = parts[vertex as usize];
    }
    vertex
}

#[cfg(test)]
mod tests {
    use crate::limits::Limits;
    use crate::rig::{
        BindingDraft, Draft, Facing, JointDraft, Limit, Mesh, MeshDraft, RotationOrder,
    };
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
            name: String::new(),
            parent,
            offset: DVec3::Y,
            rotation_order: RotationOrder::Zyx,
            rest_angles: DVec3::ZERO,
            rotation_limits: [Limit::NONE; 3],
            translates: false,
            bounding_box: None,
        };
        let binding = |joint| BindingDraft {
            joint: Some(joint),
            bind_from_joint: DAffine3::IDENTITY,
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
        let far = || cube(Vec3::ZERO, 1.0);
        for (what, mesh, wanted) in [
            ("a cube", whole(), Some(Facing::Outward)),
            (
                "a cube seen from within",
                turned_in(whole()),
                Some(Facing::Inward),
            ),
            ("without a triangle", open, None),
            ("with a corner that is off", torn, None),
            (
                "with a corner that is hardly off",
                nearly,
                Some(Facing::Outward),
            ),
            (
                "with a triangle that is a line",
                folded,
                Some(Facing::Outward),
            ),
            ("two cubes", and(whole(), far()), Some(Facing::Outward)),
            (
                "two that face otherwise",
                and(whole(), turned_in(far())),
                None,
            ),
            (
                "nothing",
                MeshDraft {
                    positions: vec![Vec3::X; 3],
                    ..MeshDraft::default()
                },
                None,
            ),
            (
                "following one joint",
                bound(whole(), |_| 1),
                Some(Facing::Outward),
            ),
            (
                "a face that follows another joint",
                bound(whole(), |vertex| u32::from(vertex < 4)),
                None,
            ),
        ] {
            assert_eq!(built(mesh).facing(), wanted, "{what}");
        }
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
        assert_eq!(built(mesh).facing(), None);
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
        assert_eq!(built(mesh).facing(), None);
    }
}
