//! Is every file, however broken, answered with a rig or with a clear error, and never with a panic, a hang or a huge allocation?

mod support;

use rigd::formats::{File, FileFault, FileRef, LoadError, Loaded, Source, load};
use rigd::limits::{LimitExceeded, Limits};
use support::random::Random;

const SKEL: &str = "\
balljoint root {
\toffset 0 1 0
\tboxmin -0.1 -0.1 -0.1
\tboxmax 0.1 0.1 0.1
\trotxlimit -1.5 1.5
\tpose 2 0 0
\tballjoint tip {
\t\toffset 0 1 0
\t\tpose 0 0 .5
\t}
}";

const SKIN: &str = "\
positions 3 {\n\t0 0 0\n\t1 0 0\n\t0 1 0\n}
normals 3 {\n\t0 0 1\n\t0 0 1\n\t0 0 1\n}
texcoords 3 {\n\t0 0\n\t1 0\n\t0 1\n}
skinweights 3 {\n\t1 0 1.0\n\t2 0 0.25 1 0.75\n\t1 1 1\n}
material face {\n\ttexture face.bmp\n}
triangles 1 {\n\t0 1 2\n}
bindings 2 {
\tmatrix {\n\t\t1 0 0\n\t\t0 1 0\n\t\t0 0 1\n\t\t0 1 0\n\t}
\tmatrix {\n\t\t1 0 0\n\t\t0 1 0\n\t\t0 0 1\n\t\t0 2 0\n\t}
}";

const MORPH: &str = "\
positions 2 {\n\t0 0 0 1\n\t2 0 2 0\n}
normals 1 {\n\t2 0 1 0\n}";

const ANIM: &str = "\
animation {
\trange 0 1.5
\tnumchannels 9
\tchannel 0 {\n\t\textrapolate constant bounce\n\t\tkeys 2 {\n\t\t\t0 1 smooth flat\n\t\t\t1 2 -.5 linear\n\t\t}\n\t}
\tchannel { keys 0 { } }\n\tchannel { keys 0 { } }\n\tchannel { keys 0 { } }\n\tchannel { keys 0 { } }
\tchannel { keys 0 { } }\n\tchannel { keys 0 { } }\n\tchannel { keys 0 { } }\n\tchannel { keys 0 { } }
}";

const LIST: &str = "rig a {\n\tskeleton a.skel\n\tskin a.skin\n\tmorphs 1 {\n\t\ta.morph\n\t}\n}";

/// One pixel: blue 1, green 2, red 3.
const TEXTURE: (&str, &[u8]) = (
    "face.bmp",
    b"BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\x18\0\0\0\0\0\x04\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x01\x02\x03\0",
);

const MIT_SKEL: &str = "0 0 0 -1\n0 1 0 0\n0 1 0 1\n";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const ATTACH: &str = "1 0\n0 1\n.5 .5\n";

/// Every kind of file, each with the family that makes a whole character: files of a family are broken one at a time.
const FAMILIES: [&[(&str, &str)]; 2] = [
    &[
        ("a.skel", SKEL),
        ("a.skin", SKIN),
        ("a.morph", MORPH),
        ("a.anim", ANIM),
        ("a.rig", LIST),
    ],
    &[("a.skel", MIT_SKEL), ("a.obj", OBJ), ("a.attach", ATTACH)],
];

fn inline(name: &str, bytes: &[u8]) -> FileRef {
    let (name, bytes) = (name.to_owned(), bytes.into());
    FileRef::Inline(File { name, bytes })
}

fn load_with(limits: &Limits, files: &[(&str, &[u8])]) -> Result<Loaded, LoadError> {
    let files: Vec<FileRef> = files
        .iter()
        .map(|&(name, bytes)| inline(name, bytes))
        .collect();
    load(&files, &Source::inline_only(), limits)
}

fn load_files(files: &[(&str, &[u8])]) -> Result<Loaded, LoadError> {
    load_with(&Limits::default(), files)
}

/// The fault that a load must end with.
fn fault(result: Result<Loaded, LoadError>) -> FileFault {
    match result.map(|loaded| loaded.name) {
        Err(LoadError::Invalid(fault)) => fault,
        other => panic!("a fault in a file was due, but this came: {other:?}"),
    }
}

