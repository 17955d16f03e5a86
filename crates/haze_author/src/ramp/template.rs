//! Templates for new ramps.

use haze_core::assets::ramp::RampRole;

use super::ramp_recipe::{Curve, HexColor, RampRecipe, RampRow, RampStop};

/// A position, 0 to 1, and an sRGB color, `0xrrggbb`.
type Stop = (f32, u32);

/// A template for a new ramp.
#[derive(Clone, Copy, Debug)]
pub struct Template {
    /// Name.
    pub name: &'static str,
    /// One-line description for users.
    pub description: &'static str,
    /// Role.
    pub role: RampRole,
    curve: Curve,
    stops: &'static [Stop],
    /// The recipe's `times` gradient and `place` formula; both empty for a ramp of one axis.
    times: &'static [Stop],
    place: &'static str,
}

/// Creates a template for a ramp of one axis.
const fn one_axis(
    role: RampRole,
    name: &'static str,
    description: &'static str,
    curve: Curve,
    stops: &'static [Stop],
) -> Template {
    Template { name, description, role, curve, stops, times: &[], place: "" }
}

/// All templates.
pub const TEMPLATES: &[Template] = &[
    one_axis(
        RampRole::Diffuse,
        "neutral",
        "gray, even to the eye",
        Curve::Monotone,
        &[(0.0, 0x1a1a1a), (0.5, 0x7a7a7a), (1.0, 0xffffff)],
    ),
    one_axis(
        RampRole::Diffuse,
        "soft_toon",
        "three tones with soft borders",
        Curve::Ease,
        &[(0.0, 0x2b2a3a), (0.40, 0x2b2a3a), (0.46, 0x8a8490), (0.68, 0x8a8490), (0.74, 0xf6efe2), (1.0, 0xf6efe2)],
    ),
    one_axis(
        RampRole::Diffuse,
        "hard_toon",
        "three tones with hard borders",
        Curve::Constant,
        &[(0.0, 0x2b2a3a), (0.45, 0x8a8490), (0.72, 0xf6efe2)],
    ),
    one_axis(
        RampRole::Diffuse,
        "ink",
        "a dark line between light and shade",
        Curve::Constant,
        &[(0.0, 0x5c6f86), (0.40, 0x0b0b0e), (0.47, 0xc8d4dc), (0.78, 0xfbf8ee)],
    ),
    one_axis(
        RampRole::Diffuse,
        "ash",
        "warm grays, never bright",
        Curve::Monotone,
        &[(0.0, 0x1d1a18), (0.35, 0x474240), (0.7, 0x8d8680), (1.0, 0xcfc7bd)],
    ),
    one_axis(
        RampRole::Diffuse,
        "steam",
        "white, with thin shade",
        Curve::Monotone,
        &[(0.0, 0x5f6c7a), (0.45, 0xa4afba), (0.75, 0xe4e8eb), (1.0, 0xffffff)],
    ),
    one_axis(
        RampRole::Diffuse,
        "soot",
        "black smoke of oil",
        Curve::Monotone,
        &[(0.0, 0x060505), (0.5, 0x1c1917), (0.8, 0x3c3632), (1.0, 0x6a615a)],
    ),
    one_axis(
        RampRole::Diffuse,
        "sand",
        "dust of a desert",
        Curve::Monotone,
        &[(0.0, 0x4a3524), (0.4, 0x8d6a47), (0.7, 0xcfa878), (1.0, 0xf6e3bb)],
    ),
    one_axis(
        RampRole::Diffuse,
        "sunset_backlight",
        "violet shade, burning edges",
        Curve::Monotone,
        &[(0.0, 0x241a33), (0.3, 0x4b2b4a), (0.5, 0xb0502f), (0.72, 0xff9a4c), (1.0, 0xffe3b0)],
    ),
    one_axis(
        RampRole::Diffuse,
        "night_lamp",
        "a street lamp on dark smoke",
        Curve::Monotone,
        &[(0.0, 0x05060c), (0.4, 0x141722), (0.65, 0x5a4126), (0.85, 0xd69a4a), (1.0, 0xffe6b0)],
    ),
    one_axis(
        RampRole::Diffuse,
        "moon",
        "cold light, deep shade",
        Curve::Monotone,
        &[(0.0, 0x05070d), (0.4, 0x1a2333), (0.7, 0x5f7590), (1.0, 0xdfe9f5)],
    ),
    Template {
        name: "burning_rim",
        description: "thin edges burn against the light, the middle stays dark",
        role: RampRole::Backlight,
        curve: Curve::Monotone,
        stops: &[(0.0, 0xc8b09a), (0.4, 0xfff4e2), (0.7, 0xe0c4a4), (1.0, 0x8a7a70)],
        times: &[(0.0, 0xffffff), (0.3, 0xd09a68), (0.65, 0x4a3228), (1.0, 0x14100f)],
        place: "",
    },
    one_axis(
        RampRole::Shadow,
        "golden_shadow",
        "light turns gold, then brown",
        Curve::Monotone,
        &[(0.0, 0xffffff), (0.3, 0xf2cf96), (0.6, 0xb87b3e), (0.85, 0x5c3018), (1.0, 0x1c0d08)],
    ),
    one_axis(
        RampRole::Shadow,
        "cold_shadow",
        "light turns blue, then black",
        Curve::Monotone,
        &[(0.0, 0xffffff), (0.3, 0xb9cbe2), (0.6, 0x6480a6), (0.85, 0x26395c), (1.0, 0x070b16)],
    ),
    one_axis(
        RampRole::Shadow,
        "toon_shadow",
        "light and shade, with a hard border",
        Curve::Constant,
        &[(0.0, 0xffffff), (0.5, 0x777a86), (0.8, 0x3a3d4c), (1.0, 0x3a3d4c)],
    ),
    one_axis(
        RampRole::Scatter,
        "fog",
        "light where thin, blue where thick",
        Curve::Monotone,
        &[(0.0, 0xb4c1cf), (0.5, 0x7d8b9c), (1.0, 0x4a5563)],
    ),
    one_axis(
        RampRole::Coverage,
        "wispy",
        "thinner edges",
        Curve::Monotone,
        &[(0.0, 0x000000), (0.08, 0x050505), (0.24, 0x2a2a2a), (0.5, 0x8c8c8c), (0.78, 0xe6e6e6), (1.0, 0xffffff)],
    ),
    one_axis(
        RampRole::Coverage,
        "cut",
        "cut out, as from paper",
        Curve::Ease,
        &[(0.0, 0x000000), (0.34, 0x000000), (0.4, 0xffffff), (1.0, 0xffffff)],
    ),
    one_axis(
        RampRole::Age,
        "embers",
        "born as fire, gray when old",
        Curve::Monotone,
        &[(0.0, 0xfff2c8), (0.1, 0xf09a3c), (0.3, 0x7a3018), (0.6, 0x4a4340), (1.0, 0x8a8580)],
    ),
    one_axis(
        RampRole::Heat,
        "cooling",
        "hot at birth, cold at half the life",
        Curve::Monotone,
        &[(0.0, 0xffffff), (0.2, 0xb0b0b0), (0.4, 0x404040), (0.55, 0x000000), (1.0, 0x000000)],
    ),
    one_axis(
        RampRole::Fire,
        "flame",
        "from dark red to pale yellow",
        Curve::Monotone,
        &[(0.0, 0x000000), (0.15, 0x160200), (0.4, 0x6e1800), (0.65, 0xd85a06), (0.85, 0xffae38), (1.0, 0xffe3a0)],
    ),
    one_axis(
        RampRole::Fire,
        "spell",
        "from dark green to white",
        Curve::Monotone,
        &[(0.0, 0x000000), (0.25, 0x01200f), (0.55, 0x068a3c), (0.8, 0x5cf07a), (1.0, 0xeaffd8)],
    ),
    Template {
        name: "neutral_glow",
        description: "a white glow, strongest in smoke of middle thickness",
        role: RampRole::Specular,
        curve: Curve::Monotone,
        stops: &[(0.0, 0xffffff), (0.04, 0xb0b0b0), (0.16, 0x5c5c5c), (0.45, 0x1c1c1c), (1.0, 0x000000)],
        times: &[(0.0, 0x000000), (0.5, 0xffffff), (1.0, 0x606060)],
        place: "",
    },
    Template {
        name: "wide_glow",
        description: "a warm glow that widens where the smoke is thick",
        role: RampRole::Specular,
        curve: Curve::Monotone,
        stops: &[(0.0, 0xfff0d2), (0.05, 0xd8a468), (0.2, 0x7a5030), (0.5, 0x241609), (1.0, 0x000000)],
        times: &[(0.0, 0x000000), (0.4, 0xffffff), (1.0, 0x6e5a48)],
        place: "u / (0.3 + 0.7 * v)",
    },
];

impl Template {
    /// Finds a template by name.
    pub fn find(name: &str) -> Option<&'static Self> {
        TEMPLATES.iter().find(|template| template.name == name)
    }

    /// Returns the template's recipe.
    pub fn recipe(&self) -> RampRecipe {
        let stops = |stops: &[Stop], curve| {
            let stop = |&(at, color): &Stop| {
                let [_, r, g, b] = color.to_be_bytes();
                RampStop { curve, ..RampStop::new(at, HexColor([r, g, b])) }
            };
            stops.iter().map(stop).collect()
        };
        let (width, height) = if self.times.is_empty() { (256, 1) } else { (128, 64) };
        RampRecipe {
            width,
            height,
            place: self.place.into(),
            times: stops(self.times, Curve::default()),
            rows: vec![RampRow { stops: stops(self.stops, self.curve), ..RampRow::default() }],
            ..RampRecipe::default()
        }
    }
}
