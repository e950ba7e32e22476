//! The document against the types.

use super::*;
use crate::protocol::blob::{ArrayTransport, Blob, Dtype, Picture, PictureTransport};
use crate::protocol::frame::{Frame, FrameParams};
use crate::protocol::mesh::{Topology, Vertices, VerticesParams};
use crate::protocol::pose::{PoseSetParams, PoseSetResult, StoredPose, Transforms};
use crate::protocol::rig::{LoadParams, RigDescription, RigList, RigSummary};
use crate::protocol::server::{Cancel, ServerInfo, ServerStats};
use crate::protocol::{Attachments, Done, Fault, params};
use jsonschema::Validator;
use serde::Serialize;
use serde::de::DeserializeOwned;

fn method<'a>(document: &'a Value, name: &str) -> &'a Value {
    let methods = document["methods"].as_array().unwrap();
    methods
        .iter()
        .find(|method| method["name"] == name)
        .unwrap()
}

fn validator(document: &Value, schema: &Value) -> Validator {
    // The components come along, for the references to lead somewhere.
    jsonschema::draft7::new(&json!({
        "allOf": [schema],
        "components": document["components"],
    }))
    .unwrap()
}

fn of_params(document: &Value, name: &str) -> Validator {
    let mut properties = Map::new();
    let mut required = Vec::new();
    for descriptor in method(document, name)["params"].as_array().unwrap() {
        let name = descriptor["name"].as_str().unwrap();
        properties.insert(name.to_owned(), descriptor["schema"].clone());
        if descriptor["required"] == true {
            required.push(name);
        }
    }
    let schema = json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    validator(document, &schema)
}

fn of_result(document: &Value, name: &str) -> Validator {
    validator(document, &method(document, name)["result"]["schema"])
}

fn walk<'a>(value: &'a Value, visit: &mut impl FnMut(&'a Map<String, Value>)) {
    match value {
        Value::Object(members) => {
            visit(members);
            members.values().for_each(|value| walk(value, visit));
        }
        Value::Array(values) => values.iter().for_each(|value| walk(value, visit)),
        _ => {}
    }
}

#[test]
fn the_document_is_the_same_every_time() {
    assert_eq!(openrpc().to_string(), openrpc().to_string());
}

#[test]
fn every_method_is_described_and_every_reference_leads_somewhere() {
    let document = openrpc();
    let names: Vec<_> = document["methods"].as_array().unwrap().iter().collect();
    assert_eq!(names.len(), Method::ALL.len());
    for name in ["rpc.discover", "rig.load", "frame.render", "mesh.topology"] {
        let method = method(&document, name);
        assert_eq!(method["paramStructure"], "by-name");
        assert!(method["result"]["schema"].is_object(), "{name}");
    }
    assert!(method(&document, "request.cancel").get("result").is_none());
    let mut references = 0;
    walk(&document, &mut |members| {
        if let Some(Value::String(reference)) = members.get("$ref") {
            let target = document.pointer(reference.strip_prefix('#').unwrap());
            assert!(target.is_some_and(Value::is_object), "{reference}");
            references += 1;
        }
    });
    assert!(references > 50, "{references}");
}

#[test]
fn schemas_are_schemas_and_say_what_they_are_about() {
    let document = openrpc();
    for (name, schema) in document["components"]["schemas"].as_object().unwrap() {
        assert!(jsonschema::draft7::meta::is_valid(schema), "{name}");
        assert!(schema["description"].is_string(), "{name}");
    }
}

