//! Meshes: each node that has one draws it by itself, its primitives one after another. Never lives here: materials.

use super::accessors::Accessors;
use super::attributes::{COLORS, INDICES, TEXCOORDS, VECTORS, VertexReader};
use super::influences::{self, Bound};
use super::materials::Materials;
use super::nodes::Nodes;
use super::skins::Skins;
use super::variants::Variants;
use crate::formats::error::LoadError;
use crate::limits::Limits;
use crate::rig::{Draft, MeshDraft, MorphDraft, MorphForm, PartDraft, PartInVariant};
use glam::{Vec2, Vec3, Vec4};
use gltf_json::accessor::Accessor;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Index, Mesh};
use std::collections::HashMap;

/// What meshes are read with.
pub(super) struct MeshReader<'a, 'm> {
    pub accessors: Accessors<'a>,
    pub nodes: &'a Nodes,
    pub limits: &'a Limits,
    pub skins: Skins<'a>,
    pub materials: &'m mut Materials<'a>,
    pub variants: &'m Variants<'a>,
    pub draft: &'m mut Draft,
    /// Of all meshes so far.
    pub totals: Totals,
    /// By mesh of the file.
    pub target_names: HashMap<usize, Vec<String>>,
    /// By node, which morph targets its mesh has in the draft: the first, and how many.
    pub morphs_of: Vec<Option<(usize, usize)>>,
}

/// How far from 1 the length of a normal of bytes can be, which the Khronos validator allows all.
const NORMAL_TOLERANCE: f32 = 0.00674;

/// How much there is of what has a ceiling.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Totals {
    vertices: usize,
    triangles: usize,
    influences: usize,
    displacements: usize,
}

impl MeshReader<'_, '_> {
    /// Adds the mesh of every node of the scene that has one, in the order of joints.
    pub(super) fn read(&mut self) -> Result<(), LoadError> {
        let root = self.accessors.root;
        for (joint, &index) in self.nodes.node_of.iter().enumerate() {
            let node = &root.nodes[index];
            let Some(mesh) = node.mesh.filter(|_| self.nodes.is_in_scene[index]) else {
                continue;
            };
            let path = format!("nodes[{index}].mesh");
            let faults = self.accessors.faults;
            let of_node = faults.get(&root.meshes, "meshes", mesh, &path)?;
            let path = format!("meshes[{}]", mesh.value());
            let skin = node.skin;
            let skin = skin.map(|skin| self.skins.bindings(skin, self.nodes, self.draft));
            let bound = Bound {
                joint,
                skin: skin.transpose()?,
            };
            let name = node.name.as_ref().or(of_node.name.as_ref());
            let name = name.map(String::as_str);
            let mut draft = MeshDraft {
                name: faults.name(name, &path, &mut self.draft.warnings),
                ..MeshDraft::default()
            };
            let first_morph = self.draft.morphs.len();
            self.add_morphs(mesh, of_node, &path, node.weights.as_deref())?;
            for (place, primitive) in of_node.primitives.iter().enumerate() {
                let path = format!("{path}.primitives[{place}]");
                self.add_primitive(&mut draft, primitive, &path, &bound, first_morph)?;
            }
            if draft.positions.is_empty() {
                // Nothing of it is drawn, and nothing of it can be moved.
                self.draft.morphs.truncate(first_morph);
                continue;
            }
            self.morphs_of[index] = Some((first_morph, self.draft.morphs.len() - first_morph));
            self.draft.meshes.push(draft);
        }
        Ok(())
    }

