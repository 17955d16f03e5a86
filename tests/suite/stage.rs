//! A small host: a camera, a wall and a post as scene depth, some sprites; drawn by the GPU renderer or the reference.

use glam::camera::rh;
use glam::{Mat4, UVec2, UVec3, Vec2, Vec3, Vec4, vec3};
use haze::headless::Headless;
use haze::noise::{NoiseRecipe, NoiseVolume};
use haze::noise::{pcg3d, unit};
use haze::picture::Picture;
use haze::ramp::Ramp;
use haze::reference;
use haze::settings::{Settings, ShadeTree};
use haze::sprite::{Sprite, SpriteLayout};
use haze::{Bounds, Descriptor, Frame, Light, MaterialAssets, Particle, Particles, Renderer, SceneDepth, System, View};
use haze::{Error, wgpu};

use crate::common::gpu;

/// Everything a frame needs, in memory.
pub struct Stage {
    pub view: View,
    pub lights: Vec<Light>,
    pub particles: Vec<Particle>,
    pub bounds: Option<Bounds>,
    pub settings: Settings,
    pub material: MaterialAssets,
    pub time: f32,
    pub shade_tree: ShadeTree,
    /// Which kind of scene depth is handed over.
    pub depth: DepthKind,
    /// The wall goes on to the right.
    pub wall_everywhere: bool,
    /// The linear target says that nothing is there.
    pub empty_linear: bool,
    /// Attach the depth buffer to the pass that the smoke is drawn in.
    pub attach_depth: bool,
}

/// What a host hands over as the scene's depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthKind {
    Buffer,
    Linear,
    Both,
}

/// What a run on the GPU leaves.
pub struct Drawn {
    pub picture: Picture<Vec4>,
    pub renderer: Renderer,
}

/// The scene behind the smoke: a colour that is nowhere near a lit sprite's, with values that f16 holds exactly.
pub const BACKDROP: Vec4 = Vec4::new(0.125, 0.25, 0.5, 1.0);

pub fn perspective(size: UVec2) -> Mat4 {
    rh::proj::directx::perspective(0.8, size.x as f32 / size.y as f32, 0.1, 80.0)
}

/// A soft ball beside the middle of the sprite.
pub fn ball_sprite(y_down: bool) -> Sprite {
    let picture = image::RgbaImage::from_fn(64, 64, |x, y| {
        let p = (Vec2::new(x as f32, 63.0 - y as f32) + 0.5) / 32.0 - 1.0;
        // Off the middle and leaning, so that a sprite turned or flipped is another.
        let p = p - Vec2::new(0.1, 0.05);
        let inside = (1.0 - p.length_squared() * 1.4).max(0.0);
        let normal = (p * 1.5 + Vec2::new(0.2, -0.1)).extend(inside.sqrt().max(0.05)).normalize() * 0.5 + 0.5;
        let channel = |value: f32| (value * 255.0).round() as u8;
        image::Rgba([channel(normal.x), channel(normal.y), channel(normal.z), channel(inside.sqrt())])
    });
    Sprite::from_picture(std::path::Path::new("ball"), &picture, SpriteLayout { y_down, ..SpriteLayout::default() })
        .unwrap()
}

/// Stands out in the middle, moves to the upper right.
fn ball_detail() -> Sprite {
    let picture = image::RgbaImage::from_fn(32, 32, |x, y| {
        let p = (Vec2::new(x as f32, 31.0 - y as f32) + 0.5) / 16.0 - 1.0;
        let inside = (1.0 - 1.2 * p.length_squared()).max(0.0);
        image::Rgba([(128.0 + 100.0 * inside) as u8, 168, 88, (inside * 255.0) as u8])
    });
    Sprite::from_picture(std::path::Path::new("ball.detail"), &picture, SpriteLayout::default()).unwrap()
}

fn recipe_noise() -> NoiseVolume {
    let recipe = NoiseRecipe { version: 1, seed: 3, size: 16, cells: 2, octaves: 3, gain: 0.5 };
    NoiseVolume::from_picture(std::path::Path::new("noise"), &recipe.bake().unwrap()).unwrap()
}

