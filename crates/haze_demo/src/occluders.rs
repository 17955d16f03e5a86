//! Grid of potential occluders: for each cell, the boxes that can shadow a light and the boxes that can occlude the
//! sky. Built once per scene and lights; shading tests only these boxes.
//!
//! The grid is conservative: a box is left out only if it cannot change the result, so the image is unchanged.

use glam::{IVec2, UVec2, UVec3, Vec3};
use haze_core::assets::image::Image;
use haze_core::formula::uniforms::LightUniform;

use super::boxes::{
    AMBIENT_REACH, MAX_BOXES, SUN_DISTANCE, SUN_SPREAD, SceneBox, Surface, WIDEST_PIXEL, box_distance, box_interval,
};

/// Number of cells along x, y and z. `OCCLUDER_CELLS` in scene.wgsl.
pub(crate) const CELLS: UVec3 = UVec3::new(40, 8, 40);
/// Minimum corner of the grid, metres. Points outside the grid test every box. `OCCLUDER_ORIGIN` in scene.wgsl.
pub(crate) const ORIGIN: Vec3 = Vec3::new(-20.0, -0.5, -24.0);
/// Side of a cell, metres.
const CELL: f32 = 1.0;
/// Cells along each side of a block. Only boxes that can be occluders in a block are tested in its cells: an occluder of a point in
/// a cell is an occluder of a point in the block.
const BLOCK: u32 = 4;
const _: () = assert!(CELLS.x.is_multiple_of(BLOCK) && CELLS.y.is_multiple_of(BLOCK) && CELLS.z.is_multiple_of(BLOCK));
/// Margin of a cell, metres: rounding may move points on its border to the neighbour.
const ROUNDING: f32 = 1.0e-3;

/// Bit mask with one bit per box.
pub(crate) type BoxMask = [u32; 4];
const ALL_BOXES: BoxMask = [u32::MAX; 4];
const _: () = assert!(MAX_BOXES <= 32 * ALL_BOXES.len());

/// Occluder masks of each cell, for the sky and for every light.
#[derive(Clone, Debug)]
pub(crate) struct Occluders {
    /// Layout of the texture in scene.wgsl: column = x + z * [`CELLS`].x, row = list * [`CELLS`].y + y. List 0 is the
    /// sky.
    pub masks: Image<BoxMask>,
}

impl Occluders {
    pub fn new(boxes: &[SceneBox], lights: &[LightUniform]) -> Self {
        let lists = 1 + lights.len() as u32;
        let has_surface = of_each::<bool>(1, 1, |_, center, half| {
            boxes.iter().any(|b| box_distance(b, b.to_local(center - b.center)).abs() <= half.length())
        });
        let is_occluder = |list: u32, b: &SceneBox, center, half| match list.checked_sub(1) {
            Some(light) => lights.get(light as usize).is_none_or(|light| can_shadow(b, light, center, half)),
            None => can_occlude_sky(b, center, half),
        };
        let among = |candidates: BoxMask, list, center, half| {
            let mut mask = [0; 4];
            for index in indices(candidates, boxes.len()) {
                mask[index / 32] |= u32::from(is_occluder(list, &boxes[index], center, half)) << (index % 32);
            }
            mask
        };
        let blocks = of_each(BLOCK, lists, |(_, list), center, half| among(ALL_BOXES, list, center, half));
        let masks = of_each(1, lists, |(cell, list), center, half| {
            // Cells without a surface are never shaded; they keep the full mask.
            if !has_surface.load(texel(cell, 1, 0)) {
                return ALL_BOXES;
            }
            among(blocks.load(texel(cell / BLOCK, BLOCK, list)), list, center, half)
        });
        Self { masks }
    }

    /// Returns the occluders of a point: list 0 for the sky, 1 for the first light, and so on.
    pub fn at(&self, list: u32, point: Vec3) -> BoxMask {
        let cell = ((point - ORIGIN) / CELL).floor();
        if cell.cmplt(Vec3::ZERO).any() || cell.cmpge(CELLS.as_vec3()).any() {
            return ALL_BOXES;
        }
        self.masks.load(texel(cell.as_uvec3(), 1, list))
    }
}

/// Evaluates `value` for every block of so many cells along each side, and every list. It gets the block with the list, the
/// block's center, and half its size. The layout is that of [`Occluders::masks`].
fn of_each<T: Copy + Default + Send>(
    cells: u32,
    lists: u32,
    value: impl Fn((UVec3, u32), Vec3, Vec3) -> T + Sync,
) -> Image<T> {
    let count = CELLS / cells;
    let mut values = Image::new(UVec2::new(count.x * count.z, count.y * lists), T::default());
    values.for_each(|at, texel| {
        let block = UVec3::new(at.x % count.x, at.y % count.y, at.x / count.x);
        let side = cells as f32 * CELL;
        let half = Vec3::splat(0.5 * side + cells as f32 * ROUNDING);
        *texel = value((block, at.y / count.y), ORIGIN + (block.as_vec3() + 0.5) * side, half);
    });
    values
}

/// Place of a block of so many cells along each side in the image of [`of_each`].
fn texel(block: UVec3, cells: u32, list: u32) -> IVec2 {
    let count = CELLS / cells;
    UVec2::new(block.x + block.z * count.x, list * count.y + block.y).as_ivec2()
}