    /// The morph targets of a mesh, still without what they move.
    fn add_morphs(
        &mut self,
        of_file: Index<Mesh>,
        mesh: &Mesh,
        path: &str,
        of_node: Option<&[f32]>,
    ) -> Result<(), LoadError> {
        let faults = self.accessors.faults;
        let count = |primitive: &Primitive| primitive.targets.as_ref().map_or(0, Vec::len);
        let targets = mesh.primitives.first().map_or(0, count);
        if let Some(other) = mesh.primitives.iter().find(|it| count(it) != targets) {
            let expected = format!("{targets} morph targets in every primitive");
            return Err(faults.load(path, expected, count(other).to_string()));
        }
        let weights = of_node.or(mesh.weights.as_deref()).unwrap_or_default();
        if !weights.is_empty() && weights.len() != targets {
            let expected = match targets {
                0 => "no weights, for it has no morph targets".to_owned(),
                _ => format!("{targets} weights, one for each morph target"),
            };
            return Err(faults.load(path, expected, weights.len().to_string()));
        }
        self.limits
            .morph_targets(self.draft.morphs.len() + targets)?;
        if targets == 0 {
            return Ok(());
        }
        let names = self.target_names.entry(of_file.value());
        let names = names.or_insert_with(|| target_names(mesh));
        for target in 0..targets {
            self.draft.morphs.push(MorphDraft {
                name: faults.name(
                    names.get(target).map(String::as_str),
                    path,
                    &mut self.draft.warnings,
                ),
                mesh: self.draft.meshes.len(),
                form: MorphForm::Displacements,
                rest: weights.get(target).copied().map_or(0.0, f64::from),
                ..MorphDraft::default()
            });
        }
        Ok(())
    }

    /// Adds a primitive's vertices and triangles to its mesh, and what its targets do to its morph targets.
    fn add_primitive(
        &mut self,
        mesh: &mut MeshDraft,
        primitive: &Primitive,
        path: &str,
        bound: &Bound,
        first_morph: usize,
    ) -> Result<(), LoadError> {
        let (faults, accessors) = (self.accessors.faults, self.accessors);
        let modes = "a mode of the specification";
        let mode = faults.valid(primitive.mode, &format!("{path}.mode"), modes)?;
        let positions = attribute(primitive, Semantic::Positions);
        let skipped = match (mode, positions) {
            (Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip, _) => {
                "is not made of triangles"
            }
            (_, None) => "has no positions",
            (_, Some(_)) => "",
        };
        let Some(positions) = positions.filter(|_| skipped.is_empty()) else {
            let warning = || faults.warning(&format!("{path} {skipped} and is left out"));
            self.draft.warnings.push(warning);
            return Ok(());
        };
        let extensions = primitive.extensions.as_ref().map(|it| &it.others);
        for &accessor in primitive.attributes.values().chain(&primitive.indices) {
            accessors.check_brought(accessor, extensions, path)?;
        }
        let first = mesh.positions.len();
        let count = accessors.count(positions, &format!("{path}.attributes.POSITION"))?;
        self.totals.vertices = self.totals.vertices.saturating_add(count);
        self.limits.vertices(self.totals.vertices)?;
        let read = VertexReader {
            accessors,
            path,
            count,
        };
        let positions = read.vectors::<3>(positions, "POSITION", VECTORS)?;
        mesh.positions
            .extend(positions.into_iter().map(Vec3::from_array));
        let material = self.materials.index(primitive.material, path, self.draft)?;
        let textured = self.add_variants(mesh, primitive, path, material);
        self.add_attributes(mesh, primitive, &read, textured)?;

        let before = self.totals.influences;
        let check_limit = |more: usize| Ok(self.limits.influences(before.saturating_add(more))?);
        let first_influence = mesh.influences.len();
        let of_node = || self.skins.rigid(bound.joint, self.draft);
        let violations = influences::add(mesh, primitive, &read, bound, of_node, check_limit)?;
        violations.warn(faults, path, &mut self.draft.warnings);
        self.totals.influences += mesh.influences.len() - first_influence;
        self.add_displacements(primitive, &read, first as u32, first_morph)?;
        let triangle_count = self.add_triangles(mesh, primitive, mode, &read, first as u32)?;
        mesh.parts.push(PartDraft {
            triangle_count,
            material: Some(material),
            is_flat: attribute(primitive, Semantic::Normals).is_none(),
        });
        Ok(())
    }

    /// What the next part of a mesh is made of in variants. Of all its materials, the file's own first, the first that has textures says on which
    /// texture coordinates all lie; that one is given back.
    fn add_variants(
        &mut self,
        mesh: &mut MeshDraft,
        primitive: &Primitive,
        path: &str,
        material: usize,
    ) -> usize {
        let Accessors { faults, root, .. } = self.accessors;
        let warnings = &mut self.draft.warnings;
        let materials = &*self.materials;
        let mut chosen = self.variants.of_primitive(primitive, path, root, warnings);
        chosen.retain(|(_, material)| !materials.is_left_out(*material));
        let all = chosen.iter().map(|(_, material)| *material);
        let mut all = std::iter::once(material).chain(all);
        let textured = all.find(|&material| materials.is_textured(material));
        let textured = textured.unwrap_or(material);
        for (variant, material) in chosen {
            let [set, wanted] = [textured, material].map(|it| materials.texcoord_set(it));
            if materials.is_textured(material) && set != wanted {
                let sentence = format!(
                    "{path} keeps its own material in variant {variant}: materials[{material}] lies on TEXCOORD_{wanted}, and another on TEXCOORD_{set}"
                );
                warnings.push(|| faults.warning(&sentence));
                continue;
            }
            mesh.in_variants.push(PartInVariant {
                part: mesh.parts.len(),
                variant,
                material,
            });
        }
        textured
    }

