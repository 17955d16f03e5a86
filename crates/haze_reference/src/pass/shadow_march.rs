//! CPU version of `shaders/shadow_march.wgsl`.

use glam::{IVec3, UVec3, Vec3};
use half::f16;

use crate::optical_depths::{OpticalDepths, cell_index, trilinear};
use haze::formula::shadow::{MAX_OPTICAL_DEPTH, SHADOW_STEPS, shadow_ray};
use haze::view_setup::SmokeShadow;

/// Marches from every cell of a density grid to every light with shadow. `density`: optical depths across the cells.
pub fn shadow_march(density: &[f32], shadow: &SmokeShadow) -> OpticalDepths {
    let size = shadow.grid.size;
    let load = |cell: IVec3| cell_index(size, cell).and_then(|index| density.get(index).copied()).unwrap_or(0.0);
    let march = |index: u32| {
        let cell = UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y));
        let origin = cell.as_vec3() + 0.5;
        let depths = shadow.march.lights.map(|light| {
            let ray = shadow_ray(light, origin, shadow.march.size);
            let step = ray.w / SHADOW_STEPS as f32;
            let places = (0..SHADOW_STEPS).map(|i| origin + ray.truncate() * ((i as f32 + 0.5) * step));
            let depth: f32 = places.map(|place| trilinear(place, load)).sum();
            f16::from_f32((depth * step).min(MAX_OPTICAL_DEPTH)).to_f32()
        });
        Vec3::from(depths)
    };
    OpticalDepths { size, cells: (0..size.element_product()).map(march).collect(), visible: None }
}
