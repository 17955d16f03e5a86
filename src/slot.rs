//! One particle system's place in the renderer: its buffers, its targets, and what this frame draws with them.

use glam::UVec2;

use crate::bounds::{Bounds, TargetRect, effective_scale};
use crate::descriptor::Descriptor;
use crate::frame::{Frame, Particles, SceneDepth, System};
use crate::gpu_types::{LightUniform, SystemUniform};
use crate::particle::{Particle, bounds_of};
use crate::pass::accumulate::{AccumulateKey, DepthTest};
use crate::pass::forward::ForwardKey;
use crate::pass::sort::{SortScratch, back_to_front};
use crate::pass::transfer::TransferKey;
use crate::pass::{LIGHTS_SIZE, Layouts, uniform_buffer};
use crate::renderer::{MemoryUse, Passes, TargetViews};
use crate::settings::{DepthSource, Settings, ShadeTree, Technique};
use crate::sprite_key::SpriteKey;
use crate::system::{SystemInView, lights_in_view, system_in_view};
use crate::targets::{Targets, TargetsKey};
use crate::view::ViewGeometry;

/// Buffers and targets of one system, and this frame's draws.
#[derive(Debug)]
pub(crate) struct Slot {
    uniform: wgpu::Buffer,
    lights: wgpu::Buffer,
    pub bindings: wgpu::BindGroup,
    instances: Option<wgpu::Buffer>,
    pub targets: Option<Targets>,
    scratch: Scratch,
    /// `None` when out of sight.
    pub draw: Option<Draw>,
}

/// Memory kept from frame to frame.
#[derive(Debug, Default)]
struct Scratch {
    lights: Vec<LightUniform>,
    sort: SortScratch,
    sorted: Vec<Particle>,
}

/// What one frame records for a system.
#[derive(Debug)]
pub(crate) struct Draw {
    /// View depth of the box's middle.
    pub distance: f32,
    pub rect: TargetRect,
    pub scale: u32,
    pub depth_limit: f32,
    /// The scene's depth is read from the linear target.
    pub linear_depth: bool,
    pub debug_loop: u32,
    pub material: wgpu::BindGroup,
    pub instances: wgpu::Buffer,
    pub instance_count: u32,
    pub path: DrawPath,
}

#[derive(Debug)]
pub(crate) enum DrawPath {
    Deferred {
        depth_downsample: Option<wgpu::RenderPipeline>,
        /// The same for the targets' copy of the reduced depth.
        depth_copy: Option<wgpu::RenderPipeline>,
        diffuse_bake: Option<wgpu::RenderPipeline>,
        accumulate: wgpu::RenderPipeline,
        /// The depth that the hardware tests sprites against.
        tested_depth: Option<wgpu::TextureView>,
        transfer: Option<wgpu::RenderPipeline>,
        specular_scatter: Option<(wgpu::RenderPipeline, u32)>,
    },
    Forward(wgpu::RenderPipeline),
}

