//! Bakes a sprite flipbook: a cluster of metaballs, eroded by turbulent noise, viewed from the front.
//!
//! OTEE: "Grayscale heightmaps never get curvy enough … use metaballs, then add some procedural bump." The baker
//! therefore uses no height map: it ray-marches a density volume and accumulates normals.

mod cluster;
mod cube;
mod erosion;
mod frame;
mod march;
mod moment;
mod recipe;
pub(super) mod shrink;
mod slices;
mod voxels;

use glam::{IVec2, UVec2};
use image::{Rgba, RgbaImage};

use super::detail::{detail, detail_size};
use crate::path_trace::Volume;
use haze::assets::parallel::parallel_for_each;
use haze::error::FieldError;
use haze::settings::validate;
use haze::sprite::Sprite;

pub use frame::BakedFrame;
pub use recipe::{RECIPE_VERSION, SpriteRecipe};
use shrink::{quantise_detail, quantise_frame};
use slices::Slices;

/// Images baked from a recipe.
#[derive(Clone, Debug)]
pub struct BakedSprite {
    /// Flipbook: rgb = normal / 2 + 1/2 (x right, y up, z towards the viewer), a = amount.
    pub picture: RgbaImage,
    /// Detail map (depth and motion), see [`detail`](crate::assets::sprite::detail).
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
        let bake = self.baker();
        let frame = |frame| progress(frame).map(|()| bake(frame as f32));
        let mut frames = (0..self.frame_count()).map(frame).collect::<Result<Vec<_>, E>>()?;
        parallel_for_each(frames.iter_mut(), |frame| self.shrink(frame));
        let pictures = frames.iter().flat_map(|frame| frame.picture.texels.iter().map(|texel| texel.0));
        let sprite = Sprite::with_levels(self.size, self.frame_count(), pictures.collect());
        let mut details: Vec<_> =
            (0..).zip(&frames).map(|(frame, baked)| detail(&sprite, frame, &baked.offset)).collect();
        if self.tolerance > 0 {
            details.iter_mut().for_each(|detail| quantise_detail(detail, self.tolerance / 2));
        }
        Ok(BakedSprite {
            picture: self.sheet(self.size, |frame, at| frames[frame].picture.load(at)),
            detail: self.sheet(detail_size(self.size), |frame, at| details[frame].load(at)),
        })
    }

    fn sheet(&self, size: u32, texel: impl Fn(usize, IVec2) -> Rgba<u8>) -> RgbaImage {
        RgbaImage::from_fn(size * self.columns, size * self.rows, |x, y| {
            let frame = y / size * self.columns + x / size;
            texel(frame as usize, UVec2::new(x % size, y % size).as_ivec2())
        })
    }

    /// Bakes one moment of the loop. `frame` is a frame index and may be fractional: 0.5 is halfway between the first
    /// two frames.
    pub fn bake_frame(&self, frame: f32) -> BakedFrame {
        let mut frame = self.baker()(frame);
        self.shrink(&mut frame);
        frame
    }

    /// Returns the density volume of one moment of the loop.
    pub fn volume(&self, frame: f32) -> Volume {
        let time = frame / self.frame_count() as f32;
        if self.version > 1 { Slices::new(self).volume(time) } else { cube::volume(self, time) }
    }

    /// Returns a function that bakes a moment without shrinking. Data that all moments share is computed once.
    fn baker(&self) -> impl Fn(f32) -> BakedFrame + '_ {
        let count = self.frame_count() as f32;
        let slices = (self.version > 1).then(|| Slices::new(self));
        move |frame| {
            let time = frame / count;
            slices.as_ref().map_or_else(|| cube::frame(self, time), |slices| slices.frame(time))
        }
    }

    fn shrink(&self, frame: &mut BakedFrame) {
        if self.tolerance > 0 {
            quantise_frame(&mut frame.picture, self.tolerance);
        }
    }
}

#[cfg(test)]
mod tests;
