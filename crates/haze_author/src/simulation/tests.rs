use std::path::Path;

use glam::{IVec2, UVec2, UVec3, Vec2, Vec3, Vec4};
use haze_core::assets::json;
use haze_core::assets::noise::{pcg3d, unit};
use haze_core::assets::sprite::Sprite;
use haze_core::formula::sprite::MOTION_RANGE;
use image::RgbaImage;

use super::advection::Flow;
use super::domain::Domain;
use super::fluid::Fluid;
use super::grid::{CellBox, Grid};
use super::pressure::{PressureSolver, RELATIVE_RESIDUAL};
use super::*;
use crate::deterministic_math::tests::hash;

/// A hot ball of smoke on a small grid, that nothing thins.
fn small() -> SimRecipe {
    let text = r#"{
        "version": 1,
        "grid": { "width": 16, "height": 24, "depth": 16 },
        "sources": [
            { "position": [0, 0.4, 0], "radius": [0.2, 0.2, 0.2], "end": 0.1, "smoke": 1, "heat": 1, "noise": 0.5, "seed": 3 }
        ],
        "physics": { "cooling": 0, "turbulence": 1 },
        "time": { "warm_up": 0.1, "duration": 0.8 },
        "sheet": { "size": 32, "columns": 2, "rows": 2 }
    }"#;
    json::parse(Path::new("small.sim.json"), text).unwrap()
}

fn run(recipe: &SimRecipe) -> BakedRecording {
    Simulation::new(recipe).unwrap().finish().bake()
}

/// Sum of all smoke, and the mean height of it.
fn smoke_of(fluid: &Fluid<'_>) -> (f64, f64) {
    let mut sum = 0.0;
    let mut height = 0.0;
    let size = fluid.fine.grid.size;
    for index in 0..size.element_product() {
        let cell = UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y)) + 1;
        let smoke = f64::from(fluid.gas[fluid.fine.grid.index(cell)].x);
        sum += smoke;
        height += smoke * f64::from(fluid.fine.position(cell.as_vec3()).y);
    }
    (sum, height / sum)
}

