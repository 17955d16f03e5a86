//! Pixels of exported images: background, alpha, and bits per channel.

use glam::{UVec2, Vec4};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::settings::DebugView;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::{display_transform, encoded, rgba8, tonemap};
use haze_preset::{KeyValue, Preset, SceneName};
use image::{DynamicImage, ImageBuffer, imageops};

use super::smoke_alone::{before_two_skies, separated};

/// Background of exported images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(not(target_arch = "wasm32"), derive(clap::ValueEnum))]
pub enum Background {
    /// The scene of the preset; none if it is `empty`.
    #[default]
    Auto,
    /// The scene of the preset, and the sky of the scene `empty`.
    Scene,
    /// None: the smoke alone, with its opacity in alpha.
    Transparent,
}

impl Background {
    /// Returns the background of all images of a preset, `Scene` or `Transparent`, whatever their time. Images of a preset
    /// with keyframes must still have theirs: the scene of one time may be empty, and that of another not.
    pub fn resolved(self, preset: &Preset, view: DebugView) -> Self {
        match self {
            Self::Auto if view == DebugView::Final && is_always_empty(preset) => Self::Transparent,
            Self::Auto => Self::Scene,
            chosen => chosen,
        }
    }

    /// Returns true if images of a shot have no background.
    pub fn is_transparent(self, shot: &Shot) -> bool {
        self.resolved(&shot.preset, shot.debug_view) == Self::Transparent
    }
}

/// True if a preset has the scene `empty` at all times, and no scene or sky of its own.
fn is_always_empty(preset: &Preset) -> bool {
    if !(preset.environment.scene_file.is_empty() && preset.environment.sky_file.is_empty()) {
        return false;
    }
    let is_empty = |value: &KeyValue| *value == KeyValue::Choice(SceneName::Empty.name().into());
    match preset.animation.iter().find(|track| track.setting == "environment.scene") {
        Some(track) => track.keys.iter().all(|key| is_empty(&key.value)),
        None => preset.environment.scene == SceneName::Empty,
    }
}

/// Color of transparent PNGs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(not(target_arch = "wasm32"), derive(clap::ValueEnum))]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum Alpha {
    /// The smoke's own color, not multiplied by alpha. Smoke of blend mode `additive` has an alpha of 0, and does not show.
    #[default]
    Straight,
    /// The smoke as before black: color times alpha, in linear light, and glow that adds light where alpha is low.
    Premultiplied,
}

/// Light of fire in the color of a flipbook for an engine. It is in `emission.png` in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(not(target_arch = "wasm32"), derive(clap::ValueEnum))]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "snake_case")]
pub enum Emission {
    /// Part of the color, which is complete.
    #[default]
    Contained,
    /// Not part of the color; to be added to it.
    Separate,
}

/// Bits per channel of PNGs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(not(target_arch = "wasm32"), derive(clap::ValueEnum))]
pub enum BitDepth {
    /// With dithering.
    #[default]
    #[cfg_attr(not(target_arch = "wasm32"), value(name = "8"))]
    Eight,
    /// Without dithering.
    #[cfg_attr(not(target_arch = "wasm32"), value(name = "16"))]
    Sixteen,
}

/// Pixels of exported images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageFormat {
    /// Background of the smoke.
    pub background: Background,
    /// Alpha of pixels that smoke covers in part.
    pub alpha: Alpha,
    /// Bits per channel.
    pub bits: BitDepth,
}

impl ImageFormat {
    /// Returns the format of all images of a shot, whatever their time.
    pub fn resolved(self, shot: &Shot) -> Self {
        Self { background: self.background.resolved(&shot.preset, shot.debug_view), ..self }
    }

