//! What glTF's extensions change and what they leave alone: which of them refuse a file, and what lights and variants look like.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6, PI};
use std::sync::{Arc, LazyLock};
use support::gltf::{Component, Gltf};
use support::pictures::{Image, draw, encoded, over};
use support::{ask, ask_ok};

/// One renderer for all tests; each uses rigs under names of its own.
static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// rigd's own renderer and wgpu's; `None` where there is no Vulkan adapter.
static RENDERERS: LazyLock<Option<[Arc<Service>; 2]>> = LazyLock::new(|| {
    let renderers = [
        support::service_on("cpu")?,
        support::service_on(&support::adapters::wgpu_adapter())?,
    ];
    for service in &renderers {
        load(service, "dressed", &dressed());
        load(
            service,
            "lit",
            &lit(json!({"type": "spot", "intensity": 9.0})),
        );
    }
    Some(renderers)
});

/// Eight bits of a channel, and one rounding either way.
const CHANNEL: f64 = 2.0;
const BACKGROUND: [f64; 3] = [0.0, 0.0, 1.0];

fn load(service: &Arc<Service>, name: &str, gltf: &Gltf) -> Vec<String> {
    let params = json!({"name": name, "files": gltf.files()});
    let summary = ask_ok(service, "rig.load", params);
    serde_json::from_value(summary["warnings"].clone()).expect("a list of sentences")
}

fn describe(rig: &str) -> Value {
    ask_ok(&SERVICE, "rig.describe", json!({ "rig": rig }))
}

/// A wall from -1 to 1 that faces +Z, of the first material, which is dull and white; its node has no parent.
fn wall() -> Gltf {
    let mut gltf = Gltf::default();
    let corners = [
        -1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0,
    ];
    let attributes = json!({
        "POSITION": gltf.floats("VEC3", &corners), "NORMAL": gltf.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4)),
    });
    let indices = gltf.accessor(Component::U8, "SCALAR", &[0.0, 1.0, 2.0, 0.0, 2.0, 3.0]);
    let material = gltf.push("materials", colored([1.0, 1.0, 1.0], json!({})));
    let primitive = json!({"attributes": attributes, "indices": indices, "material": material});
    let mesh = gltf.push("meshes", json!({ "primitives": [primitive] }));
    let node = gltf.node(json!({"name": "wall", "mesh": mesh}));
    gltf.scene(&[node]);
    gltf
}

fn colored([r, g, b]: [f64; 3], members: Value) -> Value {
    let surface =
        json!({"baseColorFactor": [r, g, b, 1], "metallicFactor": 0.0, "roughnessFactor": 1.0});
    over(json!({ "pbrMetallicRoughness": surface }), members)
}

/// Straight on, the wall fills the picture; nothing lights it but what is asked for.
fn request(rig: &str, changes: Value) -> Value {
    let request = json!({
        "rig": rig, "size": [33, 33], "samples": 1, "lights": [], "ambient": [0, 0, 0],
        "background": [BACKGROUND[0], BACKGROUND[1], BACKGROUND[2], 1],
        "camera": {"kind": "look_at", "eye": [0, 0, 5], "target": [0, 0, 0], "height": 2},
    });
    over(request, changes)
}

fn seen(rig: &str, changes: Value) -> Image {
    draw(&SERVICE, &request(rig, changes)).image
}

fn assert_pixel(image: &Image, [x, y]: [usize; 2], linear: [f64; 3], what: &str) {
    let found: Vec<f64> = image.at(x, y)[..3]
        .iter()
        .map(|&it| f64::from(it))
        .collect();
    let wanted = linear.map(encoded);
    let mut pairs = found.iter().zip(wanted);
    let is_near = pairs.all(|(found, wanted)| (found - wanted).abs() <= CHANNEL);
    assert!(is_near, "{what}: {found:?} in place of {wanted:?}");
}

const MIDDLE: [usize; 2] = [16, 16];

