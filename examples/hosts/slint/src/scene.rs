//! A host's scene: a floor and two boxes under a lamp, with a depth buffer.

use haze::glam::{UVec2, Vec3, Vec4, vec3};
use haze::{Light, View, wgpu};

/// Slint reads encoded values; the scene and haze write through a view that encodes.
const SHOWN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Centers and sizes.
const BOXES: [(Vec3, Vec3); 3] = [
    (vec3(0.0, -0.1, 0.0), vec3(14.0, 0.2, 14.0)),
    (vec3(1.2, 0.6, 0.6), vec3(0.9, 1.2, 0.9)),
    (vec3(-1.3, 0.4, -0.8), vec3(1.2, 0.8, 0.8)),
];

const SHADER: &str = "
    struct Scene { clip_from_world: mat4x4f, lamp: vec4f, light: vec4f, boxes: array<array<vec4f, 2>, 3> }
    @group(0) @binding(0) var<uniform> scene: Scene;
    struct Vertex { @builtin(position) clip: vec4f, @location(0) world: vec3f }
    // Corners of the 12 triangles of a cube, by the bits of their number.
    const CORNERS = array(0, 1, 3, 0, 3, 2, 4, 7, 5, 4, 6, 7, 0, 5, 1, 0, 4, 5, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3);
    @vertex fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Vertex {
        let corner = CORNERS[index];
        let sign = vec3f(vec3i(corner & 1, (corner >> 1) & 1, corner >> 2)) - 0.5;
        let shape = scene.boxes[instance];
        let world = shape[0].xyz + sign * shape[1].xyz;
        return Vertex(scene.clip_from_world * vec4f(world, 1.0), world);
    }
    @fragment fn fragment(vertex: Vertex) -> @location(0) vec4f {
        let normal = normalize(cross(dpdy(vertex.world), dpdx(vertex.world)));
        let to_lamp = scene.lamp.xyz - vertex.world;
        let falloff = max(dot(normal, normalize(to_lamp)), 0.0) / max(dot(to_lamp, to_lamp), 0.1);
        return vec4f(vec3f(0.3, 0.32, 0.35) * (scene.light.rgb * falloff + 0.03), 1.0);
    }
";

pub struct Scene {
    pipeline: wgpu::RenderPipeline,
    uniforms: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    targets: Option<Targets>,
}

/// Textures of the window's size.
#[derive(Clone)]
pub struct Targets {
    pub color: wgpu::Texture,
    color_view: wgpu::TextureView,
    pub depth: wgpu::TextureView,
}

impl Scene {
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("scene"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("scene"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(COLOR.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("scene"),
            size: 192,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniforms.as_entire_binding() }],
        });
        Self { pipeline, uniforms, bindings, targets: None }
    }

    /// Draws the scene into targets of the view's size.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
        lamp: &Light,
    ) -> Targets {
        let rows = (view.clip_from_view * view.view_from_world).to_cols_array();
        let lit = [lamp.position.extend(0.0), (lamp.color * lamp.intensity).extend(0.0)];
        let boxes = BOXES.iter().flat_map(|(center, size)| [center.extend(0.0), size.extend(0.0)]);
        let numbers = rows.into_iter().chain(lit.into_iter().chain(boxes).flat_map(|row: Vec4| row.to_array()));
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        queue.write_buffer(&self.uniforms, 0, &bytes);
        let targets = self.targets.take().filter(|targets| targets.size() == view.size);
        let targets = targets.unwrap_or_else(|| Targets::new(device, view.size));
        let mut pass = targets.pass(encoder, Some(wgpu::Color { r: 0.02, g: 0.03, b: 0.05, a: 1.0 }));
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bindings, &[]);
        pass.draw(0..36, 0..BOXES.len() as u32);
        drop(pass);
        self.targets.insert(targets).clone()
    }
}

impl Targets {
    fn new(device: &wgpu::Device, size: UVec2) -> Self {
        let texture = |format, view_formats| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("scene"),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats,
            })
        };
        let color = texture(SHOWN, &[COLOR]);
        let color_view = color.create_view(&wgpu::TextureViewDescriptor { format: Some(COLOR), ..Default::default() });
        Self { color_view, color, depth: texture(DEPTH, &[]).create_view(&Default::default()) }
    }

    fn size(&self) -> UVec2 {
        UVec2::new(self.color.width(), self.color.height())
    }

    /// Pass on color and depth: cleared if a color is given, otherwise over what is there, with a depth that is only read.
    pub fn pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder, clear: Option<wgpu::Color>) -> wgpu::RenderPass<'a> {
        let load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
        let store = wgpu::StoreOp::Store;
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.color_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: clear.map(|_| wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }
}
