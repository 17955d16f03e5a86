//! How a sprite keeps from cutting into the scene, what it shows, and the numbers of the techniques that have their own.
//! `docs/techniques.md` compares them.

use super::choice::choice;
use super::table::settings;

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

    /// True if the sprite is a card without thickness.
    pub fn is_flat(self) -> bool {
        matches!(self, Self::Hard | Self::Soft | Self::SoftLinear)
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
        /// As `flipbook`, but the nearest frame alone: half the lookups, and it jumps from one to the next.
        Nearest = "nearest",
    }
}

settings! {
    /// What a sprite shows.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SpriteSettings {
        /// Multiplies the radius of every particle. 0 draws nothing.
        size: f32 = 1.0, number(0.0..=100.0, "");
        /// What moves through the frames.
        animation: SpriteAnimation = SpriteAnimation::default(), choice;
        /// Holds every sprite at the frame it was born with, and the noise of volumetric sprites where it is at time 0.
        /// Frames come from the emitter: a host with its own simulation stops them itself.
        freeze_animation: bool = false, flag;
        /// How far texels are carried along the detail map's motion between two frames: 0 only blends, 1 goes all the way.
        motion: f32 = 0.0, number(0.0..=1.0, "");
        /// How much the age ramp colours a particle, forward only: 0 not at all, 1 wholly. (MS)
        age_colour: f32 = 0.0, number(0.0..=1.0, "");
        /// Shows a checkerboard in place of the sprite. (NV)
        debug_sprite: bool = false, flag;
        /// Draws all sprites this many times, to make the cost of a fragment stand out. (NV)
        debug_loop: u32 = 1, integer(1..=10_000, "");
    }
}

impl SpriteSettings {
    /// These for a sprite of so many frames: one alone is nothing to blend, unless it moves towards itself.
    pub fn for_frames(self, count: f32) -> Self {
        if count > 1.0 || self.motion > 0.0 { self } else { Self { animation: SpriteAnimation::Still, ..self } }
    }
}

settings! {
    /// Numbers of the technique `spherical_billboard`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SphericalBillboard {
        /// Radius of the sphere, in radii of the particle: how far in front of things it thins out.
        radius: f32 = 1.0, number(0.0..=10.0, "");
        /// How fast the amount grows on the way through the middle of the sphere: from haze to a solid ball.
        density: f32 = 3.0, number(0.0..=1000.0, "1/m");
    }
}

settings! {
    /// The number of the technique `density`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Density {
        /// Density of the slab where the sprite's alpha is 1: more hides things nearer to its front.
        density: f32 = 1.0, number(0.0..=1000.0, "1/m");
    }
}

settings! {
    /// Numbers of the techniques `volumetric_hard` and `volumetric_soft`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Volumetric {
        /// Steps of the march through a sphere: fewer are cheaper, and show as layers.
        march_steps: u32 = 6, integer(2..=8, "");
        /// Side of one tile of the noise, which fills the world: how large its lumps are.
        noise_size: f32 = 2.5, number(0.01..=1000.0, "m");
        /// Lookups into the noise for each step, each of three times the frequency and half the weight of the
        /// last: finer lumps.
        noise_octaves: u32 = 2, integer(1..=4, "");
        /// How fast the amount grows where the noise is densest.
        opacity: f32 = 3.0, number(0.0..=1000.0, "1/m");
        /// How fast the noise rises through the smoke: it boils.
        scroll_speed: f32 = 0.2, number(-100.0..=100.0, "m/s");
    }
}
