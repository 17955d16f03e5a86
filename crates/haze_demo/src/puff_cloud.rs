//! Clouds of many puffs: path-traced as one volume, and drawn by the CPU renderer. Shadow ramps are fitted to the
//! difference.

use std::f32::consts::TAU;
use std::path::Path;

use glam::camera::rh::proj::directx::orthographic;
use glam::{Mat4, UVec2, UVec3, Vec2, Vec3, Vec4, Vec4Swizzles as _, vec3};
use haze::{Light, LightKind, MaterialAssets, Particle, View};
use haze_author::path_trace::{DensityVolume, Medium, PathTrace};
use haze_author::ramp::response::{Response, ShadedLight};
use haze_author::simulation::Recording;
use haze_author::sprite::bake::SpriteRecipe;
use haze_author::sprite::six_way::{BakedSixWay, six_way_layout};
use haze_core::assets::image::Image;
use haze_core::assets::noise::{pcg3d, unit};
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::Error;
use haze_core::settings::{Backlight, DebugView, Lighting, Settings, Technique};
use haze_preset::{ImageSource, MaterialSources};
use haze_reference::{FrameInput, ParticleSystem, PreparedFrame};
use image::RgbaImage;

/// Number of lights in the ring around a cloud.
pub const LIGHTS: usize = 8;
/// Flipbook frames in use; each puff shows one frame.
const FRAMES: u32 = 2;
/// Number of puffs of a cloud.
const PUFFS: u32 = 24;

/// One image per light: linear radiance, premultiplied by coverage.
pub type LightImages = Vec<Image<Vec3>>;

/// Arrangement of puffs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CloudShape {
    /// Higher than wide.
    Column,
    /// As wide as high.
    Ball,
    /// Flat.
    Layer,
}

impl CloudShape {
    /// All shapes.
    pub const ALL: [Self; 3] = [Self::Column, Self::Ball, Self::Layer];

    /// Name, for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Column => "column",
            Self::Ball => "ball",
            Self::Layer => "layer",
        }
    }

    /// Half the extent of the puffs' centers.
    fn half_extent(self) -> Vec3 {
        match self {
            Self::Column => vec3(0.25, 0.6, 0.25),
            Self::Ball => Vec3::splat(0.4),
            Self::Layer => vec3(0.6, 0.18, 0.6),
        }
    }
}

/// Directions to the lights: a horizontal ring, the first towards the viewer.
pub fn ring_of_lights() -> Vec<Vec3> {
    let turns = (0..LIGHTS).map(|index| index as f32 * TAU / LIGHTS as f32);
    turns.map(|turn| vec3(turn.sin(), 0.0, turn.cos())).collect()
}

/// Shape of puffs, from which images are baked.
#[derive(Clone, Debug)]
enum PuffShape {
    Recipe(SpriteRecipe),
    Recording(Recording),
}

impl PuffShape {
    fn layout(&self) -> SpriteLayout {
        match self {
            Self::Recipe(recipe) => recipe.layout(),
            Self::Recording(recording) => recording.layout(),
        }
    }

    fn flipbook(&self) -> Result<RgbaImage, Error> {
        match self {
            Self::Recipe(recipe) => Ok(recipe.bake(|_| Ok::<_, Error>(()))?.image),
            Self::Recording(recording) => Ok(recording.bake().sprite.image),
        }
    }

    fn six_way(&self, medium: &Medium, samples: u32) -> Result<BakedSixWay, Error> {
        match self {
            Self::Recipe(recipe) => recipe.bake_six_way(medium, samples, |_, _| Ok(())),
            Self::Recording(recording) => recording.bake_six_way(medium, samples, |_, _| Ok(())),
        }
    }
}

/// A sprite, as a medium fills it.
#[derive(Clone, Debug)]
pub struct PuffKind {
    shape: PuffShape,
    medium: Medium,
    path_trace: PathTrace,
    puffs: Vec<DensityVolume>,
}

/// Puffs in a cube with sides of 2 m.
#[derive(Clone, Debug)]
pub struct PuffCloud<'a> {
    /// The puffs.
    pub particles: Vec<Particle>,
    kind: &'a PuffKind,
}

