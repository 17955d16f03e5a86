//! Base color of a scene's materials: a texture with its reduced levels, sampled like a GPU does.

use std::sync::LazyLock;

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};
use haze_core::assets::image::Image;
use haze_core::formula::color::{linear_from_srgb, srgb_from_linear};

/// Continuation of a texture past its edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// It starts again.
    #[default]
    Repeat,
    /// It runs back.
    Mirror,
    /// The last texel goes on.
    Clamp,
}

/// Texture in sRGB code, with all reduced levels.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorTexture {
    /// Full size first. Each level has half the size of the one before, rounded down, to 1x1.
    pub levels: Vec<Image<[u8; 4]>>,
    /// Across and down.
    pub wrap: [Wrap; 2],
}

static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| linear_from_srgb(code as f32 / 255.0)));

fn linear(texel: [u8; 4]) -> Vec4 {
    let [red, green, blue] = [0, 1, 2].map(|channel| LINEAR[usize::from(texel[channel])]);
    Vec4::new(red, green, blue, f32::from(texel[3]) / 255.0)
}

fn code(color: Vec4) -> [u8; 4] {
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let [red, green, blue] = color.truncate().to_array().map(srgb_from_linear);
    [red, green, blue, color.w].map(byte)
}

impl ColorTexture {
    /// Makes the reduced levels of an image that is not empty. Levels wider or higher than `max_side` are left out.
    pub fn new(image: Image<[u8; 4]>, wrap: [Wrap; 2], max_side: u32) -> Self {
        let mut levels = vec![image];
        while let Some(last) = levels.last().filter(|last| last.size.max_element() > 1) {
            let next = halved(last);
            if last.size.max_element() > max_side {
                levels.clear();
            }
            levels.push(next);
        }
        Self { levels, wrap }
    }

    /// Memory of all levels, bytes.
    pub fn bytes(&self) -> u64 {
        self.levels.iter().map(|level| 4 * level.texels.len() as u64).sum()
    }

    /// Linear color at a position, filtered between texels and levels. Level 0 is full size.
    pub fn sample(&self, uv: Vec2, level: f32) -> Vec4 {
        let last = self.levels.len().saturating_sub(1) as f32;
        let level = level.clamp(0.0, last);
        let first = level.floor() as usize;
        let mix = level.fract();
        let fine = self.filtered(first, uv);
        if mix > 0.0 { fine.lerp(self.filtered(first + 1, uv), mix) } else { fine }
    }

    fn filtered(&self, level: usize, uv: Vec2) -> Vec4 {
        let Some(image) = self.levels.get(level) else { return Vec4::ONE };
        let position = uv * image.size.as_vec2() - 0.5;
        let at = position.floor().as_ivec2();
        let mix = position - position.floor();
        let texel = |x, y| {
            let wrapped = |position: i32, axis: usize| wrap(position, image.size[axis] as i32, self.wrap[axis]);
            linear(image.load(IVec2::new(wrapped(at.x.saturating_add(x), 0), wrapped(at.y.saturating_add(y), 1))))
        };
        let row = |y| texel(0, y).lerp(texel(1, y), mix.x);
        row(0).lerp(row(1), mix.y)
    }
}

fn wrap(position: i32, size: i32, wrap: Wrap) -> i32 {
    match wrap {
        Wrap::Repeat => position.rem_euclid(size),
        Wrap::Clamp => position.clamp(0, size - 1),
        Wrap::Mirror => {
            let position = position.rem_euclid(2 * size);
            position.min(2 * size - 1 - position)
        }
    }
}

/// Image of half the size: means of 2x2 texels, weighted by alpha.
fn halved(image: &Image<[u8; 4]>) -> Image<[u8; 4]> {
    let mut half = Image::new((image.size / 2).max(UVec2::ONE), [0; 4]);
    half.for_each(|at, texel| {
        let corner = |x, y| linear(image.load((2 * at + UVec2::new(x, y)).as_ivec2()));
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        let alpha: f32 = corners.iter().map(|corner| corner.w).sum();
        let weight = |corner: &Vec4| if alpha > 0.0 { corner.w / alpha } else { 0.25 };
        let color: Vec3 = corners.iter().map(|corner| corner.truncate() * weight(corner)).sum();
        *texel = code(color.extend(0.25 * alpha));
    });
    half
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_keep_the_light_and_wrapping_follows_the_edge() {
        let black_and_white = |at: u32| if at.is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] };
        let texels = (0..16).map(|index| black_and_white(index % 4 + index / 4)).collect();
        let image = Image { size: UVec2::splat(4), texels };
        let texture = ColorTexture::new(image.clone(), [Wrap::Repeat, Wrap::Clamp], 4);
        assert_eq!(texture.levels.iter().map(|level| level.size.x).collect::<Vec<_>>(), [4, 2, 1]);
        // Half of the light is code 188.
        assert_eq!(texture.levels[1].texels[0], [188, 188, 188, 255]);
        let middle = texture.sample(Vec2::splat(0.3), 9.0);
        assert!((middle.x - 0.5).abs() < 0.01 && (middle.w - 1.0).abs() < 1e-6, "{middle}");
        let at = |x: f32, y: f32| texture.sample(Vec2::new(x / 4.0, y / 4.0), 0.0).x;
        let bits = |values: [f32; 4]| values.map(f32::to_bits);
        assert_eq!(bits([at(0.5, 0.5), at(1.5, 0.5), at(4.5, 0.5), at(0.5, -9.0)]), bits([1.0, 0.0, 1.0, 1.0]));
        assert!((at(1.0, 0.5) - 0.5).abs() < 1e-6, "between texels");
        assert!([(-1, 0), (4, 3), (5, 2), (8, 0)].into_iter().all(|(at, is)| wrap(at, 4, Wrap::Mirror) == is));
        assert_eq!(ColorTexture::new(image, [Wrap::Clamp; 2], 2).levels.len(), 2, "too large a level is left out");
    }
}
