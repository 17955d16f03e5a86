//! Compares a column of many puffs, lit by ramps or by six-way maps, with a path trace of their summed densities, and
//! measures how much of the error comes from puffs that do not shadow each other.

use std::convert::Infallible;
use std::f32::consts::TAU;
use std::path::Path;

use glam::camera::rh::proj::directx::orthographic;
use glam::{Mat4, UVec2, UVec3, Vec2, Vec3, Vec4, Vec4Swizzles, vec3};
use haze::builtin;
use haze::image::Image;
use haze::noise::{pcg3d, unit};
use haze::settings::{Backlight, Lighting, Settings, Technique};
use haze::sprite::Sprite;
use haze::{Light, LightKind, MaterialAssets, Particle, View};
use haze_author::path_trace::{DensityVolume, MEDIA, Medium, PathTrace, PathTraceResult};
use haze_author::ramp::response::{LightResponse, Response};
use haze_author::sprite::bake::SpriteRecipe;
use haze_author::sprite::six_way::six_way_layout;

const LIGHTS: usize = 8;
/// Flipbook frames in use; each puff shows one frame.
const FRAMES: u32 = 2;

/// Puffs in a cube with sides of 2 m, and the parameters to path-trace them.
struct Column {
    particles: Vec<Particle>,
    recipe: SpriteRecipe,
    medium: Medium,
    path_trace: PathTrace,
}

/// One image per light: linear radiance, premultiplied by coverage.
type LightImages = Vec<Image<Vec3>>;

impl Column {
    fn new(medium: Medium, size: u32, samples: u32) -> Self {
        let puff = |index: u32| {
            let (a, b) = (pcg3d(UVec3::new(index, 0, 7)), pcg3d(UVec3::new(index, 1, 7)));
            let place = vec3(unit(a.x), unit(a.y), unit(a.z)) * 2.0 - 1.0;
            Particle {
                position: place * vec3(0.25, 0.6, 0.25),
                radius: 0.26 + 0.12 * unit(b.x),
                rotation: 0.0,
                amount: 1.0,
                frame: (b.y % FRAMES) as f32,
                age: 0.5,
            }
        };
        let recipe = SpriteRecipe::of_builtin(builtin::find(builtin::SPRITES, "billow").unwrap()).unwrap();
        let recipe =
            SpriteRecipe { size, columns: FRAMES, rows: 1, extinction: medium.density, tolerance: 0, ..recipe };
        let particles = (0..24).map(puff).collect();
        Self { particles, recipe, medium, path_trace: PathTrace { size, samples, seed: 1 } }
    }

    fn trace(&self, volume: &DensityVolume, path_trace: &PathTrace) -> PathTraceResult {
        let Ok(traced) = path_trace.run(volume, &self.medium, &lights(), |_| Ok::<_, Infallible>(()));
        traced
    }

    fn puff(&self, frame: u32) -> DensityVolume {
        SpriteRecipe { size: self.recipe.size / 2, ..self.recipe.clone() }.volume(frame as f32)
    }

    /// Path trace of the summed densities of all puffs.
    fn truth(&self) -> LightImages {
        let puffs: Vec<_> = (0..FRAMES).map(|frame| self.puff(frame)).collect();
        let side = self.path_trace.size;
        let mut all = DensityVolume { size: UVec3::splat(side), densities: vec![0.0; side.pow(3) as usize] };
        for index in 0..all.densities.len() as u32 {
            let voxel = UVec3::new(index % side, index / side % side, index / (side * side));
            let place = all.voxel_centre(voxel);
            let density = |puff: &Particle| {
                let local = (place - puff.position) / puff.radius;
                let is_inside = local.abs().max_element() < 1.0;
                // Divided by the radius, so that the optical depth through a puff does not depend on its size.
                if is_inside { puffs[puff.frame as usize].density(local) / puff.radius } else { 0.0 }
            };
            all.densities[index as usize] = self.particles.iter().map(density).sum();
        }
        self.trace(&all, &self.path_trace).light
    }

    /// Every puff path-traced separately, composited back to front. Correct, except that puffs neither shadow nor light
    /// each other.
    fn puffs_alone(&self) -> LightImages {
        let path_trace = PathTrace { size: self.recipe.size / 2, ..self.path_trace };
        let puffs: Vec<_> = (0..FRAMES).map(|frame| self.trace(&self.puff(frame), &path_trace)).collect();
        let mut sorted: Vec<_> = self.particles.iter().collect();
        sorted.sort_by(|a, b| a.position.z.total_cmp(&b.position.z));
        let of_light = |light: usize| {
            let mut picture = Image::new(UVec2::splat(self.path_trace.size), Vec3::ZERO);
            let scale = 2.0 / self.path_trace.size as f32;
            picture.for_each(|at, texel| {
                let place = ((at.as_vec2() + 0.5) * scale - 1.0) * Vec2::new(1.0, -1.0);
                for puff in &sorted {
                    let local = (place - puff.position.truncate()) / puff.radius;
                    if local.abs().max_element() < 1.0 {
                        let traced = &puffs[puff.frame as usize];
                        let at = (local * Vec2::new(1.0, -1.0) + 1.0) * 0.5 * path_trace.size as f32;
                        let at = at.as_ivec2();
                        *texel = *texel * (1.0 - traced.coverage.load(at)) + traced.light[light].load(at);
                    }
                }
            });
            picture
        };
        (0..LIGHTS).map(of_light).collect()
    }

