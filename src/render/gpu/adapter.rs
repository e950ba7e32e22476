//! Which graphics adapter to use, and what there is to choose from.

use pollster::block_on;
use std::fmt;
use std::str::FromStr;

/// What `--adapter` asks for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum AdapterChoice {
    /// A real GPU, else Vulkan's software driver, else GL.
    #[default]
    Auto,
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
    /// `vulkan`, `gl`, `metal` or `dx12`.
    pub backend: &'static str,
    pub kind: AdapterKind,
    /// Name and version as the driver gives them.
    pub driver: String,
}

/// How fast to expect it to be, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    Discrete,
    Integrated,
    /// A driver that draws on the CPU.
    Software,
}

impl AdapterKind {
    /// As the wire spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Discrete => "discrete",
            Self::Integrated => "integrated",
            Self::Software => "software",
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
        } = self;
        write!(f, "{name} ({}, {backend}, {driver})", kind.name())
    }
}

/// Why there is no adapter to work with.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AdapterError {
    #[error(
        "no graphics adapter was found; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` brings a software one \
         (`rigd doctor` tells more)"
    )]
    None,
    #[error("no adapter matches `{asked}`; there are: {}", list(.found))]
    NoMatch {
        asked: String,
        found: Vec<AdapterInfo>,
    },
    #[error("a real GPU is required, but there are only: {}", list(.found))]
    OnlySoftware { found: Vec<AdapterInfo> },
    #[error("the adapter {adapter} gives no device: {reason}")]
    NoDevice { adapter: String, reason: String },
}

fn list(found: &[AdapterInfo]) -> String {
    let names: Vec<_> = found.iter().map(ToString::to_string).collect();
    names.join("; ")
}

/// Every adapter of this machine, best first.
pub fn adapters() -> Vec<AdapterInfo> {
    let found = [NATIVE, LAST].into_iter().flat_map(found);
    found.map(|adapter| info(&adapter.get_info())).collect()
}

/// The adapter to use, before a device is opened on it.
pub(super) fn choose(
    choice: &AdapterChoice,
    require_gpu: bool,
) -> Result<wgpu::Adapter, AdapterError> {
    let is_asked_for = |info: &AdapterInfo| match choice {
        AdapterChoice::Auto => true,
        AdapterChoice::Backend(backend) => info.backend == backend.name(),
        AdapterChoice::Named(name) => info.name.to_lowercase().contains(&name.to_lowercase()),
    };
    let is_allowed = |info: &AdapterInfo| !require_gpu || info.kind != AdapterKind::Software;
    let mut seen = Vec::new();
    for backends in [NATIVE, LAST] {
        for adapter in found(backends) {
            let info = info(&adapter.get_info());
            if is_asked_for(&info) && is_allowed(&info) {
                return Ok(adapter);
            }
            seen.push(info);
        }
    }
    Err(if seen.is_empty() {
        AdapterError::None
    } else if seen.iter().any(is_asked_for) {
        AdapterError::OnlySoftware { found: seen }
    } else {
        AdapterError::NoMatch {
            asked: choice.to_string(),
            found: seen,
        }
    })
}

impl Backend {
    fn name(self) -> &'static str {
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
            Self::Backend(backend) => backend.name(),
            Self::Named(name) => name,
        })
    }
}

/// Best first.
fn found(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    // Validation layers and debug names are for who works on rigd, by wgpu's own environment variables.
    descriptor.flags = wgpu::InstanceFlags::empty().with_env();
    let instance = wgpu::Instance::new(descriptor);
    let mut adapters = block_on(instance.enumerate_adapters(backends));
    adapters.retain(|adapter| backend_name(adapter.get_info().backend).is_some());
    // Stable, so that the drivers' own order decides between equals.
    adapters.sort_by_key(|adapter| info_kind(&adapter.get_info()));
    adapters
}

/// GL after everything else: its libraries look for displays, take their time and complain on standard error, so that they are
/// only asked where nothing else will do.
const NATIVE: wgpu::Backends = wgpu::Backends::PRIMARY;
const LAST: wgpu::Backends = wgpu::Backends::GL;

pub(super) fn info(info: &wgpu::AdapterInfo) -> AdapterInfo {
    AdapterInfo {
        name: info.name.clone(),
        backend: backend_name(info.backend).unwrap_or("other"),
        kind: info_kind(info),
        driver: format!("{} {}", info.driver, info.driver_info)
            .trim()
            .to_owned(),
    }
}

fn backend_name(backend: wgpu::Backend) -> Option<&'static str> {
    match backend {
        wgpu::Backend::Vulkan => Some(Backend::Vulkan.name()),
        wgpu::Backend::Gl => Some(Backend::Gl.name()),
        wgpu::Backend::Metal => Some(Backend::Metal.name()),
        wgpu::Backend::Dx12 => Some(Backend::Dx12.name()),
        wgpu::Backend::Noop | wgpu::Backend::BrowserWebGpu => None,
    }
}

fn info_kind(info: &wgpu::AdapterInfo) -> AdapterKind {
    // Mesa's GL driver on the CPU gives its type as "other".
    let draws_on_cpu = ["llvmpipe", "softpipe", "swiftshader", "lavapipe"];
    let name = info.name.to_lowercase();
    match info.device_type {
        wgpu::DeviceType::Cpu => AdapterKind::Software,
        _ if draws_on_cpu.iter().any(|software| name.contains(software)) => AdapterKind::Software,
        wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
        wgpu::DeviceType::IntegratedGpu
        | wgpu::DeviceType::VirtualGpu
        | wgpu::DeviceType::Other => AdapterKind::Integrated,
    }
}
