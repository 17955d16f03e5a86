//! A host's camera in one normal form, and values derived from it.

use glam::{Mat3, Mat4, UVec2, Vec2, Vec3, Vec4};

use crate::error::FieldError;
use crate::formula::depth::{DepthConvention, SKY_VIEW_DEPTH, depth_coefficients};
use crate::formula::uniforms::ViewUniform;
use crate::frame::View;

/// Tolerance for the entries of a rigid transform or of a plain projection: allows for f32 rounding in a product of
/// many rotations.
const TOLERANCE: f32 = 1.0e-3;

/// A view in the normal form that all other code uses: in view space, x points right and y up *in the image*, z points
/// towards the viewer, and the near plane is not behind the eye.
#[derive(Clone, Copy, Debug)]
pub struct ViewGeometry {
    /// From world to view space, rigid but for a mirror.
    pub view_from_world: Mat4,
    /// The projection.
    pub clip_from_view: Mat4,
    /// Size of the view, pixels.
    pub size: UVec2,
    /// First pixel of the view in the host's targets.
    pub origin: UVec2,
    /// Convention of the depth buffer.
    pub depth: DepthConvention,
    /// View-space xy per unit of NDC, at view depth 1 (perspective) or at any depth (orthographic).
    pub ray_scale: Vec2,
    /// View-space xy at the NDC origin, same units; zero for a centerd projection.
    pub ray_offset: Vec2,
    /// Added to the host's view depth, metres. Not 0 for an orthographic view whose near plane is behind the viewer.
    pub depth_offset: f32,
    /// True if `view_from_world` mirrors: counter-clockwise in the world is then clockwise in the image.
    pub mirrored: bool,
}

impl ViewGeometry {
    /// Brings a host's view into this form.
    ///
    /// # Errors
    /// Names the matrix or the size that is not valid.
    pub fn new(view: &View) -> Result<Self, FieldError> {
        if view.size.min_element() == 0 {
            let value = format!("{}x{}", view.size.x, view.size.y);
            return Err(FieldError::new("view.size", value, "at least 1x1 pixels"));
        }
        validate_rigid(&view.view_from_world)?;
        let projection = normalized_projection(&view.clip_from_view)?;

        // Moves flipped axes from the projection to the view matrix.
        let flip = Vec3::new(
            projection.x_axis.x.signum(),
            projection.y_axis.y.signum(),
            if looks_along_positive_z(&projection) { -1.0 } else { 1.0 },
        );
        let flip = Mat4::from_scale(flip);
        let mut view_from_world = flip * view.view_from_world;
        let mut clip_from_view = projection * flip;
        let mut depth = DepthConvention::from_clip_from_view(&clip_from_view)?;
        // The position of an orthographic viewer along its view direction is arbitrary: moves it back to the near
        // plane.
        let depth_offset = if depth.orthographic { (-depth.near).max(0.0) } else { 0.0 };
        if depth_offset > 0.0 {
            let back = Mat4::from_translation(Vec3::new(0.0, 0.0, -depth_offset));
            view_from_world = back * view_from_world;
            clip_from_view *= Mat4::from_translation(Vec3::new(0.0, 0.0, depth_offset));
            depth.near = 0.0;
            depth.far += depth_offset;
        }
        let clip = &clip_from_view;
        let focal = Vec2::new(clip.x_axis.x, clip.y_axis.y);
        // ndc = (focal · xy - shift · depth) / depth for perspective, focal · xy + shift for orthographic.
        let shift = if depth.orthographic { clip.w_axis } else { -clip.z_axis };
        Ok(Self {
            view_from_world,
            clip_from_view,
            size: view.size,
            origin: view.origin,
            depth,
            ray_scale: focal.recip(),
            ray_offset: -Vec2::new(shift.x, shift.y) / focal,
            depth_offset,
            mirrored: view_from_world.determinant() < 0.0,
        })
    }

    /// Transforms a position to view space.
    pub fn view_position(&self, world: Vec3) -> Vec3 {
        self.view_from_world.transform_point3(world)
    }

    /// Returns the view's uniforms. `linear_depth`: true if the scene depth is linear view depth.
    pub fn uniform(&self, linear_depth: bool) -> ViewUniform {
        let linear = Vec4::new(self.depth_offset, 1.0, 1.0, 0.0);
        ViewUniform {
            view_from_world: self.view_from_world,
            clip_from_view: self.clip_from_view,
            depth_coefficients: if linear_depth { linear } else { depth_coefficients(&self.depth) },
            ray_scale: self.ray_scale,
            ray_offset: self.ray_offset,
            size: self.size.as_vec2(),
            origin: self.origin.as_vec2(),
            near: self.depth.near,
            far: self.depth.far.min(SKY_VIEW_DEPTH),
            orthographic: if self.depth.orthographic { 1.0 } else { 0.0 },
            depth_offset: self.depth_offset,
        }
    }
}

