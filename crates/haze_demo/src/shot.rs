//! A preset with its images and particle files loaded, independent of the renderer.

use std::borrow::Cow;
use std::path::Path;

use glam::{UVec2, Vec3};
use haze_core::assets::material_assets::MaterialAssets;
use haze_core::error::{AssetError, Error};
use haze_core::fire::FireLight;
use haze_core::frame::{EmitterPaths, EmitterSnapshot, Light, MAX_LIGHTS, Particle};
use haze_core::settings::{DebugView, Settings};
use haze_preset::{AssetFolders, Camera, Preset, PresetSystem, system_list};

use super::heat_haze::HeatHaze;
use super::particle_scalar::ShownScalar;
use super::scene::Scene;
use super::shadow_views::{ShadowView, shadow_views};
use haze_author::backdrop::Backdrop;
use haze_author::particle_files::{self, ParticleFrames, load_particle_files};

/// An emitter with more births than this is evaluated on the GPU.
const MAX_CPU_BIRTHS: u32 = 1 << 14;

/// Source of a system's particles.
pub(super) enum ParticleSource {
    Particles(Vec<Particle>),
    EmitterSnapshot(Box<EmitterSnapshot>),
}

/// A preset with its images and particle files loaded.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The preset. May be changed between frames.
    pub preset: Preset,
    /// Image size, pixels.
    pub size: UVec2,
    /// The debug view that is shown.
    pub debug_view: DebugView,
    /// Images, one entry per system.
    pub materials: Vec<MaterialAssets>,
    /// Particle files, one entry per system. `None` if the system uses its emitter.
    pub caches: Vec<Option<ParticleFrames>>,
    /// Scene and sky from files.
    pub backdrop: Backdrop,
    /// Number that takes the place of the particles' tints; see [`Shot::showing`].
    pub shown_scalar: Option<ShownScalar>,
}

impl Shot {
    /// Loads a preset, built in or from a file, with its images and particle files.
    ///
    /// # Errors
    /// As [`Preset::load`] and [`Shot::new`].
    pub fn load(name_or_path: impl AsRef<Path>, size: UVec2) -> Result<Self, Error> {
        let path = name_or_path.as_ref();
        Self::new(Preset::load(path)?, path, size)
    }

    /// Loads the files that a preset names, relative to the folder of `path`.
    ///
    /// # Errors
    /// As [`Preset::load_materials`], [`particle_files::load_particle_files`] and [`Backdrop::load`].
    pub fn new(preset: Preset, path: &Path, size: UVec2) -> Result<Self, Error> {
        Self::from_folders(preset, path, &AssetFolders::for_preset_file(path), size)
    }

    /// Loads the files that a preset names from the given folders.
    ///
    /// # Errors
    /// As [`Shot::new`].
    pub fn from_folders(preset: Preset, path: &Path, folders: &AssetFolders, size: UVec2) -> Result<Self, Error> {
        let materials = preset.load_materials_from(path, folders)?;
        for (index, (system, material)) in preset.systems.iter().zip(&materials).enumerate() {
            let fits = material.info().validate(index, &system.settings);
            fits.map_err(|error| Error::from(AssetError::JsonField { path: path.into(), error }))?;
        }
        let caches = load_particle_files(&preset, path, folders)?;
        let backdrop = Backdrop::load(&preset, path, folders)?;
        Ok(Self { preset, size, debug_view: DebugView::Final, materials, caches, backdrop, shown_scalar: None })
    }

    /// Removes all systems but one.
    pub fn keep_only_system(&mut self, index: usize) {
        system_list::keep_only(&mut self.preset, index);
        self.materials = self.materials.drain(..).skip(index).take(1).collect();
        self.caches = self.caches.drain(..).skip(index).take(1).collect();
    }

