//! Skins in small files: what is read, what is warned of, what is refused and where.

use super::{Skin, read};
use crate::formats::contribution::KnownSkeleton;
use crate::formats::text::lexer::Lexer;
use crate::limits::Limits;
use crate::rig::{JointDraft, Warnings};
use glam::{DMat3, DVec3, Vec2, Vec3};

fn skin_with(joint_count: Option<usize>, text: &str) -> Result<(Skin, Vec<String>), String> {
    let mut warnings = Warnings::default();
    let joints = joint_count.map(|count| vec![JointDraft::default(); count]);
    let skeleton = joints.as_deref().map(|joints| KnownSkeleton {
        file: "a.skel",
        joints,
    });
    read(
        Lexer::new("a.skin", text),
        skeleton,
        &Limits::default(),
        &mut warnings,
    )
    .map(|skin| (skin, warnings.into_sentences()))
    .map_err(|error| error.to_string())
}

fn skin(text: &str) -> Result<(Skin, Vec<String>), String> {
    skin_with(None, text)
}

const SKIN: &str = "\
positions 3 {\n 0 0 0\n 1 0 0\n 0 1 .5\n}
normals 3 {\n 0 0 1\n 0 0 1\n 0 0 2\n}
texcoords 3 {\n 0 0\n 1 0\n 0 1.5\n}
skinweights 3 {\n 1 0 1\n 2 0 .25 1 .75\n 0\n}
material face {\n texture head.bmp\n}
triangles 1 {\n 0 1 2\n}
bindings 2 {\n matrix {\n 0 1 0\n -1 0 0\n 0 0 1\n 5 6 7\n }\n matrix { 1 0 0 0 1 0 0 0 1 0 0 0 }\n}
";

#[test]
fn all_sections_of_a_skin_are_read() {
    let (skin, warnings) = skin_with(Some(2), SKIN).expect("it is a skin");
    assert_eq!(skin.mesh.positions[2], Vec3::new(0.0, 1.0, 0.5));
    assert_eq!(
        skin.mesh.normals.as_deref().map(|normals| normals[2]),
        Some(Vec3::new(0.0, 0.0, 2.0))
    );
    assert_eq!(
        skin.mesh.texcoords.as_deref().map(|uvs| uvs[2]),
        Some(Vec2::new(0.0, 1.5))
    );
    assert_eq!(skin.mesh.influence_counts, [1, 2, 0]);
    assert_eq!(skin.mesh.influences, [(0, 1.0), (0, 0.25), (1, 0.75)]);
    assert_eq!(skin.mesh.triangles, [[0, 1, 2]]);
    let material = skin.material.expect("it has one");
    let texture = material
        .texture
        .map(|texture| (texture.name, texture.place));
    assert_eq!(material.name, "face");
    assert_eq!(
        texture,
        Some(("head.bmp".to_owned(), "a.skin:22:10".to_owned()))
    );
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn rows_of_a_binding_are_columns_of_its_matrix() {
    let (skin, _) = skin(SKIN).expect("it is a skin");
    let quarter_turn = DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2);
    assert!(skin.bindings[0].matrix3.abs_diff_eq(quarter_turn, 1e-15));
    assert_eq!(skin.bindings[0].translation, DVec3::new(5.0, 6.0, 7.0));
    // From the joint's own space to where it stood.
    assert!(
        skin.bindings[0]
            .transform_point3(DVec3::X)
            .abs_diff_eq(DVec3::new(5.0, 7.0, 7.0), 1e-15)
    );
}

/// `SKIN` with one piece of it replaced.
fn changed(piece: &str, by: &str) -> String {
    assert_eq!(SKIN.matches(piece).count(), 1, "{piece} must stand once");
    SKIN.replace(piece, by)
}

