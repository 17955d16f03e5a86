//! A configurable test host on the GPU: it owns the render targets and the pass in which a [`TestScene`] is drawn.

mod textures;

use glam::{UVec2, Vec4};
use haze::{
    Context, FrameInput, Particle, ParticleBuffer, ParticleSystem, Particles, Renderer, RendererDescriptor, SceneDepth,
    ShadowMap, Timing, wgpu,
};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_demo::headless::Headless;

pub use self::textures::convert_to_rgba16float;
use self::textures::{depth_buffer, depth_layers, pad_to_target, target, target_with_view_format, upload};
use crate::gpu::shared_context;
use crate::test_scene::{DepthKind, TestScene};

/// Formats and sample count of a host's pass and targets.
#[derive(Clone, Debug)]
pub struct HostKind {
    pub color_format: wgpu::TextureFormat,
    /// Formats of the additional color attachments of the pass.
    pub additional_attachments: Vec<wgpu::TextureFormat>,
    pub depth_format: wgpu::TextureFormat,
    /// Sample count of the pass. The depth buffer passed to haze has one sample, but for [`DepthKind::Multisampled`].
    pub samples: u32,
    /// Format of the color texture, if the attachment is a view of it in another format.
    pub stored_format: Option<wgpu::TextureFormat>,
    /// True to put one sample of each pixel of the multisampled depth buffer on the near plane.
    pub has_near_sample: bool,
    pub exact_filtering: bool,
    /// Size of the targets, pixels, if the view covers only a part of the targets. `None` for the size of the view.
    pub target_size: Option<UVec2>,
}

impl Default for HostKind {
    fn default() -> Self {
        Self {
            color_format: wgpu::TextureFormat::Rgba16Float,
            additional_attachments: Vec::new(),
            depth_format: wgpu::TextureFormat::Depth32Float,
            samples: 1,
            stored_format: None,
            has_near_sample: false,
            exact_filtering: true,
            target_size: None,
        }
    }
}

/// State of the host that persists between frames.
pub struct Host {
    pub renderer: Renderer,
    pub material: haze::Material,
    size: UVec2,
    /// Single-sampled color target, which tests read back.
    pub color: wgpu::Texture,
    /// The color attachment that the smoke is drawn on, then the additional attachments.
    attachments: Vec<wgpu::TextureView>,
    resolved: Option<wgpu::TextureView>,
    /// Single-sampled depth buffer passed to haze.
    pub depth: wgpu::TextureView,
    /// Depth buffer of the pass, with as many samples: passed to haze as [`DepthKind::Multisampled`].
    samples: wgpu::TextureView,
    /// Linear view depth passed to haze, metres.
    pub linear: wgpu::TextureView,
    attached_depth: wgpu::TextureView,
    shadow_maps: Vec<wgpu::Texture>,
    /// Records the shadow ahead of `prepare`.
    pub casts_first: bool,
    /// Measures the host's pass; resolved at the end of each frame.
    pub timing: Option<Timing>,
}

/// Image of one frame, and the renderer that drew it.
pub struct RenderedFrame {
    pub image: Image<Vec4>,
    pub renderer: Renderer,
}

impl TestScene {
    pub fn on_gpu(&self, gpu: &Headless) -> RenderedFrame {
        self.try_on_gpu(gpu).unwrap()
    }

    pub fn try_on_gpu(&self, gpu: &Headless) -> Result<RenderedFrame, Error> {
        let mut host = Host::with_shared_context(gpu, self)?;
        host.draw(gpu, self)?;
        Ok(RenderedFrame { image: host.image(gpu)?, renderer: host.renderer })
    }
}

impl Host {
    pub fn new(gpu: &Headless, scene: &TestScene) -> Result<Self, Error> {
        Self::with_context(gpu, scene, None)
    }

    /// Creates a host on the context that tests share, if `gpu` is the device that they share. Only for comparing images: on
    /// a shared context, counts of created resources and compiled pipelines mean nothing.
    pub fn with_shared_context(gpu: &Headless, scene: &TestScene) -> Result<Self, Error> {
        let is_shared = std::ptr::eq(gpu, crate::gpu::gpu());
        Self::with_context(gpu, scene, is_shared.then(shared_context).as_ref())
    }

