//! Settings of one particle system: plain data with units and ranges. Every slider moves one of their fields.
//!
//! The order of the variants is the order of the constants in the shaders, which `tests/suite/shader_layout.rs` checks.

use crate::error::FieldError;

mod accumulate;
mod assign;
pub mod choice;
mod curve;
mod debug;
pub mod deserialize;
pub mod fields;
mod lighting;
mod old_names;
mod scale_budget;
pub mod settings_macro;
mod shadow;
mod soft_fade;
mod technique;
mod traversal;

pub use accumulate::COARSEST_AUTO_SCALE;
pub use accumulate::{
    Accumulate, AccumulationFormat, BlendOrder, DepthDownsample, DepthSource, LightingResolution, NormalDecode,
    NormalEncoding, ScaleMode, Traversal, Upsample,
};
pub use assign::is_field_named;
pub use assign::set_field;
pub use choice::choice;
pub use choice::{Choice, ParseChoiceError};
pub use curve::{Curve, CurveError, MAX_CURVE_POINTS};
pub use debug::DebugSettings;
pub use fields::{BackdropKind, FieldHeading, FieldVisitor, Fields, ImageRole, validate};
pub use lighting::{
    Ambient, Backlight, CoverageMode, Diffuse, DiffuseMode, Fire, Lighting, RampFilter, SoftScatter, SoftScatterMode,
    SpecularScatter,
};
pub use old_names::{current_path, rename_old_keys};
pub use scale_budget::{Budget, ScaleBudget};
pub use settings_macro::settings;
pub use shadow::Shadow;
pub use soft_fade::{FadeCurve, SoftFade};
pub use technique::{Exponential, Grain, SphericalBillboard, SpriteAnimation, SpriteSettings, Technique, Volumetric};
pub use traversal::write_field_path;
pub use traversal::{FieldRef, FieldValue, PathStep, field_path, field_values, for_each_field};

choice! {
    /// Rendering path of a system.
    RenderPath {
        /// The faster of `raster` and `tiled`, estimated from the number of layers and their cost on the device.
        #[default]
        Auto = "auto",
        /// Deferred: the hardware blends sprites into the accumulation target, which is lit once per pixel.
        Raster = "raster",
        /// Deferred, accumulated by compute shaders: sprites are listed by tiles of the target and added up front to
        /// back, texel by texel. Layers are cheap, and hidden ones are skipped. Not every device supports it;
        /// `docs/tiled.md` compares the two.
        Tiled = "tiled",
        /// Every fragment is lit and blended at full resolution: the classic method, kept as the baseline.
        Forward = "forward",
    }
}

impl RenderPath {
    /// Paths that this setting may select.
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
    /// Blend mode of smoke over the scene: OTEE's three.
    BlendMode {
        /// Smoke: covers the background.
        #[default]
        Alpha = "alpha",
        /// Glow alone, which hides nothing: magic, holograms, sparks in front of a bright sky.
        Additive = "additive",
        /// Dark smoke: darkens the background. On the path `forward`; other paths draw `alpha`.
        Multiply = "multiply",
    }
}

choice! {
    /// Tonemap of the program's images: from the light of a scene, which has no limit, to the colors of a screen. The library
    /// changes no color of a host.
    Tonemap {
        /// Contrast of film. Bright colors turn on their way to white: orange fire to yellow, violet to pink.
        #[default]
        Aces = "aces",
        /// Contrast of film. Bright colors pale and keep their hue: for magic in blue, cyan or violet. Red flames turn to salmon.
        KeepHue = "keep_hue",
        /// Soft contrast, and colors that pale slowly.
        Agx = "agx",
        /// Colors as they were painted, up to four fifths of white; brighter ones pale and keep their hue.
        Neutral = "neutral",
    }
}

choice! {
    /// Debug view: the stage of the shading that is shown. OTEE's "Shade tree".
    DebugView {
        /// Lit smoke over the scene.
        #[default]
        Final = "final",
        /// Diffuse light and soft scatter, without specular scatter.
        Combined = "combined",
        /// Diffuse light only.
        Diffuse = "diffuse",
        /// Soft scatter only.
        SoftScatter = "soft_scatter",
        /// Specular scatter only.
        SpecularScatter = "specular_scatter",
        /// Decoded normals, n/2 + 1/2.
        Normals = "normals",
        /// Accumulated amount of all systems, as white smoke: gray over black.
        Amount = "amount",
        /// Sprite layers per pixel, of the system in front where several have smoke: black 0, blue 4, green 8, yellow 16,
        /// red 32, white 64 and more.
        Overdraw = "overdraw",
        /// Depth that sprites are compared with: white at the near side of the box, black beyond the far side. Of the system
        /// in front where several boxes overlap.
        ReducedDepth = "reduced_depth",
        /// Fractions of the first three lights with shadow that reach the smoke, in red, green and blue: what comes through
        /// other smoke, 2^(-optical depth), and past the scene.
        Shadow = "shadow",
        /// The same in the grid of the shadow, on a plane through the middle of the smoke. Dark lines are borders of cells.
        ShadowSlice = "shadow_slice",
    }
}

