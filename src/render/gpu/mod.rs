//! The wgpu renderer: one device, its pipelines, and the work in flight on it. Every stage bears the name of its shader.

mod adapter;
mod buffers;
mod clock;
mod coats;
mod device;
mod draws;
mod instances;
mod layout;
mod pipelines;
mod readback;
mod resolve;
mod room;
mod shade;
mod shaders;
mod skin;
mod solids;
mod targets;
mod textures;
mod upload;
mod wear;

pub use adapter::adapters;
pub use readback::{Finished, InFlight};

use super::{AdapterChoice, AdapterError, AdapterInfo, Capabilities};
use super::{Plan, RenderError, Wanted};
use buffers::Readbacks;
use clock::Clock;
use device::Device;
use instances::Skins;
use readback::{Copies, Form};
use resolve::ResolveStage;
use shade::{Drawing, ShadeStage};
use skin::SkinStage;
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
            clock: Clock::new(&device),
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

    /// How many of `plans`, from the first, may share a submission; at least one, where there is one.
    pub fn fitting(&self, plans: &[&Plan]) -> usize {
        // What is refused anyway is refused by itself.
        let is_acceptable = |plan: &&&Plan| self.accept(plan).is_ok();
        let acceptable = plans.iter().take_while(is_acceptable).count();
        let fitting = room::fitting(&plans[..acceptable], self.device.buffer_bytes);
        fitting.max(1).min(plans.len())
    }

    /// Starts the work on all of them as one; [`Gpu::finish`] waits for it. Several submissions may be in flight, and are finished in order.
    ///
    /// # Errors
    /// [`RenderError`]; nothing of the plans is then in flight. Which of them is at fault can be found out by submitting each by itself.
    pub fn submit(&mut self, plans: &[&Plan]) -> Result<InFlight, RenderError> {
        self.device.forgive()?;
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
        if let Wanted::Picture(picture) = &plan.wanted {
            capabilities.accept_size(picture.scene.size)?;
        }
        Ok(())
    }

    fn encode(&mut self, plans: &[&Plan]) -> InFlight {
        let device = &self.device;
        let skins = Skins::of(plans);
        let layouts = Layouts {
            rig: &self.skin.rig_layout,
            textures: &self.textures,
        };
        for skin in skins.iter() {
            self.uploads.upload(device, layouts, skin.instance.rig());
        }
        let uploaded = |skin: &instances::Skin<'_>| {
            let rig = self.uploads.get(skin.instance.rig());
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
        let skinned_of = |instance| {
            let place = skins.position(instance);
            place.map(|place| &skinned[place])
        };
        let drawings = plans.iter().filter_map(|plan| match &plan.wanted {
            Wanted::Picture(picture) => {
                let shown = plan.shown_instances().iter();
                let skin = shown.map(|instance| Some((instance, skinned_of(instance)?)));
                let skin = skin.collect();
                Some(Drawing {
                    plan,
                    picture,
                    skin,
                })
            }
            Wanted::Vertices(_) => None,
        });
        let drawings: Vec<_> = drawings.collect();
        let mut pictures = self.shade.prepare(device, &drawings).into_iter();

        let forms: Vec<_> = plans.iter().map(|plan| Form::of(plan)).collect();
        let bytes = forms.iter().map(Form::bytes).sum::<u64>() + Clock::BYTES;
        let mut copies = Copies::new(device, &mut self.readbacks, bytes);
        let vertices = self.skin.skinned();
        for plan in plans {
            match &plan.wanted {
                // Pictures of one shape share their targets: each is copied out before the next one is drawn.
                Wanted::Picture(_) => {
                    let Some(ready) = pictures.next() else {
                        continue;
                    };
                    let shape = shade::shape_of(ready.picture);
                    let targets = self.targets.get(device, &self.resolve.layout, shape);
                    self.shade.encode(&mut encoder, &ready, targets, vertices);
                    self.resolve.encode(&mut encoder, targets);
                    let bytes = 4 * shape.size.pixels() as u64;
                    copies.copy(&mut encoder, &targets.pixels, 0, bytes);
                }
                Wanted::Vertices(queries) => {
                    let of_plan = plan.instances.first().and_then(skinned_of);
                    copies.copy_vertices(&mut encoder, queries, of_plan, vertices);
                }
            }
        }
        if let Some(clock) = clock {
            let times = clock.stop(&mut encoder);
            copies.copy(&mut encoder, times, 0, Clock::BYTES);
        }
        copies.submit(device, encoder, forms)
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
