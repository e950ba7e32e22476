//! Is every file, however broken, answered with a rig or with a clear error, and never with a panic, a hang or a huge allocation?

use rigd::formats::{File, FileFault, FileRef, LoadError, Loaded, Source, load};
use rigd::limits::{LimitExceeded, Limits};

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

const TEXTURE: (&str, &[u8]) = ("face.bmp", b"BM");

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

#[test]
fn the_files_used_here_are_sound() {
    let loaded = load_files(&[
        ("a.skel", SKEL.as_bytes()),
        ("a.skin", SKIN.as_bytes()),
        TEXTURE,
    ])
    .expect("both are valid");
    assert_eq!(loaded.rig.warnings(), [""; 0]);
    assert_eq!(loaded.rig.skeleton().joints()[0].rest_angles.x, 1.5);
    assert_eq!(loaded.rig.bindings().len(), 2);
    assert_eq!(
        loaded.rig.materials()[0]
            .texture
            .as_ref()
            .map(|it| it.levels().len()),
        Some(2)
    );
    assert_eq!(
        (loaded.name.as_str(), loaded.dialects),
        ("a", vec!["cse169 skel", "cse169 skin"])
    );
}

#[test]
fn a_file_cut_anywhere_is_a_clear_fault() {
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

/// Marsaglia's xorshift: the same mutations on every run.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }
}

fn mutated(text: &str, random: &mut Random) -> Vec<u8> {
    const PIECES: [&[u8]; 20] = [
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
    let (mut rigs, mut faults) = (0, 0);
    for round in 0..20_000 {
        let mut skel = SKEL.as_bytes().to_vec();
        let mut skin = SKIN.as_bytes().to_vec();
        if round % 2 == 0 {
            skel = mutated(SKEL, &mut random);
        } else {
            skin = mutated(SKIN, &mut random);
        }
        match load_files(&[("a.skel", &skel), ("a.skin", &skin), TEXTURE]) {
            Ok(loaded) => {
                rigs += 1;
                let rig = loaded.rig;
                assert_eq!(
                    rig.bindings()
                        .iter()
                        .filter(|it| it.joint.is_some())
                        .count(),
                    rig.skeleton().joints().len()
                );
                for mesh in rig.meshes() {
                    assert!(mesh.positions().iter().all(|position| position.is_finite()));
                    assert!(
                        mesh.influences()
                            .iter()
                            .all(|influence| influence.weight.is_finite())
                    );
                }
            }
            Err(LoadError::Invalid(fault)) => {
                faults += 1;
                assert_is_clear(&fault, if fault.file == "a.skel" { &skel } else { &skin });
            }
            Err(LoadError::Limit(_) | LoadError::TwoSkeletons { .. }) => {}
            Err(other) => panic!("{other}"),
        }
    }
    // Both must have been tried.
    assert!(rigs > 1000 && faults > 1000, "{rigs} rigs, {faults} faults");
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
}

#[test]
fn memory_follows_what_a_file_holds_not_what_it_claims() {
    let unlimited = Limits {
        vertices: u64::MAX,
        triangles: u64::MAX,
        joints: u64::MAX,
        influences: u64::MAX,
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
fn encodings_that_are_not_utf8_are_refused_by_name() {
    let utf16: Vec<u8> = "\u{FEFF}balljoint a { }"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let found = fault(load_files(&[("a.skel", &utf16)]));
    assert_eq!(
        found.to_string(),
        "a.skel:1:1: expected UTF-8 text, but found UTF-16 text"
    );
    let found = fault(load_files(&[(
        "a.skel",
        b"balljoint a {\n\tballjoint kn\xE4 { } }",
    )]));
    assert_eq!(
        found.to_string(),
        "a.skel:2:14: expected UTF-8 text, but found the byte 0xE4"
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
    assert!(rig.meshes()[0].texcoords().is_some() && rig.meshes()[0].material() == Some(0));
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
            "a.bmp:1:1: expected a CSE 169 skeleton (`.skel`) or skin (`.skin`), but found a BMP picture",
        ),
        (
            &[("a.skel", skel), ("a.anim", b"animation {")],
            "a.anim:1:1: expected a CSE 169 skeleton (`.skel`) or skin (`.skin`), but found an animation, which is not supported",
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
