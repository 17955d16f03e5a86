//! Preview of a single lit sprite, drawn on the CPU with the formulas of the renderers.

use eframe::egui::{self, Color32, ColorImage, TextureHandle, TextureId, TextureOptions};
use glam::{UVec2, Vec2, Vec3, Vec3Swizzles as _, Vec4Swizzles as _};
use haze::MaterialAssets;
use haze_core::assets::image::Image;
use haze_core::formula::color::srgb_color;
use haze_core::formula::lighting::diffuse_coordinate;
use haze_core::formula::normal::normal_from_accumulation;
use haze_core::formula::ramp::sample_ramp;
use haze_core::formula::sprite::{MOTION_RANGE, flipbook_frames, sample_detail, sample_sprite, sprite_lod};
use haze_core::settings::{NormalDecode, NormalEncoding, RampFilter};

use super::sprite_view::SpriteChannel;

/// Parameters of the preview, apart from the material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub channel: SpriteChannel,
    pub frame: f32,
    /// Unit vector to the light.
    pub to_light: Vec3,
    pub filter: RampFilter,
    /// Factor on the sprite's motion vectors between frames.
    pub motion: f32,
    /// Side of the image in pixels.
    pub side: u32,
}

/// Texture of the last preview, and its parameters.
pub struct SpritePreview {
    view: View,
    material: MaterialAssets,
    texture: TextureHandle,
}

impl SpritePreview {
    /// Returns the preview's texture, redrawn only if its parameters have changed.
    pub fn show(
        painted: &mut Option<Self>,
        context: &egui::Context,
        view: View,
        material: &MaterialAssets,
    ) -> TextureId {
        let is_same = |last: &Self| last.view == view && last.material.shares_memory(material);
        if let Some(last) = painted.as_ref().filter(|last| is_same(last)) {
            return last.texture.id();
        }
        let image = draw(material, &view);
        let texture = match painted.take() {
            Some(Self { mut texture, .. }) => {
                texture.set(image, TextureOptions::LINEAR);
                texture
            }
            None => context.load_texture("flipbook", image, TextureOptions::LINEAR),
        };
        painted.insert(Self { view, material: material.clone(), texture }).texture.id()
    }
}

/// Linear light of the background: dark enough for bright rims, bright enough for dark smoke.
const BEHIND: Vec3 = Vec3::splat(0.03);

/// Draws the preview.
pub fn draw(material: &MaterialAssets, view: &View) -> ColorImage {
    let mut image = Image::new(UVec2::splat(view.side), Color32::BLACK);
    image.for_each(|at, pixel| {
        let uv = (at.as_vec2() + 0.5) / view.side as f32;
        let [r, g, b] = code(material, view, uv).to_array().map(|code| (code * 255.0).round() as u8);
        *pixel = Color32::from_rgb(r, g, b);
    });
    ColorImage::new([view.side as usize; 2], image.texels)
}

/// Returns the sRGB value, 0 to 1, of a position on the sprite.
fn code(material: &MaterialAssets, view: &View, uv: Vec2) -> Vec3 {
    let sprite = &material.sprite;
    let frames = flipbook_frames(view.frame, sprite.frame_count() as f32);
    let detail = material.detail.as_ref().map_or(Vec3::ZERO, |detail| {
        sample_detail(detail, uv, frames, sprite_lod(detail.size() as f32, view.side as f32))
    });
    let lod = sprite_lod(sprite.size() as f32, view.side as f32);
    let texel = sample_sprite(sprite, uv, frames, detail.yz() * view.motion, lod);
    let normal = texel.xyz();
    let amount = texel.w;
    match view.channel {
        SpriteChannel::Lit => {
            let normal = normal_from_accumulation(NormalEncoding::Signed, NormalDecode::Exact, normal, 1.0);
            let light = sample_ramp(&material.diffuse_ramp, view.filter, diffuse_coordinate(normal, view.to_light));
            srgb_color(BEHIND.lerp(light, amount))
        }
        SpriteChannel::Normals => normal * 0.5 + 0.5,
        SpriteChannel::Amount => Vec3::splat(amount),
        SpriteChannel::Depth => Vec3::splat(detail.x * 0.5 + 0.5),
        SpriteChannel::Motion => (detail.yz() / MOTION_RANGE * 0.5 + 0.5).extend(0.5),
    }
}

#[cfg(test)]
mod tests {
    use haze_core::settings::SpriteSettings;
    use haze_preset::{ImageSource, MaterialSources};

    use super::*;

    fn material() -> MaterialAssets {
        MaterialSources { sprite: "ball".into(), ..MaterialSources::default() }.load(ImageSource::BuiltIn).unwrap()
    }

    fn view(channel: SpriteChannel, to_light: Vec3) -> View {
        let motion = SpriteSettings::default().motion;
        View { channel, frame: 0.0, to_light, filter: RampFilter::default(), motion, side: 64 }
    }

    /// Returns the mean brightness of the left, right, upper and lower half.
    fn halves(image: &ColorImage) -> [f32; 4] {
        let mean = |is_in: &dyn Fn(usize, usize) -> bool| {
            let at = |index: usize| (index % 64, index / 64);
            let of = image.pixels.iter().enumerate().filter(|(index, _)| is_in(at(*index).0, at(*index).1));
            of.map(|(_, pixel)| f32::from(pixel.g())).sum::<f32>() / 2048.0
        };
        [mean(&|x, _| x < 32), mean(&|x, _| x >= 32), mean(&|_, y| y < 32), mean(&|_, y| y >= 32)]
    }

    #[test]
    fn the_side_that_faces_the_light_is_brighter() {
        let material = material();
        let lit = |to_light| halves(&draw(&material, &view(SpriteChannel::Lit, to_light)));
        let [left, right, ..] = lit(Vec3::NEG_X);
        assert!(left > 1.3 * right, "{left} {right}");
        let [left, right, ..] = lit(Vec3::X);
        assert!(right > 1.3 * left, "{left} {right}");
        let [.., above, below] = lit(Vec3::Y);
        assert!(above > 1.3 * below, "{above} {below}");
    }

    #[test]
    fn each_view_shows_its_channel_of_the_sheet() {
        let material = material();
        let middle = |channel| draw(&material, &view(channel, Vec3::Z)).pixels[32 * 64 + 32];
        let corner = |channel| draw(&material, &view(channel, Vec3::Z)).pixels[0];
        let [normal, amount] = [SpriteChannel::Normals, SpriteChannel::Amount].map(middle);
        assert!(normal.b() > 200 && amount.g() > 150, "{normal:?} {amount:?}");
        assert_eq!(corner(SpriteChannel::Amount), Color32::BLACK);
        // The depth is largest in the middle.
        assert!(middle(SpriteChannel::Depth).r() > 150, "{:?}", middle(SpriteChannel::Depth));
        // Without a detail map the depth is unknown.
        let plain = MaterialAssets { detail: None, ..material.clone() };
        assert_eq!(draw(&plain, &view(SpriteChannel::Motion, Vec3::Z)).pixels[2000], Color32::from_rgb(128, 128, 128));
        let moved = View { frame: 0.5, ..view(SpriteChannel::Amount, Vec3::Z) };
        assert_ne!(draw(&material, &moved), draw(&material, &view(SpriteChannel::Amount, Vec3::Z)));
    }
}
