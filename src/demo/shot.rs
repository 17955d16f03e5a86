//! A preset as a picture: scene and smoke, by the GPU or by the CPU.

use std::path::{Path, PathBuf};

use glam::{UVec2, Vec4};

use super::stage::Stage;
use super::{Scene, cpu};
use crate::error::Error;
use crate::headless::Headless;
use crate::material::MaterialAssets;
use crate::particle::Particle;
use crate::preset::Preset;
use crate::reference;
use crate::reference::picture::Picture;
use crate::settings::{Settings, ShadeTree};

/// A preset with its pictures loaded.
#[derive(Clone, Debug)]
pub struct Shot {
    /// The preset; change it freely.
    pub preset: Preset,
    /// Picture size.
    pub size: UVec2,
    /// Which stage of the shading is shown.
    pub shade_tree: ShadeTree,
    /// One per system.
    pub materials: Vec<MaterialAssets>,
}

impl Shot {
    /// Loads a preset, built in or from a file, and its pictures.
    ///
    /// # Errors
    /// As [`Preset::load`] and [`MaterialNames::load`](crate::preset::MaterialNames::load).
    pub fn load(name_or_path: &str, size: UVec2) -> Result<Self, Error> {
        Self::new(Preset::load(name_or_path)?, Path::new(name_or_path), size)
    }

    /// Loads the pictures of a preset, which are looked for beside `path`.
    ///
    /// # Errors
    /// As [`MaterialNames::load`](crate::preset::MaterialNames::load).
    pub fn new(preset: Preset, path: &Path, size: UVec2) -> Result<Self, Error> {
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        let load = |(index, system): (usize, &crate::preset::PresetSystem)| {
            system.material.load(&folder).map_err(|error| match error {
                Error::Field(mut error) => {
                    error.field = format!("systems[{index}].{}", error.field);
                    Error::JsonField { path: path.into(), error }
                }
                other => other,
            })
        };
        let materials: Vec<_> = preset.systems.iter().enumerate().map(load).collect::<Result<_, _>>()?;
        for (index, (system, material)) in preset.systems.iter().zip(&materials).enumerate() {
            let fits = material.info().validate(index, &system.settings);
            fits.map_err(|error| Error::JsonField { path: path.into(), error })?;
        }
        Ok(Self { preset, size, shade_tree: ShadeTree::Final, materials })
    }

    /// True if the smoke is shown in the scene; the other stages are shown on black.
    pub(super) fn shows_scene(&self) -> bool {
        self.shade_tree == ShadeTree::Final
    }

    pub(super) fn scene(&self) -> Scene {
        Scene::new(self.preset.environment.scene, &self.preset.environment, &self.preset.lights)
    }

    /// Particles and settings of every system, in order.
    pub(super) fn systems(&self) -> Vec<(Vec<Particle>, Settings)> {
        let evaluate = |system: &crate::preset::PresetSystem| {
            let mut particles = Vec::new();
            system.particles(self.preset.time, &mut particles);
            (particles, system.settings_for(self.size.y))
        };
        self.preset.systems.iter().map(evaluate).collect()
    }

    /// Renders on the CPU, linear HDR.
    ///
    /// # Errors
    /// [`Error::Field`] when the preset was changed to something invalid.
    pub fn render_on_cpu(&self) -> Result<Picture<Vec4>, Error> {
        let view = self.preset.camera.view(self.size);
        let (mut colour, depth) = cpu::render(&self.scene(), &view);
        if !self.shows_scene() {
            colour.texels.fill(Vec4::W);
        }
        let particles = self.systems();
        let systems: Vec<_> = particles
            .iter()
            .zip(&self.materials)
            .map(|((particles, settings), material)| reference::renderer::System {
                particles,
                bounds: None,
                settings,
                material,
            })
            .collect();
        let frame = reference::renderer::Frame {
            view,
            scene_depth: &depth,
            lights: &self.preset.lights,
            systems: &systems,
            time: self.preset.time,
            shade_tree: self.shade_tree,
        };
        reference::renderer::render(&frame, &mut colour)?;
        Ok(colour)
    }

    /// Renders on the GPU, linear HDR. `exact_filtering` as in [`Descriptor`](crate::Descriptor).
    ///
    /// # Errors
    /// [`Error::Field`] when the preset was changed to something invalid or a picture is too large for the device,
    /// [`Error::Device`] when the device failed.
    pub fn render_on_gpu(&self, gpu: &Headless, exact_filtering: bool) -> Result<Picture<Vec4>, Error> {
        let mut stage = Stage::new(gpu, self, exact_filtering)?;
        stage.draw(self)?;
        stage.picture()
    }
}