pub fn material() -> MaterialAssets {
    let line =
        |from: Vec3, to: Vec3| Ramp::from_linear(UVec2::new(16, 1), (0..16).map(|i| from.lerp(to, i as f32 / 15.0)));
    let glow = |i: u32| Vec3::splat((1.0 - (i % 16) as f32 / 15.0) * (i / 16) as f32 / 7.0);
    MaterialAssets {
        sprite: ball_sprite(false),
        detail: Some(ball_detail()),
        noise: recipe_noise(),
        diffuse_ramp: line(Vec3::splat(0.05), Vec3::ONE),
        soft_scatter_ramp: line(Vec3::splat(0.3), Vec3::ZERO),
        specular_ramp: Ramp::from_linear(UVec2::new(16, 8), (0..128).map(glow)),
        motif: line(Vec3::ZERO, Vec3::ONE),
        age_ramp: line(vec3(1.0, 0.2, 0.1), vec3(0.2, 0.4, 1.0)),
    }
}

impl Stage {
    /// A cloud of 60 sprites round (0, 0, -6), lit from the left and from behind.
    pub fn new(size: UVec2) -> Self {
        let particle = |i: u32| {
            let (a, b) = (pcg3d(UVec3::new(i, 0, 5)), pcg3d(UVec3::new(i, 1, 5)));
            Particle {
                position: (vec3(unit(a.x), unit(a.y), unit(a.z)) - 0.5) * vec3(4.0, 2.4, 2.0) + vec3(0.0, 0.0, -6.0),
                radius: 0.3 + 0.6 * unit(b.x),
                rotation: unit(b.y) * 6.0,
                amount: 0.1 + 0.4 * unit(b.z),
                frame: 0.0,
                age: 0.5,
            }
        };
        Self {
            view: View::new(Mat4::IDENTITY, perspective(size), size),
            lights: vec![
                Light {
                    position: vec3(-4.0, 2.0, -4.0),
                    colour: vec3(1.0, 0.6, 0.3),
                    intensity: 20.0,
                    ..Light::default()
                },
                Light { position: vec3(0.5, 0.3, -8.5), intensity: 3.0, ..Light::default() },
            ],
            particles: (0..60).map(particle).collect(),
            bounds: None,
            settings: Settings { boost: 1.5, ..Settings::default() },
            material: material(),
            time: 1.0,
            shade_tree: ShadeTree::Final,
            depth: DepthKind::Buffer,
            wall_everywhere: false,
            empty_linear: false,
            // OpenGL cannot test and sample one depth buffer in one pass.
            attach_depth: haze::read_only_depth_is_supported(&gpu().device),
        }
    }

    /// View depth of the scene: a post of 0.3 m at 5 m, a wall at 6.2 m on the left half, that the cloud reaches into, nothing on the right.
    fn view_depth(&self, at: UVec2) -> Option<f32> {
        if self.wall_everywhere {
            return Some(6.2);
        }
        let uv = (at.as_vec2() + 0.5) / self.view.size.as_vec2();
        let post = (uv.x - 0.6).abs() < 0.03;
        if post { Some(5.0) } else { (uv.x < 0.5).then_some(6.2) }
    }

    /// What the depth buffer holds.
    pub fn ndc_depth(&self) -> Picture<f32> {
        let reversed = self.view.clip_from_view.project_point3(vec3(0.0, 0.0, -1.0)).z
            > self.view.clip_from_view.project_point3(vec3(0.0, 0.0, -2.0)).z;
        let mut picture = Picture::new(self.view.size, if reversed { 0.0 } else { 1.0 });
        picture.for_each(|at, texel| {
            if let Some(depth) = self.view_depth(at) {
                *texel = self.view.clip_from_view.project_point3(vec3(0.0, 0.0, -depth)).z;
            }
        });
        picture
    }

    pub fn on_cpu(&self) -> Picture<Vec4> {
        let mut picture = Picture::new(self.view.size, BACKDROP);
        let frame = reference::Frame {
            view: self.view,
            scene_depth: &self.ndc_depth(),
            lights: &self.lights,
            systems: &[reference::System {
                particles: &self.particles,
                bounds: self.bounds,
                settings: &self.settings,
                material: &self.material,
            }],
            time: self.time,
            shade_tree: self.shade_tree,
        };
        reference::render(&frame, &mut picture).unwrap();
        picture
    }

    pub fn on_gpu(&self, gpu: &Headless) -> Drawn {
        self.try_on_gpu(gpu).unwrap()
    }

    pub fn try_on_gpu(&self, gpu: &Headless) -> Result<Drawn, Error> {
        let mut host = Host::new(gpu, self)?;
        host.draw(gpu, self)?;
        Ok(Drawn { picture: host.picture(gpu)?, renderer: host.renderer })
    }
}

