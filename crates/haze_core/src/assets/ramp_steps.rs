//! Steps of a material's ramps, by which `lighting_resolution` `auto` decides: light per texel would blur hard ones.

use glam::{Vec2, Vec3, vec2};

use crate::formula::ramp::sample_ramp_2d;
use crate::formula::texture::Texture2d;
use crate::settings::{Backlight, DiffuseMode, RampFilter, Settings, SoftScatterMode};

/// Positions across a ramp that are compared, and rows of it.
const POSITIONS: u32 = 129;
const ROWS: u32 = 9;

/// Largest change of each ramp over a 64th of its width, of the ramp's brightest color, linear light: 1/64 for an even
/// gradient, 1 for a hard step from black. Of the built-in ramps, those for toon shading are at 0.27 to 0.41, the others
/// below 0.11.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RampSteps {
    /// Of the diffuse ramp.
    pub diffuse: f32,
    /// Of the ramp for light from behind.
    pub backlight: f32,
    /// Of the soft scatter ramp.
    pub soft_scatter: f32,
    /// Of the shadow ramp.
    pub shadow: f32,
    /// Of the painted motif.
    pub motif: f32,
    /// Of the heat ramp.
    pub fire: f32,
}

impl RampSteps {
    /// Hard steps in every ramp.
    pub const HARD: Self = Self { diffuse: 1.0, backlight: 1.0, soft_scatter: 1.0, shadow: 1.0, motif: 1.0, fire: 1.0 };

    /// Returns the largest step of the ramps that light smoke with these settings. Coverage and the glow of lights are
    /// looked up once per pixel at every lighting resolution.
    pub fn largest(&self, settings: &Settings) -> f32 {
        let by_normal = !settings.is_six_way();
        let lit =
            by_normal && matches!(settings.diffuse.mode, DiffuseMode::Ramp | DiffuseMode::Cubemap | DiffuseMode::Motif);
        let used = [
            (self.diffuse, lit),
            (self.backlight, lit && settings.diffuse.backlight == Backlight::Ramp),
            (self.motif, by_normal && settings.diffuse.mode == DiffuseMode::PaintedMotif),
            (self.soft_scatter, settings.soft_scatter.mode == SoftScatterMode::Ramp),
            (self.shadow, settings.shadow.strength > 0.0),
            (self.fire, settings.burns()),
        ];
        let steps = used.into_iter().filter(|(_, is_used)| *is_used).map(|(step, _)| step);
        match settings.ramp_filter {
            RampFilter::Bilinear => steps.fold(0.0, f32::max),
            // Every texel of a ramp is a step.
            RampFilter::Nearest => steps.fold(0.0, |_, _| 1.0),
        }
    }
}

/// Returns the largest step of a ramp, across it or up.
pub fn largest_step(ramp: &impl Texture2d) -> f32 {
    let place = |index: u32, count: u32| index as f32 / (count - 1) as f32;
    let color = |at: Vec2| sample_ramp_2d(ramp, RampFilter::Bilinear, at);
    let mut brightest = 0.0_f32;
    let mut largest = 0.0_f32;
    for row in 0..ROWS {
        for turned in [false, true] {
            let at = |position| {
                let along = place(position, POSITIONS);
                let across = place(row, ROWS);
                color(if turned { vec2(across, along) } else { vec2(along, across) })
            };
            let colors: [Vec3; POSITIONS as usize] = std::array::from_fn(|position| at(position as u32));
            brightest = colors.iter().fold(brightest, |most, color| most.max(color.max_element()));
            // Over two positions, so that a step is whole wherever it is.
            let changes = colors.windows(3).map(|window| (window[2] - window[0]).abs().max_element());
            largest = changes.fold(largest, f32::max);
        }
    }
    largest / brightest.max(1.0e-6)
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::assets::ramp::Ramp;

    fn gradient(color: impl Fn(f32) -> f32) -> Ramp {
        Ramp::from_linear(UVec2::new(256, 1), (0..256).map(|x| Vec3::splat(color(x as f32 / 255.0))))
    }

    #[test]
    fn steps_of_gradients_are_small_and_of_edges_whole() {
        let even = largest_step(&gradient(|x| x));
        assert!((even - 1.0 / 64.0).abs() < 1e-3, "{even}");
        let bright = largest_step(&gradient(|x| 9.0 * x));
        assert!((bright - even).abs() < 1e-4, "{bright}");
        assert!(largest_step(&gradient(|x| if x < 0.5 { 0.0 } else { 1.0 })) > 0.99);
        assert!(largest_step(&gradient(|_| 0.0)) <= 0.0);
    }

    #[test]
    fn only_ramps_in_use_count() {
        let diffuse = RampSteps { diffuse: 0.5, ..RampSteps::default() };
        let mut settings = Settings::default();
        let is = |settings: &Settings, step: f32| (diffuse.largest(settings) - step).abs() < 1e-6;
        assert!(is(&settings, 0.5));
        settings.diffuse.mode = DiffuseMode::PaintedMotif;
        assert!(is(&settings, 0.0));
        settings.ramp_filter = RampFilter::Nearest;
        assert!(is(&settings, 1.0));
        settings.diffuse.mode = DiffuseMode::SphericalHarmonics;
        assert!(is(&settings, 0.0));
    }

    #[test]
    fn only_toon_ramps_of_the_built_in_ones_have_hard_steps() {
        // Coverage and the glow of lights are looked up once per pixel.
        let is_lit_per_texel =
            |name: &str| !["coverage", "specular", "motif"].iter().any(|role| name.starts_with(role));
        let mut toons = 0;
        for entry in std::fs::read_dir("../../ramps").unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            if path.extension().is_none_or(|extension| extension != "png") || !is_lit_per_texel(name) {
                continue;
            }
            let step = largest_step(&Ramp::load(&path).unwrap());
            let is_toon = ["diffuse_soft_toon", "diffuse_ink", "shadow_toon"].contains(&name);
            assert!(if is_toon { step > 0.25 } else { step < 0.11 }, "{name}: {step}");
            toons += u32::from(is_toon);
        }
        assert_eq!(toons, 3);
    }
}
