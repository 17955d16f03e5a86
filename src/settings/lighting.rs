//! The light on the smoke: by its normal, by its amount, and from behind.

use glam::Vec3;

use super::choice::choice;
use super::table::settings;

choice! {
    /// How sprites take on light. `docs/six_way.md` compares the two.
    Lighting {
        /// By their normals, through ramps that an artist paints.
        #[default]
        Normals = "normals",
        /// By six-way maps: pictures of the sprite under light from six sides, as smoke truly answers it, shadows within it and all.
        /// Volumetric sprites, which have no picture, and devices that cannot blend two targets keep to normals.
        SixWay = "six_way",
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
    /// What a light that shines from behind the smoke is looked up in.
    Backlight {
        /// In the diffuse ramp, as from any side.
        #[default]
        Same = "same",
        /// In the backlight ramp; between the viewer's side and straight against it in a mix of both.
        Ramp = "ramp",
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
    /// How the amount becomes coverage: the share of what is behind that is hidden.
    CoverageMode {
        /// Times `boost`.
        #[default]
        Linear = "linear",
        /// Through the coverage ramp, looked up at the amount times `boost`: silhouettes by paint.
        Ramp = "ramp",
    }
}

choice! {
    /// What a ramp gives between two of its texels.
    RampFilter {
        /// A mix of both.
        #[default]
        Bilinear = "bilinear",
        /// The nearer of them: hard steps.
        Nearest = "nearest",
    }
}

settings! {
    /// Diffuse light: `ramp(dot(n, l)/2 + 1/2, amount · boost)` per light.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Diffuse {
        /// How the light of a normal is found: exactly, cheaply for many lights, or by paint.
        mode: DiffuseMode = DiffuseMode::default(), choice;
        /// One ramp for light from all sides, or another for light from behind: smoke that glows against the sun and is grey beside it.
        backlight: Backlight = Backlight::default(), choice;
        /// Multiplies the sum over all lights: brighter smoke in the same scene.
        intensity: f32 = 1.0, number(0.0..=100.0, "");
        /// Linear RGB of smoke that is lit by six-way maps, which hold no colour of their own.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        six_way_colour: Vec3 = Vec3::ONE, colour(0.0..=1.0);
        /// How six-way maps are mixed for light from between their sides: 0 evenly; towards 1 as smoke that scatters light onwards, whose
        /// glow keeps close round a light behind it.
        six_way_anisotropy: f32 = 0.2, number(0.0..=0.95, "");
    }
}

settings! {
    /// Soft scatter: the even backlight of thin smoke, darker as the amount grows.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SoftScatter {
        /// Curve or painted ramp: two colours, or any.
        mode: SoftScatterMode = SoftScatterMode::default(), choice;
        /// Amount at which `scatter_colour` begins to give way: more lets the pale rim reach further in.
        scatter_amount: f32 = 0.0, number(0.0..=1.0, "");
        /// Amount after that at which `ambient_colour` is reached: little makes an edge, much a slow change.
        scatter_smooth: f32 = 0.7, number(0.0..=1.0, "");
        /// Linear RGB of thin smoke, where light comes through whatever it comes from.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        scatter_colour: Vec3 = Vec3::new(0.05, 0.055, 0.065), colour(0.0..=100.0);
        /// Linear RGB of thick smoke: lifts what no light reaches.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        ambient_colour: Vec3 = Vec3::new(0.012, 0.013, 0.017), colour(0.0..=100.0);
        /// Multiplies the result: milky smoke, or shade that is dark.
        intensity: f32 = 1.0, number(0.0..=100.0, "");
    }
}

settings! {
    /// Specular scatter: the glow round a light seen through smoke.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SpecularScatter {
        /// Half the side of the quad, whatever the distance: how wide the glow is. Cost grows with its square.
        size: f32 = 160.0, number(1.0..=8192.0, "pixels");
        /// Multiplies the glow. 0 draws no quads.
        intensity: f32 = 1.0, number(0.0..=100.0, "");
    }
}
