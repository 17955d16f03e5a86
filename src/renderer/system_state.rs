//! State of one particle system in a renderer: its buffers, its targets, and its passes of the current frame.

use glam::{UVec2, Vec2, Vec3};

use super::auto::{PathChoice, PathChooser, PathWorkload, estimate_workload};
use super::context::Shared;
use super::counts::{FrameCounts, Overdraw};
use super::frame_bindings::FrameBindings;
use super::gpu::Gpu;
use super::gpu::idle_counter::IdleCounter;
use super::gpu::record::uniform_buffer;
use super::instances::{Instances, SortedBy};
use super::layouts::LIGHTS_SIZE;
use super::memory_use::{MemoryUse, TiledMemory};
use super::pass::Groups;
use super::plan::{PipelineInputs, Plan, plan};
use super::sprite_instances::Sprites;
use super::system_passes::{ParticlePass, PassBuilder, SystemPasses, TiledContext};
use super::system_targets::SystemTargets;
use super::targets::TargetViews;
use super::tiled::{EmittedParticles, SortedParticles, TiledSystem};
use super::validate_frame::tiled_unavailable_reason;
use crate::formula::uniforms::{LightUniform, SystemUniform, ViewUniform};
use crate::frame::{Bounds, Frame, Particle, Particles, System, particle_bounds};
use crate::settings::{Lighting, RenderPath, Settings, Technique};
use crate::view_setup::{
    SpriteProjector, SpriteTrim, SystemInput, SystemSetup, TexelGrid, ViewGeometry, light_uniforms, system_setup,
};

/// A frame, with the resources that every system needs.
pub(crate) struct FrameContext<'a> {
    pub gpu: Gpu<'a>,
    pub shared: &'a Shared,
    pub frame: &'a Frame<'a>,
    pub view: &'a ViewGeometry,
    /// Size of the host's targets, pixels.
    pub host_size: UVec2,
    pub inputs: &'a PipelineInputs<'a>,
    pub bindings: &'a FrameBindings,
}

/// Buffers and targets of one system, and its passes of the current frame.
#[derive(Debug)]
pub(crate) struct SystemState {
    /// Key of the system.
    pub key: u64,
    uniform: wgpu::Buffer,
    lights: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    light_uniforms: Vec<LightUniform>,
    instances: Instances,
    targets: SystemTargets,
    tiles: TiledSystem,
    emitted: EmittedParticles,
    depth_sorted: SortedParticles,
    /// Sample of an emitter's particles, for estimates.
    sample: Vec<Particle>,
    path_chooser: PathChooser,
    /// Counts frames without deferred drawing, after which the targets are released.
    frames_without_targets: IdleCounter,
    /// Counts frames without the path `tiled`, after which its buffers are released.
    frames_untiled: IdleCounter,
    /// Counts frames in which no host's particles were sorted, after which the sort's buffers are released.
    frames_unsorted: IdleCounter,
    /// Counts frames without the system, after which this state is dropped.
    frames_absent: IdleCounter,
    /// `None` if the system is out of sight.
    prepared: Option<PreparedSystem>,
}

#[derive(Debug)]
struct PreparedSystem {
    setup: SystemSetup,
    technique: Technique,
    trim: SpriteTrim,
    /// Choice of the path `auto`; `None` for any other path setting.
    choice: Option<PathChoice>,
    /// Number of particles that each one of `sample` represents, if the GPU evaluates the emitter; otherwise `None`.
    sampled: Option<u32>,
    particle_pass: Option<ParticlePass>,
    passes: SystemPasses,
}

