//! Outlines of objects, on the CPU. At an outline, smoke is drawn over the surfaces behind it alone, and the object's samples
//! are added after it with the smoke in front of them. `scene_samples.wgsl` and `scene_outline.wgsl` implement the same functions
//! on the GPU.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::depth::view_depth_from_ndc_depth;
use haze_core::formula::saturate;

/// Samples of a pixel, pixels from its upper left corner.
pub(crate) const SAMPLES: [Vec2; 4] =
    [Vec2::new(0.25, 0.25), Vec2::new(0.75, 0.25), Vec2::new(0.25, 0.75), Vec2::new(0.75, 0.75)];

/// Depths whose ratio is below this are one surface. `OUTLINE_RATIO` in scene_samples.wgsl.
const OUTLINE_RATIO: f32 = 1.05;

/// The four samples of a pixel in two groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SampleGroups {
    /// Samples of the object in front; none if all are one surface.
    pub is_front: [bool; 4],
    /// View depth of the object in front.
    pub front_depth: f32,
    /// Depth buffer value of the other samples: the mean, which is that of the pixel's center on a plane.
    pub back: f32,
}

impl SampleGroups {
    /// Groups samples by their depth buffer values. `coefficients` as for [`view_depth_from_ndc_depth`].
    pub fn new(ndc: [f32; 4], coefficients: Vec4) -> Self {
        let depths = ndc.map(|depth| view_depth_from_ndc_depth(depth, coefficients));
        let nearest = depths.into_iter().fold(f32::INFINITY, f32::min);
        let farthest = depths.into_iter().fold(0.0, f32::max);
        let limit = nearest * OUTLINE_RATIO;
        let limit = if farthest >= limit { limit } else { nearest };
        let is_front = depths.map(|depth| depth < limit);
        let mean = |group: bool| {
            let members = ndc.into_iter().zip(is_front).filter(|(_, is_front)| *is_front == group);
            let (sum, count) = members.fold((0.0, 0.0_f32), |(sum, count), (depth, _)| (sum + depth, count + 1.0));
            sum / count.max(1.0)
        };
        Self { is_front, front_depth: view_depth_from_ndc_depth(mean(true), coefficients), back: mean(false) }
    }

    /// Number of samples of the object in front, as a fraction of the four.
    pub fn front_fraction(&self) -> f32 {
        0.25 * self.is_front.iter().filter(|is_front| **is_front).count() as f32
    }

    /// The other samples.
    pub fn is_back(&self) -> [bool; 4] {
        self.is_front.map(|is_front| !is_front)
    }
}

/// Image of a scene and the smoke in front of it, with what outlines are completed from.
pub(crate) struct Outlines<'a> {
    pub groups: &'a Image<SampleGroups>,
    pub coefficients: Vec4,
    /// Surfaces behind outlines.
    pub behind: &'a Image<Vec4>,
    /// The same with smoke, whose opacity is in alpha.
    pub smoked: &'a Image<Vec4>,
    /// Objects in front, with their fraction of the pixel in alpha.
    pub front: &'a Image<Vec4>,
    /// Range of view depths of smoke, metres.
    pub smoke_depths: [f32; 2],
}

impl Outlines<'_> {
    /// Returns the completed image.
    pub fn completed(&self) -> Image<Vec4> {
        let mut completed = Image::new(self.smoked.size, Vec4::W);
        completed.for_each(|at, texel| *texel = self.pixel(at).extend(1.0));
        completed
    }

    fn pixel(&self, at: UVec2) -> Vec3 {
        let image = self.smoked.load(at.as_ivec2()).xyz();
        let object = self.front.load(at.as_ivec2());
        if object.w == 0.0 {
            return image;
        }
        let before = self.smoke_before(at.as_ivec2());
        let seen = (object.xyz() * (1.0 - before.w) + before.xyz()).max(Vec3::ZERO);
        let weight = object.w * color_weight(seen);
        let rest = (1.0 - object.w) * color_weight(image);
        (seen * weight + image * rest) / (weight + rest)
    }

    /// Smoke in front of a pixel's surface: premultiplied light, opacity.
    fn smoke_of(&self, at: IVec2) -> Vec4 {
        let image = self.smoked.load(at);
        (image.xyz() - self.behind.load(at).xyz() * (1.0 - image.w)).extend(image.w)
    }

    /// Smoke in front of an object that covers a part of a pixel.
    fn smoke_before(&self, pixel: IVec2) -> Vec4 {
        let depth = self.groups.load(pixel).front_depth;
        let last = self.smoked.size.as_ivec2() - 1;
        let mut sum = Vec4::ZERO;
        let mut count = 0.0;
        for i in 0..9 {
            let at = (pixel + IVec2::new(i % 3, i / 3) - 1).clamp(IVec2::ZERO, last);
            let view_depth = view_depth_from_ndc_depth(self.groups.load(at).back, self.coefficients);
            if (view_depth - depth).abs() < depth * (OUTLINE_RATIO - 1.0) {
                sum += self.smoke_of(at);
                count += 1.0;
            }
        }
        if count > 0.0 {
            return sum / count;
        }
        let [nearest, farthest] = self.smoke_depths;
        let passed = saturate((depth - nearest) / (farthest - nearest).max(1.0e-3));
        let whole = self.smoke_of(pixel);
        let opacity = 1.0 - (1.0 - whole.w).max(1.0e-6).powf(passed);
        whole * (opacity / whole.w.max(1.0e-6))
    }
}

/// Weight of a color in a pixel: a single bright sample does not dominate it.
fn color_weight(color: Vec3) -> f32 {
    1.0 / (1.0 + color.max_element().max(0.0))
}