#[test]
fn what_the_parser_takes_and_refuses_so_does_the_schema() {
    let document = openrpc();
    let cases: [(&str, &[(bool, Value)]); 5] = [
        (
            "frame.render",
            &[
                (true, json!({"rig": "a"})),
                (true, json!(FrameParams::of("a"))),
                (
                    true,
                    json!({"rig": "a", "camera": {}, "show": {}, "material": {}, "pose": {}}),
                ),
                (
                    true,
                    json!({"rig": "a", "camera": {"fov_y": 1, "near": null}}),
                ),
                (
                    true,
                    json!({"rig": "a", "camera": {"kind": "look_at", "eye": [0, 0, 1], "target": [0, 0, 0]}}),
                ),
                (
                    true,
                    json!({"rig": "a", "lights": [{"kind": "point", "position": [0, 0, 0]}]}),
                ),
                (true, json!({"rig": "a", "lights": null, "samples": 1})),
                (true, json!({"rig": "a", "lights": "file"})),
                (true, json!({"rig": "a", "lights": []})),
                (false, json!({"rig": "a", "lights": "files"})),
                (false, json!({"rig": "a", "lights": {}})),
                (false, json!({})),
                (false, json!({"rig": "a", "rigg": 1})),
                (false, json!({"rig": "a", "camera": null})),
                (
                    false,
                    json!({"rig": "a", "camera": {"kind": "look_at", "eye": [0, 0, 1]}}),
                ),
                (false, json!({"rig": "a", "camera": {"eye": [0, 0, 1]}})),
                (false, json!({"rig": "a", "camera": {"kind": "sphere"}})),
                (
                    false,
                    json!({"rig": "a", "lights": [{"position": [0, 0, 0]}]}),
                ),
                (
                    false,
                    json!({"rig": "a", "lights": [{"kind": "directional", "position": [0, 0, 0]}]}),
                ),
                (
                    true,
                    json!({"rig": "a", "size": [256.0, 1e2], "samples": 4.0}),
                ),
                (false, json!({"rig": "a", "size": [256.5, 256]})),
                (false, json!({"rig": "a", "size": [1]})),
                (false, json!({"rig": "a", "size": [1, 2, 3]})),
                (false, json!({"rig": "a", "size": [1, -1]})),
                (false, json!({"rig": "a", "samples": 2})),
                (false, json!({"rig": "a", "transport": "json"})),
                (false, json!({"rig": "a", "show": {"skin": "gone"}})),
                (false, json!({"rig": "a", "pose": {"clip": []}})),
                (
                    true,
                    json!({"rig": "a", "pose": {"clips": [{"name": "walk", "time": 0.0}]}}),
                ),
                (
                    false,
                    json!({"rig": "a", "pose": {"clips": [{"name": "walk"}]}}),
                ),
            ],
        ),
        (
            "rig.load",
            &[
                (
                    true,
                    json!({"files": ["a", {"name": "b", "text": ""}, {"name": "c", "base64": ""}]}),
                ),
                (
                    true,
                    json!({"files": [{"name": "c", "attach": {"offset": 0, "bytes": 1}}], "name": null}),
                ),
                (false, json!({"files": [{"name": "b"}]})),
                (
                    false,
                    json!({"files": [{"name": "b", "text": "", "base64": ""}]}),
                ),
                (false, json!({"files": [7]})),
                (
                    false,
                    json!({"files": [{"name": "c", "attach": {"offset": -1, "bytes": 1}}]}),
                ),
            ],
        ),
        (
            "pose.set",
            &[
                (
                    true,
                    json!({"rig": "a", "pose": {"dof_values": [1, 2.5], "base": "rest"}}),
                ),
                (
                    true,
                    json!({"rig": "a", "pose": {"dof_values": {"attach": {"offset": 0, "bytes": 1}}}}),
                ),
                (false, json!({"rig": "a", "pose": {"dof_values": {}}})),
                (
                    false,
                    json!({"rig": "a", "pose": {"rotations": {"x": [0, 0, 1]}}}),
                ),
                (false, json!({"rig": "a", "pose": {"dofs": {"x": "1"}}})),
            ],
        ),
        (
            "mesh.vertices",
            &[
                (
                    true,
                    json!({"rig": "a", "range": {"start": 0, "count": 1}, "attributes": []}),
                ),
                (false, json!({"rig": "a", "range": [0, 1]})),
                (false, json!({"rig": "a", "attributes": ["tangents"]})),
            ],
        ),
        (
            "request.cancel",
            &[
                (true, json!({"request": "x"})),
                (true, json!({"request": null})),
                (true, json!({"request": -1})),
                (true, json!({"request": 1.0})),
                (false, json!({"request": 1.5})),
                (false, json!({})),
            ],
        ),
    ];
    for (name, requests) in cases {
        let validator = of_params(&document, name);
        for (good, request) in requests {
            assert_eq!(validator.is_valid(request), *good, "{name} {request}");
            let raw = serde_json::value::to_raw_value(request).unwrap();
            let parsed = match Method::named(name).unwrap() {
                Method::FrameRender => params::<FrameParams>(Some(&raw)).err(),
                Method::RigLoad => params::<LoadParams>(Some(&raw)).err(),
                Method::PoseSet => params::<PoseSetParams>(Some(&raw)).err(),
                Method::MeshVertices => params::<VerticesParams>(Some(&raw)).err(),
                _ => params::<Cancel>(Some(&raw)).err(),
            };
            assert_eq!(parsed.is_none(), *good, "{name} {request}: {parsed:?}");
        }
    }
}

