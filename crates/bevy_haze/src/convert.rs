//! Bevy's matrices and colors as haze's. The two may use different versions of glam.

use bevy::math::{Affine3A, Mat4, Vec3};
use haze::glam;

pub(crate) fn vec3(v: Vec3) -> glam::Vec3 {
    glam::Vec3::from_array(v.to_array())
}

pub(crate) fn mat4(m: Mat4) -> glam::Mat4 {
    glam::Mat4::from_cols_array(&m.to_cols_array())
}

/// Placement without shear and with one scale, and whether it had to be changed. It may mirror. `None` if it is flat or not
/// finite.
pub(crate) fn placement(world_from_smoke: Affine3A) -> Option<(glam::Mat4, bool)> {
    let (scale, rotation, translation) = world_from_smoke.to_scale_rotation_translation();
    // The geometric mean keeps the volume.
    let mean = (scale.x * scale.y * scale.z).abs().cbrt();
    if !world_from_smoke.is_finite() || mean <= 0.0 || !rotation.is_finite() {
        return None;
    }
    let placed = Mat4::from_scale_rotation_translation(scale.signum() * mean, rotation, translation);
    let changed = !placed.abs_diff_eq(Mat4::from(world_from_smoke), 1.0e-3 * mean);
    Some((mat4(placed), changed))
}

/// View that is rigid, and the projection that takes up the view's scale: `P · V⁻¹ = (P · S⁻¹) · (V · S⁻¹)⁻¹`, where S is
/// the uniform scale of a camera whose parent is scaled. A scale that differs between axes stays; haze refuses it.
pub(crate) fn rigid_view(world_from_view: Affine3A, clip_from_view: Mat4) -> (Mat4, Mat4) {
    let scale = world_from_view.matrix3.determinant().abs().cbrt();
    if !(scale.is_finite() && scale > 0.0) {
        return (Mat4::from(world_from_view.inverse()), clip_from_view);
    }
    let mut rigid = world_from_view;
    rigid.matrix3 *= scale.recip();
    (Mat4::from(rigid.inverse()), clip_from_view * Mat4::from_scale(Vec3::splat(scale.recip())))
}

#[cfg(test)]
mod tests {
    use bevy::camera::{CameraProjection, PerspectiveProjection};
    use bevy::math::Quat;

    use super::*;

    #[test]
    fn a_scaled_view_sees_the_same() {
        let turn = Quat::from_euler(bevy::math::EulerRot::YXZ, 0.4, -0.2, 0.1);
        let scaled = Affine3A::from_scale_rotation_translation(Vec3::splat(2.5), turn, Vec3::new(1.0, 2.0, 3.0));
        let projection = PerspectiveProjection::default().get_clip_from_view();
        let (view, clip) = rigid_view(scaled, projection);
        assert!((view.determinant() - 1.0).abs() < 1e-5);
        let point = Vec3::new(-0.5, 1.5, -4.0);
        let expected = (projection * Mat4::from(scaled.inverse())).project_point3(point);
        assert!((clip * view).project_point3(point).abs_diff_eq(expected, 1e-5));
    }

    #[test]
    fn uneven_scales_become_their_mean() {
        let at = |scale| placement(Affine3A::from_scale_rotation_translation(scale, Quat::IDENTITY, Vec3::X));
        let (even, changed) = at(Vec3::splat(2.0)).unwrap();
        assert!(!changed && (even.determinant() - 8.0).abs() < 1e-4);
        let (uneven, changed) = at(Vec3::new(1.0, 2.0, 4.0)).unwrap();
        assert!(changed && (uneven.x_axis.x - 2.0).abs() < 1e-4);
        let (mirrored, changed) = at(Vec3::splat(-2.0)).unwrap();
        assert!(
            !changed
                && mirrored.abs_diff_eq(
                    glam::Mat4::from_cols_array_2d(&[
                        [-2.0, 0.0, 0.0, 0.0],
                        [0.0, -2.0, 0.0, 0.0],
                        [0.0, 0.0, -2.0, 0.0],
                        [1.0, 0.0, 0.0, 1.0],
                    ]),
                    1e-4
                ),
            "{mirrored}"
        );
        assert!(at(Vec3::new(1.0, 0.0, 1.0)).is_none());
    }
}
