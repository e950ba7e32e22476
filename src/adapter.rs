//! Which renderer to use, and what it says of itself. Never lives here: finding out what there is.

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

/// A graphics interface that adapters are driven through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backend {
    /// Vulkan, on systems other than Apple's.
    Vulkan,
    /// OpenGL or OpenGL ES; its adapters come after those of all other interfaces.
    Gl,
    /// Metal, on Apple's systems alone.
    Metal,
    /// Direct3D 12, on Windows alone.
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
    /// As its driver gives it; a part of it is what [`AdapterChoice::Named`] asks for.
    pub name: String,
    /// `vulkan`, `gl`, `metal`, `dx12` or `cpu`.
    pub backend: &'static str,
    /// What draws: a GPU, or the CPU with or without a driver.
    pub kind: AdapterKind,
    /// Name and version as the driver gives them.
    pub driver: String,
    /// Why it was chosen, where it was.
    pub why: Option<String>,
}

/// How fast to expect it to be, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the CPU's memory, a virtual one, or one whose driver does not say which it is.
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
    /// The system has no adapter at all, not even a driver that draws on the CPU.
    #[error("no graphics adapter was found (`rigd doctor` tells more); `--adapter cpu` needs none")]
    None,
    /// None of the adapters is what was asked for, or the one that was in use is gone.
    #[error("no adapter matches `{asked}`; there are: {}", list(.found))]
    NoMatch {
        /// What `--adapter` says, or the name of the adapter that was in use.
        asked: String,
        /// All that were looked at.
        found: Vec<AdapterInfo>,
    },
    /// Those that match what was asked for draw on the CPU, but a real GPU is required.
    #[error("a real GPU is required, but there are only: {}", list(.found))]
    OnlySoftware {
        /// Those that match.
        found: Vec<AdapterInfo>,
    },
    /// Two requirements that exclude each other: rigd's own renderer, and a real GPU.
    #[error(
        "a real GPU is required, but rigd's own renderer was asked for, which draws on the CPU"
    )]
    CpuIsNoGpu,
    /// There is an adapter, but no device or thread to draw with can be made on it.
    #[error("no device can be created on the adapter {adapter}: {reason}")]
    NoDevice {
        /// Name, kind, interface and driver, as [`AdapterInfo`] displays them.
        adapter: String,
        /// The driver's or the system's own words.
        reason: String,
    },
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
    /// As `--adapter` and [`AdapterInfo::backend`] spell it.
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
