//! The GPU renderer against the CPU renderer, whole frames: every preset, and every setting that changes a pipeline.

use glam::{UVec2, Vec4};
use haze::demo::shot::Shot;
use haze::reference::picture::Picture;
use haze::settings::*;
use haze::{Descriptor, builtin};

use crate::common::{gpu, psnr};

/// Issue of f16 rounding, f32 order of operations and sub-pixel edges: two correct renderers differ by well under this.
const AGREEMENT: f32 = 45.0;

fn exact() -> Descriptor {
    Descriptor { exact_filtering: true, ..Descriptor::default() }
}

fn shot(name: &str, size: UVec2) -> Shot {
    Shot::load(name, size).unwrap()
}

fn agreement(shot: &Shot) -> (f32, Picture<Vec4>) {
    let on_gpu = shot.render_on_gpu(gpu(), &exact()).unwrap();
    let on_cpu = shot.render_on_cpu().unwrap();
    gpu().check().unwrap();
    assert!(on_gpu.texels.iter().all(|texel| texel.is_finite()));
    (psnr(&on_gpu, &on_cpu), on_gpu)
}

#[test]
fn every_preset_agrees() {
    for preset in builtin::PRESETS {
        let (psnr, _) = agreement(&shot(preset.name, UVec2::new(320, 180)));
        println!("{}: {psnr:.1} dB", preset.name);
        assert!(psnr >= AGREEMENT, "{}: {psnr:.1} dB", preset.name);
    }
}

/// Changes one system setting of the default preset.
fn with(change: impl Fn(&mut Settings)) -> Shot {
    let mut shot = shot("column", UVec2::new(160, 90));
    for system in &mut shot.preset.systems {
        change(&mut system.settings);
        system.settings.validate(String::new).unwrap();
    }
    shot
}

#[test]
fn every_setting_agrees() {
    let mut shots = Vec::new();
    let mut add = |name: &str, choice: &str, shot: Shot| shots.push((format!("{name} {choice}"), shot));
    for &mode in DiffuseMode::ALL {
        add("diffuse.mode", mode.name(), with(|s| s.diffuse.mode = mode));
    }
    for &mode in SoftScatterMode::ALL {
        add("soft_scatter.mode", mode.name(), with(|s| s.soft_scatter.mode = mode));
    }
    for &curve in FadeCurve::ALL {
        add("soft_fade.curve", curve.name(), with(|s| s.soft_fade.curve = curve));
    }
    for &upsample in Upsample::ALL {
        add("upsample", upsample.name(), with(|s| (s.accumulate.upsample, s.accumulate.scale) = (upsample, 3)));
    }
    for &mode in DepthDownsample::ALL {
        add("depth_downsample", mode.name(), with(|s| (s.accumulate.depth_downsample, s.accumulate.scale) = (mode, 4)));
    }
    for &decode in NormalDecode::ALL {
        add("decode, signed", decode.name(), with(|s| s.accumulate.decode = decode));
        let biased = |s: &mut Settings| (s.accumulate.decode, s.accumulate.encoding) = (decode, NormalEncoding::Biased);
        add("decode, biased", decode.name(), with(biased));
        add(
            "decode, rgba8",
            decode.name(),
            with(|s| {
                biased(s);
                s.accumulate.format = AccumulationFormat::Rgba8Unorm;
            }),
        );
    }
    for &mode in BlendMode::ALL {
        add("forward", mode.name(), with(|s| (s.path, s.blend_mode) = (Path::Forward, mode)));
    }
    add("depth_source", "host", with(|s| (s.accumulate.depth_source, s.accumulate.scale) = (DepthSource::Host, 1)));
    for &stage in ShadeTree::ALL {
        let mut shot = with(|_| {});
        shot.shade_tree = stage;
        add("shade tree", stage.name(), shot);
    }
    for (name, shot) in &shots {
        let (psnr, _) = agreement(shot);
        println!("{name}: {psnr:.1} dB");
        assert!(psnr >= AGREEMENT, "{name}: {psnr:.1} dB");
    }
}
