//! Writes clouds of smoke for a path tracer, and how every lighting model draws them; `scripts/truth` compares the two.
//!
//! `truth FOLDER SIZE SAMPLES [--sheets] MEDIUM…` writes to the folder, of clouds or of sheets of simulated smoke:
//! - `MEDIUM_CLOUD.vol`: densities, for Mitsuba,
//! - `MEDIUM_CLOUD_MODEL.f32`: the drawn cloud as little-endian floats, row by row from the top: premultiplied linear
//!   RGB under each light, then the coverage; the model `path_trace` is haze's own path tracer,
//! - `manifest.json`: media, lights, names of the files, milliseconds of a frame of each model.
//!
//! `SIZE`: side of images and volumes. `SAMPLES`: paths per pixel of six-way maps and of haze's path tracer.

use std::convert::Infallible;
use std::error::Error;
use std::fs;
use std::path::Path;

use glam::{UVec2, Vec3};
use haze::builtin;
use haze_author::path_trace::{MEDIA, Medium, PathTrace};
use haze_author::simulation::{SimRecipe, Simulation};
use haze_author::sprite::bake::{SheetLayout, SpriteRecipe};
use haze_core::assets::image::Image;
use haze_core::assets::ramp::Ramp;
use haze_core::formula::six_way::henyey_greenstein;
use haze_core::settings::RenderPath;
use haze_demo::headless::Headless;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::puff_cloud::{CloudShape, LightImages, PuffCloud, PuffKind, PuffMaterial, ring_of_lights};
use haze_demo::shot::Shot;
use serde_json::{Value, json};

/// Seed of the sprite: another puff than that which the ramps were fitted to.
const SPRITE_SEED: u32 = 4711;
/// Seeds of clouds. Shadow ramps were fitted to seeds 1 to 12.
const CLOUDS: [(&str, CloudShape, u32); 8] = [
    ("column_a", CloudShape::Column, 201),
    ("column_b", CloudShape::Column, 202),
    ("column_c", CloudShape::Column, 203),
    ("ball_a", CloudShape::Ball, 204),
    ("ball_b", CloudShape::Ball, 205),
    ("ball_of_eight", CloudShape::Ball, 206),
    ("layer_a", CloudShape::Layer, 207),
    ("layer_b", CloudShape::Layer, 208),
];
/// Number of puffs in `ball_of_eight`.
const FEW: usize = 8;

/// Simulations of sheets, and frames of each.
const SHEETS: [&str; 3] = ["puff", "mushroom", "ground_dust"];
const SHEET_FRAMES: u32 = 3;

/// Image size of the timed frame.
const FRAME: UVec2 = UVec2::new(1280, 720);
/// Number of timed frames of each model.
const FRAMES: usize = 9;
/// Number of frames of each model before them: pipelines are compiled and images uploaded in the first.
const WARM_UP: usize = 1;

/// Octaves, and what each multiplies the last one's light, optical depth and anisotropy by: 1/2 keeps energy, as the
/// light must not fall more slowly than the depth. (Wrenninge et al., "Oz: The Great and Volumetric", SIGGRAPH 2013)
const OCTAVES: (i32, f32) = (8, 0.5);

