//! Shadow of the smoke of a frame: the grid around all systems, and the lights that cast it.

use glam::{DMat4, DVec3, Mat4, UVec3, Vec3, Vec4};

use super::resolved_settings::ResolvedSettings;
use super::view_geometry::ViewGeometry;
use crate::formula::ambient::SKY_DIRECTIONS;
use crate::formula::color::luminance;
use crate::formula::lighting::distance_attenuation;
use crate::formula::shadow::{LIGHT_BLOCKS, LIGHTS_PER_BLOCK, SHADOWED_LIGHTS};
use crate::formula::shadow_map::MAX_SHADOW_LAYERS;
use crate::formula::uniforms::{SceneShadowUniform, ShadowMapUniform, ShadowMarchUniform, ShadowVisibilityUniform};
use crate::frame::{Bounds, Light, LightKind, ShadowProjection};

/// Smallest extent of a grid, metres.
const MIN_EXTENT: f64 = 1.0e-3;

/// Grid of cubic cells along the axes of the world. It follows the box of the smoke: a grid that keeps its cells until the
/// box has outgrown them changes all of its cells at once, which shows. So would marches that end at the last cell, where a
/// cell is added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmokeGrid {
    /// Corner of the first cell, metres.
    origin: DVec3,
    /// Side of a cell, metres.
    cell: f64,
    /// Extent of the box in cells, along each axis. At least half a cell less than their number, so that a lookup at the end
    /// of the box is between two cells.
    extent: DVec3,
    /// Number of cells along each axis.
    pub size: UVec3,
}

impl SmokeGrid {
    /// Grid around a box, with `resolution` cells along its longest side.
    fn new(bounds: &Bounds, resolution: u32) -> Self {
        let min = bounds.min.as_dvec3();
        let max = bounds.max.as_dvec3();
        let longest = (max - min).max_element().max(MIN_EXTENT);
        let longest_extent = f64::from(resolution.max(1)) - 0.5;
        let cell = longest / longest_extent;
        let extent = ((max - min) / cell).clamp(DVec3::splat(0.5), DVec3::splat(longest_extent));
        Self { origin: min, cell, extent, size: (extent + 0.5).ceil().as_uvec3() }
    }

    /// Returns the matrix from cells to world space.
    fn world_from_grid(&self) -> DMat4 {
        DMat4::from_translation(self.origin) * DMat4::from_scale(DVec3::splat(self.cell))
    }

    /// Returns the matrix from view space to cells.
    fn grid_from_view(&self, view: &ViewGeometry) -> Mat4 {
        let world_from_view = view.view_from_world.as_dmat4().inverse();
        let grid_from_world = DMat4::from_scale(DVec3::splat(1.0 / self.cell)) * DMat4::from_translation(-self.origin);
        (grid_from_world * world_from_view).as_mat4()
    }

    /// Returns the number of cells along a metre.
    pub fn cells_per_metre(&self) -> f32 {
        (1.0 / self.cell) as f32
    }

    fn grid_position(&self, world: Vec3) -> Vec3 {
        ((world.as_dvec3() - self.origin) / self.cell).as_vec3()
    }
}

/// Shadow of the smoke of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmokeShadow {
    /// Density grid around all smoke that casts shadow.
    pub grid: SmokeGrid,
    /// From view space to cells.
    pub grid_from_view: Mat4,
    /// Largest resolution of all systems: size of the texture along each axis.
    pub resolution: u32,
    /// Number of blocks of the volume with optical depths towards lights.
    pub light_blocks: u32,
    /// Indices of the lights that cast shadows. The three brightest come first.
    pub lights: [Option<usize>; SHADOWED_LIGHTS],
    /// Uniforms of the marches.
    pub march: ShadowMarchUniform,
    /// System whose ramp tints the shadow on the scene, and the strength of that shadow; `None` if none falls on it.
    pub on_scene: Option<(usize, f32)>,
    /// True if the host's shadow maps shade smoke.
    pub has_visibility: bool,
    /// True if smoke shades ambient light.
    pub has_openness: bool,
}

