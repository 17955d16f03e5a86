//! Imports sprites from other kinds of images: painted normals, heights, alpha only, and six-way light maps.

use std::path::Path;

use glam::{UVec2, Vec3, Vec4};
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::AssetError;
use haze_core::formula::saturate;
use haze_core::formula::six_way::SixWay;
use haze_core::settings::choice;
use image::{Rgba, RgbaImage, imageops};

use super::height::{dome_heights, map_pixels, normal_of};
use super::lint::{clear_borders, describe_non_normals};
use super::opacity::{has_alpha, is_gray, opacities};
use super::six_way::{Packing, pack};
use super::y_direction::{MIN_CONFIDENCE, YDirection, y_direction};

choice! {
    /// Contents of an imported image.
    ImportSource {
        /// rgb = normals, a = amount.
        #[default]
        Normals = "normals",
        /// Gray = height, a = amount.
        Height = "height",
        /// a = amount, or gray if there is no alpha. Normals are those of a dome over the silhouette.
        Alpha = "alpha",
        /// Two light maps in the layout of Unity's VFX Graph: right, top, back; left, bottom, front. Alpha of the first
        /// = amount; alpha of the second, emission, is left out.
        SixWayUnity = "six_way_unity",
        /// Two light maps: right, left, top; bottom, back, front. Alpha of the first, or else of the second = amount.
        SixWayRltBbf = "six_way_rlt_bbf",
    }
}

impl ImportSource {
    /// Returns the packing if the source is a pair of light maps.
    pub fn packing(self) -> Option<Packing> {
        match self {
            Self::SixWayUnity => Some(Packing::Unity),
            Self::SixWayRltBbf => Some(Packing::RltBbf),
            Self::Normals | Self::Height | Self::Alpha => None,
        }
    }

    /// True if the source consists of two images, or three if the opacity has one of its own.
    pub fn needs_two_images(self) -> bool {
        self.packing().is_some()
    }
}

/// Result of an import, with observations about the source.
#[derive(Clone, Debug)]
pub struct ImportedSprite {
    /// rgb = normal / 2 + 1/2 (x right, y up, z towards the viewer), a = amount.
    pub image: RgbaImage,
    /// Six-way maps, if the source is a pair of light maps: see [`six_way`](super::six_way).
    pub six_way: Option<RgbaImage>,
    /// Detected direction of green in painted normals; `None` for other sources.
    pub y_direction: Option<YDirection>,
    /// Description of the contents if the source should be normals but does not look like it.
    pub not_normals: Option<&'static str>,
    /// Largest alpha of the second light map, if that is not the amount: emission in Unity's packing. It is left out, because a
    /// sprite has no place for it.
    pub emission: Option<u8>,
    /// The frame with the largest alpha on its border, and that alpha. Borders were cleared.
    pub border: Option<(u32, u8)>,
}

/// Arranges frames of equal size on a sheet that is as square as possible. Returns the sheet and its columns and rows.
///
/// # Errors
/// [`AssetError::Image`] if a frame differs in size from the first.
pub fn arrange_sheet(frames: &[(&Path, RgbaImage)]) -> Result<(RgbaImage, UVec2), AssetError> {
    let Some((_, first)) = frames.first() else { return Ok((RgbaImage::new(0, 0), UVec2::ZERO)) };
    let (width, height) = first.dimensions();
    let count = frames.len() as u32;
    // The sheet has no empty cells: columns times rows must equal the number of frames.
    let columns = (1..=count).filter(|&columns| count.is_multiple_of(columns) && columns * columns >= count).min();
    let columns = columns.unwrap_or(count);
    let mut sheet = RgbaImage::new(width * columns, height * (count / columns));
    for (index, (path, frame)) in (0..).zip(frames) {
        if frame.dimensions() != (width, height) {
            let reason =
                format!("{}x{} pixels; expected {width}x{height} as the first frame", frame.width(), frame.height());
            return Err(AssetError::Image { path: path.to_path_buf(), reason });
        }
        let at = UVec2::new(index % columns * width, index / columns * height);
        imageops::replace(&mut sheet, frame, at.x.into(), at.y.into());
    }
    Ok((sheet, UVec2::new(columns, count / columns)))
}

