//! Runs a recipe, and bakes its frames to the images of a sprite.

use glam::{UVec2, UVec3, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::sprite::Sprite;
use haze_core::error::FieldError;
use haze_core::formula::saturate;
use image::{GrayImage, Luma};

use super::domain::Domain;
use super::fluid::Fluid;
use super::framing::Window;
use super::recorded_frame::{Extent, FrameSampler, RecordedFrame, visible_density};
use super::sim_recipe::{FrameLoop, SimRecipe};
use crate::path_trace::{DensityVolume, Medium, voxel_center};
use crate::sprite::bake::{BakedFrame, BakedSprite, Surface, march_volume};
use crate::sprite::detail::{bake_detail_frame, detail_size, optical_flow};
use crate::sprite::six_way::{BakedSixWay, bake_six_way};

/// A finished simulation, from which images are baked.
pub struct Simulation {
    recipe: SimRecipe,
    /// Frames of the sheet, and those after it that blend into its first ones.
    frames: Vec<RecordedFrame>,
    fine: Domain,
    window: Window,
}

/// Images baked from a simulation.
#[derive(Clone, Debug)]
pub struct BakedSimulation {
    /// Flipbook and detail map.
    pub sprite: BakedSprite,
    /// Mean heat of what is visible, 0 to 1, if fuel burns; in the layout of the flipbook.
    pub heat: Option<GrayImage>,
}

/// Density of one frame at the resolution of a sprite.
struct FrameVolume {
    density: DensityVolume,
    /// Velocity along x and y, sides of the sprite per frame, and heat, of every voxel.
    carried: Vec<Vec3>,
}

impl SimRecipe {
    /// Returns the number of frames after the sheet's that blend into its first ones.
    fn blended_frames(&self) -> u32 {
        match self.time.frame_loop {
            FrameLoop::Once => 0,
            FrameLoop::CrossBlend => (self.sheet.frame_count() as f32 * self.time.blend).round() as u32,
        }
    }

    /// Returns the number of moments that are simulated for the sheet.
    pub fn moment_count(&self) -> u32 {
        self.sheet.frame_count() + self.blended_frames()
    }

    /// Simulates all frames. `progress` is called with the number of finished moments, of [`Self::moment_count`]; an
    /// error from it cancels the simulation.
    ///
    /// # Errors
    /// The first field of the recipe that is not valid, or the error of `progress`.
    pub fn simulate<E: From<FieldError>>(&self, progress: impl Fn(u32) -> Result<(), E>) -> Result<Simulation, E> {
        self.validate()?;
        let mut fluid = Fluid::new(self);
        let step = self.seconds_per_frame();
        progress(0)?;
        // The warm-up in steps of about a frame, so that sources begin and end on time.
        let steps = (self.time.warm_up / step).ceil().min(1.0e4) as u32;
        for _ in 0..steps {
            fluid.advance(self.time.warm_up / steps as f32);
            progress(0)?;
        }
        let mut frames = Vec::new();
        for moment in 0..self.moment_count() {
            fluid.advance(step);
            frames.push(RecordedFrame::new(&fluid, &self.view));
            progress(moment + 1)?;
        }
        let extent = frames.iter().map(|frame| frame.extent).fold(Extent::EMPTY, Extent::union);
        let window = Window::new(self, fluid.domain, extent);
        Ok(Simulation { recipe: self.clone(), frames, fine: fluid.fine, window })
    }

    fn seconds_per_frame(&self) -> f32 {
        self.time.duration / self.sheet.frame_count() as f32
    }
}

impl Simulation {
    /// Bakes the flipbook, its detail map, and the heat map of a fire.
    pub fn bake(&self) -> BakedSimulation {
        let sheet = self.recipe.sheet;
        let mut frames: Vec<_> = (0..sheet.frame_count()).map(|frame| self.bake_frame(frame)).collect();
        let sprite = sheet.assemble(&mut frames, |sprite, frame, baked| {
            bake_detail_frame(sprite, frame, &baked.offset, &motion(sprite, frame, baked))
        });
        let heat = self.recipe.burns().then(|| {
            GrayImage::from_fn(sheet.size * sheet.columns, sheet.size * sheet.rows, |x, y| {
                let frame = &frames[(y / sheet.size * sheet.columns + x / sheet.size) as usize];
                let heat = frame.carried.load(UVec2::new(x % sheet.size, y % sheet.size).as_ivec2()).z;
                Luma([(saturate(heat) * 255.0).round() as u8])
            })
        });
        BakedSimulation { sprite, heat }
    }

    /// Bakes six-way maps of a medium, as
    /// [`SpriteRecipe::bake_six_way`](crate::sprite::bake::SpriteRecipe::bake_six_way).
    ///
    /// # Errors
    /// The error of `progress`.
    pub fn bake_six_way<E>(
        &self,
        medium: &Medium,
        samples: u32,
        progress: impl Fn(u32, u32) -> Result<(), E>,
    ) -> Result<BakedSixWay, E> {
        let sheet = self.recipe.sheet;
        let frame = |frame: u32| {
            let mut shape = self.bake_frame(frame).image;
            sheet.quantise(&mut shape);
            (self.volume(frame, (sheet.size / 2).max(8)).density, shape)
        };
        bake_six_way(sheet, medium, samples, frame, progress)
    }

    fn bake_frame(&self, frame: u32) -> BakedFrame {
        let view = &self.recipe.view;
        let FrameVolume { density, carried } = self.volume(frame, self.recipe.sheet.size);
        let surface = Surface { extinction: view.extinction, bump: view.bump };
        march_volume(surface, &density, |voxel| carried[voxel])
    }

    /// Samples a frame on `size` by `size` by `size` / 2 voxels.
    fn volume(&self, frame: u32, size: u32) -> FrameVolume {
        let sides = UVec3::new(size, size, (size / 2).max(4));
        // A blended frame is the mix of itself and of the one a loop later.
        let blended = self.recipe.blended_frames();
        let later = self.frames.get((frame + self.recipe.sheet.frame_count()) as usize).filter(|_| frame < blended);
        let fraction = if later.is_some() { frame as f32 / blended as f32 } else { 1.0 };
        let samplers: Vec<(FrameSampler, f32)> = [(self.frames.get(frame as usize), fraction), (later, 1.0 - fraction)]
            .into_iter()
            .filter_map(|(frame, fraction)| Some((frame?.sampler()?, fraction)))
            .collect();
        let to_motion = self.recipe.seconds_per_frame() / (2.0 * self.window.half_side);
        let mut voxels = Image::new(UVec2::new(size, size * sides.z), (0.0, Vec3::ZERO));
        voxels.for_each(|at, (density, carried)| {
            let point = voxel_center(sides, UVec3::new(at.x, at.y % size, at.y / size));
            let fade = self.window.fade(point);
            if fade <= 0.0 {
                return;
            }
            let coordinate = self.fine.coordinate(self.window.gas_position(point));
            for (sampler, fraction) in &samplers {
                let [smoke, heat, x, y] = sampler.sample(coordinate).to_array();
                let visible = visible_density(&self.recipe.view, smoke, heat) * fade * fraction;
                *density += visible;
                *carried += Vec3::new(x * to_motion, -y * to_motion, heat) * visible;
            }
            *carried /= density.max(1.0e-6);
        });
        let (densities, carried) = voxels.texels.into_iter().unzip();
        FrameVolume { density: DensityVolume { size: sides, densities }, carried }
    }
}

/// Returns the motion of a frame's texels to the next frame: that of the gas, refined by optical flow.
fn motion(sprite: &Sprite, frame: u32, baked: &BakedFrame) -> Image<Vec2> {
    optical_flow(sprite, frame, Some(&gas_motion(sprite, frame, baked)))
}

/// Returns the velocity of what is visible, at the size of the detail map.
fn gas_motion(sprite: &Sprite, frame: u32, baked: &BakedFrame) -> Image<Vec2> {
    let size = detail_size(sprite.size());
    let scale = sprite.size() / size;
    let mut motion = Image::new(UVec2::splat(size), Vec2::ZERO);
    motion.for_each(|at, motion| {
        let mut weight = 1.0e-6;
        for index in 0..scale * scale {
            let fine = at * scale + UVec2::new(index % scale, index / scale);
            let amount = sprite.texel(0, frame, fine.x, fine.y).w;
            *motion += baked.carried.load(fine.as_ivec2()).truncate() * amount;
            weight += amount;
        }
        *motion /= weight;
    });
    motion
}