impl SmokeShadow {
    /// `up`: world space, unit length. `max_volume_depth`: of a 3D texture, texels. `is_mapped`: true for indices of
    /// lights that have shadow maps. `systems`: of each system, the box of the smoke that casts shadow, and the settings.
    /// Returns `None` if no system receives shadow, or there is no smoke.
    pub fn new(
        view: &ViewGeometry,
        up: Vec3,
        max_volume_depth: u32,
        lights: &[Light],
        is_mapped: impl Fn(usize) -> bool,
        systems: impl Iterator<Item = (Bounds, ResolvedSettings)>,
    ) -> Option<Self> {
        let mut around = Bounds::EMPTY;
        let mut resolution = None;
        let mut on_scene = None;
        let mut by_depth = false;
        let mut has_openness = false;
        let mut count = 0;
        for (index, (bounds, settings)) in systems.enumerate() {
            if !bounds.is_empty() {
                around.min = around.min.min(bounds.min);
                around.max = around.max.max(bounds.max);
            }
            if settings.receives_shadow() {
                resolution = resolution.max(Some(settings.shadow.resolution));
                count = count.max(settings.shadow.lights);
                by_depth |= settings.receives_shadow_by_depth();
                has_openness |= settings.shades_ambient();
                let strength = settings.shadow.scene;
                on_scene = on_scene.or((strength > 0.0).then_some((index, strength)));
            }
        }
        let resolution = resolution.filter(|_| !around.is_empty())?;
        let chosen = brightest_lights(lights, &around, count as usize);
        // The slots are the outer loop: inside a loop over shadow maps, LLVM copies that loop for every set of slots in use.
        let has_visibility = by_depth && chosen.into_iter().flatten().any(is_mapped);
        let light_blocks = count.div_ceil(LIGHTS_PER_BLOCK as u32);
        // WebGL 2 guarantees 256 texels along each axis.
        let resolution = resolution.min(max_volume_depth / block_count(light_blocks, has_visibility, has_openness));
        let grid = SmokeGrid::new(&around, resolution);
        let placed = chosen.map(|index| match index.and_then(|index| lights.get(index)) {
            // A light in the middle of nothing: no smoke is in front of it.
            None => Vec4::ZERO,
            Some(light) if light.kind == LightKind::Directional => {
                (-light.direction.normalize_or(Vec3::NEG_Y)).extend(1.0)
            }
            Some(light) => grid.grid_position(light.position).extend(0.0),
        });
        let mut radii = [Vec4::ZERO; LIGHT_BLOCKS];
        for (slot, light) in chosen.iter().enumerate().filter_map(|(slot, index)| Some((slot, lights.get((*index)?)?)))
        {
            if light.kind != LightKind::Directional {
                radii[slot / LIGHTS_PER_BLOCK][slot % LIGHTS_PER_BLOCK] = light.radius * grid.cells_per_metre();
            }
        }
        let mut shadow = Self {
            grid,
            grid_from_view: grid.grid_from_view(view),
            resolution,
            light_blocks,
            lights: chosen,
            march: ShadowMarchUniform {
                lights: placed,
                radii,
                sky: sky_directions(up).map(|direction| direction.extend(1.0)),
                size: grid.size.as_vec3(),
                resolution,
                extent: grid.extent.as_vec3(),
                openness_block: 0,
                light_blocks: 0,
                padding: [0; 3],
            },
            on_scene,
            has_visibility,
            has_openness,
        };
        shadow.march.openness_block = shadow.openness_block();
        shadow.march.light_blocks = shadow.used_light_blocks();
        Some(shadow)
    }

    /// Number of blocks of the volume.
    pub fn blocks(&self) -> u32 {
        block_count(self.light_blocks, self.has_visibility, self.has_openness)
    }

    /// Number of blocks of lights whose visibility past the scene is looked up.
    pub fn map_blocks(&self) -> u32 {
        if self.has_visibility { self.light_blocks } else { 0 }
    }

    /// Number of blocks with lights that are there: a march towards no light is left out.
    pub fn used_light_blocks(&self) -> u32 {
        self.lights.iter().flatten().count().div_ceil(LIGHTS_PER_BLOCK) as u32
    }

    /// First of the blocks that hold the lights' visibility past the scene; 0 for none.
    pub fn visibility_block(&self) -> u32 {
        if self.has_visibility { self.light_blocks } else { 0 }
    }

    /// Block that holds openness to sky and ground; 0 for none.
    pub fn openness_block(&self) -> u32 {
        if self.has_openness { self.blocks() - 1 } else { 0 }
    }

    /// Returns the matrix from cells to world space.
    pub fn world_from_grid(&self) -> Mat4 {
        self.grid.world_from_grid().as_mat4()
    }

    /// Returns the lights of a block.
    pub fn lights_of_block(&self, block: u32) -> [Option<usize>; LIGHTS_PER_BLOCK] {
        let first = block as usize * LIGHTS_PER_BLOCK;
        std::array::from_fn(|slot| self.lights.get(first + slot).copied().flatten())
    }