/// Settings and images that draw a kind of puff.
#[derive(Clone, Debug)]
pub struct PuffMaterial {
    /// Lighting by normals, or by six-way maps.
    pub settings: Settings,
    /// Ramps, sprite and six-way maps.
    pub assets: MaterialAssets,
    /// Multiplies the drawn light of a puff alone, so that it is as bright as the path trace.
    pub exposure: f32,
}

impl PuffKind {
    /// `path_trace.size`: side of the images, and of the volumes of clouds.
    pub fn new(recipe: &SpriteRecipe, medium: &Medium, path_trace: PathTrace) -> Self {
        let size = path_trace.size;
        let recipe =
            SpriteRecipe { size, columns: FRAMES, rows: 1, extinction: medium.density, tolerance: 0, ..recipe.clone() };
        let puff = |frame| SpriteRecipe { size: size / 2, ..recipe.clone() }.volume(frame as f32);
        let puffs = (0..FRAMES).map(puff).collect();
        Self { shape: PuffShape::Recipe(recipe), medium: *medium, path_trace, puffs }
    }

    /// Puffs of a simulation whose smoke has the extinction of the medium. Its sprites have the size of `path_trace`.
    pub fn of_recording(recording: Recording, medium: &Medium, path_trace: PathTrace) -> Self {
        let SpriteLayout { columns, rows, .. } = recording.layout();
        let puffs = (0..columns * rows).map(|frame| recording.density(frame, path_trace.size / 2)).collect();
        Self { shape: PuffShape::Recording(recording), medium: *medium, path_trace, puffs }
    }

    /// Volume of one puff.
    pub fn puff(&self, frame: u32) -> &DensityVolume {
        &self.puffs[frame as usize % self.puffs.len()]
    }

    /// A cloud of puffs at random positions.
    pub fn cloud(&self, shape: CloudShape, seed: u32) -> PuffCloud<'_> {
        let puff = |index: u32| {
            let a = pcg3d(UVec3::new(index, 0, seed));
            let b = pcg3d(UVec3::new(index, 1, seed));
            let unit_position = vec3(unit(a.x), unit(a.y), unit(a.z)) * 2.0 - 1.0;
            Particle {
                position: unit_position * shape.half_extent(),
                radius: 0.26 + 0.12 * unit(b.x),
                rotation: 0.0,
                amount: 1.0,
                frame: (b.y % self.puffs.len() as u32) as f32,
                age: 0.5,
                ..Particle::default()
            }
        };
        PuffCloud { particles: (0..PUFFS).map(puff).collect(), kind: self }
    }

    /// One puff.
    pub fn single(&self) -> PuffCloud<'_> {
        let particle = Particle {
            position: Vec3::ZERO,
            radius: 0.8,
            rotation: 0.0,
            amount: 1.0,
            frame: 0.0,
            age: 0.5,
            ..Particle::default()
        };
        PuffCloud { particles: vec![particle], kind: self }
    }

    /// Material with default ramps and without scattered glow. Sprites are drawn texel by texel: no soft fade, no boost.
    ///
    /// # Errors
    /// If an image cannot be baked.
    pub fn material(&self) -> Result<PuffMaterial, Error> {
        let mut settings = Settings { boost: 1.0, technique: Technique::Hard, ..Settings::default() };
        settings.accumulate.downscale = 1;
        settings.soft_scatter.intensity = 0.0;
        settings.specular_scatter.intensity = 0.0;
        let flipbook = self.shape.flipbook()?;
        let assets = MaterialAssets {
            sprite: Sprite::from_image(Path::new("puff"), &flipbook, self.shape.layout())?,
            detail: None,
            ..MaterialSources::default().load(ImageSource::BuiltIn)?
        };
        Ok(PuffMaterial { settings, assets, exposure: 1.0 })
    }

    /// Material with ramps for diffuse light, and with six-way maps of the medium.
    ///
    /// # Errors
    /// If an image cannot be baked.
    pub fn materials(&self, diffuse: &Ramp, backlight: &Ramp) -> Result<[PuffMaterial; 2], Error> {
        let PuffMaterial { mut settings, assets, .. } = self.material()?;
        settings.diffuse.backlight = Backlight::Ramp;
        let maps = self.shape.six_way(&self.medium, self.path_trace.samples)?;
        let layout = six_way_layout(self.shape.layout());
        let assets = MaterialAssets {
            six_way: Some(Sprite::from_image(Path::new("puff"), &maps.image, layout)?),
            diffuse_ramp: diffuse.clone(),
            backlight_ramp: backlight.clone(),
            ..assets
        };
        let mut six_way = Settings { lighting: Lighting::SixWay, ..settings };
        six_way.diffuse.six_way_anisotropy = maps.anisotropy;
        six_way.diffuse.six_way_color = maps.color;
        let single = self.single();
        let truth = single.truth(&ring_of_lights());
        let material = |settings| {
            let material = PuffMaterial { settings, assets: assets.clone(), exposure: 1.0 };
            let drawn = single.drawn(&ring_of_lights(), &material)?;
            Ok::<_, Error>(PuffMaterial { exposure: Response::new(&drawn, &truth).exposure, ..material })
        };
        Ok([material(settings)?, material(six_way)?])
    }
}

