//! Bakes a sprite flipbook: a cluster of metaballs, eroded by turbulent noise, viewed from the front.
//!
//! OTEE: "Grayscale heightmaps never get curvy enough … use metaballs, then add some procedural bump." The baker
//! therefore uses no height map: it ray-marches a density volume and accumulates normals.

mod baked_frame;
mod cluster;
mod erosion;
mod loop_state;
mod march;
pub(super) mod near_lossless;
mod sprite_recipe;
mod volume_baker;
mod voxel_grid;

use glam::{IVec2, UVec2};
use haze_core::assets::parallel::parallel_for_each;
use haze_core::assets::sprite::Sprite;
use haze_core::error::FieldError;
use haze_core::settings::validate;
use image::{Rgba, RgbaImage};

use crate::path_trace::DensityVolume;
use crate::sprite::detail::{bake_detail_frame, detail_size};

pub use baked_frame::BakedFrame;
use near_lossless::{quantise_detail, quantise_frame};
pub use sprite_recipe::{RECIPE_VERSION, SpriteRecipe};
use volume_baker::VolumeBaker;

/// Images baked from a recipe.
#[derive(Clone, Debug)]
pub struct BakedSprite {
    /// Flipbook: rgb = normal / 2 + 1/2 (x right, y up, z towards the viewer), a = amount.
    pub picture: RgbaImage,
    /// Detail map (depth and motion), see [`detail`](crate::sprite::detail).
    pub detail: RgbaImage,
}

impl SpriteRecipe {
    /// Bakes the flipbook and its detail map. `progress` is called with the number of finished frames; an error from it
    /// cancels the bake.
    ///
    /// # Errors
    /// The first field of the recipe that is out of range, or the error of `progress`.
    pub fn bake<E: From<FieldError>>(&self, progress: impl Fn(u32) -> Result<(), E>) -> Result<BakedSprite, E> {
        validate(self, String::new)?;
        let bake = self.frame_baker();
        let frame = |frame| progress(frame).map(|()| bake(frame as f32));
        let mut frames = (0..self.frame_count()).map(frame).collect::<Result<Vec<_>, E>>()?;
        parallel_for_each(frames.iter_mut(), |frame| self.quantise(frame));
        let pictures = frames.iter().flat_map(|frame| frame.picture.texels.iter().map(|texel| texel.0));
        let sprite = Sprite::with_levels(self.size, self.frame_count(), pictures.collect());
        let mut details: Vec<_> =
            (0..).zip(&frames).map(|(frame, baked)| bake_detail_frame(&sprite, frame, &baked.offset)).collect();
        if self.tolerance > 0 {
            details.iter_mut().for_each(|detail| quantise_detail(detail, self.tolerance / 2));
        }
        Ok(BakedSprite {
            picture: self.assemble_sheet(self.size, |frame, at| frames[frame].picture.load(at)),
            detail: self.assemble_sheet(detail_size(self.size), |frame, at| details[frame].load(at)),
        })
    }

    fn assemble_sheet(&self, size: u32, texel: impl Fn(usize, IVec2) -> Rgba<u8>) -> RgbaImage {
        RgbaImage::from_fn(size * self.columns, size * self.rows, |x, y| {
            let frame = y / size * self.columns + x / size;
            texel(frame as usize, UVec2::new(x % size, y % size).as_ivec2())
        })
    }

    /// Bakes one moment of the loop. `frame` is a frame index and may be fractional: 0.5 is halfway between the first
    /// two frames.
    pub fn bake_frame(&self, frame: f32) -> BakedFrame {
        let mut frame = self.frame_baker()(frame);
        self.quantise(&mut frame);
        frame
    }

    /// Returns the density volume of one moment of the loop.
    pub fn volume(&self, frame: f32) -> DensityVolume {
        VolumeBaker::new(self).volume(frame / self.frame_count() as f32)
    }

    /// Returns a function that bakes a moment without shrinking. Data that all moments share is computed once.
    fn frame_baker(&self) -> impl Fn(f32) -> BakedFrame + '_ {
        let count = self.frame_count() as f32;
        let baker = VolumeBaker::new(self);
        move |frame| baker.frame(frame / count)
    }

    fn quantise(&self, frame: &mut BakedFrame) {
        if self.tolerance > 0 {
            quantise_frame(&mut frame.picture, self.tolerance);
        }
    }
}

#[cfg(test)]
mod tests;