/// Refuses a view that scales, shears or projects.
fn validate_rigid(view_from_world: &Mat4) -> Result<(), FieldError> {
    let axes = Mat3::from_mat4(*view_from_world);
    let rotates = (axes.transpose() * axes).abs_diff_eq(Mat3::IDENTITY, TOLERANCE);
    if view_from_world.is_finite() && rotates && view_from_world.row(3) == Vec4::W {
        return Ok(());
    }
    let expected = "a finite matrix that only rotates, translates or mirrors, without scale or shear";
    Err(FieldError::new("view.view_from_world", view_from_world, expected))
}

/// Returns the projection scaled to w = ±z or w = 1. Refuses projections that tilt, shear or roll.
fn normalized_projection(clip_from_view: &Mat4) -> Result<Mat4, FieldError> {
    let refuse = |expected: &str| Err(FieldError::new("view.clip_from_view", clip_from_view, expected));
    if !clip_from_view.is_finite() {
        return refuse("finite numbers");
    }
    let m = clip_from_view;
    let orthographic = m.z_axis.w == 0.0;
    let w = if orthographic { m.w_axis.w } else { m.z_axis.w.abs() };
    let focal = Vec2::new(m.x_axis.x, m.y_axis.y).abs();
    if w <= 0.0 || focal.min_element() <= 0.0 {
        return refuse("a perspective (w = -z or w = z) or orthographic (w = 1) projection");
    }
    if !orthographic && m.w_axis.w != 0.0 {
        return refuse("w = -z or w = z, without a constant");
    }
    // These entries must be 0, relative to the focal scale.
    let off = |entries: &[f32]| entries.iter().any(|entry| entry.abs() > TOLERANCE * focal.max_element());
    if off(&[m.x_axis.y, m.y_axis.x]) {
        return refuse("a projection that does not roll: rotate view_from_world instead");
    }
    if off(&[m.x_axis.z, m.y_axis.z, m.x_axis.w, m.y_axis.w]) {
        return refuse("near and far planes perpendicular to the view direction (no oblique near plane)");
    }
    let shear = if orthographic { m.z_axis } else { m.w_axis };
    if off(&[shear.x, shear.y]) {
        return refuse("a projection that does not shear: translate view_from_world instead");
    }
    Ok(*clip_from_view * (1.0 / w))
}

