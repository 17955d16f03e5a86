//! Shelf of layers: particle systems to add to a preset, such as sparks to a fire.

use std::path::Path;
use std::sync::LazyLock;

use haze_core::emitter::Emitter;
use haze_core::error::FieldError;
use haze_core::glam::Vec3;

use super::preset_file::{Preset, PresetSystem};
use super::{Camera, builtin, system_list};

/// Particle system that stands at the origin, on the ground, and is about a metre large.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Layer {
    /// Name on a command line: `ground_dust`.
    pub name: &'static str,
    /// Name shown in lists: "Ground dust".
    pub title: String,
    /// Description in one line.
    pub description: String,
    system: PresetSystem,
    /// Its heat haze and its antialiasing are what the layer needs of a camera.
    camera: Camera,
}

impl Layer {
    /// Adds the system to a preset, with the origin moved to a position, metres. The camera gets what the layer needs.
    ///
    /// # Errors
    /// If the preset has [`MAX_SYSTEMS`](crate::MAX_SYSTEMS) systems, or is not valid with one more. It then stays as it was.
    pub fn add_at(&self, preset: &mut Preset, position: Vec3) -> Result<(), FieldError> {
        self.add(preset, self.at(position))
    }

    /// As [`add_at`](Self::add_at), at the source of another system. The floor stays: layers that flow along it are put on the
    /// ground below.
    ///
    /// # Errors
    /// As [`add_at`](Self::add_at).
    pub fn add_at_source(&self, preset: &mut Preset, source: &Emitter) -> Result<(), FieldError> {
        self.add(preset, self.at_source(source))
    }

    fn add(&self, preset: &mut Preset, system: PresetSystem) -> Result<(), FieldError> {
        system_list::add(preset, system)?;
        preset.camera.antialiasing |= self.camera.antialiasing;
        preset.camera.heat_haze = preset.camera.heat_haze.max(self.camera.heat_haze);
        Ok(())
    }

    fn at(&self, position: Vec3) -> PresetSystem {
        let mut system = self.system.clone();
        let emitter = &mut system.emitter;
        emitter.position += position;
        emitter.attractor += position;
        emitter.obstacle += position;
        emitter.floor += position.dot(emitter.up.normalize_or(Vec3::Y));
        system
    }

    fn at_source(&self, source: &Emitter) -> PresetSystem {
        let mut system = self.at(source.position.with_y(0.0));
        let emitter = &mut system.emitter;
        if emitter.floor_margin <= 0.0 {
            let height = source.position * Vec3::Y;
            emitter.position += height;
            emitter.attractor += height;
        }
        system
    }
}

/// Returns all layers, in the order of the shelf.
pub fn layers() -> &'static [Layer] {
    static LAYERS: LazyLock<Vec<Layer>> = LazyLock::new(|| builtin::LAYERS.iter().filter_map(parse).collect());
    &LAYERS
}

/// Finds a layer by its name on a command line. `option`: the argument that has the name, for the error.
///
/// # Errors
/// [`FieldError`] with the names that exist.
pub fn find_layer(option: &str, name: &str) -> Result<&'static Layer, FieldError> {
    layers().iter().find(|layer| layer.name == name).ok_or_else(|| {
        let names: Vec<_> = layers().iter().map(|layer| layer.name).collect();
        FieldError::new(option, format!("{name:?}"), format!("one of {}", names.join(", ")))
    })
}

/// A test shows that all layers can be parsed.
fn parse(file: &builtin::Builtin) -> Option<Layer> {
    let text = std::str::from_utf8(file.bytes).ok()?;
    let Preset { name: title, description, systems, camera, .. } = Preset::parse(Path::new(file.name), text).ok()?;
    let name = file.name.rsplit('/').next()?;
    Some(Layer { name, title, description, system: systems.into_iter().next()?, camera })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layer_is_a_preset_of_one_system_as_it_is_written() {
        assert_eq!(layers().len(), builtin::LAYERS.len());
        for (layer, file) in layers().iter().zip(builtin::LAYERS) {
            let text = std::str::from_utf8(file.bytes).unwrap();
            let preset = Preset::parse(Path::new(file.name), text).unwrap();
            assert_eq!(preset.to_json(text), text, "{}", file.name);
            assert_eq!((preset.systems.len(), preset.animation.len()), (1, 0), "{}", file.name);
            assert!(!layer.title.is_empty() && layer.description.len() > 10, "{}", file.name);
            assert_eq!(find_layer("LAYER", layer.name).unwrap().title, layer.title);
            // At the origin, on the ground.
            let Emitter { position, size, .. } = layer.system.emitter;
            assert!(position.with_y(0.0) == Vec3::ZERO && (0.0..1.0).contains(&position.y), "{}", file.name);
            assert!((0.5..=1.0).contains(&size), "{}", file.name);
            let Camera { antialiasing, heat_haze, .. } = layer.camera;
            assert_eq!(layer.camera, Camera { antialiasing, heat_haze, ..Camera::default() }, "{}", file.name);
        }
    }

    #[test]
    fn the_camera_gets_what_a_layer_needs_and_loses_nothing() {
        let shimmer = find_layer("LAYER", "heat_shimmer").unwrap();
        let mut preset = Preset::default();
        preset.camera.antialiasing = true;
        shimmer.add_at(&mut preset, Vec3::ZERO).unwrap();
        assert!(preset.camera.heat_haze > 0.0 && preset.camera.antialiasing);
        preset.camera.heat_haze = 1.0;
        shimmer.add_at(&mut preset, Vec3::X).unwrap();
        assert!(preset.camera.heat_haze > 0.99);
        let mut still = Preset::default();
        find_layer("LAYER", "smoke").unwrap().add_at(&mut still, Vec3::ZERO).unwrap();
        assert_eq!(still.camera, Preset::default().camera);
    }

    #[test]
    fn all_points_of_a_layer_move_and_those_on_the_ground_stay_there() {
        let wisps = find_layer("LAYER", "magic_wisps").unwrap();
        let offset = Vec3::new(1.0, 2.0, 3.0);
        let moved = wisps.at(offset).emitter;
        assert_eq!(moved.position, wisps.system.emitter.position + offset);
        assert_eq!(moved.attractor, wisps.system.emitter.attractor + offset);
        let source = Emitter { position: offset, ..Emitter::default() };
        assert_eq!(wisps.at_source(&source).emitter.position, moved.position);
        let ring = find_layer("LAYER", "shock_ring").unwrap();
        let on_roof = ring.at(offset).emitter;
        assert!((on_roof.floor - ring.system.emitter.floor - 2.0).abs() < 1.0e-6);
        let below = ring.at_source(&source).emitter;
        assert_eq!(below.position, ring.system.emitter.position + offset.with_y(0.0));
        assert!((below.floor - ring.system.emitter.floor).abs() < 1.0e-6);
    }
}