    /// Creates a host whose renderer uses `context`, or its own context if `None`.
    pub fn with_context(gpu: &Headless, scene: &TestScene, context: Option<&Context>) -> Result<Self, Error> {
        let kind = &scene.host;
        let additional_attachments: Vec<_> = kind.additional_attachments.iter().copied().map(Some).collect();
        let descriptor = RendererDescriptor {
            color_format: kind.color_format,
            other_color_formats: &additional_attachments,
            depth_format: scene.attach_depth.then_some(kind.depth_format),
            sample_count: kind.samples,
            exact_filtering: kind.exact_filtering,
            scene_color_format: None,
        };
        let context = context.cloned().unwrap_or_else(|| Context::new(&gpu.device, &gpu.queue));
        let renderer = Renderer::new(&context, &descriptor)?;
        let material = context.create_material(&scene.material)?;
        let size = kind.target_size.unwrap_or(scene.view.size);
        let whole = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let color = match kind.stored_format {
            Some(format) => target_with_view_format(gpu, size, format, kind.color_format),
            None => gpu.target("host color", size, kind.color_format),
        };
        let resolved = (kind.samples > 1).then(|| whole(&color));
        let mut attachments: Vec<_> = std::iter::once(kind.color_format)
            .chain(kind.additional_attachments.iter().copied())
            .map(|format| whole(&target(gpu, size, format, kind.samples)))
            .collect();
        if resolved.is_none() {
            let format = Some(kind.color_format);
            attachments[0] = color.create_view(&wgpu::TextureViewDescriptor { format, ..Default::default() });
        }
        let depth = depth_buffer(gpu, scene, size, 1);
        let attached_depth =
            if kind.samples > 1 { depth_buffer(gpu, scene, size, kind.samples) } else { depth.clone() };
        let linear = upload(gpu, &pad_to_target(&scene.linear_depth(), scene.view.origin, size));
        // A depth-stencil buffer is sampled through a view of its depth aspect only.
        let depth_aspect = wgpu::TextureViewDescriptor {
            aspect: if kind.depth_format.has_stencil_aspect() {
                wgpu::TextureAspect::DepthOnly
            } else {
                wgpu::TextureAspect::All
            },
            ..Default::default()
        };
        Ok(Self {
            renderer,
            material,
            size,
            color,
            attachments,
            resolved,
            samples: attached_depth.create_view(&depth_aspect),
            depth: depth.create_view(&depth_aspect),
            linear: whole(&linear),
            attached_depth: whole(&attached_depth),
            shadow_maps: scene.shadow_maps.iter().map(|map| depth_layers(gpu, &map.layers)).collect(),
            casts_first: false,
            timing: None,
        })
    }

    /// Draws one frame: clears to the backdrop, then draws the smoke.
    pub fn draw(&mut self, gpu: &Headless, scene: &TestScene) -> Result<(), Error> {
        self.draw_particles(gpu, scene, Particles::Slice(&scene.particles))
    }

    pub fn draw_particles(&mut self, gpu: &Headless, scene: &TestScene, particles: Particles<'_>) -> Result<(), Error> {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.prepare(&mut encoder, scene, particles)?;
        self.render(&mut encoder, scene);
        if let Some(timing) = &self.timing {
            timing.resolve(&mut encoder);
        }
        gpu.submit(encoder)
    }

    /// Draws particles from a GPU buffer in their given order, without sorting.
    pub fn draw_buffer(&mut self, gpu: &Headless, scene: &TestScene, particles: &[Particle]) -> Result<(), Error> {
        let buffer = particle_buffer(gpu, particles);
        let count = particles.len() as u32;
        self.draw_particles(
            gpu,
            scene,
            Particles::Buffer(ParticleBuffer { is_sorted: true, ..ParticleBuffer::new(&buffer, count) }),
        )
    }