#[test]
fn what_is_odd_in_a_skin_is_worked_with() {
    for (text, warnings) in [
        (changed("skinweights 3 {", "skinweights 3"), vec![]),
        (changed("bindings 2 {", "bindings 2"), vec![]),
        (
            changed("0\n}\nmaterial", "0\nmaterial").replace("skinweights 3 {", "skinweights 3"),
            vec![],
        ),
        (changed("material face", "material"), vec![]),
        (changed(" texture head.bmp\n", ""), vec![]),
        (changed("2 0 .25 1 .75", "2 0 -0.000 1 .75"), vec![]),
        (
            changed("triangles 1", "tangents 1 { 1 2 3 } triangles 1"),
            vec!["a.skin:24:1: skipped `tangents`, which is not known here"],
        ),
        (
            changed("texture head.bmp", "diffuse 1 0 0 texture head.bmp"),
            vec!["a.skin:22:2: skipped `diffuse`, which is not known here"],
        ),
        (
            changed("positions 3", "version 1 positions 3"),
            vec!["a.skin:1:1: skipped `version`, which is not known here"],
        ),
        (
            changed("positions 3", "Positions 3"),
            vec!["a.skin:1:1: `Positions` is taken for `positions`"],
        ),
        (
            changed("texture head.bmp", "TEXTURE \"my head.bmp\""),
            vec!["a.skin:22:2: `TEXTURE` is taken for `texture`"],
        ),
        (
            format!("{SKIN}}}"),
            vec!["a.skin:36:1: skipped `}`, which is not known here"],
        ),
    ] {
        let (skin, found) = skin_with(Some(2), &text).expect(&text);
        assert_eq!(skin.mesh.triangles.len(), 1, "{text}");
        assert_eq!(found, warnings, "{text}");
    }
}

#[test]
fn what_is_wrong_in_a_skin_is_told_where_it_is() {
    for (text, wanted) in [
        (
            String::new(),
            "1:1: expected `positions`, but found the end of the file",
        ),
        (
            "mesh 5".to_owned(),
            "1:1: expected `positions`, but found `mesh`",
        ),
        (
            changed("positions 3", "positions"),
            "1:11: expected a whole number from 0 after `positions`, but found `{`",
        ),
        (
            changed("positions 3", "positions -3"),
            "1:11: expected a whole number from 0 after `positions`, but found `-3`",
        ),
        (
            changed("positions 3 {", "positions 3"),
            "2:2: expected `{` after `positions 3`, but found `0`",
        ),
        (
            changed("positions 3", "positions 4"),
            "5:1: expected 4 positions as announced, but found `}` after 3",
        ),
        (
            changed("positions 3", "positions 2"),
            "4:2: expected `}` after 2 positions as announced, but found `0`: 3 positions in all",
        ),
        (
            changed("0 1 .5", "0 1"),
            "5:1: expected 3 positions as announced, but found `}` after 2",
        ),
        (
            changed("0 1 .5", "0 x .5"),
            "4:4: expected a number in position 2, but found `x`",
        ),
        (
            changed("0 1 .5", "0 1 inf"),
            "4:6: expected a number in position 2, but found `inf`",
        ),
        (
            changed("normals 3", "normals 4").replace("0 0 2", "0 0 2 0 0 2"),
            "6:9: expected 3 normals, as many as positions, but found `4`",
        ),
        (
            changed("texcoords 3", "texcoords 4"),
            "15:1: expected 4 texture coordinates as announced, but found `}` after 3",
        ),
        (
            changed("0 1.5", "0 1.5 7"),
            "14:8: expected `}` after 3 texture coordinates as announced, but found `7`",
        ),
        (
            changed(" 0\n}\nmat", "}\nmat"),
            "19:1: expected 3 vertices with weights as announced, but found `}` after 2",
        ),
        (
            changed("skinweights 3 {", "skinweights 2"),
            "19:2: expected `}` after 2 vertices with weights as announced, but found `0`: 3 vertices with weights in all",
        ),
        (
            changed("2 0 .25 1 .75", "3 0 .25 1 .75"),
            "20:1: expected 3 vertices with weights as announced, but found `}` after 1",
        ),
        (
            changed("1 .75", "2 .75"),
            "18:10: expected a joint below 2, the number of bindings, but found `2`",
        ),
        (
            changed("1 .75", "-1 .75"),
            "18:10: expected a whole number from 0 in vertex 1, but found `-1`",
        ),
        (
            changed("1 .75", "1 -.75"),
            "18:12: expected a weight that is not negative in vertex 1, but found `-.75`",
        ),
        (
            changed(" 0 1 2", " 0 1 3"),
            "25:6: expected a vertex below 3, the number of positions, but found `3`",
        ),
        (
            changed(" 0 1 2", " 0 99999999999999999999 2"),
            "25:4: expected a vertex below 3, the number of positions, but found `99999999999999999999`",
        ),
        (
            changed(" 0 1 2", " 4294967296 1 2"),
            "25:2: expected a vertex below 3, the number of positions, but found `4294967296`",
        ),
        (
            changed(" 0 1 2", " 0 1 1.5"),
            "25:6: expected a whole number from 0 in triangle 0, but found `1.5`",
        ),
        (
            changed("bindings 2", "bindings 1"),
            "34:2: expected `}` after 1 binding as announced, but found `matrix`: 2 bindings in all",
        ),
        (
            changed("5 6 7", "5 6"),
            "33:2: expected a number in binding 0, but found `}`",
        ),
        (
            changed("5 6 7", "5 6 7 8"),
            "32:8: expected `}` after 12 numbers in binding 0, but found `8`",
        ),
        (
            changed("0 0 1\n 5 6 7", "0 0 0\n 5 6 7"),
            "28:2: expected a matrix that can be inverted in binding 0, but found one that cannot",
        ),
        (
            changed("triangles 1 {\n 0 1 2\n}\n", ""),
            "33:1: expected `triangles`, but found the end of the file",
        ),
        (
            changed("positions 3", "position 3"),
            "1:1: expected `positions`, but found `position`",
        ),
        (
            changed("triangles 1", "triangle 1"),
            "24:1: expected `triangles`, but found `triangle`",
        ),
        (
            changed("skinweights 3", "skinweight 3"),
            "16:1: expected `skinweights`, as there are bindings, but found `skinweight`",
        ),
        (
            changed("skinweights 3", "weights 3"),
            "16:1: expected `skinweights`, as there are bindings, but found `weights`",
        ),
        (
            format!("{SKIN}normals 1 {{"),
            "36:1: expected `normals` once, but found a second one",
        ),
        (
            changed("head.bmp", ""),
            "23:1: expected a file name after `texture`, but found `}`",
        ),
        (
            changed("head.bmp", "a texture b"),
            "22:12: expected `texture` once, but found a second one",
        ),
        (
            "positions 0 { } triangles 0 { }".to_owned(),
            "1:11: expected at least one position, but found `0`",
        ),
    ] {
        let found = skin_with(None, &text).map(|_| ());
        assert_eq!(found, Err(format!("a.skin:{wanted}")), "{text}");
    }
}

