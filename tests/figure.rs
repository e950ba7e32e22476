//! Are the built-in figure's files what its generator writes?
//! What they look like is no matter of this test.

#[path = "../assets/figure/main.rs"]
#[allow(dead_code, reason = "its main writes the files")]
mod figure;

/// What a file says: of a picture its size and texels, for an encoder may pack the same ones another way.
fn meaning(name: &str, content: Vec<u8>) -> Vec<u8> {
    if !name.ends_with(".png") {
        return content;
    }
    let picture = image::load_from_memory(&content).expect("a picture that can be read");
    let size = [
        picture.width().to_le_bytes(),
        picture.height().to_le_bytes(),
    ];
    [size.concat(), picture.into_rgb8().into_raw()].concat()
}

#[test]
fn the_files_are_what_the_generator_writes() {
    let assets = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let written = figure::files().expect("the picture can be encoded");
    let names: Vec<_> = written.iter().map(|file| file.0).collect();
    let known = [
        "figure.skel",
        "figure.skin",
        "smile.morph",
        "blink.morph",
        "walk.anim",
        "figure.rig",
        "figure.png",
    ];
    assert_eq!(names, known);
    for (name, content) in written {
        let committed = std::fs::read(assets.join(name)).unwrap_or_default();
        assert!(
            meaning(name, content) == meaning(name, committed),
            "{name} is stale: run `cargo run --release --example figure`"
        );
    }
}

#[test]
fn it_is_closed_so_that_its_far_side_is_not_drawn() {
    let files = rigd::cli::figure();
    let source = rigd::formats::Source::inline_only();
    let loaded = rigd::formats::load(&files, &source, &rigd::limits::Limits::default());
    let rig = loaded.expect("the figure").rig;
    for mesh in rig.meshes() {
        let outward = mesh.parts()[0].sides.outward_count();
        let all = mesh.triangles().len();
        // The rest is what normals turned: slivers at its seams.
        let few = all - all / 1000;
        assert!(
            outward.is_some_and(|outward| outward >= few),
            "{outward:?} of {all}"
        );
    }
}
