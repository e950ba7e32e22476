//! `rigd render`: one picture, drawn by this process.

use super::values::{Assignment, Numbers, OrbitView, Pixels};
use super::{RendererArgs, local};
use crate::formats::Source;
use crate::protocol::blob::PictureTransport;
use crate::protocol::camera::{Camera, Orbit};
use crate::protocol::frame as wire;
use crate::service::Service;
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct RenderArgs {
    /// Files of the rig, in any order; without any, as for `rigd serve`
    files: Vec<String>,
    /// The PNG to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Set a degree of freedom, e.g. elbow.rx=30deg; may be given many times
    #[arg(long = "set", value_name = "DOF=VALUE", allow_hyphen_values = true)]
    assignments: Vec<Assignment>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    size: Pixels,
    /// Where to look from: azimuth and inclination (radians, or with deg), and the distance
    #[arg(long, value_name = "AZ,INC[,DIST]", allow_hyphen_values = true)]
    camera: Option<OrbitView>,
    /// How to show the skin
    #[arg(long, value_name = "HOW", default_value = "posed")]
    skin: Skin,
    /// How to show the skeleton
    #[arg(long, value_name = "HOW", default_value = "none")]
    skeleton: Skeleton,
    /// From 0 to 1; below 1 the skeleton shines through the skin
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    skin_opacity: f64,
    /// Light each triangle by its own normal
    #[arg(long)]
    flat: bool,
    /// Linear red, green, blue and alpha, from 0 to 1
    #[arg(long, value_name = "R,G,B[,A]")]
    background: Option<Numbers<3, 4>>,
    /// Linear red, green and blue that the skin scatters
    #[arg(long, value_name = "R,G,B")]
    diffuse: Option<Numbers<3, 3>>,
    /// Samples of a pixel: 1 or 4
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=4))]
    samples: u8,
    #[command(flatten)]
    renderer: RendererArgs,
}

#[derive(Clone, Copy, ValueEnum)]
enum Skin {
    Posed,
    Bind,
    None,
}

#[derive(Clone, Copy, ValueEnum)]
enum Skeleton {
    None,
    Wireframe,
    Boxes,
    Sticks,
    Cylinders,
}

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<()> {
    let engine = args.renderer.open()?;
    let loaded = local::load(&engine, &args.files)?;
    let service = Service::new(engine, Source::inline_only());
    let (frame, attached) =
        local::ask::<_, wire::Frame>(&service, "frame.render", &args.params(&loaded.name)?)?;
    for clamped in &frame.clamped {
        eprintln!(
            "warning: {} of {} is past its limit; used {}",
            clamped.dof, clamped.asked, clamped.used
        );
    }
    let picture = frame
        .images
        .get("color")
        .context("a frame has a color picture")?
        .bytes(&attached)?;
    std::fs::write(&args.output, &picture)
        .with_context(|| format!("cannot write {}", args.output.display()))?;
    println!(
        "{} ({}x{}, {} bytes)",
        args.output.display(),
        frame.width,
        frame.height,
        picture.len()
    );
    Ok(())
}

impl RenderArgs {
    fn params(&self, rig: &str) -> anyhow::Result<wire::FrameParams> {
        let mut params = wire::FrameParams::of(rig);
        for Assignment { dof, value } in &self.assignments {
            params.pose.dofs.insert(dof.clone(), *value);
        }
        if let Some(OrbitView {
            azimuth,
            inclination,
            distance,
        }) = self.camera
        {
            let (azimuth, inclination) = (Some(azimuth), Some(inclination));
            params.camera = Camera::Orbit(Orbit {
                azimuth,
                inclination,
                distance,
                ..Orbit::default()
            });
        }
        params.show = wire::Show {
            skin: match self.skin {
                Skin::Posed => wire::ShowSkin::Posed,
                Skin::Bind => wire::ShowSkin::Bind,
                Skin::None => wire::ShowSkin::None,
            },
            skeleton: match self.skeleton {
                Skeleton::None => wire::ShowSkeleton::None,
                Skeleton::Wireframe => wire::ShowSkeleton::Wireframe,
                Skeleton::Boxes => wire::ShowSkeleton::Boxes,
                Skeleton::Sticks => wire::ShowSkeleton::Sticks,
                Skeleton::Cylinders => wire::ShowSkeleton::Cylinders,
            },
            skin_opacity: self.skin_opacity,
            normals: if self.flat {
                wire::ShowNormals::Flat
            } else {
                wire::ShowNormals::Smooth
            },
        };
        params.background = match self
            .background
            .as_ref()
            .map(|background| background.0.as_slice())
        {
            None => None,
            Some(&[r, g, b]) => Some([r, g, b, 1.0]),
            Some(rgba) => Some(rgba.try_into()?),
        };
        params.material.diffuse = self
            .diffuse
            .as_ref()
            .map(|diffuse| diffuse.0.as_slice().try_into())
            .transpose()?;
        params.size = self.size.0;
        params.samples = match self.samples {
            1 => wire::Samples::One,
            4 => wire::Samples::Four,
            other => bail!("expected 1 or 4 samples, but found {other}"),
        };
        // A file on disk is written once and read often.
        params.compression = wire::Compression::Default;
        params.transport = PictureTransport::Attach;
        Ok(params)
    }
}
