//! Sprite techniques and their settings, and the appearance of sprites. `docs/techniques.md` compares the techniques.

use glam::Vec3;

use super::choice::choice;
use super::settings_macro::settings;

choice! {
    /// Technique by which a sprite meets the scene.
    Technique {
        /// Cut off at the scene, by the hardware's depth test. (NV, MS)
        Hard = "hard",
        /// Fades out in front of the scene, whose depth buffer is read as a texture. (NV, MS)
        #[default]
        Soft = "soft",
        /// The same, with an `R32Float` view depth that the scene pass wrote. (NV)
        SoftLinear = "soft_linear",
        /// Every texel has its own depth, from the sprite's detail map, and is cut off at the scene. (MS)
        DepthSpriteHard = "depth_sprite_hard",
        /// Every texel has its own depth, and fades out in front of the scene. (MS)
        DepthSpriteSoft = "depth_sprite_soft",
        /// Sphere of gas: the amount grows with the length of the ray inside it, between near plane and scene. (BLOG 2)
        SphericalBillboard = "spherical_billboard",
        /// Slab of gas between near plane and scene, with the sprite's alpha as its density. (BLOG 3)
        Density = "density",
        /// Sphere of 3D noise, ray-marched up to the scene. (MS)
        VolumetricHard = "volumetric_hard",
        /// The same, with every step faded in front of the scene. (MS)
        VolumetricSoft = "volumetric_soft",
    }
}

impl Technique {
    /// True if the sprite is a sphere, drawn over its silhouette. Other sprites are squares.
    pub fn is_sphere(self) -> bool {
        matches!(self, Self::SphericalBillboard) || self.is_volumetric()
    }

    /// True if the sprite is a card without thickness.
    pub fn is_flat(self) -> bool {
        matches!(self, Self::Hard | Self::Soft | Self::SoftLinear)
    }

    /// True if `soft_fade` applies to the sprite.
    pub fn is_soft(self) -> bool {
        matches!(self, Self::Soft | Self::SoftLinear | Self::DepthSpriteSoft | Self::VolumetricSoft)
    }

    /// True if the sprite is ray-marched.
    pub fn is_volumetric(self) -> bool {
        matches!(self, Self::VolumetricHard | Self::VolumetricSoft)
    }

    /// True if depth is read from the sprite's detail map.
    pub fn is_depth_sprite(self) -> bool {
        matches!(self, Self::DepthSpriteHard | Self::DepthSpriteSoft)
    }
}

choice! {
    /// Source of the flipbook frame.
    SpriteAnimation {
        /// The particle's `frame`, repeating, with neighbours blended.
        #[default]
        Flipbook = "flipbook",
        /// The particle's age: frames are the slices of a volume texture, the first at birth and the last at death,
        /// with neighbours blended. (MS)
        Volume = "volume",
        /// None: always the first frame.
        Still = "still",
        /// As `flipbook`, but only the nearest frame: half the lookups, with visible jumps between frames.
        Nearest = "nearest",
    }
}

settings! {
    /// Size and animation of sprites.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SpriteSettings {
        /// Multiplies the radius of every particle. Higher: larger puffs that overlap more. 0 draws nothing.
        size: f32 = 1.0, number(0.0..=100.0, "");
        /// Source of the flipbook frame: time, age, or none.
        animation: SpriteAnimation = SpriteAnimation::default(), choice;
        /// Motion of texels between two frames, by the detail map. 0: frames are only blended. 1: texels move all the
        /// way.
        motion: f32 = 0.0, number(0.0..=1.0, "");
        /// Strength of the age ramp's color, by which the light on particles is multiplied. 0: none, and no cost. 1: full. (MS)
        age_color: f32 = 0.0, number(0.0..=1.0, "");
        /// Strength of the particles' own colors, by which the light on them is multiplied: those of the emitter, of a
        /// particle file, or of a host. 0: none, and no cost. 1: full.
        tint: f32 = 0.0, number(0.0..=1.0, "");
        /// Stretches sprites along their motion, by the way that they move in this time: as with a shutter that is open so
        /// long. Thin ones are at least a texel wide, and fainter in return. Higher: longer sparks and tongues of flame. 0: none, and
        /// no cost. Spheres are not stretched.
        stretch: f32 = 0.0, number(0.0..=10.0, "s");
        /// Velocity, in world space, by which sprites are stretched instead of their own: upright tongues of flame, rain. 0, 0,
        /// 0: their own.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        stretch_axis: Vec3 = Vec3::ZERO, vector(-1.0e3..=1.0e3, "m/s");
        /// Largest length of a stretched sprite, in lengths of the sprite at rest. Lower: fast sprites stay compact.
        stretch_limit: f32 = 4.0, number(1.0..=64.0, "");
    }
}

