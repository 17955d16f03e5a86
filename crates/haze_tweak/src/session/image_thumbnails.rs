//! Thumbnails of the images that a material can use. A worker thread decodes each once.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use eframe::egui::{self, Color32, ColorImage, TextureHandle, TextureOptions};
use glam::{UVec3, Vec3, Vec4Swizzles};
use haze_core::assets::image::{decode_color_png, decode_png};
use haze_core::assets::noise;
use haze_core::assets::sprite::Sprite;
use haze_core::error::{Error, builtin_path};
use haze_core::settings::ImageRole;
use haze_preset::builtin::{self, Builtin};
use image::imageops::{self, FilterType};

use crate::platform::file_io::{self, Stamp};
use crate::platform::worker::Worker;

/// Size of a thumbnail, pixels.
pub const SIZE: [usize; 2] = [72, 48];

/// Largest number of files that a folder offers.
const MAX_FILES: usize = 64;

/// Interval in which a folder is listed again while its files are shown, seconds.
const LIST_INTERVAL: f64 = 1.0;

type Key = (u8, String);
type Decoded = (Key, Option<ColorImage>);

/// Cache of thumbnails, shared by the panels.
#[derive(Default)]
pub struct ImageThumbnails(RefCell<Inner>);

#[derive(Default)]
struct Inner {
    worker: Option<Worker<Decoded>>,
    thumbs: HashMap<Key, Thumb>,
    /// Folders with files; empty for a built-in preset without a shared folder.
    folders: Vec<PathBuf>,
    /// PNG files in the folders, and the time when they were listed, seconds.
    files: Vec<String>,
    listed: Option<f64>,
}

/// Thumbnail of one image.
struct Thumb {
    /// Stamp of the image file.
    stamp: Option<Stamp>,
    /// `None` while it is decoded, and if it cannot be decoded.
    texture: Option<TextureHandle>,
}

impl ImageThumbnails {
    /// Sets the folders to the preset's own, followed by the shared one.
    pub fn follow(&self, preset: &Path, assets: Option<&Path>) {
        let own = preset.extension().map(|_| preset.parent().unwrap_or(Path::new("")));
        let is_same = |inner: &Inner| inner.folders.iter().map(PathBuf::as_path).eq(own.into_iter().chain(assets));
        let mut inner = self.0.borrow_mut();
        if !is_same(&inner) {
            let folders = own.into_iter().chain(assets).map(Path::to_owned).collect();
            *inner = Inner { worker: inner.worker.take(), folders, ..Inner::default() };
        }
    }

    /// Returns names of images for a role: files first, then the many built-in ones.
    pub fn names(&self, context: &egui::Context, role: ImageRole) -> Vec<String> {
        let now = context.input(|input| input.time);
        let inner = &mut *self.0.borrow_mut();
        if inner.listed.is_none_or(|listed| now - listed > LIST_INTERVAL) {
            inner.listed = Some(now);
            inner.files = inner.folders.iter().flat_map(|folder| pngs(folder)).collect();
            inner.files.sort();
            inner.files.dedup();
            // Files that have changed since are decoded again.
            let Inner { folders, thumbs, .. } = inner;
            let stamp = |name: &str| file(folders, name).and_then(|path| Stamp::of(&path));
            thumbs.retain(|(_, name), thumb| thumb.stamp.is_none() || thumb.stamp == stamp(name));
        }
        let builtins = builtin::for_role(role).iter().map(|builtin| builtin.name.to_owned());
        inner.files.iter().cloned().chain(builtins).collect()
    }

    /// Returns the thumbnail of an image, once it is decoded.
    pub fn texture(&self, context: &egui::Context, role: ImageRole, name: &str) -> Option<egui::TextureId> {
        let inner = &mut *self.0.borrow_mut();
        while let Some(Some((key, image))) = inner.worker.as_ref().and_then(Worker::poll) {
            if let Some((thumb, image)) = inner.thumbs.get_mut(&key).zip(image) {
                thumb.texture = Some(context.load_texture(&key.1, image, TextureOptions::LINEAR));
            }
        }
        let key = (role as u8, name.to_owned());
        if let Some(thumb) = inner.thumbs.get(&key) {
            return thumb.texture.as_ref().map(TextureHandle::id);
        }
        let source = match builtin::find(builtin::for_role(role), name) {
            Some(builtin) => ImageSource::Builtin(builtin),
            None => ImageSource::File(file(&inner.folders, name)?),
        };
        let stamp = if let ImageSource::File(path) = &source { Stamp::of(path) } else { None };
        inner.thumbs.insert(key.clone(), Thumb { stamp, texture: None });
        if inner.worker.is_none() {
            let context = context.clone();
            // Without a thread, only names are shown.
            inner.worker = Worker::new("thumbnails", move || context.request_repaint()).ok();
        }
        let worker = inner.worker.as_ref()?;
        worker.submit(move |_| (key, thumbnail(role, &source).ok()));
        None
    }
}

