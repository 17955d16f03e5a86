//! Smooth edges of what is thinner than a few pixels and far brighter than what is behind it, such as sparks: half a pixel of it
//! is as white as a whole one. On the CPU; `antialiasing.wgsl` has the same functions for the GPU.
//! (After Lottes, "FXAA", 2009: the direction of an edge by the brightness of the corners, and samples along it)

use glam::{IVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::color::luminance;

/// WGSL of the [`ImagePass`](super::image_pass::ImagePass). It has no uniform.
pub const ANTIALIASING_SHADER: &str = include_str!("antialiasing.wgsl");

/// Contrast from which on there is an edge, as a fraction of the brightest texel around; and the least.
const EDGE_CONTRAST: f32 = 0.25;
const MIN_CONTRAST: f32 = 0.03;
/// Brightest light that is told apart: half floats end not far above.
const BRIGHTEST: f32 = 6.0e4;
/// Farthest distance of a sample along an edge, pixels, doubled.
const MAX_SPAN: f32 = 8.0;
/// Keeps corners, which have no direction, short; and the least.
const CORNER: f32 = 0.03125;
const MIN_CORNER: f32 = 0.0078125;

/// Returns the image with smooth edges.
pub fn antialiased(image: &Image<Vec4>) -> Image<Vec4> {
    let mut smooth = Image::new(image.size, Vec4::W);
    smooth.for_each(|at, texel| {
        let light = image.load(at.as_ivec2());
        *texel = smooth_color(image, at.as_ivec2()).map_or(light, |color| expanded(color).extend(light.w));
    });
    smooth
}

/// Compresses light to 0..1, so that an average looks as it would after a tonemap.
fn compressed(light: Vec3) -> Vec3 {
    let color = light.clamp(Vec3::ZERO, Vec3::splat(BRIGHTEST));
    color / (1.0 + color.max_element())
}

/// The inverse of [`compressed`].
fn expanded(color: Vec3) -> Vec3 {
    color / (1.0 - color.max_element()).max(1.0e-4)
}

/// Compressed color of a pixel at an edge; `None` if there is no edge.
fn smooth_color(image: &Image<Vec4>, at: IVec2) -> Option<Vec3> {
    let load = |x: i32, y: i32| compressed(image.load(at + IVec2::new(x, y)).xyz());
    let [nw, ne, sw, se] = [(-1, -1), (1, -1), (-1, 1), (1, 1)].map(|(x, y)| luminance(load(x, y)));
    let middle = luminance(load(0, 0));
    let darkest = middle.min(nw.min(ne).min(sw.min(se)));
    let brightest = middle.max(nw.max(ne).max(sw.max(se)));
    if brightest - darkest < MIN_CONTRAST.max(EDGE_CONTRAST * brightest) {
        return None;
    }
    let across = Vec2::new(sw + se - nw - ne, nw + sw - ne - se);
    let corner = (CORNER * (nw + ne + sw + se)).max(MIN_CORNER);
    let along = across / (across.abs().min_element() + corner);
    let along = along.clamp(Vec2::splat(-MAX_SPAN), Vec2::splat(MAX_SPAN));
    let sample = |part: f32| bilinear(image, at.as_vec2() + 0.5 + along * part);
    let near = 0.5 * (sample(-1.0 / 6.0) + sample(1.0 / 6.0));
    let wide = 0.5 * near + 0.25 * (sample(-0.5) + sample(0.5));
    // Beyond the end of the edge is something else.
    let brightness = luminance(wide);
    Some(if brightness < darkest || brightness > brightest { near } else { wide })
}

/// Compressed color at a position, pixels.
fn bilinear(image: &Image<Vec4>, position: Vec2) -> Vec3 {
    let corner = (position - 0.5).floor();
    let t = position - 0.5 - corner;
    let load = |x: i32, y: i32| compressed(image.load(corner.as_ivec2() + IVec2::new(x, y)).xyz());
    let row = |y: i32| load(0, y).lerp(load(1, y), t.x);
    row(0).lerp(row(1), t.y)
}
