//! A request on its way in: one line, of which as much as possible is understood even where it is wrong.
//! Never lives here: where lines end, how long they may be, and what a method's parameters are.

use super::error::Fault;
use super::field::{FieldFault, FieldPath, shortened};
use super::id::Id;
use super::strict::{self, expected_but_found, of_syntax, unknown_field};
use serde::Deserializer;
use serde::de::{DeserializeOwned, Error, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor};
use serde_json::value::RawValue;
use std::fmt;

/// A request or, without an `id`, a notification. Its parameters are still raw; [`params`](fn@super::params) types them.
#[derive(Debug, Clone)]
pub struct Request {
    /// `None` makes it a notification, which is never answered. `null` is an id like any other.
    pub id: Option<Id>,
    /// As the line spells it; whether there is such a method is not known yet.
    pub method: String,
    /// The text of a JSON object. `None` where the line has no `params`, which reads as `{}`.
    pub params: Option<Box<RawValue>>,
    /// Milliseconds from arrival.
    pub deadline_ms: Option<u64>,
    /// Raw bytes that follow the line.
    pub attach_bytes: u64,
}

/// A line that is no request. It is answered all the same, and the connection goes on behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct BadRequest {
    /// For the reply: null where none could be read.
    pub id: Id,
    /// Raw bytes that follow the line. `None` where the line seems to announce some and their number cannot be read: where the next line
    /// starts is then anybody's guess.
    pub attach_bytes: Option<u64>,
    /// What is wrong with the line: broken JSON or UTF-8 wherever it stands, else the first member at fault.
    pub fault: Fault,
}

const MEMBERS: [&str; 6] = [
    "jsonrpc",
    "id",
    "method",
    "params",
    "deadline_ms",
    "attach_bytes",
];

impl Request {
    /// From one line, with or without its end.
    ///
    /// # Errors
    /// [`BadRequest`], with as much of the id and the framing as could be read.
    pub fn parse(line: &[u8]) -> Result<Self, BadRequest> {
        let mut draft = Draft::default();
        let outcome = std::str::from_utf8(line)
            .map_err(|problem| Fault::ParseError {
                message: format!(
                    "the line is not UTF-8: see byte {}",
                    problem.valid_up_to() + 1
                ),
            })
            .and_then(|text| draft.read(text));
        match outcome.and_then(|()| draft.method()) {
            Ok(method) => Ok(Self {
                id: draft.id,
                method,
                params: draft.params,
                deadline_ms: draft.deadline_ms,
                attach_bytes: draft.attach_bytes.unwrap_or(0),
            }),
            Err(fault) => Err(BadRequest {
                attach_bytes: draft.framing(line, &fault),
                id: draft.id.unwrap_or(Id::Null),
                fault,
            }),
        }
    }
}

/// What has been read of a line so far, and the first thing that was wrong with it. Reading goes on behind a fault, so that the id and the
/// framing are known wherever in the line they stand.
#[derive(Default)]
struct Draft {
    seen: [bool; MEMBERS.len()],
    id: Option<Id>,
    method: Option<String>,
    params: Option<Box<RawValue>>,
    deadline_ms: Option<u64>,
    attach_bytes: Option<u64>,
    fault: Option<Fault>,
}

impl Draft {
    fn read(&mut self, text: &str) -> Result<(), Fault> {
        let mut inner = serde_json::Deserializer::from_str(text);
        (&mut inner)
            .deserialize_any(LineVisitor(self))
            .and_then(|()| inner.end())
            .map_err(|error| match self.fault.take() {
                Some(fault) if error.is_data() => fault,
                _ => {
                    let (reason, column) = (of_syntax(&error), error.column());
                    let message = format!("{reason} at column {column} of the line");
                    Fault::ParseError { message }
                }
            })?;
        match self.fault.take() {
            Some(fault) => Err(fault),
            None => Ok(()),
        }
    }

    fn method(&mut self) -> Result<String, Fault> {
        if !self.seen[0] {
            return Err(invalid(
                "jsonrpc",
                "expected `\"2.0\"`, but the member is missing",
            ));
        }
        self.method
            .take()
            .ok_or_else(|| invalid("method", "the member is missing"))
    }

    fn framing(&self, line: &[u8], fault: &Fault) -> Option<u64> {
        let name = b"attach_bytes";
        let cut_short = matches!(fault, Fault::ParseError { .. });
        let announced =
            self.seen[5] || (cut_short && line.windows(name.len()).any(|window| window == name));
        if announced {
            self.attach_bytes
        } else {
            Some(0)
        }
    }

    fn complain(&mut self, member: &str, message: impl Into<String>) {
        if self.fault.is_none() {
            self.fault = Some(invalid(member, message));
        }
    }

    fn member(&mut self, key: &str, raw: &RawValue) {
        let Some(index) = MEMBERS.iter().position(|member| *member == key) else {
            self.complain(key, unknown_field(key, &MEMBERS));
            return;
        };
        if std::mem::replace(&mut self.seen[index], true) {
            self.complain(key, format!("`{key}` is given twice"));
            return;
        }
        match key {
            "jsonrpc" => {
                let version = serde_json::from_str::<String>(raw.get());
                if version.is_ok_and(|version| version == "2.0") {
                    return;
                }
                let found = shortened(raw.get());
                self.complain(key, format!("expected `\"2.0\"`, but found `{found}`"));
            }
            "id" => self.id = self.typed(key, raw),
            "method" => self.method = self.typed(key, raw),
            "params" if raw.get().starts_with('{') => self.params = Some(raw.to_owned()),
            "params" => self.complain(key, "expected an object: parameters go by name"),
            "deadline_ms" => self.deadline_ms = self.typed(key, raw),
            _ => self.attach_bytes = self.typed(key, raw),
        }
    }

    fn typed<T: DeserializeOwned>(&mut self, key: &str, raw: &RawValue) -> Option<T> {
        strict::from_str(raw.get())
            .map_err(|fault| self.complain(key, fault.message))
            .ok()
    }
}

fn invalid(member: &str, message: impl Into<String>) -> Fault {
    Fault::InvalidMember(FieldFault::new(
        FieldPath::default().field(member.to_owned()),
        message,
    ))
}

struct LineVisitor<'a>(&'a mut Draft);

impl LineVisitor<'_> {
    /// The error stands for a fault that is kept.
    fn refuse<E: Error>(self, found: Unexpected) -> Result<(), E> {
        let message = expected_but_found("a request, which is an object", found);
        self.0.fault = Some(Fault::InvalidRequest { message });
        Err(E::custom(""))
    }
}

impl<'de> Visitor<'de> for LineVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a request, which is an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        while let Some(key) = members.next_key::<String>()? {
            self.0.member(&key, members.next_value()?);
        }
        Ok(())
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<(), E> {
        self.refuse(Unexpected::Bool(value))
    }

    fn visit_i64<E: Error>(self, integer: i64) -> Result<(), E> {
        self.refuse(Unexpected::Signed(integer))
    }

    fn visit_u64<E: Error>(self, integer: u64) -> Result<(), E> {
        self.refuse(Unexpected::Unsigned(integer))
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<(), E> {
        self.refuse(Unexpected::Float(number))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<(), E> {
        self.refuse(Unexpected::Str(text))
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.refuse(Unexpected::Unit)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        // To the end, since a broken list is a broken line.
        while seq.next_element::<IgnoredAny>()?.is_some() {}
        self.0.fault = Some(Fault::InvalidRequest {
            message: "expected a request, but found a list: write one request to a line; many may be written before a reply is read".to_owned(),
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests;
