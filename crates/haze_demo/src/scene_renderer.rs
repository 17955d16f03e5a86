//! GPU renderer of the demo scene, or of a scene from a file. Three passes: paint (reflectance at 2x2 samples per pixel), depth
//! (depth buffer and linear view depth), and light. With shadow of smoke, light writes up to three lights to textures of their own,
//! and a fourth pass, shade, adds them, dimmed by the smoke. At outlines, all passes after paint show the surfaces behind;
//! light and shade have a second turn for the objects in front, which `outline_pass.rs` adds when the smoke is drawn.

use std::ops::Range;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError, Weak};

use bytemuck::Zeroable as _;
use glam::UVec2;
use haze_core::formula::uniforms::LightUniform;
use haze_core::frame::{MAX_LIGHTS, View};

use super::boxes::{MAX_BOXES, SceneBox};
use super::mesh_renderer::MeshPipelines;
use super::occluders::Occluders;
use super::scene::{Scene, SceneUniform};
use super::scene_pipeline::{
    COLOR_FORMAT, DEPTH_FORMAT, LIGHT, LIGHT_PARTS, LINEAR_FORMAT, ScenePipeline, default_view, texture,
    texture_entries,
};
use super::shadow_views::{ShadowView, casters};
use super::uploaded_backdrop::UploadedBackdrop;
use haze::shader;
use haze_author::backdrop::Backdrop;
use wgpu::util::DeviceExt as _;

/// Formats of the color targets of a pass. Most passes have one.
const COLOR: [wgpu::TextureFormat; 4] = [COLOR_FORMAT; 4];

/// Compiled on first use: a scene draws half of the pipelines.
type LazyPipeline = LazyLock<wgpu::RenderPipeline, Box<dyn FnOnce() -> wgpu::RenderPipeline + Send>>;

/// Pipelines of the scene, shared by all [`OffscreenRenderer`](super::offscreen_renderer::OffscreenRenderer)s of a
/// device.
#[derive(Debug)]
pub(crate) struct SceneRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Layout of group 0.
    pub scene_layout: wgpu::BindGroupLayout,
    paint_layout: wgpu::BindGroupLayout,
    /// Writes reflectance and face at 2x2 samples per pixel.
    paint: LazyPipeline,
    /// Writes the depth buffer, and linear depth if `R32Float` is renderable.
    depth: LazyPipeline,
    parts_layout: wgpu::BindGroupLayout,
    /// Lights the paint of a layer.
    light: LazyPipeline,
    /// Lights the paint of a layer, with up to three lights apart.
    light_parts: LazyPipeline,
    /// Adds up the parts of a layer.
    shade: LazyPipeline,
    /// Writes depth alone, as a light sees it.
    shadow: LazyPipeline,
    sky_sampler: wgpu::Sampler,
    mesh: OnceLock<Arc<MeshPipelines>>,
    /// Backdrops that existing renderers have uploaded.
    backdrops: Mutex<Vec<Weak<UploadedBackdrop>>>,
    pub draws_linear: bool,
}

/// Targets and buffers of a scene at one size. Layers are the surfaces behind outlines, and the objects in front.
#[derive(Debug)]
pub(crate) struct SceneTargets {
    /// Surfaces behind outlines. Alpha is 0: that of smoke is added to it.
    pub color: wgpu::Texture,
    /// Objects in front at outlines, with their fraction of the pixel in alpha.
    pub front: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    /// Linear view depth, if the adapter can render to `R32Float`.
    pub linear: Option<wgpu::TextureView>,
    /// Reflectance and face at 2x2 samples per pixel.
    paint: wgpu::TextureView,
    pub paint_depth: wgpu::TextureView,
    paint_group: wgpu::BindGroup,
    /// Normals at 2x2 samples per pixel, and the group of all samples, if the scene is a mesh.
    mesh_samples: Option<(wgpu::TextureView, wgpu::BindGroup)>,
    /// With shadow of smoke: light of all other lights, and of those with shadow, for each layer.
    parts: Option<[LightParts; 2]>,
    /// Of the scene that was recorded last.
    pub scene_group: Option<wgpu::BindGroup>,
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
        let parts = self.parts.iter().flatten().flat_map(|parts| &parts.views);
        let normals = self.mesh_samples.iter().map(|(normals, _)| normals);
        let views = [&self.front, &self.depth, &self.paint, &self.paint_depth].into_iter();
        let views = views.chain(&self.linear).chain(parts);
        let views = views.chain(normals);
        std::iter::once(&self.color).chain(views.map(wgpu::TextureView::texture))
    }
}

