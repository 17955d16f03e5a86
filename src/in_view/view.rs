//! A host's camera, brought into one form, and what follows from it.

use glam::{Mat3, Mat4, UVec2, Vec2, Vec3, Vec4};

use crate::error::FieldError;
use crate::formula::depth::{DepthConvention, SKY_VIEW_DEPTH, depth_coefficients};
use crate::formula::uniforms::ViewUniform;
use crate::frame::View;

/// How far an entry of a matrix may be off what a rigid transform or a plain projection has there: what f32 leaves of a product
/// of many rotations.
const TOLERANCE: f32 = 1.0e-3;

/// A view in the form that everything else works on: view space has x to the right and y up *in the picture* and z towards the
/// viewer, and begins at the near plane or in front of it.
#[derive(Clone, Copy, Debug)]
pub struct ViewGeometry {
    pub view_from_world: Mat4,
    pub clip_from_view: Mat4,
    pub size: UVec2,
    /// First pixel of the view in the host's targets.
    pub origin: UVec2,
    pub depth: DepthConvention,
    /// View-space xy per unit of NDC, at view depth 1 (perspective) or at any depth (orthographic).
    pub ray_scale: Vec2,
    /// View-space xy at the NDC origin, same units; zero for a centred projection.
    pub ray_offset: Vec2,
    /// Added to the host's view depth: not 0 for an orthographic view that begins behind the viewer.
    pub depth_offset: f32,
    /// `view_from_world` mirrors: what is counter-clockwise in the world is clockwise in the picture.
    pub mirrored: bool,
}

