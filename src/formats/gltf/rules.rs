//! What a document says against the specification, without consequence for what is read: a warning each.
//! Never lives here: what the readers meet on their way, which they tell themselves.

use super::accessors::element_size;
use super::buffers::media_type;
use super::fault::Faults;
use super::nodes::Nodes;
use crate::formats::error::quoted;
use crate::rig::Warnings;
use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};
use serde_json::Value;
use std::collections::BTreeSet;

/// Lists without items and members that are `null`, both of which have to be left out: one warning for all of a kind, since exporters that
/// write one write many.
pub(super) fn warn_of_nothing(faults: Faults<'_>, json: &Value, warnings: &mut Warnings) {
    /// The path of the first, and how many there are.
    #[derive(Default)]
    struct Found(String, usize);
    impl Found {
        fn add(&mut self, path: impl FnOnce() -> String) {
            if self.1 == 0 {
                self.0 = path();
            }
            self.1 += 1;
        }
        fn warn(self, what: &str, is: &str, faults: Faults<'_>, warnings: &mut Warnings) {
            let Self(first, count) = self;
            let more = match count {
                0 => return,
                1 => String::new(),
                _ => format!(", as are {} more", count - 1),
            };
            warnings.push(|| faults.warning(&format!("{what} {first} is {is}{more}")));
        }
    }
    fn walk(value: &Value, path: &str, empty: &mut Found, null: &mut Found) {
        match value {
            Value::Array(items) if items.is_empty() => empty.add(|| path.to_owned()),
            Value::Array(items) => {
                let is_nested = |item: &Value| item.is_array() || item.is_object();
                for (index, item) in items.iter().enumerate().filter(|(_, it)| is_nested(it)) {
                    walk(item, &format!("{path}[{index}]"), empty, null);
                }
            }
            Value::Object(members) => {
                let dot = if path.is_empty() { "" } else { "." };
                for (name, member) in members {
                    let path = || format!("{path}{dot}{name}");
                    match member {
                        _ if matches!(name.as_str(), "extras" | "extensions") => {}
                        Value::Null => null.add(path),
                        Value::Array(_) | Value::Object(_) => walk(member, &path(), empty, null),
                        Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
                    }
                }
            }
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }
    let (mut empty, mut null) = (Found::default(), Found::default());
    walk(json, "", &mut empty, &mut null);
    empty.warn("the list", "empty", faults, warnings);
    null.warn("the member", "null and passed over", faults, warnings);
}

/// Checks what the readers did not have to.
pub(super) fn warn(faults: Faults<'_>, root: &Root, nodes: &Nodes, warnings: &mut Warnings) {
    let mut rules = Rules {
        faults,
        root,
        warnings,
    };
    rules.views();
    rules.accessors();
    rules.bounds();
    rules.strides();
    rules.primitives();
    rules.nodes(nodes);
    rules.skins(nodes);
    rules.animations();
    rules.textures();
    rules.materials();
}

struct Rules<'a> {
    faults: Faults<'a>,
    root: &'a Root,
    warnings: &'a mut Warnings,
}