    /// The column drawn by the CPU renderer.
    fn drawn(&self, settings: &Settings, material: &MaterialAssets) -> LightImages {
        let size = UVec2::splat(self.path_trace.size);
        let view = Mat4::from_translation(vec3(0.0, 0.0, -3.0));
        let view = View::new(view, orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 10.0), size);
        let of_light = |to_light: Vec3| {
            let light = Light { kind: LightKind::Directional, direction: -to_light, ..Light::default() };
            let mut picture = Image::new(size, Vec4::ZERO);
            let frame = haze_reference::FrameInput {
                view,
                scene_depth: &Image::new(size, 1.0),
                lights: &[light],
                systems: &[haze_reference::ParticleSystem::new(&self.particles, settings, material)],
                exposure: 1.0,
                time: 0.0,
                up: Vec3::Y,
                debug_view: haze::settings::DebugView::Final,
            };
            haze_reference::render(&frame, &mut picture).unwrap();
            Image { size, texels: picture.texels.iter().map(|texel| texel.xyz()).collect() }
        };
        lights().into_iter().map(of_light).collect()
    }

    /// The column drawn with the ramps fitted to a medium, and with six-way maps of that medium.
    fn drawn_with_ramps_and_six_way(&self, medium: &str) -> [LightImages; 2] {
        let mut settings = Settings { boost: 1.0, technique: Technique::Hard, ..Settings::default() };
        settings.accumulate.scale = 1;
        settings.diffuse.backlight = Backlight::Ramp;
        (settings.soft_scatter.intensity, settings.specular_scatter.intensity) = (0.0, 0.0);
        let ramp =
            |role: &str| builtin::find(builtin::RAMPS, &format!("{role}_traced_{medium}")).unwrap().ramp().unwrap();
        let sheet = self.recipe.bake(|_| Ok::<_, haze::Error>(())).unwrap().picture;
        let Ok(maps) = self.recipe.bake_six_way(&self.medium, self.path_trace.samples, |_, _| Ok::<_, Infallible>(()));
        let layout = self.recipe.layout();
        let sprite = |picture, layout| Sprite::from_image(Path::new("billow"), picture, layout).unwrap();
        let material = MaterialAssets {
            sprite: sprite(&sheet, layout),
            detail: None,
            six_way: Some(sprite(&maps.picture, six_way_layout(layout))),
            diffuse_ramp: ramp("diffuse"),
            backlight_ramp: ramp("backlight"),
            ..crate::test_scene::material()
        };
        let mut six_way = Settings { lighting: Lighting::SixWay, ..settings };
        six_way.diffuse.six_way_anisotropy = maps.anisotropy;
        six_way.diffuse.six_way_color = maps.color;
        [settings, six_way].map(|settings| self.drawn(&settings, &material))
    }
}

/// Directions to the lights: a horizontal ring, the first towards the viewer.
fn lights() -> Vec<Vec3> {
    let turns = (0..LIGHTS).map(|index| index as f32 * TAU / LIGHTS as f32);
    turns.map(|turn| vec3(turn.sin(), 0.0, turn.cos())).collect()
}

/// Brightness under each light relative to the first, rounded to 0.01.
fn relative_brightness(lights: &[LightResponse]) -> Vec<f32> {
    lights.iter().map(|light| (light.shown / lights[0].shown * 100.0).round() / 100.0).collect()
}

/// Prints how far ramps, six-way maps and puffs alone are from the path trace, and six-way maps from puffs alone;
/// returns the four responses in that order.
fn compare_medium(medium: &str, size: u32, samples: u32) -> [Response; 4] {
    let named = MEDIA.iter().find(|named| named.name == medium).unwrap();
    let column = Column::new(named.medium, size, samples);
    let (truth, alone) = (column.truth(), column.puffs_alone());
    let [ramps, six_way] = column.drawn_with_ramps_and_six_way(medium);
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
    let white =
        1.3 * rows[0].iter().flat_map(|picture| &picture.texels).fold(0.0, |most: f32, texel| most.max(texel.x));
    let exposures: Vec<_> = rows.iter().map(|row| Response::new(row, rows[0]).exposure).collect();
    let picture = image::RgbImage::from_fn(side * LIGHTS as u32, side * rows.len() as u32, |x, y| {
        let row = rows[(y / side) as usize];
        let exposure = exposures[(y / side) as usize];
        let texel = row[(x / side) as usize].load(UVec2::new(x % side, y % side).as_ivec2()) * exposure / white;
        let code = texel.to_array().map(|light| haze::formula::color::srgb_from_linear(light.clamp(0.0, 1.0)));
        image::Rgb(code.map(|code| (code * 255.0).round() as u8))
    });
    let (width, height) = picture.dimensions();
    let picture = image::imageops::resize(&picture, 2 * width, 2 * height, image::imageops::FilterType::CatmullRom);
    picture.save(folder.join(format!("column_{medium}.png"))).unwrap();
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

/// Prints the table of columns in docs/light.md. With `HAZE_LOOK=folder` it also writes a comparison image per medium.
#[test]
#[ignore = "takes some minutes"]
fn prints_column_errors_for_every_medium() {
    for named in MEDIA {
        compare_medium(named.name, 64, 48);
    }
}