#[test]
fn what_changes_looks_alone_refuses_no_file() {
    for name in [
        "KHR_materials_anisotropy",
        "KHR_materials_clearcoat",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_dispersion",
        "KHR_materials_ior",
        "KHR_materials_iridescence",
        "KHR_materials_sheen",
        "KHR_materials_specular",
        "KHR_materials_transmission",
        "KHR_materials_volume",
        "KHR_materials_of_tomorrow",
        "ADOBE_materials_thin_transparency",
        "EXT_lights_ies",
        "EXT_lights_image_based",
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "MSFT_texture_dds",
        "MSFT_packing_occlusionRoughnessMetallic",
        "MSFT_lod",
        "KHR_audio_emitter",
        "KHR_node_visibility",
        "KHR_xmp",
        "KHR_xmp_json_ld",
        "CESIUM_primitive_outline",
        "EXT_structural_metadata",
    ] {
        let mut gltf = wall();
        gltf.json["extensionsRequired"] = json!([name]);
        // A file may say so in either list or both, and as often as it likes.
        for used in [Value::Null, json!([name, name])] {
            let rig = format!("{name} {used}");
            if !used.is_null() {
                gltf.json["extensionsUsed"] = used;
            }
            let warnings = load(&SERVICE, &rig, &gltf);
            assert_eq!(warnings.len(), 1, "{warnings:?}");
            let told = format!("`{name}` is passed over: ");
            assert!(warnings[0].contains(&told), "{warnings:?}");
        }
    }
}

#[test]
fn every_missing_extension_is_named() {
    let mut gltf = wall();
    let refused = |gltf: &Gltf| {
        let params = json!({"name": "refused", "files": gltf.files()});
        let error = ask(&SERVICE, "rig.load", params).expect_err("they are required");
        assert_eq!(error.data.kind, "rig_file_invalid");
        error.detail("found").expect("what was found").clone()
    };
    let draco = "KHR_draco_mesh_compression";
    let required = [
        "EXT_meshopt_compression",
        "KHR_materials_sheen",
        draco,
        "KHR_mesh_quantization",
        "EXT_mesh_gpu_instancing",
        draco,
        "KHR_lights_punctual",
    ];
    gltf.json["extensionsRequired"] = json!(required);
    let wanted = format!("`EXT_mesh_gpu_instancing`, `EXT_meshopt_compression`, `{draco}`");
    assert_eq!(refused(&gltf), json!(wanted));

    let many: Vec<String> = (100..150).map(|number| format!("EXT_{number}")).collect();
    gltf.json["extensionsRequired"] = json!(many);
    let found = refused(&gltf);
    let found = found.as_str().expect("a text");
    assert!(found.contains("`EXT_131` and 18 more"), "{found}");
}

#[test]
fn what_an_extension_brings_that_is_not_read_is_a_fault() {
    fn bare(gltf: &mut Gltf) {
        let accessors = gltf.json["accessors"].as_array_mut().expect("a list");
        for accessor in accessors {
            accessor
                .as_object_mut()
                .expect("an object")
                .remove("bufferView");
        }
    }
    let [draco, meshopt] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];
    type Bring = fn(&mut Gltf, Value);
    let cases: [(&str, Bring); 4] = [
        (draco, |gltf, extension| {
            bare(gltf);
            gltf.json["meshes"][0]["primitives"][0]["extensions"] = extension;
        }),
        (meshopt, |gltf, extension| {
            bare(gltf);
            gltf.json["accessors"][0]["extensions"] = extension;
        }),
        (meshopt, |gltf, extension| {
            gltf.json["buffers"] =
                json!([{"byteLength": gltf.bytes.len(), "extensions": extension}]);
        }),
        (meshopt, |gltf, extension| {
            gltf.json["buffers"] = json!([{"byteLength": gltf.bytes.len()}]);
            let views = gltf.json["bufferViews"].as_array_mut().expect("a list");
            for view in views {
                view["extensions"] = extension.clone();
            }
        }),
    ];
    for (place, (name, by)) in cases.into_iter().enumerate() {
        let mut gltf = wall();
        by(&mut gltf, json!({ name: {"bufferView": 0} }));
        let params = json!({"name": "brought", "files": gltf.files()});
        let error = ask(&SERVICE, "rig.load", params).expect_err("nothing is there");
        let told = format!("the extension `{name}` instead");
        assert!(error.message.contains(&told), "{place}: {}", error.message);
    }
    // Where the file has it all beside the extension, nothing is missing.
    let mut gltf = wall();
    gltf.json["meshes"][0]["primitives"][0]["extensions"] = json!({ draco: {"bufferView": 0} });
    load(&SERVICE, "beside", &gltf);
}

