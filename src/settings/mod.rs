//! Everything a slider moves: the settings of one particle system. Plain data with units and ranges.
//!
//! The order of the variants is the order of the constants in the shaders; `tests/shader_layout.rs` holds the two together.

use glam::Vec3;

use crate::error::FieldError;
use crate::fields::{FieldVisitor, Fields, validate};

/// Derives what every setting enum has.
macro_rules! choice {
    ($(#[$meta:meta])* $name:ident { $($(#[$variant_meta:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
        pub enum $name { $($(#[$variant_meta])* #[serde(rename = $text)] $variant,)+ }

        impl $name {
            /// Every choice, in the order of the documentation.
            pub const ALL: &[Self] = &[$(Self::$variant,)+];

            /// The name used in presets, on the command line and in user interfaces.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }
        }

        impl std::str::FromStr for $name {
            type Err = $crate::error::FieldError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::ALL.iter().copied().find(|choice| choice.name() == text).ok_or_else(|| {
                    let names: Vec<_> = Self::ALL.iter().map(|choice| choice.name()).collect();
                    let expected = format!("one of {}", names.join(", "));
                    Self::Err::new(stringify!($name), format!("{text:?}"), expected)
                })
            }
        }
    };
}

mod technique;

pub use technique::{Density, SphericalBillboard, SpriteAnimation, SpriteSettings, Technique, Volumetric};

choice! {
    /// How a system reaches the picture.
    Path {
        /// The best that the device can do.
        #[default]
        Auto = "auto",
        /// Deferred: sprites blended into the accumulation target by the hardware, lit once per pixel.
        Raster = "raster",
        /// Every fragment lit and blended at full resolution: the classic way, kept as the baseline.
        Forward = "forward",
    }
}

choice! {
    /// Texel format of the accumulation target.
    AccumulationFormat {
        /// 8 bytes. The default.
        #[default]
        Rgba16Float = "rgba16float",
        /// 4 bytes, half the bandwidth. Amounts below about 0.02 are lost to rounding, and the sum stalls near 0.9.
        Rgba8Unorm = "rgba8unorm",
    }
}

choice! {
    /// How a normal is written into the accumulation target.
    NormalEncoding {
        /// -1..1 as it is. Needs `rgba16float`.
        #[default]
        Signed = "signed",
        /// n/2 + 1/2, as OTEE's 8-bit target needs.
        Biased = "biased",
    }
}

choice! {
    /// How the accumulated normal is read back.
    NormalDecode {
        /// Takes the amount into account: right at every amount.
        #[default]
        Exact = "exact",
        /// `normalize(rgb * 2 - 1)`, as printed in OTEE. Wrong wherever the amount is below 1; kept for comparison.
        Literal = "literal",
    }
}

choice! {
    /// Which scene depth the sprites are compared with.
    DepthSource {
        /// A copy at the resolution of the accumulation target. Works everywhere.
        #[default]
        Reduced = "reduced",
        /// The host's own depth buffer, attached read-only; the hardware rejects hidden sprites. Needs scale 1, a
        /// depth-only format, and a backend with read-only depth attachments (not OpenGL).
        Host = "host",
    }
}

choice! {
    /// Which of the depths under a reduced texel is kept.
    DepthDownsample {
        /// Farthest and nearest in alternating texels: an upsampler finds both sides of an edge close by.
        #[default]
        Checkerboard = "checkerboard",
        /// The farthest: smoke covers thin things, and never leaves a halo round them.
        Max = "max",
        /// The nearest: thin things stay clear of smoke, with a halo.
        Min = "min",
        /// The texel's middle pixel: cheapest, shimmers on thin things.
        Point = "point",
    }
}

choice! {
    /// How the reduced target is brought to full resolution.
    Upsample {
        /// Bilinear where the four depths agree, else the texel whose depth is closest: a row of dots can show where an
        /// edge crosses a steep gradient of smoke.
        NearestDepth = "nearest_depth",
        /// Bilinear weights times a falloff over the depth difference. Smooth on both sides of an edge.
        #[default]
        JointBilateral = "joint_bilateral",
        /// Ignores depth. Halos at edges; the baseline.
        Bilinear = "bilinear",
    }
}

choice! {
    /// The curve from depth difference to fade; x is the difference times `fade_scale`, clamped to 0..1.
    FadeCurve {
        /// 3x² - 2x³: no crease at either end.
        #[default]
        Smoothstep = "smoothstep",
        /// x.
        Linear = "linear",
        /// NV's symmetric power curve.
        Contrast = "contrast",
        /// NV's `1 - 2^(-2 (2x)^c)`. Does not reach 1: 0.9375 at x = 1 for c = 1.
        Exponential = "exponential",
        /// Whole up to the surface, and linearly gone `1 / fade_scale` metres behind it: sprites show through. There is
        /// no depth test then. (BLOG, comment)
        Always = "always",
    }
}

choice! {
    /// How the diffuse light of a normal is found.
    DiffuseMode {
        /// Every light through the diffuse ramp, in every pixel. Point lights vary across the smoke.
        #[default]
        Ramp = "ramp",
        /// All lights through the ramp into a small cubemap by normal, once; then one lookup.
        Cubemap = "cubemap",
        /// The same into a picture of a lit sphere, looked up by the normal's xy.
        Motif = "motif",
        /// A painted picture of a lit sphere; the scene's lights do not enter.
        PaintedMotif = "painted_motif",
        /// The same projected on nine spherical harmonics.
        SphericalHarmonics = "spherical_harmonics",
    }
}

choice! {
    /// How soft scatter depends on the amount.
    SoftScatterMode {
        /// From `scatter_colour` to `ambient_colour` by a smoothstep.
        #[default]
        Smoothstep = "smoothstep",
        /// From a painted ramp over the amount.
        Ramp = "ramp",
    }
}

choice! {
    /// How forward sprites are blended: OTEE's three.
    BlendMode {
        /// Greyish smoke: covers what is behind it.
        #[default]
        Alpha = "alpha",
        /// Fiery things: adds light, hides nothing.
        Additive = "additive",
        /// Dark smoke: darkens what is behind it.
        Multiply = "multiply",
    }
}

choice! {
    /// Which stage of the shading is shown. OTEE's "Shade tree".
    ShadeTree {
        /// The smoke, lit, over the scene.
        #[default]
        Final = "final",
        /// Diffuse and soft scatter, without the specular quads.
        Combined = "combined",
        /// Diffuse light alone.
        Diffuse = "diffuse",
        /// Soft scatter alone.
        SoftScatter = "soft_scatter",
        /// The specular quads alone.
        SpecularScatter = "specular_scatter",
        /// Decoded normals, n/2 + 1/2.
        Normals = "normals",
        /// Accumulated amount, as grey.
        Amount = "amount",
        /// Sprite layers per pixel: black 0, blue 4, green 8, yellow 16, red 32, white 64 and more.
        Overdraw = "overdraw",
        /// The depth that sprites are compared with: white at the near side of the box, black beyond the far side.
        ReducedDepth = "reduced_depth",
    }
}

/// The accumulation pass: how sprites become normal + amount.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Accumulate {
    /// Texel format of the target.
    pub format: AccumulationFormat,
    /// How normals are written.
    pub encoding: NormalEncoding,
    /// How normals are read.
    pub decode: NormalDecode,
    /// Pixels of the picture per texel of the target, along each side. Cost falls with its square.
    pub scale: u32,
    /// Most texels along the picture's longer side; raises `scale` on large pictures.
    pub max_side: u32,
    /// Which scene depth sprites are compared with.
    pub depth_source: DepthSource,
    /// Which depth a reduced texel keeps.
    pub depth_downsample: DepthDownsample,
    /// How the target is brought to full resolution.
    pub upsample: Upsample,
    /// Multiplies the amount of every sprite.
    pub opacity: f32,
}

impl Default for Accumulate {
    fn default() -> Self {
        Self {
            format: AccumulationFormat::default(),
            encoding: NormalEncoding::default(),
            decode: NormalDecode::default(),
            scale: 2,
            max_side: 4096,
            depth_source: DepthSource::default(),
            depth_downsample: DepthDownsample::default(),
            upsample: Upsample::default(),
            opacity: 1.0,
        }
    }
}

impl Fields for Accumulate {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("scale", &mut self.scale, 1..=16, "pixels");
        visitor.integer("max_side", &mut self.max_side, 16..=16384, "texels");
        visitor.number("opacity", &mut self.opacity, 0.0..=1.0, "");
    }
}

/// The soft depth fade: how a sprite dissolves where it meets the scene or the camera.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SoftFade {
    /// The curve.
    pub curve: FadeCurve,
    /// Reciprocal of the distance over which a sprite fades. Larger is harder.
    pub fade_scale: f32,
    /// Steepness of the `contrast` and `exponential` curves. 1 is linear for `contrast`.
    pub contrast_power: f32,
    /// Sprites closer to the surface than this are dropped. 0 keeps everything in front of the surface.
    pub epsilon: f32,
    /// View depth at which a sprite is gone.
    pub near_fade_start: f32,
    /// View depth from which a sprite is whole; not less than `near_fade_start`. Both 0: no near fade.
    pub near_fade_end: f32,
}

