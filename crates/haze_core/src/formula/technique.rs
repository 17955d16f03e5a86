//! Formulas of the techniques, by which sprites meet the scene. WGSL: `shaders/lib/technique.wgsl`.

use glam::{Vec2, Vec3};

use super::saturate;

/// 1 in front of the scene or on it, 0 behind it: the result of the hardware's depth test. (NV 3)
pub fn hard_fade(distance: f32) -> f32 {
    if distance >= 0.0 { 1.0 } else { 0.0 }
}

/// View depth of a texel that is displaced towards the viewer by `offset` radii, −1..1. (MS "2D particles with depth")
pub fn depth_sprite_depth(view_depth: f32, offset: f32, radius: f32) -> f32 {
    view_depth - offset * radius
}

/// Part of a ray inside a sphere, clipped at the near plane and at the scene. Distances are along the ray, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayInterval {
    /// Distance at which the ray enters.
    pub enter: f32,
    /// Distance at which the ray leaves. The interval is empty if this is not greater than `enter`.
    pub leave: f32,
    /// Vector from the center of the sphere to the nearest point of the ray's line.
    pub axis: Vec3,
}

/// Intersects a ray of unit length with a sphere. `near` and `scene` are distances along the ray. Half the chord is w =
/// √(r² − q²). (BLOG 2)
pub fn ray_sphere(origin: Vec3, direction: Vec3, center: Vec3, radius: f32, near: f32, scene: f32) -> RayInterval {
    let to_center = center - origin;
    let middle = to_center.dot(direction);
    let axis = direction * middle - to_center;
    let half_chord = (radius * radius - axis.length_squared()).max(0.0).sqrt();
    RayInterval { enter: (middle - half_chord).max(near), leave: (middle + half_chord).min(scene), axis }
}

/// Umenhoffer's spherical billboard: a = 1 − exp(−density · (1 − q/r) · Δs), where q is `axis_distance` and Δs is
/// `stretch`. (BLOG 2)
pub fn spherical_billboard_amount(density: f32, axis_distance: f32, radius: f32, stretch: f32) -> f32 {
    let inwards = saturate(1.0 - axis_distance / radius.max(1.0e-6));
    1.0 - (-density * inwards * stretch.max(0.0)).exp()
}

/// Thickness of the slab between near plane and scene, metres. The slab extends one radius in front of the sprite and
/// one behind it.
pub fn density_thickness(view_depth: f32, radius: f32, near: f32, scene: f32) -> f32 {
    (scene.min(view_depth + radius) - near.max(view_depth - radius)).max(0.0)
}

/// Fraction of that slab that lies beyond the near plane.
pub fn visible_slab_fraction(view_depth: f32, radius: f32, near: f32) -> f32 {
    saturate((view_depth + radius - near) / (2.0 * radius).max(1.0e-6))
}

/// Amount of a slab: a = 1 − exp(−density · thickness). (BLOG 3)
pub fn density_amount(density: f32, thickness: f32) -> f32 {
    1.0 - (-density * thickness).exp()
}

/// Falloff of a volume from its center. `position` is the position in the sphere, −1..1. (MS "March", step 3)
pub fn volumetric_falloff(position: Vec3) -> f32 {
    saturate(1.0 - position.length_squared())
}

/// Density of a volume, 0..1: noise that is eroded from the outside in. (MS "March", steps 1 and 3)
pub fn volumetric_density(noise: f32, falloff: f32) -> f32 {
    saturate(2.0 * noise - 1.0 + falloff) * falloff
}

/// Position where a step of a march ends, as a fraction of the way through a sphere. `done` is the fraction of the steps. Steps
/// are shortest in the middle, where a volume is densest: 7 of them reach the error of 8 equal ones.
pub fn march_boundary(done: f32) -> f32 {
    let from_middle = 2.0 * done - 1.0;
    0.5 + from_middle * (2.0 + from_middle.powi(4)) / 6.0
}

/// View-space normal at a point of a volume: out of the sphere and down the noise's density, and never away from the
/// viewer. (MS "March", step 2)
pub fn volumetric_normal(position: Vec3, gradient: Vec3) -> Vec3 {
    let normal = position + 2.0 * gradient;
    normal.with_z(normal.z.max(0.1)).normalize()
}

/// Lower and upper bound of a sphere's projection on one axis, as position / depth, clipped at the near plane. `center`
/// is (position on the axis, depth). (Mara and McGuire, JCGT 2013)
pub fn sphere_axis_bounds(center: Vec2, radius: f32, near: f32) -> Vec2 {
    let clipped = center.y - radius < near;
    let cut = (radius * radius - (near - center.y) * (near - center.y)).max(0.0).sqrt();
    let mut bounds = Vec2::new(center.x - cut, center.x + cut) / near;
    let tangent_squared = center.length_squared() - radius * radius;
    if tangent_squared > 0.0 {
        let distance = center.length();
        let cosine = tangent_squared.sqrt() / distance;
        let sine = radius / distance;
        let lower = Vec2::new(cosine * center.x - sine * center.y, cosine * center.y + sine * center.x);
        let upper = Vec2::new(cosine * center.x + sine * center.y, cosine * center.y - sine * center.x);
        if !clipped || lower.y * cosine > near {
            bounds.x = lower.x / lower.y;
        }
        if !clipped || upper.y * cosine > near {
            bounds.y = upper.x / upper.y;
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sphere_bounds_contain_every_visible_point_and_are_tight() {
        let near = 0.1;
        // Beside the near plane, around it, and half behind it.
        let spheres = [
            (Vec2::new(1.0, 5.0), 0.7),
            (Vec2::new(-3.0, 1.0), 0.9),
            (Vec2::new(0.2, 0.3), 0.5),
            (Vec2::new(0.4, -0.2), 0.35),
            (Vec2::new(2.0, 0.05), 1.0),
        ];
        for (center, radius) in spheres {
            let bounds = sphere_axis_bounds(center, radius, near);
            let points = (0..100_000).map(|i| center + Vec2::from_angle(i as f32 * 6.283_2e-5) * radius);
            let cut = (radius * radius - (near - center.y) * (near - center.y)).max(0.0).sqrt();
            let rim = [center.x - cut, center.x + cut].map(|x| Vec2::new(x, near));
            let rim = rim.into_iter().filter(|_| (near - center.y).abs() < radius);
            let seen = points.filter(|point| point.y >= near).chain(rim).map(|point| point.x / point.y);
            let (low, high) = seen.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
            let close = |a: f32, b: f32| (a - b).abs() < 1e-3 * (1.0 + b.abs());
            assert!(close(bounds.x, low) && close(bounds.y, high), "{center} {radius}: {bounds}, not {low}..{high}");
        }
    }
}
