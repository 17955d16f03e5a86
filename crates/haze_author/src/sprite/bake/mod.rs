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
mod sheet_layout;
mod sprite_recipe;
mod volume_baker;
mod voxel_grid;

use haze_core::error::FieldError;
use haze_core::settings::validate;

use crate::path_trace::DensityVolume;
use crate::sprite::detail::{bake_detail_frame, optical_flow};

pub use baked_frame::BakedFrame;
pub use march::{Surface, march_volume};
pub use sheet_layout::{BakedSprite, SheetLayout};
pub use sprite_recipe::{RECIPE_VERSION, SpriteRecipe};
use volume_baker::VolumeBaker;

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
        Ok(self.sheet().assemble(&mut frames, |sprite, frame, baked| {
            bake_detail_frame(sprite, frame, &baked.offset, &optical_flow(sprite, frame, None))
        }))
    }

    /// Returns the frames on the sheet.
    pub fn sheet(&self) -> SheetLayout {
        let Self { size, columns, rows, tolerance, .. } = *self;
        SheetLayout { size, columns, rows, tolerance }
    }

    /// Bakes one moment of the loop. `frame` is a frame index and may be fractional: 0.5 is halfway between the first
    /// two frames.
    pub fn bake_frame(&self, frame: f32) -> BakedFrame {
        let mut frame = self.frame_baker()(frame);
        self.sheet().quantise(&mut frame.image);
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
}

#[cfg(test)]
mod tests;
