//! One frame of a simulation in memory.

use glam::Vec3;

/// A particle as its file has it: axes and lengths are the file's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CachedParticle {
    /// Its own from frame to frame; its place in the file where there are no ids.
    pub id: i64,
    /// In units of the file.
    pub position: Vec3,
    /// In units of the file, 0 or more.
    pub radius: f32,
    /// Radians.
    pub rotation: f32,
    /// What the file says, 1 for an opaque one.
    pub amount: f32,
    /// Share of its life that has passed, 0 to 1.
    pub age: f32,
}

/// What a file gives of its particles besides their positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each is one thing that is given or not")]
pub struct Given {
    /// Who is who from frame to frame.
    pub id: bool,
    /// How large they are.
    pub radius: bool,
    /// How they are turned.
    pub rotation: bool,
    /// How opaque they are.
    pub amount: bool,
}

/// The particles of one frame, by id where they have any, and what of them the file gives.
#[derive(Clone, Debug, PartialEq)]
pub struct CacheFrame {
    particles: Vec<CachedParticle>,
    given: Given,
}

impl CacheFrame {
    /// Fails with the first id that is there twice.
    pub(super) fn new(mut particles: Vec<CachedParticle>, given: Given) -> Result<Self, i64> {
        if given.id && !particles.is_sorted_by_key(|particle| particle.id) {
            particles.sort_unstable_by_key(|particle| particle.id);
        }
        match particles.windows(2).find(|pair| pair[0].id == pair[1].id) {
            Some(twice) => Err(twice[0].id),
            None => Ok(Self { particles, given }),
        }
    }

    /// Its particles.
    pub fn particles(&self) -> &[CachedParticle] {
        &self.particles
    }

    /// What the file gives of each.
    pub fn given(&self) -> Given {
        self.given
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> u64 {
        size_of_val(self.particles.as_slice()) as u64
    }

    /// Hands over every particle that lives between this frame and the next, and how much of it there is: one that is in both
    /// is on its way, one that is born or dies in between stands still and grows or dwindles. Without ids in both, or where they
    /// give different things, those of this frame.
    pub fn between(&self, next: Option<&Self>, share: f32, mut each: impl FnMut(&CachedParticle, f32)) {
        let next = next.filter(|next| share > 0.0 && self.given.id && next.given == self.given);
        let Some(next) = next else {
            return self.particles.iter().for_each(|particle| each(particle, 1.0));
        };
        let (mut ours, mut theirs) = (self.particles.iter().peekable(), next.particles.iter().peekable());
        loop {
            match (ours.peek(), theirs.peek()) {
                (Some(one), Some(other)) if one.id == other.id => {
                    each(&one.towards(other, share), 1.0);
                    ours.next();
                    theirs.next();
                }
                (Some(one), other) if other.is_none_or(|other| one.id < other.id) => {
                    each(one, 1.0 - share);
                    ours.next();
                }
                (_, Some(other)) => {
                    each(other, share);
                    theirs.next();
                }
                (_, None) => return,
            }
        }
    }
}

impl CachedParticle {
    fn towards(&self, other: &Self, share: f32) -> Self {
        let mix = |from: f32, to: f32| from + (to - from) * share;
        // The short way round: simulations may begin again at a full turn.
        let turn = (other.rotation - self.rotation + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU);
        Self {
            id: self.id,
            position: self.position.lerp(other.position, share),
            radius: mix(self.radius, other.radius),
            rotation: self.rotation + (turn - std::f32::consts::PI) * share,
            amount: mix(self.amount, other.amount),
            age: mix(self.age, other.age),
        }
    }
}
