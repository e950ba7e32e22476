//! Are joints and vertices where the definition puts them? Both skinners are measured against an oracle in f64 that reads the files itself.

#[path = "skinning/collapse.rs"]
mod collapse;
#[path = "skinning/made.rs"]
mod made;
#[path = "skinning/mirrored.rs"]
mod mirrored;
#[path = "skinning/noticed.rs"]
mod noticed;
#[path = "skinning/reference.rs"]
mod reference;
#[path = "skinning/subject.rs"]
mod subject;
mod support;

use glam::DVec3;
use made::{Made, SkinText, Tube, skel};
use serde_json::json;
use subject::{DUAL, LINEAR, Subject};
use support::oracle::compare::{Worst, compare};

fn figure() -> Made {
    let (skel, skin) = (
        include_str!("../assets/figure.skel"),
        include_str!("../assets/figure.skin"),
    );
    let files = [("skel", skel.to_owned()), ("skin", skin.to_owned())];
    Made::new("figure again", files)
}

#[test]
fn vertices_of_real_rigs_are_where_the_definition_puts_them() {
    for files in [
        &["cse169/tube.skel", "cse169/tube.skin"][..],
        &["cse169/tube.skel", "cse169/tube_smooth.skin"],
        &["cse169/wasp.skel", "cse169/wasp.skin"],
        &["cse169/wasp_walk/wasp.skel", "cse169/wasp_walk/wasp.skin"],
        &["cse169/head/head.skel", "cse169/head/head_tex.skin"],
        &["cse169/triangle.skin"],
        &["cse169/tube.skin"],
        &["cse169/wasp.skin"],
        &["cse169/head/head_tex.skin"],
    ] {
        let Some(subject) = Subject::real(files) else {
            return;
        };
        subject.check_vertices();
    }
}

#[test]
fn vertices_of_real_files_that_a_rig_file_lists_are_where_the_definition_puts_them() {
    let Some(subject) = Subject::real(&[
        "cse169/wasp_walk/wasp.rig",
        "cse169/wasp_walk/wasp.skel",
        "cse169/wasp_walk/wasp.skin",
    ]) else {
        return;
    };
    subject.check_vertices();
}

#[test]
fn vertices_of_a_real_head_are_where_the_definition_puts_them_however_it_is_morphed() {
    for files in [
        &[
            "cse169/head/head.skel",
            "cse169/head/head_tex.skin",
            "cse169/head/head1.morph",
            "cse169/head/head2.morph",
        ][..],
        &[
            "cse169/head/head_tex.skin",
            "cse169/head/head2.morph",
            "cse169/head/head1.morph",
        ],
    ] {
        let Some(subject) = Subject::real(files) else {
            return;
        };
        subject.check_vertices();
    }
}

#[test]
fn a_real_wasp_walks_where_the_definition_lets_it() {
    let Some(subject) = Subject::real(&[
        "cse169/wasp_walk/wasp.skel",
        "cse169/wasp_walk/wasp.skin",
        "cse169/wasp_walk/wasp_walk.anim",
    ]) else {
        return;
    };
    let poses = subject.clip_poses("wasp_walk");
    subject.check_joints_in(&poses);
    subject.check_vertices_in(&poses);
}

#[test]
fn vertices_of_real_models_of_mit_are_where_the_definition_puts_them() {
    for model in ["Model1", "Model3"] {
        let file = |ending: &str| format!("mit6837/{model}.{ending}");
        let [skel, mesh, attachment] = ["skel", "obj", "attach"].map(file);
        let Some(subject) = Subject::real(&[&skel, &mesh, &attachment]) else {
            return;
        };
        subject.check_vertices();
    }
}

#[test]
fn joints_of_real_rigs_are_where_the_definition_puts_them() {
    for skel in [
        "cse169/test.skel",
        "cse169/tube.skel",
        "cse169/wasp.skel",
        "cse169/wasp_walk/wasp.skel",
        "cse169/head/head.skel",
        "cse169/horse.skel",
        "cse169/tree.skel",
        "cse169/chain.skel",
    ] {
        let Some(subject) = Subject::real(&[skel]) else {
            return;
        };
        subject.check_joints();
    }
}

