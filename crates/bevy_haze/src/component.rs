//! Components that a program puts on entities.

use std::collections::HashSet;
use std::sync::Arc;

use bevy::asset::AssetId;
use bevy::camera::primitives::Aabb;
use bevy::prelude::*;
use bevy::render::storage::ShaderBuffer;

use crate::animation::SmokeAnimation;
use crate::asset::SmokeAsset;
use crate::convert;

/// Smoke of a preset at an entity.
///
/// The emitter runs in the entity's local space: its [`Transform`] places, turns and scales all of the smoke. A scale that
/// differs between axes is replaced by its geometric mean. [`Visibility`] and
/// [`RenderLayers`](bevy::camera::visibility::RenderLayers) work as for meshes.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_haze::Smoke;
/// fn setup(mut commands: Commands, assets: Res<AssetServer>) {
///     commands.spawn((Smoke::from(assets.load("column.smoke.json")), Transform::from_xyz(0.0, 0.5, 0.0)));
/// }
/// ```
#[derive(Component, Clone, Debug, Default, Deref, DerefMut, PartialEq, Eq)]
#[require(SmokeClock, SmokeAnimation, Transform, Visibility)]
pub struct Smoke(pub Handle<SmokeAsset>);

impl From<Handle<SmokeAsset>> for Smoke {
    fn from(asset: Handle<SmokeAsset>) -> Self {
        Self(asset)
    }
}

/// Clock of an entity's smoke. It starts when the preset has loaded and follows Bevy's virtual time, which a program can
/// pause and slow down for all.
///
/// Emitter, keyframes and flicker are functions of time: set [`seconds`](Self::seconds) to any value, forwards or back, and
/// the smoke is there.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone)]
pub struct SmokeClock {
    /// Seconds since the start of the emitter. Negative is before the start. An emitter without a duration has always been
    /// there.
    pub seconds: f64,
    /// Seconds of smoke per second of Bevy's virtual time. 1 is real time, negative runs backwards.
    pub speed: f64,
    /// Holds the clock.
    pub paused: bool,
}

impl Default for SmokeClock {
    fn default() -> Self {
        Self { seconds: 0.0, speed: 1.0, paused: false }
    }
}

impl SmokeClock {
    /// Clock that starts at this second.
    pub const fn at(seconds: f64) -> Self {
        Self { seconds, speed: 1.0, paused: false }
    }

    /// Clock that is held at this second.
    pub const fn paused_at(seconds: f64) -> Self {
        Self { seconds, speed: 1.0, paused: true }
    }
}

/// Particles of a program's own simulation, in the entity's local space. On an entity with [`Smoke`], they replace the
/// emitter of the preset's first system; the preset's other systems are not drawn.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_haze::{SmokeParticle, SmokeParticles};
/// fn simulate(mut smokes: Query<&mut SmokeParticles>, time: Res<Time>) {
///     for mut particles in &mut smokes {
///         let x = time.elapsed_secs().sin();
///         particles.set([SmokeParticle { position: Vec3::new(x, 1.0, 0.0), ..default() }]);
///     }
/// }
/// ```
#[derive(Component, Clone, Debug, Default)]
pub struct SmokeParticles(pub(crate) Arc<Vec<haze::Particle>>);

impl SmokeParticles {
    /// Particles in any order; haze sorts them. Those with a number that is not finite are left out.
    pub fn new(particles: impl IntoIterator<Item = SmokeParticle>) -> Self {
        let mut this = Self::default();
        this.set(particles);
        this
    }

