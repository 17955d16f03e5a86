//! Changes every setting in turn: each must change the image, and both renderers must agree on the new image. A field
//! visitor finds the settings, so that a new one is tested automatically.

use std::ops::RangeInclusive;

use glam::{UVec2, Vec3, Vec4};
use haze_core::assets::image::Image;
use haze_core::settings::*;
use haze_preset::builtin;

use crate::gpu::gpu;
use crate::psnr::{MIN_PSNR, MIN_PSNR_WITH_STEPS, psnr};
use crate::test_scene::{DepthKind, TestScene};

const SIZE: UVec2 = UVec2::new(96, 54);

/// File of an alternative detail map.
pub const OTHER_DETAIL: &str = "other.png";
/// File of alternative six-way maps.
pub const OTHER_SIX_WAY: &str = "other.six_way.png";
/// File of an alternative noise; only one noise is built in.
pub const OTHER_NOISE: &str = "noise.png";

/// Field visitor that sets one field to one of its alternatives and records the path of the field.
#[derive(Default)]
pub struct SettingMutator {
    /// Number of fields to skip before the one to change.
    pub skip: usize,
    /// Number of the alternative, for fields that have several.
    pub value: usize,
    /// Names of the groups that enclose the visited field.
    pub path: Vec<&'static str>,
    /// RenderPath of the changed field, followed by the new value of a choice. `None` if no field was changed.
    pub moved: Option<String>,
    /// True if the field has further alternatives.
    pub has_more: bool,
}

impl SettingMutator {
    /// Returns true and records the path if this is the field to change; otherwise counts the field.
    fn is_selected(&mut self, name: &str) -> bool {
        if self.moved.is_some() {
            return false;
        }
        if self.skip > 0 {
            self.skip -= 1;
            return false;
        }
        self.moved = Some([&self.path[..], &[name]].concat().join("."));
        true
    }
}

impl FieldVisitor for SettingMutator {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, _: &'static str) {
        if self.is_selected(name) {
            let larger = *value * 1.7 + 0.15;
            *value = if range.contains(&larger) { larger } else { *value * 0.55 };
        }
    }
    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        if self.is_selected(name) {
            // A limit on the longer side has an effect only below the size of the image.
            let near = if *range.end() > 1000 && *value > 100 { *range.start() } else { *value + 1 };
            *value = if range.contains(&near) { near } else { *value - 1 };
        }
    }
    fn vector(&mut self, name: &'static str, value: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {
        if self.is_selected(name) {
            *value = *value * 0.5 + Vec3::new(0.3, 0.2, 0.1);
        }
    }
    fn curve(&mut self, name: &'static str, value: &mut Curve, _: RangeInclusive<f32>) {
        if self.is_selected(name) {
            *value = "0.1:0.4,0.6:0.9".parse().unwrap();
        }
    }
    fn flag(&mut self, name: &'static str, value: &mut bool) {
        if self.is_selected(name) {
            *value = !*value;
        }
    }
    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        if self.is_selected(name) {
            let others: Vec<_> = (0..value.names().len()).filter(|&index| index != value.index()).collect();
            self.has_more = self.value + 1 < others.len();
            value.set_index(others[self.value]);
            if let Some(moved) = &mut self.moved {
                *moved = format!("{moved} {}", value.names()[value.index()]);
            }
        }
    }
    fn image(&mut self, name: &'static str, value: &mut String, role: ImageRole) {
        if self.is_selected(name) {
            let builtins = match role {
                ImageRole::Sprite => builtin::SPRITES,
                ImageRole::Ramp => builtin::RAMPS,
                ImageRole::Motif => builtin::MOTIFS,
                ImageRole::Noise => builtin::NOISES,
                ImageRole::Detail | ImageRole::SixWay => &[],
            };
            let file = match role {
                ImageRole::Noise => OTHER_NOISE,
                ImageRole::SixWay => OTHER_SIX_WAY,
                _ => OTHER_DETAIL,
            };
            let other = builtins.iter().find(|builtin| builtin.name != value);
            *value = other.map_or(file, |builtin| builtin.name).into();
        }
    }
    fn seed(&mut self, name: &'static str, value: &mut u32) {
        if self.is_selected(name) {
            *value += 1;
        }
    }
    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.path.push(name);
        fields.visit(self);
        self.path.pop();
    }
    fn item(&mut self, _: &'static str, _: usize, _: &mut dyn Fields) {}
}

