//! The OBJ reader on small files: what is read, what is warned of, what is refused and where.

use super::read;
use crate::limits::Limits;
use crate::rig::{MeshDraft, Warnings};
use glam::{Vec2, Vec3};

fn obj(text: &str) -> Result<(MeshDraft, Vec<String>), String> {
    let mut warnings = Warnings::default();
    read("a.obj", text, &Limits::default(), &mut warnings)
        .map(|mesh| (mesh, warnings.into_sentences()))
        .map_err(|error| error.to_string())
}

/// Three vertices on five lines, to put statements after.
const ABOVE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 .5\nvt 0 0\nvn 0 0 1\n";

#[test]
fn vertices_are_the_v_lines_in_their_order() {
    // Used backwards, and one of them by no face.
    let text =
        "v 0 0 0\nv 1 0 0\nv 0 1e0 -.5 1.0\nv 9 9 9\nv 0 0 1 0.1 0.2 0.3\nf 5 3 2\nf 3 2 1\n";
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
fn faces_of_many_corners_become_fans() {
    let (mesh, _) = obj(&format!("{ABOVE}v 0 0 9\nv 0 0 8\nf 2 3 4 5 1\n")).expect("it is a mesh");
    assert_eq!(mesh.triangles, [[1, 2, 3], [1, 3, 4], [1, 4, 0]]);
}

#[test]
fn relative_indices_count_back_from_where_they_stand() {
    let (mesh, _) =
        obj(&format!("{ABOVE}f -3 -2 -1\nv 9 9 9\nf -3 -2 -1\n")).expect("it is a mesh");
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 2, 3]]);
}

#[test]
fn standard_statements_are_read_over_in_silence() {
    let text = "# made by hand\nmtllib a.mtl\no Body #1\ng a b\ns off\nusemtl {skin}\nvp 0 0\n\
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
        [
            "a.obj:6:3: skipped `surf`, which is not read here, and its like",
            "a.obj:10:1: no face uses the file's normals",
            "a.obj:10:1: no face uses the file's texture coordinates"
        ]
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

#[test]
fn normals_and_texcoords_that_are_not_the_vertices_own_are_left_out() {
    for (faces, wanted) in [
        (
            "vn 0 1 0\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 2/1/1 3/1/2\nf 1/1/2 2/1/2 3/1/2\n",
            "8:15: a second normal for a vertex; the file's normals are not used",
        ),
        (
            "vt 0 0\nvt 0 1\nf 1/1/1 2/2/1 3/1/1\nf 3/1/1 2/3/1 1/1/1\n",
            "9:9: a second texture coordinate for a vertex; the file's texture coordinates are not used",
        ),
        (
            "f 1/1/1 2/1 3/1/1\n",
            "6:9: a corner without a normal; the file's normals are not used",
        ),
        (
            "f 1//1 2/1/1 3//1\n",
            "6:3: a corner without a texture coordinate; the file's texture coordinates are not used",
        ),
    ] {
        let (mesh, warnings) = obj(&format!("{ABOVE}{faces}")).expect(faces);
        let of_normals = wanted.contains("normals");
        assert_eq!(mesh.normals.is_none(), of_normals, "{faces}");
        assert_eq!(mesh.texcoords.is_none(), !of_normals, "{faces}");
        assert_eq!(warnings, [format!("a.obj:{wanted}")], "{faces}");
    }
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
        (
            "f 1 2",
            "6: expected at least 3 corners after `f`, but found 2".to_owned(),
        ),
        (
            "f",
            "2: expected at least 3 corners after `f`, but found 0".to_owned(),
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
        mesh.map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(read("f 1 2 3\nf 1 2 3\n"), Ok(()));
    let wanted = "4 exceeds the limit `vertices` of 3";
    assert_eq!(read("v never read"), Err(wanted.to_owned()));
    let wanted = "3 exceeds the limit `triangles` of 2";
    assert_eq!(read("f 1 2 3 1 2 never read"), Err(wanted.to_owned()));
}
