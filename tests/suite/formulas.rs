//! Every WGSL function of `shaders/lib` against the reference function of the same name, and against mutants of itself:
//! a wrong shader must fail, or the test says nothing.

use std::sync::OnceLock;

use glam::{IVec2, UVec2, UVec3, Vec2, Vec3, Vec4, vec2, vec3, vec4};
use haze::emitter::EmitterShape;
use haze::formula::texture::Texture2d;
use haze::formula::uniforms::{EmitterUniform, LightUniform};
use haze::formula::{
    blending, colour, depth, diffuse_bake, emitter, gradient_noise, lighting, noise_volume, normal, order, ramp,
    six_way, soft_fade, sprite, technique, tonemap, upsample, view,
};
use haze::noise::{NoiseRecipe, NoiseVolume};
use haze::noise::{pcg3d, unit};
use haze::settings::{
    BlendMode, DepthDownsample, FadeCurve, NormalDecode, NormalEncoding, RampFilter, SpriteAnimation, Upsample,
};
use haze::{ramp::Ramp, shader, sprite::Sprite, sprite::SpriteLayout};

use crate::common::gpu;

/// Most numbers that one case takes or gives.
const WIDTH: usize = 32;

/// One function of `shaders/lib`, as both sides compute it.
struct Formula {
    /// The WGSL function; the reference has the same name.
    name: &'static str,
    /// The file that defines it.
    file: &'static str,
    /// WGSL statements that read inputs `x(i)` and write results with `y(i, value)`.
    wgsl: &'static str,
    /// The same with the reference.
    reference: fn(&[f32]) -> Vec<f32>,
    /// Inputs of every case.
    cases: Vec<Vec<f32>>,
    /// Largest difference, relative to 1 or to the result if that is larger.
    tolerance: f32,
    /// (text in the file, what a mistake would make of it): each must fail.
    mutants: &'static [(&'static str, &'static str)],
}

/// f32 arithmetic in another order, with fused or separate multiply-add: a few units in the last place.
const ARITHMETIC: f32 = 2e-6;
/// As above, through the driver's `pow`, `exp2`, `log2`, `sin` or `inverseSqrt`, which Vulkan lets be that imprecise.
const TRANSCENDENTAL: f32 = 2e-4;

/// `count` cases of numbers in the given ranges, the same every time.
fn random(count: u32, ranges: &[(f32, f32)]) -> Vec<Vec<f32>> {
    let number = |case: u32, index: usize| unit(pcg3d(UVec3::new(case, index as u32, 77)).x);
    let pick = |case| (0..).zip(ranges).map(|(i, &(low, high))| low + (high - low) * number(case, i)).collect();
    (0..count).map(pick).collect()
}

/// A case for every step of every choice with some random numbers after it.
fn with_choices(choices: u32, ranges: &[(f32, f32)]) -> Vec<Vec<f32>> {
    let prefix = |(index, mut case): (u32, Vec<f32>)| {
        case.insert(0, (index % choices) as f32);
        case
    };
    (0..).zip(random(40 * choices, ranges)).map(prefix).collect()
}

/// How many choices a setting has: a new one is tested without being named here.
fn count<T>(choices: &[T]) -> u32 {
    choices.len() as u32
}

/// What is shown under light from six sides, a way to a light, and an anisotropy.
const SIX_WAY_AND_LIGHT: [(f32, f32); 10] = {
    const SHOWN: (f32, f32) = (0.0, 1.0);
    const AXIS: (f32, f32) = (-1.0, 1.0);
    [SHOWN, SHOWN, SHOWN, SHOWN, SHOWN, SHOWN, AXIS, AXIS, AXIS, (0.1, 0.95)]
};

fn unit_vectors(cases: Vec<Vec<f32>>, at: usize) -> Vec<Vec<f32>> {
    let normalise = |mut case: Vec<f32>| {
        let n = vec3(case[at], case[at + 1], case[at + 2]).normalize_or(Vec3::X);
        case[at..at + 3].copy_from_slice(&n.to_array());
        case
    };
    cases.into_iter().map(normalise).collect()
}

fn v2(x: &[f32]) -> Vec2 {
    Vec2::from_slice(x)
}

fn v3(x: &[f32]) -> Vec3 {
    Vec3::from_slice(x)
}

fn v4(x: &[f32]) -> Vec4 {
    Vec4::from_slice(x)
}

fn light(x: &[f32]) -> LightUniform {
    LightUniform {
        position: v3(&x[0..]),
        inverse_range: x[3],
        direction: v3(&x[4..]),
        directional: x[7],
        colour: Vec3::ONE,
        specular_scatter: 1.0,
        spot_scale: x[8],
        spot_offset: x[9],
        radius: x[10],
        padding: 0.0,
    }
}

const WGSL_LIGHT: &str = "let light = Light(vec3f(x(0), x(1), x(2)), x(3), vec3f(x(4), x(5), x(6)), x(7), vec3f(1.0), \
     1.0, x(8), x(9), x(10), 0.0);";

/// An emitter of the shape `x(0)`, eight seconds after its first birth.
fn test_emitter(x: &[f32]) -> EmitterUniform {
    EmitterUniform {
        first: u32::MAX - 100,
        count: 330,
        seed: 3,
        shape: x[0] as u32,
        since_first: 8.0,
        rate: 40.0,
        lifetime: 6.0,
        lifetime_spread: 0.4,
        position: vec3(1.0, 2.0, 3.0),
        burst: 0.7,
        extent: vec3(0.5, 0.25, 0.75),
        velocity_spread: 0.5,
        velocity: vec3(0.1, 0.6, 0.0),
        drag: 0.6,
        rise: vec3(0.0, 0.5, 0.1),
        turbulence: 0.5,
        wind: vec3(0.3, 0.0, -0.2),
        turbulence_scale: 1.5,
        disc_x: vec3(0.6, 0.8, 0.0),
        radius_start: 0.25,
        disc_z: Vec3::Z,
        radius_end: 1.5,
        phase: vec2(0.6, 0.8),
        radius_spread: 0.25,
        spin: 0.5,
        amount: 0.5,
        fade_in: 0.25,
        fade_out: 0.5,
        frame_rate: 4.0,
    }
}

macro_rules! wgsl_emitter {
    ($call:literal) => {
        concat!(
            "let e = Emitter(4294967195u, 330u, 3u, u32(x(0)), 8.0, 40.0, 6.0, 0.4, vec3f(1.0, 2.0, 3.0), 0.7, \
             vec3f(0.5, 0.25, 0.75), 0.5, vec3f(0.1, 0.6, 0.0), 0.6, vec3f(0.0, 0.5, 0.1), 0.5, vec3f(0.3, 0.0, -0.2), \
             1.5, vec3f(0.6, 0.8, 0.0), 0.25, vec3f(0.0, 0.0, 1.0), 1.5, vec2f(0.6, 0.8), 0.25, 0.5, 0.5, 0.25, 0.5, 4.0); ",
            $call
        )
    };
}

const WGSL_BIRTH_OFFSET: &str =
    wgsl_emitter!("let v = birth_offset(e, vec3f(x(1), x(2), x(3))); y(0, v.x); y(1, v.y); y(2, v.z);");

const WGSL_EMITTED: &str = wgsl_emitter!(
    "let p = emitted_particle(e, u32(x(1))); for (var i = 0u; i < 4u; i++) { y(i, p.position_radius[i]); \
     y(4u + i, p.rotation_amount_frame_age[i]); }"
);

/// Four texels of place and value, of weights 1 to 4.
fn fit(x: &[f32]) -> upsample::GuidedFit {
    x[..20].chunks(5).zip([1.0, 2.0, 3.0, 4.0]).fold(upsample::GuidedFit::default(), |fit, (x, weight)| {
        upsample::with_texel(&fit, v3(x), weight, Vec4::splat(x[3]))
    })
}

const WGSL_FIT: &str = "var f: GuidedFit; f.nearest = 1.0e6; f.farthest = -1.0e6; for (var i = 0u; i < 4u; i++) { let o = 5u * i; \
     f = with_texel(f, vec3f(x(o), x(o + 1u), x(o + 2u)), f32(i + 1u), vec4f(x(o + 3u))); } \
     y(0, f.total); y(1, f.nearest); y(2, f.farthest); for (var i = 0u; i < 3u; i++) { y(3u + i, f.place[i]); \
     y(6u + i, f.squares[i]); y(9u + i, f.products[i]); } y(12, f.value.x); y(13, f.x_value.x); y(14, f.y_value.x); \
     y(15, f.z_value.x); y(16, f.low.x); y(17, f.high.x);";

const WGSL_FITTED: &str = "var f: GuidedFit; f.nearest = 1.0e6; f.farthest = -1.0e6; for (var i = 0u; i < 4u; i++) { \
     let o = 5u * i; f = with_texel(f, vec3f(x(o), x(o + 1u), x(o + 2u)), f32(i + 1u), vec4f(x(o + 3u))); } \
     y(0, fitted_value(f, 0.5).x);";

/// A ramp and a flipbook with a different number in every texel.
fn test_ramp() -> Ramp {
    let colour = |i: u32| {
        let hash = pcg3d(UVec3::new(i, 1, 2));
        vec3(unit(hash.x), unit(hash.y), unit(hash.z)) * 2.0
    };
    Ramp::from_linear(UVec2::new(8, 4), (0..32).map(colour))
}

