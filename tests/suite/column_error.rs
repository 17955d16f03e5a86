//! Compares a column of many puffs, lit by ramps or by six-way maps, with a path trace of their summed densities, and
//! measures how much of the error comes from puffs that do not shadow each other.

use std::convert::Infallible;
use std::path::Path;

use glam::{UVec2, Vec2, Vec3, vec3};
use haze_author::path_trace::{MEDIA, Medium, PathTrace};
use haze_author::ramp::response::{LightResponse, Response};
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::assets::image::Image;
use haze_core::assets::ramp::Ramp;
use haze_demo::puff_cloud::{CloudShape, LIGHTS, LightImages, PuffCloud, PuffKind, PuffMaterial, ring_of_lights};
use haze_preset::builtin;

/// Seed of the columns.
const COLUMN: u32 = 7;

/// Every puff path-traced separately, composited back to front. Correct, except that puffs neither shadow nor light
/// each other.
fn puffs_alone(cloud: &PuffCloud<'_>, kind: &PuffKind, medium: &Medium, path_trace: PathTrace) -> LightImages {
    let single = PathTrace { size: path_trace.size / 2, ..path_trace };
    let trace = |frame| {
        let Ok(traced) = single.run(kind.puff(frame), medium, &ring_of_lights(), |_| Ok::<_, Infallible>(()));
        traced
    };
    let puffs = [0, 1].map(trace);
    let mut sorted: Vec<_> = cloud.particles.iter().collect();
    sorted.sort_by(|a, b| a.position.z.total_cmp(&b.position.z));
    let of_light = |light: usize| {
        let mut image = Image::new(UVec2::splat(path_trace.size), Vec3::ZERO);
        let scale = 2.0 / path_trace.size as f32;
        image.for_each(|at, texel| {
            let position = ((at.as_vec2() + 0.5) * scale - 1.0) * Vec2::new(1.0, -1.0);
            for puff in &sorted {
                let local = (position - puff.position.truncate()) / puff.radius;
                if local.abs().max_element() < 1.0 {
                    let traced = &puffs[puff.frame as usize];
                    let at = (local * Vec2::new(1.0, -1.0) + 1.0) * 0.5 * single.size as f32;
                    let at = at.as_ivec2();
                    *texel = *texel * (1.0 - traced.coverage.load(at)) + traced.light[light].load(at);
                }
            }
        });
        image
    };
    (0..LIGHTS).map(of_light).collect()
}

fn kind_of(medium: &str, path_trace: PathTrace) -> (Medium, PuffKind) {
    let medium = MEDIA.iter().find(|named| named.name == medium).unwrap().medium;
    let recipe = SpriteRecipe::of_builtin(builtin::find(builtin::SPRITES, "billow").unwrap()).unwrap();
    (medium, PuffKind::new(&recipe, &medium, path_trace))
}

fn built_in(role: &str, medium: &str) -> Ramp {
    builtin::find(builtin::RAMPS, &format!("{role}_traced_{medium}")).unwrap().ramp().unwrap()
}

/// Materials with the ramps fitted to a medium, and with six-way maps of that medium.
fn materials(kind: &PuffKind, medium: &str) -> [PuffMaterial; 2] {
    kind.materials(&built_in("diffuse", medium), &built_in("backlight", medium)).unwrap()
}

/// Brightness under each light relative to the first, rounded to 0.01.
fn relative_brightness(lights: &[LightResponse]) -> Vec<f32> {
    lights.iter().map(|light| (light.shown / lights[0].shown * 100.0).round() / 100.0).collect()
}

/// Prints how far ramps, six-way maps and puffs alone are from the path trace, and six-way maps from puffs alone;
/// returns the four responses in that order.
fn compare_medium(medium: &str, size: u32, samples: u32) -> [Response; 4] {
    let path_trace = PathTrace { size, samples, seed: 1 };
    let (traced, kind) = kind_of(medium, path_trace);
    let column = kind.cloud(CloudShape::Column, COLUMN);
    let truth = column.truth(&ring_of_lights());
    let alone = puffs_alone(&column, &kind, &traced, path_trace);
    let [ramps, six_way] = materials(&kind, medium).map(|material| column.drawn(&ring_of_lights(), &material).unwrap());
    if let Some(folder) = std::env::var_os("HAZE_LOOK") {
        save(Path::new(&folder), medium, &[&truth, &alone, &ramps, &six_way]);
    }
    let all = [
        ("truth", &truth, &truth),
        ("ramps", &ramps, &truth),
        ("six-way", &six_way, &truth),
        ("puffs alone", &alone, &truth),
        ("six-way against puffs alone", &six_way, &alone),
    ];
    let [_, responses @ ..] = all.map(|(what, shown, truth)| {
        let response = Response::new(shown, truth);
        let Response { error, pixel_error, lights, .. } = &response;
        println!(
            "{medium}: {what} {:.1} %, pixels {:.0} %, by angle {:?}",
            100.0 * error,
            100.0 * pixel_error,
            relative_brightness(lights)
        );
        response
    });
    responses
}

