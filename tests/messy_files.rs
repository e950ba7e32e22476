//! What files of the courses hold beside what their grammars say: does each load as its author meant it, with a word about what was passed
//! over?

mod support;

use rigd::formats::{File, FileRef, Loaded, Source, load};
use rigd::limits::Limits;
use rigd::rig::{Rig, Rotation};

fn loaded(files: &[(&str, &[u8])]) -> Loaded {
    let inline = |&(name, bytes): &(&str, &[u8])| {
        FileRef::Inline(File {
            name: name.to_owned(),
            bytes: bytes.into(),
        })
    };
    let files: Vec<_> = files.iter().map(inline).collect();
    load(&files, &Source::inline_only(), &Limits::default()).expect("it is only messy")
}

fn text(name: &str, text: &str) -> Rig {
    loaded(&[(name, text.as_bytes())]).rig
}

/// Files of `tests/cases/course`.
fn cases(names: &[&str]) -> Loaded {
    let read = |name: &&str| support::case_bytes(&format!("course/{name}"));
    let contents: Vec<Vec<u8>> = names.iter().map(read).collect();
    let contents = contents.iter().map(Vec::as_slice);
    let files: Vec<_> = names.iter().copied().zip(contents).collect();
    loaded(&files)
}

fn joint_names(rig: &Rig) -> Vec<&str> {
    let joints = rig.skeleton().joints().iter();
    joints.map(|joint| joint.name.as_str()).collect()
}

#[test]
fn a_pose_that_is_commented_out_turns_nothing() {
    let rig = cases(&["comment_disabled_pose.skel"]).rig;
    assert_eq!(joint_names(&rig), ["root"]);
    assert!(rig.dofs().all().iter().all(|dof| dof.rest == 0.0));
    let wanted = "comment_disabled_pose.skel:3:3: passed over a comment";
    assert_eq!(rig.warnings(), [wanted]);
}

#[test]
fn a_joint_that_is_commented_out_is_none() {
    let rig = cases(&["comment_disabled_joint.skel"]).rig;
    assert_eq!(joint_names(&rig), ["root", "leg"]);
    let wanted =
        "comment_disabled_joint.skel:2:3: passed over 3 comments, of which this is the first";
    assert_eq!(rig.warnings(), [wanted]);
}

#[test]
fn words_and_braces_of_a_comment_mean_nothing() {
    let rig = cases(&["comment_words.skel"]).rig;
    assert_eq!(joint_names(&rig), ["root"]);
    assert_eq!(rig.skeleton().joints()[0].offset, glam::DVec3::ZERO);
    assert_eq!(rig.warnings().len(), 1);
}

#[test]
fn limits_of_ten_thousand_million_are_limits() {
    let rig = cases(&["limit_1e10.skel"]).rig;
    let rx = rig.dofs().all().iter().find(|dof| dof.name == "a.rx");
    let limit = rx.expect("every joint has one").limit;
    assert_eq!((limit.min, limit.max), (-1e10, 1e10));
    assert_eq!(rig.warnings(), [""; 0]);
}

#[test]
fn a_limit_past_a_joint_without_a_pose_loads() {
    let rig = cases(&["roll_get.skel"]).rig;
    assert_eq!(joint_names(&rig), ["a", "b", "e"]);
    assert_eq!(rig.warnings(), [""; 0]);
}

#[test]
fn normals_of_no_rows_are_computed() {
    let rig = cases(&["normals_0.skin"]).rig;
    let normals = rig.meshes()[0].normals();
    assert!(normals.len() == 4 && normals.iter().all(|&normal| normal == glam::Vec3::Z));
    let wanted = "normals_0.skin:5:25: the texture `picture.bmp` is left out: it was not found";
    assert_eq!(rig.warnings(), [wanted]);
}

#[test]
fn a_texture_that_is_too_wide_is_left_out_by_name() {
    let rig = cases(&["wide_texture.skin", "wide_17000.png"]).rig;
    assert_eq!(rig.textures().count(), 0);
    let wanted = "wide_texture.skin:5:25: the texture `wide_17000.png` is left out: \
        17000 exceeds the limit `side` of 16384";
    assert_eq!(rig.warnings(), [wanted]);
}

#[test]
fn a_picture_of_a_gltf_that_is_too_wide_is_left_out_by_name() {
    let zeros = "A".repeat(48);
    let document = format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "material": 0}}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}],
        "textures": [{{"source": 0}}], "images": [{{"uri": "wide_17000.png"}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{zeros}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [0, 0, 0]}},
            {{"bufferView": 0, "componentType": 5126, "type": "VEC2", "count": 3}}]}}"#
    );
    let picture = support::case_bytes("course/wide_17000.png");
    let rig = loaded(&[
        ("a.gltf", document.as_bytes()),
        ("wide_17000.png", &picture),
    ])
    .rig;
    assert_eq!(rig.textures().count(), 0);
    let wanted =
        "a.gltf: images[0], `wide_17000.png`, is left out: 17000 exceeds the limit `side` of 16384";
    assert_eq!(rig.warnings(), [wanted]);
}

#[test]
fn a_comment_first_does_not_change_what_a_file_is() {
    let names = [
        "mit_comment_first.mit.skel",
        "mit_comment_first.obj",
        "mit_comment_first.attach",
    ];
    let Loaded { rig, dialects, .. } = cases(&names);
    assert_eq!(dialects, ["mit6837 skel", "obj", "mit6837 attach"]);
    assert_eq!((rig.skeleton().joints().len(), rig.vertex_count()), (2, 3));
    assert_eq!(
        rig.warnings(),
        ["mit_comment_first.mit.skel:1:1: passed over a comment"]
    );
    for (name, first, dialect) in [
        ("a.txt", "balljoint a { }", "cse169 skel"),
        ("a.skel", "0 0 0 -1", "mit6837 skel"),
        (
            "a.txt",
            "positions 1 { 0 0 0 } triangles 0 { }",
            "cse169 skin",
        ),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "obj"),
    ] {
        let commented = format!("\r\n# joint {{\n{first}");
        assert_eq!(loaded(&[(name, commented.as_bytes())]).dialects, [dialect]);
    }
}

