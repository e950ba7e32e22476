//! The table of methods: name, effect, parameters, result, and the errors to expect beside the general ones.
//! Never lives here: what a method does.

use super::error::{ErrorKind, Fault};
use super::field::shortened;
use super::{Done, NoParams, batch, frame, mesh, pick, pose, rig, server};
use crate::spelling::nearest;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use std::borrow::Cow;

macro_rules! methods {
    ($($(#[doc = $doc:literal])* $variant:ident $name:literal $effect:ident $params:ty => $result:ty, $errors:expr;)*) => {
        /// Everything that a server can be asked for.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Method { $($(#[doc = $doc])* $variant,)* }

        impl Method {
            /// In the order in which the OpenRPC document lists them.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// As the wire spells it.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// What it does, in a sentence or two.
            pub fn summary(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),*).trim_start(),)* }
            }

            /// Whether it changes anything on the server, so that it is of use even where nobody hears the answer.
            pub const fn mutates(self) -> bool {
                match self { $(Self::$variant => matches!(Effect::$effect, Effect::Mutates),)* }
            }

            /// What can go wrong beside [`Method::GENERAL_ERRORS`].
            pub fn errors(self) -> &'static [ErrorKind] {
                match self { $(Self::$variant => &$errors,)* }
            }

            /// The name under which the generator keeps the schema of the parameters.
            pub(super) fn params_schema(self, generator: &mut SchemaGenerator) -> Cow<'static, str> {
                match self {
                    $(Self::$variant => {
                        generator.subschema_for::<$params>();
                        <$params>::schema_name()
                    })*
                }
            }

            pub(super) fn result_schema(self, generator: &mut SchemaGenerator) -> Schema {
                match self { $(Self::$variant => generator.subschema_for::<$result>(),)* }
            }
        }
    };
}

/// What a method does to the server.
enum Effect {
    Reads,
    Mutates,
}

methods! {
    /// Gives this document.
    RpcDiscover "rpc.discover" Reads NoParams => Document, [];
    /// Tells what answers, what draws, and which limits hold.
    ServerInfo "server.info" Reads NoParams => server::ServerInfo, [];
    /// Does nothing: to see whether anybody answers.
    ServerPing "server.ping" Reads NoParams => Done, [];
    /// Gives counters and gauges.
    ServerStats "server.stats" Reads NoParams => server::ServerStats, [];
    /// Loads a rig from its files. The same rig under the same name again changes nothing and costs nothing.
    RigLoad "rig.load" Mutates rig::LoadParams => rig::RigSummary, [
        ErrorKind::RigFileInvalid, ErrorKind::RigNameTaken, ErrorKind::LimitExceeded, ErrorKind::FileNotFound, ErrorKind::PathNotAllowed,
    ];
    /// Forgets a rig and its stored pose. Requests in hand keep what they started with.
    RigUnload "rig.unload" Mutates rig::RigParams => Done, [ErrorKind::RigNotLoaded];
    /// Lists the loaded rigs.
    RigList "rig.list" Reads NoParams => rig::RigList, [];
    /// Tells everything about a rig but its vertices and triangles.
    RigDescribe "rig.describe" Reads rig::RigParams => rig::RigDescription, [ErrorKind::RigNotLoaded];
    /// Gives the stored pose of a rig.
    PoseGet "pose.get" Reads rig::RigParams => pose::StoredPose, [ErrorKind::RigNotLoaded];
    /// Changes the stored pose of a rig, for every request that comes after.
    PoseSet "pose.set" Mutates pose::PoseSetParams => pose::PoseSetResult, [ErrorKind::RigNotLoaded];
    /// Sets every degree of freedom of the stored pose back to the file's own value.
    PoseReset "pose.reset" Mutates rig::RigParams => Done, [ErrorKind::RigNotLoaded];
    /// Turns a joint further about an axis. Its children go with it.
    PoseRotate "pose.rotate" Mutates pose::RotateParams => pose::PoseSetResult, [ErrorKind::RigNotLoaded];
    /// Turns a joint further about its own bone.
    PoseRoll "pose.roll" Mutates pose::RollParams => pose::PoseSetResult, [ErrorKind::RigNotLoaded];
    /// Draws a rig.
    FrameRender "frame.render" Reads frame::FrameParams => frame::Frame, [
        ErrorKind::RigNotLoaded, ErrorKind::LimitExceeded, ErrorKind::DeviceLost,
    ];
    /// Draws many pictures. Where streamed, each goes ahead of the result as a notification `frame.ready`.
    FrameBatch "frame.batch" Reads batch::FrameBatchParams => batch::FrameBatch, [
        ErrorKind::RigNotLoaded, ErrorKind::LimitExceeded, ErrorKind::DeviceLost,
    ];
    /// Gives skinned vertices, in the order of the file.
    MeshVertices "mesh.vertices" Reads mesh::VerticesParams => mesh::Vertices, [
        ErrorKind::RigNotLoaded, ErrorKind::LimitExceeded, ErrorKind::DeviceLost,
    ];
    /// Gives the vertices or joints of a rig in many poses. Where streamed, each goes ahead of the result as a notification `mesh.ready`.
    MeshBatch "mesh.batch" Reads batch::MeshBatchParams => batch::MeshBatch, [
        ErrorKind::RigNotLoaded, ErrorKind::LimitExceeded, ErrorKind::DeviceLost,
    ];
    /// Gives triangles and texture coordinates, which stay the same in every pose.
    MeshTopology "mesh.topology" Reads mesh::TopologyParams => mesh::Topology, [
        ErrorKind::RigNotLoaded, ErrorKind::LimitExceeded,
    ];
    /// Tells what a picture would show at one of its pixels.
    ScenePick "scene.pick" Reads pick::PickParams => pick::Picked, [
        ErrorKind::RigNotLoaded, ErrorKind::LimitExceeded, ErrorKind::DeviceLost,
    ];
    /// Tells where the joints are in world space.
    JointTransforms "joint.transforms" Reads pose::TransformsParams => pose::Transforms, [ErrorKind::RigNotLoaded];
    /// Ends an earlier request of the same connection, which is then answered with `cancelled`. A notification: it has no `id` and gets no answer.
    RequestCancel "request.cancel" Mutates server::Cancel => Done, [];
}

