//! Reads a MIT 6.837 `.skel`: one tree of joints, a line each.
//! Never lives here: uniqueness of names, and where the joints end up in space.
//!
//! ```text
//! skel  := joint*                      one at least
//! joint := x y z parent [NAME]         on a line of its own; empty lines do not count; in place of a name a number is read over
//! ```
//! Joints are counted from 0 in the order of their lines. `parent` is the number of an earlier one, and -1 for the first joint
//! alone, which is the root; `x y z` is from the parent's origin. Names are one student's extension.

use crate::formats::error::{FileFault, LoadError};
use crate::formats::text::lexer::{Lexer, Token, parse_number};
use crate::limits::Limits;
use crate::rig::{Axis, JointDraft, RotationOrder, Warnings};
use glam::DVec3;

/// Joints in the order of their lines, which puts parents before their children.
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
        warnings,
        numbered: None,
    };
    let mut joints = Vec::new();
    let mut first = reader.lexer.next();
    if first.is_end() {
        let expected = "a joint: `x y z parent`";
        return Err(reader.lexer.fault(first, expected).into());
    }
    while !first.is_end() {
        let index = joints.len();
        limits.joints(index + 1)?;
        joints.push(reader.read_joint(first, index)?);
        first = reader.lexer.next();
    }
    reader.warn_of_numbers();
    Ok(joints)
}

struct Reader<'a, 'w> {
    lexer: Lexer<'a>,
    warnings: &'w mut Warnings,
    /// The first number behind a joint, and how many joints have one.
    numbered: Option<(Token<'a>, usize)>,
}

impl<'a> Reader<'a, '_> {
    /// Takes the whole line, of which `word` is the first.
    fn read_joint(&mut self, mut word: Token<'a>, index: usize) -> Result<JointDraft, FileFault> {
        let mut offset = DVec3::ZERO;
        for axis in Axis::ALL {
            let place = || format!("in joint {index}");
            offset[axis.index()] = self.lexer.number_at(word, place)?;
            word = self.lexer.next_in_line();
        }
        let parent = self.parent_of(word, index)?;
        let name = self.read_name(index)?;
        Ok(JointDraft {
            name: name.to_owned(),
            parent,
            offset,
            rotation_order: RotationOrder::Xyz,
            translates: parent.is_none(),
            ..JointDraft::default()
        })
    }

    fn parent_of(&self, word: Token<'a>, index: usize) -> Result<Option<usize>, FileFault> {
        if index == 0 {
            if word.text == "-1" {
                return Ok(None);
            }
            let expected = "the parent -1 in joint 0, which is the root";
            return Err(self.lexer.fault(word, expected));
        }
        match word.text.parse() {
            Ok(parent) if parent < index => Ok(Some(parent)),
            _ => {
                let parents = match index {
                    1 => "the parent 0".to_owned(),
                    _ => format!("a parent from 0 to {}", index - 1),
                };
                let expected = format!("{parents} in joint {index}");
                Err(self.lexer.fault(word, expected))
            }
        }
    }

    /// The name of a joint, empty where its line ends or goes on with a number, and whatever else its line has.
    fn read_name(&mut self, index: usize) -> Result<&'a str, FileFault> {
        /// A name stands in each DOF's name again and in replies.
        const NAME_BYTES: usize = 256;
        let word = self.lexer.next_in_line();
        if word.ends_line() {
            return Ok("");
        }
        // The course's own loader takes four numbers of a line and reads no further, so that some files number their lines.
        if parse_number(word.text).is_some() {
            self.numbered.get_or_insert((word, 0)).1 += 1;
            self.skip_line();
            return Ok("");
        }
        let name = self.lexer.unquoted(word);
        if name.text.len() > NAME_BYTES {
            let expected = format!("a name of at most {NAME_BYTES} bytes after joint {index}");
            let found = format!("one of {} bytes", name.text.len());
            return Err(self.lexer.fault_found(name, expected, found));
        }
        let rest = self.lexer.next_in_line();
        if !rest.ends_line() {
            let lexer = &self.lexer;
            self.warnings.push(|| {
                let place = lexer.place(rest);
                format!("{place}: what follows the name of a joint is not used")
            });
            self.skip_line();
        }
        Ok(name.text)
    }

    fn skip_line(&mut self) {
        while !self.lexer.next_in_line().ends_line() {}
    }

    fn warn_of_numbers(&mut self) {
        let Some((first, count)) = self.numbered else {
            return;
        };
        let lexer = &self.lexer;
        self.warnings.push(|| {
            let place = lexer.place(first);
            let others = match count {
                1 => String::new(),
                _ => format!(", and so in {} lines more", count - 1),
            };
            format!("{place}: a number behind a joint is not used, nor what follows it{others}")
        });
    }
}
