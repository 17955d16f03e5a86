//! Fire: light of hot smoke. WGSL: `shaders/lib/fire.wgsl`.

use glam::Vec2;

use super::saturate;

/// Heat at a position of a sprite. `thickness`: alpha of the sprite's image there, 0 to 1. `facing`: cosine between its normal
/// and the direction to the viewer. `core`: fraction by which a thin edge is cooler than the middle. `crust`: fraction by which
/// the side that faces the viewer is cooler than the creases.
pub fn heat_at(heat: f32, thickness: f32, facing: f32, core: f32, crust: f32) -> f32 {
    let front = saturate(facing);
    heat * (1.0 - core * (1.0 - thickness)) * (1.0 - crust * front * front)
}

/// Mean heat of the smoke that burns at a point, and its fraction of all visible smoke there. `moments`: means of heat and of
/// its square over that smoke.
///
/// Heat itself is the weight of the mean. Cold smoke in front of a fire then takes from the fraction, not from the heat: the
/// fire grows dim and keeps its color.
pub fn fire_from_moments(moments: Vec2) -> Vec2 {
    let burns = moments.x > 1.0e-4 && moments.y > 1.0e-8;
    if burns { Vec2::new(moments.y / moments.x, moments.x * moments.x / moments.y).min(Vec2::ONE) } else { Vec2::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cold_smoke_in_front_dims_a_fire_and_keeps_its_heat() {
        let heat = 0.7;
        for transmittance in [1.0, 0.5, 0.1, 0.02] {
            let moments = Vec2::new(heat, heat * heat) * transmittance;
            let fire = fire_from_moments(moments);
            assert!((fire - Vec2::new(heat, transmittance)).abs().max_element() < 1e-5, "{fire}");
        }
        assert_eq!(fire_from_moments(Vec2::ZERO), Vec2::ZERO);
        assert_eq!(fire_from_moments(Vec2::NAN), Vec2::ZERO);
    }
}