/// The result is what the type is written as, fits its schema, and does not fit it with something else, or nothing, at any of the places.
fn check<R: Serialize + DeserializeOwned>(method: Method, result: &Value, places: &[&str]) {
    let name = method.name();
    let typed: R = serde_json::from_value(result.clone()).unwrap();
    assert_eq!(&json!(typed), result, "{name}");
    let validator = of_result(&openrpc(), name);
    validator
        .validate(result)
        .unwrap_or_else(|error| panic!("{name}: {error} at {}", error.instance_path()));
    for place in places {
        let mut wrong = result.clone();
        *wrong.pointer_mut(place).unwrap() = json!(true);
        assert!(!validator.is_valid(&wrong), "{name} with true at {place}");
        let (parent, member) = place.rsplit_once('/').unwrap();
        let parent = wrong.pointer_mut(parent).unwrap();
        parent.as_object_mut().unwrap().remove(member).unwrap();
        assert!(!validator.is_valid(&wrong), "{name} without {place}");
    }
}

#[test]
fn pictures_fit_their_schema_and_wrong_ones_do_not() {
    let matrix = [1.0; 16];
    let png = Picture::Png {
        width: 1,
        height: 1,
        file: vec![1, 2, 3].into(),
    };
    let bare = Picture::Rgba8 {
        width: 1,
        height: 1,
        pixels: vec![0; 4].into(),
    };
    for (picture, transport, place) in [
        (png.clone(), PictureTransport::Base64, "/images/color/data"),
        (png, PictureTransport::Attach, "/images/color/offset"),
        (
            bare.clone(),
            PictureTransport::Base64,
            "/images/color/dtype",
        ),
        (bare, PictureTransport::Attach, "/images/color/shape"),
    ] {
        let blob = Blob::picture(picture, transport, &mut Attachments::default());
        let frame = json!({
            "width": 4, "height": 4, "images": {"color": blob}, "rig": "sha256:00", "clamped": [],
            "camera": {"world_from_camera": matrix, "clip_from_world": matrix, "fx": 1.0, "fy": 1.0, "cx": 2.0, "cy": 2.0},
            "renderer": {"name": "cpu", "version": "0.1.0"},
            "timings_ms": {"queue": 0.0, "render": 1.5, "encode": 0.5},
        });
        check::<Frame>(
            Method::FrameRender,
            &frame,
            &[
                place,
                "/images",
                "/camera/fx",
                "/timings_ms/queue",
                "/clamped",
            ],
        );
    }
}

