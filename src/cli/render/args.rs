//! What can be typed after `rigd render`. Never lives here: what it comes to.

use crate::cli::RendererArgs;
use crate::cli::angle::FieldOfView;
use crate::cli::exit;
use crate::cli::numbers::{number, positive};
use crate::cli::values::{
    Assignment, Fps, LightArg, OrbitView, Pixels, Rgba, Rotation, Seconds, Vector, Weight, point,
};
use crate::protocol::{frame as wire, pose as wire_pose};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = SEQUENCES, after_long_help = format!("{SEQUENCES}\n\n{}", exit::CODES))]
pub(in crate::cli) struct RenderArgs {
    /// Files of the rig, in any order; without any, as for `rigd serve`
    pub files: Vec<String>,
    #[command(flatten)]
    pub renderer: RendererArgs,
    /// End with exit code 3 where there were warnings; what was asked for is written all the same
    #[arg(long)]
    pub strict: bool,
    #[command(flatten)]
    pub output: OutputArgs,
    #[command(flatten)]
    pub sequence: SequenceArgs,
    #[command(flatten)]
    pub pose: PoseArgs,
    #[command(flatten)]
    pub camera: CameraArgs,
    #[command(flatten)]
    pub look: LookArgs,
    #[command(flatten)]
    pub light: LightArgs,
}

const SEQUENCES: &str = "\
The ending of --output says what is written: .png a picture, .gif or .apng an animation. A sequence into .png writes numbered files, \
e.g. walk_0000.png for walk.png.

  rigd render drake.skel drake.skin -o drake.png                    one picture
  rigd render drake.skel drake.skin -o drake.gif --turntable 48     once around
  rigd render drake.rig walk.anim -o walk.gif --clip walk           the clip from its start to its end
  rigd render drake.rig walk.anim -o walk.png --clip walk           the clip's first moment, one picture
  rigd render drake.rig walk.anim -o walk.png --clip walk --fps 30  the clip as numbered pictures";

#[derive(Args)]
#[command(next_help_heading = "Output")]
pub(in crate::cli) struct OutputArgs {
    /// The file to write; its ending is .png, .gif or .apng. With - one picture goes to standard output as a PNG
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Width and height in pixels
    #[arg(
        long,
        value_name = "WxH",
        default_value = "512x512",
        allow_hyphen_values = true
    )]
    pub size: Pixels,
    /// Samples of a pixel
    #[arg(long, value_name = "N", default_value = "4")]
    pub samples: Samples,
    /// How much time to spend on a small file, or on the colors of a GIF
    // A file on disk is written once and read often.
    #[arg(long, value_name = "HOW", default_value = "default")]
    pub compression: Compression,
}

#[derive(Args)]
#[command(next_help_heading = "Sequence")]
pub(in crate::cli) struct SequenceArgs {
    /// Draw N frames, once around the rig from the camera's azimuth
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_FRAMES)), allow_negative_numbers = true)]
    pub turntable: Option<u32>,
    /// Frames a second, 24 without it; with --clip it asks for the whole clip also where the output is a .png
    #[arg(long, value_name = "F", allow_hyphen_values = true)]
    pub fps: Option<Fps>,
}

/// As many as come to days of drawing; more is a slip of the finger.
pub(super) const MOST_FRAMES: u32 = 1_000_000;

#[derive(Args)]
#[command(next_help_heading = "Pose")]
pub(in crate::cli) struct PoseArgs {
    /// Pose by an animation, at its start unless --time says otherwise
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
    /// The moment of the clip, also outside of its range; with --turntable it stands still there
    #[arg(
        long,
        value_name = "SECONDS",
        requires = "clip",
        allow_hyphen_values = true
    )]
    pub time: Option<Seconds>,
    /// Turn a joint to a local rotation, a unit quaternion; may be given many times
    #[arg(
        long = "rotate",
        value_name = "JOINT=X,Y,Z,W",
        allow_hyphen_values = true
    )]
    pub rotations: Vec<Rotation>,
    /// Set a degree of freedom: an angle in radians or with deg, e.g. elbow.rx=30deg, else a number; may be given many times
    #[arg(long = "set", value_name = "DOF=VALUE", allow_hyphen_values = true)]
    pub assignments: Vec<Assignment>,
    /// Set the weight of a morph target, e.g. smile=0.5 or morph.smile=0.5; may be given many times
    #[arg(long = "morph", value_name = "NAME=WEIGHT", allow_hyphen_values = true)]
    pub morphs: Vec<Weight>,
    /// What becomes of a value past its limits
    #[arg(long, value_name = "HOW", default_value = "clamp")]
    pub limits: Limits,
    /// How a vertex follows several joints
    #[arg(long, value_name = "HOW", default_value = "linear")]
    pub skinning: Skinning,
}

