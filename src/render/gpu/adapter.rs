//! Which of the machine's graphics adapters to use.

use crate::adapter::{AdapterChoice, AdapterError, AdapterInfo, AdapterKind, Backend};
use pollster::block_on;

/// Every adapter of this machine, best first.
pub fn adapters() -> Vec<AdapterInfo> {
    let found = [NATIVE, LAST].into_iter().flat_map(found);
    found.map(|adapter| info(&adapter.get_info())).collect()
}

/// The adapter to use, before a device is opened on it.
pub(super) fn choose(
    choice: &AdapterChoice,
    require_gpu: bool,
) -> Result<(wgpu::Adapter, AdapterId), AdapterError> {
    // By itself only a real GPU is taken: software drivers are for who asks for them.
    let needs_gpu = require_gpu || *choice == AdapterChoice::Auto;
    let is_allowed = |info: &AdapterInfo| !needs_gpu || info.kind != AdapterKind::Software;
    let mut seen = Vec::new();
    // Who leaves the choice to us is not to wait for GL's libraries.
    let looks_everywhere = require_gpu || *choice != AdapterChoice::Auto;
    for backends in [Some(NATIVE), looks_everywhere.then_some(LAST)] {
        let adapters = backends.map(found).unwrap_or_default();
        let infos: Vec<_> = adapters.iter().map(wgpu::Adapter::get_info).collect();
        for (index, adapter) in adapters.into_iter().enumerate() {
            let info = info(&infos[index]);
            if choice.takes(&info) && is_allowed(&info) {
                return Ok((adapter, AdapterId::of(index, &infos)));
            }
            seen.push(info);
        }
    }
    if seen.is_empty() {
        return Err(AdapterError::None);
    }
    let (matching, others): (Vec<_>, Vec<_>) =
        seen.into_iter().partition(|info| choice.takes(info));
    Err(if matching.is_empty() {
        AdapterError::NoMatch {
            asked: choice.to_string(),
            found: others,
        }
    } else {
        AdapterError::OnlySoftware { found: matching }
    })
}

/// What tells one adapter of this machine from another, also from an equal card beside it, for as long as nobody rebuilds the machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterId {
    backend: wgpu::Backend,
    vendor: u32,
    device: u32,
    name: String,
    /// Where the card is plugged in; empty where the driver does not say.
    pci_bus: String,
    /// Among those that are the same in all of this, in the driver's order.
    ordinal: usize,
}

impl AdapterId {
    /// Of one of `found`.
    fn of(index: usize, found: &[wgpu::AdapterInfo]) -> Self {
        let id = |info: &wgpu::AdapterInfo| Self {
            backend: info.backend,
            vendor: info.vendor,
            device: info.device,
            name: info.name.clone(),
            pci_bus: info.device_pci_bus_id.clone(),
            ordinal: 0,
        };
        let own = id(&found[index]);
        let before = found[..index].iter().filter(|info| id(info) == own);
        Self {
            ordinal: before.count(),
            ..own
        }
    }
}

/// An adapter that was chosen before.
pub(super) fn find(id: &AdapterId) -> Result<wgpu::Adapter, AdapterError> {
    let adapters = found(id.backend.into());
    let infos: Vec<_> = adapters.iter().map(wgpu::Adapter::get_info).collect();
    let is_it = |index: &usize| AdapterId::of(*index, &infos) == *id;
    let index = (0..infos.len()).find(is_it);
    let adapter = index.and_then(|index| adapters.into_iter().nth(index));
    adapter.ok_or_else(|| AdapterError::NoMatch {
        asked: id.name.clone(),
        found: infos.iter().map(info).collect(),
    })
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
        why: None,
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