/// Returns stages in which settings may have an effect: most settings in soft smoke, some only with one technique or
/// path.
fn stages() -> Vec<TestScene> {
    let flipbook = crate::techniques::flipbook();
    let scene = |technique: Technique, path: RenderPath, change: fn(&mut Settings)| {
        let mut scene = TestScene::new(SIZE);
        scene.depth = DepthKind::Both;
        scene.attach_depth = true;
        scene.settings.technique = technique;
        scene.settings.path = path;
        scene.settings.volumetric.noise_size = 1.5;
        scene.settings.specular_scatter.size = 260.0;
        scene.settings.boost = 1.0;
        // Particles of every age and flipbook frame.
        for (index, particle) in (0u8..).zip(&mut scene.particles) {
            particle.age = f32::from(index) / 59.0;
            particle.frame = f32::from(index) * 0.37;
            particle.velocity = Vec3::new(1.5, 0.05 * f32::from(index) - 1.5, 0.5);
            particle.tint = [255, 4 * index, 100];
            particle.heat = 255 - 2 * index;
        }
        (scene.material.sprite, scene.material.detail, scene.material.six_way) = flipbook.clone();
        scene.time = 1.3;
        change(&mut scene.settings);
        scene
    };
    let nothing: fn(&mut Settings) = |_| {};
    // The near fade reaches into the smoke.
    let contrast: fn(&mut Settings) = |s| (s.soft_fade.curve, s.soft_fade.near_fade_end) = (FadeCurve::Contrast, 9.0);
    let tested: fn(&mut Settings) = |s| (s.accumulate.downscale, s.accumulate.encoding) = (1, NormalEncoding::Biased);
    let weighted: fn(&mut Settings) = |s| s.accumulate.order = BlendOrder::Weighted;
    let six_way: fn(&mut Settings) = |s| s.lighting = Lighting::SixWay;
    let shaded: fn(&mut Settings) = |s| (s.shadow.strength, s.shadow.lights) = (0.7, 1);
    let under_a_sky: fn(&mut Settings) =
        |s| (s.shadow.strength, s.shadow.by_depth, s.ambient.intensity) = (0.7, true, 1.0);
    let burning: fn(&mut Settings) = |s| (s.fire.intensity, s.ambient.intensity) = (2.0, 1.0);
    let stretched: fn(&mut Settings) = |s| (s.sprite.stretch, s.sprite.stretch_limit) = (2.0, 1.6);
    let grainy: fn(&mut Settings) =
        |s| s.grain = Grain { erosion: 0.5, dissolve: 0.0, bump: 0.7, tiles: 0.25, octaves: 1 };
    let adaptive: fn(&mut Settings) =
        |s| (s.accumulate.downscale, s.accumulate.scale_mode, s.accumulate.max_error) = (1, ScaleMode::Auto, 0.1);
    vec![
        scene(Technique::Soft, RenderPath::Raster, burning),
        scene(Technique::Soft, RenderPath::Raster, nothing),
        scene(Technique::Soft, RenderPath::Raster, weighted),
        scene(Technique::Soft, RenderPath::Forward, nothing),
        scene(Technique::Soft, RenderPath::Raster, contrast),
        scene(Technique::Soft, RenderPath::Raster, tested),
        scene(Technique::Soft, RenderPath::Raster, six_way),
        scene(Technique::Soft, RenderPath::Raster, stretched),
        scene(Technique::Soft, RenderPath::Raster, grainy),
        scene(Technique::SphericalBillboard, RenderPath::Raster, nothing),
        scene(Technique::Density, RenderPath::Raster, nothing),
        scene(Technique::VolumetricSoft, RenderPath::Raster, nothing),
        scene(Technique::Soft, RenderPath::Raster, shaded),
        scene(Technique::Soft, RenderPath::Raster, under_a_sky),
        scene(Technique::Soft, RenderPath::Raster, adaptive),
    ]
}

/// Values that give the same image wherever both can be drawn, with the reason.
const SAME: [&str; 10] = [
    // There is one system.
    "sort_priority",
    // Shades the scene, which this test does not draw.
    "shadow.scene",
    // A light that the host adds to its own.
    "fire.light",
    "fire.flicker",
    // Chooses one of two paths, which are compared elsewhere.
    "path auto",
    // The same image, computed differently; tiled.rs compares the two.
    "path tiled",
    // The choice of `auto` here.
    "accumulate.lighting_resolution target",
    // The layers that are skipped otherwise are invisible.
    "accumulate.layers all",
    // The same depth, read from another texture.
    "technique soft_linear",
    // At scale 1 the reduced depth equals the host's.
    "accumulate.depth_source host",
];

#[test]
fn every_setting_changes_the_image_and_both_renderers_agree() {
    let stages = stages();
    let plain: Vec<Image<Vec4>> = stages.iter().map(TestScene::on_cpu).collect();
    let mut skip = 0;
    let mut value = 0;
    let mut seen = 0;
    loop {
        let mut name = None;
        let mut has_more = false;
        let mut has_effect = false;
        for (index, plain) in plain.iter().enumerate() {
            let mut scene = stages[index].clone();
            let mut mover = SettingMutator { skip, value, ..SettingMutator::default() };
            scene.settings.visit(&mut mover);
            has_more = mover.has_more;
            name = mover.moved.clone();
            let Some(name) = &mover.moved else { break };
            // Some values are invalid together with others.
            if scene.settings.validate(String::new).is_err() {
                continue;
            }
            let on_cpu = scene.on_cpu();
            if on_cpu == *plain && !SAME.contains(&name.as_str()) {
                continue;
            }
            has_effect = true;
            let on_gpu = match scene.try_on_gpu(gpu()) {
                Ok(drawn) => drawn.image,
                // The error says that the backend does not support it.
                Err(error) => {
                    eprintln!("skipped: {name}: {error}");
                    break;
                }
            };
            let psnr = psnr(&on_gpu, &on_cpu);
            println!("{name}: {psnr:.1} dB, {}", stages[index].settings.technique.name());
            let has_steps = ["debug.checkerboard", "ramp_filter nearest"].contains(&name.as_str());
            let least = if has_steps { MIN_PSNR_WITH_STEPS } else { MIN_PSNR };
            assert!(psnr >= least, "{name}: {psnr:.1} dB");
            break;
        }
        let Some(name) = name else { break };
        assert!(has_effect, "{name} changes no image");
        seen += 1;
        (skip, value) = if has_more { (skip, value + 1) } else { (skip + 1, 0) };
    }
    assert!(seen > 60, "{seen} values");
}
