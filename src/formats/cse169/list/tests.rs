//! Lists of files: what is listed, what is warned of, what is refused and where.

use super::read;
use crate::formats::text::lexer::Lexer;
use crate::limits::Limits;
use crate::rig::Warnings;

/// The name of each entry's format and its file.
type Listed = Vec<(&'static str, String)>;

fn list(text: &str) -> Result<(Listed, Vec<String>), String> {
    let mut warnings = Warnings::default();
    let limits = Limits {
        morph_targets: 10,
        ..Limits::default()
    };
    let entries = read(Lexer::new("a.rig", text), &limits, &mut warnings);
    let entries = entries.map_err(|error| error.to_string())?;
    let entries = entries
        .into_iter()
        .map(|entry| (entry.format.name, entry.file));
    Ok((entries.collect(), warnings.into_sentences()))
}

#[test]
fn entries_come_in_any_order_and_each_may_be_missing() {
    let entry = |role, file: &str| (role, file.to_owned());
    let (skeleton, skin) = (
        entry("cse169 skel", "a.skel"),
        entry("cse169 skin", "a.skin"),
    );
    let morphs = [
        entry("cse169 morph", "1.morph"),
        entry("cse169 morph", "morph"),
    ];
    for (text, wanted) in [
        (
            "rig a {\r\n\tskeleton a.skel\r\n\tskin a.skin\r\n\tmorphs 0 {\r\n\t}\r\n}\r\n",
            vec![skeleton.clone(), skin.clone()],
        ),
        (
            "rig{skin a.skin skeleton a.skel}",
            vec![skin.clone(), skeleton],
        ),
        ("rig a { skin a.skin }", vec![skin]),
        ("rig a { morphs 2 { 1.morph morph } }", morphs.to_vec()),
        (
            "rig a { morphs 2{morph 1.morph morph morph} }",
            morphs.to_vec(),
        ),
    ] {
        assert_eq!(list(text), Ok((wanted, vec![])), "{text}");
    }
}

#[test]
fn what_is_odd_in_a_list_is_worked_with() {
    for (text, warning) in [
        (
            "rig a { texture a.bmp skin a.skin }",
            "a.rig:1:9: skipped `texture`, which is not known here",
        ),
        (
            "rig a { skin a.skin }\n}",
            "a.rig:2:1: what follows the `rig` is not used",
        ),
    ] {
        let wanted = vec![("cse169 skin", "a.skin".to_owned())];
        assert_eq!(list(text), Ok((wanted, vec![warning.to_owned()])));
    }
}

#[test]
fn what_is_wrong_in_a_list_is_told_where_it_is() {
    for (text, wanted) in [
        ("", "1:1: expected `rig`, but found the end of the file"),
        ("rigs {", "1:1: expected `rig`, but found `rigs`"),
        (
            "rig a b {",
            "1:7: expected `{` after `rig a`, but found `b`",
        ),
        (
            "rig a { }",
            "1:9: expected `skeleton`, `skin` or `morphs` with a file's name, but found `}`",
        ),
        (
            "rig a { skeletn a.skel }",
            "1:9: expected `skeleton`, `skin` or `morphs` with a file's name, but found `skeletn`",
        ),
        (
            "rig a { skin a.skin Skin \"b c.skin\" }",
            "1:21: expected `skin` once, but found a second one",
        ),
        (
            "rig a { morphs 0 { }\n}",
            "2:1: expected `skeleton`, `skin` or `morphs` with a file's name, but found `}`",
        ),
        (
            "rig a { skin a.skin",
            "1:20: expected `}` to end the `rig`, but found the end of the file",
        ),
        (
            "rig a { skin }",
            "1:14: expected a file name after `skin`, but found `}`",
        ),
        (
            "rig a { skin a.skin skin b.skin }",
            "1:21: expected `skin` once, but found a second one",
        ),
        (
            "rig a { morphs 0 { } morphs 0 { } }",
            "1:22: expected `morphs` once, but found a second one",
        ),
        (
            "rig a { morphs 2 { a.morph } }",
            "1:28: expected 2 morph targets as announced, but found `}` after 1",
        ),
        (
            "rig a { morphs 1 { a.morph b.morph } }",
            "1:28: expected `}` after 1 morph target as announced, but found `b.morph`: 2 morph targets in all",
        ),
        (
            "rig a { morphs 1 a.morph }",
            "1:18: expected `{` after `morphs 1`, but found `a.morph`",
        ),
    ] {
        assert_eq!(list(text), Err(format!("a.rig:{wanted}")), "{text}");
    }
    let limit = "11 exceeds the limit `morph_targets` of 10";
    assert_eq!(list("rig a { morphs 11 {"), Err(limit.to_owned()));
}
