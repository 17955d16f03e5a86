//! The camera a frame is seen from, and how its depth buffer is read.

use glam::{Mat4, UVec2, Vec2, Vec3};

use crate::error::FieldError;

/// View depth given to pixels where the scene has no surface, metres. Finite, so that differences stay finite.
pub const SKY_VIEW_DEPTH: f32 = 1.0e6;

/// The camera of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World to view space. View space is right-handed: x right, y up, z towards the viewer. Rigid (no scale).
    pub view_from_world: Mat4,
    /// View space to clip space, depth 0..1. Perspective or orthographic, standard or reversed, finite or
    /// infinite far plane, off-centre allowed. A left-handed host multiplies both matrices by
    /// `Mat4::from_scale(vec3(1.0, 1.0, -1.0))` on the side that faces view space.
    pub clip_from_view: Mat4,
    /// Size of the host's colour target and scene depth, pixels. The view fills it.
    pub size: UVec2,
}

/// How a depth buffer encodes distance. Read off the projection, so that it can never disagree with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthConvention {
    /// View depth of the near plane, metres. Positive; for an orthographic view it may be 0.
    pub near: f32,
    /// View depth of the far plane, metres; infinite for an infinite projection.
    pub far: f32,
    /// True if the near plane is stored as 1 and the far plane as 0.
    pub reversed: bool,
    /// True if depth is linear in the distance.
    pub orthographic: bool,
}

impl DepthConvention {
    /// Reads the convention off a projection matrix.
    ///
    /// # Errors
    /// When the matrix is neither a right-handed perspective nor an orthographic projection to depth 0..1.
    pub fn from_clip_from_view(clip_from_view: &Mat4) -> Result<Self, FieldError> {
        let bad = |expected: &str| FieldError::new("view.clip_from_view", clip_from_view, expected);
        if !clip_from_view.is_finite() {
            return Err(bad("finite numbers"));
        }
        let orthographic = clip_from_view.z_axis.w == 0.0;
        let expected_w = if orthographic { (0.0, 1.0) } else { (-1.0, 0.0) };
        if (clip_from_view.z_axis.w, clip_from_view.w_axis.w) != expected_w {
            return Err(bad("a right-handed projection, with w = -z (perspective) or w = 1 (orthographic)"));
        }
        // In f64: the effective far plane hides in the last bits of a matrix entry close to 1.
        let (scale, offset) = (f64::from(clip_from_view.z_axis.z), f64::from(clip_from_view.w_axis.z));
        let view_depth_at = |ndc_depth: f64| {
            if orthographic { (offset - ndc_depth) / scale } else { offset / (ndc_depth + scale) }
        };
        let (at_zero, at_one) = (view_depth_at(0.0), view_depth_at(1.0));
        let reversed = at_zero.abs() > at_one.abs();
        let (near, far) = if reversed { (at_one, at_zero) } else { (at_zero, at_one) };
        let far = if far.is_infinite() { f64::INFINITY } else { far };
        // Linear depth is stored as a share of a limit, which must be in front of the viewer: near ≥ 0.
        if !(near.is_finite() && near < far && near >= 0.0 && (orthographic || near > 0.0)) {
            return Err(bad("a projection whose depth runs from a near to a far plane in front of the viewer"));
        }
        Ok(Self { near: near as f32, far: far as f32, reversed, orthographic })
    }
}

/// A view with everything derived from it once per frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ViewGeometry {
    pub view: View,
    pub depth: DepthConvention,
    /// View-space xy per unit of NDC, at view depth 1 (perspective) or at any depth (orthographic).
    pub ray_scale: Vec2,
    /// View-space xy at the NDC origin, same units; zero for a centred projection.
    pub ray_offset: Vec2,
}

impl ViewGeometry {
    pub fn new(view: &View) -> Result<Self, FieldError> {
        if view.size.min_element() == 0 {
            return Err(FieldError::new(
                "view.size",
                format!("{}x{}", view.size.x, view.size.y),
                "at least 1x1 pixels",
            ));
        }
        if !view.view_from_world.is_finite() || view.view_from_world.determinant() <= 0.0 {
            let expected = "a finite, rigid, right-handed transform";
            return Err(FieldError::new("view.view_from_world", view.view_from_world, expected));
        }
        let depth = DepthConvention::from_clip_from_view(&view.clip_from_view)?;
        let clip = &view.clip_from_view;
        let focal = Vec2::new(clip.x_axis.x, clip.y_axis.y);
        if focal.min_element() <= 0.0 {
            return Err(FieldError::new("view.clip_from_view", clip, "a positive scale in x and y"));
        }
        // ndc = (focal * xy - shift * depth) / depth for perspective, focal * xy + shift for orthographic.
        let shift = if depth.orthographic { clip.w_axis } else { -clip.z_axis };
        Ok(Self { view: *view, depth, ray_scale: focal.recip(), ray_offset: -Vec2::new(shift.x, shift.y) / focal })
    }

