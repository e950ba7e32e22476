//! Skinned vertices that jobs share: the first job of a pose computes them, the others wait for it and read the same ones.
//! Never lives here: skinning, and drawing.

use super::job::Job;
use crate::render::Skin;
use crate::render::cpu::Skinned;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

#[derive(Default)]
pub(super) struct SkinCache(Mutex<State>);

#[derive(Default)]
struct State {
    /// Of jobs in hand.
    entries: Vec<Entry>,
    /// Kept for a client that looks at one pose again and again.
    last: Option<Arc<Skinned>>,
    next_id: u64,
}

struct Entry {
    id: u64,
    skins: Vec<Skin>,
    state: EntryState,
}

enum EntryState {
    Computing { waiting: Vec<Job> },
    Ready(Weak<Skinned>),
}

/// What a job with a picture is to do about its skins.
pub(super) enum Lookup {
    Hit(Job, Arc<Skinned>),
    /// Compute them, and say so by [`SkinCache::complete`].
    Miss(Job, Computation),
    /// Another job computes them. Its thread gets this job from [`SkinCache::complete`].
    Waiting,
}

/// The duty to complete an entry.
pub(super) struct Computation(u64);

impl SkinCache {
    /// The skins that the picture of a job shows.
    pub(super) fn look_up(&self, job: Job) -> Lookup {
        let skins: Vec<Skin> = job.plan.drawn_skins().cloned().collect();
        let mut state = self.lock();
        state.entries.retain(|entry| match &entry.state {
            EntryState::Computing { .. } => true,
            EntryState::Ready(skinned) => skinned.strong_count() > 0,
        });
        let mut entries = state.entries.iter_mut();
        match entries.find(|entry| entry.skins == skins) {
            Some(Entry {
                state: EntryState::Computing { waiting },
                ..
            }) => {
                waiting.push(job);
                return Lookup::Waiting;
            }
            Some(Entry {
                state: EntryState::Ready(skinned),
                ..
            }) => {
                if let Some(skinned) = skinned.upgrade() {
                    return Lookup::Hit(job, skinned);
                }
            }
            None => {}
        }
        let id = state.next_id;
        state.next_id += 1;
        state.entries.push(Entry {
            id,
            skins,
            state: EntryState::Computing {
                waiting: Vec::new(),
            },
        });
        Lookup::Miss(job, Computation(id))
    }

    /// Vertices that are there already and have those of a skin among them.
    pub(super) fn ready(&self, skin: &Skin) -> Option<Arc<Skinned>> {
        let state = self.lock();
        let ready = state.entries.iter().filter_map(|entry| match &entry.state {
            EntryState::Ready(skinned) if entry.skins.contains(skin) => skinned.upgrade(),
            EntryState::Ready(_) | EntryState::Computing { .. } => None,
        });
        ready.into_iter().next()
    }

    /// Whether any job waits for it.
    pub(super) fn is_awaited(&self, computation: &Computation) -> bool {
        self.lock().entries.iter().any(|entry| {
            entry.id == computation.0
                && matches!(&entry.state, EntryState::Computing { waiting } if !waiting.is_empty())
        })
    }

    /// Gives back the jobs that wait. Without vertices they have to look up anew.
    pub(super) fn complete(
        &self,
        computation: &Computation,
        skinned: Option<&Arc<Skinned>>,
    ) -> Vec<Job> {
        let mut state = self.lock();
        let index = state.entries.iter().position(|it| it.id == computation.0);
        let Some(entry) = index.map(|index| state.entries.swap_remove(index)) else {
            return Vec::new();
        };
        if let Some(skinned) = skinned {
            state.last = Some(Arc::clone(skinned));
            state.entries.push(Entry {
                id: entry.id,
                skins: entry.skins,
                state: EntryState::Ready(Arc::downgrade(skinned)),
            });
        }
        match entry.state {
            EntryState::Computing { waiting } => waiting,
            EntryState::Ready(_) => Vec::new(),
        }
    }

    /// Frees what no job has in hand.
    pub(super) fn sweep(&self) {
        self.lock().last = None;
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::worker::Cancellation;
    use crate::engine::{Admission, JobContext};
    use crate::limits::Limits;
    use crate::pose::{Posed, Skinning};
    use crate::render::cpu::{Cores, Cpu, Parallelism};
    use crate::render::fixtures;
    use crate::scene::ShowSkin;

    fn posed() -> Arc<Posed> {
        fixtures::posed(1)
    }

    fn job(posed: &Arc<Posed>, skinning: Skinning, skin: ShowSkin) -> Job {
        let plan = fixtures::picture(posed, skinning, skin);
        let admission = Arc::new(Admission::new(&Limits::default()));
        let context = JobContext {
            cancellation: Cancellation::default(),
            ticket: admission.admit().unwrap(),
        };
        Job::new(plan, context, Box::new(|_| {}))
    }

    #[test]
    fn one_job_computes_what_others_of_the_same_pose_wait_for() {
        let cache = SkinCache::default();
        let (one, other) = (posed(), posed());
        let linear = |posed| job(posed, Skinning::Linear, ShowSkin::Posed);
        let Lookup::Miss(first, computation) = cache.look_up(linear(&one)) else {
            panic!("nobody computes it yet");
        };
        let skin = first.plan.instances[0].skin().clone();
        assert!(!cache.is_awaited(&computation));
        assert!(matches!(cache.look_up(linear(&one)), Lookup::Waiting));
        assert!(matches!(cache.look_up(linear(&one)), Lookup::Waiting));
        assert!(cache.is_awaited(&computation));
        assert!(cache.ready(&skin).is_none());
        // Another rig, another way of skinning, another shape: none of them is the same.
        for unlike in [
            linear(&other),
            job(&one, Skinning::DualQuaternion, ShowSkin::Posed),
            job(&one, Skinning::Linear, ShowSkin::Bind),
        ] {
            let Lookup::Miss(_, computation) = cache.look_up(unlike) else {
                panic!("it is another one");
            };
            // It failed.
            assert!(cache.complete(&computation, None).is_empty());
        }
        let skinned = Cpu::default().skin(&first.plan, Parallelism::uncancelled(Cores::One));
        let skinned = Arc::new(skinned.unwrap());
        assert_eq!(cache.complete(&computation, Some(&skinned)).len(), 2);
        assert!(cache.ready(&skin).is_some());
        let kept = Arc::downgrade(&skinned);
        drop(skinned);
        assert!(matches!(cache.look_up(linear(&one)), Lookup::Hit(..)));
        cache.sweep();
        assert_eq!(kept.strong_count(), 0);
        assert!(cache.ready(&skin).is_none());
        assert!(matches!(cache.look_up(linear(&one)), Lookup::Miss(..)));
    }

    #[test]
    fn where_computing_fails_those_who_waited_look_up_anew() {
        let cache = SkinCache::default();
        let posed = posed();
        let linear = || job(&posed, Skinning::Linear, ShowSkin::Posed);
        let Lookup::Miss(_, computation) = cache.look_up(linear()) else {
            panic!("nobody computes it yet");
        };
        assert!(matches!(cache.look_up(linear()), Lookup::Waiting));
        let mut waiting = cache.complete(&computation, None);
        assert_eq!(waiting.len(), 1);
        let again = cache.look_up(waiting.remove(0));
        assert!(matches!(again, Lookup::Miss(..)));
    }
}
