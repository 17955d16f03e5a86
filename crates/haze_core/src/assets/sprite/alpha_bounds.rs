//! Bounds of a sprite's non-zero alpha, per frame and mip level. Both paths skip the clear parts of a sprite's square.

use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec4};

use crate::formula::sprite::FlipbookFrames;

/// Alpha bounds of a frame at a mip level, including the footprint of bilinear filtering. Read by
/// `alpha_bounds_texel()` in `shaders/lib/sprite_vertex.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct AlphaBoundsTexel {
    /// Bit mask of 8 by 8 cells: a bit is set if its cell has any amount. Row by row from the top, first cell in the
    /// lowest bit.
    cells: u64,
    /// Extent of the amount from the middle, left, down, right and up: 255 is half a side.
    reach: [u8; 4],
    padding: u32,
}

/// Alpha bounds of all frames and mip levels of a sprite.
#[derive(Debug)]
pub struct AlphaBounds {
    level_count: u32,
    /// Entries frame by frame, each with all mip levels.
    texels: Vec<AlphaBoundsTexel>,
}

impl AlphaBounds {
    /// `texels`: frame by frame, each with all mip levels.
    pub(super) fn new(level_count: u32, texels: Vec<AlphaBoundsTexel>) -> Self {
        Self { level_count, texels }
    }

    /// Returns the number of mip levels (x) and frames (y).
    pub fn size(&self) -> UVec2 {
        UVec2::new(self.level_count, self.texels.len() as u32 / self.level_count)
    }

    /// Returns the texels as the shaders read them, frame by frame: two words of cells, one of the extent, one of padding.
    pub fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.texels)
    }

    /// Returns the extent of the amount from the middle in half sides: left, down, right, up. Covers both blended
    /// frames.
    pub fn trimmed_extent(&self, frames: FlipbookFrames, lod: f32) -> Vec4 {
        let level = (lod as u32).min(self.level_count - 1);
        let reach = |frame: i32| {
            let texel = self.texels.get((frame as u32 * self.level_count + level) as usize);
            texel.map_or(Vec4::ONE, |texel| Vec4::from(texel.reach.map(f32::from)) / 255.0)
        };
        let first = reach(frames.first);
        if frames.blend > 0.0 { first.max(reach(frames.second)) } else { first }
    }
}

