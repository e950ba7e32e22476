//! Stage 1 on the device, `shaders/skin*.wgsl`: every vertex that a submission asks for, once, into one buffer that draws and queries
//! read.

use super::buffers::Growing;
use super::device::Device;
use super::layout::SkinJob;
use super::shaders;
use super::skins::SkinSet;
use super::upload::GpuRig;
use crate::pose::Skinning;
use glam::Vec4;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use wgpu::{BufferUsages, ShaderStages};

/// Where one skin lies in the skinned buffer, in model space.
pub(super) struct SkinnedRig<'a> {
    pub rig: &'a GpuRig,
    /// Of the rig's vertices, the first that has a place there. Those behind it follow, up to the last that was asked for, whether they
    /// were skinned or not.
    pub first_vertex: u32,
    /// In bytes, three floats a vertex.
    pub positions_start: u64,
    pub normals_start: u64,
    /// What was asked for of the rig's vertices.
    runs: Vec<Range<u32>>,
}

pub(super) struct SkinStage {
    pipeline_layout: wgpu::PipelineLayout,
    /// Made when first needed.
    pipelines: HashMap<Skinning, wgpu::ComputePipeline>,
    job_layout: wgpu::BindGroupLayout,
    pub rig_layout: wgpu::BindGroupLayout,
    jobs: Growing,
    palette: Growing,
    morph_weights: Growing,
    skinned: Growing,
    bind_group: wgpu::BindGroup,
    /// Bytes from one job to the next, as the device aligns them.
    job_stride: u64,
    /// Reused from submission to submission.
    scratch: Scratch,
}

#[derive(Default)]
struct Scratch {
    palette: Vec<Vec4>,
    morph_weights: Vec<f32>,
    jobs: Vec<u8>,
}

impl SkinStage {
    pub(super) fn new(device: &Device) -> Self {
        let job_layout = layout(
            device,
            "skin.job",
            &[
                wgpu::BufferBindingType::Uniform,
                wgpu::BufferBindingType::Storage { read_only: true },
                wgpu::BufferBindingType::Storage { read_only: true },
                wgpu::BufferBindingType::Storage { read_only: false },
            ],
        );
        let rig_layout = layout(
            device,
            "skin.rig",
            &[wgpu::BufferBindingType::Storage { read_only: true }; 5],
        );
        let pipeline_layout =
            device
                .device
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some("skin.pipeline_layout"),
                    bind_group_layouts: &[Some(&job_layout), Some(&rig_layout)],
                    immediate_size: 0,
                });
        let jobs = Growing::new(device, "skin.jobs", BufferUsages::UNIFORM);
        let palette = Growing::new(device, "skin.palette", BufferUsages::STORAGE);
        let morph_weights = Growing::new(device, "skin.morph_weights", BufferUsages::STORAGE);
        let skinned_usage = BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_SRC;
        let skinned = Growing::new(device, "skin.skinned", skinned_usage);
        let bind_group = bind(
            device,
            &job_layout,
            [&jobs, &palette, &morph_weights, &skinned],
        );
        let alignment = u64::from(device.device.limits().min_uniform_buffer_offset_alignment);
        let job_stride = (size_of::<SkinJob>() as u64).next_multiple_of(alignment);
        let scratch = Scratch::default();
        Self {
            pipeline_layout,
            pipelines: HashMap::new(),
            job_layout,
            rig_layout,
            jobs,
            palette,
            morph_weights,
            skinned,
            bind_group,
            job_stride,
            scratch,
        }
    }

    /// The skinned vertices of what was [encoded](Self::encode) last.
    pub(super) fn skinned(&self) -> &wgpu::Buffer {
        self.skinned.buffer()
    }

    pub(super) fn bytes(&self) -> u64 {
        [
            &self.jobs,
            &self.palette,
            &self.morph_weights,
            &self.skinned,
        ]
        .iter()
        .map(|growing| growing.buffer().size())
        .sum()
    }

    /// Makes the pipeline for this way of skinning where it was not needed before.
    fn prepare(&mut self, device: &Device, skinning: Skinning) {
        let source = match skinning {
            Skinning::Linear => shaders::SKIN_LINEAR,
            Skinning::DualQuaternion => shaders::SKIN_DUAL_QUATERNION,
        };
        let layout = &self.pipeline_layout;
        self.pipelines.entry(skinning).or_insert_with(|| {
            let module = device
                .device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some("skin.shader"),
                    source: wgpu::ShaderSource::Wgsl(source.into()),
                });
            device
                .device
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some("skin.pipeline"),
                    layout: Some(layout),
                    module: &module,
                    entry_point: Some("skin"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    cache: None,
                })
        });
    }

    /// Writes palettes and weights and records the skin pass, if there is anything to skin. `rigs` are those of `skins`, in step, and so is
    /// what is returned.
    pub(super) fn encode<'a>(
        &mut self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        skins: &SkinSet<'_>,
        rigs: &[&'a GpuRig],
    ) -> Vec<SkinnedRig<'a>> {
        if rigs.is_empty() {
            return Vec::new();
        }
        for skin in skins.iter() {
            self.prepare(device, skin.skin.palette().skinning());
        }
        let Scratch {
            palette,
            morph_weights,
            jobs,
        } = &mut self.scratch;
        palette.clear();
        morph_weights.clear();
        jobs.clear();
        let mut skinned = Vec::new();
        let mut floats: u32 = 0;
        for (skin, rig) in skins.iter().zip(rigs) {
            let first_row = palette.len() as u32;
            palette.extend_from_slice(skin.skin.palette().rows());
            let first_morph_weight = morph_weights.len() as u32;
            morph_weights.extend_from_slice(skin.skin.morph_weights());
            let runs = runs(rig, &skin.meshes);
            let first_vertex = runs.first().map_or(0, |run| run.start);
            let count = runs.last().map_or(0, |run| run.end) - first_vertex;
            let (positions_start, normals_start) = (floats, floats + 3 * count);
            floats += 6 * count;
            for run in &runs {
                let before = 3 * (run.start - first_vertex);
                let job = SkinJob {
                    first_vertex: run.start,
                    vertex_count: run.end - run.start,
                    rig_vertex_count: rig.vertex_count,
                    first_row,
                    first_morph_weight,
                    positions_start: positions_start + before,
                    normals_start: normals_start + before,
                };
                jobs.extend_from_slice(bytemuck::bytes_of(&job));
                jobs.resize(jobs.len().next_multiple_of(self.job_stride as usize), 0);
            }
            skinned.push(SkinnedRig {
                rig,
                first_vertex,
                positions_start: 4 * u64::from(positions_start),
                normals_start: 4 * u64::from(normals_start),
                runs,
            });
        }
        let grew = [
            self.jobs.write(device, jobs),
            self.palette.write(device, palette),
            self.morph_weights.write(device, morph_weights),
            self.skinned.reserve(device, 4 * u64::from(floats)),
        ];
        if grew.contains(&true) {
            self.bind_group = bind(
                device,
                &self.job_layout,
                [
                    &self.jobs,
                    &self.palette,
                    &self.morph_weights,
                    &self.skinned,
                ],
            );
        }
        self.record(encoder, skins, &skinned);
        skinned
    }

    fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        skins: &SkinSet<'_>,
        skinned: &[SkinnedRig<'_>],
    ) {
        let descriptor = wgpu::ComputePassDescriptor {
            label: Some("skin.pass"),
            timestamp_writes: None,
        };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        let mut offset = 0;
        for (skin, place) in skins.iter().zip(skinned) {
            pass.set_pipeline(&self.pipelines[&skin.skin.palette().skinning()]);
            pass.set_bind_group(1, &place.rig.bind_group, &[]);
            for run in &place.runs {
                pass.set_bind_group(0, &self.bind_group, &[offset]);
                let groups = (run.end - run.start).div_ceil(shaders::WORKGROUP);
                let rows = groups.div_ceil(MOST_GROUPS);
                pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
                offset += self.job_stride as u32;
            }
        }
    }
}