/// Converts a sheet to a sprite; of light maps, two sheets, and a third that is gray if the opacity is in neither. `y_down`
/// gives the direction of green in painted normals; with `None` it is detected, and taken as up if uncertain. `strength`
/// scales heights and domes: 1 is a hemisphere.
///
/// # Errors
/// [`AssetError::Image`] if the sheets do not fit the layout or each other, and if light maps have no opacity.
pub fn import_sprite(
    path: &Path,
    sheets: &[RgbaImage],
    source: ImportSource,
    layout: SpriteLayout,
    y_down: Option<bool>,
    strength: f32,
) -> Result<ImportedSprite, AssetError> {
    let ImportSheets { mut image, second } = ImportSheets::new(path, sheets, source)?;
    let emission = second.and_then(|second| emission(&image, second));
    let columns = layout.columns.max(1);
    let rows = layout.rows.max(1);
    let size = UVec2::new(image.width() / columns, image.height() / rows);
    let border = clear_borders(&mut image, layout);
    // Returns an error if the layout does not fit.
    let sprite = Sprite::from_image(path, &image, SpriteLayout { y_down: false, ..layout })?;
    let mut found = None;
    let mut not_normals = None;
    match source {
        ImportSource::Normals => {
            not_normals = describe_non_normals(&sprite);
            found = y_direction(&sprite);
            let guess = found.is_some_and(|found| found.is_down && found.confidence >= MIN_CONFIDENCE);
            let turns = y_down.unwrap_or(guess);
            for texel in image.pixels_mut() {
                let normal = value(texel).truncate() * 2.0 - 1.0;
                let normal = if turns { normal.with_y(-normal.y) } else { normal };
                *texel = encode(normal, texel.0[3]);
            }
        }
        ImportSource::Height | ImportSource::Alpha => {
            for frame in 0..columns * rows {
                let origin = UVec2::new(frame % columns, frame / columns) * size;
                let texel = |at: UVec2| value(image.get_pixel(origin.x + at.x, origin.y + at.y));
                let height = match source {
                    ImportSource::Height => map_pixels(size, |at| texel(at).x),
                    _ => dome_heights(&map_pixels(size, |at| texel(at).w)),
                };
                for at in (0..size.element_product()).map(|index| UVec2::new(index % size.x, index / size.x)) {
                    let normal = normal_of(&height, at.as_ivec2(), strength);
                    let out = image.get_pixel_mut(origin.x + at.x, origin.y + at.y);
                    *out = encode(normal, out.0[3]);
                }
            }
        }
        ImportSource::SixWayUnity | ImportSource::SixWayRltBbf => {}
    }
    let light = source.packing().zip(second);
    let six_way = light.map(|(packing, second)| pack(&image, second, packing));
    if let Some((packing, second)) = light {
        for (texel, other) in image.pixels_mut().zip(second.pixels()) {
            let SixWay { positive, negative } = packing.six_way(value(texel).truncate(), value(other).truncate());
            *texel = encode((positive - negative) * strength, texel.0[3]);
        }
    }
    Ok(ImportedSprite { image, six_way, y_direction: found, emission, not_normals, border })
}

/// Sheets of an import.
struct ImportSheets<'a> {
    /// First sheet, with the amount in alpha.
    image: RgbaImage,
    /// Second light map.
    second: Option<&'a RgbaImage>,
}

