use glam::UVec3;
use proptest::prelude::*;

use super::phase::{phase_function, sample_scattered_direction};
use super::random::Random;
use super::*;

/// A ball with a soft surface.
fn ball(size: u32) -> DensityVolume {
    let mut volume = DensityVolume { size: UVec3::splat(size), densities: Vec::new() };
    for index in 0..size.pow(3) {
        let voxel = UVec3::new(index % size, index / size % size, index / (size * size));
        let r = volume.voxel_center(voxel).length();
        volume.densities.push(((1.0 - r / 0.95) / 0.4).clamp(0.0, 1.0));
    }
    volume
}

fn trace(volume: &DensityVolume, medium: Medium, lights: &[Vec3], samples: u32) -> PathTraceResult {
    let trace = PathTrace { size: 24, samples, seed: 1 };
    trace.run(volume, &medium, lights, |_| Ok::<_, ()>(())).unwrap()
}

#[test]
fn the_phase_function_is_normalised_and_sampled_with_its_mean_cosine() {
    for g in [-0.5, 0.0, 0.5, 0.9] {
        let steps = 20_000;
        let cos = |step: u32| (step as f32 + 0.5) / steps as f32 * 2.0 - 1.0;
        let ring = 4.0 * std::f32::consts::PI / steps as f32;
        let whole: f32 = (0..steps).map(|step| phase_function(cos(step), g) * ring).sum();
        let mut random = Random::new(UVec3::new(1, 2, 3));
        let along = Vec3::new(0.6, 0.0, 0.8);
        let mean =
            (0..20_000).map(|_| sample_scattered_direction(along, g, &mut random).dot(along)).sum::<f32>() / 20_000.0;
        assert!((whole - 1.0).abs() < 1e-3 && (mean - g).abs() < 0.02, "{g}: {whole}, {mean}");
    }
}

#[test]
fn thin_smoke_matches_single_scattering() {
    // Thin enough that light scatters once: coverage times albedo times phase function.
    let medium = Medium { albedo: Vec3::new(0.5, 0.25, 1.0), anisotropy: 0.4, density: 0.01 };
    let lights = [Vec3::Z, Vec3::X, Vec3::NEG_Z];
    let traced = trace(&ball(16), medium, &lights, 4);
    let coverage = traced.coverage.texels.iter().sum::<f32>() / 576.0;
    for (index, light) in lights.iter().enumerate() {
        let expected = medium.albedo * (coverage * phase_function(-light.z, 0.4) * std::f32::consts::PI);
        assert!(((traced.mean(index) - expected) / expected).abs().max_element() < 0.02, "{light}");
    }
}

#[test]
fn smoke_without_absorption_conserves_light() {
    // White furnace: under uniform light, smoke without absorption is as bright as the surroundings.
    let mut lights = Vec::new();
    for z in [-0.9_f32, -0.7, -0.5, -0.3, -0.1, 0.1, 0.3, 0.5, 0.7, 0.9] {
        for turn in 0..10 {
            let around = glam::Vec2::from_angle(turn as f32 * 0.628_318_5 + z * 3.0) * (1.0 - z * z).sqrt();
            lights.push(around.extend(z));
        }
    }
    let medium = Medium { albedo: Vec3::ONE, anisotropy: 0.0, density: 5.0 };
    let traced = trace(&ball(24), medium, &lights, 16);
    let coverage: f32 = traced.coverage.texels.iter().sum();
    // A uniform radiance of 1 equals 100 lights of irradiance 4π / 100. The traced lights have irradiance π each, so
    // scale by 4 / 100.
    let light: f32 = traced.light.iter().flat_map(|image| &image.texels).map(|light| light.y).sum();
    let fraction = light * 4.0 / 100.0 / coverage;
    assert!((fraction - 1.0).abs() < 0.02, "{fraction}");
}

#[test]
fn equal_seeds_give_equal_images_and_an_error_cancels_the_trace() {
    let medium = MEDIA[0].medium;
    let [first, again] = [2, 2].map(|samples| trace(&ball(12), medium, &[Vec3::Z, Vec3::X], samples));
    assert!(first == again);
    let path_trace = PathTrace { size: 8, samples: 4, seed: 1 };
    let stopped =
        path_trace.run(&ball(12), &medium, &[Vec3::Z], |sample| if sample < 2 { Ok(()) } else { Err(sample) });
    assert_eq!(stopped.unwrap_err(), 2);
}

#[test]
fn random_media_give_finite_light_that_grows_with_the_albedo() {
    let albedo = [0, 1, 2].map(|_| Medium::ALBEDO_RANGE);
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    let volume = ball(12);
    proptest!(config, |(albedo in albedo, anisotropy in Medium::ANISOTROPY_RANGE, density in Medium::DENSITY_RANGE)| {
        let medium = Medium { albedo: albedo.into(), anisotropy, density };
        let lights = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let trace = PathTrace { size: 8, samples: 4, seed: 1 };
        let traced = trace.run(&volume, &medium, &lights, |_| Ok::<_, ()>(())).unwrap();
        prop_assert!(traced.coverage.texels.iter().all(|coverage| (0.0..=1.0).contains(coverage)));
        for light in 0..lights.len() {
            let mean = traced.mean(light);
            prop_assert!(mean.is_finite() && mean.min_element() >= 0.0, "{}: {}", light, mean);
            // The channels share their paths.
            prop_assert_eq!(medium.albedo.x <= medium.albedo.y, mean.x <= mean.y, "{}: {}", light, mean);
        }
    });
}
