//! How files of several kinds become one rig: order, names, lists, and what goes with what.

use super::assemble::assemble;
use super::context::Context;
use super::files::Files;
use super::parts::Parts;
use super::textures::Textures;
use super::{FORMATS, File, FileRef, LoadError, Loaded, Source, load, readers};
use crate::limits::Limits;
use crate::rig::{Channel, Draft, Rig, RotationOrder, Warnings};
use glam::Vec3;
use std::sync::Arc;

const SKEL: &str = "balljoint a { balljoint b { offset 0 1 0 } }";
const SKIN: &str = "positions 3 { 0 0 0 1 0 0 0 1 0 } normals 3 { 0 0 1 0 0 1 0 0 1 } \
    skinweights 3 { 1 0 1 1 1 1 2 0 .5 1 .5 } triangles 1 { 0 1 2 } \
    bindings 2 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } matrix { 1 0 0 0 1 0 0 0 1 0 1 0 } }";
const SMILE: &str = "positions 1 { 2 0 3 0 } normals 1 { 2 0 2 0 }";
const FROWN: &str = "positions 1 { 0 0 0 -1 }";
const WAVE: &str = "animation { range 0 1 numchannels 1 channel { keys 1 { 0 5 flat flat } } }";
const LIST: &str = "rig a { skeleton a.skel skin a.skin morphs 2 { smile.morph frown.morph } }";
/// One pixel.
const BMP: &str = "BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\x18\0\0\0\0\0\
    \x04\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x01\x02\x03\0";
const MIT_SKEL: &str = "0 0 0 -1\n0 1 0 0\n0 1 0 1\n";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const ATTACH: &str = "1 0\n0 1\n.5 .5\n";

fn load_files(files: &[(&str, &str)]) -> Result<Loaded, LoadError> {
    load_with(&Limits::default(), files)
}

fn load_with(limits: &Limits, files: &[(&str, &str)]) -> Result<Loaded, LoadError> {
    load(&inline(files), &Source::inline_only(), limits)
}

fn inline(files: &[(&str, &str)]) -> Vec<FileRef> {
    let inline = |&(name, text): &(&str, &str)| {
        FileRef::Inline(File {
            name: name.to_owned(),
            bytes: text.as_bytes().into(),
        })
    };
    files.iter().map(inline).collect()
}

/// The draft of files before a rig is built from it.
fn drafted(files: &[(&str, &str)]) -> Draft {
    let limits = Limits::default();
    let source = Source::inline_only();
    let mut context = Context {
        limits: &limits,
        files: Files::gather(&inline(files), readers::TABLE, &source, &limits)
            .expect("all are sent"),
        textures: Textures::new(&limits),
        warnings: Warnings::default(),
    };
    let parts = Parts::gather(&mut context).expect("it is whole");
    assemble(&parts, &mut context).expect("each is right")
}

fn refusal(files: &[(&str, &str)]) -> String {
    match load_files(files) {
        Ok(loaded) => format!("{} was loaded", loaded.name),
        Err(error) => error.to_string(),
    }
}

fn morph_names(rig: &Rig) -> Vec<&str> {
    rig.morphs().iter().map(|morph| &*morph.name).collect()
}

#[test]
fn a_whole_character_comes_in_any_order_of_files() {
    let mut files = vec![
        ("w/wave.anim", WAVE),
        ("smile.morph", SMILE),
        ("a.skin", SKIN),
        ("frown.morph", FROWN),
        ("a.skel", SKEL),
    ];
    for first in ["wave", "smile", "a", "frown", "a"] {
        let loaded = load_files(&files).expect("it is whole");
        assert_eq!(loaded.name, first);
        let readers = ["cse169 skel", "cse169 skin", "cse169 morph", "cse169 anim"];
        assert_eq!(loaded.dialects, readers);
        let rig = loaded.rig;
        assert_eq!((rig.meshes().len(), rig.clips().len()), (1, 1));
        assert_eq!(rig.clips()[0].name, "wave");
        let Channel::Dof { dof, .. } = rig.clips()[0].channels[0] else {
            panic!("every channel sets a DOF");
        };
        assert_eq!(rig.dofs().all()[dof].name, "a.tx");
        let smile = rig.morphs().iter().position(|morph| morph.name == "smile");
        let of_tip = rig.meshes()[0].morph_displacements_of(2);
        assert_eq!(of_tip.len(), 1);
        assert_eq!(Some(of_tip[0].morph as usize), smile);
        assert_eq!(of_tip[0].position, Vec3::Y * 2.0);
        assert_eq!(of_tip[0].normal, Vec3::Y - Vec3::Z);
        let told =
            "w/wave.anim:1:35: there are 1 channels, but `a.skel` takes 9; those that fit are used";
        assert_eq!(rig.warnings(), [told]);
        files.rotate_left(1);
    }
}

