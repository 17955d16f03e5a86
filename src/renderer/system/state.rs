//! State of one particle system in a renderer: its buffers, its targets, and its passes of the current frame.

use haze_core::assets::material_assets::MaterialInfo;
use haze_core::formula::uniforms::{LightUniform, SystemUniform, ViewUniform};
use haze_core::frame::{Bounds, Particle};
use haze_core::glam::{UVec2, Vec2, Vec3};
use haze_core::settings::{RenderPath, Technique};
use haze_core::view_setup::{
    DrawOrder, LightingChoice, ParticleSpace, ResolvedSettings, ScaleChoice, SpriteProjector, SpriteTrim, SystemInput,
    SystemSetup, TexelGrid, ViewGeometry, caster_uniform, light_uniforms, system_setup,
};

use super::alive_copy::AliveCopy;
use super::particles::SystemParticles;
use super::passes::{AccumulatePasses, DeferredInputs, DeferredPasses, ParticlePass, PassBuilder, SystemPasses};
use super::targets::SystemTargets;
use crate::frame::{ParticleSystem, Particles};
use crate::renderer::auto::{PathChoice, PathChooser, PathWorkload, estimate_workload};
use crate::renderer::context::Shared;
use crate::renderer::counts::{FrameCounts, Overdraw};
use crate::renderer::frame_bindings::DepthBindings;
use crate::renderer::frame_context::FrameContext;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::renderer::gpu::record::uniform_buffer;
use crate::renderer::layouts::LIGHTS_SIZE;
use crate::renderer::memory_use::MemoryUse;
use crate::renderer::pass::density_splat::DensitySplat;
use crate::renderer::pass::depth_downsample::REDUCED_DEPTH;
use crate::renderer::pass::groups::Groups;
use crate::renderer::pass::measure::Measure;
use crate::renderer::plan::{Plan, plan};
use crate::renderer::support::tiled_unavailable_reason;
use crate::renderer::targets::{SystemTextures, TargetViews};
use crate::renderer::tiled::{TiledPasses, TiledSystem};

/// Buffers and targets of one system, and its passes of the current frame.
#[derive(Debug)]
pub(crate) struct SystemState {
    /// Key of the system.
    pub key: u64,
    uniform: wgpu::Buffer,
    lights: wgpu::Buffer,
    bindings: SystemBindings,
    /// Placement, settings and box of the current frame.
    measured: Option<MeasuredSystem>,
    light_uniforms: Vec<LightUniform>,
    particles: SystemParticles,
    targets: SystemTargets,
    tiles: TiledSystem,
    path_chooser: PathChooser,
    /// Scale of the last frame, if it was chosen.
    chosen_scale: Option<u32>,
    /// Counts frames without deferred drawing, after which the targets are released.
    frames_without_targets: IdleCounter,
    /// Counts frames without the path `tiled`, after which its buffers are released.
    frames_untiled: IdleCounter,
    /// Counts frames without the system, after which this state is dropped.
    frames_absent: IdleCounter,
    /// `None` if the system is out of sight.
    prepared: Option<PreparedSystem>,
    /// A system out of sight that casts shadow.
    hidden: Option<HiddenSystem>,
}

/// Bind group 1, and the volume that it binds.
#[derive(Debug)]
struct SystemBindings {
    group: wgpu::BindGroup,
    /// The same without the volume, for passes that run while it is written.
    without_shadow: wgpu::BindGroup,
    optical_depths: wgpu::TextureView,
}

/// A system before it is placed in the view.
#[derive(Clone, Copy, Debug)]
struct MeasuredSystem {
    space: ParticleSpace,
    settings: ResolvedSettings,
    /// Box that contains every sprite, world space.
    bounds: Bounds,
}

#[derive(Debug)]
struct PreparedSystem {
    setup: SystemSetup,
    technique: Technique,
    trim: SpriteTrim,
    /// Choice of the path `auto`; `None` for any other path setting.
    choice: Option<PathChoice>,
    /// Choice of the lighting resolution `auto`; `None` for any other, and for forward smoke.
    lighting_choice: Option<LightingChoice>,
    /// Choice of the scale mode `auto`; `None` for a fixed scale.
    scale_choice: Option<ScaleChoice>,
    caster: CasterPasses,
    passes: SystemPasses,
}

/// A system out of sight that casts shadow.
#[derive(Debug)]
struct HiddenSystem {
    uniform: SystemUniform,
    caster: CasterPasses,
}

/// Passes that prepare the particles and cast their shadow.
#[derive(Debug)]
struct CasterPasses {
    alive: Option<AliveCopy>,
    measure: Option<Measure>,
    particle_pass: Option<ParticlePass>,
    splat: Option<DensitySplat>,
}

