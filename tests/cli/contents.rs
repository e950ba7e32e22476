//! What a rig's files have for `render` and `inspect` beside joints and meshes: morph targets, clips, variants and lights.

use crate::{ADAPTER, apng_frames, drawn, folder, gif_frames, picture, render, rigd, text};
use std::sync::Once;

/// A square of two triangles on one joint, a morph target that moves one corner to the middle, and a clip that turns the joint. Written
/// once, since tests run side by side.
fn write_animated_rig() {
    static WRITTEN: Once = Once::new();
    WRITTEN.call_once(write_card);
}

fn write_card() {
    let skel = "balljoint root { }";
    let skin = "\
positions 4 { -1 -1 0  1 -1 0  1 1 0  -1 1 0 }
normals 4 { 0 0 1  0 0 1  0 0 1  0 0 1 }
skinweights 4 { 1 0 1  1 0 1  1 0 1  1 0 1 }
triangles 2 { 0 1 2  0 2 3 }
bindings 1 { matrix { 1 0 0  0 1 0  0 0 1  0 0 0 } }";
    let morph = "positions 1 { 2 0 0 0 } normals 1 { 2 0 0 1 }";
    let still = "channel { extrapolate constant constant keys 0 { } }\n".repeat(5);
    let anim = format!(
        "animation {{ range 0.5 1 numchannels 6 {still} \
         channel {{ extrapolate linear linear keys 2 {{ 0 0 linear linear  1 1.5 linear linear }} }} }}"
    );
    for (name, content) in [
        ("card.skel", skel),
        ("card.skin", skin),
        ("corner.morph", morph),
        ("turn.anim", &anim),
    ] {
        std::fs::write(folder().join(name), content).expect("a file");
    }
}

const CARD: [&str; 4] = ["card.skel", "card.skin", "corner.morph", "turn.anim"];

fn card(name: &str, arguments: &[&str]) -> String {
    render(name, &[&CARD, arguments].concat())
}

#[test]
fn a_morph_target_is_set_by_its_name() {
    write_animated_rig();
    card("morph0.png", &["--morph", "corner=0"]);
    card("morph1.png", &["--morph", "corner=1"]);
    card("morph_dof.png", &["--set", "morph.corner=1"]);
    assert_ne!(picture("morph0.png"), picture("morph1.png"));
    assert_eq!(picture("morph1.png"), picture("morph_dof.png"));
}

#[test]
fn a_clip_is_a_picture_at_its_start_or_at_a_time() {
    write_animated_rig();
    let said = card("clip.png", &["--clip", "turn"]);
    assert!(said.starts_with("clip.png ("), "{said}");
    card("clip_start.png", &["--clip", "turn", "--time", "0.5"]);
    card("clip_later.png", &["--clip", "turn", "--time", "0.8"]);
    assert_eq!(picture("clip.png"), picture("clip_start.png"));
    assert_ne!(picture("clip.png"), picture("clip_later.png"));
}

/// A camera that does not go by what a clip comes to.
const FIXED: [&str; 4] = ["--target", "0,0,0", "--camera", "30deg,20deg,4"];

#[test]
fn a_clip_that_leads_away_stays_in_the_picture() {
    // The figure walks nearly a meter.
    let walk = ["--clip", "walk", "--fps", "10", "--background", "0,0,0,0"];
    render("away.apng", &walk);
    for frame in apng_frames("away.apng") {
        let (width, height) = (48, 40);
        let alpha = |x: usize, y: usize| frame[4 * (width * y + x) + 3];
        let sides = (0..height).flat_map(|y| [(0, y), (width - 1, y)]);
        let edge = (0..width)
            .flat_map(|x| [(x, 0), (x, height - 1)])
            .chain(sides);
        assert!(edge.into_iter().all(|(x, y)| alpha(x, y) == 0));
        assert!(frame.iter().skip(3).step_by(4).any(|&alpha| alpha > 0));
    }
}

