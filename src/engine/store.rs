//! The loaded rigs by name, each with its stored pose.

use super::extents::Extents;
use super::recent::RecentPoses;
use super::{EngineError, PoseError};
use crate::formats::Loaded;
use crate::limits::Limits;
use crate::pose::{Clamped, Pose, Posed};
use crate::rig::Rig;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A rig as it was loaded.
#[derive(Debug)]
pub struct LoadedRig {
    /// What requests call it by, unique among the loaded rigs.
    pub name: Arc<str>,
    /// `sha256:` and 64 hexadecimal digits.
    pub digest: String,
    /// Which reader read each file.
    pub dialects: Vec<&'static str>,
    /// What the files hold together.
    pub rig: Arc<Rig>,
    /// How far it reaches at rest.
    pub extents: Extents,
    pub(super) recent: RecentPoses,
}

impl LoadedRig {
    /// A rig that nobody keeps yet, under `name` or its first file's stem.
    ///
    /// # Errors
    /// Where even the rest pose is out of range.
    pub fn new(loaded: Loaded, name: Option<&str>) -> Result<Self, EngineError> {
        let Loaded {
            rig,
            name: stem,
            digest,
            dialects,
        } = loaded;
        let name = name.map_or_else(|| stem.into(), Arc::from);
        let rig = Arc::new(rig);
        let rest = Posed::new(&Pose::rest(&rig)).map_err(PoseError::from)?;
        let extents = Extents::of(&rest);
        Ok(Self {
            name,
            digest,
            dialects,
            rig,
            extents,
            recent: RecentPoses::default(),
        })
    }

    /// What was odd in the files, a sentence each.
    pub fn warnings(&self) -> &[String] {
        self.rig.warnings()
    }
}

impl RigRef {
    /// A rig that nobody keeps, at rest.
    pub fn at_rest(loaded: LoadedRig) -> Self {
        let stored = Pose::rest(&loaded.rig);
        Self {
            loaded: Arc::new(loaded),
            stored,
            by_digest: false,
        }
    }
}

/// A rig as a request named it, with the pose that was stored at that moment.
#[derive(Debug, Clone)]
pub struct RigRef {
    /// The rig, kept alive also where it is unloaded meanwhile.
    pub loaded: Arc<LoadedRig>,
    /// The server's own pose of the rig, which is the file's until a request changes it.
    pub stored: Pose,
    /// Whether the request gave the digest rather than the name.
    pub by_digest: bool,
}

/// A pose that may be stored: it was worked out once. [`RigRef::changed`] makes them.
pub struct ChangedPose {
    pub(super) pose: Pose,
    pub(super) clamped: Vec<Clamped>,
}

struct Entry {
    loaded: Arc<LoadedRig>,
    stored: Pose,
}

pub(super) struct Store {
    entries: Mutex<BTreeMap<Arc<str>, Entry>>,
    limits: Limits,
}

impl Store {
    pub(super) fn new(limits: Limits) -> Self {
        Self {
            entries: Mutex::default(),
            limits,
        }
    }

    pub(super) fn keep(
        &self,
        name: Option<&str>,
        loaded: Loaded,
        replace: bool,
    ) -> Result<Arc<LoadedRig>, EngineError> {
        let named = name.unwrap_or(&loaded.name);
        if let Some(same) = self.same_as(named, &loaded.digest) {
            return Ok(same);
        }
        let loaded = Arc::new(LoadedRig::new(loaded, name)?);
        let (name, stored) = (loaded.name.clone(), Pose::rest(&loaded.rig));
        let bytes = loaded.rig.memory_bytes();
        let mut entries = self.lock();
        // Asked again under the lock: two connections may have been loading the same name.
        match entries.get(&name) {
            Some(entry) if entry.loaded.digest == loaded.digest => {
                return Ok(Arc::clone(&entry.loaded));
            }
            Some(_) if !replace => {
                return Err(EngineError::RigNameTaken {
                    rig: name.to_string(),
                });
            }
            _ => {}
        }
        let others = entries.iter().filter(|(other, _)| **other != name);
        let (count, other_bytes) = others.fold((0u64, 0u64), |(count, bytes), (_, entry)| {
            (count + 1, bytes + entry.loaded.rig.memory_bytes())
        });
        self.limits.rigs(count + 1)?;
        self.limits.rig_bytes(other_bytes + bytes)?;
        entries.insert(
            name,
            Entry {
                loaded: Arc::clone(&loaded),
                stored,
            },
        );
        Ok(loaded)
    }

    fn same_as(&self, name: &str, digest: &str) -> Option<Arc<LoadedRig>> {
        let entries = self.lock();
        let same = entries
            .get(name)
            .filter(|entry| entry.loaded.digest == digest);
        same.map(|entry| Arc::clone(&entry.loaded))
    }

    pub(super) fn remove(&self, rig: &str) -> Result<(), EngineError> {
        let mut entries = self.lock();
        let (name, _) = find(&entries, rig)?;
        entries.remove(&name);
        Ok(())
    }

    pub(super) fn find(&self, rig: &str) -> Result<RigRef, EngineError> {
        find(&self.lock(), rig).map(|(_, rig_ref)| rig_ref)
    }

    pub(super) fn all(&self) -> Vec<Arc<LoadedRig>> {
        self.lock()
            .values()
            .map(|entry| Arc::clone(&entry.loaded))
            .collect()
    }

    pub(super) fn bytes(&self) -> u64 {
        self.lock()
            .values()
            .map(|entry| entry.loaded.rig.memory_bytes())
            .sum()
    }

    /// The lock is held from reading the stored pose to writing it, so that no change of another connection is lost.
    pub(super) fn update_pose<E: From<EngineError>>(
        &self,
        rig: &str,
        update: impl FnOnce(&RigRef) -> Result<ChangedPose, E>,
    ) -> Result<(Arc<LoadedRig>, Vec<Clamped>), E> {
        let mut entries = self.lock();
        let (name, current) = find(&entries, rig)?;
        let ChangedPose {
            pose: stored,
            clamped,
        } = update(&current)?;
        let loaded = current.loaded;
        entries.insert(
            name,
            Entry {
                loaded: Arc::clone(&loaded),
                stored,
            },
        );
        Ok((loaded, clamped))
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<Arc<str>, Entry>> {
        // Entries are replaced whole, so a panic elsewhere left none half-written.
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The rig of that name, else the first by name that has that digest.
fn find(entries: &BTreeMap<Arc<str>, Entry>, rig: &str) -> Result<(Arc<str>, RigRef), EngineError> {
    let by_name = entries.get_key_value(rig);
    let by_digest = || entries.iter().find(|(_, entry)| entry.loaded.digest == rig);
    let (name, entry) = by_name
        .or_else(by_digest)
        .ok_or_else(|| EngineError::RigNotLoaded {
            rig: rig.to_owned(),
            loaded: entries.keys().cloned().collect(),
        })?;
    let (loaded, stored) = (Arc::clone(&entry.loaded), entry.stored.clone());
    Ok((
        name.clone(),
        RigRef {
            loaded,
            stored,
            by_digest: **name != *rig,
        },
    ))
}
