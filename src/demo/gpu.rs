//! The demo scene on the GPU: colour at two by two samples a pixel, depth at pixel centres, as a depth buffer and linear.

use glam::Vec3;

use super::layout::SceneBox;
use super::scene::{MAX_BOXES, Scene, SceneUniform};
use crate::error::Error;
use crate::formula::depth::SKY_VIEW_DEPTH;
use crate::formula::uniforms::LightUniform;
use crate::frame::{MAX_LIGHTS, View};
use crate::headless::Headless;
use crate::renderer::shader;

pub(crate) const COLOUR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

pub(crate) const LINEAR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Colour and depth of a rendered scene.
#[derive(Debug)]
pub(crate) struct SceneTargets {
    pub colour: wgpu::Texture,
    pub depth: wgpu::Texture,
    /// Linear view depth, on adapters that can draw to `R32Float`.
    pub linear: Option<wgpu::Texture>,
}

/// Renders the scene once.
pub(crate) fn render(gpu: &Headless, scene: &Scene, view: &View) -> Result<SceneTargets, Error> {
    let renderer = SceneRenderer::new(gpu);
    renderer.render(gpu, scene, view)
}

struct SceneRenderer {
    scene_layout: wgpu::BindGroupLayout,
    samples_layout: wgpu::BindGroupLayout,
    boxes: wgpu::RenderPipeline,
    /// Depth, and linear depth as a colour where it can be drawn.
    depth: wgpu::RenderPipeline,
    sky: wgpu::RenderPipeline,
    resolve: wgpu::RenderPipeline,
}

impl SceneRenderer {
    fn new(gpu: &Headless) -> Self {
        let device = &gpu.device;
        let source = shader::compose(include_str!("scene.wgsl")).unwrap_or_default();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("demo scene"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty,
            count: None,
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let samples = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("demo scene"), entries })
        };
        let scene_layout = layout(&[entry(0, uniform), entry(1, uniform), entry(2, uniform)]);
        let samples_layout = layout(&[entry(0, samples)]);
        type Fragment<'a> = Option<(&'a str, wgpu::TextureFormat)>;
        let pipeline = |vertex, fragment: Fragment<'_>, groups: &[Option<&wgpu::BindGroupLayout>], depth: bool| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("demo scene"),
                bind_group_layouts: groups,
                immediate_size: 0,
            });
            let targets = [fragment.map(|(_, format)| format.into())];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("demo scene"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: depth.then(|| wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::LessEqual),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: fragment.map(|(entry_point, _)| wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entry_point),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let linear = gpu.can_draw_to(LINEAR_FORMAT).then_some(("linear_fragment", LINEAR_FORMAT));
        let scene_group = [Some(&scene_layout)];
        Self {
            boxes: pipeline("box_vertex", Some(("box_fragment", COLOUR_FORMAT)), &scene_group, true),
            depth: pipeline("box_vertex", linear, &scene_group, true),
            sky: pipeline("sky_vertex", Some(("sky_fragment", COLOUR_FORMAT)), &scene_group, true),
            resolve: pipeline(
                "sky_vertex",
                Some(("resolve_fragment", COLOUR_FORMAT)),
                &[Some(&scene_layout), Some(&samples_layout)],
                false,
            ),
            scene_layout,
            samples_layout,
        }
    }

    fn render(&self, gpu: &Headless, scene: &Scene, view: &View) -> Result<SceneTargets, Error> {
        let eye = view.view_from_world.inverse().transform_point3(Vec3::ZERO);
        let uniform = scene.uniform(view.clip_from_view * view.view_from_world, eye);
        let mut boxes = [SceneBox::default(); MAX_BOXES];
        boxes[..scene.boxes.len()].copy_from_slice(&scene.boxes);
        let mut lights = [LightUniform::default(); MAX_LIGHTS];
        lights[..scene.lights.len()].copy_from_slice(&scene.lights);
        let buffers = [
            uniform_buffer(gpu, bytemuck::bytes_of::<SceneUniform>(&uniform)),
            uniform_buffer(gpu, bytemuck::cast_slice(&boxes)),
            uniform_buffer(gpu, bytemuck::cast_slice(&lights)),
        ];
        let entries: Vec<_> = (0..)
            .zip(&buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene"),
            layout: &self.scene_layout,
            entries: &entries,
        });

        let twice = view.size * 2;
        let samples = gpu.target("demo scene samples", twice, COLOUR_FORMAT);
        let samples_depth = gpu.target("demo scene samples depth", twice, DEPTH_FORMAT);
        let targets = SceneTargets {
            colour: gpu.target("demo scene colour", view.size, COLOUR_FORMAT),
            depth: gpu.target("demo scene depth", view.size, DEPTH_FORMAT),
            linear: gpu.can_draw_to(LINEAR_FORMAT).then(|| gpu.target("demo scene linear", view.size, LINEAR_FORMAT)),
        };
        let samples_view = samples.create_view(&wgpu::TextureViewDescriptor::default());
        let samples_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene samples"),
            layout: &self.samples_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&samples_view),
            }],
        });

        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let count = scene.boxes.len() as u32;
        {
            let mut pass = begin(&mut encoder, Some(&samples), Some(&samples_depth));
            pass.set_bind_group(0, &group, &[]);
            pass.set_pipeline(&self.boxes);
            pass.draw(0..36, 0..count);
            pass.set_pipeline(&self.sky);
            pass.draw(0..3, 0..1);
        }
        {
            let mut pass = begin(&mut encoder, targets.linear.as_ref(), Some(&targets.depth));
            pass.set_bind_group(0, &group, &[]);
            pass.set_pipeline(&self.depth);
            pass.draw(0..36, 0..count);
        }
        {
            let mut pass = begin(&mut encoder, Some(&targets.colour), None);
            pass.set_bind_group(0, &group, &[]);
            pass.set_bind_group(1, &samples_group, &[]);
            pass.set_pipeline(&self.resolve);
            pass.draw(0..3, 0..1);
        }
        gpu.submit(encoder)?;
        Ok(targets)
    }
}

fn uniform_buffer(gpu: &Headless, bytes: &[u8]) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("demo scene"),
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}

fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    colour: Option<&wgpu::Texture>,
    depth: Option<&wgpu::Texture>,
) -> wgpu::RenderPass<'a> {
    let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let (colour, depth) = (colour.map(view), depth.map(view));
    // Black, or as far away as the sky.
    let is_linear = colour.as_ref().is_some_and(|view| view.texture().format() == LINEAR_FORMAT);
    let clear = wgpu::Color { r: if is_linear { f64::from(SKY_VIEW_DEPTH) } else { 0.0 }, ..wgpu::Color::BLACK };
    let attachment = colour.as_ref().map(|view| wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("demo scene"),
        color_attachments: if attachment.is_some() { std::slice::from_ref(&attachment) } else { &[] },
        depth_stencil_attachment: depth.as_ref().map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
