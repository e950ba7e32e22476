//! Meshes: counts and indices checked, weights and normals completed, triangles wound.

use super::{are_usable, finite};
use crate::rig::{
    Binding, Influence, Look, Mesh, MeshDraft, Part, PartDraft, RigProblem, Sides, Warnings,
};
use glam::Vec3;
use std::collections::BTreeMap;

/// Files print weights with four or five decimals; a sum further off than this was not meant to be 1.
const WEIGHT_SUM_TOLERANCE: f64 = 1e-3;

pub(super) struct MeshBuild<'a> {
    pub index: usize,
    pub mesh: MeshDraft,
    pub warnings: &'a mut Warnings,
}

impl MeshBuild<'_> {
    pub(super) fn build(
        mut self,
        name: String,
        bindings: &mut Vec<Binding>,
        [material_count, variant_count]: [usize; 2],
    ) -> Result<Mesh, RigProblem> {
        self.check_counts()?;
        self.check_numbers(&name)?;
        self.check_indices(bindings.len(), material_count)?;
        self.check_variants(material_count, variant_count)?;
        let (influence_starts, influences) = self.build_influences(&name, bindings);
        let normals = self.build_normals();
        let parts = self.build_parts();
        let mut mesh = self.mesh;
        for &original in &mesh.copies {
            mesh.positions.push(mesh.positions[original as usize]);
        }
        let draw_triangles = mesh
            .triangles
            .iter()
            .map(|&t| wound_about_normals(t, &mesh.positions, &normals))
            .collect();
        Ok(Mesh {
            name,
            has_negative_weights: influences.iter().any(|influence| influence.weight < 0.0),
            positions: mesh.positions,
            copies: mesh.copies,
            normals,
            texcoords: mesh.texcoords,
            colors: mesh.colors,
            influence_starts,
            influences,
            morph_starts: Vec::new(),
            morph_displacements: Vec::new(),
            triangles: mesh.triangles,
            draw_triangles,
            parts,
            // Found once morph targets are there too.
            binding_bounds: Vec::new(),
            morph_reach: Vec::new(),
        })
    }

    fn check_counts(&self) -> Result<(), RigProblem> {
        let vertices = self.mesh.positions.len();
        let draw_vertices = vertices + self.mesh.copies.len();
        let claimed: usize = self
            .mesh
            .influence_counts
            .iter()
            .map(|&count| count as usize)
            .sum();
        let counts = [
            (
                "normals",
                draw_vertices,
                self.mesh.normals.as_ref().map(Vec::len),
            ),
            (
                "texture coordinates",
                draw_vertices,
                self.mesh.texcoords.as_ref().map(Vec::len),
            ),
            (
                "vertex colors",
                draw_vertices,
                self.mesh.colors.as_ref().map(Vec::len),
            ),
            (
                "lists of influences",
                vertices,
                Some(self.mesh.influence_counts.len()).filter(|&count| count > 0),
            ),
        ];
        for (what, vertices, found) in counts {
            if let Some(found) = found.filter(|&found| found != vertices) {
                return Err(RigProblem::CountsDiffer {
                    mesh: self.index,
                    vertices,
                    what,
                    found,
                });
            }
        }
        let in_parts: usize = self.mesh.parts.iter().map(|part| part.triangle_count).sum();
        if !self.mesh.parts.is_empty() && in_parts != self.mesh.triangles.len() {
            let what = "triangles in its parts, which are not all it has";
            return Err(RigProblem::CountsDiffer {
                mesh: self.index,
                vertices,
                what,
                found: in_parts,
            });
        }
        if claimed != self.mesh.influences.len() {
            let (what, found) = (
                "influences in all, which its counts do not sum to",
                self.mesh.influences.len(),
            );
            return Err(RigProblem::CountsDiffer {
                mesh: self.index,
                vertices,
                what,
                found,
            });
        }
        Ok(())
    }

    fn check_numbers(&self, name: &str) -> Result<(), RigProblem> {
        let mesh = &self.mesh;
        finite(
            mesh.positions.iter().all(|p| are_usable(&p.to_array())),
            || format!("a position of mesh `{name}`"),
        )?;
        finite(
            mesh.normals
                .iter()
                .flatten()
                .all(|n| are_usable(&n.to_array())),
            || format!("a normal of mesh `{name}`"),
        )?;
        finite(
            mesh.texcoords
                .iter()
                .flatten()
                .all(|uv| are_usable(&uv.to_array())),
            || format!("a texture coordinate of mesh `{name}`"),
        )?;
        finite(
            mesh.colors
                .iter()
                .flatten()
                .all(|color| are_usable(&color.to_array())),
            || format!("a vertex color of mesh `{name}`"),
        )?;
        finite(
            mesh.influences.iter().all(|(_, weight)| weight.is_finite()),
            || format!("a weight of mesh `{name}`"),
        )
    }

    fn check_indices(&self, binding_count: usize, material_count: usize) -> Result<(), RigProblem> {
        let out_of_range = |what: &str, index: usize, target, found, count| {
            Err(RigProblem::OutOfRange {
                what: format!("{what} {index} of mesh {}", self.index),
                target,
                found,
                count,
            })
        };
        let vertex_count = self.mesh.positions.len();
        for (index, &original) in self.mesh.copies.iter().enumerate() {
            if original as usize >= vertex_count {
                return out_of_range("copy", index, "vertex", original as usize, vertex_count);
            }
        }
        let draw_vertex_count = vertex_count + self.mesh.copies.len();
        for (index, triangle) in self.mesh.triangles.iter().enumerate() {
            if let Some(&vertex) = triangle
                .iter()
                .find(|&&vertex| vertex as usize >= draw_vertex_count)
            {
                let found = vertex as usize;
                return out_of_range("triangle", index, "vertex", found, draw_vertex_count);
            }
        }
        for (index, &(binding, _)) in self.mesh.influences.iter().enumerate() {
            if binding as usize >= binding_count {
                return out_of_range(
                    "influence",
                    index,
                    "binding",
                    binding as usize,
                    binding_count,
                );
            }
        }
        let mut named = self.mesh.parts.iter().enumerate();
        match named.find(|(_, part)| part.material.is_some_and(|it| it >= material_count)) {
            Some((index, part)) => {
                let material = part.material.unwrap_or_default();
                out_of_range("part", index, "material", material, material_count)
            }
            None => Ok(()),
        }
    }

    fn check_variants(
        &self,
        material_count: usize,
        variant_count: usize,
    ) -> Result<(), RigProblem> {
        for (index, it) in self.mesh.in_variants.iter().enumerate() {
            let named = [
                ("part", it.part, self.mesh.parts.len()),
                ("variant", it.variant, variant_count),
                ("material", it.material, material_count),
            ];
            for (target, found, count) in named {
                if found >= count {
                    return Err(RigProblem::OutOfRange {
                        what: format!("choice {index} of variants of mesh {}", self.index),
                        target,
                        found,
                        count,
                    });
                }
            }
        }
        Ok(())
    }

    fn build_parts(&self) -> Vec<Part> {
        let whole = PartDraft {
            triangle_count: self.mesh.triangles.len(),
            material: None,
            is_flat: false,
        };
        let drafts = match self.mesh.parts.as_slice() {
            [] => std::slice::from_ref(&whole),
            parts => parts,
        };
        let mut start = 0;
        let part = |draft: &PartDraft| {
            let triangles = start..start + draft.triangle_count;
            start = triangles.end;
            Part {
                triangles,
                material: draft.material,
                in_variants: BTreeMap::new(),
                is_flat: draft.is_flat,
                // Found once influences and morph targets are there too.
                sides: Sides::Both,
                center: Vec3::ZERO,
                follows: 0,
            }
        };
        let mut parts: Vec<Part> = drafts.iter().map(part).collect();
        for it in &self.mesh.in_variants {
            let in_variants = parts[it.part].in_variants.entry(it.variant);
            in_variants.or_insert(Look {
                material: Some(it.material),
                sides: Sides::Both,
            });
        }
        parts
    }

    /// Weights are divided by their sum in f64. A vertex whose weights have no positive sum follows nothing, so it stays where it
    /// was modelled, as every vertex of a mesh without influences does.
    fn build_influences(
        &mut self,
        name: &str,
        bindings: &mut Vec<Binding>,
    ) -> (Vec<u32>, Vec<Influence>) {
        let vertex_count = self.mesh.positions.len();
        let mut starts = Vec::with_capacity(vertex_count + 1);
        let mut influences = Vec::with_capacity(self.mesh.influences.len().max(vertex_count));
        let mut world = None;
        let mut off_sums = 0usize;
        let mut unbound = 0usize;
        let mut first = 0;
        starts.push(0);
        for vertex in 0..vertex_count {
            let count = self
                .mesh
                .influence_counts
                .get(vertex)
                .map_or(0, |&count| count as usize);
            let of_vertex = &self.mesh.influences[first..first + count];
            first += count;
            let sum: f64 = of_vertex.iter().map(|(_, weight)| weight).sum();
            if sum > 0.0 && sum.is_finite() {
                off_sums += usize::from((sum - 1.0).abs() > WEIGHT_SUM_TOLERANCE);
                let first = influences.len();
                influences.extend(of_vertex.iter().map(|&(binding, weight)| Influence {
                    binding,
                    weight: (weight / sum) as f32,
                }));
                // Blending dual quaternions takes its signs from the first.
                let joint_of = |influence: &Influence| bindings[influence.binding as usize].joint;
                influences[first..].sort_by(|a, b| {
                    let by_weight = b.weight.total_cmp(&a.weight);
                    by_weight.then_with(|| joint_of(a).cmp(&joint_of(b)))
                });
            } else {
                unbound += 1;
                let binding = *world.get_or_insert_with(|| {
                    bindings.push(Binding::WORLD);
                    bindings.len() as u32 - 1
                });
                influences.push(Influence {
                    binding,
                    weight: 1.0,
                });
            }
            starts.push(influences.len() as u32);
        }
        for &original in &self.mesh.copies {
            let original = original as usize;
            influences.extend_from_within(starts[original] as usize..starts[original + 1] as usize);
            starts.push(influences.len() as u32);
        }
        if off_sums > 0 {
            self.warnings
                .push(|| format!("mesh `{name}`: the weights of {off_sums} vertices do not sum to 1; divided by their sum"));
        }
        if unbound > 0 && !self.mesh.influence_counts.is_empty() {
            self.warnings.push(|| {
                format!("mesh `{name}`: the weights of {unbound} vertices have no positive sum; they stay as modelled")
            });
        }
        (starts, influences)
    }

    fn build_normals(&mut self) -> Vec<Vec3> {
        let given = self.mesh.normals.take();
        let directions = |normals: &Vec<Vec3>| normals.iter().map(|n| direction(*n)).collect();
        if let Some(usable) = given.as_ref().and_then(directions) {
            return usable;
        }
        let (vertex_count, copies) = (self.mesh.positions.len(), &self.mesh.copies);
        let original = |vertex: u32| match (vertex as usize).checked_sub(vertex_count) {
            Some(copy) => copies[copy],
            None => vertex,
        };
        let mut computed = vec![Vec3::ZERO; vertex_count];
        for triangle in &self.mesh.triangles {
            let triangle = triangle.map(original);
            // Twice the triangle's area long, which is the weight that is wanted.
            let area_vector = face_vector(triangle, &self.mesh.positions);
            for corner in triangle {
                computed[corner as usize] += area_vector;
            }
        }
        for &original in copies {
            computed.push(computed[original as usize]);
        }
        let normals = given.unwrap_or_else(|| vec![Vec3::ZERO; computed.len()]);
        normals
            .iter()
            .zip(computed)
            // A vertex of no triangle, or of flat ones only, has no normal to find; any will do.
            .map(|(given, computed)| {
                direction(*given).unwrap_or_else(|| computed.normalize_or(Vec3::Y))
            })
            .collect()
    }
}

/// How many influences the copies of a mesh have.
pub(super) fn influences_of_copies(mesh: &MeshDraft) -> usize {
    let count = |original: &u32| mesh.influence_counts.get(*original as usize);
    let counts = mesh.copies.iter().filter_map(count);
    counts.map(|&count| count as usize).sum()
}

/// Of a vector of any length but 0, also where its square is too small for f32.
fn direction(vector: Vec3) -> Option<Vec3> {
    vector.as_dvec3().try_normalize().map(|unit| unit.as_vec3())
}

fn face_vector([a, b, c]: [u32; 3], positions: &[Vec3]) -> Vec3 {
    let [a, b, c] = [a, b, c].map(|corner| positions[corner as usize]);
    (b - a).cross(c - a)
}

fn wound_about_normals(triangle: [u32; 3], positions: &[Vec3], normals: &[Vec3]) -> [u32; 3] {
    let [a, b, c] = triangle;
    let normal_sum: Vec3 = triangle
        .iter()
        .map(|&corner| normals[corner as usize])
        .sum();
    if face_vector(triangle, positions).dot(normal_sum) < 0.0 {
        [a, c, b]
    } else {
        triangle
    }
}
