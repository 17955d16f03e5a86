//! Everything a slider moves: the settings of one particle system. Plain data with units and ranges.
//!
//! The order of the variants is the order of the constants in the shaders; `tests/suite/shader_layout.rs` holds the two together.

use crate::error::FieldError;

mod accumulate;
mod budget;
#[doc(hidden)]
pub mod choice;
pub(crate) mod fields;
mod lighting;
mod set;
mod soft_fade;
pub(crate) mod table;
mod technique;
mod walk;

pub use accumulate::{
    Accumulate, AccumulationFormat, DepthDownsample, DepthSource, Layers, LightingResolution, NormalDecode,
    NormalEncoding, Order, Upsample,
};
pub use budget::{Budget, ScaleBudget};
pub use choice::Choice;
#[doc(hidden)]
pub use choice::choice;
pub use fields::{FieldVisitor, Fields, Headed, PictureRole, validate};
pub use lighting::{
    Backlight, CoverageMode, Diffuse, DiffuseMode, Lighting, RampFilter, SoftScatter, SoftScatterMode, SpecularScatter,
};
pub use set::set_field;
pub use soft_fade::{FadeCurve, SoftFade};
pub(crate) use table::settings;
pub use technique::{Density, SphericalBillboard, SpriteAnimation, SpriteSettings, Technique, Volumetric};
pub use walk::{Leaf, Step, Value, path_of, values, walk};

choice! {
    /// How a system reaches the picture.
    Path {
        /// The faster of `raster` and `tiled`, as far as can be told from how many layers there are and what the device takes for them.
        #[default]
        Auto = "auto",
        /// Deferred: sprites blended into the accumulation target by the hardware, lit once per pixel.
        Raster = "raster",
        /// The same, accumulated by compute shaders: sprites are listed by tiles of the target and added up front to back, texel by
        /// texel. Layers cost little, and none that cannot be seen. Not every device can; `docs/tiled.md` compares the two.
        Tiled = "tiled",
        /// Every fragment lit and blended at full resolution: the classic way, kept as the baseline.
        Forward = "forward",
    }
}

impl Path {
    /// What it may turn out to be.
    pub fn candidates(self) -> &'static [Self] {
        match self {
            Self::Auto => &[Self::Raster, Self::Tiled],
            Self::Raster => &[Self::Raster],
            Self::Tiled => &[Self::Tiled],
            Self::Forward => &[Self::Forward],
        }
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

impl ShadeTree {
    /// True for stages that show numbers, not light: they are neither exposed nor tonemapped.
    pub fn is_data(self) -> bool {
        matches!(self, Self::Normals | Self::Amount | Self::Overdraw | Self::ReducedDepth)
    }

    /// True for what forward sprites show too: lit smoke.
    pub fn is_picture(self) -> bool {
        matches!(self, Self::Final | Self::Combined)
    }

    /// True where the glow of lights is shown.
    pub fn glows(self) -> bool {
        matches!(self, Self::Final | Self::SpecularScatter)
    }
}

settings! {
    /// All settings of one particle system.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Settings {
        /// How the system reaches the picture: what it costs, and, drawn forward, how it is lit.
        path: Path = Path::Auto, choice;
        /// How forward sprites are blended; the deferred path has its own blend.
        blend_mode: BlendMode = BlendMode::Alpha, choice;
        /// How sprites meet the scene.
        technique: Technique = Technique::Soft, choice;
        /// How sprites take on light: painted, or path-traced.
        lighting: Lighting = Lighting::default(), choice;
        /// Multiplies the accumulated amount into coverage: how soon smoke hides the scene. OTEE's value is 3.
        boost: f32 = 3.0, number(0.0..=16.0, "");
        /// How the amount becomes coverage: soft silhouettes, or any by paint.
        coverage: CoverageMode = CoverageMode::default(), choice;
        /// What ramps give between two texels: smooth light, or hard steps.
        ramp_filter: RampFilter = RampFilter::default(), choice;
        /// What sprites show.
        sprite: SpriteSettings = SpriteSettings::default(), group;
        /// Sprites to normal + amount.
        accumulate: Accumulate = Accumulate::default(), group;
        /// The fade against scene and camera.
        soft_fade: SoftFade = SoftFade::default(), group;
        /// For the technique of that name.
        spherical_billboard: SphericalBillboard = SphericalBillboard::default(), group;
        /// For the technique of that name.
        density: Density = Density::default(), group;
        /// For the techniques of that name.
        volumetric: Volumetric = Volumetric::default(), group;
        /// Light by normal.
        diffuse: Diffuse = Diffuse::default(), group;
        /// Light by amount.
        soft_scatter: SoftScatter = SoftScatter::default(), group;
        /// Glow round lights behind.
        specular_scatter: SpecularScatter = SpecularScatter::default(), group;
    }
}

impl Settings {
    /// True if the system is lit and blended per fragment.
    pub fn is_forward(&self) -> bool {
        self.path == Path::Forward
    }

    /// True if sprites are lit by six-way maps.
    pub fn is_six_way(&self) -> bool {
        self.lighting == Lighting::SixWay && !self.technique.is_volumetric() && !self.sprite.debug_sprite
    }

    /// The order in which sprites are drawn. Forward sprites hide each other and are always sorted.
    pub fn order(&self) -> Order {
        if self.is_forward() { Order::Sorted } else { self.accumulate.order }
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
        if accumulate.format == AccumulationFormat::Rgba8Unorm && accumulate.order == Order::Weighted {
            return conflict("order", "weighted", "\"sorted\" with format \"rgba8unorm\", which holds no sums");
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
        assert!(
            error.contains("\"cubic\"") && error.contains("guided, joint_bilateral, nearest_depth, bilinear"),
            "{error}"
        );
    }

    #[test]
    fn settings_that_exclude_each_other_are_refused() {
        let mut settings = Settings::default();
        settings.accumulate.format = AccumulationFormat::Rgba8Unorm;
        assert_eq!(settings.validate(|| "s".into()).unwrap_err().field, "s.accumulate.encoding");
        settings.accumulate.encoding = NormalEncoding::Biased;
        settings.validate(String::new).unwrap();
        settings.accumulate.order = Order::Weighted;
        assert_eq!(settings.validate(String::new).unwrap_err().field, "accumulate.order");
        settings.accumulate.order = Order::Sorted;
        settings.accumulate.depth_source = DepthSource::Host;
        assert_eq!(settings.validate(String::new).unwrap_err().field, "accumulate.scale");
        settings.accumulate.scale = 1;
        settings.validate(String::new).unwrap();
    }
}
