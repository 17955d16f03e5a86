//! One file of a set of sheets.

use std::path::{Path, PathBuf};

use glam::{IVec2, UVec2, Vec4};
use image::RgbaImage;

use super::super::opacity::{has_alpha, is_gray};
use super::frame_grid::FrameGrid;

/// A decoded file, with properties that several questions need.
#[derive(Clone, Debug)]
pub struct SheetFile {
    /// File.
    pub path: PathBuf,
    /// Its texels, as in the file.
    pub image: RgbaImage,
    /// True if alpha differs between texels.
    pub has_alpha: bool,
    /// True if texels are gray.
    pub is_gray: bool,
}

impl SheetFile {
    /// Measures a decoded file.
    pub fn new(path: &Path, image: RgbaImage) -> Self {
        Self { path: path.into(), has_alpha: has_alpha(&image), is_gray: is_gray(&image), image }
    }

    /// Name without folder and extension.
    pub fn stem(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    pub(super) fn size(&self) -> UVec2 {
        UVec2::new(self.image.width(), self.image.height())
    }

    /// Most frequent color of texels at the borders of the sheet: that of clear texels, unless smoke reaches them all.
    pub(super) fn background(&self) -> [u8; 3] {
        let size = self.size();
        let rows = (0..size.x).flat_map(|x| [UVec2::new(x, 0), UVec2::new(x, size.y - 1)]);
        let columns = (0..size.y).flat_map(|y| [UVec2::new(0, y), UVec2::new(size.x - 1, y)]);
        let mut colors: Vec<[u8; 3]> = rows
            .chain(columns)
            .map(|at| {
                let [r, g, b, _] = self.image.get_pixel(at.x, at.y).0;
                [r, g, b]
            })
            .collect();
        colors.sort_unstable();
        let runs = colors.chunk_by(|a, b| a == b);
        runs.max_by_key(|run| run.len()).and_then(|run| run.first().copied()).unwrap_or_default()
    }

    /// Returns a texel of a frame of `size` texels, which may differ from the size of the file's own frames.
    pub(super) fn texel(&self, grid: &FrameGrid, frame: u32, at: UVec2, size: UVec2) -> Vec4 {
        let own = self.size() / grid.cells;
        let origin = (grid.cell(frame) * own).as_ivec2();
        let load = |at: IVec2| {
            let at = (origin + at.clamp(IVec2::ZERO, own.as_ivec2() - 1)).as_uvec2();
            Vec4::from(self.image.get_pixel(at.x, at.y).0.map(f32::from)) / 255.0
        };
        if own == size {
            return load(at.as_ivec2());
        }
        let position = (at.as_vec2() + 0.5) * own.as_vec2() / size.as_vec2() - 0.5;
        let base = position.floor();
        let fraction = position - base;
        let base = base.as_ivec2();
        let top = load(base).lerp(load(base + IVec2::X), fraction.x);
        let bottom = load(base + IVec2::Y).lerp(load(base + IVec2::ONE), fraction.x);
        top.lerp(bottom, fraction.y)
    }
}
