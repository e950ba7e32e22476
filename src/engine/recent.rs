//! Poses of one rig that somebody has in hand, so that none is worked out twice: requests in the same pose share what comes of it, the
//! skinned vertices as well. Never lives here: working them out.

use crate::pose::{Pose, PoseOutOfRange, Posed};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// As many as are looked through in less time than working one out takes.
const MOST: usize = 16;

#[derive(Debug, Default)]
pub(super) struct RecentPoses(Mutex<VecDeque<(Pose, Weak<Posed>)>>);

impl RecentPoses {
    /// The pose worked out, now or by whoever has it in hand.
    ///
    /// # Errors
    /// As [`Posed::new`].
    pub(super) fn posed(&self, pose: Pose) -> Result<Arc<Posed>, PoseOutOfRange> {
        if let Some(posed) = self.find(&pose) {
            return Ok(posed);
        }
        // Not while others wait. Two that come at the same time both do it, which harms nobody.
        let posed = Arc::new(Posed::new(&pose)?);
        let mut recent = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        recent.truncate(MOST - 1);
        recent.push_front((pose, Arc::downgrade(&posed)));
        Ok(posed)
    }

    fn find(&self, pose: &Pose) -> Option<Arc<Posed>> {
        let mut recent = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        recent.retain(|(_, posed)| posed.strong_count() > 0);
        let found = recent.iter().find(|(other, _)| other.is_same(pose))?;
        found.1.upgrade()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::pose::PoseEdit;
    use crate::rig::{Draft, JointDraft};

    #[test]
    fn a_pose_in_hand_is_not_worked_out_again() {
        let joint = JointDraft {
            ..JointDraft::default()
        };
        let draft = Draft {
            joints: vec![joint],
            ..Draft::default()
        };
        let rig = Arc::new(draft.build(&Limits::default()).unwrap());
        let turned = |angle: f64| {
            let edit = PoseEdit {
                dofs: vec![(0, angle)],
                ..PoseEdit::default()
            };
            Pose::rest(&rig).edited(&edit).unwrap().0
        };
        let recent = RecentPoses::default();
        let first = recent.posed(turned(0.5)).unwrap();
        assert!(Arc::ptr_eq(&first, &recent.posed(turned(0.5)).unwrap()));
        for other in [0.25, 0.0, -0.0] {
            let other = recent.posed(turned(other)).unwrap();
            assert!(!Arc::ptr_eq(&first, &other));
        }
        let zero = recent.posed(turned(0.0)).unwrap();
        // The same angle, and other bits in what comes of it.
        assert!(!Arc::ptr_eq(&zero, &recent.posed(turned(-0.0)).unwrap()));
        drop(first);
        let many: Vec<_> = (0..100)
            .map(|index| recent.posed(turned(f64::from(index))).unwrap())
            .collect();
        assert!(recent.0.lock().unwrap().len() <= MOST);
        drop(many);
        recent.posed(turned(0.75)).unwrap();
        assert_eq!(recent.0.lock().unwrap().len(), 1);
    }
}
