//! Values from the papers, worked out by hand. Both renderers use `formula`, so an error there passes every comparison
//! of the two.

use haze::glam::{Vec2, Vec3, Vec4, Vec4Swizzles, vec2, vec3};
use haze_core::formula::diffuse_bake::{
    add_light, cube_coordinate, cube_direction, motif_normal, motif_position, spherical_harmonics, zonal_coefficients,
};
use haze_core::formula::lighting::{
    coverage, diffuse_coordinate, distance_attenuation, soft_scatter_weight, specular_scatter_fade,
};
use haze_core::formula::normal::{accumulation_from_normal, normal_from_accumulation, rotate_normal};
use haze_core::formula::soft_fade::{fade_contrast, fade_exponential, near_fade, soft_fade};
use haze_core::formula::technique::{density_amount, depth_sprite_depth, ray_sphere, spherical_billboard_amount};
use haze_core::formula::{color, depth};
use haze_core::settings::{FadeCurve, NormalDecode, NormalEncoding};
use haze_reference::blend_unit::premultiplied_over;

/// A few roundings of f32.
const ROUNDING: f32 = 1e-6;

#[track_caller]
fn assert_close(found: f32, expected: f32) {
    assert!((found - expected).abs() <= ROUNDING * expected.abs().max(1.0), "{found} is not {expected}");
}

#[track_caller]
fn assert_close_vector(found: Vec3, expected: Vec3) {
    assert!(found.distance(expected) <= 3.0 * ROUNDING, "{found} is not {expected}");
}

// OTEE

/// Accumulates layers of (normal, amount), each over those before.
fn accumulate(encoding: NormalEncoding, layers: &[(Vec3, f32)]) -> Vec4 {
    let over = |target, &(normal, amount): &(Vec3, f32)| {
        premultiplied_over(accumulation_from_normal(encoding, normal, amount, 1.0), target)
    };
    layers.iter().fold(Vec4::ZERO, over)
}

#[test]
fn amounts_add_like_opacities() {
    // 1 - 0.5 · 0.5 · 0.5 · 0.5.
    let four = accumulate(NormalEncoding::Signed, &[(Vec3::Z, 0.5); 4]);
    assert_close(four.w, 0.9375);
    // "RGB is still blended": the last layer counts half, the one below it a quarter.
    let two = accumulate(NormalEncoding::Signed, &[(Vec3::X, 0.5), (Vec3::Y, 0.5)]);
    assert_close_vector(two.xyz(), vec3(0.25, 0.5, 0.0));
    assert_close(two.w, 0.75);
}

#[test]
fn normals_survive_accumulation_and_decoding() {
    let normal = Vec3::ONE.normalize();
    let decode = |decode, layers: &[(Vec3, f32)]| {
        let accumulated = accumulate(NormalEncoding::Biased, layers);
        normal_from_accumulation(NormalEncoding::Biased, decode, accumulated.xyz(), accumulated.w)
    };
    assert_close_vector(decode(NormalDecode::Exact, &[(normal, 0.125)]), normal);
    assert_close_vector(decode(NormalDecode::Exact, &[(normal, 0.5); 4]), normal);
    // The talk's literal decode is right for opaque smoke, and reversed for half of it: (0.789 · 0.5) · 2 - 1 is
    // negative.
    assert_close_vector(decode(NormalDecode::Literal, &[(normal, 1.0)]), normal);
    assert_close_vector(decode(NormalDecode::Literal, &[(normal, 0.5)]), -normal);
    // A quarter turn counter-clockwise turns a normal that leans right into one that leans up.
    assert_close_vector(rotate_normal(vec3(0.6, 0.0, 0.8), Vec2::Y), vec3(0.0, 0.6, 0.8));
}

#[test]
fn diffuse_coordinate_runs_from_behind_to_in_front() {
    for (to_light, position) in
        [(Vec3::NEG_Z, 0.0), (Vec3::X, 0.5), (vec3(0.0, 0.75_f32.sqrt(), 0.5), 0.75), (Vec3::Z, 1.0)]
    {
        assert_close(diffuse_coordinate(Vec3::Z, to_light), position);
    }
}

#[test]
fn soft_scatter_weight_is_a_smoothstep_of_the_amount() {
    // smoothstep(0.2, 0.2 + 0.4, A): x²(3 - 2x) at 0, ¼, ½, ¾ and 1.
    for (amount, weight) in [(0.1, 0.0), (0.2, 0.0), (0.3, 0.15625), (0.4, 0.5), (0.5, 0.84375), (0.6, 1.0), (0.9, 1.0)]
    {
        assert_close(soft_scatter_weight(amount, 0.2, 0.4), weight);
    }
}

#[test]
fn coverage_is_the_amount_times_the_boost() {
    assert_close(coverage(0.2, 3.0), 0.6);
    assert_close(coverage(0.5, 3.0), 1.0);
}