impl PuffMaterial {
    /// The same with a shadow ramp.
    pub fn with_shadow(&self, ramp: &Ramp) -> Self {
        let mut shaded = self.clone();
        shaded.settings.shadow.strength = 1.0;
        shaded.assets.shadow_ramp = ramp.clone();
        shaded
    }
}

impl PuffCloud<'_> {
    /// Density at a position: extinction per metre, in units of the medium's.
    fn density(&self, position: Vec3) -> f32 {
        let of_puff = |puff: &Particle| {
            let local = (position - puff.position) / puff.radius;
            let is_inside = local.abs().max_element() < 1.0;
            // Divided by the radius, so that the optical depth through a puff does not depend on its size.
            if is_inside { self.kind.puff(puff.frame as u32).density(local) / puff.radius } else { 0.0 }
        };
        self.particles.iter().map(of_puff).sum()
    }

    /// Fraction of a light that passes straight through the cloud to a position, marched through all densities.
    pub fn transmittance(&self, position: Vec3, to_light: Vec3) -> f32 {
        // The cloud is in a cube with sides of 2 m.
        const STEP: f32 = 0.01;
        let steps = 0..(6.0 / STEP) as u32;
        let depth: f32 = steps.map(|step| self.density(position + to_light * ((step as f32 + 0.5) * STEP))).sum();
        (-depth * STEP * self.kind.medium.density).exp()
    }

    /// Summed densities of all puffs.
    pub fn volume(&self) -> DensityVolume {
        let side = self.kind.path_trace.size;
        let mut all = DensityVolume { size: UVec3::splat(side), densities: vec![0.0; side.pow(3) as usize] };
        for index in 0..all.densities.len() as u32 {
            let voxel = UVec3::new(index % side, index / side % side, index / (side * side));
            all.densities[index as usize] = self.density(all.voxel_center(voxel));
        }
        all
    }

    /// View of the whole cube from the front, without perspective.
    pub fn view(&self) -> View {
        let view = Mat4::from_translation(vec3(0.0, 0.0, -3.0));
        let projection = orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 10.0);
        View::new(view, projection, UVec2::splat(self.kind.path_trace.size))
    }

    /// Path trace of the summed densities of all puffs.
    pub fn truth(&self, lights: &[Vec3]) -> LightImages {
        let PuffKind { medium, path_trace, .. } = self.kind;
        let Ok(traced) = path_trace.run(&self.volume(), medium, lights, |_| Ok::<_, std::convert::Infallible>(()));
        traced.light
    }

    /// The cloud drawn by the CPU renderer, under one light after the other.
    ///
    /// # Errors
    /// If a setting of the material is not valid.
    pub fn drawn(&self, lights: &[Vec3], material: &PuffMaterial) -> Result<LightImages, Error> {
        let size = UVec2::splat(self.kind.path_trace.size);
        let of_light = |to_light: &Vec3| {
            let mut image = Image::new(size, Vec4::ZERO);
            self.prepared(*to_light, material, |frame| frame.render(&mut image))?;
            Ok(Image { size, texels: image.texels.iter().map(|texel| texel.xyz()).collect() })
        };
        lights.iter().map(of_light).collect()
    }

    /// Fraction of the background that the drawn cloud hides.
    ///
    /// # Errors
    /// As [`PuffCloud::drawn`].
    pub fn drawn_coverage(&self, material: &PuffMaterial) -> Result<Image<f32>, Error> {
        let size = UVec2::splat(self.kind.path_trace.size);
        let [black, white] = [Vec4::ZERO, Vec4::ONE].map(|behind| {
            let mut image = Image::new(size, behind);
            self.prepared(Vec3::Z, material, |frame| frame.render(&mut image))?;
            Ok::<_, Error>(image)
        });
        let black = black?;
        let white = white?;
        let texels = black.texels.iter().zip(&white.texels).map(|(black, white)| 1.0 - (white.y - black.y));
        Ok(Image { size, texels: texels.collect() })
    }

    /// Fractions of a light that fall through the cloud onto points of a scene, by the CPU renderer.
    ///
    /// # Errors
    /// If a setting of the material is not valid.
    pub fn drawn_transmittance(
        &self,
        positions: &[Vec3],
        to_light: Vec3,
        material: &PuffMaterial,
    ) -> Result<Vec<Vec3>, Error> {
        self.prepared(to_light, material, |frame| {
            let through =
                |position| frame.scene_shadow().map_or(Vec3::ONE, |shadow| shadow.haze_transmittance(position, 0));
            positions.iter().map(|position| through(*position)).collect()
        })
    }

    /// Calls `f` with the cloud, prepared by the CPU renderer under one light.
    fn prepared<T>(
        &self,
        to_light: Vec3,
        material: &PuffMaterial,
        f: impl FnOnce(&PreparedFrame<'_>) -> T,
    ) -> Result<T, Error> {
        let size = UVec2::splat(self.kind.path_trace.size);
        let view = self.view();
        let systems = [ParticleSystem::new(&self.particles, &material.settings, &material.assets)];
        let light = Light { kind: LightKind::Directional, direction: -to_light, ..Light::default() };
        let scene_depth = Image::new(size, 1.0);
        let frame = FrameInput {
            lights: &[light],
            systems: &systems,
            debug_view: DebugView::Final,
            ..FrameInput::new(view, &scene_depth)
        };
        Ok(f(&PreparedFrame::new(&frame, size)?))
    }

    /// Equations of a shadow ramp: what it multiplies, where it is looked up, and the path trace.
    ///
    /// # Errors
    /// As [`PuffCloud::drawn`].
    pub fn shaded_lights(&self, material: &PuffMaterial, truth: &LightImages) -> Result<Vec<ShadedLight>, Error> {
        let lights = ring_of_lights();
        let unshaded = self.drawn(&lights, material)?;
        // Its value is its first coordinate, which the shaded image then shows.
        let coordinates = Ramp::from_linear(UVec2::new(256, 1), (0..256).map(|x| Vec3::splat(x as f32 / 255.0)));
        let shaded = self.drawn(&lights, &material.with_shadow(&coordinates))?;
        let equations = |(index, to_light): (usize, &Vec3)| {
            let position = |(plain, shaded): (&Vec3, &Vec3)| {
                let across = if plain.y > 1.0e-5 { (shaded.y / plain.y).clamp(0.0, 1.0) } else { 0.0 };
                Vec2::new(across, 0.5 - 0.5 * to_light.z)
            };
            ShadedLight {
                unshaded: unshaded[index].texels.iter().map(|light| *light * material.exposure).collect(),
                positions: unshaded[index].texels.iter().zip(&shaded[index].texels).map(position).collect(),
                truth: truth[index].texels.clone(),
            }
        };
        Ok(lights.iter().enumerate().map(equations).collect())
    }
}
