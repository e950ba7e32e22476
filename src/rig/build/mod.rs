//! The one place where a draft is validated. Readers report faults with their line and column; what is checked here again is what
//! the rest of the program relies on, whoever filled the draft.

mod clip;
mod closed;
mod light;
mod mesh;
mod morph;
mod reach;
mod sides;
mod skeleton;

use super::{Dofs, Draft, LARGEST_COORDINATE, Rig, RigError, RigId, RigProblem, names};
use crate::limits::Limits;
use mesh::MeshBuild;

impl Draft {
    /// Validates the draft and completes it: names made unique, rest clamped into its limits, weights divided by their sum, normals
    /// made unit length or computed, triangles wound about their normals.
    ///
    /// # Errors
    /// [`RigError`] names the first thing found wrong and its file, or the ceiling that the rig exceeds.
    pub fn build(self, limits: &Limits) -> Result<Rig, RigError> {
        let file = self.file.clone();
        self.checked(limits).map_err(|error| RigError {
            file: error.file.or(file),
            ..error
        })
    }

    fn checked(mut self, limits: &Limits) -> Result<Rig, RigError> {
        if self.joints.is_empty() && self.meshes.is_empty() {
            return Err(RigProblem::Empty.into());
        }
        limits.joints(self.joints.len())?;
        limits.vertices(
            self.meshes
                .iter()
                .map(|mesh| mesh.positions.len() + mesh.copies.len())
                .sum::<usize>(),
        )?;
        limits.triangles(
            self.meshes
                .iter()
                .map(|mesh| mesh.triangles.len())
                .sum::<usize>(),
        )?;
        limits.influences(
            self.meshes
                .iter()
                .map(|mesh| mesh.influences.len() + mesh::influences_of_copies(mesh))
                .sum::<usize>(),
        )?;

        let skeleton = skeleton::build(self.joints)?;
        let mut bindings = skeleton::build_bindings(&self.bindings, skeleton.joints().len())?;
        let mesh_names = names::unique("mesh", self.meshes.iter().map(|mesh| mesh.name.as_str()));
        let material_names = names::unique(
            "material",
            self.materials.iter().map(|material| material.name.as_str()),
        );
        for (material, name) in self.materials.iter_mut().zip(material_names) {
            material.name = name;
        }
        let variants = names::unique("variant", self.variants.iter().map(String::as_str));
        let lights = light::build(self.lights, skeleton.joints().len())?;
        let mut meshes = Vec::with_capacity(self.meshes.len());
        for (index, (mesh, name)) in self.meshes.into_iter().zip(mesh_names).enumerate() {
            let file = mesh.file.clone();
            let build = MeshBuild {
                index,
                mesh,
                warnings: &mut self.warnings,
            };
            let counts = [self.materials.len(), self.variants.len()];
            let built = build.build(name, &mut bindings, counts);
            meshes.push(built.map_err(|problem| problem.of(file.as_ref()))?);
        }
        let morphs = morph::build(self.morphs, &mut meshes, limits)?;
        for mesh in &mut meshes {
            sides::sort(mesh, &self.materials);
            mesh.binding_bounds = reach::binding_bounds(mesh);
            mesh.morph_reach = reach::of_morphs(mesh);
            reach::place_parts(mesh);
        }
        let dofs = Dofs::of(&skeleton, &morphs);
        let clips = clip::build(self.clips, &dofs, limits, &mut self.warnings)?;
        Ok(Rig {
            id: RigId::next(),
            dofs,
            skeleton,
            meshes,
            bindings,
            materials: self.materials,
            variants,
            lights,
            morphs,
            clips,
            warnings: self.warnings.into_sentences(),
        })
    }
}

/// Finite, and no larger than [`LARGEST_COORDINATE`].
fn is_usable(numbers: &[f64]) -> bool {
    numbers
        .iter()
        .all(|number| number.abs() <= LARGEST_COORDINATE)
}

fn are_usable(numbers: &[f32]) -> bool {
    numbers
        .iter()
        .all(|number| number.abs() <= LARGEST_COORDINATE as f32)
}

fn finite(is_finite: bool, what: impl FnOnce() -> String) -> Result<(), RigProblem> {
    if is_finite {
        Ok(())
    } else {
        Err(RigProblem::NotFinite { what: what() })
    }
}
