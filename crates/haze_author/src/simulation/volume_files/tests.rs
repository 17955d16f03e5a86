//! Files that OpenVDB has written: `scripts/vdb_files`.

#![allow(clippy::float_cmp, reason = "heats are quotients that are exact")]

use std::path::{Path, PathBuf};

use glam::{DVec3, IVec3, UVec2, UVec3};
use haze_core::error::AssetError;
use haze_preset::UpAxis;

use super::super::bake::Recording;
use super::super::sim_recipe::FrameLoop;
use super::cell_grid::{Axes, Bounds, CellGrid};
use super::heat_scale::HeatScale;
use super::*;
use crate::sprite::bake::SheetLayout;
use crate::vdb::GridTransform;

fn corpus(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/corpus/vdb")).join(name)
}

fn options() -> VolumeOptions {
    let sheet = SheetLayout { size: 16, columns: 1, rows: 1, tolerance: 0 };
    VolumeOptions { resolution: 64, sheet, ..VolumeOptions::default() }
}

fn record(path: &Path, options: &VolumeOptions) -> Result<VolumeRecording, AssetError> {
    VolumeSequence::find(path)?.record(options, |_| Ok(()))
}

/// Density that the script writes from voxel 0 to (11, 11, 9).
fn field(voxel: IVec3) -> f32 {
    let is_inside = voxel.cmpge(IVec3::ZERO).all() && voxel.cmple(IVec3::new(11, 11, 9)).all();
    if is_inside { (voxel.x + 2 * voxel.y + 4 * voxel.z + 16) as f32 / 64.0 } else { 0.0 }
}

const LARGEST: f32 = (11 + 22 + 36 + 16) as f32 / 64.0;

/// Smoke, heat and velocity of a cell of the only frame.
fn cell(recording: &Recording, cell: UVec3) -> [f32; 4] {
    recording.frames[0].sampler().unwrap().sample(cell.as_vec3()).to_array()
}

fn cells(recording: &Recording) -> impl Iterator<Item = UVec3> + use<> {
    let size = recording.fine.grid.size;
    (0..size.element_product())
        .map(move |index| UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y)) + 1)
}

/// Half floats have 11 bits.
fn is_near(found: f32, expected: f32) -> bool {
    (found - expected).abs() <= expected.abs() / 2048.0 + 1.0e-6
}

#[test]
fn cells_have_the_values_of_their_voxels() {
    for (name, up) in [("good_blosc", UpAxis::Y), ("good_blosc", UpAxis::Z), ("good_parts", UpAxis::Z)] {
        let recording = record(&corpus(name), &VolumeOptions { up: Some(up), ..options() }).unwrap().recording;
        // A margin of one cell around 12x12x10 voxels.
        let expected = if up == UpAxis::Y { UVec3::new(14, 14, 12) } else { UVec3::new(14, 12, 14) };
        assert_eq!(recording.fine.grid.size, expected);
        for at in cells(&recording) {
            let along = at.as_ivec3() - 2;
            let voxel = if up == UpAxis::Y { along } else { IVec3::new(along.x, 11 - along.z, along.y) };
            let [smoke, ..] = cell(&recording, at);
            assert!(is_near(smoke, field(voxel) / LARGEST), "{name}, {up:?}: {smoke} at {voxel}");
        }
    }
}

#[test]
fn larger_cells_have_the_mean_of_their_voxels() {
    // At most 8 cells and 2 of margin along 12 voxels: 2 voxels each.
    let recorded = record(&corpus("good_blosc"), &VolumeOptions { resolution: 10, ..options() }).unwrap();
    assert_eq!(recorded.recording.fine.grid.size, UVec3::new(8, 8, 7));
    for at in cells(&recorded.recording) {
        let corner = (at.as_ivec3() - 2) * 2;
        let voxels = (0..8).map(|index| corner + IVec3::new(index & 1, index >> 1 & 1, index >> 2));
        let mean = voxels.map(field).sum::<f32>() / 8.0;
        let [smoke, ..] = cell(&recorded.recording, at);
        assert!(is_near(smoke, mean / LARGEST), "{smoke} at {corner}");
    }
}