impl SystemState {
    pub fn new(key: u64, shared: &Shared) -> Self {
        let device = &shared.device;
        let uniform = uniform_buffer(device, "haze system", size_of::<SystemUniform>() as u64);
        let lights = uniform_buffer(device, "haze lights", LIGHTS_SIZE);
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("haze system"),
            layout: &shared.layouts.system,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: lights.as_entire_binding() },
            ],
        });
        Self {
            key,
            uniform,
            lights,
            bindings,
            light_uniforms: Vec::new(),
            instances: Instances::default(),
            targets: SystemTargets::default(),
            tiles: TiledSystem::default(),
            emitted: EmittedParticles::default(),
            depth_sorted: SortedParticles::default(),
            sample: Vec::new(),
            path_chooser: PathChooser::default(),
            frames_without_targets: IdleCounter::default(),
            frames_untiled: IdleCounter::default(),
            frames_unsorted: IdleCounter::default(),
            frames_absent: IdleCounter::default(),
            prepared: None,
        }
    }

    /// Returns this frame's passes; `None` if the system is out of sight.
    pub fn passes(&self) -> Option<&SystemPasses> {
        self.prepared.as_ref().map(|prepared| &prepared.passes)
    }

    /// Returns the pass that produces the system's particles. It runs before all other passes.
    pub fn particle_pass(&self) -> Option<&ParticlePass> {
        self.prepared.as_ref()?.particle_pass.as_ref()
    }

    /// Returns this frame's choice of the path `auto`.
    pub fn choice(&self) -> Option<PathChoice> {
        self.prepared.as_ref()?.choice
    }

    /// Returns the view depth of the smoke's centre, metres.
    pub fn distance(&self) -> f32 {
        self.prepared.as_ref().map_or(0.0, |prepared| prepared.setup.distance)
    }

    pub fn memory_use(&self) -> MemoryUse {
        let emitted = TiledMemory { emitted: self.emitted.bytes(), ..TiledMemory::default() };
        let tiled = emitted + self.tiles.memory() + self.depth_sorted.memory();
        let buffers = self.uniform.size() + self.lights.size() + self.instances.bytes() + tiled.total();
        MemoryUse { targets: self.targets.bytes(), buffers, tiled }
    }

    pub fn counts(&self) -> FrameCounts {
        let (sprites, texels) = match &self.prepared {
            None => return FrameCounts::default(),
            Some(PreparedSystem { passes: SystemPasses::Forward(forward), .. }) => (&forward.sprites, UVec2::ZERO),
            Some(PreparedSystem { passes: SystemPasses::Deferred(passes), setup, .. }) => {
                (&passes.sprites, setup.rect.size)
            }
        };
        FrameCounts {
            systems: 1,
            sprites: u64::from(sprites.count) * u64::from(sprites.loops),
            texels: u64::from(texels.x) * u64::from(texels.y),
        }
    }

    /// Computes the overdraw of the system in `view`.
    pub fn overdraw(&self, view: &ViewUniform) -> Overdraw {
        let Some(PreparedSystem { setup, technique, trim, sampled, passes, .. }) = &self.prepared else {
            return Overdraw::default();
        };
        let (particles, each) = match *sampled {
            Some(each) => (self.sample.as_slice(), f64::from(each)),
            None => (self.instances.particles(), 1.0),
        };
        if particles.is_empty() {
            return Overdraw::default();
        }
        let (sprites, grid) = match passes {
            SystemPasses::Forward(forward) => {
                (&forward.sprites, TexelGrid { origin: Vec2::ZERO, scale: 1.0, size: view.size.as_uvec2() })
            }
            SystemPasses::Deferred(passes) => (&passes.sprites, setup.grid()),
        };
        let projector = SpriteProjector { view, system: &setup.uniform, technique: *technique, trim };
        let side = (setup.pixels.as_dvec2() / f64::from(grid.scale)).ceil();
        let fragments = f64::from(sprites.loops) * each * projector.fragments(&grid, particles);
        Overdraw { fragments, texels: side.x * side.y }
    }

    pub fn target_views(&self) -> Option<TargetViews<'_>> {
        let PreparedSystem { setup, passes: SystemPasses::Deferred(_), .. } = self.prepared.as_ref()? else {
            return None;
        };
        let (accumulation, baked_diffuse) = self.targets.textures()?;
        Some(TargetViews {
            accumulation: &accumulation.attachments,
            roles: accumulation.roles(),
            reduced_depth: accumulation.reduced_depth.as_ref(),
            baked_diffuse: &baked_diffuse.faces,
            origin: setup.rect.origin,
            size: setup.rect.size,
            scale: setup.uniform.scale as u32,
            depth_limit: setup.uniform.depth_limit,
            lit_depth: setup.lit_depth,
        })
    }

    /// Counts a frame in which the system may be missing. Returns true once it has been missing for more than 120
    /// frames in a row.
    pub fn tick_absence(&mut self, is_missing: bool) -> bool {
        if is_missing {
            self.prepared = None;
        }
        self.frames_absent.tick(is_missing)
    }

    /// Places the system in the view, uploads its data, and prepares targets and pipelines.
    pub fn write(&mut self, context: &FrameContext<'_>, system: &System<'_>) {
        self.prepared = self.prepare(context, system);
        let is_deferred = matches!(self.passes(), Some(SystemPasses::Deferred(_)));
        if self.frames_without_targets.tick(!is_deferred) {
            self.targets = SystemTargets::default();
        }
        let is_tiled = matches!(self.passes(), Some(SystemPasses::Deferred(passes)) if passes.accumulate.is_tiled());
        if self.frames_untiled.tick(!is_tiled) {
            (self.tiles, self.emitted) = (TiledSystem::default(), EmittedParticles::default());
        }
        if self.frames_unsorted.tick(!matches!(self.particle_pass(), Some(ParticlePass::DepthSort(..)))) {
            self.depth_sorted = SortedParticles::default();
        }
    }

    fn prepare(&mut self, context: &FrameContext<'_>, system: &System<'_>) -> Option<PreparedSystem> {
        let FrameContext { gpu, shared, frame, view, .. } = context;
        let settings = system.settings;
        let bounds = bounds_of_system(system);
        light_uniforms(view, frame.lights, &bounds, &mut self.light_uniforms);
        let known = known_particles(system.particles, &mut self.sample);
        let (particles, particles_per_sample) = known.unwrap_or((&[], 1));
        let in_world = SystemInput {
            bounds: &bounds,
            depth: system.depth,
            particles,
            particles_per_sample,
            settings,
            material: &system.material.info,
            lights: &self.light_uniforms,
            up: frame.up.normalize_or(Vec3::Y),
            time: frame.time,
        };
        let setup = system_setup(view, context.host_size, &in_world)?;
        let workload = matches!(settings.path, RenderPath::Auto | RenderPath::Tiled).then(|| {
            let view = view.uniform(false);
            let trim = SpriteTrim::new(settings, &system.material.info);
            let projector =
                SpriteProjector { view: &view, system: &setup.uniform, technique: settings.technique, trim: &trim };
            estimate_workload(&projector, &setup.grid(), system.particles.count(), known, settings)
        });
        let choice = choose(&mut self.path_chooser, shared, system, workload.as_ref());
        let lighting = if shared.six_way { settings.lighting } else { Lighting::Normals };
        let settings = &Settings { path: choice.map_or(settings.path, |choice| choice.path), lighting, ..*settings };
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&setup.uniform));
        gpu.queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&self.light_uniforms));

        let trim = SpriteTrim::new(settings, &system.material.info);
        let sprite = settings.sprite.for_frames(system.material.info.frame_count);
        let plan = plan(context.inputs, &Settings { sprite, ..*settings }, setup.back_faces);
        let depth = context.bindings.get(plan.reads_linear_target())?;
        let groups = Groups {
            frame: depth.frame.clone(),
            system: self.bindings.clone(),
            material: system.material.bind_group.clone(),
            lighting: system.material.lighting.clone(),
        };
        let (sprites, particle_pass) = self.particles(context, system.particles, settings, &groups)?;
        let sampled = matches!(particle_pass, Some(ParticlePass::Emit(_))).then_some(particles_per_sample);
        let builder = PassBuilder { gpu: *gpu, pipelines: &shared.pipelines, groups, sprites };
        let passes = match &plan {
            Plan::Skip => return None,
            Plan::Forward(plan) => builder.forward(plan),
            Plan::Deferred(plan) => {
                let scale = settings.accumulate.effective_scale(view.size);
                let limit = UVec2::new(view.size.x.div_ceil(scale), view.size.y.div_ceil(scale));
                let targets = self.targets.ensure(shared, settings, plan, setup.rect.size, limit);
                let tiles = TiledContext { system: &mut self.tiles, workload: workload.as_ref() };
                builder.deferred(plan, tiles, targets, &setup, depth, frame.scene_depth.buffer())
            }
        };
        Some(PreparedSystem { setup, technique: settings.technique, trim, choice, sampled, particle_pass, passes })
    }

    /// Uploads the particles, or prepares the pass that produces them. Returns `None` if there is nothing to draw.
    fn particles(
        &mut self,
        context: &FrameContext<'_>,
        particles: Particles<'_>,
        settings: &Settings,
        groups: &Groups,
    ) -> Option<(Sprites, Option<ParticlePass>)> {
        let FrameContext { gpu, shared, view, .. } = context;
        let is_tiled = settings.path == RenderPath::Tiled;
        if let (Particles::Emitter(emission), Some(tiled), true) = (particles, &shared.pipelines.tiled, is_tiled) {
            self.instances = Instances::default();
            let (sprites, emit) = self.emitted.write(gpu, tiled, emission, settings.sprite.debug_loop)?;
            return Some((sprites, Some(ParticlePass::Emit(emit))));
        }
        let sorted_by = shared.tiles().filter(|_| is_tiled);
        let sorted_by = sorted_by.map(|cooperative| if cooperative { SortedBy::Gpu } else { SortedBy::Cpu });
        let sprites = self.instances.write(gpu, view, particles, settings, sorted_by)?;
        match &shared.pipelines.tiled {
            Some(tiled) if !is_tiled && particles.need_sorting(settings) => {
                let (sprites, sort) = self.depth_sorted.write(gpu, tiled, &sprites);
                Some((sprites, Some(ParticlePass::DepthSort(sort, groups.clone()))))
            }
            _ => Some((sprites, None)),
        }
    }
}