impl Rules<'_> {
    fn warn(&mut self, sentence: impl FnOnce() -> String) {
        let faults = self.faults;
        self.warnings.push(|| faults.warning(&sentence()));
    }

    /// Where an index leads nowhere: of something that is not used, or it would be a fault.
    fn check_index<T>(
        &mut self,
        list: &[T],
        index: Option<Index<T>>,
        path: impl FnOnce() -> String,
    ) {
        if let Some(index) = index.filter(|index| index.value() >= list.len()) {
            self.warn(|| format!("{} is {}, which does not exist", path(), index.value()));
        }
    }

    fn views(&mut self) {
        let root = self.root;
        for (index, buffer) in root.buffers.iter().enumerate() {
            if buffer.byte_length.0 == 0 {
                self.warn(|| format!("buffers[{index}] is of no bytes"));
            }
        }
        for (index, view) in root.buffer_views.iter().enumerate() {
            let path = || format!("bufferViews[{index}]");
            self.check_index(&root.buffers, Some(view.buffer), || path() + ".buffer");
            let length = view.byte_length.0;
            let end = view.byte_offset.unwrap_or_default().0.checked_add(length);
            let buffer = root.buffers.get(view.buffer.value());
            let is_beyond =
                |buffer: &gltf_json::Buffer| end.is_none_or(|end| end > buffer.byte_length.0);
            if buffer.is_some_and(is_beyond) {
                self.warn(|| format!("{} goes past the end of its buffer", path()));
            }
            if length == 0 {
                self.warn(|| format!("{} is of no bytes", path()));
            }
            if let Some(stride) = view.byte_stride.map(|stride| stride.0) {
                if stride % 4 != 0 {
                    self.warn(|| format!("{}.byteStride is {stride}, no multiple of 4", path()));
                }
                if stride as u64 > length {
                    self.warn(|| {
                        format!(
                            "{}.byteStride is {stride}, more than its {length} bytes",
                            path()
                        )
                    });
                }
            }
        }
    }

    fn accessors(&mut self) {
        let root = self.root;
        for (index, accessor) in root.accessors.iter().enumerate() {
            let path = || format!("accessors[{index}]");
            let offset = accessor.byte_offset.unwrap_or_default().0;
            let (&Checked::Valid(GenericComponentType(component)), &Checked::Valid(kind)) =
                (&accessor.component_type, &accessor.type_)
            else {
                self.warn(|| format!("{} has an unknown type", path()));
                continue;
            };
            self.check_index(&root.buffer_views, accessor.buffer_view, || {
                path() + ".bufferView"
            });
            if let Some(sparse) = &accessor.sparse {
                for (view, name) in [
                    (sparse.indices.buffer_view, "indices"),
                    (sparse.values.buffer_view, "values"),
                ] {
                    let path = || format!("{}.sparse.{name}.bufferView", path());
                    self.check_index(&root.buffer_views, Some(view), path);
                }
            }
            let is_wide = matches!(component, ComponentType::F32 | ComponentType::U32);
            if accessor.normalized && is_wide {
                self.warn(|| format!("{} is normalized, but its numbers are of 32 bits", path()));
            }
            if accessor.count.0 == 0 {
                self.warn(|| format!("{} has no elements", path()));
            }
            let view = accessor
                .buffer_view
                .map(|view| root.buffer_views.get(view.value()));
            let Some(view) = view else {
                if accessor.byte_offset.is_some() {
                    self.warn(|| format!("{} has a byteOffset, but no bufferView", path()));
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
                self.warn(|| format!("{} does not begin at a multiple of {aligned} bytes", path()));
            }
            let element = element_size(kind, component) as u64;
            let stride = view.byte_stride.map_or(element, |stride| stride.0 as u64);
            let last = accessor.count.0.saturating_sub(1).saturating_mul(stride);
            if offset.saturating_add(last).saturating_add(element) > view.byte_length.0 {
                self.warn(|| format!("{} goes past the end of its view", path()));
            }
        }
    }

    /// Positions and times have to say from where to where they go: one warning for all that do not, as of empty lists.
    fn bounds(&mut self) {
        let root = self.root;
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
            self.warn(|| {
                format!("accessors[{first}] {more} no min and max, as positions and times must")
            });
        }
    }

    /// Only what is there for each vertex may lie apart.
    fn strides(&mut self) {
        let root = self.root;
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
            self.warn(|| {
                format!("bufferViews[{view}] has a byteStride, but not only attributes of vertices")
            });
        }
    }

    fn primitives(&mut self) {
        for (mesh, of_mesh) in self.root.meshes.iter().enumerate() {
            for (place, primitive) in of_mesh.primitives.iter().enumerate() {
                self.attributes(primitive, &format!("meshes[{mesh}].primitives[{place}]"));
            }
        }
    }

    fn attributes(&mut self, primitive: &Primitive, path: &str) {
        let root = self.root;
        // Of TEXCOORD, COLOR, JOINTS and WEIGHTS: how many sets there are, and the number after the largest.
        let mut sets = [
            ("TEXCOORD", 0, 0),
            ("COLOR", 0, 0),
            ("JOINTS", 0, 0),
            ("WEIGHTS", 0, 0),
        ];
        let mut has_unknown = false;
        for (semantic, &accessor) in &primitive.attributes {
            self.check_index(&root.accessors, Some(accessor), || {
                format!("{path}.attributes")
            });
            let of_file = root.accessors.get(accessor.value());
            if of_file.is_some_and(is_unsigned_int) {
                self.warn(|| format!("{path}.attributes has one of whole numbers of 32 bits"));
            }
            let (kind, set) = match semantic {
                Checked::Invalid => {
                    has_unknown = true;
                    continue;
                }
                Checked::Valid(Semantic::TexCoords(set)) => (0, *set),
                Checked::Valid(Semantic::Colors(set)) => (1, *set),
                Checked::Valid(Semantic::Joints(set)) => (2, *set),
                Checked::Valid(Semantic::Weights(set)) => (3, *set),
                Checked::Valid(_) => continue,
            };
            let (_, count, end) = &mut sets[kind];
            *count += 1;
            *end = set.saturating_add(1).max(*end);
        }
        if has_unknown {
            self.warn(|| format!("{path}.attributes has one of an unknown name"));
        }
        for (name, _, end) in sets.into_iter().filter(|(_, count, end)| count != end) {
            let last = end - 1;
            self.warn(|| format!("{path}.attributes has {name}_{last}, but not all before it"));
        }
        let has = |semantic| primitive.attributes.contains_key(&Checked::Valid(semantic));
        for (index, target) in primitive.targets.iter().flatten().enumerate() {
            for (displaced, name, base) in [
                (target.positions, "POSITION", Semantic::Positions),
                (target.normals, "NORMAL", Semantic::Normals),
                (target.tangents, "TANGENT", Semantic::Tangents),
            ] {
                let path = || format!("{path}.targets[{index}].{name}");
                self.check_index(&root.accessors, displaced, path);
                if displaced.is_some() && !has(base) {
                    self.warn(|| format!("{} displaces what the primitive does not have", path()));
                }
            }
        }
    }

    fn nodes(&mut self, nodes: &Nodes) {
        let root = self.root;
        for (index, node) in root.nodes.iter().enumerate() {
            let path = || format!("nodes[{index}]");
            self.check_index(&root.cameras, node.camera, || path() + ".camera");
            self.check_index(&root.meshes, node.mesh, || path() + ".mesh");
            self.check_index(&root.skins, node.skin, || path() + ".skin");
            let needless = [
                ("skin", node.skin.is_some()),
                ("weights", node.weights.is_some()),
            ];
            for (member, is_there) in needless {
                if is_there && node.mesh.is_none() {
                    self.warn(|| format!("{} has {member}, but no mesh", path()));
                }
            }
        }
        for (index, scene) in root.scenes.iter().enumerate() {
            for (place, node) in scene.nodes.iter().enumerate() {
                let path = || format!("scenes[{index}].nodes[{place}]");
                self.check_index(&root.nodes, Some(*node), path);
                if nodes.forest.has_parent(node.value()) {
                    self.warn(|| format!("{} is a node with a parent", path()));
                }
            }
        }
    }

    fn skins(&mut self, nodes: &Nodes) {
        let (root, forest) = (self.root, &nodes.forest);
        for (index, skin) in root.skins.iter().enumerate() {
            let path = || format!("skins[{index}]");
            for (place, joint) in skin.joints.iter().enumerate() {
                self.check_index(&root.nodes, Some(*joint), || {
                    format!("{}.joints[{place}]", path())
                });
            }
            self.check_index(&root.nodes, skin.skeleton, || path() + ".skeleton");
            let joints = || {
                let joints = skin.joints.iter().map(Index::value);
                joints.filter(|&joint| joint < root.nodes.len())
            };
            let tops: BTreeSet<_> = joints().map(|joint| forest.top(joint)).collect();
            if tops.len() > 1 {
                self.warn(|| format!("the joints of {} have no common root", path()));
            }
            let skeleton = skin.skeleton.map(|skeleton| skeleton.value());
            let skeleton = skeleton.filter(|&skeleton| skeleton < root.nodes.len());
            if skeleton.is_some_and(|top| joints().any(|joint| !forest.is_below(joint, top))) {
                self.warn(|| format!("{}.skeleton is not above all joints", path()));
            }
        }
    }

    /// Where a word or a number is none of those that are known. What is read in its place stands behind.
    fn check_known<T>(&mut self, value: &Checked<T>, path: impl FnOnce() -> String, instead: &str) {
        if matches!(value, Checked::Invalid) {
            let faults = self.faults;
            self.warn(|| {
                let path = path();
                let found = faults.found(&path);
                format!("{path} is {found}, which is not known; {instead}")
            });
        }
    }

    fn animations(&mut self) {
        for (index, animation) in self.root.animations.iter().enumerate() {
            for (place, channel) in animation.channels.iter().enumerate() {
                let path = || format!("animations[{index}].channels[{place}].target.path");
                self.check_known(&channel.target.path, path, "the channel is left out");
            }
            for (place, sampler) in animation.samplers.iter().enumerate() {
                let path = || format!("animations[{index}].samplers[{place}].interpolation");
                self.check_known(&sampler.interpolation, path, "LINEAR is taken");
            }
        }
    }

    fn textures(&mut self) {
        let root = self.root;
        for (index, texture) in root.textures.iter().enumerate() {
            let path = || format!("textures[{index}]");
            self.check_index(&root.samplers, texture.sampler, || path() + ".sampler");
            // The library has this for none.
            let source = Some(texture.source).filter(|it| it.value() != u32::MAX as usize);
            self.check_index(&root.images, source, || path() + ".source");
        }
        for (index, sampler) in root.samplers.iter().enumerate() {
            let path = |member: &str| format!("samplers[{index}].{member}");
            for (member, mode) in [("wrapS", &sampler.wrap_s), ("wrapT", &sampler.wrap_t)] {
                self.check_known(mode, || path(member), "it repeats");
            }
            let unread = "filters are not read";
            if let Some(filter) = &sampler.mag_filter {
                self.check_known(filter, || path("magFilter"), unread);
            }
            if let Some(filter) = &sampler.min_filter {
                self.check_known(filter, || path("minFilter"), unread);
            }
        }
        for (index, image) in root.images.iter().enumerate() {
            let path = || format!("images[{index}]");
            self.check_index(&root.buffer_views, image.buffer_view, || {
                path() + ".bufferView"
            });
            if image.uri.is_some() == image.buffer_view.is_some() {
                self.warn(|| format!("{} has not one of `uri` and `bufferView`", path()));
            }
            let media = image.mime_type.as_ref().map(|it| it.0.as_str());
            let media = media.or(image.uri.as_deref().and_then(media_type));
            if let Some(media) = media.filter(|it| !matches!(*it, "image/png" | "image/jpeg")) {
                self.warn(|| {
                    format!(
                        "{} has the media type {}, neither PNG nor JPEG",
                        path(),
                        quoted(media)
                    )
                });
            }
            if image.buffer_view.is_some() && image.mime_type.is_none() {
                self.warn(|| format!("{} lies in a buffer and has no mimeType", path()));
            }
        }
    }

    fn materials(&mut self) {
        for (index, material) in self.root.materials.iter().enumerate() {
            let path = || format!("materials[{index}].alphaMode");
            self.check_known(&material.alpha_mode, path, "OPAQUE is taken");
            let rough = &material.pbr_metallic_roughness;
            let factors = [
                (
                    "pbrMetallicRoughness.baseColorFactor",
                    &rough.base_color_factor.0[..],
                ),
                (
                    "pbrMetallicRoughness.metallicFactor",
                    &[rough.metallic_factor.0],
                ),
                (
                    "pbrMetallicRoughness.roughnessFactor",
                    &[rough.roughness_factor.0],
                ),
                ("emissiveFactor", &material.emissive_factor.0),
            ];
            for (member, numbers) in factors {
                for number in numbers.iter().filter(|it| !(0.0..=1.0).contains(*it)) {
                    self.warn(|| {
                        format!("materials[{index}].{member} is {number}, not a number from 0 to 1")
                    });
                }
            }
            if let Some(cutoff) = material.alpha_cutoff.filter(|cutoff| cutoff.0 < 0.0) {
                let cutoff = cutoff.0;
                self.warn(|| {
                    format!("materials[{index}].alphaCutoff is {cutoff}, not a number from 0 up")
                });
            }
        }
    }
}

fn is_unsigned_int(accessor: &Accessor) -> bool {
    let component = &accessor.component_type;
    matches!(component, Checked::Valid(it) if it.0 == ComponentType::U32)
}
