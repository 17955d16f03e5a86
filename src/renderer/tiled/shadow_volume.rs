//! Density grid of a frame, optical depths towards its lights, and the splats of its systems.

use haze_core::formula::uniforms::{ShadowMarchUniform, SplatUniform};
use haze_core::glam::UVec2;
use haze_core::view_setup::SmokeShadow;

use super::storage_buffers::storage;
use super::tile_buffers::ParticleRange;
use super::tiled_pipelines::TiledPipelines;
use crate::frame::ShadowMap;
use crate::renderer::gpu::Gpu;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::renderer::gpu::record::uniform_buffer;
use crate::renderer::layouts::SHADOW_FORMAT;
use crate::renderer::pass::density_splat::{DensitySplat, DensitySplatKey};
use crate::renderer::pass::groups::Groups;
use crate::renderer::pass::shadow_march::{ShadowMarch, ShadowMarchKey};
use crate::renderer::pass::shadow_visibility::{ShadowVisibility, ShadowVisibilityKey};
use crate::renderer::pass::sprite_instances::Sprites;
use crate::renderer::shadow_map_bindings::ShadowMapBindings;

/// Bytes of a cell: two words.
const CELL_BYTES: u64 = 8;
/// Bytes of a texel of the volume.
const TEXEL_BYTES: u64 = 8;
/// Workgroups in a row of a dispatch: the limit of every device.
const MAX_COLUMNS: u32 = 65535;

/// Density grid of a renderer, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct ShadowVolume {
    buffers: Option<VolumeBuffers>,
    idle: IdleCounter,
}

#[derive(Debug)]
struct VolumeBuffers {
    /// Cells along each axis that fit.
    resolution: u32,
    blocks: u32,
    uniform: wgpu::Buffer,
    density: wgpu::Buffer,
    optical_depths: wgpu::TextureView,
    copy_density: wgpu::BindGroup,
    march: wgpu::BindGroup,
    /// By block of lights; empty unless shadow maps shade smoke.
    maps: Vec<ShadowMapBindings>,
}

/// Density grid of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameShadow<'a> {
    pub shadow: &'a SmokeShadow,
    /// `None` on devices without compute shaders.
    pub density: Option<&'a wgpu::Buffer>,
    pub optical_depths: &'a wgpu::TextureView,
}

impl ShadowVolume {
    /// Prepares the grid for a frame; releases it after 120 frames without shadow.
    pub fn write(
        &mut self,
        gpu: &Gpu<'_>,
        tiled: &TiledPipelines,
        shadow: Option<&SmokeShadow>,
        maps: &[ShadowMap<'_>],
    ) {
        if self.idle.tick(shadow.is_none()) {
            self.buffers = None;
        }
        let Some(shadow) = shadow else { return };
        let fits = |held: &VolumeBuffers| {
            (held.resolution, held.blocks) == (shadow.resolution, shadow.blocks())
                && held.maps.len() == shadow.map_blocks() as usize
        };
        if !self.buffers.as_ref().is_some_and(fits) {
            self.buffers = None;
        }
        let buffers = self.buffers.get_or_insert_with(|| VolumeBuffers::new(gpu.device, tiled, shadow));
        gpu.queue.write_buffer(&buffers.uniform, 0, bytemuck::bytes_of(&shadow.march));
        for (block, held) in (0..).zip(&mut buffers.maps) {
            let volume = Some(&buffers.optical_depths);
            held.write(gpu, &tiled.passes.shadow_visibility.inputs, shadow, block, maps, volume);
        }
    }

    /// Returns the grid with the frame's shadow.
    pub fn of_frame<'a>(&'a self, shadow: &'a SmokeShadow) -> Option<FrameShadow<'a>> {
        let VolumeBuffers { density, optical_depths, .. } = self.buffers.as_ref()?;
        Some(FrameShadow { shadow, density: Some(density), optical_depths })
    }

    /// Clears the density.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(held) = &self.buffers {
            encoder.clear_buffer(&held.density, 0, None);
        }
    }

    /// Returns the pass that marches to the lights.
    pub fn march(&self, tiled: &TiledPipelines, shadow: &SmokeShadow) -> Option<ShadowMarch> {
        let buffers = self.buffers.as_ref()?;
        // On GPUs the marches to the sky share the dispatch of those to the lights.
        let shares_dispatch = tiled.cooperative();
        let marches_sky = shadow.has_openness;
        Some(ShadowMarch {
            copy_density: tiled.passes.shadow_march.get(ShadowMarchKey::CopyDensity),
            copy_inputs: buffers.copy_density.clone(),
            march_cells: tiled.passes.shadow_march.get(ShadowMarchKey::MarchCells),
            march_sky: (marches_sky && !shares_dispatch)
                .then(|| tiled.passes.shadow_march.get(ShadowMarchKey::MarchSky)),
            march_inputs: buffers.march.clone(),
            size: shadow.grid.size,
            blocks: shadow.used_light_blocks() + u32::from(marches_sky && shares_dispatch),
        })
    }

    /// Returns the pass that looks up the host's shadow maps, if they shade smoke.
    pub fn look_up(&self, tiled: &TiledPipelines, shadow: &SmokeShadow) -> Option<ShadowVisibility> {
        let maps = self.buffers.as_ref().map(|held| &held.maps).filter(|maps| !maps.is_empty())?;
        let used = maps.iter().take(shadow.used_light_blocks() as usize);
        let inputs = used.map(|maps| maps.group().clone()).collect();
        Some(ShadowVisibility {
            pipeline: tiled.passes.shadow_visibility.get(ShadowVisibilityKey),
            inputs,
            size: shadow.grid.size,
        })
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.buffers.as_ref().map_or(0, |held| {
            let maps = held.maps.iter().map(ShadowMapBindings::bytes).sum::<u64>();
            let volume = u64::from(held.blocks) * TEXEL_BYTES * u64::from(held.resolution).pow(3);
            let density = TEXEL_BYTES * u64::from(density_side(held.resolution)).pow(3);
            held.uniform.size() + held.density.size() + density + volume + maps
        })
    }
}

