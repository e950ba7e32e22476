//! Animations in small files: slopes, what is warned of, what is refused and where.

use super::read;
use crate::formats::contribution::LooseClip;
use crate::formats::text::lexer::Lexer;
use crate::limits::{LimitExceeded, Limits};
use crate::rig::{Axis, ChannelDraft, ChannelTarget, Curve, DofKind, Extrapolation, Warnings};

fn clip(text: &str) -> Result<(LooseClip, Vec<String>), String> {
    let mut warnings = Warnings::default();
    let lexer = Lexer::new("a.anim", text);
    read(lexer, &Limits::default(), &mut warnings)
        .map(|clip| (clip, warnings.into_sentences()))
        .map_err(|error| error.to_string())
}

/// An animation of six channels, of which the first has these keys and the others none.
fn with_keys(keys: &str) -> String {
    let rest = "channel { keys 0 { } }\n".repeat(5);
    let extrapolate = "extrapolate cycle linear";
    format!(
        "animation {{\n range 0 2\n numchannels 6\n channel {{ {extrapolate}\n keys {keys}\n }}\n {rest}}}"
    )
}

fn slopes(keys: &str) -> Vec<[f64; 2]> {
    let (clip, warnings) = clip(&with_keys(keys)).expect(keys);
    assert_eq!(warnings, [""; 0], "{keys}");
    let keys = curve(&clip, 0).keys.iter();
    keys.map(|key| [key.slope_in, key.slope_out]).collect()
}

#[test]
fn every_word_for_a_tangent_becomes_a_slope() {
    // Lines of slope 2, then -1: from (0, 0) to (1, 2) to (3, 0).
    for (word, wanted) in [
        ("flat", [[0.0; 2]; 3]),
        ("linear", [[2.0, 2.0], [2.0, -1.0], [-1.0, -1.0]]),
        ("smooth", [[2.0, 2.0], [0.0, 0.0], [-1.0, -1.0]]),
        ("-.75", [[-0.75; 2]; 3]),
    ] {
        let keys = format!("3 {{ 0 0 {word} {word} 1 2 {word} {word} 3 0 {word} {word} }}");
        assert_eq!(slopes(&keys), wanted, "{word}");
    }
    let mixed = "3 { 0 0 flat linear 1 2 smooth 4 3 3 13.7 -0.22 }";
    assert_eq!(slopes(mixed), [[0.0, 2.0], [1.0, 4.0], [13.7, -0.22]]);
    assert_eq!(slopes("1 { 5 7 linear smooth }"), [[0.0, 0.0]]);
    assert_eq!(slopes("1 { 5 7 3 flat }"), [[3.0, 0.0]]);
    assert_eq!(slopes("0 { }"), [[0.0; 2]; 0]);
}

#[test]
fn channels_set_the_roots_place_and_then_each_joints_angles() {
    let text = "animation{range -1 4.5 numchannels 9\r\n\
        channel 0{extrapolate constant linear keys 1{0 10 flat flat}} channel 1{keys 0{}}\r\
        channel 2{extrapolate cycle cycle_offset keys 0{}}channel{extrapolate bounce bounce keys 0{}}\
        channel 4{keys 1{-2 14 flat flat}}channel 5{keys 0{}}channel 6 { keys 0 { } }\
        channel{keys 0{}}channel{keys 1{0 18 flat flat}}}";
    let (clip, warnings) = clip(text).expect("it is an animation");
    assert_eq!(warnings, [""; 0]);
    assert_eq!(clip.clip.range, [-1.0, 4.5]);
    let targets: Vec<_> = clip.clip.channels.iter().map(target).collect();
    let place = Axis::ALL.map(|axis| DofKind::Translation { joint: 0, axis });
    let angles = [0, 1].map(|joint| Axis::ALL.map(|axis| DofKind::Rotation { joint, axis }));
    assert_eq!(targets, [&place[..], angles.as_flattened()].concat());
    let modes = |channel: usize| {
        let curve = curve(&clip, channel);
        (curve.before, curve.after)
    };
    use Extrapolation::{Bounce, Constant, Cycle, CycleOffset, Linear};
    assert_eq!(modes(0), (Constant, Linear));
    assert_eq!(modes(1), (Constant, Constant));
    assert_eq!(modes(2), (Cycle, CycleOffset));
    assert_eq!(modes(3), (Bounce, Bounce));
    let value = |channel: usize| curve(&clip, channel).at(0.0);
    assert_eq!((value(0), value(4), value(8)), (10.0, 14.0, 18.0));
}