    /// Replaces the particles, as [`new`](Self::new). Reuses the memory once the renderer has let go of it.
    pub fn set(&mut self, particles: impl IntoIterator<Item = SmokeParticle>) {
        if Arc::get_mut(&mut self.0).is_none() {
            // The renderer still reads the last frame's particles.
            self.0 = Arc::new(Vec::with_capacity(self.0.len()));
        }
        if let Some(list) = Arc::get_mut(&mut self.0) {
            list.clear();
            list.extend(particles.into_iter().map(SmokeParticle::to_haze).filter(haze::Particle::is_valid));
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True without particles.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// One puff: a sprite that faces the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmokeParticle {
    /// Center in the entity's local space, metres.
    pub position: Vec3,
    /// Half the side of the square sprite, metres. 0 draws nothing.
    pub radius: f32,
    /// Rotation on the screen, radians, counter-clockwise.
    pub rotation: f32,
    /// Fraction of the background that the puff hides, 0 to 1; larger values are clamped. 0 draws nothing.
    pub amount: f32,
    /// Frame of the sprite's flipbook. Wraps around; a fraction blends with the next frame.
    pub frame: f32,
    /// Fraction of the puff's life that has passed, 0 to 1. Only fire and color by age read it.
    pub age: f32,
    /// Velocity in the entity's local space, metres per second. Only presets with `sprite.stretch` above 0 read it.
    pub velocity: Vec3,
    /// Color of the puff, 0 to 1, on which light falls. Only presets with `sprite.tint` above 0 read it.
    pub tint: LinearRgba,
    /// Multiplies the heat that the preset has for the puff's age, 0 to 1. Only fire reads it.
    pub heat: f32,
}

impl Default for SmokeParticle {
    fn default() -> Self {
        Self {
            position: Vec3::ZERO,
            radius: 0.5,
            rotation: 0.0,
            amount: 0.3,
            frame: 0.0,
            age: 0.5,
            velocity: Vec3::ZERO,
            tint: LinearRgba::WHITE,
            heat: 1.0,
        }
    }
}

/// Particles of a simulation on the GPU, in the entity's local space. On an entity with [`Smoke`], they take the place that
/// [`SmokeParticles`] have; those win if an entity has both.
///
/// Each particle is twelve words, as [`SmokeParticle::to_words`] lists them. The buffer needs the usages `VERTEX` and
/// `STORAGE`. A compute pass of the program writes it before the main pass of the first camera.
#[derive(Component, Clone, Debug)]
pub struct SmokeBuffer {
    /// Buffer of the particles.
    pub buffer: Handle<ShaderBuffer>,
    /// Number of particles to draw, from the start of the buffer on. Dead ones among them have the radius 0.
    pub count: u32,
    /// Box that holds all particles with their radii, in the entity's local space. The CPU cannot see them: what is outside
    /// may be cut off, and a box that is much too large costs time.
    pub bounds: Aabb,
}

impl SmokeParticle {
    /// Layout of a particle in a [`SmokeBuffer`]: the bits of eleven `f32` (position, radius, rotation, amount, frame, age,
    /// velocity), then WGSL's `pack4x8unorm(vec4f(tint, heat))`.
    pub fn to_words(self) -> [u32; 12] {
        let particle = self.to_haze();
        let Vec3 { x, y, z } = self.position;
        let Vec3 { x: u, y: v, z: w } = self.velocity;
        let numbers = [x, y, z, self.radius, self.rotation, self.amount, self.frame, self.age, u, v, w];
        let [red, green, blue] = particle.tint;
        let mut words = [0; 12];
        words.iter_mut().zip(numbers).for_each(|(word, number)| *word = number.to_bits());
        words[11] = u32::from_le_bytes([red, green, blue, particle.heat]);
        words
    }

    fn to_haze(self) -> haze::Particle {
        let Self { position, radius, rotation, amount, frame, age, velocity, tint, heat } = self;
        let fraction = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        haze::Particle {
            position: convert::vec3(position),
            radius,
            rotation,
            amount,
            frame,
            age,
            velocity: convert::vec3(velocity),
            tint: [tint.red, tint.green, tint.blue].map(fraction),
            heat: fraction(heat),
        }
    }
}

/// Moves every clock whose smoke has loaded.
pub(crate) fn advance_clocks(
    time: Res<Time>,
    assets: Res<Assets<SmokeAsset>>,
    mut smokes: Query<(&Smoke, &mut SmokeClock)>,
) {
    let step = time.delta_secs_f64();
    for (smoke, mut clock) in &mut smokes {
        if !clock.paused && step > 0.0 && assets.contains(smoke.id()) {
            clock.seconds += step * clock.speed;
        }
    }
}

/// Evaluates the tracks of each entity's preset at the time of its clock. Fields are looked up again only when the preset has
/// changed.
pub(crate) fn animate_smoke(
    mut events: MessageReader<AssetEvent<SmokeAsset>>,
    mut changed: Local<HashSet<AssetId<SmokeAsset>>>,
    assets: Res<Assets<SmokeAsset>>,
    mut smokes: Query<(Ref<Smoke>, &SmokeClock, &mut SmokeAnimation)>,
) {
    changed.clear();
    changed.extend(events.read().filter_map(|event| match event {
        AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } => Some(*id),
        _ => None,
    }));
    for (smoke, clock, mut animation) in &mut smokes {
        if smoke.is_changed() || changed.contains(&smoke.id()) {
            *animation = assets.get(smoke.id()).map(SmokeAnimation::new).unwrap_or_default();
        }
        animation.evaluate(clock.seconds);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particles_that_are_not_finite_are_left_out() {
        let bad = SmokeParticle { position: Vec3::NAN, ..default() };
        let mut particles = SmokeParticles::new([SmokeParticle::default(), bad]);
        assert_eq!(particles.len(), 1);
        let held = particles.clone();
        particles.set([]);
        assert!(particles.is_empty() && held.len() == 1);
    }
}