#[test]
fn a_file_that_requires_lights_loads() {
    let file = include_str!("cases/gltf/lights_required.gltf");
    let files = json!([{"name": "lights_required.gltf", "text": file}]);
    let summary = ask_ok(&SERVICE, "rig.load", json!({ "files": files }));
    assert_eq!(summary["warnings"], json!([]));
    let found = ask_ok(&SERVICE, "mesh.vertices", json!({"rig": "lights_required"}));
    let corners = json!([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(found["meshes"][0]["positions"]["data"], corners);
    // It lists a light, but none of its nodes carries it.
    assert_eq!(describe("lights_required")["lights"], json!([]));
}

#[test]
fn a_texture_without_a_picture_that_is_read_is_left_out() {
    let mut gltf = wall();
    let image = gltf.push("images", json!({"mimeType": "image/ktx2", "uri": "x.ktx2"}));
    let texture = gltf.push(
        "textures",
        json!({"extensions": {"KHR_texture_basisu": {"source": image}}}),
    );
    let surface = &mut gltf.json["materials"][0]["pbrMetallicRoughness"];
    surface["baseColorTexture"] = json!({ "index": texture });
    gltf.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    let warnings = load(&SERVICE, "basis", &gltf);
    let told = "textures[0] is left out";
    assert!(warnings.iter().any(|it| it.contains(told)), "{warnings:?}");
    let image = seen("basis", json!({"ambient": [1, 1, 1]}));
    assert_pixel(&image, MIDDLE, [1.0; 3], "white");
}

#[test]
fn emission_is_as_strong_as_the_file_says() {
    for (strength, wanted, warning_count) in [
        (json!(4), 0.4, 0),
        (json!(0.5), 0.05, 0),
        (json!(0), 0.0, 0),
        (json!(1e30), 1.0, 0),
        (json!(-1), 0.1, 1),
        (json!("bright"), 0.1, 1),
        (Value::Null, 0.1, 1),
    ] {
        let extension = match &strength {
            Value::Null => json!(3),
            _ => json!({ "emissiveStrength": strength }),
        };
        let mut gltf = wall();
        gltf.json["materials"][0] = json!({
            "emissiveFactor": [0.1, 0.1, 0.1],
            "extensions": {"KHR_materials_emissive_strength": extension},
        });
        let rig = format!("glowing {strength}");
        assert_eq!(load(&SERVICE, &rig, &gltf).len(), warning_count, "{rig}");
        assert_pixel(&seen(&rig, json!({})), MIDDLE, [wanted; 3], &rig);
    }
}

/// The wall, white in the file's own choice, and its variants: red; green glass, half of it let through; blue from the front alone; one
/// that says nothing of it.
fn dressed() -> Gltf {
    let mut gltf = wall();
    gltf.json["materials"][0]["doubleSided"] = json!(true);
    let red = gltf.push(
        "materials",
        colored([1.0, 0.0, 0.0], json!({"doubleSided": true})),
    );
    let mut glass = colored(
        [0.0, 1.0, 0.0],
        json!({"alphaMode": "BLEND", "doubleSided": true}),
    );
    glass["pbrMetallicRoughness"]["baseColorFactor"][3] = json!(0.5);
    let green = gltf.push("materials", glass);
    let blue = gltf.push("materials", colored([0.0, 0.0, 1.0], json!({})));
    let mappings = json!([
        {"material": red, "variants": [0]}, {"material": green, "variants": [1]}, {"material": blue, "variants": [2]},
    ]);
    gltf.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": mappings}});
    let names = ["red", "glass", "one side", "bare"].map(|name| json!({ "name": name }));
    gltf.json["extensions"] = json!({"KHR_materials_variants": {"variants": names}});
    gltf
}

/// Each variant, whether it is looked at from behind, and what is seen then under white light.
fn dressings() -> Vec<(Value, Value, [f64; 3])> {
    let behind =
        json!({"camera": {"kind": "look_at", "eye": [0, 0, -5], "target": [0, 0, 0], "height": 2}});
    let variant = |name: &str| json!({"material": {"variant": name}});
    vec![
        (json!({}), json!({}), [1.0; 3]),
        (variant("red"), json!({}), [1.0, 0.0, 0.0]),
        (variant("red"), behind.clone(), [1.0, 0.0, 0.0]),
        (variant("glass"), json!({}), [0.0, 0.5, 0.5]),
        (
            variant("one side"),
            json!({"background": [1, 1, 0, 1]}),
            [0.0, 0.0, 1.0],
        ),
        (
            variant("one side"),
            over(behind, json!({"background": [1, 1, 0, 1]})),
            [1.0, 1.0, 0.0],
        ),
        (variant("bare"), json!({}), [1.0; 3]),
    ]
}

#[test]
fn a_variant_is_shown_on_request() {
    assert_eq!(load(&SERVICE, "dressed", &dressed()), [""; 0]);
    let names = json!(["red", "glass", "one side", "bare"]);
    assert_eq!(describe("dressed")["variants"], names);
    let white = json!({"ambient": [1, 1, 1]});
    for (variant, view, wanted) in dressings() {
        let changes = over(over(white.clone(), variant), view);
        assert_pixel(
            &seen("dressed", changes.clone()),
            MIDDLE,
            wanted,
            &changes.to_string(),
        );
    }
    // What a request gives stands in place of what the variant says.
    let given = json!({"ambient": [1, 1, 1], "material": {"variant": "red", "diffuse": [0, 1, 0]}});
    assert_pixel(&seen("dressed", given), MIDDLE, [0.0, 1.0, 0.0], "given");

    // In a batch each picture has its own.
    let mut batch = request("dressed", white);
    batch["material"] = json!({"variant": "red"});
    batch["frames"] = json!([{}, {"material": {"variant": "one side"}}, {"material": {}}]);
    let pictures = ask_ok(&SERVICE, "frame.batch", batch.clone());
    let pictures = pictures["frames"].as_array().expect("a list").iter();
    let encoded = pictures.map(|it| it["images"]["color"]["data"].clone());
    let encoded: Vec<Value> = encoded.collect();
    assert!(encoded[0] != encoded[1] && encoded[1] != encoded[2] && encoded[0] != encoded[2]);
    batch["frames"] = json!([{}, {"material": {"variant": "one sid"}}]);
    let error = ask(&SERVICE, "frame.batch", batch).expect_err("there is no such variant");
    assert_eq!(
        error.detail("path"),
        Some(&json!("frames[1].material.variant"))
    );
    assert!(
        error.message.contains("did you mean `one side`?"),
        "{error}"
    );

    // What cannot be seen cannot be picked.
    let mut pick = request("dressed", dressings()[5].1.clone());
    pick["pixel"] = json!([16.5, 16.5]);
    pick["targets"] = json!(["skin"]);
    assert_eq!(
        ask_ok(&SERVICE, "scene.pick", pick.clone())["hit"]["kind"],
        "skin"
    );
    pick["material"] = json!({"variant": "one side"});
    assert_eq!(ask_ok(&SERVICE, "scene.pick", pick)["hit"], Value::Null);
}

#[test]
fn variants_that_are_not_as_they_should_be_are_left_out() {
    for (bend, told) in [
        (
            json!({"mappings": [{"material": 9, "variants": [0]}]}),
            "names material 9 of 4",
        ),
        (
            json!({"mappings": [{"material": 1, "variants": [0, 7]}]}),
            "names variant 7 of 4",
        ),
        (
            json!({"mappings": [{"material": 1}]}),
            "expected a member `variants`, but found none",
        ),
        (
            json!({"mappings": 1}),
            "expected a list, but found integer `1`",
        ),
    ] {
        let mut gltf = dressed();
        gltf.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"] = bend;
        let warnings = load(&SERVICE, &format!("bent {told}"), &gltf);
        assert!(
            warnings.len() == 1 && warnings[0].contains(told),
            "{warnings:?}"
        );
    }
    let mut gltf = dressed();
    let names: Vec<Value> = (0..200_000).map(|_| json!({"name": "again"})).collect();
    gltf.json["extensions"]["KHR_materials_variants"]["variants"] = json!(names);
    let warnings = load(&SERVICE, "too many", &gltf);
    assert!(
        warnings[0].contains("the first 131072 are kept"),
        "{warnings:?}"
    );
}

/// The wall and, on the node `arm`, a lamp: a light alone, a quarter along X and one before the wall, shining at it.
fn lit(light: Value) -> Gltf {
    let mut gltf = wall();
    let lamp = gltf.node(json!({
        "name": "lamp", "translation": [0.25, 0, 1], "extensions": {"KHR_lights_punctual": {"light": 0}},
    }));
    let arm = gltf.node(json!({"name": "arm", "children": [lamp]}));
    gltf.json["scenes"][0]["nodes"] = json!([0, arm]);
    gltf.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    gltf
}

fn rest(dofs: Value) -> Value {
    json!({"base": "rest", "dofs": dofs})
}

#[test]
fn lights_of_the_file_shine_where_its_pose_puts_them() {
    let color = [1.0, 0.5, 0.25];
    let point = json!({"type": "point", "name": "bulb", "color": color, "intensity": 2.0});
    assert_eq!(load(&SERVICE, "bulb", &lit(point)), [""; 0]);
    let sun = json!({"type": "directional", "color": color, "intensity": 2.0});
    assert_eq!(load(&SERVICE, "sun", &lit(sun)), [""; 0]);
    let described = describe("bulb");
    let light = &described["lights"][0];
    assert_eq!(
        [
            &light["name"],
            &light["kind"],
            &light["joint"],
            &light["intensity"]
        ],
        [&json!("bulb"), &json!("point"), &json!("arm"), &json!(2.0)]
    );
    assert_eq!(
        described["joint_count"], 2,
        "a node of a light alone is no joint"
    );

    // As lights of a request are that stand in the same place; a candela and a lux are 1/π of their intensity.
    let intensity = 2.0 / PI;
    let at = |position: [f64; 3]| json!([{"kind": "point", "position": position, "color": color, "intensity": intensity, "falloff": "inverse_square"}]);
    let along = |direction: [f64; 3]| json!([{"kind": "directional", "direction": direction, "color": color, "intensity": intensity}]);
    let turned = json!({"arm.ry": FRAC_PI_6});
    let (sine, cosine) = FRAC_PI_6.sin_cos();
    for (rig, dofs, given) in [
        ("bulb", json!({}), at([0.25, 0.0, 1.0])),
        (
            "bulb",
            json!({"arm.tx": -0.75, "arm.ty": 0.5}),
            at([-0.5, 0.5, 1.0]),
        ),
        ("bulb", json!({"arm.sz": 0.5}), at([0.25, 0.0, 0.5])),
        ("sun", json!({}), along([0.0, 0.0, -1.0])),
        ("sun", turned, along([-sine, 0.0, -cosine])),
        // A directional light is the same everywhere.
        ("sun", json!({"arm.tx": 9}), along([0.0, 0.0, -1.0])),
    ] {
        let of_file = seen(rig, json!({"pose": rest(dofs.clone()), "lights": "file"}));
        let of_request = seen(rig, json!({"pose": rest(dofs.clone()), "lights": given}));
        assert!(of_file.worst_difference(&of_request) <= 1, "{rig} {dofs}");
        assert!(of_file.center()[0] > 100, "{rig} {dofs} lights something");
    }
    // Squeezed to nothing it points nowhere.
    let flat = seen(
        "sun",
        json!({"pose": rest(json!({"arm.sz": 0})), "lights": "file"}),
    );
    assert_pixel(&flat, MIDDLE, [0.0; 3], "a light that points nowhere");

    let mut batch = request("bulb", json!({}));
    batch["frames"] = json!([{"lights": "file"}, {"lights": []}]);
    let pictures = ask_ok(&SERVICE, "frame.batch", batch);
    let picture = |index: usize| &pictures["frames"][index]["images"]["color"]["data"];
    assert_ne!(picture(0), picture(1));
}

#[test]
fn a_rig_without_lights_in_its_file_cannot_be_lit_by_them() {
    load(&SERVICE, "unlit", &wall());
    let params = request("unlit", json!({"lights": "file"}));
    let error = ask(&SERVICE, "frame.render", params).expect_err("there are none");
    assert_eq!(error.detail("path"), Some(&json!("lights")));
    let batch = json!({"rig": "figure", "frames": [{}, {"lights": "file"}]});
    let error = ask(&SERVICE, "frame.batch", batch).expect_err("there are none");
    assert_eq!(error.detail("path"), Some(&json!("frames[1].lights")));
}

#[test]
fn a_spot_light_shines_into_its_cone() {
    // From one unit before the wall, its middle a quarter to the right of the wall's own: the tangent of the angle is the distance on the wall.
    let spot = |inner: f64, outer: f64| {
        let cone = json!({"innerConeAngle": inner, "outerConeAngle": outer});
        json!({"type": "spot", "intensity": 2.0, "spot": cone})
    };
    load(
        &SERVICE,
        "bulb beside it",
        &lit(json!({"type": "point", "intensity": 2.0})),
    );
    load(&SERVICE, "wide spot", &lit(spot(FRAC_PI_3, FRAC_PI_2)));
    load(&SERVICE, "spot", &lit(spot(0.1, 0.4)));
    load(&SERVICE, "sharp spot", &lit(spot(0.3999999, 0.4)));
    let of = |rig: &str| seen(rig, json!({"lights": "file"}));
    let bulb = of("bulb beside it");
    assert!(
        of("wide spot").worst_difference(&bulb) <= 1,
        "all is within the inner cone"
    );
    let image = of("spot");
    // Pixel centers are 2/33 apart.
    for x in 0..33 {
        let distance = ((x as f64 - 16.0) * 2.0 / 33.0 - 0.25).abs();
        let cosine = 1.0 / distance.hypot(1.0);
        let share = (cosine - 0.4f64.cos()) / (0.1f64.cos() - 0.4f64.cos());
        let illuminance = 2.0 * cosine.powi(3) * share.clamp(0.0, 1.0).powi(2);
        assert_pixel(
            &image,
            [x, 16],
            [illuminance / PI; 3],
            &format!("column {x}"),
        );
    }
    let (sharp, edge) = (of("sharp spot"), 0.4f64.tan());
    for (x, y, color) in sharp.iter() {
        let [across, up] = [x, y].map(|it| (it as f64 - 16.0) * 2.0 / 33.0);
        let distance = (across - 0.25).hypot(up);
        if (distance - edge).abs() > 0.01 {
            let wanted = if distance < edge {
                bulb.at(x, y)
            } else {
                [0, 0, 0, 255]
            };
            assert!(color[0].abs_diff(wanted[0]) <= 1, "{x} {y}: {color:?}");
        }
    }
}

#[test]
fn a_light_rides_on_the_nearest_joint_above_it() {
    // arm > camera > lamp: neither the camera nor the lamp is a joint.
    let mut gltf = lit(json!({"type": "point"}));
    let camera = json!({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}});
    let camera = gltf.push("cameras", camera);
    let mount = json!({"camera": camera, "translation": [0, 1, 0], "rotation": [0, 0, 1, 0], "children": [1]});
    let mount = gltf.node(mount);
    gltf.json["nodes"][2]["children"] = json!([mount]);
    load(&SERVICE, "mounted", &gltf);
    let described = describe("mounted");
    assert_eq!(described["joint_count"], 2);
    let light = &described["lights"][0];
    assert_eq!(light["joint"], "arm");
    let place: Vec<f64> =
        serde_json::from_value(light["joint_from_light"].clone()).expect("16 numbers");
    let wanted = [-0.25, 1.0, 1.0];
    let mut pairs = place[12..15].iter().zip(wanted);
    assert!(pairs.all(|(a, b)| (a - b).abs() < 1e-6), "{place:?}");

    // What an animation moves is a joint, and so is what is below it.
    let times = gltf.floats("SCALAR", &[0.0, 1.0]);
    let moves = gltf.floats("VEC3", &[0.0, 1.0, 0.0, 0.0, 3.0, 0.0]);
    let sampler = json!({"input": times, "output": moves});
    gltf.channel(
        "swing",
        json!({"node": mount, "path": "translation"}),
        sampler,
    );
    load(&SERVICE, "swinging", &gltf);
    let described = describe("swinging");
    assert_eq!(described["joint_count"], 3, "the light's own node is none");
    let mount = described["joints"][2]["name"].clone();
    assert_eq!(described["lights"][0]["joint"], mount);
    let at = |time: f64| {
        let pose = json!({"base": "rest", "clip": {"name": "swing", "time": time}});
        seen("swinging", json!({"pose": pose, "lights": "file"}))
    };
    assert!(at(0.0).center()[0] > at(1.0).center()[0], "it moves away");

    // Alone in the scene, it stands where its own node puts it.
    let mut gltf = lit(json!({"type": "point"}));
    gltf.json["scenes"][0]["nodes"] = json!([0, 1]);
    gltf.json["nodes"][2] = json!({"name": "arm"});
    load(&SERVICE, "standing", &gltf);
    assert_eq!(describe("standing")["lights"][0]["joint"], Value::Null);
    let given = json!([{"kind": "point", "position": [0.25, 0, 1], "intensity": 1.0 / PI, "falloff": "inverse_square"}]);
    let difference = seen("standing", json!({"lights": "file"}))
        .worst_difference(&seen("standing", json!({"lights": given})));
    assert!(difference <= 1);
}

#[test]
fn numbers_of_lights_that_are_a_little_off_are_held_to_what_they_may_be() {
    let spot = |inner: f64, outer: f64| json!({"type": "spot", "spot": {"innerConeAngle": inner, "outerConeAngle": outer}});
    for (light, told) in [
        (
            json!({"type": "point", "color": [1, 1, 2]}),
            "its color is held",
        ),
        // π/2 of float32.
        (
            spot(0.5, f64::from(std::f32::consts::FRAC_PI_2)),
            "its outer angle is held to π/2",
        ),
        (spot(0.5, 1.6), "its outer angle is held to π/2"),
        (spot(-0.5, 0.5), "its inner angle is held"),
        (spot(0.5, 0.5), "its inner angle is held"),
        (spot(1.0, 0.5), "its inner angle is held"),
    ] {
        let rig = format!("held light {light}");
        let warnings = load(&SERVICE, &rig, &lit(light));
        assert!(
            warnings.len() == 1 && warnings[0].contains(told),
            "{warnings:?}"
        );
        assert_eq!(describe(&rig)["lights"].as_array().map(Vec::len), Some(1));
        seen(&rig, json!({"lights": "file"}));
    }
}

#[test]
fn lights_that_are_not_as_they_should_be_are_left_out() {
    for (light, told) in [
        (json!({"type": "area"}), "unknown variant `area`"),
        (json!({}), "expected a member `type`, but found none"),
        (json!({"type": "point", "intensity": -1}), "its intensity"),
        (
            json!({"type": "spot", "spot": {"outerConeAngle": 0}}),
            "its cone",
        ),
    ] {
        let rig = format!("bad light {told}");
        let warnings = load(&SERVICE, &rig, &lit(light));
        assert!(
            warnings.len() == 1 && warnings[0].contains(told),
            "{warnings:?}"
        );
        assert_eq!(describe(&rig)["lights"], json!([]));
    }
    let mut gltf = lit(json!({"type": "point", "range": 3.0}));
    let warnings = load(&SERVICE, "ranged", &gltf);
    assert!(
        warnings.len() == 1 && warnings[0].contains("ranges"),
        "{warnings:?}"
    );
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"][0] = json!({"type": "point"});
    gltf.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = json!(3);
    let warnings = load(&SERVICE, "nowhere", &gltf);
    assert!(
        warnings.len() == 1 && warnings[0].contains("one of the 1 lights"),
        "{warnings:?}"
    );
    gltf.json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = json!(0);
    gltf.json["nodes"][1]["translation"] = json!([1e30, 0, 0]);
    let warnings = load(&SERVICE, "far away", &gltf);
    assert!(
        warnings.len() == 1 && warnings[0].contains("stands beyond"),
        "{warnings:?}"
    );

    let mut gltf = lit(json!({"type": "point"}));
    let lamps =
        (0..20).map(|_| gltf.node(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}})));
    let mut roots: Vec<usize> = lamps.collect();
    roots.push(0);
    gltf.json["scenes"][0]["nodes"] = json!(roots);
    let warnings = load(&SERVICE, "many lamps", &gltf);
    assert!(
        warnings.len() == 1 && warnings[0].contains("of 20 lights the first 16"),
        "{warnings:?}"
    );
    let described = describe("many lamps");
    assert_eq!(described["lights"].as_array().map(Vec::len), Some(16));
    seen("many lamps", json!({"lights": "file"}));
}

#[test]
fn both_renderers_show_variants_and_lights_alike() {
    let Some(renderers) = RENDERERS.as_ref() else {
        return;
    };
    let of_variants = dressings().into_iter().map(|(variant, view, _)| {
        request(
            "dressed",
            over(over(json!({"ambient": [1, 1, 1]}), variant), view),
        )
    });
    let translucent = json!({"ambient": [1, 1, 1], "material": {"variant": "glass"}, "show": {"skin_opacity": 0.5}});
    let of_lights = [
        request("lit", json!({"lights": "file"})),
        request(
            "lit",
            json!({"lights": "file", "pose": rest(json!({"arm.ry": -0.3, "arm.tx": -0.4}))}),
        ),
        request("dressed", translucent),
    ];
    for request in of_variants.chain(of_lights) {
        let [one, other] = [0, 1].map(|index| draw(&renderers[index], &request).image);
        assert!(one.worst_difference(&other) <= 2, "{request}");
    }
}