/// Writes a comparison image. Rows: truth, puffs alone, ramps, six-way; each exposed to match the truth. One column
/// per light.
fn save(folder: &Path, medium: &str, rows: &[&LightImages]) {
    let side = rows[0][0].size.x;
    let white = 1.3 * rows[0].iter().flat_map(|image| &image.texels).fold(0.0, |most: f32, texel| most.max(texel.x));
    let exposures: Vec<_> = rows.iter().map(|row| Response::new(row, rows[0]).exposure).collect();
    let image = image::RgbImage::from_fn(side * LIGHTS as u32, side * rows.len() as u32, |x, y| {
        let row = rows[(y / side) as usize];
        let exposure = exposures[(y / side) as usize];
        let texel = row[(x / side) as usize].load(UVec2::new(x % side, y % side).as_ivec2()) * exposure / white;
        let code = texel.to_array().map(|light| haze_core::formula::color::srgb_from_linear(light.clamp(0.0, 1.0)));
        image::Rgb(code.map(|code| (code * 255.0).round() as u8))
    });
    let (width, height) = image.dimensions();
    let image = image::imageops::resize(&image, 2 * width, 2 * height, image::imageops::FilterType::CatmullRom);
    image.save(folder.join(format!("column_{medium}.png"))).unwrap();
}

#[test]
fn most_six_way_error_in_a_column_is_missing_shadowing_between_puffs() {
    let [_, six_way, alone, against_alone] = compare_medium("ash", 48, 12);
    assert!(
        six_way.error > against_alone.error,
        "six-way {}, against puffs alone {}",
        six_way.error,
        against_alone.error
    );
    assert!(
        alone.pixel_error > 0.5 * six_way.pixel_error,
        "puffs alone {}, six-way {}",
        alone.pixel_error,
        six_way.pixel_error
    );
}

/// Clouds on which the built-in shadow ramps were not fitted: other seeds.
const CLOUDS: [(CloudShape, u32); 3] = [(CloudShape::Column, 101), (CloudShape::Ball, 102), (CloudShape::Layer, 103)];

/// Errors of ramps and six-way maps, each without shadow and with the built-in shadow ramp of the medium, for each of
/// [`CLOUDS`].
fn shadow_errors(medium: &str, size: u32, samples: u32) -> [[[Response; 2]; 2]; 3] {
    let (_, kind) = kind_of(medium, PathTrace { size, samples, seed: 1 });
    let materials = materials(&kind, medium);
    let shadows = ["shadow_traced", "shadow_six_way"];
    let shadows =
        shadows.map(|name| builtin::find(builtin::RAMPS, &format!("{name}_{medium}")).unwrap().ramp().unwrap());
    CLOUDS.map(|(shape, seed)| {
        let cloud = kind.cloud(shape, seed);
        let truth = cloud.truth(&ring_of_lights());
        let mut line = format!("{medium}, {}:", shape.name());
        let responses = [0, 1].map(|by| {
            let material = &materials[by];
            [material.clone(), material.with_shadow(&shadows[by])].map(|material| {
                let response = Response::new(&cloud.drawn(&ring_of_lights(), &material).unwrap(), &truth);
                line += &format!(" {:.1} % / {:.0} %", 100.0 * response.error, 100.0 * response.pixel_error);
                response
            })
        });
        println!("{line}");
        responses
    })
}

