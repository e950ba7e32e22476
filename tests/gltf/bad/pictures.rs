//! Pictures that are broken, missing or too large.

use super::{broken, outcome};
use crate::support::everything::{good, picture};
use serde_json::{Value, json};

/// CRC-32 as PNG has it, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _: u32| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
    !bytes
        .iter()
        .fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

/// The picture with another size in its header, and its checksum right.
fn sized(width: u32, height: u32) -> Vec<u8> {
    let mut file = picture();
    // 8 bytes of signature, length and name of the first chunk; then width and height; 13 bytes of content in all.
    file[16..20].copy_from_slice(&width.to_be_bytes());
    file[20..24].copy_from_slice(&height.to_be_bytes());
    let checksum = crc(&file[12..29]);
    file[29..33].copy_from_slice(&checksum.to_be_bytes());
    file
}

#[test]
fn pictures_that_are_broken_or_missing_do_no_harm() {
    // Or the checksum alone would be the fault.
    assert_eq!(sized(2, 2), picture());
    let whole = picture();
    let embedded = |bytes: &[u8], media: &str| {
        let mut gltf = good();
        let view = gltf.view(bytes);
        gltf.json["images"][0] = json!({"bufferView": view, "mimeType": media});
        gltf
    };
    let image = |image: Value| {
        let mut gltf = good();
        gltf.json["images"][0] = image;
        gltf
    };
    for (what, gltf) in [
        (
            "a picture of 60000x60000",
            embedded(&sized(60_000, 60_000), "image/png"),
        ),
        (
            "a picture of 2^31-1",
            embedded(&sized(i32::MAX as u32, i32::MAX as u32), "image/png"),
        ),
        ("a picture of nothing", embedded(&sized(0, 0), "image/png")),
        (
            "half a picture",
            embedded(&whole[..whole.len() / 2], "image/png"),
        ),
        ("a header of a picture", embedded(&whole[..8], "image/png")),
        ("an empty picture", embedded(&[], "image/png")),
        ("a picture of another kind", embedded(&whole, "image/jpeg")),
        ("a picture of no kind", embedded(&whole, "image/x-nobody")),
        ("no picture", embedded(b"hello there", "image/png")),
        (
            "a picture that is missing",
            image(json!({"uri": "missing.png"})),
        ),
        ("a picture outside", image(json!({"uri": "../x.png"}))),
        (
            "a picture of the system",
            image(json!({"uri": "file:///etc/passwd"})),
        ),
        (
            "a picture elsewhere",
            image(json!({"uri": "http://localhost/x.png"})),
        ),
        (
            "a picture of broken base64",
            image(json!({"uri": "data:image/png;base64,!!!!"})),
        ),
        (
            "a picture in no such view",
            image(json!({"bufferView": 77, "mimeType": "image/png"})),
        ),
        ("a picture that is nowhere", image(json!({}))),
        (
            "no such image",
            broken(|it| it.json["textures"][0]["source"] = json!(77)),
        ),
        (
            "no such sampler of a texture",
            broken(|it| it.json["textures"][0]["sampler"] = json!(77)),
        ),
        (
            "a texture of nothing",
            broken(|it| it.json["textures"][0] = json!({})),
        ),
        (
            "a wrap of nobody",
            broken(|it| it.json["samplers"][0]["wrapS"] = json!(7)),
        ),
        (
            "no such texture",
            broken(|it| {
                it.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] =
                    json!(77)
            }),
        ),
        (
            "texture coordinates that are not there",
            broken(|it| {
                it.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] =
                    json!(7)
            }),
        ),
    ] {
        match outcome(what, gltf.files()) {
            // A wrap of nobody and a picture whose kind is told wrongly may be taken for what they are.
            Ok(summary) => assert!(summary["warnings"].is_array(), "{what}"),
            Err(error) => {
                let kind = error.data.kind.as_str();
                assert!(
                    ["rig_file_invalid", "limit_exceeded"].contains(&kind),
                    "{what}: {kind}"
                );
            }
        }
    }
}
