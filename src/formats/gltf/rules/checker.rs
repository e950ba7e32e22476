//! What all rules are checked with. Never lives here: a rule.

use crate::formats::gltf::fault::Faults;
use crate::rig::Warnings;
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

pub(super) struct Checker<'a> {
    pub faults: Faults<'a>,
    pub root: &'a Root,
    pub warnings: &'a mut Warnings,
}

impl Checker<'_> {
    pub(super) fn warn(&mut self, sentence: impl FnOnce() -> String) {
        let faults = self.faults;
        self.warnings.push(|| faults.warning(&sentence()));
    }

    /// Where an index leads nowhere: of something that is not used, or it would be a fault.
    pub(super) fn check_index<T>(
        &mut self,
        list: &[T],
        index: Option<Index<T>>,
        path: impl FnOnce() -> String,
    ) {
        if let Some(index) = index.filter(|index| index.value() >= list.len()) {
            self.warn(|| format!("{} is {}, which does not exist", path(), index.value()));
        }
    }

    /// Warns of a word or a number that is not known. `instead` says what is read in its place.
    pub(super) fn check_known<T>(
        &mut self,
        value: &Checked<T>,
        path: impl FnOnce() -> String,
        instead: &str,
    ) {
        if matches!(value, Checked::Invalid) {
            let faults = self.faults;
            self.warn(|| {
                let path = path();
                let found = faults.found(&path);
                format!("{path} is {found}, which is not known; {instead}")
            });
        }
    }
}
