//! Light of sun, moon and sky by the height of the sun: an analytic model, and its use on a preset's settings.
//!
//! - Illuminance of the ground, by day, in twilight and under a full moon: polynomials of Seidelmann (ed.), "Explanatory
//!   Supplement to the Astronomical Almanac", 1992, table 9.1.
//! - Illuminance of the ground by a clear sky: IES Calculation Procedures Committee, "Recommended practice for the calculation of
//!   daylight availability", 1984.
//! - Sunlight that the air lets through: Beer–Lambert over the air mass of Kasten and Young, "Revised optical air mass tables and
//!   approximation formula", 1989.
//! - Color of the sky: sunlight scattered once in even air (Chandrasekhar, "Radiative Transfer", 1960), dimmed by ozone, which
//!   keeps the zenith blue in twilight (Hulburt, "Explanation of the Brightness and Color of the Sky, Particularly the Twilight
//!   Sky", 1953).
//! - Adaptation of the eye: key of an automatic exposure by Krawczyk, Myszkowski and Seidel, "Perceptual Effects in Real-time
//!   Tone Mapping", 2005. A night is dark in the image, but not a million times darker than the day.
//! - Blue moonlight, as the eye sees it: Jensen et al., "Night Rendering", 2000.

use std::f32::consts::PI;

use glam::Vec3;
use haze_core::formula::color::luminance;
use haze_core::formula::lighting::sample_light;
use haze_core::frame::{Light, LightKind, LightRole};
use haze_preset::Preset;

use crate::color_temperature::color_of_temperature;
use crate::light_angles::{Angles, from_angles, to_angles};

/// Source of daylight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// The sun, by day and in twilight.
    Sun,
    /// A full moon.
    Moon,
}

/// Elevations above the horizon, degrees. Below -12, nothing of the twilight is visible.
pub const SUN_ELEVATION: std::ops::RangeInclusive<f32> = -12.0..=90.0;

/// Named time, with its source of light and the elevation of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeOfDay {
    /// Name for people.
    pub name: &'static str,
    /// Source of light.
    pub body: Body,
    /// Height above the horizon, degrees.
    pub elevation: f32,
}

const fn time(name: &'static str, body: Body, elevation: f32) -> TimeOfDay {
    TimeOfDay { name, body, elevation }
}

/// Times from dawn to night.
pub const TIMES_OF_DAY: [TimeOfDay; 6] = [
    time("dawn", Body::Sun, -3.0),
    time("morning", Body::Sun, 18.0),
    time("noon", Body::Sun, 60.0),
    time("sunset", Body::Sun, 3.0),
    time("dusk", Body::Sun, -5.0),
    time("moonlit", Body::Moon, 35.0),
];

/// Light of sun or moon, and of the sky, in the unit of [`Light::intensity`] of a directional light: radiance of a white matte
/// surface. At noon the sun has about 2.5, to fit the exposures of the built-in presets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Daylight {
    /// Linear RGB of sun or moon, brightest channel 1.
    pub color: Vec3,
    /// Multiplies `color`.
    pub intensity: f32,
    /// Linear RGB of the sky overhead.
    pub zenith: Vec3,
    /// Linear RGB of the sky at the horizon.
    pub horizon: Vec3,
    /// Linear RGB that a white surface has under the whole sky.
    pub sky: Vec3,
    /// Linear RGB that a white surface has under the light that the ground reflects.
    pub ground: Vec3,
}

/// Optical depths of the air from the ground upwards, for red, green and blue. Molecules and ozone: Hillaire, "A Scalable and
/// Production Ready Sky and Atmosphere Rendering Technique", 2020, table 1, times 8 km and 15 km.
const MOLECULES: Vec3 = Vec3::new(0.0464, 0.1085, 0.2648);
const OZONE: Vec3 = Vec3::new(0.009_75, 0.0282, 0.0013);
/// Haze of country air: 0.1 at 550 nm, by wavelength to the power of -1.3. (Ångström, 1929)
const HAZE: Vec3 = Vec3::new(0.076, 0.1, 0.134);

