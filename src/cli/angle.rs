//! Angles as users type them, and as they are told of them: in the unit that was typed. Never lives here: limits of a rig.

use super::numbers::{finite, rounded};
use crate::scene::FOV_Y_RADIANS;
use std::str::FromStr;

/// An angle as it was typed: `0.5`, `0.5rad`, `30deg` or `30°`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Angle {
    pub radians: f64,
    pub unit: Unit,
}

/// What was typed behind an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    /// Nothing, which stands for radians.
    None,
    Radians,
    Degrees,
}

impl Unit {
    /// An angle in this unit, as it can be typed.
    pub(super) fn show(self, radians: f64) -> String {
        self.show_moved(radians, 0.0)
    }

    /// The least that an angle may be, rounded up, so that what is shown may be typed.
    pub(super) fn show_least(self, radians: f64) -> String {
        self.show_moved(radians, ALMOST_HALF)
    }

    /// The most that an angle may be, rounded down, so that what is shown may be typed.
    pub(super) fn show_most(self, radians: f64) -> String {
        self.show_moved(radians, -ALMOST_HALF)
    }

    /// Moved by a share of the last decimal that is shown.
    fn show_moved(self, radians: f64, share: f64) -> String {
        match self {
            Self::None | Self::Radians => format!("{}rad", rounded(radians + share * 1e-4, 4)),
            // Files give radians with few decimals; more than two of a degree would show that.
            Self::Degrees => format!("{}deg", rounded(radians.to_degrees() + share * 1e-2, 2)),
        }
    }
}

/// Moves a number that is to be rounded up or down, but for one that is off a round one by the error of a conversion.
const ALMOST_HALF: f64 = 0.5 - 1e-9;

impl Angle {
    /// What is odd about a number without a unit that would be a common one in degrees.
    pub(super) fn doubt(self) -> Option<String> {
        let Self { radians, unit } = self;
        let is_odd = unit == Unit::None && radians.abs() > std::f64::consts::TAU;
        is_odd.then(|| {
            format!("{radians} is taken for radians, more than a full turn; for degrees type {radians}deg")
        })
    }
}

impl FromStr for Angle {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let units = [
            ("deg", Unit::Degrees),
            ("°", Unit::Degrees),
            ("rad", Unit::Radians),
            ("", Unit::None),
        ];
        let typed = units
            .into_iter()
            .find_map(|(ending, unit)| Some((text.strip_suffix(ending)?, unit)));
        let (number, unit) = typed.unwrap_or((text, Unit::None));
        let number = finite(number, "an angle such as 0.5, 0.5rad or 30deg", text)?;
        let radians = match unit {
            Unit::Degrees => number * (std::f64::consts::PI / 180.0),
            Unit::None | Unit::Radians => number,
        };
        Ok(Self { radians, unit })
    }
}

/// The angle that a picture is high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FieldOfView(pub f64);

impl FromStr for FieldOfView {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let angle: Angle = text.parse()?;
        if FOV_Y_RADIANS.contains(&angle.radians) {
            return Ok(Self(angle.radians));
        }
        let least = angle.unit.show_least(*FOV_Y_RADIANS.start());
        let most = angle.unit.show_most(*FOV_Y_RADIANS.end());
        let is_in_degrees =
            angle.unit == Unit::None && FOV_Y_RADIANS.contains(&angle.radians.to_radians());
        let hint = if is_in_degrees {
            format!(", which stands for radians; for degrees type {text}deg")
        } else {
            String::new()
        };
        Err(format!(
            "expected an angle from {least} to {most}, but found `{text}`{hint}"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_have_a_unit_or_are_radians() {
        for (text, radians, unit, shown) in [
            ("0.5", 0.5, Unit::None, "0.5rad"),
            ("-2rad", -2.0, Unit::Radians, "-2rad"),
            ("180deg", std::f64::consts::PI, Unit::Degrees, "180deg"),
            ("180°", std::f64::consts::PI, Unit::Degrees, "180deg"),
            ("1e-1", 0.1, Unit::None, "0.1rad"),
            ("-1e-9deg", -1.0e-9_f64.to_radians(), Unit::Degrees, "0deg"),
        ] {
            assert_eq!(text.parse(), Ok(Angle { radians, unit }), "{text}");
            assert_eq!(unit.show(radians), shown);
        }
        for text in ["", "deg", "30 grad", "nan", "inf", "1e999"] {
            assert!(text.parse::<Angle>().is_err(), "{text}");
        }
    }

    #[test]
    fn ends_of_a_range_are_shown_as_what_lies_inside() {
        let degrees = |number: f64| number * (std::f64::consts::PI / 180.0);
        for (unit, radians, least, most) in [
            (Unit::None, 1.23456, "1.2346rad", "1.2345rad"),
            (Unit::Radians, -1.23456, "-1.2345rad", "-1.2346rad"),
            (Unit::Radians, 0.5, "0.5rad", "0.5rad"),
            (Unit::Degrees, degrees(40.0), "40deg", "40deg"),
            (Unit::Degrees, degrees(-29.0), "-29deg", "-29deg"),
            (Unit::Degrees, degrees(0.007), "0.01deg", "0deg"),
        ] {
            assert_eq!(unit.show_least(radians), least);
            assert_eq!(unit.show_most(radians), most);
        }
    }

    #[test]
    fn more_than_a_turn_without_a_unit_is_doubted() {
        for (text, is_odd) in [
            ("30", true),
            ("-7", true),
            ("6.2", false),
            ("400deg", false),
            ("30rad", false),
        ] {
            let angle: Angle = text.parse().unwrap();
            assert_eq!(angle.doubt().is_some(), is_odd, "{text}");
        }
    }

    #[test]
    fn a_field_of_view_is_refused_in_the_unit_it_was_typed_in() {
        assert_eq!("1".parse(), Ok(FieldOfView(1.0)));
        for (text, wanted) in [
            ("200deg", "from 0.01deg to 179.99deg, but found `200deg`"),
            ("4rad", "from 0.0001rad to 3.1414rad, but found `4rad`"),
            (
                "3.1415",
                "to 3.1414rad, but found `3.1415`, which stands for radians; for degrees type 3.1415deg",
            ),
            ("200", "to 3.1414rad, but found `200`"),
            ("0", "to 3.1414rad, but found `0`"),
            (
                "45",
                "but found `45`, which stands for radians; for degrees type 45deg",
            ),
        ] {
            let error = text.parse::<FieldOfView>().unwrap_err();
            assert!(error.ends_with(wanted), "{error}");
        }
    }
}