    /// Normals, texture coordinates and colors of the vertices that a mesh was just given. What some primitives of it have, all get.
    fn add_attributes(
        &mut self,
        mesh: &mut MeshDraft,
        primitive: &Primitive,
        read: &VertexReader<'_>,
        material: usize,
    ) -> Result<(), LoadError> {
        let count = mesh.positions.len();
        let first = count - read.count;
        if let Some(normals) = attribute(primitive, Semantic::Normals) {
            let given = read.vectors::<3>(normals, "NORMAL", VECTORS)?;
            let is_unit =
                |it: &&[f32; 3]| (Vec3::from_array(**it).length() - 1.0).abs() <= NORMAL_TOLERANCE;
            let others = given.len() - given.iter().filter(is_unit).count();
            self.warn_of(read, "NORMAL", others, "of another length than 1");
            let all = mesh.normals.get_or_insert_default();
            // Of primitives without, they are worked out.
            all.resize(first, Vec3::ZERO);
            all.extend(given.into_iter().map(Vec3::from_array));
        }
        if let Some(normals) = &mut mesh.normals {
            normals.resize(count, Vec3::ZERO);
        }
        let set = self.materials.texcoord_set(material);
        match attribute(primitive, Semantic::TexCoords(set)) {
            Some(texcoords) => {
                let name = format!("TEXCOORD_{set}");
                let given = read.vectors::<2>(texcoords, &name, TEXCOORDS)?;
                let all = mesh.texcoords.get_or_insert_default();
                all.resize(first, Vec2::ZERO);
                // The file has them from the top.
                all.extend(given.into_iter().map(|[u, v]| Vec2::new(u, 1.0 - v)));
            }
            None if self.materials.is_textured(material) => {
                let (faults, path) = (self.accessors.faults, read.path);
                let warning =
                    || faults.warning(&format!("{path} has no TEXCOORD_{set} for its textures"));
                self.draft.warnings.push(warning);
            }
            None => {}
        }
        if let Some(texcoords) = &mut mesh.texcoords {
            texcoords.resize(count, Vec2::ZERO);
        }
        if let Some(colors) = attribute(primitive, Semantic::Colors(0)) {
            let (floats, width) = read.floats(colors, "COLOR_0", COLORS)?;
            let is_light = |number: &&f32| (0.0..=1.0).contains(*number);
            let others = floats.len() - floats.iter().filter(is_light).count();
            self.warn_of(read, "COLOR_0", others, "below 0 or above 1");
            let all = mesh.colors.get_or_insert_default();
            all.resize(first, Vec4::ONE);
            let color = |color: &[f32]| {
                Vec3::from_slice(color).extend(color.get(3).copied().unwrap_or(1.0))
            };
            all.extend(floats.chunks_exact(width).map(color));
        }
        if let Some(colors) = &mut mesh.colors {
            colors.resize(count, Vec4::ONE);
        }
        Ok(())
    }

    /// Where there are numbers of an attribute that the specification does not allow.
    fn warn_of(&mut self, read: &VertexReader<'_>, attribute: &str, count: usize, which: &str) {
        if count > 0 {
            let (faults, path) = (read.accessors.faults, read.path);
            let warning = || faults.warning(&format!("{path}.{attribute} has {count} {which}"));
            self.draft.warnings.push(warning);
        }
    }