/// Temperature of the sun above the air, kelvin.
const SUN_KELVIN: f32 = 5778.0;
/// Illuminance of the sun above the air, lux.
const SUN_LUX: f32 = 133_300.0;
/// Illuminance by a clear sky, lux: the first number plus the second times the root of the sine of the sun's elevation. What the
/// table leaves beside direct sunlight is far too little for a sun at 15° to 45°: the ground would be brighter than the sky.
const CLEAR_SKY_LUX: [f32; 2] = [800.0, 15_500.0];
/// Color of moonlight in the image.
const MOON_COLOR: Vec3 = Vec3::new(0.45, 0.62, 1.0);
/// Color of the sky by moonlight, overhead and at the horizon.
const MOON_SKY: [Vec3; 2] = [Vec3::new(0.2, 0.38, 1.0), Vec3::new(0.42, 0.55, 1.0)];
/// Illuminance of the stars and of the air's own glow, lux.
const STARS_LUX: f32 = 0.002;
/// Fraction of the sky's light that comes from around the low sun, and counts as the sun's. Tuned by eye on the preset
/// `column`.
const GLOW: f32 = 0.35;
/// Fraction of the light that the ground reflects: between asphalt and dry grass, slightly warm.
const GROUND: Vec3 = Vec3::new(0.14, 0.13, 0.11);
/// Sun's intensity in the image at noon. It fits the exposures of the built-in presets, 0.3 to 0.8.
const NOON: f32 = 2.5;
/// Brightness of fill lights, as a fraction of the sky's. Tuned by eye on the preset `column`.
const FILL: f32 = 0.25;
/// Air masses of a view a little above the horizon, 7°.
const HORIZON_MASS: f32 = 8.0;
/// Fraction of skylight that was scattered more than once, by day. With it the noon sky has the colors of the preset
/// `steam_vent`.
const SCATTERED_AGAIN: f32 = 0.2;

/// Polynomials of log10(lux) over elevation ÷ 90, each with the elevation from which on it holds.
const SUN_CURVE: [(f32, [f32; 4]); 6] = [
    (20.0, [3.74, 3.97, -4.07, 1.47]),
    (5.0, [3.05, 13.28, -45.98, 64.33]),
    (-0.8, [2.88, 22.26, -207.64, 1034.3]),
    (-5.0, [2.88, 21.81, -258.11, -858.36]),
    (-12.0, [2.7, 12.17, -431.69, -1899.83]),
    (-18.0, [13.84, 262.72, 1447.42, 2797.93]),
];
const MOON_CURVE: [(f32, [f32; 4]); 3] = [
    (20.0, [-1.95, 4.06, -4.24, 1.56]),
    (5.0, [-2.58, 12.58, -42.58, 59.06]),
    (-0.8, [-2.79, 24.27, -252.95, 1321.29]),
];

/// Returns the illuminance of level ground, lux.
fn illuminance(curve: &[(f32, [f32; 4])], elevation: f32) -> f32 {
    let last = curve.last().map_or((0.0, [0.0; 4]), |&last| last);
    let (least, [a, b, c, d]) = curve.iter().copied().find(|(from, _)| elevation >= *from).unwrap_or(last);
    let x = elevation.max(least) / 90.0;
    10.0_f32.powf(a + x * (b + x * (c + x * d)))
}

/// Returns the air that sunlight crosses, as a multiple of that overhead: 1 at the zenith, 38 at the horizon and below.
fn air_mass(elevation: f32) -> f32 {
    let elevation = elevation.clamp(0.0, 90.0);
    1.0 / (elevation.to_radians().sin() + 0.505_72 * (elevation + 6.079_95).powf(-1.6364))
}

/// Returns the fraction of light that a number of air masses lets through.
fn transmission(mass: f32) -> Vec3 {
    (-(MOLECULES + OZONE + HAZE) * mass).exp()
}

/// Returns the air mass behind the colors of a low sun: at most 12. The light around the disc has crossed less air than the disc's
/// own, so the red of the last light is not pure.
fn color_mass(mass: f32) -> f32 {
    mass / (1.0 + mass / 18.0)
}