/// Returns true if the viewer looks along +z of view space. For an orthographic projection, the positions of the near
/// and far planes decide; if it reaches as far behind the viewer as in front, −z is assumed.
fn looks_along_positive_z(projection: &Mat4) -> bool {
    let scale = projection.z_axis.z;
    let offset = projection.w_axis.z;
    if projection.z_axis.w != 0.0 { projection.z_axis.w > 0.0 } else { (0.5 - offset) / scale > 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::camera::{lh, rh};
    use glam::vec3;

    const FOV: f32 = 1.0;

    fn geometry(clip_from_view: Mat4) -> ViewGeometry {
        ViewGeometry::new(&View::new(Mat4::IDENTITY, clip_from_view, UVec2::new(640, 360))).unwrap()
    }

    /// Reversed Z: depth' = 1 - depth.
    fn reversed(projection: Mat4) -> Mat4 {
        Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::NEG_Z, Vec4::new(0.0, 0.0, 1.0, 1.0)) * projection
    }

    #[test]
    fn depth_convention_is_derived_from_the_projection_matrix() {
        let perspective = rh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0);
        let orthographic = rh::proj::directx::orthographic(-4.0, 4.0, -3.0, 3.0, 0.5, 60.0);
        let infinite = f32::INFINITY;
        let cases = [
            (perspective, 0.2, 80.0, false, false),
            (rh::proj::directx::perspective_infinite(FOV, 1.5, 0.2), 0.2, infinite, false, false),
            (rh::proj::directx::perspective_infinite_reverse(FOV, 1.5, 0.2), 0.2, infinite, true, false),
            (reversed(perspective), 0.2, 80.0, true, false),
            (orthographic, 0.5, 60.0, false, true),
            (reversed(orthographic), 0.5, 60.0, true, true),
            // A far plane so distant that it is infinite in f32.
            (rh::proj::directx::perspective(FOV, 1.5, 0.2, 1.0e9), 0.2, infinite, false, false),
            // The same with view space that looks along +z.
            (lh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0), 0.2, 80.0, false, false),
            (reversed(lh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0)), 0.2, 80.0, true, false),
            (lh::proj::directx::orthographic(-4.0, 4.0, -3.0, 3.0, 0.5, 60.0), 0.5, 60.0, false, true),
            // A uniform scale of clip space changes nothing.
            (perspective * 3.0, 0.2, 80.0, false, false),
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
        let off_center = rh::proj::directx::frustum(-0.05, 0.15, -0.1, 0.06, 0.1, 100.0);
        let orthographic = rh::proj::directx::orthographic(-2.0, 6.0, -1.0, 3.0, 0.1, 50.0);
        let behind = rh::proj::directx::orthographic(-2.0, 6.0, -1.0, 3.0, -20.0, 50.0);
        for matrix in [off_center, orthographic, behind, lh::proj::directx::perspective(FOV, 1.5, 0.1, 9.0)] {
            let g = geometry(matrix);
            let ndc = Vec2::new(0.3, -0.7);
            let depth = 7.0;
            let xy = (ndc * g.ray_scale + g.ray_offset) * if g.depth.orthographic { 1.0 } else { depth };
            let clip = g.clip_from_view * xy.extend(-depth).extend(1.0);
            assert!((clip.truncate().truncate() / clip.w - ndc).length() < 1e-5);
        }
    }

    #[test]
    fn world_points_project_as_in_the_host_for_all_axis_conventions() {
        let rh_view = rh::view::look_at_mat4(vec3(1.0, 2.0, 5.0), Vec3::ZERO, Vec3::Y);
        let lh_view = lh::view::look_at_mat4(vec3(1.0, 2.0, 5.0), Vec3::ZERO, Vec3::Y);
        let rh_projection = rh::proj::directx::perspective(FOV, 1.5, 0.1, 100.0);
        let lh_projection = lh::proj::directx::perspective(FOV, 1.5, 0.1, 100.0);
        let flip = |x, y, z| Mat4::from_scale(vec3(x, y, z));
        let cases = [
            (rh_view, rh_projection, false),
            (lh_view, lh_projection, true),
            (rh_view * flip(1.0, 1.0, -1.0), rh_projection, true),
            (rh_view, flip(-1.0, 1.0, 1.0) * rh_projection, true),
            (rh_view, flip(1.0, -1.0, 1.0) * rh_projection, true),
            (rh_view, flip(-1.0, -1.0, 1.0) * rh_projection, false),
            (flip(1.0, 1.0, -1.0) * rh_view, lh_projection, false),
            (rh_view, rh::proj::directx::orthographic(-4.0, 4.0, -3.0, 3.0, -30.0, 60.0), false),
        ];
        for (index, (view_from_world, clip_from_view, mirrored)) in cases.into_iter().enumerate() {
            let g = ViewGeometry::new(&View::new(view_from_world, clip_from_view, UVec2::new(6, 4))).unwrap();
            assert_eq!(g.mirrored, mirrored, "case {index}");
            for world in [vec3(0.3, -0.2, 0.7), vec3(-1.0, 0.5, -2.0)] {
                let expected = (clip_from_view * view_from_world).project_point3(world);
                let position = g.view_position(world);
                assert!(g.clip_from_view.project_point3(position).distance(expected) < 1e-4, "case {index}");
                // The point is in front of the viewer; x is to the right and y is up in the image.
                assert!(position.z < 0.0, "case {index}");
                let from_axis = position - vec3(g.ray_offset.x, g.ray_offset.y, 0.0);
                assert_eq!(from_axis.x > 0.0, expected.x > 0.0, "case {index}");
                assert_eq!(from_axis.y > 0.0, expected.y > 0.0, "case {index}");
            }
        }
    }

    #[test]
    fn invalid_views_are_refused_and_the_field_is_named() {
        let perspective = rh::proj::directx::perspective(FOV, 1.5, 0.1, 100.0);
        let view = View::new(Mat4::IDENTITY, perspective, UVec2::new(4, 4));
        let field = |view: View| ViewGeometry::new(&view).unwrap_err().field;
        assert_eq!(field(View { size: UVec2::new(0, 4), ..view }), "view.size");
        let refused = |clip_from_view: Mat4| {
            let error = ViewGeometry::new(&View { clip_from_view, ..view }).unwrap_err();
            assert_eq!(error.field, "view.clip_from_view");
            error.expected
        };
        assert!(refused(Mat4::ZERO).contains("perspective"));
        assert!(refused(Mat4::NAN).contains("finite"));
        assert!(refused(Mat4::from_rotation_z(0.1) * perspective).contains("roll"));
        // An oblique near plane: depth grows with x as well. (Lengyel)
        let mut oblique = perspective;
        oblique.x_axis.z = 0.2;
        assert!(refused(oblique).contains("oblique"));
        let mut sheared = perspective;
        sheared.w_axis.x = 0.5;
        assert!(refused(sheared).contains("shear"));
        // A near plane behind the viewer.
        assert!(refused(rh::proj::directx::perspective(FOV, 1.5, -5.0, 5.0)).contains("near to a far"));
        for scaled in [
            Mat4::ZERO,
            Mat4::NAN,
            Mat4::from_scale(vec3(2.0, 2.0, 2.0)),
            Mat4::from_scale(vec3(1.0, 1.2, 1.0)),
            Mat4::from_cols(Vec4::X, Vec4::new(0.2, 1.0, 0.0, 0.0), Vec4::Z, Vec4::W),
            perspective,
        ] {
            assert_eq!(field(View { view_from_world: scaled, ..view }), "view.view_from_world", "{scaled}");
        }
        // The rounding errors of a long chain of rotations are accepted.
        let worn = (0..1000).fold(Mat4::IDENTITY, |m, i| Mat4::from_rotation_y(0.1 + i as f32) * m);
        ViewGeometry::new(&View { view_from_world: worn, ..view }).unwrap();
    }
}
