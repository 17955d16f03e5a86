//! How a sprite keeps from cutting into the scene, what it shows, and the numbers of the techniques that have their own.
//! `docs/techniques.md` compares them.

use crate::fields::{FieldVisitor, Fields};

choice! {
    /// How a sprite meets the scene.
    Technique {
        /// Cut off where the scene begins, by the hardware's depth test. (NV, MS)
        Hard = "hard",
        /// Fades out before the scene, whose depth buffer is read as a texture. (NV, MS)
        #[default]
        Soft = "soft",
        /// The same with an `R32Float` view depth that the scene pass wrote. (NV)
        SoftLinear = "soft_linear",
        /// Every texel at a depth of its own, from the sprite's detail map, and cut off there. (MS)
        DepthSpriteHard = "depth_sprite_hard",
        /// Every texel at a depth of its own, and faded. (MS)
        DepthSpriteSoft = "depth_sprite_soft",
        /// A sphere of gas: its amount grows with the way through it, which scene and near plane cut short. (BLOG 2)
        SphericalBillboard = "spherical_billboard",
        /// The sprite's alpha is the density of a slab, which scene and near plane cut short. (BLOG 3)
        Density = "density",
        /// A sphere of 3D noise, marched through as far as the scene. (MS)
        VolumetricHard = "volumetric_hard",
        /// The same, every step faded before the scene. (MS)
        VolumetricSoft = "volumetric_soft",
    }
}

impl Technique {
    /// True if the sprite is a sphere, drawn wherever its silhouette is; the others are squares.
    pub fn is_sphere(self) -> bool {
        matches!(self, Self::SphericalBillboard) || self.is_volumetric()
    }

    /// True if the sprite fades by `soft_fade`.
    pub fn is_soft(self) -> bool {
        matches!(self, Self::Soft | Self::SoftLinear | Self::DepthSpriteSoft | Self::VolumetricSoft)
    }

    /// True if the sprite is marched through.
    pub fn is_volumetric(self) -> bool {
        matches!(self, Self::VolumetricHard | Self::VolumetricSoft)
    }

    /// True if the sprite's detail map is read for depth.
    pub fn is_depth_sprite(self) -> bool {
        matches!(self, Self::DepthSpriteHard | Self::DepthSpriteSoft)
    }
}

choice! {
    /// What moves through the frames of a sprite.
    SpriteAnimation {
        /// The particle's `frame`, round and round, neighbours blended.
        #[default]
        Flipbook = "flipbook",
        /// The particle's age: the frames are the slices of a volume texture, the first at birth, the last at death,
        /// neighbours blended. (MS)
        Volume = "volume",
        /// Nothing: the first frame.
        Still = "still",
    }
}

/// What a sprite shows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SpriteSettings {
    /// Multiplies the radius of every particle. 0 draws nothing.
    pub size: f32,
    /// What moves through the frames.
    pub animation: SpriteAnimation,
    /// Holds every sprite at the frame it was born with, and the noise of volumetric sprites where it is at time 0.
    /// Frames come from the emitter: a host with its own simulation stops them itself.
    pub freeze_animation: bool,
    /// How far texels are carried along the detail map's motion between two frames: 0 only blends, 1 goes all the way.
    pub motion: f32,
    /// How much the age ramp colours a particle, forward only: 0 not at all, 1 wholly. (MS)
    pub age_colour: f32,
    /// Shows a checkerboard in place of the sprite. (NV)
    pub debug_sprite: bool,
    /// Draws all sprites this many times, to make the cost of a fragment stand out. (NV)
    pub debug_loop: u32,
}

impl Default for SpriteSettings {
    fn default() -> Self {
        Self {
            size: 1.0,
            animation: SpriteAnimation::default(),
            freeze_animation: false,
            motion: 0.0,
            age_colour: 0.0,
            debug_sprite: false,
            debug_loop: 1,
        }
    }
}

impl Fields for SpriteSettings {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("size", &mut self.size, 0.0..=100.0, "");
        visitor.number("motion", &mut self.motion, 0.0..=1.0, "");
        visitor.number("age_colour", &mut self.age_colour, 0.0..=1.0, "");
        visitor.integer("debug_loop", &mut self.debug_loop, 1..=10_000, "");
    }
}

/// Numbers of the technique `spherical_billboard`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SphericalBillboard {
    /// Radius of the sphere, in radii of the particle.
    pub radius: f32,
    /// How fast the amount grows on the way through the middle of the sphere.
    pub density: f32,
}

impl Default for SphericalBillboard {
    fn default() -> Self {
        Self { radius: 1.0, density: 3.0 }
    }
}

impl Fields for SphericalBillboard {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("radius", &mut self.radius, 0.0..=10.0, "");
        visitor.number("density", &mut self.density, 0.0..=1000.0, "1/m");
    }
}

/// The number of the technique `density`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Density {
    /// Density of the slab where the sprite's alpha is 1.
    pub density: f32,
}

impl Default for Density {
    fn default() -> Self {
        Self { density: 1.0 }
    }
}

impl Fields for Density {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("density", &mut self.density, 0.0..=1000.0, "1/m");
    }
}

/// Numbers of the techniques `volumetric_hard` and `volumetric_soft`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Volumetric {
    /// Steps of the march through a sphere.
    pub march_steps: u32,
    /// Side of one tile of the noise, which fills the world.
    pub noise_size: f32,
    /// Lookups into the noise for each step, each of three times the frequency and half the weight of the last.
    pub noise_octaves: u32,
    /// How fast the amount grows where the noise is densest.
    pub opacity: f32,
    /// How fast the noise rises.
    pub scroll_speed: f32,
}

impl Default for Volumetric {
    fn default() -> Self {
        Self { march_steps: 6, noise_size: 2.5, noise_octaves: 2, opacity: 3.0, scroll_speed: 0.2 }
    }
}

impl Fields for Volumetric {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("march_steps", &mut self.march_steps, 2..=8, "");
        visitor.number("noise_size", &mut self.noise_size, 0.01..=1000.0, "m");
        visitor.integer("noise_octaves", &mut self.noise_octaves, 1..=4, "");
        visitor.number("opacity", &mut self.opacity, 0.0..=1000.0, "1/m");
        visitor.number("scroll_speed", &mut self.scroll_speed, -100.0..=100.0, "m/s");
    }
}
