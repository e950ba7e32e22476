//! What users type for numbers: sizes, colors, lights, assignments. Never lives here: angles, which have a file of their own, and whether a rig
//! can take them.

use super::angle::Angle;
use super::numbers::finite;
use crate::encode::FrameRate;
use crate::protocol::camera::{DirectionalLight, Falloff, Light, PointLight};
use crate::rig::MORPH_PREFIX;
use crate::scene::CAMERA_DISTANCES;
use std::str::FromStr;

/// `elbow.rx=30deg`: the name of a DOF and its value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Assignment {
    pub dof: String,
    /// A number without a unit may also be of something else than an angle.
    pub value: Angle,
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // Names come from files and may hold anything, also an equals sign.
        let (dof, value) = text
            .rsplit_once('=')
            .ok_or_else(|| format!("expected DOF=VALUE, but found `{text}`"))?;
        Ok(Self {
            dof: dof.to_owned(),
            value: value.parse().map_err(|_| {
                format!("expected a number, or an angle such as 30deg, but found `{value}`")
            })?,
        })
    }
}

/// `640x480`, or `512` for a square.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pixels(pub [u32; 2]);

impl FromStr for Pixels {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text.split_once(['x', 'X']).unwrap_or((text, text));
        let side = |side: &str| {
            side.parse()
                .map_err(|_| format!("expected WIDTHxHEIGHT, but found `{text}`"))
        };
        Ok(Self([side(width)?, side(height)?]))
    }
}

/// `N` numbers with commas between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vector<const N: usize>(pub [f64; N]);

impl<const N: usize> FromStr for Vector<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |_| format!("expected {N} numbers with commas between, but found `{text}`");
        numbers(text)?.try_into().map(Self).map_err(wrong)
    }
}

/// A point that a camera can stand at or look at.
pub(super) fn point(text: &str) -> Result<Vector<3>, String> {
    let point: Vector<3> = text.parse()?;
    let most = *CAMERA_DISTANCES.end();
    if point.0.iter().any(|number| number.abs() > most) {
        return Err(format!(
            "expected coordinates within ±{most:e}, but found `{text}`"
        ));
    }
    Ok(point)
}

/// Red, green, blue and perhaps alpha, which is 1 where it is left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rgba(pub [f64; 4]);

impl FromStr for Rgba {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match *numbers(text)? {
            [r, g, b] => Ok(Self([r, g, b, 1.0])),
            [r, g, b, a] => Ok(Self([r, g, b, a])),
            _ => Err(format!("expected R,G,B[,A], but found `{text}`")),
        }
    }
}

fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |number| finite(number, "numbers with commas between", text);
    text.split(',').map(number).collect()
}

/// `smile=0.5`: the name of a morph target and its weight.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weight {
    pub morph: String,
    pub weight: f64,
}

impl Weight {
    /// The degree of freedom, which may be typed as such.
    pub(super) fn dof(&self) -> String {
        if self.morph.starts_with(MORPH_PREFIX) {
            self.morph.clone()
        } else {
            format!("{}{}", MORPH_PREFIX, self.morph)
        }
    }
}

impl FromStr for Weight {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (morph, weight) = text
            .rsplit_once('=')
            .ok_or_else(|| format!("expected NAME=WEIGHT, but found `{text}`"))?;
        Ok(Self {
            morph: morph.to_owned(),
            weight: finite(weight, "a weight such as 0.5", text)?,
        })
    }
}

/// `elbow=0,0,0.7071,0.7071`: the name of a joint and its local rotation, a unit quaternion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rotation {
    pub joint: String,
    pub quaternion: [f64; 4],
}

impl FromStr for Rotation {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (joint, quaternion) = text
            .rsplit_once('=')
            .ok_or_else(|| format!("expected JOINT=X,Y,Z,W, but found `{text}`"))?;
        Ok(Self {
            joint: joint.to_owned(),
            quaternion: quaternion.parse::<Vector<4>>()?.0,
        })
    }
}