#[test]
fn the_velocity_has_no_divergence_after_the_projection() {
    let grid = Grid { size: UVec3::new(16, 24, 12) };
    let strides = grid.strides();
    let is_solid = |cell: UVec3| cell.y == 0 || (cell.cmpge(UVec3::splat(5)) & cell.cmple(UVec3::new(9, 8, 7))).all();
    let cells = || {
        (0..grid.cells() as u32).map(|index| {
            let [_, row, slice] = strides.map(|stride| stride as u32);
            UVec3::new(index % row, index % slice / row, index / slice)
        })
    };
    let is_face = |axis: usize, cell: UVec3| {
        let faces = grid.faces(axis);
        cell.cmpge(faces.low).all() && cell.cmple(faces.high).all()
    };
    let open = [0, 1, 2].map(|axis| {
        let of_cell = |cell: UVec3| {
            let below = cell.with_x(cell.x - u32::from(axis == 0));
            let below = below.with_y(cell.y - u32::from(axis == 1)).with_z(cell.z - u32::from(axis == 2));
            f32::from(u8::from(!is_solid(cell) && !is_solid(below)))
        };
        cells().map(|cell| if is_face(axis, cell) { of_cell(cell) } else { 0.0 }).collect::<Vec<_>>()
    });
    let mut velocity =
        [1, 2, 3].map(|salt| cells().map(|cell| unit(pcg3d(cell * salt).x) * 2.0 - 1.0).collect::<Vec<f32>>());
    let divergence = |velocity: &[Vec<f32>; 3]| {
        let inside = |cell: &UVec3| cell.min_element() > 0 && cell.cmple(grid.size).all() && !is_solid(*cell);
        let flow = |index: usize| {
            (0..3).map(|axis| velocity[axis][index + strides[axis]] - velocity[axis][index]).sum::<f32>()
        };
        let squares = cells().filter(inside).map(|cell| f64::from(flow(grid.index(cell))).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let mut solver = PressureSolver::new(grid, open.clone());
    // Nothing flows through solid faces even before.
    for (values, open) in velocity.iter_mut().zip(&open) {
        values.iter_mut().zip(open).for_each(|(value, open)| *value *= open);
    }
    let before = divergence(&velocity);
    let iterations = solver.project(&mut velocity, &vec![0.0; grid.cells()]);
    let after = divergence(&velocity);
    // f32 rounds the velocities, which doubles the residual at most.
    assert!(after < 2.0 * RELATIVE_RESIDUAL * before, "{before} {after}");
    assert!(iterations < 20, "{iterations}");
    assert!(velocity[1][grid.index(UVec3::new(3, 1, 3))] == 0.0 && velocity[0][grid.index(UVec3::new(5, 6, 6))] == 0.0);
}

#[test]
fn sums_do_not_depend_on_the_number_of_threads() {
    // Large enough for threads.
    let grid = Grid { size: UVec3::new(40, 40, 40) };
    let row =
        |first: usize| (0..40).map(|x| f64::from(unit(pcg3d(UVec3::new((first + x) as u32, 1, 2)).x))).sum::<f64>();
    let mut expected = 0.0;
    for z in 1..=40 {
        expected += (1..=40).map(|y| row(grid.index(UVec3::new(1, y, z)))).sum::<f64>();
    }
    assert_eq!(grid.sum_rows(row).to_bits(), expected.to_bits());
}

#[test]
fn every_machine_simulates_the_same_bytes() {
    let mut fire = small();
    fire.sources[0].fuel = 1.0;
    fire.sources[0].position.y = 0.15;
    fire.sources[0].velocity = Vec3::new(0.3, 0.2, -0.1);
    fire.grid.ground = true;
    fire.grid.detail = 1;
    fire.physics = Physics { burn_expansion: 0.5, drag: 0.5, erosion: 0.1, weight: 0.1, ..Physics::default() };
    fire.obstacle = Some(Obstacle { position: Vec3::new(0.1, 0.8, 0.0), radius: Vec3::splat(0.15) });
    fire.time.frame_loop = FrameLoop::CrossBlend;
    let found = [small(), fire].map(|recipe| {
        let BakedRecording { sprite, heat } = run(&recipe);
        let heat = heat.map(image::ImageBuffer::into_raw).unwrap_or_default();
        hash(sprite.image.into_raw().into_iter().chain(sprite.detail.into_raw()).chain(heat))
    });
    assert_eq!(found, EXPECTED, "{found:#x?}");
}

/// Hashes of the images above.
const EXPECTED: [u64; 2] = [0x3ffa_5a67_bebd_eb3d, 0xdddd_ede6_7e88_e5eb];

#[test]
fn smoke_rises_and_none_is_lost() {
    let recipe = small();
    let mut fluid = Fluid::new(&recipe);
    fluid.advance(0.12);
    let (smoke, height) = smoke_of(&fluid);
    fluid.advance(0.3);
    let (later, higher) = smoke_of(&fluid);
    assert!(higher > height + 0.05, "{height} {higher}");
    // Semi-Lagrangian paths do not conserve sums exactly.
    assert!((later / smoke - 1.0).abs() < 0.08, "{smoke} {later}");
}

#[test]
fn gas_flows_around_an_obstacle() {
    let mut recipe = small();
    let obstacle = Obstacle { position: Vec3::new(0.0, 0.85, 0.0), radius: Vec3::new(0.2, 0.06, 0.2) };
    recipe.sources[0].end = 100.0;
    recipe.obstacle = Some(obstacle.clone());
    let mut fluid = Fluid::new(&recipe);
    (0..40).for_each(|_| fluid.advance(0.05));
    let mut above = 0.0;
    let size = fluid.fine.grid.size;
    for index in 0..size.element_product() {
        let cell = UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y)) + 1;
        let position = fluid.fine.position(cell.as_vec3());
        let smoke = fluid.gas[fluid.fine.grid.index(cell)].x;
        // One cell of the velocity within its surface: advection reaches the first.
        let deep = (position - obstacle.position).abs().cmplt(obstacle.radius - 0.06).all();
        assert!(!deep || smoke < 0.2, "{position}: {smoke}");
        above += if position.y > 1.0 { smoke } else { 0.0 };
    }
    assert!(above > 1.0, "{above}");
}

