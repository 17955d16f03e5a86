//! Lighting of the smoke: by its normal, by its amount, and from behind.

use glam::Vec3;

use super::choice::choice;
use super::settings_macro::settings;

choice! {
    /// Lighting model of sprites. `docs/six_way.md` compares the two.
    Lighting {
        /// Normals, through ramps that an artist paints.
        #[default]
        Normals = "normals",
        /// Six-way maps: images of the sprite under light from six sides, with shadows inside the smoke. Volumetric
        /// sprites, which have no image, and devices that cannot blend two targets use normals.
        SixWay = "six_way",
    }
}

choice! {
    /// Computation of the diffuse light of a normal.
    DiffuseMode {
        /// Every light through the diffuse ramp, in every pixel. Point lights vary across the smoke.
        #[default]
        Ramp = "ramp",
        /// All lights through the ramp into a small cubemap by normal, once; then one lookup per pixel.
        Cubemap = "cubemap",
        /// All lights through the ramp into an image of a lit sphere, which is looked up by the normal's xy.
        Motif = "motif",
        /// A painted image of a lit sphere. The scene's lights have no effect.
        PaintedMotif = "painted_motif",
        /// All lights through the ramp, projected on nine spherical harmonics.
        SphericalHarmonics = "spherical_harmonics",
    }
}

choice! {
    /// Ramp for light from behind the smoke.
    Backlight {
        /// The diffuse ramp, as from any side.
        #[default]
        Same = "same",
        /// The backlight ramp. It is mixed with the diffuse ramp by how far behind the smoke the light is.
        Ramp = "ramp",
    }
}

choice! {
    /// Dependence of soft scatter on the amount.
    SoftScatterMode {
        /// From `scatter_color` to `ambient_color` by a smoothstep.
        #[default]
        Smoothstep = "smoothstep",
        /// From a painted ramp over the amount.
        Ramp = "ramp",
    }
}

choice! {
    /// Conversion of the amount to coverage, the fraction of the background that is hidden.
    CoverageMode {
        /// The amount times `boost`.
        #[default]
        Linear = "linear",
        /// The coverage ramp, looked up at the amount times `boost`: silhouettes by paint.
        Ramp = "ramp",
    }
}

choice! {
    /// Value of a ramp between two of its texels.
    RampFilter {
        /// A mix of both: smooth light.
        #[default]
        Bilinear = "bilinear",
        /// The nearer one: hard steps.
        Nearest = "nearest",
    }
}

settings! {
    /// Diffuse light: `ramp(dot(n, l)/2 + 1/2, amount · boost)` per light.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Diffuse {
        /// Computation of diffuse light: exact, cheap for many lights, or painted.
        mode: DiffuseMode = DiffuseMode::default(), choice;
        /// Ramp for light from behind: the same as from all sides, or one of its own, for smoke that glows against the
        /// sun and is gray beside it.
        backlight: Backlight = Backlight::default(), choice;
        /// Multiplies the diffuse light of all lights. Higher: brighter smoke in the same scene.
        intensity: f32 = 1.0, number(0.0..=100.0, "");
        /// Linear RGB color of smoke that is lit by six-way maps, which have no color of their own.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        six_way_color: Vec3 = Vec3::ONE, color(0.0..=1.0);
        /// Mix of six-way maps for light from between their sides. 0: even. Towards 1: smoke that scatters light
        /// forward, with a glow close around a light behind it.
        six_way_anisotropy: f32 = 0.2, number(0.0..=0.95, "");
    }
}

settings! {
    /// Light without a source: sky from above, light that the ground reflects from below. Smoke between them shades it with
    /// `shadow.by_depth`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Ambient {
        /// Multiplies both colors. 0: no ambient light, and no cost. 1: white smoke has the color of the sky on its upper
        /// side. Not with `diffuse.mode` `painted_motif` or `spherical_harmonics`.
        intensity: f32 = 0.0, number(0.0..=100.0, "");
        /// Linear RGB of the light from above.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        sky_color: Vec3 = Vec3::new(0.25, 0.32, 0.42), color(0.0..=100.0);
        /// Linear RGB of the light from below.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        ground_color: Vec3 = Vec3::new(0.09, 0.08, 0.065), color(0.0..=100.0);
    }
}

