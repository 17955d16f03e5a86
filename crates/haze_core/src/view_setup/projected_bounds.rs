//! Projection of a system's bounding box: the pixels and depths that it covers. The transfer pass draws the box, and
//! its screen rectangle determines the size of the accumulation target.

use glam::{IVec2, UVec2, Vec2, Vec3};

use super::view_geometry::ViewGeometry;
use crate::frame::Bounds;

/// Screen rectangle and depth range of a bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ProjectedBounds {
    /// Smallest view depth of the box, metres; negative if it reaches behind the eye.
    pub near: f32,
    /// Largest view depth of the box, metres.
    pub far: f32,
    /// Covered pixels: `min` inclusive, `max` exclusive, inside the view and not empty.
    pub min: UVec2,
    pub max: UVec2,
}

/// Computes the pixels and depths that `bounds` covers; `None` if it is out of sight.
pub(super) fn project_bounds(bounds: &Bounds, view: &ViewGeometry) -> Option<ProjectedBounds> {
    if bounds.is_empty() {
        return None;
    }
    let corners: [Vec3; 8] = std::array::from_fn(|i| view.view_position(bounds.corner(i as u32)));
    let depths = corners.map(|corner| -corner.z);
    let near = depths.iter().copied().fold(f32::INFINITY, f32::min);
    let far = depths.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    if far <= view.depth.near || near >= view.depth.far {
        return None;
    }

    let mut ndc_min = Vec2::INFINITY;
    let mut ndc_max = Vec2::NEG_INFINITY;
    let mut include = |position: Vec3| {
        let clip = view.clip_from_view * position.extend(1.0);
        let ndc = Vec2::new(clip.x, clip.y) / clip.w;
        ndc_min = ndc_min.min(ndc);
        ndc_max = ndc_max.max(ndc);
    };
    let clip_depth = view.depth.near;
    for (index, &corner) in corners.iter().enumerate() {
        if depths[index] >= clip_depth {
            include(corner);
        }
        // Clips each of the twelve edges at the near plane.
        for bit in [1, 2, 4] {
            let other = index | bit;
            if other != index && (depths[index] < clip_depth) != (depths[other] < clip_depth) {
                let t = (clip_depth - depths[index]) / (depths[other] - depths[index]);
                include(corner.lerp(corners[other], t));
            }
        }
    }

    let size = view.size.as_vec2();
    // NDC y points up, pixel y down.
    let min = Vec2::new(ndc_min.x * 0.5 + 0.5, 0.5 - ndc_max.y * 0.5) * size;
    let max = Vec2::new(ndc_max.x * 0.5 + 0.5, 0.5 - ndc_min.y * 0.5) * size;
    let min = min.floor().clamp(Vec2::ZERO, size).as_uvec2();
    let max = max.ceil().clamp(Vec2::ZERO, size).as_uvec2();
    (min.cmplt(max).all()).then_some(ProjectedBounds { near, far, min, max })
}

/// A rectangle of texels on the grid of reduced resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TargetRect {
    /// First texel, on the grid whose texel (i, j) covers the pixels i·scale .. (i+1)·scale.
    pub origin: IVec2,
    pub size: UVec2,
    /// Pixels of the image per texel, along each side.
    pub scale: u32,
}

/// Returns the texels that an upsampler can read for the pixels of a rectangle.
pub(super) fn target_rect(first: UVec2, pixels: UVec2, scale: u32, image: UVec2) -> TargetRect {
    let grid = UVec2::new(image.x.div_ceil(scale), image.y.div_ceil(scale));
    // Two texels more on every side: the widest footprint of an upsampler at a border pixel.
    let border = UVec2::splat(2);
    let last = first + pixels;
    let min = (first / scale).saturating_sub(border);
    let max = UVec2::new(last.x.div_ceil(scale), last.y.div_ceil(scale)) + border;
    let max = max.min(grid);
    TargetRect { origin: min.as_ivec2(), size: max - min, scale }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::View;
    use glam::Mat4;
    use glam::camera::rh;

    fn view(size: UVec2) -> ViewGeometry {
        let clip_from_view = rh::proj::directx::perspective(1.0, size.x as f32 / size.y as f32, 0.1, 100.0);
        ViewGeometry::new(&View::new(Mat4::IDENTITY, clip_from_view, size)).unwrap()
    }

    fn cube(center: Vec3, half: f32) -> Bounds {
        Bounds { min: center - half, max: center + half }
    }

    #[test]
    fn box_in_front_of_the_camera_covers_the_image_center() {
        let found = project_bounds(&cube(Vec3::new(0.0, 0.0, -10.0), 1.0), &view(UVec2::new(640, 360))).unwrap();
        assert!((found.near - 9.0).abs() < 1e-5 && (found.far - 11.0).abs() < 1e-5);
        assert!(found.min.x > 250 && found.max.x < 390 && found.min.y > 130 && found.max.y < 230, "{found:?}");
    }

    #[test]
    fn box_around_the_eye_covers_the_image_and_a_box_out_of_sight_nothing() {
        let view = view(UVec2::new(641, 359));
        let found = project_bounds(&cube(Vec3::ZERO, 2.0), &view).unwrap();
        assert_eq!((found.min, found.max), (UVec2::ZERO, UVec2::new(641, 359)));
        assert!(found.near < 0.0);
        assert_eq!(project_bounds(&cube(Vec3::new(0.0, 0.0, 5.0), 1.0), &view), None);
        assert_eq!(project_bounds(&cube(Vec3::new(500.0, 0.0, -9.0), 1.0), &view), None);
        assert_eq!(project_bounds(&Bounds::EMPTY, &view), None);
    }

    #[test]
    fn target_rectangle_contains_every_bilinear_footprint() {
        let image = UVec2::new(641, 359);
        for scale in 1..=16 {
            let bounds = ProjectedBounds { near: 1.0, far: 2.0, min: UVec2::new(100, 50), max: UVec2::new(301, 200) };
            let rect = target_rect(bounds.min, bounds.max - bounds.min, scale, image);
            for (pixel, edge) in [(bounds.min, 0.0), (bounds.max - 1, 1.0)] {
                let texel = (pixel.as_vec2() + 0.5) / scale as f32 - 0.5;
                let texel = (texel.floor() + edge).as_ivec2();
                let grid = UVec2::new(image.x.div_ceil(scale), image.y.div_ceil(scale)).as_ivec2();
                let texel = texel.clamp(IVec2::ZERO, grid - 1);
                let inside = texel - rect.origin;
                assert!(inside.cmpge(IVec2::ZERO).all() && inside.cmplt(rect.size.as_ivec2()).all(), "scale {scale}");
            }
        }
    }
}
