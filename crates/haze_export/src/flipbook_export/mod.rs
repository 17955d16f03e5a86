//! Flipbooks for engines: sheets of color, normals, motion vectors, fire and six-way light, which fit each other.

mod cut_smoke;
mod fill;
mod frame_layers;
mod motion_fit;
mod numbers;
mod options;
mod readme;
mod sheets;
mod sprite_sheet;

use std::path::Path;

use haze_core::error::Error;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::display_transform;
use haze_preset::write_file;

use crate::backend::Backend;
use crate::engine::Engine;
use crate::image_export::{ExportProgress, Frames, image_label, is_additive, stopped_before_writing};
use crate::image_format::{Alpha, Emission};
use crate::png_stream::EncodedPng;
pub use cut_smoke::CutSmoke;
use frame_layers::{FrameLayers, frame_light, mixed};
use motion_fit::HalfwayImages;
use numbers::{FlipbookNumbers, Scales};
pub use options::FlipbookOptions;

use sheets::{SheetLayout, Sheets};

/// Files of a flipbook.
pub struct FlipbookExport {
    /// Sheets, by the part of their file names.
    pub images: Vec<(&'static str, EncodedPng)>,
    /// Numbers that a shader needs beside the sheets.
    pub numbers: FlipbookNumbers,
    /// Smoke that the borders of frames cut off; `None` if there is none.
    pub cut_smoke: Option<CutSmoke>,
    sprite_sheet: String,
    readme: String,
}

/// Names of all files that a flipbook may have.
pub const FILES: [&str; 10] = [
    sheets::COLOR,
    sheets::NORMALS,
    sheets::MOTION,
    sheets::EMISSION,
    sheets::SIX_WAY[0],
    sheets::SIX_WAY[1],
    NUMBERS,
    SPRITE_SHEET,
    MODULE,
    README,
];

const NUMBERS: &str = "flipbook.json";
const README: &str = "README.md";
const SPRITE_SHEET: &str = "color.json";
const MODULE: &str = "haze_flipbook.js";

/// Text of the module that plays a flipbook in an engine, if there is one. All mix frames by the same shader functions.
fn module(engine: Engine) -> Option<String> {
    let module = match engine {
        Engine::Three => include_str!("haze_flipbook.js"),
        Engine::Babylon => include_str!("haze_flipbook_babylon.js"),
        Engine::Playcanvas => include_str!("haze_flipbook_playcanvas.js"),
        Engine::Unreal | Engine::Unity | Engine::Godot | Engine::Wgsl => return None,
    };
    Some(module.replace("HAZE_FLIPBOOK_GLSL", include_str!("haze_flipbook.glsl")))
}

impl FlipbookExport {
    /// Renders a flipbook. `folder`: the one to be written into. It need not exist; until [`FlipbookExport::write`], sheets are in
    /// temporary files without names there, or in the nearest folder above.
    ///
    /// # Errors
    /// As [`FlipbookOptions::check`]; errors of rendering; [`AssetError::Io`](haze_core::error::AssetError::Io) if a temporary file cannot be written, or it was stopped.
    pub async fn render(
        backend: &Backend,
        shot: &Shot,
        frames: &Frames,
        options: FlipbookOptions,
        progress: &ExportProgress<'_>,
        folder: &Path,
    ) -> Result<Self, Error> {
        options.check(shot, frames)?;
        let count = frames.count();
        let fade = options.loop_fade;
        let all = count + fade;
        let burns = frames.burns(shot, all);
        // Frames of the fade are rendered with those that they fade into.
        let done = |index: u32| index + index.min(fade);
        let layers = async |index: u32| {
            let done = done(index);
            if !progress.goes_on(done, all) {
                return Err(stopped_before_writing(folder, done, all));
            }
            let at = async |frame: u32, done: u32| {
                let shot = frames.shot(shot, frames.range.start() + frame);
                let layers = FrameLayers::render(backend, &shot, 1.0 / frames.rate, burns, options.has_six_way);
                progress.show(image_label(done, all), layers).await
            };
            let layers = at(index, done).await?;
            if index >= fade {
                return Ok(layers);
            }
            // The frame after the last is the first, so that it follows the last.
            let fraction = 1.0 - index as f32 / fade as f32;
            Ok(layers.mixed(&at(count + index, done + 1).await?, fraction))
        };
        let FlipbookOptions { engine, cells, emission, has_six_way, effort, .. } = options;
        // Light that hides nothing is lost in straight alpha.
        let glows = burns && emission == Emission::Contained || is_additive(&shot.preset);
        let alpha = options.alpha.unwrap_or(if glows { Alpha::Premultiplied } else { Alpha::Straight });
        let tonemap = display_transform(shot).tonemap;
        let layout = SheetLayout { engine, frame: shot.size, cells, alpha, emission, tonemap, effort, folder };
        // Image halfway between a frame and the next, encoded.
        let halfway = async |index: u32| {
            let at =
                async |frame: u32| frame_light(backend, &frames.shot_halfway(shot, frames.range.start() + frame)).await;
            let light = async {
                let light = at(index).await?;
                if index >= fade {
                    return Ok::<_, Error>(light);
                }
                let fraction = 1.0 - (index as f32 + 0.5) / fade as f32;
                Ok(mixed(light, &at(count + index).await?, fraction))
            };
            let light = progress.show(image_label(done(index), all), light).await?;
            Ok::<_, Error>(layout.encoded(&light))
        };
        let mut sheets = Sheets::new(layout, burns, has_six_way)?;
        let mut cut_smoke = None;
        let mut before = None;
        for index in 0..count {
            let layers = layers(index).await?;
            CutSmoke::add_frame(&mut cut_smoke, index, &layers.light);
            if index == 0 && fade > 0 {
                before = Some(halfway(count - 1).await?);
            }
            let has_next = index + 1 < count || fade > 0;
            let after = if has_next { Some(halfway(index).await?) } else { None };
            let images = HalfwayImages { before: before.as_ref(), after: after.as_ref() };
            progress.show("haze: encoding a frame".into(), async { sheets.place(&layers, images) }).await?;
            before = after;
        }
        let goes_on =
            || if progress.goes_on(all, all) { Ok(()) } else { Err(stopped_before_writing(folder, all, all)) };
        goes_on()?;
        let made = progress.show("haze: encoding the sheets".into(), async { sheets.encode(&goes_on) }).await?;
        let scales = Scales {
            motion: made.motion_scale,
            six_way_intensity: made.six_way_intensity,
            six_way_emission: made.six_way_emission,
        };
        let names = made.images.iter().map(|(name, _)| *name);
        let numbers = FlipbookNumbers::new(&options, alpha, shot.size, count, frames.rate, &scales, names);
        if let Some(cut_smoke) = &mut cut_smoke {
            let stopped = |_| stopped_before_writing(folder, all, all);
            cut_smoke.fitting_fov = cut_smoke::fitting_fov(backend, shot, frames, all, progress, stopped).await?;
            cut_smoke.has_keyframes = cut_smoke::has_keyframes(shot);
        }
        let mut readme = readme::readme(options.engine, &shot.preset.name, &numbers);
        if let Some(cut_smoke) = &cut_smoke {
            readme += &format!("\nBeware: {cut_smoke}.\n");
        }
        let sprite_sheet = sprite_sheet::sprite_sheet(&shot.preset.name, &numbers);
        Ok(Self { images: made.images, numbers, cut_smoke, sprite_sheet, readme })
    }

    /// Writes the files into the folder, which must exist now.
    ///
    /// # Errors
    /// [`AssetError::Io`](haze_core::error::AssetError::Io) for the first file that cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        self.images.iter().try_for_each(|(_, image)| image.write())?;
        // Numbers and strings always become JSON.
        let numbers = serde_json::to_string_pretty(&self.numbers).unwrap_or_default() + "\n";
        write_file(&folder.join(NUMBERS), numbers.as_bytes())?;
        write_file(&folder.join(SPRITE_SHEET), self.sprite_sheet.as_bytes())?;
        if let Some(module) = module(self.numbers.engine) {
            write_file(&folder.join(MODULE), module.as_bytes())?;
        }
        Ok(write_file(&folder.join(README), self.readme.as_bytes())?)
    }

    /// Returns the names of the files that are written.
    pub fn files(&self) -> impl Iterator<Item = &'static str> {
        let module = module(self.numbers.engine).map(|_| MODULE);
        self.images.iter().map(|(name, _)| *name).chain([NUMBERS, SPRITE_SHEET]).chain(module).chain([README])
    }
}

#[cfg(test)]
mod tests;
