//! Rules of the specification, each broken or only seemingly broken by itself, in the words of the Khronos validator and in ours.
//! Never lives here: who is asked.

use super::everything::{BOUND, INDICES, JOINTS, POSITIONS, TARGET, TIMES, TURNS, WEIGHTS};
use super::gltf::{Component, Gltf};
use serde_json::{Value, json};

/// What is done to a sound document.
pub struct Rule {
    pub what: &'static str,
    /// The error of the validator; `None` where it finds none.
    pub code: Option<&'static str>,
    pub by: fn(&mut Gltf),
    /// Part of our warning or fault; empty where there is none.
    pub told: &'static str,
}

const fn rule(
    what: &'static str,
    code: &'static str,
    by: fn(&mut Gltf),
    told: &'static str,
) -> Rule {
    Rule {
        what,
        code: Some(code),
        by,
        told,
    }
}

const fn valid(what: &'static str, by: fn(&mut Gltf), told: &'static str) -> Rule {
    Rule {
        what,
        code: None,
        by,
        told,
    }
}

fn primitive(gltf: &mut Gltf) -> &mut Value {
    &mut gltf.json["meshes"][0]["primitives"][0]
}

fn animation(gltf: &mut Gltf) -> &mut Value {
    &mut gltf.json["animations"][0]
}

fn remove(object: &mut Value, member: &str) {
    let members = object.as_object_mut().expect("an object");
    members.remove(member).expect("it was there");
}

