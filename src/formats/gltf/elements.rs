//! Where the elements of an accessor lie, and numbers from their bytes. Never lives here: checking an accessor against its buffer.

use super::buffers::View;
use gltf_json::accessor::{ComponentType, Type};

/// The elements of an accessor, all in range of their bytes.
pub(super) struct Elements<'b> {
    pub component: ComponentType,
    /// Components of an element.
    pub width: usize,
    pub count: usize,
    /// `None`: all of them are 0.
    pub base: Option<Strided<'b>>,
    pub sparse: Option<Sparse<'b>>,
}

/// Elements that differ from the base.
pub(super) struct Sparse<'b> {
    /// Of elements, in ascending order.
    pub indices: Vec<u32>,
    pub values: Strided<'b>,
}

/// Elements of a view, `stride` bytes apart from `offset` on.
pub(super) struct Strided<'b> {
    pub view: View<'b>,
    pub offset: usize,
    pub stride: usize,
}

impl Strided<'_> {
    /// `size` bytes each, as many as are asked for.
    pub(super) fn iter(&self, size: usize) -> impl Iterator<Item = &[u8]> {
        let bytes = &self.view.bytes[self.offset..];
        (0..).map(move |index| &bytes[index * self.stride..][..size])
    }
}

impl Elements<'_> {
    /// Every element that is not all 0, as its bytes; one that differs from its base comes twice.
    pub(super) fn each(&self, mut take: impl FnMut(usize, &[u8])) {
        let size = self.width * component_size(self.component);
        // Columns of matrices of bytes and shorts would be padded; no such matrix is ever asked for.
        if let Some(base) = &self.base {
            for (element, bytes) in (0..self.count).zip(base.iter(size)) {
                take(element, bytes);
            }
        }
        if let Some(Sparse { indices, values }) = &self.sparse {
            for (&element, bytes) in indices.iter().zip(values.iter(size)) {
                take(element as usize, bytes);
            }
        }
    }
}

pub(super) fn component_count(kind: Type) -> usize {
    match kind {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}

/// In bytes.
pub(super) fn element_size(kind: Type, component: ComponentType) -> usize {
    component_count(kind) * component_size(component)
}

/// In bytes.
pub(super) fn component_size(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

/// What 1 is as a normalized integer.
pub(super) fn divisor(component: ComponentType) -> f32 {
    match component {
        ComponentType::I8 => 127.0,
        ComponentType::U8 => 255.0,
        ComponentType::I16 => 32767.0,
        ComponentType::U16 => 65535.0,
        ComponentType::U32 | ComponentType::F32 => 1.0,
    }
}

/// A component from its bytes; of a float its bits.
pub(super) fn integer(component: ComponentType, bytes: &[u8]) -> i64 {
    let two = || bytes.first_chunk::<2>().copied().unwrap_or_default();
    let four = || bytes.first_chunk::<4>().copied().unwrap_or_default();
    match component {
        ComponentType::I8 => i64::from(bytes[0] as i8),
        ComponentType::U8 => i64::from(bytes[0]),
        ComponentType::I16 => i64::from(i16::from_le_bytes(two())),
        ComponentType::U16 => i64::from(u16::from_le_bytes(two())),
        ComponentType::U32 | ComponentType::F32 => i64::from(u32::from_le_bytes(four())),
    }
}
