//! The error of a [`Strict`](super::Strict) deserializer: a field and what is wrong with it, in the words of this protocol.
//! Never lives here: what is held to which rule.

use crate::protocol::field::{FieldFault, FieldPath, shortened};
use crate::spelling::nearest;
use serde::de::{Error, Expected, Unexpected};
use std::borrow::Cow;
use std::cell::Cell;
use std::fmt::{self, Display};

/// What a type does not take. Boxed, since every result of every step carries it.
#[derive(Debug)]
pub(super) struct Mismatch(Box<FieldFault>);

impl Mismatch {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self::at(FieldPath::default(), message)
    }

    fn at(path: FieldPath, message: impl Into<String>) -> Self {
        Self(Box::new(FieldFault::new(path, message)))
    }

    pub(super) fn within(self, outer: FieldPath) -> Self {
        Self(Box::new(self.0.within(outer)))
    }

    pub(super) fn into_fault(self) -> FieldFault {
        *self.0
    }
}

impl Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for Mismatch {}

impl Error for Mismatch {
    fn custom<T: Display>(message: T) -> Self {
        let text = message.to_string();
        match text.split_once(FIELD_MARK) {
            Some((field, message)) => {
                let path = FieldPath::default().field(field.to_owned());
                Self::at(path, shortened(message))
            }
            None => Self::new(shortened(&text)),
        }
    }

    fn invalid_type(found: Unexpected, expected: &dyn Expected) -> Self {
        Self::new(expected_but_found(expected, found))
    }

    fn invalid_value(found: Unexpected, expected: &dyn Expected) -> Self {
        Self::new(expected_but_found(expected, found))
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        Self::new(shortened(&unknown_field(name, known)))
    }

    fn missing_field(field: &'static str) -> Self {
        Self::at(field.into(), "the field is missing")
    }
}

/// Something wrong with one field, found by rules about several fields of the same object once all of them were read.
pub(in crate::protocol) fn field_error<E: Error>(field: &str, message: impl Display) -> E {
    E::custom(format_args!("{field}{FIELD_MARK}{message}"))
}

/// Parts the field from the message of [`field_error`], for a type reads itself into any error and that takes nothing but one text. Text
/// from outside is escaped before it gets into a message, so that it cannot hold one.
const FIELD_MARK: char = '\u{1f}';

/// The sentence about a value that cannot be taken.
pub(in crate::protocol) fn expected_but_found(expected: impl Display, found: Unexpected) -> String {
    let found: Cow<'static, str> = match found {
        Unexpected::Unit => "null".into(),
        Unexpected::Seq => "a list".into(),
        Unexpected::Map => "an object".into(),
        // As JSON has it: 1e300, which would else be three hundred digits.
        Unexpected::Float(number) => format!("floating point `{}`", json(number)).into(),
        other => other.to_string().into(),
    };
    format!("expected {expected}, but found {}", shortened(&found))
}

fn json(number: f64) -> String {
    serde_json::Number::from_f64(number).map_or_else(String::new, |number| number.to_string())
}

/// The sentence about a name that is none of the known ones.
pub(in crate::protocol) fn unknown_field(name: &str, known: &[&str]) -> String {
    let hint = match nearest(name, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => "there are no fields here".to_owned(),
        None => format!("expected {}", OneOf(known)),
    };
    format!("unknown field `{}`; {hint}", shortened(name).escape_debug())
}

/// Names to choose from.
pub(super) struct OneOf<'a>(pub &'a [&'a str]);

impl Display for OneOf<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, others @ ..] = self.0 else {
            return f.write_str("nothing");
        };
        if !others.is_empty() {
            f.write_str("one of ")?;
        }
        write!(f, "`{first}`")?;
        others.iter().try_for_each(|name| write!(f, ", `{name}`"))
    }
}

/// What serde_json found wrong with the text itself, without the position.
pub(in crate::protocol) fn of_syntax(error: &impl Display) -> String {
    let text = error.to_string();
    // It gives its reason and the position as one text alone.
    let reason = text
        .rsplit_once(" at line ")
        .map_or(text.as_str(), |(reason, _)| reason);
    match reason {
        "number out of range" => "expected a finite number of 64 bits".to_owned(),
        other => shortened(other).into_owned(),
    }
}

/// Takes a [`Mismatch`] past the deserializer inside, whose own error can hold nothing but text.
#[derive(Default)]
pub(super) struct Detour(Cell<Option<Mismatch>>);

impl Detour {
    /// Keeps the mismatch, and gives the error to stand for it.
    pub(super) fn enter<E: Error>(&self, mismatch: Mismatch) -> E {
        self.0.set(Some(mismatch));
        E::custom("")
    }

    /// The mismatch that `error` stands for; where it stands for none, the text is no JSON.
    pub(super) fn leave(&self, error: &impl Display) -> Mismatch {
        let kept = self.0.take();
        kept.unwrap_or_else(|| Mismatch::new(of_syntax(error)))
    }
}
