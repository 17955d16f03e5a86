//! Checks `Preset::no_effect_reason`: a field that it reports changes no image on either renderer, and every other field
//! changes one in some case.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path as File;
use std::sync::{Mutex, PoisonError};

use glam::{UVec2, Vec3, Vec4, vec3};
use haze::{Context, Light, LightKind, MaterialAssets};
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::particle_files;
use haze_author::particle_files::ParticleFrames;
use haze_author::preset::no_effect_reason;
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::settings::*;
use haze_preset::{AssetFolders, EndBehavior, ImageSource, MaterialSources, Preset, PresetSystem};

use crate::every_setting::{OTHER_DETAIL, OTHER_NOISE, OTHER_SIX_WAY, SettingMutator};
use crate::gpu::{gpu, is_opengl, is_tiled_available, shared_context};
use crate::test_host::Host;
use crate::test_scene::TestScene;

const SIZE: UVec2 = UVec2::new(48, 27);

/// Preset of one system and one light, with the textures and particle files of the system.
#[derive(Clone)]
struct PresetCase {
    preset: Preset,
    material: MaterialAssets,
    caches: Vec<Option<ParticleFrames>>,
}

/// Loads images. Most cases have the same ones: those of the first names are kept.
fn load(names: &MaterialSources, folder: &File) -> Result<MaterialAssets, Error> {
    static LOADED: Mutex<Vec<(MaterialSources, MaterialAssets)>> = Mutex::new(Vec::new());
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, assets)) = loaded.iter().find(|(of, _)| of == names) {
        return Ok(assets.clone());
    }
    let assets = names.load(ImageSource::folder(folder))?;
    if loaded.len() < 40 {
        loaded.push((names.clone(), assets.clone()));
    }
    Ok(assets)
}

impl PresetCase {
    fn new(folder: &File, change: fn(&mut PresetSystem, &mut Light)) -> Self {
        let mut system = PresetSystem::default();
        let emitter = &mut system.emitter;
        let settings = &mut system.settings;
        emitter.rate = 8.0;
        emitter.position = vec3(0.0, -1.5, -6.0);
        emitter.lifetime = 5.0;
        emitter.burst = 0.3;
        emitter.wind = vec3(0.1, 0.0, 0.0);
        settings.boost = 1.0;
        settings.specular_scatter.size = 300.0;
        settings.volumetric.noise_size = 1.5;
        // As coarse as the texels of a small image.
        settings.grain.tiles = 0.25;
        settings.grain.octaves = 1;
        // The near fade reaches into the smoke.
        settings.soft_fade.near_fade_end = 7.0;
        let mut light = Light { position: vec3(0.4, 0.3, -7.5), intensity: 8.0, ..Light::default() };
        light.direction = vec3(0.4, -0.1, 0.8);
        change(&mut system, &mut light);
        let material = load(&system.material, folder).unwrap();
        let preset = Preset { time: 6.3, lights: vec![light], systems: vec![system], ..Preset::default() };
        preset.validate().unwrap();
        let caches = particle_files::load_particle_files(&preset, folder, &AssetFolders::new(folder)).unwrap();
        Self { preset, material, caches }
    }

    fn scene(&self) -> TestScene {
        let mut scene = TestScene::new(SIZE);
        let system = &self.preset.systems[0];
        particle_files::particles(system, self.caches[0].as_ref(), self.preset.time, &mut scene.particles);
        scene.lights.clone_from(&self.preset.lights);
        scene.settings = system.settings;
        scene.time = self.preset.time;
        scene.material = self.material.clone();
        scene
    }

    /// Returns a copy in which field number `skip` has its alternative number `value`, the path of the field, and true
    /// if the field has further alternatives. The copy is `None` if the value is invalid together with the other
    /// fields. Returns `None` past the last field.
    #[allow(clippy::type_complexity, reason = "used once")]
    fn moved(&self, folder: &File, skip: usize, value: usize) -> Option<(Option<Self>, String, bool)> {
        let mut other = self.clone();
        let mut mover = SettingMutator { skip, value, ..SettingMutator::default() };
        other.preset.systems[0].visit(&mut mover);
        let mut path = "systems[0].";
        if mover.moved.is_none() {
            other.preset.lights[0].visit(&mut mover);
            path = "lights[0].";
        }
        let moved = mover.moved?;
        let path = format!("{path}{}", moved.split(' ').next().unwrap_or_default());
        if other.preset.systems[0].material != self.preset.systems[0].material {
            match load(&other.preset.systems[0].material, folder) {
                Ok(material) => other.material = material,
                Err(_) => return Some((None, path, mover.has_more)),
            }
        }
        let fits = other.preset.validate().is_ok();
        Some((fits.then_some(other), path, mover.has_more))
    }

