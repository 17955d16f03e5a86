//! Shadow of smoke on an image that is lit already: its surfaces from their depth, and the fraction of their light that is
//! left. View space.

use glam::Vec3;

/// The shorter of two steps along the viewer's direction: the one that does not cross an edge.
pub fn smoother_step(a: Vec3, b: Vec3) -> Vec3 {
    if a.z.abs() < b.z.abs() { a } else { b }
}

/// Normal of the scene at a pixel, towards the viewer, from the positions of the pixel and its four neighbours.
pub fn scene_normal(center: Vec3, left: Vec3, right: Vec3, above: Vec3, below: Vec3) -> Vec3 {
    let across = smoother_step(center - left, right - center);
    let up = smoother_step(center - below, above - center);
    let normal = across.cross(up);
    normal / normal.length_squared().max(1.0e-30).sqrt()
}

/// Fraction of the scene's light that is left. `full`: light of a white matte surface without smoke. `shaded`: through it.
pub fn fraction_of_light(full: Vec3, shaded: Vec3) -> Vec3 {
    (shaded + 1.0e-6) / (full + 1.0e-6)
}
