//! Bakes frames of gas to the images of a sprite.

use glam::{UVec2, UVec3, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::formula::saturate;
use image::{GrayImage, Luma};

use super::domain::Domain;
use super::framing::Window;
use super::recorded_frame::{FrameSampler, RecordedFrame, visible_density};
use super::sim_recipe::View;
use crate::path_trace::{DensityVolume, Medium, voxel_center};
use crate::sprite::bake::{BakedFrame, BakedSprite, SheetLayout, Surface, march_volume};
use crate::sprite::detail::{bake_detail_frame, detail_size, optical_flow};
use crate::sprite::six_way::{BakedSixWay, bake_six_way};

/// Frames of gas, simulated or read from files, from which images are baked.
#[derive(Clone, Debug)]
pub struct Recording {
    pub(super) sheet: SheetLayout,
    pub(super) view: View,
    /// Frames of the sheet, and those after it that blend into its first ones.
    pub(super) frames: Vec<RecordedFrame>,
    /// Time between frames, in which the velocity moves texels. 0: they stay.
    pub(super) seconds_per_frame: f32,
    pub(super) has_velocity: bool,
    pub(super) has_heat: bool,
    /// Grid of the gas.
    pub(super) fine: Domain,
    pub(super) window: Window,
}

/// Images baked from a recording.
#[derive(Clone, Debug)]
pub struct BakedRecording {
    /// Flipbook and detail map.
    pub sprite: BakedSprite,
    /// Mean heat of what is visible, 0 to 1, if there is any; in the layout of the flipbook.
    pub heat: Option<GrayImage>,
}

/// Density of one frame at the resolution of a sprite.
struct FrameVolume {
    density: DensityVolume,
    /// Velocity along x and y, sides of the sprite per frame, and heat, of every voxel.
    carried: Vec<Vec3>,
}

impl Recording {
    /// Bakes the flipbook, its detail map, and the heat map of a fire.
    pub fn bake(&self) -> BakedRecording {
        let sheet = self.sheet;
        let mut frames: Vec<_> = (0..sheet.frame_count()).map(|frame| self.bake_frame(frame)).collect();
        let sprite = sheet.assemble(&mut frames, |sprite, frame, baked| {
            bake_detail_frame(sprite, frame, &baked.offset, &self.motion(sprite, frame, baked))
        });
        let heat = self.has_heat.then(|| {
            GrayImage::from_fn(sheet.size * sheet.columns, sheet.size * sheet.rows, |x, y| {
                let frame = &frames[(y / sheet.size * sheet.columns + x / sheet.size) as usize];
                let heat = frame.carried.load(UVec2::new(x % sheet.size, y % sheet.size).as_ivec2()).z;
                Luma([(saturate(heat) * 255.0).round() as u8])
            })
        });
        BakedRecording { sprite, heat }
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
        let sheet = self.sheet;
        let frame = |frame: u32| {
            let mut shape = self.bake_frame(frame).image;
            sheet.quantise(&mut shape);
            (self.density(frame, (sheet.size / 2).max(8)), shape)
        };
        bake_six_way(sheet, medium, samples, frame, progress)
    }

    /// Returns the layout of the flipbook.
    pub fn layout(&self) -> SpriteLayout {
        SpriteLayout { columns: self.sheet.columns, rows: self.sheet.rows, y_down: false }
    }

    /// Returns the density of a frame on `size` by `size` by `size` / 2 voxels.
    pub fn density(&self, frame: u32, size: u32) -> DensityVolume {
        self.volume(frame, size).density
    }

    /// Returns the motion of a frame's texels to the next frame: that of the gas, refined by optical flow.
    fn motion(&self, sprite: &Sprite, frame: u32, baked: &BakedFrame) -> Image<Vec2> {
        let of_gas = self.has_velocity.then(|| gas_motion(sprite, frame, baked));
        optical_flow(sprite, frame, of_gas.as_ref())
    }

    fn bake_frame(&self, frame: u32) -> BakedFrame {
        let FrameVolume { density, carried } = self.volume(frame, self.sheet.size);
        let surface = Surface { extinction: self.view.extinction, bump: self.view.bump };
        march_volume(surface, &density, |voxel| carried[voxel])
    }

    /// Samples a frame on `size` by `size` by `size` / 2 voxels.
    fn volume(&self, frame: u32, size: u32) -> FrameVolume {
        let sides = UVec3::new(size, size, (size / 2).max(4));
        // A blended frame is the mix of itself and of the one a loop later.
        let blended = (self.frames.len() as u32).saturating_sub(self.sheet.frame_count());
        let later = self.frames.get((frame + self.sheet.frame_count()) as usize).filter(|_| frame < blended);
        let fraction = if later.is_some() { frame as f32 / blended as f32 } else { 1.0 };
        let samplers: Vec<(FrameSampler, f32)> = [(self.frames.get(frame as usize), fraction), (later, 1.0 - fraction)]
            .into_iter()
            .filter_map(|(frame, fraction)| Some((frame?.sampler()?, fraction)))
            .collect();
        let to_motion = self.seconds_per_frame / (2.0 * self.window.half_side);
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
                let visible = visible_density(&self.view, smoke, heat) * fade * fraction;
                *density += visible;
                *carried += Vec3::new(x * to_motion, -y * to_motion, heat) * visible;
            }
            *carried /= density.max(1.0e-6);
        });
        let (densities, carried) = voxels.texels.into_iter().unzip();
        FrameVolume { density: DensityVolume { size: sides, densities }, carried }
    }
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
