//! Parts of file names. Never lives here: opening files.

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

/// What follows the last dot, in lower case.
pub(super) fn extension(file: &str) -> String {
    let base = base_name(file);
    let extension = base.rsplit_once('.').map_or("", |(_, extension)| extension);
    extension.to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cut_at_slashes_and_dots() {
        for (file, base, the_stem, the_extension) in [
            ("wasp/wasp.skel", "wasp.skel", "wasp", "skel"),
            ("C:\\rigs\\a.b.SKEL", "a.b.SKEL", "a.b", "skel"),
            (".skel", ".skel", ".skel", "skel"),
            ("noext", "noext", "noext", ""),
            ("dir/", "", "", ""),
        ] {
            let found = (base_name(file), stem(file), &*extension(file));
            assert_eq!(found, (base, the_stem, the_extension));
        }
    }
}
