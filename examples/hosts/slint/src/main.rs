//! Smoke in a Slint window: Slint's device draws a scene with smoke into a texture, and Slint shows it as an image behind its
//! widgets, which change the smoke.

mod scene;

use std::cell::RefCell;
use std::path::Path;
use std::time::Instant;

use haze::emitter::Emitter;
use haze::glam::camera::rh;
use haze::glam::{UVec2, Vec3, vec3};
use haze::preset::Preset;
use haze::{
    Context, FrameInput, Light, Material, Particle, ParticleSystem, Particles, Renderer, RendererDescriptor,
    SceneDepth, Settings, View, wgpu,
};
use slint::wgpu_30::{WGPUConfiguration, WGPUSettings};

use scene::{COLOR, DEPTH, Scene};

type Failure = Box<dyn std::error::Error>;

slint::slint! {
    import { Slider } from "std-widgets.slint";

    export component AppWindow inherits Window {
        title: "haze in Slint";
        preferred-width: 960px;
        preferred-height: 540px;
        in property <image> view;
        out property <length> view-width: self.width;
        out property <length> view-height: self.height;
        out property <float> lamp: lamp-slider.value;
        out property <float> thickness: thickness-slider.value;

        Image {
            width: 100%;
            height: 100%;
            source: root.view;
        }
        Rectangle {
            x: 16px;
            y: 16px;
            width: 260px;
            height: 120px;
            background: #101418c0;
            border-radius: 8px;
            VerticalLayout {
                padding: 12px;
                Text { text: "Lamp"; color: white; }
                lamp-slider := Slider { minimum: 0; maximum: 40; value: 16; }
                Text { text: "Thickness of the smoke"; color: white; }
                thickness-slider := Slider { minimum: 0.2; maximum: 4; value: 1.5; }
            }
        }
    }
}

fn main() -> Result<(), Failure> {
    // Slint asks for the least that WebGL 2 has. haze shades smoke faster with compute shaders.
    let mut settings = WGPUSettings::default();
    settings.device_required_limits = wgpu::Limits::default();
    slint::BackendSelector::new().require_wgpu_30(WGPUConfiguration::Automatic(settings)).select()?;
    let app = AppWindow::new()?;
    let window = app.as_weak();
    let host = RefCell::new(None);
    app.window().set_rendering_notifier(move |state, api| {
        let Some(app) = window.upgrade() else { return };
        let drawn = match (state, api) {
            (slint::RenderingState::RenderingSetup, slint::GraphicsAPI::WGPU30 { device, queue, .. }) => {
                Host::new(device, queue).map(|made| drop(host.replace(Some(made))))
            }
            (slint::RenderingState::BeforeRendering, _) => {
                host.borrow_mut().as_mut().map_or(Ok(()), |host| host.draw(&app))
            }
            (slint::RenderingState::RenderingTeardown, _) => {
                host.take();
                Ok(())
            }
            _ => Ok(()),
        };
        if let Err(failure) = drawn {
            eprintln!("smoke: {failure}");
            host.take();
        }
    })?;
    app.run()?;
    Ok(())
}

/// The scene, and haze's four parts: renderer, material, particles, settings.
struct Host {
    device: wgpu::Device,
    queue: wgpu::Queue,
    scene: Scene,
    start: Instant,
    smoke: Renderer,
    material: Material,
    emitter: Emitter,
    particles: Vec<Particle>,
    settings: Settings,
}

impl Host {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self, Failure> {
        let descriptor =
            RendererDescriptor { color_format: COLOR, depth_format: Some(DEPTH), ..RendererDescriptor::default() };
        let context = Context::new(device, queue);
        let smoke = Renderer::new(&context, &descriptor)?;
        let preset = Preset::load("column")?;
        let images = preset.load_materials(Path::new("column"))?;
        let (Some(system), Some(images)) = (preset.systems.first(), images.first()) else {
            return Err("the preset has no smoke".into());
        };
        Ok(Self {
            device: device.clone(),
            queue: queue.clone(),
            scene: Scene::new(device),
            start: Instant::now(),
            smoke,
            material: context.create_material(images)?,
            emitter: system.emitter.clone(),
            particles: Vec::new(),
            settings: system.settings,
        })
    }

    fn draw(&mut self, app: &AppWindow) -> Result<(), Failure> {
        let size = app.window().size();
        let size = UVec2::new(size.width, size.height).clamp(UVec2::ONE, UVec2::splat(4096));
        // The column is there from the start.
        let time = 14.0 + self.start.elapsed().as_secs_f64();
        let angle = 0.2 * time as f32;
        let view = View::new(
            rh::view::look_at_mat4(vec3(7.0 * angle.sin(), 2.4, 7.0 * angle.cos()), vec3(0.0, 1.7, 0.0), Vec3::Y),
            rh::proj::directx::perspective(0.8, size.x as f32 / size.y as f32, 0.1, 100.0),
            size,
        );
        self.emitter.evaluate(time, &mut self.particles);
        self.settings.boost = app.get_thickness();
        let lamp = Light {
            position: vec3(-2.5, 3.0, 2.0),
            color: vec3(1.0, 0.7, 0.4),
            intensity: app.get_lamp(),
            ..Light::default()
        };
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let targets = self.scene.draw(&self.device, &self.queue, &mut encoder, &view, &lamp);
        let frame = FrameInput {
            lights: &[lamp],
            systems: &[ParticleSystem::new(0, Particles::Slice(&self.particles), &self.settings, &self.material)],
            time,
            ..FrameInput::new(view, SceneDepth::Buffer(&targets.depth))
        };
        self.smoke.prepare(&mut encoder, &frame)?;
        self.smoke.render(&mut targets.pass(&mut encoder, None));
        self.queue.submit([encoder.finish()]);
        app.set_view(slint::Image::try_from(targets.color.clone())?);
        app.window().request_redraw();
        Ok(())
    }
}