impl DebugView {
    /// True for debug views that show data instead of light, which are neither exposed nor tonemapped.
    pub fn is_data(self) -> bool {
        matches!(
            self,
            Self::Normals | Self::Amount | Self::Overdraw | Self::ReducedDepth | Self::Shadow | Self::ShadowSlice
        )
    }

    /// True for debug views that show lit smoke, which forward sprites show too.
    pub fn shows_lit_smoke(self) -> bool {
        matches!(self, Self::Final | Self::Combined)
    }

    /// True for debug views that show the glow of lights.
    pub fn shows_glow(self) -> bool {
        matches!(self, Self::Final | Self::SpecularScatter)
    }
}

settings! {
    /// All settings of one particle system.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Settings {
        /// Rendering path: its cost, and with `forward`, its lighting too.
        path: RenderPath = RenderPath::Auto, choice;
        /// Blend over the scene: smoke that covers what is behind it, or glow alone, which hides nothing however thick it is.
        blend_mode: BlendMode = BlendMode::Alpha, choice;
        /// Systems of a higher priority are drawn over those of a lower one, wherever they are: sparks over the smoke
        /// around them. Those of equal priority are drawn far to near, by the middle of their boxes.
        sort_priority: u32 = 0, integer(0..=15, "");
        /// Technique by which sprites meet the scene: hard cut, soft fade, or volume.
        technique: Technique = Technique::Soft, choice;
        /// Lighting model of sprites: painted, or path-traced.
        lighting: Lighting = Lighting::default(), choice;
        /// Multiplies the accumulated amount into coverage. Higher: smoke hides the scene sooner. OTEE uses 3.
        boost: f32 = 3.0, number(0.0..=16.0, "");
        /// Conversion of the amount to coverage: soft silhouettes, or painted ones.
        coverage: CoverageMode = CoverageMode::default(), choice;
        /// Values of ramps between two texels: smooth light, or hard steps.
        ramp_filter: RampFilter = RampFilter::default(), choice;
        /// Size and animation of sprites.
        sprite: SpriteSettings = SpriteSettings::default(), group;
        /// Noise that is finer than the texels of the sprite.
        grain: Grain = Grain::default(), group;
        /// Accumulation of sprites into normal and amount.
        accumulate: Accumulate = Accumulate::default(), group;
        /// Fade of sprites near the scene and near the camera.
        soft_fade: SoftFade = SoftFade::default(), group;
        /// Settings of the technique of that name.
        spherical_billboard: SphericalBillboard = SphericalBillboard::default(), group;
        /// Settings of the technique `density`.
        exponential: Exponential = Exponential::default(), group;
        /// Settings of the techniques of that name.
        volumetric: Volumetric = Volumetric::default(), group;
        /// Diffuse light, by normal.
        diffuse: Diffuse = Diffuse::default(), group;
        /// Shadow of smoke on smoke.
        shadow: Shadow = Shadow::default(), group;
        /// Light from the sky and from the ground.
        ambient: Ambient = Ambient::default(), group;
        /// Light of hot smoke.
        fire: Fire = Fire::default(), group;
        /// Soft scatter, by amount: light without a source.
        soft_scatter: SoftScatter = SoftScatter::default(), group;
        /// Glow around lights behind the smoke.
        specular_scatter: SpecularScatter = SpecularScatter::default(), group;
        /// Settings to debug smoke, and to measure it.
        debug: DebugSettings = DebugSettings::default(), group;
    }
}

impl Settings {
    /// True if the system is lit and blended per fragment.
    pub fn is_forward(&self) -> bool {
        self.path == RenderPath::Forward
    }

    /// True if sprites are lit by six-way maps.
    pub fn is_six_way(&self) -> bool {
        self.lighting == Lighting::SixWay && !self.technique.is_volumetric() && !self.debug.checkerboard
    }

    /// True if smoke can shade the diffuse light of this system: each light has a lookup of its own.
    pub fn can_receive_shadow(&self) -> bool {
        self.is_forward() || self.is_six_way() || self.diffuse.mode == DiffuseMode::Ramp
    }

    /// True if smoke shades the diffuse light of this system.
    pub fn receives_shadow(&self) -> bool {
        self.shadow.strength > 0.0 && self.can_receive_shadow()
    }

    /// True if shadow falls on the smoke at its mean depth: that of the scene, and that of smoke from the fourth light on.
    pub fn receives_shadow_by_depth(&self) -> bool {
        self.shadow.by_depth && self.receives_shadow()
    }

