//! Rules of buffer views and accessors. Never lives here: what the numbers in them are for.

use super::checker::Checker;
use crate::formats::gltf::elements::element_size;
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::mesh::Semantic;
use gltf_json::validation::Checked;
use std::collections::BTreeSet;

pub(super) fn check(checker: &mut Checker) {
    check_views(checker);
    check_accessors(checker);
    check_bounds(checker);
    check_strides(checker);
}

fn check_views(checker: &mut Checker) {
    let root = checker.root;
    for (index, buffer) in root.buffers.iter().enumerate() {
        if buffer.byte_length.0 == 0 {
            checker.warn(|| format!("buffers[{index}] is of no bytes"));
        }
    }
    for (index, view) in root.buffer_views.iter().enumerate() {
        let path = || format!("bufferViews[{index}]");
        checker.check_index(&root.buffers, Some(view.buffer), || path() + ".buffer");
        let length = view.byte_length.0;
        let end = view.byte_offset.unwrap_or_default().0.checked_add(length);
        let buffer = root.buffers.get(view.buffer.value());
        let is_beyond =
            |buffer: &gltf_json::Buffer| end.is_none_or(|end| end > buffer.byte_length.0);
        if buffer.is_some_and(is_beyond) {
            checker.warn(|| format!("{} goes past the end of its buffer", path()));
        }
        if length == 0 {
            checker.warn(|| format!("{} is of no bytes", path()));
        }
        if let Some(stride) = view.byte_stride.map(|stride| stride.0) {
            if stride % 4 != 0 {
                checker.warn(|| format!("{}.byteStride is {stride}, no multiple of 4", path()));
            }
            if stride as u64 > length {
                checker.warn(|| {
                    format!(
                        "{}.byteStride is {stride}, more than its {length} bytes",
                        path()
                    )
                });
            }
        }
    }
}

fn check_accessors(checker: &mut Checker) {
    let root = checker.root;
    for (index, accessor) in root.accessors.iter().enumerate() {
        let path = || format!("accessors[{index}]");
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let (&Checked::Valid(GenericComponentType(component)), &Checked::Valid(kind)) =
            (&accessor.component_type, &accessor.type_)
        else {
            checker.warn(|| format!("{} has an unknown type", path()));
            continue;
        };
        checker.check_index(&root.buffer_views, accessor.buffer_view, || {
            path() + ".bufferView"
        });
        if let Some(sparse) = &accessor.sparse {
            for (view, name) in [
                (sparse.indices.buffer_view, "indices"),
                (sparse.values.buffer_view, "values"),
            ] {
                let path = || format!("{}.sparse.{name}.bufferView", path());
                checker.check_index(&root.buffer_views, Some(view), path);
            }
        }
        let is_wide = matches!(component, ComponentType::F32 | ComponentType::U32);
        if accessor.normalized && is_wide {
            checker.warn(|| format!("{} is normalized, but its numbers are of 32 bits", path()));
        }
        if accessor.count.0 == 0 {
            checker.warn(|| format!("{} has no elements", path()));
        }
        let view = accessor
            .buffer_view
            .map(|view| root.buffer_views.get(view.value()));
        let Some(view) = view else {
            if accessor.byte_offset.is_some() {
                checker.warn(|| format!("{} has a byteOffset, but no bufferView", path()));
            }
            continue;
        };
        let Some(view) = view else { continue };
        let size = element_size(Type::Scalar, component) as u64;
        let aligned = match kind {
            Type::Mat2 | Type::Mat3 | Type::Mat4 => 4,
            _ => size,
        };
        let start = view.byte_offset.unwrap_or_default().0;
        if offset % aligned != 0 || offset.wrapping_add(start) % aligned != 0 {
            checker.warn(|| format!("{} does not begin at a multiple of {aligned} bytes", path()));
        }
        let element = element_size(kind, component) as u64;
        let stride = view.byte_stride.map_or(element, |stride| stride.0 as u64);
        let last = accessor.count.0.saturating_sub(1).saturating_mul(stride);
        if offset.saturating_add(last).saturating_add(element) > view.byte_length.0 {
            checker.warn(|| format!("{} goes past the end of its view", path()));
        }
    }
}

/// Positions and times have to say from where to where they go: one warning for all that do not, as of empty lists.
fn check_bounds(checker: &mut Checker) {
    let root = checker.root;
    let samplers = root.animations.iter().flat_map(|it| &it.samplers);
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let positions = primitives.flat_map(|primitive| {
        let targets = primitive.targets.iter().flatten();
        let own = primitive
            .attributes
            .get(&Checked::Valid(Semantic::Positions));
        own.copied()
            .into_iter()
            .chain(targets.filter_map(|it| it.positions))
    });
    let bounded: BTreeSet<_> = samplers
        .map(|it| it.input)
        .chain(positions)
        .map(|it| it.value())
        .collect();
    let is_unbounded = |accessor: &usize| {
        let accessor = root.accessors.get(*accessor);
        accessor.is_some_and(|it| it.min.is_none() || it.max.is_none())
    };
    let mut unbounded = bounded.into_iter().filter(is_unbounded);
    if let Some(first) = unbounded.next() {
        let more = match unbounded.count() {
            0 => "has".to_owned(),
            count => format!("and {count} more have"),
        };
        checker.warn(|| {
            format!("accessors[{first}] {more} no min and max, as positions and times must")
        });
    }
}

/// Only what is there for each vertex may lie apart.
fn check_strides(checker: &mut Checker) {
    let root = checker.root;
    let mut packed: BTreeSet<usize> = BTreeSet::new();
    let samplers = root.animations.iter().flat_map(|it| &it.samplers);
    let of_samplers = samplers.flat_map(|sampler| [sampler.input, sampler.output]);
    let of_skins = root.skins.iter().filter_map(|it| it.inverse_bind_matrices);
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let of_primitives = primitives.filter_map(|primitive| primitive.indices);
    let accessors = of_samplers.chain(of_skins).chain(of_primitives);
    let accessors = accessors.filter_map(|it| root.accessors.get(it.value()));
    packed.extend(accessors.filter_map(|it| Some(it.buffer_view?.value())));
    for sparse in root.accessors.iter().filter_map(|it| it.sparse.as_ref()) {
        let [indices, values] = [sparse.indices.buffer_view, sparse.values.buffer_view];
        packed.extend([indices.value(), values.value()]);
    }
    packed.extend(
        root.images
            .iter()
            .filter_map(|it| Some(it.buffer_view?.value())),
    );
    let is_apart = |view: &usize| {
        let view = root.buffer_views.get(*view);
        view.is_some_and(|view| view.byte_stride.is_some())
    };
    for view in packed.into_iter().filter(is_apart) {
        checker.warn(|| {
            format!("bufferViews[{view}] has a byteStride, but not only attributes of vertices")
        });
    }
}
