//! The passes, one file each, and what they share: bind group layouts and pipeline variants.

pub(crate) mod accumulate;
pub(crate) mod depth_downsample;
pub(crate) mod diffuse_bake;
pub(crate) mod forward;
pub(crate) mod sort;
pub(crate) mod specular_scatter;
pub(crate) mod transfer;

use std::collections::HashMap;
use std::hash::Hash;

use crate::descriptor::read_only_depth_is_supported;
use crate::frame_bindings::FrameBindings;
use crate::gpu_types::{LightUniform, SystemUniform, ViewUniform};
use crate::light::MAX_LIGHTS;
use crate::shader;
use crate::slot::{Draw, Slot};

/// Layouts of the bind groups: 0 frame, 1 system, 2 material, 3 the pass's own inputs. `shaders/lib/bindings.wgsl`.
#[derive(Debug)]
pub(crate) struct Layouts {
    /// [`read_only_depth_is_supported`], asked once: the answer is one of many that a device makes a copy of each time.
    pub read_only_depth: bool,
    pub frame: wgpu::BindGroupLayout,
    pub system: wgpu::BindGroupLayout,
    pub material: wgpu::BindGroupLayout,
    pub accumulate: wgpu::BindGroupLayout,
    pub transfer: wgpu::BindGroupLayout,
}

/// Layers to allocate for a square array texture of `layers`. wgpu's OpenGL backend takes a texture of one layer for a plain
/// one, and a square texture of six, or a multiple, for a cube: neither can then be sampled as an array.
pub(crate) fn array_layers(layers: u32) -> u32 {
    if layers == 1 || layers.is_multiple_of(6) { layers + 1 } else { layers }
}

/// Bytes of the lights' uniform block.
pub(crate) const LIGHTS_SIZE: u64 = (MAX_LIGHTS * size_of::<LightUniform>()) as u64;

impl Layouts {
    pub fn new(device: &wgpu::Device) -> Self {
        use wgpu::TextureViewDimension::{D2, D2Array, D3};
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        // Depth buffers and R32Float alike.
        let unfilterable = wgpu::TextureSampleType::Float { filterable: false };
        let uniform = |size: u64| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(size),
        };
        let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        let layout = |label, types: &[wgpu::BindingType]| {
            let entries: Vec<_> = (0..)
                .zip(types)
                .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
                    binding,
                    visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                    ty,
                    count: None,
                })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        Self {
            read_only_depth: read_only_depth_is_supported(device),
            frame: layout("haze frame", &[uniform(size_of::<ViewUniform>() as u64), texture(unfilterable, D2)]),
            system: layout("haze system", &[uniform(size_of::<SystemUniform>() as u64), uniform(LIGHTS_SIZE)]),
            material: layout(
                "haze material",
                &[
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
                ],
            ),
            accumulate: layout("haze accumulate inputs", &[texture(unfilterable, D2)]),
            transfer: layout(
                "haze transfer inputs",
                &[texture(unfilterable, D2), texture(unfilterable, D2), texture(filterable, D2Array)],
            ),
        }
    }
}

/// A pass's shader, and its pipelines by what distinguishes them. Compiled when first asked for.
#[derive(Debug)]
pub(crate) struct Variants<K> {
    pub module: wgpu::ShaderModule,
    pub layout: wgpu::PipelineLayout,
    pipelines: HashMap<K, wgpu::RenderPipeline>,
}

impl<K: Copy + Eq + Hash> Variants<K> {
    /// `name` is the pass: its shader file and its label.
    pub fn new(device: &wgpu::Device, name: &'static str, groups: &[Option<&wgpu::BindGroupLayout>]) -> Self {
        let file = format!("{name}.wgsl");
        // The sources are embedded and a test composes every one, so neither can fail; an empty module would be
        // reported by the device like any other invalid shader.
        let source = shader::source(&file).and_then(|text| shader::compose(text).ok()).unwrap_or_default();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: groups,
            immediate_size: 0,
        });
        Self { module, layout, pipelines: HashMap::new() }
    }

    /// The pipeline for `key`, made by `create` the first time.
    pub fn get(
        &mut self,
        key: K,
        create: impl FnOnce(&wgpu::ShaderModule, &wgpu::PipelineLayout) -> wgpu::RenderPipeline,
    ) -> wgpu::RenderPipeline {
        self.pipelines.entry(key).or_insert_with(|| create(&self.module, &self.layout)).clone()
    }
}

/// Premultiplied: the source's colour and amount over what is there. On the accumulation target this is OTEE's
/// AddSmooth: alpha becomes a + A·(1 − a).
pub(crate) const PREMULTIPLIED_OVER: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

