//! Layouts of the bind groups: 0 frame, 1 system, 2 material, 3 the pass's own inputs. See `shaders/lib/bindings.wgsl`.

use super::gpu::capabilities::tiles_are_supported;
use crate::formula::uniforms::{
    LightUniform, SceneShadowUniform, ScreenShadowUniform, ShadowMarchUniform, ShadowVisibilityUniform, SystemUniform,
    ViewUniform,
};
use crate::frame::MAX_LIGHTS;
use crate::view_setup::MAX_TARGET_ATTACHMENTS;

/// Size of the lights' uniform block, bytes.
pub(crate) const LIGHTS_SIZE: u64 = (MAX_LIGHTS * size_of::<LightUniform>()) as u64;

/// Bindings of a material that the passes that draw sprites or bake light read. WebGPU and WebGL2 guarantee 16 textures per
/// stage, too few for all of the material's.
pub(crate) const SPRITE_BINDINGS: [u32; 13] = [0, 1, 2, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15];

/// Bindings of a material that the passes that light accumulated smoke read: ramps, their sampler, and the painted motif.
pub(crate) const LIGHTING_BINDINGS: [u32; 9] = [1, 2, 3, 4, 5, 10, 12, 13, 15];

/// Format of the optical depths in the cells of the density grid.
pub(crate) const SHADOW_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Number of textures that transfer reads: first attachment, reduced depth, baked light, further attachments.
pub(crate) const TRANSFER_TEXTURES: usize = 3 + (MAX_TARGET_ATTACHMENTS - 1);

#[derive(Debug)]
pub(crate) struct Layouts {
    pub frame: wgpu::BindGroupLayout,
    pub system: wgpu::BindGroupLayout,
    /// With [`SPRITE_BINDINGS`].
    pub material: wgpu::BindGroupLayout,
    /// As `material`, with [`LIGHTING_BINDINGS`].
    pub lighting: wgpu::BindGroupLayout,
    /// Of depth_resolve alone: the host's multisampled depth.
    pub depth_resolve: wgpu::BindGroupLayout,
    pub accumulate: wgpu::BindGroupLayout,
    pub transfer: wgpu::BindGroupLayout,
    /// Lit smoke or the first attachment, reduced depth, depth slopes, cells with smoke, glows.
    pub lit: wgpu::BindGroupLayout,
    /// Of a host's shaders: shadow of the smoke on the scene.
    pub scene_shadow: wgpu::BindGroupLayout,
    /// A host's shadow maps of a block of lights.
    pub shadow_maps: wgpu::BindGroupLayout,
    pub screen_shadow: wgpu::BindGroupLayout,
    /// Optical depths across the cells of the density grid, on devices without compute shaders.
    pub shadow_march_slice: wgpu::BindGroupLayout,
}

impl Layouts {
    pub fn new(device: &wgpu::Device) -> Self {
        use wgpu::TextureViewDimension::{D2, D2Array, D3};
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        // Suits depth buffers and R32Float.
        let unfilterable = wgpu::TextureSampleType::Float { filterable: false };
        let uniform = |size: u64| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(size),
        };
        let texture = texture_type;
        let mut visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
        visibility.set(wgpu::ShaderStages::COMPUTE, tiles_are_supported(device));
        let layout_of = |label, is_bound: &dyn Fn(u32) -> bool, types: &[wgpu::BindingType]| {
            let entries: Vec<_> = (0..)
                .zip(types)
                .filter(|(binding, _)| is_bound(*binding))
                .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        let layout = |label, types: &[wgpu::BindingType]| layout_of(label, &|_| true, types);
        let material = [
            texture(filterable, D2Array),
            texture(filterable, D2),
            texture(filterable, D2),
            texture(filterable, D2),
            texture(filterable, D2),
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            texture(filterable, D2Array),
            texture(filterable, D2),
            texture(filterable, D3),
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            texture(filterable, D2),
            texture(wgpu::TextureSampleType::Uint, D2),
            texture(filterable, D2),
            texture(filterable, D2),
            texture(filterable, D2),
            texture(filterable, D2),
        ];
        let multisampled = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: D2,
            multisampled: true,
        };
        let map = texture(unfilterable, D2Array);
        Self {
            frame: layout("haze frame", &[uniform(size_of::<ViewUniform>() as u64), texture(unfilterable, D2)]),
            system: layout(
                "haze system",
                &[uniform(size_of::<SystemUniform>() as u64), uniform(LIGHTS_SIZE), texture(filterable, D3)],
            ),
            material: layout_of("haze material", &|binding| SPRITE_BINDINGS.contains(&binding), &material),
            lighting: layout_of("haze material lighting", &|binding| LIGHTING_BINDINGS.contains(&binding), &material),
            depth_resolve: layout("haze depth samples", &[multisampled]),
            accumulate: layout("haze accumulate inputs", &[texture(unfilterable, D2)]),
            transfer: layout("haze transfer inputs", &transfer_types()),
            lit: layout(
                "haze lit inputs",
                &[
                    texture(filterable, D2),
                    texture(unfilterable, D2),
                    texture(filterable, D2),
                    texture(unfilterable, D2),
                    texture(unfilterable, D2),
                    texture(unfilterable, D2),
                ],
            ),
            scene_shadow: layout(
                "haze scene shadow",
                &[
                    uniform(size_of::<SceneShadowUniform>() as u64),
                    texture(filterable, D3),
                    texture(filterable, D2),
                    wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                ],
            ),
            shadow_maps: layout(
                "haze shadow maps",
                &[uniform(size_of::<ShadowVisibilityUniform>() as u64), map, map, map],
            ),
            shadow_march_slice: layout(
                "haze shadow_march_slice inputs",
                &[uniform(size_of::<ShadowMarchUniform>() as u64), texture(unfilterable, D3)],
            ),
            screen_shadow: layout(
                "haze screen_shadow inputs",
                &[uniform(size_of::<ScreenShadowUniform>() as u64), uniform(LIGHTS_SIZE)],
            ),
        }
    }
}

/// Returns the type of a texture that shaders read.
pub(crate) fn texture_type(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

/// Returns the types of the textures that transfer and light_target read.
pub(crate) fn transfer_types() -> [wgpu::BindingType; TRANSFER_TEXTURES] {
    let unfilterable = wgpu::TextureSampleType::Float { filterable: false };
    let mut types = [texture_type(unfilterable, wgpu::TextureViewDimension::D2); TRANSFER_TEXTURES];
    let filterable = wgpu::TextureSampleType::Float { filterable: true };
    types[2] = texture_type(filterable, wgpu::TextureViewDimension::D2Array);
    types
}

/// Creates a bind group of resources, in the order of its layout.
pub(crate) fn bind_resources<'a>(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// Creates a bind group of textures, in the order of its layout.
pub(crate) fn bind_textures<'a>(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    views: impl IntoIterator<Item = &'a wgpu::TextureView>,
) -> wgpu::BindGroup {
    bind_resources(device, label, layout, views.into_iter().map(wgpu::BindingResource::TextureView))
}
