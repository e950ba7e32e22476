//! Which of the two renderers draws, and why. Never lives here: drawing.

use super::Capabilities;
use super::cpu::Cpu;
use super::gpu::{self, Gpu};
use crate::adapter::{AdapterChoice, AdapterError, AdapterInfo, AdapterKind};

/// One of the renderers, opened.
pub enum Renderer {
    /// Draws through wgpu, on one device, from the thread that owns it.
    Gpu(Box<Gpu>),
    /// Draws without a driver, and may be used by several threads at a time.
    Cpu(Cpu),
}

impl Renderer {
    /// `threads` is how many the CPU may draw with.
    ///
    /// # Errors
    /// [`AdapterError`] says what there is instead.
    pub fn open(
        choice: &AdapterChoice,
        require_gpu: bool,
        threads: usize,
    ) -> Result<(Self, AdapterInfo, Capabilities), AdapterError> {
        let cpu = |why: String| {
            let info = AdapterInfo {
                why: Some(why),
                ..Cpu::info(threads)
            };
            Ok((Self::Cpu(Cpu::default()), info, Cpu::CAPABILITIES))
        };
        let asks_for_cpu = *choice != AdapterChoice::Auto && choice.takes(&Cpu::info(threads));
        match (asks_for_cpu, require_gpu) {
            (true, false) => return cpu("asked for".to_owned()),
            (true, true) => return Err(AdapterError::CpuIsNoGpu),
            (false, _) => {}
        }
        let may_do_without = *choice == AdapterChoice::Auto && !require_gpu;
        match Gpu::open(choice, require_gpu) {
            Ok(gpu) => {
                let why = match choice {
                    AdapterChoice::Auto => "the first GPU that was found",
                    AdapterChoice::Cpu | AdapterChoice::Backend(_) | AdapterChoice::Named(_) => {
                        "asked for"
                    }
                };
                let info = AdapterInfo {
                    why: Some(why.to_owned()),
                    ..gpu.adapter().clone()
                };
                let capabilities = gpu.capabilities();
                Ok((Self::Gpu(Box::new(gpu)), info, capabilities))
            }
            Err(AdapterError::NoDevice { adapter, reason }) if may_do_without => {
                cpu(format!("the GPU {adapter} cannot be used: {reason}"))
            }
            Err(_) if may_do_without => cpu("no GPU was found".to_owned()),
            Err(AdapterError::NoMatch { asked, mut found }) => {
                found.push(Cpu::info(threads));
                Err(AdapterError::NoMatch { asked, found })
            }
            Err(error) => Err(error),
        }
    }
}

/// Everything that can be drawn with, best first.
pub fn adapters(threads: usize) -> Vec<AdapterInfo> {
    let mut adapters = gpu::adapters();
    let software = |info: &AdapterInfo| info.kind >= AdapterKind::Software;
    let after_gpus = adapters.iter().position(software).unwrap_or(adapters.len());
    adapters.insert(after_gpus, Cpu::info(threads));
    adapters
}