/// Returns the color of the sky along `view` air masses, with the sun behind `sun` of them. `more`: fraction of light that was
/// scattered more than once, with the blue of molecules.
fn sky_color(view: f32, sun: f32, more: f32) -> Vec3 {
    let depth = MOLECULES + HAZE;
    let difference = sun - view;
    // At equal air masses, the limit.
    let once = if difference.abs() < 1.0e-3 {
        depth * view * (-depth * view).exp()
    } else {
        ((-depth * view).exp() - (-depth * sun).exp()) * (view / difference)
    };
    let once = once * (-OZONE * sun).exp() * color_of_temperature(SUN_KELVIN);
    once + hue(MOLECULES) * (more * luminance(once))
}

/// Returns a color with luminance 1.
fn hue(color: Vec3) -> Vec3 {
    color / luminance(color).max(f32::MIN_POSITIVE)
}

/// Light as a meter shows it, and its colors.
struct Measured {
    /// Light of sun or moon on a surface that faces it, and of the sky on level ground, lux.
    direct: f32,
    sky: f32,
    color: Vec3,
    zenith: Vec3,
    horizon: Vec3,
}

fn measured(body: Body, elevation: f32) -> Measured {
    let sine = elevation.to_radians().sin().max(0.0);
    match body {
        Body::Sun => {
            let all = illuminance(&SUN_CURVE, elevation);
            let mass = air_mass(elevation);
            let sun = color_of_temperature(SUN_KELVIN);
            // The last of the disc sets at -0.8°. Haze and hills take its light from 3° on.
            let risen = ((elevation + 0.8) / 3.8).clamp(0.0, 1.0);
            let direct = SUN_LUX * luminance(transmission(mass) * hue(sun)) * risen * risen;
            // Near the horizon and below, the sky gives nearly all light.
            let sky = (CLEAR_SKY_LUX[0] + CLEAR_SKY_LUX[1] * sine.sqrt()).min(all);
            // Weakly from 10° down: the sky is brightest around a low sun.
            let low = ((10.0 - elevation) / 10.0).clamp(0.0, 1.0);
            let direct = direct + GLOW * low * low * sky;
            let mass = color_mass(mass);
            // In twilight, the sun reaches only the thin air high above, and the sky turns blue.
            let more = SCATTERED_AGAIN + 0.5 * (-elevation / 8.0).clamp(0.0, 1.0);
            let zenith = sky_color(1.0, mass, more);
            let horizon = sky_color(HORIZON_MASS, mass, more);
            Measured { direct, sky, color: transmission(mass) * sun, zenith, horizon }
        }
        Body::Moon => {
            let all = illuminance(&MOON_CURVE, elevation.max(0.0));
            let sky = 0.15 * all + STARS_LUX;
            let [zenith, horizon] = MOON_SKY;
            Measured { direct: 0.85 * all / sine.max(0.1), sky, color: MOON_COLOR, zenith, horizon }
        }
    }
}

/// Returns the brightness in the image of one lux, for eyes that are used to this light.
fn adaptation(light: &Measured) -> f32 {
    // The image is half sky and half ground, which reflects 18 % and on average receives half of the direct light.
    let seen = (0.5 * light.sky + 0.5 * 0.18 * (light.sky + 0.5 * light.direct)) / PI;
    let key = 1.03 - 2.0 / (2.0 + (seen + 1.0).log10());
    key / seen.max(f32::MIN_POSITIVE)
}

impl Daylight {
    /// Returns the light under the sun, or under a full moon, at an elevation in degrees: -90 to 90.
    pub fn new(body: Body, elevation: f32) -> Self {
        let noon = measured(Body::Sun, 60.0);
        let unit = NOON / (noon.direct * adaptation(&noon));
        let light = measured(body, elevation);
        let of_lux = unit * adaptation(&light);
        let direct = light.direct * of_lux;
        let sky = light.sky * of_lux;
        let color = light.color / light.color.max_element();
        let on_ground = direct * elevation.to_radians().sin().max(0.0) * hue(color);
        // Luminance of the colors together is that of the sky: they are its halves.
        let [zenith, horizon] = [light.zenith, light.horizon];
        let both = luminance(0.5 * (zenith + horizon)).max(f32::MIN_POSITIVE);
        let [zenith, horizon] = [zenith, horizon].map(|color| color * (sky / both));
        let mean = 0.5 * (zenith + horizon);
        // `intensity` multiplies a color whose brightest channel is 1.
        let intensity = direct / luminance(color).max(f32::MIN_POSITIVE);
        Self { color, intensity, zenith, horizon, sky: mean, ground: GROUND * (on_ground + mean) }
    }
}