/// The host's side on the GPU, kept from frame to frame.
pub struct Host {
    pub renderer: Renderer,
    material: haze::Material,
    colour: wgpu::Texture,
    colour_view: wgpu::TextureView,
    depth_view: wgpu::TextureView,
    linear_view: wgpu::TextureView,
}

impl Host {
    pub fn new(gpu: &Headless, stage: &Stage) -> Result<Self, Error> {
        let mut descriptor = Descriptor { exact_filtering: true, ..Descriptor::default() };
        if !stage.attach_depth {
            descriptor.depth_format = None;
        }
        let renderer = Renderer::new(&gpu.device, &gpu.queue, &descriptor)?;
        let material = renderer.create_material(&gpu.device, &gpu.queue, &stage.material)?;
        let colour = gpu.target("host colour", stage.view.size, wgpu::TextureFormat::Rgba16Float);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let (depth, linear) = depth_textures(gpu, stage);
        let (colour_view, depth_view, linear_view) = (view(&colour), view(&depth), view(&linear));
        Ok(Self { renderer, material, colour, colour_view, depth_view, linear_view })
    }

    /// One frame: the backdrop, then the smoke.
    pub fn draw(&mut self, gpu: &Headless, stage: &Stage) -> Result<(), Error> {
        self.draw_particles(gpu, stage, Particles::Slice(&stage.particles))
    }

    pub fn draw_particles(&mut self, gpu: &Headless, stage: &Stage, particles: Particles<'_>) -> Result<(), Error> {
        let frame = Frame {
            view: stage.view,
            scene_depth: match stage.depth {
                DepthKind::Buffer => SceneDepth::Buffer(&self.depth_view),
                DepthKind::Linear => SceneDepth::Linear(&self.linear_view),
                DepthKind::Both => SceneDepth::Both { buffer: &self.depth_view, linear: &self.linear_view },
            },
            lights: &stage.lights,
            systems: &[System { bounds: stage.bounds, ..System::new(particles, &stage.settings, &self.material) }],
            time: stage.time,
            shade_tree: stage.shade_tree,
        };
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, &frame)?;
        let [r, g, b, a] = BACKDROP.to_array().map(f64::from);
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("host"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &self.colour_view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: stage.attach_depth.then_some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth_view,
                    depth_ops: None,
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            self.renderer.render(&mut pass);
        }
        gpu.submit(encoder)
    }

    pub fn picture(&self, gpu: &Headless) -> Result<Picture<Vec4>, Error> {
        let size = UVec2::new(self.colour.width(), self.colour.height());
        Ok(Picture { size, texels: gpu.read_rgba16float(&self.colour)? })
    }
}

/// The stage's scene as a Depth32Float buffer and as an R32Float target of linear metres.
fn depth_textures(gpu: &Headless, stage: &Stage) -> (wgpu::Texture, wgpu::Texture) {
    const SOURCE: &str = "
        @group(0) @binding(0) var values: texture_2d<f32>;
        @vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
            return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
        }
        @fragment fn fragment(@builtin(position) p: vec4f) -> @builtin(frag_depth) f32 {
            return textureLoad(values, vec2i(p.xy), 0).r;
        }";
    let size = stage.view.size;
    let extent = wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 };
    let upload = |values: &[f32]| {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("host depth values"),
            size: extent,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size.x), rows_per_image: None };
        gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(values), layout, extent);
        texture
    };
    let ndc = upload(&stage.ndc_depth().texels);
    let mut linear = Picture::new(size, 0.0);
    let seen = |at| stage.view_depth(at).filter(|_| !stage.empty_linear);
    linear.for_each(|at, texel| *texel = seen(at).unwrap_or(haze::formula::depth::SKY_VIEW_DEPTH));
    let linear = upload(&linear.texels);

    let depth = gpu.target("host depth", size, wgpu::TextureFormat::Depth32Float);
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("host depth"),
        source: wgpu::ShaderSource::Wgsl(SOURCE.into()),
    });
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("host depth"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        }],
    });
    let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("host depth"),
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("host depth"),
        layout: Some(&pipeline_layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let values = ndc.create_view(&wgpu::TextureViewDescriptor::default());
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("host depth"),
        layout: &layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&values) }],
    });
    let target = depth.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host depth"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    gpu.submit(encoder).unwrap();
    (depth, linear)
}
