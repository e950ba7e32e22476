//! JSON line in, JSON line out. [`Service::converse`] gives a connection its [`Conversation`], which takes one message at a time.
//! Never lives here: sockets, and how a rig is loaded, posed or drawn.
//!
//! Each family of methods has its file: from wire types to plain ones, one call to the engine, and back.

mod answer;
mod batch;
mod describe;
mod fault;
mod file_lights;
mod frame;
mod in_process;
mod mesh;
mod mesh_batch;
mod message;
mod names;
mod pick;
mod pose;
mod rig;
mod scene;
mod server;
mod stats;

pub use crate::protocol::attach::Part;
pub use answer::{Outgoing, Pending};
pub use describe::{describe_files, description};
pub use in_process::Subject;
pub use message::{Message, turned_away};
pub use stats::Stats;

use crate::engine::{AttachedBytes, Engine, EngineError, HeldBytes, Share, Terms, Urgency};
use crate::formats::Source;
use crate::limits::Limits;
use crate::protocol::{self, Attachments, BadRequest, Fault, Id, Method};
use answer::Answer;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Everything that the daemon can be asked. Shared by every connection.
pub struct Service {
    engine: Engine,
    source: Source,
    stats: Arc<Stats>,
    started: Instant,
}

impl Service {
    /// Paths in requests are opened by way of `source`.
    pub fn new(engine: Engine, source: Source) -> Arc<Self> {
        Arc::new(Self {
            engine,
            source,
            stats: Arc::default(),
            started: Instant::now(),
        })
    }

    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    pub fn limits(&self) -> &Limits {
        self.engine.limits()
    }

    pub fn stats(&self) -> &Stats {
        &self.stats
    }

    /// What one connection says to the service.
    pub fn converse(self: &Arc<Self>) -> Conversation {
        Conversation {
            service: Arc::clone(self),
            in_hand: VecDeque::new(),
            share: self.engine.admission().share(),
        }
    }

    /// Answers one line and waits for it; `attached` is what followed it. `None` for a notification.
    pub fn answer(self: &Arc<Self>, line: &[u8], attached: Vec<u8>) -> Option<Outgoing> {
        let message = Message::read(line, Instant::now());
        self.converse()
            .begin(message, attached)
            .map(|pending| pending.wait())
    }
}

/// The service's side of one connection.
pub struct Conversation {
    service: Arc<Service>,
    /// Requests that may still be cancelled, the oldest first.
    in_hand: VecDeque<(Id, answer::Handle)>,
    /// Of the room for results.
    share: Arc<Share>,
}

/// Sooner than this nobody need ask again, whatever it was that the server had too much of.
const LEAST_RETRY_MS: u64 = 50;

/// Of a request, not yet read.
type Params<'a> = Option<&'a serde_json::value::RawValue>;

/// One request on its way through its handler.
#[derive(Clone)]
struct Call {
    service: Arc<Service>,
    /// What came beside its line.
    attached: Arc<Vec<u8>>,
    urgency: Urgency,
    share: Arc<Share>,
}

impl Conversation {
    /// Room for the raw bytes of a message; `None` where there is none now.
    pub fn room_for(&self, attached: u64) -> Option<AttachedBytes> {
        self.service.engine.admission().attach(attached)
    }

    /// Acts on a message. What changes rigs or poses has happened when this returns; drawing and copying go on behind the
    /// [`Pending`] reply. `None` for a notification.
    pub fn begin(&mut self, message: Message, attached: Vec<u8>) -> Option<Pending> {
        let Message { request, arrived } = message;
        let stats = &self.service.stats;
        let request = match request {
            Ok(request) => request,
            Err(BadRequest { id, fault, .. }) => {
                let (answer, pending) = Answer::new(id, None, Urgency::default(), stats);
                answer.fail(fault);
                return Some(pending);
            }
        };
        let after = |ms| arrived.checked_add(Duration::from_millis(ms));
        let urgency = Urgency {
            deadline: request.deadline_ms.and_then(after),
            ..Urgency::default()
        };
        let method = Method::named(&request.method);
        let named = method.as_ref().ok().copied();
        let (answer, pending) = match &request.id {
            Some(id) => {
                let (answer, pending) = Answer::new(id.clone(), named, urgency.clone(), stats);
                self.in_hand.retain(|(_, handle)| handle.is_open());
                self.in_hand.push_back((id.clone(), pending.handle()));
                (answer, Some(pending))
            }
            // Nobody hears what a notification comes to, so one that only asks is not worth working on.
            None if named.is_none_or(|method| !method.mutates()) => return None,
            None => (Answer::unheard(named, stats), None),
        };
        match method {
            Err(fault) => answer.fail(fault),
            Ok(Method::RequestCancel) => {
                let cancelled = protocol::params(request.params.as_deref());
                match cancelled {
                    Ok(wanted) => answer.send(&self.cancel(&wanted), Attachments::default(), None),
                    Err(fault) => answer.fail(fault),
                }
            }
            Ok(method) => {
                let call = Call {
                    service: Arc::clone(&self.service),
                    attached: Arc::new(attached),
                    urgency,
                    share: Arc::clone(&self.share),
                };
                let params = request.params.as_deref();
                // A panic drops the answer, which tells the client; a store is only ever changed as a whole.
                let caught = catch_unwind(AssertUnwindSafe(|| call.handle(method, params, answer)));
                drop(caught);
            }
        }
        pending
    }

