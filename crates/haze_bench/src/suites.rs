//! Suites of the benchmark: groups of shots that are measured in turn and compared with each other.

use glam::{UVec2, Vec3};
use haze::Light;
use haze_core::error::Error;
use haze_core::settings::{
    AccumulationFormat, BlendOrder, DepthDownsample, FadeCurve, LightingResolution, NormalEncoding, RenderPath,
    Settings, Technique, Traversal, Upsample,
};
use haze_demo::shot::Shot;
use haze_preset::builtin;

use super::frame_suite;
use super::shadow_suite;
use super::sprite_shots::{BEYOND_IMAGE, CrowdExtent, WITHIN_IMAGE, layers, small_sprites, sprite_count, with_alpha};
use super::sprites_suite;
pub use super::suite::{Case, Group, Suite};
use super::suite::{at_scale, changed, full_resolution};

/// Returns all paths but `auto`. A path that is added to the settings is included.
fn paths() -> impl Iterator<Item = RenderPath> {
    RenderPath::ALL.iter().copied().filter(|&path| path != RenderPath::Auto)
}

/// Returns the same paths, each with every choice of layers that it supports.
fn paths_and_layers() -> impl Iterator<Item = (RenderPath, Traversal)> {
    paths().flat_map(|path| {
        let layers = if path == RenderPath::Tiled { Traversal::ALL } else { &Traversal::ALL[..1] };
        layers.iter().map(move |&layers| (path, layers))
    })
}

/// Name of a path in rows.
fn path_name(path: RenderPath, layers: Traversal) -> String {
    if path == RenderPath::Tiled { format!("{} {}", path.name(), layers.name()) } else { path.name().into() }
}

const SCALES: [u32; 6] = [1, 2, 3, 4, 6, 8];

/// Returns all groups of a suite at an image size. `quick` leaves out intermediate cases.
pub fn groups(suite: Suite, size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    match suite {
        Suite::Scale => scale(size, quick),
        Suite::Overdraw => overdraw(size, quick),
        Suite::Lights => lights(size, quick),
        Suite::Shadow => shadow_suite::groups(size, quick),
        Suite::Sprites => sprites_suite::groups(size),
        Suite::Soft => soft(size, quick),
        Suite::Upsample => upsample(size, quick),
        Suite::Presets => presets(size, quick),
        Suite::Frame => frame_suite::groups(size, quick),
        Suite::Particles => particles(size, quick),
        Suite::Auto => auto(size, quick),
        Suite::Limits | Suite::All => Ok(Vec::new()),
    }
}

/// Scales to measure on a path; forward has only full resolution.
fn scales(path: RenderPath, scales: &[u32]) -> &[u32] {
    if path == RenderPath::Forward { &[1] } else { scales }
}

fn scale(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let counts: &[u32] = if quick { &[4, 32] } else { &[4, 16, 64] };
    let formats: &[AccumulationFormat] =
        if quick { &[AccumulationFormat::Rgba16Float] } else { AccumulationFormat::ALL };
    let group = |&count: &u32| {
        let shot = layers(size, count, 0.1)?;
        let mut cases = Vec::new();
        for path in paths() {
            for &format in if path == RenderPath::Forward { &formats[..1] } else { formats } {
                for &scale in scales(path, &SCALES) {
                    let name = format!("{} {} 1/{scale} {count} sprites", path.name(), format.name());
                    let shot = changed(&shot, |settings| {
                        at_scale(path, scale)(settings);
                        set_format(settings, format);
                    });
                    let work = (format!("{} {scale}", path.name()), f64::from(count));
                    cases.push(Case { name, shot, work });
                }
            }
        }
        Ok(Group { suite: Suite::Scale, cases, reference: full_resolution(&shot) })
    };
    counts.iter().map(group).collect()
}

fn set_format(settings: &mut Settings, format: AccumulationFormat) {
    settings.accumulate.format = format;
    if format == AccumulationFormat::Rgba8Unorm {
        // Rgba8Unorm supports no other encoding and order.
        settings.accumulate.encoding = NormalEncoding::Biased;
        settings.accumulate.order = BlendOrder::Sorted;
    }
}

