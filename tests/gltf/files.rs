//! Files as a whole: where bytes come from, what is valid and seldom, extensions.

use crate::support::{ask, with_base64};
use crate::{CORNERS, SERVICE, assert_near, case, load, load_files, positions, triangle, warnings};
use serde_json::json;

#[test]
fn a_buffer_comes_from_wherever_it_is() {
    let gltf = triangle();
    let beside = |uri: &str, name: &str| {
        let text = gltf.document(Some(uri)).to_string();
        json!([{"name": "x.gltf", "text": text}, with_base64(name, &gltf.bytes)])
    };
    let other_media = gltf.data_uri().replace("octet-stream", "gltf-buffer");
    let other_media = gltf.document(Some(&other_media)).to_string();
    for (what, files) in [
        ("a data URI", gltf.files()),
        (
            "a data URI of glTF's own media type",
            json!([{"name": "x.gltf", "text": other_media}]),
        ),
        ("a file beside", beside("x.bin", "x.bin")),
        (
            "a file whose name has a space",
            beside("my%20data.bin", "my data.bin"),
        ),
        ("a binary chunk", json!([with_base64("x.glb", &gltf.glb())])),
        (
            "a binary file of another name",
            json!([with_base64("x", &gltf.glb())]),
        ),
    ] {
        let summary = load_files(what, files);
        assert_eq!(warnings(&summary), [""; 0], "{what}");
        assert_eq!(
            (&summary["vertex_count"], &summary["triangle_count"]),
            (&json!(3), &json!(1)),
            "{what}"
        );
        assert_near(&positions(what, json!({})), &CORNERS, 0.0, what);
    }
}

/// One triangle, whatever else the file has.
#[test]
fn what_is_valid_and_seldom_loads() {
    for (name, told) in [
        ("accessor_of_zeros.gltf", None),
        ("data_uri_percent_encoded.gltf", None),
        ("integers_as_floats.gltf", None),
        ("unused_placeholder_buffer.gltf", Some("buffers[1]")),
        ("glb_json_then_unknown_chunk_no_bin.glb", Some("`TEST`")),
    ] {
        let summary = load_files(name, case(name));
        let warnings = warnings(&summary);
        assert_eq!(
            warnings.len(),
            usize::from(told.is_some()),
            "{name}: {warnings:?}"
        );
        assert!(
            warnings
                .iter()
                .all(|it| it.contains(told.unwrap_or_default())),
            "{warnings:?}"
        );
        let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert_eq!(positions(name, json!({})), corners, "{name}");
    }
    let moved = positions(
        "accessor_of_zeros.gltf",
        json!({"dofs": {"morph.morph_0": 1.0}}),
    );
    assert_eq!(moved, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
}

/// With and without base64, escaped or broken into lines, padded or not.
#[test]
fn a_data_uri_holds_the_same_bytes_however_it_is_written() {
    let gltf = triangle();
    let base64 = gltf.data_uri();
    let (head, text) = base64.split_once(',').expect("a data URI");
    let escaped = |bytes: &[u8]| {
        let escape = |byte: &u8| format!("%{byte:02x}");
        bytes.iter().map(escape).collect::<String>()
    };
    let (first, last) = text.split_at(10);
    for (what, uri) in [
        (
            "escaped base64",
            format!("{head},{}", escaped(text.as_bytes())),
        ),
        (
            "padding that is escaped",
            format!("{head},{}%3D%3D", text.trim_end_matches('=')),
        ),
        (
            "no padding",
            format!("{head},{}", text.trim_end_matches('=')),
        ),
        ("two lines", format!("{head},{first}%0D%0A{last}")),
        (
            "a parameter before",
            format!("data:application/octet-stream;charset=x;BASE64,{text}"),
        ),
        (
            "bytes",
            format!("data:application/octet-stream,{}", escaped(&gltf.bytes)),
        ),
        (
            "bytes of no medium",
            format!("data:,{}", escaped(&gltf.bytes)),
        ),
    ] {
        let content = gltf.document(Some(&uri)).to_string();
        let summary = load_files(what, json!([{"name": "x.gltf", "text": content}]));
        assert_eq!(warnings(&summary), [""; 0], "{what}");
        assert_eq!(positions(what, json!({})), CORNERS, "{what}");
    }
}

#[test]
fn extensions_are_known_refused_or_warned_of() {
    for known in [
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_materials_unlit",
        "KHR_materials_pbrSpecularGlossiness",
    ] {
        let mut gltf = triangle();
        gltf.json["extensionsUsed"] = json!([known]);
        gltf.json["extensionsRequired"] = json!([known]);
        assert_eq!(warnings(&load(known, &gltf)), [""; 0], "{known}");
    }
    let mut gltf = triangle();
    gltf.json["extensionsUsed"] = json!(["EXT_of_nobody"]);
    let warnings = warnings(&load("used", &gltf));
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("EXT_of_nobody"), "{warnings:?}");

    gltf.json["extensionsRequired"] = json!(["EXT_of_nobody"]);
    let params = json!({"name": "required", "files": gltf.files()});
    let error = ask(&SERVICE, "rig.load", params).expect_err("it is required");
    assert_eq!(error.data.kind, "rig_file_invalid");
    assert!(error.message.contains("EXT_of_nobody"), "{}", error.message);
}