fn test_sprite() -> Sprite {
    let mut sheet = image::RgbaImage::new(24, 8);
    for (x, y, pixel) in sheet.enumerate_pixels_mut() {
        let hash = pcg3d(UVec3::new(x, y, 3));
        let border = x % 8 == 0 || x % 8 == 7 || y == 0 || y == 7;
        let alpha = if border { 0 } else { hash.x as u8 };
        *pixel = image::Rgba([hash.y as u8, hash.z as u8, (hash.y >> 8) as u8, alpha]);
    }
    let layout = SpriteLayout { columns: 3, rows: 1, y_down: false };
    Sprite::from_picture(std::path::Path::new("test"), &sheet, layout).unwrap()
}

/// One frame of a sprite.
struct Frame(Sprite, u32);

impl Texture2d for Frame {
    fn dimensions(&self) -> UVec2 {
        UVec2::splat(self.0.level_size(0))
    }
    fn load(&self, at: UVec2) -> Vec4 {
        self.0.texel(0, self.1, at.x, at.y)
    }
}

fn test_noise() -> &'static NoiseVolume {
    static NOISE: OnceLock<NoiseVolume> = OnceLock::new();
    NOISE.get_or_init(|| {
        let recipe = NoiseRecipe { version: 1, seed: 5, size: 8, cells: 2, octaves: 2, gain: 0.5 };
        NoiseVolume::from_picture(std::path::Path::new("noise"), &recipe.bake().unwrap()).unwrap()
    })
}

