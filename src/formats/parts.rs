//! Which files a rig is made of, by what they contribute, and whether they go together.
//! Never lives here: what is in them, but for a list of files.

use super::context::Context;
use super::contribution::{ListEntry, LooseClip};
use super::error::{FileFault, LoadError};
use super::files::Gathered;
use super::format::Format;
use super::names::base_name;
use super::reader::{Contribution, MeshReader, MorphReader, Read, Reader, WeightsReader};
use super::readers::{READERS, reader_of};
use super::source::Denied;
use crate::rig::{Draft, JointDraft};
use std::collections::HashSet;
use std::sync::Arc;

/// A file of the rig and how it is read.
#[derive(Debug, Clone)]
pub(super) struct Part<R> {
    pub file: Arc<Gathered>,
    pub read: R,
}

/// The files that become a rig, and nothing else. What a list names comes first and in its order, then come the other files of the
/// request in theirs, so that a list means the same rig whether what it names was sent or found.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub list: Option<Part<Read<Vec<ListEntry>>>>,
    pub whole: Option<Part<Read<Draft>>>,
    pub skeleton: Option<Part<Read<Vec<JointDraft>>>>,
    pub meshes: Vec<Part<MeshReader>>,
    pub weights: Option<Part<WeightsReader>>,
    pub morphs: Vec<Part<MorphReader>>,
    pub clips: Vec<Part<Read<LooseClip>>>,
}

impl Parts {
    /// Finds what a list names, if there is one, and checks that everything needed is there once.
    pub(super) fn gather(context: &mut Context) -> Result<Self, LoadError> {
        let sent: Vec<_> = context
            .files
            .sent()
            .iter()
            .filter_map(with_reader)
            .collect();
        let mut parts = Self::default();
        let is_list = |reader: &Reader| matches!(reader.contribution, Contribution::List(_));
        for (file, reader) in sent.iter().filter(|(_, reader)| is_list(reader)) {
            parts.add(file.clone(), reader)?;
        }
        let listed = match &parts.list {
            Some(list) => open_entries(&list.file, (list.read)(&list.file, context)?, context)?,
            None => Vec::new(),
        };
        for (file, reader) in listed.iter().filter_map(with_reader) {
            parts.add(file, reader)?;
        }
        let is_listed = |file: &Arc<Gathered>| listed.iter().any(|it| Arc::ptr_eq(it, file));
        for (file, reader) in &sent {
            if !is_list(reader) && !is_listed(file) {
                parts.add(file.clone(), reader)?;
            }
        }
        if let Some(first) = context.files.sent().first().filter(|_| sent.is_empty()) {
            let (expected, found) = (context.files.formats().expected(), first.described());
            return Err(FileFault::whole(&first.name, expected, found).into());
        }
        parts.check()?;
        Ok(parts)
    }

    fn add(&mut self, file: Arc<Gathered>, reader: &Reader) -> Result<(), LoadError> {
        let in_rig = || format!("one {} in the rig", reader.format.noun);
        match reader.contribution {
            Contribution::List(read) => {
                let expected = || format!("one {} in a request", reader.format.noun);
                put_once(&mut self.list, Part { file, read }, expected)?;
            }
            Contribution::Whole(read) => put_once(&mut self.whole, Part { file, read }, in_rig)?,
            Contribution::Skeleton(read) => {
                if let Some(first) = &self.skeleton {
                    return Err(LoadError::TwoSkeletons {
                        first: first.file.name.clone(),
                        second: file.name.clone(),
                    });
                }
                self.skeleton = Some(Part { file, read });
            }
            Contribution::Mesh(read) => self.meshes.push(Part { file, read }),
            Contribution::Weights(read) => {
                put_once(&mut self.weights, Part { file, read }, in_rig)?;
            }
            Contribution::Morph(read) => self.morphs.push(Part { file, read }),
            Contribution::Clip(read) => self.clips.push(Part { file, read }),
        }
        Ok(())
    }

    /// Every file in it.
    pub(super) fn all(&self) -> impl Iterator<Item = &Arc<Gathered>> {
        let alone = [
            self.list.as_ref().map(|part| &part.file),
            self.skeleton.as_ref().map(|part| &part.file),
            self.weights.as_ref().map(|part| &part.file),
            self.whole.as_ref().map(|part| &part.file),
        ];
        let meshes = self.meshes.iter().map(|part| &part.file);
        let morphs = self.morphs.iter().map(|part| &part.file);
        let clips = self.clips.iter().map(|part| &part.file);
        let alone = alone.into_iter().flatten();
        alone.chain(meshes).chain(morphs).chain(clips)
    }

    fn check(&self) -> Result<(), FileFault> {
        self.check_whole()?;
        for morph in &self.morphs {
            self.mesh_of_morph(morph)?;
        }
        if let (Some(clip), None) = (self.clips.first(), &self.skeleton) {
            let expected = "a skeleton in the rig, which this animation moves";
            return Err(FileFault::whole(&clip.file.name, expected, "none"));
        }
        match &self.weights {
            Some(weights) => {
                self.mesh_of_weights(weights)?;
                self.skeleton_of_weights(weights).map(drop)
            }
            None => self.check_unbound(),
        }
    }

    fn check_whole(&self) -> Result<(), FileFault> {
        let Some(whole) = &self.whole else {
            return Ok(());
        };
        match self.all().find(|file| !Arc::ptr_eq(file, &whole.file)) {
            Some(other) => {
                let expected = format!("no other rig file beside {}", whole.file.described());
                Err(FileFault::whole(&whole.file.name, expected, named(other)))
            }
            None => Ok(()),
        }
    }