/// Returns the index of the light that is a preset's sun or moon: its key light if that is directional, or else, in a preset
/// without a key light, the first directional light without a role.
pub fn sun_of(lights: &[Light]) -> Option<usize> {
    let role = if lights.iter().any(|light| light.role == LightRole::Key) { LightRole::Key } else { LightRole::None };
    lights.iter().position(|light| light.kind == LightKind::Directional && light.role == role)
}

/// Returns the body that a light stands for: bluish light is that of the moon.
pub fn body_of(light: &Light) -> Body {
    if light.color.z > light.color.x { Body::Moon } else { Body::Sun }
}

/// Returns the light that reaches a position in free air: a white matte surface there that faces the light has this radiance.
pub fn irradiance(light: &Light, position: Vec3) -> Vec3 {
    let light = light.uniform(&glam::Mat4::IDENTITY);
    light.color * sample_light(&light, position).attenuation
}

/// Ratio of a sun's brightness to that of the model, within which it counts as the preset's choice. Beyond, such as for a sun of
/// intensity 0, the model's brightness is taken.
const SCALES: std::ops::RangeInclusive<f32> = 1.0e-4..=1.0e7;

/// Moves a preset's sun or moon, and gives it, the sky, the ambient light of all systems and the fill lights their colors and
/// brightness at that time. If the sun is brighter than the model's, all are brighter by the same factor. `index`: the sun.
/// `position`: center of the smoke, where fill lights are measured. The intensity of ambient light stays, and so do all other
/// lights.
pub fn set_time(preset: &mut Preset, index: usize, body: Body, angles: Angles, position: Vec3) {
    let Some(sun) = preset.lights.get_mut(index) else { return };
    let before = Daylight::new(body_of(sun), to_angles(sun.direction).elevation);
    let brightness = |color: Vec3, intensity: f32| luminance(color) * intensity;
    let scale = brightness(sun.color, sun.intensity) / brightness(before.color, before.intensity);
    let scale = if SCALES.contains(&scale) { scale } else { 1.0 };
    let light = Daylight::new(body, angles.elevation);
    sun.direction = from_angles(angles);
    sun.color = light.color;
    sun.intensity = scale * light.intensity;
    let most = Vec3::splat(MAX_COLOR);
    let [zenith, horizon, sky, ground] =
        [light.zenith, light.horizon, light.sky, light.ground].map(|color| (color * scale).min(most));
    let environment = &mut preset.environment;
    environment.zenith = zenith;
    environment.horizon = horizon;
    environment.ground = ground;
    for system in &mut preset.systems {
        let ambient = &mut system.settings.ambient;
        ambient.sky_color = sky;
        ambient.ground_color = ground;
    }
    for fill in preset.lights.iter_mut().filter(|light| light.role == LightRole::Fill) {
        fill.color = sky / sky.max_element().max(f32::MIN_POSITIVE);
        set_brightness(fill, position, FILL * scale * luminance(light.sky));
    }
}

/// Largest channel of the colors of sky and ground.
const MAX_COLOR: f32 = 100.0;

/// Largest intensity of a light.
const MAX_INTENSITY: f32 = 1.0e9;

