//! Memory that is worked in and kept: in a steady stream of like pictures none is asked for. Never lives here: what is in it.

use super::bin::Chunk;
use super::geometry::Surface;
use super::instance::DrawnInstance;
use super::material::PartMaterial;
use super::picture::{SkinMesh, SolidVertices};
use super::project::Projected;
use crate::render::order::PartPlace;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What one picture needs until it is drawn.
#[derive(Default)]
pub(super) struct Room {
    pub instances: Vec<DrawnInstance>,
    pub solids: SolidVertices,
    pub projected: Vec<Projected>,
    pub line_corners: Vec<[f32; 4]>,
    pub line_triangles: Vec<[u32; 3]>,
    pub chunks: Vec<Chunk>,
    /// Empty between pictures, as the next two.
    pub surfaces: Vec<Surface<'static>>,
    pub materials: Vec<PartMaterial<'static>>,
    pub meshes: Vec<SkinMesh<'static>>,
    /// Parts that blend, in their order.
    pub blending: Vec<(f64, PartPlace)>,
}

/// Rooms that nobody works in: as many as were ever used at a time.
pub(super) struct Rooms<T>(Mutex<Kept<T>>);

struct Kept<T> {
    rooms: Vec<Box<T>>,
    /// How often they were cleared: a room lent before that is not taken back.
    clearings: u64,
}

impl<T> Default for Rooms<T> {
    fn default() -> Self {
        Self(Mutex::new(Kept {
            rooms: Vec::new(),
            clearings: 0,
        }))
    }
}

impl<T> Rooms<T> {
    /// Lets go of all of them; of those that are lent as soon as they come back.
    pub fn clear(&self) {
        let mut kept = self.kept();
        kept.rooms.clear();
        kept.clearings += 1;
    }

    fn kept(&self) -> MutexGuard<'_, Kept<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Default> Rooms<T> {
    pub fn take(self: &Arc<Self>) -> Lent<T> {
        let mut kept = self.kept();
        let (room, clearings) = (kept.rooms.pop(), kept.clearings);
        drop(kept);
        Lent {
            room: Some(room.unwrap_or_default()),
            rooms: Arc::clone(self),
            clearings,
        }
    }
}

/// A room, given back on drop.
pub(super) struct Lent<T> {
    room: Option<Box<T>>,
    rooms: Arc<Rooms<T>>,
    clearings: u64,
}

impl<T> Deref for Lent<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.room.as_deref().expect("lent until it is dropped")
    }
}

impl<T> DerefMut for Lent<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.room.as_deref_mut().expect("lent until it is dropped")
    }
}

impl<T> Drop for Lent<T> {
    fn drop(&mut self) {
        let mut kept = self.rooms.kept();
        if kept.clearings == self.clearings {
            kept.rooms.extend(self.room.take());
        }
    }
}
