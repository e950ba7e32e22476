//! The members of an object, whose keys are each given once and, where the names are known, are among them.
//! Never lives here: what a member's value has to be.

use super::Inside;
use super::mismatch::{Detour, Mismatch};
use crate::protocol::field::FieldPath;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, Visitor};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;

pub(super) struct Members<'de, 's, A> {
    members: A,
    keys: Keys<'de>,
    detour: &'s Detour,
}

impl<'s, A> Members<'_, 's, A> {
    pub(super) fn new(
        members: A,
        fields: Option<&'static [&'static str]>,
        detour: &'s Detour,
    ) -> Self {
        let keys = Keys {
            fields,
            seen_fields: 0,
            seen_names: BTreeSet::new(),
            last: Cow::default(),
        };
        Self {
            members,
            keys,
            detour,
        }
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Members<'de, '_, A> {
    type Error = Mismatch;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Mismatch> {
        let (keys, detour) = (&mut self.keys, self.detour);
        let next = self.members.next_key_seed(Key { seed, keys, detour });
        next.map_err(|error| detour.leave(&error))
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Mismatch> {
        let detour = self.detour;
        let value = self.members.next_value_seed(Inside { seed, detour });
        value.map_err(|error| detour.leave(&error).within(self.keys.path()))
    }
}

/// The keys so far. Neither a known field nor a key that stands in the text as it is takes a string of its own.
struct Keys<'de> {
    fields: Option<&'static [&'static str]>,
    /// A bit for each of the first fields.
    seen_fields: u64,
    /// All other keys.
    seen_names: BTreeSet<Cow<'de, str>>,
    last: Cow<'de, str>,
}

impl<'de> Keys<'de> {
    fn take(&mut self, key: Cow<'de, str>) -> Result<(), Mismatch> {
        self.last = key.clone();
        let field = self
            .fields
            .map(|fields| {
                let known = fields.iter().position(|field| *field == key);
                known.ok_or_else(|| Mismatch::unknown_field(&key, fields))
            })
            .transpose()?;
        let is_first = match field {
            Some(field @ 0..64) => {
                let bit = 1 << field;
                let is_first = self.seen_fields & bit == 0;
                self.seen_fields |= bit;
                is_first
            }
            _ => self.seen_names.insert(key),
        };
        if is_first {
            Ok(())
        } else {
            Err(Mismatch::new("the key is given twice"))
        }
    }

    /// To the member of the last key.
    fn path(&self) -> FieldPath {
        FieldPath::default().field(self.last.clone().into_owned())
    }
}

struct Key<'k, 'de, S> {
    seed: S,
    keys: &'k mut Keys<'de>,
    detour: &'k Detour,
}

impl<'de, S: DeserializeSeed<'de>> Key<'_, 'de, S> {
    fn read(self, key: Cow<'de, str>) -> Result<S::Value, Mismatch> {
        let Self { seed, keys, .. } = self;
        let read = keys.take(key);
        let read = read.and_then(|()| seed.deserialize(StrDeserializer::new(&keys.last)));
        read.map_err(|mismatch| mismatch.within(keys.path()))
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Key<'_, 'de, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, inner: D) -> Result<S::Value, D::Error> {
        inner.deserialize_str(self)
    }
}

impl<'de, S: DeserializeSeed<'de>> Visitor<'de> for Key<'_, 'de, S> {
    type Value = S::Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_borrowed_str<E: Error>(self, key: &'de str) -> Result<S::Value, E> {
        let detour = self.detour;
        let read = self.read(key.into());
        read.map_err(|mismatch| detour.enter(mismatch))
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<S::Value, E> {
        let detour = self.detour;
        let read = self.read(key.to_owned().into());
        read.map_err(|mismatch| detour.enter(mismatch))
    }
}