#[test]
fn what_is_odd_in_an_animation_is_worked_with() {
    let sound = with_keys("1 { 0 1 flat flat }");
    for (piece, by, warning) in [
        (
            "range 0",
            "fps 30 range 0",
            "a.anim:2:2: skipped `fps`, which is not known here",
        ),
        (
            "extrapolate",
            "weight 1 extrapolate",
            "a.anim:4:12: skipped `weight`, which is not known here",
        ),
        (
            "channel { extrapolate",
            "channel 3 { extrapolate",
            "a.anim:4:10: this is channel 0, not 3; the order counts",
        ),
    ] {
        let text = sound.replace(piece, by);
        let (clip, warnings) = clip(&text).expect(&text);
        assert_eq!(curve(&clip, 0).keys.len(), 1, "{text}");
        assert_eq!(warnings, [warning], "{text}");
    }
    let (_, warnings) = clip(&format!("{sound} }}")).expect("it goes on after its end");
    assert_eq!(
        warnings,
        ["a.anim:12:3: what follows the `animation` is not used"]
    );
}

#[test]
fn what_is_wrong_in_an_animation_is_told_where_it_is() {
    let sound = with_keys("2 { 0 1 flat flat 1 2 flat flat }");
    assert!(clip(&sound).is_ok());
    for (piece, by, wanted) in [
        (
            "animation {",
            "{",
            "1:1: expected `animation`, but found `{`",
        ),
        (
            "animation {",
            "animation",
            "2:2: expected `{` after `animation`, but found `range`",
        ),
        (
            "range 0 2",
            "range 3 2",
            "2:8: expected the earlier time first after `range`, but found 3 and 2",
        ),
        (
            "range 0 2",
            "range 0 2e9",
            "2:10: expected a number of at most 1e9 in size after `range`, but found `2e9`",
        ),
        (
            "range 0 2",
            "range 0 2 range 0 2",
            "2:12: expected `range` once, but found a second one",
        ),
        ("range 0 2", "", "12:1: expected `range`, but found `}`"),
        (
            "numchannels 6",
            "numchannels",
            "4:2: expected a whole number from 0 after `numchannels`, but found `channel`",
        ),
        (
            "numchannels 6",
            "",
            "4:2: expected `numchannels` before the first `channel`, but found `channel`",
        ),
        (
            "numchannels 6",
            "numchannel 6",
            "3:2: expected `numchannels` before the first `channel`, but found `numchannel`",
        ),
        (
            "numchannels 6",
            "numchannels 6 numchannels 6",
            "3:16: expected `numchannels` once, but found a second one",
        ),
        (
            "numchannels 6",
            "numchannels 7",
            "12:1: expected 7 channels as announced, but found `}` after 6",
        ),
        (
            "numchannels 6",
            "numchannels 1",
            "7:2: expected `}` after 1 channel as announced, but found `channel`: 6 channels in all",
        ),
        (
            "channel { extrapolate",
            "channel x { extrapolate",
            "4:10: expected a whole number from 0 or `{` after `channel`, but found `x`",
        ),
        (
            "channel { extrapolate",
            "channel 0 0 { extrapolate",
            "4:12: expected `{` after `channel 0`, but found `0`",
        ),
        (
            "cycle linear",
            "cycle",
            "5:2: expected `constant`, `linear`, `cycle`, `cycle_offset` or `bounce` twice after `extrapolate`, but found `keys`",
        ),
        (
            "cycle linear",
            "cycle linear extrapolate",
            "4:37: expected `extrapolate` once, but found a second one",
        ),
        (
            "keys 2 {",
            "keyframes 2 {",
            "6:2: expected `keys` in channel 0, but found `}`",
        ),
        (
            "keys 2 {",
            "keys 0 { } keys 2 {",
            "5:13: expected `keys` once, but found a second one",
        ),
        (
            "keys 2 {",
            "keys 3 {",
            "5:39: expected 3 keys as announced, but found `}` after 2",
        ),
        (
            "keys 2 {",
            "keys 1 {",
            "5:25: expected `}` after 1 key as announced, but found `1`: 2 keys in all",
        ),
        (
            "1 2 flat flat }",
            "1 2 flat }",
            "5:34: expected 2 keys as announced, but found `}` after 1",
        ),
        (
            "1 2 flat flat }",
            "0 2 flat flat }",
            "5:25: expected a time after 0 in key 1, but found `0`",
        ),
        (
            "1 2 flat flat }",
            "-1e-9 2 flat flat }",
            "5:25: expected a time after 0 in key 1, but found `-1e-9`",
        ),
        (
            "1 2 flat flat }",
            "1 2 spline flat }",
            "5:29: expected `flat`, `linear`, `smooth` or a number in key 1, but found `spline`",
        ),
        (
            "1 2 flat flat }",
            "1 2 flat nan }",
            "5:34: expected `flat`, `linear`, `smooth` or a number in key 1, but found `nan`",
        ),
        (
            "1 2 flat flat }",
            "1 x flat flat }",
            "5:27: expected a number in key 1, but found `x`",
        ),
        (
            "1 2 flat flat }",
            "1e-300 2 linear flat }",
            "5:25: expected slopes of at most 1e9 in key 1, but found one of 1.0e300",
        ),
    ] {
        assert!(sound.contains(piece), "{piece}");
        let text = sound.replacen(piece, by, 1);
        let found = clip(&text).map(|_| ());
        assert_eq!(found, Err(format!("a.anim:{wanted}")), "{text}");
    }
}