#[test]
fn shadow_ramps_bring_clouds_close_to_the_path_trace() {
    let clouds = shadow_errors("ash", 48, 12);
    // Ramps, and six-way maps: the largest mean of the three clouds. Measured: 7 % each, and 4 to 10 % for single clouds.
    for (by, most) in [(0, 0.10), (1, 0.09)] {
        let mean = clouds.iter().map(|responses| responses[by][1].error / 3.0).sum::<f32>();
        assert!(mean < most, "{by}: {mean}");
        for [plain, shaded] in clouds.each_ref().map(|responses| responses[by].each_ref()) {
            assert!(shaded.error < 0.8 * plain.error, "{by}: {}, without shadow {}", shaded.error, plain.error);
            assert!(shaded.pixel_error < plain.pixel_error, "{by}: {} {}", shaded.pixel_error, plain.pixel_error);
        }
    }
}

/// Mean error of the light that falls through clouds of a medium onto the ground, and its mean shadow: fractions of full
/// light, for suns from above and from the side.
fn ground_errors(kind: &PuffKind, medium: &str) -> Vec<(f32, f32)> {
    let neutral = builtin::find(builtin::RAMPS, "shadow_neutral").unwrap().ramp().unwrap();
    let material = materials(kind, medium)[0].with_shadow(&neutral);
    let positions: Vec<_> = (0..48 * 48_u32)
        .map(|index| vec3((index % 48) as f32 / 16.0 - 1.5, -1.1, (index / 48) as f32 / 16.0 - 1.5))
        .collect();
    let under = |(shape, seed)| {
        let cloud = kind.cloud(shape, seed);
        let suns = [Vec3::Y, vec3(0.5, 1.0, 0.3).normalize()];
        suns.map(|sun| {
            let drawn = cloud.drawn_transmittance(&positions, sun, &material).unwrap();
            let mut error = 0.0;
            let mut shadow = 0.0;
            for (position, drawn) in positions.iter().zip(drawn) {
                let truth = cloud.transmittance(*position, sun);
                error += (drawn.y - truth).abs();
                shadow = shadow + 1.0 - truth;
            }
            (error / positions.len() as f32, shadow / positions.len() as f32)
        })
    };
    CLOUDS.into_iter().flat_map(under).collect()
}

#[test]
fn shadow_on_the_ground_is_close_to_that_of_all_densities() {
    let (_, kind) = kind_of("dust", PathTrace { size: 48, samples: 4, seed: 1 });
    for (error, shadow) in ground_errors(&kind, "dust") {
        println!("{:.1} % of full light, mean shadow {:.1} %", 100.0 * error, 100.0 * shadow);
        // Measured: 1 to 4 %, of shadows of 6 to 18 %.
        assert!(error < 0.05 && shadow > 0.05, "{error}, {shadow}");
    }
}

/// Prints the table of columns in docs/light.md. With `HAZE_LOOK=folder` it also writes a comparison image per medium.
#[test]
#[ignore = "takes some minutes"]
fn prints_column_errors_for_every_medium() {
    for named in MEDIA {
        compare_medium(named.name, 64, 48);
    }
}

/// Prints the errors by resolution in docs/shadow.md.
#[test]
#[ignore = "takes some minutes"]
fn prints_shadow_errors_by_resolution() {
    let (_, kind) = kind_of("ash", PathTrace { size: 64, samples: 48, seed: 1 });
    let materials = materials(&kind, "ash");
    let names = ["shadow_traced_ash", "shadow_six_way_ash"];
    let ramps = names.map(|name| builtin::find(builtin::RAMPS, name).unwrap().ramp().unwrap());
    let clouds = CLOUDS.map(|(shape, seed)| {
        let cloud = kind.cloud(shape, seed);
        let truth = cloud.truth(&ring_of_lights());
        (cloud, truth)
    });
    for resolution in [4, 8, 12, 16, 24, 32, 48, 64, 96] {
        let errors = [0, 1].map(|by| {
            let mut material = materials[by].with_shadow(&ramps[by]);
            material.settings.shadow.resolution = resolution;
            let errors = clouds.iter().map(|(cloud, truth)| {
                let drawn = cloud.drawn(&ring_of_lights(), &material).unwrap();
                let Response { error, pixel_error, .. } = Response::new(&drawn, truth);
                (error, pixel_error)
            });
            errors.fold((0.0, 0.0), |sum, (error, pixels)| (sum.0 + error / 3.0, sum.1 + pixels / 3.0))
        });
        println!(
            "{resolution} cells: normals {:.1} % / {:.0} %, six-way {:.1} % / {:.0} %",
            100.0 * errors[0].0,
            100.0 * errors[0].1,
            100.0 * errors[1].0,
            100.0 * errors[1].1
        );
    }
}
