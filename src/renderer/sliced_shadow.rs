//! Shadow of smoke on devices without compute shaders: the CPU adds up the density grid, and render passes march through it,
//! slice by slice. `tiled/shadow_volume.rs` is the same by compute shaders.

use haze_core::formula::uniforms::{ShadowMarchUniform, SystemUniform};
use haze_core::frame::Particle;
use haze_core::glam::UVec3;
use haze_core::view_setup::{SmokeShadow, cell_optical_depths, density_splat};

use super::context::Shared;
use super::gpu::idle_counter::IdleCounter;
use super::gpu::record::uniform_buffer;
use super::pass::shadow_march_slice::MarchTo;
use super::pass::shadow_visibility_slice::ShadowVisibilitySliceKey;
use super::pass::volume_slices::VolumeSlices;
use super::shadow_map_bindings::ShadowMapBindings;
use super::tiled::{FrameShadow, volume};
use crate::frame::ShadowMap;

/// Bytes of a cell on the GPU: of its density, and of a texel of the volume.
const DENSITY_BYTES: u64 = 4;
const TEXEL_BYTES: u64 = 8;

/// Density grid and volume of a renderer, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct SlicedShadow {
    buffers: Option<SliceBuffers>,
    idle: IdleCounter,
    /// Sums of the frame, in fixed-point steps.
    steps: Vec<u64>,
    /// The same as optical depths.
    depths: Vec<f32>,
}

#[derive(Debug)]
struct SliceBuffers {
    /// Cells along each axis that fit.
    resolution: u32,
    blocks: u32,
    uniform: wgpu::Buffer,
    density: wgpu::Texture,
    optical_depths: wgpu::TextureView,
    march: wgpu::BindGroup,
    /// By block of lights; empty unless shadow maps shade smoke.
    maps: Vec<ShadowMapBindings>,
}

impl SlicedShadow {
    /// Prepares the grid for a frame; releases it after 120 frames without shadow.
    pub fn write(&mut self, shared: &Shared, shadow: Option<&SmokeShadow>, maps: &[ShadowMap<'_>]) {
        if self.idle.tick(shadow.is_none()) {
            *self = Self::default();
        }
        let Some(shadow) = shadow else { return };
        let fits = |held: &SliceBuffers| {
            (held.resolution, held.blocks) == (shadow.resolution, shadow.blocks())
                && held.maps.len() == shadow.map_blocks() as usize
        };
        if !self.buffers.as_ref().is_some_and(fits) {
            self.buffers = None;
        }
        let buffers = self.buffers.get_or_insert_with(|| SliceBuffers::new(shared, shadow));
        shared.queue.write_buffer(&buffers.uniform, 0, bytemuck::bytes_of(&shadow.march));
        for (block, held) in (0..).zip(&mut buffers.maps) {
            held.write(&shared.gpu(), &shared.layouts.shadow_maps, shadow, block, maps, None);
        }
        self.steps.clear();
        self.steps.resize(shadow.grid.size.element_product() as usize, 0);
    }

    /// Returns the grid with the frame's shadow.
    pub fn of_frame<'a>(&'a self, shadow: &'a SmokeShadow) -> Option<FrameShadow<'a>> {
        let optical_depths = &self.buffers.as_ref()?.optical_depths;
        Some(FrameShadow { shadow, density: None, optical_depths })
    }

    /// Adds the sprites of a system.
    pub fn add(&mut self, shadow: &SmokeShadow, system: &SystemUniform, particles: &[Particle]) {
        density_splat(system, particles, shadow.grid.size, &mut self.steps);
    }

    /// Uploads the sums. Returns the passes that march through them and look up the shadow maps.
    pub fn march(&mut self, shared: &Shared, shadow: &SmokeShadow) -> Vec<VolumeSlices<'_>> {
        let Some(held) = &self.buffers else { return Vec::new() };
        self.depths.clear();
        self.depths.extend(cell_optical_depths(&self.steps));
        let size = shadow.grid.size;
        let extent = extent(size);
        let rows =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size.x), rows_per_image: Some(size.y) };
        shared.queue.write_texture(held.density.as_image_copy(), bytemuck::cast_slice(&self.depths), rows, extent);
        let pipelines = &shared.pipelines;
        let of_block = |block: u32, name, pipeline, inputs: &wgpu::BindGroup| {
            let first = block * held.resolution;
            let slices = first..first + size.z;
            VolumeSlices { name, pipeline, inputs: inputs.clone(), volume: &held.optical_depths, size, slices }
        };
        let march =
            |block, to| of_block(block, "shadow_march_slice", pipelines.drawn.shadow_march_slice.get(to), &held.march);
        let lights = (0..shadow.used_light_blocks()).map(|block| march(block, MarchTo::Lights));
        let sky = shadow.has_openness.then(|| march(shadow.openness_block(), MarchTo::Sky));
        let maps = (shadow.visibility_block()..).zip(held.maps.iter().take(shadow.used_light_blocks() as usize));
        let visible = maps.map(|(block, maps)| {
            let pipeline = pipelines.drawn.shadow_visibility_slice.get(ShadowVisibilitySliceKey);
            of_block(block, "shadow_visibility_slice", pipeline, maps.group())
        });
        lights.chain(sky).chain(visible).collect()
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.buffers.as_ref().map_or(0, |held| {
            let cells = u64::from(held.resolution).pow(3);
            let maps: u64 = held.maps.iter().map(ShadowMapBindings::bytes).sum();
            held.uniform.size() + cells * (DENSITY_BYTES + u64::from(held.blocks) * TEXEL_BYTES) + maps
        })
    }
}

impl SliceBuffers {
    fn new(shared: &Shared, shadow: &SmokeShadow) -> Self {
        let device = &shared.device;
        let layouts = &shared.layouts;
        let resolution = shadow.resolution;
        let blocks = shadow.blocks();
        let uniform = uniform_buffer(device, "haze shadow_march", size_of::<ShadowMarchUniform>() as u64);
        let density = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("haze density"),
            size: extent(UVec3::splat(resolution)),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let optical_depths =
            volume(device, "haze optical depths", resolution, blocks, wgpu::TextureUsages::RENDER_ATTACHMENT);
        let density_view = density.create_view(&wgpu::TextureViewDescriptor::default());
        let resources = [uniform.as_entire_binding(), wgpu::BindingResource::TextureView(&density_view)];
        let march = shared.pipelines.drawn.shadow_march_slice.bind(resources);
        let map = |_| ShadowMapBindings::new(device, &layouts.shadow_maps, None);
        let maps = (0..shadow.map_blocks()).map(map).collect();
        Self { resolution, blocks, uniform, density, optical_depths, march, maps }
    }
}

fn extent(size: UVec3) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z }
}
