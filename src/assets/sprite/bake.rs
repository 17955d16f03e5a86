//! Bakes a sprite flipbook: a cluster of metaballs, eroded by turbulent noise, seen from the front.
//!
//! OTEE: "Grayscale heightmaps never get curvy enough … use metaballs, then add some procedural bump." So the baker has no
//! height map at all: it marches through a density volume and collects the normals on the way.

mod cluster;
mod cube;
mod frame;
mod recipe;
mod shrink;
mod slices;

use glam::{IVec2, UVec2};
use image::{Rgba, RgbaImage};

use super::Sprite;
use super::detail::{detail, detail_size};
use crate::error::FieldError;
use crate::settings::validate;

pub use frame::BakedFrame;
pub use recipe::{RECIPE_VERSION, SpriteRecipe};
use shrink::{shrink_detail, shrink_frame};
use slices::Slices;

/// What a recipe makes.
#[derive(Clone, Debug)]
pub struct BakedSprite {
    /// The flipbook: rgb = normal / 2 + 1/2 (x right, y up, z to the viewer), a = amount.
    pub picture: RgbaImage,
    /// Depth and motion, see [`detail`](crate::assets::sprite::detail).
    pub detail: RgbaImage,
}

impl SpriteRecipe {
    /// Bakes the whole sheet and its details. `progress` is told how many frames are done; its error ends the work.
    ///
    /// # Errors
    /// The first number of the recipe that is out of range, or what `progress` says.
    pub fn bake<E: From<FieldError>>(&self, progress: impl Fn(u32) -> Result<(), E>) -> Result<BakedSprite, E> {
        validate(self, String::new)?;
        let bake = self.baker();
        let frame = |frame| progress(frame).map(|()| bake(frame as f32));
        let frames = (0..self.frame_count()).map(frame).collect::<Result<Vec<_>, E>>()?;
        let pictures = frames.iter().flat_map(|frame| frame.picture.texels.iter().map(|texel| texel.0));
        let sprite = Sprite::with_levels(self.size, self.frame_count(), pictures.collect());
        let mut details: Vec<_> =
            (0..).zip(&frames).map(|(frame, baked)| detail(&sprite, frame, &baked.offset)).collect();
        if self.tolerance > 0 {
            details.iter_mut().for_each(|detail| shrink_detail(detail, self.tolerance / 2));
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

    /// Bakes one moment of the loop; `frame` 0.5 is half way between the first two.
    pub fn bake_frame(&self, frame: f32) -> BakedFrame {
        self.baker()(frame)
    }

    /// Bakes moments, with what they share worked out once.
    fn baker(&self) -> impl Fn(f32) -> BakedFrame + '_ {
        let count = self.frame_count() as f32;
        let slices = (self.version > 1).then(|| Slices::new(self));
        move |frame| {
            let time = frame / count;
            let mut frame = slices.as_ref().map_or_else(|| cube::frame(self, time), |slices| slices.frame(time));
            if self.tolerance > 0 {
                shrink_frame(&mut frame.picture, self.tolerance);
            }
            frame
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::assets::json;

    fn puff() -> SpriteRecipe {
        let recipe = include_str!("../../../tests/corpus/sprite/good_first");
        json::parse(Path::new("puff.sprite.json"), recipe).unwrap()
    }

    fn bake(recipe: &SpriteRecipe) -> Result<BakedSprite, FieldError> {
        recipe.bake(|_| Ok(()))
    }

    #[test]
    fn every_seed_is_as_good_as_the_next() {
        // The second times 31 is the last word there is.
        for seed in [0, 1_108_378_657, u32::MAX] {
            for version in [1, 2] {
                let frame = SpriteRecipe { seed, version, size: 8, ..puff() }.bake_frame(0.0);
                assert!(frame.offset.texels.iter().all(|offset| offset.is_finite()));
            }
        }
    }

    #[test]
    fn what_is_new_needs_the_new_version() {
        for change in [
            (|recipe| recipe.length = 0.5) as fn(&mut SpriteRecipe),
            |recipe| recipe.upright = 0.5,
            |recipe| recipe.lumps = 0.5,
            |recipe| recipe.travel = 0.5,
        ] {
            let mut recipe = SpriteRecipe { size: 32, columns: 2, rows: 1, ..puff() };
            change(&mut recipe);
            assert!(bake(&recipe).is_err());
            // Each is seen; `upright` where there are lines.
            let plain = SpriteRecipe { version: 2, length: recipe.length.max(recipe.upright), ..puff() };
            let plain = SpriteRecipe { size: 32, columns: 2, rows: 1, ..plain };
            recipe = SpriteRecipe { version: 2, length: plain.length, ..recipe };
            let plain = if recipe.length > 0.0 && recipe.upright <= 0.0 {
                SpriteRecipe { length: 0.0, ..plain }
            } else {
                plain
            };
            assert!(bake(&recipe).unwrap().picture != bake(&plain).unwrap().picture);
        }
    }

    #[test]
    fn both_versions_show_the_same() {
        let recipe = SpriteRecipe { size: 64, ..puff() };
        let [first, second] =
            [1, 2].map(|version| SpriteRecipe { version, ..recipe.clone() }.bake_frame(1.5).picture.texels);
        let texels = first.iter().zip(&second).filter(|(first, second)| first.0[3].max(second.0[3]) > 40);
        let off: Vec<[f32; 4]> =
            texels.map(|(a, b)| std::array::from_fn(|c| f32::from(a.0[c].abs_diff(b.0[c])))).collect();
        let mean: [f32; 4] = std::array::from_fn(|c| off.iter().map(|off| off[c]).sum::<f32>() / off.len() as f32);
        // A voxel of the second is four times as deep; another seed is some 40 off.
        assert!(off.len() > 1000 && mean.iter().all(|&mean| mean < 12.0), "{mean:?}");
    }

    #[test]
    fn progress_is_told_and_ends_the_work() {
        let told = std::cell::RefCell::new(Vec::new());
        let recipe = SpriteRecipe { version: 2, size: 8, columns: 3, rows: 1, ..puff() };
        let bake = |last| {
            let error = || FieldError::new("", "", "");
            recipe.bake(|frame| {
                told.borrow_mut().push(frame);
                if frame < last { Ok(()) } else { Err(error()) }
            })
        };
        assert!(bake(9).is_ok());
        assert_eq!(told.take(), [0, 1, 2]);
        assert!(bake(1).is_err());
        assert_eq!(told.take(), [0, 1]);
    }

    #[test]
    fn what_is_written_is_read_again() {
        let path = Path::new("a.sprite.json");
        for recipe in [puff(), SpriteRecipe { version: 2, travel: 0.25, ..puff() }] {
            let text = recipe.to_text();
            assert_eq!(json::parse::<SpriteRecipe>(path, &text).unwrap(), recipe);
            // Programs that know no version 2 read what it is not needed for.
            assert_eq!(text.contains("\"travel\": 0.25"), recipe.version == 2);
            assert!(text.ends_with("}\n") && !text.contains("\"length\""), "{text}");
        }
    }
}
