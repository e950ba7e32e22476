//! Morph targets: from lists of vertices to what each vertex gathers.

use super::{are_usable, finite, is_usable};
use crate::limits::Limits;
use crate::rig::{
    Mesh, Morph, MorphDisplacement, MorphDraft, MorphForm, RigError, RigProblem, names,
};
use glam::Vec3;

/// Gives each mesh the displacements of its own targets.
pub(super) fn build(
    drafts: Vec<MorphDraft>,
    meshes: &mut [Mesh],
    limits: &Limits,
) -> Result<Vec<Morph>, RigError> {
    limits.morph_targets(drafts.len())?;
    let listed = drafts
        .iter()
        .map(|morph| morph.positions.len() + morph.normals.len());
    limits.morph_displacements(listed.sum::<usize>())?;
    let unique_names = names::unique("morph", drafts.iter().map(|morph| morph.name.as_str()));
    // Of each mesh: what its vertices gather, not yet in their order.
    let mut gathered: Vec<Vec<(u32, MorphDisplacement)>> = vec![Vec::new(); meshes.len()];
    let mut morphs = Vec::with_capacity(drafts.len());
    for (index, (draft, name)) in drafts.into_iter().zip(unique_names).enumerate() {
        let Some(mesh) = meshes.get(draft.mesh) else {
            let problem = RigProblem::OutOfRange {
                what: format!("morph target {index}"),
                target: "mesh",
                found: draft.mesh,
                count: meshes.len(),
            };
            return Err(problem.of(draft.file.as_ref()));
        };
        let displacements = checked(index, &name, &draft, mesh);
        let displacements = displacements.map_err(|problem| problem.of(draft.file.as_ref()))?;
        morphs.push(Morph {
            name,
            mesh: draft.mesh,
            vertex_count: displacements.len(),
            rest: draft.rest,
        });
        gathered[draft.mesh].extend(displacements);
    }
    for (mesh, mut of_mesh) in meshes.iter_mut().zip(gathered) {
        if of_mesh.is_empty() {
            continue;
        }
        // Stable: targets stay in load order, so that sums are the same everywhere.
        of_mesh.sort_by_key(|(vertex, _)| *vertex);
        let mut starts = vec![0u32; mesh.vertex_count() + 1];
        for (vertex, _) in &of_mesh {
            starts[*vertex as usize + 1] += 1;
        }
        for vertex in 1..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let displacements = of_mesh.into_iter().map(|(_, displacement)| displacement);
        let mut displacements: Vec<_> = displacements.collect();
        for &original in &mesh.copies {
            let original = original as usize;
            let own = starts[original] as usize..starts[original + 1] as usize;
            limits.morph_displacements(displacements.len() + own.len())?;
            displacements.extend_from_within(own);
            starts.push(displacements.len() as u32);
        }
        mesh.morph_starts = starts;
        mesh.morph_displacements = displacements;
    }
    Ok(morphs)
}

/// Those of a target called `name`, all finite.
fn checked(
    index: usize,
    name: &str,
    draft: &MorphDraft,
    mesh: &Mesh,
) -> Result<Vec<(u32, MorphDisplacement)>, RigProblem> {
    finite(is_usable(&[draft.rest]), || {
        format!("the weight of morph target `{name}`")
    })?;
    let displacements = displacements(index, draft, mesh)?;
    finite(
        displacements
            .iter()
            .all(|(_, d)| are_usable(&d.position.to_array()) && are_usable(&d.normal.to_array())),
        || format!("a vertex of morph target `{name}`"),
    )?;
    Ok(displacements)
}