#[test]
fn a_clip_is_played_from_its_start_to_its_end() {
    write_animated_rig();
    // Half a second at 8 a second: 0.5, 0.625, 0.75, 0.875.
    card(
        "play.apng",
        &[&["--clip", "turn", "--fps", "8"], &FIXED[..]].concat(),
    );
    let frames = apng_frames("play.apng");
    assert_eq!(frames.len(), 4);
    card(
        "played.png",
        &[&["--clip", "turn", "--time", "0.875"], &FIXED[..]].concat(),
    );
    assert_eq!(frames[3], picture("played.png").into_raw());

    card(
        "play.png",
        &[&["--clip", "turn", "--fps", "8"], &FIXED[..]].concat(),
    );
    assert_eq!(picture("play_0003.png"), picture("played.png"));
    card("play.gif", &["--clip", "turn"]);
    assert_eq!(gif_frames("play.gif").len(), 12, "24 a second");
}

#[test]
fn a_turntable_plays_a_clip_unless_a_time_is_given() {
    write_animated_rig();
    let turn = [
        &["--clip", "turn", "--fps", "8", "--turntable", "2"],
        &FIXED[..],
    ]
    .concat();
    card("both.apng", &turn);
    card(
        "second.png",
        &[
            "--clip",
            "turn",
            "--time",
            "0.625",
            "--target",
            "0,0,0",
            "--camera",
            "210deg,20deg,4",
        ],
    );
    assert_eq!(
        apng_frames("both.apng")[1],
        picture("second.png").into_raw()
    );
    card("held.apng", &[&turn[..], &["--time", "0.5"]].concat());
    let (held, both) = (apng_frames("held.apng"), apng_frames("both.apng"));
    assert_eq!(held[0], both[0]);
    assert_ne!(held[1], both[1]);
}

#[test]
fn morphs_and_clips_are_listed() {
    write_animated_rig();
    let output = rigd(&[&["inspect"], &CARD[..]].concat());
    let tree = text(&output.stdout);
    for line in [
        "morphs\n└─ morph.corner: 1 vertex of mesh ",
        "clips\n└─ turn: 0.5 s to 1 s, ",
    ] {
        assert!(
            tree.contains(line),
            "{line}\nis not in\n{tree}{}",
            text(&output.stderr)
        );
    }
}

/// That of the protocol's examples: it has two variants, and a spot light on its joint `arm`.
fn write_wall() {
    let examples = include_str!("../../api/examples/looks.jsonl");
    let first = examples.lines().next().expect("the rig is loaded first");
    let first: serde_json::Value = serde_json::from_str(first).expect("JSON");
    let file = &first["request"]["params"]["files"][0]["text"];
    let file = file.as_str().expect("a file of text");
    std::fs::write(folder().join("wall.gltf"), file).expect("a file");
}

#[test]
fn a_variant_and_the_lights_of_a_file_are_chosen_and_listed() {
    write_wall();
    let own = drawn("wall.png", &["wall.gltf"]);
    let summer = drawn("summer.png", &["wall.gltf", "--variant", "summer"]);
    let winter = drawn("winter.png", &["wall.gltf", "--variant", "winter"]);
    let lit = drawn("lit.png", &["wall.gltf", "--light", "file"]);
    let moved = drawn(
        "moved.png",
        &["wall.gltf", "--light", "file", "--set", "arm.tx=0.5"],
    );
    let all = [own, summer, winter, lit, moved];
    for (index, picture) in all.iter().enumerate() {
        assert!(
            !all[..index].contains(picture),
            "picture {index} is like another"
        );
    }
    let wrong = ["render", "wall.gltf", "-o", "x.png", "--variant", "wintre"];
    let output = rigd(&[&wrong[..], &ADAPTER].concat());
    let said = text(&output.stderr);
    assert!(
        !output.status.success() && said.contains("did you mean `winter`?"),
        "{said}"
    );
    let both = [
        "render",
        "wall.gltf",
        "-o",
        "x.png",
        "--light",
        "file",
        "--light",
        "dir:0,-1,0",
    ];
    let output = rigd(&[&both[..], &ADAPTER].concat());
    let said = text(&output.stderr);
    assert!(
        !output.status.success() && said.contains("goes with no other light"),
        "{said}"
    );
    let tree = text(&rigd(&["inspect", "wall.gltf"]).stdout);
    for line in [
        "variants\n├─ summer\n└─ winter\n",
        "lights\n└─ lamp: spot, 9 cd, on arm\n",
    ] {
        assert!(tree.contains(line), "{line}\nis not in\n{tree}");
    }
}
