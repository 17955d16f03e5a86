//! Writes fires behind cold smoke for a path tracer, and how haze draws them; `scripts/truth --fire` compares the two.
//!
//! `fire_truth FOLDER SIZE` writes to the folder, for each cloud and each optical depth of cold smoke:
//! - `CLOUD_DEPTH.vol`: densities of all smoke, for Mitsuba,
//! - `CLOUD_FIRE.vol`: densities of the hot smoke, times the luminance of the fire ramp at its heat,
//! - `CLOUD_DEPTH_FIRE.f32`: the drawn fire as little-endian floats, row by row from the top: linear RGB on black,
//! - `manifest.json`: names of the files, and the optical depths.
//!
//! `SIZE`: side of images and volumes. The GPU draws on the path `raster`. No light but that of the fire: smoke is black.

use std::error::Error;
use std::fs;
use std::path::Path;

use glam::{UVec2, UVec3, Vec2, Vec3, Vec4Swizzles as _, vec3};
use haze::{
    Context, FrameInput, Particle, ParticleSystem, Particles, Renderer, RendererDescriptor, SceneDepth, builtin,
};
use haze_author::path_trace::{DensityVolume, Medium, PathTrace};
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::assets::noise::{pcg3d, unit};
use haze_core::assets::ramp::Ramp;
use haze_core::formula::color::luminance;
use haze_core::formula::ramp::sample_ramp_2d;
use haze_core::settings::{RampFilter, RenderPath};
use haze_demo::headless::Headless;
use haze_demo::puff_cloud::{PuffCloud, PuffKind, PuffMaterial};
use serde_json::json;

/// Optical depths of the cold smoke.
const DEPTHS: [f32; 6] = [0.0, 0.5, 1.0, 2.0, 3.0, 4.0];
/// Seeds of clouds.
const CLOUDS: [u32; 4] = [301, 302, 303, 304];
/// Hot puffs of a cloud, and the most cold ones.
const PUFFS: [u32; 2] = [12, 128];
/// Extinction per half side of a puff. Thin, so that many puffs add up to the depths.
const DENSITY: f32 = 1.0;

const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A fire: its ramp, and the least heat of its puffs.
struct Fire {
    name: &'static str,
    ramp: Ramp,
    coldest: f32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [folder, size] = &arguments[..] else { return Err("usage: fire_truth FOLDER SIZE".into()) };
    let folder = Path::new(folder);
    let size = size.parse()?;
    fs::create_dir_all(folder)?;
    let ramp = |name| builtin::find(builtin::RAMPS, name).ok_or(format!("no ramp {name}"));
    let fires = [
        Fire { name: "even", ramp: Ramp::from_linear(UVec2::ONE, [Vec3::ONE]), coldest: 1.0 },
        Fire { name: "mixed", ramp: ramp("fire_campfire")?.ramp()?, coldest: 0.4 },
    ];
    let recipe = SpriteRecipe::of_builtin(builtin::find(builtin::SPRITES, "billow").ok_or("no sprite billow")?)?;
    let medium = Medium { albedo: Vec3::ZERO, anisotropy: 0.0, density: DENSITY };
    let kind = PuffKind::new(&recipe, &medium, PathTrace { size, samples: 1, seed: 1 });
    let mut material = kind.material()?;
    material.assets.heat_ramp = ramp("heat_even")?.ramp()?;
    material.settings.path = RenderPath::Raster;
    material.settings.diffuse.intensity = 0.0;
    material.settings.fire.intensity = 1.0;
    material.settings.fire.core = 0.0;
    let gpu = Headless::new()?;
    let mut clouds = Vec::new();
    for seed in CLOUDS {
        let hot: Vec<_> = (0..PUFFS[0]).map(|index| hot_puff(index, seed)).collect();
        for fire in &fires {
            let volume = emission(&kind, &hot, fire, seed);
            fs::write(folder.join(format!("{seed}_{}.vol", fire.name)), volume.to_mitsuba())?;
        }
        for (nominal, (cold, depth)) in DEPTHS.iter().zip(cold_smoke(&kind, &hot, seed)) {
            let mut cloud = kind.single();
            cloud.particles = [hot.as_slice(), &cold].concat();
            fs::write(folder.join(format!("{seed}_{nominal}.vol")), cloud.volume().to_mitsuba())?;
            for fire in &fires {
                for (index, particle) in (0..).zip(&mut cloud.particles) {
                    particle.heat = if index < PUFFS[0] { heat(index, seed, fire) } else { 0 };
                }
                material.assets.fire_ramp = fire.ramp.clone();
                let file = folder.join(format!("{seed}_{nominal}_{}.f32", fire.name));
                fs::write(file, draw(&gpu, &cloud, &material)?)?;
            }
            clouds.push(json!({ "cloud": seed.to_string(), "nominal": nominal, "depth": depth, "cold": cold.len() }));
            eprintln!("cloud {seed}: drew the fire behind {} puffs, optical depth {depth:.2}", cold.len());
        }
    }
    let names = fires.map(|fire| fire.name);
    let manifest = json!({ "device": gpu.description(), "density": DENSITY, "fires": names, "clouds": clouds });
    fs::write(folder.join("manifest.json"), serde_json::to_string_pretty(&manifest)?)?;
    Ok(())
}