fn overdraw(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let depths: &[u32] = if quick { &[4, 32, 256] } else { &[4, 16, 64, 256, 1024] };
    let alphas: &[f32] = if quick { &[0.1] } else { &[0.02, 0.1, 0.3] };
    let group = |shot: Shot, sprites: String, work: f64| {
        let case = |(path, layers): (RenderPath, Traversal)| Case {
            name: format!("{} {sprites}", path_name(path, layers)),
            shot: changed(&shot, |settings| {
                at_scale(path, 1)(settings);
                settings.accumulate.layers = layers;
            }),
            work: (format!("overdraw {}", path_name(path, layers)), work),
        };
        Group {
            suite: Suite::Overdraw,
            cases: paths_and_layers().map(case).collect(),
            reference: full_resolution(&shot),
        }
    };
    let large = depths.iter().flat_map(|&deep| alphas.iter().map(move |&alpha| (deep, alpha)));
    let mut groups = Vec::new();
    for (deep, alpha) in large {
        let shot = with_alpha(layers(size, sprite_count(deep), alpha)?, alpha);
        groups.push(group(shot, format!("{deep} layers of {alpha}"), f64::from(deep)));
    }
    // Many small sprites, where the cost per sprite matters too.
    let crowds: &[(u32, f32, f32, CrowdExtent)] = if quick {
        &[(4096, 156.0, 0.1, WITHIN_IMAGE)]
    } else {
        &[
            (1024, 14.0, 0.1, WITHIN_IMAGE),
            (4096, 64.0, 0.1, WITHIN_IMAGE),
            (4096, 64.0, 0.1, BEYOND_IMAGE),
            (4096, 156.0, 0.1, WITHIN_IMAGE),
            (4096, 156.0, 0.3, WITHIN_IMAGE),
            (16384, 627.0, 0.1, WITHIN_IMAGE),
            (32768, 1024.0, 0.1, WITHIN_IMAGE),
            (32768, 1024.0, 0.1, BEYOND_IMAGE),
        ]
    };
    for &(count, deep, alpha, extent) in crowds {
        let shot = with_alpha(small_sprites(size, count, deep, extent)?, alpha);
        let beyond = if extent.images > 1.0 { ", on beyond the image" } else { "" };
        groups.push(group(shot, format!("{count} small sprites, {deep} deep, of {alpha}{beyond}"), f64::from(deep)));
    }
    Ok(groups)
}

fn lights(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let counts: &[u32] = if quick { &[1, 8, 64] } else { &[1, 2, 4, 8, 16, 32, 64] };
    let group = |&count: &u32| {
        let mut shot = layers(size, sprite_count(if quick { 10 } else { 64 }), 0.1)?;
        let lamp = |index: u32| {
            let angle = index as f32 * 2.4;
            let place =
                Vec3::new(-3.05, 1.2, 0.5) + Vec3::new(angle.cos(), 0.4 * (angle * 0.7).sin(), angle.sin()) * 1.5;
            let intensity = 12.0 / count as f32;
            Light { position: place, intensity, range: 50.0, specular_scatter: 0.0, ..Light::default() }
        };
        shot.preset.lights = (0..count).map(lamp).collect();
        let mut cases = Vec::new();
        for path in paths() {
            for &scale in scales(path, &[1, 2, 4]) {
                let name = format!("{} 1/{scale} {count} lights", path.name());
                let work = (format!("lights {} {scale}", path.name()), f64::from(count));
                let lit_at = |resolution| {
                    changed(&shot, |s| {
                        at_scale(path, scale)(s);
                        s.accumulate.lighting_resolution = resolution;
                    })
                };
                let shot = lit_at(LightingResolution::Full);
                let lit = lit_at(LightingResolution::Target);
                cases.push(Case { name: name.clone(), shot, work });
                if scale > 1 {
                    // The same, lit once per texel of the target.
                    let name = format!("{name}, lit at 1/{scale}");
                    let work = (format!("lights {} {scale} lit", path.name()), f64::from(count));
                    cases.push(Case { name, shot: lit, work });
                }
            }
        }
        Ok(Group { suite: Suite::Lights, cases, reference: full_resolution(&shot) })
    };
    counts.iter().map(group).collect()
}

fn soft(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let shot = full_resolution(&layers(size, if quick { 4 } else { 16 }, 0.1)?);
    let mut cases = Vec::new();
    let mut case = |technique: Technique, curve: FadeCurve| {
        let shot = changed(&shot, |settings| {
            settings.technique = technique;
            settings.soft_fade.curve = curve;
        });
        let name = format!("{} {}", technique.name(), curve.name());
        cases.push(Case { name, shot, work: ("soft".into(), 1.0) });
    };
    Technique::ALL.iter().for_each(|&technique| case(technique, FadeCurve::default()));
    let others = FadeCurve::ALL.iter().filter(|&&curve| curve != FadeCurve::default());
    others.for_each(|&curve| case(Technique::Soft, curve));
    Ok(vec![Group { suite: Suite::Soft, cases, reference: shot }, nv_experiment(size, quick)?])
}

/// NV's experiment: two big sprites drawn many times, with each of the three depth tests.
fn nv_experiment(size: UVec2, quick: bool) -> Result<Group, Error> {
    let loops = if quick { 20 } else { 200 };
    let shot = changed(&full_resolution(&layers(size, 2, 0.5)?), |settings| settings.debug.draw_count = loops);
    let case = |technique: Technique| Case {
        name: format!("{} two sprites {loops} times", technique.name()),
        shot: changed(&shot, |settings| settings.technique = technique),
        work: ("experiment".into(), 1.0),
    };
    let cases = [Technique::Hard, Technique::Soft, Technique::SoftLinear].map(case).into();
    Ok(Group { suite: Suite::Soft, cases, reference: shot })
}

