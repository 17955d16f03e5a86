//! Particles of one system: measured on the CPU, uploaded, evaluated or sorted.

use haze_core::frame::{EmitterPaths, Particle, SpriteExtent};
use haze_core::settings::{BlendOrder, RenderPath, Settings};
use haze_core::view_setup::{ParticleMeasures, ParticleSpace, SystemBoxes, ViewGeometry};

use super::instances::{Instances, ParticleUse, SortedBy};
use super::passes::ParticlePass;
use crate::frame::{ParticleSystem, Particles};
use crate::renderer::context::Shared;
use crate::renderer::frame_context::FrameContext;
use crate::renderer::gpu::idle_counter::IdleCounter;
use crate::renderer::memory_use::TiledMemory;
use crate::renderer::pass::density_splat::DensitySplat;
use crate::renderer::pass::groups::Groups;
use crate::renderer::pass::measure::Measure;
use crate::renderer::pass::sprite_instances::Sprites;
use crate::renderer::support::{exceeds_tiled_limits, is_readable_by_compute};
use crate::renderer::tiled::{EmittedParticles, MeasureInputs, MeasuredParticles, SortedParticles, SplatParticles};

/// Number of particles from which the GPU sorts for a path that draws: the CPU needs 0.2 ms to sort them.
const MIN_GPU_SORTED: u32 = 32_768;

/// Maximum number of particles of a slice that are kept for [`SystemParticles::estimate_sample`].
const SAMPLE: usize = 4096;

/// Particles of one system, and the buffers that hold them.
#[derive(Debug, Default)]
pub(crate) struct SystemParticles {
    /// Measures of a slice, or of an emitter's sample.
    pub measures: ParticleMeasures,
    /// Sample of the particles, for estimates; of an emitter, also for measures.
    sample: Vec<Particle>,
    sample_paths: EmitterPaths,
    /// Number of particles that each of the sample represents.
    particles_per_sample: u32,
    instances: Instances,
    emitted: EmittedParticles,
    depth_sorted: SortedParticles,
    measured: MeasuredParticles,
    splat: SplatParticles,
    /// Counts frames in which no host's particles were sorted, after which the sort's buffers are released.
    frames_unsorted: IdleCounter,
    /// Counts frames in which no host's particles were measured.
    frames_unmeasured: IdleCounter,
    /// Counts frames in which the particles were not added to a density grid, whose buffer the splat's bind group keeps.
    frames_unsplatted: IdleCounter,
}

impl SystemParticles {
    /// Measures a slice or an emitter's sample.
    pub fn measure(
        &mut self,
        view: &ViewGeometry,
        space: &ParticleSpace,
        system: &ParticleSystem<'_, '_>,
        settings: &Settings,
    ) -> SystemBoxes {
        self.take_sample(system.particles);
        let (particles, _) = cpu_particles(system.particles, &self.sample).unwrap_or((&[], 1));
        self.measures.measure(space, view.depth.near, particles, settings);
        let bounds = system.bounds.or(match system.particles {
            Particles::Emitter(emission) => Some(emission.bounds(SpriteExtent::from_settings(system.settings))),
            // `validate` refuses a buffer without bounds.
            Particles::Slice(_) | Particles::Buffer(_) => None,
        });
        self.measures.boxes(bounds.map(|bounds| space.world_bounds(&bounds)))
    }

    /// Takes a sample that outlives the frame's input.
    fn take_sample(&mut self, particles: Particles<'_>) {
        match particles {
            Particles::Emitter(emission) => {
                emission.sample_along(&mut self.sample_paths, &mut self.sample);
                self.particles_per_sample = emission.step;
            }
            Particles::Slice(particles) => {
                let step = particles.len().div_ceil(SAMPLE).max(1);
                self.sample.clear();
                self.sample.extend(particles.iter().step_by(step).filter(|particle| particle.is_visible()));
                self.particles_per_sample = step as u32;
            }
            Particles::Buffer(_) => self.sample.clear(),
        }
    }

