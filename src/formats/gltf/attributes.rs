//! What there is one of for each vertex of a primitive, and what its attributes may be.
//! Never lives here: what becomes of the numbers.

use super::accessors::{Accessors, Requirement};
use crate::formats::error::LoadError;
use gltf_json::Index;
use gltf_json::accessor::ComponentType::{F32, I8, I16, U8, U16, U32};
use gltf_json::accessor::{Accessor, Type};

/// Of positions, normals and their displacements: floats, or what quantization allows.
pub(super) const VECTORS: Requirement = Requirement {
    types: &[Type::Vec3],
    components: &[F32, I8, U8, I16, U16],
    expected: "VEC3 of numbers",
    normalizes: false,
};
pub(super) const TEXCOORDS: Requirement = Requirement {
    types: &[Type::Vec2],
    components: &[F32, I8, U8, I16, U16],
    expected: "VEC2 of numbers",
    normalizes: false,
};
pub(super) const COLORS: Requirement = Requirement {
    types: &[Type::Vec3, Type::Vec4],
    components: &[F32, U8, U16],
    expected: "VEC3 or VEC4 of F32, or of normalized U8 or U16",
    normalizes: true,
};
pub(super) const INDICES: Requirement = Requirement {
    types: &[Type::Scalar],
    components: &[U8, U16, U32],
    expected: "SCALAR of U8, U16 or U32",
    normalizes: false,
};

/// Reads what there is one of for each vertex of a primitive.
pub(super) struct VertexReader<'a> {
    pub accessors: Accessors<'a>,
    pub path: &'a str,
    pub count: usize,
}

impl VertexReader<'_> {
    pub(super) fn vectors<const N: usize>(
        &self,
        accessor: Index<Accessor>,
        name: &str,
        requirement: Requirement,
    ) -> Result<Vec<[f32; N]>, LoadError> {
        let path = self.check_count(accessor, name)?;
        self.accessors.vectors(accessor, &path, requirement)
    }

    pub(super) fn floats(
        &self,
        accessor: Index<Accessor>,
        name: &str,
        requirement: Requirement,
    ) -> Result<(Vec<f32>, usize), LoadError> {
        let path = self.check_count(accessor, name)?;
        self.accessors.floats(accessor, &path, requirement)
    }

    pub(super) fn integers(
        &self,
        accessor: Index<Accessor>,
        name: &str,
        requirement: Requirement,
    ) -> Result<Vec<u32>, LoadError> {
        let path = self.check_count(accessor, name)?;
        Ok(self.accessors.integers(accessor, &path, requirement)?.0)
    }

    /// The path of the attribute, where it has as many elements as there are vertices.
    fn check_count(&self, accessor: Index<Accessor>, name: &str) -> Result<String, LoadError> {
        let path = if name.starts_with("targets") {
            format!("{}.{name}", self.path)
        } else {
            format!("{}.attributes.{name}", self.path)
        };
        let found = self.accessors.count(accessor, &path)?;
        if found == self.count {
            return Ok(path);
        }
        let expected = format!("{} elements, as many as there are positions", self.count);
        Err(self
            .accessors
            .faults
            .load(&path, expected, found.to_string()))
    }
}
