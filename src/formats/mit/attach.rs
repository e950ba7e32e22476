//! Reads a MIT 6.837 `.attach`: how much each vertex of a mesh follows each joint of a skeleton.
//! Never lives here: the mesh and the skeleton themselves, and bringing weights to a sum of 1.
//!
//! ```text
//! attach := row*                       one for each vertex, in the order of the mesh
//! row    := weight*                    on a line of its own, one for each joint but the root; empty lines do not count
//! ```

use crate::formats::contribution::{KnownMesh, KnownSkeleton, Weights};
use crate::formats::error::{FileFault, LoadError};
use crate::formats::text::lexer::{Lexer, Token};
use crate::limits::Limits;
use crate::rig::{BindPose, BindingDraft, JointDraft};
use glam::{DAffine3, DVec3};

/// One binding for each joint; no weight is 0 or less.
///
/// # Errors
/// [`LoadError::Invalid`] at the word or line end that does not fit, [`LoadError::Limit`] at the first influence too many.
pub(super) fn read(
    lexer: Lexer,
    mesh: KnownMesh,
    skeleton: KnownSkeleton,
    limits: &Limits,
) -> Result<Weights, LoadError> {
    let mut reader = Reader {
        lexer,
        mesh,
        skeleton,
        limits,
        weights: Weights {
            bindings: bindings(skeleton.joints),
            ..Weights::default()
        },
    };
    reader.read_rows()?;
    Ok(reader.weights)
}

struct Reader<'a> {
    lexer: Lexer<'a>,
    mesh: KnownMesh<'a>,
    skeleton: KnownSkeleton<'a>,
    limits: &'a Limits,
    weights: Weights,
}

impl<'a> Reader<'a> {
    fn read_rows(&mut self) -> Result<(), LoadError> {
        let mut first = self.lexer.next();
        if self.skeleton.joints.len() < 2 {
            // Its rows would be empty, like lines that do not count.
            let expected = "a skeleton with joints besides its root";
            let found = format!("`{}` without any", self.skeleton.file);
            return Err(self.lexer.fault_found(first, expected, found).into());
        }
        for vertex in 0..self.mesh.vertex_count {
            if first.is_end() {
                let found = format!("the end of the file after {vertex}");
                let rows = self.rows_expected();
                return Err(self.lexer.fault_found(first, rows, found).into());
            }
            self.read_row(first, vertex)?;
            first = self.lexer.next();
        }
        if !first.is_end() {
            return Err(self.too_many_rows(first).into());
        }
        Ok(())
    }

    /// Takes the whole line, of which `word` is the first.
    fn read_row(&mut self, mut word: Token<'a>, vertex: usize) -> Result<(), LoadError> {
        let influences = &mut self.weights.influences;
        let kept_before = influences.len();
        for joint in 1..self.skeleton.joints.len() {
            if word.ends_line() {
                return Err(self.wrong_length(word, vertex, joint - 1).into());
            }
            let weight = self.lexer.number_at(word, || in_vertex(vertex))?;
            if weight < 0.0 {
                let expected = format!("a weight that is not negative {}", in_vertex(vertex));
                return Err(self.lexer.fault(word, expected).into());
            }
            // Most are zero: rows are as long as the skeleton whatever moves their vertex.
            if weight > 0.0 {
                self.limits.influences(influences.len() + 1)?;
                // A skeleton with more joints than 32 bits can count fits no file.
                influences.push((joint as u32, weight));
            }
            word = self.lexer.next_in_line();
        }
        if !word.ends_line() {
            let surplus = self.words_to_line_end(word);
            let found = self.skeleton.joints.len() - 1 + surplus;
            return Err(self.wrong_length(word, vertex, found).into());
        }
        let kept = influences.len() - kept_before;
        self.weights.influence_counts.push(kept as u32);
        Ok(())
    }

    fn wrong_length(&self, place: Token, vertex: usize, found: usize) -> FileFault {
        let (weights, file) = (self.skeleton.joints.len() - 1, self.skeleton.file);
        let expected = format!(
            "{weights} weights {}, one for each joint of `{file}` but the root",
            in_vertex(vertex)
        );
        self.lexer.fault_found(place, expected, found.to_string())
    }

    fn rows_expected(&self) -> String {
        let (rows, file) = (self.mesh.vertex_count, self.mesh.file);
        format!("{rows} rows, one for each vertex of `{file}`")
    }

    fn too_many_rows(&mut self, first: Token<'a>) -> FileFault {
        let mut rows = self.mesh.vertex_count;
        let mut word = first;
        while !word.is_end() {
            rows += 1;
            self.words_to_line_end(word);
            word = self.lexer.next();
        }
        let found = format!("{rows} in all");
        self.lexer.fault_found(first, self.rows_expected(), found)
    }

    /// How many words the line has from `word` on, which has been taken.
    fn words_to_line_end(&mut self, mut word: Token<'a>) -> usize {
        let mut words = 0;
        while !word.ends_line() {
            words += 1;
            word = self.lexer.next_in_line();
        }
        words
    }
}

fn in_vertex(vertex: usize) -> String {
    format!("in vertex {vertex}")
}

/// The bind poses of the course's meshes: each joint where it is when nothing is turned, one binding per joint.
/// Parents stand before their children, as [`skel::read`](super::skel::read) gives them.
pub(super) fn bindings(joints: &[JointDraft]) -> Vec<BindingDraft> {
    let mut positions_in_bind: Vec<DVec3> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent_position_in_bind = joint
            .parent
            .map_or(DVec3::ZERO, |parent| positions_in_bind[parent]);
        positions_in_bind.push(parent_position_in_bind + joint.offset);
    }
    let binding = |(joint, position_in_bind)| BindingDraft {
        file: None,
        joint: Some(joint),
        bind_pose: BindPose::BindFromJoint(DAffine3::from_translation(position_in_bind)),
    };
    positions_in_bind
        .into_iter()
        .enumerate()
        .map(binding)
        .collect()
}