impl Method {
    /// What can go wrong with every request.
    pub const GENERAL_ERRORS: &[ErrorKind] = &[
        ErrorKind::ParseError,
        ErrorKind::InvalidRequest,
        ErrorKind::InvalidParams,
        ErrorKind::Internal,
        ErrorKind::Unauthorized,
        ErrorKind::Busy,
        ErrorKind::DeadlineExceeded,
        ErrorKind::ShuttingDown,
        ErrorKind::Cancelled,
    ];

    /// # Errors
    /// [`Fault::MethodNotFound`], with the name that may have been meant.
    pub fn named(name: &str) -> Result<Self, Fault> {
        let known = || Self::ALL.iter().copied();
        known()
            .find(|method| method.name() == name)
            .ok_or_else(|| Fault::MethodNotFound {
                method: shortened(name).into_owned(),
                nearest: nearest(name, known().map(Self::name)).map(str::to_owned),
            })
    }

    /// Whether it only makes sense without an `id`.
    pub fn is_notification(self) -> bool {
        self == Self::RequestCancel
    }
}

/// What `rpc.discover` gives; [`openrpc`](fn@super::openrpc) makes it.
struct Document;

impl JsonSchema for Document {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Document".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "An OpenRPC document.",
            "type": "object",
            "required": ["openrpc", "info", "methods"],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_loads_poses_or_cancels_mutates_and_nothing_else_does() {
        let mutating = Method::ALL.iter().filter(|method| method.mutates());
        let names: Vec<_> = mutating.map(|method| method.name()).collect();
        let wanted = [
            "rig.load",
            "rig.unload",
            "pose.set",
            "pose.reset",
            "pose.rotate",
            "pose.roll",
            "request.cancel",
        ];
        assert_eq!(names, wanted);
    }

    #[test]
    fn methods_are_found_by_name_and_near_ones_are_offered() {
        for method in Method::ALL {
            assert_eq!(Method::named(method.name()), Ok(*method));
        }
        for (name, message) in [
            (
                "frame.rendr",
                "there is no method `frame.rendr`; did you mean `frame.render`?",
            ),
            (
                "SERVER.PING",
                "there is no method `SERVER.PING`; did you mean `server.ping`?",
            ),
            (
                "render",
                "there is no method `render`; did you mean `frame.render`?",
            ),
            // There are two of that end.
            ("batch", "there is no method `batch`"),
            ("zzz", "there is no method `zzz`"),
            ("", "there is no method ``"),
        ] {
            assert_eq!(Method::named(name).unwrap_err().to_string(), message);
        }
        let long = Method::named(&"x".repeat(100_000)).unwrap_err();
        assert!(long.to_string().len() < 1000);
    }
}
