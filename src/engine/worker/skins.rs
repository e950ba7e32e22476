//! Skins that jobs share: the first job of a pose makes them, the others wait for it and draw from the same vertices.
//! Never lives here: skinning, and drawing.

use super::job::Job;
use crate::render::Instance;
use crate::render::cpu::Skinned;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

#[derive(Default)]
pub(super) struct Skins(Mutex<State>);

#[derive(Default)]
struct State {
    /// Of jobs in hand.
    entries: Vec<Entry>,
    /// Kept for a client that looks at one pose again and again.
    last: Option<Arc<Skinned>>,
    next_number: u64,
}

struct Entry {
    number: u64,
    instances: Vec<Instance>,
    progress: Progress,
}

enum Progress {
    InTheMaking { waiting: Vec<Job> },
    Made(Weak<Skinned>),
}

/// What a job is to do about its skin.
pub(super) enum Claim {
    /// It is there.
    Made(Job, Arc<Skinned>),
    /// Make it, and tell by [`Skins::made`].
    Make(Job, Making),
    /// Somebody makes it, and gets the job back with it.
    Wait,
}

/// The duty to say what became of a skin.
pub(super) struct Making(u64);

impl Skins {
    pub fn claim(&self, job: Job) -> Claim {
        let wanted = job.plan.shown_instances();
        let mut state = self.lock();
        state.entries.retain(|entry| match &entry.progress {
            Progress::InTheMaking { .. } => true,
            Progress::Made(skinned) => skinned.strong_count() > 0,
        });
        let mut entries = state.entries.iter_mut();
        match entries.find(|entry| are_skinned_alike(&entry.instances, wanted)) {
            Some(Entry {
                progress: Progress::InTheMaking { waiting },
                ..
            }) => {
                waiting.push(job);
                return Claim::Wait;
            }
            Some(Entry {
                progress: Progress::Made(skinned),
                ..
            }) => {
                if let Some(skinned) = skinned.upgrade() {
                    return Claim::Made(job, skinned);
                }
            }
            None => {}
        }
        let number = state.next_number;
        state.next_number += 1;
        state.entries.push(Entry {
            number,
            instances: wanted.to_vec(),
            progress: Progress::InTheMaking {
                waiting: Vec::new(),
            },
        });
        Claim::Make(job, Making(number))
    }

    /// Whether anybody waits for it.
    pub fn is_awaited(&self, making: &Making) -> bool {
        self.lock().entries.iter().any(|entry| {
            entry.number == making.0
                && matches!(&entry.progress, Progress::InTheMaking { waiting } if !waiting.is_empty())
        })
    }

    /// Gives back those who wait for it. Without a skin they have to begin anew.
    pub fn made(&self, making: &Making, skinned: Option<&Arc<Skinned>>) -> Vec<Job> {
        let mut state = self.lock();
        let position = state.entries.iter().position(|it| it.number == making.0);
        let Some(Entry {
            instances,
            progress,
            ..
        }) = position.map(|position| state.entries.swap_remove(position))
        else {
            return Vec::new();
        };
        if let Some(skinned) = skinned {
            state.last = Some(Arc::clone(skinned));
            state.entries.push(Entry {
                number: making.0,
                instances,
                progress: Progress::Made(Arc::downgrade(skinned)),
            });
        }
        match progress {
            Progress::InTheMaking { waiting } => waiting,
            Progress::Made(_) => Vec::new(),
        }
    }

    /// Lets go of what nobody has in hand.
    pub fn sweep(&self) {
        self.lock().last = None;
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn are_skinned_alike(some: &[Instance], others: &[Instance]) -> bool {
    let mut pairs = some.iter().zip(others);
    some.len() == others.len() && pairs.all(|(one, other)| one.is_skinned_like(other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::worker::Urgency;
    use crate::engine::{Admission, Terms};
    use crate::limits::Limits;
    use crate::pose::{Pose, Posed, Skinning};
    use crate::render::Plan;
    use crate::render::cpu::{Cores, Cpu, Spread};
    use crate::rig::{Draft, MeshDraft};
    use crate::scene::Shape;
    use glam::Vec3;

    fn posed() -> Arc<Posed> {
        let mesh = MeshDraft {
            positions: vec![Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 1, 2]],
            ..MeshDraft::default()
        };
        let draft = Draft {
            meshes: vec![mesh],
            ..Draft::default()
        };
        let rig = Arc::new(draft.build(&Limits::default()).unwrap());
        Arc::new(Posed::new(&Pose::rest(&rig)).unwrap())
    }

    fn job(posed: &Arc<Posed>, skinning: Skinning, shape: Shape) -> Job {
        let admission = Arc::new(Admission::new(&Limits::default()));
        let terms = Terms {
            urgency: Urgency::default(),
            ticket: admission.admit().unwrap(),
        };
        let plan = Plan::vertices(Arc::clone(posed), skinning, shape, Vec::new());
        Job::new(plan, terms, Box::new(|_| {}))
    }

    #[test]
    fn one_job_makes_what_others_of_the_same_pose_wait_for() {
        let skins = Skins::default();
        let (one, other) = (posed(), posed());
        let linear = |posed| job(posed, Skinning::Linear, Shape::Posed);
        let Claim::Make(first, making) = skins.claim(linear(&one)) else {
            panic!("nobody makes it yet");
        };
        assert!(!skins.is_awaited(&making));
        assert!(matches!(skins.claim(linear(&one)), Claim::Wait));
        assert!(matches!(skins.claim(linear(&one)), Claim::Wait));
        assert!(skins.is_awaited(&making));
        // Another rig, another way of skinning, another shape: none of them is the same.
        for unlike in [
            linear(&other),
            job(&one, Skinning::DualQuaternion, Shape::Posed),
            job(&one, Skinning::Linear, Shape::Bind),
        ] {
            let Claim::Make(_, making) = skins.claim(unlike) else {
                panic!("it is another one");
            };
            // It failed.
            assert!(skins.made(&making, None).is_empty());
        }
        let whole = Spread::to_the_end(Cores::One);
        let skinned = Cpu::default().skin(first.plan.shown_instances(), whole);
        let skinned = Arc::new(skinned.unwrap());
        assert_eq!(skins.made(&making, Some(&skinned)).len(), 2);
        let kept = Arc::downgrade(&skinned);
        drop(skinned);
        assert!(matches!(skins.claim(linear(&one)), Claim::Made(..)));
        skins.sweep();
        assert_eq!(kept.strong_count(), 0);
        assert!(matches!(skins.claim(linear(&one)), Claim::Make(..)));
    }

    #[test]
    fn where_making_fails_those_who_waited_begin_anew() {
        let skins = Skins::default();
        let posed = posed();
        let linear = || job(&posed, Skinning::Linear, Shape::Posed);
        let Claim::Make(_, making) = skins.claim(linear()) else {
            panic!("nobody makes it yet");
        };
        assert!(matches!(skins.claim(linear()), Claim::Wait));
        let mut waiting = skins.made(&making, None);
        assert_eq!(waiting.len(), 1);
        let again = skins.claim(waiting.remove(0));
        assert!(matches!(again, Claim::Make(..)));
    }
}
