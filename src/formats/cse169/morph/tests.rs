//! Morph targets in small files: what is read, what is warned of, what is refused and where.

use super::read;
use crate::formats::contribution::KnownMesh;
use crate::formats::error::LoadError;
use crate::formats::text::lexer::Lexer;
use crate::limits::{LimitExceeded, Limits};
use crate::rig::{MorphDraft, Warnings};
use glam::Vec3;

const MORPH: &str = "\
positions 2 {\n 3 1 2 3\n 0 -1 .5 0\n}
normals 2 {\n 0 0 0 2\n 1 0 -1e-9 0\n}
";

fn read_with(limits: &Limits, text: &str) -> Result<(MorphDraft, Vec<String>), LoadError> {
    let mut warnings = Warnings::default();
    let mesh = KnownMesh {
        file: "a.skin",
        vertex_count: 4,
    };
    let morph = read(Lexer::new("a.morph", text), mesh, limits, &mut warnings)?;
    Ok((morph, warnings.into_sentences()))
}

fn morph(text: &str) -> Result<(MorphDraft, Vec<String>), String> {
    read_with(&Limits::default(), text).map_err(|error| error.to_string())
}

/// `MORPH` with one piece of it replaced.
fn changed(piece: &str, by: &str) -> String {
    assert_eq!(MORPH.matches(piece).count(), 1, "{piece} must stand once");
    MORPH.replace(piece, by)
}

#[test]
fn vertices_are_listed_in_any_order_and_normals_have_length_1() {
    let (morph, warnings) = morph(MORPH).expect("it is a morph target");
    let positions = [
        (3, Vec3::new(1.0, 2.0, 3.0)),
        (0, Vec3::new(-1.0, 0.5, 0.0)),
    ];
    assert_eq!(morph.positions, positions);
    assert_eq!(morph.normals, [(0, Vec3::Z), (1, -Vec3::Y)]);
    assert_eq!((morph.rest, warnings), (0.0, vec![]));
}

#[test]
fn normals_may_be_missing_and_sections_may_be_empty() {
    for (text, counts) in [
        ("positions 1 { 0 1 1 1 }", [1, 0]),
        ("positions 0 { }", [0, 0]),
        ("normals 1{0 0 0 1}positions 0{}", [0, 1]),
    ] {
        let (morph, warnings) = morph(text).expect(text);
        assert_eq!([morph.positions.len(), morph.normals.len()], counts);
        assert_eq!(warnings, [""; 0], "{text}");
    }
}

#[test]
fn what_is_odd_in_a_morph_target_is_worked_with() {
    for (text, normals, warning) in [
        (
            changed("1 0 -1e-9 0", "2 0 -0 0"),
            1,
            "a.morph:7:2: the normal of vertex 2 has no length; it stays as it is in the skin",
        ),
        (
            changed("positions", "name smile positions"),
            2,
            "a.morph:1:1: skipped `name`, which is not known here",
        ),
    ] {
        let (morph, warnings) = morph(&text).expect(&text);
        assert_eq!(morph.normals.len(), normals);
        assert_eq!(warnings, [warning]);
    }
}

#[test]
fn what_is_wrong_in_a_morph_target_is_told_where_it_is() {
    for (text, wanted) in [
        (
            String::new(),
            "1:1: expected `positions`, but found the end of the file",
        ),
        (
            "morph a".to_owned(),
            "1:1: expected `positions`, but found `morph`",
        ),
        (
            "normals 0 { } position 0 { }".to_owned(),
            "1:15: expected `positions`, but found `position`",
        ),
        (
            "normals 0 { }".to_owned(),
            "1:14: expected `positions`, but found the end of the file",
        ),
        (
            format!("{MORPH}positions 0 {{ }}"),
            "9:1: expected `positions` once, but found a second one",
        ),
        (
            changed("positions 2", "positions 3"),
            "4:1: expected 3 positions as announced, but found `}` after 2",
        ),
        (
            changed("positions 2", "positions 1"),
            "3:2: expected `}` after 1 position as announced, but found `0`: 2 positions in all",
        ),
        (
            changed("normals 2", "normals 3"),
            "8:1: expected 3 normals as announced, but found `}` after 2",
        ),
        (
            changed("3 1 2 3", "4 1 2 3"),
            "2:2: expected a vertex below 4, the number of positions in `a.skin`, in position 0, but found `4`",
        ),
        (
            changed("3 1 2 3", "99999999999999999999 1 2 3"),
            "2:2: expected a vertex below 4, the number of positions in `a.skin`, in position 0, but found `99999999999999999999`",
        ),
        (
            changed("0 -1 .5 0", "3 -1 .5 0"),
            "3:2: expected a vertex that was not listed before in position 1, but found `3`",
        ),
        (
            changed("1 0 -1e-9 0", "0 0 1 0"),
            "7:2: expected a vertex that was not listed before in normal 1, but found `0`",
        ),
        (
            changed("3 1 2 3", "-3 1 2 3"),
            "2:2: expected a whole number from 0 in position 0, but found `-3`",
        ),
        (
            changed("3 1 2 3", "3 1 2 3e9"),
            "2:8: expected a number of at most 1e9 in size in position 0, but found `3e9`",
        ),
        (
            changed("3 1 2 3", "3 1 nan 3"),
            "2:6: expected a number in position 0, but found `nan`",
        ),
        (
            changed("3 1 2 3", "3 1 2"),
            "3:4: expected a whole number from 0 in position 1, but found `-1`",
        ),
    ] {
        let found = morph(&text).map(|_| ());
        let found = found.map_err(|error| error.replacen("a.morph:", "", 1));
        assert_eq!(found, Err(wanted.to_owned()), "{text}");
    }
}

#[test]
fn vertices_of_both_sections_are_held_to_their_limit() {
    let limits = |morph_displacements| Limits {
        morph_displacements,
        ..Limits::default()
    };
    assert!(read_with(&limits(4), MORPH).is_ok());
    for (maximum, asked) in [(3, 4), (1, 2)] {
        let wanted = LimitExceeded {
            limit: "morph_displacements",
            maximum,
            asked,
        };
        let found = read_with(&limits(maximum), MORPH);
        assert!(matches!(found, Err(LoadError::Limit(exceeded)) if exceeded == wanted));
    }
}
