//! The wgpu renderer: one device, its pipelines, and the work in flight on it. Every stage bears the name of its shader.

mod adapter;
mod budget;
mod buffers;
mod clock;
mod device;
mod draw_list;
mod draws;
mod layout;
mod material_buffer;
mod pipelines;
mod readback;
mod resolve;
mod shade;
mod shaders;
mod skin;
mod skins;
mod solids;
mod targets;
mod textures;
mod upload;

pub use adapter::{AdapterId, adapters};
pub use readback::{Finished, InFlight};

use super::Capabilities;
use super::{Plan, RenderError};
use crate::adapter::{AdapterChoice, AdapterError, AdapterInfo};
use crate::frame::ImageKind;
use buffers::Readbacks;
use clock::Clock;
use device::Device;
use draws::Drawing;
use readback::{Copies, ReadbackLayout};
use resolve::ResolveStage;
use shade::ShadeStage;
use skin::SkinStage;
use skins::{RequiredSkin, SkinSet};
use std::time::Duration;
use targets::TargetCache;
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
    /// `None` where the device has none.
    clock: Option<Clock>,
}

impl Gpu {
    /// # Errors
    /// [`AdapterError`] says what there is instead.
    pub fn open(choice: &AdapterChoice, require_gpu: bool) -> Result<Self, AdapterError> {
        let (adapter, id) = adapter::choose(choice, require_gpu)?;
        Ok(Self::with(Device::open(&adapter, id)?))
    }

    /// The adapter that was opened before, after its device was lost.
    ///
    /// # Errors
    /// As for [`Gpu::open`].
    pub fn reopen(id: &AdapterId) -> Result<Self, AdapterError> {
        Ok(Self::with(Device::open(&adapter::find(id)?, id.clone())?))
    }

    fn with(device: Device) -> Self {
        let textures = TextureBinding::new(&device);
        Self {
            uploads: Uploads::default(),
            skin: SkinStage::new(&device),
            shade: ShadeStage::new(&device, &textures),
            textures,
            resolve: ResolveStage::new(&device),
            targets: TargetCache::default(),
            readbacks: Readbacks::default(),
            clock: Clock::new(&device),
            device,
        }
    }

