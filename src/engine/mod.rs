//! The use-cases in plain types: load, pose, render, vertices. Knows no wire, no socket and no JSON.

mod admission;
mod error;
mod extents;
mod ordered;
mod query;
mod recent;
mod store;
mod thread_pool;
mod worker;

pub use admission::{Admission, AttachmentPermit, ConnectionQuota, MemoryPermit, Ticket};
pub use error::{EngineError, PoseError};
pub use extents::Extents;
pub use ordered::{Ordered, WindowPermit, Work};
pub use query::{Character, FrameQuery, PickQuery};
pub use store::{ChangedPose, LoadedRig, RigRef};
pub use worker::{Cancellation, Timings};

use crate::adapter::{AdapterChoice, AdapterInfo};
use crate::formats::{self, FileRef, Source};
use crate::frame::{Outputs, SkinnedVertices};
use crate::limits::Limits;
use crate::pick::{self, Hit, Targets};
use crate::pose::{Clamped, Pose, PoseEdit, Posed, Skinning};
use crate::render::{self, Capabilities, Plan, Skin, turn_outward};
use crate::scene::{Shape, VertexQuery};
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use store::Store;
use thread_pool::ThreadPool;
use worker::{Job, Opened};

/// Which renderer to open.
#[derive(Debug, Clone, Default)]
pub struct RendererChoice {
    /// By default a GPU, and without one the CPU.
    pub adapter: AdapterChoice,
    /// Refuse whatever draws on the CPU.
    pub require_gpu: bool,
    /// For drawing on the CPU and for encoding; without it, as many as there are cores.
    pub threads: Option<NonZeroUsize>,
}

/// Everything that can be drawn with, best first.
pub fn adapters(threads: Option<NonZeroUsize>) -> Vec<AdapterInfo> {
    render::adapters(ThreadPool::threads(threads))
}

/// What accompanies a job on its way.
#[derive(Debug)]
pub struct JobContext {
    /// Looked at before the work starts, and again while it lasts or at its end.
    pub cancellation: Cancellation,
    /// Held until the job is answered.
    pub ticket: Ticket,
}

/// From which pose an edit starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Base {
    /// The server's own of that rig.
    Stored,
    /// The file's.
    Rest,
}

impl RigRef {
    /// The pose that an edit starts from.
    pub fn start(&self, base: Base) -> Pose {
        match base {
            Base::Stored => self.stored.clone(),
            Base::Rest => Pose::rest(&self.loaded.rig),
        }
    }

    /// The pose of one request, worked out; nothing stored changes.
    ///
    /// # Errors
    /// As the pose has them.
    pub fn posed(
        &self,
        base: Base,
        edit: &PoseEdit,
    ) -> Result<(Arc<Posed>, Vec<Clamped>), PoseError> {
        let (pose, clamped) = self.start(base).edited(edit)?;
        Ok((self.loaded.recent.posed(pose)?, clamped))
    }

    /// What the stored pose may become.
    ///
    /// # Errors
    /// As the pose has them. One that cannot be worked out is not to be kept either.
    pub fn changed(&self, base: Base, edit: &PoseEdit) -> Result<ChangedPose, PoseError> {
        let (pose, clamped) = self.start(base).edited(edit)?;
        Posed::new(&pose)?;
        Ok(ChangedPose { pose, clamped })
    }
}

/// Rigs, their stored poses, and the renderer. Shared by every connection.
pub struct Engine {
    store: Store,
    /// Held while files become a rig: loads in progress would otherwise each take as much memory as all rigs together may.
    loading: Mutex<()>,
    opened: Opened,
    pool: Arc<ThreadPool>,
    admission: Arc<Admission>,
    limits: Limits,
}

impl Engine {
    /// Opens the renderer.
    ///
    /// # Errors
    /// [`EngineError::Adapter`] where there is none of the kind asked for.
    pub fn open(choice: RendererChoice, limits: Limits) -> Result<Self, EngineError> {
        let pool = ThreadPool::new(choice.threads).map_err(|error| EngineError::Internal {
            reason: error.to_string(),
        })?;
        let pool = Arc::new(pool);
        let opened = worker::open(&choice, &pool)?;
        Ok(Self {
            store: Store::new(limits),
            loading: Mutex::new(()),
            opened,
            pool,
            admission: Arc::new(Admission::new(&limits)),
            limits,
        })
    }