    /// Ends every request of that id that is still in hand.
    fn cancel(&self, wanted: &protocol::server::Cancel) -> protocol::Done {
        for (_, handle) in self.in_hand.iter().filter(|(id, _)| *id == wanted.request) {
            handle.end(Fault::Cancelled);
        }
        protocol::Done {}
    }
}

impl Call {
    fn handle(&self, method: Method, params: Params<'_>, answer: Answer) {
        if let Err(late) = self.urgency.check() {
            return answer.fail(late.into());
        }
        match method {
            Method::RpcDiscover => self.reply(params, answer, |_: protocol::NoParams| {
                Ok(protocol::openrpc())
            }),
            Method::ServerInfo => {
                self.reply(params, answer, |_: protocol::NoParams| Ok(self.info()))
            }
            Method::ServerPing => self.reply(params, answer, |_: protocol::NoParams| {
                Ok(protocol::Done {})
            }),
            Method::ServerStats => {
                self.reply(params, answer, |_: protocol::NoParams| Ok(self.stats()))
            }
            Method::RigLoad => self.reply(params, answer, |params| self.load(params)),
            Method::RigUnload => self.reply(params, answer, |params| self.unload(&params)),
            Method::RigList => self.reply(params, answer, |_: protocol::NoParams| Ok(self.list())),
            Method::RigDescribe => self.reply(params, answer, |params| self.describe(&params)),
            Method::PoseGet => self.reply(params, answer, |params| self.get_pose(&params)),
            Method::PoseSet => self.reply(params, answer, |params| self.set_pose(&params)),
            Method::PoseReset => self.reply(params, answer, |params| self.reset_pose(&params)),
            Method::PoseRotate => self.reply(params, answer, |params| self.rotate_pose(&params)),
            Method::PoseRoll => self.reply(params, answer, |params| self.roll_pose(&params)),
            Method::JointTransforms => {
                self.reply(params, answer, |params| self.joint_transforms(&params))
            }
            Method::FrameRender => self.hand_over(params, answer, Self::render),
            Method::FrameBatch => self.hand_over(params, answer, Self::render_batch),
            Method::MeshVertices => self.hand_over(params, answer, Self::vertices),
            Method::MeshBatch => self.hand_over(params, answer, Self::vertices_batch),
            Method::MeshTopology => self.hand_over(params, answer, Self::topology),
            Method::ScenePick => self.hand_over(params, answer, Self::pick),
            // Needs the conversation, which has dealt with it.
            Method::RequestCancel => {}
        }
    }

    /// For a method that is done when it returns.
    fn reply<P: DeserializeOwned, R: Serialize>(
        &self,
        params: Params<'_>,
        answer: Answer,
        work: impl FnOnce(P) -> Result<R, Fault>,
    ) {
        match protocol::params(params).and_then(work) {
            Ok(result) => answer.give(&result, |bytes| self.hold(bytes)),
            Err(fault) => answer.fail(fault),
        }
    }

    /// For a method whose answer goes its own way, unless it fails at once.
    fn hand_over<P: DeserializeOwned>(
        &self,
        params: Params<'_>,
        answer: Answer,
        work: impl FnOnce(&Self, P, &mut Option<Answer>) -> Result<(), Fault>,
    ) {
        let mut answer = Some(answer);
        let begun = protocol::params(params).and_then(|params| work(self, params, &mut answer));
        if let (Err(fault), Some(answer)) = (begun, answer) {
            answer.fail(fault);
        }
    }

    fn engine(&self) -> &Engine {
        &self.service.engine
    }

    /// Room for a result of that size, and the terms on which the engine works on it.
    fn take_on(&self, bytes: u64) -> Result<(HeldBytes, Terms), Fault> {
        let held = self.hold(bytes)?;
        let ticket = self
            .engine()
            .admission()
            .admit()
            .map_err(|error| self.busy(error))?;
        Ok((
            held,
            Terms {
                urgency: self.urgency.clone(),
                ticket,
            },
        ))
    }

    fn hold(&self, bytes: u64) -> Result<HeldBytes, Fault> {
        self.share.hold(bytes).map_err(|error| self.busy(error))
    }

    /// With a guess at when the renderer will have room again.
    fn busy(&self, error: EngineError) -> Fault {
        match error {
            EngineError::Busy { queue_depth } => {
                let drained = self.service.stats.mean_render()
                    * u32::try_from(queue_depth).unwrap_or(u32::MAX)
                    / 2;
                let retry_after_ms = (drained.as_millis() as u64).clamp(LEAST_RETRY_MS, 5_000);
                Fault::Busy {
                    retry_after_ms,
                    queue_depth,
                }
            }
            other => other.into(),
        }
    }
}
