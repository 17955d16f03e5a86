//! Sheets of smoke puffs, path-traced beside the renderer's.

use glam::{UVec2, Vec3};
use haze_author::ramp::response::{LIGHTS, Puff, light_angle};
use haze_core::assets::image::Image;
use haze_core::formula::color::srgb_from_linear;
use image::imageops::{FilterType, resize};
use image::{Rgb, RgbImage};

use super::contact_sheet::ContactSheet;

/// Linear background of the puffs: darker than most puffs, lighter than soot.
const BACKGROUND: Vec3 = Vec3::splat(0.03);
/// Side of a puff on a sheet, pixels.
const SIDE: u32 = 160;
/// Lights from the viewer's side to straight behind the puff; the other half of the ring looks much the same.
const SHOWN_LIGHTS: usize = LIGHTS as usize / 2 + 1;

/// Composites a puff over the background. Light as bright as `white` becomes white.
fn over_background(light: &Image<Vec3>, coverage: &Image<f32>, white: f32) -> RgbImage {
    let Image { size, texels } = light;
    RgbImage::from_fn(size.x, size.y, |x, y| {
        let index = (y * size.x + x) as usize;
        let seen = texels[index] / white + BACKGROUND * (1.0 - coverage.texels[index]);
        let code = seen.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(srgb_from_linear);
        Rgb(code.map(|channel| (channel * 255.0).round() as u8))
    })
}

/// Returns the light that is shown as white: brighter than all but the glow when the light is nearly behind the puff.
fn white_level(puff: &Puff) -> f32 {
    let mut brightest: Vec<f32> = puff.traced().light[..SHOWN_LIGHTS - 2]
        .iter()
        .flat_map(|image| image.texels.iter().map(|light| light.max_element()))
        .collect();
    brightest.sort_by(f32::total_cmp);
    brightest.get(brightest.len() * 995 / 1000).copied().unwrap_or(1.0).max(1.0e-6)
}

fn degrees(light: usize) -> String {
    format!("{}°", light_angle(light))
}

/// Sheet of the path-traced puff, light by light.
pub fn traced_sheet(puff: &Puff) -> RgbImage {
    let mut sheet = ContactSheet::new(UVec2::splat(SIDE), SHOWN_LIGHTS as u32, SHOWN_LIGHTS as u32);
    let white = white_level(puff);
    for light in 0..SHOWN_LIGHTS {
        let image = over_background(&puff.traced().light[light], &puff.traced().coverage, white);
        sheet.place(light as u32, &degrees(light), &enlarged(&image));
    }
    sheet.image
}

fn enlarged(image: &RgbImage) -> RgbImage {
    resize(image, SIDE, SIDE, FilterType::CatmullRom)
}

/// Images that are compared with the path-traced puff: one for each light, and the factor they are multiplied by.
pub struct ComparedImages<'a> {
    /// Image of the puff under a light, by the light's index.
    pub light: &'a dyn Fn(usize) -> Image<Vec3>,
    /// Factor by which the light is multiplied.
    pub exposure: f32,
}

/// Sheet of the path-traced puff, the images called `name`, and their difference, in three rows.
pub fn comparison_sheet(puff: &Puff, name: &str, shown: &ComparedImages<'_>) -> RgbImage {
    let mut sheet = ContactSheet::new(UVec2::splat(SIDE), SHOWN_LIGHTS as u32, 3 * SHOWN_LIGHTS as u32);
    let white = white_level(puff);
    for light in 0..SHOWN_LIGHTS {
        let [truth, ours] = image_pair(puff, shown, white, light);
        let difference = RgbImage::from_fn(truth.width(), truth.height(), |x, y| {
            let [a, b] = [truth.get_pixel(x, y).0, ours.get_pixel(x, y).0];
            Rgb(std::array::from_fn(|channel| a[channel].abs_diff(b[channel])))
        });
        for (row, (what, image)) in [("traced", truth), (name, ours), ("error", difference)].iter().enumerate() {
            let label = format!("{what}, {}", degrees(light));
            sheet.place((row * SHOWN_LIGHTS + light) as u32, &label, &enlarged(image));
        }
    }
    sheet.image
}

/// The path-traced image and the compared image under one light, at the same exposure.
fn image_pair(puff: &Puff, shown: &ComparedImages<'_>, white: f32, light: usize) -> [RgbImage; 2] {
    let coverage = &puff.traced().coverage;
    let ours = (shown.light)(light);
    [
        over_background(&puff.traced().light[light], coverage, white),
        over_background(&ours, coverage, white / shown.exposure),
    ]
}

/// Pairs of the path-traced and the compared image, for each light.
pub fn image_pairs(puff: &Puff, shown: &ComparedImages<'_>) -> Vec<[RgbImage; 2]> {
    let white = white_level(puff);
    (0..LIGHTS as usize).map(|light| image_pair(puff, shown, white, light)).collect()
}
