//! Reads a MIT 6.837 `.attach`: how much each vertex of a mesh follows each joint of a skeleton.
//! Never lives here: the mesh and the skeleton themselves, and bringing weights to a sum of 1.
//!
//! ```text
//! attach := row*                       one for each vertex, in the order of the mesh
//! row    := weight*                    on a line of its own, one for each joint but the root; empty lines do not count
//! ```

use crate::formats::error::{FileFault, LoadError};
use crate::formats::lexer::{Lexer, Token};
use crate::limits::Limits;

/// What the weights are for: nothing in the file names it.
#[derive(Debug, Clone, Copy)]
pub(in crate::formats) struct AttachedTo<'a> {
    pub mesh_file: &'a str,
    pub vertex_count: usize,
    pub skeleton_file: &'a str,
    pub joint_count: usize,
}

/// As in [`MeshDraft`](crate::rig::MeshDraft), but with joints in the place of bindings. No weight is 0 or less.
#[derive(Debug, Default, PartialEq)]
pub(in crate::formats) struct Attachments {
    /// One for each vertex.
    pub influence_counts: Vec<u32>,
    /// `(joint, weight)` of every vertex, one vertex after another.
    pub influences: Vec<(u32, f64)>,
}

/// # Errors
/// [`LoadError::Invalid`] at the word or line end that does not fit, [`LoadError::Limit`] at the first influence too many.
pub(in crate::formats) fn read(
    lexer: Lexer,
    to: AttachedTo,
    limits: &Limits,
) -> Result<Attachments, LoadError> {
    let mut reader = Reader {
        lexer,
        to,
        limits,
        attachments: Attachments::default(),
    };
    reader.read_rows()?;
    Ok(reader.attachments)
}

struct Reader<'a> {
    lexer: Lexer<'a>,
    to: AttachedTo<'a>,
    limits: &'a Limits,
    attachments: Attachments,
}

impl<'a> Reader<'a> {
    fn read_rows(&mut self) -> Result<(), LoadError> {
        let mut first = self.lexer.next();
        if self.to.joint_count < 2 {
            // Its rows would be empty, and could not be told from lines that do not count.
            let expected = "a skeleton with joints besides its root";
            let found = format!("`{}` without any", self.to.skeleton_file);
            return Err(self.lexer.fault_found(first, expected, found).into());
        }
        for vertex in 0..self.to.vertex_count {
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
        let influences = &mut self.attachments.influences;
        let kept_before = influences.len();
        for joint in 1..self.to.joint_count {
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
            let found = self.to.joint_count - 1 + surplus;
            return Err(self.wrong_length(word, vertex, found).into());
        }
        let kept = influences.len() - kept_before;
        self.attachments.influence_counts.push(kept as u32);
        Ok(())
    }

    fn wrong_length(&self, place: Token, vertex: usize, found: usize) -> FileFault {
        let (weights, file) = (self.to.joint_count - 1, self.to.skeleton_file);
        let expected = format!(
            "{weights} weights {}, one for each joint of `{file}` but the root",
            in_vertex(vertex)
        );
        self.lexer.fault_found(place, expected, found.to_string())
    }

    fn rows_expected(&self) -> String {
        let (rows, file) = (self.to.vertex_count, self.to.mesh_file);
        format!("{rows} rows, one for each vertex of `{file}`")
    }

    fn too_many_rows(&mut self, first: Token<'a>) -> FileFault {
        let mut rows = self.to.vertex_count;
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