    /// The index of the mesh that a morph target is of.
    pub(super) fn mesh_of_morph(&self, morph: &Part<MorphReader>) -> Result<usize, FileFault> {
        let purpose = "which this morph target changes";
        self.one_mesh(morph.read.mesh, &morph.file, purpose)
    }

    /// The index of the mesh that weights are of.
    pub(super) fn mesh_of_weights(
        &self,
        weights: &Part<WeightsReader>,
    ) -> Result<usize, FileFault> {
        let purpose = "which this file attaches to a skeleton";
        self.one_mesh(weights.read.mesh, &weights.file, purpose)
    }

    fn one_mesh(
        &self,
        format: &Format,
        file: &Gathered,
        purpose: &str,
    ) -> Result<usize, FileFault> {
        let meshes = self.meshes.iter().map(|part| &part.file).enumerate();
        let mut meshes = meshes.filter(|(_, mesh)| mesh.recognised.format() == Some(format));
        let found = match (meshes.next(), meshes.next()) {
            (Some((index, _)), None) => return Ok(index),
            (Some((_, first)), Some((_, second))) => both(first, second),
            (None, _) => "none".to_owned(),
        };
        let expected = format!("one {} in the rig, {purpose}", format.noun);
        Err(FileFault::whole(&file.name, expected, found))
    }

    /// The file of the skeleton that weights bind a mesh to.
    pub(super) fn skeleton_of_weights(
        &self,
        weights: &Part<WeightsReader>,
    ) -> Result<&Gathered, FileFault> {
        let wanted = weights.read.skeleton;
        let found = match &self.skeleton {
            Some(part) if part.file.recognised.format() == Some(wanted) => return Ok(&part.file),
            Some(other) => named(&other.file),
            None => "none".to_owned(),
        };
        let expected = format!("{}, which this file attaches a mesh to", wanted.what);
        Err(FileFault::whole(&weights.file.name, expected, found))
    }

    /// Without weights no mesh may stand beside a skeleton that does not bind itself to it.
    fn check_unbound(&self) -> Result<(), FileFault> {
        let mut meshes = self.meshes.iter();
        let unbound = meshes.find(|mesh| matches!(mesh.read, MeshReader::Unbound(_)));
        let (Some(mesh), Some(skeleton)) = (unbound, &self.skeleton) else {
            return Ok(());
        };
        let binds = |reader: &&Reader| match reader.contribution {
            Contribution::Weights(read) => mesh.file.recognised.format() == Some(read.mesh),
            _ => false,
        };
        let weights = READERS.into_iter().find(binds);
        let noun = weights.map_or("weights", |reader| reader.format.noun);
        let expected = format!(
            "a file of kind {noun} in the rig, which attaches this mesh to `{}`",
            skeleton.file.name
        );
        Err(FileFault::whole(&mesh.file.name, expected, "none"))
    }
}

/// `None` of a file that no reader takes.
fn with_reader(file: &Arc<Gathered>) -> Option<(Arc<Gathered>, &'static Reader)> {
    Some((file.clone(), reader_of(file.recognised.format()?)?))
}

fn put_once<R>(
    slot: &mut Option<Part<R>>,
    part: Part<R>,
    expected: impl Fn() -> String,
) -> Result<(), FileFault> {
    if let Some(first) = slot {
        let found = both(&first.file, &part.file);
        return Err(FileFault::whole(&part.file.name, expected(), found));
    }
    *slot = Some(part);
    Ok(())
}

fn both(first: &Gathered, second: &Gathered) -> String {
    format!("both `{}` and `{}`", first.name, second.name)
}

fn named(file: &Gathered) -> String {
    format!("`{}`, {}", file.name, file.described())
}

/// The files that a list names, in its order.
fn open_entries(
    list: &Arc<Gathered>,
    entries: Vec<ListEntry>,
    context: &mut Context,
) -> Result<Vec<Arc<Gathered>>, LoadError> {
    let mut names = HashSet::new();
    let mut listed = Vec::with_capacity(entries.len());
    for entry in entries {
        let file = open_entry(list, &entry, context)?;
        if !names.insert(base_name(&file.name).to_owned()) {
            let fault = entry.fault(&list.name, "each file once", "a second mention of it");
            return Err(fault.into());
        }
        listed.push(file);
    }
    Ok(listed)
}

fn open_entry(
    list: &Arc<Gathered>,
    entry: &ListEntry,
    context: &mut Context,
) -> Result<Arc<Gathered>, LoadError> {
    let found = match context.files.look_up(list, &entry.file) {
        Ok(file) if file.recognised.format() == Some(entry.format) => return Ok(file),
        Ok(file) if Arc::ptr_eq(&file, list) => "this `.rig` itself".to_owned(),
        Ok(file) => file.described(),
        Err(Denied::Limit(exceeded)) => return Err(exceeded.into()),
        Err(Denied::NotFound) if list.by_path => {
            "no such file in the request or beside this one".to_owned()
        }
        Err(Denied::NotFound) => "no such file in the request".to_owned(),
        Err(Denied::NotAllowed(reason)) => format!("that it may not be opened: {reason}"),
        Err(Denied::Io(error)) => format!("that it cannot be read: {error}"),
    };
    Err(entry.fault(&list.name, entry.expected(), found).into())
}
