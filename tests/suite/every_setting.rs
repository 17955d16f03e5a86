//! Every setting, moved: both renderers follow alike, and no setting does nothing. The walk finds the settings, so that a new
//! one is tested before anyone has thought of it.

use std::ops::RangeInclusive;

use glam::{UVec2, Vec3, Vec4};
use haze::builtin;
use haze::picture::Picture;
use haze::settings::*;

use crate::common::{AGREEMENT, STEP_AGREEMENT, gpu, psnr};
use crate::stage::{DepthKind, Stage};

const SIZE: UVec2 = UVec2::new(96, 54);

/// What a detail map is moved to, beside the sprite's file.
pub const OTHER_DETAIL: &str = "other.png";
/// The same for six-way maps.
pub const OTHER_SIX_WAY: &str = "other.six_way.png";
/// The same for a noise, of which one is built in.
pub const OTHER_NOISE: &str = "noise.png";

/// Moves the one field that is asked for to the one value that is asked for, and tells of it.
#[derive(Default)]
pub struct Mover {
    /// Fields to pass by.
    pub skip: usize,
    /// Which of a field's other values.
    pub value: usize,
    pub path: Vec<&'static str>,
    pub moved: Option<String>,
    /// The field has more values than this.
    pub has_more: bool,
}

impl Mover {
    /// Whether this field is the one; counts it.
    fn is_here(&mut self, name: &str) -> bool {
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

impl FieldVisitor for Mover {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, _: &'static str) {
        if self.is_here(name) {
            let larger = *value * 1.7 + 0.15;
            *value = if range.contains(&larger) { larger } else { *value * 0.55 };
        }
    }
    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        if self.is_here(name) {
            // A largest side is felt below the picture's.
            let near = if *range.end() > 1000 && *value > 100 { *range.start() } else { *value + 1 };
            *value = if range.contains(&near) { near } else { *value - 1 };
        }
    }
    fn vector(&mut self, name: &'static str, value: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {
        if self.is_here(name) {
            *value = *value * 0.5 + Vec3::new(0.3, 0.2, 0.1);
        }
    }
    fn flag(&mut self, name: &'static str, value: &mut bool) {
        if self.is_here(name) {
            *value = !*value;
        }
    }
    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        if self.is_here(name) {
            let others: Vec<_> = (0..value.names().len()).filter(|&index| index != value.index()).collect();
            self.has_more = self.value + 1 < others.len();
            value.set_index(others[self.value]);
            if let Some(moved) = &mut self.moved {
                *moved = format!("{moved} {}", value.names()[value.index()]);
            }
        }
    }
    fn picture(&mut self, name: &'static str, value: &mut String, role: PictureRole) {
        if self.is_here(name) {
            let builtins = match role {
                PictureRole::Sprite => builtin::SPRITES,
                PictureRole::Ramp => builtin::RAMPS,
                PictureRole::Motif => builtin::MOTIFS,
                PictureRole::Noise => builtin::NOISES,
                PictureRole::Detail | PictureRole::SixWay => &[],
            };
            let file = match role {
                PictureRole::Noise => OTHER_NOISE,
                PictureRole::SixWay => OTHER_SIX_WAY,
                _ => OTHER_DETAIL,
            };
            let other = builtins.iter().find(|builtin| builtin.name != value);
            *value = other.map_or(file, |builtin| builtin.name).into();
        }
    }
    fn seed(&mut self, name: &'static str, value: &mut u32) {
        if self.is_here(name) {
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

/// Where a setting may be felt: most in soft smoke, some under one technique or path only.
fn stages() -> Vec<Stage> {
    let flipbook = crate::techniques::flipbook();
    let stage = |technique: Technique, path: Path, change: fn(&mut Settings)| {
        let mut stage = Stage::new(SIZE);
        (stage.depth, stage.attach_depth) = (DepthKind::Both, true);
        (stage.settings.technique, stage.settings.path) = (technique, path);
        (stage.settings.volumetric.noise_size, stage.settings.specular_scatter.size) = (1.5, 20.0);
        stage.settings.boost = 1.0;
        // Of every age and frame.
        for (index, particle) in (0..).zip(&mut stage.particles) {
            (particle.age, particle.frame) = (index as f32 / 59.0, index as f32 * 0.37);
        }
        (stage.material.sprite, stage.material.detail, stage.material.six_way) = flipbook.clone();
        stage.time = 1.3;
        change(&mut stage.settings);
        stage
    };
    let nothing: fn(&mut Settings) = |_| {};
    // The near fade reaches into the smoke.
    let contrast: fn(&mut Settings) = |s| (s.soft_fade.curve, s.soft_fade.near_fade_end) = (FadeCurve::Contrast, 9.0);
    let tested: fn(&mut Settings) = |s| (s.accumulate.scale, s.accumulate.encoding) = (1, NormalEncoding::Biased);
    let weighted: fn(&mut Settings) = |s| s.accumulate.order = Order::Weighted;
    let six_way: fn(&mut Settings) = |s| s.lighting = Lighting::SixWay;
    vec![
        stage(Technique::Soft, Path::Raster, nothing),
        stage(Technique::Soft, Path::Raster, weighted),
        stage(Technique::Soft, Path::Forward, nothing),
        stage(Technique::Soft, Path::Raster, contrast),
        stage(Technique::Soft, Path::Raster, tested),
        stage(Technique::Soft, Path::Raster, six_way),
        stage(Technique::SphericalBillboard, Path::Raster, nothing),
        stage(Technique::Density, Path::Raster, nothing),
        stage(Technique::VolumetricSoft, Path::Raster, nothing),
    ]
}

/// Values that make no other picture where they can be compared, and why.
const SAME: [&str; 5] = [
    // One of the two that are compared elsewhere.
    "path auto",
    // The same picture by other means; tiled.rs compares them.
    "path tiled",
    // What is left out there cannot be seen.
    "accumulate.layers all",
    // The same depth, read from another texture.
    "technique soft_linear",
    // At scale 1 the reduced depth is the host's.
    "accumulate.depth_source host",
];

#[test]
fn every_setting_moves_both_renderers_alike() {
    let stages = stages();
    let plain: Vec<Picture<Vec4>> = stages.iter().map(Stage::on_cpu).collect();
    let (mut skip, mut value, mut seen) = (0, 0, 0);
    loop {
        let mut name = None;
        let (mut has_more, mut felt) = (false, false);
        for (index, plain) in plain.iter().enumerate() {
            let mut stage = stages[index].clone();
            let mut mover = Mover { skip, value, ..Mover::default() };
            stage.settings.visit(&mut mover);
            has_more = mover.has_more;
            name = mover.moved.clone();
            let Some(name) = &mover.moved else { break };
            // Not every value goes with every other.
            if stage.settings.validate(String::new).is_err() {
                continue;
            }
            let on_cpu = stage.on_cpu();
            if on_cpu == *plain && !SAME.contains(&name.as_str()) {
                continue;
            }
            felt = true;
            let on_gpu = match stage.try_on_gpu(gpu()) {
                Ok(drawn) => drawn.picture,
                // A backend without it says so.
                Err(error) => {
                    eprintln!("left out: {name}: {error}");
                    break;
                }
            };
            let psnr = psnr(&on_gpu, &on_cpu);
            println!("{name}: {psnr:.1} dB, {}", stages[index].settings.technique.name());
            let has_steps = ["sprite.debug_sprite", "ramp_filter nearest"].contains(&name.as_str());
            let least = if has_steps { STEP_AGREEMENT } else { AGREEMENT };
            assert!(psnr >= least, "{name}: {psnr:.1} dB");
            break;
        }
        let Some(name) = name else { break };
        assert!(felt, "{name} does nothing");
        seen += 1;
        (skip, value) = if has_more { (skip, value + 1) } else { (skip + 1, 0) };
    }
    assert!(seen > 60, "{seen} values");
}