#[test]
fn a_comment_behind_a_row_names_no_joint() {
    let rig = cases(&["slash_name.mit.skel"]).rig;
    assert_eq!(joint_names(&rig), ["joint_0", "joint_1"]);
    assert_eq!(rig.warnings().len(), 1);
}

#[test]
fn a_hash_inside_a_name_is_part_of_it() {
    let rig = text(
        "a.skel",
        "balljoint knee#2 { balljoint 2#2 { } # balljoint b { }\n }",
    );
    assert_eq!(joint_names(&rig), ["knee#2", "2#2"]);
}

/// A family of files, whole and with comments wherever a word may stand: the same rig.
#[test]
fn comments_anywhere_in_any_file_change_nothing() {
    const CSE169: [(&str, &str); 5] = [
        (
            "a.skel",
            "balljoint a {\n offset 0 1 0\n rotxlimit -1 1\n balljoint b {\n pose 0 .5 0\n }\n}\n",
        ),
        (
            "a.skin",
            "positions 3 {\n 0 0 0\n 1 0 0\n 0 1 0\n }\n skinweights 3 {\n 1 0 1\n 2 0 .5\n 1 .5\n 1 1 1\n }\n \
             triangles 1 {\n 0 1 2\n }\n material m {\n }\n bindings 2 {\n matrix {\n 1 0 0 0 1 0\n 0 0 1 0 1 0\n }\n \
             matrix {\n 1 0 0 0 1 0 0 0 1 0 0 0\n }\n }\n",
        ),
        ("a.morph", "positions 1 {\n 2 0\n 3 0\n }\n"),
        (
            "a.anim",
            "animation {\n range 0 1\n numchannels 1\n channel {\n keys 1 {\n 0 5\n flat flat\n }\n }\n }\n",
        ),
        (
            "a.rig",
            "rig a {\n skeleton a.skel\n skin a.skin\n morphs 1 {\n a.morph\n }\n }\n",
        ),
    ];
    const MIT: [(&str, &str); 2] = [
        ("a.skel", "0 0 0 -1\n0 1 0 0 arm\n0 1 0 1\n"),
        ("a.attach", "1 0\n0 1\n.5 .5\n"),
    ];
    const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mit: Vec<_> = MIT.into_iter().chain([("a.obj", OBJ)]).collect();
    for family in [&CSE169[..], &mit] {
        let whole: Vec<_> = family
            .iter()
            .map(|&(name, text)| (name, text.as_bytes()))
            .collect();
        let wanted = loaded(&whole).rig;
        for (name, text) in family.iter().filter(|(name, _)| *name != "a.obj") {
            let commented = text
                .replace('\n', " // } pose 1 1 1 { 7 matrix\n#pose 2 2 2\n\t; 9 9\n")
                .replace(" 0", " 0 /* 8 } */");
            let files: Vec<_> = whole
                .iter()
                .map(|&(file, bytes)| {
                    (
                        file,
                        if file == *name {
                            commented.as_bytes()
                        } else {
                            bytes
                        },
                    )
                })
                .collect();
            let found = loaded(&files).rig;
            let told = |rig: &Rig| {
                format!(
                    "{:?}",
                    (
                        rig.skeleton(),
                        rig.meshes(),
                        rig.bindings(),
                        rig.morphs(),
                        rig.clips()
                    )
                )
            };
            assert_eq!(told(&found), told(&wanted), "{name}");
            let others = wanted.warnings().len();
            assert_eq!(found.warnings().len(), others + 1, "{:?}", found.warnings());
        }
    }
}

#[test]
fn latin_1_and_nul_bytes_at_the_end_are_read_in_every_text_file() {
    for (name, bytes) in [
        ("a.skel", &b"balljoint kn\xE4 { }\n\0\0"[..]),
        ("a.skel", b"0 0 0 -1 kn\xE4\0"),
        (
            "a.skin",
            b"positions 1 { 0 0 0 } triangles 0 { } material kn\xE4 { }\0\n",
        ),
        ("a.obj", b"# kn\xE4\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n\0"),
    ] {
        let rig = loaded(&[(name, bytes)]).rig;
        let mut joints = joint_names(&rig);
        let materials = rig.materials().iter();
        joints.extend(materials.map(|material| material.name.as_str()));
        assert!(
            joints.iter().all(|joint| *joint == "kn\u{e4}"),
            "{joints:?}"
        );
        let is_told = |what: &str| rig.warnings().iter().any(|told| told.contains(what));
        assert!(
            is_told("taken for Latin-1") && is_told("NUL byte"),
            "{:?}",
            rig.warnings()
        );
    }
}

#[test]
fn names_in_quotes_may_hold_spaces_and_comment_marks() {
    let skel = "balljoint \"left // arm #1\" { pose 1 0 0 }";
    let rig = text("a.skel", skel);
    assert_eq!(joint_names(&rig), ["left // arm #1"]);
    assert_eq!(rig.warnings(), [""; 0]);
    let Rotation::Angles(angles) = rig.skeleton().joints()[0].rest_rotation else {
        panic!("a pose is angles");
    };
    assert_eq!(angles.x, 1.0);
}
