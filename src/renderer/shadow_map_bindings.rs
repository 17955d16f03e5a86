//! A host's shadow maps of a block of lights, as shaders read them.

use haze_core::formula::shadow::LIGHTS_PER_BLOCK;
use haze_core::formula::uniforms::ShadowVisibilityUniform;
use haze_core::view_setup::SmokeShadow;

use super::gpu::Gpu;
use super::gpu::binding::bind_resources;
use super::gpu::capabilities::array_layers;
use super::gpu::record::uniform_buffer;
use crate::frame::ShadowMap;

/// Bind group of `lib/shadow_map_lookup.wgsl`, kept between frames.
#[derive(Debug)]
pub(crate) struct ShadowMapBindings {
    uniform: wgpu::Buffer,
    /// Instead of a light without map.
    no_map: wgpu::Texture,
    /// Textures and first layers of the lights' maps, by slot.
    bound: [(wgpu::Texture, u32); LIGHTS_PER_BLOCK],
    group: wgpu::BindGroup,
}

impl ShadowMapBindings {
    /// `layout`: uniform, maps, and the volume that is written, if there is one.
    pub fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, volume: Option<&wgpu::TextureView>) -> Self {
        let uniform = uniform_buffer(device, "haze shadow maps", size_of::<ShadowVisibilityUniform>() as u64);
        let no_map = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("haze no shadow map"),
            size: wgpu::Extent3d { depth_or_array_layers: array_layers(1), ..wgpu::Extent3d::default() },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let bound = std::array::from_fn(|_| (no_map.clone(), 0));
        let group = bind(device, layout, &uniform, &bound, volume);
        Self { uniform, no_map, bound, group }
    }

    /// Prepares the maps of a block of lights for a frame. `layout` and `volume` as in [`new`](Self::new).
    pub fn write(
        &mut self,
        gpu: &Gpu<'_>,
        layout: &wgpu::BindGroupLayout,
        shadow: &SmokeShadow,
        block: u32,
        maps: &[ShadowMap<'_>],
        volume: Option<&wgpu::TextureView>,
    ) {
        let of_light = |light: usize| maps.iter().find(|map| map.projection.light == light);
        let uniform = shadow.visibility(block, |light| of_light(light).map(|map| map.projection));
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let used = shadow.lights_of_block(block).map(|light| match light.and_then(of_light) {
            Some(map) => (map.depth, map.first_layer),
            None => (&self.no_map, 0),
        });
        if used.iter().zip(&self.bound).any(|((map, layer), bound)| (*map, *layer) != (&bound.0, bound.1)) {
            self.bound = used.map(|(map, layer)| (map.clone(), layer));
            self.group = bind(gpu.device, layout, &self.uniform, &self.bound, volume);
        }
    }

    pub fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }

    /// Returns the bytes of GPU memory held.
    pub fn bytes(&self) -> u64 {
        self.uniform.size()
    }
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniform: &wgpu::Buffer,
    maps: &[(wgpu::Texture, u32); LIGHTS_PER_BLOCK],
    volume: Option<&wgpu::TextureView>,
) -> wgpu::BindGroup {
    let views = maps.each_ref().map(|(map, first_layer)| {
        map.create_view(&wgpu::TextureViewDescriptor {
            label: Some("haze shadow map"),
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            aspect: wgpu::TextureAspect::DepthOnly,
            mip_level_count: Some(1),
            base_array_layer: *first_layer,
            ..Default::default()
        })
    });
    let textures = views.iter().chain(volume).map(wgpu::BindingResource::TextureView);
    bind_resources(device, "haze shadow maps", layout, [uniform.as_entire_binding()].into_iter().chain(textures))
}
