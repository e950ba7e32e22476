//! The OBJ reader on small files: what is read, what is warned of, what is refused and where.

use super::{Obj, read};
use crate::limits::Limits;
use crate::rig::{MeshDraft, PartDraft, Warnings};
use glam::{Vec2, Vec3, Vec4};

fn whole(text: &str) -> Result<(Obj, Vec<String>), String> {
    let mut warnings = Warnings::default();
    read("a.obj", text, &Limits::default(), &mut warnings)
        .map(|obj| (obj, warnings.into_sentences()))
        .map_err(|error| error.to_string())
}

fn obj(text: &str) -> Result<(MeshDraft, Vec<String>), String> {
    whole(text).map(|(obj, warnings)| (obj.mesh, warnings))
}

/// `(triangles, material, whether flat)` of each.
fn parts(mesh: &MeshDraft) -> Vec<(usize, Option<usize>, bool)> {
    let part = |part: &PartDraft| (part.triangle_count, part.material, part.is_flat);
    mesh.parts.iter().map(part).collect()
}

/// Three vertices on five lines, to put statements after.
const ABOVE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 .5\nvt 0 0\nvn 0 0 1\n";

#[test]
fn vertices_are_the_v_lines_in_their_order() {
    // Used backwards, and one of them by no face.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1e0 -.5 1.0\nv 9 9 9\nv 0 0 1\nf 5 3 2\nf 3 2 1\n";
    let (mesh, warnings) = obj(text).expect("it is a mesh");
    assert_eq!(
        mesh.positions,
        [
            Vec3::ZERO,
            Vec3::X,
            Vec3::new(0.0, 1.0, -0.5),
            Vec3::splat(9.0),
            Vec3::Z
        ]
    );
    assert_eq!(mesh.triangles, [[4, 2, 1], [2, 1, 0]]);
    assert!(mesh.normals.is_none() && mesh.texcoords.is_none());
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn corners_are_told_in_many_ways() {
    for face in [
        "f 1 2 3",
        "fo 1 2 3",
        "\tf\t1 2  3 \r",
        "f 1/1 2/1 3/1",
        "f 1//1 2//1 3//1",
        "f 1/1/1 2/1/1 3/1/1",
        "f 1/ 2// 3/",
        "f -3 -2 -1",
        "f -3/-1/-1 -2/1/-1 -1/-1/1",
        "f 1 2 3 # 4 5 \\",
        "f 1 2\\\n3",
        "f 1 2 \\ \r\n\\\r 3",
        "f 1 2 3 \\",
        "\\\nf 1 2 3",
    ] {
        let (mesh, _) = obj(&format!("{ABOVE}{face}\n")).expect(face);
        assert_eq!(mesh.triangles, [[0, 1, 2]], "{face:?}");
    }
}

#[test]
fn convex_faces_of_many_corners_become_fans() {
    let (mesh, _) = obj(&format!(
        "{ABOVE}v -1 0 1\nv -1 -1 0\nv 0 -1 0\nf 2 3 4 5 6\n"
    ))
    .expect("it is a mesh");
    assert_eq!(mesh.triangles, [[1, 2, 3], [1, 3, 4], [1, 4, 5]]);
}

#[test]
fn relative_indices_count_back_from_where_they_stand() {
    let (mesh, _) =
        obj(&format!("{ABOVE}f -3 -2 -1\nv 9 9 9\nf -3 -2 -1\n")).expect("it is a mesh");
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 2, 3]]);
}

