//! Normals or texture coordinates of an OBJ, which belong to corners there, brought to its vertices.
//! Never lives here: splitting vertices, for other files count them.

use crate::formats::lexer::{Lexer, Token};
use crate::rig::Warnings;

/// A list of values and which vertex uses which of them.
#[derive(Debug)]
pub(super) struct Attribute<'a, T> {
    /// Of one and of many.
    nouns: (&'static str, &'static str),
    /// In file order; a file's bytes bound them.
    values: Vec<T>,
    /// Index of the value that each vertex used first.
    of_vertex: Vec<Option<u32>>,
    /// The first corner of all that has none.
    without: Option<Token<'a>>,
    /// The first corner whose vertex had another value before.
    differs: Option<Token<'a>>,
}

impl<'a, T: Copy + Default + PartialEq> Attribute<'a, T> {
    pub(super) fn new(nouns: (&'static str, &'static str)) -> Self {
        Self {
            nouns,
            values: Vec::new(),
            of_vertex: Vec::new(),
            without: None,
            differs: None,
        }
    }

    pub(super) fn push(&mut self, value: T) {
        self.values.push(value);
    }

    pub(super) fn value_count(&self) -> usize {
        self.values.len()
    }

    pub(super) fn many(&self) -> &'static str {
        self.nouns.1
    }

    /// Notes that a corner, told at `place`, gives its vertex the value `index`, which is in range.
    pub(super) fn note(&mut self, vertex: u32, index: Option<u32>, place: Token<'a>) {
        let Some(index) = index else {
            self.without.get_or_insert(place);
            return;
        };
        let vertex = vertex as usize;
        if self.of_vertex.len() <= vertex {
            self.of_vertex.resize(vertex + 1, None);
        }
        let first = *self.of_vertex[vertex].get_or_insert(index);
        // Exporters write equal values many times over, so it is not the index that counts.
        if self.values[first as usize] != self.values[index as usize] {
            self.differs.get_or_insert(place);
        }
    }

    /// The value of each vertex where all corners agree; a vertex of no face has the default. Otherwise none, with a warning.
    pub(super) fn finish(
        mut self,
        vertex_count: usize,
        lexer: &Lexer,
        warnings: &mut Warnings,
    ) -> Option<Vec<T>> {
        if self.values.is_empty() {
            return None;
        }
        let (one, many) = self.nouns;
        if self.of_vertex.is_empty() {
            let end = lexer.peek();
            warnings.push(|| {
                let place = lexer.place(end);
                format!("{place}: no face uses the file's {many}")
            });
            return None;
        }
        let odd = match (self.differs, self.without) {
            (Some(differs), _) => Some((differs, format!("a second {one} for a vertex"))),
            (None, Some(without)) => Some((without, format!("a corner without a {one}"))),
            (None, None) => None,
        };
        if let Some((token, what)) = odd {
            warnings.push(|| {
                let place = lexer.place(token);
                format!("{place}: {what}; the file's {many} are not used")
            });
            return None;
        }
        self.of_vertex.resize(vertex_count, None);
        let value =
            |index: &Option<u32>| index.map_or(T::default(), |index| self.values[index as usize]);
        Some(self.of_vertex.iter().map(value).collect())
    }
}
