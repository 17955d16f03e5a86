//! One frame of a particle simulation, and interpolation between two frames.

use glam::Vec3;

/// A particle with the axes and units of its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FileParticle {
    /// Identifies the particle across frames. The row in the file if the file has no ids.
    pub id: i64,
    /// In units of the file.
    pub position: Vec3,
    /// In units of the file, 0 or more.
    pub radius: f32,
    /// Radians.
    pub rotation: f32,
    /// Amount: 0 is transparent, 1 opaque.
    pub amount: f32,
    /// Fraction of the lifetime that has passed, 0 to 1.
    pub age: f32,
    /// In units of the file per second.
    pub velocity: Vec3,
    /// Linear RGB.
    pub color: Vec3,
    /// Heat, 0 to 1; larger values are clamped.
    pub heat: f32,
}

/// Optional attributes that a file provides besides positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each is an independent attribute")]
pub struct ProvidedAttributes {
    /// Ids that identify particles across frames.
    pub id: bool,
    /// Radius, or a width that is halved.
    pub radius: bool,
    /// Rotation.
    pub rotation: bool,
    /// Amount.
    pub amount: bool,
    /// Color.
    pub color: bool,
    /// Heat.
    pub heat: bool,
}

/// Particles of one frame, sorted by id if the file has ids, and the attributes that the file provides.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleFrame {
    particles: Vec<FileParticle>,
    provided: ProvidedAttributes,
}

impl ParticleFrame {
    /// Sorts the particles by id. The error is the first duplicate id.
    pub(super) fn new(mut particles: Vec<FileParticle>, provided: ProvidedAttributes) -> Result<Self, i64> {
        if provided.id && !particles.is_sorted_by_key(|particle| particle.id) {
            particles.sort_unstable_by_key(|particle| particle.id);
        }
        match particles.windows(2).find(|pair| pair[0].id == pair[1].id) {
            Some(twice) => Err(twice[0].id),
            None => Ok(Self { particles, provided }),
        }
    }

    /// Returns the particles.
    pub fn particles(&self) -> &[FileParticle] {
        &self.particles
    }

    pub(super) fn particles_mut(&mut self) -> &mut [FileParticle] {
        &mut self.particles
    }

    /// Removes the amount from the attributes that the file provides.
    pub(super) fn unset_amount(&mut self) {
        self.provided.amount = false;
    }

    /// Returns the attributes that the file provides.
    pub fn provided(&self) -> ProvidedAttributes {
        self.provided
    }

    /// Returns the size in memory, bytes.
    pub fn bytes(&self) -> u64 {
        size_of_val(self.particles.as_slice()) as u64
    }

    /// Interpolates between this frame and the next at `fraction`, 0 to 1, and calls `each` with every particle and its
    /// weight, 0 to 1. A particle in both frames is interpolated and has weight 1. A particle in one frame only keeps
    /// its position; its weight fades out or in. If the frames have no ids or provide different attributes, the particles
    /// are those of this frame.
    pub fn interpolate(&self, next: Option<&Self>, fraction: f32, mut each: impl FnMut(&FileParticle, f32)) {
        let next = next.filter(|next| fraction > 0.0 && self.provided.id && next.provided == self.provided);
        let Some(next) = next else {
            return self.particles.iter().for_each(|particle| each(particle, 1.0));
        };
        let mut ours = self.particles.iter().peekable();
        let mut theirs = next.particles.iter().peekable();
        loop {
            match (ours.peek(), theirs.peek()) {
                (Some(one), Some(other)) if one.id == other.id => {
                    each(&one.lerp(other, fraction), 1.0);
                    ours.next();
                    theirs.next();
                }
                (Some(one), other) if other.is_none_or(|other| one.id < other.id) => {
                    each(one, 1.0 - fraction);
                    ours.next();
                }
                (_, Some(other)) => {
                    each(other, fraction);
                    theirs.next();
                }
                (_, None) => return,
            }
        }
    }
}

impl FileParticle {
    fn lerp(&self, other: &Self, fraction: f32) -> Self {
        let mix = |from: f32, to: f32| from + (to - from) * fraction;
        // Rotates by the smaller angle: a simulation may wrap rotations at a full turn.
        let turn = (other.rotation - self.rotation + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU);
        Self {
            id: self.id,
            position: self.position.lerp(other.position, fraction),
            radius: mix(self.radius, other.radius),
            rotation: self.rotation + (turn - std::f32::consts::PI) * fraction,
            amount: mix(self.amount, other.amount),
            age: mix(self.age, other.age),
            velocity: self.velocity.lerp(other.velocity, fraction),
            color: self.color.lerp(other.color, fraction),
            heat: mix(self.heat, other.heat),
        }
    }
}
