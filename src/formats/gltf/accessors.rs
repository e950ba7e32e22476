//! Numbers out of buffers: every accessor is held against its buffer before anything of its size is allocated.
//! Never lives here: what the numbers are for.

use super::buffers::{Buffers, View};
use super::elements::{
    Elements, Sparse, Strided, component_count, component_size, divisor, element_size, integer,
};
use super::extensions;
use super::fault::Faults;
use crate::formats::error::LoadError;
use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type, sparse};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};
use serde_json::{Map, Value};
use std::cell::Cell;

/// Reads accessors of one document.
#[derive(Debug, Clone, Copy)]
pub(super) struct Accessors<'a> {
    pub faults: Faults<'a>,
    pub root: &'a Root,
    pub buffers: &'a Buffers<'a>,
    /// Numbers that may still be read: a small file may have one accessor read any number of times.
    pub left: &'a Cell<u64>,
}

/// As many as fill the largest rig several times over, and as are read in a few seconds.
pub(super) const MOST_NUMBERS: u64 = 1 << 30;

/// Elements that an accessor without a buffer view may have in a file of few bytes. Zeros cost nothing to claim: in a larger file there may be
/// as many as it has bytes in its buffers.
const ZEROS: u64 = 1 << 16;

/// What is due where a type is none of the specification.
const KNOWN_TYPE: &str = "a type of the specification";

/// What an accessor has to be for its use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Requirement {
    /// Any of these.
    pub types: &'static [Type],
    pub components: &'static [ComponentType],
    pub expected: &'static str,
    /// Whether integers have to be numbers from −1 or 0 to 1; else they are where the accessor says so.
    pub normalizes: bool,
}

