//! What all readers of one rig share. Never lives here: what they read.

use super::files::Files;
use super::textures::Textures;
use crate::limits::Limits;
use crate::rig::Warnings;

pub(super) struct Context<'a> {
    pub limits: &'a Limits,
    pub files: Files<'a>,
    /// Of files beside those that are read; a document that holds its own pictures has its own.
    pub textures: Textures<'a>,
    pub warnings: Warnings,
}