impl VolumeBuffers {
    fn new(device: &wgpu::Device, tiled: &TiledPipelines, shadow: &SmokeShadow) -> Self {
        let resolution = shadow.resolution;
        let blocks = shadow.blocks();
        let uniform = uniform_buffer(device, "haze shadow_march", size_of::<ShadowMarchUniform>() as u64);
        let density = storage(device, "haze density", resolution.pow(3), CELL_BYTES);
        let written = wgpu::TextureUsages::STORAGE_BINDING;
        let optical_depths = volume(device, "haze optical depths", resolution, blocks, written);
        let density_texture = volume(device, "haze density texture", density_side(resolution), 1, written);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("haze density"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let bind_volumes = |written, read| {
            let resources = [
                uniform.as_entire_binding(),
                density.as_entire_binding(),
                wgpu::BindingResource::TextureView(written),
                wgpu::BindingResource::TextureView(read),
                wgpu::BindingResource::Sampler(&sampler),
            ];
            tiled.passes.shadow_march.bind(resources)
        };
        let copy_density = bind_volumes(&density_texture, &optical_depths);
        let march = bind_volumes(&optical_depths, &density_texture);
        let maps = (0..shadow.map_blocks())
            .map(|_| ShadowMapBindings::new(device, &tiled.passes.shadow_visibility.inputs, Some(&optical_depths)))
            .collect();
        Self { resolution, blocks, uniform, density, optical_depths, copy_density, march, maps }
    }
}

/// Returns the cells along each axis of the density's texture: one more at each end, which are empty.
fn density_side(resolution: u32) -> u32 {
    resolution + 2
}

/// Creates a volume of `blocks` cubes along z.
pub(crate) fn volume(
    device: &wgpu::Device,
    label: &str,
    resolution: u32,
    blocks: u32,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: resolution, height: resolution, depth_or_array_layers: resolution * blocks },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: SHADOW_FORMAT,
        usage: usage | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Splat of one system, kept between frames.
#[derive(Debug, Default)]
pub(crate) struct SplatParticles {
    buffers: Option<SplatBuffers>,
}

#[derive(Debug)]
struct SplatBuffers {
    uniform: wgpu::Buffer,
    /// Recreated when the particles or the grid are in another buffer.
    inputs: Option<(ParticleRange, wgpu::Buffer, wgpu::BindGroup)>,
}

impl SplatParticles {
    /// Prepares the pass that adds `sprites` to a grid.
    pub fn write(
        &mut self,
        gpu: &Gpu<'_>,
        tiled: &TiledPipelines,
        sprites: &Sprites,
        groups: &Groups,
        density: &wgpu::Buffer,
    ) -> DensitySplat {
        let range = ParticleRange::new(&tiled.limits, sprites);
        let workgroups = UVec2::new(sprites.count.clamp(1, MAX_COLUMNS), sprites.count.div_ceil(MAX_COLUMNS));
        let uniform = SplatUniform { count: sprites.count, first: range.first, columns: workgroups.x, padding: 0 };
        let held = self.buffers.get_or_insert_with(|| SplatBuffers {
            uniform: uniform_buffer(gpu.device, "haze density_splat", size_of::<SplatUniform>() as u64),
            inputs: None,
        });
        gpu.queue.write_buffer(&held.uniform, 0, bytemuck::bytes_of(&uniform));
        let inputs = match &held.inputs {
            Some((bound, grid, group)) if *bound == range && grid == density => group.clone(),
            _ => {
                let resources = [held.uniform.as_entire_binding(), range.binding(), density.as_entire_binding()];
                let group = tiled.passes.density_splat.bind(resources);
                held.inputs = Some((range, density.clone(), group.clone()));
                group
            }
        };
        DensitySplat {
            pipeline: tiled.passes.density_splat.get(DensitySplatKey),
            groups: groups.clone(),
            inputs,
            workgroups,
        }
    }
}