#[test]
fn arrays_fit_their_schema_and_wrong_ones_do_not() {
    for transport in [
        ArrayTransport::Json,
        ArrayTransport::Base64,
        ArrayTransport::Attach,
    ] {
        let mut attachments = Attachments::default();
        let mut array = |dtype, bytes: Vec<u8>| {
            Blob::array(dtype, bytes.into(), &[1, 3], transport, &mut attachments)
        };
        let points = array(Dtype::Float32, 0.5_f32.to_le_bytes().repeat(3));
        let vertices = json!({
            "meshes": [{"name": "skin", "vertex_count": 1, "positions": points}],
            "bounds": {"min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0]},
            "clamped": [{"dof": "elbow.rx", "asked": 3.0, "used": 2.0}],
            "timings_ms": {"queue": 0.5, "render": 1.0, "encode": 0.25},
        });
        check::<Vertices>(
            Method::MeshVertices,
            &vertices,
            &[
                "/meshes/0/positions/shape",
                "/bounds/min",
                "/clamped/0/used",
            ],
        );
        let triangles = array(Dtype::Uint32, [0_u32, 1, 2].map(u32::to_le_bytes).concat());
        let topology = json!({
            "meshes": [{"name": "skin", "vertex_count": 3, "triangle_count": 1, "material": null, "parts": [{"triangle_count": 1, "material": null}], "triangles": triangles}],
        });
        check::<Topology>(
            Method::MeshTopology,
            &topology,
            &["/meshes/0/triangles", "/meshes/0/material"],
        );
    }
}

#[test]
fn other_results_fit_their_schemas_and_wrong_ones_do_not() {
    let summary = json!({
        "name": "wasp", "digest": "sha256:00", "dialects": ["cse169.skel"], "joint_count": 1, "dof_count": 1,
        "vertex_count": 0, "triangle_count": 0, "morph_count": 0, "clip_count": 0, "warnings": [],
    });
    check::<RigSummary>(Method::RigLoad, &summary, &["/digest", "/warnings"]);
    let list = json!({ "rigs": [summary] });
    check::<RigList>(Method::RigList, &list, &["/rigs/0/name"]);
    let mut description = json!({
        "joints": [{"name": "root", "parent": null, "offset": [0.0, 0.0, 0.0], "rotation_order": "zyx", "bounding_box": null}],
        "dofs": [{"name": "root.rx", "kind": "rotation", "joint": "root", "min": null, "max": 1.0, "rest": 0.0, "value": 0.0}],
        "meshes": [{"name": "skin", "vertex_count": 0, "triangle_count": 0, "material": "fur", "parts": [{"triangle_count": 0, "material": "fur"}], "has_texcoords": true}],
        "materials": [{"name": "fur", "texture": null, "color": [1.0, 0.5, 0.25, 1.0], "opacity": "blend", "single_sided": false, "unlit": false}],
        "variants": ["winter"],
        "lights": [{"name": "lamp", "kind": "spot", "joint": null, "joint_from_light": ([1.0; 16]), "color": [1.0, 1.0, 1.0], "intensity": 1.0, "cone": [0.0, 0.5]}],
        "morphs": [], "clips": [],
        "bounds": {"of": "vertices", "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0]},
        "joint_bounds": null,
    });
    let members = description.as_object_mut().unwrap();
    members.extend(summary.as_object().unwrap().clone());
    check::<RigDescription>(
        Method::RigDescribe,
        &description,
        &[
            "/digest",
            "/joints/0/parent",
            "/dofs/0/min",
            "/dofs/0/kind",
            "/bounds",
            "/bounds/of",
            "/clips",
            "/variants",
            "/lights/0/joint",
        ],
    );
    let pose = json!({
        "dofs": {"root.rx": 0.5},
        "joints": {"root": {"translation": [0.0, 0.0, 0.0], "rotation": [0.0, 0.0, 0.0, 1.0], "scale": [1.0, 1.0, 1.0]}},
    });
    check::<StoredPose>(Method::PoseGet, &pose, &["/dofs", "/joints/root/scale"]);
    let set = json!({ "clamped": [{"dof": "elbow.rx", "asked": 3.0, "used": 2.0}] });
    check::<PoseSetResult>(Method::PoseSet, &set, &["/clamped/0/dof"]);
    let matrix = [1.0; 16];
    let transforms = json!({
        "joints": [{"name": "root", "parent": null, "world_from_joint": matrix}],
        "clamped": [],
    });
    check::<Transforms>(
        Method::JointTransforms,
        &transforms,
        &["/joints/0/world_from_joint", "/joints/0/parent"],
    );
    let info = json!({
        "name": "rigd", "version": "0.1.0", "protocol": 1, "limits": {"pixels": 16}, "formats": ["cse169.skel"], "uptime_s": 0.5,
        "adapter": {"name": "CPU", "backend": "cpu", "type": "cpu", "driver": "", "why": "no GPU was found"},
    });
    check::<ServerInfo>(
        Method::ServerInfo,
        &info,
        &["/protocol", "/adapter/type", "/limits"],
    );
    let mut stats = ServerStats::default();
    let outcomes = stats.requests.entry("frame.render".into()).or_default();
    outcomes.ok = 12;
    outcomes.errors.insert("busy".into(), 3);
    let places = ["/requests/frame.render/ok", "/memory/gpu_bytes", "/frames"];
    check::<ServerStats>(Method::ServerStats, &json!(stats), &places);
    check::<Done>(Method::ServerPing, &json!({}), &[]);
    // What a newer server adds is passed over.
    let newer = json!({ "clamped": [], "warnings": [] });
    assert!(serde_json::from_value::<PoseSetResult>(newer).is_ok());
}

#[test]
fn an_error_fits_its_schema_and_half_of_one_does_not() {
    let error = validator(
        &openrpc(),
        &json!({"$ref": "#/components/schemas/ErrorObject"}),
    );
    assert!(error.is_valid(&json!(ErrorObject::from(Fault::DeviceLost))));
    assert!(!error.is_valid(&json!({"code": 1, "message": ""})));
}
