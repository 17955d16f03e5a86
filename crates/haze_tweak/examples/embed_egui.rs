//! Embeds haze in a panel of an egui window: a 3D view with smoke beside sliders. Drag in the view to orbit.

use std::time::Instant;

use eframe::{egui, egui_wgpu};
use glam::camera::rh;
use glam::{UVec2, Vec3, vec3};
use haze::emitter::Emitter;
use haze::preset::{ImageSource, MaterialSources};
use haze::{
    Context, FrameInput, Light, Material, Particle, ParticleSystem, Particles, Renderer, RendererDescriptor,
    SceneDepth, Settings, View, wgpu,
};

type Failure = Box<dyn std::error::Error + Send + Sync>;

const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// haze writes linear light, which the hardware encodes; egui reads the encoded values.
const WRITTEN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
const SHOWN: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

fn main() -> eframe::Result {
    let options = eframe::NativeOptions { renderer: eframe::Renderer::Wgpu, ..Default::default() };
    eframe::run_native("haze: embed_egui", options, Box::new(|creation| Ok(Box::new(App::new(creation)?))))
}

/// An egui program, and haze's four parts: renderer, material, particles, settings.
struct App {
    start: Instant,
    /// Angle of the camera around the smoke, radians.
    angle: f32,
    lamp: Lamp,
    targets: Option<Targets>,
    smoke: Renderer,
    material: Material,
    particles: Vec<Particle>,
    settings: Settings,
    failure: Option<String>,
}

struct Lamp {
    /// Radians.
    angle: f32,
    intensity: f32,
}

/// Textures of the view, as large as the panel.
struct Targets {
    size: UVec2,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    id: egui::TextureId,
}

impl App {
    fn new(creation: &eframe::CreationContext<'_>) -> Result<Self, Failure> {
        let gpu = creation.wgpu_render_state.as_ref().ok_or("egui does not draw with wgpu")?;
        let context = Context::new(&gpu.device, &gpu.queue);
        let descriptor =
            RendererDescriptor { color_format: WRITTEN, depth_format: Some(DEPTH), ..RendererDescriptor::default() };
        Ok(Self {
            start: Instant::now(),
            angle: 0.5,
            lamp: Lamp { angle: 2.2, intensity: 12.0 },
            targets: None,
            smoke: Renderer::new(&context, &descriptor)?,
            material: context.create_material(&MaterialSources::default().load(ImageSource::BuiltIn)?)?,
            particles: Vec::new(),
            settings: Settings::default(),
            failure: None,
        })
    }

    /// Draws the smoke into the targets, which it makes as large as the panel.
    fn draw(&mut self, gpu: &egui_wgpu::RenderState, size: UVec2) -> Result<egui::TextureId, haze::PrepareError> {
        if self.targets.as_ref().is_none_or(|held| held.size != size) {
            self.targets = Some(Targets::new(gpu, size, self.targets.take()));
        }
        let Some(Targets { color, depth, id, .. }) = &self.targets else { return Ok(egui::TextureId::default()) };
        let time = self.start.elapsed().as_secs_f64();
        Emitter::default().evaluate(time, &mut self.particles);
        let around =
            |angle: f32, distance: f32, height: f32| vec3(distance * angle.sin(), height, distance * angle.cos());
        let view = View::new(
            rh::view::look_at_mat4(around(self.angle, 6.5, 1.8), vec3(0.0, 1.8, 0.0), Vec3::Y),
            rh::proj::directx::perspective(0.8, size.x as f32 / size.y as f32, 0.1, 100.0),
            size,
        );
        let Lamp { angle, intensity } = self.lamp;
        let lamp =
            Light { position: around(angle, 4.0, 3.0), color: vec3(1.0, 0.7, 0.4), intensity, ..Light::default() };
        let frame = FrameInput {
            lights: &[lamp],
            systems: &[ParticleSystem::new(0, Particles::Slice(&self.particles), &self.settings, &self.material)],
            time,
            ..FrameInput::new(view, SceneDepth::Buffer(depth))
        };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let clear = wgpu::Color { r: 0.02, g: 0.03, b: 0.05, a: 1.0 };
        // The program draws its opaque scene in this pass; this example has none.
        drop(begin(&mut encoder, color, depth, Some(clear)));
        self.smoke.prepare(&mut encoder, &frame)?;
        self.smoke.render(&mut begin(&mut encoder, color, depth, None));
        // egui submits its own commands after these.
        gpu.queue.submit([encoder.finish()]);
        Ok(*id)
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        egui::Panel::right("settings").show(ui, |ui| {
            ui.add(egui::Slider::new(&mut self.lamp.angle, 0.0..=std::f32::consts::TAU).text("Lamp: angle"));
            ui.add(egui::Slider::new(&mut self.lamp.intensity, 0.0..=40.0).text("Lamp: intensity"));
            ui.add(egui::Slider::new(&mut self.settings.boost, 0.0..=8.0).text("Boost"));
            ui.add(egui::Slider::new(&mut self.settings.shadow.strength, 0.0..=1.0).text("Shadow"));
            if let Some(failure) = &self.failure {
                ui.colored_label(ui.visuals().error_fg_color, failure);
            }
        });
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let points = ui.available_size();
            let pixels = (points * ui.pixels_per_point()).max(egui::Vec2::splat(1.0));
            let Some(gpu) = frame.wgpu_render_state() else { return };
            match self.draw(gpu, UVec2::new(pixels.x as u32, pixels.y as u32)) {
                Ok(id) => {
                    let image = egui::Image::new((id, points)).sense(egui::Sense::drag());
                    self.angle -= 0.01 * ui.add(image).drag_delta().x;
                    self.failure = None;
                }
                Err(error) => self.failure = Some(error.to_string()),
            }
        });
        ui.ctx().request_repaint();
    }
}

impl Targets {
    /// `before`: targets whose place in egui these take.
    fn new(gpu: &egui_wgpu::RenderState, size: UVec2, before: Option<Self>) -> Self {
        let texture = |label, format, view_formats: &[wgpu::TextureFormat]| {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats,
            })
        };
        let color = texture("view", SHOWN, &[WRITTEN]);
        let shown = color.create_view(&Default::default());
        let filter = wgpu::FilterMode::Nearest;
        let mut renderer = gpu.renderer.write();
        let id = match before {
            Some(Self { id, .. }) => {
                renderer.update_egui_texture_from_wgpu_texture(&gpu.device, &shown, filter, id);
                id
            }
            None => renderer.register_native_texture(&gpu.device, &shown, filter),
        };
        Self {
            size,
            color: color.create_view(&wgpu::TextureViewDescriptor { format: Some(WRITTEN), ..Default::default() }),
            depth: texture("depth", DEPTH, &[]).create_view(&Default::default()),
            id,
        }
    }
}

/// Begins a pass: with `clear`, it clears color and depth; without, it keeps both and cannot write depth.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: &wgpu::TextureView,
    depth: &wgpu::TextureView,
    clear: Option<wgpu::Color>,
) -> wgpu::RenderPass<'a> {
    let depth_ops = clear.map(|_| wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("view"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops,
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
