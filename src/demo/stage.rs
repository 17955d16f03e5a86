//! A shot on the GPU: its scene, drawn once, and a renderer for the smoke, kept from frame to frame.

use std::time::{Duration, Instant};

use glam::{Vec3, Vec4};

use super::gpu::{self, SceneTargets};
use super::shot::Shot;
use crate::assets::picture::Picture;
use crate::error::Error;
use crate::frame::{Frame, Material, Particles, SceneDepth, System, View};
use crate::headless::Headless;
use crate::renderer::{Descriptor, Renderer, read_only_depth_is_supported};

/// See the module.
#[derive(Debug)]
pub struct Stage<'a> {
    gpu: &'a Headless,
    view: View,
    targets: SceneTargets,
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    linear: Option<wgpu::TextureView>,
    tests_depth: bool,
    renderer: Renderer,
    materials: Vec<Material>,
}

impl<'a> Stage<'a> {
    /// Draws the scene. `exact_filtering` as in [`Descriptor`].
    ///
    /// # Errors
    /// [`Error::Field`] when a picture is too large for the device, [`Error::Device`] when the device failed.
    pub fn new(gpu: &'a Headless, shot: &Shot, exact_filtering: bool) -> Result<Self, Error> {
        let view = shot.preset.camera.view(shot.size);
        let targets = gpu::render(gpu, &shot.scene(), &view)?;
        let whole = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let linear = targets.linear.as_ref().map(whole);
        // The depth buffer is attached where it need not be read, or can be all the same.
        let tests_depth = linear.is_some() || read_only_depth_is_supported(&gpu.device);
        let renderer = Renderer::new(
            &gpu.device,
            &gpu.queue,
            &Descriptor {
                color_format: gpu::COLOUR_FORMAT,
                depth_format: tests_depth.then_some(gpu::DEPTH_FORMAT),
                exact_filtering,
                ..Descriptor::default()
            },
        )?;
        let upload = |assets| renderer.create_material(&gpu.device, &gpu.queue, assets);
        let materials = shot.materials.iter().map(upload).collect::<Result<_, _>>()?;
        let (colour, depth) = (whole(&targets.colour), whole(&targets.depth));
        Ok(Self { gpu, view, targets, colour, depth, linear, tests_depth, renderer, materials })
    }

    /// Draws the smoke of a shot in the same scene over what is there, and tells how long the device took.
    ///
    /// # Errors
    /// [`Error::Field`] when the preset was changed to something invalid, [`Error::Device`] when the device failed.
    pub fn draw(&mut self, shot: &Shot) -> Result<Duration, Error> {
        let particles = shot.systems();
        let systems: Vec<_> = (0..)
            .zip(particles.iter().zip(&self.materials))
            .map(|(key, ((particles, settings), material))| System {
                key,
                ..System::new(Particles::Slice(particles), settings, material)
            })
            .collect();
        let frame = Frame {
            view: self.view,
            scene_depth: match &self.linear {
                Some(linear) => SceneDepth::Both { buffer: &self.depth, linear },
                None => SceneDepth::Buffer(&self.depth),
            },
            lights: &shot.preset.lights,
            systems: &systems,
            time: shot.preset.time,
            up: Vec3::Y,
            stages: &[shot.shade_tree],
        };
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.renderer.prepare(device, queue, &mut encoder, &frame)?;
        let load = if shot.shows_scene() { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("smoke"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &self.colour,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: self.tests_depth.then_some(wgpu::RenderPassDepthStencilAttachment {
                    view: &self.depth,
                    depth_ops: None,
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            self.renderer.render_stage(&mut pass, shot.shade_tree);
        }
        let start = Instant::now();
        self.gpu.submit(encoder)?;
        Ok(start.elapsed())
    }

    /// Reads the picture back, linear HDR.
    ///
    /// # Errors
    /// [`Error::Device`] when the device failed.
    pub fn picture(&self) -> Result<Picture<Vec4>, Error> {
        let texels = self.gpu.read_rgba16float(&self.targets.colour)?;
        Ok(Picture { size: self.view.size, texels })
    }
}
