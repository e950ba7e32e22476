//! Which reader a file is for: its content decides, its extension is a hint where two dialects look alike.
//! Never lives here: reading past the first words.

use super::comments::{self, End};
use super::error::quoted;
use super::text::without_bom;
use std::ops::Range;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Cse169Skel,
    Cse169Skin,
    Cse169Morph,
    Cse169Anim,
    Cse169Rig,
    MitSkel,
    Obj,
    MitAttach,
    Gltf,
    /// Known by name only: what it is.
    Unsupported(&'static str),
    /// A picture perhaps, if a file refers to it.
    Other,
}

pub(super) const EXPECTED: &str = "a rig file (CSE 169 `.skel`, `.skin`, `.morph`, `.anim` or `.rig`, \
                                   MIT 6.837 `.skel` or `.attach`, `.obj`, or glTF 2.0 `.gltf` or `.glb`)";

impl Kind {
    /// Its reader, in the words of [`FORMATS`](super::FORMATS).
    pub(super) fn reader(self) -> Option<&'static str> {
        Some(match self {
            Self::Cse169Skel => "cse169 skel",
            Self::Cse169Skin => "cse169 skin",
            Self::Cse169Morph => "cse169 morph",
            Self::Cse169Anim => "cse169 anim",
            Self::Cse169Rig => "cse169 rig",
            Self::MitSkel => "mit6837 skel",
            Self::Obj => "obj",
            Self::MitAttach => "mit6837 attach",
            Self::Gltf => "gltf",
            Self::Unsupported(_) | Self::Other => return None,
        })
    }

    /// What a file of this kind is: `a CSE 169 skin`.
    pub(super) fn described(self, bytes: &[u8]) -> String {
        let what = match self {
            Self::Cse169Skel => "a CSE 169 skeleton",
            Self::Cse169Skin => "a CSE 169 skin",
            Self::Cse169Morph => "a CSE 169 morph target",
            Self::Cse169Anim => "a CSE 169 animation",
            Self::Cse169Rig => "a `.rig` list of files",
            Self::MitSkel => "a MIT 6.837 skeleton",
            Self::Obj => "an OBJ mesh",
            Self::MitAttach => "a MIT 6.837 attachment list",
            Self::Gltf => "a glTF document",
            Self::Unsupported(what) => return format!("{what}, which is not supported"),
            Self::Other => return describe_other(bytes),
        };
        what.to_owned()
    }
}

pub(super) fn recognise(file: &str, bytes: &[u8]) -> Kind {
    let words = first_words(bytes);
    // Readers take keywords in any case.
    let word = words[0].to_ascii_lowercase();
    let extension = extension(file);
    let starts_a_number = word
        .iter()
        .find(|byte| !b"+-.".contains(byte))
        .is_some_and(u8::is_ascii_digit);
    match (extension.as_str(), word.as_slice()) {
        (_, b"balljoint" | b"joint") => Kind::Cse169Skel,
        // The two look alike at first.
        ("morph", b"positions" | b"normals") => Kind::Cse169Morph,
        (
            _,
            b"positions" | b"normals" | b"texcoords" | b"skinweights" | b"triangles" | b"bindings"
            | b"material",
        ) => Kind::Cse169Skin,
        // Also words of plain language: what follows must look right as well.
        (_, b"animation") if words[1] == b"{" => Kind::Cse169Anim,
        (_, b"rig") if words[1..].contains(&&b"{"[..]) => Kind::Cse169Rig,
        ("gltf" | "glb", _) => Kind::Gltf,
        _ if bytes.starts_with(b"glTF") => Kind::Gltf,
        ("skel" | "skin", _) if word.starts_with(b"<") => {
            Kind::Unsupported("XML (DART keeps skeletons in it)")
        }
        ("skel", _) if starts_a_number => Kind::MitSkel,
        ("skel", _) => Kind::Cse169Skel,
        ("skin", _) => Kind::Cse169Skin,
        ("morph", _) => Kind::Cse169Morph,
        ("anim", _) => Kind::Cse169Anim,
        ("rig", _) => Kind::Cse169Rig,
        ("obj", _) => Kind::Obj,
        ("attach", _) => Kind::MitAttach,
        _ => Kind::Other,
    }
}

/// What a file that no reader takes looks like.
fn describe_other(bytes: &[u8]) -> String {
    let pictures: [(&[u8], &str); 4] = [
        (b"BM", "a BMP picture"),
        (b"\x89PNG", "a PNG picture"),
        (b"\xFF\xD8\xFF", "a JPEG picture"),
        (b"GIF8", "a GIF picture"),
    ];
    if let Some((_, what)) = pictures.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return (*what).to_owned();
    }
    let bytes = without_bom(bytes);
    match std::str::from_utf8(&bytes[word_from(bytes, 0)]) {
        Ok("") => "an empty file".to_owned(),
        Ok(word) if !word.contains('\0') => format!("a file that starts with {}", quoted(word)),
        _ => "a binary file".to_owned(),
    }
}

/// What follows the last slash, of either kind.
pub(super) fn base_name(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}

