//! The wgpu renderer: one device, its pipelines, and the work in flight on it. Every stage bears the name of its shader.

mod adapter;
mod buffers;
mod device;
mod layout;
mod readback;
mod resolve;
mod shade;
mod shaders;
mod skin;
mod targets;
mod upload;

pub use adapter::{AdapterChoice, AdapterError, AdapterInfo, AdapterKind, Backend, adapters};
pub use device::Capabilities;
pub use readback::InFlight;

use super::{Outputs, Plan, RenderError, Wanted};
use buffers::Readbacks;
use device::Device;
use readback::Region;
use resolve::ResolveStage;
use shade::ShadeStage;
use skin::SkinStage;
use targets::{TargetCache, TargetShape};
use upload::Uploads;

/// A device with everything that lives as long as it does. One thread owns it.
pub struct Gpu {
    device: Device,
    uploads: Uploads,
    skin: SkinStage,
    shade: ShadeStage,
    resolve: ResolveStage,
    targets: TargetCache,
    readbacks: Readbacks,
}

impl Gpu {
    /// # Errors
    /// [`AdapterError`] says what there is instead.
    pub fn open(choice: &AdapterChoice, require_gpu: bool) -> Result<Self, AdapterError> {
        let device = Device::open(choice, require_gpu)?;
        Ok(Self {
            uploads: Uploads::default(),
            skin: SkinStage::new(&device),
            shade: ShadeStage::new(&device),
            resolve: ResolveStage::new(&device),
            targets: TargetCache::default(),
            readbacks: Readbacks::default(),
            device,
        })
    }

    pub fn adapter(&self) -> &AdapterInfo {
        &self.device.info
    }

    pub fn capabilities(&self) -> Capabilities {
        self.device.capabilities()
    }

    /// Device memory in use, as far as rigd asked for it.
    pub fn memory_bytes(&self) -> u64 {
        let stages = self.skin.bytes() + self.shade.bytes();
        stages + self.uploads.bytes() + self.targets.bytes() + self.readbacks.bytes()
    }

    /// Frees the device memory of rigs that nobody holds any more.
    pub fn sweep(&mut self) {
        self.uploads.sweep();
    }

    /// Starts the work; [`Gpu::finish`] waits for it. Several plans may be in flight, and are finished in order.
    ///
    /// # Errors
    /// [`RenderError`]; nothing of the plan is then in flight.
    pub fn submit(&mut self, plan: &Plan) -> Result<InFlight, RenderError> {
        // A complaint about earlier work is not this plan's fault.
        self.device.check()?;
        let device = &self.device;
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("frame"),
        };
        let mut encoder = device.device.create_command_encoder(&descriptor);
        for instance in &plan.instances {
            device.capabilities().accept_rig(instance.rig())?;
        }
        let skinned = self
            .skin
            .encode(device, &mut self.uploads, &mut encoder, &plan.instances);
        let in_flight = match &plan.wanted {
            Wanted::Picture(picture) => {
                let size = picture.scene.size;
                device.capabilities().accept_size(size)?;
                let samples = picture.scene.samples;
                let shape = TargetShape {
                    size,
                    samples,
                    layers: shade::layers_of(picture),
                };
                let targets = self.targets.get(device, &self.resolve.layout, shape);
                let layout = &self.skin.mesh_layout;
                for instance in &plan.instances {
                    self.uploads.get(device, layout, instance.rig());
                }
                let uploads = &self.uploads;
                let placed: Vec<_> = skinned
                    .into_iter()
                    .filter_map(|place| {
                        Some((uploads.find(plan.instances[place.instance].rig())?, place))
                    })
                    .map(|(rig, place)| (place, rig))
                    .collect();
                self.shade.encode(
                    device,
                    &mut encoder,
                    picture,
                    targets,
                    &placed,
                    self.skin.skinned(),
                );
                self.resolve.encode(&mut encoder, targets);
                let region = Region {
                    source: &targets.pixels,
                    start: 0,
                    bytes: 4 * size.pixels() as u64,
                };
                readback::start(
                    device,
                    &mut self.readbacks,
                    encoder,
                    &[region],
                    readback::Form::Picture(size),
                )
            }
            Wanted::Vertices(queries) => {
                let regions = readback::regions(queries, &skinned, self.skin.skinned());
                let form = readback::Form::Vertices(queries.clone());
                readback::start(device, &mut self.readbacks, encoder, &regions, form)
            }
        };
        self.device.check()?;
        Ok(in_flight)
    }

    /// Waits for what was [submitted](Gpu::submit) and gives its outputs.
    ///
    /// # Errors
    /// [`RenderError`]; after `DeviceLost` this renderer is of no more use.
    pub fn finish(&mut self, in_flight: InFlight) -> Result<Outputs, RenderError> {
        let (outputs, buffer) = in_flight.finish(&self.device)?;
        self.readbacks.give_back(buffer);
        Ok(outputs)
    }

    /// Destroys the device under the renderer's feet, to see what a driver's crash would do.
    #[doc(hidden)]
    pub fn lose_device(&self) {
        self.device.device.destroy();
    }
}