/// Gives a light the intensity with which its [`irradiance`] at a position has a luminance. A light that does not reach the
/// position stays as it is.
pub fn set_brightness(light: &mut Light, position: Vec3, wanted: f32) {
    let one = luminance(irradiance(&Light { intensity: 1.0, ..*light }, position));
    let intensity = wanted / one;
    if intensity.is_finite() {
        light.intensity = intensity.clamp(0.0, MAX_INTENSITY);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELEVATIONS: std::ops::RangeInclusive<i32> = -900..=900;

    fn sun(tenths: i32) -> Daylight {
        Daylight::new(Body::Sun, tenths as f32 * 0.1)
    }

    #[test]
    fn light_is_finite_and_positive_at_every_elevation() {
        for tenths in ELEVATIONS {
            for body in [Body::Sun, Body::Moon] {
                let light = Daylight::new(body, tenths as f32 * 0.1);
                let Daylight { color, intensity, zenith, horizon, sky, ground } = light;
                for color in [color, zenith, horizon, sky, ground] {
                    assert!(color.is_finite() && color.min_element() >= 0.0, "{body:?} {tenths}: {light:?}");
                }
                assert!(intensity > 0.0 && intensity < 100.0, "{body:?} {tenths}: {light:?}");
                assert!((color.max_element() - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_lower_sun_is_redder() {
        let mut last = sun(-900).color;
        for tenths in ELEVATIONS {
            let color = sun(tenths).color;
            assert!(color.y >= last.y && color.z >= last.z, "{tenths}: {color} after {last}");
            last = color;
        }
        let low = sun(0).color;
        assert!(low.y < 0.4 && low.z < 0.1, "{low}");
        let noon = sun(600).color;
        assert!(noon.z > 0.6, "{noon}");
    }

    #[test]
    fn the_sky_gets_darker_with_the_sun_and_is_blue_by_day_and_warm_at_the_horizon_in_the_evening() {
        let mut last = 0.0;
        for tenths in -120..=0 {
            let sky = luminance(sun(tenths).sky);
            assert!(sky >= last, "{tenths}: {sky} after {last}");
            last = sky;
        }
        let day = sun(450);
        assert!(day.zenith.z > 2.0 * day.zenith.x && day.horizon.z < 2.0 * day.horizon.x, "{day:?}");
        let evening = sun(20);
        assert!(evening.horizon.x > 1.5 * evening.horizon.z, "{evening:?}");
        assert!(evening.zenith.z > evening.zenith.y, "{evening:?}");
    }

    #[test]
    fn brightness_has_no_steps() {
        for tenths in -119..=890 {
            let a = sun(tenths);
            let b = sun(tenths + 1);
            for [a, b] in [[a.intensity, b.intensity], [luminance(a.sky), luminance(b.sky)]] {
                // A rising sun doubles its light in a degree.
                assert!((a / b - 1.0).abs() < 0.11, "{tenths}: {a} {b}");
            }
        }
    }

    /// Values of the tables that the model is made of, and of meters.
    #[test]
    fn illuminance_and_air_mass_are_those_of_tables() {
        // Kasten and Young, table II.
        for (elevation, mass) in [(90.0, 1.0), (30.0, 1.994), (10.0, 5.586), (0.0, 37.92)] {
            assert!((air_mass(elevation) / mass - 1.0).abs() < 0.002, "{elevation}: {}", air_mass(elevation));
        }
        // Neighbouring polynomials meet where one ends.
        for curve in [&SUN_CURVE[..], &MOON_CURVE[..]] {
            for [(from, _), _] in curve.array_windows() {
                let [below, at] = [from - 1e-3, *from].map(|elevation| illuminance(curve, elevation));
                assert!((below / at - 1.0).abs() < 0.03, "{from}: {below} {at}");
            }
        }
        let lux = |elevation| illuminance(&SUN_CURVE, elevation);
        assert!((100_000.0..140_000.0).contains(&lux(90.0)) && (300.0..1000.0).contains(&lux(0.0)));
        // End of civil twilight.
        assert!((2.0..6.0).contains(&lux(-6.0)), "{}", lux(-6.0));
        assert!((0.2..0.35).contains(&illuminance(&MOON_CURVE, 90.0)));
        // Direct sunlight on a clear day.
        let direct = SUN_LUX * luminance(transmission(1.0));
        assert!((90_000.0..115_000.0).contains(&direct), "{direct}");
    }

    #[test]
    fn moonlight_is_dim_and_blue_but_not_black() {
        let moon = Daylight::new(Body::Moon, 35.0);
        let noon = sun(600);
        let ratio = moon.intensity * luminance(moon.color) / (noon.intensity * luminance(noon.color));
        assert!((0.01..0.15).contains(&ratio), "{ratio}");
        assert!(moon.color.z > moon.color.x && luminance(moon.sky) < 0.1 * luminance(noon.sky), "{moon:?}");
    }

    #[test]
    fn the_sky_is_brighter_than_the_ground() {
        for tenths in ELEVATIONS {
            let light = sun(tenths);
            let [sky, ground] = [light.sky, light.ground].map(luminance);
            assert!(sky > ground, "{tenths}: {sky} {ground}");
        }
        // The sky of a day is a color and not a dark gray.
        for tenths in 150..=900 {
            let light = sun(tenths);
            let fraction = luminance(light.sky) / (light.intensity * luminance(light.color));
            assert!((0.1..0.25).contains(&fraction), "{tenths}: {fraction}");
        }
    }

    fn light_of(kind: LightKind, role: LightRole) -> Light {
        Light { kind, role, ..Light::default() }
    }

    #[test]
    fn the_sun_is_the_directional_key_light() {
        use LightKind::{Directional, Point};
        use LightRole::{Fill, Key};
        let sun = |lights: &[(LightKind, LightRole)]| {
            sun_of(&lights.iter().map(|&(kind, role)| light_of(kind, role)).collect::<Vec<_>>())
        };
        assert_eq!(sun(&[(Directional, Fill), (Directional, Key)]), Some(1));
        assert_eq!(sun(&[(Point, Key), (Directional, LightRole::None)]), None);
        assert_eq!(sun(&[(Directional, Fill), (Directional, LightRole::None)]), Some(1));
        assert_eq!(sun(&[(Directional, Fill), (Point, LightRole::None)]), None);
    }

    #[test]
    fn a_time_sets_sun_sky_and_fill_and_leads_back() {
        let mut preset = Preset::load("column").unwrap();
        let position = Vec3::new(0.5, 2.0, 0.0);
        preset.lights[0] = light_of(LightKind::Directional, LightRole::Key);
        preset.lights[2].role = LightRole::Fill;
        let day = Angles { azimuth: 40.0, elevation: 30.0 };
        preset.lights[0].intensity = 0.0;
        set_time(&mut preset, 0, Body::Sun, day, position);
        // The artist's sun is twice as bright.
        preset.lights[0].intensity *= 2.0;
        set_time(&mut preset, 0, Body::Sun, day, position);
        let start = preset.clone();
        assert!((preset.lights[0].intensity / (2.0 * sun(300).intensity) - 1.0).abs() < 1e-3);
        let fill = luminance(irradiance(&preset.lights[1], position));
        let lamp = luminance(irradiance(&preset.lights[2], position));
        assert!((fill / lamp - 1.0).abs() < 1e-3, "fill lights of every kind are equally bright: {fill} {lamp}");
        for (body, elevation) in [(Body::Sun, 2.0), (Body::Sun, -5.0), (Body::Moon, 35.0), (Body::Sun, 70.0)] {
            set_time(&mut preset, 0, body, Angles { elevation, ..day }, position);
            assert_eq!(body_of(&preset.lights[0]), body);
            preset.validate().unwrap();
            assert_ne!(preset.environment, start.environment);
            assert_ne!(preset.systems[0].settings.ambient.sky_color, start.systems[0].settings.ambient.sky_color);
        }
        set_time(&mut preset, 0, Body::Sun, day, position);
        assert!((preset.lights[0].intensity / start.lights[0].intensity - 1.0).abs() < 1e-2);
        assert!(preset.environment.zenith.abs_diff_eq(start.environment.zenith, 1e-2));
        let ambient = |preset: &Preset| preset.systems[0].settings.ambient.intensity.to_bits();
        assert_eq!(ambient(&preset), ambient(&start));
        // A sun without light takes the model's.
        preset.lights[0].intensity = 0.0;
        set_time(&mut preset, 0, Body::Sun, day, position);
        assert!((preset.lights[0].intensity / sun(300).intensity - 1.0).abs() < 1e-3);
    }
}