/// Iterates over the indices below `count` that are set in a mask.
pub(crate) fn indices(mask: BoxMask, count: usize) -> impl Iterator<Item = usize> {
    let words = mask.into_iter().enumerate();
    let bits = words.flat_map(|(word, mut bits)| {
        std::iter::from_fn(move || {
            let bit = bits.trailing_zeros();
            bits &= bits.wrapping_sub(1);
            (bit < 32).then_some(word * 32 + bit as usize)
        })
    });
    bits.take_while(move |&index| index < count)
}

/// True if the box can block or, by its penumbra, dim a light at some point of the cell.
fn can_shadow(b: &SceneBox, light: &LightUniform, center: Vec3, half: Vec3) -> bool {
    if b.surface == Surface::Glow as u32 {
        return false;
    }
    let (towards, reach, dims) = if light.directional > 0.5 {
        // The penumbra at the box is as wide as the sun's disc appears at the box's distance.
        let beyond = (b.center - center).length() + b.half_size.length() + half.length();
        (-light.direction * SUN_DISTANCE, 1.0, (beyond * SUN_SPREAD).min(SUN_DISTANCE * SUN_SPREAD))
    } else {
        (light.position - center, 1.0, light.radius)
    };
    // Instead of rays from every point of the cell, tests the ray from its center against the box grown by half a cell.
    let cell =
        Vec3::new(half.x * b.cos.abs() + half.z * b.sin.abs(), half.y, half.z * b.cos.abs() + half.x * b.sin.abs());
    let grown = SceneBox { half_size: b.half_size + cell + dims.max(WIDEST_PIXEL), ..*b };
    let (enter, leave) = box_interval(&grown, b.to_local(center - b.center), b.to_local(towards));
    enter <= leave && leave >= 0.0 && enter <= reach
}

/// True if the box can be close enough to a point of the cell to occlude the sky.
fn can_occlude_sky(b: &SceneBox, center: Vec3, half: Vec3) -> bool {
    box_distance(b, b.to_local(center - b.center)) <= 2.0 * AMBIENT_REACH + half.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use haze_author::backdrop::Backdrop;
    use haze_core::assets::noise::{pcg3d, unit};
    use haze_preset::Preset;

    #[test]
    fn blocks_leave_out_no_occluder_of_their_cells() {
        for name in ["column", "corridor", "colored_lights", "campfire"] {
            let preset = Preset::load(name).unwrap();
            let Scene { boxes, lights, occluders, .. } =
                Scene::new(&preset.environment, &preset.lights, &Backdrop::default());
            let mut shaded = 0;
            for (list, light) in (0..).zip([None].into_iter().chain(lights.iter().map(Some))) {
                for index in 0..CELLS.element_product() {
                    let cell = UVec3::new(index % CELLS.x, index / CELLS.x % CELLS.y, index / (CELLS.x * CELLS.y));
                    let center = ORIGIN + (cell.as_vec3() + 0.5) * CELL;
                    let half = Vec3::splat(0.5 * CELL + ROUNDING);
                    let found = occluders.at(list, center);
                    if found == ALL_BOXES {
                        continue;
                    }
                    shaded += 1;
                    for (index, b) in boxes.iter().enumerate() {
                        let expected = match light {
                            Some(light) => can_shadow(b, light, center, half),
                            None => can_occlude_sky(b, center, half),
                        };
                        assert_eq!(
                            found[index / 32] >> (index % 32) & 1 == 1,
                            expected,
                            "{name} {list} {cell} {index}"
                        );
                    }
                }
            }
            assert!(shaded > 1000, "{name}: {shaded}");
        }
    }

    #[test]
    fn omitting_non_occluders_does_not_change_the_light() {
        for name in ["column", "corridor", "colored_lights"] {
            let preset = Preset::load(name).unwrap();
            let scene = Scene::new(&preset.environment, &preset.lights, &Backdrop::default());
            let everything =
                Scene { occluders: Occluders { masks: Image::new(UVec2::ONE, ALL_BOXES) }, ..scene.clone() };
            let mut points = 0;
            let mut tested = 0;
            for index in 0..4000_u32 {
                let random = |salt| {
                    let hash = pcg3d(UVec3::new(index, salt, 3));
                    Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z)) * 2.0 - 1.0
                };
                // A random point on a face of a box.
                let b = &scene.boxes[index as usize % scene.boxes.len()];
                let position = random(0);
                let side = random(1);
                let normal = side.signum()
                    * Vec3::select(side.abs().cmpeq(Vec3::splat(side.abs().max_element())), Vec3::ONE, Vec3::ZERO);
                let local = Vec3::select(normal.cmpeq(Vec3::ZERO), position, normal) * b.half_size;
                let world = b.center + b.to_world(local);
                let normal = b.to_world(normal);
                let pixel = WIDEST_PIXEL * unit(pcg3d(UVec3::splat(index)).x);
                let lit = |scene: &Scene| scene.irradiance(world, normal, pixel, &|_| Vec3::ONE);
                assert_eq!(lit(&scene), lit(&everything), "{world}");
                points += 1;
                tested += indices(scene.occluders.at(1, world), scene.boxes.len()).count();
            }
            let fraction = tested as f32 / (points * scene.boxes.len()) as f32;
            println!("{name}: {fraction:.2} of the boxes are asked");
            assert!(fraction < 0.4, "{name}: {fraction}");
        }
    }
}
