//! CPU version of `shaders/depth_downsample.wgsl`.

use glam::IVec2;
use haze_core::assets::image::Image;
use haze_core::formula::depth::{SKY_VIEW_DEPTH, depth_downsample_keeps_farthest};
use haze_core::settings::{DepthDownsample, DepthSource};

use crate::visible_system::VisibleSystem;

impl VisibleSystem<'_> {
    /// Returns the scene's view depth at the resolution of the target, metres.
    pub fn depth_downsample(&self) -> Image<f32> {
        let mut reduced = Image::new(self.setup.rect.size, 0.0);
        let mode = self.settings.accumulate.depth_downsample;
        let scale = self.system.scale as i32;
        let limit = |depth: f32| depth.min(self.system.depth_limit);
        reduced.for_each(|at, texel| {
            let at = at.as_ivec2() + self.setup.rect.origin;
            let first = at * scale;
            let last = self.scene_depth.size.as_ivec2() - 1;
            *texel = if self.settings.accumulate.depth_source == DepthSource::Host {
                self.scene_view_depth(first)
            } else if mode == DepthDownsample::Point {
                limit(self.scene_view_depth((first + scale / 2).min(last)))
            } else {
                let mut nearest = SKY_VIEW_DEPTH;
                let mut farthest = 0.0_f32;
                let end = (first + scale - 1).min(last);
                for y in first.y..=end.y {
                    for x in first.x..=end.x {
                        let depth = self.scene_view_depth(IVec2::new(x, y));
                        nearest = nearest.min(depth);
                        farthest = farthest.max(depth);
                    }
                }
                limit(if depth_downsample_keeps_farthest(mode, at) { farthest } else { nearest })
            };
        });
        reduced
    }
}