#[test]
fn heat_and_velocity_are_read_with_their_scales() {
    let VolumeRecording { recording, notes } = record(&corpus("good_simulation"), &options()).unwrap();
    assert_eq!(
        notes,
        [
            "smoke from density, of which 1.328125 is 1; heat from temperature, of which 1.015625 is 1; motion from vel",
            "up is y, as houdini writes",
            "14x14x12 cells of a voxel",
            "not read: color",
        ]
    );
    assert!(recording.has_heat);
    let [_, heat, x, y] = cell(&recording, UVec3::splat(5));
    // Voxel (3, 3, 3).
    assert!(is_near(heat, field(IVec3::splat(3)) / 1.015_625), "{heat}");
    // Staggered: the mean of the faces below and above the voxel. 14 cells of 0.25 are one box width.
    let [expected_x, expected_y] = [3.5 / 4.0, -3.5 / 4.0].map(|speed| speed / (14.0 * 0.25));
    assert!(is_near(x, expected_x) && is_near(y, expected_y), "{x} {y}");
    let VolumeRecording { notes, .. } = record(&corpus("good_parts"), &options()).unwrap();
    assert!(notes[0].ends_with("; motion from vel.x, vel.y, vel.z"), "{notes:?}");
}

#[test]
fn a_ball_of_blender_becomes_a_round_sprite() {
    let mut options = options();
    options.sheet.size = 32;
    options.view.extinction = 100.0;
    let VolumeRecording { recording, notes } = record(&corpus("good_blender"), &options).unwrap();
    assert!(notes[1].starts_with("up is y, because the file names no program that is known"), "{notes:?}");
    let image = recording.bake().sprite.image;
    for (x, y, texel) in image.enumerate_pixels() {
        let at = glam::Vec2::new(x as f32 - 15.5, 15.5 - y as f32) / 16.0;
        let [_, _, _, amount] = texel.0;
        // A margin of 6 of 100 on each side; voxels are 0.15 wide.
        assert!(at.length() < 1.05 || amount == 0, "{at}: {amount}");
        assert!(at.length() > 0.6 || amount > 200, "{at}: {amount}");
    }
}

#[test]
fn heat_is_read_in_kelvin_or_relative_to_the_largest() {
    let heat = |largest, value| HeatScale::of_largest(largest).heat(value);
    assert_eq!(heat(0.8, 0.5), 0.5);
    assert_eq!(heat(5.0, 2.5), 0.5);
    assert_eq!(heat(2500.0, 1400.0), 0.5);
    assert_eq!(heat(2500.0, 300.0), 0.0);
}

#[test]
fn files_that_make_no_smoke_are_refused_by_name() {
    let cubes = "expected a scale and a translation: resample it";
    for (name, expected) in [
        ("bad_turned", format!("density: turned or sheared voxels; {cubes}")),
        ("bad_flat_voxels", "density: voxels of 1 x 2 x 1 at [0, 0, 0]; expected cubes".into()),
        ("bad_frustum", "density: a frustum of a camera; expected a grid in a box: resample it".into()),
        (
            "bad_without_density",
            "no grid named density; expected one, or --grid with the name of another. Grids of the file: vel \
             (vec3s), flame (float)"
                .into(),
        ),
        (
            "bad_level_set",
            "density: a level set, distances to a surface; expected a fog volume: convert it".into(),
        ),
        (
            "bad_integers",
            "density: values of int32; expected float, half, double or vectors of them, in a tree of 5, 4 and 3 levels"
                .into(),
        ),
        (
            "bad_tree",
            "density: Tree_float_4_3_3; expected float, half, double or vectors of them, in a tree of 5, 4 and 3 levels"
                .into(),
        ),
        (
            "bad_points",
            "density: points; expected a volume: rasterize them, or export them as CSV or PLY for particles".into(),
        ),
        ("bad_empty", "density: no value above 0 in any frame; expected smoke".into()),
        (
            "bad_stream",
            "a stream without positions of its grids; expected a file of OpenVDB's io::File".into(),
        ),
    ] {
        let path = corpus(name);
        let refused = record(&path, &options()).err().map(|error| error.to_string());
        assert_eq!(refused, Some(format!("{}: {expected}", path.display())));
    }
    let vectors = VolumeOptions { density: "vel".into(), ..options() };
    let refused = record(&corpus("good_simulation"), &vectors).err().unwrap().to_string();
    assert!(refused.ends_with("vel: 3 numbers in each voxel; expected 1"), "{refused}");
}