/// A lighting model by name.
type Model = (&'static str, PuffMaterial);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [folder, size, samples, media @ ..] = &arguments[..] else {
        return Err("usage: truth FOLDER SIZE SAMPLES [--sheets] MEDIUM…".into());
    };
    let (has_sheets, media) = match media {
        [first, media @ ..] if first == "--sheets" => (true, media),
        _ => (false, media),
    };
    let folder = Path::new(folder);
    let size = size.parse()?;
    let path_trace = PathTrace { size, samples: samples.parse()?, seed: 1 };
    fs::create_dir_all(folder)?;
    let lights = ring_of_lights();
    let mut clouds = Vec::new();
    let mut milliseconds = None;
    for name in media {
        let medium = MEDIA.iter().find(|medium| medium.name == name).ok_or_else(|| {
            let names: Vec<_> = MEDIA.iter().map(|medium| medium.name).collect();
            format!("{name}: no such medium; expected one of {}", names.join(", "))
        })?;
        let kinds =
            if has_sheets { sheets(&medium.medium, path_trace)? } else { vec![puffs(&medium.medium, path_trace)?] };
        for (sheet, kind) in &kinds {
            let models = models(kind, name, &medium.medium)?;
            let shown = if has_sheets { sheet_frames(sheet, kind) } else { puff_clouds(kind) };
            for (cloud_name, cloud) in shown {
                let volume = cloud.volume();
                let Ok(traced) = path_trace.run(&volume, &medium.medium, &lights, |_| Ok::<_, Infallible>(()));
                let mut drawn = vec![("path_trace", traced.light, traced.coverage)];
                for (model, material) in &models {
                    drawn.push((model, cloud.drawn(&lights, material)?, cloud.drawn_coverage(material)?));
                }
                let file = format!("{name}_{cloud_name}");
                fs::write(folder.join(&file).with_extension("vol"), volume.to_mitsuba())?;
                let Medium { albedo, anisotropy, density } = medium.medium;
                clouds.push(json!({
                    "medium": name,
                    "name": cloud_name,
                    "albedo": albedo.to_array(),
                    "g": anisotropy,
                    "density": density,
                    "volume": format!("{file}.vol"),
                    "drawn": write_images(folder, &file, &drawn)?,
                }));
                eprintln!("{name}: drew {cloud_name}");
            }
            if milliseconds.is_none() {
                milliseconds = Some(time_frames(&models).unwrap_or_else(|error| json!({ "error": error.to_string() })));
            }
        }
    }
    let lights: Vec<_> = lights.iter().map(Vec3::to_array).collect();
    let manifest = json!({ "size": size, "lights": lights, "frame": milliseconds, "clouds": clouds });
    fs::write(folder.join("manifest.json"), serde_json::to_string_pretty(&manifest)?)?;
    Ok(())
}

/// Puffs of a built-in sprite.
fn puffs(medium: &Medium, path_trace: PathTrace) -> Result<(&'static str, PuffKind), Box<dyn Error>> {
    let recipe = SpriteRecipe::of_builtin(builtin::find(builtin::SPRITES, "billow").ok_or("no sprite billow")?)?;
    Ok(("billow", PuffKind::new(&SpriteRecipe { seed: SPRITE_SEED, ..recipe }, medium, path_trace)))
}

/// Flipbooks of simulated smoke.
fn sheets(medium: &Medium, path_trace: PathTrace) -> Result<Vec<(&'static str, PuffKind)>, Box<dyn Error>> {
    let sheet = |name: &'static str| {
        let builtin = builtin::find(builtin::SIMULATIONS, name).ok_or("no such simulation")?;
        let mut recipe = SimRecipe::of_built_in(builtin)?;
        recipe.sheet = SheetLayout { size: path_trace.size, columns: SHEET_FRAMES, rows: 1, tolerance: 0 };
        recipe.view.extinction = medium.density;
        let recording = Simulation::new(&recipe)?.finish();
        Ok((name, PuffKind::of_recording(recording, medium, path_trace)))
    };
    SHEETS.into_iter().map(sheet).collect()
}

/// The frames of a sheet, each alone.
fn sheet_frames<'a>(sheet: &str, kind: &'a PuffKind) -> Vec<(String, PuffCloud<'a>)> {
    (0..SHEET_FRAMES).map(|frame| (format!("{sheet}_{}", frame + 1), single(kind, frame as f32))).collect()
}

fn single(kind: &PuffKind, frame: f32) -> PuffCloud<'_> {
    let mut cloud = kind.single();
    cloud.particles[0].frame = frame;
    cloud
}

/// Ten volumes: two single puffs, three columns, three balls, two layers.
fn puff_clouds(kind: &PuffKind) -> Vec<(String, PuffCloud<'_>)> {
    let random = CLOUDS.map(|(name, shape, seed)| {
        let mut cloud = kind.cloud(shape, seed);
        if name == "ball_of_eight" {
            cloud.particles.truncate(FEW);
        }
        (name.to_owned(), cloud)
    });
    let singles = [("puff_a", 0.0), ("puff_b", 1.0)].map(|(name, frame)| (name.to_owned(), single(kind, frame)));
    singles.into_iter().chain(random).collect()
}

/// Lighting models by name.
fn models(kind: &PuffKind, name: &str, medium: &Medium) -> Result<Vec<Model>, Box<dyn Error>> {
    let ramp = |role: &str| {
        let name = format!("{role}_{name}");
        builtin::find(builtin::RAMPS, &name)
            .ok_or_else(|| format!("no ramp {name}"))?
            .ramp()
            .map_err(Box::<dyn Error>::from)
    };
    let [ramps, six_way] = kind.materials(&ramp("diffuse_traced")?, &ramp("backlight_traced")?)?;
    let mut forward = ramps.clone();
    forward.settings.path = RenderPath::Forward;
    let exponential = shadow_ramp(|depth, _| (-depth).exp());
    let octaves = octave_ramp(medium.anisotropy);
    Ok(vec![
        ("ramps_shadow", ramps.with_shadow(&ramp("shadow_traced")?)),
        ("six_way_shadow", six_way.with_shadow(&ramp("shadow_six_way")?)),
        ("ramps_exponential", ramps.with_shadow(&exponential)),
        ("six_way_exponential", six_way.with_shadow(&exponential)),
        ("ramps_octaves", ramps.with_shadow(&octaves)),
        ("six_way_octaves", six_way.with_shadow(&octaves)),
        ("ramps", ramps),
        ("six_way", six_way),
        ("forward", forward),
    ])
}