/// Returns the path in the first folder that has the file.
fn file(folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    folders.iter().map(|folder| folder.join(name)).find(|path| file_io::exists(path))
}

/// Returns the PNG files in a folder.
fn pngs(folder: &Path) -> Vec<String> {
    let is_png = |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    let name = |path: PathBuf| Some(path.file_name()?.to_str()?.to_owned());
    file_io::list(folder).into_iter().filter(is_png).filter_map(name).take(MAX_FILES).collect()
}

enum ImageSource {
    Builtin(&'static Builtin),
    File(PathBuf),
}

fn thumbnail(role: ImageRole, source: &ImageSource) -> Result<ColorImage, Error> {
    match (role, source) {
        (ImageRole::Sprite, ImageSource::Builtin(builtin)) => Ok(puff(&builtin.sprite()?)),
        (ImageRole::Noise, ImageSource::Builtin(builtin)) => Ok(slice(&builtin.noise()?)),
        (_, ImageSource::Builtin(builtin)) => decoded(role, &builtin_path(builtin.name), builtin.bytes),
        (_, ImageSource::File(path)) => decoded(role, path, &file_io::read_image(path)?),
    }
}

/// Decodes an image as for a material, and stretches it to the size of a thumbnail.
fn decoded(role: ImageRole, path: &Path, bytes: &[u8]) -> Result<ColorImage, Error> {
    let [width, height] = SIZE.map(|side| side as u32);
    let decode = match role {
        ImageRole::Ramp | ImageRole::Motif => decode_color_png,
        ImageRole::Sprite | ImageRole::Detail | ImageRole::SixWay | ImageRole::Noise => decode_png,
    };
    let small = imageops::resize(&decode(path, bytes)?.to_rgba8(), width, height, FilterType::Triangle);
    Ok(ColorImage::from_rgba_unmultiplied(SIZE, small.as_raw()))
}

/// Builds a thumbnail from a function of the pixel.
fn drawn(color: impl Fn([usize; 2]) -> Color32) -> ColorImage {
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    ColorImage::new(SIZE, pixels.map(color).collect())
}

/// Returns the first frame of a sprite, lit from the upper left.
fn puff(sprite: &Sprite) -> ColorImage {
    // The smallest mip level that is at least as high as the thumbnail.
    let is_large = |level: &u32| sprite.level_size(*level) as usize >= SIZE[1];
    let level = (0..sprite.level_count()).rev().find(is_large).unwrap_or(0);
    let side = sprite.level_size(level) as usize;
    let left = (SIZE[0] - SIZE[1]) / 2;
    drawn(|[x, y]| {
        if !(left..left + SIZE[1]).contains(&x) {
            return Color32::TRANSPARENT;
        }
        let at = |pixel: usize| (pixel * side / SIZE[1]) as u32;
        let texel = sprite.texel(level, 0, at(x - left), at(y));
        let light = (texel.xyz() * 2.0 - 1.0).dot(Vec3::new(-0.5, 0.6, 0.62)).max(0.0);
        let gray = (70.0 + 175.0 * light).min(255.0) as u8;
        Color32::from_rgba_unmultiplied(gray, gray, gray, (texel.w.clamp(0.0, 1.0) * 255.0) as u8)
    })
}

/// Returns the density of one slice of a noise volume.
fn slice(noise: &noise::NoiseVolume) -> ColorImage {
    let side = noise.size();
    drawn(|[x, y]| {
        let at = |pixel: usize| (pixel as u32 * side / SIZE[1] as u32) % side;
        Color32::from_gray((noise.texel(UVec3::new(at(x), at(y), 0)).w.clamp(0.0, 1.0) * 255.0) as u8)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramp_thumbnails_show_the_colors_of_the_light() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("clear.png");
        image::RgbaImage::from_pixel(4, 1, image::Rgba([255, 255, 255, 55])).save(&path).unwrap();
        let first = |role| thumbnail(role, &ImageSource::File(path.clone())).unwrap().pixels[0];
        // A transparent texel gives proportionally less light: alpha 55/255 halves the sRGB code of white.
        let gray = first(ImageRole::Ramp);
        assert!(gray.is_opaque() && gray.r().abs_diff(128) <= 1, "{gray:?}");
        assert_eq!(first(ImageRole::Motif), gray);
        assert_eq!(first(ImageRole::Noise), Color32::from_rgba_unmultiplied(255, 255, 255, 55));
    }
}
