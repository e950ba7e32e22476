//! The table of readers: what rigd reads. A format is a folder, or a file of one, and a row here.
//! Never lives here: how any of them reads.

use super::format::Format;
use super::reader::Reader;
use super::recognise::Formats;
use super::{cse169, gltf, mit, obj};

/// In the order of [`FORMATS`](super::FORMATS).
pub(super) static READERS: [&Reader; 9] = [
    &cse169::SKEL,
    &cse169::SKIN,
    &cse169::MORPH,
    &cse169::ANIM,
    &cse169::RIG,
    &mit::SKEL,
    &obj::OBJ,
    &mit::ATTACH,
    &gltf::GLTF,
];

/// The formats of all readers.
pub(super) static TABLE: Formats = Formats(&formats());

/// Their names.
pub(super) const NAMES: [&str; READERS.len()] = names();

pub(super) fn reader_of(format: &Format) -> Option<&'static Reader> {
    READERS.into_iter().find(|reader| reader.format == format)
}

const fn formats() -> [&'static Format; READERS.len()] {
    let mut formats = [READERS[0].format; READERS.len()];
    let mut row = 0;
    while row < READERS.len() {
        formats[row] = READERS[row].format;
        row += 1;
    }
    formats
}

const fn names() -> [&'static str; READERS.len()] {
    let mut names = [""; READERS.len()];
    let mut row = 0;
    while row < READERS.len() {
        names[row] = READERS[row].format.name;
        row += 1;
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides_and_the_extension_helps() {
        for (file, bytes, wanted) in [
            ("a.skel", &b"balljoint root {"[..], "cse169 skel"),
            ("a.txt", b"\xEF\xBB\xBF\r\n balljoint{", "cse169 skel"),
            ("a.skin", b"joint root {", "cse169 skel"),
            ("a.skel", b"positions 3 {", "cse169 skin"),
            ("A.SKIN", b"material {", "cse169 skin"),
            ("a", b"bindings 3", "cse169 skin"),
            ("a.morph", b"triangles 3", "cse169 skin"),
            ("a.MORPH", b"positions 3 {", "cse169 morph"),
            ("a.txt", b"animation{", "cse169 anim"),
            ("a.txt", b"rig wasp {", "cse169 rig"),
            ("a", b"rig{", "cse169 rig"),
            ("a.skel", b"0.5 0.75 0.5 -1", "mit6837 skel"),
            ("a.skel", b"-.5 0 0 -1", "mit6837 skel"),
            ("a.skel", b"# my model\n0 0 0 -1", "mit6837 skel"),
            ("a.skel", b"/* joint */ // x\r;\r 1 2 3 -1", "mit6837 skel"),
            ("a.txt", b"# wasp\njoint a {", "cse169 skel"),
            ("a.txt", b"BallJoint a {", "cse169 skel"),
            ("a.txt", b"Positions 3 {", "cse169 skin"),
            ("a.txt", b"rig//x\n", ""),
            ("a.txt", b"rig // x\n a {", "cse169 rig"),
            ("a.txt", b"/* joint", ""),
            ("a.obj", b"# positions\nv 1 2 3", "obj"),
            ("a.obj", b"v 1 2 3", "obj"),
            ("a.attach", b"0 1", "mit6837 attach"),
            // Left to the readers, which say what is wrong and where.
            ("a.skel", b"", "cse169 skel"),
            ("a.skel", b"\xFF\xFEb\0", "cse169 skel"),
            ("a.skin", b"version 1 positions", "cse169 skin"),
            ("a.morph", b"1 2 3", "cse169 morph"),
            ("a.anim", b"idle.pos", "cse169 anim"),
            ("a.rig", b"", "cse169 rig"),
            ("a.glb", b"glTF", "gltf"),
            ("a.GLTF", b"{", "gltf"),
            ("a", b"glTF", "gltf"),
            ("a.bmp", b"BM\0\0", ""),
            ("readme.txt", b"rig files", ""),
            ("readme.txt", b"animation of a wasp", ""),
            ("skel", b"1 2 3", ""),
        ] {
            let found = TABLE.recognise(file, bytes).format();
            let found = found.map_or("", |format| format.name);
            assert_eq!(found, wanted, "{file} {bytes:?}");
        }
    }

    #[test]
    fn other_rig_files_are_known_by_name() {
        let bytes = b"<?xml version";
        let found = TABLE.recognise("a.skel", bytes).described(bytes);
        let wanted = "XML (DART keeps skeletons in it), which is not supported";
        assert_eq!(found, wanted);
    }

    #[test]
    fn no_two_formats_have_one_name() {
        let mut names = NAMES.to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), READERS.len());
    }
}