    fn on_gpu(&self, context: &Context) -> Image<Vec4> {
        let scene = self.scene();
        let mut host = Host::with_context(gpu(), &scene, Some(context)).unwrap();
        host.draw(gpu(), &scene).unwrap();
        host.image(gpu()).unwrap()
    }
}

/// Changes to the preset of a case. Together the cases produce every reason of `no_effect_reason`.
const CASES: &[fn(&mut PresetSystem, &mut Light)] = &[
    |_, _| {},
    |s, _| {
        s.settings.accumulate.downscale = 1;
        s.settings.grain.erosion = 0.6;
        s.settings.grain.bump = 0.8;
    },
    |s, _| s.settings.accumulate.encoding = NormalEncoding::Biased,
    |s, _| s.settings.path = RenderPath::Forward,
    |s, _| (s.settings.path, s.settings.accumulate.opacity) = (RenderPath::Tiled, 1.0),
    |s, _| (s.settings.path, s.settings.sprite.age_color) = (RenderPath::Forward, 0.5),
    |s, l| (s.settings.accumulate.order, l.kind) = (BlendOrder::Weighted, LightKind::Directional),
    |s, l| {
        s.settings.accumulate.downscale = 1;
        s.settings.soft_fade.curve = FadeCurve::Contrast;
        l.kind = LightKind::Spot;
    },
    |s, _| (s.settings.accumulate.downscale, s.settings.soft_fade.curve) = (1, FadeCurve::Always),
    |s, _| (s.settings.accumulate.downscale, s.settings.technique) = (1, Technique::Hard),
    |s, _| (s.settings.accumulate.upsample, s.settings.technique) = (Upsample::Bilinear, Technique::Hard),
    |s, _| (s.settings.accumulate.max_side, s.settings.accumulate.downscale) = (16, 1),
    |s, _| {
        let accumulate = &mut s.settings.accumulate;
        accumulate.downscale = 1;
        accumulate.scale_mode = ScaleMode::Auto;
        accumulate.max_error = 0.1;
    },
    |s, _| (s.settings.accumulate.downscale, s.settings.accumulate.depth_source) = (1, DepthSource::Host),
    |s, _| s.settings.technique = Technique::Hard,
    |s, _| s.settings.technique = Technique::DepthSpriteHard,
    |s, _| (s.settings.technique, s.settings.debug.checkerboard) = (Technique::DepthSpriteSoft, true),
    |s, _| (s.settings.technique, s.settings.sprite.motion) = (Technique::SphericalBillboard, 0.5),
    |s, _| s.settings.technique = Technique::Density,
    |s, _| s.settings.technique = Technique::VolumetricHard,
    |s, _| (s.settings.technique, s.settings.debug.freeze_animation) = (Technique::VolumetricSoft, true),
    |s, _| (s.settings.technique, s.settings.volumetric.scroll_speed) = (Technique::VolumetricSoft, 0.0),
    |s, _| (s.settings.debug.checkerboard, s.settings.sprite.motion) = (true, 0.5),
    |s, _| s.settings.debug.freeze_animation = true,
    |s, _| (s.settings.sprite.animation, s.settings.sprite.motion) = (SpriteAnimation::Still, 0.5),
    |s, _| (s.settings.sprite.animation, s.settings.sprite.motion) = (SpriteAnimation::Volume, 0.5),
    |s, l| (s.settings.diffuse.mode, s.emitter.frame_rate, l.intensity) = (DiffuseMode::PaintedMotif, 0.0, 0.0),
    |s, _| (s.settings.diffuse.mode, s.settings.path) = (DiffuseMode::PaintedMotif, RenderPath::Forward),
    |s, _| (s.settings.soft_scatter.mode, s.settings.diffuse.intensity) = (SoftScatterMode::Ramp, 0.0),
    |s, _| (s.settings.soft_scatter.intensity, s.settings.specular_scatter.intensity) = (0.0, 0.0),
    |s, _| (s.settings.coverage, s.settings.ramp_filter) = (CoverageMode::Ramp, RampFilter::Nearest),
    |s, _| (s.settings.diffuse.mode, s.settings.specular_scatter.intensity) = (DiffuseMode::SphericalHarmonics, 0.0),
    |s, _| (s.settings.diffuse.backlight, s.material.backlight_ramp) = (Backlight::Ramp, "diffuse_ember".into()),
    |s, _| s.settings.shadow.strength = 1.0,
    |s, _| (s.settings.shadow.strength, s.settings.diffuse.mode) = (1.0, DiffuseMode::Cubemap),
    |s, _| (s.settings.ambient.intensity, s.settings.diffuse.mode) = (1.0, DiffuseMode::Cubemap),
    |s, _| (s.settings.ambient.intensity, s.settings.diffuse.mode) = (1.0, DiffuseMode::SphericalHarmonics),
    |s, _| {
        s.settings.ambient.intensity = 1.0;
        s.settings.shadow.strength = 0.8;
        s.settings.shadow.by_depth = true;
    },
    |s, _| s.settings.sprite.age_color = 0.5,
    |s, _| (s.settings.sprite.tint, s.emitter.other_tint) = (0.5, vec3(0.2, 0.7, 0.9)),
    |s, _| (s.settings.sprite.stretch, s.settings.path) = (3.0, RenderPath::Tiled),
    |s, _| (s.settings.sprite.stretch, s.settings.sprite.stretch_limit) = (3.0, 1.0),
    |s, _| s.settings.fire.intensity = 2.0,
    |s, _| (s.settings.fire.intensity, s.settings.fire.light) = (2.0, 0.0),
    |s, _| (s.settings.fire.intensity, s.settings.path) = (2.0, RenderPath::Forward),
    |s, _| (s.emitter.turbulence, s.emitter.extent, s.emitter.buoyancy) = (0.0, Vec3::ZERO, 0.0),
    |s, _| (s.emitter.bounce, s.emitter.buoyancy, s.emitter.floor) = (0.5, -2.0, s.emitter.position.y - 0.4),
    |s, _| (s.emitter.floor_margin, s.emitter.buoyancy, s.emitter.floor) = (0.5, -2.0, s.emitter.position.y - 0.4),
    |s, _| (s.emitter.obstacle_margin, s.emitter.obstacle) = (0.5, s.emitter.position + vec3(0.1, 0.8, 0.0)),
    |s, _| (s.emitter.ring_speed, s.emitter.attraction, s.emitter.small_fraction) = (1.0, 0.5, 0.4),
    |s, _| (s.emitter.duration, s.emitter.period) = (0.4, 0.5),
    |s, _| (s.material.sprite, s.material.detail) = ("own.png".into(), "own.png".into()),
    |s, _| {
        s.material.sprite = "own.png".into();
        s.material.detail = "own.png".into();
        s.settings.sprite.motion = 0.7;
    },
    |s, _| {
        s.material.sprite = "own.png".into();
        s.material.six_way = "six_way.png".into();
        s.settings.lighting = Lighting::SixWay;
    },
    |s, _| {
        s.material.sprite = "own.png".into();
        s.material.six_way = "six_way.png".into();
        s.settings.lighting = Lighting::SixWay;
        s.settings.path = RenderPath::Forward;
        s.settings.specular_scatter.intensity = 0.0;
    },
    // Particle files, at a time between two frames and past the end.
    |s, _| {
        s.particle_files.path = PARTICLES.into();
        s.particle_files.position = vec3(0.0, -0.5, -6.0);
        s.particle_files.fps = 3.0;
        s.particle_files.after = EndBehavior::Loop;
        // Large enough that the sampled mip level of the detail map still contains motion.
        s.settings.sprite.size = 4.0;
    },
];