impl Default for SoftFade {
    fn default() -> Self {
        Self {
            curve: FadeCurve::default(),
            fade_scale: 2.0,
            contrast_power: 2.0,
            epsilon: 0.0,
            near_fade_start: 0.0,
            near_fade_end: 0.5,
        }
    }
}

impl Fields for SoftFade {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("fade_scale", &mut self.fade_scale, 0.001..=1000.0, "1/m");
        visitor.number("contrast_power", &mut self.contrast_power, 0.1..=16.0, "");
        visitor.number("epsilon", &mut self.epsilon, 0.0..=10.0, "m");
        visitor.number("near_fade_start", &mut self.near_fade_start, 0.0..=1000.0, "m");
        visitor.number("near_fade_end", &mut self.near_fade_end, self.near_fade_start..=1000.0, "m");
    }
}

/// Diffuse light: `ramp(dot(n, l)/2 + 1/2)` per light.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Diffuse {
    /// How the light of a normal is found.
    pub mode: DiffuseMode,
    /// Multiplies the sum over all lights.
    pub intensity: f32,
}

impl Default for Diffuse {
    fn default() -> Self {
        Self { mode: DiffuseMode::default(), intensity: 1.0 }
    }
}

impl Fields for Diffuse {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("intensity", &mut self.intensity, 0.0..=100.0, "");
    }
}