impl<'a> ImportSheets<'a> {
    /// Finds the sheet that has the opacity.
    ///
    /// # Errors
    /// As [`import_sprite`], but for the layout.
    fn new(path: &Path, sheets: &'a [RgbaImage], source: ImportSource) -> Result<Self, AssetError> {
        let refuse = |reason: String| Err(AssetError::Image { path: path.into(), reason });
        let [first, rest @ ..] = sheets else { return refuse("no image; expected one".into()) };
        if let Some(other) = rest.iter().find(|other| other.dimensions() != first.dimensions()) {
            let size = |sheet: &RgbaImage| format!("{}x{}", sheet.width(), sheet.height());
            return refuse(format!("another sheet has {} pixels; expected {} as the first", size(other), size(first)));
        }
        let Some(packing) = source.packing() else {
            if !rest.is_empty() {
                return refuse(format!("{} sheets; expected 1", sheets.len()));
            }
            let mut image = first.clone();
            if source == ImportSource::Alpha {
                set_alpha(&mut image, &opacities(first));
            }
            return Ok(Self { image, second: None });
        };
        let third = match sheets {
            [_, _] => None,
            [_, _, _] => match sheets.iter().rposition(is_gray) {
                None => return refuse("none of 3 sheets is gray; expected two light maps and their opacity".into()),
                gray => gray,
            },
            _ => {
                let expected = "2 light maps, or 3 sheets if the opacity has its own";
                return refuse(format!("{} sheets; expected {expected}", sheets.len()));
            }
        };
        let mut maps = sheets.iter().enumerate().filter(|(index, _)| Some(*index) != third).map(|(_, sheet)| sheet);
        let (Some(map), Some(second)) = (maps.next(), maps.next()) else {
            return refuse("no two light maps; expected them".into());
        };
        // Alpha of the second map may be emission in Unity's packing.
        let in_second = (has_alpha(second) && !packing.has_emission()).then_some(second);
        let opacity = third.map(|index| &sheets[index]).or(has_alpha(map).then_some(map)).or(in_second);
        let Some(opacity) = opacity else {
            return refuse(
                "no opacity: alpha of the light maps is the same everywhere; expected the amount in alpha of the first, or \
                 a third sheet, gray"
                    .into(),
            );
        };
        let mut image = map.clone();
        set_alpha(&mut image, &opacities(opacity));
        Ok(Self { image, second: Some(second) })
    }
}

fn set_alpha(image: &mut RgbaImage, alphas: &[u8]) {
    image.pixels_mut().zip(alphas).for_each(|(texel, &alpha)| texel.0[3] = alpha);
}

/// Returns the largest alpha of the second light map, unless it is the amount, or the same in all texels.
fn emission(first: &RgbaImage, second: &RgbaImage) -> Option<u8> {
    let largest = second.pixels().map(|texel| texel.0[3]).max()?;
    let is_plain = second.pixels().all(|texel| texel.0[3] == largest);
    // Tools that resize maps round alpha in each.
    let is_amount = first.pixels().zip(second.pixels()).all(|(a, b)| a.0[3].abs_diff(b.0[3]) <= 2);
    (!is_plain && !is_amount).then_some(largest)
}

fn value(texel: &Rgba<u8>) -> Vec4 {
    Vec4::from(texel.0.map(f32::from)) / 255.0
}