    /// Returns the particles that the CPU knows, and the number of particles that each represents. `None` for a host's
    /// buffer.
    pub fn cpu_particles<'a>(&'a self, particles: Particles<'a>) -> Option<(&'a [Particle], u32)> {
        cpu_particles(particles, &self.sample)
    }

    /// Returns the uploaded particles that the CPU knows, in no order; some may be invisible.
    pub fn instances<'a>(&'a self, particles: Particles<'a>) -> &'a [Particle] {
        match particles {
            Particles::Slice(particles) => particles,
            Particles::Emitter(_) => self.instances.evaluated(),
            Particles::Buffer(_) => &[],
        }
    }

    /// Returns drawn particles, all or a sample, and the number of particles that each represents. Empty for a host's
    /// buffer.
    pub fn estimate_sample(&self) -> (&[Particle], u32) {
        match self.instances.evaluated() {
            [] => (&self.sample, self.particles_per_sample),
            evaluated => (evaluated, 1),
        }
    }

    /// Uploads the particles, or prepares the pass that produces them. Returns `None` if there is nothing to draw.
    pub fn upload(
        &mut self,
        context: &FrameContext<'_>,
        space: &ParticleSpace,
        particles: Particles<'_>,
        settings: &Settings,
        groups: &Groups,
    ) -> Option<(Sprites, Option<ParticlePass>)> {
        let FrameContext { gpu, shared, .. } = context;
        let is_tiled = settings.path == RenderPath::Tiled;
        if let (Particles::Emitter(emission), Some(tiled), true) = (particles, &shared.pipelines.tiled, is_tiled) {
            self.instances = Instances::default();
            let (sprites, emit) = self.emitted.write(gpu, tiled, emission, settings.debug.draw_count)?;
            return Some((sprites, Some(ParticlePass::Emit(emit))));
        }
        let sorted_by = sorted_by(shared, &particles, is_tiled);
        let read_by_compute = is_tiled || context.shadow.is_some() || sorted_by == SortedBy::Gpu;
        let order = &mut self.measures.order;
        let used = ParticleUse { sorted_by, read_by_compute };
        let sprites = self.instances.write(gpu, space, order, particles, settings, used)?;
        let must_sort = settings.order() == BlendOrder::Sorted && !sprites.is_sorted;
        match &shared.pipelines.tiled {
            Some(tiled) if !is_tiled && must_sort => {
                let (sprites, sort) = self.depth_sorted.write(gpu, tiled, &sprites);
                Some((sprites, Some(ParticlePass::DepthSort(sort, groups.clone()))))
            }
            _ => Some((sprites, None)),
        }
    }

    /// Prepares the pass that measures a host's particles and writes their extent to the uniforms `system`. `None` for
    /// other particles, and for a buffer that compute shaders cannot read.
    pub fn measure_pass(
        &mut self,
        context: &FrameContext<'_>,
        host: &ParticleSystem<'_, '_>,
        settings: &Settings,
        groups: &Groups,
        system: &wgpu::Buffer,
    ) -> Option<Measure> {
        let FrameContext { gpu, shared, .. } = context;
        let Particles::Buffer(particles) = host.particles else { return None };
        let tiled = shared.pipelines.tiled.as_ref().filter(|_| is_readable_by_compute(&particles))?;
        let inputs = MeasureInputs {
            sprites: Sprites::of_host(&particles, 1),
            groups,
            system,
            keeps_depth: host.depth.is_some(),
            fade_distance: settings.soft_fade.max_distance(),
        };
        Some(self.measured.write(gpu, tiled, inputs))
    }

    /// Prepares the pass that adds the system's sprites to the density grid of the frame. `None` without shadow, and for a
    /// buffer that compute shaders cannot read.
    pub fn splat_pass(
        &mut self,
        context: &FrameContext<'_>,
        particles: Particles<'_>,
        sprites: &Sprites,
        groups: &Groups,
    ) -> Option<DensitySplat> {
        let FrameContext { gpu, shared, shadow, .. } = context;
        let tiled = shared.pipelines.tiled.as_ref()?;
        let is_readable = match &particles {
            Particles::Buffer(particles) => is_readable_by_compute(particles),
            _ => true,
        };
        let density = shadow.filter(|_| is_readable)?.density?;
        Some(self.splat.write(gpu, tiled, sprites, groups, density))
    }

    /// Releases buffers that have not been needed for 120 frames. `is_untiled`: true if that is so for the path
    /// `tiled`. `is_sorted`: true if the GPU sorted a host's particles in this frame; `is_measured`: if it measured them;
    /// `is_splatted`: if it added the particles to a density grid.
    pub fn release_unused(&mut self, is_untiled: bool, is_sorted: bool, is_measured: bool, is_splatted: bool) {
        if is_untiled {
            self.emitted = EmittedParticles::default();
        }
        if self.frames_unsorted.tick(!is_sorted) {
            self.depth_sorted = SortedParticles::default();
        }
        if self.frames_unmeasured.tick(!is_measured) {
            self.measured = MeasuredParticles::default();
        }
        if self.frames_unsplatted.tick(!is_splatted) {
            self.splat = SplatParticles::default();
        }
    }

    /// Returns the bytes of GPU memory of uploaded particles.
    pub fn instance_bytes(&self) -> u64 {
        self.instances.bytes()
    }

    /// Returns the GPU memory of particles that compute shaders produce.
    pub fn tiled_memory(&self) -> TiledMemory {
        let emitted = self.emitted.bytes() + self.measured.bytes();
        TiledMemory { emitted, ..TiledMemory::default() } + self.depth_sorted.memory()
    }
}

/// Returns the processor that sorts particles of the CPU.
fn sorted_by(shared: &Shared, particles: &Particles<'_>, is_tiled: bool) -> SortedBy {
    let Some(tiled) = shared.pipelines.tiled.as_ref().filter(|tiled| tiled.cooperative()) else { return SortedBy::Cpu };
    let count = particles.count();
    let is_worth_it = count >= MIN_GPU_SORTED && !exceeds_tiled_limits(tiled, count);
    if is_tiled || is_worth_it { SortedBy::Gpu } else { SortedBy::Cpu }
}

/// See [`SystemParticles::cpu_particles`].
fn cpu_particles<'a>(particles: Particles<'a>, sample: &'a [Particle]) -> Option<(&'a [Particle], u32)> {
    match particles {
        Particles::Slice(particles) => Some((particles, 1)),
        Particles::Buffer(_) => None,
        Particles::Emitter(emission) => Some((sample, emission.step)),
    }
}