/// Soft scatter: the even backlight of thin smoke, darker as the amount grows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SoftScatter {
    /// Curve or painted ramp.
    pub mode: SoftScatterMode,
    /// Amount at which `scatter_colour` begins to give way.
    pub scatter_amount: f32,
    /// Amount after that at which `ambient_colour` is reached.
    pub scatter_smooth: f32,
    /// Linear RGB of thin smoke.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub scatter_colour: Vec3,
    /// Linear RGB of thick smoke.
    #[cfg_attr(feature = "app", schemars(with = "[f32; 3]"))]
    pub ambient_colour: Vec3,
    /// Multiplies the result.
    pub intensity: f32,
}

impl Default for SoftScatter {
    fn default() -> Self {
        Self {
            mode: SoftScatterMode::default(),
            scatter_amount: 0.0,
            scatter_smooth: 0.7,
            scatter_colour: Vec3::new(0.05, 0.055, 0.065),
            ambient_colour: Vec3::new(0.012, 0.013, 0.017),
            intensity: 1.0,
        }
    }
}

impl Fields for SoftScatter {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("scatter_amount", &mut self.scatter_amount, 0.0..=1.0, "");
        visitor.number("scatter_smooth", &mut self.scatter_smooth, 0.0..=1.0, "");
        visitor.vector("scatter_colour", &mut self.scatter_colour, 0.0..=100.0, "");
        visitor.vector("ambient_colour", &mut self.ambient_colour, 0.0..=100.0, "");
        visitor.number("intensity", &mut self.intensity, 0.0..=100.0, "");
    }
}

/// Specular scatter: the glow round a light seen through smoke.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SpecularScatter {
    /// Half the side of the quad, whatever the distance.
    pub size: f32,
    /// Multiplies the glow. 0 draws no quads.
    pub intensity: f32,
}

impl Default for SpecularScatter {
    fn default() -> Self {
        Self { size: 160.0, intensity: 1.0 }
    }
}

impl Fields for SpecularScatter {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("size", &mut self.size, 1.0..=8192.0, "pixels");
        visitor.number("intensity", &mut self.intensity, 0.0..=100.0, "");
    }
}