impl SceneRenderer {
    /// Creates the shader. `draws_linear`: the adapter can render to `R32Float`.
    /// `shadow_layout`: that of the smoke's shadow.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        draws_linear: bool,
        shadow_layout: &wgpu::BindGroupLayout,
    ) -> Self {
        let source = shader::compose(concat!(
            include_str!("scene_materials.wgsl"),
            include_str!("scene.wgsl"),
            include_str!("scene_samples.wgsl"),
            include_str!("scene_light.wgsl"),
            include_str!("scene_boxes.wgsl"),
            include_str!("scene_shade.wgsl")
        ));
        let source = source.unwrap_or_default() + &shader::scene_shadow_wgsl(2);
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
        let filterable = texture(wgpu::TextureSampleType::Float { filterable: true });
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let buffers = [entry(0, uniform), entry(1, uniform), entry(2, uniform)];
        let scene_layout =
            layout(&[&buffers[..], &[entry(3, masks), entry(4, filterable), entry(5, sampler)]].concat());
        let unfilterable = texture(wgpu::TextureSampleType::Float { filterable: false });
        let paint_layout = layout(&[0, 7].map(|binding| entry(binding, unfilterable)));
        let parts_layout = layout(&[1, 2, 3, 4, 7].map(|binding| entry(binding, unfilterable)));
        let pipeline =
            |vertex, fragment: Option<(&'static str, &'static [wgpu::TextureFormat])>, groups: &[_], depth| {
                let device = device.clone();
                let module = module.clone();
                let groups: Vec<wgpu::BindGroupLayout> = groups.iter().copied().cloned().collect();
                let create = move || {
                    let groups: Vec<_> = groups.iter().map(Some).collect();
                    ScenePipeline { groups: &groups, vertex, buffers: &[], fragment, depth, blend: None }
                        .create(&device, &module)
                };
                LazyPipeline::new(Box::new(create))
            };
        let depth = if draws_linear { ("linear_fragment", &[LINEAR_FORMAT][..]) } else { ("depth_fragment", &[][..]) };
        let scene_group = [&scene_layout];
        let paint_groups = [&scene_layout, &paint_layout];
        let shade_groups = [&scene_layout, &parts_layout, shadow_layout];
        let of_layer =
            |fragment, colors, groups: &[_]| pipeline("layer_vertex", Some((fragment, colors)), groups, false);
        Self {
            paint: pipeline("box_vertex", Some(("paint_fragment", &COLOR[..1])), &scene_group, true),
            depth: pipeline("fullscreen_vertex", Some(depth), &paint_groups, true),
            light: of_layer(LIGHT, &COLOR[..1], &paint_groups),
            light_parts: of_layer(LIGHT_PARTS, &COLOR, &paint_groups),
            shade: of_layer("shade_fragment", &COLOR[..1], &shade_groups),
            shadow: pipeline("box_vertex", None, &scene_group, true),
            parts_layout,
            scene_layout,
            paint_layout,
            sky_sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("demo scene sky"),
                address_mode_u: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            mesh: OnceLock::new(),
            backdrops: Mutex::default(),
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
        let paint_depth = target("demo scene paint depth", size * 2, DEPTH_FORMAT);
        let buffer = |size| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("demo scene"),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let boxes = size_of::<[SceneBox; MAX_BOXES]>();
        let lights = size_of::<[LightUniform; MAX_LIGHTS]>();
        SceneTargets {
            color: texture("demo scene color", size, COLOR_FORMAT),
            front: target("demo scene front", size, COLOR_FORMAT),
            depth: target("demo scene depth", size, DEPTH_FORMAT),
            linear: self.draws_linear.then(|| target("demo scene linear", size, LINEAR_FORMAT)),
            paint_group: self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("demo scene paint"),
                layout: &self.paint_layout,
                entries: &texture_entries([(0, &paint), (7, &paint_depth)]),
            }),
            paint,
            paint_depth,
            mesh_samples: None,
            parts: None,
            scene_group: None,
            buffers: [size_of::<SceneUniform>(), boxes, lights].map(buffer),
        }
    }

    /// Records all passes of a scene but shade. At most once per targets and submission, since the uniforms are written by
    /// the queue. `apart`: indices of at most three lights that smoke shades; with any, [`shade`](Self::shade) completes
    /// the scene. `backdrop`: that of the scene, uploaded.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &mut SceneTargets,
        scene: &Scene,
        view: &View,
        apart: &[usize],
        backdrop: &UploadedBackdrop,
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
        let [scene_buffer, boxes, lights] = &targets.buffers;
        let group = self.scene_group([scene_buffer, boxes, lights], &occluders, &backdrop.sky);
        let mesh = backdrop.mesh.as_ref();
        targets.mesh_samples = match (mesh, targets.mesh_samples.take()) {
            (Some((pipelines, _)), None) => Some(self.mesh_samples(pipelines, targets)),
            (Some(_), held) => held,
            (None, _) => None,
        };
        let count = scene.boxes.len() as u32;
        {
            let normals = targets.mesh_samples.as_ref().map(|(normals, _)| normals);
            let views: Vec<_> = std::iter::once(&targets.paint).chain(normals).collect();
            let mut pass = begin_pass(encoder, &views, NO_BOX, Some(&targets.paint_depth));
            pass.set_bind_group(0, &group, &[]);
            if let Some((pipelines, mesh)) = mesh {
                pass.set_pipeline(&pipelines.paint);
                mesh.draw(&mut pass);
            } else {
                pass.set_pipeline(&self.paint);
                pass.draw(0..36, 0..count);
            }
        }
        {
            let linear = targets.linear.as_ref();
            let mut pass = begin_pass(encoder, linear.as_slice(), wgpu::Color::TRANSPARENT, Some(&targets.depth));
            pass.set_bind_group(0, &group, &[]);
            pass.set_bind_group(1, &targets.paint_group, &[]);
            pass.set_pipeline(&self.depth);
            pass.draw(0..3, 0..1);
        }
        targets.parts = match targets.parts.take() {
            _ if apart.is_empty() => None,
            held => Some(held.unwrap_or_else(|| [(); 2].map(|()| self.light_parts(targets)))),
        };
        let colors = [default_view(&targets.color), targets.front.clone()];
        for layer in 0..2 {
            let pipeline = match (mesh, &targets.parts) {
                (Some((pipelines, _)), Some(_)) => &pipelines.light_parts,
                (Some((pipelines, _)), None) => &pipelines.light,
                (None, Some(_)) => &self.light_parts,
                (None, None) => &self.light,
            };
            let views = match &targets.parts {
                Some(parts) => parts[layer].views.each_ref().to_vec(),
                None => vec![&colors[layer]],
            };
            let mut pass = begin_pass(encoder, &views, wgpu::Color::TRANSPARENT, None);
            pass.set_bind_group(0, &group, &[]);
            if let Some(((_, samples), (_, mesh))) = targets.mesh_samples.as_ref().zip(mesh) {
                pass.set_bind_group(1, samples, &[]);
                pass.set_bind_group(2, mesh.hierarchy(), &[]);
            } else {
                pass.set_bind_group(1, &targets.paint_group, &[]);
            }
            pass.set_pipeline(pipeline);
            pass.draw(layer_vertices(layer), 0..1);
        }
        targets.scene_group = Some(group);
    }

    /// Adds the light that comes through the smoke to the scene that was recorded last. Does nothing if no light was kept
    /// apart.
    pub fn shade(&self, encoder: &mut wgpu::CommandEncoder, targets: &SceneTargets, shadow: &wgpu::BindGroup) {
        let Some((parts, group)) = targets.parts.as_ref().zip(targets.scene_group.as_ref()) else { return };
        let colors = [&default_view(&targets.color), &targets.front];
        for (layer, (color, parts)) in colors.into_iter().zip(parts).enumerate() {
            let mut pass = begin_pass(encoder, &[color], wgpu::Color::TRANSPARENT, None);
            pass.set_bind_group(0, group, &[]);
            pass.set_bind_group(1, &parts.group, &[]);
            pass.set_bind_group(2, shadow, &[]);
            pass.set_pipeline(&self.shade);
            pass.draw(layer_vertices(layer), 0..1);
        }
    }

    /// Draws the scene as a light sees it, a layer per matrix.
    pub fn shadow_map(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        view: &ShadowView,
        backdrop: &UploadedBackdrop,
    ) -> wgpu::Texture {
        let mut boxes = [SceneBox::default(); MAX_BOXES];
        let mut count = 0;
        for (slot, caster) in boxes.iter_mut().zip(casters(&scene.boxes)) {
            *slot = caster;
            count += 1;
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
            let mesh_scale = scene.environment.scene_scale;
            let uniform =
                SceneUniform { clip_from_world: *matrix, box_count: count, mesh_scale, ..SceneUniform::zeroed() };
            let uniform = buffer(bytemuck::bytes_of(&uniform));
            let group = self.scene_group([&uniform, &boxes, &lights], &masks, &backdrop.sky);
            let of_layer = map.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            });
            let mut pass = begin_pass(encoder, &[], wgpu::Color::BLACK, Some(&of_layer));
            pass.set_bind_group(0, &group, &[]);
            if let Some((pipelines, mesh)) = &backdrop.mesh {
                pass.set_pipeline(&pipelines.shadow);
                mesh.draw(&mut pass);
            } else {
                pass.set_pipeline(&self.shadow);
                pass.draw(0..36, 0..count);
            }
        }
        map
    }

    /// Uploads a backdrop, or returns what another renderer of the device has uploaded of it.
    pub fn uploaded(&self, backdrop: &Backdrop) -> Arc<UploadedBackdrop> {
        let mut backdrops = self.backdrops.lock().unwrap_or_else(PoisonError::into_inner);
        backdrops.retain(|uploaded| uploaded.strong_count() > 0);
        if let Some(uploaded) = backdrops.iter().filter_map(Weak::upgrade).find(|one| one.backdrop == *backdrop) {
            return uploaded;
        }
        let pipelines = || {
            let compile = || Arc::new(MeshPipelines::new(&self.device, &self.scene_layout));
            self.mesh.get_or_init(compile).clone()
        };
        let uploaded = Arc::new(UploadedBackdrop::new(&self.device, &self.queue, backdrop, pipelines));
        backdrops.push(Arc::downgrade(&uploaded));
        uploaded
    }

    /// Group 0. `buffers`: scene, boxes, lights.
    fn scene_group(
        &self,
        buffers: [&wgpu::Buffer; 3],
        masks: &wgpu::TextureView,
        sky: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        let resources = buffers.map(wgpu::Buffer::as_entire_binding).into_iter().chain([
            wgpu::BindingResource::TextureView(masks),
            wgpu::BindingResource::TextureView(sky),
            wgpu::BindingResource::Sampler(&self.sky_sampler),
        ]);
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene"),
            layout: &self.scene_layout,
            entries: &entries,
        })
    }

    fn mesh_samples(&self, pipelines: &MeshPipelines, targets: &SceneTargets) -> (wgpu::TextureView, wgpu::BindGroup) {
        let size = UVec2::new(targets.color.width(), targets.color.height());
        let normals = default_view(&texture(&self.device, "demo scene normals", size * 2, COLOR_FORMAT));
        let group = pipelines.samples(&self.device, [&targets.paint, &normals, &targets.paint_depth]);
        (normals, group)
    }

    fn light_parts(&self, targets: &SceneTargets) -> LightParts {
        let size = UVec2::new(targets.color.width(), targets.color.height());
        let view = |()| default_view(&texture(&self.device, "demo scene light", size, COLOR_FORMAT));
        let views = [(); 4].map(view);
        let [rest, first, second, third] = &views;
        let bound = [(1, rest), (2, first), (3, second), (4, third), (7, &targets.paint_depth)];
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("demo scene light"),
            layout: &self.parts_layout,
            entries: &texture_entries(bound),
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

/// Clear value of paint. `NO_BOX` in scene.wgsl.
const NO_BOX: wgpu::Color = wgpu::Color { a: -1.0, ..wgpu::Color::TRANSPARENT };

/// Vertices of the triangle of a layer, for `layer_vertex` in scene_samples.wgsl.
fn layer_vertices(layer: usize) -> Range<u32> {
    let first = 3 * layer as u32;
    first..first + 3
}

pub(crate) fn begin_pass<'a>(
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
