//! The table of methods: which handler takes which request. Never lives here: what a handler does.

use super::call::Call;
use super::in_flight::InFlight;
use super::message::{Payload, Permit};
use super::response::Responder;
use crate::protocol::server::Cancel;
use crate::protocol::{self, Attachments, Done, Fault, Method, NoParams};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::value::RawValue;

/// A response that nobody counts: as many as a connection may have in flight come to a megabyte or two.
const SMALL_RESULT_BYTES: usize = 64 << 10;

/// A request that has a method and is not read any further yet.
pub(super) struct Dispatch<'a> {
    pub call: &'a Call,
    pub params: Option<&'a RawValue>,
    pub responder: Responder,
}

impl Dispatch<'_> {
    /// What changes rigs or poses has happened when this returns. `in_flight` are the requests of the same connection.
    pub(super) fn run(self, method: Method, in_flight: &InFlight) {
        let call = self.call;
        if let Err(late) = call.cancellation.check() {
            return self.responder.respond(Err(late.into()));
        }
        match method {
            Method::RpcDiscover => self.answer(|_: NoParams| Ok(protocol::openrpc())),
            Method::ServerInfo => self.answer(|_: NoParams| Ok(call.info())),
            Method::ServerPing => self.answer(|_: NoParams| Ok(Done {})),
            Method::ServerStats => self.answer(|_: NoParams| Ok(call.stats())),
            Method::RigLoad => self.answer(|params| call.load(params)),
            Method::RigUnload => self.answer(|params| call.unload(&params)),
            Method::RigList => self.answer(|_: NoParams| Ok(call.list())),
            Method::RigDescribe => self.answer(|params| call.describe(&params)),
            Method::PoseGet => self.answer(|params| call.get_pose(&params)),
            Method::PoseSet => self.answer(|params| call.set_pose(params)),
            Method::PoseReset => self.answer(|params| call.reset_pose(&params)),
            Method::PoseRotate => self.answer(|params| call.rotate_pose(&params)),
            Method::PoseRoll => self.answer(|params| call.roll_pose(&params)),
            Method::JointTransforms => self.answer(|params| call.joint_transforms(params)),
            Method::FrameRender => self.start(|params| call.render(params)),
            Method::FrameBatch => self.start(|params| call.render_batch(params)),
            Method::MeshVertices => self.start(|params| call.vertices(params)),
            Method::MeshBatch => self.start(|params| call.vertices_batch(params)),
            Method::MeshTopology => self.start(|params| call.topology(&params)),
            Method::ScenePick => self.start(|params| call.pick(&params)),
            Method::RequestCancel => self.answer(|Cancel { request }| {
                in_flight.cancel(&request);
                Ok(Done {})
            }),
        }
    }

    /// For a method that is done when it returns.
    fn answer<P: DeserializeOwned, R: Serialize>(self, work: impl FnOnce(P) -> Result<R, Fault>) {
        let payload = || {
            let result = work(protocol::params(self.params)?)?;
            let mut payload = Payload::new(&result, Attachments::default(), None)?;
            if payload.json.len() > SMALL_RESULT_BYTES {
                let memory = self.call.reserve(payload.json.len() as u64)?;
                payload.permit = Some(Permit::new(memory));
            }
            Ok(payload)
        };
        let payload = payload();
        self.responder.respond(payload);
    }

    /// For a method in two steps: `prepare` checks the parameters and is admitted, and what it gives does the work, which may go on
    /// behind this call.
    fn start<P: DeserializeOwned, W: FnOnce(Responder)>(
        self,
        prepare: impl FnOnce(P) -> Result<W, Fault>,
    ) {
        match protocol::params(self.params).and_then(prepare) {
            Ok(work) => work(self.responder),
            Err(fault) => self.responder.respond(Err(fault)),
        }
    }
}