/// One of each vertex that the target lists, in the order of vertices.
fn displacements(
    morph: usize,
    draft: &MorphDraft,
    mesh: &Mesh,
) -> Result<Vec<(u32, MorphDisplacement)>, RigProblem> {
    let of_file = ..mesh.vertex_count();
    let positions = ordered(morph, draft, &draft.positions, &mesh.positions[of_file])?;
    let normals = ordered(morph, draft, &draft.normals, &mesh.normals[of_file])?;
    let (mut positions, mut normals) = (
        positions.into_iter().peekable(),
        normals.into_iter().peekable(),
    );
    let mut displacements = Vec::new();
    loop {
        let next = [positions.peek(), normals.peek()];
        let Some(vertex) = next.into_iter().flatten().map(|(vertex, _)| *vertex).min() else {
            return Ok(displacements);
        };
        let take = |listed: &mut std::iter::Peekable<std::vec::IntoIter<(u32, Vec3)>>| {
            listed
                .next_if(|(listed, _)| *listed == vertex)
                .map_or(Vec3::ZERO, |(_, moved)| moved)
        };
        let displacement = MorphDisplacement {
            morph: morph as u32,
            position: take(&mut positions),
            normal: take(&mut normals),
        };
        displacements.push((vertex, displacement));
    }
}