/// Computes the bounds of a frame at a mip level. `texels`: row by row from the top, `size` in each.
pub(super) fn alpha_bounds_texel(texels: &[[u8; 4]], size: u32) -> AlphaBoundsTexel {
    const CELLS: f32 = 8.0;
    // Bilinear filtering extends a texel by half a texel; 0.05 more allows for the sampler's rounding.
    let found = |texel: u32| [texel as f32 - 0.55, texel as f32 + 1.55].map(|position| position / size as f32);
    let cells = |texel: u32| found(texel).map(|position| (position * CELLS).clamp(0.0, CELLS - 1.0) as u64);
    let columns: Vec<u64> = (0..size)
        .map(|x| {
            let [first, last] = cells(x);
            (2 << last) - (1 << first)
        })
        .collect();
    let mut alpha_bounds = AlphaBoundsTexel::zeroed();
    let mut reach = [0.0_f32; 4];
    for (y, row) in (0..).zip(texels.chunks_exact(size as usize)) {
        let is_filled = |texel: &[u8; 4]| texel[3] > 0;
        let (Some(first), Some(last)) = (row.iter().position(is_filled), row.iter().rposition(is_filled)) else {
            continue;
        };
        let in_row = row.iter().zip(&columns).filter(|(texel, _)| is_filled(texel));
        let in_row = in_row.fold(0, |all, (_, columns)| all | columns);
        let [top, bottom] = cells(y);
        alpha_bounds.cells |= (top..=bottom).fold(0, |all, row| all | in_row << (8 * row));
        let [left, _] = found(first as u32);
        let [_, right] = found(last as u32);
        let [top, bottom] = found(y);
        let of_row = [1.0 - 2.0 * left, 2.0 * bottom - 1.0, 2.0 * right - 1.0, 1.0 - 2.0 * top];
        reach.iter_mut().zip(of_row).for_each(|(reach, of_row)| *reach = reach.max(of_row));
    }
    alpha_bounds.reach = reach.map(|fraction| (fraction * 255.0).ceil().min(255.0) as u8);
    alpha_bounds
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::{Vec2, Vec4Swizzles};
    use image::{Rgba, RgbaImage};

    use super::super::{Sprite, SpriteLayout};
    use super::*;
    use crate::formula::sprite::{sample_sprite, sprite_uv};

    fn sprite(width: u32, columns: u32, x: u32, y: u32) -> Sprite {
        let mut sheet = RgbaImage::from_pixel(width, width / columns, Rgba([128, 128, 255, 0]));
        sheet.put_pixel(x, y, Rgba([128, 128, 255, 255]));
        Sprite::from_image(Path::new(""), &sheet, SpriteLayout { columns, ..SpriteLayout::default() }).unwrap()
    }

    #[test]
    fn cells_include_the_footprint_of_bilinear_filtering() {
        let cells = |sprite: &Sprite, level, frame| {
            alpha_bounds_texel(sprite.frame_texels(level, frame), sprite.level_size(level)).cells
        };
        let one = sprite(64, 2, 32 + 14, 21);
        assert_eq!(cells(&one, 0, 0), 0);
        // The footprint is texels 13.5 to 15.5 across and 20.5 to 22.5 down; a cell has four texels.
        assert_eq!(cells(&one, 0, 1), 1 << (8 * 5 + 3));
        let beside = sprite(32, 1, 12, 21);
        assert_eq!(cells(&beside, 0, 0), 0b1100 << (8 * 5));
        // At level 2 a cell is one texel wide; at level 4 a quarter of a texel.
        assert_eq!(cells(&beside, 2, 0).count_ones(), 3 * 3);
        assert_eq!(cells(&beside, 4, 0).count_ones(), 7 * 7);
    }

    #[test]
    fn lookups_beyond_a_sprites_extent_are_clear() {
        let layout = SpriteLayout { columns: 4, rows: 2, y_down: false };
        let sprite = Sprite::load(Path::new("../../sprites/puff.png"), layout).unwrap();
        let alpha_bounds = sprite.alpha_bounds(None);
        let mut beyond = 0;
        for (frame, level) in (0..4).flat_map(|frame| (0..sprite.level_count()).map(move |level| (frame, level))) {
            let frames = FlipbookFrames { first: frame, second: frame + 1, blend: 0.5 };
            let reach = alpha_bounds.trimmed_extent(frames, level as f32);
            for position in (0..128 * 128).map(|i| (UVec2::new(i % 128, i / 128).as_vec2() + 0.5) / 64.0 - 1.0) {
                let is_within = position.cmpge(-reach.xy()).all() && position.cmple(reach.zw()).all();
                let found = sample_sprite(&sprite, sprite_uv(position), frames, Vec2::ZERO, level as f32).w;
                assert!(
                    is_within || found == 0.0,
                    "frame {frame}, level {level}: {found} at {position}, reach {reach}"
                );
                beyond += u32::from(!is_within);
            }
        }
        assert!(beyond > 128 * 128 * 4, "{beyond}");
    }

    #[test]
    fn the_extent_includes_the_footprint_of_bilinear_filtering() {
        let alpha_bounds = sprite(128, 2, 64 + 50, 14).alpha_bounds(None);
        let frames = |first, blend| FlipbookFrames { first, second: 1, blend };
        assert_eq!(alpha_bounds.trimmed_extent(frames(0, 0.0), 0.0), Vec4::ZERO);
        // The footprint is texels 49.45 to 51.55 across and 13.45 to 15.55 down of 64, so right of and above the middle
        // at 32.
        let reach = Vec4::new(0.0, 0.0, 19.55 / 32.0, 18.55 / 32.0);
        for frames in [frames(1, 0.0), frames(0, 0.1)] {
            let found = alpha_bounds.trimmed_extent(frames, 0.0);
            assert!((found - reach).min_element() >= 0.0 && (found - reach).max_element() < 1.0 / 255.0, "{found}");
        }
        // At this level a frame has four texels per side; the texel is the last one across and the first one down.
        assert_eq!(alpha_bounds.trimmed_extent(frames(1, 0.0), 4.0), Vec4::new(0.0, 0.0, 1.0, 1.0));
    }
}