#[test]
fn standard_statements_are_read_over_in_silence() {
    let text = "# made by hand\no Body #1\ng a b\nmg 1 2\nvp 0 0\n\
        v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 \\\n f 3\np 1\n#f 9 9 9\nf 1 2 3 #f 9 9 9\n\n";
    let (mesh, warnings) = obj(text).expect("it is a mesh");
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn other_statements_are_worth_one_warning() {
    let text = format!("{ABOVE}  surf 0 1 0 1\ncall b.obj\nf 1 2 3\nxyz\n");
    let (mesh, warnings) = obj(&text).expect("it is a mesh");
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(
        warnings,
        ["a.obj:6:3: `surf` is not read here; it is skipped, and so are others like it"]
    );
}

#[test]
fn normals_and_texcoords_are_kept_where_each_vertex_has_one() {
    // Vertex 2 names two normals that are the same; vertex 4 is of no face.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 5 5 5\n\
        vn 0 0 2\nvn 0 1 0\nvn 0 0 2\nvt .5\nvt 1 .25 9\n\
        f 1/1/2 2/2/1 3/2/1\nf 3/2/1 2/2/3 4/1/2\n";
    let (mesh, warnings) = obj(text).expect("it is a mesh");
    let two = Vec3::new(0.0, 0.0, 2.0);
    let wanted = vec![Vec3::Y, two, two, Vec3::Y, Vec3::ZERO];
    assert_eq!(mesh.normals, Some(wanted));
    let (left, right) = (Vec2::new(0.5, 0.0), Vec2::new(1.0, 0.25));
    let wanted = vec![left, right, right, left, Vec2::ZERO];
    assert_eq!(mesh.texcoords, Some(wanted));
    assert_eq!(warnings, [""; 0]);
}

/// What each corner of each triangle has: its vertex of the file, and its own normal and texture coordinate.
fn corners(mesh: &MeshDraft) -> Vec<(u32, Vec3, Vec2)> {
    let own = |&corner: &u32| {
        let index = corner as usize;
        let copy = index.checked_sub(mesh.positions.len());
        let normal = mesh.normals.as_ref().map_or(Vec3::ZERO, |all| all[index]);
        let texcoord = mesh.texcoords.as_ref().map_or(Vec2::ZERO, |all| all[index]);
        (
            copy.map_or(corner, |copy| mesh.copies[copy]),
            normal,
            texcoord,
        )
    };
    mesh.triangles.as_flattened().iter().map(own).collect()
}

#[test]
fn a_vertex_with_several_texcoords_has_a_copy_for_each_but_the_first() {
    let text = format!("{ABOVE}vt 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf 3/1 2/2 1/3\nf 1/2 2/2 3/1\n");
    let (mesh, warnings) = obj(&text).expect("it is a mesh");
    assert_eq!(mesh.positions.len(), 3);
    // The third coordinate equals the first.
    assert_eq!(mesh.copies, [1, 0]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 3, 0], [4, 3, 2]]);
    let of = |x| Vec2::new(x, 0.0);
    let wanted = vec![of(0.0), of(0.0), of(0.0), of(1.0), of(1.0)];
    assert_eq!(mesh.texcoords, Some(wanted));
    assert_eq!((mesh.normals, warnings), (None, Vec::new()));
}

#[test]
fn a_vertex_with_several_normals_is_smooth_and_has_a_copy_for_each() {
    let text = format!("{ABOVE}vn 0 1 0\nf 1//1 2//1 3//1\nf 3//1 2//2 1//1\nf 1//1 2 3//1\n");
    let (mesh, warnings) = obj(&text).expect("it is a mesh");
    assert_eq!(mesh.copies, [1; 3]);
    // Those of no length are to be computed.
    let zero = Vec3::ZERO;
    let wanted = [Vec3::Z, zero, Vec3::Z, Vec3::Y, zero, Vec3::Z];
    assert_eq!(mesh.normals.as_deref(), Some(&wanted[..]));
    let normals: Vec<_> = corners(&mesh).iter().map(|corner| corner.1).collect();
    let (z, y) = (Vec3::Z, Vec3::Y);
    assert_eq!(normals, [z, z, z, z, y, z, z, Vec3::ZERO, z]);
    let vertices: Vec<_> = corners(&mesh).iter().map(|corner| corner.0).collect();
    assert_eq!(vertices, [0, 1, 2, 2, 1, 0, 0, 1, 2]);
    assert_eq!(warnings, [""; 0]);
}

/// Two faces that meet in an edge at right angles.
const BEND: &str = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\n";
const FACES: [&str; 2] = ["f 1 3 2\n", "f 1 2 4\n"];