/// Seconds, also negative ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seconds(pub f64);

impl FromStr for Seconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        finite(text, "a number of seconds", text).map(Self)
    }
}

/// Frames a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fps(pub FrameRate);

impl FromStr for Fps {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let rate = text.trim().parse().ok().and_then(FrameRate::new);
        rate.map(Self).ok_or_else(|| {
            let (least, most) = (FrameRate::LEAST, FrameRate::MOST);
            format!("expected {least} to {most} frames a second, but found `{text}`")
        })
    }
}

/// A light, the wish for none, or for those of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum LightArg {
    None,
    File,
    Light(Light),
}

impl FromStr for LightArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        light(text)
            .ok_or_else(|| format!("expected {LIGHT_FORM}, none or file, but found `{text}`"))
    }
}

const LIGHT_FORM: &str =
    "dir:X,Y,Z[:R,G,B][:INTENSITY] or point:X,Y,Z[:R,G,B][:INTENSITY][:inverse_square]";

fn light(text: &str) -> Option<LightArg> {
    match text {
        "none" => return Some(LightArg::None),
        "file" => return Some(LightArg::File),
        _ => {}
    }
    let (kind, rest) = text.split_once(':')?;
    let mut parts = rest.split(':').peekable();
    let vector = |part: &str| part.parse::<Vector<3>>().ok().map(|vector| vector.0);
    let place = vector(parts.next()?)?;
    let color = parts.next_if(|part| part.contains(','));
    let color = color
        .map(|color| vector(color).ok_or(()))
        .transpose()
        .ok()?;
    let intensity = parts.next_if(|part| part.parse::<f64>().is_ok_and(f64::is_finite));
    let intensity = intensity.and_then(|intensity| intensity.parse().ok());
    let light = match kind {
        "dir" => Light::Directional(DirectionalLight {
            direction: place,
            color,
            intensity,
        }),
        "point" => Light::Point(PointLight {
            position: place,
            color,
            intensity,
            falloff: match parts.next_if_eq(&"inverse_square") {
                Some(_) => Falloff::InverseSquare,
                None => Falloff::None,
            },
        }),
        _ => return None,
    };
    parts.next().is_none().then_some(LightArg::Light(light))
}

/// `azimuth,inclination[,distance]`: two angles, and a length in the rig's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OrbitView {
    pub azimuth: Angle,
    pub inclination: Angle,
    pub distance: Option<f64>,
}

impl FromStr for OrbitView {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(',').collect();
        let (azimuth, inclination, distance) = match parts.as_slice() {
            [azimuth, inclination] => (azimuth, inclination, None),
            [azimuth, inclination, typed] => {
                let distance = finite(typed, "a distance", typed)?;
                if !CAMERA_DISTANCES.contains(&distance) {
                    let (least, most) = (CAMERA_DISTANCES.start(), CAMERA_DISTANCES.end());
                    return Err(format!(
                        "expected a distance from {least:e} to {most:e}, but found `{typed}`"
                    ));
                }
                (azimuth, inclination, Some(distance))
            }
            _ => {
                return Err(format!(
                    "expected AZIMUTH,INCLINATION[,DISTANCE], but found `{text}`"
                ));
            }
        };
        Ok(Self {
            azimuth: azimuth.parse()?,
            inclination: inclination.parse()?,
            distance,
        })
    }
}

