//! Embeds haze in a winit window; the camera orbits the smoke. Close the window or press Escape to quit.

use std::sync::Arc;
use std::time::Instant;

use glam::camera::rh;
use glam::{UVec2, Vec3, vec3};
use haze::emitter::Emitter;
use haze::preset::{ImageSource, MaterialSources};
use haze::{
    Context, FrameInput, Light, Material, Particle, ParticleSystem, Particles, Renderer, RendererDescriptor,
    SceneDepth, Settings, View, wgpu,
};
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

type Failure = Box<dyn std::error::Error>;

const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

fn main() -> Result<(), Failure> {
    let mut app = App { host: None, failure: None };
    EventLoop::new()?.run_app(&mut app)?;
    app.failure.map_or(Ok(()), Err)
}

struct App {
    host: Option<Host>,
    failure: Option<Failure>,
}

/// State of any wgpu program, and haze's four parts: renderer, material, particles, settings.
struct Host {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    depth: wgpu::TextureView,
    start: Instant,
    smoke: Renderer,
    material: Material,
    particles: Vec<Particle>,
    settings: Settings,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        let made = event_loop
            .create_window(Window::default_attributes().with_title("haze: embed_winit"))
            .map_err(Failure::from)
            .and_then(|window| Host::new(Arc::new(window)));
        match made {
            Ok(host) => self.host = Some(host),
            Err(failure) => self.end(event_loop, failure),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(host) = &mut self.host else { return };
        let drawn = match event {
            WindowEvent::CloseRequested => return event_loop.exit(),
            WindowEvent::KeyboardInput { event, .. } if event.logical_key == Key::Named(NamedKey::Escape) => {
                return event_loop.exit();
            }
            WindowEvent::Resized(size) => {
                host.resize(UVec2::new(size.width, size.height));
                Ok(())
            }
            WindowEvent::RedrawRequested => host.draw(),
            _ => Ok(()),
        };
        if let Err(failure) = drawn {
            self.end(event_loop, failure);
        }
    }
}

impl App {
    fn end(&mut self, event_loop: &ActiveEventLoop, failure: Failure) {
        self.failure = Some(failure);
        event_loop.exit();
    }
}

impl Host {
    fn new(window: Arc<Window>) -> Result<Self, Failure> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(window.clone())?;
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            ..Default::default()
        }))?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let size = window.inner_size();
        let mut configuration = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or("the adapter cannot draw to this window")?;
        // Shaders write linear light; the hardware encodes it to sRGB.
        configuration.format = configuration.format.add_srgb_suffix();
        surface.configure(&device, &configuration);

        let descriptor = RendererDescriptor {
            color_format: configuration.format,
            depth_format: Some(DEPTH),
            ..RendererDescriptor::default()
        };
        let context = Context::new(&device, &queue);
        let smoke = Renderer::new(&context, &descriptor)?;
        let material = context.create_material(&MaterialSources::default().load(ImageSource::BuiltIn)?)?;
        let depth = depth_target(&device, &configuration);
        let start = Instant::now();
        let settings = Settings::default();
        Ok(Self {
            window,
            surface,
            configuration,
            device,
            queue,
            depth,
            start,
            smoke,
            material,
            particles: Vec::new(),
            settings,
        })
    }

    fn resize(&mut self, size: UVec2) {
        // A minimised window has size 0, and configuring a surface of size 0 panics.
        if size.min_element() > 0 {
            self.configuration.width = size.x;
            self.configuration.height = size.y;
            self.surface.configure(&self.device, &self.configuration);
            self.depth = depth_target(&self.device, &self.configuration);
        }
        self.window.request_redraw();
    }

    fn draw(&mut self) -> Result<(), Failure> {
        use wgpu::CurrentSurfaceTexture::{Lost, Outdated, Suboptimal, Success};
        let target = match self.surface.get_current_texture() {
            Success(target) | Suboptimal(target) => target,
            Outdated | Lost => {
                self.resize(UVec2::new(self.configuration.width, self.configuration.height));
                return Ok(());
            }
            // Occluded or timed out: try again with the next frame.
            _ => {
                self.window.request_redraw();
                return Ok(());
            }
        };
        let size = UVec2::new(self.configuration.width, self.configuration.height);
        let time = self.start.elapsed().as_secs_f64();
        let angle = 0.3 * time as f32;
        let eye = vec3(6.5 * angle.sin(), 1.8, 6.5 * angle.cos());
        Emitter::default().evaluate(time, &mut self.particles);

        let view = View::new(
            rh::view::look_at_mat4(eye, vec3(0.0, 1.8, 0.0), Vec3::Y),
            rh::proj::directx::perspective(0.8, size.x as f32 / size.y as f32, 0.1, 100.0),
            size,
        );
        let lamp = |position, color, intensity| Light { position, color, intensity, ..Light::default() };
        let frame = FrameInput {
            lights: &[
                lamp(vec3(-3.0, 3.0, 3.0), vec3(1.0, 0.7, 0.4), 12.0),
                lamp(vec3(2.0, 2.0, -2.5), vec3(0.4, 0.6, 1.0), 3.0),
            ],
            systems: &[ParticleSystem::new(0, Particles::Slice(&self.particles), &self.settings, &self.material)],
            time,
            ..FrameInput::new(view, SceneDepth::Buffer(&self.depth))
        };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let color = target.texture.create_view(&Default::default());
        let clear = wgpu::Color { r: 0.02, g: 0.03, b: 0.05, a: 1.0 };
        // The host draws its opaque scene in this pass; this example has none.
        drop(begin(&mut encoder, &color, &self.depth, Some(clear)));
        self.smoke.prepare(&mut encoder, &frame)?;
        self.smoke.render(&mut begin(&mut encoder, &color, &self.depth, None));
        self.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.queue.present(target);
        self.window.request_redraw();
        Ok(())
    }
}

fn depth_target(device: &wgpu::Device, configuration: &wgpu::SurfaceConfiguration) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("depth"),
        size: wgpu::Extent3d { width: configuration.width, height: configuration.height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

/// Begins a pass on the window. With `clear` it writes color and depth; without, depth is read-only, as haze requires.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: &wgpu::TextureView,
    depth: &wgpu::TextureView,
    clear: Option<wgpu::Color>,
) -> wgpu::RenderPass<'a> {
    let load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
    let depth_ops = clear.map(|_| wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops,
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