/// The base name up to its last dot.
pub(super) fn stem(file: &str) -> &str {
    let base = base_name(file);
    match base.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => base,
    }
}

fn extension(file: &str) -> String {
    let base = base_name(file);
    let extension = base.rsplit_once('.').map_or("", |(_, extension)| extension);
    extension.to_ascii_lowercase()
}

/// Behind comments. Braces are words of their own; past the end come empty ones.
fn first_words(bytes: &[u8]) -> [&[u8]; 3] {
    let bytes = without_bom(bytes);
    let mut at = 0;
    [(); 3].map(|()| {
        loop {
            let word = word_from(bytes, at);
            at = match comments::end(bytes, word.start) {
                Some(End::At(end)) => end,
                Some(End::Missing) => bytes.len(),
                None => {
                    at = word.end;
                    return &bytes[word];
                }
            };
        }
    })
}

/// The first word that starts at or after `at`.
fn word_from(bytes: &[u8], at: usize) -> Range<usize> {
    let separates = |byte: &u8| (1..=b' ').contains(byte);
    let blank = bytes[at..].iter().take_while(|byte| separates(byte));
    let start = at + blank.count();
    let word = &bytes[start..];
    let ends = |byte: &u8| separates(byte) || b"{}".contains(byte);
    let length = match word.first() {
        Some(b'{' | b'}') => 1,
        _ => word.iter().position(ends).unwrap_or(word.len()),
    };
    start..start + length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides_and_the_extension_helps() {
        for (file, bytes, wanted) in [
            ("a.skel", &b"balljoint root {"[..], Kind::Cse169Skel),
            ("a.txt", b"\xEF\xBB\xBF\r\n balljoint{", Kind::Cse169Skel),
            ("a.skin", b"joint root {", Kind::Cse169Skel),
            ("a.skel", b"positions 3 {", Kind::Cse169Skin),
            ("A.SKIN", b"material {", Kind::Cse169Skin),
            ("a", b"bindings 3", Kind::Cse169Skin),
            ("a.morph", b"triangles 3", Kind::Cse169Skin),
            ("a.MORPH", b"positions 3 {", Kind::Cse169Morph),
            ("a.txt", b"animation{", Kind::Cse169Anim),
            ("a.txt", b"rig wasp {", Kind::Cse169Rig),
            ("a", b"rig{", Kind::Cse169Rig),
            ("a.skel", b"0.5 0.75 0.5 -1", Kind::MitSkel),
            ("a.skel", b"-.5 0 0 -1", Kind::MitSkel),
            ("a.skel", b"# my model\n0 0 0 -1", Kind::MitSkel),
            ("a.skel", b"/* joint */ // x\r;\r 1 2 3 -1", Kind::MitSkel),
            ("a.txt", b"# wasp\njoint a {", Kind::Cse169Skel),
            ("a.txt", b"BallJoint a {", Kind::Cse169Skel),
            ("a.txt", b"Positions 3 {", Kind::Cse169Skin),
            ("a.txt", b"rig//x\n", Kind::Other),
            ("a.txt", b"rig // x\n a {", Kind::Cse169Rig),
            ("a.txt", b"/* joint", Kind::Other),
            ("a.obj", b"# positions\nv 1 2 3", Kind::Obj),
            ("a.obj", b"v 1 2 3", Kind::Obj),
            ("a.attach", b"0 1", Kind::MitAttach),
            // Left to the readers, which say what is wrong and where.
            ("a.skel", b"", Kind::Cse169Skel),
            ("a.skel", b"\xFF\xFEb\0", Kind::Cse169Skel),
            ("a.skin", b"version 1 positions", Kind::Cse169Skin),
            ("a.morph", b"1 2 3", Kind::Cse169Morph),
            ("a.anim", b"idle.pos", Kind::Cse169Anim),
            ("a.rig", b"", Kind::Cse169Rig),
            ("a.glb", b"glTF", Kind::Gltf),
            ("a.GLTF", b"{", Kind::Gltf),
            ("a", b"glTF", Kind::Gltf),
            ("a.bmp", b"BM\0\0", Kind::Other),
            ("readme.txt", b"rig files", Kind::Other),
            ("readme.txt", b"animation of a wasp", Kind::Other),
            ("skel", b"1 2 3", Kind::Other),
        ] {
            assert_eq!(recognise(file, bytes), wanted, "{file} {bytes:?}");
        }
    }

    #[test]
    fn other_rig_files_are_known_by_name() {
        let bytes = b"<?xml version";
        let found = recognise("a.skel", bytes).described(bytes);
        let wanted = "XML (DART keeps skeletons in it), which is not supported";
        assert_eq!(found, wanted);
    }

    #[test]
    fn names_are_cut_at_slashes_and_dots() {
        for (file, base, the_stem) in [
            ("wasp/wasp.skel", "wasp.skel", "wasp"),
            ("C:\\rigs\\a.b.skel", "a.b.skel", "a.b"),
            (".skel", ".skel", ".skel"),
            ("noext", "noext", "noext"),
            ("dir/", "", ""),
        ] {
            assert_eq!((base_name(file), stem(file)), (base, the_stem));
        }
    }
}