#[test]
fn a_list_decides_the_order_and_what_it_does_not_name_comes_behind() {
    let list = ("a.rig", LIST);
    let others = [
        ("wink.morph", FROWN),
        ("frown.morph", FROWN),
        ("x/a.skin", SKIN),
        ("smile.morph", SMILE),
        ("wave.anim", WAVE),
        ("a.skel", SKEL),
    ];
    let loaded = load_files(&[&others[..], &[list]].concat()).expect("it is whole");
    assert_eq!(loaded.name, "wink");
    assert_eq!(loaded.dialects, FORMATS[..5]);
    assert_eq!(morph_names(&loaded.rig), ["smile", "frown", "wink"]);
    assert_eq!(loaded.rig.clips().len(), 1);
    let again = load_files(&[&[list][..], &others[..]].concat()).expect("it is whole");
    assert_eq!((again.name.as_str(), again.digest), ("a", loaded.digest));
}

#[test]
fn what_a_list_names_must_be_there_and_be_what_it_says() {
    let list = |text| [("d/a.rig", text), ("a.skel", SKEL), ("b.rig", "hello")];
    for (text, wanted) in [
        (
            "rig a {\n skin a.skin }",
            "d/a.rig:2:7: expected `a.skin` to be a CSE 169 skin, but found no such file in the request",
        ),
        (
            "rig a { skin a.skel }",
            "d/a.rig:1:14: expected `a.skel` to be a CSE 169 skin, but found a CSE 169 skeleton",
        ),
        (
            "rig a { morphs 1 { morph ../a.rig } }",
            "d/a.rig:1:26: expected `../a.rig` to be a CSE 169 morph target, but found this `.rig` itself",
        ),
        (
            "rig a { skeleton c.bmp }",
            "d/a.rig:1:18: expected `c.bmp` to be a CSE 169 skeleton, but found a BMP picture",
        ),
        (
            "rig a { skeleton m.skel }",
            "d/a.rig:1:18: expected `m.skel` to be a CSE 169 skeleton, but found a MIT 6.837 skeleton",
        ),
    ] {
        let files = [
            list(text)[0],
            list(text)[1],
            ("c.bmp", "BM"),
            ("m.skel", "0 0 0 -1"),
        ];
        // The MIT skeleton is one too many only where the list itself is right.
        assert_eq!(refusal(&files), wanted);
    }
    let twice = "rig a { morphs 2 { s.morph s.morph } }";
    let files = [("a.rig", twice), ("s.morph", SMILE), ("a.skin", SKIN)];
    assert_eq!(
        refusal(&files),
        "a.rig:1:28: expected each file once, but found a second mention of it"
    );
    let twice = twice.replace("s.morph s.morph", "s.morph x/../s.morph");
    let files = [("a.rig", &*twice), ("s.morph", SMILE), ("a.skin", SKIN)];
    assert!(refusal(&files).ends_with("but found a second mention of it"));
    let wanted =
        "b.rig:1:1: expected one `.rig` in a request, but found both `d/a.rig` and `b.rig`";
    assert_eq!(refusal(&list(LIST)), wanted);
    let files = [
        ("a.rig", "rig a { skeleton a.skel }"),
        ("a.skel", SKEL),
        ("b.skel", SKEL),
    ];
    let wanted = "`a.skel` and `b.skel` are both skeletons, but a rig has at most one";
    assert_eq!(refusal(&files), wanted);
}

