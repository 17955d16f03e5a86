//! GPU renderer of the demo scene. Three passes: paint (reflectance at 2x2 samples per pixel), depth (depth buffer and
//! linear view depth at pixel centres), and light. With shadow of smoke, light keeps that of up to three lights apart, and
//! a fourth pass, shade, adds what of it comes through the smoke.

use bytemuck::Zeroable as _;
use glam::UVec2;

use super::boxes::{MAX_BOXES, SceneBox};
use super::occluders::Occluders;
use super::scene::{Scene, SceneUniform};
use super::shadow_views::{ShadowView, casters};
use haze::formula::depth::SKY_VIEW_DEPTH;
use haze::formula::uniforms::LightUniform;
use haze::frame::{MAX_LIGHTS, View};
use haze::shader;
use wgpu::util::DeviceExt as _;

pub(crate) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

pub(crate) const LINEAR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Pipelines of the scene, shared by all [`OffscreenRenderer`](super::offscreen_renderer::OffscreenRenderer)s of a
/// device.
#[derive(Debug)]
pub(crate) struct SceneRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    scene_layout: wgpu::BindGroupLayout,
    paint_layout: wgpu::BindGroupLayout,
    /// Writes reflectance and face at 2x2 samples per pixel.
    paint: wgpu::RenderPipeline,
    /// Writes the depth buffer, and linear depth if `R32Float` is renderable.
    depth: wgpu::RenderPipeline,
    parts_layout: wgpu::BindGroupLayout,
    /// Lights the paint.
    light: wgpu::RenderPipeline,
    /// Lights the paint, with up to three lights apart.
    light_parts: wgpu::RenderPipeline,
    /// Adds up the parts.
    shade: wgpu::RenderPipeline,
    /// Writes depth alone, as a light sees it.
    shadow: wgpu::RenderPipeline,
    pub draws_linear: bool,
}

/// Targets and buffers of a scene at one size.
#[derive(Debug)]
pub(crate) struct SceneTargets {
    pub color: wgpu::Texture,
    pub depth: wgpu::TextureView,
    /// Linear view depth, if the adapter can render to `R32Float`.
    pub linear: Option<wgpu::TextureView>,
    /// Reflectance and face at 2x2 samples per pixel.
    paint: wgpu::TextureView,
    paint_depth: wgpu::TextureView,
    paint_group: wgpu::BindGroup,
    /// With shadow of smoke: light of all other lights, and of those with shadow.
    parts: Option<LightParts>,
    /// Of the scene that was recorded last.
    scene_group: Option<wgpu::BindGroup>,
    /// Uniform buffers of scene, boxes and lights.
    buffers: [wgpu::Buffer; 3],
}

#[derive(Debug)]
struct LightParts {
    views: [wgpu::TextureView; 4],
    group: wgpu::BindGroup,
}

impl SceneTargets {
    pub fn textures(&self) -> impl Iterator<Item = &wgpu::Texture> {
        let parts = self.parts.iter().flat_map(|parts| &parts.views);
        let views = [&self.depth, &self.paint, &self.paint_depth].into_iter().chain(&self.linear).chain(parts);
        std::iter::once(&self.color).chain(views.map(wgpu::TextureView::texture))
    }
}