    /// Records `prepare`, the first half of a frame.
    pub fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &TestScene,
        particles: Particles<'_>,
    ) -> Result<(), Error> {
        let casts_first = self.casts_first;
        self.with_frame(scene, particles, |renderer, frame| {
            if casts_first {
                renderer.prepare_shadow(encoder, frame)?;
            }
            Ok(renderer.prepare(encoder, frame)?)
        })
    }

    /// Records `prepare_shadow` alone.
    pub fn prepare_shadow(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &TestScene) -> Result<(), Error> {
        let particles = Particles::Slice(&scene.particles);
        self.with_frame(scene, particles, |renderer, frame| Ok(renderer.prepare_shadow(encoder, frame)?))
    }

    /// Calls `f` with the renderer and the input of a frame.
    fn with_frame(
        &mut self,
        scene: &TestScene,
        particles: Particles<'_>,
        f: impl FnOnce(&mut Renderer, &FrameInput<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let bounds = scene.bounds;
        let world_from_particles = scene.world_from_particles;
        let mut systems = vec![ParticleSystem {
            bounds,
            world_from_particles,
            ..ParticleSystem::new(0, particles, &scene.settings, &self.material)
        }];
        systems.extend((1..).zip(&scene.others).map(|(key, (particles, settings))| {
            ParticleSystem::new(key, Particles::Slice(particles), settings, &self.material)
        }));
        let scene_depth = match scene.depth {
            DepthKind::Buffer => SceneDepth::Buffer(&self.depth),
            DepthKind::Multisampled => SceneDepth::Multisampled(&self.samples),
            DepthKind::Linear => SceneDepth::Linear(&self.linear),
            DepthKind::Both => SceneDepth::BufferAndLinear { buffer: &self.depth, linear: &self.linear },
        };
        let shadow_maps: Vec<_> = self
            .shadow_maps
            .iter()
            .zip(&scene.shadow_maps)
            .map(|(depth, map)| ShadowMap { depth, first_layer: 0, projection: map.projection() })
            .collect();
        let frame = FrameInput {
            shadow_maps: &shadow_maps,
            scene_ambient: scene.scene_ambient,
            lights: &scene.lights,
            systems: &systems,
            target_size: scene.host.target_size,
            exposure: scene.exposure,
            up: scene.up,
            time: scene.time,
            debug_views: scene.debug_views.unwrap_or(std::slice::from_ref(&scene.debug_view)),
            ..FrameInput::new(scene.view, scene_depth)
        };
        f(&mut self.renderer, &frame)
    }

    /// Records the host's pass, the second half of a frame.
    pub fn render(&self, encoder: &mut wgpu::CommandEncoder, scene: &TestScene) {
        self.render_with(encoder, scene, |pass| {
            self.renderer.render_scene_shadow(pass);
            self.renderer.render_debug_view(pass, scene.debug_view);
        });
    }

    /// Records the host's pass; `draw` records its contents.
    pub fn render_with(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &TestScene,
        draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let [r, g, b, a] = scene.backdrop().to_array().map(f64::from);
        let attachments: Vec<_> = self
            .attachments
            .iter()
            .enumerate()
            .map(|(index, view)| {
                Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: self.resolved.as_ref().filter(|_| index == 0),
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                        store: wgpu::StoreOp::Store,
                    },
                })
            })
            .collect();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("host"),
            color_attachments: &attachments,
            depth_stencil_attachment: scene.attach_depth.then_some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.attached_depth,
                depth_ops: None,
                stencil_ops: None,
            }),
            timestamp_writes: self.timing.as_ref().and_then(|timing| timing.host_pass("host")),
            ..Default::default()
        });
        draw(&mut pass);
    }

    /// Reads back the color target as floats. sRGB formats are decoded to linear light.
    pub fn image(&self, gpu: &Headless) -> Result<Image<Vec4>, Error> {
        Ok(Image { size: self.size, texels: gpu.read_rgba16float(&convert_to_rgba16float(gpu, &self.color))? })
    }

    /// Reads back additional attachment number `index`.
    pub fn additional_attachments(&self, gpu: &Headless, index: usize) -> Image<Vec4> {
        let texels = gpu.read_rgba16float(&convert_to_rgba16float(gpu, self.attachments[index + 1].texture())).unwrap();
        Image { size: self.size, texels }
    }
}

/// Uploads particles to a vertex buffer, as a host with its own simulation does.
fn particle_buffer(gpu: &Headless, particles: &[Particle]) -> wgpu::Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(particles);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("host particles"),
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytes);
    buffer
}