#[test]
fn indices_are_checked_whatever_the_order_of_sections() {
    let text = "\
triangles 1 { 0 5 0 }
skinweights 1 { 1 7 1 }
bindings 1 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } }
positions 1 { 0 0 0 }";
    let wanted = "a.skin:1:17: expected a vertex below 1, the number of positions, but found `5`";
    assert_eq!(skin(text).map(|_| ()), Err(wanted.to_owned()));
    let wanted = "a.skin:2:19: expected a joint below 1, the number of bindings, but found `7`";
    assert_eq!(
        skin(&text.replace('5', "0")).map(|_| ()),
        Err(wanted.to_owned())
    );
}

#[test]
fn a_skin_must_fit_its_skeleton() {
    for joint_count in [1, 3] {
        let wanted = format!(
            "a.skin:27:10: expected {joint_count} bindings, one for each joint of `a.skel`, but found `2`"
        );
        let found = skin_with(Some(joint_count), SKIN);
        assert_eq!(found.map(|_| ()), Err(wanted));
    }
    let unbound = "positions 1 { 0 0 0 } triangles 0 { }";
    assert!(skin(unbound).is_ok());
    let wanted = "a.skin:1:38: expected `skinweights`, as there is a skeleton, but found the end of the file";
    assert_eq!(
        skin_with(Some(1), unbound).map(|_| ()),
        Err(wanted.to_owned())
    );
}

#[test]
fn a_section_of_no_rows_is_as_good_as_none() {
    let unbound = "positions 1 { 0 0 0 } triangles 0 { }";
    for empty in [
        "normals 0 { }",
        "texcoords 0 { }",
        "skinweights 0 { }",
        "skinweights 0",
        "bindings 0 { } skinweights 0 { } texcoords 0 { }",
    ] {
        let (skin, warnings) = skin(&format!("{unbound} {empty}")).expect(empty);
        assert!(skin.mesh.normals.is_none() && skin.mesh.texcoords.is_none());
        assert!(skin.mesh.influence_counts.is_empty() && skin.bindings.is_empty());
        assert_eq!(warnings, [""; 0], "{empty}");
    }
    for (empty, expected) in [
        ("skinweights 0 { }", "`skinweights`, as there is a skeleton"),
        (
            "skinweights 0 { } bindings 1 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } }",
            "`skinweights`, as there are bindings",
        ),
    ] {
        let wanted = format!("a.skin:1:51: expected {expected}, but found `0`");
        let found = skin_with(Some(1), &format!("{unbound} {empty}"));
        assert_eq!(found.map(|_| ()), Err(wanted));
    }
    let none = format!("{unbound} skinweights 1 {{ 1 0 1 }} bindings 0 {{ }}");
    let wanted = "a.skin:1:57: expected no joint, as there are no bindings, but found `0`";
    assert_eq!(skin(&none).map(|_| ()), Err(wanted.to_owned()));
}