#[test]
fn a_morph_target_needs_exactly_one_skin_and_an_animation_a_skeleton() {
    let (skel, skin) = (("a.skel", SKEL), ("a.skin", SKIN));
    let (smile, wave) = (("s.morph", SMILE), ("w.anim", WAVE));
    let skinless =
        "s.morph:1:1: expected one skin in the rig, which this morph target changes, but found";
    for (files, wanted) in [
        (&[smile][..], format!("{skinless} none")),
        (&[skel, smile], format!("{skinless} none")),
        (&[smile, ("a.obj", OBJ)], format!("{skinless} none")),
        (
            &[skin, smile, ("b.skin", SKIN)],
            format!("{skinless} both `a.skin` and `b.skin`"),
        ),
        (
            &[skin, wave],
            "w.anim:1:1: expected a skeleton in the rig, which this animation moves, but found none".to_owned(),
        ),
    ] {
        assert_eq!(refusal(files), wanted);
    }
    // An OBJ file beside the one skin is in nobody's way.
    let rig = load_files(&[("a.obj", OBJ), skin, smile])
        .expect("there is one skin")
        .rig;
    assert_eq!((rig.meshes().len(), rig.morphs()[0].mesh), (2, 1));
}

#[test]
fn an_animation_of_another_skeleton_moves_what_fits() {
    let wave = |channels: usize| {
        let channel = "channel { keys 1 { 0 5 flat flat } } ".repeat(channels);
        format!("animation {{ range 0 1\nnumchannels {channels} {channel} }}")
    };
    // Three channels for the root's place, three for the angles of each joint.
    for (channels, applied) in [(6, 6), (9, 9), (10, 9)] {
        let files = [("a.skel", SKEL), ("w.anim", &*wave(channels))];
        let rig = load_files(&files).expect("what fits is used").rig;
        assert_eq!(rig.clips()[0].channels.len(), applied);
        let told = format!(
            "w.anim:2:13: there are {channels} channels, but `a.skel` takes 9; those that fit are used"
        );
        assert_eq!(rig.warnings(), vec![told; usize::from(channels != 9)]);
    }
}

#[test]
fn every_file_of_a_rig_is_named_by_what_it_contributed() {
    let files = [
        ("d/a.skel", SKEL),
        ("a.skin", SKIN),
        ("smile.morph", SMILE),
        ("wave.anim", WAVE),
    ];
    let draft = drafted(&files);
    assert_eq!(draft.file.as_deref(), Some("d/a.skel"));
    assert_eq!(draft.meshes[0].file.as_deref(), Some("a.skin"));
    assert_eq!(draft.bindings[1].file.as_deref(), Some("a.skin"));
    assert_eq!(draft.morphs[0].file.as_deref(), Some("smile.morph"));
    assert_eq!(draft.clips[0].file.as_deref(), Some("wave.anim"));
    // Where the course's meshes are bound is said by the skeleton.
    let files = [("a.attach", ATTACH), ("a.obj", OBJ), ("a.skel", MIT_SKEL)];
    let draft = drafted(&files);
    let file_of_binding = draft.bindings[0].file.as_ref().or(draft.file.as_ref());
    assert_eq!(file_of_binding.map(|file| &**file), Some("a.skel"));
    assert_eq!(draft.meshes[0].file.as_deref(), Some("a.obj"));
}

#[test]
fn an_obj_alone_is_a_static_mesh() {
    let loaded = load_files(&[("a.obj", OBJ), ("b.obj", OBJ)]).expect("each is a mesh");
    assert_eq!(loaded.dialects, ["obj"]);
    assert_eq!(loaded.rig.vertex_count(), 6);
    assert!(
        loaded
            .rig
            .bindings()
            .iter()
            .all(|binding| binding.joint.is_none())
    );
    assert_eq!(loaded.rig.warnings(), [""; 0]);
}

#[test]
fn an_obj_is_attached_to_a_mit_skeleton() {
    let mut files = vec![("a.attach", ATTACH), ("a.obj", OBJ), ("a.skel", MIT_SKEL)];
    for _ in 0..files.len() {
        let loaded = load_files(&files).expect("it is whole");
        assert_eq!(loaded.dialects, ["mit6837 skel", "obj", "mit6837 attach"]);
        let rig = loaded.rig;
        let joints = rig.skeleton().joints();
        assert_eq!(
            (joints.len(), joints[2].rotation_order),
            (3, RotationOrder::Xyz)
        );
        let influences = rig.meshes()[0].influences_of(2).iter();
        let joints = influences.map(|it| rig.bindings()[it.binding as usize].joint);
        assert_eq!(joints.collect::<Vec<_>>(), [Some(1), Some(2)]);
        files.rotate_left(1);
    }
}

