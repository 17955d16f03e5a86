//! CPU version of `shaders/shadow_visibility.wgsl`.

use glam::{IVec2, Mat4, UVec3, Vec3, Vec4, Vec4Swizzles};
use half::f16;
use haze_core::assets::image::Image;
use haze_core::formula::shadow_map::{shadow_map_position, shadow_map_visibility};
use haze_core::formula::uniforms::ShadowMapUniform;
use haze_core::view_setup::SmokeShadow;

use crate::input::ShadowMap;

/// Fraction of each cell of the density grid that the lights of a block reach past the scene.
pub fn shadow_visibility(maps: &[ShadowMap<'_>], shadow: &SmokeShadow, block: u32) -> Vec<Vec3> {
    let of_light = |light: usize| maps.iter().find(|map| map.projection.light == light);
    let uniform = shadow.visibility(block, |light| of_light(light).map(|map| map.projection));
    let layers = shadow.lights_of_block(block).map(|light| light.and_then(of_light).map_or(&[][..], |map| map.layers));
    let size = shadow.grid.size;
    let look_up = |index: u32| {
        let cell = UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y));
        let visible: Vec3 = (0..8)
            .map(|corner| {
                let offset = UVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2).as_vec3() * 0.5 + 0.25;
                let position = cell.as_vec3() + offset;
                Vec3::from([0, 1, 2].map(|slot| map_visibility(&uniform.maps[slot], layers[slot], position)))
            })
            .sum();
        Vec3::from((visible / 8.0).to_array().map(|visible| f16::from_f32(visible).to_f32()))
    };
    (0..size.element_product()).map(look_up).collect()
}

/// Fraction of a light that reaches a point past the scene, between the four nearest texels. `position`: in cells.
pub fn map_visibility(map: &ShadowMapUniform, layers: &[Image<f32>], position: Vec3) -> f32 {
    let inside = |(clip_from_grid, layer): (&Mat4, _)| {
        let at = shadow_map_position(*clip_from_grid * position.extend(1.0));
        (at.w > 0.5).then_some((at, layer))
    };
    let found: Option<(Vec4, &Image<f32>)> = map.clip_from_grid.iter().zip(layers).find_map(inside);
    found.map_or(1.0, |(at, layer)| {
        let corner = at.xy() * layer.size.as_vec2() - 0.5;
        let base = corner.floor().as_ivec2();
        let fraction = corner - corner.floor();
        let lit = |x, y| {
            let texel = (base + IVec2::new(x, y)).clamp(IVec2::ZERO, layer.size.as_ivec2() - 1);
            shadow_map_visibility(at.z, layer.load(texel), map.bias, map.reversed == 1)
        };
        let row = |y| lerp(lit(0, y), lit(1, y), fraction.x);
        lerp(row(0), row(1), fraction.y)
    })
}

fn lerp(a: f32, b: f32, fraction: f32) -> f32 {
    a + (b - a) * fraction
}
