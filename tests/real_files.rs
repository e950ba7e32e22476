//! Are the files that people really have read, and read right? They are not ours to ship: where `../shared/rigs` is not there,
//! these tests say so and pass.

mod support;

use rigd::formats::{FileRef, Loaded, Source, load};
use rigd::limits::Limits;

/// The folder of the CSE 169 rigs, where it is.
fn source() -> Option<Source> {
    let folder = support::real_rigs()?.join("cse169");
    Some(Source::rooted(&folder).expect("the folder can be opened"))
}

fn loaded(source: &Source, files: &[&str]) -> Loaded {
    let refs: Vec<FileRef> = files
        .iter()
        .map(|file| FileRef::Path((*file).to_owned()))
        .collect();
    load(&refs, source, &Limits::default()).unwrap_or_else(|error| panic!("{files:?}: {error}"))
}

#[test]
fn counts_are_those_of_an_independent_parser() {
    let Some(source) = source() else { return };
    for (files, [joints, vertices, triangles, influenced]) in [
        (&["test.skel"][..], [6, 0, 0, 0]),
        (&["tube.skel"], [2, 0, 0, 0]),
        (&["wasp.skel"], [23, 0, 0, 0]),
        (&["wasp_walk/wasp.skel"], [23, 0, 0, 0]),
        (&["head/head.skel"], [1, 0, 0, 0]),
        (&["horse.skel"], [22, 0, 0, 0]),
        (&["tree.skel"], [10, 0, 0, 0]),
        (&["chain.skel"], [6, 0, 0, 0]),
        (&["tube.skin"], [0, 240, 456, 0]),
        (&["tube_smooth.skin"], [0, 240, 456, 0]),
        (&["triangle.skin"], [0, 3, 1, 0]),
        (&["wasp.skin"], [0, 694, 1236, 0]),
        (&["head/head_tex.skin"], [0, 3078, 1458, 0]),
        (&["tube.skel", "tube.skin"], [2, 240, 456, 2]),
        (&["tube.skel", "tube_smooth.skin"], [2, 240, 456, 2]),
        (&["wasp.skel", "wasp.skin"], [23, 694, 1236, 23]),
        (
            &["wasp_walk/wasp.skel", "wasp_walk/wasp.skin"],
            [23, 694, 1236, 23],
        ),
        (
            &["head/head_tex.skin", "head/head.skel"],
            [1, 3078, 1458, 1],
        ),
    ] {
        let rig = loaded(&source, files).rig;
        let found = [
            rig.skeleton().joints().len(),
            rig.vertex_count(),
            rig.triangle_count(),
            rig.bindings()
                .iter()
                .filter(|binding| binding.joint.is_some())
                .count(),
        ];
        assert_eq!(
            found,
            [joints, vertices, triangles, influenced],
            "{files:?}"
        );
        assert_eq!(rig.warnings(), [""; 0], "{files:?}");
    }
}

#[test]
fn poses_are_clamped_also_where_they_stand_before_their_limits() {
    let Some(source) = source() else { return };
    let rig = loaded(&source, &["test.skel"]).rig;
    let knee = rig.skeleton().joint_named("knee_r");
    let angles = knee.map(|knee| rig.skeleton().joints()[knee].rest_angles.to_array());
    assert_eq!(angles, Some([-2.0, 0.0, 0.0]));

    let rig = loaded(&source, &["horse.skel"]).rig;
    let limited = rig
        .skeleton()
        .joints()
        .iter()
        .filter(|joint| joint.is_limited());
    assert_eq!(limited.count(), 11);
    for dof in rig.dofs().all() {
        assert!(dof.limit.contains(dof.rest), "{}", dof.name);
    }
}

#[test]
fn a_texture_beside_its_skin_is_found_and_counts_in_the_digest() {
    let Some(source) = source() else { return };
    let beside = loaded(&source, &["head/head_tex.skin"]);
    let texture = beside.rig.materials()[0].texture.as_ref();
    let texture = texture.map(|it| (it.file(), it.levels()[0].width));
    assert_eq!(texture, Some(("head.bmp", 512)));
    assert_eq!(beside.rig.materials()[0].name, "face");

    let sent = loaded(&source, &["head/head_tex.skin", "head/head.bmp"]);
    assert_eq!(beside.digest, sent.digest);
    let with_more = loaded(&source, &["head/head_tex.skin", "head/head.skel"]);
    assert_ne!(beside.digest, with_more.digest);
}

#[test]
fn names_and_readers_are_told() {
    let Some(source) = source() else { return };
    let wasp = loaded(&source, &["wasp_walk/wasp.skin", "wasp_walk/wasp.skel"]);
    assert_eq!(wasp.name, "wasp");
    assert_eq!(wasp.dialects, ["cse169 skel", "cse169 skin"]);
}

#[test]
fn files_of_other_kinds_are_refused_by_name() {
    let Some(folder) = support::real_rigs() else {
        return;
    };
    for (file, wanted) in [
        ("cse169/sample.anim", "an animation"),
        ("cse169/wasp_walk/wasp.rig", "a `.rig` list of files"),
        ("cse169/head/head1.morph", "a morph target"),
        ("mit6837/Model1.skel", "a MIT 6.837 skeleton"),
        ("mit6837/Model1.obj", "an OBJ mesh"),
        ("mit6837/Model1.attach", "a MIT 6.837 attachment list"),
        ("gltf/Fox/Fox.glb", "a glTF file"),
        ("gltf/SimpleSkin/SimpleSkin.gltf", "a glTF file"),
        ("cse169/head/head.bmp", "a BMP picture"),
    ] {
        let path = FileRef::Path(folder.join(file).to_string_lossy().into_owned());
        let error = load(&[path], &Source::local(), &Limits::default())
            .map(|loaded| loaded.name)
            .expect_err(file);
        assert!(error.to_string().contains(wanted), "{error}");
    }
}