#[test]
fn maccormack_blurs_less_than_paths_alone() {
    let grid = Grid { size: UVec3::splat(24) };
    let domain = Domain { grid };
    let from_axis = |cell: UVec3| domain.position(cell.as_vec3()) - Vec3::Y * 0.5;
    let mut velocity = vec![Vec4::ZERO; grid.cells()];
    let mut blob = vec![Vec4::ZERO; grid.cells()];
    for index in 0..24_u32.pow(3) {
        let cell = UVec3::new(index % 24, index / 24 % 24, index / 576) + 1;
        let at = from_axis(cell);
        velocity[grid.index(cell)] = Vec4::new(-at.y, at.x, 0.0, 0.0);
        let inside = (1.0 - (at - Vec3::X * 0.2).length_squared() / 0.02).max(0.0);
        blob[grid.index(cell)] = Vec4::splat(inside);
    }
    // Steps of 1/40 of a turn.
    let flow = Flow::new(grid, &velocity, 24.0 * std::f32::consts::TAU / 40.0);
    let all = CellBox { low: UVec3::ONE, high: grid.size };
    let mut sharp = blob.clone();
    let mut blurred = blob;
    for _ in 0..40 {
        sharp = flow.advect_cells(&sharp, grid, all);
        blurred = flow.carry_cells(&blurred, grid, all);
    }
    let peak = |values: &[Vec4]| values.iter().fold(0.0_f32, |peak, value| peak.max(value.x));
    let peaks = [peak(&sharp), peak(&blurred)];
    assert!(peaks[0] > 1.5 * peaks[1] && peaks[0] <= 1.0, "{peaks:?}");
}

#[test]
fn frames_are_clear_at_their_borders_and_motion_predicts_the_next() {
    let mut recipe = small();
    recipe.grid = GridSize { width: 24, height: 32, depth: 24, ..recipe.grid };
    recipe.sheet.size = 64;
    let BakedRecording { sprite: baked, heat } = run(&recipe);
    assert!(heat.is_none());
    // Refuses frames that are not clear at the border.
    let sprite = Sprite::from_image(Path::new("small.png"), &baked.image, recipe.sheet.layout()).unwrap();
    let still = RgbaImage::from_pixel(baked.detail.width(), baked.detail.height(), image::Rgba([128; 4]));
    let [moved, still] = [&baked.detail, &still]
        .map(|detail| (0..3).map(|frame| prediction_error(&sprite, detail, recipe.sheet.columns, frame)).sum::<f32>());
    assert!(moved < 0.6 * still, "{moved} {still}");
}

/// Sum of the squared differences of amount between a frame moved along its motion and the next frame, on the texels of
/// the detail map.
fn prediction_error(sprite: &Sprite, detail: &RgbaImage, columns: u32, frame: u32) -> f32 {
    let size = sprite.level_size(2);
    let amount = |frame: u32, at: IVec2| {
        let at = at.clamp(IVec2::ZERO, IVec2::splat(size as i32 - 1)).as_uvec2();
        sprite.texel(2, frame, at.x, at.y).w
    };
    let at = |index: u32| UVec2::new(index % size, index / size);
    let error = |at: UVec2| {
        let corner = UVec2::new(frame % columns, frame / columns) * size;
        let [_, x, y, _] =
            detail.get_pixel(corner.x + at.x, corner.y + at.y).0.map(|code| (f32::from(code) - 128.0) / 127.0);
        let moved = at.as_vec2() + Vec2::new(x, y) * MOTION_RANGE * size as f32;
        let low = moved.floor();
        let fraction = moved - low;
        let load = |x, y| amount(frame + 1, low.as_ivec2() + IVec2::new(x, y));
        let top = load(0, 0) + (load(1, 0) - load(0, 0)) * fraction.x;
        let bottom = load(0, 1) + (load(1, 1) - load(0, 1)) * fraction.x;
        (amount(frame, at.as_ivec2()) - (top + (bottom - top) * fraction.y)).powi(2)
    };
    (0..size * size).map(|index| error(at(index))).sum()
}

