//! Numbers out of buffers: every accessor is held against its buffer before anything of its size is allocated.
//! Never lives here: what the numbers are for.

use super::buffers::Buffers;
use super::extensions;
use super::fault::Faults;
use crate::formats::error::LoadError;
use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
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

/// What an accessor is asked to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted {
    /// Any of these.
    pub types: &'static [Type],
    pub components: &'static [ComponentType],
    pub expected: &'static str,
    /// Whether integers have to be numbers from −1 or 0 to 1; else they are where the accessor says so.
    pub normalizes: bool,
}

/// Where the elements of an accessor are.
struct Place<'b> {
    component: ComponentType,
    /// Components of an element.
    width: usize,
    count: usize,
    /// `None`: all of them are 0.
    base: Option<Strided<'b>>,
    /// Those that differ from the base, in ascending order.
    sparse: Option<(Vec<u32>, Strided<'b>)>,
}

struct Strided<'b> {
    bytes: &'b [u8],
    stride: usize,
}

impl Strided<'_> {
    fn element(&self, index: usize, size: usize) -> &[u8] {
        &self.bytes[index * self.stride..][..size]
    }
}

impl<'a> Accessors<'a> {
    pub fn accessor(&self, index: Index<Accessor>, path: &str) -> Result<&'a Accessor, LoadError> {
        let accessors = &self.root.accessors;
        Ok(self.faults.get(accessors, "accessors", index, path)?)
    }

    /// How many elements it has. `path` is that of the member which names it.
    pub fn count(&self, index: Index<Accessor>, path: &str) -> Result<usize, LoadError> {
        Ok(self.accessor(index, path)?.count.0 as usize)
    }

    /// The largest number that fits its components, which no index of a vertex may be.
    pub fn largest_index(&self, index: Index<Accessor>) -> Option<u32> {
        match self.root.accessors.get(index.value())?.component_type {
            Checked::Valid(GenericComponentType(ComponentType::U8)) => Some(u8::MAX.into()),
            Checked::Valid(GenericComponentType(ComponentType::U16)) => Some(u16::MAX.into()),
            _ => Some(u32::MAX),
        }
    }

    /// All numbers of all elements, and how many an element has.
    pub fn floats(
        &self,
        index: Index<Accessor>,
        path: &str,
        wanted: Wanted,
    ) -> Result<(Vec<f32>, usize), LoadError> {
        let accessor = self.accessor(index, path)?;
        let place = self.place(index, accessor, path, wanted)?;
        let is_float = place.component == ComponentType::F32;
        let divisor = if accessor.normalized {
            divisor(place.component)
        } else {
            1.0
        };
        // Of a normalized byte -128 and -127 are both -1.
        let least = if accessor.normalized { -1.0 } else { f32::MIN };
        let size = size_of_component(place.component);
        let mut floats = vec![0.0; place.count * place.width];
        place.each(|element, bytes| {
            let into = &mut floats[element * place.width..][..place.width];
            for (into, bytes) in into.iter_mut().zip(bytes.chunks_exact(size)) {
                *into = if is_float {
                    f32::from_bits(integer(place.component, bytes) as u32)
                } else {
                    (integer(place.component, bytes) as f32 / divisor).max(least)
                };
            }
        });
        if let Some(at) = floats.iter().position(|number| !number.is_finite()) {
            let path = format!("accessors[{}], element {}", index.value(), at / place.width);
            return Err(self
                .faults
                .load(&path, "a finite number", floats[at].to_string()));
        }
        Ok((floats, place.width))
    }

    /// As [`Self::floats`], of elements that have so many numbers each.
    pub fn vectors<const N: usize>(
        &self,
        index: Index<Accessor>,
        path: &str,
        wanted: Wanted,
    ) -> Result<Vec<[f32; N]>, LoadError> {
        let (floats, width) = self.floats(index, path, wanted)?;
        debug_assert_eq!(width, N);
        Ok(floats.as_chunks().0.to_vec())
    }

    /// Integers, not normalized.
    pub fn integers(
        &self,
        index: Index<Accessor>,
        path: &str,
        wanted: Wanted,
    ) -> Result<(Vec<u32>, usize), LoadError> {
        let accessor = self.accessor(index, path)?;
        let place = self.place(index, accessor, path, wanted)?;
        let size = size_of_component(place.component);
        let mut integers = vec![0; place.count * place.width];
        place.each(|element, bytes| {
            let into = &mut integers[element * place.width..][..place.width];
            for (into, bytes) in into.iter_mut().zip(bytes.chunks_exact(size)) {
                *into = integer(place.component, bytes) as u32;
            }
        });
        Ok((integers, place.width))
    }

    /// An accessor of no bytes is zeros, but where one of these extensions may bring what it has.
    pub fn check_brought(
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

    fn place(
        &self,
        index: Index<Accessor>,
        accessor: &Accessor,
        path: &str,
        wanted: Wanted,
    ) -> Result<Place<'a>, LoadError> {
        let faults = self.faults;
        let own = format!("accessors[{}]", index.value());
        let types = "a type of the specification";
        let kind = faults.valid(accessor.type_, &format!("{own}.type"), types)?;
        let component = format!("{own}.componentType");
        let component = faults.valid(accessor.component_type, &component, types)?.0;
        let is_bare = component != ComponentType::F32 && !accessor.normalized;
        if !wanted.types.contains(&kind)
            || !wanted.components.contains(&component)
            || (wanted.normalizes && is_bare)
        {
            let path = format!("{path} -> {own}");
            let bare = if is_bare { ", not normalized" } else { "" };
            let found = format!("{kind:?} of {component:?}{bare}");
            return Err(faults.load(&path, wanted.expected, found));
        }
        let most = match accessor.buffer_view {
            Some(_) => u64::from(u32::MAX),
            None => self.buffers.bytes().max(ZEROS),
        };
        if accessor.count.0 == 0 || accessor.count.0 > most {
            let path = format!("{own}.count");
            let expected = match accessor.count.0 {
                0 => "at least one element".to_owned(),
                _ => format!("at most {most} elements"),
            };
            return Err(faults.load(&path, expected, accessor.count.0.to_string()));
        }
        let count = accessor.count.0 as usize;
        let numbers = accessor.count.0 * components_of(kind) as u64;
        let left = self.left.get().checked_sub(numbers).ok_or_else(|| {
            let expected = format!("no more than {MOST_NUMBERS} numbers in all accessors together");
            faults.load(path, expected, "more, each counted as often as it is read")
        })?;
        self.left.set(left);
        let size = element_size(kind, component);
        let base = match accessor.buffer_view {
            None => {
                let extensions = accessor.extensions.as_ref().map(|it| &it.others);
                self.check_brought(index, extensions, path)?;
                None
            }
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                let view_path = format!("{own}.bufferView");
                let (bytes, stride) = self.buffers.view(self.root, view, &view_path)?;
                Some(self.strided(&own, (bytes, stride), offset, count, size)?)
            }
        };
        let sparse = match &accessor.sparse {
            None => None,
            Some(sparse) => {
                let own = format!("{own}.sparse");
                let listed = sparse.count.0;
                if listed > count as u64 {
                    let expected = format!("no more than the {count} elements");
                    return Err(faults.load(&format!("{own}.count"), expected, listed.to_string()));
                }
                let listed = listed as usize;
                let (indices, values) = (&sparse.indices, &sparse.values);
                let kind_path = format!("{own}.indices.componentType");
                let kind = faults.valid(indices.component_type, &kind_path, types)?.0;
                let indices_path = format!("{own}.indices");
                let (bytes, _) =
                    self.buffers
                        .view(self.root, indices.buffer_view, &indices_path)?;
                let width = size_of_component(kind);
                let offset = indices.byte_offset.0;
                let packed = self.strided(&indices_path, (bytes, None), offset, listed, width)?;
                let at = |it: usize| integer(kind, packed.element(it, width)) as u32;
                let at: Vec<u32> = (0..listed).map(at).collect();
                let ascends = at.is_sorted_by(|a, b| a < b);
                if !ascends || at.last().is_some_and(|&last| last as usize >= count) {
                    let expected = format!("indices below {count}, each above the one before");
                    return Err(faults.load(&indices_path, expected, "others"));
                }
                let values_path = format!("{own}.values");
                let (bytes, _) = self
                    .buffers
                    .view(self.root, values.buffer_view, &values_path)?;
                let offset = values.byte_offset.0;
                Some((
                    at,
                    self.strided(&values_path, (bytes, None), offset, listed, size)?,
                ))
            }
        };
        Ok(Place {
            component,
            width: components_of(kind),
            count,
            base,
            sparse,
        })
    }

    /// Where so many elements of that size lie in the bytes of a view.
    fn strided<'b>(
        &self,
        path: &str,
        (bytes, stride): (&'b [u8], Option<usize>),
        offset: u64,
        count: usize,
        size: usize,
    ) -> Result<Strided<'b>, LoadError> {
        let stride = stride.unwrap_or(size);
        if stride < size {
            let expected = format!("a stride of at least the {size} bytes of an element");
            return Err(self.faults.load(path, expected, stride.to_string()));
        }
        let last = count.saturating_sub(1) as u64;
        let needed = last
            .checked_mul(stride as u64)
            .and_then(|it| it.checked_add(size as u64));
        let needed = needed.filter(|_| count > 0).or((count == 0).then_some(0));
        let end = needed.and_then(|needed| needed.checked_add(offset));
        match end.filter(|&end| end <= bytes.len() as u64) {
            Some(_) => Ok(Strided {
                bytes: &bytes[offset as usize..],
                stride,
            }),
            None => {
                let expected = format!("{count} elements in the {} bytes of its view", bytes.len());
                let found = format!("elements of {size} bytes, {stride} apart, from {offset}");
                Err(self.faults.load(path, expected, found))
            }
        }
    }
}

impl Place<'_> {
    /// Every element that is not all 0, as its bytes; one that differs from its base comes twice.
    fn each(&self, mut take: impl FnMut(usize, &[u8])) {
        let size = self.width * size_of_component(self.component);
        // Columns of matrices of bytes and shorts would be padded; no such matrix is ever asked for.
        if let Some(base) = &self.base {
            for element in 0..self.count {
                take(element, base.element(element, size));
            }
        }
        if let Some((at, values)) = &self.sparse {
            for (index, &element) in at.iter().enumerate() {
                take(element as usize, values.element(index, size));
            }
        }
    }
}

fn components_of(kind: Type) -> usize {
    match kind {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}

pub(super) fn element_size(kind: Type, component: ComponentType) -> usize {
    components_of(kind) * size_of_component(component)
}

fn size_of_component(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

/// What 1 is as a normalized integer.
fn divisor(component: ComponentType) -> f32 {
    match component {
        ComponentType::I8 => 127.0,
        ComponentType::U8 => 255.0,
        ComponentType::I16 => 32767.0,
        ComponentType::U16 => 65535.0,
        ComponentType::U32 | ComponentType::F32 => 1.0,
    }
}

fn integer(component: ComponentType, bytes: &[u8]) -> i64 {
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