    /// True if light from sky and ground can fall on the smoke: it is looked up, or baked, by normal.
    pub fn can_have_ambient(&self) -> bool {
        let by_normal = !matches!(self.diffuse.mode, DiffuseMode::PaintedMotif | DiffuseMode::SphericalHarmonics);
        self.is_forward() || self.is_six_way() || by_normal
    }

    /// True if light from sky and ground falls on the smoke.
    pub fn has_ambient(&self) -> bool {
        self.ambient.intensity > 0.0 && self.can_have_ambient()
    }

    /// True if smoke shades ambient light.
    pub fn shades_ambient(&self) -> bool {
        self.has_ambient() && self.receives_shadow_by_depth()
    }

    /// True if the smoke gives light of its own.
    pub fn burns(&self) -> bool {
        self.fire.intensity > 0.0
    }

    /// True if particles have colors of their own.
    pub fn is_tinted(&self) -> bool {
        self.sprite.age_color > 0.0 || self.sprite.tint > 0.0
    }

    /// True if sprites are stretched along their motion.
    pub fn is_stretched(&self) -> bool {
        self.sprite.stretch > 0.0 && self.sprite.stretch_limit > 1.0 && !self.technique.is_sphere()
    }

    /// Octaves of the noise that gives sprites their grain; 0 without grain.
    pub fn grain_octaves(&self) -> u32 {
        let Grain { erosion, dissolve, bump, octaves, .. } = self.grain;
        let is_shown = erosion > 0.0 || dissolve > 0.0 || bump > 0.0;
        let has_image = !self.technique.is_volumetric() && !self.debug.checkerboard;
        if is_shown && has_image { octaves } else { 0 }
    }

    /// `fire.crust`, or 0 with six-way maps, which have no normals.
    pub fn fire_crust(&self) -> f32 {
        if self.is_six_way() { 0.0 } else { self.fire.crust }
    }

    /// Order in which sprites are drawn. Forward sprites hide each other and are always sorted.
    pub fn order(&self) -> BlendOrder {
        if self.is_forward() { BlendOrder::Sorted } else { self.accumulate.order }
    }

    /// Distance behind the scene at which sprites still show, metres: 0, except under the curve `always`.
    pub fn show_through_distance(&self) -> f32 {
        let shows_through = self.soft_fade.curve == FadeCurve::Always && self.technique.is_soft();
        if shows_through { 1.0 / self.soft_fade.fade_scale } else { 0.0 }
    }

    /// Checks ranges, and settings that exclude each other.
    ///
    /// # Errors
    /// The first field that is out of range or in conflict. `path` precedes its name.
    pub fn validate(&self, path: impl Fn() -> String) -> Result<(), FieldError> {
        validate(self, &path)?;
        let conflict = |field: &str, value: &str, expected: &str| {
            let prefix = path();
            let dot = if prefix.is_empty() { "" } else { "." };
            Err(FieldError::new(format!("{prefix}{dot}accumulate.{field}"), value, expected))
        };
        let accumulate = &self.accumulate;
        if accumulate.format == AccumulationFormat::Rgba8Unorm && accumulate.encoding == NormalEncoding::Signed {
            return conflict(
                "encoding",
                "\"signed\"",
                "\"biased\" with format \"rgba8unorm\", which cannot hold signs",
            );
        }
        if accumulate.format == AccumulationFormat::Rgba8Unorm && accumulate.order == BlendOrder::Weighted {
            return conflict("order", "\"weighted\"", "\"sorted\" with format \"rgba8unorm\", which cannot hold sums");
        }
        if accumulate.depth_source == DepthSource::Host && accumulate.downscale != 1 {
            return conflict("downscale", &accumulate.downscale.to_string(), "1 with depth_source \"host\"");
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
        assert_eq!(error, "\"cubic\" is not valid; expected one of guided, joint_bilateral, nearest_depth, bilinear");
    }

    #[test]
    fn conflicting_settings_are_rejected() {
        let mut settings = Settings::default();
        settings.accumulate.format = AccumulationFormat::Rgba8Unorm;
        assert_eq!(settings.validate(|| "s".into()).unwrap_err().field, "s.accumulate.encoding");
        settings.accumulate.encoding = NormalEncoding::Biased;
        settings.validate(String::new).unwrap();
        settings.accumulate.order = BlendOrder::Weighted;
        assert_eq!(settings.validate(String::new).unwrap_err().field, "accumulate.order");
        settings.accumulate.order = BlendOrder::Sorted;
        settings.accumulate.depth_source = DepthSource::Host;
        assert_eq!(settings.validate(String::new).unwrap_err().field, "accumulate.downscale");
        settings.accumulate.downscale = 1;
        settings.validate(String::new).unwrap();
    }
}
