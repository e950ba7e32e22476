//! Lines of text drawn as a tree. Never lives here: what they say.

use std::fmt::Write;

/// Nodes are added parents first. It is drawn without recursion, so that a tree may be as deep as it likes.
#[derive(Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    roots: Vec<usize>,
}

struct Node {
    line: String,
    /// Lines between this one and its children.
    notes: Vec<String>,
    children: Vec<usize>,
}

/// Levels that are drawn. Below, lines say how deep they are: a chain of joints would take a page to indent, and each a longer one.
const MOST_LEVELS: usize = 40;

impl Tree {
    /// Its number, to be the parent of others.
    pub(super) fn push(&mut self, parent: Option<usize>, line: String) -> usize {
        let index = self.nodes.len();
        match parent {
            Some(parent) => self.nodes[parent].children.push(index),
            None => self.roots.push(index),
        }
        self.nodes.push(Node {
            line: one_line(line),
            notes: Vec::new(),
            children: Vec::new(),
        });
        index
    }

    pub(super) fn note(&mut self, node: usize, line: String) {
        self.nodes[node].notes.push(one_line(line));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    pub(super) fn write(&self, text: &mut String) -> std::fmt::Result {
        let mut waiting = Vec::new();
        stack(&mut waiting, &self.roots, 0, "");
        while let Some(Waiting {
            node,
            level,
            before,
            is_last,
        }) = waiting.pop()
        {
            let Node {
                line,
                notes,
                children,
            } = &self.nodes[node];
            let (branch, below) = if is_last {
                ("└─ ", "   ")
            } else {
                ("├─ ", "│  ")
            };
            let (branch, inner) = if level < MOST_LEVELS {
                (format!("{before}{branch}"), format!("{before}{below}"))
            } else {
                (format!("{before}… {level} "), before)
            };
            writeln!(text, "{branch}{line}")?;
            let to_children = if children.is_empty() { "  " } else { "│ " };
            for note in notes {
                writeln!(text, "{inner}{to_children}  {note}")?;
            }
            stack(&mut waiting, children, level + 1, &inner);
        }
        Ok(())
    }
}

/// Names out of a file may hold line ends, or what terminals act on.
fn one_line(line: String) -> String {
    if !line.contains(char::is_control) {
        return line;
    }
    let mut plain = String::with_capacity(line.len());
    for c in line.chars() {
        if c.is_control() {
            plain.extend(c.escape_default());
        } else {
            plain.push(c);
        }
    }
    plain
}

struct Waiting {
    node: usize,
    level: usize,
    before: String,
    is_last: bool,
}

/// Puts siblings on the stack, the first one on top.
fn stack(waiting: &mut Vec<Waiting>, siblings: &[usize], level: usize, before: &str) {
    for (place, node) in siblings.iter().enumerate().rev() {
        waiting.push(Waiting {
            node: *node,
            level,
            before: before.to_owned(),
            is_last: place + 1 == siblings.len(),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_hang_from_their_parents() {
        let mut tree = Tree::default();
        let hip = tree.push(None, "hip".to_owned());
        let thigh = tree.push(Some(hip), "thigh".to_owned());
        let spine = tree.push(Some(hip), "spine".to_owned());
        tree.push(Some(thigh), "shin".to_owned());
        tree.note(hip, ".rx".to_owned());
        tree.note(thigh, ".rx".to_owned());
        tree.note(spine, ".r\nx".to_owned());
        let mut text = String::new();
        tree.write(&mut text).unwrap();
        let wanted = "\
└─ hip
   │   .rx
   ├─ thigh
   │  │   .rx
   │  └─ shin
   └─ spine
          .r\\nx
";
        assert_eq!(text, wanted);
    }

    #[test]
    fn a_chain_is_not_indented_for_ever() {
        let mut tree = Tree::default();
        let mut parent = None;
        for joint in 0..20_000 {
            parent = Some(tree.push(parent, format!("joint {joint}")));
        }
        let mut text = String::new();
        tree.write(&mut text).unwrap();
        assert_eq!(text.lines().count(), 20_000);
        assert!(text.lines().all(|line| line.chars().count() < 150));
        assert!(
            text.lines()
                .last()
                .unwrap()
                .ends_with("… 19999 joint 19999")
        );
    }
}