impl SkinnedRig<'_> {
    /// Bytes from the first vertex that has a place to the first one of `mesh`, among positions as among normals; `None` where nobody asked
    /// for that mesh.
    pub(super) fn offset(&self, mesh: usize) -> Option<u64> {
        let vertices = self.rig.vertices.get(mesh)?;
        let has = |run: &Range<u32>| run.start <= vertices.start && vertices.end <= run.end;
        let is_there = !vertices.is_empty() && self.runs.iter().any(has);
        is_there.then(|| 12 * u64::from(vertices.start - self.first_vertex))
    }
}

/// The vertices of these meshes, those of meshes that stand side by side as one.
fn runs(rig: &GpuRig, meshes: &BTreeSet<usize>) -> Vec<Range<u32>> {
    let mut runs: Vec<Range<u32>> = Vec::new();
    for mesh in meshes {
        let vertices = rig.vertices[*mesh].clone();
        match runs.last_mut() {
            Some(last) if last.end == vertices.start => last.end = vertices.end,
            _ => runs.push(vertices),
        }
    }
    runs
}

/// Workgroups along one dimension that every adapter takes.
const MOST_GROUPS: u32 = 65_535;

fn layout(
    device: &Device,
    label: &str,
    types: &[wgpu::BufferBindingType],
) -> wgpu::BindGroupLayout {
    let entry = |(binding, &ty): (u32, &wgpu::BufferBindingType)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: ty == wgpu::BufferBindingType::Uniform,
            min_binding_size: None,
        },
        count: None,
    };
    let entries: Vec<_> = (0u32..).zip(types).map(entry).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    };
    device.device.create_bind_group_layout(&descriptor)
}

/// `buffers` are jobs, palette, morph weights and skinned vertices.
fn bind(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    buffers: [&Growing; 4],
) -> wgpu::BindGroup {
    let [jobs, whole @ ..] = buffers.map(Growing::buffer);
    let one_job = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer: jobs,
        offset: 0,
        size: wgpu::BufferSize::new(size_of::<SkinJob>() as u64),
    });
    let whole = whole.map(wgpu::Buffer::as_entire_binding);
    let entries: Vec<_> = (0u32..)
        .zip(std::iter::once(one_job).chain(whole))
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    device.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("skin.job"),
        layout,
        entries: &entries,
    })
}
