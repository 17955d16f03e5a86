//! Material of a system for other engines: its ramps as textures, and the formula of its lighting as source code with the
//! preset's numbers.

mod calls;
mod godot_scene;
mod readme;
mod snippet;
mod sources;
mod spatial_shader;
mod sprite_texture;
mod three_js;
mod translation;

use std::path::Path;

use glam::UVec2;
use haze::{FieldError, MaterialAssets};
use haze_core::assets::ramp::Ramp;
use haze_core::error::Error;
use haze_core::formula::color::srgb_from_linear;
use haze_core::settings::DiffuseMode;
use haze_preset::{CompressionEffort, PresetSystem, write_file, write_png};
use image::{DynamicImage, Rgb, RgbImage};

use crate::engine::Engine;
use godot_scene::SCENE;
use snippet::{Snippet, UsedRamp};
use sprite_texture::{SPRITE, SpriteTexture};

/// Files of a material.
pub struct MaterialExport {
    /// File names and texts.
    pub texts: Vec<(String, String)>,
    /// File names and images: ramps in sRGB, for some engines followed by the sprite.
    pub textures: Vec<(String, DynamicImage)>,
}

impl MaterialExport {
    /// Makes the files of one system. `title`: of the preset; `index`: of the system in it; `assets`: the system's images.
    ///
    /// # Errors
    /// [`Error::Field`] if its light does not come from ramps.
    pub fn new(
        title: &str,
        index: usize,
        system: &PresetSystem,
        assets: &MaterialAssets,
        engine: Engine,
    ) -> Result<Self, Error> {
        let settings = &system.settings;
        let refuse = |name: &str, value: &str, expected: &str| {
            let field = format!("systems[{index}].settings.{name}");
            Err(FieldError::new(field, format!("{value:?}"), expected).into())
        };
        if settings.is_six_way() {
            let expected = "\"normals\"; `haze sprite export` writes the six-way maps for engines";
            return refuse("lighting", "six_way", expected);
        }
        if settings.diffuse.mode == DiffuseMode::PaintedMotif {
            let expected = "another mode: an engine's lights do not light a painted motif";
            return refuse("diffuse.mode", "painted_motif", expected);
        }
        let snippet = Snippet::new(settings, engine)?;
        let sprite = SpriteTexture::new(&assets.sprite);
        let sources = sources::sources(engine, settings, &snippet, &sprite)?;
        let mut texts: Vec<_> = sources.into_iter().map(|(name, text)| (name.to_owned(), text)).collect();
        let has_scene = engine == Engine::Godot && !system.particle_files.is_used();
        if has_scene {
            texts.push((SCENE.to_owned(), godot_scene::scene(system, assets, &snippet, sprite.frames)));
        }
        texts.push(("README.md".to_owned(), readme::readme(engine, title, system, &snippet)));
        let first_row_is_at_the_top = engine.first_row_is_at_the_top();
        let ramp = |ramp: &UsedRamp| (ramp.file(), image((ramp.of)(assets), first_row_is_at_the_top).into());
        let mut textures: Vec<(_, DynamicImage)> = snippet.ramps.iter().map(ramp).collect();
        if engine.takes_sprite() {
            textures.push((SPRITE.to_owned(), sprite.image.into()));
        }
        if engine == Engine::Godot {
            let settings = |(name, _): &(String, _)| (format!("{name}.import"), godot_scene::import_settings(name));
            texts.extend(textures.iter().map(settings));
        }
        Ok(Self { texts, textures })
    }

    /// Returns the names of all files.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        let texts = self.texts.iter().map(|(name, _)| name.as_str());
        texts.chain(self.textures.iter().map(|(name, _)| name.as_str()))
    }

    /// Writes the files into a folder.
    ///
    /// # Errors
    /// [`AssetError::Io`](haze_core::error::AssetError::Io) for the first file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        for (name, text) in &self.texts {
            write_file(&folder.join(name), text.as_bytes())?;
        }
        for (name, texture) in &self.textures {
            write_png(&folder.join(name), texture, CompressionEffort::Small)?;
        }
        Ok(())
    }
}

/// Image of a ramp, sRGB.
fn image(ramp: &Ramp, first_row_is_at_the_top: bool) -> RgbImage {
    let size = ramp.size();
    RgbImage::from_fn(size.x, size.y, |x, y| {
        let row = if first_row_is_at_the_top { y } else { size.y - 1 - y };
        let color = ramp.texel(UVec2::new(x, row)).to_array();
        Rgb(color.map(|channel| (srgb_from_linear(channel.clamp(0.0, 1.0)) * 255.0).round() as u8))
    })
}

#[cfg(test)]
mod tests;
