//! Reads a MIT 6.837 `.skel`: one tree of joints, a line each.
//! Never lives here: uniqueness of names, and where the joints end up in space.
//!
//! ```text
//! skel  := joint*                      one at least
//! joint := x y z parent [NAME]         on a line of its own; empty lines do not count
//! ```
//! Joints are counted from 0 in the order of their lines. `parent` is the number of an earlier one, and -1 for the first joint
//! alone, which is the root; `x y z` is from the parent's origin. Names are one student's extension.

use crate::formats::error::{FileFault, LoadError};
use crate::formats::lexer::{Lexer, Token, parse_number};
use crate::limits::Limits;
use crate::rig::{Axis, JointDraft, RotationOrder, Warnings};
use glam::DVec3;

/// Joints in the order of their lines, which puts parents before their children.
///
/// # Errors
/// [`LoadError::Invalid`] at the first word that does not fit, [`LoadError::Limit`] at the first joint too many.
pub(in crate::formats) fn read(
    mut lexer: Lexer,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Vec<JointDraft>, LoadError> {
    let mut joints = Vec::new();
    let mut first = lexer.next();
    if first.is_end() {
        return Err(lexer.fault(first, "a joint: `x y z parent`").into());
    }
    while !first.is_end() {
        let index = joints.len();
        limits.joints(index + 1)?;
        joints.push(read_joint(&mut lexer, first, index, warnings)?);
        first = lexer.next();
    }
    Ok(joints)
}

/// Takes the whole line, of which `word` is the first.
fn read_joint<'a>(
    lexer: &mut Lexer<'a>,
    mut word: Token<'a>,
    index: usize,
    warnings: &mut Warnings,
) -> Result<JointDraft, FileFault> {
    let mut offset = DVec3::ZERO;
    for axis in Axis::ALL {
        offset[axis.index()] = lexer.number_at(word, || format!("in joint {index}"))?;
        word = lexer.next_in_line();
    }
    let parent = parent_of(lexer, word, index)?;
    let name = read_name(lexer, index, warnings)?;
    Ok(JointDraft {
        name: name.to_owned(),
        parent,
        offset,
        rotation_order: RotationOrder::Xyz,
        translates: parent.is_none(),
        ..JointDraft::default()
    })
}

fn parent_of(lexer: &Lexer, word: Token, index: usize) -> Result<Option<usize>, FileFault> {
    if index == 0 {
        if word.text == "-1" {
            return Ok(None);
        }
        let expected = "the parent -1 in joint 0, which is the root";
        return Err(lexer.fault(word, expected));
    }
    match word.text.parse() {
        Ok(parent) if parent < index => Ok(Some(parent)),
        _ => {
            let expected = format!("a parent from 0 to {} in joint {index}", index - 1);
            Err(lexer.fault(word, expected))
        }
    }
}

/// The name of a joint, empty where its line ends, and whatever else its line has.
fn read_name<'a>(
    lexer: &mut Lexer<'a>,
    index: usize,
    warnings: &mut Warnings,
) -> Result<&'a str, FileFault> {
    /// A name stands in each DOF's name again and in replies.
    const NAME_BYTES: usize = 256;
    let name = lexer.next_in_line();
    if name.ends_line() {
        return Ok("");
    }
    // A fifth number is no name but a line of some other format, which would be read as a wrong tree.
    if parse_number(name.text).is_some() {
        let expected = format!("a name or the end of the line after joint {index}");
        return Err(lexer.fault(name, expected));
    }
    if name.text.len() > NAME_BYTES {
        let expected = format!("a name of at most {NAME_BYTES} bytes after joint {index}");
        let found = format!("one of {} bytes", name.text.len());
        return Err(lexer.fault_found(name, expected, found));
    }
    skip_rest(lexer, warnings);
    Ok(name.text)
}

fn skip_rest(lexer: &mut Lexer, warnings: &mut Warnings) {
    let word = lexer.next_in_line();
    if word.ends_line() {
        return;
    }
    warnings.push(|| {
        let place = lexer.place(word);
        format!("{place}: what follows the name of a joint is not used")
    });
    while !lexer.next_in_line().ends_line() {}
}