    /// The shot at the time of its preset: its settings have the values of their tracks, and the ambient colors of smoke those
    /// of its sky. Renderers call it; call it before settings are changed for one image, because tracks replace them.
    pub fn at_its_time(&self) -> Cow<'_, Self> {
        let is_lit_by_sky = self.backdrop.sky.is_some();
        if self.preset.animation.is_empty() && !is_lit_by_sky {
            return Cow::Borrowed(self);
        }
        let mut preset = self.preset.evaluate(self.preset.time);
        if let Some(sky) = self.backdrop.sky.as_ref().filter(|_| preset.environment.sky_light) {
            // As systems clamp them: colors of a preset go up to 100.
            let light = sky.light.scaled(preset.environment.sky_exposure.exp2()).hemispheres();
            let [sky, ground] = light.map(|light| light.min(Vec3::splat(100.0)));
            for system in &mut preset.systems {
                system.settings.ambient.sky_color = sky;
                system.settings.ambient.ground_color = ground;
            }
        }
        Cow::Owned(Self {
            preset,
            size: self.size,
            debug_view: self.debug_view,
            materials: self.materials.clone(),
            caches: self.caches.clone(),
            backdrop: self.backdrop.clone(),
            shown_scalar: self.shown_scalar,
        })
    }

    /// True if both give the same image before tonemapping; exposure is ignored. Cheap: images and particles from files
    /// are compared by address.
    pub fn has_same_image(&self, other: &Self) -> bool {
        let shares = |(a, b): (&MaterialAssets, &MaterialAssets)| a.shares_memory(b);
        let own = self.preset.camera;
        let differs_only_in_display = || {
            let mut preset = other.preset.clone();
            preset.camera = Camera { exposure: own.exposure, tonemap: own.tonemap, ..preset.camera };
            preset == self.preset
        };
        let of_other = other.preset.camera;
        let has_same_display = own.exposure.to_bits() == of_other.exposure.to_bits() && own.tonemap == of_other.tonemap;
        (self.size, self.debug_view, self.shown_scalar) == (other.size, other.debug_view, other.shown_scalar)
            && (self.preset == other.preset || !has_same_display && differs_only_in_display())
            && self.materials.len() == other.materials.len()
            && self.materials.iter().zip(&other.materials).all(shares)
            && self.backdrop == other.backdrop
            && ParticleFrames::share_all_memory(&self.caches, &other.caches)
    }

    /// Fraction of the light that the camera's lens spreads. Only the final image has bloom.
    pub(super) fn bloom(&self) -> f32 {
        if self.shows_scene() && self.shown_scalar.is_none() { self.preset.camera.bloom } else { 0.0 }
    }

    /// True if edges of the final image are smooth.
    pub(super) fn antialiasing(&self) -> bool {
        self.shows_scene() && self.shown_scalar.is_none() && self.preset.camera.antialiasing
    }

    /// Hot air in the final image. `lights`: as from [`lights`](Self::lights).
    pub(super) fn heat_haze(&self, lights: &[Light]) -> Option<HeatHaze> {
        if !self.shows_scene() || self.shown_scalar.is_some() {
            return None;
        }
        let camera = &self.preset.camera;
        let fires = lights.get(self.preset.lights.len()..).unwrap_or_default();
        HeatHaze::new(&camera.view(self.size), fires, camera.heat_haze, self.preset.time)
    }

    /// True if the scene is visible. Debug views other than the final image are shown on black.
    pub(super) fn shows_scene(&self) -> bool {
        self.debug_view == DebugView::Final
    }

    /// Shadow maps of the preset's lights, if the scene shades smoke. Fires have none: their lights move in every frame.
    pub(super) fn shadow_views(&self) -> Vec<ShadowView> {
        let by_depth = self.preset.systems.iter().any(|system| system.settings.receives_shadow_by_depth());
        if by_depth { shadow_views(&self.preset.lights, self.mesh_bounds()) } else { Vec::new() }
    }

    /// Corners of the box around the scene from a file, metres.
    fn mesh_bounds(&self) -> Option<(Vec3, Vec3)> {
        let (min, max) = self.backdrop.mesh()?.bounds()?;
        let scale = self.preset.environment.scene_scale;
        Some((min * scale, max * scale))
    }

    /// Returns the lights of the preset, followed by those of its fires.
    pub fn lights(&self) -> Vec<Light> {
        self.lights_along(&mut self.paths())
    }

    /// Returns new paths of the particles, one for each system.
    pub(super) fn paths(&self) -> Vec<EmitterPaths> {
        vec![EmitterPaths::default(); self.preset.systems.len()]
    }

    /// [`lights`](Self::lights) for frame after frame, along the paths of the sampled particles of each system.
    pub(super) fn lights_along(&self, paths: &mut [EmitterPaths]) -> Vec<Light> {
        let mut lights = self.preset.lights.clone();
        let time = self.preset.time;
        let fires =
            self.preset.systems.iter().zip(&self.materials).zip(paths).enumerate().filter_map(|(index, of_system)| {
                let ((system, assets), paths) = of_system;
                let settings = &system.settings;
                if !settings.burns() {
                    return None;
                }
                let files = self.caches.get(index).and_then(Option::as_ref);
                let mut particles = Vec::new();
                let step = match particle_files::emission(system, files, time) {
                    Some(emission) => {
                        emission.sample_along(paths, &mut particles);
                        emission.step
                    }
                    None => {
                        particle_files::particles(system, files, time, &mut particles);
                        1
                    }
                };
                let seed = system.emitter.seed;
                FireLight { particles: &particles, particles_per_sample: step, settings, assets, time, seed }.estimate()
            });
        lights.extend(fires);
        lights.truncate(MAX_LIGHTS);
        lights
    }

    pub(super) fn scene(&self) -> Scene {
        Scene::new(&self.preset.environment, &self.lights(), &self.backdrop)
    }

    /// Evaluates the particles and settings of every system, in order.
    pub(super) fn systems(&self) -> Vec<(Vec<Particle>, Settings)> {
        self.each_system(&mut self.paths(), |system, cache, paths| {
            let mut particles = Vec::new();
            self.evaluate(system, cache, paths, &mut particles);
            particles
        })
    }

    /// Returns particles and settings of every system for the GPU renderer. Emitters with many particles are not
    /// evaluated here but on the GPU. `paths`: those of the particles of each system.
    pub(super) fn sources(&self, paths: &mut [EmitterPaths]) -> Vec<(ParticleSource, Settings)> {
        self.each_system(paths, |system, cache, paths| {
            match particle_files::emission(system, cache, self.preset.time) {
                Some(emission) if emission.count() > MAX_CPU_BIRTHS && self.shown_scalar.is_none() => {
                    ParticleSource::EmitterSnapshot(Box::new(emission))
                }
                _ => {
                    let mut particles = Vec::new();
                    self.evaluate(system, cache, paths, &mut particles);
                    ParticleSource::Particles(particles)
                }
            }
        })
    }

    fn evaluate(
        &self,
        system: &PresetSystem,
        cache: Option<&ParticleFrames>,
        paths: &mut EmitterPaths,
        particles: &mut Vec<Particle>,
    ) {
        particle_files::particles_along(system, cache, self.preset.time, paths, particles);
        if let Some(shown) = &self.shown_scalar {
            let displacements = self.displacements(system, cache, particles, shown.scalar.seconds());
            shown.apply(particles, &displacements, &self.preset.camera.view(self.size));
        }
    }

    /// Ways of the particles of a system in the next `seconds`, metres. Those of files follow their velocities.
    pub(super) fn displacements(
        &self,
        system: &PresetSystem,
        cache: Option<&ParticleFrames>,
        particles: &[Particle],
        seconds: f32,
    ) -> Vec<Vec3> {
        if cache.is_some() && system.particle_files.is_used() {
            return particles.iter().map(|particle| particle.velocity * seconds).collect();
        }
        let mut displacements = Vec::new();
        system.emitter.displacements(self.preset.time, seconds, &mut displacements);
        displacements
    }

    fn each_system<T>(
        &self,
        paths: &mut [EmitterPaths],
        source: impl Fn(&PresetSystem, Option<&ParticleFrames>, &mut EmitterPaths) -> T,
    ) -> Vec<(T, Settings)> {
        let systems = self.preset.systems.iter().zip(paths).enumerate();
        let source = |(index, (system, paths)): (usize, (&PresetSystem, &mut EmitterPaths))| {
            let cache = self.caches.get(index).and_then(Option::as_ref);
            (source(system, cache, paths), system.settings)
        };
        systems.map(source).collect()
    }
}