impl SceneRenderer {
    /// Compiles the pipelines. `draws_linear`: the adapter can render to `R32Float`.
    /// `shadow_layout`: that of the smoke's shadow.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        draws_linear: bool,
        shadow_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let source = shader::compose(concat!(include_str!("scene_materials.wgsl"), include_str!("scene.wgsl")))
            .unwrap_or_default();
        let source = source + &shader::scene_shadow_wgsl(2);
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
        let texture = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("demo scene"), entries })
        };
        let masks = texture(wgpu::TextureSampleType::Uint);
        let scene_layout = layout(&[entry(0, uniform), entry(1, uniform), entry(2, uniform), entry(3, masks)]);
        let paint_layout = layout(&[entry(0, texture(wgpu::TextureSampleType::Float { filterable: false }))]);
        let unfilterable = texture(wgpu::TextureSampleType::Float { filterable: false });
        let parts_layout = layout(&[1, 2, 3, 4, 5].map(|binding| entry(binding, unfilterable)));
        let pipeline = |vertex, fragment, groups: &[_], depth| {
            let fragment: Option<(&str, &[_])> = fragment;
            scene_pipeline(&module, device, groups, vertex, fragment, depth)
        };
        let color = [COLOR_FORMAT; 4];
        let linear = draws_linear.then_some(("linear_fragment", &[LINEAR_FORMAT][..]));
        let scene_group = [Some(&scene_layout)];
        let paint_groups = [Some(&scene_layout), Some(&paint_layout)];
        let shade_groups = [Some(&scene_layout), Some(&parts_layout), Some(shadow_layout)];
        Self {
            paint: pipeline("box_vertex", Some(("paint_fragment", &color[..1])), &scene_group, true),
            depth: pipeline("box_vertex", linear, &scene_group, true),
            light: pipeline("fullscreen_vertex", Some(("light_fragment", &color[..1])), &paint_groups, false),
            light_parts: pipeline("fullscreen_vertex", Some(("light_parts_fragment", &color)), &paint_groups, false),
            shade: pipeline("fullscreen_vertex", Some(("shade_fragment", &color[..1])), &shade_groups, false),
            shadow: pipeline("box_vertex", None, &scene_group, true),
            parts_layout,
            scene_layout,
            paint_layout,
            draws_linear,
            device: device.clone(),
            queue: queue.clone(),
        }
    }

    /// Creates targets of a size in pixels.
    pub fn targets(&self, size: UVec2) -> SceneTargets {
        let texture = |label, size, format| texture(&self.device, label, size, format);
        let target = |label, size, format| default_view(&texture(label, size, format));
        let paint = target("demo scene paint", size * 2, COLOR_FORMAT);
        let buffer = |size| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("demo scene"),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let (boxes, lights) = (size_of::<[SceneBox; MAX_BOXES]>(), size_of::<[LightUniform; MAX_LIGHTS]>());
        SceneTargets {
            color: texture("demo scene color", size, COLOR_FORMAT),
            depth: target("demo scene depth", size, DEPTH_FORMAT),
            linear: self.draws_linear.then(|| target("demo scene linear", size, LINEAR_FORMAT)),
            paint_depth: target("demo scene paint depth", size * 2, DEPTH_FORMAT),
            paint_group: self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("demo scene paint"),
                layout: &self.paint_layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&paint) }],
            }),
            paint,
            parts: None,
            scene_group: None,
            buffers: [size_of::<SceneUniform>(), boxes, lights].map(buffer),
        }
    }

    /// Records all passes of a scene but shade. At most once per targets and submission, since the uniforms are written by
    /// the queue. `apart`: indices of at most three lights that smoke shades; with any, [`shade`](Self::shade) completes
    /// the scene.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &mut SceneTargets,
        scene: &Scene,
        view: &View,
        apart: &[usize],
    ) {
        let uniform = scene.uniform(view, apart);
        let mut boxes = [SceneBox::default(); MAX_BOXES];
        boxes[..scene.boxes.len()].copy_from_slice(&scene.boxes);
        let mut lights = [LightUniform::default(); MAX_LIGHTS];
        lights[..scene.lights.len()].copy_from_slice(&scene.lights);
        let contents: [&[u8]; 3] =
            [bytemuck::bytes_of(&uniform), bytemuck::cast_slice(&boxes), bytemuck::cast_slice(&lights)];
        for (buffer, bytes) in targets.buffers.iter().zip(contents) {
            self.queue.write_buffer(buffer, 0, bytes);
        }
        let occluders = default_view(&self.occluder_texture(&scene.occluders));
        let buffer = |binding: usize| wgpu::BindGroupEntry {
            binding: binding as u32,
            resource: targets.buffers[binding].as_entire_binding(),
        };
        let masks = wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::TextureView(&occluders) };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene"),
            layout: &self.scene_layout,
            entries: &[buffer(0), buffer(1), buffer(2), masks],
        });
        let count = scene.boxes.len() as u32;
        {
            let mut pass = begin_pass(encoder, &[&targets.paint], NO_BOX, Some(&targets.paint_depth));
            pass.set_bind_group(0, &group, &[]);
            pass.set_pipeline(&self.paint);
            pass.draw(0..36, 0..count);
        }
        {
            let mut pass = begin_pass(encoder, targets.linear.as_ref().as_slice(), NO_SURFACE, Some(&targets.depth));
            pass.set_bind_group(0, &group, &[]);
            pass.set_pipeline(&self.depth);
            pass.draw(0..36, 0..count);
        }
        targets.parts = match targets.parts.take() {
            _ if apart.is_empty() => None,
            held => Some(held.unwrap_or_else(|| self.light_parts(targets))),
        };
        {
            let color = default_view(&targets.color);
            let (views, pipeline) = match &targets.parts {
                Some(parts) => (parts.views.each_ref().to_vec(), &self.light_parts),
                None => (vec![&color], &self.light),
            };
            let mut pass = begin_pass(encoder, &views, wgpu::Color::BLACK, None);
            pass.set_bind_group(0, &group, &[]);
            pass.set_bind_group(1, &targets.paint_group, &[]);
            pass.set_pipeline(pipeline);
            pass.draw(0..3, 0..1);
        }
        targets.scene_group = Some(group);
    }

    /// Adds the light that comes through the smoke to the scene that was recorded last. Does nothing if no light was kept
    /// apart.
    pub fn shade(&self, encoder: &mut wgpu::CommandEncoder, targets: &SceneTargets, shadow: &wgpu::BindGroup) {
        let Some((parts, group)) = targets.parts.as_ref().zip(targets.scene_group.as_ref()) else { return };
        let mut pass = begin_pass(encoder, &[&default_view(&targets.color)], wgpu::Color::BLACK, None);
        pass.set_bind_group(0, group, &[]);
        pass.set_bind_group(1, &parts.group, &[]);
        pass.set_bind_group(2, shadow, &[]);
        pass.set_pipeline(&self.shade);
        pass.draw(0..3, 0..1);
    }

    /// Draws the scene as a light sees it, a layer per matrix.
    pub fn shadow_map(&self, encoder: &mut wgpu::CommandEncoder, scene: &Scene, view: &ShadowView) -> wgpu::Texture {
        let mut boxes = [SceneBox::default(); MAX_BOXES];
        let mut count = 0;
        for (slot, caster) in boxes.iter_mut().zip(casters(&scene.boxes)) {
            (*slot, count) = (caster, count + 1);
        }
        let buffer = |contents: &[u8]| {
            let usage = wgpu::BufferUsages::UNIFORM;
            let descriptor = wgpu::util::BufferInitDescriptor { label: Some("demo shadow map"), contents, usage };
            self.device.create_buffer_init(&descriptor)
        };
        let boxes = buffer(bytemuck::cast_slice(&boxes));
        let lights = buffer(bytemuck::cast_slice(&[LightUniform::default(); MAX_LIGHTS]));
        let masks = default_view(&self.occluder_texture(&scene.occluders));
        // OpenGL takes a texture of one layer for one without layers, and six for the faces of a cube.
        let layers = view.clip_from_world.len() as u32 + 1;
        let map = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("demo shadow map"),
            size: wgpu::Extent3d { width: view.size, height: view.size, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        for (layer, matrix) in (0..).zip(&view.clip_from_world) {
            let uniform = SceneUniform { clip_from_world: *matrix, box_count: count, ..SceneUniform::zeroed() };
            let uniform = buffer(bytemuck::bytes_of(&uniform));
            let bound = [&uniform, &boxes, &lights].map(wgpu::Buffer::as_entire_binding).into_iter();
            let resources = bound.chain([wgpu::BindingResource::TextureView(&masks)]);
            let entries: Vec<_> =
                (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
            let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("demo shadow map"),
                layout: &self.scene_layout,
                entries: &entries,
            });
            let of_layer = map.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            });
            let mut pass = begin_pass(encoder, &[], wgpu::Color::BLACK, Some(&of_layer));
            pass.set_bind_group(0, &group, &[]);
            pass.set_pipeline(&self.shadow);
            pass.draw(0..36, 0..count);
        }
        map
    }

    fn light_parts(&self, targets: &SceneTargets) -> LightParts {
        let size = UVec2::new(targets.color.width(), targets.color.height());
        let view = |()| default_view(&texture(&self.device, "demo scene light", size, COLOR_FORMAT));
        let views = [(); 4].map(view);
        let bound = (1..).zip(views.iter().chain([&targets.depth]));
        let entry =
            |(binding, view)| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene light"),
            layout: &self.parts_layout,
            entries: &bound.map(entry).collect::<Vec<_>>(),
        });
        LightParts { views, group }
    }

    fn occluder_texture(&self, occluders: &Occluders) -> wgpu::Texture {
        let masks = &occluders.masks;
        let size = wgpu::Extent3d { width: masks.size.x, height: masks.size.y, depth_or_array_layers: 1 };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("demo scene occluders"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let rows =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * size.width), rows_per_image: None };
        self.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&masks.texels), rows, size);
        texture
    }
}

