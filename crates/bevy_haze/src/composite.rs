//! composite: smoke in views that Bevy tonemaps in the shader of each mesh. WESL: `composite.wesl`.

use bevy::asset::{AssetServer, Handle, load_embedded_asset};
use bevy::core_pipeline::FullscreenShader;
use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use bevy::core_pipeline::tonemapping::{
    DebandDither, Tonemapping, TonemappingLuts, get_lut_bind_group_layout_entries, get_lut_bindings,
};
use bevy::ecs::prelude::*;
use bevy::ecs::system::SystemParam;
use bevy::prelude::default;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::binding_types::{texture_2d, uniform_buffer};
use bevy::render::render_resource::{
    BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, BlendState, BufferId, CachedRenderPipelineId,
    ColorTargetState, ColorWrites, CompareFunction, DepthStencilState, DynamicBindGroupLayoutEntries, FragmentState,
    MultisampleState, PipelineCache, RenderPipelineDescriptor, ShaderStages, SpecializedRenderPipeline, TextureFormat,
    TextureSampleType, TextureViewId,
};
use bevy::render::renderer::RenderDevice;
use bevy::render::texture::{FallbackImage, GpuImage};
use bevy::render::view::{ViewUniform, ViewUniforms};
use bevy::shader::{Shader, ShaderDefVal};

use crate::targets::LightTarget;

/// Pipeline that a view composites with.
#[derive(Component, Clone, Copy)]
pub(crate) struct CompositePipelineId(pub CachedRenderPipelineId);

/// Bind group of a view, and what it was made of.
pub(crate) struct CompositeBinding {
    made_of: (BufferId, TextureViewId, TextureViewId),
    pub group: BindGroup,
}

#[derive(Resource)]
pub(crate) struct CompositePipeline {
    layout: BindGroupLayoutDescriptor,
    fullscreen: FullscreenShader,
    shader: Handle<Shader>,
}

/// Pass and tonemapping of a view.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct CompositeKey {
    pub format: TextureFormat,
    pub samples: u32,
    pub tonemapping: Tonemapping,
    pub dither: DebandDither,
}

impl FromWorld for CompositePipeline {
    fn from_world(world: &mut World) -> Self {
        let [lut, lut_sampler] = get_lut_bind_group_layout_entries();
        let entries = DynamicBindGroupLayoutEntries::new_with_indices(
            ShaderStages::FRAGMENT,
            (
                (0, uniform_buffer::<ViewUniform>(true)),
                (1, texture_2d(TextureSampleType::Float { filterable: false })),
                (2, lut),
                (3, lut_sampler),
            ),
        );
        Self {
            layout: BindGroupLayoutDescriptor::new("smoke_composite", &entries),
            fullscreen: world.resource::<FullscreenShader>().clone(),
            shader: load_embedded_asset!(world.resource::<AssetServer>(), "composite.wesl"),
        }
    }
}

impl SpecializedRenderPipeline for CompositePipeline {
    type Key = CompositeKey;

    fn specialize(&self, key: CompositeKey) -> RenderPipelineDescriptor {
        let mut shader_defs = vec![
            ShaderDefVal::UInt("TONEMAPPING_LUT_TEXTURE_BINDING_INDEX".into(), 2),
            ShaderDefVal::UInt("TONEMAPPING_LUT_SAMPLER_BINDING_INDEX".into(), 3),
            tonemap_method(key.tonemapping).into(),
        ];
        if key.dither == DebandDither::Enabled {
            shader_defs.push("DEBAND_DITHER".into());
        }
        RenderPipelineDescriptor {
            label: Some("smoke_composite".into()),
            layout: vec![self.layout.clone()],
            vertex: self.fullscreen.to_vertex_state(),
            fragment: Some(FragmentState {
                shader: self.shader.clone(),
                shader_defs,
                targets: vec![Some(ColorTargetState {
                    format: key.format,
                    blend: Some(BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: ColorWrites::ALL,
                })],
                ..default()
            }),
            // The transparent pass has a depth buffer. The smoke has been tested already.
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                depth_write_enabled: Some(false),
                depth_compare: Some(CompareFunction::Always),
                stencil: default(),
                bias: default(),
            }),
            multisample: MultisampleState { count: key.samples, ..default() },
            ..default()
        }
    }
}

/// Name by which Bevy's tonemapping shader selects a curve.
const fn tonemap_method(tonemapping: Tonemapping) -> &'static str {
    match tonemapping {
        Tonemapping::None | Tonemapping::Linear => "TONEMAP_METHOD_LINEAR",
        Tonemapping::Reinhard => "TONEMAP_METHOD_REINHARD",
        Tonemapping::ReinhardLuminance => "TONEMAP_METHOD_REINHARD_LUMINANCE",
        Tonemapping::AcesFitted => "TONEMAP_METHOD_ACES_FITTED",
        Tonemapping::AgX => "TONEMAP_METHOD_AGX",
        Tonemapping::SomewhatBoringDisplayTransform => "TONEMAP_METHOD_SOMEWHAT_BORING_DISPLAY_TRANSFORM",
        Tonemapping::TonyMcMapface => "TONEMAP_METHOD_TONY_MC_MAPFACE",
        Tonemapping::BlenderFilmic => "TONEMAP_METHOD_BLENDER_FILMIC",
        Tonemapping::KhronosPbrNeutral => "TONEMAP_METHOD_PBR_NEUTRAL",
    }
}

/// Resources that a composite's bind group is made of.
#[derive(SystemParam)]
pub(crate) struct CompositeResources<'w> {
    device: Res<'w, RenderDevice>,
    cache: Res<'w, PipelineCache>,
    pipeline: Res<'w, CompositePipeline>,
    uniforms: Res<'w, ViewUniforms>,
    images: Res<'w, RenderAssets<GpuImage>>,
    luts: Res<'w, TonemappingLuts>,
    fallback: Res<'w, FallbackImage>,
}

impl CompositeResources<'_> {
    /// Makes the bind group again if anything that it is made of has changed. `None` without a view uniform.
    pub fn bind(
        &self,
        kept: Option<CompositeBinding>,
        light: &LightTarget,
        tonemapping: &Tonemapping,
    ) -> Option<CompositeBinding> {
        let uniforms = &self.uniforms.uniforms;
        let source = &light.source().default_view;
        let (lut, sampler) = get_lut_bindings(&self.images, &self.luts, tonemapping, &self.fallback);
        let made_of = (uniforms.buffer()?.id(), source.id(), lut.id());
        if let Some(kept) = kept.filter(|kept| kept.made_of == made_of) {
            return Some(kept);
        }
        let layout = self.cache.get_bind_group_layout(&self.pipeline.layout);
        let entries = BindGroupEntries::sequential((uniforms.binding()?, source, lut, sampler));
        Some(CompositeBinding { made_of, group: self.device.create_bind_group("smoke_composite", &layout, &entries) })
    }
}