pub const RULES: &[Rule] = &[
    rule(
        "a negative weight",
        "ACCESSOR_WEIGHTS_NEGATIVE",
        |it| {
            it.set_float(WEIGHTS, 0, -0.5);
            it.set_float(WEIGHTS, 1, 1.5);
        },
        "1 vertices have a negative weight",
    ),
    rule(
        "a vertex without weights",
        "ACCESSOR_WEIGHTS_NON_NORMALIZED",
        |it| {
            it.set_float(WEIGHTS, 0, 0.0);
            it.set_float(WEIGHTS, 1, 0.0);
        },
        "1 vertices have no weights with a positive sum and follow the mesh's node",
    ),
    rule(
        "weights of NaN",
        "ACCESSOR_INVALID_FLOAT",
        |it| it.set_float(WEIGHTS, 0, f32::NAN),
        "a finite number",
    ),
    rule(
        "weights of more than 1",
        "ACCESSOR_WEIGHTS_NON_NORMALIZED",
        |it| it.set_float(WEIGHTS, 0, 1.5),
        "do not sum to 1",
    ),
    rule(
        "a joint twice for a vertex",
        "ACCESSOR_JOINTS_INDEX_DUPLICATE",
        |it| {
            let start = it.start_of(JOINTS);
            it.bytes[start] = 1;
        },
        "1 vertices name a joint twice",
    ),
    rule(
        "a joint that is none, with a weight of 0",
        "ACCESSOR_JOINTS_INDEX_OOB",
        |it| {
            let start = it.start_of(JOINTS);
            it.bytes[start + 2] = 9;
        },
        "with a weight of 0",
    ),
    rule(
        "a skin of a mesh without joints",
        "NODE_SKIN_WITH_NON_SKINNED_MESH",
        |it| {
            for attribute in ["JOINTS_0", "WEIGHTS_0"] {
                remove(&mut primitive(it)["attributes"], attribute);
            }
        },
        "3 vertices have no weights with a positive sum and follow the mesh's node",
    ),
    valid(
        "joints of a mesh without a skin",
        |it| remove(&mut it.json["nodes"][2], "skin"),
        "3 vertices have joints and weights, but no skin",
    ),
    rule(
        "an inverse bind matrix that projects",
        "ACCESSOR_INVALID_IBM",
        |it| it.set_float(BOUND, 3, 1.0),
        "a fourth row other than 0 0 0 1",
    ),
    valid(
        "an inverse bind matrix that flattens",
        |it| {
            it.set_float(BOUND, 0, 0.0);
            remove(&mut it.json["accessors"][BOUND], "min");
        },
        "skins[0].joints[0]: its inverse bind matrix cannot be inverted",
    ),
    rule(
        "too few inverse bind matrices",
        "INVALID_IBM_ACCESSOR_COUNT",
        |it| it.json["accessors"][BOUND]["count"] = json!(1),
        "a matrix for each of 2 joints",
    ),
    rule(
        "a rotation that is not unit",
        "ROTATION_NON_UNIT",
        |it| it.json["nodes"][1]["rotation"] = json!([0, 0, 0.5, 0.5]),
        "nodes[1].rotation is no unit quaternion",
    ),
    rule(
        "a rotation of nothing",
        "ROTATION_NON_UNIT",
        |it| it.json["nodes"][1]["rotation"] = json!([0, 0, 0, 0]),
        "nodes[1].rotation is no rotation",
    ),
    rule(
        "a matrix beside a translation",
        "NODE_MATRIX_TRS",
        |it| {
            it.json["nodes"][2]["matrix"] = json!([2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]);
            it.json["nodes"][2]["scale"] = json!([1, 1, 1]);
        },
        "nodes[2] has a matrix, beside which",
    ),
    rule(
        "a matrix that shears",
        "NODE_MATRIX_NON_TRS",
        |it| {
            it.json["nodes"][2]["matrix"] = json!([1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
        },
        "nodes[2].matrix is no translation, rotation and scale",
    ),
    rule(
        "a key that is not unit",
        "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION",
        |it| it.set_float(TURNS, 3, 2.0),
        "channels[0] has 1 rotations that are no unit quaternions",
    ),
    rule(
        "a key of no rotation",
        "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION",
        |it| it.set_float(TURNS, 3, 0.0),
        "channels[0] has 1 rotations that are no unit quaternions",
    ),
    rule(
        "a channel on a node with a matrix",
        "ANIMATION_CHANNEL_TARGET_NODE_MATRIX",
        |it| {
            remove(&mut it.json["nodes"][1], "translation");
            it.json["nodes"][1]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1]);
        },
        "channels[0] moves nodes[1], which has a matrix",
    ),
    rule(
        "two channels on one target",
        "ANIMATION_DUPLICATE_TARGETS",
        |it| {
            let again = animation(it)["channels"][0].clone();
            let channels = animation(it)["channels"].as_array_mut();
            channels.expect("a list").push(again);
        },
        "channels[2] has the target of channels[0] and is left out",
    ),
    rule(
        "weights of a node without morph targets",
        "ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS",
        |it| {
            remove(primitive(it), "targets");
            remove(&mut it.json["meshes"][0], "weights");
        },
        "channels[1] moves morph targets of nodes[2], which draws none",
    ),
    rule(
        "a key before 0 seconds",
        "ACCESSOR_ANIMATION_INPUT_NEGATIVE",
        |it| it.set_float(TIMES, 0, -1.0),
        "channels[0] has a key before 0 seconds",
    ),
    rule(
        "keys at one time",
        "ACCESSOR_ANIMATION_INPUT_NON_INCREASING",
        |it| it.set_float(TIMES, 1, 0.0),
        "channels[0] has 1 keys at the time of the one before",
    ),
    rule(
        "keys out of order",
        "ACCESSOR_ANIMATION_INPUT_NON_INCREASING",
        |it| it.set_float(TIMES, 0, 2.0),
        "a time after 2",
    ),
    rule(
        "a spline of one key",
        "ANIMATION_SAMPLER_INPUT_ACCESSOR_TOO_FEW_ELEMENTS",
        |it| {
            let input = it.floats("SCALAR", &[0.0]);
            let output = it.floats("VEC3", &[0.0; 9]);
            let sampler = json!({"input": input, "output": output, "interpolation": "CUBICSPLINE"});
            it.channel("wave", json!({"node": 1, "path": "scale"}), sampler);
        },
        "channels[2] has a spline of one key",
    ),
    rule(
        "normals of another length",
        "ACCESSOR_VECTOR3_NON_UNIT",
        |it| it.set_float(1, 2, 2.0),
        "NORMAL has 1 of another length than 1",
    ),
    rule(
        "a restart among the indices",
        "ACCESSOR_INDEX_PRIMITIVE_RESTART",
        |it| {
            let start = it.start_of(INDICES);
            it.bytes[start..start + 2].fill(0xFF);
        },
        "65535",
    ),
    rule(
        "an attribute of nobody",
        "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
        |it| primitive(it)["attributes"]["COLOUR"] = json!(POSITIONS),
        "one of an unknown name",
    ),
    rule(
        "a set without those before it",
        "MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY",
        |it| primitive(it)["attributes"]["COLOR_1"] = json!(WEIGHTS),
        "COLOR_1, but not all before it",
    ),
    rule(
        "colors that are no light",
        "ACCESSOR_NON_CLAMPED",
        |it| {
            let colors = it.floats("VEC3", &[2.0; 9]);
            primitive(it)["attributes"]["COLOR_0"] = json!(colors);
        },
        "COLOR_0 has 9 below 0 or above 1",
    ),
    rule(
        "an empty list",
        "EMPTY_ENTITY",
        |it| it.json["nodes"][1]["children"] = json!([]),
        "the list nodes[1].children is empty",
    ),
    rule(
        "a skin without a mesh",
        "UNSATISFIED_DEPENDENCY",
        |it| it.json["nodes"][1]["skin"] = json!(0),
        "nodes[1] has skin, but no mesh",
    ),
    rule(
        "a root with a parent",
        "SCENE_NON_ROOT_NODE",
        |it| it.json["scenes"][0]["nodes"] = json!([0, 1, 2]),
        "scenes[0].nodes[1] is a node with a parent",
    ),
    rule(
        "a skeleton that is elsewhere",
        "SKIN_SKELETON_INVALID",
        |it| it.json["skins"][0]["skeleton"] = json!(2),
        "skins[0].skeleton is not above all joints",
    ),
    rule(
        "joints of two trees",
        "SKIN_NO_COMMON_ROOT",
        |it| it.json["skins"][0]["joints"] = json!([0, 2]),
        "the joints of skins[0] have no common root",
    ),
    rule(
        "inverse bind matrices apart",
        "SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE",
        |it| {
            let view = it.json["accessors"][BOUND]["bufferView"]
                .as_u64()
                .expect("an index");
            it.json["bufferViews"][view as usize]["byteStride"] = json!(64);
        },
        "has a byteStride, but not only attributes of vertices",
    ),
    rule(
        "positions without bounds",
        "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
        |it| remove(&mut it.json["accessors"][POSITIONS], "min"),
        "accessors[0] has no min and max",
    ),
    rule(
        "normalized floats",
        "ACCESSOR_NORMALIZED_INVALID",
        |it| it.json["accessors"][WEIGHTS]["normalized"] = json!(true),
        "accessors[4] is normalized, but",
    ),
    rule(
        "an accessor between the floats",
        "ACCESSOR_OFFSET_ALIGNMENT",
        |it| {
            let odd = it.floats("SCALAR", &[0.0, 1.0]);
            it.json["accessors"][odd]["byteOffset"] = json!(1);
            it.json["accessors"][odd]["count"] = json!(1);
        },
        "does not begin at a multiple of 4 bytes",
    ),
    rule(
        "no such camera",
        "UNRESOLVED_REFERENCE",
        |it| it.json["nodes"][1]["camera"] = json!(7),
        "nodes[1].camera is 7, which does not exist",
    ),
    rule(
        "a data URI of another medium",
        "BUFFER_DATA_URI_MIME_TYPE_INVALID",
        |it| {
            let uri = it
                .data_uri()
                .replace("application/octet-stream", "text/plain");
            it.json["buffers"] = json!([{"byteLength": it.bytes.len(), "uri": uri}]);
        },
        "buffers[0].uri has the media type `text/plain`",
    ),
    rule(
        "morph weights that do not fit",
        "MESH_INVALID_WEIGHTS_COUNT",
        |it| it.json["meshes"][0]["weights"] = json!([0, 0]),
        "one for each morph target",
    ),
    rule(
        "a picture of another kind",
        "IMAGE_MIME_TYPE_INVALID",
        |it| it.json["images"][0]["mimeType"] = json!("image/jpeg"),
        "images[0] is called `image/jpeg`, but is `image/png`",
    ),
    rule(
        "a picture of no kind",
        "TEXTURE_INVALID_IMAGE_MIME_TYPE",
        |it| it.json["images"][0]["mimeType"] = json!("image/ktx"),
        "images[0] has the media type `image/ktx`, neither PNG nor JPEG",
    ),
    rule(
        "a texture that is none, of a material of nothing",
        "UNRESOLVED_REFERENCE",
        |it| {
            let odd = json!({"emissiveTexture": {"index": 77}});
            it.push("materials", odd);
        },
        "a material is left out: expected materials[1].emissiveTexture",
    ),
    rule(
        "a texture that is none, of a material of something",
        "UNRESOLVED_REFERENCE",
        |it| it.json["materials"][0]["emissiveTexture"] = json!({"index": 77}),
        "x.gltf:1:1: expected materials[0].emissiveTexture",
    ),
    rule(
        "more metal than there is",
        "VALUE_NOT_IN_RANGE",
        |it| it.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(2),
        "materials[0].pbrMetallicRoughness.metallicFactor is 2, not a number from 0 to 1",
    ),
    rule(
        "a cutoff below nothing",
        "VALUE_NOT_IN_RANGE",
        |it| {
            it.json["materials"][0]["alphaMode"] = json!("MASK");
            it.json["materials"][0]["alphaCutoff"] = json!(-1);
        },
        "materials[0].alphaCutoff is -1, not a number from 0 up",
    ),
    rule(
        "a buffer of no bytes",
        "VALUE_NOT_IN_RANGE",
        |it| {
            let whole = json!({"byteLength": it.bytes.len(), "uri": it.data_uri()});
            it.json["buffers"] = json!([whole, {"byteLength": 0, "uri": "data:,"}]);
        },
        "buffers[1] is of no bytes",
    ),
    rule(
        "an old version",
        "UNKNOWN_ASSET_MAJOR_VERSION",
        |it| it.json["asset"]["version"] = json!("1.0"),
        "glTF version 2.0",
    ),
    valid(
        "a version to come",
        |it| it.json["asset"] = json!({"version": "2.1", "minVersion": "2.1"}),
        "asset.minVersion is `2.1`",
    ),
    rule(
        "a version to come that old readers know enough of",
        "UNKNOWN_ASSET_MAJOR_VERSION",
        |it| it.json["asset"] = json!({"version": "3.0", "minVersion": "2.0"}),
        "asset.version is `3.0`",
    ),
    valid(
        "a mode of opacity of nobody",
        |it| it.json["materials"][0]["alphaMode"] = json!("GLASS"),
        "materials[0].alphaMode is `\"GLASS\"`, which is not known; OPAQUE is taken",
    ),
    valid(
        "an interpolation of nobody",
        |it| animation(it)["samplers"][0]["interpolation"] = json!("BEZIER"),
        "samplers[0].interpolation is `\"BEZIER\"`, which is not known; LINEAR is taken",
    ),
    valid(
        "a target of nobody",
        |it| animation(it)["channels"][0]["target"]["path"] = json!("color"),
        "channels[0].target.path is `\"color\"`, which is not known; the channel is left out",
    ),
    valid(
        "a wrapping of nobody",
        |it| it.json["samplers"] = json!([{"wrapS": 7}]),
        "samplers[0].wrapS is `7`, which is not known; it repeats",
    ),
    valid(
        "a filter of nobody",
        |it| it.json["samplers"] = json!([{"magFilter": 7}]),
        "samplers[0].magFilter is `7`, which is not known; filters are not read",
    ),
    valid(
        "more bytes than a data URI's buffer has",
        |it| {
            it.bytes.push(0);
            let uri = it.data_uri();
            it.json["buffers"] = json!([{"byteLength": it.bytes.len() - 1, "uri": uri}]);
        },
        "bytes, but a byteLength of",
    ),
    rule(
        "a member of nothing",
        "TYPE_MISMATCH",
        |it| it.json["nodes"][1]["camera"] = Value::Null,
        "the member nodes[1].camera is null and passed over",
    ),
    valid(
        "integers with a point",
        |it| {
            it.json["nodes"][2]["mesh"] = json!(0.0);
            it.json["accessors"][INDICES]["count"] = json!(3e0);
            it.json["accessors"][INDICES]["componentType"] = json!(5123.0);
            it.json["bufferViews"][0]["byteLength"] = json!(36.0);
        },
        "",
    ),
    valid(
        "zeros from nowhere",
        |it| remove(&mut it.json["accessors"][TARGET], "bufferView"),
        "",
    ),
    valid(
        "zeros from nowhere in a file without bytes",
        |it| {
            *it = Gltf::default();
            let zeros = json!({"componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [0, 0, 0]});
            it.push("accessors", zeros);
            it.push(
                "meshes",
                json!({"primitives": [{"attributes": {"POSITION": 0}}]}),
            );
            it.node(json!({"mesh": 0}));
        },
        "",
    ),
    valid(
        "times that are all zero",
        |it| remove(&mut it.json["accessors"][TIMES], "bufferView"),
        "keys at the time of the one before",
    ),
    valid(
        "a buffer that nothing reads",
        |it| {
            let whole = json!({"byteLength": it.bytes.len(), "uri": it.data_uri()});
            it.json["buffers"] = json!([whole, {"byteLength": 64}]);
        },
        "a buffer is left out: expected buffers[1]: a `uri`",
    ),
    valid(
        "a channel without a node",
        |it| {
            let aimless = json!({"sampler": 0, "target": {"path": "rotation"}});
            let channels = animation(it)["channels"].as_array_mut();
            channels.expect("a list").insert(0, aimless);
        },
        "",
    ),
    valid(
        "points that are moved",
        |it| primitive(it)["mode"] = json!(0),
        "channels[1] moves morph targets of nodes[2], which draws none",
    ),
    valid(
        "a node of no size",
        |it| it.json["nodes"][1]["scale"] = json!([0, 0, 0]),
        "",
    ),
    valid(
        "bytes as int8",
        |it| {
            let colors = it.normalized(Component::U8, "VEC4", &[255.0; 12]);
            primitive(it)["attributes"]["COLOR_0"] = json!(colors);
        },
        "",
    ),
    valid(
        "a scene without nodes",
        |it| it.json["scenes"][0] = json!({}),
        "nothing to draw",
    ),
    valid(
        "nothing at all",
        |it| *it = Gltf::default(),
        "nothing to draw",
    ),
];