/// Encodes a normal of unit length. z is clamped to 0 or more, so that normals of overlapping sprites do not cancel.
fn encode(normal: Vec3, alpha: u8) -> Rgba<u8> {
    let normal = normal.with_z(normal.z.max(0.0)).normalize_or(Vec3::Z);
    let [x, y, z] = normal.to_array().map(|axis| (saturate(axis * 0.5 + 0.5) * 255.0).round() as u8);
    Rgba([x, y, z, alpha])
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::sprite::lint::lint_sprite;

    /// Draws two hemispheres side by side. `texel` maps a normal and an amount to channels.
    fn balls(texel: impl Fn(Vec3, f32) -> [f32; 4]) -> RgbaImage {
        RgbaImage::from_fn(128, 64, |x, y| {
            let p = (Vec2::new((x % 64) as f32, y as f32) - 31.5) / 28.0;
            let z = (1.0 - p.length_squared()).max(0.0).sqrt();
            let inside = saturate((1.0 - p.length()) * 8.0);
            Rgba(texel(Vec3::new(p.x, -p.y, z), inside).map(|channel| (saturate(channel) * 255.0).round() as u8))
        })
    }

    const LAYOUT: SpriteLayout = SpriteLayout { columns: 2, rows: 1, y_down: false };

    /// Imports sheets and returns the mean distance of the normals from those of the hemispheres.
    fn off(sheets: &[RgbaImage], source: ImportSource, y_down: Option<bool>, strength: f32) -> f32 {
        let imported = import_sprite(Path::new("a.png"), sheets, source, LAYOUT, y_down, strength).unwrap();
        assert_eq!(lint_sprite(Path::new("a.png"), &imported.image, LAYOUT).unwrap(), [], "{source:?}");
        let wanted = balls(|normal, amount| (normal * 0.5 + 0.5).extend(amount).to_array());
        let solid = wanted.pixels().zip(imported.image.pixels()).filter(|(wanted, _)| wanted.0[3] > 200);
        let apart = |(a, b): (&Rgba<u8>, &Rgba<u8>)| {
            let normal = |texel| value(texel).truncate() * 2.0 - 1.0;
            normal(a).distance(normal(b))
        };
        let off: Vec<f32> = solid.map(apart).collect();
        off.iter().sum::<f32>() / off.len() as f32
    }

    #[test]
    fn painted_normals_are_flipped_as_requested_or_detected() {
        let sheet = |y: f32| [balls(|n, amount| ((n * Vec3::new(1.0, y, 1.0)) * 0.5 + 0.5).extend(amount).to_array())];
        assert!(off(&sheet(1.0), ImportSource::Normals, None, 1.0) < 0.01);
        assert!(off(&sheet(-1.0), ImportSource::Normals, None, 1.0) < 0.01);
        assert!(off(&sheet(-1.0), ImportSource::Normals, Some(true), 1.0) < 0.01);
        let imported = import_sprite(Path::new(""), &sheet(-1.0), ImportSource::Normals, LAYOUT, None, 1.0).unwrap();
        let found = imported.y_direction.unwrap();
        assert!(found.is_down && found.confidence > 0.9, "{found:?}");
        // An explicit `y_down` overrides the detection.
        let kept = import_sprite(Path::new(""), &sheet(-1.0), ImportSource::Normals, LAYOUT, Some(false), 1.0).unwrap();
        assert!(
            kept.image.pixels().zip(sheet(-1.0)[0].pixels()).all(|(a, b)| a.0[1].abs_diff(b.0[1]) <= 2 || a.0[3] == 0)
        );
    }

    #[test]
    fn heights_alpha_and_light_maps_become_normals() {
        let height = balls(|normal, amount| [normal.z, normal.z, normal.z, amount]);
        assert!(off(&[height], ImportSource::Height, None, 28.0 / 32.0) < 0.05);
        // A dome is not an exact hemisphere. For comparison, normals that all face the viewer have an error of 0.75.
        let alpha = balls(|_, amount| [1.0, 1.0, 1.0, amount]);
        assert!(off(&[alpha], ImportSource::Alpha, None, 1.0) < 0.45);
        let gray = balls(|_, amount| [amount, amount, amount, 1.0]);
        assert!(off(&[gray], ImportSource::Alpha, None, 1.0) < 0.45);
        // Light on a surface from each side.
        let light = |axis: Vec3| move |normal: Vec3| 0.1 + 0.9 * normal.dot(axis).max(0.0);
        let sheet = |axes: [Vec3; 3]| {
            let [r, g, b] = axes.map(light);
            balls(move |normal, amount| [r(normal), g(normal), b(normal), amount])
        };
        let x = Vec3::X;
        let y = Vec3::Y;
        let z = Vec3::Z;
        assert!(off(&[sheet([x, -x, y]), sheet([-y, -z, z])], ImportSource::SixWayRltBbf, None, 1.0) < 0.02);
        assert!(off(&[sheet([x, y, -z]), sheet([-x, -y, z])], ImportSource::SixWayUnity, None, 1.0) < 0.02);
    }

    #[test]
    fn emission_of_light_maps_is_told() {
        let first = balls(|_, amount| [0.5, 0.5, 0.5, amount]);
        let found = |alpha: fn(Vec3, f32) -> f32| {
            let second = balls(|normal, amount| [0.5, 0.5, 0.5, alpha(normal, amount)]);
            let sheets = [first.clone(), second];
            import_sprite(Path::new("a.png"), &sheets, ImportSource::SixWayUnity, LAYOUT, None, 1.0).unwrap().emission
        };
        assert_eq!(found(|normal, _| 0.8 * f32::from(u8::from(normal.z > 0.5))), Some(204));
        assert_eq!([found(|_, amount| amount), found(|_, _| 0.0), found(|_, _| 1.0)], [None; 3]);
    }

    #[test]
    fn opacity_of_light_maps_is_found_or_they_are_refused() {
        let light = |amount: fn(f32) -> f32| balls(move |n, a| [0.5 + n.x * 0.4, 0.5 - n.x * 0.4, 0.6, amount(a)]);
        let plain = || light(|_| 1.0);
        let opacity = balls(|_, amount| [amount, amount, amount, 1.0]);
        let import = |sheets: &[RgbaImage], source| {
            import_sprite(Path::new("a.png"), sheets, source, LAYOUT, None, 1.0).map(|imported| imported.image)
        };
        let expected = import(&[light(|amount| amount), plain()], ImportSource::SixWayUnity).unwrap();
        for (sheets, source) in [
            (vec![plain(), plain(), opacity.clone()], ImportSource::SixWayUnity),
            (vec![opacity, plain(), plain()], ImportSource::SixWayRltBbf),
            (vec![plain(), light(|amount| amount)], ImportSource::SixWayRltBbf),
        ] {
            let found = import(&sheets, source).unwrap();
            assert!(found.pixels().zip(expected.pixels()).all(|(a, b)| a.0[3] == b.0[3]), "{source:?}");
        }
        for sheets in [[plain(), plain()], [plain(), light(|amount| amount)]] {
            let message = import(&sheets, ImportSource::SixWayUnity).unwrap_err().to_string();
            assert!(message.starts_with("a.png: no opacity: ") && message.contains("a third sheet, gray"), "{message}");
        }
    }

    #[test]
    fn sheets_that_do_not_fit_are_refused() {
        let sheet = balls(|_, _| [0.5; 4]);
        let message = |sheets: &[RgbaImage], source| {
            import_sprite(Path::new("a.png"), sheets, source, LAYOUT, None, 1.0).unwrap_err().to_string()
        };
        assert!(message(&[], ImportSource::Height).contains("expected one"));
        assert!(message(std::slice::from_ref(&sheet), ImportSource::SixWayRltBbf).contains("1 sheets; expected 2"));
        assert!(
            message(&vec![sheet.clone(); 4], ImportSource::SixWayUnity).contains("4 sheets; expected 2 light maps")
        );
        assert!(message(&vec![sheet.clone(); 2], ImportSource::Height).contains("2 sheets; expected 1"));
        let color = balls(|_, _| [0.2, 0.5, 0.9, 1.0]);
        assert!(message(&vec![color; 3], ImportSource::SixWayUnity).contains("none of 3 sheets is gray"));
        let small = RgbaImage::new(64, 64);
        assert!(message(&[sheet, small.clone()], ImportSource::SixWayUnity).contains("expected 128x64 as the first"));
        assert!(message(&[small], ImportSource::Alpha).contains("square frames"));
    }

    #[test]
    fn frames_are_arranged_on_a_sheet_without_empty_cells() {
        let frame = |gray: u8| (Path::new("a.png"), RgbaImage::from_pixel(4, 4, Rgba([gray; 4])));
        let frames: Vec<_> = (0..6).map(|index| frame(index * 10)).collect();
        let (sheet, layout) = arrange_sheet(&frames).unwrap();
        assert_eq!((sheet.dimensions(), layout), ((12, 8), UVec2::new(3, 2)));
        assert_eq!(sheet.get_pixel(5, 5).0[0], 40);
        let odd = [frame(1), (Path::new("b.png"), RgbaImage::new(5, 4))];
        assert!(arrange_sheet(&odd).unwrap_err().to_string().starts_with("b.png: 5x4 pixels; expected 4x4"));
    }
}