#[test]
fn smoothing_groups_are_smooth_within_and_hard_between() {
    let [one, other] = FACES;
    let mesh = |first: &str, second: &str| {
        let text = format!("{BEND}{first}{one}{second}{other}");
        let (mesh, warnings) = obj(&text).expect(&text);
        assert_eq!(warnings, [""; 0], "{text}");
        mesh
    };
    let apart = mesh("s 1\n", "s 2\n");
    assert_eq!(apart.copies.len(), 4);
    let normals: Vec<_> = corners(&apart).iter().map(|corner| corner.1).collect();
    assert_eq!(normals[..3], [Vec3::Z; 3]);
    assert_eq!(normals[3..], [Vec3::X; 3]);
    let together = mesh("s 7\n", "s 7\n");
    assert_eq!(together.copies, [0; 0]);
    let between = (Vec3::X + Vec3::Z).normalize_or_zero();
    assert_eq!(corners(&together)[0].1, between);
    for (first, second, wanted) in [
        ("", "", vec![(2, None, false)]),
        ("s off\n", "", vec![(2, None, true)]),
        ("s 0\n", "s 3\n", vec![(1, None, true), (1, None, false)]),
    ] {
        assert_eq!(parts(&mesh(first, second)), wanted, "{first}{second}");
    }
    // Normals of its own count for more.
    let (given, _) =
        obj(&format!("{BEND}vn 0 0 1\ns off\nf 1//1 3//1 2//1\n")).expect("it is a mesh");
    assert_eq!(parts(&given), [(1, None, false)]);
    assert_eq!(corners(&given)[0].1, Vec3::Z);
}

#[test]
fn materials_make_parts_in_the_order_of_the_file() {
    let text = format!(
        "mtllib a.mtl\nmtllib my lib.mtl #x\nmtllib a.mtl\n{ABOVE}f 1 2 3\nusemtl red one\nf 1 2 3\nf 1 2 3\n\
         usemtl {{b}}\nusemtl red one\nf 1 2 3\nusemtl c#1\nf 1 2 3\n"
    );
    let (obj, warnings) = whole(&text).expect("it is a mesh");
    assert_eq!(
        parts(&obj.mesh),
        [(1, None, false), (3, Some(0), false), (1, Some(2), false)]
    );
    let names = |mentions: &[super::Mention]| -> Vec<String> {
        let told = mentions.iter();
        told.map(|it| format!("{} {}", it.place, it.name)).collect()
    };
    assert_eq!(
        names(&obj.materials),
        ["a.obj:10:8 red one", "a.obj:13:8 {b}", "a.obj:16:8 c#1"]
    );
    assert_eq!(
        names(&obj.libraries),
        ["a.obj:1:8 a.mtl", "a.obj:2:8 my lib.mtl"]
    );
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn colors_of_vertices_are_read_and_linear() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 0.5 1 0 0.25\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\n\
        f 1//1 2//1 3//1\nf 3//2 2//1 1//1\n";
    let (mesh, warnings) = obj(text).expect("it is a mesh");
    let half = 0.214_041_14;
    let green = Vec4::new(half, 1.0, 0.0, 1.0);
    let red = Vec4::new(1.0, 0.0, 0.0, 1.0);
    assert_eq!(mesh.copies, [2, 2]);
    let wanted = vec![red, Vec4::ONE, green, Vec4::ONE, green, green];
    assert_eq!(mesh.colors, Some(wanted));
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn a_concave_face_is_cut_along_its_outline() {
    let text = include_str!("../../../../tests/cases/course/concave_fan_from_first_is_wrong.obj");
    // Once as it is, once from another corner, once the other way round.
    for face in ["f 2 3 4 5 1", "f 3 4 5 1 2", "f 1 5 4 3 2"] {
        let (mesh, warnings) = obj(&text.replace("f 2 3 4 5 1", face)).expect(face);
        let area_vector = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            (b - a).cross(c - a) / 2.0
        };
        let areas: Vec<_> = mesh.triangles.iter().map(area_vector).collect();
        let side = if face.starts_with("f 1") { -1.0 } else { 1.0 };
        assert_eq!(areas.len(), 3);
        assert!(areas.iter().all(|area| area.z * side > 0.0), "{areas:?}");
        assert_eq!(areas.iter().sum::<Vec3>(), Vec3::Z * side * 2.5);
        assert_eq!(warnings, [""; 0]);
    }
}

