//! From files to a [`Rig`]: finds out what each file is, reads it, and looks up what it refers to.
//! Never lives here: posing, drawing, and any file name that the request did not give.

mod cse169;
mod digest;
mod error;
mod lexer;
mod pictures;
mod recognise;
mod sent;
mod source;
mod text;
mod textures;

pub use error::{FileFault, LoadError};
pub use source::Source;

use crate::limits::Limits;
use crate::rig::{BindingDraft, Draft, Material, MeshDraft, Rig, RigError};
use cse169::skel;
use cse169::skin::{self, BoundTo, Skin};
use recognise::Kind;
use sent::Sent;
use source::Budget;
use std::sync::Arc;
use textures::Textures;

/// What is read, in the words of [`Loaded::dialects`].
pub const FORMATS: &[&str] = &[SKEL, SKIN];

const SKEL: &str = "cse169 skel";
const SKIN: &str = "cse169 skin";

/// A file as a request names it.
#[derive(Debug, Clone)]
pub enum FileRef {
    /// Opened by the [`Source`]; relative to its root where it has one.
    Path(String),
    Inline(File),
}

/// A file that came with the request.
#[derive(Debug, Clone)]
pub struct File {
    /// As given, e.g. `wasp/wasp.skel`; other files know it by what follows the last slash.
    pub name: String,
    pub bytes: Arc<[u8]>,
}

/// A rig and what its files say about it as files.
#[derive(Debug)]
pub struct Loaded {
    pub rig: Rig,
    /// The stem of the first file.
    pub name: String,
    /// `sha256:<hex>` over all files, those referred to included.
    pub digest: String,
    /// The readers that were used, each once, out of [`FORMATS`].
    pub dialects: Vec<&'static str>,
}

/// Reads at most one skeleton and any number of skins, each of which becomes a mesh bound to it. Without a skeleton, skins stay as
/// they were modelled. What the files contain that could be worked with, but should not be there, is in [`Rig::warnings`].
///
/// # Errors
/// [`LoadError`] names the file that is missing, forbidden or wrong, and what is wrong where.
pub fn load(files: &[FileRef], source: &Source, limits: &Limits) -> Result<Loaded, LoadError> {
    let mut budget = Budget::new(limits);
    let sent = sent::gather(files, source, &mut budget)?;
    let skeleton = sent::only_skeleton(&sent)?;
    let skins: Vec<&Sent> = sent::of_kind(&sent, Kind::Cse169Skin).collect();

    let mut draft = Draft::default();
    if let Some(file) = skeleton {
        draft.joints = skel::read(file.lexer()?, limits, &mut draft.warnings)?;
    }
    let bound_to = skeleton.map(|file| BoundTo {
        file: &file.name,
        joint_count: draft.joints.len(),
    });
    let mut textures = Textures::new(&sent, source, budget, limits);
    for file in &skins {
        let skin = skin::read(file.lexer()?, bound_to, limits, &mut draft.warnings)?;
        add_skin(&mut draft, skin, file, &mut textures)?;
    }
    textures.warn_of_unused(&mut draft.warnings);
    let rig = draft
        .build(limits)
        .map_err(|error| told(error, skeleton, &skins))?;

    let readers = [(SKEL, skeleton.is_some()), (SKIN, !skins.is_empty())];
    Ok(Loaded {
        rig,
        name: recognise::stem(&sent[0].name).to_owned(),
        digest: digest::of(textures.all_files()),
        dialects: readers
            .iter()
            .filter(|(_, used)| *used)
            .map(|(reader, _)| *reader)
            .collect(),
    })
}

/// Adds a skin as a mesh of its own, bound joint by joint where there is a skeleton.
fn add_skin(
    draft: &mut Draft,
    skin: Skin,
    file: &Sent,
    textures: &mut Textures,
) -> Result<(), LoadError> {
    let material = match skin.material {
        None => None,
        Some(material) => {
            let texture = match &material.texture {
                Some(name) => textures.look_up(file, name, &mut draft.warnings)?,
                None => None,
            };
            draft.materials.push(Material {
                name: material.name,
                texture,
            });
            Some(draft.materials.len() - 1)
        }
    };
    let mut mesh = MeshDraft {
        material,
        ..skin.mesh
    };
    if draft.joints.is_empty() {
        // Nothing to be bound to: it stays as it was modelled.
        mesh.influence_counts.clear();
        mesh.influences.clear();
    } else {
        // Each skin has bindings of its own. Four thousand million of them would not fit any file.
        let first = draft.bindings.len() as u32;
        let bindings = skin.bindings.into_iter().enumerate();
        draft
            .bindings
            .extend(bindings.map(|(joint, bind_from_joint)| BindingDraft {
                joint: Some(joint),
                bind_from_joint,
            }));
        for (binding, _) in &mut mesh.influences {
            *binding += first;
        }
    }
    draft.meshes.push(mesh);
    Ok(())
}

/// What the readers let through and the rig refuses all the same: told of the file it most likely came from.
fn told(error: RigError, skeleton: Option<&Sent>, skins: &[&Sent]) -> LoadError {
    let of_mesh = |mesh: usize| skins.get(mesh).copied();
    let file = match error {
        RigError::Limit(exceeded) => return exceeded.into(),
        RigError::CountsDiffer { mesh, .. } | RigError::OutOfRange { mesh, .. } => of_mesh(mesh),
        RigError::SingularBinding { .. } => of_mesh(0),
        RigError::NotFinite { mesh, .. } => mesh.and_then(of_mesh).or(skeleton),
        RigError::Empty
        | RigError::ParentNotBefore { .. }
        | RigError::SecondRoot { .. }
        | RigError::LimitReversed { .. }
        | RigError::NoSuchDof { .. }
        | RigError::KeysOutOfOrder { .. }
        | RigError::VertexTwice { .. } => skeleton,
    };
    let name = file
        .or(skeleton)
        .or(of_mesh(0))
        .map_or("", |file| &file.name);
    FileFault::whole(name, "a rig without contradictions", error.to_string()).into()
}