#[test]
fn specular_scatter_fades_while_the_light_passes_through_the_box() {
    for (light, fade) in [(3.0, 0.0), (4.0, 0.0), (5.0, 0.25), (8.0, 1.0), (9.0, 1.0)] {
        assert_close(specular_scatter_fade(light, 4.0, 8.0), fade);
    }
}

// NV and BLOG

#[test]
fn the_linear_fade_is_the_scaled_difference() {
    let fade = |distance| soft_fade(FadeCurve::Linear, distance, 2.0, 1.0, 0.0);
    for (distance, expected) in [(-0.1, 0.0), (0.0, 0.0), (0.125, 0.25), (0.5, 1.0), (3.0, 1.0)] {
        assert_close(fade(distance), expected);
    }
    // Below epsilon the fragment is discarded.
    assert_close(soft_fade(FadeCurve::Linear, 0.125, 2.0, 1.0, 0.126), 0.0);
}

#[test]
fn the_contrast_fade_is_as_printed() {
    // Output = 0.5*pow(saturate(2*((Input > 0.5) ? 1-Input : Input)), ContrastPower);
    // Output = (Input > 0.5) ? 1-Output : Output;
    for (x, power, expected) in
        [(0.25, 1.0, 0.25), (0.25, 2.0, 0.125), (0.25, 3.0, 0.0625), (0.75, 2.0, 0.875), (0.125, 0.5, 0.25)]
    {
        assert_close(fade_contrast(x, power), expected);
    }
    for power in [0.1, 0.5, 1.0, 1.5, 2.0, 4.0, 16.0] {
        assert_close(fade_contrast(0.0, power), 0.0);
        assert_close(fade_contrast(0.5, power), 0.5);
        assert_close(fade_contrast(1.0, power), 1.0);
        let mut before = 0.0;
        for step in 0..=100_i16 {
            let x = f32::from(step) / 100.0;
            let fade = fade_contrast(x, power);
            // "Symmetric at the central point (0.5, 0.5)", and monotonic.
            assert_close(fade + fade_contrast(1.0 - x, power), 1.0);
            assert!(fade >= before, "{fade} at {x} after {before}, power {power}");
            before = fade;
        }
    }
}

#[test]
fn the_exponential_fade_is_not_symmetric_and_ends_short() {
    // 1 - 2^(-2 · (2x)^c): ¾ in the middle for every c, 15/16 at the end for c = 1, 255/256 for c = 2.
    for power in [0.5, 1.0, 2.0, 8.0] {
        assert_close(fade_exponential(0.0, power), 0.0);
        assert_close(fade_exponential(0.5, power), 0.75);
    }
    assert_close(fade_exponential(0.25, 1.0), 0.5);
    assert_close(fade_exponential(1.0, 1.0), 0.9375);
    assert_close(fade_exponential(1.0, 2.0), 255.0 / 256.0);
}

#[test]
fn the_always_fade_ends_behind_the_surface() {
    // 1 - saturate(softness · (sprite - scene)).
    let fade = |distance| soft_fade(FadeCurve::Always, distance, 2.0, 1.0, 0.0);
    for (distance, expected) in [(1.0, 1.0), (0.0, 1.0), (-0.25, 0.5), (-0.5, 0.0), (-2.0, 0.0)] {
        assert_close(fade(distance), expected);
    }
}

#[test]
fn view_depth_inverts_the_projection() {
    let coefficients = |near, far, reversed, orthographic| {
        depth::depth_coefficients(&depth::DepthConvention { near, far, reversed, orthographic })
    };
    // NV's projection writes f(z - n) / ((f - n)z). NV prints z = fn / (f - zbuf(f + n)), which is negative at the far
    // plane, zbuf = 1.
    let standard = coefficients(1.0, 10.0, false, false);
    for z in [1.0, 2.0, 4.0, 10.0] {
        assert_close(depth::view_depth_from_ndc_depth(10.0 * (z - 1.0) / (9.0 * z), standard), z);
    }
    assert_close(depth::view_depth_from_ndc_depth(0.25, coefficients(0.5, f32::INFINITY, true, false)), 2.0);
    assert_close(depth::view_depth_from_ndc_depth(0.25, coefficients(2.0, 10.0, false, true)), 4.0);
    assert_close(depth::view_depth_from_ndc_depth(0.25, coefficients(2.0, 10.0, true, true)), 8.0);
}

#[test]
fn sprites_near_the_camera_fade() {
    // A smoothstep between the two distances.
    for (view_depth, fade) in [(0.5, 0.0), (1.0, 0.0), (1.5, 0.15625), (2.0, 0.5), (3.0, 1.0), (9.0, 1.0)] {
        assert_close(near_fade(view_depth, 1.0, 3.0), fade);
    }
}

