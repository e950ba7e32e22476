//! Which renderer to use, and what it says of itself. Never lives here: finding out what there is.

use crate::frame::ImageKind;
use crate::limits::LimitExceeded;
use crate::pose::SkinDualQuaternion;
use crate::rig::Rig;
use crate::scene::Size;
use std::fmt;
use std::str::FromStr;

/// What `--adapter` asks for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum AdapterChoice {
    /// A real GPU, else rigd's own renderer.
    #[default]
    Auto,
    /// Rigd's own renderer, which needs no driver.
    Cpu,
    /// The best adapter of one graphics interface.
    Backend(Backend),
    /// The first whose name contains this, whatever the case of its letters.
    Named(String),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backend {
    Vulkan,
    Gl,
    Metal,
    Dx12,
}

impl FromStr for AdapterChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text.to_ascii_lowercase().as_str() {
            "auto" => Self::Auto,
            "cpu" => Self::Cpu,
            "vulkan" => Self::Backend(Backend::Vulkan),
            "gl" => Self::Backend(Backend::Gl),
            "metal" => Self::Backend(Backend::Metal),
            "dx12" => Self::Backend(Backend::Dx12),
            _ => Self::Named(text.to_owned()),
        })
    }
}

/// What an adapter says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterInfo {
    pub name: String,
    /// `vulkan`, `gl`, `metal`, `dx12` or `cpu`.
    pub backend: &'static str,
    pub kind: AdapterKind,
    /// Name and version as the driver gives them.
    pub driver: String,
    /// Why it was chosen, where it was.
    pub why: Option<String>,
}

/// How fast to expect it to be, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    Discrete,
    Integrated,
    /// A driver that draws on the CPU.
    Software,
    /// No driver: rigd's own renderer.
    Cpu,
}

impl AdapterKind {
    /// As the wire spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Discrete => "discrete",
            Self::Integrated => "integrated",
            Self::Software => "software",
            Self::Cpu => "cpu",
        }
    }
}

impl fmt::Display for AdapterInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            backend,
            kind,
            driver,
            why,
        } = self;
        match kind {
            AdapterKind::Cpu => write!(f, "{name} ({backend}, {driver})")?,
            _ => write!(f, "{name} ({}, {backend}, {driver})", kind.name())?,
        }
        why.iter().try_for_each(|why| write!(f, ": {why}"))
    }
}

/// Why there is no adapter to work with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AdapterError {
    #[error("no graphics adapter was found (`rigd doctor` tells more); `--adapter cpu` needs none")]
    None,
    #[error("no adapter matches `{asked}`; there are: {}", list(.found))]
    NoMatch {
        asked: String,
        found: Vec<AdapterInfo>,
    },
    #[error("a real GPU is required, but there are only: {}", list(.found))]
    OnlySoftware { found: Vec<AdapterInfo> },
    #[error("a real GPU is required, and rigd's own renderer asked for: only one can be had")]
    CpuIsNoGpu,
    #[error("the adapter {adapter} gives no device: {reason}")]
    NoDevice { adapter: String, reason: String },
}

fn list(found: &[AdapterInfo]) -> String {
    let names: Vec<_> = found.iter().map(ToString::to_string).collect();
    names.join("; ")
}

impl AdapterChoice {
    /// Whether an adapter is one of those asked for.
    pub fn takes(&self, info: &AdapterInfo) -> bool {
        match self {
            Self::Auto => true,
            Self::Cpu => info.kind == AdapterKind::Cpu,
            Self::Backend(backend) => info.backend == backend.name(),
            // Every name contains nothing.
            Self::Named(name) if name.trim().is_empty() => false,
            Self::Named(name) => info.name.to_lowercase().contains(&name.to_lowercase()),
        }
    }
}

impl Backend {
    pub fn name(self) -> &'static str {
        match self {
            Self::Vulkan => "vulkan",
            Self::Gl => "gl",
            Self::Metal => "metal",
            Self::Dx12 => "dx12",
        }
    }
}

impl fmt::Display for AdapterChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Cpu => "cpu",
            Self::Backend(backend) => backend.name(),
            Self::Named(name) => name,
        })
    }
}

/// What a renderer can do at most, known without it.
#[derive(Debug, Clone, Copy)]
pub struct Capabilities {
    /// Pixels of the side of a picture or texture.
    pub side: u64,
    /// Of one array of a rig or a picture; `None` where there is only memory itself.
    pub buffer_bytes: Option<u64>,
}

impl Capabilities {
    /// Name and value of each, as errors name them.
    pub fn entries(&self) -> impl Iterator<Item = (&'static str, u64)> + use<> {
        let bytes = self.buffer_bytes.map(|bytes| (BUFFER_BYTES, bytes));
        [(SIDE, self.side)].into_iter().chain(bytes)
    }

    /// # Errors
    /// Where a raster of this kind and size is larger than the adapter draws.
    pub fn accept_raster(&self, kind: ImageKind, size: Size) -> Result<(), LimitExceeded> {
        hold(SIDE, self.side, size.width.max(size.height).into())?;
        self.accept_bytes(kind.bytes(size) as u64)
    }

    fn accept_bytes(&self, bytes: u64) -> Result<(), LimitExceeded> {
        hold(BUFFER_BYTES, self.buffer_bytes.unwrap_or(u64::MAX), bytes)
    }

    /// # Errors
    /// Where a buffer or a texture of this rig is larger than the adapter takes.
    pub fn accept_rig(&self, rig: &Rig) -> Result<(), LimitExceeded> {
        // Those of all meshes stand in one buffer each, and so do their skinned vertices, six floats each. What else there is of a
        // vertex takes no more than that.
        let [influences, displacements, triangles] =
            rig.meshes().iter().fold([0; 3], |sums, mesh| {
                let [influences, displacements, triangles] = sums;
                [
                    influences + size_of_val(mesh.influences()),
                    displacements + size_of_val(mesh.morph_displacements()),
                    triangles + size_of_val(mesh.draw_triangles()),
                ]
            });
        let skinned = rig.draw_vertex_count() * 24;
        let palette = rig.bindings().len() * size_of::<SkinDualQuaternion>();
        let sizes = [influences, displacements, triangles, skinned, palette];
        let largest = sizes.into_iter().max().unwrap_or(0);
        self.accept_bytes(largest as u64)?;
        let sides = rig
            .textures()
            .map(|texture| texture.levels()[0].width.max(texture.levels()[0].height));
        hold(SIDE, self.side, sides.max().unwrap_or(0).into())
    }
}

const SIDE: &str = "adapter_side";
const BUFFER_BYTES: &str = "adapter_buffer_bytes";

fn hold(limit: &'static str, maximum: u64, asked: u64) -> Result<(), LimitExceeded> {
    if asked > maximum {
        Err(LimitExceeded {
            limit,
            maximum,
            asked,
        })
    } else {
        Ok(())
    }
}