#[test]
fn an_attachment_list_needs_both_of_its_ends() {
    let (skel, cse_skel) = (("a.skel", MIT_SKEL), ("a.skel", SKEL));
    let (obj, attach) = (("a.obj", OBJ), ("a.attach", ATTACH));
    for (files, wanted) in [
        (
            &[skel, obj][..],
            "a.obj:1:1: expected a file of kind `.attach` in the rig, which attaches this mesh to `a.skel`, but found none",
        ),
        (
            &[cse_skel, obj],
            "a.obj:1:1: expected a file of kind `.attach` in the rig, which attaches this mesh to `a.skel`, but found none",
        ),
        (
            &[skel, attach],
            "a.attach:1:1: expected one OBJ mesh in the rig, which this file attaches to a skeleton, but found none",
        ),
        (
            &[obj, attach],
            "a.attach:1:1: expected a MIT 6.837 skeleton, which this file attaches a mesh to, but found none",
        ),
        (
            &[obj, cse_skel, attach],
            "a.attach:1:1: expected a MIT 6.837 skeleton, which this file attaches a mesh to, but found `a.skel`, a CSE 169 skeleton",
        ),
        (
            &[obj, skel, attach, ("b.obj", OBJ)],
            "a.attach:1:1: expected one OBJ mesh in the rig, which this file attaches to a skeleton, but found both `a.obj` and `b.obj`",
        ),
        (
            &[obj, skel, attach, ("b.attach", ATTACH)],
            "b.attach:1:1: expected one `.attach` in the rig, but found both `a.attach` and `b.attach`",
        ),
        (
            &[cse_skel, ("b.skel", MIT_SKEL)],
            "`a.skel` and `b.skel` are both skeletons, but a rig has at most one",
        ),
    ] {
        assert_eq!(refusal(files), wanted);
    }
}

#[test]
fn a_picture_is_decoded_once_and_left_out_where_it_weighs_too_much() {
    let skin = |texture: &str| format!("{SKIN} material m {{ texture {texture} }}");
    let (one, other) = (skin("one.bmp"), skin("other.bmp"));
    let files = [
        ("1.skin", &*one),
        ("2.skin", &*one),
        ("3.skin", &*other),
        ("one.bmp", BMP),
        ("other.bmp", BMP),
    ];
    let rig = load_files(&files).expect("all are there").rig;
    let texture = |index: usize| {
        let place = rig.materials()[index].texture.as_ref();
        &place.expect("it is there").texture
    };
    assert!(Arc::ptr_eq(texture(0), texture(1)));
    assert!(!Arc::ptr_eq(texture(0), texture(2)));
    let limits = |rig_bytes| Limits {
        rig_bytes,
        ..Limits::default()
    };
    // A pixel with its halvings is counted as five bytes, and two pictures are different ones whatever is in them.
    let warnings = |rig_bytes| {
        let rig = load_with(&limits(rig_bytes), &files).expect("a texture may be missing");
        rig.rig.warnings().to_vec()
    };
    assert_eq!(warnings(10), [""; 0]);
    let (line, column) = (1, SKIN.len() + " material m { texture ".len() + 1);
    let wanted = format!(
        "3.skin:{line}:{column}: the texture `other.bmp` is left out: 10 exceeds the limit `rig_bytes` of 9"
    );
    assert_eq!(warnings(9), [wanted]);
}

#[test]
fn a_document_of_nothing_says_that_there_is_nothing_to_draw() {
    let found = refusal(&[("d/a.gltf", r#"{"asset": {"version": "2.0"}}"#)]);
    assert!(found.starts_with("d/a.gltf:1:1: expected ") && found.ends_with(" nothing to draw"));
}

#[test]
fn every_reader_is_told_of() {
    let files = [
        ("a.rig", LIST),
        ("a.skel", SKEL),
        ("a.skin", SKIN),
        ("smile.morph", SMILE),
        ("frown.morph", FROWN),
        ("wave.anim", WAVE),
    ];
    let cse169 = load_files(&files).expect("it is whole").dialects;
    let files = [("a.attach", ATTACH), ("a.obj", OBJ), ("a.skel", MIT_SKEL)];
    let mit6837 = load_files(&files).expect("it is whole").dialects;
    let text = r#"{"asset": {"version": "2.0"}, "nodes": [{}]}"#;
    let gltf = load_files(&[("a.gltf", text)])
        .expect("it is whole")
        .dialects;
    assert_eq!([cse169, mit6837, gltf].concat(), FORMATS);
}