#[test]
fn what_nobody_reads_need_not_be_right() {
    for (text, wanted) in [
        (
            "f 1/7 2/8 3/9\n",
            "4:3: `1/7` names a texture coordinate, but there are none above; it is passed over, and so are others like it",
        ),
        (
            "f 1//1 2//1 3\n",
            "4:3: `1//1` names a normal, but there are none above; it is passed over, and so are others like it",
        ),
        (
            "f 1 2\nf 1 2 3\nf\n",
            "4:1: `f` has fewer than 3 corners; it is left out, and so are others like it",
        ),
        (
            "f 1 2 3#glued 4 5\n",
            "4:7: `3#glued` ends in a comment, and so do others like it",
        ),
        (
            "vt 0#glued\nf 1 2 3\n",
            "4:4: `0#glued` ends in a comment, and so do others like it",
        ),
        (
            "vn nan -nan(ind) -1.#IND\nf 1//1 2//1 3//1\n",
            "4:4: `nan` is no number; it is passed over, and so are others like it",
        ),
        (
            "vt 1.#QNAN inf\nf 1 2 3\n",
            "4:4: `1.#QNAN` is no number; it is passed over, and so are others like it",
        ),
        (
            "v 9 9 9 nan 0 0\nf 1 2 3\n",
            "4:9: `nan` is no number; it is passed over, and so are others like it",
        ),
        (
            "v 9 9 9 0 255 0\nf 1 2 3\n",
            "4:11: `255` is no part of a color, which goes from 0 to 1; it is clamped, and so are others like it",
        ),
        (
            "s x y\nf 1 2 3\n",
            "4:3: `x` is no smoothing group; it is taken for `off`, and so are others like it",
        ),
        (
            "usemtl\nf 1 2 3\n",
            "4:1: `usemtl` names nothing; it is passed over, and so are others like it",
        ),
    ] {
        let (mesh, warnings) = obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{text}")).expect(text);
        assert_eq!(mesh.triangles, [[0, 1, 2]], "{text}");
        assert_eq!(warnings, [format!("a.obj:{wanted}")], "{text}");
    }
}

#[test]
fn a_face_that_crosses_itself_is_a_fan_with_a_warning() {
    let text = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n";
    let (mesh, warnings) = obj(text).expect("it is a mesh");
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    let wanted = "a.obj:5:1: `f` is a face that crosses itself; it is cut into a fan, and so are others like it";
    assert_eq!(warnings, [wanted]);
}

#[test]
fn vertices_without_faces_are_a_mesh_with_a_warning() {
    let (mesh, warnings) = obj("v 1 2 3\n").expect("it is a mesh");
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (1, 0));
    assert_eq!(warnings, ["a.obj:2:1: there are no faces"]);
}

