//! What users type for numbers: angles with their unit, sizes, colors, assignments.

use std::str::FromStr;

/// Radians; typed as `0.5`, `0.5rad` or `30deg`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Angle(pub f64);

impl FromStr for Angle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (number, unit) = match (text.strip_suffix("deg"), text.strip_suffix("rad")) {
            (Some(number), _) => (number, std::f64::consts::PI / 180.0),
            (None, Some(number)) => (number, 1.0),
            (None, None) => (text, 1.0),
        };
        Ok(Self(
            finite(number, "a number such as 0.5, 0.5rad or 30deg", text)? * unit,
        ))
    }
}

/// `elbow.rx=30deg`: the name of a DOF and its value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Assignment {
    pub dof: String,
    pub value: f64,
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
            value: value.parse::<Angle>()?.0,
        })
    }
}

/// `640x480`, or `512` for a square.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pixels(pub [u32; 2]);

impl FromStr for Pixels {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text.split_once('x').unwrap_or((text, text));
        let side = |side: &str| {
            side.parse()
                .map_err(|_| format!("expected WIDTHxHEIGHT, but found `{text}`"))
        };
        Ok(Self([side(width)?, side(height)?]))
    }
}

/// `N` numbers or fewer with commas between, at least `LEAST`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Numbers<const LEAST: usize, const MOST: usize>(pub Vec<f64>);

impl<const LEAST: usize, const MOST: usize> FromStr for Numbers<LEAST, MOST> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = text
            .split(',')
            .map(|number| finite(number, "numbers with commas between", text))
            .collect::<Result<_, _>>()?;
        if (LEAST..=MOST).contains(&numbers.len()) {
            return Ok(Self(numbers));
        }
        Err(format!(
            "expected {LEAST} to {MOST} numbers, but found {}",
            numbers.len()
        ))
    }
}

/// `azimuth,inclination[,distance]`: two angles, and a length in the rig's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OrbitView {
    pub azimuth: f64,
    pub inclination: f64,
    pub distance: Option<f64>,
}

impl FromStr for OrbitView {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(',').collect();
        let (azimuth, inclination, distance) = match parts.as_slice() {
            [azimuth, inclination] => (azimuth, inclination, None),
            [azimuth, inclination, distance] => (
                azimuth,
                inclination,
                Some(finite(distance, "a distance", text)?),
            ),
            _ => {
                return Err(format!(
                    "expected AZIMUTH,INCLINATION[,DISTANCE], but found `{text}`"
                ));
            }
        };
        Ok(Self {
            azimuth: azimuth.parse::<Angle>()?.0,
            inclination: inclination.parse::<Angle>()?.0,
            distance,
        })
    }
}

fn finite(number: &str, expected: &str, text: &str) -> Result<f64, String> {
    let parsed = number
        .trim()
        .parse::<f64>()
        .ok()
        .filter(|number| number.is_finite());
    parsed.ok_or_else(|| format!("expected {expected}, but found `{text}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_have_a_unit_or_are_radians() {
        for (text, radians) in [
            ("0.5", 0.5),
            ("-2rad", -2.0),
            ("180deg", std::f64::consts::PI),
            ("1e-1", 0.1),
        ] {
            assert_eq!(text.parse(), Ok(Angle(radians)), "{text}");
        }
        for text in ["", "deg", "30 grad", "nan", "inf", "1e999"] {
            assert!(text.parse::<Angle>().is_err(), "{text}");
        }
    }

    #[test]
    fn assignments_sizes_and_views() {
        let elbow = Assignment {
            dof: "elbow.rx".to_owned(),
            value: 1.5,
        };
        assert_eq!("elbow.rx=1.5".parse(), Ok(elbow));
        assert_eq!("a=b.rx=1".parse::<Assignment>().unwrap().dof, "a=b.rx");
        assert!("elbow.rx".parse::<Assignment>().is_err());
        assert_eq!("640x480".parse(), Ok(Pixels([640, 480])));
        assert_eq!("64".parse(), Ok(Pixels([64, 64])));
        assert!("64x".parse::<Pixels>().is_err());
        assert_eq!("1,2,3".parse(), Ok(Numbers::<3, 4>(vec![1.0, 2.0, 3.0])));
        assert!("1,2".parse::<Numbers<3, 4>>().is_err());
        let view = OrbitView {
            azimuth: 0.0,
            inclination: std::f64::consts::FRAC_PI_2,
            distance: Some(4.0),
        };
        assert_eq!("0,90deg,4".parse(), Ok(view));
    }
}
