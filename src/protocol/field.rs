//! Which field of a request is at fault, and why.
//! Never lives here: what else can go wrong with a request.

use std::borrow::Cow;
use std::fmt;

/// The way from the parameters of a request to one of their fields, e.g. `lights[1].color`. Empty, it is the parameters themselves.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FieldPath(Vec<Segment>);

/// One step of a [`FieldPath`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Segment {
    /// To a member of an object, by its whole name: that of a degree of freedom may have dots of its own.
    Name(Cow<'static, str>),
    /// To an element of a list.
    Index(usize),
}

impl FieldPath {
    /// The path to a member of what this one leads to.
    #[must_use]
    pub fn field(mut self, name: impl Into<Cow<'static, str>>) -> Self {
        self.0.push(Segment::Name(name.into()));
        self
    }

    /// The path to an element of what this one leads to.
    #[must_use]
    pub fn index(mut self, index: usize) -> Self {
        self.0.push(Segment::Index(index));
        self
    }

    /// The path to what `inner` leads to from where this one leads.
    #[must_use]
    pub fn join(mut self, inner: Self) -> Self {
        self.0.extend(inner.0);
        self
    }

    /// The steps from the parameters inward, none for the parameters themselves.
    pub fn segments(&self) -> &[Segment] {
        &self.0
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (position, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Name(name) => {
                    let dot = if position == 0 { "" } else { "." };
                    write!(f, "{dot}{}", shortened(name))?;
                }
                Segment::Index(index) => write!(f, "[{index}]")?,
            }
        }
        if self.0.is_empty() {
            f.write_str("params")?;
        }
        Ok(())
    }
}

impl From<&'static str> for FieldPath {
    /// A field at the top.
    fn from(name: &'static str) -> Self {
        Self::default().field(name)
    }
}

impl<const N: usize> From<[&'static str; N]> for FieldPath {
    /// One field inside the other.
    fn from(names: [&'static str; N]) -> Self {
        names.into_iter().fold(Self::default(), Self::field)
    }
}

impl From<(&'static str, usize)> for FieldPath {
    /// An element of a list at the top.
    fn from((name, index): (&'static str, usize)) -> Self {
        Self::from(name).index(index)
    }
}

/// A field that cannot be worked with: where it is, what was expected there, and what was found.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {message}")]
pub struct FieldFault {
    /// From the parameters of the request; of a fault beside them, from the line's own members.
    pub path: FieldPath,
    /// What was expected and what was found, without the path.
    pub message: String,
}

impl FieldFault {
    /// `path` starts from the parameters, or from a part of them that [`FieldFault::within`] puts in its place later.
    pub fn new(path: impl Into<FieldPath>, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            message: message.into(),
        }
    }

    /// The same fault as seen from further out: of the part of the request that `outer` leads to.
    #[must_use]
    pub fn within(self, outer: impl Into<FieldPath>) -> Self {
        Self {
            path: outer.into().join(self.path),
            ..self
        }
    }
}

/// As much of a text from outside as a message can carry.
pub fn shortened(text: &str) -> Cow<'_, str> {
    const LONGEST_BYTES: usize = 160;
    if text.len() <= LONGEST_BYTES {
        return text.into();
    }
    let mut end = LONGEST_BYTES;
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    format!("{}…", &text[..end]).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_shown_as_the_wire_has_it() {
        let elbow = String::from("elbow.rx");
        for (path, shown) in [
            (FieldPath::default(), "params"),
            (FieldPath::default().index(3), "[3]"),
            (FieldPath::from("size").index(1), "size[1]"),
            (
                FieldPath::from(("lights", 1)).field("color"),
                "lights[1].color",
            ),
            (["pose", "dofs"].into(), "pose.dofs"),
            (
                FieldPath::from(["pose", "dofs"]).field(elbow),
                "pose.dofs.elbow.rx",
            ),
        ] {
            assert_eq!(path.to_string(), shown);
        }
        let long = FieldPath::from("pose")
            .field("x".repeat(100_000))
            .to_string();
        assert!(long.starts_with("pose.xxx") && long.ends_with('…') && long.len() < 200);
    }

    #[test]
    fn a_fault_of_a_part_is_one_of_the_whole() {
        let of_light = FieldFault::new("color", "expected three numbers");
        let of_frame = of_light.within(("lights", 1));
        let of_batch = of_frame.within(("frames", 7));
        assert_eq!(
            of_batch.to_string(),
            "frames[7].lights[1].color: expected three numbers"
        );
        let names = FieldPath::from(("frames", 7))
            .join(("lights", 1).into())
            .field("color");
        assert_eq!(of_batch.path.segments(), names.segments());
    }

    #[test]
    fn text_is_shortened_between_characters() {
        assert_eq!(shortened("short"), "short");
        assert_eq!(shortened(&"é".repeat(200)).chars().count(), 81);
        assert_eq!(shortened(&"€".repeat(200)).chars().count(), 54);
    }
}
