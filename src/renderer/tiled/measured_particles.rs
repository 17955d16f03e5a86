//! Measurement of a host's particles on the GPU.

use haze_core::formula::uniforms::MeasureUniform;

use super::storage_buffers::storage;
use super::tile_buffers::ParticleRange;
use super::tiled_pipelines::TiledPipelines;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::record::uniform_buffer;
use crate::renderer::pass::groups::Groups;
use crate::renderer::pass::measure::{Measure, MeasureKey, WORKGROUP};
use crate::renderer::pass::sprite_instances::Sprites;

/// Bytes of ExtentSums and of MeasuredExtent in `shaders/measure.wgsl`.
const SUMS_BYTES: u64 = 32;
const MEASURED_BYTES: u64 = 32;

/// Buffers for the measurement of one system, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct MeasuredParticles {
    buffers: Option<MeasureBuffers>,
}

#[derive(Debug)]
struct MeasureBuffers {
    uniform: wgpu::Buffer,
    sums: wgpu::Buffer,
    measured: wgpu::Buffer,
    /// Bind group with the host's own buffer; recreated when that is another.
    inputs: Option<(ParticleRange, wgpu::BindGroup)>,
}

/// Particles to measure.
pub(crate) struct MeasureInputs<'a> {
    pub sprites: Sprites,
    pub groups: &'a Groups,
    /// Uniforms of the system, which receive the extent.
    pub system: &'a wgpu::Buffer,
    /// True if the host has chosen the depth of the center.
    pub keeps_depth: bool,
    /// Length of the fade, metres.
    pub fade_distance: f32,
}

impl MeasuredParticles {
    /// Prepares the buffers and the pass that measures.
    pub fn write(&mut self, gpu: &Gpu<'_>, tiled: &TiledPipelines, inputs: MeasureInputs<'_>) -> Measure {
        let MeasureInputs { sprites, groups, system, keeps_depth, fade_distance } = inputs;
        let buffers = self.buffers.get_or_insert_with(|| MeasureBuffers {
            uniform: uniform_buffer(gpu.device, "haze measure", size_of::<MeasureUniform>() as u64),
            sums: storage(gpu.device, "haze extent sums", WORKGROUP, SUMS_BYTES),
            measured: storage(gpu.device, "haze measured extent", 1, MEASURED_BYTES),
            inputs: None,
        });
        let range = ParticleRange::new(&tiled.limits, &sprites);
        let workgroups = sprites.count.div_ceil(WORKGROUP).clamp(1, WORKGROUP);
        let uniform = MeasureUniform {
            count: sprites.count,
            first: range.first,
            workgroups,
            keeps_depth: u32::from(keeps_depth),
            fade_distance,
            padding: [0.0; 3],
        };
        gpu.queue.write_buffer(&buffers.uniform, 0, bytemuck::bytes_of(&uniform));
        Measure {
            pipelines: MeasureKey::ALL.map(|key| tiled.passes.measure.get(key)),
            groups: groups.clone(),
            inputs: buffers.bind(tiled, range),
            workgroups,
            measured: buffers.measured.clone(),
            system: system.clone(),
        }
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.buffers.as_ref().map_or(0, |held| held.uniform.size() + held.sums.size() + held.measured.size())
    }
}

impl MeasureBuffers {
    fn bind(&mut self, tiled: &TiledPipelines, range: ParticleRange) -> wgpu::BindGroup {
        match &self.inputs {
            Some((bound, group)) if *bound == range => group.clone(),
            _ => {
                let resources = [
                    self.uniform.as_entire_binding(),
                    range.binding(),
                    self.sums.as_entire_binding(),
                    self.measured.as_entire_binding(),
                ];
                let group = tiled.passes.measure.bind(resources);
                self.inputs = Some((range, group.clone()));
                group
            }
        }
    }
}