/// Particle files, one per frame, without columns for radius and amount.
const PARTICLES: &str = "particles_##.csv";

/// Fields whose alternatives give the same image wherever both can be drawn, with the reason.
const SAME: [&str; 10] = [
    // There is one system; a test of presets draws two.
    "systems[0].settings.sort_priority",
    // Names the light for people and tools.
    "lights[0].role",
    // These images have one light.
    "systems[0].settings.shadow.lights",
    // Shades the scene, which these images do not have.
    "systems[0].settings.shadow.scene",
    // A light that the host adds to its own.
    "systems[0].settings.fire.light",
    "systems[0].settings.fire.flicker",
    // At scale 1 the reduced depth equals the host's.
    "systems[0].settings.accumulate.depth_source",
    // The layers that are skipped are invisible.
    "systems[0].settings.accumulate.layers",
    // Flipbook frames are square, so neither can change without the other.
    "systems[0].material.columns",
    "systems[0].material.rows",
];

/// Fields that have no effect in some case although `no_effect_reason` does not report them: the effect depends on more
/// than settings, or on the size of the change.
const NOT_ALWAYS: [&str; 34] = [
    // `multiply` is `alpha` where smoke is deferred.
    "systems[0].settings.blend_mode",
    "lights[0].role",
    // Particles may be white, and those of files may rest.
    "systems[0].settings.sprite.tint",
    "systems[0].settings.sprite.stretch",
    // The smoke may not come near.
    "systems[0].emitter.obstacle_margin",
    // No particle may be so fast.
    "systems[0].settings.sprite.stretch_limit",
    // There may be fewer lights.
    "systems[0].settings.shadow.lights",
    // A directional light is the same at every depth.
    "systems[0].settings.shadow.by_depth",
    // As in `SAME`.
    "systems[0].settings.shadow.scene",
    "systems[0].settings.fire.light",
    "systems[0].settings.fire.flicker",
    // The layers that are skipped are invisible.
    "systems[0].settings.accumulate.layers",
    // The light is hidden, or lights nothing.
    "lights[0].kind",
    "lights[0].radius",
    "lights[0].specular_scatter",
    "systems[0].material.specular_ramp",
    "systems[0].settings.specular_scatter.falloff",
    "systems[0].settings.specular_scatter.intensity",
    "systems[0].settings.specular_scatter.size",
    // Without diffuse light nothing reads normals or six-way maps; an artist may change these settings all the same.
    "systems[0].settings.lighting",
    "systems[0].settings.accumulate.decode",
    "systems[0].settings.accumulate.encoding",
    "systems[0].settings.grain.bump",
    // Particles of files may be of age 0.
    "systems[0].settings.grain.dissolve",
    // A small max_side determines the scale; in so few texels the reduced depth may or may not contain the post.
    "systems[0].settings.accumulate.depth_downsample",
    "systems[0].settings.accumulate.max_side",
    "systems[0].settings.accumulate.downscale",
    // The same scale may be chosen.
    "systems[0].settings.accumulate.scale_mode",
    "systems[0].settings.accumulate.max_error",
    // Some alternatives give the same image: `auto` chooses `raster` and `target`, and `soft_linear` and `host` read the
    // same depth.
    "systems[0].settings.accumulate.lighting_resolution",
    "systems[0].settings.path",
    "systems[0].settings.technique",
    "systems[0].settings.accumulate.depth_source",
    // Epsilon is smaller than the fade distance.
    "systems[0].settings.soft_fade.epsilon",
];