fn upsample(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let shot = Shot::load("fence", size)?;
    let group = |&scale: &u32| {
        let mut cases = Vec::new();
        for &downsample in DepthDownsample::ALL {
            for &upsample in Upsample::ALL {
                let name = format!("1/{scale} {} {}", downsample.name(), upsample.name());
                let shot = changed(&shot, |settings| {
                    at_scale(RenderPath::Raster, scale)(settings);
                    settings.accumulate.depth_downsample = downsample;
                    settings.accumulate.upsample = upsample;
                });
                cases.push(Case { name, shot, work: ("upsample".into(), 1.0) });
            }
        }
        Group { suite: Suite::Upsample, cases, reference: full_resolution(&shot) }
    };
    Ok(if quick { &[4][..] } else { &[2, 4] }.iter().map(group).collect())
}

fn presets(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let steps: &[u32] = if quick { &[2, 4] } else { &[1, 2, 4, 8] };
    let group = |name: &str| {
        let shot = Shot::load(name, size)?;
        let mut cases = Vec::new();
        for path in paths() {
            for &scale in scales(path, steps) {
                let name = format!("{name} {} 1/{scale}", path.name());
                cases.push(Case { name, shot: changed(&shot, at_scale(path, scale)), work: ("presets".into(), 1.0) });
            }
        }
        Ok(Group { suite: Suite::Presets, cases, reference: full_resolution(&shot) })
    };
    let each = if quick { 4 } else { 1 };
    builtin::PRESETS.iter().step_by(each).map(|preset| group(preset.name)).collect()
}

fn particles(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let counts: &[u32] = if quick { &[1_000, 100_000] } else { &[1_000, 10_000, 100_000, 1_000_000] };
    let group = |&count: &u32| {
        let mut shot = layers(size, 1, 0.02)?;
        for system in &mut shot.preset.systems {
            // At the greatest rate, a million births take ten seconds.
            system.emitter.rate = count as f32 / 10.0;
            system.emitter.duration = 10.0;
            system.emitter.extent = Vec3::new(1.5, 0.8, 0.8);
            system.emitter.turbulence = 0.5;
            // All counts cover the same area, so the difference in cost is the cost per particle.
            system.settings.sprite.size = 3.2 * 4.0 / (count as f32).sqrt();
        }
        shot.preset.time = 10.0;
        let mut cases = Vec::new();
        for path in paths() {
            let name = format!("{} {count} particles", path.name());
            let work = (format!("particles {}", path.name()), f64::from(count));
            cases.push(Case { name, shot: changed(&shot, at_scale(path, 2)), work });
        }
        Ok(Group { suite: Suite::Particles, cases, reference: full_resolution(&shot) })
    };
    counts.iter().map(group).collect()
}

fn auto(size: UVec2, quick: bool) -> Result<Vec<Group>, Error> {
    let sizes: &[u32] = if quick { &[1] } else { &[1, 2] };
    let techniques: &[Technique] = if quick {
        &[Technique::Soft, Technique::VolumetricSoft]
    } else {
        &[Technique::Soft, Technique::SphericalBillboard, Technique::VolumetricSoft]
    };
    let mut groups = Vec::new();
    for size in sizes.iter().map(|divisor| (size / divisor).max(UVec2::ONE)) {
        let shots = [
            ("4 sprites", layers(size, 4, 0.1)?),
            ("64 sprites", layers(size, 64, 0.1)?),
            ("256 thick sprites", layers(size, 256, 0.3)?),
            ("1024 small sprites", small_sprites(size, 1024, 9.3, WITHIN_IMAGE)?),
            ("4096 small sprites", small_sprites(size, 4096, 103.0, WITHIN_IMAGE)?),
        ];
        for (sprites, shot) in &shots {
            for (&technique, scale) in techniques.iter().flat_map(|technique| [(technique, 1), (technique, 3)]) {
                let case = |path: RenderPath| {
                    let what = format!("{sprites} {} 1/{scale} {}x{}", technique.name(), size.x, size.y);
                    let shot = changed(shot, |settings| {
                        at_scale(path, scale)(settings);
                        settings.technique = technique;
                    });
                    Case { name: format!("{} {what}", path.name()), shot, work: (what, 1.0) }
                };
                let cases = [RenderPath::Raster, RenderPath::Tiled, RenderPath::Auto].map(case).into();
                groups.push(Group { suite: Suite::Auto, cases, reference: full_resolution(shot) });
            }
        }
    }
    Ok(groups)
}