/// Chooses the path if the setting is `auto`; otherwise returns `None`.
fn choose(
    path_chooser: &mut PathChooser,
    shared: &Shared,
    system: &System<'_>,
    workload: Option<&PathWorkload>,
) -> Option<PathChoice> {
    let Some(workload) = workload.filter(|_| system.settings.path == RenderPath::Auto) else {
        *path_chooser = PathChooser::default();
        return None;
    };
    if let Some(reason) = tiled_unavailable_reason(shared, system) {
        return Some(PathChoice { path: RenderPath::Raster, reason });
    }
    Some(path_chooser.choose(&shared.path_model(), workload))
}

/// Returns the particles that the CPU knows, and the number of particles that each represents. `None` for a host's
/// buffer.
fn known_particles<'a>(particles: Particles<'a>, sample: &'a mut Vec<Particle>) -> Option<(&'a [Particle], u32)> {
    match particles {
        Particles::Slice(particles) => Some((particles, 1)),
        Particles::Buffer { .. } => None,
        Particles::Emitter(emission) => {
            emission.sample(sample);
            Some((sample, emission.step))
        }
    }
}

fn bounds_of_system(system: &System<'_>) -> Bounds {
    match (system.bounds, system.particles) {
        (Some(bounds), _) => bounds,
        (None, Particles::Slice(particles)) => particle_bounds(particles, system.settings.sprite_extent()),
        (None, Particles::Emitter(emission)) => emission.bounds(system.settings.sprite_extent()),
        // `validate` refuses a buffer without bounds.
        (None, Particles::Buffer { .. }) => Bounds::EMPTY,
    }
}
