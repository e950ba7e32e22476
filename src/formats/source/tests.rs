//! What each kind of source opens and what it refuses, on real folders.

use super::{Budget, Denied, read_regular, reading};
use crate::formats::{File, FileRef, LoadError, Loaded, Source, load};
use crate::limits::{LimitExceeded, Limits};
use cap_std::ambient_authority;
use cap_std::fs::Dir;
use std::path::{Path, PathBuf};

const SKEL: &str = "balljoint root { }";
/// One pixel: blue 1, green 2, red 3.
const BMP: &[u8] = b"BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\x18\0\0\0\0\0\x04\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x01\x02\x03\0";
const SKIN: &str = "positions 1 { 0 0 0 } triangles 0 { } material m { texture skin.bmp }";
const LIST: &str = "rig all {\n skin skin.skin\n morphs 1 { sub/a.morph }\n}";
const MORPH: &str = "positions 1 { 0 1 2 3 }";

/// A folder of its own for each test:
/// ```text
/// secret.skel
/// root/  good.skel  skin.skin  skin.bmp  folder/  pipe
///        inside.skel -> good.skel      escape.skel -> ../secret.skel      loop.skel -> loop.skel
///        sub/  up.skin (its texture is ../../secret.skel)  up.rig (it lists ../../secret.skel)  a.morph
///        all.rig (it lists skin.skin and sub/a.morph)
/// ```
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let folder = format!("rigd-source-{}-{test}", std::process::id());
        let base = std::env::temp_dir().join(folder);
        let root = base.join("root");
        std::fs::create_dir_all(root.join("folder")).expect("the temporary folder is ours");
        std::fs::create_dir_all(root.join("sub")).expect("the temporary folder is ours");
        let up = SKIN.replace("skin.bmp", "../../secret.skel");
        for (file, content) in [
            ("secret.skel", SKEL.as_bytes()),
            ("root/good.skel", SKEL.as_bytes()),
            ("root/skin.skin", SKIN.as_bytes()),
            ("root/skin.bmp", BMP),
            ("root/sub/up.skin", up.as_bytes()),
            ("root/all.rig", LIST.as_bytes()),
            ("root/sub/a.morph", MORPH.as_bytes()),
            ("root/sub/up.rig", b"rig a { skeleton ../../secret.skel }"),
        ] {
            std::fs::write(base.join(file), content).expect("the temporary folder is ours");
        }
        #[cfg(unix)]
        for (target, link) in [
            ("good.skel", "inside.skel"),
            ("../secret.skel", "escape.skel"),
            ("loop.skel", "loop.skel"),
        ] {
            std::os::unix::fs::symlink(target, root.join(link)).expect("links can be made here");
        }
        Self(base)
    }

    fn root(&self) -> PathBuf {
        self.0.join("root")
    }

    fn rooted(&self) -> Source {
        Source::rooted(&self.root()).expect("the root is there")
    }

    /// Whether a pipe could be made.
    fn make_pipe(&self) -> bool {
        let made = std::process::Command::new("mkfifo")
            .arg(self.root().join("pipe"))
            .status();
        made.is_ok_and(|status| status.success())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn load_path(source: &Source, path: &str) -> Result<Loaded, LoadError> {
    load(
        &[FileRef::Path(path.to_owned())],
        source,
        &Limits::default(),
    )
}

/// The kind of an error, with the file that it names.
fn kind(result: Result<Loaded, LoadError>) -> String {
    match result {
        Ok(loaded) => format!("ok {}", loaded.name),
        Err(LoadError::FileNotFound { file }) => format!("not found {file}"),
        Err(LoadError::PathNotAllowed { file, .. }) => format!("not allowed {file}"),
        Err(other) => format!("other: {other}"),
    }
}

#[test]
fn nothing_leads_out_of_a_root() {
    let folder = Folder::new("root");
    let source = folder.rooted();
    let absolute = folder.0.join("secret.skel").display().to_string();
    let absolute_inside = folder.root().join("good.skel").display().to_string();
    for (path, wanted) in [
        ("good.skel", "ok good".to_owned()),
        ("./folder/../good.skel", "ok good".to_owned()),
        ("missing.skel", "not found missing.skel".to_owned()),
        ("good.skel/x.skel", "not found good.skel/x.skel".to_owned()),
        ("../secret.skel", "not allowed ../secret.skel".to_owned()),
        (
            "folder/../../secret.skel",
            "not allowed folder/../../secret.skel".to_owned(),
        ),
        ("../missing.skel", "not allowed ../missing.skel".to_owned()),
        (
            "../root/good.skel",
            "not allowed ../root/good.skel".to_owned(),
        ),
        (&absolute, format!("not allowed {absolute}")),
        (&absolute_inside, format!("not allowed {absolute_inside}")),
        ("folder", "not allowed folder".to_owned()),
        ("folder/", "not allowed folder/".to_owned()),
        ("", "not allowed ".to_owned()),
        (".", "not allowed .".to_owned()),
        ("good.skel\0", "not allowed good.skel\0".to_owned()),
    ] {
        assert_eq!(kind(load_path(&source, path)), wanted, "{path:?}");
    }
}

#[cfg(unix)]
#[test]
fn links_are_followed_inside_a_root_only() {
    let folder = Folder::new("links");
    let source = folder.rooted();
    assert_eq!(kind(load_path(&source, "inside.skel")), "ok inside");
    assert_eq!(
        kind(load_path(&source, "escape.skel")),
        "not allowed escape.skel"
    );
    assert!(load_path(&source, "loop.skel").is_err());
    let local = folder.root().join("escape.skel").display().to_string();
    assert_eq!(kind(load_path(&Source::local(), &local)), "ok escape");
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_not_waited_for() {
    let folder = Folder::new("pipe");
    if !folder.make_pipe() {
        println!("left out: mkfifo does not work here");
        return;
    }
    assert_eq!(
        kind(load_path(&folder.rooted(), "pipe")),
        "not allowed pipe"
    );
    let local = folder.root().join("pipe").display().to_string();
    assert_eq!(
        kind(load_path(&Source::local(), &local)),
        format!("not allowed {local}")
    );
    assert_eq!(
        kind(load_path(&Source::local(), "/dev/zero")),
        "not allowed /dev/zero"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_that_takes_a_files_place_is_not_waited_for() {
    let folder = Folder::new("race");
    if !folder.make_pipe() {
        println!("left out: mkfifo does not work here");
        return;
    }
    let dir = Dir::open_ambient_dir(folder.root(), ambient_authority()).expect("it is there");
    // What happens where the look before opening still saw a file.
    let pipe = dir
        .open_with("pipe", &reading())
        .expect("opening does not wait");
    let read = read_regular(pipe, &mut Budget::new(&Limits::default()));
    assert!(matches!(read, Err(Denied::NotAllowed(_))));
}

#[test]
fn a_source_without_paths_opens_none() {
    let source = Source::inline_only();
    assert_eq!(
        kind(load_path(&source, "good.skel")),
        "not allowed good.skel"
    );
}

#[test]
fn textures_are_looked_up_beside_their_skin() {
    let folder = Folder::new("texture");
    let local = folder.root().join("skin.skin").display().to_string();
    for (source, path) in [(folder.rooted(), "skin.skin"), (Source::local(), &*local)] {
        let rig = load_path(&source, path).expect("the skin is fine").rig;
        let texture = rig.materials()[0]
            .texture
            .as_ref()
            .expect("it lies beside the skin");
        assert_eq!(texture.texture.file(), "skin.bmp");
        assert_eq!(texture.texture.levels()[0].texels, [[3, 2, 1, 255]]);
    }
}

#[test]
fn what_a_list_names_is_looked_up_beside_it_and_counts_in_the_digest() {
    let folder = Folder::new("list");
    let local = folder.root().join("all.rig").display().to_string();
    let sent = |name: &str, bytes: &[u8]| {
        FileRef::Inline(File {
            name: name.to_owned(),
            bytes: bytes.into(),
        })
    };
    let files = [
        sent("all.rig", LIST.as_bytes()),
        sent("a.morph", MORPH.as_bytes()),
        sent("skin.skin", SKIN.as_bytes()),
        sent("skin.bmp", BMP),
    ];
    let inline = load(&files, &Source::inline_only(), &Limits::default()).expect("it is whole");
    for (source, path) in [(folder.rooted(), "all.rig"), (Source::local(), &*local)] {
        let loaded = load_path(&source, path).expect("everything lies beside the list");
        assert_eq!(loaded.name, "all");
        assert_eq!(loaded.digest, inline.digest);
        let rig = loaded.rig;
        assert_eq!(rig.warnings(), [""; 0]);
        assert_eq!(rig.morphs()[0].name, "a");
        // The skin was found beside the list, and its texture beside the skin.
        assert!(rig.materials()[0].texture.is_some());
    }
}

#[test]
fn what_a_list_names_may_not_lie_outside_nor_be_missing() {
    let folder = Folder::new("list-outside");
    let local = folder.root().join("sub/up.rig").display().to_string();
    for (source, path) in [(folder.rooted(), "sub/up.rig"), (Source::local(), &*local)] {
        let wanted = format!(
            "{path}:1:18: expected `../../secret.skel` to be a CSE 169 skeleton, but found that it may not be opened: \
             it leads out of the folder that files are read from"
        );
        let found = load_path(&source, path).map(|loaded| loaded.name);
        assert_eq!(found.map_err(|error| error.to_string()), Err(wanted));
    }
    std::fs::remove_file(folder.root().join("sub/a.morph")).expect("it is there");
    let wanted = "all.rig:3:13: expected `sub/a.morph` to be a CSE 169 morph target, \
                  but found no such file in the request or beside this one";
    let found = load_path(&folder.rooted(), "all.rig").map(|loaded| loaded.name);
    assert_eq!(
        found.map_err(|error| error.to_string()),
        Err(wanted.to_owned())
    );
}

#[test]
fn a_fault_in_a_file_that_was_found_names_it_as_a_request_would() {
    let folder = Folder::new("list-fault");
    std::fs::write(folder.root().join("sub/a.morph"), "positions x").expect("it is ours");
    let wanted =
        "./sub/a.morph:1:11: expected a whole number from 0 after `positions`, but found `x`";
    let found = load_path(&folder.rooted(), "./all.rig").map(|loaded| loaded.name);
    assert_eq!(
        found.map_err(|error| error.to_string()),
        Err(wanted.to_owned())
    );
}

#[test]
fn two_files_of_one_name_that_differ_are_not_part_of_one_rig() {
    let folder = Folder::new("names");
    let write = |file: &str, text: &str| {
        std::fs::write(folder.root().join(file), text).expect("the temporary folder is ours");
    };
    std::fs::create_dir_all(folder.root().join("other")).expect("the temporary folder is ours");
    write("one.morph", "positions 1 { 0 1 1 1 }");
    write("other/one.morph", "positions 1 { 0 2 2 2 }");
    write(
        "both.rig",
        "rig a { skin skin.skin morphs 2 { one.morph other/one.morph } }",
    );
    let wanted = "other: both.rig:1:45: expected `other/one.morph` to be a CSE 169 morph target, \
        but found that it may not be opened: another file of that name is part of the rig";
    assert_eq!(kind(load_path(&folder.rooted(), "both.rig")), wanted);
    // A picture is left out.
    std::fs::write(folder.root().join("other/skin.bmp"), [BMP, b"x"].concat())
        .expect("the temporary folder is ours");
    write("more.skin", &SKIN.replace("skin.bmp", "other/skin.bmp"));
    let paths = ["skin.skin", "more.skin"].map(|path| FileRef::Path(path.to_owned()));
    let rig = load(&paths, &folder.rooted(), &Limits::default())
        .expect("both are fine")
        .rig;
    let textures = rig
        .materials()
        .iter()
        .filter(|material| material.texture.is_some());
    assert_eq!((textures.count(), rig.warnings().len()), (1, 1));
    assert!(rig.warnings()[0].ends_with("another file of that name is part of the rig"));
}

#[test]
fn a_texture_outside_is_left_out_with_a_warning() {
    let folder = Folder::new("outside");
    let local = folder.root().join("sub/up.skin").display().to_string();
    for (source, path) in [(folder.rooted(), "sub/up.skin"), (Source::local(), &*local)] {
        let rig = load_path(&source, path).expect("the skin is fine").rig;
        assert!(rig.materials()[0].texture.is_none());
        let wanted = format!(
            "{path}:1:60: the texture `../../secret.skel` is left out: \
             it leads out of the folder that files are read from"
        );
        assert_eq!(rig.warnings(), [wanted]);
    }
}

#[test]
fn the_bytes_of_all_files_together_are_held_to_their_limit() {
    let folder = Folder::new("limit");
    let inline = FileRef::Inline(File {
        name: "a.bmp".to_owned(),
        bytes: BMP.into(),
    });
    let path = |path: &str| FileRef::Path(path.to_owned());
    let [skel, skin, picture] = [SKEL.len(), SKIN.len(), BMP.len()].map(|bytes| bytes as u64);
    let [list, morph] = [LIST.len(), MORPH.len()].map(|bytes| bytes as u64);
    let limits = |rig_file_bytes| Limits {
        rig_file_bytes,
        ..Limits::default()
    };
    for (files, bytes) in [
        (vec![path("good.skel")], skel),
        (vec![path("good.skel"), inline.clone()], skel + picture),
        (vec![inline, path("good.skel")], skel + picture),
        // What a list names counts.
        (vec![path("all.rig")], list + morph + skin),
    ] {
        assert!(
            load(&files, &folder.rooted(), &limits(bytes)).is_ok(),
            "{files:?}"
        );
        let result = load(&files, &folder.rooted(), &limits(bytes - 1));
        let wanted = LimitExceeded {
            limit: "rig_file_bytes",
            maximum: bytes - 1,
            asked: bytes,
        };
        assert!(
            matches!(result, Err(LoadError::Limit(found)) if found == wanted),
            "{files:?}"
        );
    }
    // The texture that a skin refers to counts, and is left out where it is too much.
    for (bytes, warnings) in [(skin + picture, 0), (skin + picture - 1, 1)] {
        let rig = load(&[path("skin.skin")], &folder.rooted(), &limits(bytes));
        let rig = rig.expect("a texture may be missing").rig;
        assert_eq!(rig.warnings().len(), warnings);
        assert_eq!(rig.materials()[0].texture.is_none(), warnings == 1);
    }
}

#[test]
fn a_file_too_large_is_refused_before_it_is_read() {
    let folder = Folder::new("large");
    // A hole: it takes no room on the disk, and would take hours to read.
    let bytes = 1 << 40;
    let file = std::fs::File::create(folder.root().join("skin.bmp"));
    if !file.is_ok_and(|file| file.set_len(bytes).is_ok()) {
        println!("left out: files with holes cannot be made here");
        return;
    }
    let result = load_path(&folder.rooted(), "skin.bmp");
    assert!(matches!(result, Err(LoadError::Limit(found)) if found.asked == bytes));
    let rig = load_path(&folder.rooted(), "skin.skin").expect("a texture may be missing");
    let asked = bytes + SKIN.len() as u64;
    let reason = format!("the texture `skin.bmp` is left out: {asked} exceeds the limit");
    assert!(rig.rig.warnings()[0].contains(&reason));
}

#[test]
fn a_file_is_found_in_another_case_and_behind_backslashes() {
    let folder = Folder::new("case");
    let write = |file: &str, content: &[u8]| {
        std::fs::write(folder.root().join(file), content).expect("the temporary folder is ours");
    };
    write("sub/Head.BMP", BMP);
    for (name, found) in [
        ("SKIN.BMP", "skin.bmp"),
        ("sub/head.bmp", "sub/Head.BMP"),
        ("Sub\\Head.BMP", "sub/Head.BMP"),
    ] {
        write("a.skin", SKIN.replace("skin.bmp", name).as_bytes());
        let local = folder.root().join("a.skin").display().to_string();
        for (source, path) in [(folder.rooted(), "a.skin"), (Source::local(), &*local)] {
            let loaded = load_path(&source, path).expect("the skin is fine");
            let wanted = format!("{path}: the file `{name}` is taken for `{found}`");
            assert_eq!(loaded.rig.warnings(), [wanted]);
            let texture = loaded.rig.materials()[0].texture.as_ref();
            assert!(found.ends_with(texture.expect("it is found").texture.file()));
        }
    }
    // Of several in other cases none is meant more than another.
    write("a.skin", SKIN.replace("skin.bmp", "SKIN.BMP").as_bytes());
    write("Skin.bmp", BMP);
    let rig = load_path(&folder.rooted(), "a.skin")
        .expect("the skin is fine")
        .rig;
    assert!(rig.warnings()[0].ends_with("the texture `SKIN.BMP` is left out: it was not found"));
    // Neither folders above nor links lead out.
    for name in ["../SECRET.skel", "ESCAPE.skel"] {
        write("a.skin", SKIN.replace("skin.bmp", name).as_bytes());
        let rig = load_path(&folder.rooted(), "a.skin")
            .expect("the skin is fine")
            .rig;
        assert!(rig.materials()[0].texture.is_none(), "{name}");
    }
}

#[test]
fn a_list_and_a_request_know_files_in_another_case_as_well() {
    let folder = Folder::new("listed");
    let list = "rig a { skin \"SKIN.skin\" morphs 1 { \"sub/A.morph\" } }";
    std::fs::write(folder.root().join("b.rig"), list).expect("the temporary folder is ours");
    let loaded = load_path(&folder.rooted(), "b.rig").expect("all are there");
    let warnings = [("SKIN.skin", "skin.skin"), ("sub/A.morph", "sub/a.morph")]
        .map(|(name, found)| format!("b.rig: the file `{name}` is taken for `{found}`"));
    assert_eq!(loaded.rig.warnings(), warnings);
    let sent = FileRef::Inline(File {
        name: "Skin.BMP".to_owned(),
        bytes: BMP.into(),
    });
    let inline = FileRef::Inline(File {
        name: "a.skin".to_owned(),
        bytes: SKIN.as_bytes().into(),
    });
    let rig = load(&[inline, sent], &Source::inline_only(), &Limits::default());
    let wanted = "a.skin: the file `skin.bmp` is taken for `Skin.BMP`";
    assert_eq!(rig.expect("both are there").rig.warnings(), [wanted]);
}

#[test]
fn a_texture_found_counts_in_the_digest_as_one_that_was_sent() {
    let folder = Folder::new("digest");
    let skin = FileRef::Path("skin.skin".to_owned());
    let sent = FileRef::Inline(File {
        name: "skin.bmp".to_owned(),
        bytes: BMP.into(),
    });
    let digest = |files: &[FileRef]| {
        let loaded = load(files, &folder.rooted(), &Limits::default());
        loaded.expect("the skin is fine").digest
    };
    let found = digest(std::slice::from_ref(&skin));
    assert_eq!(found, digest(&[skin.clone(), sent]));
    std::fs::write(folder.root().join("skin.bmp"), "BM2").expect("the temporary folder is ours");
    assert_ne!(found, digest(&[skin]));
}

#[test]
fn a_file_that_grows_while_it_is_read_is_noticed() {
    // Its size is told as 0.
    let path = Path::new("/proc/self/status");
    if !path.exists() {
        println!("left out: there is no {}", path.display());
        return;
    }
    let limits = Limits {
        rig_file_bytes: 10,
        ..Limits::default()
    };
    let read = Source::local().read("/proc/self/status", &mut Budget::new(&limits));
    assert!(matches!(
        read,
        Err(Denied::Limit(LimitExceeded { asked: 11, .. }))
    ));
}