fn exceeded(result: Result<Loaded, LoadError>) -> LimitExceeded {
    match result.map(|loaded| loaded.name) {
        Err(LoadError::Limit(exceeded)) => exceeded,
        other => panic!("an exceeded limit was due, but this came: {other:?}"),
    }
}

/// A fault points into its file and says something.
fn assert_is_clear(fault: &FileFault, bytes: &[u8]) {
    let lines = 1 + bytes.iter().filter(|byte| b"\r\n".contains(byte)).count();
    assert!((1..=lines).contains(&fault.line), "{fault}");
    assert!((1..=bytes.len() + 1).contains(&fault.column), "{fault}");
    assert!(!fault.expected.is_empty() && !fault.found.is_empty());
    assert!(
        fault.to_string().len() < 400 && !fault.to_string().contains('\n'),
        "{fault}"
    );
}

/// A family with its picture, the bytes of one file replaced.
fn with_broken<'a>(
    family: &[(&'static str, &'static str)],
    name: &str,
    bytes: &'a [u8],
) -> Vec<(&'static str, &'a [u8])> {
    let files = family.iter().map(|&(file, text)| {
        let bytes: &[u8] = if file == name { bytes } else { text.as_bytes() };
        (file, bytes)
    });
    files.chain([TEXTURE]).collect()
}

#[test]
fn the_files_used_here_are_sound() {
    let loaded =
        load_files(&with_broken(FAMILIES[0], "", b"")).expect("all of the family are valid");
    assert_eq!(loaded.rig.warnings(), [""; 0]);
    let joint = &loaded.rig.skeleton().joints()[0];
    assert_eq!(joint.rest_rotation.angles(joint.rotation_order).x, 1.5);
    assert_eq!(loaded.rig.bindings().len(), 2);
    assert_eq!(
        loaded.rig.materials()[0]
            .texture
            .as_ref()
            .map(|it| it.texture.levels()[0].texels.clone()),
        Some(vec![[3, 2, 1, 255]])
    );
    let moved = [loaded.rig.morphs().len(), loaded.rig.clips().len()];
    assert_eq!((loaded.name.as_str(), moved), ("a", [1, 1]));
    let rig = load_files(&with_broken(FAMILIES[1], "", b""))
        .expect("all of the family are valid")
        .rig;
    assert_eq!((rig.vertex_count(), rig.skeleton().joints().len()), (3, 3));
}

#[test]
fn a_skeleton_or_skin_cut_anywhere_is_a_clear_fault() {
    for end in 0..SKEL.len() {
        let cut = &SKEL.as_bytes()[..end];
        assert_is_clear(&fault(load_files(&[("a.skel", cut)])), cut);
    }
    for end in 0..SKIN.len() {
        let cut = &SKIN.as_bytes()[..end];
        assert_is_clear(&fault(load_files(&[("a.skin", cut)])), cut);
        assert_is_clear(
            &fault(load_files(&[("a.skel", SKEL.as_bytes()), ("a.skin", cut)])),
            cut,
        );
    }
}

#[test]
fn a_file_cut_anywhere_gives_a_sound_rig_or_a_clear_fault() {
    for family in FAMILIES {
        for (name, text) in family {
            let mut faults = 0;
            for end in 0..text.len() {
                let cut = &text.as_bytes()[..end];
                match load_files(&with_broken(family, name, cut)) {
                    Ok(loaded) => assert_is_sound(&loaded),
                    Err(LoadError::Invalid(fault)) => {
                        faults += 1;
                        let of_another = fault.file != *name;
                        let bytes = if of_another { text.as_bytes() } else { cut };
                        assert_is_clear(&fault, bytes);
                    }
                    Err(other) => panic!("{name} cut at {end}: {other}"),
                }
            }
            assert!(faults > 0, "{name}");
        }
    }
}