#[test]
fn an_animation_that_ends_early_says_what_is_missing() {
    for (text, wanted) in [
        (
            "",
            "1:1: expected `animation`, but found the end of the file",
        ),
        (
            "animation { numchannels 1",
            "1:26: expected 1 channel as announced, but found the end of the file after 0",
        ),
        (
            "animation { range 0 1 numchannels 0\n",
            "2:1: expected `}` to end the `animation` at 1:1, but found the end of the file",
        ),
        (
            "animation { numchannels 1 channel { keys 0 { }",
            "1:47: expected `}` to end the `channel` at 1:27, but found the end of the file",
        ),
        (
            "animation { numchannels 1 channel { keys 1 { 0 1 flat ",
            "1:55: expected 1 key as announced, but found the end of the file after 0",
        ),
    ] {
        let found = clip(text).map(|_| ());
        assert_eq!(found, Err(format!("a.anim:{wanted}")), "{text}");
    }
}

#[test]
fn keys_of_all_channels_are_held_to_their_limit() {
    let text = "animation { range 0 1 numchannels 2 channel { keys 1 { 0 1 flat flat } } channel { keys 2 {";
    let limits = Limits {
        keys: 2,
        ..Limits::default()
    };
    let lexer = Lexer::new("a.anim", text);
    let found = read(lexer, &limits, &mut Warnings::default());
    let wanted = LimitExceeded {
        limit: "keys",
        maximum: 2,
        asked: 3,
    };
    assert!(matches!(found, Err(crate::formats::LoadError::Limit(exceeded)) if exceeded == wanted));
}

fn curve(clip: &LooseClip, channel: usize) -> &Curve<f64> {
    match &clip.clip.channels[channel] {
        ChannelDraft::Dof { curve, .. } => curve,
        ChannelDraft::Rotation { .. } => panic!("every channel sets a DOF"),
    }
}

fn target(channel: &ChannelDraft) -> DofKind {
    match channel {
        ChannelDraft::Dof {
            target: ChannelTarget::Dof(dof),
            ..
        } => *dof,
        _ => panic!("every channel sets a DOF"),
    }
}