    /// As they were given to [`Engine::open`].
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// What draws, and why it was chosen.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.opened.adapter
    }

    /// What the renderer can draw at most, besides the [limits](Self::limits).
    pub fn capabilities(&self) -> Capabilities {
        self.opened.capabilities
    }

    /// The budgets of requests and memory that all connections share.
    pub fn admission(&self) -> &Arc<Admission> {
        &self.admission
    }

    /// Device memory in use.
    pub fn gpu_bytes(&self) -> u64 {
        self.opened.worker.gpu_bytes()
    }

    /// For how long the graphics device was at work since the start, by its own clock; zero where it has none.
    pub fn gpu_busy(&self) -> Duration {
        self.opened.worker.gpu_busy()
    }

    /// Reads files and keeps the rig under `name`, or under the first file's stem.
    ///
    /// # Errors
    /// As reading and keeping have them; nothing is then changed.
    pub fn load(
        &self,
        name: Option<&str>,
        files: &[FileRef],
        source: &Source,
        replace: bool,
    ) -> Result<Arc<LoadedRig>, EngineError> {
        let _alone = self.loading.lock().unwrap_or_else(PoisonError::into_inner);
        let loaded = formats::load(files, source, &self.limits)?;
        self.capabilities().accept_rig(&loaded.rig)?;
        let kept = self.store.keep(name, loaded, replace)?;
        self.opened.worker.sweep();
        Ok(kept)
    }

    /// # Errors
    /// [`EngineError::RigNotLoaded`].
    pub fn unload(&self, rig: &str) -> Result<(), EngineError> {
        self.store.remove(rig)?;
        self.opened.worker.sweep();
        Ok(())
    }

    /// Every rig, by name.
    pub fn rigs(&self) -> Vec<Arc<LoadedRig>> {
        self.store.all()
    }

    /// Estimated memory of all rigs.
    pub fn rig_bytes(&self) -> u64 {
        self.store.bytes()
    }

    /// The rig of that name or digest.
    ///
    /// # Errors
    /// [`EngineError::RigNotLoaded`].
    pub fn rig(&self, rig: &str) -> Result<RigRef, EngineError> {
        self.store.find(rig)
    }

    /// Changes the stored pose for good, to what `change` makes of it.
    ///
    /// # Errors
    /// [`EngineError::RigNotLoaded`], and as `change` has them; the stored pose is then as it was.
    pub fn set_pose<E: From<EngineError>>(
        &self,
        rig: &str,
        change: impl FnOnce(&RigRef) -> Result<ChangedPose, E>,
    ) -> Result<(Arc<LoadedRig>, Vec<Clamped>), E> {
        self.store.update_pose(rig, change)
    }

    /// # Errors
    /// [`EngineError::RigNotLoaded`].
    pub fn reset_pose(&self, rig: &str) -> Result<(), EngineError> {
        // Loading has worked it out.
        let at_rest = |current: &RigRef| ChangedPose {
            pose: current.start(Base::Rest),
            clamped: Vec::new(),
        };
        self.store
            .update_pose::<EngineError>(rig, |current| Ok(at_rest(current)))?;
        Ok(())
    }

    /// How many threads draw on the CPU, encode, and do what [`Engine::spawn`] is given.
    pub fn thread_count(&self) -> usize {
        self.pool.thread_count()
    }

    /// Runs `work` on one of those threads some time soon. How much waits is up to the caller.
    pub fn spawn(&self, work: impl FnOnce() + Send + 'static) {
        self.pool.spawn(work);
    }

    /// Draws a picture. `done` runs on a pool thread, exactly once, whatever happens.
    pub fn render(
        &self,
        query: FrameQuery,
        context: JobContext,
        done: impl FnOnce(Result<(Outputs, Timings), EngineError>) + Send + 'static,
    ) {
        self.run(query.into(), context, done);
    }

    /// Skins `posed` and copies out what `queries` ask for, all of it inside its meshes. `done` as for [`Engine::render`].
    pub fn vertices(
        &self,
        posed: Arc<Posed>,
        skinning: Skinning,
        shape: Shape,
        queries: Vec<VertexQuery>,
        context: JobContext,
        done: impl FnOnce(Result<(Vec<SkinnedVertices>, Timings), EngineError>) + Send + 'static,
    ) {
        let plan = Plan::vertices(posed, skinning, shape, queries);
        self.run(plan, context, move |result| {
            done(result.map(|(outputs, timings)| (outputs.vertices, timings)));
        });
    }

    /// Looks for what a ray meets first in `posed`. `done` as for [`Engine::render`], though where no skin is asked for it runs at once.
    pub fn pick(
        &self,
        posed: Arc<Posed>,
        skinning: Skinning,
        query: PickQuery,
        context: JobContext,
        done: impl FnOnce(Result<(Option<Hit>, Timings), EngineError>) + Send + 'static,
    ) {
        let rig = Arc::clone(posed.rig());
        let PickQuery {
            ray,
            bones,
            bone_radius,
            skin,
            cull,
            variant,
        } = query;
        let pick = move |posed: &Posed, meshes: Option<&[SkinnedVertices]>| {
            let targets = Targets {
                bones: bones.then_some(pick::Bones {
                    posed,
                    radius: bone_radius,
                }),
                skin: meshes.zip(skin).map(|(meshes, shape)| pick::Skin {
                    posed,
                    shape,
                    cull,
                    variant,
                    meshes,
                }),
            };
            pick::pick(&ray, &targets)
        };
        let Some(shape) = skin else {
            return done(Ok((pick(&posed, None), Timings::default())));
        };
        let queries = rig.meshes().iter().enumerate();
        let queries = queries.map(|(mesh, of_mesh)| VertexQuery {
            instance: 0,
            mesh,
            start: 0,
            // A hit's normal is that of the surface as it is drawn.
            count: of_mesh.draw_vertex_count(),
            positions: true,
            normals: true,
        });
        let looked_at = Arc::clone(&posed);
        self.vertices(
            posed,
            skinning,
            shape,
            queries.collect(),
            context,
            move |result| {
                done(result.map(|(meshes, timings)| (pick(&looked_at, Some(&meshes)), timings)));
            },
        );
    }

    fn run(
        &self,
        plan: Plan,
        context: JobContext,
        done: impl FnOnce(Result<(Outputs, Timings), EngineError>) + Send + 'static,
    ) {
        let with_skin = |query: &VertexQuery| {
            let skin = plan.instances[query.instance].skin();
            (*query, skin.clone())
        };
        let queried: Vec<(VertexQuery, Skin)> = plan.vertices.iter().map(with_skin).collect();
        let done = move |result: Result<(Outputs, Timings), EngineError>| {
            done(result.map(|(mut outputs, timings)| {
                for ((query, skin), skinned) in queried.iter().zip(&mut outputs.vertices) {
                    turn_outward(skin, query, skinned);
                }
                (outputs, timings)
            }));
        };
        self.opened
            .worker
            .take(Job::new(plan, context, Box::new(done)));
    }

    /// Destroys the device, to see what a driver's crash would do.
    #[doc(hidden)]
    pub fn lose_device(&self) {
        self.opened.worker.lose_device();
    }
}