#[test]
fn errors_name_the_field() {
    let refused = |change: fn(&mut SimRecipe)| {
        let mut recipe = small();
        change(&mut recipe);
        recipe.validate().unwrap_err().to_string()
    };
    let sides = refused(|recipe| recipe.grid.height = 18);
    assert_eq!(sides, "grid.height: 18 is not valid; expected a multiple of 4");
    let size = refused(|recipe| recipe.sources[0].radius.y = 0.0);
    assert_eq!(size, "sources[0].radius: 0 is not valid; expected 0.001 to 4 box widths");
    let cooling = refused(|recipe| recipe.physics.cooling = -1.0);
    assert_eq!(cooling, "physics.cooling: -1 is not valid; expected 0 to 50 per second");
    let none = refused(|recipe| recipe.sources.clear());
    assert_eq!(none, "sources: 0 is not valid; expected 1 to 64 sources");
    let cells = refused(|recipe| recipe.grid = GridSize { width: 192, height: 192, depth: 192, ..recipe.grid });
    assert_eq!(cells, "grid: 192x192x192 is not valid; expected at most 128x192x128 cells");
    let detail = refused(|recipe| recipe.grid = GridSize { width: 128, height: 128, depth: 64, ..recipe.grid });
    assert_eq!(detail, "grid.detail: 2 is not valid; expected 1 for more than 64x96x64 cells");
}

#[test]
fn shipped_recipes_are_valid() {
    for builtin in haze_preset::builtin::SIMULATIONS {
        let recipe = SimRecipe::of_built_in(builtin).unwrap();
        recipe.validate().unwrap();
        recipe.preview().validate().unwrap();
        assert_eq!(recipe.burns(), ["burst", "flame_lick"].contains(&builtin.name), "{}", builtin.name);
        let written: SimRecipe = json::parse(Path::new("a.sim.json"), &recipe.to_json()).unwrap();
        assert_eq!(written, recipe);
    }
}

#[test]
fn a_simulation_goes_on_from_any_moment_to_the_same_images() {
    let mut recipe = small();
    recipe.sources[0].fuel = 0.5;
    recipe.grid.ground = true;
    let whole = run(&recipe);
    // In the warm-up, before the first moment, after one, and after the last.
    let mut simulation = Simulation::new(&recipe).unwrap();
    for finished in [0, 0, 1, 2, 3, 4] {
        let checkpoint = simulation.to_checkpoint();
        let resumed = Simulation::resume(&recipe, &checkpoint).unwrap().unwrap();
        assert_eq!(resumed.finished_moments(), finished);
        let baked = resumed.finish().bake();
        assert!(baked.sprite.image == whole.sprite.image && baked.sprite.detail == whole.sprite.detail, "{finished}");
        assert!(baked.heat == whole.heat && baked.heat.is_some());
        simulation.advance();
    }
}

#[test]
fn a_checkpoint_of_another_recipe_is_none_and_a_damaged_one_is_refused() {
    let recipe = small();
    let mut simulation = Simulation::new(&recipe).unwrap();
    simulation.advance();
    simulation.advance();
    let checkpoint = simulation.to_checkpoint();
    let mut other = recipe.clone();
    other.physics.buoyancy = 3.0;
    assert!(Simulation::resume(&other, &checkpoint).unwrap().is_none());
    let said = |file: &[u8]| Simulation::resume(&recipe, file).map(drop).unwrap_err();
    assert_eq!(said(b"haze"), "no checkpoint of this version of haze");
    for cut in (18..checkpoint.len()).step_by(checkpoint.len() / 97) {
        assert!(!said(&checkpoint[..cut]).is_empty(), "{cut}");
    }
    // No byte makes it panic.
    for at in (0..checkpoint.len()).step_by(checkpoint.len() / 97) {
        let mut damaged = checkpoint.clone();
        damaged[at] ^= 0x55;
        if let Ok(Some(mut resumed)) = Simulation::resume(&recipe, &damaged) {
            resumed.advance();
        }
    }
}
