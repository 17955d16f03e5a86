//! Shelf of layers: particle systems to add to a preset, such as sparks to a fire.

use std::path::Path;
use std::sync::LazyLock;

use haze_core::emitter::Emitter;
use haze_core::error::FieldError;
use haze_core::glam::Vec3;

use super::builtin;
use super::preset_file::{Preset, PresetSystem};

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
}

impl Layer {
    /// The system with the origin moved to a position, metres.
    #[must_use]
    pub fn at(&self, position: Vec3) -> PresetSystem {
        let mut system = self.system.clone();
        let emitter = &mut system.emitter;
        emitter.position += position;
        emitter.attractor += position;
        emitter.obstacle += position;
        emitter.floor += position.dot(emitter.up.normalize_or(Vec3::Y));
        system
    }

    /// The system at the source of another one. The floor stays: layers that flow along it are put on the ground below.
    #[must_use]
    pub fn at_source(&self, source: &Emitter) -> PresetSystem {
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
    let Preset { name: title, description, systems, .. } = Preset::parse(Path::new(file.name), text).ok()?;
    let name = file.name.rsplit('/').next()?;
    Some(Layer { name, title, description, system: systems.into_iter().next()? })
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
        }
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
