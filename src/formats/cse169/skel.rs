//! Reads a CSE 169 `.skel`: one tree of joints.
//! Never lives here: clamping of poses and uniqueness of names, which [`Draft::build`](crate::rig::Draft::build) sees to.
//!
//! ```text
//! skel  := joint
//! joint := ("balljoint" | "joint") [NAME] "{" item* "}"
//! item  := "offset" x y z | "boxmin" x y z | "boxmax" x y z | "pose" x y z
//!        | "rotxlimit" min max | "rotylimit" min max | "rotzlimit" min max       `inf` as well
//!        | "orient" number*                                                      read over
//!        | joint
//! ```
//! Items come in any order, all are optional, and of two alike the last one counts. Angles are in radians, `x` turns first.
//! Names are free words, or stand in double quotes, and are neither unique nor always there: a joint is known by its place in the order of
//! appearance.

use super::common::name_and_brace;
use super::keywords::Keywords;
use crate::formats::error::{FileFault, LoadError};
use crate::formats::text::lexer::{Lexer, Token, parse_number};
use crate::limits::Limits;
use crate::rig::{JointDraft, LARGEST_COORDINATE, Limit, Rotation, Warnings};
use glam::DVec3;
use std::f64::consts::TAU;

const JOINT: Keywords = Keywords(&["balljoint", "joint"]);
const ITEM: Keywords = Keywords(&[
    "balljoint",
    "joint",
    "offset",
    "pose",
    "boxmin",
    "boxmax",
    "rotxlimit",
    "rotylimit",
    "rotzlimit",
    "orient",
]);

/// The course's own.
const DEFAULT_BOX: [DVec3; 2] = [DVec3::splat(-0.1), DVec3::splat(0.1)];

/// Joints in order of appearance, which puts parents before their children.
///
/// # Errors
/// [`LoadError::Invalid`] at the first word that does not fit, [`LoadError::Limit`] at the first joint too many.
pub(super) fn read(
    lexer: Lexer,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Vec<JointDraft>, LoadError> {
    let mut reader = Reader {
        lexer,
        limits,
        warnings,
        joints: Vec::new(),
        open: Vec::new(),
        orient_reported: false,
        like_degrees: None,
    };
    reader.read_root()?;
    while let Some(open) = reader.open.last().copied() {
        reader.read_item(&open)?;
    }
    reader.read_end()?;
    reader.ask_whether_degrees();
    Ok(reader.joints)
}

struct Reader<'a, 'w> {
    lexer: Lexer<'a>,
    limits: &'w Limits,
    warnings: &'w mut Warnings,
    joints: Vec<JointDraft>,
    /// From the root down. A stack of our own: a file's depth must not become the depth of calls.
    open: Vec<OpenJoint<'a>>,
    orient_reported: bool,
    /// The first property whose angles look like degrees, and how many there are.
    like_degrees: Option<(Token<'a>, usize)>,
}

#[derive(Clone, Copy)]
struct OpenJoint<'a> {
    index: usize,
    keyword: Token<'a>,
    /// Properties met so far, a bit each.
    seen: u8,
}

#[derive(Clone, Copy)]
enum Property {
    Offset,
    Pose,
    Corner(usize),
    Limit(usize),
}

impl Property {
    fn of(word: &str) -> Option<Self> {
        Some(match word {
            "offset" => Self::Offset,
            "pose" => Self::Pose,
            "boxmin" => Self::Corner(0),
            "boxmax" => Self::Corner(1),
            "rotxlimit" => Self::Limit(0),
            "rotylimit" => Self::Limit(1),
            "rotzlimit" => Self::Limit(2),
            _ => return None,
        })
    }

    fn bit(self) -> u8 {
        1 << match self {
            Self::Offset => 0,
            Self::Pose => 1,
            Self::Corner(which) => 2 + which,
            Self::Limit(axis) => 4 + axis,
        }
    }
}

impl<'a> Reader<'a, '_> {
    fn read_root(&mut self) -> Result<(), LoadError> {
        let mut first_unknown = None;
        loop {
            let word = JOINT.next(&mut self.lexer, self.warnings);
            if is_joint(word.text) {
                return self.open_joint(word);
            }
            let first = *first_unknown.get_or_insert(word);
            if word.is_end() {
                // Told at the first word: the file is no skeleton from there on, not only at its end.
                return Err(self.lexer.fault(first, "`balljoint`").into());
            }
            JOINT.skip_unknown(&mut self.lexer, word, self.warnings)?;
        }
    }

    fn open_joint(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        let index = self.joints.len();
        self.limits.joints(index + 1)?;
        let name = name_and_brace(&mut self.lexer, keyword)?;
        let parent = self.open.last().map(|open| open.index);
        self.joints.push(JointDraft {
            name: name.to_owned(),
            parent,
            translates: parent.is_none(),
            bounding_box: Some(DEFAULT_BOX),
            ..JointDraft::default()
        });
        self.open.push(OpenJoint {
            index,
            keyword,
            seen: 0,
        });
        Ok(())
    }

    fn read_item(&mut self, open: &OpenJoint<'a>) -> Result<(), LoadError> {
        let word = ITEM.next(&mut self.lexer, self.warnings);
        match word.text {
            "}" => {
                self.open.pop();
            }
            "orient" => self.read_over_orient(word),
            text if is_joint(text) => self.open_joint(word)?,
            "" => {
                let (line, column) = self.lexer.line_column(open.keyword);
                let keyword = open.keyword.text;
                let expected = format!("`}}` to end the `{keyword}` at {line}:{column}");
                return Err(self.lexer.fault(word, expected).into());
            }
            text => match Property::of(text) {
                Some(property) => self.read_property(property, word, open.index)?,
                None => {
                    ITEM.skip_unknown(&mut self.lexer, word, self.warnings)?;
                }
            },
        }
        Ok(())
    }

    fn read_property(
        &mut self,
        property: Property,
        word: Token<'a>,
        index: usize,
    ) -> Result<(), FileFault> {
        self.warn_of_repeat(property, word);
        let lexer = &mut self.lexer;
        let mut vector = || {
            let numbers = lexer.numbers(|| format!("after `{}`", word.text));
            numbers.map(DVec3::from_array)
        };
        let joint = &mut self.joints[index];
        match property {
            Property::Offset => joint.offset = vector()?,
            Property::Pose => {
                let angles = vector()?;
                joint.rest_rotation = Rotation::Angles(angles);
                self.note_angles(word, &angles.to_array());
            }
            Property::Corner(which) => {
                joint.bounding_box.get_or_insert(DEFAULT_BOX)[which] = vector()?;
            }
            Property::Limit(axis) => {
                let limit = read_limit(lexer, word)?;
                joint.rotation_limits[axis] = limit;
                self.note_angles(word, &[limit.min, limit.max]);
            }
        }
        Ok(())
    }

    fn note_angles(&mut self, word: Token<'a>, angles: &[f64]) {
        if angles.iter().any(|&angle| looks_like_degrees(angle)) {
            self.like_degrees.get_or_insert((word, 0)).1 += 1;
        }
    }

    fn ask_whether_degrees(&mut self) {
        let Some((word, count)) = self.like_degrees else {
            return;
        };
        let lexer = &self.lexer;
        self.warnings.push(|| {
            let (place, word) = (lexer.place(word), word.text);
            let others = match count {
                1 => String::new(),
                _ => format!(", and in {} places more", count - 1),
            };
            format!(
                "{place}: `{word}` goes past a full turn here{others}; angles are in radians, were degrees meant?"
            )
        });
    }

    fn warn_of_repeat(&mut self, property: Property, word: Token<'a>) {
        let Some(open) = self.open.last_mut() else {
            return;
        };
        if open.seen & property.bit() != 0 {
            let lexer = &self.lexer;
            self.warnings.push(|| {
                let place = lexer.place(word);
                format!(
                    "{place}: `{}` stands twice in a joint; the last one counts",
                    word.text
                )
            });
        }
        open.seen |= property.bit();
    }

    /// An exporter writes nine numbers here that contradict its own bindings; the joints fit together without them.
    fn read_over_orient(&mut self, word: Token<'a>) {
        while parse_number(self.lexer.peek().text).is_some() {
            self.lexer.next();
        }
        if !std::mem::replace(&mut self.orient_reported, true) {
            let lexer = &self.lexer;
            self.warnings
                .push(|| format!("{}: `orient` is not used", lexer.place(word)));
        }
    }

    fn read_end(&mut self) -> Result<(), LoadError> {
        let word = self.lexer.next();
        let mut joint = word;
        while !joint.is_end() {
            if is_joint(joint.text) {
                let expected = "the end of the file after the one root joint";
                return Err(self.lexer.fault(joint, expected).into());
            }
            joint = self.lexer.next();
        }
        if !word.is_end() {
            let lexer = &self.lexer;
            self.warnings.push(|| {
                format!(
                    "{}: what follows the root joint is not used",
                    lexer.place(word)
                )
            });
        }
        Ok(())
    }
}

