//! The formats of the course, and how their files are recognised. Never lives here: reading them.

use super::skin;
use crate::formats::format::{Evidence, Format};

const FAMILY: &str = "CSE 169";

pub(super) static SKEL: Format = Format {
    name: "cse169 skel",
    family: FAMILY,
    extensions: &["skel"],
    what: "a CSE 169 skeleton",
    noun: "skeleton",
    sniff: |opening| {
        let is_own = matches!(&*opening.words[0], b"balljoint" | b"joint");
        is_own.then_some(Evidence::Content)
    },
};

pub(super) static SKIN: Format = Format {
    name: "cse169 skin",
    family: FAMILY,
    extensions: &["skin"],
    what: "a CSE 169 skin",
    noun: "skin",
    sniff: |opening| {
        let starts_with_section = skin::is_keyword(&opening.words[0]);
        starts_with_section.then_some(Evidence::Content)
    },
};

pub(super) static MORPH: Format = Format {
    name: "cse169 morph",
    family: FAMILY,
    extensions: &["morph"],
    what: "a CSE 169 morph target",
    noun: "morph target",
    sniff: |opening| {
        // A skin may start like this as well.
        let is_own = matches!(&*opening.words[0], b"positions" | b"normals");
        (is_own && opening.extension == "morph").then_some(Evidence::ContentAndExtension)
    },
};

pub(super) static ANIM: Format = Format {
    name: "cse169 anim",
    family: FAMILY,
    extensions: &["anim"],
    what: "a CSE 169 animation",
    noun: "animation",
    sniff: |opening| {
        // Also a word of plain language: what follows must look right as well.
        let is_own = opening.words[0] == b"animation" && opening.words[1] == b"{";
        is_own.then_some(Evidence::Content)
    },
};

pub(super) static RIG: Format = Format {
    name: "cse169 rig",
    family: FAMILY,
    extensions: &["rig"],
    what: "a `.rig` list of files",
    noun: "`.rig`",
    sniff: |opening| {
        let [first, others @ ..] = &opening.words;
        let is_own = first == b"rig" && others.iter().any(|word| word == b"{");
        is_own.then_some(Evidence::Content)
    },
};
