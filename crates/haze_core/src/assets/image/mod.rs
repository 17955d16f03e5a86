//! Images in memory with parallel iteration over rows, and reading of PNG files.

mod color_space;
mod decoder_panic;
mod icc_profile;
mod png;
pub mod png_chunks;
pub mod primaries;

pub use color_space::{color_conversion_notes, decode_color_png, read_color_png};
pub use decoder_panic::{catch_decoder_panic, is_decoding};
pub use png::{MAX_BYTES, MAX_SIDE, decode_png, is_png, read_file, read_png};

use glam::{IVec2, UVec2, Vec3, Vec4};
use serde::{Deserialize, Serialize};

use crate::assets::parallel::{parallel_for_each, thread_count};
use crate::formula::texture::Texture2d;

/// A 2D image, row by row from the top.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Image<T> {
    /// Width and height.
    pub size: UVec2,
    /// `size.x * size.y` texels.
    pub texels: Vec<T>,
}

impl<T: Copy + Send> Image<T> {
    /// Creates an image filled with `texel`.
    pub fn new(size: UVec2, texel: T) -> Self {
        Self { size, texels: vec![texel; (size.x * size.y) as usize] }
    }

    /// Returns the texel at a position. Positions outside are clamped to the border.
    pub fn load(&self, at: IVec2) -> T {
        let at = at.clamp(IVec2::ZERO, self.size.as_ivec2() - 1).as_uvec2();
        self.texels[(at.y * self.size.x + at.x) as usize]
    }

    /// Calls `f(first_row, rows)` for bands of rows, on all processors.
    pub fn for_bands(&mut self, f: impl Fn(u32, &mut [T]) + Sync) {
        let width = self.size.x as usize;
        // More bands than threads, since smoke is rarely distributed evenly.
        let rows = (self.size.y as usize).div_ceil(thread_count() * 4).max(1);
        parallel_for_each(self.texels.chunks_mut(rows * width).enumerate(), |(index, band)| {
            f((index * rows) as u32, band);
        });
    }

    /// Calls `f(position, texel)` for every texel, on all processors.
    pub fn for_each(&mut self, f: impl Fn(UVec2, &mut T) + Sync) {
        let width = self.size.x;
        self.for_bands(|first_row, band| {
            for (index, texel) in (0u32..).zip(band.iter_mut()) {
                f(UVec2::new(index % width, first_row + index / width), texel);
            }
        });
    }
}

impl Texture2d for Image<Vec3> {
    fn dimensions(&self) -> UVec2 {
        self.size
    }

    fn load(&self, at: UVec2) -> Vec4 {
        self.texels[(at.y * self.size.x + at.x) as usize].extend(1.0)
    }
}