/// A shadow ramp of a function of the optical depth and of the cosine of the scattering angle.
fn shadow_ramp(value: impl Fn(f32, f32) -> f32) -> Ramp {
    let size = UVec2::new(512, 65);
    let at = |index: u32| {
        let x = (index % size.x) as f32 / (size.x - 1) as f32;
        let y = (index / size.x) as f32 / (size.y - 1) as f32;
        // Inverse of `shadow_position`.
        Vec3::splat(value(-(1.0 - x).max(1.0e-9).log2(), 2.0 * y - 1.0))
    };
    Ramp::from_linear(size, (0..size.x * size.y).map(at))
}

/// Multiple scattering by octaves: Σ aⁱ exp(−bⁱ τ) p(cⁱ g), relative to that at τ = 0. The smoke's own light, which the
/// ramp multiplies, has the phase function in it.
fn octave_ramp(anisotropy: f32) -> Ramp {
    let (count, half) = OCTAVES;
    let light = |depth: f32, cosine| {
        let octave = |index| {
            let fraction = half.powi(index);
            let g = anisotropy * fraction;
            fraction * (-depth * fraction).exp() * henyey_greenstein(cosine, g) * (1.0 - g * g)
        };
        (0..count).map(octave).sum::<f32>()
    };
    shadow_ramp(|depth, cosine| light(depth, cosine) / light(0.0, cosine))
}

/// Writes images and coverage of each model. Returns the names of the files by model.
fn write_images(folder: &Path, name: &str, drawn: &[(&str, LightImages, Image<f32>)]) -> Result<Value, Box<dyn Error>> {
    let mut names = serde_json::Map::new();
    for (model, lights, coverage) in drawn {
        let file = format!("{name}_{model}.f32");
        let colors = lights.iter().flat_map(|image| &image.texels).flat_map(Vec3::to_array);
        let bytes: Vec<_> = colors.chain(coverage.texels.iter().copied()).flat_map(f32::to_le_bytes).collect();
        fs::write(folder.join(&file), bytes)?;
        names.insert((*model).into(), file.into());
    }
    Ok(names.into())
}

/// Median milliseconds of a frame of the preset `column`, lit by each model. Models take turns, so that a busy machine
/// slows all of them; those that differ only in their ramps share a time.
fn time_frames(models: &[Model]) -> Result<Value, Box<dyn Error>> {
    let headless = Headless::new()?;
    let context = OffscreenContext::new(&headless.adapter, &headless.device, &headless.queue);
    let mut timed: Vec<(&PuffMaterial, OffscreenRenderer, Shot, Vec<f32>)> = Vec::new();
    for (_, material) in models {
        if timed.iter().all(|(other, ..)| other.settings != material.settings) {
            let mut shot = Shot::load("column", FRAME)?;
            let settings = &mut shot.preset.systems[0].settings;
            settings.path = material.settings.path;
            settings.lighting = material.settings.lighting;
            settings.diffuse = material.settings.diffuse;
            settings.shadow.strength = material.settings.shadow.strength;
            shot.materials[0] = material.assets.clone();
            timed.push((material, OffscreenRenderer::new(&context, false)?, shot, Vec::new()));
        }
    }
    for round in 0..WARM_UP + FRAMES {
        for (_, renderer, shot, times) in &mut timed {
            let time = renderer.draw(&headless, shot)?;
            if round >= WARM_UP {
                times.push(1000.0 * time.as_secs_f32());
            }
        }
    }
    let mut medians = serde_json::Map::new();
    for (model, material) in models {
        for (_, _, _, times) in timed.iter_mut().filter(|(other, ..)| other.settings == material.settings) {
            times.sort_by(f32::total_cmp);
            medians.insert((*model).into(), json!(times[FRAMES / 2]));
        }
    }
    Ok(json!({ "device": headless.description(), "size": FRAME.to_array(), "milliseconds": medians }))
}