impl PoseArgs {
    /// Whether a sequence of pictures lets the clip run, not stand still at a time.
    pub(crate) fn plays_clip(&self) -> bool {
        self.clip.is_some() && self.time.is_none()
    }
}

#[derive(Args)]
#[command(next_help_heading = "Camera")]
pub(in crate::cli) struct CameraArgs {
    /// Where to look from: azimuth, from +Z toward +X, and inclination, above the horizon (radians, or with deg: 30deg,20deg without it),
    /// and the distance, which else fits the rig at rest or the whole clip
    #[arg(long, value_name = "AZ,INC[,DIST]", allow_hyphen_values = true)]
    pub camera: Option<OrbitView>,
    /// The point to look at; without it, the middle of the rig at rest
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub target: Option<Vector<3>>,
    /// The point to look from, in place of --camera
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_parser = point,
        allow_hyphen_values = true,
        conflicts_with = "camera"
    )]
    pub eye: Option<Vector<3>>,
    /// Angle that the picture is high (radians, or with deg)
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pub fov: Option<FieldOfView>,
    /// Draw without perspective, HEIGHT units of length high
    #[arg(long, value_name = "HEIGHT", value_parser = positive, allow_hyphen_values = true, conflicts_with = "fov")]
    pub ortho: Option<f64>,
}

#[derive(Args)]
#[command(next_help_heading = "Look (colors are linear, from 0 to 1)")]
pub(in crate::cli) struct LookArgs {
    /// How to show the skin
    #[arg(long, value_name = "HOW", default_value = "posed")]
    pub skin: Skin,
    /// How to show the skeleton
    #[arg(long, value_name = "HOW", default_value = "none")]
    pub skeleton: Skeleton,
    /// From 0 to 1; below 1 the skeleton shines through the skin
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, value_parser = number, allow_hyphen_values = true)]
    pub skin_opacity: f64,
    /// Whether to leave out the far side of closed skin
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub cull: Cull,
    /// Light each triangle by its own normal
    #[arg(long)]
    pub flat: bool,
    /// Color that the skin scatters
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true)]
    pub diffuse: Option<Vector<3>>,
    /// Color of the highlight
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true)]
    pub specular: Option<Vector<3>>,
    /// Exponent of the highlight: the higher, the smaller
    #[arg(long, value_name = "EXPONENT", value_parser = number, allow_hyphen_values = true)]
    pub shininess: Option<f64>,
    /// Choose other materials of the file by the name of one of its variants
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// What stands behind the rig; alpha 0 makes it transparent
    #[arg(long, value_name = "R,G,B[,A]", allow_hyphen_values = true)]
    pub background: Option<Rgba>,
}

#[derive(Args)]
#[command(next_help_heading = "Light")]
pub(in crate::cli) struct LightArgs {
    #[arg(long = "light", value_name = "LIGHT", help = LIGHTS)]
    pub lights: Vec<LightArg>,
    /// Light from everywhere
    #[arg(long, value_name = "R,G,B", allow_hyphen_values = true)]
    pub ambient: Option<Vector<3>>,
}

/// Not a comment of the option: its brackets would be taken for links.
const LIGHTS: &str = "A light instead of the default ones; may be given many times: dir:X,Y,Z[:R,G,B][:INTENSITY] travels that way, \
                      point:X,Y,Z[:R,G,B][:INTENSITY][:inverse_square] stands there, none leaves the ambient light alone, file takes those of the file";

/// A word of the protocol as a word of the command line.
macro_rules! words {
    ($($name:ident is $wire:path { $($(#[$inner:meta])* $variant:ident,)* })*) => {
        $(#[derive(Clone, Copy, ValueEnum)]
        #[value(rename_all = "snake_case")]
        pub(in crate::cli) enum $name { $($(#[$inner])* $variant,)* }

        impl From<$name> for $wire {
            fn from(word: $name) -> Self {
                match word { $($name::$variant => Self::$variant,)* }
            }
        })*
    };
}

words! {
    Skin is wire::ShowSkin { Posed, Bind, None, }
    Skeleton is wire::ShowSkeleton { None, Wireframe, Boxes, Sticks, Cylinders, }
    Skinning is wire::Skinning { Linear, DualQuaternion, }
    Cull is wire::Cull { Auto, Never, }
    Compression is wire::Compression { Fast, Default, Best, }
    Samples is wire::Samples { #[value(name = "1")] One, #[value(name = "4")] Four, }
    Limits is wire_pose::LimitPolicy { Clamp, Reject, Ignore, }
}
