//! Images of one preset: each is decoded once, and their total size is limited.

use std::collections::HashMap;
use std::hash::Hash;
use std::path::{Path, PathBuf};

use haze_core::assets::noise::NoiseVolume;
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::{AssetError, FieldError};

use super::builtin::Builtin;
use super::image_source::ImageSource;

/// Maximum memory of the images of a preset, bytes. An image counts for every field that names it, because renderers
/// upload it for each.
pub const MAX_IMAGE_BYTES: u64 = 1 << 30;

/// Images loaded so far, by file.
pub struct ImageCache<'a> {
    source: ImageSource<'a>,
    ramps: HashMap<PathBuf, Ramp>,
    sprites: HashMap<(PathBuf, SpriteLayout), Sprite>,
    noises: HashMap<PathBuf, NoiseVolume>,
    /// Built-in sprites with their detail maps, by name.
    builtin_sprites: HashMap<&'static str, (Sprite, Option<Sprite>)>,
    /// Built-in noises, by name.
    builtin_noises: HashMap<&'static str, NoiseVolume>,
    bytes: u64,
}

impl<'a> ImageCache<'a> {
    /// Nothing loaded yet.
    pub fn new(source: ImageSource<'a>) -> Self {
        let (ramps, sprites, noises) = Default::default();
        let (builtin_sprites, builtin_noises) = Default::default();
        Self { source, ramps, sprites, noises, builtin_sprites, builtin_noises, bytes: 0 }
    }

    /// Loads the ramp of this file, for a field of the material.
    pub fn ramp(&mut self, field: &str, file: &Path) -> Result<Ramp, AssetError> {
        self.count(field, 0)?;
        let source = &mut self.source;
        let load = |file: &PathBuf| source.read(file).and_then(|(path, bytes)| Ramp::decode(&path, &bytes));
        let ramp = get_or_load(&mut self.ramps, file.into(), load);
        let ramp = ramp.map_err(|error| named_by(field, error))?;
        self.count(field, ramp.memory())?;
        Ok(ramp)
    }

    /// Loads the sprite of this file.
    pub fn sprite(&mut self, field: &str, file: &Path, layout: SpriteLayout) -> Result<Sprite, AssetError> {
        self.count(field, 0)?;
        let source = &mut self.source;
        let load = |(file, layout): &(PathBuf, SpriteLayout)| {
            source.read(file).and_then(|(path, bytes)| Sprite::decode(&path, &bytes, *layout))
        };
        let sprite =
            get_or_load(&mut self.sprites, (file.into(), layout), load).map_err(|error| named_by(field, error))?;
        self.count(field, sprite.memory())?;
        Ok(sprite)
    }

    /// Loads the noise of this file.
    pub fn noise(&mut self, field: &str, file: &Path) -> Result<NoiseVolume, AssetError> {
        self.count(field, 0)?;
        let source = &mut self.source;
        let load = |file: &PathBuf| source.read(file).and_then(|(path, bytes)| NoiseVolume::decode(&path, &bytes));
        let noise = get_or_load(&mut self.noises, file.into(), load);
        let noise = noise.map_err(|error| named_by(field, error))?;
        self.count(field, noise.memory())?;
        Ok(noise)
    }

    /// Decodes a built-in sprite and its detail map.
    pub fn builtin_sprite(&mut self, sprite: &'static Builtin) -> Result<(Sprite, Option<Sprite>), AssetError> {
        get_or_load(&mut self.builtin_sprites, sprite.name, |_| Ok((sprite.sprite()?, sprite.detail()?)))
    }

    /// Decodes a built-in noise.
    pub fn builtin_noise(&mut self, noise: &'static Builtin) -> Result<NoiseVolume, AssetError> {
        get_or_load(&mut self.builtin_noises, noise.name, |_| noise.noise())
    }

    /// Counts bytes. Fails above the limit, after which nothing is decoded.
    fn count(&mut self, field: &str, bytes: u64) -> Result<(), FieldError> {
        self.bytes += bytes;
        if self.bytes <= MAX_IMAGE_BYTES {
            return Ok(());
        }
        let [found, most] = [self.bytes, MAX_IMAGE_BYTES].map(|bytes| bytes >> 20);
        let problem = format!("up to this one, the images of the preset take {found} MiB");
        let expected = format!("at most {most} MiB, each image counted as often as it is named");
        Err(FieldError::from_problem(format!("material.{field}"), problem, expected))
    }
}

fn get_or_load<K: Hash + Eq, T: Clone>(
    loaded: &mut HashMap<K, T>,
    key: K,
    load: impl FnOnce(&K) -> Result<T, AssetError>,
) -> Result<T, AssetError> {
    if let Some(image) = loaded.get(&key) {
        return Ok(image.clone());
    }
    let image = load(&key)?;
    loaded.insert(key, image.clone());
    Ok(image)
}

/// Adds the field of the preset that names it to the error of an image.
fn named_by(field: &str, error: AssetError) -> AssetError {
    AssetError::Named { named_by: format!("material.{field}"), error: Box::new(error) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset_folders::AssetFolders;
    use crate::builtin;

    #[test]
    fn a_file_is_read_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = Path::new("own.png");
        let path = folder.path().join(file);
        let layout = SpriteLayout::default();
        image::RgbaImage::new(1, 1).save(&path).unwrap();
        let mut images = ImageCache::new(ImageSource::Folders(AssetFolders::new(folder.path())));
        let ramp = images.ramp("motif", file).unwrap();
        let noise = images.noise("noise", file).unwrap();
        let sprite = images.sprite("sprite", file, layout).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(images.ramp("age_ramp", file).unwrap(), ramp);
        assert_eq!(images.noise("noise", file).unwrap(), noise);
        assert_eq!(images.sprite("detail", file, layout).unwrap(), sprite);
        // The ramp has four half floats a texel, the noise and the sprite four bytes.
        assert_eq!(images.bytes, 2 * (8 + 4 + 4));
        let other = SpriteLayout { y_down: true, ..layout };
        let error = images.sprite("sprite", file, other).unwrap_err().to_string();
        assert!(error.starts_with("material.sprite: ") && error.contains("own.png: No such file"), "{error}");
    }

    #[test]
    fn built_in_images_are_decoded_once() {
        let mut images = ImageCache::new(ImageSource::Folders(AssetFolders::new(Path::new(""))));
        let puff = builtin::find(builtin::SPRITES, "puff").unwrap();
        let [(first, _), (again, _)] = [(); 2].map(|()| images.builtin_sprite(puff).unwrap());
        assert!(first.shares_memory(&again));
        let noise = &builtin::NOISES[0];
        let [first, again] = [(); 2].map(|()| images.builtin_noise(noise).unwrap());
        assert!(first.shares_memory(&again));
    }
}