/// A host and a port, as far as that can be told without asking for the host.
pub(super) fn address(text: &str) -> Result<String, String> {
    let parts = text.rsplit_once(':');
    parts
        .filter(|(host, port)| !host.is_empty() && !port.is_empty())
        .map(|_| text.to_owned())
        .ok_or_else(|| format!("expected HOST:PORT such as 127.0.0.1:7443, but found `{text}`"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::angle::Unit;

    fn angle(radians: f64, unit: Unit) -> Angle {
        Angle { radians, unit }
    }

    #[test]
    fn assignments_sizes_and_views() {
        let elbow = Assignment {
            dof: "elbow.rx".to_owned(),
            value: angle(1.5, Unit::None),
        };
        assert_eq!("elbow.rx=1.5".parse(), Ok(elbow));
        assert_eq!("a=b.rx=1".parse::<Assignment>().unwrap().dof, "a=b.rx");
        assert!("elbow.rx".parse::<Assignment>().is_err());
        assert_eq!("640x480".parse(), Ok(Pixels([640, 480])));
        assert_eq!("64".parse(), Ok(Pixels([64, 64])));
        assert!("64x".parse::<Pixels>().is_err());
        assert_eq!("1,2,3".parse(), Ok(Vector([1.0, 2.0, 3.0])));
        assert!("1,2".parse::<Vector<3>>().is_err());
        assert_eq!("0,.5,1".parse(), Ok(Rgba([0.0, 0.5, 1.0, 1.0])));
        assert_eq!("0,.5,1,0".parse(), Ok(Rgba([0.0, 0.5, 1.0, 0.0])));
        assert!("0,1".parse::<Rgba>().is_err());
        assert_eq!("a=b=-1".parse::<Weight>().unwrap().morph, "a=b");
        assert!("smile=30deg".parse::<Weight>().is_err());
        let turned = "hip=0,0,0,1".parse::<Rotation>().unwrap();
        assert_eq!(turned.quaternion, [0.0, 0.0, 0.0, 1.0]);
        assert!("hip=0,0,1".parse::<Rotation>().is_err());
        let view = OrbitView {
            azimuth: angle(0.0, Unit::None),
            inclination: angle(std::f64::consts::FRAC_PI_2, Unit::Degrees),
            distance: Some(4.0),
        };
        assert_eq!("0,90deg,4".parse(), Ok(view));
    }

    #[test]
    fn lights_are_typed_in_one_word() {
        let directional = |color, intensity| {
            LightArg::Light(Light::Directional(DirectionalLight {
                direction: [0.0, -1.0, 0.5],
                color,
                intensity,
            }))
        };
        let point = |color, intensity, falloff| {
            LightArg::Light(Light::Point(PointLight {
                position: [1.0, 2.0, 3.0],
                color,
                intensity,
                falloff,
            }))
        };
        let red = Some([1.0, 0.0, 0.0]);
        for (text, wanted) in [
            ("none", LightArg::None),
            ("file", LightArg::File),
            ("dir:0,-1,.5", directional(None, None)),
            ("dir:0,-1,.5:2", directional(None, Some(2.0))),
            ("dir:0,-1,.5:1,0,0:2", directional(red, Some(2.0))),
            ("point:1,2,3", point(None, None, Falloff::None)),
            (
                "point:1,2,3:1,0,0:4:inverse_square",
                point(red, Some(4.0), Falloff::InverseSquare),
            ),
            (
                "point:1,2,3:inverse_square",
                point(None, None, Falloff::InverseSquare),
            ),
        ] {
            assert_eq!(text.parse(), Ok(wanted), "{text}");
        }
        for text in [
            "",
            "dir",
            "dir:1,2",
            "sun:0,1,0",
            "dir:0,-1,0:1,0",
            "dir:0,-1,0:inf",
            "dir:0,-1,0:2:1,0,0",
            "dir:0,-1,0:inverse_square",
            "point:0,1,0:2:quickly",
            "point:0,1,0::",
        ] {
            let error = text.parse::<LightArg>().unwrap_err();
            assert!(
                error.contains("[:INTENSITY]") && error.contains(text),
                "{error}"
            );
        }
    }

    #[test]
    fn rates_are_refused_where_no_file_can_hold_them() {
        assert_eq!("24".parse::<Fps>().unwrap().0.per_second(), 24.0);
        for text in ["0", "-1", "nan", "inf", "fast", ""] {
            assert!(text.parse::<Fps>().is_err(), "{text}");
        }
    }
}
