//! The GPU's stages without a GPU: the oracle that it is compared with, and what answers where no picture is needed.
//! So far it skins; drawing follows.

mod skin;

pub use skin::{SkinnedVertex, skin_mesh};