/// Tolerance for pipelines with other constants, which may be compiled differently: two steps of a half float at 1.
const ROUNDING: f32 = 2.0 / 1024.0;

/// Writes the images and particle files that the cases load.
fn write_input_files(folder: &File) {
    for (name, lean) in [("own.png", 40), (OTHER_DETAIL, 90)] {
        let image = image::RgbaImage::from_fn(32, 32, |x, y| {
            let inside = 255 - (2 * (x.abs_diff(16).pow(2) + y.abs_diff(12).pow(2))).min(255) as u8;
            image::Rgba([128 + lean, 200 - lean, 220 - x as u8, inside])
        });
        image.save(folder.join(name)).unwrap();
    }
    for (name, lean) in [("six_way.png", 40), (OTHER_SIX_WAY, 90)] {
        let image = image::RgbaImage::from_fn(32, 64, |x, y| {
            let inside = 255 - (2 * (x.abs_diff(16).pow(2) + (y % 32).abs_diff(12).pow(2))).min(255) as u8;
            image::Rgba([128 + lean, 200 - lean, 120 - y as u8, inside])
        });
        image.save(folder.join(name)).unwrap();
    }
    for frame in 0..4 {
        let particle = |id: i32| {
            format!("{id},{},{},{}\n", 0.3 * id as f32 + 0.1 * frame as f32, 0.2 * id as f32, 0.1 * id as f32)
        };
        let text = "id,x,y,z\n".to_owned() + &(-2..4 - frame).map(particle).collect::<String>();
        std::fs::write(folder.join(format!("particles_{frame:02}.csv")), text).unwrap();
    }
    let noise = NoiseRecipe { version: 1, seed: 3, size: 16, cells: 2, octaves: 3, gain: 0.5 };
    noise.bake().unwrap().save(folder.join(OTHER_NOISE)).unwrap();
}