#[allow(clippy::too_many_lines)]
fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "view_depth_from_ndc_depth",
            file: "lib/depth.wgsl",
            wgsl: "y(0, view_depth_from_ndc_depth(x(0), vec4f(x(1), x(2), x(3), x(4))));",
            reference: |x| vec![depth::view_depth_from_ndc_depth(x[0], v4(&x[1..]))],
            cases: {
                // Standard, reversed, infinite reversed and orthographic, over the whole buffer.
                let conventions = [
                    vec4(0.1, 0.0, 1.0, -0.999),
                    vec4(0.1, 0.0, 0.001, 0.999),
                    vec4(0.1, 0.0, 0.0, 1.0),
                    vec4(0.5, 59.5, 1.0, 0.0),
                ];
                let depths = (0..=100).map(|i| i as f32 / 100.0);
                let case = |d: f32| conventions.map(|c| vec![d, c.x, c.y, c.z, c.w]);
                depths.flat_map(case).collect()
            },
            tolerance: 1e-5,
            mutants: &[
                ("coefficients.z + coefficients.w", "coefficients.z - coefficients.w"),
                ("coefficients.y * ndc_depth", "0.0"),
            ],
        },
        Formula {
            name: "view_depth_from_linear",
            file: "lib/depth.wgsl",
            wgsl: "y(0, view_depth_from_linear(x(0)));",
            reference: |x| vec![depth::view_depth_from_linear(x[0])],
            cases: random(50, &[(0.0, 2.0e6)]),
            tolerance: 0.0,
            mutants: &[("texel < SKY_VIEW_DEPTH", "true")],
        },
        Formula {
            name: "depth_downsample_keeps_farthest",
            file: "lib/depth.wgsl",
            wgsl: "y(0, select(0.0, 1.0, depth_downsample_keeps_farthest(u32(x(0)), vec2i(i32(x(1)), i32(x(2))))));",
            reference: |x| {
                let texel = IVec2::new(x[1] as i32, x[2] as i32);
                let farthest = depth::depth_downsample_keeps_farthest(DepthDownsample::ALL[x[0] as usize], texel);
                vec![if farthest { 1.0 } else { 0.0 }]
            },
            cases: with_choices(count(DepthDownsample::ALL), &[(0.0, 9.0), (0.0, 9.0)]),
            tolerance: 0.0,
            mutants: &[
                ("(texel.x + texel.y) & 1", "(texel.x) & 1"),
                ("mode == DEPTH_DOWNSAMPLE_MAX", "mode == DEPTH_DOWNSAMPLE_MIN"),
            ],
        },
        Formula {
            name: "fade_linear",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_linear(x(0)));",
            reference: |x| vec![soft_fade::fade_linear(x[0])],
            cases: random(50, &[(0.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("    return x;\n", "    return 1.0 - x;\n")],
        },
        Formula {
            name: "fade_smoothstep",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_smoothstep(x(0)));",
            reference: |x| vec![soft_fade::fade_smoothstep(x[0])],
            cases: random(50, &[(0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("3.0 - 2.0 * x", "2.0 - x")],
        },
        Formula {
            name: "fade_contrast",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_contrast(x(0), x(1)));",
            reference: |x| vec![soft_fade::fade_contrast(x[0], x[1])],
            cases: random(200, &[(0.0, 1.0), (0.1, 16.0)]),
            tolerance: TRANSCENDENTAL,
            // The second: one half of the curve not reflected, as when NV's saturate is left out.
            mutants: &[("0.5 * pow(2.0 * x, contrast_power)", "pow(2.0 * x, contrast_power)"), ("(1.0 - x)", "(x)")],
        },
        Formula {
            name: "fade_exponential",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_exponential(x(0), x(1)));",
            reference: |x| vec![soft_fade::fade_exponential(x[0], x[1])],
            cases: random(200, &[(0.0, 1.0), (0.1, 16.0)]),
            tolerance: TRANSCENDENTAL,
            // The first is how the formula reads when its exponent is lost in print.
            mutants: &[
                ("exp2(-2.0 * pow(2.0 * x, contrast_power))", "pow(0.25 * 2.0 * x, contrast_power)"),
                ("2.0 * x", "x"),
            ],
        },
        Formula {
            name: "fade_always",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, fade_always(x(0), x(1)));",
            reference: |x| vec![soft_fade::fade_always(x[0], x[1])],
            cases: random(100, &[(-2.0, 2.0), (0.2, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("saturate(-distance", "saturate(distance"), ("1.0 - saturate", "saturate")],
        },
        Formula {
            name: "soft_fade",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, soft_fade(u32(x(0)), x(1), x(2), x(3), x(4)));",
            reference: |x| vec![soft_fade::soft_fade(FadeCurve::ALL[x[0] as usize], x[1], x[2], x[3], x[4])],
            cases: with_choices(count(FadeCurve::ALL), &[(-0.5, 2.0), (0.2, 4.0), (0.5, 4.0), (0.0, 0.2)]),
            tolerance: TRANSCENDENTAL,
            // Unsigned differences let sprites fade back in behind the surface.
            mutants: &[
                (
                    "if curve != FADE_CURVE_ALWAYS && distance < max(epsilon, 0.0) {\n        return 0.0;\n    }\n    \
                     let x = saturate(distance *",
                    "let x = saturate(abs(distance) *",
                ),
                ("curve != FADE_CURVE_ALWAYS && distance < max(epsilon, 0.0)", "distance < max(epsilon, 0.0)"),
                ("distance < max(epsilon, 0.0)", "distance < 0.0"),
                ("saturate(distance * fade_scale)", "saturate(distance / fade_scale)"),
                (
                    "case FADE_CURVE_CONTRAST: { return fade_contrast",
                    "case FADE_CURVE_CONTRAST: { return fade_exponential",
                ),
            ],
        },
        Formula {
            name: "near_fade",
            file: "lib/soft_fade.wgsl",
            wgsl: "y(0, near_fade(x(0), x(1), x(1) + x(2)));",
            reference: |x| vec![soft_fade::near_fade(x[0], x[1], x[1] + x[2])],
            cases: random(100, &[(0.0, 3.0), (0.0, 1.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("view_depth - start", "end - view_depth")],
        },
        Formula {
            name: "accumulation_from_normal",
            file: "lib/normal.wgsl",
            wgsl: "let v = accumulation_from_normal(u32(x(0)), vec3f(x(1), x(2), x(3)), x(4), x(5)); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| {
                let encoding = NormalEncoding::ALL[x[0] as usize];
                normal::accumulation_from_normal(encoding, v3(&x[1..]), x[4], x[5]).to_array().to_vec()
            },
            cases: with_choices(
                count(NormalEncoding::ALL),
                &[(-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0), (0.0, 1.0), (0.0, 1.0)],
            ),
            tolerance: ARITHMETIC,
            // Not premultiplied: OTEE's first, wrong blend.
            mutants: &[
                ("(normal * 0.5 + 0.5) * (amount * weight)", "normal * 0.5 + 0.5"),
                ("vec4f(normal * (amount * weight), amount)", "vec4f(normal, amount)"),
                ("vec4f(normal * (amount * weight), amount)", "vec4f(normal * amount, amount) * weight"),
            ],
        },
        Formula {
            name: "normal_from_accumulation",
            file: "lib/normal.wgsl",
            wgsl: "let v = normal_from_accumulation(u32(x(0)) / 2u, u32(x(0)) % 2u, vec3f(x(1), x(2), x(3)), x(4)); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let (encoding, decode) = (NormalEncoding::ALL[x[0] as usize / 2], NormalDecode::ALL[x[0] as usize % 2]);
                normal::normal_from_accumulation(encoding, decode, v3(&x[1..]), x[4]).to_array().to_vec()
            },
            cases: {
                let choices = count(NormalEncoding::ALL) * count(NormalDecode::ALL);
                let mut cases = with_choices(choices, &[(-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0), (0.0, 1.0)]);
                // Empty texels face the viewer.
                cases.extend((0..4).map(|choice| vec![choice as f32, 0.0, 0.0, 0.0, 0.0]));
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[("rgb * 2.0 - weights", "rgb * 2.0 - 1.0"), ("vec3f(0.0, 0.0, 1.0)", "vec3f(0.0)")],
        },
        Formula {
            name: "rotate_normal",
            file: "lib/normal.wgsl",
            wgsl: "let v = rotate_normal(vec3f(x(0), x(1), x(2)), vec2f(x(3), x(4))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| normal::rotate_normal(v3(x), v2(&x[3..])).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0); 5]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("normal.x * rotation.x - normal.y", "normal.x * rotation.x + normal.y"),
                ("normal.z,", "-normal.z,"),
            ],
        },
        Formula {
            name: "six_way_from_texel",
            file: "lib/six_way.wgsl",
            wgsl: "let v = six_way_from_texel(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| six_way::six_way_from_texel(v3(x)).to_array().to_vec(),
            cases: random(20, &[(0.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("texel * texel", "texel")],
        },
        Formula {
            name: "six_way_response",
            file: "lib/six_way.wgsl",
            wgsl: "y(0, six_way_response(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), vec3f(x(6), x(7), x(8)), x(9)));",
            reference: |x| vec![six_way::six_way_response(v3(x), v3(&x[3..]), v3(&x[6..]), x[9])],
            cases: unit_vectors(random(100, &SIX_WAY_AND_LIGHT), 6),
            tolerance: TRANSCENDENTAL,
            mutants: &[("select(negative, positive,", "select(positive, negative,")],
        },
        Formula {
            name: "scattered",
            file: "lib/six_way.wgsl",
            wgsl: "y(0, scattered(x(0), x(1)));",
            reference: |x| vec![six_way::scattered(x[0], x[1])],
            cases: random(50, &[(-1.0, 1.0), (0.0, 0.9)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("- 2.0 * anisotropy", "+ 2.0 * anisotropy"), ("inverseSqrt(base) / base", "1.0 / base")],
        },
        Formula {
            name: "six_way_shares",
            file: "lib/six_way.wgsl",
            wgsl: "let v = six_way_shares(vec3f(x(0), x(1), x(2)), x(3)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| six_way::six_way_shares(v3(x), x[3]).to_array().to_vec(),
            cases: {
                let mut cases = unit_vectors(random(100, &SIX_WAY_AND_LIGHT[6..]), 0);
                cases.extend([0.2, 0.9].map(|anisotropy| vec![0.0, 0.0, -1.0, anisotropy]));
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("to_light.xy * to_light.xy", "abs(to_light.xy)"),
                ("scattered(-to_light.z, g)", "scattered(to_light.z, g)"),
                ("1.0 - along", "1.0"),
                ("to_light.z < 0.0", "to_light.z > 0.0"),
            ],
        },
        Formula {
            name: "rotate_six_way",
            file: "lib/six_way.wgsl",
            wgsl: "let v = rotate_six_way(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), vec2f(cos(x(6)), sin(x(6)))); \
                   y(0, v.positive.x); y(1, v.positive.y); y(2, v.positive.z); \
                   y(3, v.negative.x); y(4, v.negative.y); y(5, v.negative.z);",
            reference: |x| {
                let six_way::SixWay { positive, negative } =
                    six_way::rotate_six_way(v3(x), v3(&x[3..]), Vec2::from_angle(x[6]));
                [positive.to_array(), negative.to_array()].concat()
            },
            cases: random(100, &[(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (-4.0, 4.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("vec2f(down.x, up.y)", "vec2f(up.x, down.y)"),
                ("select(negative.xy, positive.xy, turned.x)", "positive.xy"),
                ("select(positive.yx, negative.yx, turned.y)", "negative.yx"),
                ("squares.y, positive.z)", "squares.y, negative.z)"),
            ],
        },
        Formula {
            name: "normal_from_six_way",
            file: "lib/six_way.wgsl",
            wgsl: "let v = normal_from_six_way(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| six_way::normal_from_six_way(v3(x), v3(&x[3..])).to_array().to_vec(),
            cases: {
                let mut cases = random(50, &[(0.0, 1.0); 6]);
                // Lit alike from all sides.
                cases.push(vec![0.5; 6]);
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[("positive - negative", "negative - positive"), ("vec3f(0.0, 0.0, 1.0)", "vec3f(0.0)")],
        },
        Formula {
            name: "distance_attenuation",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, distance_attenuation(x(0), x(1), x(2)));",
            reference: |x| vec![lighting::distance_attenuation(x[0], x[1], x[2])],
            cases: {
                let mut cases = random(100, &[(0.0, 30.0), (0.1, 1.0), (0.1, 1.0)]);
                // A point without a body, close by; one without a range.
                cases.extend(random(20, &[(0.0, 2.0e-4), (0.0, 0.1), (0.0, 0.0)]));
                cases.extend(random(20, &[(0.0, 900.0), (0.0, 0.0), (0.1, 1.0)]));
                cases
            },
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("distance_squared + radius * radius", "distance_squared"),
                ("max(distance_squared + radius * radius, 1.0e-4)", "(distance_squared + radius * radius + 1.0e-9)"),
            ],
        },
        Formula {
            name: "range_window",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, range_window(x(0), x(1)));",
            reference: |x| vec![lighting::range_window(x[0], x[1])],
            cases: random(100, &[(0.0, 30.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("1.0 - ratio * ratio", "1.0 - ratio"), ("window * window", "window")],
        },
        Formula {
            name: "sample_light",
            file: "lib/lighting.wgsl",
            wgsl: "let s = sample_light(light, vec3f(x(11), x(12), x(13))); \
                   y(0, s.direction.x); y(1, s.direction.y); y(2, s.direction.z); y(3, s.attenuation);",
            reference: |x| {
                let sample = lighting::sample_light(&light(x), v3(&x[11..]));
                sample.direction.extend(sample.attenuation).to_array().to_vec()
            },
            cases: {
                let range = [
                    (-4.0, 4.0),
                    (-4.0, 4.0),
                    (-4.0, 4.0),
                    (0.05, 0.2),
                    (-1.0, 1.0),
                    (-1.0, 1.0),
                    (-1.0, 1.0),
                    (-0.5, 1.0),
                    (0.0, 8.0),
                    (-4.0, 1.0),
                    (0.05, 0.5),
                    (-3.0, 3.0),
                    (-3.0, 3.0),
                    (-3.0, 3.0),
                ];
                unit_vectors(random(300, &range), 4)
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("dot(-direction", "dot(direction"),
                ("light.position - position", "position - light.position"),
                ("LightSample(-light.direction", "LightSample(light.direction"),
            ],
        },
        Formula {
            name: "diffuse_coordinate",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, diffuse_coordinate(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| vec![lighting::diffuse_coordinate(v3(x), v3(&x[3..]))],
            cases: unit_vectors(unit_vectors(random(100, &[(-1.0, 1.0); 6]), 0), 3),
            tolerance: ARITHMETIC,
            mutants: &[("* 0.5 + 0.5", "")],
        },
        Formula {
            name: "direction_to_viewer",
            file: "lib/lighting.wgsl",
            wgsl: "let d = direction_to_viewer(vec3f(x(1), x(2), x(3)), x(0)); y(0, d.x); y(1, d.y); y(2, d.z);",
            reference: |x| lighting::direction_to_viewer(v3(&x[1..]), x[0]).to_array().to_vec(),
            cases: with_choices(2, &[(-9.0, 9.0), (-9.0, 9.0), (-50.0, -0.1)]),
            tolerance: ARITHMETIC,
            mutants: &[("return -position", "return position"), ("orthographic > 0.5", "orthographic > 2.0")],
        },
        Formula {
            name: "backlight_weight",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, backlight_weight(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))));",
            reference: |x| vec![lighting::backlight_weight(v3(x), v3(&x[3..]))],
            cases: unit_vectors(unit_vectors(random(100, &[(-1.0, 1.0); 6]), 0), 3),
            tolerance: ARITHMETIC,
            mutants: &[("0.5 - 0.5", "0.5 + 0.5"), ("against * against * against", "against * against")],
        },
        Formula {
            name: "soft_scatter_weight",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, soft_scatter_weight(x(0), x(1), x(2)));",
            reference: |x| vec![lighting::soft_scatter_weight(x[0], x[1], x[2])],
            cases: {
                let mut cases = random(100, &[(0.0, 1.0), (0.0, 0.5), (0.05, 1.0)]);
                // A step, where the smoothstep would divide by zero.
                cases.extend([vec![0.3, 0.5, 0.0], vec![0.7, 0.5, 0.0]]);
                cases
            },
            tolerance: 1e-5,
            mutants: &[
                ("amount - scatter_amount", "amount"),
                ("max(scatter_smooth, 1.0e-4)", "max(scatter_smooth - scatter_amount, 1.0e-4)"),
            ],
        },
        Formula {
            name: "coverage",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, coverage(x(0), x(1)));",
            reference: |x| vec![lighting::coverage(x[0], x[1])],
            cases: random(50, &[(0.0, 1.0), (0.0, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("saturate(amount * boost)", "amount * boost")],
        },
        Formula {
            name: "painted_coverage",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, painted_coverage(vec3f(x(0), x(1), x(2))));",
            reference: |x| vec![lighting::painted_coverage(v3(x))],
            cases: random(100, &[(0.0, 1.3); 3]),
            tolerance: 1e-5,
            mutants: &[("luminance(paint)", "paint.r"), ("srgb_from_linear(saturate", "(saturate")],
        },
        Formula {
            name: "specular_scatter_fade",
            file: "lib/lighting.wgsl",
            wgsl: "y(0, specular_scatter_fade(x(0), x(1), x(1) + x(2)));",
            reference: |x| vec![lighting::specular_scatter_fade(x[0], x[1], x[1] + x[2])],
            cases: random(50, &[(0.0, 9.0), (1.0, 4.0), (1.0, 4.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("light_depth - smoke_near", "smoke_far - light_depth")],
        },
        Formula {
            name: "sprite_lod",
            file: "lib/sprite.wgsl",
            wgsl: "y(0, sprite_lod(x(0), x(1)));",
            reference: |x| vec![sprite::sprite_lod(x[0], x[1])],
            cases: random(50, &[(8.0, 512.0), (0.0, 600.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("sprite_size / max", "0.5 * sprite_size / max"),
                ("1.0e-3)) + 0.5)", "1.0e-3)))"),
                ("max(floor(", "max(("),
            ],
        },
        Formula {
            name: "flipbook_frames",
            file: "lib/sprite.wgsl",
            wgsl: "let f = flipbook_frames(x(0), x(1)); y(0, f32(f.first)); y(1, f32(f.second)); y(2, f.blend);",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[0], x[1]);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: (-40_i32..120).map(|i| vec![i as f32 * 0.37, (1 + i.rem_euclid(9)) as f32]).collect(),
            tolerance: 1e-5,
            mutants: &[("first + 1.5 > frame_count", "false"), ("floor(frame / frame_count)", "0.0")],
        },
        Formula {
            name: "shown_frames",
            file: "lib/sprite.wgsl",
            wgsl: "let f = shown_frames(u32(x(0)), x(1), 4.0); y(0, f32(f.first)); y(1, f32(f.second)); y(2, f.blend);",
            reference: |x| {
                let frames = sprite::shown_frames(SpriteAnimation::ALL[x[0] as usize], x[1], 4.0);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: with_choices(count(SpriteAnimation::ALL), &[(0.0, 9.0)]),
            tolerance: 1e-5,
            mutants: &[
                ("animation == SPRITE_ANIMATION_STILL ||", ""),
                ("|| animation == SPRITE_ANIMATION_NEAREST", ""),
            ],
        },
        Formula {
            name: "visibility_tap",
            file: "lib/lighting.wgsl",
            wgsl: "let v = visibility_tap(u32(x(0)), x(1)); y(0, v.x); y(1, v.y);",
            reference: |x| lighting::visibility_tap(x[0] as u32, x[1]).to_array().to_vec(),
            cases: with_choices(lighting::VISIBILITY_TAPS, &[(0.0, 20.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("index == 8u", "false"), ("0.785398163", "0.7"), ("* radius, vec2f", ", vec2f")],
        },
        Formula {
            name: "cube_direction",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = cube_direction(i32(x(0)), vec2f(x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| diffuse_bake::cube_direction(x[0] as i32, v2(&x[1..])).to_array().to_vec(),
            cases: with_choices(6, &[(-1.0, 1.0), (-1.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("vec3f(1.0, position.y, -position.x)", "vec3f(1.0, position.y, position.x)")],
        },
        Formula {
            name: "cube_coordinate",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let c = cube_coordinate(vec3f(x(0), x(1), x(2))); y(0, f32(c.face)); y(1, c.position.x); y(2, c.position.y);",
            reference: |x| {
                let cube = diffuse_bake::cube_coordinate(v3(x));
                vec![cube.face as f32, cube.position.x, cube.position.y]
            },
            cases: random(300, &[(-1.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("CubeCoordinate(3, vec2f(d.x, d.z))", "CubeCoordinate(3, vec2f(d.x, -d.z))"),
                ("size.y >= size.z {", "size.y <= size.z {"),
            ],
        },
        Formula {
            name: "motif_normal",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = motif_normal(vec2f(x(0), x(1))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| diffuse_bake::motif_normal(v2(x)).to_array().to_vec(),
            cases: random(100, &[(-1.0, 1.0); 2]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("sqrt(1.0 - square)", "1.0 - square")],
        },
        Formula {
            name: "motif_position",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = motif_position(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y);",
            reference: |x| diffuse_bake::motif_position(v3(x)).to_array().to_vec(),
            cases: unit_vectors(random(100, &[(-1.0, 1.0); 3]), 0),
            tolerance: TRANSCENDENTAL,
            mutants: &[("normal.z >= 0.0", "normal.z >= -2.0")],
        },
        Formula {
            name: "sample_baked",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "let v = sample_baked(test_sprite, test_sampler, vec2f(x(1), x(2)), i32(x(0))); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                diffuse_bake::sample_baked(&Frame(test_sprite(), x[0] as u32), v2(&x[1..])).to_array().to_vec()
            },
            cases: with_choices(3, &[(-1.2, 1.2); 2]),
            tolerance: 1e-5,
            // The last puts the border between texels, where faces of the cube would show a seam.
            mutants: &[
                ("low, layer, 0)", "low, 0, 0)"),
                ("position * 0.5 + 0.5", "vec2f(position.x, -position.y) * 0.5 + 0.5"),
                (
                    "let texel = saturate(position * 0.5 + 0.5) * (size - 1.0)",
                    "let texel = saturate(position * 0.5 + 0.5) * size - 0.5",
                ),
            ],
        },
        Formula {
            name: "spherical_harmonics",
            file: "lib/diffuse_bake.wgsl",
            wgsl: "var c: array<vec4f, 9>; for (var i = 0u; i < 9u; i++) { \
                   c[i] = vec4f(x(3u + i), x(12u + i), x(21u + i), 0.0); } \
                   let v = spherical_harmonics(c, vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let coefficients = std::array::from_fn(|i| vec4(x[3 + i], x[12 + i], x[21 + i], 0.0));
                diffuse_bake::spherical_harmonics(&coefficients, v3(x)).to_array().to_vec()
            },
            cases: unit_vectors(random(100, &[(-1.0, 1.0); 30]), 0),
            tolerance: ARITHMETIC * 5.0,
            mutants: &[
                ("n.x * n.z * c[7].rgb", "n.x * n.z * c[6].rgb"),
                ("3.0 * n.z * n.z - 1.0", "3.0 * n.y * n.y - 1.0"),
                ("max(light, vec3f(0.0))", "light"),
            ],
        },
        Formula {
            name: "optical_depth_in_front",
            file: "lib/order.wgsl",
            wgsl: "var k: array<vec4f, 4>; for (var i = 0u; i < 16u; i++) { k[i / 4u][i % 4u] = x(3u + i); } \
                   y(0, optical_depth_in_front(k, x(0), x(1), x(2)));",
            reference: |x| {
                let knots = std::array::from_fn(|i| v4(&x[3 + 4 * i..]));
                vec![order::optical_depth_in_front(&knots, x[0], x[1], x[2])]
            },
            // Depths before the first knot, at the last and beyond it.
            cases: random(200, &[[(-2.0, 14.0), (3.0, 4.0), (5.0, 8.0)].as_slice(), &[(0.0, 9.0); 16]].concat()),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("through * 0.5 + 0.25", "through"), ("place - f32(low)", "0.0"), ("low + 1u", "low")],
        },
        Formula {
            name: "order_weight",
            file: "lib/order.wgsl",
            wgsl: "y(0, order_weight(x(0), x(1)));",
            reference: |x| vec![order::order_weight(x[0], x[1])],
            cases: random(100, &[(0.0, 4.0), (0.0, 12.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("depth_weight * optical_depth", "depth_weight"), ("exp(-min", "exp(min")],
        },
        Formula {
            name: "upsample_weights",
            file: "lib/upsample.wgsl",
            wgsl: "let w = upsample_weights(u32(x(0)), vec2f(x(1), x(2)), vec4f(x(3), x(4), x(5), x(6)), x(7)); \
                   y(0, w.x); y(1, w.y); y(2, w.z); y(3, w.w);",
            reference: |x| {
                let mode = Upsample::ALL[x[0] as usize];
                upsample::upsample_weights(mode, v2(&x[1..]), v4(&x[3..]), x[7]).to_array().to_vec()
            },
            cases: {
                let mut cases = with_choices(
                    count(Upsample::ALL),
                    &[(0.0, 1.0), (0.0, 1.0), (4.0, 6.0), (4.0, 6.0), (4.0, 6.0), (4.0, 6.0), (4.0, 6.0)],
                );
                // Smooth floors, and a pixel whose surface no texel has seen.
                cases.extend(with_choices(
                    count(Upsample::ALL),
                    &[(0.0, 1.0), (0.0, 1.0), (4.9, 5.1), (4.9, 5.1), (4.9, 5.1), (4.9, 5.1), (4.9, 5.1)],
                ));
                cases.extend(with_choices(
                    count(Upsample::ALL),
                    &[(0.0, 1.0), (0.0, 1.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (30.0, 60.0)],
                ));
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("vec4f(SAME_SURFACE * depth)", "vec4f(SAME_SURFACE)"),
                ("fraction.x * g.y, g.x * fraction.y", "g.x * fraction.y, fraction.x * g.y"),
                ("if difference.y == closest", "if difference.z == closest"),
                ("-0.5 * sigmas * sigmas", "-sigmas * sigmas"),
            ],
        },
        Formula {
            name: "is_smooth",
            file: "lib/upsample.wgsl",
            wgsl: "y(0, f32(is_smooth(vec4f(x(0), x(1), x(2), x(3)), x(4), x(5))));",
            reference: |x| vec![f32::from(upsample::is_smooth(v4(x), x[4], x[5]))],
            cases: random(200, &[(4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (4.0, 5.0), (0.0, 4.0)]),
            tolerance: 0.0,
            mutants: &[
                ("SAME_SMOKE * fade", "fade"),
                ("min(depths.z, depths.w)), depth)", "min(depths.z, depths.w)), 9.0)"),
                ("max(depths.x, depths.y)", "depths.y"),
            ],
        },
        Formula {
            name: "guided_weight",
            file: "lib/upsample.wgsl",
            wgsl: "y(0, guided_weight(vec3f(x(0), x(1), x(2)), x(3)));",
            reference: |x| vec![upsample::guided_weight(v3(x), x[3])],
            cases: random(100, &[(-2.2, 2.2), (-2.2, 2.2), (-0.5, 0.5), (3.0, 6.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("abs(place.xy) * 0.5", "abs(place.xy)"), ("(2.0 / (SAME_SURFACE", "(1.0 / (SAME_SURFACE")],
        },
        Formula {
            name: "with_texel",
            file: "lib/upsample.wgsl",
            wgsl: WGSL_FIT,
            reference: |x| {
                let fit = fit(x);
                let vectors = [fit.place, fit.squares, fit.products].map(|v| v.to_array());
                let values = [fit.value, fit.x_value, fit.y_value, fit.z_value, fit.low, fit.high].map(|v| v.x);
                [[fit.total, fit.nearest, fit.farthest].as_slice(), vectors.as_flattened(), &values].concat()
            },
            cases: random(100, &[(-2.0, 2.0); 20]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("w.xxy * place.yzz", "w.xyy * place.yzz"),
                ("w * place,", "w,"),
                ("fit.y_value + value * w.y", "fit.y_value + value * w.x"),
                ("value, fit.total == 0.0),\n        min", "value, false),\n        min"),
                ("min(fit.nearest, place.z)", "place.z"),
            ],
        },
        Formula {
            name: "fitted_value",
            file: "lib/upsample.wgsl",
            wgsl: WGSL_FITTED,
            reference: |x| vec![upsample::fitted_value(&fit(x), 0.5).x],
            cases: random(200, &[(-1.5, 1.5); 20]),
            // Through the inverse of a matrix, of sums in another order.
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("held * held", "held"),
                ("vec3f(0.02, 0.02,", "vec3f(0.0, 0.0,"),
                ("clamp(0.0, fit.nearest, fit.farthest)", "0.0"),
                ("clamp(fitted, fit.low, fit.high)", "fitted"),
                ("mean.xxy * mean.yzz", "mean.xxy"),
            ],
        },
        Formula {
            name: "ndc_from_pixel",
            file: "lib/view.wgsl",
            wgsl: "let v = ndc_from_pixel(vec2f(x(0), x(1)), vec2f(x(2), x(3))); y(0, v.x); y(1, v.y);",
            reference: |x| view::ndc_from_pixel(v2(x), v2(&x[2..])).to_array().to_vec(),
            cases: random(50, &[(0.0, 640.0), (0.0, 360.0), (100.0, 640.0), (100.0, 360.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("1.0 - pixel.y / size.y * 2.0", "pixel.y / size.y * 2.0 - 1.0")],
        },
        Formula {
            name: "pixel_from_ndc",
            file: "lib/view.wgsl",
            wgsl: "let v = pixel_from_ndc(vec2f(x(0), x(1)), vec2f(x(2), x(3))); y(0, v.x); y(1, v.y);",
            reference: |x| view::pixel_from_ndc(v2(x), v2(&x[2..])).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0), (-1.0, 1.0), (100.0, 640.0), (100.0, 360.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("0.5 - ndc.y * 0.5", "0.5 + ndc.y * 0.5")],
        },
        Formula {
            name: "view_position",
            file: "lib/view.wgsl",
            wgsl: "let v = view_position(vec2f(x(1), x(2)), x(3), x(0)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| view::view_position(v2(&x[1..]), x[3], x[0]).to_array().to_vec(),
            cases: with_choices(2, &[(-1.0, 1.0), (-1.0, 1.0), (0.1, 50.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("mix(view_depth, 1.0, orthographic)", "view_depth"), ("-view_depth)", "view_depth)")],
        },
        Formula {
            name: "sample_ramp_2d",
            file: "lib/ramp.wgsl",
            wgsl: "let v = sample_ramp_2d(test_ramp, test_sampler, vec2f(x(0), x(1))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| ramp::sample_ramp_2d(&test_ramp(), RampFilter::Bilinear, v2(x)).to_array().to_vec(),
            cases: random(200, &[(-0.1, 1.1); 2]),
            tolerance: 1e-5,
            // Swapped axes, and the texel centres of an image instead of a gradient's ends.
            mutants: &[("saturate(coordinate)", "saturate(coordinate.yx)"), ("* (size - 1.0)", "* size - 0.5")],
        },
        Formula {
            name: "ramp_texel",
            file: "lib/ramp.wgsl",
            wgsl: "let v = ramp_texel(vec2f(x(2), x(3)), vec2f(x(0), x(1))); y(0, v.x); y(1, v.y);",
            reference: |x| ramp::ramp_texel(v2(&x[2..]).as_uvec2(), v2(x)).to_array().to_vec(),
            cases: vec![vec![-0.1, 0.3, 16.0, 1.0], vec![0.5, 1.2, 256.0, 64.0], vec![1.0, 0.7, 4.0, 9.0]],
            tolerance: ARITHMETIC,
            mutants: &[("(size - 1.0)", "size"), ("saturate(coordinate)", "coordinate")],
        },
        Formula {
            name: "sample_ramp_nearest",
            file: "lib/ramp.wgsl",
            wgsl: "let v = sample_ramp_nearest(test_ramp, vec2f(x(0), x(1))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| ramp::sample_ramp_nearest(&test_ramp(), v2(x)).to_array().to_vec(),
            cases: random(200, &[(-0.1, 1.1); 2]),
            tolerance: 1e-6,
            mutants: &[("coordinate) + 0.5)", "coordinate))"), ("saturate(coordinate)", "saturate(coordinate.yx)")],
        },
        Formula {
            name: "sample_ramp",
            file: "lib/ramp.wgsl",
            wgsl: "let v = sample_ramp(test_ramp, test_sampler, x(0)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| ramp::sample_ramp(&test_ramp(), RampFilter::Bilinear, x[0]).to_array().to_vec(),
            cases: random(100, &[(-0.1, 1.1)]),
            tolerance: 1e-5,
            mutants: &[("vec2f(u, 0.0)", "vec2f(0.0, u)")],
        },
        Formula {
            name: "sample_sprite",
            file: "lib/sprite.wgsl",
            wgsl: "let f = flipbook_frames(x(2), 3.0); \
                   let v = sample_sprite(test_sprite, test_sampler, vec2f(x(0), x(1)), f, vec2f(x(4), x(5)), x(3)); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[2], 3.0);
                sprite::sample_sprite(&test_sprite(), v2(x), frames, v2(&x[4..]), x[3]).to_array().to_vec()
            },
            cases: random(300, &[(0.0, 1.0), (0.0, 1.0), (0.0, 9.0), (0.0, 4.0), (-0.2, 0.2), (-0.2, 0.2)]),
            tolerance: 1e-5,
            mutants: &[
                ("mix(texel, next, frames.blend)", "texel"),
                ("mix(fine, coarse, level - base)", "fine"),
                ("texel.rgb * 2.0 - 1.0", "texel.rgb"),
                ("uv * vec2f(size) - 0.5", "uv * vec2f(size)"),
                ("uv - motion * frames.blend", "uv + motion * frames.blend"),
                ("motion * (1.0 - frames.blend)", "motion * frames.blend"),
            ],
        },
        Formula {
            name: "frames_after",
            file: "lib/sprite.wgsl",
            wgsl: "let f = frames_after(flipbook_frames(x(0), 5.0), i32(x(1))); \
                   y(0, f32(f.first)); y(1, f32(f.second)); y(2, f.blend);",
            reference: |x| {
                let frames = sprite::frames_after(sprite::flipbook_frames(x[0], 5.0), x[1] as i32);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: random(50, &[(0.0, 9.0), (0.0, 12.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("frames.first + layers", "frames.first"), ("frames.second + layers", "frames.first + layers")],
        },
        Formula {
            name: "sprite_frame",
            file: "lib/sprite.wgsl",
            wgsl: "y(0, sprite_frame(u32(x(0)), x(1), x(2), x(3)));",
            reference: |x| vec![sprite::sprite_frame(SpriteAnimation::ALL[x[0] as usize], x[1], x[2], x[3])],
            cases: with_choices(count(SpriteAnimation::ALL), &[(0.0, 9.0), (-0.2, 1.2), (1.0, 9.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("frame_count - 1.0);", "frame_count);"),
                ("STILL: { return 0.0; }", "STILL: { return frame; }"),
                ("return frame + 0.5;", "return frame;"),
            ],
        },
        Formula {
            name: "detail_from_texel",
            file: "lib/sprite.wgsl",
            wgsl: "let v = detail_from_texel(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| sprite::detail_from_texel(v3(x)).to_array().to_vec(),
            cases: random(50, &[(0.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("- 128.0", "- 127.5"), ("vec3f(1.0, MOTION_RANGE", "vec3f(MOTION_RANGE, MOTION_RANGE")],
        },
        Formula {
            name: "sample_detail",
            file: "lib/sprite.wgsl",
            wgsl: "let f = flipbook_frames(x(2), 3.0); \
                   let v = sample_detail(test_sprite, test_sampler, vec2f(x(0), x(1)), f, x(3)); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let frames = sprite::flipbook_frames(x[2], 3.0);
                sprite::sample_detail(&test_sprite(), v2(x), frames, x[3]).to_array().to_vec()
            },
            cases: random(200, &[(0.0, 1.0), (0.0, 1.0), (0.0, 9.0), (0.0, 4.0)]),
            tolerance: 1e-5,
            mutants: &[("mix(first.x, second.x, frames.blend)", "first.x"), ("first.yz", "second.yz")],
        },
        Formula {
            name: "unrotate",
            file: "lib/sprite.wgsl",
            wgsl: "let v = unrotate(vec2f(x(0), x(1)), vec2f(x(2), x(3))); y(0, v.x); y(1, v.y);",
            reference: |x| sprite::unrotate(v2(x), v2(&x[2..])).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0); 4]),
            tolerance: ARITHMETIC,
            mutants: &[("offset.x * rotation.x + offset.y", "offset.x * rotation.x - offset.y")],
        },
        Formula {
            name: "sprite_uv",
            file: "lib/sprite.wgsl",
            wgsl: "let v = sprite_uv(vec2f(x(0), x(1))); y(0, v.x); y(1, v.y);",
            reference: |x| sprite::sprite_uv(v2(x)).to_array().to_vec(),
            cases: random(50, &[(-1.0, 1.0); 2]),
            tolerance: ARITHMETIC,
            mutants: &[("0.5 - corner.y * 0.5", "0.5 + corner.y * 0.5")],
        },
        Formula {
            name: "checkerboard",
            file: "lib/sprite.wgsl",
            wgsl: "let v = checkerboard(vec2f(x(0), x(1))); y(0, v.z); y(1, v.w);",
            reference: |x| vec![sprite::checkerboard(v2(x)).z, sprite::checkerboard(v2(x)).w],
            cases: random(100, &[(0.0, 1.0); 2]),
            tolerance: 0.0,
            mutants: &[("check.x + check.y", "check.x")],
        },
        Formula {
            name: "hard_fade",
            file: "lib/technique.wgsl",
            wgsl: "y(0, hard_fade(x(0)));",
            reference: |x| vec![technique::hard_fade(x[0])],
            cases: random(50, &[(-1.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("distance >= 0.0", "distance <= 0.0")],
        },
        Formula {
            name: "depth_sprite_depth",
            file: "lib/technique.wgsl",
            wgsl: "y(0, depth_sprite_depth(x(0), x(1), x(2)));",
            reference: |x| vec![technique::depth_sprite_depth(x[0], x[1], x[2])],
            cases: random(50, &[(1.0, 9.0), (-1.0, 1.0), (0.0, 2.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("- offset * radius", "+ offset * radius"), ("offset * radius", "offset")],
        },
        Formula {
            name: "ray_sphere",
            file: "lib/technique.wgsl",
            wgsl: "let v = ray_sphere(vec3f(0.1, 0.2, 0.3), vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), x(6), x(7), \
                   x(7) + x(8)); y(0, v.enter); y(1, v.leave); y(2, v.axis.x); y(3, v.axis.y); y(4, v.axis.z);",
            reference: |x| {
                let origin = vec3(0.1, 0.2, 0.3);
                let found = technique::ray_sphere(origin, v3(x), v3(&x[3..]), x[6], x[7], x[7] + x[8]);
                vec![found.enter, found.leave, found.axis.x, found.axis.y, found.axis.z]
            },
            // Missed, hit, and cut at either end.
            cases: unit_vectors(
                random(
                    300,
                    &[
                        (-0.3, 0.3),
                        (-0.3, 0.3),
                        (-1.0, -0.5),
                        (-1.0, 1.0),
                        (-1.0, 1.0),
                        (-6.0, 0.5),
                        (0.0, 2.0),
                        (0.1, 4.0),
                        (0.0, 6.0),
                    ],
                ),
                0,
            ),
            // The root of a difference of squares near the rim: 1e-7 under it is 3e-4.
            tolerance: 5e-4,
            mutants: &[
                ("max(middle - half_chord, near)", "middle - half_chord"),
                ("min(middle + half_chord, scene)", "middle + half_chord"),
                ("radius * radius - dot(axis, axis)", "radius * radius"),
            ],
        },
        Formula {
            name: "spherical_billboard_amount",
            file: "lib/technique.wgsl",
            wgsl: "y(0, spherical_billboard_amount(x(0), x(1), x(2), x(3)));",
            reference: |x| vec![technique::spherical_billboard_amount(x[0], x[1], x[2], x[3])],
            cases: {
                let mut cases = random(100, &[(0.0, 4.0), (0.0, 1.5), (0.5, 1.5), (-0.5, 2.0)]);
                cases.push(vec![1.0, 0.0, 0.0, 1.0]);
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[("1.0 - axis_distance / max", "axis_distance / max"), ("max(stretch, 0.0)", "stretch")],
        },
        Formula {
            name: "density_thickness",
            file: "lib/technique.wgsl",
            wgsl: "y(0, density_thickness(x(0), x(1), x(2), x(3)));",
            reference: |x| vec![technique::density_thickness(x[0], x[1], x[2], x[3])],
            cases: random(200, &[(0.1, 4.0), (0.0, 2.0), (0.1, 2.0), (0.1, 6.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("min(scene, view_depth + radius)", "(view_depth + radius)"),
                ("max(near, view_depth - radius)", "(view_depth - radius)"),
            ],
        },
        Formula {
            name: "slab_share",
            file: "lib/technique.wgsl",
            wgsl: "y(0, slab_share(x(0), x(1), x(2)));",
            reference: |x| vec![technique::slab_share(x[0], x[1], x[2])],
            cases: random(100, &[(-2.0, 3.0), (0.1, 2.0), (0.05, 0.5)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("radius - near)", "radius)"),
                ("saturate((view_depth + radius - near)", "((view_depth + radius - near)"),
            ],
        },
        Formula {
            name: "density_amount",
            file: "lib/technique.wgsl",
            wgsl: "y(0, density_amount(x(0), x(1)));",
            reference: |x| vec![technique::density_amount(x[0], x[1])],
            cases: random(50, &[(0.0, 4.0), (0.0, 2.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("1.0 - exp(-density * thickness)", "density * thickness")],
        },
        Formula {
            name: "volumetric_falloff",
            file: "lib/technique.wgsl",
            wgsl: "y(0, volumetric_falloff(vec3f(x(0), x(1), x(2))));",
            reference: |x| vec![technique::volumetric_falloff(v3(x))],
            cases: random(100, &[(-1.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("dot(place, place)", "length(place)"), ("saturate(1.0", "(1.0")],
        },
        Formula {
            name: "volumetric_density",
            file: "lib/technique.wgsl",
            wgsl: "y(0, volumetric_density(x(0), x(1)));",
            reference: |x| vec![technique::volumetric_density(x[0], x[1])],
            cases: random(100, &[(0.0, 1.0); 2]),
            tolerance: ARITHMETIC,
            mutants: &[("2.0 * noise - 1.0 + falloff", "noise"), ("* falloff;", ";")],
        },
        Formula {
            name: "volumetric_normal",
            file: "lib/technique.wgsl",
            wgsl: "let v = volumetric_normal(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| technique::volumetric_normal(v3(x), v3(&x[3..])).to_array().to_vec(),
            cases: random(100, &[(-1.0, 1.0); 6]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("place + 2.0 * gradient", "place - 2.0 * gradient"), ("max(normal.z, 0.1)", "normal.z")],
        },
        Formula {
            name: "sphere_axis_bounds",
            file: "lib/technique.wgsl",
            wgsl: "let v = sphere_axis_bounds(vec2f(x(0), x(1)), x(2), x(3)); y(0, v.x); y(1, v.y);",
            reference: |x| technique::sphere_axis_bounds(v2(x), x[2], x[3]).to_array().to_vec(),
            cases: {
                let mut cases = random(300, &[(-3.0, 3.0), (0.3, 6.0), (0.05, 2.0), (0.1, 0.3)]);
                // Only spheres that reach in front of the near plane are drawn.
                cases.retain(|x| x[1] + x[2] > x[3]);
                cases
            },
            // Tangents that touch close to the near plane are far out and steep.
            tolerance: 2e-3,
            mutants: &[
                ("vec2f(centre.x - cut, centre.x + cut)", "vec2f(centre.x, centre.x)"),
                ("cosine * centre.x - sine * centre.y", "cosine * centre.x + sine * centre.y"),
                ("!clipped || upper.y", "upper.y < 0.0 || upper.y"),
            ],
        },
        Formula {
            name: "luminance",
            file: "lib/colour.wgsl",
            wgsl: "y(0, luminance(vec3f(x(0), x(1), x(2))));",
            reference: |x| vec![colour::luminance(v3(x))],
            cases: random(50, &[(0.0, 4.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("0.7152, 0.0722", "0.0722, 0.7152")],
        },
        Formula {
            name: "srgb_from_linear",
            file: "lib/colour.wgsl",
            wgsl: "y(0, srgb_from_linear(x(0)));",
            reference: |x| vec![colour::srgb_from_linear(x[0])],
            cases: [random(100, &[(0.0, 1.0)]), random(50, &[(0.0, 0.01)])].concat(),
            tolerance: TRANSCENDENTAL,
            mutants: &[("1.0 / 2.4", "1.0 / 2.2"), ("linear * 12.92", "linear")],
        },
        Formula {
            name: "bounded_light",
            file: "lib/colour.wgsl",
            wgsl: "let v = bounded_light(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| colour::bounded_light(v3(x)).to_array().to_vec(),
            cases: random(50, &[(0.0, 1.0e5); 3]),
            tolerance: 0.0,
            mutants: &[("min(light", "max(light"), ("32752.0", "65504.0")],
        },
        Formula {
            name: "gamma_target_colour",
            file: "lib/colour.wgsl",
            wgsl: "let v = gamma_target_colour(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| colour::gamma_target_colour(v3(x)).to_array().to_vec(),
            cases: random(100, &[(-0.5, 3.0); 3]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("saturate(light)", "light"), ("srgb_from_linear(shown.g)", "shown.g")],
        },
        Formula {
            name: "pcg3d",
            file: "lib/hash.wgsl",
            wgsl: "let v = pcg3d(vec3u(u32(x(0)), u32(x(1)), u32(x(2)))) >> vec3u(8u); \
                   y(0, f32(v.x)); y(1, f32(v.y)); y(2, f32(v.z));",
            reference: |x| {
                let word = |i: usize| x[i] as u32;
                let v = pcg3d(UVec3::new(word(0), word(1), word(2)));
                (v >> UVec3::splat(8)).as_vec3().to_array().to_vec()
            },
            cases: random(50, &[(0.0, 1.0e6); 3])
                .into_iter()
                .map(|case| case.into_iter().map(f32::floor).collect())
                .collect(),
            tolerance: 0.0,
            mutants: &[("1664525u", "1664526u"), ("vec3u(16u)", "vec3u(15u)")],
        },
        Formula {
            name: "unit",
            file: "lib/hash.wgsl",
            wgsl: "y(0, unit(u32(x(0)) * 77777u));",
            reference: |x| vec![unit((x[0] as u32).wrapping_mul(77777))],
            cases: random(50, &[(0.0, 1.0e6)]),
            tolerance: 0.0,
            mutants: &[("word >> 8u", "word >> 9u")],
        },
        Formula {
            name: "film",
            file: "lib/tonemap.wgsl",
            wgsl: "let v = film(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| tonemap::film(v3(x)).to_array().to_vec(),
            cases: [random(60, &[(-0.1, 1.0); 3]), random(30, &[(0.0, 50.0); 3])].concat(),
            tolerance: 10.0 * ARITHMETIC,
            mutants: &[("0.35458", "0.45458"), ("output * fitted", "fitted * output"), ("0.432951", "0.532951")],
        },
        Formula {
            name: "developed",
            file: "lib/tonemap.wgsl",
            wgsl: "let v = developed(vec3f(x(0), x(1), x(2)), x(3)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| tonemap::developed(v3(x), x[3]).to_array().to_vec(),
            cases: random(60, &[(0.0, 2.0), (0.0, 2.0), (0.0, 2.0), (0.1, 4.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("film(colour * exposure)", "film(colour)"), ("gamma_target_colour(film", "(film")],
        },
        Formula {
            name: "dither",
            file: "lib/tonemap.wgsl",
            wgsl: "y(0, dither(vec2u(u32(x(0)), u32(x(1)))) * 255.0);",
            reference: |x| vec![tonemap::dither(UVec2::new(x[0] as u32, x[1] as u32)) * 255.0],
            cases: random(50, &[(0.0, 4000.0); 2]),
            tolerance: ARITHMETIC,
            mutants: &[("unit(hash.y)", "unit(hash.z)"), ("vec3u(at, 0u)", "vec3u(at.yx, 0u)")],
        },
        Formula {
            name: "overdraw_colour",
            file: "lib/colour.wgsl",
            wgsl: "let v = overdraw_colour(x(0)); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| colour::overdraw_colour(x[0]).to_array().to_vec(),
            cases: [random(100, &[(0.0, 80.0)]), random(50, &[(0.0, 9.0)])].concat(),
            tolerance: TRANSCENDENTAL,
            mutants: &[("layers * 0.25", "layers * 0.5"), ("- 1.0, layers", "- 2.0, layers"), ("index + 1u", "index")],
        },
        Formula {
            name: "forward_fragment",
            file: "lib/blending.wgsl",
            wgsl: "let v = forward_fragment(u32(x(0)), vec3f(x(1), x(2), x(3)), x(4)); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| {
                blending::forward_fragment(BlendMode::ALL[x[0] as usize], v3(&x[1..]), x[4]).to_array().to_vec()
            },
            cases: with_choices(count(BlendMode::ALL), &[(0.0, 2.0), (0.0, 2.0), (0.0, 2.0), (0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                // Not premultiplied.
                ("vec4f(light, 1.0) * coverage", "vec4f(light, coverage)"),
                ("light * coverage, 0.0", "light * coverage, coverage"),
                ("min(light, vec3f(1.0))", "light"),
            ],
        },
        Formula {
            name: "sample_noise_volume",
            file: "lib/noise_volume.wgsl",
            wgsl: "let v = sample_noise_volume(test_noise, test_sampler, vec3f(x(0), x(1), x(2))); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| noise_volume::sample_noise_volume(test_noise(), v3(x)).to_array().to_vec(),
            cases: random(200, &[(-2.0, 2.0); 3]),
            // `fract` keeps 1e-7 of a coordinate; times 8 texels and the steepest slope between two of them, 2.
            tolerance: 2e-5,
            mutants: &[
                ("((texel % size) + size) % size", "clamp(texel, vec3i(0), size - 1)"),
                ("place * vec3f(size) - 0.5", "place * vec3f(size)"),
                ("texel.rgb * 2.0 - 1.0", "texel.rgb"),
                ("mix(near, far, f.z)", "near"),
            ],
        },
        Formula {
            name: "sample_noise_octaves",
            file: "lib/noise_volume.wgsl",
            wgsl: "let v = sample_noise_octaves(test_noise, test_sampler, vec3f(x(1), x(2), x(3)), 1u + u32(x(0))); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| {
                let octaves = 1 + x[0] as u32;
                noise_volume::sample_noise_octaves(test_noise(), v3(&x[1..]), octaves).to_array().to_vec()
            },
            cases: with_choices(4, &[(-1.0, 1.0); 3]),
            // A coordinate's last bit, 27 times over.
            tolerance: 2e-4,
            mutants: &[("place *= 3.0", "place *= 2.0"), ("weight *= 0.5", "weight *= 1.0"), ("sum / total", "sum")],
        },
        Formula {
            name: "noise_coordinate",
            file: "lib/noise_volume.wgsl",
            wgsl: "let v = noise_coordinate(vec3f(x(0), x(1), x(2)), x(3), vec3f(x(4), x(5), x(6))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| noise_volume::noise_coordinate(v3(x), x[3], v3(&x[4..])).to_array().to_vec(),
            cases: random(50, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (0.5, 4.0), (0.0, 2.0), (0.0, 2.0), (0.0, 2.0)]),
            // Coordinates up to 20.
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("from_eye + noise_offset", "from_eye - noise_offset"), ("/ noise_size", "* noise_size")],
        },
        Formula {
            name: "lattice_gradient",
            file: "lib/gradient_noise.wgsl",
            wgsl: "let v = lattice_gradient(vec3i(i32(x(0)), i32(x(1)), i32(x(2))), vec2f(x(3), x(4)), 7u); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| {
                let at = glam::IVec3::new(x[0] as i32, x[1] as i32, x[2] as i32);
                gradient_noise::lattice_gradient(at, v2(&x[3..]), 7).to_array().to_vec()
            },
            cases: random(50, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (-1.0, 1.0), (-1.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("seed ^ 0x9e3779b9u", "seed"),
                ("hash & vec3u(0xffffu)", "hash >> vec3u(16u)"),
                ("second * phase.y", "second"),
            ],
        },
        Formula {
            name: "gradient_noise",
            file: "lib/gradient_noise.wgsl",
            wgsl: "let v = gradient_noise(vec3f(x(0), x(1), x(2)), vec2f(x(3), x(4)), 7u); \
                   y(0, v.value); y(1, v.gradient.x); y(2, v.gradient.y); y(3, v.gradient.z);",
            reference: |x| {
                let noise = gradient_noise::gradient_noise(v3(x), v2(&x[3..]), 7);
                [&[noise.value][..], &noise.gradient.to_array()].concat()
            },
            cases: random(200, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (-1.0, 1.0), (-1.0, 1.0)]),
            // Sums of eight corners.
            tolerance: 4.0 * ARITHMETIC,
            mutants: &[
                ("f * 6.0 - 15.0", "f * 6.0 - 14.0"),
                ("f * f * 30.0", "f * f * 15.0"),
                ("select(-slope, slope, is_far)", "slope"),
                ("corner < 8u", "corner < 7u"),
                ("lattice * weight + vec3f", "vec3f"),
            ],
        },
        Formula {
            name: "curl_noise",
            file: "lib/gradient_noise.wgsl",
            wgsl: "let v = curl_noise(vec3f(x(0), x(1), x(2)), vec2f(x(3), x(4)), 7u); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| gradient_noise::curl_noise(v3(x), v2(&x[3..]), 7).to_array().to_vec(),
            cases: random(100, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (-1.0, 1.0), (-1.0, 1.0)]),
            tolerance: 8.0 * ARITHMETIC,
            mutants: &[("seed + 1u", "seed"), ("z.y - y.z", "y.z - z.y")],
        },
        Formula {
            name: "unit_sphere",
            file: "lib/emitter.wgsl",
            wgsl: "let v = unit_sphere(vec3f(x(0), x(1), x(2))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| emitter::unit_sphere(v3(x)).to_array().to_vec(),
            cases: random(100, &[(0.0, 1.0); 3]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("random.z * 2.0 - 1.0", "random.z"), ("sqrt(1.0 - z * z)", "(1.0 - z * z)")],
        },
        Formula {
            name: "drag_integrals",
            file: "lib/emitter.wgsl",
            wgsl: "let v = drag_integrals(x(0), x(1)); y(0, v.x); y(1, v.y);",
            reference: |x| emitter::drag_integrals(x[0], x[1]).to_array().to_vec(),
            // No drag, some, much; both sides of where the series ends.
            cases: [(0.0, 0.0), (0.0, 2.0), (0.01, 8.0)]
                .into_iter()
                .flat_map(|drag| random(100, &[drag, (0.0, 8.0)]))
                .collect(),
            // An exponential less 1, over a drag as small as 0.06 twice.
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("x / 2.0 * (1.0 - x / 3.0", "x / 2.0 * (1.0 - x / 4.0"),
                ("0.5 * t * t * approached", "t * t * approached"),
                ("(1.0 - exp(-x)) / drag", "(1.0 - exp(-x))"),
                ("(t - reached) / drag", "t - reached"),
            ],
        },
        Formula {
            name: "eased",
            file: "lib/emitter.wgsl",
            wgsl: "y(0, eased(x(0)));",
            reference: |x| vec![emitter::eased(x[0])],
            cases: random(50, &[(-1.0, 2.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("3.0 - 2.0 * s", "2.0 - s"), ("let s = saturate(x)", "let s = x")],
        },
        Formula {
            name: "birth_offset",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_BIRTH_OFFSET,
            reference: |x| emitter::birth_offset(&test_emitter(x), v3(&x[1..])).to_array().to_vec(),
            cases: with_choices(count(EmitterShape::ALL), &[(0.0, 1.0); 3]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("pow(random.x, 1.0 / 3.0)", "random.x"),
                ("(random * 2.0 - 1.0) * emitter.extent", "random * emitter.extent"),
                ("sqrt(random.z) * emitter.extent.xz", "random.z * emitter.extent.xz"),
                ("emitter.disc_z * level.y", "emitter.disc_x * level.y"),
            ],
        },
        Formula {
            name: "birth_random",
            file: "lib/emitter.wgsl",
            wgsl: "let v = birth_random(u32(x(0)), u32(x(1)), 9u); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| emitter::birth_random(x[0] as u32, x[1] as u32, 9).to_array().to_vec(),
            cases: random(50, &[(0.0, 1.0e6), (0.0, 4.0)]),
            tolerance: 0.0,
            mutants: &[("vec3u(index, salt, seed)", "vec3u(index, seed, salt)"), ("unit(hash.y)", "unit(hash.x)")],
        },
        Formula {
            name: "emitted_particle",
            file: "lib/emitter.wgsl",
            wgsl: WGSL_EMITTED,
            reference: |x| {
                let emitted = emitter::emitted_particle(&test_emitter(x), x[1] as u32);
                [emitted.position_radius, emitted.rotation_amount_frame_age].map(|v| v.to_array()).concat()
            },
            // Of 40 births a second the last 8 seconds: some are dead.
            cases: with_choices(count(EmitterShape::ALL), &[(0.0, 330.0)]),
            // The driver's sines and roots, carried on by swirls that change by 10 over a turbulence_scale.
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("(f32(number) + life.y) / emitter.rate", "f32(number) / emitter.rate"),
                ("seconds < lifetime", "true"),
                ("2.0 * life.x - 1.0", "life.x"),
                ("outward * emitter.burst", "vec3f(0.0)"),
                ("emitter.velocity_spread * life.z", "emitter.velocity_spread"),
                ("emitter.wind * (seconds - reached)", "emitter.wind * seconds"),
                ("emitter.rise * integrals.y", "emitter.rise"),
                ("2.3 / emitter.turbulence_scale", "2.0 / emitter.turbulence_scale"),
                ("emitter.turbulence * age", "emitter.turbulence"),
                ("emitter.seed * 977u + 5u", "emitter.seed * 977u"),
                ("* sqrt(age)", "* age"),
                ("2.0 * look.x - 1.0", "look.x"),
                ("(2.0 * look.z - 1.0) * reached", "(2.0 * look.z - 1.0) * seconds"),
                ("fade_in * fade_out", "fade_in"),
                ("eased(age / max(emitter.fade_in", "saturate(age / max(emitter.fade_in"),
                ("place.x * 256.0 + seconds", "place.x * 256.0 - seconds"),
                ("birth_random(index, 3u", "birth_random(index, 2u"),
            ],
        },
    ]
}

/// Runs the formula on the GPU, from `source` of its file.
fn run(formula: &Formula, mutate: Option<(&str, &str)>) -> Vec<Vec<f32>> {
    let mut library = format!("#import \"{}\"\n", formula.file);
    if !["lib/sprite.wgsl", "lib/ramp.wgsl", "lib/noise_volume.wgsl"].contains(&formula.file) {
        library.push_str("#import \"lib/ramp.wgsl\"\n");
    }
    let mut source = shader::compose(&library).unwrap();
    if let Some((from, to)) = mutate {
        assert!(source.contains(from), "{}: there is no {from:?} to mutate", formula.name);
        source = source.replace(from, to);
    }
    // `sample_light` takes a struct of many fields.
    let prelude = if formula.name == "sample_light" { WGSL_LIGHT } else { "" };
    // One case per workgroup: llvmpipe 22 takes a textureLoad's level for a whole SIMD group from its first invocation.
    source.push_str(&format!(
        "@group(0) @binding(0) var<storage, read> inputs: array<f32>;
         @group(0) @binding(1) var<storage, read_write> results: array<f32>;
         @group(0) @binding(2) var test_ramp: texture_2d<f32>;
         @group(0) @binding(3) var test_sprite: texture_2d_array<f32>;
         @group(0) @binding(4) var test_sampler: sampler;
         @group(0) @binding(5) var test_noise: texture_3d<f32>;
         var<private> case_index: u32;
         fn x(i: u32) -> f32 {{ return inputs[case_index * {WIDTH}u + i]; }}
         fn y(i: u32, value: f32) {{ results[case_index * {WIDTH}u + i] = value; }}
         @compute @workgroup_size(1)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             case_index = id.x;
             if case_index * {WIDTH}u >= arrayLength(&inputs) {{ return; }}
             {prelude}
             {}
         }}",
        formula.wgsl
    ));
    let results =
        crate::common::compute(gpu(), &source, &formula.cases, WIDTH, &test_ramp(), &test_sprite(), test_noise());
    gpu().check().unwrap_or_else(|error| panic!("{}: {error}\n{source}", formula.name));
    results
}

/// Largest difference from the reference, relative to 1 or the result.
fn error(formula: &Formula, results: &[Vec<f32>]) -> f32 {
    let mut worst = 0.0_f32;
    for (case, result) in formula.cases.iter().zip(results) {
        for (expected, found) in (formula.reference)(case).into_iter().zip(result) {
            assert!(expected.is_finite(), "{} of {case:?} is {expected}", formula.name);
            let difference = (expected - found).abs() / expected.abs().max(1.0);
            worst = worst.max(if difference.is_nan() { f32::INFINITY } else { difference });
        }
    }
    worst
}

#[test]
fn every_formula_agrees_with_the_reference() {
    for formula in formulas() {
        let worst = error(&formula, &run(&formula, None));
        println!("{}: {worst:e}", formula.name);
        assert!(worst <= formula.tolerance, "{}: off by {worst:e}", formula.name);
    }
}

#[test]
fn every_mutant_fails() {
    for formula in formulas() {
        assert!(!formula.mutants.is_empty(), "{} has no mutant", formula.name);
        for &mutant in formula.mutants {
            let worst = error(&formula, &run(&formula, Some(mutant)));
            assert!(worst > 10.0 * formula.tolerance, "{}: the mutant {mutant:?} passes ({worst:e})", formula.name);
        }
    }
}

/// Functions that the formulas above run through, or that read the passes' own bindings; whole frames hold the latter.
const INDIRECT: &[&str] = &[
    "load_sprite_bilinear",
    "sample_sprite_frame",
    "last_level",
    "sample_at_level",
    "sprite_corner",
    "sprite_vertex",
    "placed_sprite",
    "diffuse",
    "diffuse_from_lights",
    "diffuse_from_six_way",
    "surface_from_accumulation",
    "sample_flipbook",
    "smoke_coverage",
    "light_visibility",
    "stored_depth",
    "soft_scatter",
    "scene_view_depth",
    "clamped_texel",
    "sample_target",
    "lit_position",
    "load_noise_volume",
    "load_scene_depth",
    "target_colour",
    "is_sphere",
    "is_volumetric",
    "sprite_thickness",
    "sprite_front",
    "sphere_corner",
    "reads_scene",
    "technique_fragment",
    "host_view_depth",
    "fade_before",
    "sprite_texel",
    "sphere_fragment",
    "volumetric_fragment",
    // Whole pictures of tests/suite/tiled.rs.
    "inclusive_sum",
    "packed_rect",
    "rects_meet",
    "front_to_back_bits",
    "ray_through_texel",
    "texel_of_ray",
    "texel_of_ndc",
    "place_in_square",
    "square_fills",
    "filled_cells",
    "cell_at",
    "is_filled",
    "is_filled_between",
    "bytes_below",
    "touches",
    "fragment_of",
    "digit_of",
    "low_of_bin",
    "list_fits",
    "bin_list",
    "tiles_along",
    "tested_view_depth",
    "shown_depth",
    "marks_of",
    "begun_texel",
    "with_sprite",
    "is_done",
    "write_texel",
    "is_inside",
    "sprite_number",
    "covers",
];

#[test]
fn no_function_is_left_out() {
    let formulas = formulas();
    for (file, text) in shader::sources() {
        let mut before = "";
        for line in text.lines() {
            // A pass's entry points.
            let is_entry_point = before.starts_with('@');
            before = line;
            let Some(name) = line.strip_prefix("fn ").and_then(|rest| rest.split('(').next()) else { continue };
            if is_entry_point {
                continue;
            }
            let tested = formulas.iter().any(|formula| formula.name == name && formula.file == *file);
            assert!(tested || INDIRECT.contains(&name), "{file}: {name} has no test against the reference");
        }
    }
    for name in INDIRECT {
        let is_there = |text: &str| text.contains(&format!("\nfn {name}("));
        assert!(shader::sources().iter().any(|(_, text)| is_there(text)), "{name} is no more");
    }
}