    /// Returns the lookups of the shadow maps of a block of lights. `projection` returns that of a light's map, by its index.
    pub fn visibility<'a>(
        &self,
        block: u32,
        projection: impl Fn(usize) -> Option<ShadowProjection<'a>>,
    ) -> ShadowVisibilityUniform {
        let world_from_grid = self.grid.world_from_grid();
        let maps = self.lights_of_block(block).map(|light| {
            let Some(ShadowProjection { clip_from_world, reversed, bias, .. }) = light.and_then(&projection) else {
                return ShadowMapUniform::default();
            };
            let mut clip_from_grid = [Mat4::ZERO; MAX_SHADOW_LAYERS];
            for (of_grid, of_world) in clip_from_grid.iter_mut().zip(clip_from_world) {
                *of_grid = (of_world.as_dmat4() * world_from_grid).as_mat4();
            }
            let layers = clip_from_world.len().min(MAX_SHADOW_LAYERS) as u32;
            ShadowMapUniform { clip_from_grid, layers, reversed: u32::from(reversed), bias, padding: 0.0 }
        });
        let first_cell = (self.visibility_block() + block) * self.resolution;
        ShadowVisibilityUniform { maps, size: self.march.size, first_cell }
    }

    /// Returns the shadow on the scene as shaders read it.
    pub fn scene_uniform(&self) -> SceneShadowUniform {
        let mut indices = [u32::MAX; 16];
        for (slot, light) in indices.iter_mut().zip(self.lights) {
            *slot = light.map_or(u32::MAX, |index| index as u32);
        }
        SceneShadowUniform {
            origin: self.grid.origin.as_vec3(),
            cells_per_metre: self.grid.cells_per_metre(),
            extent: self.march.extent,
            strength: self.on_scene.map_or(0.0, |(_, strength)| strength),
            lights: self.march.lights,
            indices,
        }
    }

    /// Returns the channel of a light's optical depths among those of the first `blocks`, from 1 on; 0 for a light without
    /// shadow.
    pub fn slot(&self, light: usize, blocks: u32) -> f32 {
        let mut read = self.lights.iter().take(blocks as usize * LIGHTS_PER_BLOCK);
        read.position(|&chosen| chosen == Some(light)).map_or(0.0, |slot| slot as f32 + 1.0)
    }
}

/// Number of blocks of a volume with so many blocks of optical depths.
fn block_count(light_blocks: u32, has_visibility: bool, has_openness: bool) -> u32 {
    light_blocks * (1 + u32::from(has_visibility)) + u32::from(has_openness)
}

/// Returns directions halfway between the pole of the upper hemisphere and its rim, where half of the light from an even sky
/// comes from either side.
fn sky_directions(up: Vec3) -> [Vec3; SKY_DIRECTIONS] {
    let (x, z) = up.any_orthonormal_pair();
    [x, z, -x, -z].map(|side| (up + side).normalize())
}

/// Returns the indices of at most `count` lights that smoke shades and that are brightest at the box: those of the first block,
/// and then the others, each in ascending order.
fn brightest_lights(lights: &[Light], bounds: &Bounds, count: usize) -> [Option<usize>; SHADOWED_LIGHTS] {
    let brightness = |light: &Light| {
        let emitted = luminance(light.color) * light.intensity;
        if light.kind == LightKind::Directional {
            return emitted;
        }
        let distance = light.position.clamp(bounds.min, bounds.max).distance_squared(light.position);
        emitted * distance_attenuation(distance, 1.0 / light.range, light.radius)
    };
    let mut bright: Vec<_> = lights
        .iter()
        .enumerate()
        .filter(|(_, light)| light.smoke_shadow)
        .map(|(index, light)| (index, brightness(light)))
        .filter(|(_, brightness)| *brightness > 0.0)
        .collect();
    bright.sort_by(|a, b| b.1.total_cmp(&a.1));
    bright.truncate(count);
    let in_first_block = bright.len().min(LIGHTS_PER_BLOCK);
    let (first, further) = bright.split_at_mut(in_first_block);
    [first, further].into_iter().for_each(|lights| lights.sort_by_key(|(index, _)| *index));
    std::array::from_fn(|slot| bright.get(slot).map(|(index, _)| *index))
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use glam::camera::rh;

    use super::*;
    use crate::assets::ramp_steps::RampSteps;
    use crate::frame::View;
    use crate::settings::Settings;
    use crate::view_setup::Support;

    #[test]
    fn volumes_fit_the_deepest_texture_of_the_device() {
        let clip_from_view = rh::proj::directx::perspective(0.8, 1.0, 0.1, 80.0);
        let view = ViewGeometry::new(&View::new(Mat4::IDENTITY, clip_from_view, UVec2::ONE)).unwrap();
        let mut settings = Settings::default();
        settings.shadow.strength = 1.0;
        settings.shadow.by_depth = true;
        settings.shadow.resolution = 96;
        settings.ambient.intensity = 1.0;
        let lights = [Light::default(); SHADOWED_LIGHTS];
        let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE };
        for (lights_with_shadow, max_volume_depth, resolution) in
            [(3, 2048, 96), (15, 2048, 96), (3, 256, 85), (15, 256, 23)]
        {
            settings.shadow.lights = lights_with_shadow;
            let resolved = ResolvedSettings::new(&settings, 1.0, UVec2::ONE, 1.0, &RampSteps::default(), Support::ALL);
            let systems = [(bounds, resolved)].into_iter();
            let shadow =
                SmokeShadow::new(&view, Vec3::Y, max_volume_depth, &lights, |light| light == 0, systems).unwrap();
            assert_eq!(shadow.resolution, resolution, "{lights_with_shadow} lights, {max_volume_depth} texels");
            assert!(shadow.resolution * shadow.blocks() <= max_volume_depth);
            assert!(shadow.grid.size.max_element() <= resolution);
        }
    }
}