#[test]
fn frames_are_spread_over_the_sequence() {
    let folder = tempfile::tempdir().unwrap();
    for number in [8, 9, 10, 12, 15, 16, 17] {
        std::fs::copy(corpus("good_blosc"), folder.path().join(format!("s_{number:02}.vdb"))).unwrap();
    }
    let sequence = VolumeSequence::find(&folder.path().join("s_##.vdb")).unwrap();
    assert_eq!((sequence.frame_count(), sequence.missing().as_deref()), (10, Some("11, 13 to 14")));
    let sheet = |columns, rows| SheetLayout { columns, rows, ..options().sheet };
    let numbers = |sheet, frame_loop| {
        let moments = sequence.moments(&VolumeOptions { sheet, frame_loop, ..options() })?;
        let name = |path: &Path| path.file_stem().unwrap().to_str().unwrap()[2..].to_owned();
        Ok::<_, haze_core::error::FieldError>(moments.into_iter().map(name).collect::<Vec<_>>())
    };
    assert_eq!(numbers(sheet(5, 1), FrameLoop::Once).unwrap(), ["08", "10", "12", "12", "16"]);
    assert_eq!(numbers(sheet(1, 1), FrameLoop::Once).unwrap(), ["08"]);
    assert_eq!(numbers(sheet(4, 2), FrameLoop::CrossBlend).unwrap().len(), 10);
    let refused = numbers(sheet(4, 3), FrameLoop::Once).unwrap_err().to_string();
    assert_eq!(refused, "columns and rows: 12 frames from 10; expected at most 10");
    assert_eq!(sequence.default_grid(FrameLoop::CrossBlend), UVec2::new(4, 2));
    for (frames, grid) in
        [(1, (1, 1)), (2, (2, 1)), (3, (3, 1)), (5, (2, 2)), (7, (3, 2)), (61, (10, 6)), (250, (8, 8))]
    {
        let files = vec![(1, PathBuf::new()), (frames, PathBuf::new())];
        let sequence = VolumeSequence { path: PathBuf::new(), files };
        assert_eq!(sequence.default_grid(FrameLoop::Once), UVec2::from(grid), "{frames} frames");
    }
}

#[test]
fn all_frames_share_one_box_and_one_scale() {
    let folder = tempfile::tempdir().unwrap();
    for (number, name) in [(1, "good_half_zip"), (2, "good_parts")] {
        std::fs::copy(corpus(name), folder.path().join(format!("{number}.vdb"))).unwrap();
    }
    let mut options = options();
    options.sheet.columns = 2;
    let recording = record(&folder.path().join("#.vdb"), &options).unwrap().recording;
    // The first frame has a cube beside the box, up to voxel 23.
    assert_eq!(recording.fine.grid.size, UVec3::new(26, 14, 12));
    for frame in &recording.frames {
        let [smoke, ..] = frame.sampler().unwrap().sample(glam::Vec3::splat(5.0)).to_array();
        assert!(is_near(smoke, field(IVec3::splat(3)) / LARGEST), "{smoke}");
    }
}

#[test]
fn the_grid_of_cells_is_bounded() {
    let transform = GridTransform { voxel: 0.1, offset: DVec3::ZERO };
    let grid = |high: DVec3, resolution, frames| {
        // The center of voxel 0 is at 0.
        let bounds = Bounds { low: DVec3::splat(-0.05), high: high - 0.05 };
        let cells = CellGrid::new(bounds, transform, Axes(UpAxis::Y), resolution, frames);
        (cells.domain.grid.size, cells.voxels_per_cell)
    };
    assert_eq!(grid(DVec3::splat(10.0), 192, 1), (UVec3::splat(102), 1));
    // 300 of 192 voxels.
    assert_eq!(grid(DVec3::new(10.0, 30.0, 1.0), 192, 1), (UVec3::new(52, 152, 7), 2));
    // 192³ cells of 256 frames would take 14 GB.
    let (size, _) = grid(DVec3::splat(19.0), 192, 256);
    assert!(size.element_product() as u64 * 8 * 256 <= 2 << 30, "{size}");
    for far in [1.0e6, 1.0e20] {
        let (size, _) = grid(DVec3::new(far, 1.0, 1.0), 192, 256);
        assert!(size.max_element() <= 192 && size.min_element() >= 3, "{size}");
    }
}
