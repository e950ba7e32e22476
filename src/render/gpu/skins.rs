//! What a submission skins: each distinct skin once, all of it where a picture shows it, else only the meshes that somebody asked for.
//! Never lives here: skinning.

use crate::render::{Plan, Skin};
use crate::rig::Mesh;
use crate::scene::VertexQuery;
use std::collections::BTreeSet;

/// A skin that pictures show, or whose vertices are asked for.
pub(super) struct RequiredSkin<'a> {
    pub skin: &'a Skin,
    /// Those to skin, in the rig's meshes; at least one, and each has vertices.
    pub meshes: BTreeSet<usize>,
}

/// No two of them are the same.
#[derive(Default)]
pub(super) struct SkinSet<'a>(Vec<RequiredSkin<'a>>);

impl<'a> SkinSet<'a> {
    pub(super) fn of(plans: &[&'a Plan]) -> Self {
        let mut skins = Self::default();
        for plan in plans {
            for skin in plan.drawn_skins() {
                skins.add_drawn(skin);
            }
            for query in plan.vertices.iter().filter(|query| asks_for_any(query)) {
                skins.add(plan.instances[query.instance].skin(), query.mesh);
            }
        }
        skins
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &RequiredSkin<'a>> {
        self.0.iter()
    }

    /// Index of a skin among them; `None` where nothing of it was asked for.
    pub(super) fn position(&self, skin: &Skin) -> Option<usize> {
        self.0.iter().position(|required| required.skin == skin)
    }

    /// All of it, if there is anything to draw.
    fn add_drawn(&mut self, skin: &'a Skin) {
        let meshes = skin.rig().meshes();
        let is_drawn = |mesh: &Mesh| !mesh.draw_triangles().is_empty();
        if meshes.iter().any(is_drawn) {
            // Also those without triangles, so that it is one run of vertices, counted from the rig's first.
            let there = meshes.iter().enumerate();
            let there = there.filter(|(_, mesh)| mesh.vertex_count() > 0);
            there.for_each(|(mesh, _)| self.add(skin, mesh));
        }
    }

    fn add(&mut self, skin: &'a Skin, mesh: usize) {
        let index = self.position(skin).unwrap_or_else(|| {
            let meshes = BTreeSet::new();
            self.0.push(RequiredSkin { skin, meshes });
            self.0.len() - 1
        });
        self.0[index].meshes.insert(mesh);
    }
}

fn asks_for_any(query: &VertexQuery) -> bool {
    query.count > 0 && (query.positions || query.normals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::{Posed, Skinning};
    use crate::render::fixtures;
    use crate::scene::{Shape, ShowSkin};
    use std::sync::Arc;

    fn posed() -> Arc<Posed> {
        fixtures::posed(3)
    }

    fn picture(posed: &Arc<Posed>, skin: ShowSkin) -> Plan {
        fixtures::picture(posed, Skinning::Linear, skin)
    }

    fn vertices(posed: &Arc<Posed>, skinning: Skinning, queries: &[(usize, usize)]) -> Plan {
        let query = |&(mesh, count)| VertexQuery {
            instance: 0,
            mesh,
            start: 0,
            count,
            positions: true,
            normals: false,
        };
        let queries = queries.iter().map(query).collect();
        Plan::vertices(Arc::clone(posed), skinning, Shape::Posed, queries)
    }

    /// The meshes of each.
    fn skinned(plans: &[Plan]) -> Vec<Vec<usize>> {
        let plans: Vec<&Plan> = plans.iter().collect();
        let skins = SkinSet::of(&plans);
        let meshes = skins.iter().map(|skin| skin.meshes.iter().copied());
        meshes.map(Iterator::collect).collect()
    }

    #[test]
    fn a_skin_is_made_once_however_many_ask_for_it() {
        let (one, other) = (posed(), posed());
        let linear = |queries: &[(usize, usize)]| vertices(&one, Skinning::Linear, queries);
        let shown = |posed| picture(posed, ShowSkin::default());
        let plans = [
            linear(&[(2, 3)]),
            shown(&one),
            shown(&one),
            linear(&[(0, 1), (2, 1)]),
        ];
        assert_eq!(skinned(&plans), [[0, 1, 2]]);
        let apart = [
            shown(&one),
            shown(&other),
            vertices(&one, Skinning::DualQuaternion, &[(1, 3)]),
        ];
        assert_eq!(skinned(&apart), [vec![0, 1, 2], vec![0, 1, 2], vec![1]]);
    }

    #[test]
    fn nothing_is_skinned_that_nobody_asked_for() {
        let posed = posed();
        let some = vertices(&posed, Skinning::Linear, &[(2, 1), (0, 0)]);
        assert_eq!(skinned(&[some]), [[2]]);
        let none = vertices(&posed, Skinning::Linear, &[(1, 0)]);
        let hidden = picture(&posed, ShowSkin::None);
        assert_eq!(skinned(&[none, hidden]), Vec::<Vec<usize>>::new());
    }
}
