//! Reduced frames, which are enough to answer questions and quick to compare.

use glam::{IVec2, UVec2, Vec2, Vec4};
use haze_core::assets::image::Image;

use super::frame_grid::FrameGrid;
use super::sheet_file::SheetFile;

/// Most texels along a side.
const SIDE: u32 = 64;

/// Frames of equal size.
#[derive(Clone, Debug)]
pub(super) struct SmallFrames {
    pub size: UVec2,
    pub frames: Vec<Image<Vec4>>,
}

impl SmallFrames {
    /// Size to which frames of a file are reduced.
    pub fn size_for(file: &SheetFile, grid: &FrameGrid) -> UVec2 {
        let own = file.size() / grid.cells;
        let scale = own.max_element().div_ceil(SIDE).max(1);
        (own / scale).max(UVec2::ONE)
    }

    /// Reduces frames to a size: each texel is the mean of those in it, of at most 64 that are spread evenly.
    pub fn new(file: &SheetFile, grid: &FrameGrid, count: u32, size: UVec2) -> Self {
        let own = (file.size() / grid.cells).max(UVec2::ONE);
        let frames = (0..count).map(|frame| {
            let origin = grid.cell(frame) * own;
            let mut image = Image::new(size, Vec4::ZERO);
            image.for_each(|at, texel| {
                let low = at * own / size;
                let high = ((at + 1) * own / size).max(low + 1);
                let step = (high - low + 7) / 8;
                let mut taken = 0.0;
                for y in (low.y..high.y).step_by(step.y as usize) {
                    for x in (low.x..high.x).step_by(step.x as usize) {
                        let code = file.image.get_pixel(origin.x + x, origin.y + y).0;
                        *texel += Vec4::from(code.map(f32::from));
                        taken += 255.0;
                    }
                }
                *texel /= taken;
            });
            image
        });
        Self { size, frames: frames.collect() }
    }

    /// Builds frames of the same size from a function of frame and position.
    pub fn map(&self, texel: impl Fn(usize, IVec2) -> Vec4 + Sync) -> Self {
        let frames = (0..self.frames.len()).map(|frame| {
            let mut image = Image::new(self.size, Vec4::ZERO);
            image.for_each(|at, value| *value = texel(frame, at.as_ivec2()));
            image
        });
        Self { size: self.size, frames: frames.collect() }
    }

    /// Mean squared difference of two frames.
    pub fn difference(&self, a: u32, b: u32) -> f32 {
        let [Some(a), Some(b)] = [a, b].map(|frame| self.frames.get(frame as usize)) else { return 0.0 };
        let sum: f32 = a.texels.iter().zip(&b.texels).map(|(a, b)| (*a - *b).length_squared()).sum();
        sum / a.texels.len().max(1) as f32
    }
}

/// Samples a small frame between texels.
pub(super) fn bilinear(image: &Image<Vec4>, at: Vec2) -> Vec4 {
    let base = at.floor();
    let fraction = at - base;
    let base = base.as_ivec2();
    let top = image.load(base).lerp(image.load(base + IVec2::X), fraction.x);
    let bottom = image.load(base + IVec2::Y).lerp(image.load(base + IVec2::ONE), fraction.x);
    top.lerp(bottom, fraction.y)
}