/// By how much each listed vertex differs from the mesh's own, in the order of vertices.
fn ordered(
    morph: usize,
    draft: &MorphDraft,
    listed: &[(u32, Vec3)],
    own: &[Vec3],
) -> Result<Vec<(u32, Vec3)>, RigProblem> {
    let mut moved = Vec::with_capacity(listed.len());
    for (index, &(vertex, target)) in listed.iter().enumerate() {
        let Some(own) = own.get(vertex as usize) else {
            return Err(RigProblem::OutOfRange {
                what: format!("entry {index} of morph target {morph}"),
                target: "vertex",
                found: vertex as usize,
                count: own.len(),
            });
        };
        let displacement = match draft.form {
            MorphForm::Targets => target - *own,
            MorphForm::Displacements => target,
        };
        moved.push((vertex, displacement));
    }
    moved.sort_by_key(|(vertex, _)| *vertex);
    match moved.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(RigProblem::VertexTwice {
            morph,
            vertex: pair[0].0,
        }),
        None => Ok(moved),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::{BindPose, BindingDraft, Draft, JointDraft, MeshDraft};
    use glam::DAffine3;

    fn triangle() -> MeshDraft {
        MeshDraft {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: Some(vec![Vec3::Z; 3]),
            triangles: vec![[0, 1, 2]],
            ..MeshDraft::default()
        }
    }

    fn built(morphs: Vec<MorphDraft>) -> Result<crate::rig::Rig, RigProblem> {
        let meshes = vec![triangle()];
        Draft {
            meshes,
            morphs,
            ..Draft::default()
        }
        .build(&Limits::default())
        .map_err(|error| error.problem)
    }

    #[test]
    fn each_vertex_gathers_what_targets_list_of_it() {
        let first = MorphDraft {
            positions: vec![(2, Vec3::Y * 3.0), (0, Vec3::Z)],
            normals: vec![(2, Vec3::X)],
            ..MorphDraft::default()
        };
        let second = MorphDraft {
            name: "smile".to_owned(),
            positions: vec![(2, Vec3::ZERO)],
            ..MorphDraft::default()
        };
        let rig = built(vec![first, second]).expect("it is right");
        let mesh = &rig.meshes()[0];
        let of = |vertex| -> Vec<_> {
            let displacements = mesh.morph_displacements_of(vertex).iter();
            displacements
                .map(|d| (d.morph, d.position, d.normal))
                .collect()
        };
        assert_eq!(of(0), [(0, Vec3::Z, Vec3::ZERO)]);
        assert_eq!(of(1), []);
        let turned = Vec3::X - Vec3::Z;
        assert_eq!(
            of(2),
            [(0, Vec3::Y * 2.0, turned), (1, -Vec3::Y, Vec3::ZERO)]
        );
        let names: Vec<_> = rig
            .dofs()
            .all()
            .iter()
            .map(|dof| dof.name.as_str())
            .collect();
        assert_eq!(names, ["morph.morph_0", "morph.smile"]);
    }

    #[test]
    fn a_copy_follows_and_changes_as_its_vertex_does() {
        let mesh = || MeshDraft {
            copies: vec![2, 0],
            normals: Some(vec![Vec3::Z, Vec3::Z, Vec3::ZERO, Vec3::X, Vec3::ZERO]),
            triangles: vec![[0, 1, 3], [4, 1, 2]],
            influence_counts: vec![1, 1, 2],
            influences: vec![(0, 1.0), (1, 1.0), (0, 0.75), (1, 0.25)],
            ..triangle()
        };
        let joint = |parent| JointDraft {
            parent,
            ..JointDraft::default()
        };
        let binding = |joint| BindingDraft {
            joint: Some(joint),
            file: None,
            bind_pose: BindPose::JointFromBind(DAffine3::IDENTITY),
        };
        let built = |mesh, limits| {
            let moved = MorphDraft {
                positions: vec![(2, Vec3::Y * 3.0), (1, Vec3::ZERO)],
                ..MorphDraft::default()
            };
            let draft = Draft {
                joints: vec![joint(None), joint(Some(0))],
                bindings: vec![binding(0), binding(1)],
                meshes: vec![mesh],
                morphs: vec![moved],
                ..Draft::default()
            };
            draft.build(&limits).map_err(|error| error.problem)
        };
        let rig = built(mesh(), Limits::default()).expect("it is right");
        let of_rig = &rig.meshes()[0];
        assert_eq!((rig.vertex_count(), rig.draw_vertex_count()), (3, 5));
        assert_eq!(rig.morphs()[0].vertex_count, 2);
        let file_triangles: Vec<_> = of_rig.file_triangles().collect();
        assert_eq!(file_triangles, [[0, 1, 2], [0, 1, 2]]);
        for (copy, original) in [(3, 2), (4, 0)] {
            let moved = |vertex| of_rig.morph_displacements_of(vertex);
            assert_eq!(moved(copy), moved(original));
            let influences = |vertex| of_rig.influences_of(vertex);
            assert_eq!(influences(copy), influences(original));
            assert_eq!(of_rig.positions()[copy], of_rig.positions()[original]);
        }
        // Computed of what is around the vertex, whichever of its copies that is drawn with.
        let normals = [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::X, Vec3::Z];
        assert_eq!(of_rig.normals(), normals);

        let limits = Limits {
            vertices: 4,
            ..Limits::default()
        };
        assert!(matches!(built(mesh(), limits), Err(RigProblem::Limit(_))));
        let limits = Limits {
            influences: 6,
            ..Limits::default()
        };
        assert!(matches!(built(mesh(), limits), Err(RigProblem::Limit(_))));
        let limits = Limits {
            morph_displacements: 2,
            ..Limits::default()
        };
        assert!(matches!(built(mesh(), limits), Err(RigProblem::Limit(_))));
        let no_such = MeshDraft {
            copies: vec![2, 3],
            ..mesh()
        };
        let found = built(no_such, Limits::default());
        assert!(matches!(
            found,
            Err(RigProblem::OutOfRange { found: 3, .. })
        ));
        let too_few = MeshDraft {
            normals: Some(vec![Vec3::Z; 3]),
            ..mesh()
        };
        let found = built(too_few, Limits::default());
        assert!(matches!(found, Err(RigProblem::CountsDiffer { .. })));
    }

    #[test]
    fn what_contradicts_the_mesh_is_refused() {
        let of = |positions, mesh| MorphDraft {
            positions,
            mesh,
            ..MorphDraft::default()
        };
        let past_the_end = built(vec![of(vec![(3, Vec3::ZERO)], 0)]);
        assert!(matches!(
            past_the_end,
            Err(RigProblem::OutOfRange {
                found: 3,
                count: 3,
                ..
            })
        ));
        let twice = built(vec![of(vec![(1, Vec3::ZERO), (1, Vec3::X)], 0)]);
        assert!(matches!(
            twice,
            Err(RigProblem::VertexTwice {
                morph: 0,
                vertex: 1
            })
        ));
        assert!(built(vec![of(Vec::new(), 1)]).is_err());
        assert!(built(vec![of(vec![(1, Vec3::NAN)], 0)]).is_err());
    }
}
