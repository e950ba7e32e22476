//! Are the files that people really have read, and read right? They are not ours to ship: where `../shared/rigs` is not there,
//! these tests say so and pass.

mod support;

use rigd::formats::{FileRef, Loaded, Source, load};
use rigd::limits::Limits;
use rigd::rig::Channel;

/// The folder of the CSE 169 rigs, where it is.
fn source() -> Option<Source> {
    source_of("cse169")
}

fn source_of(course: &str) -> Option<Source> {
    let folder = support::real_rigs()?.join(course);
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
        (&["wasp_walk/wasp.rig"], [23, 694, 1236, 23]),
        (
            &["wasp_walk/wasp.rig", "wasp_walk/wasp_walk.anim"],
            [23, 694, 1236, 23],
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
    let angles = knee.map(|knee| {
        let knee = &rig.skeleton().joints()[knee];
        knee.rest_rotation.angles(knee.rotation_order).to_array()
    });
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
    let texture = texture.map(|place| &place.texture);
    let texture = texture.map(|it| (it.file(), it.levels()[0].width, it.levels()[0].height));
    assert_eq!(texture, Some(("head.bmp", 512, 512)));
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
    let listed = loaded(&source, &["wasp_walk/wasp_walk.anim", "wasp_walk/wasp.rig"]);
    assert_eq!(listed.name, "wasp_walk");
    let readers = ["cse169 skel", "cse169 skin", "cse169 anim", "cse169 rig"];
    assert_eq!(listed.dialects, readers);
}

/// Reference numbers are printed with six digits.
const PRINTED: f64 = 1e-5;

/// The values of a rig's only clip, one for each channel.
fn values_at(loaded: &Loaded, time: f64) -> Vec<f64> {
    let channels = &loaded.rig.clips()[0].channels;
    let value = |channel: &Channel| match channel {
        Channel::Dof { curve, .. } => curve.at(time),
        Channel::Rotation { .. } => panic!("every channel sets a DOF"),
    };
    channels.iter().map(value).collect()
}

fn assert_close(found: &[f64], wanted: &[f64], what: &str) {
    assert_eq!(found.len(), wanted.len(), "{what}");
    let is_close = |(a, b): (&f64, &f64)| (a - b).abs() < PRINTED;
    assert!(
        found.iter().zip(wanted).all(is_close),
        "{what}: {found:?}, but {wanted:?} was due"
    );
}

#[test]
fn the_sample_animation_has_the_values_of_an_independent_program() {
    let Some(source) = source() else { return };
    let sample = loaded(&source, &["tube.skel", "sample.anim"]);
    assert_eq!(
        sample.rig.warnings(),
        [
            "sample.anim:3:15: there are 3 channels, but `tube.skel` takes 9; those that fit are used"
        ]
    );
    assert_eq!(sample.rig.clips()[0].range, [0.0, 2.0]);
    for (time, wanted) in support::SAMPLE_ANIM {
        assert_close(&values_at(&sample, time), &wanted, &format!("{time} s"));
    }
}

#[test]
fn the_wasp_walks_as_in_an_independent_program() {
    let Some(source) = source() else { return };
    let files = ["wasp_walk/wasp.rig", "wasp_walk/wasp_walk.anim"];
    let wasp = loaded(&source, &files);
    let clip = &wasp.rig.clips()[0];
    assert_eq!((clip.name.as_str(), clip.range), ("wasp_walk", [0.0, 4.0]));
    // Every DOF in its order: nothing else tells which channel is whose.
    let dof = |channel: &Channel| match channel {
        Channel::Dof { dof, .. } => *dof,
        Channel::Rotation { .. } => panic!("every channel sets a DOF"),
    };
    let dofs: Vec<usize> = clip.channels.iter().map(dof).collect();
    assert_eq!(dofs, (0..72).collect::<Vec<_>>());
    for (time, z) in [
        (-0.5, 0.675),
        (0.0, 0.45),
        (0.7, 0.135),
        (1.3, -0.135),
        (3.0, -0.9),
        (5.25, -1.9125),
    ] {
        let found = values_at(&wasp, time);
        assert_close(
            &found[..3],
            &[0.0, 0.95, z],
            &format!("the root at {time} s"),
        );
    }
    let joint = 3 + 3 * 7;
    let found = values_at(&wasp, 1.3);
    let wanted = [-0.02648, 0.71404, 2.09406];
    assert_close(&found[joint..joint + 3], &wanted, "joint 7");
}

#[test]
fn heads_blend_as_in_an_independent_program() {
    let Some(source) = source() else { return };
    let files = ["head/head2.morph", "head/head_tex.skin", "head/head1.morph"];
    let head = loaded(&source, &files).rig;
    let morphs: Vec<_> = head
        .morphs()
        .iter()
        .map(|it| (&*it.name, it.vertex_count))
        .collect();
    assert_eq!(morphs, [("head2", 223), ("head1", 259)]);
    let mesh = &head.meshes()[0];
    let mut sum = [0.0; 3];
    for vertex in 0..mesh.vertex_count() {
        let mut position = mesh.positions()[vertex].as_dvec3();
        for displacement in mesh.morph_displacements_of(vertex) {
            position += displacement.position.as_dvec3() * [1.0, 0.5][displacement.morph as usize];
        }
        sum = [
            sum[0] + position.x,
            sum[1] + position.y,
            sum[2] + position.z,
        ];
    }
    // A sum of thousands of numbers that were rounded to float32.
    let is_close = |(a, b): (f64, f64)| (a - b).abs() < 5e-4;
    let wanted = [-3168.5062, 2350.8472, -2.4787];
    assert!(sum.into_iter().zip(wanted).all(is_close), "{sum:?}");
}

#[test]
fn models_of_mit_6837_come_as_skeleton_mesh_and_attachments() {
    let Some(source) = source_of("mit6837") else {
        return;
    };
    for (name, files) in [
        ("Model1", ["Model1.attach", "Model1.obj", "Model1.skel"]),
        ("Model3", ["Model3.skel", "Model3.attach", "Model3.obj"]),
    ] {
        let model = loaded(&source, &files);
        assert_eq!(model.name, name);
        assert_eq!(model.dialects, ["mit6837 skel", "obj", "mit6837 attach"]);
        let rig = model.rig;
        let found = [
            rig.skeleton().joints().len(),
            rig.vertex_count(),
            rig.triangle_count(),
        ];
        assert_eq!(found, [18, 13336, 26668], "{name}");
        assert_eq!(rig.warnings(), [""; 0], "{name}");
        let alone = format!("{name}.obj");
        let static_mesh = loaded(&source, &[alone.as_str()]).rig;
        assert_eq!(static_mesh.vertex_count(), 13336);
    }
}

#[test]
fn files_that_make_no_rig_alone_are_refused_by_name() {
    let Some(folder) = support::real_rigs() else {
        return;
    };
    for (file, wanted) in [
        (
            "cse169/sample.anim",
            "a skeleton in the rig, which this animation moves",
        ),
        ("cse169/head/head1.morph", "one skin in the rig"),
        ("mit6837/Model1.attach", "one OBJ mesh in the rig"),
        ("cse169/head/head.bmp", "a BMP picture"),
    ] {
        let path = FileRef::Path(folder.join(file).to_string_lossy().into_owned());
        let error = load(&[path], &Source::local(), &Limits::default())
            .map(|loaded| loaded.name)
            .expect_err(file);
        assert!(error.to_string().contains(wanted), "{error}");
    }
}

#[test]
fn which_of_them_enclose_a_volume() {
    let outward_counts = |course: &str, files: &[&str]| {
        let rig = loaded(&source_of(course)?, files).rig;
        let counts = rig.meshes().iter();
        let counts = counts.map(|mesh| mesh.parts()[0].sides.outward_count());
        Some(counts.collect::<Vec<_>>())
    };
    // Normals turn a dozen triangles of each.
    for (course, files, wanted) in [
        (
            "mit6837",
            ["Model1.skel", "Model1.obj", "Model1.attach"].as_slice(),
            Some(26_656),
        ),
        (
            "mit6837",
            &["Model3.skel", "Model3.obj", "Model3.attach"],
            Some(26_648),
        ),
        ("cse169", &["tube.skel", "tube.skin"], None),
        ("cse169", &["wasp.skel", "wasp.skin"], None),
    ] {
        if let Some(found) = outward_counts(course, files) {
            assert_eq!(found, [wanted], "{files:?}");
        }
    }
}