/// What holds of every rig, whatever it was made of.
fn assert_is_sound(loaded: &Loaded) {
    let rig = &loaded.rig;
    let joints = rig.skeleton().joints().len();
    assert!(
        rig.bindings()
            .iter()
            .all(|binding| binding.joint.is_none_or(|joint| joint < joints))
    );
    for mesh in rig.meshes() {
        assert!(mesh.positions().iter().all(|position| position.is_finite()));
        assert!(mesh.influences().iter().all(|it| it.weight.is_finite()));
        let is_there = |&corner: &u32| (corner as usize) < mesh.draw_vertex_count();
        assert!(mesh.triangles().as_flattened().iter().all(is_there));
        let is_of_file = |corner: u32| (corner as usize) < mesh.vertex_count();
        assert!(mesh.file_triangles().flatten().all(is_of_file));
        for vertex in 0..mesh.draw_vertex_count() {
            let displacements = mesh.morph_displacements_of(vertex).iter();
            displacements.for_each(|it| assert!(it.position.is_finite() && it.normal.is_finite()));
        }
    }
    for channel in rig.clips().iter().flat_map(|clip| &clip.channels) {
        let rigd::rig::Channel::Dof { dof, curve } = channel else {
            panic!("no reader of these makes another");
        };
        assert!(*dof < rig.dofs().all().len());
        for time in [-1e9, -1.0, 0.5, 1.0, 1e9] {
            assert!(curve.at(time).is_finite());
        }
    }
}