    /// As its driver gives it; `why` is `None`.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.device.info
    }

    /// What [`Gpu::reopen`] finds the same adapter by.
    pub fn adapter_id(&self) -> &AdapterId {
        &self.device.adapter_id
    }

    /// The most that its device allows of textures and buffers.
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

    /// How many of `plans`, from the first, may share a submission; at least one, where there is one.
    pub fn fitting(&self, plans: &[&Plan]) -> usize {
        // What is refused anyway is refused by itself.
        let is_acceptable = |plan: &&&Plan| self.accept(plan).is_ok();
        let acceptable = plans.iter().take_while(is_acceptable).count();
        let fitting = budget::fitting(&plans[..acceptable], self.device.buffer_bytes);
        fitting.max(1).min(plans.len())
    }

    /// Starts the work on all of them as one; [`Gpu::finish`] waits for it. Several submissions may be in flight, and are finished in order.
    ///
    /// # Errors
    /// [`RenderError`]; nothing of the plans is then in flight. Which of them is at fault can be found out by submitting each by itself.
    pub fn submit(&mut self, plans: &[&Plan]) -> Result<InFlight, RenderError> {
        self.device.discard_stale_errors()?;
        plans.iter().try_for_each(|plan| self.accept(plan))?;
        let in_flight = self.encode(plans);
        let checked = self.device.check();
        if checked.is_err() {
            self.renew(plans);
        }
        checked.map(|()| in_flight)
    }

    /// # Errors
    /// Where a rig or a picture of the plan is larger than the adapter takes.
    fn accept(&self, plan: &Plan) -> Result<(), RenderError> {
        let capabilities = self.device.capabilities;
        let mut rigs = plan.instances.iter().map(|instance| instance.rig());
        rigs.try_for_each(|rig| capabilities.accept_rig(rig))?;
        if let Some(image) = &plan.image {
            let mut kinds = image.outputs.iter();
            kinds.try_for_each(|kind| capabilities.accept_raster(*kind, image.scene.size))?;
        }
        Ok(())
    }

    fn encode(&mut self, plans: &[&Plan]) -> InFlight {
        let device = &self.device;
        let skins = SkinSet::of(plans);
        let layouts = Layouts {
            rig: &self.skin.rig_layout,
            textures: &self.textures,
        };
        for required in skins.iter() {
            self.uploads.upload(device, layouts, required.skin.rig());
        }
        let uploaded = |required: &RequiredSkin<'_>| {
            let rig = self.uploads.get(required.skin.rig());
            rig.expect("it was uploaded just now")
        };
        let rigs: Vec<_> = skins.iter().map(uploaded).collect();
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("submission"),
        };
        let mut encoder = device.device.create_command_encoder(&descriptor);
        let clock = self.clock.as_ref();
        clock.inspect(|clock| clock.start(&mut encoder));

        let skinned = self.skin.encode(device, &mut encoder, &skins, &rigs);
        let skinned_of = |skin| skins.position(skin).map(|index| &skinned[index]);
        let drawings = plans.iter().filter_map(|plan| {
            let image = plan.image.as_ref()?;
            let skins = plan
                .drawn()
                .filter_map(|(index, instance)| Some((index, skinned_of(instance.skin())?)));
            Some(Drawing {
                plan,
                scene: &image.scene,
                skins: skins.collect(),
            })
        });
        let drawings: Vec<_> = drawings.collect();
        let mut pictures = self.shade.prepare(device, &drawings).into_iter();

        let readbacks: Vec<_> = plans.iter().map(|plan| ReadbackLayout::of(plan)).collect();
        let bytes = readbacks.iter().map(ReadbackLayout::bytes).sum::<u64>() + Clock::BYTES;
        let mut copies = Copies::new(device, &mut self.readbacks, bytes);
        let vertices = self.skin.skinned();
        for plan in plans {
            // Pictures of one shape share their targets: each is copied out before the next one is drawn.
            if let Some(image) = &plan.image
                && let Some(ready) = pictures.next()
            {
                for kind in &image.outputs {
                    match kind {
                        ImageKind::Color => {
                            let shape = shade::shape_of(plan, &image.scene);
                            let targets = self.targets.get(device, &self.resolve.layout, shape);
                            self.shade.encode(&mut encoder, &ready, targets, vertices);
                            self.resolve.encode(&mut encoder, targets);
                            let bytes = kind.bytes(shape.size) as u64;
                            copies.copy(&mut encoder, &targets.pixels, 0, bytes);
                        }
                    }
                }
            }
            for query in &plan.vertices {
                let of_query = skinned_of(plan.instances[query.instance].skin());
                copies.copy_vertices(&mut encoder, query, of_query, vertices);
            }
        }
        if let Some(clock) = clock {
            let times = clock.stop(&mut encoder);
            copies.copy(&mut encoder, times, 0, Clock::BYTES);
        }
        copies.submit(device, encoder, readbacks)
    }

    /// Drops what was made for `plans`, and whatever else may be half there: the next submission makes it anew.
    fn renew(&mut self, plans: &[&Plan]) {
        let instances = plans.iter().flat_map(|plan| &plan.instances);
        self.uploads
            .forget(instances.map(|instance| instance.rig().id()));
        self.targets = TargetCache::default();
        self.readbacks = Readbacks::default();
        self.skin = SkinStage::new(&self.device);
        self.shade = ShadeStage::new(&self.device, &self.textures);
    }

    /// Waits for what was [submitted](Gpu::submit), so long at the most, and tells whether it is done.
    ///
    /// # Errors
    /// As for [`Gpu::finish`].
    pub fn wait(&self, in_flight: &mut InFlight, slice: Duration) -> Result<bool, RenderError> {
        in_flight.wait(&self.device, slice)
    }

    /// Waits for what was [submitted](Gpu::submit) and gives its outputs.
    ///
    /// # Errors
    /// [`RenderError`]; after `DeviceLost` this renderer is of no more use.
    pub fn finish(&mut self, in_flight: InFlight) -> Result<Finished, RenderError> {
        let (finished, buffer) = in_flight.finish(&self.device, self.clock.as_ref())?;
        self.readbacks.give_back(buffer);
        Ok(finished)
    }

    /// Destroys the device under the renderer's feet, to see what a driver's crash would do.
    #[doc(hidden)]
    pub fn lose_device(&self) {
        self.device.device.destroy();
    }
}