impl SystemState {
    pub fn new(key: u64, shared: &Shared) -> Self {
        let device = &shared.device;
        let uniform = uniform_buffer(device, "haze system", size_of::<SystemUniform>() as u64);
        let lights = uniform_buffer(device, "haze lights", LIGHTS_SIZE);
        let bindings = SystemBindings::new(shared, &uniform, &lights, &shared.no_shadow);
        Self {
            key,
            uniform,
            lights,
            bindings,
            measured: None,
            light_uniforms: Vec::new(),
            particles: SystemParticles::default(),
            targets: SystemTargets::default(),
            tiles: TiledSystem::default(),
            path_chooser: PathChooser::default(),
            chosen_scale: None,
            frames_without_targets: IdleCounter::default(),
            frames_untiled: IdleCounter::default(),
            frames_absent: IdleCounter::default(),
            prepared: None,
            hidden: None,
        }
    }

    /// Returns this frame's passes; `None` if the system is out of sight.
    pub fn passes(&self) -> Option<&SystemPasses> {
        self.prepared.as_ref().map(|prepared| &prepared.passes)
    }

    fn caster(&self) -> Option<&CasterPasses> {
        let in_sight = self.prepared.as_ref().map(|prepared| &prepared.caster);
        in_sight.or(self.hidden.as_ref().map(|hidden| &hidden.caster))
    }

    /// Returns this frame's passes of the path `tiled`.
    pub fn tiled_passes(&self) -> Option<&TiledPasses> {
        match self.passes()? {
            SystemPasses::Deferred(DeferredPasses { accumulate: AccumulatePasses::Tiled(tiled), .. }) => Some(tiled),
            _ => None,
        }
    }

    /// Returns the copy of the number of a host's particles, if only the GPU knows it. It comes before all passes.
    pub fn alive(&self) -> Option<&AliveCopy> {
        self.caster()?.alive.as_ref()
    }

    /// Returns the pass that measures a host's particles. It runs before all other passes.
    pub fn measure(&self) -> Option<&Measure> {
        self.caster()?.measure.as_ref()
    }

    /// Returns the pass that produces the system's particles. It runs before all other passes.
    pub fn particle_pass(&self) -> Option<&ParticlePass> {
        self.caster()?.particle_pass.as_ref()
    }

    /// Returns the pass that adds the system to the density grid of the frame. It comes after the particles are produced.
    pub fn splat(&self) -> Option<&DensitySplat> {
        self.caster()?.splat.as_ref()
    }

