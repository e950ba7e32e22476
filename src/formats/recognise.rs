//! Which reader a file is for: its content decides, its extension is a hint where two dialects look alike.
//! Never lives here: reading past the first word.

use super::error::{FileFault, quoted};
use super::text::without_bom;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Cse169Skel,
    Cse169Skin,
    /// A picture perhaps, if a file refers to it.
    Other,
}

pub(super) const EXPECTED: &str = "a CSE 169 skeleton (`.skel`) or skin (`.skin`)";

/// # Errors
/// [`FileFault`] for a rig file of a kind that is known by name only.
pub(super) fn recognise(file: &str, bytes: &[u8]) -> Result<Kind, FileFault> {
    let word = first_word(bytes);
    let extension = extension(file);
    let unsupported = |what: &str| {
        let found = format!("{what}, which is not supported");
        Err(FileFault::whole(file, EXPECTED, found))
    };
    let starts_a_number = word
        .iter()
        .find(|byte| !b"+-.".contains(byte))
        .is_some_and(u8::is_ascii_digit);
    match (extension.as_str(), word) {
        (_, b"balljoint" | b"joint") => Ok(Kind::Cse169Skel),
        // The two look alike at first: both open with `positions`.
        ("morph", _) => unsupported("a morph target"),
        (
            _,
            b"positions" | b"normals" | b"texcoords" | b"skinweights" | b"triangles" | b"bindings"
            | b"material",
        ) => Ok(Kind::Cse169Skin),
        ("skel" | "skin" | "anim" | "", b"animation") | ("anim", _) => unsupported("an animation"),
        ("skel" | "skin" | "", b"rig") | ("rig", _) => unsupported("a `.rig` list of files"),
        ("gltf" | "glb", _) => unsupported("a glTF file"),
        _ if bytes.starts_with(b"glTF") => unsupported("a glTF file"),
        ("obj", _) => unsupported("an OBJ mesh"),
        ("attach", _) => unsupported("a MIT 6.837 attachment list"),
        ("skel" | "skin", _) if word.starts_with(b"<") => {
            unsupported("XML (DART keeps skeletons in it)")
        }
        ("skel", _) if starts_a_number => unsupported("a MIT 6.837 skeleton"),
        ("skel", _) => Ok(Kind::Cse169Skel),
        ("skin", _) => Ok(Kind::Cse169Skin),
        _ => Ok(Kind::Other),
    }
}

/// What a file that no reader takes looks like.
pub(super) fn describe(bytes: &[u8]) -> String {
    let pictures: [(&[u8], &str); 4] = [
        (b"BM", "a BMP picture"),
        (b"\x89PNG", "a PNG picture"),
        (b"\xFF\xD8\xFF", "a JPEG picture"),
        (b"GIF8", "a GIF picture"),
    ];
    if let Some((_, what)) = pictures.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return (*what).to_owned();
    }
    match std::str::from_utf8(first_word(bytes)) {
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

fn first_word(bytes: &[u8]) -> &[u8] {
    let bytes = without_bom(bytes);
    let separates = |byte: &u8| (1..=b' ').contains(byte);
    let start = bytes
        .iter()
        .position(|byte| !separates(byte))
        .unwrap_or(bytes.len());
    let word = &bytes[start..];
    let end = word
        .iter()
        .position(|byte| separates(byte) || b"{}".contains(byte));
    &word[..end.unwrap_or(word.len())]
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
            // Left to the readers, which say what is wrong and where.
            ("a.skel", b"", Kind::Cse169Skel),
            ("a.skel", b"\xFF\xFEb\0", Kind::Cse169Skel),
            ("a.skin", b"version 1 positions", Kind::Cse169Skin),
            ("a.bmp", b"BM\0\0", Kind::Other),
            ("readme.txt", b"rig files", Kind::Other),
            ("skel", b"1 2 3", Kind::Other),
        ] {
            assert_eq!(recognise(file, bytes), Ok(wanted), "{file} {bytes:?}");
        }
    }

    #[test]
    fn other_rig_files_are_refused_by_name() {
        for (file, bytes, wanted) in [
            ("a.skel", &b"0.5 0.75 0.5 -1"[..], "a MIT 6.837 skeleton"),
            ("a.skel", b"-.5 0 0 -1", "a MIT 6.837 skeleton"),
            (
                "a.skel",
                b"<?xml version",
                "XML (DART keeps skeletons in it)",
            ),
            ("a.anim", b"animation {", "an animation"),
            ("walk", b"animation {", "an animation"),
            ("a.rig", b"rig wasp {", "a `.rig` list of files"),
            ("a.morph", b"positions 3 {", "a morph target"),
            ("a.obj", b"v 1 2 3", "an OBJ mesh"),
            ("a.attach", b"0 1", "a MIT 6.837 attachment list"),
            ("a.glb", b"glTF", "a glTF file"),
            ("a", b"glTF", "a glTF file"),
        ] {
            let found = recognise(file, bytes).map_err(|fault| (fault.line, fault.found));
            let wanted = format!("{wanted}, which is not supported");
            assert_eq!(found, Err((1, wanted)), "{file}");
        }
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