/// All settings of one particle system.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How the system reaches the picture.
    pub path: Path,
    /// How forward sprites are blended; the deferred path has its own blend.
    pub blend_mode: BlendMode,
    /// How sprites meet the scene.
    pub technique: Technique,
    /// Multiplies the accumulated amount into coverage. OTEE's value is 3.
    pub boost: f32,
    /// What sprites show.
    pub sprite: SpriteSettings,
    /// Sprites to normal + amount.
    pub accumulate: Accumulate,
    /// The fade against scene and camera.
    pub soft_fade: SoftFade,
    /// For the technique of that name.
    pub spherical_billboard: SphericalBillboard,
    /// For the technique of that name.
    pub density: Density,
    /// For the techniques of that name.
    pub volumetric: Volumetric,
    /// Light by normal.
    pub diffuse: Diffuse,
    /// Light by amount.
    pub soft_scatter: SoftScatter,
    /// Glow round lights behind.
    pub specular_scatter: SpecularScatter,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            path: Path::default(),
            blend_mode: BlendMode::default(),
            technique: Technique::default(),
            boost: 3.0,
            sprite: SpriteSettings::default(),
            accumulate: Accumulate::default(),
            soft_fade: SoftFade::default(),
            spherical_billboard: SphericalBillboard::default(),
            density: Density::default(),
            volumetric: Volumetric::default(),
            diffuse: Diffuse::default(),
            soft_scatter: SoftScatter::default(),
            specular_scatter: SpecularScatter::default(),
        }
    }
}

impl Fields for Settings {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("boost", &mut self.boost, 0.0..=16.0, "");
        visitor.group("sprite", &mut self.sprite);
        visitor.group("accumulate", &mut self.accumulate);
        visitor.group("soft_fade", &mut self.soft_fade);
        visitor.group("spherical_billboard", &mut self.spherical_billboard);
        visitor.group("density", &mut self.density);
        visitor.group("volumetric", &mut self.volumetric);
        visitor.group("diffuse", &mut self.diffuse);
        visitor.group("soft_scatter", &mut self.soft_scatter);
        visitor.group("specular_scatter", &mut self.specular_scatter);
    }
}

impl Settings {
    /// True if the system is lit and blended per fragment.
    pub fn is_forward(&self) -> bool {
        self.path == Path::Forward
    }

    /// Metres behind the scene at which sprites are still seen: none, but for the curve `always`.
    pub fn fade_through(&self) -> f32 {
        let shows_through = self.soft_fade.curve == FadeCurve::Always && self.technique.is_soft();
        if shows_through { 1.0 / self.soft_fade.fade_scale } else { 0.0 }
    }

    /// How far the corners of a sprite reach, whichever way it turns, in radii of its particle.
    pub fn reach(&self) -> f32 {
        let of_technique = match self.technique {
            Technique::SphericalBillboard => self.spherical_billboard.radius,
            Technique::VolumetricHard | Technique::VolumetricSoft => 1.0,
            _ => std::f32::consts::SQRT_2,
        };
        self.sprite.size * of_technique
    }

    /// Checks ranges and the settings that exclude each other.
    ///
    /// # Errors
    /// The first field in conflict; `path` is put before its name.
    pub fn validate(&self, path: impl Fn() -> String) -> Result<(), FieldError> {
        validate(self, &path)?;
        let conflict = |field: &str, value: &str, expected: &str| {
            let prefix = path();
            let dot = if prefix.is_empty() { "" } else { "." };
            Err(FieldError::new(format!("{prefix}{dot}accumulate.{field}"), value, expected))
        };
        let accumulate = &self.accumulate;
        if accumulate.format == AccumulationFormat::Rgba8Unorm && accumulate.encoding == NormalEncoding::Signed {
            return conflict("encoding", "signed", "\"biased\" with format \"rgba8unorm\", which holds no sign");
        }
        if accumulate.depth_source == DepthSource::Host && accumulate.scale != 1 {
            return conflict("scale", &accumulate.scale.to_string(), "1 with depth_source \"host\"");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid() {
        Settings::default().validate(String::new).unwrap();
    }

    #[test]
    fn names_round_trip() {
        for &choice in Upsample::ALL {
            assert_eq!(choice.name().parse::<Upsample>().unwrap(), choice);
            assert_eq!(serde_json::to_string(&choice).unwrap(), format!("{:?}", choice.name()));
        }
        let error = "cubic".parse::<Upsample>().unwrap_err().to_string();
        assert!(error.contains("\"cubic\"") && error.contains("nearest_depth, joint_bilateral, bilinear"), "{error}");
    }

    #[test]
    fn settings_that_exclude_each_other_are_refused() {
        let mut settings = Settings::default();
        settings.accumulate.format = AccumulationFormat::Rgba8Unorm;
        assert_eq!(settings.validate(|| "s".into()).unwrap_err().field, "s.accumulate.encoding");
        settings.accumulate.encoding = NormalEncoding::Biased;
        settings.validate(String::new).unwrap();
        settings.accumulate.depth_source = DepthSource::Host;
        assert_eq!(settings.validate(String::new).unwrap_err().field, "accumulate.scale");
        settings.accumulate.scale = 1;
        settings.validate(String::new).unwrap();
    }
}
