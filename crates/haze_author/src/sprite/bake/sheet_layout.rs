//! Layout of a flipbook's sheet, and its assembly from frames.

use glam::{IVec2, UVec2};
use haze_core::assets::image::{Image, MAX_SIDE};
use haze_core::assets::parallel::parallel_for_each;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::settings::{FieldVisitor, Fields};
use image::{Rgba, RgbaImage};

use super::baked_frame::BakedFrame;
use super::near_lossless::{quantise_detail, quantise_frame};
use crate::sprite::detail::detail_size;

/// Frames on a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SheetLayout {
    /// Width and height of one frame.
    pub size: u32,
    /// Columns of frames on the sheet.
    pub columns: u32,
    /// Rows of frames on the sheet.
    pub rows: u32,
    /// Maximum change of a texel to make the file smaller. Normals in thin smoke may change up to four times as much,
    /// depth and motion half as much. 2 halves the file size without a visible difference.
    pub tolerance: u32,
}

impl Default for SheetLayout {
    fn default() -> Self {
        Self { size: 128, columns: 8, rows: 8, tolerance: 2 }
    }
}

impl Fields for SheetLayout {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.integer("size", &mut self.size, 8..=512, "pixels");
        // The sheet must stay within the size limit for reading.
        let most = (MAX_SIDE / self.size.max(1)).min(16);
        visitor.integer("columns", &mut self.columns, 1..=most, "frames");
        visitor.integer("rows", &mut self.rows, 1..=most, "frames");
        visitor.integer("tolerance", &mut self.tolerance, 0..=8, "of 255");
    }
}

/// Images baked from a recipe.
#[derive(Clone, Debug)]
pub struct BakedSprite {
    /// Flipbook: rgb = normal / 2 + 1/2 (x right, y up, z towards the viewer), a = amount.
    pub image: RgbaImage,
    /// Detail map (depth and motion), see [`detail`](crate::sprite::detail).
    pub detail: RgbaImage,
}

impl SheetLayout {
    /// Returns the number of frames on the sheet.
    pub fn frame_count(self) -> u32 {
        self.columns * self.rows
    }

    /// Returns the layout of frames on the sheet.
    pub fn layout(self) -> SpriteLayout {
        SpriteLayout { columns: self.columns, rows: self.rows, y_down: false }
    }

    /// Moves the texels of a frame within the tolerance.
    pub fn quantise(self, frame: &mut Image<Rgba<u8>>) {
        if self.tolerance > 0 {
            quantise_frame(frame, self.tolerance);
        }
    }

    /// Quantises the frames, which are those of the sheet in order, and assembles the sheet and its detail map.
    /// `detail` bakes the detail map of a frame.
    pub fn assemble(
        self,
        frames: &mut [BakedFrame],
        detail: impl Fn(&Sprite, u32, &BakedFrame) -> Image<Rgba<u8>>,
    ) -> BakedSprite {
        parallel_for_each(frames.iter_mut(), |frame| self.quantise(&mut frame.image));
        let images = frames.iter().flat_map(|frame| frame.image.texels.iter().map(|texel| texel.0));
        let sprite = Sprite::with_levels(self.size, self.frame_count(), images.collect());
        let mut details: Vec<_> = (0..).zip(&*frames).map(|(frame, baked)| detail(&sprite, frame, baked)).collect();
        if self.tolerance > 0 {
            details.iter_mut().for_each(|detail| quantise_detail(detail, self.tolerance / 2));
        }
        BakedSprite {
            image: self.assemble_sheet(self.size, |frame, at| frames[frame].image.load(at)),
            detail: self.assemble_sheet(detail_size(self.size), |frame, at| details[frame].load(at)),
        }
    }

    /// Assembles a sheet of frames of `size` by `size` texels.
    pub fn assemble_sheet(self, size: u32, texel: impl Fn(usize, IVec2) -> Rgba<u8>) -> RgbaImage {
        RgbaImage::from_fn(size * self.columns, size * self.rows, |x, y| {
            let frame = y / size * self.columns + x / size;
            texel(frame as usize, UVec2::new(x % size, y % size).as_ivec2())
        })
    }
}