#[test]
fn settings_without_effect_are_exactly_those_that_change_no_image() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_input_files(folder);
    let context = shared_context();
    let mut reasons = BTreeSet::new();
    let mut with_effect = BTreeSet::new();
    let mut all = BTreeSet::new();
    let mut compared = BTreeSet::new();
    let mut has_skipped = false;
    let mut wrong = BTreeSet::new();
    let mut unreported = BTreeMap::<String, Vec<usize>>::new();
    for (index, change) in CASES.iter().enumerate() {
        let preset_case = PresetCase::new(folder, *change);
        let settings = &preset_case.preset.systems[0].settings;
        // These images have no linear depth, with which OpenGL could test sprites.
        let tests_host_depth = settings.accumulate.depth_source == DepthSource::Host && is_opengl();
        if tests_host_depth || settings.path == RenderPath::Tiled && !is_tiled_available() {
            has_skipped = true;
            continue;
        }
        let plain = preset_case.scene().on_cpu();
        let mut on_gpu = None;
        let mut skip = 0;
        let mut value = 0;
        while let Some((moved, path, has_more)) = preset_case.moved(folder, skip, value) {
            (skip, value) = if has_more { (skip, value + 1) } else { (skip + 1, 0) };
            all.insert(path.clone());
            let reason = no_effect_reason(&preset_case.preset, &path, SIZE);
            reasons.extend(reason);
            // Another case has shown the effect, and there need not be one in this.
            if reason.is_none() && NOT_ALWAYS.contains(&path.as_str()) && with_effect.contains(&path) {
                continue;
            }
            // Some values are invalid together with others.
            let on_cpu = moved.as_ref().and_then(|moved| moved.scene().try_on_cpu().ok());
            let Some((moved, on_cpu)) = moved.zip(on_cpu) else { continue };
            let is_moved = on_cpu != plain;
            let Some(reason) = reason else {
                if is_moved {
                    with_effect.insert(path);
                } else {
                    unreported.entry(path).or_default().push(index);
                }
                continue;
            };
            if is_moved {
                wrong.insert(format!("{path} has an effect in case {index}; no_effect_reason says: {reason}"));
            } else if compared.insert((reason, path.clone())) {
                let plain = on_gpu.get_or_insert_with(|| preset_case.on_gpu(&context));
                let moved = moved.on_gpu(&context);
                let differences = plain.texels.iter().zip(&moved.texels).map(|(a, b)| (a - b).abs().max_element());
                let most = differences.fold(0.0, f32::max);
                if most > ROUNDING {
                    wrong.insert(format!(
                        "{path} changes the GPU's image by {most} in case {index}; no_effect_reason says: {reason}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let never_with_effect: Vec<_> =
        all.iter().filter(|path| !with_effect.contains(*path) && !SAME.contains(&path.as_str())).collect();
    assert!(has_skipped || never_with_effect.is_empty(), "fields without any effect: {never_with_effect:?}");
    assert!(
        unreported.keys().all(|path| NOT_ALWAYS.contains(&path.as_str())),
        "no effect in these cases: {unreported:?}"
    );
    // All reasons except the one about the demo scene.
    assert!(has_skipped || reasons.len() == 68, "{reasons:#?}");
}

#[test]
fn lamp_and_brazier_have_an_effect_only_in_the_yard_scene() {
    use haze_demo::shot::Shot;
    use haze_preset::SceneName;

    use crate::presets::render_on_gpu;

    let mut shot = Shot::load("column", SIZE).unwrap();
    let images = |shot: &Shot| (shot.render_on_cpu().unwrap(), render_on_gpu(shot, true));
    for &scene in SceneName::ALL {
        shot.preset.environment.scene = scene;
        let plain = images(&shot);
        for field in ["environment.lamp", "environment.brazier"] {
            let mut other = shot.clone();
            set_field(&mut other.preset, field, "false").unwrap();
            let is_told = no_effect_reason(&shot.preset, field, SIZE).is_some();
            assert_eq!(is_told, scene != SceneName::Yard, "{field}");
            let moved = images(&other);
            assert_eq!(is_told, moved.0 == plain.0, "{field} {}", scene.name());
            assert_eq!(is_told, moved.1 == plain.1, "{field} {}", scene.name());
        }
    }
}