    pub fn view_position(&self, world: Vec3) -> Vec3 {
        self.view.view_from_world.transform_point3(world)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;
    use glam::camera::{lh, rh};

    const FOV: f32 = 1.0;

    fn geometry(clip_from_view: Mat4) -> ViewGeometry {
        ViewGeometry::new(&View { view_from_world: Mat4::IDENTITY, clip_from_view, size: UVec2::new(640, 360) })
            .unwrap()
    }

    #[test]
    fn every_convention_is_read_off_its_matrix() {
        let reversed_finite = {
            // Reversed Z: depth' = 1 - depth.
            let flip = Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::new(0.0, 0.0, -1.0, 0.0), Vec4::new(0.0, 0.0, 1.0, 1.0));
            flip * rh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0)
        };
        let cases = [
            (rh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0), 0.2, 80.0, false, false),
            (rh::proj::directx::perspective_infinite(FOV, 1.5, 0.2), 0.2, f32::INFINITY, false, false),
            (rh::proj::directx::perspective_infinite_reverse(FOV, 1.5, 0.2), 0.2, f32::INFINITY, true, false),
            (reversed_finite, 0.2, 80.0, true, false),
            (rh::proj::directx::orthographic(-4.0, 4.0, -3.0, 3.0, 0.5, 60.0), 0.5, 60.0, false, true),
        ];
        for (matrix, near, far, reversed, orthographic) in cases {
            let depth = geometry(matrix).depth;
            assert!((depth.near - near).abs() < 1e-4 * near, "{depth:?}");
            let same = if far.is_infinite() { depth.far.is_infinite() } else { (depth.far - far).abs() < 1e-3 * far };
            assert!(same, "{depth:?}");
            assert_eq!((depth.reversed, depth.orthographic), (reversed, orthographic), "{depth:?}");
        }
    }

    #[test]
    fn a_ray_through_a_pixel_projects_back_to_it() {
        let off_centre = rh::proj::directx::frustum(-0.05, 0.15, -0.1, 0.06, 0.1, 100.0);
        let orthographic = rh::proj::directx::orthographic(-2.0, 6.0, -1.0, 3.0, 0.1, 50.0);
        for matrix in [off_centre, orthographic] {
            let g = geometry(matrix);
            let ndc = Vec2::new(0.3, -0.7);
            let depth = 7.0;
            let xy = (ndc * g.ray_scale + g.ray_offset) * if g.depth.orthographic { 1.0 } else { depth };
            let clip = matrix * xy.extend(-depth).extend(1.0);
            assert!((clip.truncate().truncate() / clip.w - ndc).length() < 1e-5);
        }
    }

    #[test]
    fn unusable_views_are_refused_with_the_field() {
        let view = View {
            view_from_world: Mat4::IDENTITY,
            clip_from_view: rh::proj::directx::perspective(FOV, 1.5, 0.1, 100.0),
            size: UVec2::new(4, 4),
        };
        let field = |view: View| ViewGeometry::new(&view).unwrap_err().field;
        assert_eq!(field(View { size: UVec2::new(0, 4), ..view }), "view.size");
        let left_handed = lh::proj::directx::perspective(FOV, 1.5, 0.1, 100.0);
        assert_eq!(field(View { clip_from_view: left_handed, ..view }), "view.clip_from_view");
        assert_eq!(field(View { clip_from_view: Mat4::ZERO, ..view }), "view.clip_from_view");
        let behind = rh::proj::directx::orthographic(-4.0, 4.0, -3.0, 3.0, -5.0, 60.0);
        assert_eq!(field(View { clip_from_view: behind, ..view }), "view.clip_from_view");
        assert_eq!(field(View { view_from_world: Mat4::NAN, ..view }), "view.view_from_world");
    }
}
