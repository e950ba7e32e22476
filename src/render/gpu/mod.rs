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
mod solids;
mod targets;
mod textures;
mod upload;

pub use adapter::adapters;
pub use readback::InFlight;

use super::{AdapterChoice, AdapterError, AdapterInfo, Capabilities};
use super::{Outputs, Plan, RenderError, Wanted};
use buffers::Readbacks;
use device::Device;
use readback::{Form, Region};
use resolve::ResolveStage;
use shade::{Drawn, ShadeStage};
use skin::SkinStage;
use targets::{TargetCache, TargetShape};
use textures::TextureBinding;
use upload::{Layouts, Uploads};

/// A device with everything that lives as long as it does. One thread owns it.
pub struct Gpu {
    device: Device,
    uploads: Uploads,
    textures: TextureBinding,
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
        let textures = TextureBinding::new(&device);
        Ok(Self {
            uploads: Uploads::default(),
            skin: SkinStage::new(&device),
            shade: ShadeStage::new(&device, &textures),
            textures,
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
        self.device.capabilities
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
        let submitted = self
            .encode(plan)
            .and_then(|in_flight| self.device.check().map(|()| in_flight));
        if submitted.is_err() {
            // What was made for this plan may be half there: the next one makes it anew.
            self.uploads
                .forget(plan.instances.iter().map(|instance| instance.rig().id()));
            self.targets = TargetCache::default();
        }
        submitted
    }

    fn encode(&mut self, plan: &Plan) -> Result<InFlight, RenderError> {
        let device = &self.device;
        for instance in &plan.instances {
            device.capabilities.accept_rig(instance.rig())?;
            let layouts = Layouts {
                mesh: &self.skin.mesh_layout,
                textures: &self.textures,
            };
            self.uploads.upload(device, layouts, instance.rig());
        }
        let uploaded = plan
            .instances
            .iter()
            .filter_map(|instance| self.uploads.get(instance.rig()));
        let rigs: Vec<_> = uploaded.collect();
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("frame"),
        };
        let mut encoder = device.device.create_command_encoder(&descriptor);
        let skinned = self
            .skin
            .encode(device, &mut encoder, &plan.instances, &rigs);
        let vertices = self.skin.skinned();
        let picture = match &plan.wanted {
            Wanted::Picture(picture) => picture,
            Wanted::Vertices(queries) => {
                let regions = readback::regions(queries, &skinned, vertices);
                let form = Form::Vertices(queries.clone());
                return Ok(readback::start(
                    device,
                    &mut self.readbacks,
                    encoder,
                    &regions,
                    form,
                ));
            }
        };
        let (size, samples) = (picture.scene.size, picture.scene.samples);
        device.capabilities.accept_size(size)?;
        let shape = TargetShape {
            size,
            samples,
            layers: shade::layers_of(picture),
        };
        let targets = self.targets.get(device, &self.resolve.layout, shape);
        let drawn = Drawn {
            skinned: &skinned,
            instances: &plan.instances,
            rigs: &rigs,
            vertices,
        };
        self.shade
            .encode(device, &mut encoder, picture, targets, &drawn);
        self.resolve.encode(&mut encoder, targets);
        let region = Region {
            source: &targets.pixels,
            start: 0,
            bytes: 4 * size.pixels() as u64,
        };
        let form = Form::Picture(size);
        Ok(readback::start(
            device,
            &mut self.readbacks,
            encoder,
            &[region],
            form,
        ))
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