impl Slot {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let uniform = uniform_buffer(device, "haze system", size_of::<SystemUniform>() as u64);
        let lights = uniform_buffer(device, "haze lights", LIGHTS_SIZE);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("haze system"),
            layout: &layouts.system,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: lights.as_entire_binding() },
            ],
        });
        Self { uniform, lights, bindings, instances: None, targets: None, scratch: Scratch::default(), draw: None }
    }

    pub fn is_in_sight(&self) -> bool {
        self.draw.is_some()
    }

    pub fn distance(&self) -> f32 {
        self.draw.as_ref().map_or(0.0, |draw| draw.distance)
    }

    pub fn memory_use(&self) -> MemoryUse {
        let instances = self.instances.as_ref().map_or(0, wgpu::Buffer::size);
        MemoryUse {
            targets: self.targets.as_ref().map_or(0, |targets| targets.bytes),
            buffers: self.uniform.size() + self.lights.size() + instances,
        }
    }

    pub fn target_views(&self) -> Option<TargetViews<'_>> {
        let (draw, targets) = (self.draw.as_ref()?, self.targets.as_ref()?);
        Some(TargetViews {
            accumulation: &targets.accumulation,
            reduced_depth: targets.reduced_depth.as_ref(),
            origin: draw.rect.origin,
            size: draw.rect.size,
            scale: draw.scale,
            depth_limit: draw.depth_limit,
        })
    }

    /// Places the system in the view, uploads what the passes read and picks their pipelines.
    #[allow(clippy::too_many_arguments, reason = "the renderer's own parts, borrowed one by one")]
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        passes: &mut Passes,
        descriptor: &Descriptor,
        view: &ViewGeometry,
        frame: &Frame<'_>,
        system: &System<'_>,
    ) {
        self.draw = None;
        let bounds = bounds_of_system(system);
        lights_in_view(view, frame.lights, &bounds, &mut self.scratch.lights);
        let info = &system.material.info;
        let Some(in_view) = system_in_view(view, &bounds, system.settings, info, &self.scratch.lights, frame.time)
        else {
            return;
        };
        let Some((instances, instance_count)) = self.write_particles(device, queue, view, system) else {
            return;
        };
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&in_view.uniform));
        queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&self.scratch.lights));

        let linear_depth = reads_linear(layouts, &frame.scene_depth, system.settings);
        let path = if system.settings.is_forward() {
            self.targets = None;
            if !matches!(frame.shade_tree, ShadeTree::Final | ShadeTree::Combined) {
                return;
            }
            DrawPath::Forward(passes.forward.pipeline(device, forward_key(view, linear_depth, system.settings)))
        } else {
            self.fit_targets(device, layouts, view, &in_view, frame.scene_depth.read_by(linear_depth), system.settings);
            self.deferred(device, passes, descriptor, view, &in_view, linear_depth, frame, system.settings)
        };
        self.draw = Some(Draw {
            distance: -view.view_position(bounds.centre()).z,
            rect: in_view.rect,
            scale: in_view.uniform.scale as u32,
            depth_limit: in_view.uniform.depth_limit,
            linear_depth,
            debug_loop: system.settings.sprite.debug_loop,
            material: system.material.bind_group.clone(),
            instances,
            instance_count,
            path,
        });
    }

    fn write_particles(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        view: &ViewGeometry,
        system: &System<'_>,
    ) -> Option<(wgpu::Buffer, u32)> {
        let particles = match system.particles {
            Particles::Buffer { buffer, count } => return (count > 0).then(|| (buffer.clone(), count)),
            Particles::Slice(particles) => particles,
        };
        let Scratch { sort, sorted, .. } = &mut self.scratch;
        back_to_front(view, particles, sort, sorted);
        if sorted.is_empty() {
            return None;
        }
        let bytes: &[u8] = bytemuck::cast_slice(sorted);
        let buffer = match &self.instances {
            Some(buffer) if buffer.size() >= bytes.len() as u64 => buffer.clone(),
            _ => device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("haze particles"),
                size: (bytes.len() as u64).next_power_of_two().min(device.limits().max_buffer_size),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        };
        queue.write_buffer(&buffer, 0, bytes);
        self.instances = Some(buffer.clone());
        Some((buffer, sorted.len() as u32))
    }

    fn fit_targets(
        &mut self,
        device: &wgpu::Device,
        layouts: &Layouts,
        view: &ViewGeometry,
        in_view: &SystemInView,
        depth: &wgpu::TextureView,
        settings: &Settings,
    ) {
        let accumulate = &settings.accumulate;
        let key = TargetsKey {
            format: accumulate.format,
            depth_source: accumulate.depth_source,
            diffuse_mode: settings.diffuse.mode,
        };
        if self.targets.as_ref().is_some_and(|targets| targets.fits(key, &in_view.rect, depth)) {
            return;
        }
        // The old textures go before the new ones come.
        self.targets = None;
        let scale = effective_scale(accumulate.scale, accumulate.max_side, view.view.size);
        let limit = UVec2::new(view.view.size.x.div_ceil(scale), view.view.size.y.div_ceil(scale));
        self.targets = Some(Targets::new(device, layouts, key, &in_view.rect, limit, depth));
    }

    #[allow(clippy::too_many_arguments, reason = "the renderer's own parts, borrowed one by one")]
    fn deferred(
        &self,
        device: &wgpu::Device,
        passes: &mut Passes,
        descriptor: &Descriptor,
        view: &ViewGeometry,
        in_view: &SystemInView,
        linear_depth: bool,
        frame: &Frame<'_>,
        settings: &Settings,
    ) -> DrawPath {
        let accumulate = &settings.accumulate;
        let shade_tree = frame.shade_tree;
        let (depth_test, tested_depth) = self.depth_test(view, frame, settings);
        let glows = matches!(shade_tree, ShadeTree::Final | ShadeTree::SpecularScatter)
            && settings.specular_scatter.intensity > 0.0
            && !self.scratch.lights.is_empty();
        DrawPath::Deferred {
            depth_downsample: (accumulate.depth_source == DepthSource::Reduced)
                .then(|| passes.depth_downsample.pipeline(device, accumulate.depth_downsample, false)),
            depth_copy: (depth_test == DepthTest::Copy)
                .then(|| passes.depth_downsample.pipeline(device, accumulate.depth_downsample, true)),
            diffuse_bake: passes.diffuse_bake.pipeline(device, settings.diffuse.mode),
            accumulate: passes.accumulate.pipeline(
                device,
                AccumulateKey {
                    format: accumulate.format,
                    encoding: accumulate.encoding,
                    sprite: SpriteKey::new(settings, linear_depth),
                    host_depth: accumulate.depth_source == DepthSource::Host,
                    depth_test,
                    overdraw: shade_tree == ShadeTree::Overdraw,
                },
            ),
            tested_depth,
            transfer: (shade_tree != ShadeTree::SpecularScatter).then(|| {
                passes.transfer.pipeline(
                    device,
                    TransferKey {
                        encoding: accumulate.encoding,
                        decode: accumulate.decode,
                        diffuse_mode: settings.diffuse.mode,
                        soft_scatter_mode: settings.soft_scatter.mode,
                        upsample: accumulate.upsample,
                        host_depth: accumulate.depth_source == DepthSource::Host,
                        shade_tree,
                        back_faces: in_view.back_faces || descriptor.depth_format.is_none(),
                        reversed: view.depth.reversed,
                    },
                )
            }),
            specular_scatter: glows.then(|| {
                let pipeline = passes.specular_scatter.pipeline(device, accumulate.upsample);
                (pipeline, self.scratch.lights.len() as u32)
            }),
        }
    }

    /// What rejects hidden sprites, and the depth that it looks at.
    fn depth_test(
        &self,
        view: &ViewGeometry,
        frame: &Frame<'_>,
        settings: &Settings,
    ) -> (DepthTest, Option<wgpu::TextureView>) {
        if settings.fade_through() > 0.0 {
            return (DepthTest::InShader, None);
        }
        if settings.accumulate.depth_source == DepthSource::Host {
            let buffer = frame.scene_depth.buffer().cloned();
            let format = buffer.as_ref().map(|buffer| buffer.texture().format());
            return match format {
                Some(format) => (DepthTest::Host(format, view.depth.reversed), buffer),
                // Refused when the frame was validated.
                None => (DepthTest::InShader, None),
            };
        }
        match &self.targets {
            Some(Targets { depth_copy: Some(copy), .. }) => (DepthTest::Copy, Some(copy.clone())),
            Some(Targets { reduced_depth: Some(reduced), .. }) => (DepthTest::Reduced, Some(reduced.clone())),
            _ => (DepthTest::InShader, None),
        }
    }
}