fn read_limit(lexer: &mut Lexer, word: Token) -> Result<Limit, FileFault> {
    let first = lexer.peek();
    let (min, max) = (read_bound(lexer, word)?, read_bound(lexer, word)?);
    if min > max {
        let expected = format!("the smaller value first after `{}`", word.text);
        return Err(lexer.fault_found(first, expected, format!("{min} and {max}")));
    }
    if min > LARGEST_COORDINATE || max < -LARGEST_COORDINATE {
        let expected = format!(
            "a range with an angle of at most 1e9 in size after `{}`",
            word.text
        );
        return Err(lexer.fault_found(first, expected, format!("{min} and {max}")));
    }
    Ok(Limit { min, max })
}

/// One end of a range. Programs write `1e10` or `inf` for no limit, and an end is only compared with.
fn read_bound(lexer: &mut Lexer, word: Token) -> Result<f64, FileFault> {
    let token = lexer.next();
    let bound = token.text.parse().ok();
    bound
        .filter(|bound: &f64| !bound.is_nan())
        .ok_or_else(|| lexer.fault(token, format!("a number after `{}`", word.text)))
}

fn looks_like_degrees(angle: f64) -> bool {
    /// A full turn, also where it is written with few digits.
    const TURN_IN_RADIANS: f64 = 1.01 * TAU;
    /// Beyond it an angle makes no sense in degrees either: ±1000, ±100000 and ±1e10 are ways to say that there is no limit.
    const TURN_IN_DEGREES: f64 = 360.0;
    (TURN_IN_RADIANS..=TURN_IN_DEGREES).contains(&angle.abs())
}

fn is_joint(word: &str) -> bool {
    matches!(word, "balljoint" | "joint")
}

#[cfg(test)]
mod tests;