/// A puff at a random position of a box. `key`: hot or cold, and index.
fn puff(key: [u32; 2], seed: u32, (center, half_extent): (Vec3, Vec3), radius: f32) -> Particle {
    let [a, b] = [0, 1].map(|more| pcg3d(UVec3::new(key[1], 2 * key[0] + more, seed)));
    let unit_position = vec3(unit(a.x), unit(a.y), unit(a.z)) * 2.0 - 1.0;
    Particle {
        position: center + unit_position * half_extent,
        radius,
        frame: (b.y % 2) as f32,
        age: 0.5,
        ..Particle::default()
    }
}

/// Puffs of the fire are at the back of the cube.
fn hot_puff(index: u32, seed: u32) -> Particle {
    puff([0, index], seed, (vec3(0.0, 0.0, -0.65), vec3(0.25, 0.25, 0.05)), 0.3)
}

/// Puffs of cold smoke are wider than the fire and before it.
fn cold_puff(index: u32, seed: u32) -> Particle {
    puff([1, index], seed, (vec3(0.0, 0.0, 0.35), vec3(0.4, 0.4, 0.05)), 0.6)
}

/// Heat of a hot puff, 255 for 1.
fn heat(index: u32, seed: u32, fire: &Fire) -> u8 {
    let random = unit(pcg3d(UVec3::new(index, 9, seed)).x);
    (255.0 * (fire.coldest + (1.0 - fire.coldest) * random)).round() as u8
}

/// Densities of the hot puffs, times the luminance of the fire ramp at their heat.
fn emission(kind: &PuffKind, hot: &[Particle], fire: &Fire, seed: u32) -> DensityVolume {
    let mut cloud = kind.single();
    cloud.particles.clear();
    let mut sum = cloud.volume();
    for (index, particle) in (0..).zip(hot) {
        cloud.particles = vec![*particle];
        let at = Vec2::new(f32::from(heat(index, seed, fire)) / 255.0, 0.0);
        let light = luminance(sample_ramp_2d(&fire.ramp, RampFilter::Bilinear, at));
        sum.densities.iter_mut().zip(cloud.volume().densities).for_each(|(sum, density)| *sum += light * density);
    }
    sum
}

/// Cold puffs for each of [`DEPTHS`]: as many as come nearest to it, and their depth. It is that of the even smoke that
/// would let the same fraction of the fire's light through.
fn cold_smoke(kind: &PuffKind, hot: &[Particle], seed: u32) -> Vec<(Vec<Particle>, f32)> {
    let mut cloud = kind.single();
    cloud.particles = hot.to_vec();
    let fire: Vec<_> = optical_depths(&cloud).iter().map(|depth| 1.0 - (-depth).exp()).collect();
    let mut depths = vec![0.0; fire.len()];
    let mut seen = vec![0.0];
    for index in 0..PUFFS[1] {
        cloud.particles = vec![cold_puff(index, seed)];
        depths.iter_mut().zip(optical_depths(&cloud)).for_each(|(sum, depth)| *sum += depth);
        let through: f32 = fire.iter().zip(&depths).map(|(light, depth)| light * (-depth).exp()).sum();
        seen.push(-(through / fire.iter().sum::<f32>()).ln());
    }
    let nearest = |wanted: &f32| {
        let apart = |count: &usize| (seen[*count] - wanted).abs();
        let count = (0..seen.len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or(0);
        ((0..count as u32).map(|index| cold_puff(index, seed)).collect(), seen[count])
    };
    DEPTHS.iter().map(nearest).collect()
}

/// Optical depth through a cloud, for each column of its volume.
fn optical_depths(cloud: &PuffCloud<'_>) -> Vec<f32> {
    let DensityVolume { size, densities } = cloud.volume();
    let mut depths = vec![0.0; (size.x * size.y) as usize];
    for (index, density) in densities.iter().enumerate() {
        depths[index % (size.x * size.y) as usize] += density * DENSITY * 2.0 / size.z as f32;
    }
    depths
}

/// Draws a cloud on black by the GPU. Returns the bytes of linear RGB.
fn draw(gpu: &Headless, cloud: &PuffCloud<'_>, material: &PuffMaterial) -> Result<Vec<u8>, Box<dyn Error>> {
    let view = cloud.view();
    let color = gpu.target("color", view.size, COLOR);
    let depth = gpu.target("depth", view.size, DEPTH);
    let color_view = color.create_view(&Default::default());
    let depth_view = depth.create_view(&Default::default());
    let context = Context::new(&gpu.device, &gpu.queue);
    let descriptor = RendererDescriptor { color_format: COLOR, depth_format: None, ..RendererDescriptor::default() };
    let mut renderer = Renderer::new(&context, &descriptor)?;
    let uploaded = context.create_material(&material.assets)?;
    let particles = Particles::Slice(&cloud.particles);
    let systems = [ParticleSystem::new(0, particles, &material.settings, &uploaded)];
    let frame = FrameInput { systems: &systems, ..FrameInput::new(view, SceneDepth::Buffer(&depth_view)) };
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    // Nothing stands behind the smoke.
    let far = wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store };
    drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &depth_view,
            depth_ops: Some(far),
            stencil_ops: None,
        }),
        ..Default::default()
    }));
    renderer.prepare(&mut encoder, &frame)?;
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &color_view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    });
    renderer.render(&mut pass);
    drop(pass);
    gpu.submit(encoder)?;
    let texels = gpu.read_rgba16float(&color)?;
    Ok(texels.iter().flat_map(|texel| texel.xyz().to_array()).flat_map(f32::to_le_bytes).collect())
}