#[test]
fn joints_of_real_models_of_mit_are_where_the_definition_puts_them() {
    for skel in ["mit6837/Model1.skel", "mit6837/Model3.skel"] {
        let Some(subject) = Subject::real(&[skel]) else {
            return;
        };
        subject.check_joints();
    }
}

#[test]
fn the_built_in_figure_is_where_the_definition_puts_it() {
    let figure = Subject::load(&figure());
    figure.check_joints();
    figure.check_vertices();
}

#[test]
fn bindings_are_read_by_column() {
    // A quarter turn about z: (1, 0, 0) in the world was (0, -1, 0) in the joint, and still is in the joint that stands unturned.
    let quarter = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let one = SkinText::random(3, vec![quarter], |_| vec![(0, 1.0)]);
    let one = SkinText {
        positions: vec![[1.0, 0.0, 0.0]; 3],
        normals: vec![[0.0, 1.0, 0.0]; 3],
        ..one
    };
    let files = [("skel", skel(&[(None, [0.0; 3])])), ("skin", one.text())];
    let subject = Subject::load(&Made::new("quarter turn", files));
    let wanted = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0]];
    for found in [
        subject.by_gpu(&subject.rest(), LINEAR),
        subject.by_cpu(&subject.rest(), LINEAR),
    ] {
        assert_eq!(found, [wanted; 3]);
    }

    Subject::load(&made::bound_turned()).check_vertices();
}

#[test]
fn normals_stay_perpendicular_to_what_was_stretched() {
    // Halving x turns the plane with normal (1, 1, 0) into one with normal (2, 1, 0).
    let double = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let one = SkinText::random(3, vec![double], |_| vec![(0, 1.0)]);
    let one = SkinText {
        normals: vec![[1.0, 1.0, 0.0]; 3],
        ..one
    };
    let files = [("skel", skel(&[(None, [0.0; 3])])), ("skin", one.text())];
    let subject = Subject::load(&Made::new("doubled", files));
    let wanted = DVec3::new(2.0, 1.0, 0.0) / 5f64.sqrt();
    for skinning in [LINEAR, DUAL] {
        for found in [
            subject.by_gpu(&subject.rest(), skinning),
            subject.by_cpu(&subject.rest(), skinning),
        ] {
            let normal = DVec3::from_array(found[0][1].map(f64::from));
            assert!(normal.distance(wanted) < Worst::LENGTH, "{normal}");
        }
    }

    Subject::load(&made::bound_stretched()).check_vertices();
}

#[test]
fn joints_may_be_bound_while_they_are_sheared() {
    Subject::load(&made::bound_sheared()).check_vertices();
}

#[test]
fn a_vertex_may_follow_forty_joints() {
    Subject::load(&made::forty()).check_vertices();
}

#[test]
fn a_vertex_may_follow_joints_in_equal_parts() {
    Subject::load(&made::equals()).check_vertices();
}

#[test]
fn a_chain_may_have_three_hundred_joints() {
    let subject = Subject::load(&made::three_hundred());
    subject.check_joints();
    subject.check_vertices();
}

#[test]
fn two_morphs_may_move_the_same_vertices() {
    Subject::load(&made::morphing()).check_vertices();
    Subject::load(&made::morphing_alone()).check_vertices();
}

#[test]
fn morphs_are_moved_by_name_as_well() {
    let subject = Subject::load(&made::morphing());
    let mut pose = subject.oracle.rest();
    pose.morphs = vec![0.75, -0.25];
    let wire = json!({"base": "rest", "dofs": {"morph.frown": -0.25, "morph.smile": 0.75}});
    for skinning in [LINEAR, DUAL] {
        let found = subject.answered(&wire, skinning);
        let off = compare(&found, &subject.oracle.skin(&pose, skinning));
        assert!(off.is_close(), "{off:?}");
    }
}

#[test]
fn clips_move_what_they_have_channels_for_and_keep_to_limits() {
    let subject = Subject::load(&made::moving());
    for clip in ["whole", "short", "long"] {
        let poses = subject.clip_poses(clip);
        subject.check_joints_in(&poses);
        subject.check_vertices_in(&poses);
    }
}

#[test]
fn a_model_of_mits_kind_is_where_the_definition_puts_it() {
    let subject = Subject::load(&Tube::new().mit_rig());
    subject.check_joints();
    subject.check_vertices();
}