#[test]
fn volume_amounts_follow_the_beer_lambert_law() {
    // Spherical billboards: 1 - exp(-ρ (1 - d/r) Δs). A density of ln 2 over one metre lets half the light through.
    assert_close(spherical_billboard_amount(std::f32::consts::LN_2, 0.0, 1.0, 1.0), 0.5);
    assert_close(spherical_billboard_amount(std::f32::consts::LN_2, 0.5, 1.0, 2.0), 0.5);
    assert_close(spherical_billboard_amount(5.0, 1.0, 1.0, 1.0), 0.0);
    assert_close(density_amount(std::f32::consts::LN_2, 2.0), 0.75);
}

// MS

#[test]
fn ray_sphere_gives_entry_exit_and_distance() {
    // Entry, exit, and distance of the ray from the center.
    let ahead = |center, near, scene| {
        let found = ray_sphere(Vec3::ZERO, Vec3::NEG_Z, center, 1.0, near, scene);
        vec3(found.enter, found.leave, found.axis.length())
    };
    let deep = vec3(0.0, 0.0, -5.0);
    assert_close_vector(ahead(deep, 0.0, 100.0), vec3(4.0, 6.0, 0.0));
    // At 0.6 from the axis, the chord is 2 · 0.8.
    assert_close_vector(ahead(deep + vec3(0.6, 0.0, 0.0), 0.0, 100.0), vec3(4.2, 5.8, 0.6));
    // The exit is clamped to the scene's depth ("the rear exit point"), the entry to the near plane.
    assert_close_vector(ahead(deep, 4.5, 5.5), vec3(4.5, 5.5, 0.0));
    // A texel that stands out by half a radius is nearer by half a radius.
    assert_close(depth_sprite_depth(5.0, 0.5, 2.0), 4.0);
}

// light

#[test]
fn point_lights_fall_off_with_the_square_of_the_distance() {
    assert_close(distance_attenuation(4.0, 0.0, 0.0), 0.25);
    // At half its range, a light is multiplied by (1 - 1/16)²; at its range it is 0.
    assert_close(distance_attenuation(4.0, 0.25, 0.0), 0.25 * 0.878_906_25);
    assert_close(distance_attenuation(16.0, 0.25, 0.0), 0.0);
}

#[test]
fn cube_coordinate_inverts_cube_direction() {
    let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    for (face, axis) in (0..).zip(axes) {
        assert_eq!(cube_direction(face, Vec2::ZERO), axis);
        for position in [Vec2::ZERO, vec2(0.3, -0.7), vec2(-0.9, 0.2), vec2(0.99, 0.98)] {
            // The length of the direction does not matter.
            let found = cube_coordinate(cube_direction(face, position) * 7.5);
            assert_eq!(found.face, face, "{position} of {axis}");
            assert!(found.position.distance(position) < ROUNDING, "{position} of {axis}");
        }
    }
}

#[test]
fn motif_position_inverts_motif_normal() {
    assert_close_vector(motif_normal(Vec2::ZERO), Vec3::Z);
    assert_close_vector(motif_normal(vec2(0.6, 0.0)), vec3(0.6, 0.0, 0.8));
    assert_close_vector(motif_normal(vec2(3.0, 4.0)), vec3(0.6, 0.8, 0.0));
    assert_eq!(motif_position(vec3(0.6, 0.0, 0.8)), vec2(0.6, 0.0));
}

#[test]
fn spherical_harmonics_match_published_values() {
    // Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps", 2001, eq. 8: the clamped cosine
    // has A = π, 2π/3 and π/4; a zonal coefficient is A_l · sqrt((2l + 1) / 4π).
    let lambert = zonal_coefficients(|cos| Vec3::splat(cos.max(0.0)));
    for (found, expected) in lambert.into_iter().zip([0.886_227, 1.023_327, 0.495_416]) {
        // A sum of 256 steps.
        assert!((found.x - expected).abs() < 1e-4, "{found} is not {expected}");
    }
    // Constant light stays constant.
    let mut even = [Vec4::ZERO; 9];
    add_light(&mut even, &zonal_coefficients(|_| Vec3::ONE), vec3(0.6, 0.0, 0.8), vec3(1.0, 0.5, 0.25));
    for normal in [Vec3::X, Vec3::NEG_Y, vec3(0.48, 0.64, -0.6)] {
        assert!(spherical_harmonics(&even, normal).distance(vec3(1.0, 0.5, 0.25)) < 1e-4);
    }
}

// color

#[test]
fn srgb_matches_the_standard() {
    // IEC 61966-2-1.
    for (linear, encoded) in [(0.0, 0.0), (0.001, 0.012_92), (0.214_041, 0.5), (0.5, 0.735_357), (1.0, 1.0)] {
        assert_close(color::srgb_from_linear(linear), encoded);
        assert_close(color::linear_from_srgb(encoded), linear);
    }
}