impl ViewGeometry {
    pub fn new(view: &View) -> Result<Self, FieldError> {
        if view.size.min_element() == 0 {
            let value = format!("{}x{}", view.size.x, view.size.y);
            return Err(FieldError::new("view.size", value, "at least 1x1 pixels"));
        }
        validate_rigid(&view.view_from_world)?;
        let projection = plain_projection(&view.clip_from_view)?;

        // Axes that the projection turns over are turned in the view instead.
        let flip = Vec3::new(
            projection.x_axis.x.signum(),
            projection.y_axis.y.signum(),
            if looks_along_positive_z(&projection) { -1.0 } else { 1.0 },
        );
        let flip = Mat4::from_scale(flip);
        let mut view_from_world = flip * view.view_from_world;
        let mut clip_from_view = projection * flip;
        let mut depth = DepthConvention::from_clip_from_view(&clip_from_view)?;
        // Where an orthographic viewer stands changes nothing: this one steps back to the near plane.
        let depth_offset = if depth.orthographic { (-depth.near).max(0.0) } else { 0.0 };
        if depth_offset > 0.0 {
            let back = Mat4::from_translation(Vec3::new(0.0, 0.0, -depth_offset));
            view_from_world = back * view_from_world;
            clip_from_view *= Mat4::from_translation(Vec3::new(0.0, 0.0, depth_offset));
            (depth.near, depth.far) = (0.0, depth.far + depth_offset);
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

    pub fn view_position(&self, world: Vec3) -> Vec3 {
        self.view_from_world.transform_point3(world)
    }

    /// `linear_depth`: the scene depth is view depth already.
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
    let expected = "finite numbers that turn, move or mirror, without scale or shear";
    Err(FieldError::new("view.view_from_world", view_from_world, expected))
}

/// The projection with w = ±z or w = 1; refuses those that tilt, shear or roll.
fn plain_projection(clip_from_view: &Mat4) -> Result<Mat4, FieldError> {
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
    // What must be 0, in units of the picture.
    let off = |entries: &[f32]| entries.iter().any(|entry| entry.abs() > TOLERANCE * focal.max_element());
    if off(&[m.x_axis.y, m.y_axis.x]) {
        return refuse("a projection that does not roll: turn view_from_world instead");
    }
    if off(&[m.x_axis.z, m.y_axis.z, m.x_axis.w, m.y_axis.w]) {
        return refuse("near and far planes that face the viewer: an oblique near plane cannot be read back as depth");
    }
    let shear = if orthographic { m.z_axis } else { m.w_axis };
    if off(&[shear.x, shear.y]) {
        return refuse("a projection that does not shear: move view_from_world instead");
    }
    Ok(*clip_from_view * (1.0 / w))
}

/// True if the viewer looks along +z of view space. An orthographic projection says so by where its planes are; one that reaches
/// as far behind the viewer as in front is taken to look along −z.
fn looks_along_positive_z(projection: &Mat4) -> bool {
    let (scale, offset) = (projection.z_axis.z, projection.w_axis.z);
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
    fn every_convention_is_read_off_its_matrix() {
        let (perspective, orthographic) = (
            rh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0),
            rh::proj::directx::orthographic(-4.0, 4.0, -3.0, 3.0, 0.5, 60.0),
        );
        let infinite = f32::INFINITY;
        let cases = [
            (perspective, 0.2, 80.0, false, false),
            (rh::proj::directx::perspective_infinite(FOV, 1.5, 0.2), 0.2, infinite, false, false),
            (rh::proj::directx::perspective_infinite_reverse(FOV, 1.5, 0.2), 0.2, infinite, true, false),
            (reversed(perspective), 0.2, 80.0, true, false),
            (orthographic, 0.5, 60.0, false, true),
            (reversed(orthographic), 0.5, 60.0, true, true),
            // A far plane that f32 rounds beyond infinity.
            (rh::proj::directx::perspective(FOV, 1.5, 0.2, 1.0e9), 0.2, infinite, false, false),
            // The same from +z view space.
            (lh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0), 0.2, 80.0, false, false),
            (reversed(lh::proj::directx::perspective(FOV, 1.5, 0.2, 80.0)), 0.2, 80.0, true, false),
            (lh::proj::directx::orthographic(-4.0, 4.0, -3.0, 3.0, 0.5, 60.0), 0.5, 60.0, false, true),
            // A scale of all of clip space changes nothing.
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
        let off_centre = rh::proj::directx::frustum(-0.05, 0.15, -0.1, 0.06, 0.1, 100.0);
        let orthographic = rh::proj::directx::orthographic(-2.0, 6.0, -1.0, 3.0, 0.1, 50.0);
        let behind = rh::proj::directx::orthographic(-2.0, 6.0, -1.0, 3.0, -20.0, 50.0);
        for matrix in [off_centre, orthographic, behind, lh::proj::directx::perspective(FOV, 1.5, 0.1, 9.0)] {
            let g = geometry(matrix);
            let ndc = Vec2::new(0.3, -0.7);
            let depth = 7.0;
            let xy = (ndc * g.ray_scale + g.ray_offset) * if g.depth.orthographic { 1.0 } else { depth };
            let clip = g.clip_from_view * xy.extend(-depth).extend(1.0);
            assert!((clip.truncate().truncate() / clip.w - ndc).length() < 1e-5);
        }
    }

    #[test]
    fn whatever_the_axes_a_point_of_the_world_is_where_the_host_puts_it() {
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
                // In front of the viewer, to the right and up in the picture.
                assert!(position.z < 0.0, "case {index}");
                let from_axis = position - vec3(g.ray_offset.x, g.ray_offset.y, 0.0);
                assert_eq!(from_axis.x > 0.0, expected.x > 0.0, "case {index}");
                assert_eq!(from_axis.y > 0.0, expected.y > 0.0, "case {index}");
            }
        }
    }

    #[test]
    fn unusable_views_are_refused_with_the_field() {
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
        // What a long chain of rotations leaves of a rigid transform is taken.
        let worn = (0..1000).fold(Mat4::IDENTITY, |m, i| Mat4::from_rotation_y(0.1 + i as f32) * m);
        ViewGeometry::new(&View { view_from_world: worn, ..view }).unwrap();
    }
}
