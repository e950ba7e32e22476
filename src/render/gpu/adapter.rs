//! Which of the machine's graphics adapters to use.

use crate::render::{AdapterChoice, AdapterError, AdapterInfo, AdapterKind, Backend};
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
) -> Result<wgpu::Adapter, AdapterError> {
    // By itself only a real GPU is taken: software drivers are for who asks for them.
    let needs_gpu = require_gpu || *choice == AdapterChoice::Auto;
    let is_allowed = |info: &AdapterInfo| !needs_gpu || info.kind != AdapterKind::Software;
    let mut seen = Vec::new();
    // Who leaves the choice to us is not to wait for GL's libraries.
    let looks_everywhere = require_gpu || *choice != AdapterChoice::Auto;
    for backends in [Some(NATIVE), looks_everywhere.then_some(LAST)] {
        for adapter in backends.into_iter().flat_map(found) {
            let info = info(&adapter.get_info());
            if choice.takes(&info) && is_allowed(&info) {
                return Ok(adapter);
            }
            seen.push(info);
        }
    }
    Err(if seen.is_empty() {
        AdapterError::None
    } else if seen.iter().any(|info| choice.takes(info)) {
        AdapterError::OnlySoftware { found: seen }
    } else {
        AdapterError::NoMatch {
            asked: choice.to_string(),
            found: seen,
        }
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