    /// Renders an image. `render` renders a shot in linear HDR.
    pub async fn render(
        self,
        shot: &Shot,
        render: impl AsyncFn(&Shot) -> Result<Image<Vec4>, Error>,
    ) -> Result<DynamicImage, Error> {
        if !self.background.is_transparent(shot) {
            let image = render(shot).await?;
            return Ok(match self.bits {
                BitDepth::Eight => tonemap(&image, shot).into(),
                BitDepth::Sixteen => {
                    DynamicImage::from(rgba16(&encoded(&image, display_transform(shot)))).into_rgb16().into()
                }
            });
        }
        let [dark, bright] = before_two_skies(shot);
        let smoke = separated([&render(&dark).await?, &render(&bright).await?]);
        let smoke = match self.alpha {
            Alpha::Straight => straight(&smoke),
            Alpha::Premultiplied => smoke,
        };
        let encoded = encoded(&smoke, display_transform(shot));
        Ok(match self.bits {
            BitDepth::Eight => rgba8(&encoded).into(),
            BitDepth::Sixteen => rgba16(&encoded).into(),
        })
    }

    /// Returns an empty sheet for images of a shot.
    pub fn blank(self, shot: &Shot, size: UVec2) -> DynamicImage {
        match (self.background.is_transparent(shot), self.bits) {
            (false, BitDepth::Eight) => DynamicImage::new_rgb8(size.x, size.y),
            (false, BitDepth::Sixteen) => DynamicImage::new_rgb16(size.x, size.y),
            (true, BitDepth::Eight) => DynamicImage::new_rgba8(size.x, size.y),
            (true, BitDepth::Sixteen) => DynamicImage::new_rgba16(size.x, size.y),
        }
    }
}

/// Divides color by alpha.
pub fn straight(smoke: &Image<Vec4>) -> Image<Vec4> {
    let divide = |texel: &Vec4| (texel.truncate() / texel.w.max(1.0e-4)).extend(texel.w);
    Image { size: smoke.size, texels: smoke.texels.iter().map(divide).collect() }
}

fn rgba16(encoded: &Image<Vec4>) -> ImageBuffer<image::Rgba<u16>, Vec<u16>> {
    // With the added 0.5 the cast rounds; it also clamps.
    let code = |channel: f32| (channel * 65535.0 + 0.5) as u16;
    let codes = encoded.texels.iter().flat_map(|texel| texel.to_array().map(code)).collect();
    // Never the default: there is one texel per pixel.
    ImageBuffer::from_raw(encoded.size.x, encoded.size.y, codes).unwrap_or_default()
}

/// Copies an image onto a sheet of the same pixels. `imageops` would convert those of a [`DynamicImage`] to 8 bits.
pub fn place(sheet: &mut DynamicImage, image: &DynamicImage, at: UVec2) {
    use DynamicImage::{ImageRgb8, ImageRgb16, ImageRgba8, ImageRgba16};
    let x = i64::from(at.x);
    let y = i64::from(at.y);
    match (sheet, image) {
        (ImageRgb8(sheet), ImageRgb8(image)) => imageops::replace(sheet, image, x, y),
        (ImageRgba8(sheet), ImageRgba8(image)) => imageops::replace(sheet, image, x, y),
        (ImageRgb16(sheet), ImageRgb16(image)) => imageops::replace(sheet, image, x, y),
        (ImageRgba16(sheet), ImageRgba16(image)) => imageops::replace(sheet, image, x, y),
        (sheet, image) => imageops::replace(sheet, image, x, y),
    }
}

#[cfg(test)]
mod tests {
    use haze_preset::{Ease, Keyframe, Track};
    use image::GenericImageView as _;

    use super::*;

    fn rendered(shot: &Shot, format: ImageFormat) -> DynamicImage {
        pollster::block_on(format.render(shot, async |shot| shot.render_on_cpu())).unwrap()
    }

    fn small(name: &str) -> Shot {
        Shot::load(name, UVec2::new(48, 48)).unwrap()
    }

