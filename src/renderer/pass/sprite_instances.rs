//! Sprites, shared by accumulate and forward, and the variants of `shaders/lib/sprite_vertex.wgsl` and
//! `sprite_fragment.wgsl`.

use haze_core::frame::Particle;
use haze_core::settings::{FadeCurve, RampFilter, Settings, SpriteAnimation, Technique, Volumetric};

use crate::frame::ParticleBuffer;
use crate::renderer::gpu::pipeline::{Constant, bool_constant, enum_constant};

/// Layout of the instance buffer: one [`Particle`] per sprite.
pub(crate) const PARTICLE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Particle>() as u64,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x3, 3 => Unorm8x4],
};

/// Sprite options that select a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SpriteKey {
    technique: Technique,
    animation: SpriteAnimation,
    checkerboard: bool,
    six_way: bool,
    motion: bool,
    curve: FadeCurve,
    linear_depth: bool,
    exact_filtering: bool,
    shadow: bool,
    by_depth: bool,
    fire: bool,
    tint: bool,
    stretch: bool,
    grain_octaves: u32,
    marched: Marched,
    ramp_filter: RampFilter,
}

impl SpriteKey {
    /// `linear_depth`: true if the host's depth is linear.
    pub fn new(settings: &Settings, linear_depth: bool, exact_filtering: bool) -> Self {
        Self {
            technique: settings.technique,
            animation: settings.sprite.animation,
            checkerboard: settings.debug.checkerboard,
            six_way: settings.is_six_way(),
            motion: settings.sprite.motion > 0.0,
            curve: settings.soft_fade.curve,
            linear_depth,
            exact_filtering,
            shadow: settings.receives_shadow(),
            by_depth: settings.receives_shadow_by_depth(),
            fire: settings.burns(),
            tint: settings.is_tinted(),
            stretch: settings.is_stretched(),
            grain_octaves: settings.grain_octaves(),
            marched: Marched::of(settings),
            ramp_filter: settings.ramp_filter,
        }
    }

    pub fn is_flat(&self) -> bool {
        self.technique.is_flat()
    }

    pub fn receives_shadow_by_depth(&self) -> bool {
        self.by_depth
    }

    pub fn receives_shadow(&self) -> bool {
        self.shadow
    }

    /// Returns true if the path tiled stores `SpriteValues` of sprites.
    pub fn has_values(&self) -> bool {
        self.shadow || self.fire || self.tint || self.stretch
    }

    /// Returns the override constants of the shared files, followed by the pass's own.
    pub fn constants(&self, of_pass: impl IntoIterator<Item = Constant>) -> Vec<Constant> {
        let shared = [
            enum_constant!("TECHNIQUE", self.technique),
            enum_constant!("SPRITE_ANIMATION", self.animation),
            bool_constant("CHECKERBOARD", self.checkerboard),
            bool_constant("SIX_WAY", self.six_way),
            bool_constant("MOTION", self.motion),
            enum_constant!("FADE_CURVE", self.curve),
            bool_constant("LINEAR_DEPTH", self.linear_depth),
            bool_constant("EXACT_FILTERING", self.exact_filtering),
            bool_constant("SHADOW", self.shadow),
            bool_constant("FIRE", self.fire),
            bool_constant("TINT", self.tint),
            bool_constant("STRETCH", self.stretch),
            ("GRAIN_OCTAVES", f64::from(self.grain_octaves)),
            ("MARCH_STEPS", f64::from(self.marched.steps)),
            ("NOISE_OCTAVES", f64::from(self.marched.octaves)),
            enum_constant!("RAMP_FILTER", self.ramp_filter),
        ];
        shared.into_iter().chain(of_pass).collect()
    }
}

/// Lookups of a march through a volumetric sprite; the same for all other sprites.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Marched {
    steps: u32,
    octaves: u32,
}

impl Marched {
    fn of(settings: &Settings) -> Self {
        let Volumetric { march_steps, noise_octaves, .. } = settings.volumetric;
        match settings.technique.is_volumetric() {
            true => Self { steps: march_steps, octaves: noise_octaves },
            false => Self { steps: 1, octaves: 1 },
        }
    }
}

/// A range of sprites in a buffer.
#[derive(Clone, Debug)]
pub(crate) struct Sprites {
    pub buffer: wgpu::Buffer,
    /// Offset of the first sprite, bytes.
    pub offset: u64,
    pub count: u32,
    /// Number of times that all instances are drawn.
    pub loops: u32,
    /// True if they are known to be back to front.
    pub is_sorted: bool,
    /// True if haze has sorted them, by view depth; a host may sort by another measure of depth.
    pub by_view_depth: bool,
}

impl Sprites {
    /// Returns the sprites of a host's buffer.
    pub fn of_host(particles: &ParticleBuffer<'_>, loops: u32) -> Self {
        let &ParticleBuffer { buffer, offset, count, is_sorted, .. } = particles;
        Self { buffer: buffer.clone(), offset, count, loops, is_sorted, by_view_depth: false }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.buffer.slice(self.offset..));
        for _ in 0..self.loops {
            pass.draw(0..4, 0..self.count);
        }
    }
}