/// ONE, ONE on colour; alpha is left alone.
pub(crate) const ADDITIVE: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: KEEP_ALPHA,
};

/// DST, ZERO on colour: what is there times the source.
pub(crate) const MULTIPLY: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Dst,
        dst_factor: wgpu::BlendFactor::Zero,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: KEEP_ALPHA,
};

const KEEP_ALPHA: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Zero,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

/// A buffer for one uniform block.
pub(crate) fn uniform_buffer(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A WGSL override and its value.
pub(crate) type Constant = (&'static str, f64);

/// A switch of the shader.
pub(crate) fn switch(name: &'static str, on: bool) -> Constant {
    (name, if on { 1.0 } else { 0.0 })
}

/// A setting enum as the shader's number: the variant's place.
macro_rules! variant {
    ($name:literal, $value:expr) => {
        ($name, f64::from($value as u32))
    };
}
pub(crate) use variant;

/// The parts of a render pipeline that differ from pass to pass.
pub(crate) struct PipelineParts<'a> {
    pub label: &'static str,
    pub module: &'a wgpu::ShaderModule,
    pub layout: &'a wgpu::PipelineLayout,
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub primitive: wgpu::PrimitiveState,
    pub depth_stencil: Option<wgpu::DepthStencilState>,
    pub sample_count: u32,
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    pub constants: &'a [Constant],
}

pub(crate) fn create_pipeline(device: &wgpu::Device, parts: PipelineParts<'_>) -> wgpu::RenderPipeline {
    let options = wgpu::PipelineCompilationOptions { constants: parts.constants, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(parts.label),
        layout: Some(parts.layout),
        vertex: wgpu::VertexState {
            module: parts.module,
            entry_point: Some("vertex"),
            compilation_options: options.clone(),
            buffers: parts.buffers,
        },
        primitive: parts.primitive,
        depth_stencil: parts.depth_stencil,
        multisample: wgpu::MultisampleState { count: parts.sample_count, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: parts.module,
            entry_point: Some("fragment"),
            compilation_options: options,
            targets: parts.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A colour target with a blend.
pub(crate) fn color_target(
    format: wgpu::TextureFormat,
    blend: Option<wgpu::BlendState>,
) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
}

/// A depth attachment that is compared with but not written.
pub(crate) fn read_only_depth(format: wgpu::TextureFormat, compare: wgpu::CompareFunction) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(false),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// "In front of or at the surface" in a depth buffer.
pub(crate) fn in_front(reversed: bool) -> wgpu::CompareFunction {
    if reversed { wgpu::CompareFunction::GreaterEqual } else { wgpu::CompareFunction::LessEqual }
}

/// The instance buffer's layout: one [`Particle`](crate::Particle) per sprite.
pub(crate) const PARTICLE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<crate::Particle>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4],
};

/// The primitive of sprites and quads: a strip of four corners, both sides.
pub(crate) const STRIP: wgpu::PrimitiveState = wgpu::PrimitiveState {
    topology: wgpu::PrimitiveTopology::TriangleStrip,
    strip_index_format: None,
    front_face: wgpu::FrontFace::Ccw,
    cull_mode: None,
    unclipped_depth: false,
    polygon_mode: wgpu::PolygonMode::Fill,
    conservative: false,
};

/// Binds groups 0 to 2, as the layouts above have them.
pub(crate) fn bind(pass: &mut wgpu::RenderPass<'_>, frame: &FrameBindings, slot: &Slot, draw: &Draw) {
    pass.set_bind_group(0, frame.bind_group(draw.linear_depth), &[]);
    pass.set_bind_group(1, &slot.bindings, &[]);
    pass.set_bind_group(2, &draw.material, &[]);
}

/// Cleared to zero: no normal, no amount.
pub(crate) fn color_attachment(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
    })
}

pub(crate) fn begin_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &'static str,
    color_attachments: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    depth_stencil_attachment: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments,
        depth_stencil_attachment,
        ..Default::default()
    })
}

/// Depth that is tested against, not written.
pub(crate) fn read_only(depth: Option<&wgpu::TextureView>) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
    depth.map(|view| wgpu::RenderPassDepthStencilAttachment { view, depth_ops: None, stencil_ops: None })
}

/// Restricts a pass to the part of the texture that is in use.
pub(crate) fn set_part(pass: &mut wgpu::RenderPass<'_>, size: glam::UVec2) {
    pass.set_viewport(0.0, 0.0, size.x as f32, size.y as f32, 0.0, 1.0);
    pass.set_scissor_rect(0, 0, size.x, size.y);
}
