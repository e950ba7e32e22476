//! Are the built-in figure's files what its generator writes?

#[path = "../assets/figure.rs"]
#[allow(dead_code, reason = "its main writes the files")]
mod figure;

#[test]
fn the_files_are_what_the_generator_writes() {
    let advice = "run `cargo run --release --example figure`";
    assert!(
        figure::skel() == include_str!("../assets/figure.skel"),
        "figure.skel is stale: {advice}"
    );
    assert!(
        figure::skin() == include_str!("../assets/figure.skin"),
        "figure.skin is stale: {advice}"
    );
}
