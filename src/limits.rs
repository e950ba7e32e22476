//! Every ceiling of the daemon: a plain number with its unit and its reason, passed down to whoever must hold it.
//! Never lives here: the code that holds them.

/// A request asked for more than a ceiling allows. Raised before anything of that size is allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{asked} exceeds the limit `{limit}` of {maximum}")]
pub struct LimitExceeded {
    /// The field of [`Limits`] that was met.
    pub limit: &'static str,
    /// The value of that ceiling, in its unit.
    pub maximum: u64,
    /// How much the request came to, in the same unit; `u64::MAX` where it is more than 64 bits hold.
    pub asked: u64,
}

macro_rules! limits {
    ($($(#[$doc:meta])* $name:ident: $value:expr,)*) => {
        /// All ceilings, each a plain number. `Limits::default()` is what the daemon ships with.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct Limits { $($(#[$doc])* pub $name: u64,)* }

        impl Default for Limits {
            fn default() -> Self { Self { $($name: $value,)* } }
        }

        impl Limits {
            /// Name and value of each ceiling, in the order of declaration.
            pub fn entries(&self) -> impl Iterator<Item = (&'static str, u64)> {
                [$((stringify!($name), self.$name),)*].into_iter()
            }

            $($(#[$doc])*
            #[doc = ""]
            #[doc = "# Errors"]
            #[doc = "[`LimitExceeded`] where `asked` is more than that."]
            pub fn $name(&self, asked: impl TryInto<u64>) -> Result<(), LimitExceeded> {
                LimitExceeded::unless_within(stringify!($name), self.$name, asked)
            })*
        }
    };
}

limits! {
    /// Bytes of one request line. 32 MiB, so that a rig can come inline.
    line_bytes: 32 << 20,
    /// Raw bytes that may follow one request line.
    attachment_bytes: 256 << 20,
    /// Open connections: each costs two threads.
    connections: 256,
    /// Requests of one connection that are accepted and not yet written out; past it the connection is not read.
    in_flight_per_connection: 32,
    /// Requests of all connections that wait for the renderer or the encoder; past it the answer is `busy`.
    in_flight: 512,
    /// Bytes of pictures and arrays that requests in flight may be holding altogether; past it the answer is `busy`.
    in_flight_bytes: 2 << 30,
    /// As much of that as one connection may take; past it the connection is not read until its client takes in replies.
    in_flight_bytes_per_connection: 512 << 20,
    /// Bytes of the pictures or arrays of one batch that is not streamed, as they are written.
    batch_bytes: 256 << 20,
    /// Frames or poses of one batch.
    batch_items: 65_536,
    /// Raw bytes that requests of all connections are bringing along; past it they are read when others are done.
    attached_bytes: 1 << 30,
    /// Pixels of one picture: 16 Mi is 4096x4096.
    pixels: 16 << 20,
    /// Width or height of a picture; the renderer's own ceiling may be lower.
    side: 16_384,
    /// Lights of one picture, the size of the array in the shaders.
    lights: 16,
    /// Joints of one rig.
    joints: 65_536,
    /// Vertices of one rig, with those that are drawn besides for seams and hard edges.
    vertices: 8 << 20,
    /// Triangles of one rig.
    triangles: 16 << 20,
    /// Influences of one rig, all vertices together. One vertex may have as many as there are joints.
    influences: 64 << 20,
    /// Morph targets of one rig.
    morph_targets: 4096,
    /// Vertices that the morph targets of one rig move, each counted once for every target that lists it.
    morph_displacements: 16 << 20,
    /// Animations of one rig.
    clips: 4096,
    /// Keys of all animations of one rig together.
    keys: 8 << 20,
    /// Bytes of the files of one rig, what they refer to included.
    rig_file_bytes: 256 << 20,
    /// Bytes of the JSON of one glTF document. Parsed, it may take fifty times as much.
    document_bytes: 32 << 20,
    /// Bytes of memory that all loaded rigs may take, as estimated when each is loaded.
    rig_bytes: 4 << 30,
    /// Loaded rigs.
    rigs: 4096,
}

impl LimitExceeded {
    /// Unless `asked` is `maximum` at most.
    pub(crate) fn unless_within(
        limit: &'static str,
        maximum: u64,
        asked: impl TryInto<u64>,
    ) -> Result<(), Self> {
        // A count that does not even fit 64 bits is over every ceiling.
        let asked = asked.try_into().unwrap_or(u64::MAX);
        if asked <= maximum {
            return Ok(());
        }
        Err(Self {
            limit,
            maximum,
            asked,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ceiling_itself_is_allowed_and_one_more_is_not() {
        let limits = Limits {
            pixels: 100,
            ..Limits::default()
        };
        assert_eq!(limits.pixels(100u64), Ok(()));
        assert_eq!(
            limits.pixels(101u64),
            Err(LimitExceeded {
                limit: "pixels",
                maximum: 100,
                asked: 101
            })
        );
    }

    #[test]
    fn names_are_those_of_the_fields() {
        let limits = Limits::default();
        assert!(
            limits
                .entries()
                .any(|entry| entry == ("line_bytes", limits.line_bytes))
        );
    }
}