    /// Returns the particles that the CPU adds to the density grid of the frame, with the uniforms of the system.
    /// `particles`: those of the frame.
    pub fn cast<'a>(&'a self, particles: Particles<'a>) -> Option<(&'a SystemUniform, &'a [Particle])> {
        let in_sight = self.prepared.as_ref().map(|prepared| &prepared.setup.uniform);
        let uniform = in_sight.or(self.hidden.as_ref().map(|hidden| &hidden.uniform))?;
        Some((uniform, self.particles.instances(particles)))
    }

    /// Returns this frame's choice of the path `auto`.
    pub fn choice(&self) -> Option<PathChoice> {
        self.prepared.as_ref()?.choice
    }

    /// Returns this frame's choice of the lighting resolution `auto`.
    pub fn lighting_choice(&self) -> Option<LightingChoice> {
        self.prepared.as_ref()?.lighting_choice
    }

    /// Returns this frame's choice of the scale mode `auto`.
    pub fn scale_choice(&self) -> Option<ScaleChoice> {
        self.prepared.as_ref()?.scale_choice
    }

    /// Returns when the system is drawn.
    pub fn draw_order(&self) -> DrawOrder {
        self.prepared.as_ref().map_or_else(DrawOrder::default, |prepared| prepared.setup.draw_order)
    }

    /// Returns the view depth of the smoke's center in the host's view space, metres.
    pub fn lit_depth(&self) -> f32 {
        self.prepared.as_ref().map_or(0.0, |prepared| prepared.setup.lit_depth)
    }

    pub fn memory_use(&self) -> MemoryUse {
        let tiled = self.tiles.memory() + self.particles.tiled_memory();
        let buffers = self.uniform.size() + self.lights.size() + self.particles.instance_bytes() + tiled.total();
        MemoryUse { targets: self.targets.bytes(), buffers, tiled, ..MemoryUse::default() }
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
        let Some(PreparedSystem { setup, technique, trim, passes, .. }) = &self.prepared else {
            return Overdraw::default();
        };
        let (particles, each) = self.particles.estimate_sample();
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
        let fragments = f64::from(sprites.loops) * f64::from(each) * projector.fragments(&grid, particles);
        Overdraw { fragments, texels: side.x * side.y }
    }

    pub fn target_views(&self) -> Option<TargetViews<'_>> {
        let PreparedSystem { setup, passes: SystemPasses::Deferred(_), .. } = self.prepared.as_ref()? else {
            return None;
        };
        let SystemTextures { accumulation, baked_diffuse } = self.targets.textures()?;
        Some(TargetViews {
            accumulation: &accumulation.attachments,
            roles: accumulation.roles(),
            reduced_depth: accumulation.get(&REDUCED_DEPTH),
            baked_diffuse: &baked_diffuse.faces,
            origin: setup.rect.origin,
            size: setup.rect.size,
            scale: setup.rect.scale,
            depth_limit: setup.uniform.depth_limit,
            lit_depth: setup.lit_depth,
            smoke_depths: self.measure().is_none().then_some([setup.uniform.smoke_near, setup.uniform.smoke_far]),
        })
    }

    /// Counts a frame in which the system may be missing. Returns true once it has been missing for more than 120
    /// frames in a row.
    pub fn tick_absence(&mut self, is_missing: bool) -> bool {
        if is_missing {
            self.prepared = None;
            self.hidden = None;
        }
        self.frames_absent.tick(is_missing)
    }

    /// Measures the system. Returns the box of the smoke that casts shadow, and the settings, for the shadow of the frame.
    pub fn measure_box(
        &mut self,
        shared: &Shared,
        view: &ViewGeometry,
        system: &ParticleSystem<'_, '_>,
    ) -> (Bounds, ResolvedSettings) {
        let space = ParticleSpace::new(view, &system.world_from_particles);
        let MaterialInfo { frame_count, ramp_steps, .. } = &system.material.info;
        let settings =
            ResolvedSettings::new(system.settings, space.scale, view.size, *frame_count, ramp_steps, shared.support);
        let boxes = self.particles.measure(view, &space, system, &settings);
        self.measured = Some(MeasuredSystem { space, settings, bounds: boxes.all });
        (boxes.casting, settings)
    }

    /// Places the system in the view, uploads its data, and prepares targets and pipelines.
    pub fn write(&mut self, context: &FrameContext<'_>, system: &ParticleSystem<'_, '_>) {
        self.hidden = None;
        self.prepared = self.prepare(context, system);
        let is_deferred = matches!(self.passes(), Some(SystemPasses::Deferred(_)));
        if self.frames_without_targets.tick(!is_deferred) {
            self.targets = SystemTargets::default();
        }
        let is_tiled = self.tiled_passes().is_some() || self.hidden.is_some();
        let is_released = self.frames_untiled.tick(!is_tiled);
        if is_released {
            self.tiles = TiledSystem::default();
        }
        let is_sorted = matches!(self.particle_pass(), Some(ParticlePass::DepthSort(..)));
        let is_measured = self.measure().is_some();
        let is_splatted = self.splat().is_some();
        self.particles.release_unused(is_released, is_sorted, is_measured, is_splatted);
    }

    fn prepare(&mut self, context: &FrameContext<'_>, system: &ParticleSystem<'_, '_>) -> Option<PreparedSystem> {
        let FrameContext { gpu, shared, frame, view, .. } = context;
        let material = &system.material.info;
        let MeasuredSystem { space, settings, bounds } = self.measured.take()?;
        let smoke_shadow = context.shadow.map(|grid| grid.shadow);
        let on_system = smoke_shadow.map(|shadow| (shadow, settings.shadow_blocks()));
        light_uniforms(view, frame.lights, frame.exposure, &bounds, on_system, &mut self.light_uniforms);
        let cpu_particles = self.particles.cpu_particles(system.particles);
        let (particles, particles_per_sample) = cpu_particles.unwrap_or((&[], 1));
        let in_world = SystemInput {
            bounds: &bounds,
            depth: system.depth,
            space: &space,
            extent: self.particles.measures.extent(),
            particles,
            particles_per_sample,
            settings: &settings,
            material,
            lights: &self.light_uniforms,
            up: frame.up.normalize_or(Vec3::Y),
            exposure: frame.exposure,
            time: frame.time,
            shadow: smoke_shadow,
        };
        let Some(mut setup) = system_setup(view, context.host_size, &in_world) else {
            let uniform = caster_uniform(&in_world);
            let caster = self.prepare_hidden(context, system, &space, &settings, &uniform);
            self.hidden = caster.map(|caster| HiddenSystem { uniform, caster });
            return None;
        };
        let trim = SpriteTrim::new(&settings, material);
        let mut settings = settings;
        let scale_choice =
            ScaleChoice::apply(view, &mut settings, &mut setup, &trim, material, cpu_particles, self.chosen_scale);
        self.chosen_scale = scale_choice.map(|choice| choice.scale);
        let workload = matches!(settings.path, RenderPath::Auto | RenderPath::Tiled).then(|| {
            let view_uniform = view.uniform(false);
            let projector = setup.projector(&view_uniform, &settings, &trim);
            estimate_workload(&projector, &setup.grid(), system.particles.count(), cpu_particles, &settings)
        });
        let choice = choose(&mut self.path_chooser, shared, system, workload.as_ref());
        let settings = choice.map_or(settings, |choice| settings.with_path(choice.path));
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&setup.uniform));
        gpu.queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&self.light_uniforms));

        let plan = plan(context.inputs, &settings, setup.back_faces);
        let depth = context.bindings.get(plan.reads_linear_target())?;
        let groups = self.bind(context, system, depth);
        let (sprites, particle_pass) = self.particles.upload(context, &space, system.particles, &settings, &groups)?;
        let measure = self.particles.measure_pass(context, system, &settings, &groups, &self.uniform);
        let splat =
            self.particles.splat_pass(context, system.particles, &sprites, &self.bindings.without_shadow(&groups));
        let builder = PassBuilder { gpu: *gpu, pipelines: &shared.pipelines, groups, sprites };
        let passes = match &plan {
            Plan::Skip => return None,
            Plan::Forward(plan) => builder.forward(plan),
            Plan::Deferred(plan) => {
                let limit = UVec2::new(view.size.x.div_ceil(settings.scale), view.size.y.div_ceil(settings.scale));
                let (textures, groups) = self.targets.ensure(&shared.device, &settings, plan, setup.rect.size, limit);
                let inputs = DeferredInputs {
                    textures,
                    groups,
                    setup: &setup,
                    depth,
                    host_depth: frame.scene_depth.buffer(),
                    tiles: &mut self.tiles,
                    workload: workload.as_ref(),
                };
                builder.deferred(plan, inputs)
            }
        };
        Some(PreparedSystem {
            setup,
            technique: settings.technique,
            trim,
            choice,
            lighting_choice: settings.lighting_choice.filter(|_| !settings.is_forward()),
            scale_choice,
            caster: CasterPasses {
                alive: AliveCopy::new(&system.particles, &self.uniform),
                measure,
                particle_pass,
                splat,
            },
            passes,
        })
    }

    /// Prepares the shadow of a system out of sight: it may fall on what is in sight. `None` without shadow.
    fn prepare_hidden(
        &mut self,
        context: &FrameContext<'_>,
        system: &ParticleSystem<'_, '_>,
        space: &ParticleSpace,
        settings: &ResolvedSettings,
        uniform: &SystemUniform,
    ) -> Option<CasterPasses> {
        context.shadow?;
        context.gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(uniform));
        let groups = self.bind(context, system, context.bindings.any()?);
        // The GPU evaluates an emitter, as if it were in sight.
        let on_gpu = matches!(settings.path, RenderPath::Auto | RenderPath::Tiled);
        let settings = if on_gpu { settings.with_path(RenderPath::Tiled) } else { *settings };
        let (sprites, particle_pass) = self.particles.upload(context, space, system.particles, &settings, &groups)?;
        let splat =
            self.particles.splat_pass(context, system.particles, &sprites, &self.bindings.without_shadow(&groups));
        Some(CasterPasses {
            alive: AliveCopy::new(&system.particles, &self.uniform),
            measure: None,
            particle_pass,
            splat,
        })
    }

    /// Returns the bind groups of the system.
    fn bind(&mut self, context: &FrameContext<'_>, system: &ParticleSystem<'_, '_>, depth: &DepthBindings) -> Groups {
        let shared = context.shared;
        let optical_depths = context.shadow.map_or(&shared.no_shadow, |grid| grid.optical_depths);
        if self.bindings.optical_depths != *optical_depths {
            self.bindings = SystemBindings::new(shared, &self.uniform, &self.lights, optical_depths);
        }
        Groups {
            frame: depth.frame.clone(),
            system: self.bindings.group.clone(),
            material: system.material.bind_group.clone(),
            lighting: system.material.lighting.clone(),
        }
    }
}

impl SystemBindings {
    fn new(shared: &Shared, uniform: &wgpu::Buffer, lights: &wgpu::Buffer, optical_depths: &wgpu::TextureView) -> Self {
        let group = |volume| {
            shared.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("haze system"),
                layout: &shared.layouts.system,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: lights.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(volume) },
                ],
            })
        };
        Self {
            group: group(optical_depths),
            without_shadow: group(&shared.no_shadow),
            optical_depths: optical_depths.clone(),
        }
    }

    fn without_shadow(&self, groups: &Groups) -> Groups {
        Groups { system: self.without_shadow.clone(), ..groups.clone() }
    }
}

/// Chooses the path if the setting is `auto`; otherwise returns `None`.
fn choose(
    path_chooser: &mut PathChooser,
    shared: &Shared,
    system: &ParticleSystem<'_, '_>,
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