impl SpriteSettings {
    /// Settings for a sprite with this many frames. A single frame is not blended, unless it moves towards itself.
    pub fn for_frames(self, count: f32) -> Self {
        if count > 1.0 || self.motion > 0.0 { self } else { Self { animation: SpriteAnimation::Still, ..self } }
    }
}

settings! {
    /// Noise that is finer than the texels of the sprite: it tears outlines, and roughens the light.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Grain {
        /// Noise that eats the thin parts of sprites: outlines break into wisps. 0: none. 1: only the thickest parts stay whole.
        erosion: f32 = 0.0, number(0.0..=1.0, "");
        /// The same, by the end of a particle's life, added to `erosion`: smoke tears apart as it fades.
        dissolve: f32 = 0.0, number(0.0..=1.0, "");
        /// Lumps on the sprite: the noise tilts its normals, or shifts the light of its six-way maps. 0: none.
        bump: f32 = 0.0, number(0.0..=4.0, "");
        /// Tiles of the noise across a sprite. Higher: finer. What is finer than the target's texels fades out.
        tiles: f32 = 3.0, number(0.25..=32.0, "");
        /// Octaves of the noise. Each has three times the frequency and half the weight of the one before, and costs a lookup. One is
        /// enough at half scale.
        octaves: u32 = 1, integer(1..=3, "");
    }
}

settings! {
    /// Settings of the technique `spherical_billboard`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SphericalBillboard {
        /// Radius of the sphere, in radii of the particle. Higher: smoke thins out further in front of objects.
        radius: f32 = 1.0, number(0.0..=10.0, "");
        /// Growth of the amount along a ray through the middle of the sphere. Higher: from haze to a solid ball.
        density: f32 = 3.0, number(0.0..=1000.0, "1/m");
    }
}

settings! {
    /// Settings of the technique `density`, whose amount nears 1 exponentially along the ray.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Exponential {
        /// Density of the slab where the sprite's alpha is 1. Higher: objects are hidden closer to its front.
        density: f32 = 1.0, number(0.0..=1000.0, "1/m");
    }
}

settings! {
    /// Settings of the techniques `volumetric_hard` and `volumetric_soft`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Volumetric {
        /// Steps of the ray march through a sphere. Lower: cheaper, but layers show.
        march_steps: u32 = 6, integer(2..=8, "");
        /// Side of one tile of the noise, which fills the world. Higher: larger lumps.
        noise_size: f32 = 2.5, number(0.01..=1000.0, "m");
        /// Octaves of the noise, looked up at each step. Each has three times the frequency and half the weight of the
        /// one before. Higher: finer lumps at a higher cost.
        noise_octaves: u32 = 2, integer(1..=4, "");
        /// Growth of the amount where the noise is densest. Higher: denser smoke.
        opacity: f32 = 3.0, number(0.0..=1000.0, "1/m");
        /// Speed at which the noise rises through the smoke. Higher: the smoke boils faster.
        scroll_speed: f32 = 0.2, number(-100.0..=100.0, "m/s");
    }
}