fn mutated(text: &str, random: &mut Random) -> Vec<u8> {
    const PIECES: [&[u8]; 29] = [
        b"{",
        b"}",
        b" ",
        b"\r",
        b"\n",
        b"-",
        b"-1",
        b"0",
        b"9",
        b"nan",
        b"1e400",
        b"4294967296",
        b"18446744073709551616",
        b".",
        b"\0",
        b"\xFF",
        b"\xC3\xA9",
        b"balljoint",
        b"matrix",
        b"triangles 1 {",
        b"channel {",
        b"smooth",
        b"a.rig",
        b"f 1 2 3",
        b"//",
        b"#",
        b"/*",
        b"\n;",
        b"\"",
    ];
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(4) {
            0 => bytes[at] = random.below(256) as u8,
            1 => {
                bytes.remove(at);
            }
            2 => {
                let piece = PIECES[random.below(PIECES.len())];
                bytes.splice(at..at, piece.iter().copied());
            }
            _ => {
                let end = (at + random.below(30)).min(bytes.len());
                let piece: Vec<u8> = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}

#[test]
fn mutated_files_give_a_sound_rig_or_a_clear_fault() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    for family in FAMILIES {
        for (name, text) in family {
            let (mut rigs, mut faults) = (0, 0);
            for _ in 0..5_000 {
                let bytes = mutated(text, &mut random);
                match load_files(&with_broken(family, name, &bytes)) {
                    Ok(loaded) => {
                        rigs += 1;
                        assert_is_sound(&loaded);
                    }
                    Err(LoadError::Invalid(fault)) => {
                        faults += 1;
                        let of_another = family.iter().find(|(file, _)| *file == fault.file);
                        let broken = fault.file == *name;
                        let bytes = match of_another.filter(|_| !broken) {
                            Some((_, text)) => text.as_bytes(),
                            None => &bytes,
                        };
                        assert_is_clear(&fault, bytes);
                    }
                    Err(LoadError::Limit(_) | LoadError::TwoSkeletons { .. }) => {}
                    Err(other) => panic!("{other}"),
                }
            }
            // Both must have been tried.
            assert!(
                rigs > 100 && faults > 100,
                "{name}: {rigs} rigs, {faults} faults"
            );
        }
    }
}

#[test]
fn a_mutated_mesh_or_material_library_gives_a_sound_rig_or_a_clear_fault() {
    // All that there is in either: copies of vertices, a face to be cut, materials, colors, groups.
    const MESH: &str = "mtllib b.mtl\nv 1 .5 0 1 0 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 2 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n\
        usemtl one\ns 1\nf 2/1/1 3/2 4 5//1 1\nusemtl two\ns off\nf 3/2 2 1\nf -1/1/1 -2/-1/-1 -3\n";
    const LIBRARY: &str = "newmtl one\nKd 1 0 .5\nKs .1 .1 .1\nNs 9\nmap_Kd -s 2 2 -o .5 face.bmp\nnewmtl two\nd .5\nmap_Bump x\n";
    let family: &[(&str, &str)] = &[("b.obj", MESH), ("b.mtl", LIBRARY)];
    let whole = load_files(&with_broken(family, "", b"")).expect("both are valid");
    assert_eq!(whole.rig.materials().len(), 2);
    assert!(whole.rig.draw_vertex_count() > whole.rig.vertex_count());
    let mut random = Random(0x0B7E_C700);
    for (name, text) in family {
        for _ in 0..5_000 {
            let bytes = mutated(text, &mut random);
            match load_files(&with_broken(family, name, &bytes)) {
                Ok(loaded) => assert_is_sound(&loaded),
                // A library is at fault only where its first word makes a file of another kind of it.
                Err(LoadError::Invalid(fault)) if fault.file == *name => {
                    assert_is_clear(&fault, &bytes);
                }
                Err(LoadError::Invalid(fault)) => assert_is_clear(&fault, MESH.as_bytes()),
                Err(LoadError::Limit(_)) => {}
                Err(other) => panic!("{name}: {other}"),
            }
        }
    }
}

#[test]
fn counts_are_held_to_limits_before_anything_is_read() {
    for (text, limit, asked) in [
        ("positions 99999999 {", "vertices", 99_999_999),
        ("normals 99999999 {", "vertices", 99_999_999),
        ("texcoords 99999999 {", "vertices", 99_999_999),
        ("skinweights 99999999", "vertices", 99_999_999),
        ("triangles 99999999 {", "triangles", 99_999_999),
        ("bindings 65537 {", "joints", 65_537),
        ("skinweights 1 { 99999999", "influences", 99_999_999),
        (
            "positions 99999999999999999999999999 {",
            "vertices",
            u64::MAX,
        ),
    ] {
        let found = exceeded(load_files(&[("a.skin", text.as_bytes())]));
        assert_eq!((found.limit, found.asked), (limit, asked), "{text}");
    }
    for (name, text, limit) in [
        ("a.morph", "positions 99999999 {", "morph_displacements"),
        ("a.morph", "normals 99999999 {", "morph_displacements"),
        (
            "a.anim",
            "animation { numchannels 1 channel { keys 99999999 {",
            "keys",
        ),
        ("a.rig", "rig a { morphs 99999999 {", "morph_targets"),
    ] {
        let found = exceeded(load_files(&with_broken(FAMILIES[0], name, text.as_bytes())));
        assert_eq!((found.limit, found.asked), (limit, 99_999_999), "{text}");
    }
}

#[test]
fn memory_follows_what_a_file_holds_not_what_it_claims() {
    let unlimited = Limits {
        vertices: u64::MAX,
        triangles: u64::MAX,
        joints: u64::MAX,
        influences: u64::MAX,
        morph_targets: u64::MAX,
        morph_displacements: u64::MAX,
        keys: u64::MAX,
        ..Limits::default()
    };
    for text in [
        "positions 1000000000000000000 { 0 0 0 }",
        "texcoords 1000000000000000000 { 0 0 }",
        "triangles 1000000000000000000 { 0 0 0 }",
        "skinweights 1000000000000000000 { 1 0 1 }",
        "skinweights 1 { 1000000000000000000 0 1 }",
        "skinweights 1 { 4294967295 0 1 }",
        "bindings 1000000000000000000 { }",
        "positions 18446744073709551615 { }",
    ] {
        let found = fault(load_with(&unlimited, &[("a.skin", text.as_bytes())]));
        assert_is_clear(&found, text.as_bytes());
    }
    for (name, text) in [
        ("a.morph", "positions 1000000000000000000 { 0 0 0 0 }"),
        (
            "a.morph",
            "positions 0 { } normals 18446744073709551615 { 0 0 0 1 }",
        ),
        (
            "a.anim",
            "animation { range 0 1 numchannels 18446744073709551615 }",
        ),
        (
            "a.anim",
            "animation { numchannels 1 channel { keys 1000000000000000000 { 0 0 flat flat } } }",
        ),
        ("a.rig", "rig a { morphs 18446744073709551615 { a.morph } }"),
    ] {
        let files = with_broken(FAMILIES[0], name, text.as_bytes());
        let found = fault(load_with(&unlimited, &files));
        assert_eq!(found.file, name);
        assert_is_clear(&found, text.as_bytes());
    }
}

#[test]
fn depth_is_bounded_by_limits_and_not_by_the_stack() {
    let depth = 200_000;
    let deep = format!("{}{}", "joint{".repeat(depth), "}".repeat(depth));
    let found = exceeded(load_files(&[("a.skel", deep.as_bytes())]));
    assert_eq!((found.limit, found.asked), ("joints", 65_537));

    let limits = Limits {
        joints: depth as u64,
        ..Limits::default()
    };
    let loaded = load_with(&limits, &[("a.skel", deep.as_bytes())]).expect("that many are allowed");
    assert_eq!(loaded.rig.skeleton().joints().len(), depth);

    let blocks = format!("joint a {{ x {}{} }}", "{".repeat(depth), "}".repeat(depth));
    assert!(load_files(&[("a.skel", blocks.as_bytes())]).is_ok());
}

#[test]
fn complaints_and_names_are_bounded() {
    let odd = format!("joint a {{ {} }}", "pose 0 0 0 x ".repeat(20_000));
    let rig = load_files(&[("a.skel", odd.as_bytes())])
        .expect("it is only odd")
        .rig;
    assert_eq!(rig.warnings().len(), 51);
    let word = "x".repeat(5_000_000);
    let text = format!("joint a {{ {word} }}");
    let rig = load_files(&[("a.skel", text.as_bytes())])
        .expect("it is only odd")
        .rig;
    assert!(rig.warnings()[0].len() < 200);
    let long = "n".repeat(5000);
    let refused = load_files(&[(&long, SKEL.as_bytes())]);
    assert!(matches!(refused, Err(LoadError::PathNotAllowed { file, .. }) if file.len() < 100));
}

#[test]
fn a_number_too_large_to_work_with_is_told_of_the_file_it_is_in() {
    let skel = |offset: &str| format!("balljoint a {{ offset {offset} 0 0 }}");
    let skin = |position: &str, binding: &str| {
        format!(
            "positions 1 {{ {position} 0 0 }} normals 1 {{ 0 0 1 }} skinweights 1 {{ 1 0 1 }} triangles 0 {{ }} \
             bindings 1 {{ matrix {{ 1 0 0 0 1 0 0 0 1 {binding} 0 0 }} }}"
        )
    };
    for (offset, position, binding, file) in [
        ("2e9", "0", "0", "a.skel"),
        ("0", "2e9", "0", "a.skin"),
        ("0", "0", "2e9", "a.skin"),
    ] {
        let (skel, skin) = (skel(offset), skin(position, binding));
        let files = [("a.skel", skel.as_bytes()), ("a.skin", skin.as_bytes())];
        assert_eq!(fault(load_files(&files)).file, file);
    }
}

#[test]
fn utf16_and_bytes_that_are_no_text_are_refused_by_name() {
    let utf16: Vec<u8> = "\u{FEFF}balljoint a { }"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let found = fault(load_files(&[("a.skel", &utf16)]));
    assert_eq!(
        found.to_string(),
        "a.skel:1:1: expected UTF-8 text, but found UTF-16 text"
    );
    let found = fault(load_files(&[("a.skel", b"balljoint a\0b { }")]));
    assert_eq!(
        found.to_string(),
        "a.skel:1:12: expected UTF-8 text, but found the byte 0x00"
    );
    let rig = load_files(&[("a.skel", "\u{FEFF}balljoint Knäuel { }".as_bytes())])
        .expect("it is UTF-8")
        .rig;
    assert_eq!(rig.skeleton().joints()[0].name, "Knäuel");
}

#[test]
fn names_that_repeat_are_made_unique_and_reversed_limits_are_not_guessed_at() {
    let text = "balljoint knee { balljoint knee { } balljoint { } balljoint knee { } }";
    let rig = load_files(&[("a.skel", text.as_bytes())])
        .expect("names are free")
        .rig;
    let names: Vec<_> = rig
        .skeleton()
        .joints()
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(names, ["knee", "knee#2", "joint_2", "knee#3"]);

    let reversed = SKEL.replace("-1.5 1.5", "1.5 -1.5");
    let found = fault(load_files(&[("a.skel", reversed.as_bytes())]));
    assert_eq!(
        (found.line, found.column, found.found.as_str()),
        (5, 12, "1.5 and -1.5")
    );
}

#[test]
fn a_skin_alone_stays_as_modelled_and_is_checked_all_the_same() {
    let rig = load_files(&[("a.skin", SKIN.as_bytes()), TEXTURE])
        .expect("a skin may stand alone")
        .rig;
    assert!(rig.skeleton().joints().is_empty());
    assert!(rig.bindings().iter().all(|binding| binding.joint.is_none()));
    assert!(
        rig.meshes()[0].texcoords().is_some() && rig.meshes()[0].parts()[0].material == Some(0)
    );
    assert_eq!(rig.warnings(), [""; 0]);
    let wrong = SKIN.replace("1 1 1\n", "1 2 1\n");
    assert_eq!(
        fault(load_files(&[("a.skin", wrong.as_bytes())])).found,
        "`2`"
    );
}

#[test]
fn several_skins_are_several_meshes_of_one_skeleton() {
    let other = SKIN.replace("texture face.bmp", "");
    let files: [(&str, &[u8]); 4] = [
        ("b.skin", SKIN.as_bytes()),
        ("a.skel", SKEL.as_bytes()),
        ("c.skin", other.as_bytes()),
        TEXTURE,
    ];
    let rig = load_files(&files).expect("any number of skins will do").rig;
    assert_eq!(
        (
            rig.meshes().len(),
            rig.bindings().len(),
            rig.materials().len()
        ),
        (2, 4, 2)
    );
    assert_eq!(rig.meshes()[1].influences_of(0)[0].binding, 2);
    assert!(rig.materials()[0].texture.is_some() && rig.materials()[1].texture.is_none());
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let skel = SKEL.as_bytes();
    for (files, wanted) in [
        (&[][..], "no files are given"),
        (
            &[("x/a.skel", skel), ("y/a.skel", skel)],
            "two of the files are named `a.skel`",
        ),
        (
            &[("a.skel", skel), ("b.txt", skel)],
            "`a.skel` and `b.txt` are both skeletons, but a rig has at most one",
        ),
        (
            &[("x/", skel)],
            "file `x/` may not be opened: it does not end in a file name",
        ),
        (
            &[("a.bmp", b"BM")],
            "a.bmp:1:1: expected a rig file (CSE 169 `.skel`, `.skin`, `.morph`, `.anim` or `.rig`, \
             MIT 6.837 `.skel` or `.attach`, `.obj`, or glTF 2.0 `.gltf` or `.glb`), but found a BMP picture",
        ),
        (
            &[("a.skel", skel), ("a.glb", b"glTF")],
            "a.glb:1:1: expected no other rig file beside a glTF document, but found `a.skel`, a CSE 169 skeleton",
        ),
    ] {
        let found = load_files(files)
            .map(|loaded| loaded.name)
            .map_err(|error| error.to_string());
        assert_eq!(found, Err(wanted.to_owned()));
    }
}

#[test]
fn files_that_nobody_needs_and_textures_that_nobody_sent_are_warned_of() {
    let files: [(&str, &[u8]); 3] = [
        ("d/a.skel", SKEL.as_bytes()),
        ("d/a.skin", SKIN.as_bytes()),
        ("d/readme.txt", b"hello"),
    ];
    let rig = load_files(&files).expect("that is no reason to fail").rig;
    assert_eq!(
        rig.warnings(),
        [
            "d/a.skin:22:10: the texture `face.bmp` is left out: it was not found",
            "`d/readme.txt` is not used: no file refers to it",
        ]
    );
    let no_picture: [(&str, &[u8]); 2] = [("a.skin", SKIN.as_bytes()), ("face.bmp", b"BM")];
    let rig = load_files(&no_picture)
        .expect("that is no reason to fail")
        .rig;
    assert_eq!(rig.warnings().len(), 1);
    assert!(rig.warnings()[0].starts_with("a.skin:22:10: the texture `face.bmp` is left out: "));
    assert!(rig.materials()[0].texture.is_none());
    let referred_to_skel = SKIN.replace("face.bmp", "a.skel");
    let files: [(&str, &[u8]); 2] = [
        ("a.skel", SKEL.as_bytes()),
        ("a.skin", referred_to_skel.as_bytes()),
    ];
    let rig = load_files(&files).expect("that is no reason to fail").rig;
    assert_eq!(
        rig.warnings(),
        ["a.skin:22:10: the texture `a.skel` is left out: it is no picture"]
    );
}

#[test]
fn what_does_not_fit_is_told_in_the_file_that_does_not_fit() {
    for (family, name, piece, by, wanted) in [
        // A morph target of another skin.
        (
            0,
            "a.morph",
            "2 0 2 0",
            "3 0 2 0",
            "a.morph:3:2: expected a vertex below 3, the number of positions in `a.skin`, in position 1, but found `3`",
        ),
        (
            0,
            "a.morph",
            "2 0 2 0",
            "0 0 2 0",
            "a.morph:3:2: expected a vertex that was not listed before in position 1, but found `0`",
        ),
        (
            0,
            "a.morph",
            "positions 2",
            "positions 3",
            "a.morph:4:1: expected 3 positions as announced, but found `}` after 2",
        ),
        (
            0,
            "a.anim",
            "numchannels 9",
            "numchannels 12",
            "a.anim:19:1: expected 12 channels as announced, but found `}` after 9",
        ),
        (
            0,
            "a.anim",
            "keys 2",
            "keys 1",
            "a.anim:8:4: expected `}` after 1 key as announced, but found `1`: 2 keys in all",
        ),
        (
            0,
            "a.anim",
            "1 2 -.5",
            "0 2 -.5",
            "a.anim:8:4: expected a time after 0 in key 1, but found `0`",
        ),
        // A list that leads to itself, to a picture, to nothing.
        (
            0,
            "a.rig",
            "a.morph",
            "a.rig",
            "a.rig:5:3: expected `a.rig` to be a CSE 169 morph target, but found this `.rig` itself",
        ),
        (
            0,
            "a.rig",
            "a.skin",
            "face.bmp",
            "a.rig:3:7: expected `face.bmp` to be a CSE 169 skin, but found a BMP picture",
        ),
        (
            0,
            "a.rig",
            "a.skel",
            "b.skel",
            "a.rig:2:11: expected `b.skel` to be a CSE 169 skeleton, but found no such file in the request",
        ),
        (
            1,
            "a.attach",
            "0 1\n",
            "0\n",
            "a.attach:2:2: expected 2 weights in vertex 1, one for each joint of `a.skel` but the root, but found 1",
        ),
        (
            1,
            "a.attach",
            ".5 .5\n",
            "",
            "a.attach:3:1: expected 3 rows, one for each vertex of `a.obj`, but found the end of the file after 2",
        ),
        (
            1,
            "a.obj",
            "f 1 2 3",
            "f 1 2 4",
            "a.obj:4:7: expected one of the 3 vertices above, counted from 1, but found `4`",
        ),
        (
            1,
            "a.skel",
            "0 1 0 1\n",
            "0 1 0 2\n",
            "a.skel:3:7: expected a parent from 0 to 1 in joint 2, but found `2`",
        ),
    ] {
        let family = FAMILIES[family];
        let text = family.iter().find(|(file, _)| *file == name);
        let text = text.expect("it is in its family").1;
        assert_eq!(text.matches(piece).count(), 1, "{piece} must stand once");
        let text = text.replace(piece, by);
        let found = fault(load_files(&with_broken(family, name, text.as_bytes())));
        assert_eq!(found.to_string(), wanted);
    }
}

#[test]
fn the_digest_is_of_base_names_and_contents_in_any_order() {
    let (skel, skin) = (SKEL.as_bytes(), SKIN.as_bytes());
    let digest = |files: &[(&str, &[u8])]| load_files(files).expect("all are valid").digest;
    let one = digest(&[("a.skel", skel), ("a.skin", skin), TEXTURE]);
    assert_eq!(one.len(), "sha256:".len() + 64);
    assert_eq!(
        one,
        digest(&[TEXTURE, ("x/a.skin", skin), ("y\\a.skel", skel)])
    );
    assert_ne!(one, digest(&[("b.skel", skel), ("a.skin", skin), TEXTURE]));
    assert_ne!(one, digest(&[("a.skel", skel), ("a.skin", skin)]));
}