impl<'a> Accessors<'a> {
    pub(super) fn accessor(
        &self,
        index: Index<Accessor>,
        path: &str,
    ) -> Result<&'a Accessor, LoadError> {
        let accessors = &self.root.accessors;
        Ok(self.faults.get(accessors, "accessors", index, path)?)
    }

    /// How many elements it has. `path` is that of the member which names it.
    pub(super) fn count(&self, index: Index<Accessor>, path: &str) -> Result<usize, LoadError> {
        Ok(self.accessor(index, path)?.count.0 as usize)
    }

    /// The largest number that fits its components, which no index of a vertex may be.
    pub(super) fn largest_index(&self, index: Index<Accessor>) -> Option<u32> {
        match self.root.accessors.get(index.value())?.component_type {
            Checked::Valid(GenericComponentType(ComponentType::U8)) => Some(u8::MAX.into()),
            Checked::Valid(GenericComponentType(ComponentType::U16)) => Some(u16::MAX.into()),
            _ => Some(u32::MAX),
        }
    }

    /// All numbers of all elements, and how many an element has.
    pub(super) fn floats(
        &self,
        index: Index<Accessor>,
        path: &str,
        requirement: Requirement,
    ) -> Result<(Vec<f32>, usize), LoadError> {
        let accessor = self.accessor(index, path)?;
        let elements = self.elements(index, path, requirement)?;
        let is_float = elements.component == ComponentType::F32;
        let divisor = if accessor.normalized {
            divisor(elements.component)
        } else {
            1.0
        };
        // Of a normalized byte -128 and -127 are both -1.
        let least = if accessor.normalized { -1.0 } else { f32::MIN };
        let size = component_size(elements.component);
        let mut floats = vec![0.0; elements.count * elements.width];
        elements.each(|element, bytes| {
            let into = &mut floats[element * elements.width..][..elements.width];
            for (into, bytes) in into.iter_mut().zip(bytes.chunks_exact(size)) {
                *into = if is_float {
                    f32::from_bits(integer(elements.component, bytes) as u32)
                } else {
                    (integer(elements.component, bytes) as f32 / divisor).max(least)
                };
            }
        });
        if let Some(at) = floats.iter().position(|number| !number.is_finite()) {
            let path = format!(
                "accessors[{}], element {}",
                index.value(),
                at / elements.width
            );
            return Err(self
                .faults
                .load(&path, "a finite number", floats[at].to_string()));
        }
        Ok((floats, elements.width))
    }

    /// As [`Self::floats`], of elements that have so many numbers each.
    pub(super) fn vectors<const N: usize>(
        &self,
        index: Index<Accessor>,
        path: &str,
        requirement: Requirement,
    ) -> Result<Vec<[f32; N]>, LoadError> {
        let (floats, width) = self.floats(index, path, requirement)?;
        debug_assert_eq!(width, N);
        Ok(floats.as_chunks().0.to_vec())
    }

    /// Integers, not normalized.
    pub(super) fn integers(
        &self,
        index: Index<Accessor>,
        path: &str,
        requirement: Requirement,
    ) -> Result<(Vec<u32>, usize), LoadError> {
        let elements = self.elements(index, path, requirement)?;
        let size = component_size(elements.component);
        let mut integers = vec![0; elements.count * elements.width];
        elements.each(|element, bytes| {
            let into = &mut integers[element * elements.width..][..elements.width];
            for (into, bytes) in into.iter_mut().zip(bytes.chunks_exact(size)) {
                *into = integer(elements.component, bytes) as u32;
            }
        });
        Ok((integers, elements.width))
    }

    /// An accessor of no bytes is zeros, but where one of these extensions may bring what it has.
    pub(super) fn check_brought(
        &self,
        index: Index<Accessor>,
        extensions: Option<&Map<String, Value>>,
        path: &str,
    ) -> Result<(), LoadError> {
        let accessor = self.accessor(index, path)?;
        let is_zeros = accessor.buffer_view.is_none() && accessor.sparse.is_none();
        match extensions.and_then(extensions::bringing) {
            Some(name) if is_zeros => {
                let path = format!("{path} -> accessors[{}]", index.value());
                let found = extensions::instead(name);
                Err(self.faults.load(&path, "a `bufferView`", found))
            }
            _ => Ok(()),
        }
    }

    /// Where the elements of an accessor lie, once it is what is required and in range of its buffer.
    fn elements(
        &self,
        index: Index<Accessor>,
        path: &str,
        requirement: Requirement,
    ) -> Result<Elements<'a>, LoadError> {
        let accessor = self.accessor(index, path)?;
        let own = format!("accessors[{}]", index.value());
        let (kind, component) = self.required_type(accessor, &own, path, requirement)?;
        let count = self.bounded_count(accessor, &own)?;
        self.spend(count * component_count(kind), path)?;
        let size = element_size(kind, component);
        let base = match accessor.buffer_view {
            None => {
                let extensions = accessor.extensions.as_ref().map(|it| &it.others);
                self.check_brought(index, extensions, path)?;
                None
            }
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                let view = self
                    .buffers
                    .view(self.root, view, &format!("{own}.bufferView"))?;
                Some(self.strided(&own, view, offset, count, size)?)
            }
        };
        let sparse = accessor.sparse.as_ref();
        let sparse = sparse.map(|sparse| self.sparse(sparse, &own, count, size));
        Ok(Elements {
            component,
            width: component_count(kind),
            count,
            base,
            sparse: sparse.transpose()?,
        })
    }

    /// The type of elements and of their components, if it is one of those that are required.
    fn required_type(
        &self,
        accessor: &Accessor,
        own: &str,
        path: &str,
        requirement: Requirement,
    ) -> Result<(Type, ComponentType), LoadError> {
        let faults = self.faults;
        let kind = faults.valid(accessor.type_, &format!("{own}.type"), KNOWN_TYPE)?;
        let component = format!("{own}.componentType");
        let component = faults
            .valid(accessor.component_type, &component, KNOWN_TYPE)?
            .0;
        let is_bare = component != ComponentType::F32 && !accessor.normalized;
        if !requirement.types.contains(&kind)
            || !requirement.components.contains(&component)
            || (requirement.normalizes && is_bare)
        {
            let path = format!("{path} -> {own}");
            let bare = if is_bare { ", not normalized" } else { "" };
            let found = format!("{kind:?} of {component:?}{bare}");
            return Err(faults.load(&path, requirement.expected, found));
        }
        Ok((kind, component))
    }

    /// The number of elements, which is not 0 and no more than anything of the file can account for.
    fn bounded_count(&self, accessor: &Accessor, own: &str) -> Result<usize, LoadError> {
        let most = match accessor.buffer_view {
            Some(_) => u64::from(u32::MAX),
            None => self.buffers.bytes().max(ZEROS),
        };
        let count = accessor.count.0;
        if (1..=most).contains(&count) {
            return Ok(count as usize);
        }
        let expected = match count {
            0 => "at least one element".to_owned(),
            _ => format!("at most {most} elements"),
        };
        let path = format!("{own}.count");
        Err(self.faults.load(&path, expected, count.to_string()))
    }

    /// Takes so many numbers from those that may still be read.
    fn spend(&self, numbers: usize, path: &str) -> Result<(), LoadError> {
        let left = self.left.get().checked_sub(numbers as u64);
        self.left.set(left.ok_or_else(|| {
            let expected = format!("no more than {MOST_NUMBERS} numbers in all accessors together");
            let found = "more, each counted as often as it is read";
            self.faults.load(path, expected, found)
        })?);
        Ok(())
    }

    /// The elements that differ from the base of an accessor of `count` elements, `size` bytes each.
    fn sparse(
        &self,
        sparse: &sparse::Sparse,
        own: &str,
        count: usize,
        size: usize,
    ) -> Result<Sparse<'a>, LoadError> {
        let faults = self.faults;
        let own = format!("{own}.sparse");
        let listed = sparse.count.0;
        if listed > count as u64 {
            let expected = format!("no more than the {count} elements");
            return Err(faults.load(&format!("{own}.count"), expected, listed.to_string()));
        }
        let listed = listed as usize;
        // What is sparse is packed, whatever its views say.
        let packed = |view, path: &str, offset, size| {
            let view = self.buffers.view(self.root, view, path)?;
            let view = View {
                stride: None,
                ..view
            };
            self.strided(path, view, offset, listed, size)
        };
        let path = format!("{own}.indices");
        let component = sparse.indices.component_type;
        let component = faults.valid(component, &format!("{path}.componentType"), KNOWN_TYPE)?;
        let component = component.0;
        let width = component_size(component);
        let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset.0);
        let indices = packed(view, &path, offset, width)?;
        let indices = indices.iter(width).take(listed);
        let indices: Vec<u32> = indices.map(|it| integer(component, it) as u32).collect();
        let ascends = indices.is_sorted_by(|a, b| a < b);
        if !ascends || indices.last().is_some_and(|&last| last as usize >= count) {
            let expected = format!("indices below {count}, each above the one before");
            return Err(faults.load(&path, expected, "others"));
        }
        let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset.0);
        let values = packed(view, &format!("{own}.values"), offset, size)?;
        Ok(Sparse { indices, values })
    }

    /// So many elements of that size in a view, from `offset` on.
    fn strided<'b>(
        &self,
        path: &str,
        view: View<'b>,
        offset: u64,
        count: usize,
        size: usize,
    ) -> Result<Strided<'b>, LoadError> {
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            let expected = format!("a stride of at least the {size} bytes of an element");
            return Err(self.faults.load(path, expected, stride.to_string()));
        }
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(last) => {
                let before = (last as u64).checked_mul(stride as u64);
                before.and_then(|before| before.checked_add(size as u64))
            }
        };
        let end = needed.and_then(|needed| needed.checked_add(offset));
        let there = view.bytes.len();
        if end.is_none_or(|end| end > there as u64) {
            let expected = format!("{count} elements in the {there} bytes of its view");
            let found = format!("elements of {size} bytes, {stride} apart, from {offset}");
            return Err(self.faults.load(path, expected, found));
        }
        Ok(Strided {
            view,
            offset: offset as usize,
            stride,
        })
    }
}