/// True if a system reads the scene's linear target, not its depth buffer.
pub(crate) fn reads_linear(layouts: &Layouts, scene_depth: &SceneDepth<'_>, settings: &Settings) -> bool {
    match scene_depth {
        SceneDepth::Buffer(_) => false,
        SceneDepth::Linear(_) => true,
        // Where a depth buffer cannot be tested and read in one pass, it is left to the tests.
        SceneDepth::Both { .. } => settings.technique == Technique::SoftLinear || !layouts.read_only_depth,
    }
}

fn bounds_of_system(system: &System<'_>) -> Bounds {
    match (system.bounds, system.particles) {
        (Some(bounds), _) => bounds,
        (None, Particles::Slice(particles)) => bounds_of(particles, system.settings.reach()),
        // Refused when the frame was validated.
        (None, Particles::Buffer { .. }) => Bounds::EMPTY,
    }
}

fn forward_key(view: &ViewGeometry, linear_depth: bool, settings: &Settings) -> ForwardKey {
    ForwardKey {
        blend_mode: settings.blend_mode,
        sprite: SpriteKey::new(settings, linear_depth),
        age_colour: settings.sprite.age_colour > 0.0,
        shows_through: settings.fade_through() > 0.0,
        soft_scatter_mode: settings.soft_scatter.mode,
        reversed: view.depth.reversed,
    }
}
