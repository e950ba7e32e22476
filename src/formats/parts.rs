//! Which files a rig is made of, told apart, and whether they go together.
//! Never lives here: what is in them, but for the `.rig` that lists others.

use super::cse169::list::{self, Entry, Role};
use super::error::{FileFault, LoadError};
use super::files::{Files, Gathered};
use super::lexer::Lexer;
use super::recognise::{self, Kind, base_name};
use super::source::Denied;
use crate::limits::Limits;
use crate::rig::Warnings;
use std::collections::HashSet;
use std::sync::Arc;

/// The files that become a rig, and nothing else. What a `.rig` lists comes first and in its order, then come the other files of the
/// request in theirs, so that a list means the same rig whether what it lists was sent or found.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub list: Option<Arc<Gathered>>,
    pub skeleton: Option<Arc<Gathered>>,
    /// Skins and OBJ files.
    pub meshes: Vec<Arc<Gathered>>,
    pub attachments: Option<Arc<Gathered>>,
    pub morphs: Vec<Arc<Gathered>>,
    pub clips: Vec<Arc<Gathered>>,
    /// All of a rig in one.
    pub document: Option<Arc<Gathered>>,
}

impl Parts {
    /// Finds what a `.rig` lists, if there is one, and checks that everything needed is there once.
    pub(super) fn gather(
        files: &mut Files,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Self, LoadError> {
        let sent = files.sent().to_vec();
        let mut parts = Self::default();
        for file in sent.iter().filter(|file| file.kind == Kind::Cse169Rig) {
            parts.add(file.clone())?;
        }
        let listed = match parts.list.clone() {
            Some(list) => listed(&list, files, limits, warnings)?,
            None => Vec::new(),
        };
        let is_listed = |file: &Arc<Gathered>| listed.iter().any(|it| Arc::ptr_eq(it, file));
        let others = sent
            .iter()
            .filter(|file| file.kind != Kind::Cse169Rig && !is_listed(file));
        for file in listed.iter().chain(others) {
            parts.add(file.clone())?;
        }
        let is_part = |file: &Arc<Gathered>| file.kind.reader().is_some();
        if let Some(first) = sent.first().filter(|_| !sent.iter().any(is_part)) {
            let found = first.kind.described(&first.bytes);
            return Err(FileFault::whole(&first.name, recognise::EXPECTED, found).into());
        }
        parts.check_document()?;
        parts.check_morphs()?;
        parts.check_clips()?;
        parts.check_attachments()?;
        Ok(parts)
    }

    fn add(&mut self, file: Arc<Gathered>) -> Result<(), LoadError> {
        match file.kind {
            Kind::Cse169Skel | Kind::MitSkel => {
                if let Some(first) = &self.skeleton {
                    return Err(LoadError::TwoSkeletons {
                        first: first.name.clone(),
                        second: file.name.clone(),
                    });
                }
                self.skeleton = Some(file);
            }
            Kind::Cse169Skin | Kind::Obj => self.meshes.push(file),
            Kind::Cse169Morph => self.morphs.push(file),
            Kind::Cse169Anim => self.clips.push(file),
            Kind::Cse169Rig => put_once(&mut self.list, file, "one `.rig` in a request")?,
            Kind::MitAttach => put_once(&mut self.attachments, file, "one `.attach` in the rig")?,
            Kind::Gltf => put_once(&mut self.document, file, "one glTF document in the rig")?,
            Kind::Unsupported(_) | Kind::Other => {}
        }
        Ok(())
    }

    pub(super) fn meshes_of(&self, kind: Kind) -> impl Iterator<Item = &Arc<Gathered>> {
        self.meshes.iter().filter(move |file| file.kind == kind)
    }

    /// Every file in it.
    pub(super) fn all(&self) -> impl Iterator<Item = &Arc<Gathered>> {
        let alone = [
            &self.list,
            &self.skeleton,
            &self.attachments,
            &self.document,
        ];
        let many = [&self.meshes, &self.morphs, &self.clips];
        alone
            .into_iter()
            .flatten()
            .chain(many.into_iter().flatten())
    }

    fn check_document(&self) -> Result<(), FileFault> {
        let Some(document) = &self.document else {
            return Ok(());
        };
        match self.all().find(|file| !Arc::ptr_eq(file, document)) {
            Some(other) => {
                let found = format!("`{}`, {}", other.name, other.kind.described(&other.bytes));
                let expected = "no other rig file beside a glTF document";
                Err(FileFault::whole(&document.name, expected, found))
            }
            None => Ok(()),
        }
    }

    fn check_morphs(&self) -> Result<(), FileFault> {
        let Some(morph) = self.morphs.first() else {
            return Ok(());
        };
        let mut skins = self.meshes_of(Kind::Cse169Skin);
        let found = match (skins.next(), skins.next()) {
            (Some(_), None) => return Ok(()),
            (Some(first), Some(second)) => both(first, second),
            _ => "none".to_owned(),
        };
        let expected = "one skin in the rig, which this morph target changes";
        Err(FileFault::whole(&morph.name, expected, found))
    }

    fn check_clips(&self) -> Result<(), FileFault> {
        match self.clips.first() {
            Some(clip) if self.skeleton.is_none() => {
                let expected = "a skeleton in the rig, which this animation moves";
                Err(FileFault::whole(&clip.name, expected, "none"))
            }
            _ => Ok(()),
        }
    }

    /// An OBJ file says nothing of joints: with a skeleton there has to be a file that does.
    fn check_attachments(&self) -> Result<(), FileFault> {
        let mut meshes = self.meshes_of(Kind::Obj);
        let (mesh, second) = (meshes.next(), meshes.next());
        let skeleton = self.skeleton.as_ref();
        let Some(attachments) = &self.attachments else {
            return match (mesh, skeleton) {
                (Some(mesh), Some(skeleton)) => {
                    let expected = format!(
                        "an `.attach` file in the rig, which attaches this mesh to `{}`",
                        skeleton.name
                    );
                    Err(FileFault::whole(&mesh.name, expected, "none"))
                }
                _ => Ok(()),
            };
        };
        let wrong = |expected: &str, found: String| {
            Err(FileFault::whole(&attachments.name, expected, found))
        };
        const MESH: &str = "one OBJ mesh in the rig, which this file attaches to a skeleton";
        const SKELETON: &str = "a MIT 6.837 skeleton, which this file attaches a mesh to";
        match (mesh, second, skeleton) {
            (None, _, _) => wrong(MESH, "none".to_owned()),
            (Some(first), Some(second), _) => wrong(MESH, both(first, second)),
            (_, _, None) => wrong(SKELETON, "none".to_owned()),
            (_, _, Some(other)) if other.kind != Kind::MitSkel => {
                let found = format!("`{}`, {}", other.name, other.kind.described(&other.bytes));
                wrong(SKELETON, found)
            }
            _ => Ok(()),
        }
    }
}

fn put_once(
    place: &mut Option<Arc<Gathered>>,
    file: Arc<Gathered>,
    expected: &str,
) -> Result<(), FileFault> {
    if let Some(first) = place {
        return Err(FileFault::whole(&file.name, expected, both(first, &file)));
    }
    *place = Some(file);
    Ok(())
}

fn both(first: &Gathered, second: &Gathered) -> String {
    format!("both `{}` and `{}`", first.name, second.name)
}

/// What a `.rig` lists, in its order.
fn listed(
    list: &Arc<Gathered>,
    files: &mut Files,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Vec<Arc<Gathered>>, LoadError> {
    let text = list.uncommented(warnings)?;
    let entries = list::read(Lexer::new(&list.name, &text), limits, warnings)?;
    let mut names = HashSet::new();
    let mut listed = Vec::with_capacity(entries.len());
    for entry in entries {
        let file = open_entry(list, &entry, files)?;
        if !names.insert(base_name(&file.name).to_owned()) {
            let expected = "each file once";
            return Err(entry
                .fault(&list.name, expected, "a second mention of it")
                .into());
        }
        listed.push(file);
    }
    Ok(listed)
}

fn open_entry(
    list: &Arc<Gathered>,
    entry: &Entry,
    files: &mut Files,
) -> Result<Arc<Gathered>, LoadError> {
    let wanted = match entry.role {
        Role::Skeleton => Kind::Cse169Skel,
        Role::Skin => Kind::Cse169Skin,
        Role::Morph => Kind::Cse169Morph,
    };
    let found = match files.look_up(list, &entry.file) {
        Ok(file) if file.kind == wanted => return Ok(file),
        Ok(file) if Arc::ptr_eq(&file, list) => "this `.rig` itself".to_owned(),
        Ok(file) => file.kind.described(&file.bytes),
        Err(Denied::Limit(exceeded)) => return Err(exceeded.into()),
        Err(Denied::NotFound) if list.by_path => {
            "no such file in the request or beside this one".to_owned()
        }
        Err(Denied::NotFound) => "no such file in the request".to_owned(),
        Err(Denied::NotAllowed(reason)) => format!("that it may not be opened: {reason}"),
        Err(Denied::Io(error)) => format!("that it cannot be read: {error}"),
    };
    let expected = entry.expected(&wanted.described(&[]));
    Err(entry.fault(&list.name, expected, found).into())
}