/// Creates a pipeline from entry points of the scene's shader. `fragment` is an entry point with the formats it writes;
/// `depth`: tests and writes the depth buffer.
fn scene_pipeline(
    module: &wgpu::ShaderModule,
    device: &wgpu::Device,
    groups: &[Option<&wgpu::BindGroupLayout>],
    vertex: &str,
    fragment: Option<(&str, &[wgpu::TextureFormat])>,
    depth: bool,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("demo scene"),
        bind_group_layouts: groups,
        immediate_size: 0,
    });
    let targets: Vec<_> =
        fragment.iter().flat_map(|(_, formats)| *formats).map(|&format| Some(format.into())).collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("demo scene"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
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
            module,
            entry_point: Some(entry_point),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Creates a texture that can be rendered to, sampled and copied.
pub(crate) fn texture(device: &wgpu::Device, label: &str, size: UVec2, format: wgpu::TextureFormat) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC
            | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

pub(crate) fn default_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Clear value of paint. `NO_BOX` in scene.wgsl.
const NO_BOX: wgpu::Color = wgpu::Color { a: -1.0, ..wgpu::Color::TRANSPARENT };
/// Clear value of linear depth.
const NO_SURFACE: wgpu::Color = wgpu::Color { r: SKY_VIEW_DEPTH as f64, ..wgpu::Color::BLACK };

fn begin_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    colors: &[&wgpu::TextureView],
    clear: wgpu::Color,
    depth: Option<&wgpu::TextureView>,
) -> wgpu::RenderPass<'a> {
    let attachment = |view| {
        Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
        })
    };
    let attachments: Vec<_> = colors.iter().copied().map(attachment).collect();
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("demo scene"),
        color_attachments: &attachments,
        depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