    /// Those of a primitive whose vertices start at `first_vertex` of its mesh, and how many they are.
    fn add_triangles(
        &mut self,
        mesh: &mut MeshDraft,
        primitive: &Primitive,
        mode: Mode,
        read: &VertexReader<'_>,
        first_vertex: u32,
    ) -> Result<usize, LoadError> {
        let (accessors, vertices) = (self.accessors, read.count);
        let path = format!("{}.indices", read.path);
        let corners = match primitive.indices {
            None => vertices,
            Some(indices) => accessors.count(indices, &path)?,
        };
        let total = &mut self.totals.triangles;
        *total = total.saturating_add(triangle_count(mode, corners));
        self.limits.triangles(*total)?;
        let indices = match primitive.indices {
            None => (0..vertices as u32).collect(),
            Some(indices) => accessors.integers(indices, &path, INDICES)?.0,
        };
        if let Some(place) = indices.iter().position(|&index| index as usize >= vertices) {
            let path = format!("{path}, index {place}");
            let expected = format!("one of the {vertices} vertices");
            let found = indices[place].to_string();
            return Err(accessors.faults.load(&path, expected, found));
        }
        if let Some(restart) = primitive.indices.and_then(|it| accessors.largest_index(it)) {
            let restarts = indices.iter().filter(|&&index| index == restart).count();
            self.warn_of(
                read,
                "indices",
                restarts,
                "that stand for a restart, not for a vertex",
            );
        }
        if indices.len() < 3 || (mode == Mode::Triangles && indices.len() % 3 != 0) {
            let sentence = format!(
                "{} has {} corners, which make no whole triangles",
                read.path,
                indices.len()
            );
            self.draft
                .warnings
                .push(|| accessors.faults.warning(&sentence));
        }
        let triangles = triangles(mode, &indices);
        let count = triangles.len();
        let numbered = |triangle: [u32; 3]| triangle.map(|vertex| first_vertex + vertex);
        mesh.triangles.extend(triangles.into_iter().map(numbered));
        Ok(count)
    }

    /// What the targets of a primitive add to its vertices.
    fn add_displacements(
        &mut self,
        primitive: &Primitive,
        read: &VertexReader<'_>,
        first_vertex: u32,
        first_morph: usize,
    ) -> Result<(), LoadError> {
        // Flat ones follow from positions.
        let has_normals = attribute(primitive, Semantic::Normals).is_some();
        for (index, target) in primitive.targets.iter().flatten().enumerate() {
            let name = |attribute: &str| format!("targets[{index}].{attribute}");
            let displacements = |accessor: Option<Index<Accessor>>, attribute: &str| match accessor
            {
                None => Ok(Vec::new()),
                Some(accessor) => {
                    let all = read.vectors::<3>(accessor, &name(attribute), VECTORS)?;
                    let all = all.into_iter().map(Vec3::from_array);
                    let numbered = (first_vertex..).zip(all);
                    Ok::<_, LoadError>(numbered.filter(|(_, moved)| *moved != Vec3::ZERO).collect())
                }
            };
            let positions: Vec<_> = displacements(target.positions, "POSITION")?;
            let normals: Vec<_> = displacements(target.normals, "NORMAL")?;
            self.totals.displacements += positions.len() + normals.len();
            self.limits.morph_displacements(self.totals.displacements)?;
            let morph = &mut self.draft.morphs[first_morph + index];
            morph.positions.extend(positions);
            if has_normals {
                morph.normals.extend(normals);
            }
        }
        Ok(())
    }
}

fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}

/// How many triangles so many corners make.
fn triangle_count(mode: Mode, corners: usize) -> usize {
    match mode {
        Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
        _ => corners / 3,
    }
}

/// Those that indices make, wound as the specification says. Indices that are too few for one more are passed over.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let triples = indices.windows(3).enumerate();
            let turned = |(place, it): (usize, &[u32])| match place % 2 {
                0 => [it[0], it[1], it[2]],
                _ => [it[0], it[2], it[1]],
            };
            triples.map(turned).collect()
        }
        Mode::TriangleFan => {
            let pairs = indices.get(1..).unwrap_or_default().windows(2);
            pairs.map(|pair| [pair[0], pair[1], indices[0]]).collect()
        }
        _ => indices.as_chunks().0.to_vec(),
    }
}

/// By a custom that every exporter follows, though the specification has it as an example only.
fn target_names(mesh: &Mesh) -> Vec<String> {
    #[derive(serde::Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct Extras {
        target_names: Vec<String>,
    }
    let extras = mesh.extras.as_ref();
    let extras = extras.and_then(|extras| serde_json::from_str::<Extras>(extras.get()).ok());
    extras.map_or_else(Vec::new, |extras| extras.target_names)
}
