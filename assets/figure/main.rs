//! Generator of the built-in figure: a posable, skinned, painted humanoid in the CSE 169 text formats.
//! Whatever it writes is the same on every machine.
//!
//! ```text
//! cargo run --release --example figure    # writes assets/figure*
//! ```
//!
//! The left half of the body is described as a signed distance field, meshed finely with marching tetrahedra, thinned, relaxed,
//! and mirrored into one closed surface, which is unwrapped and painted.

mod body;
mod leg;
mod mesh;
mod morphs;
mod pack;
mod paint;
mod relax;
mod shapes;
mod skeleton;
mod skin;
mod surface;
mod texture;
mod thin;
mod unwrap;
mod vectors;
mod walk;
mod weights;

const RIG: &str = "\
rig figure {
  skeleton figure.skel
  skin figure.skin
  morphs 2 {
    smile.morph
    blink.morph
  }
}
";

/// The name and the content of every file that is written.
pub fn files() -> Result<Vec<(&'static str, Vec<u8>)>, image::ImageError> {
    let body = body::Body::new();
    let surface = surface::surface(&body);
    let unwrap = unwrap::unwrap(&body, &surface);
    let morph = |to| morphs::morph(&body, &surface, &unwrap, to).into_bytes();
    let texels = texture::texels(&body, &surface, &unwrap);
    Ok(vec![
        ("figure.skel", skeleton::skel().into_bytes()),
        (
            "figure.skin",
            skin::skin(&body, &surface, &unwrap).into_bytes(),
        ),
        ("smile.morph", morph(morphs::smile)),
        ("blink.morph", morph(morphs::blink)),
        ("walk.anim", walk::anim().into_bytes()),
        ("figure.rig", RIG.into()),
        ("figure.png", texture::encode(&texels)?),
    ])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "assets".into());
    for (name, content) in files()? {
        std::fs::write(std::path::Path::new(&folder).join(name), content)?;
    }
    Ok(())
}