#[test]
fn what_is_wrong_in_an_obj_is_told_where_it_is() {
    for (text, wanted) in [
        ("", "1:1: expected `v x y z`, but found the end of the file"),
        (
            "o a\n",
            "2:1: expected `v x y z`, but found the end of the file",
        ),
        (
            "hello world\n",
            "1:1: expected `v x y z`, but found `hello`",
        ),
        (
            "v 1 2\nv 1 2 3",
            "1:6: expected a number after `v`, but found the end of the line",
        ),
        (
            "v 1 2 # 3\n",
            "1:10: expected a number after `v`, but found the end of the line",
        ),
        (
            "v 1 2 \\",
            "1:8: expected a number after `v`, but found the end of the file",
        ),
        (
            "v 1 2 nan",
            "1:7: expected a number after `v`, but found `nan`",
        ),
        (
            "v 1 2 3 v 4 5 6",
            "1:9: expected a number after `v`, but found `v`",
        ),
        (
            "v 1 2 3 4 5 6 7 8",
            "1:17: expected the end of the line after at most 7 numbers, but found `8`",
        ),
        (
            "vn 1 2 3 4",
            "1:10: expected the end of the line after `vn x y z`, but found `4`",
        ),
        (
            "vt\n",
            "1:3: expected a number after `vt`, but found the end of the line",
        ),
        (
            "vt 0 0 0 0",
            "1:10: expected the end of the line after `vt u v w`, but found `0`",
        ),
        (
            "v 1e10 0 0",
            "1:3: expected a number of at most 1e9 in size after `v`, but found `1e10`",
        ),
        (
            "v 0 0 0 \\\n\\\n x",
            "3:2: expected a number after `v`, but found `x`",
        ),
        (
            "f 1 2 3",
            "1:3: expected one of the 0 vertices above, counted from 1, but found `1`",
        ),
    ] {
        let found = obj(text).map(|_| ());
        assert_eq!(found, Err(format!("a.obj:{wanted}")), "{text:?}");
    }
}

#[test]
fn what_is_wrong_in_a_face_is_told_where_it_is() {
    const VERTEX: &str = "expected one of the 3 vertices above, counted from 1, but found";
    for (face, wanted) in [
        ("f 1 2 4", format!("7: {VERTEX} `4`")),
        ("f 0 1 2", format!("3: {VERTEX} `0`")),
        ("f 1 2 -4", format!("7: {VERTEX} `-4`")),
        ("f 1 2 x", format!("7: {VERTEX} `x`")),
        ("f 1 2 1.5", format!("7: {VERTEX} `1.5`")),
        ("f 1 2 /1", format!("7: {VERTEX} `/1`")),
        ("f 1 2 3\\x", format!("7: {VERTEX} `3\\x`")),
        (
            "f 1 2 -9223372036854775808",
            format!("7: {VERTEX} `-9223372036854775808`"),
        ),
        (
            "f 1 2 99999999999999999999",
            format!("7: {VERTEX} `99999999999999999999`"),
        ),
        (
            "f 1 2/2 3",
            "7: expected one of the 1 texture coordinates above, counted from 1, but found `2`"
                .to_owned(),
        ),
        (
            "f 1 2/1/-2 3",
            "9: expected one of the 1 normals above, counted from 1, but found `-2`".to_owned(),
        ),
        (
            "f 1 2/1/1/1 3",
            "5: expected a corner of at most 3 parts, `v/vt/vn`, but found `2/1/1/1`".to_owned(),
        ),
    ] {
        let found = obj(&format!("{ABOVE}{face}\nv 1 1 1\n")).map(|_| ());
        assert_eq!(found, Err(format!("a.obj:6:{wanted}")), "{face:?}");
    }
}

#[test]
fn an_obj_stops_at_the_first_vertex_or_triangle_too_many() {
    let limits = Limits {
        vertices: 3,
        triangles: 2,
        ..Limits::default()
    };
    let read = |more: &str| {
        let text = format!("{ABOVE}{more}");
        let mesh = read("a", &text, &limits, &mut Warnings::default());
        mesh.map(drop).map_err(|error| error.to_string())
    };
    assert_eq!(read("f 1 2 3\nf 1 2 3\n"), Ok(()));
    let wanted = "4 exceeds the limit `vertices` of 3";
    assert_eq!(read("v never read"), Err(wanted.to_owned()));
    let wanted = "3 exceeds the limit `triangles` of 2";
    assert_eq!(read("f 1 2 3 1 2 never read"), Err(wanted.to_owned()));
    // A copy counts as a vertex.
    let wanted = "4 exceeds the limit `vertices` of 3";
    let second = "vt 1 1\nf 1/1 2/1 3/1\nf 1/2 2/1 3/1";
    assert_eq!(read(second), Err(wanted.to_owned()));
}