    #[test]
    fn premultiplied_smoke_is_the_smoke_before_black() {
        for name in ["column", "campfire"] {
            let shot = small(name);
            let format = |alpha| ImageFormat { background: Background::Transparent, alpha, ..ImageFormat::default() };
            let premultiplied = rendered(&shot, format(Alpha::Premultiplied)).into_rgba8();
            let black = rendered(
                &before_two_skies(&shot)[0],
                ImageFormat { background: Background::Scene, ..ImageFormat::default() },
            );
            let straight = rendered(&shot, format(Alpha::Straight)).into_rgba8();
            let mut differs = 0;
            for (x, y, pixel) in premultiplied.enumerate_pixels() {
                assert_eq!(pixel.0[..3], black.get_pixel(x, y).0[..3], "{name} {x} {y}");
                assert_eq!(pixel.0[3], straight.get_pixel(x, y).0[3]);
                differs += u32::from(pixel != straight.get_pixel(x, y));
            }
            assert!(differs > 50, "{name}: {differs}");
        }
    }

    #[test]
    fn an_empty_scene_is_transparent_unless_its_sky_is_asked_for() {
        let mut shot = small("column");
        let color = |shot: &Shot, background| {
            rendered(shot, ImageFormat { background, ..ImageFormat::default() }).color().has_alpha()
        };
        assert!(!color(&shot, Background::Auto) && color(&shot, Background::Transparent));
        shot.preset.environment.scene = SceneName::Empty;
        assert!(color(&shot, Background::Auto) && !color(&shot, Background::Scene));
        shot.debug_view = DebugView::Normals;
        assert!(!color(&shot, Background::Auto), "views of data are shown on black");
    }

    #[test]
    fn images_of_a_preset_have_a_background_at_all_times_or_at_none() {
        let mut shot = small("column");
        let key = |time, name: &str| Keyframe { time, value: KeyValue::Choice(name.into()), ease: Ease::default() };
        let keys = vec![key(0.0, "empty"), key(30.0, "yard")];
        shot.preset.animation = vec![Track { setting: "environment.scene".into(), keys, ..Track::default() }];
        let format = ImageFormat::default().resolved(&shot);
        for time in [5.0, 40.0] {
            let now = Shot { preset: shot.preset.evaluate(time), ..shot.clone() };
            assert!(
                !rendered(&now, format).color().has_alpha() && !format.blank(&shot, UVec2::ONE).color().has_alpha()
            );
        }
        shot.preset.animation[0].keys.pop();
        assert!(ImageFormat::default().blank(&shot, UVec2::ONE).color().has_alpha());
    }

    #[test]
    fn sixteen_bits_are_the_eight_bits_without_dithering() {
        let shot = small("column");
        for background in [Background::Scene, Background::Transparent] {
            let format = |bits| ImageFormat { background, bits, ..ImageFormat::default() };
            let [coarse, fine] = [BitDepth::Eight, BitDepth::Sixteen].map(|bits| rendered(&shot, format(bits)));
            assert!(matches!(fine, DynamicImage::ImageRgb16(_) | DynamicImage::ImageRgba16(_)));
            let fine = fine.into_rgba16();
            let mut levels: Vec<u16> = fine.as_raw().clone();
            for (coarse, fine) in coarse.into_rgba8().as_raw().iter().zip(fine.as_raw()) {
                // Dithering moves a value by up to a step.
                assert!((f32::from(*coarse) - f32::from(*fine) / 257.0).abs() <= 1.01, "{coarse} {fine}");
            }
            levels.sort_unstable();
            levels.dedup();
            assert!(levels.len() > 1000, "{} levels", levels.len());
        }
    }

    #[test]
    fn sheets_keep_sixteen_bits() {
        let shot = small("column");
        let format =
            ImageFormat { background: Background::Transparent, bits: BitDepth::Sixteen, ..ImageFormat::default() };
        let image = rendered(&shot, format);
        let mut sheet = format.blank(&shot, UVec2::new(96, 48));
        place(&mut sheet, &image, UVec2::new(48, 0));
        assert_eq!(sheet.crop_imm(48, 0, 48, 48), image);
        assert_eq!(sheet.crop_imm(0, 0, 48, 48).into_rgba16().as_raw().iter().max(), Some(&0));
    }
}
