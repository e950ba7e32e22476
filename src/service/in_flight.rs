//! The requests of one connection that are not answered yet, by their ids. Never lives here: what becomes of them.

use super::response::{CancelHandle, ResponseHandle};
use crate::protocol::Id;
use std::collections::VecDeque;

/// The oldest first.
#[derive(Default)]
pub(super) struct InFlight(VecDeque<(Id, CancelHandle)>);

impl InFlight {
    pub(super) fn insert(&mut self, id: Id, response: &ResponseHandle) {
        self.0.retain(|(_, request)| request.is_open());
        self.0.push_back((id, response.cancel_handle()));
    }

    /// Ends every request of that id.
    pub(super) fn cancel(&self, id: &Id) {
        for (_, request) in self.0.iter().filter(|(other, _)| other == id) {
            request.cancel();
        }
    }
}