settings! {
    /// Fire: light of the smoke itself. The heat ramp tells how hot a particle is at each age, the fire ramp how heat glows.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Fire {
        /// Multiplies the fire ramp. 0: no fire, and no cost. Far above 1: a fire that outshines the scene.
        intensity: f32 = 0.0, number(0.0..=1000.0, "");
        /// Fraction by which the thin edge of a sprite is cooler than its middle. 0: even. 1: flames with dark edges.
        core: f32 = 0.6, number(0.0..=1.0, "");
        /// Fraction by which a puff is cooler where it faces the viewer: soot over the glow of its creases, as on a fireball.
        /// Not with six-way maps.
        crust: f32 = 0.0, number(0.0..=1.0, "");
        /// Multiplies the light that the fire casts on smoke and scene. 0: none. A host asks for it, `haze::fire::FireLight`.
        light: f32 = 1.0, number(0.0..=100.0, "");
        /// Flicker of that light. 0: steady. 1: it nearly goes out.
        flicker: f32 = 0.3, number(0.0..=1.0, "");
    }
}

settings! {
    /// Soft scatter: even backlight of thin smoke, which darkens as the amount grows.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SoftScatter {
        /// Curve between two colors, or a painted ramp.
        mode: SoftScatterMode = SoftScatterMode::default(), choice;
        /// Amount at which `scatter_color` begins to fade. Higher: the pale rim reaches further in.
        scatter_amount: f32 = 0.0, number(0.0..=1.0, "");
        /// Range of amounts, after that, over which it changes to `ambient_color`. Lower: a sharp edge. Higher: a slow
        /// change.
        scatter_smooth: f32 = 0.7, number(0.0..=1.0, "");
        /// Linear RGB of thin smoke, which lets light through from all around.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        scatter_color: Vec3 = Vec3::new(0.05, 0.055, 0.065), color(0.0..=100.0);
        /// Linear RGB of thick smoke. Higher: brightens parts that no light reaches.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        ambient_color: Vec3 = Vec3::new(0.012, 0.013, 0.017), color(0.0..=100.0);
        /// Multiplies soft scatter. Higher: milky smoke. Lower: dark shade.
        intensity: f32 = 1.0, number(0.0..=100.0, "");
    }
}

settings! {
    /// Specular scatter: glow around a light that is seen through smoke.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SpecularScatter {
        /// Half the side of the glow's quad, at any distance, in pixels of a view that is 720 pixels high. It grows with
        /// the view's height. Higher: a wider glow; cost grows with its square.
        size: f32 = 160.0, number(1.0..=8192.0, "pixels");
        /// Multiplies the glow. Higher: brighter. 0 draws no quads.
        intensity: f32 = 1.0, number(0.0..=100.0, "");
        /// Fraction of the light's falloff with its distance from the smoke that dims the glow. 0: a point or spot light glows
        /// by its intensity at one metre, however far it is. 1: by the light that arrives in the middle of the smoke.
        falloff: f32 = 0.0, number(0.0..=1.0, "");
    }
}

impl SpecularScatter {
    /// Height of the view that `size` refers to, pixels.
    pub const REFERENCE_HEIGHT: f32 = 720.0;

    /// Half the side of the glow's quad in a view of this height, at least one pixel.
    pub fn size_in_pixels(&self, height: u32) -> f32 {
        (self.size * height as f32 / Self::REFERENCE_HEIGHT).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glow_keeps_its_share_of_the_views_height() {
        let fraction = |height: u32| SpecularScatter::default().size_in_pixels(height) / height as f32;
        assert!((SpecularScatter::default().size_in_pixels(720) - SpecularScatter::default().size).abs() < 1e-3);
        assert!((fraction(2160) - fraction(90)).abs() < 1e-6);
    }
}
