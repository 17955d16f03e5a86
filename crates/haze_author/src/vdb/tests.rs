//! Files that OpenVDB has written: `scripts/vdb_files`.

#![allow(clippy::float_cmp, reason = "values are read and interpolated exactly")]

use std::path::Path;

use glam::{DVec3, IVec3};

use super::values::is_set;
use super::*;

fn content(name: &str) -> Vec<u8> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/corpus/vdb"));
    std::fs::read(folder.join(name)).unwrap()
}

fn read<const N: usize>(file: &VdbFile<'_>, name: &str) -> SparseGrid<N> {
    let grid = file.grids().iter().find(|grid| grid.name == name).unwrap();
    file.read(grid).unwrap()
}

/// Density that the script writes within a box.
fn field(voxel: IVec3) -> f32 {
    (voxel.x + 2 * voxel.y + 4 * voxel.z + 16) as f32 / 64.0
}

/// Voxels of a box, both ends included.
fn voxels(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    let columns = (low.x..=high.x).flat_map(move |x| (low.y..=high.y).map(move |y| (x, y)));
    columns.flat_map(move |(x, y)| (low.z..=high.z).map(move |z| IVec3::new(x, y, z)))
}

fn assert_field(name: &str, grid: &SparseGrid<1>, low: IVec3, high: IVec3) {
    let mut sampler = grid.sampler();
    for voxel in voxels(low - 3, high + 3) {
        let is_inside = voxel.cmpge(low).all() && voxel.cmple(high).all();
        let expected = if is_inside { field(voxel) } else { 0.0 };
        assert_eq!(sampler.value(voxel), [expected], "{name} at {voxel}");
    }
}

const HIGH: IVec3 = IVec3::new(11, 11, 9);

#[test]
fn values_are_exact_in_every_compression() {
    for (name, low) in [
        ("good_zip", IVec3::new(-4, 0, 0)),
        ("good_blosc", IVec3::ZERO),
        ("good_uncompressed", IVec3::ZERO),
        ("good_zip_unmasked", IVec3::ZERO),
        ("good_parts", IVec3::ZERO),
        ("good_half_zip", IVec3::ZERO),
        ("good_half_blosc", IVec3::ZERO),
    ] {
        let content = content(name);
        let file = VdbFile::parse(&content).unwrap();
        let density = read::<1>(&file, "density");
        // Files of half floats have a cube beside the box.
        assert_field(name, &density, low, HIGH);
        let has_cube = name.contains("half");
        let bounds = if has_cube { [low, IVec3::new(23, 11, 9)] } else { [low, HIGH] };
        assert_eq!(density.bounds(0.0), Some(bounds), "{name}");
        assert_eq!(density.sampler().value(IVec3::new(16, 7, 7)), [if has_cube { 0.5 } else { 0.0 }], "{name}");
        assert_eq!(density.max(), field(HIGH), "{name}");
    }
}

#[test]
fn vectors_are_exact_and_metadata_are_read() {
    for (name, grid) in [("good_simulation", "vel"), ("good_half_zip", "v"), ("good_half_blosc", "v")] {
        let content = content(name);
        let file = VdbFile::parse(&content).unwrap();
        let velocity = read::<3>(&file, grid);
        let mut sampler = velocity.sampler();
        for voxel in voxels(IVec3::ZERO, HIGH) {
            let expected = [voxel.x as f32 / 4.0, voxel.y as f32 / -4.0, voxel.z as f32 / 8.0];
            assert_eq!(sampler.value(voxel), expected, "{name} at {voxel}");
        }
        assert_eq!(sampler.value(IVec3::splat(12)), [0.0; 3]);
    }
    let content = content("good_simulation");
    let file = VdbFile::parse(&content).unwrap();
    let found: Vec<_> =
        file.grids().iter().map(|grid| (grid.name.as_str(), grid.kind(), grid.class.as_str())).collect();
    let expected = [
        ("density", "float".into(), "unknown"),
        ("temperature", "float".into(), "fog volume"),
        ("vel", "vec3s".into(), "staggered"),
        ("color", "int32".into(), "fog volume"),
    ];
    assert_eq!(found, expected);
    assert!(file.grids().iter().all(|grid| grid.creator == "Houdini/GEO_VDBTranslator"));
}

#[test]
fn scale_and_translation_give_positions() {
    for (name, voxel, offset) in [
        ("good_blosc", 0.25, DVec3::new(1.0, 2.0, -3.0)),
        ("good_shared", 0.5, DVec3::new(1.0, 2.0, 3.0)),
        ("good_cubes", 1.0, DVec3::ZERO),
    ] {
        let content = content(name);
        let density = read::<1>(&VdbFile::parse(&content).unwrap(), "density");
        assert_eq!(density.transform, GridTransform { voxel, offset }, "{name}");
        let index = DVec3::new(3.0, -2.0, 7.5);
        assert_eq!(density.transform.index(density.transform.position(index)), index);
    }
}

#[test]
fn samples_between_voxels_are_interpolated() {
    let content = content("good_blosc");
    let density = read::<1>(&VdbFile::parse(&content).unwrap(), "density");
    let mut sampler = density.sampler();
    // The field is linear, so that interpolation is exact, also from one leaf to the next.
    for at in [DVec3::new(2.5, 3.25, 4.0), DVec3::splat(7.5), DVec3::new(7.125, 8.0, 0.75)] {
        let expected = (at.x + 2.0 * at.y + 4.0 * at.z + 16.0) / 64.0;
        assert_eq!(sampler.sample(at), [expected as f32], "{at}");
    }
    // Rounding of a transform gives the voxel itself.
    assert_eq!(sampler.sample(DVec3::splat(4.0 - 1.0e-9)), [field(IVec3::splat(4))]);
    assert_eq!(sampler.sample(DVec3::splat(f64::NAN)), [0.0]);
    assert_eq!(sampler.sample(DVec3::splat(1.0e300)), [0.0]);
}

#[test]
fn cubes_of_one_value_are_read_on_every_level() {
    let content = content("good_cubes");
    let density = read::<1>(&VdbFile::parse(&content).unwrap(), "density");
    let mut sampler = density.sampler();
    for (voxel, expected) in [
        ([8, 8, 8], 0.25),
        ([15, 15, 15], 0.25),
        ([16, 15, 15], 0.0),
        ([128, 0, 0], 0.5),
        ([255, 127, 127], 0.5),
        ([256, 0, 0], 0.0),
        ([4096, 0, 0], 0.75),
        ([8191, 4095, 4095], 0.75),
        ([8192, 0, 0], 0.0),
        ([1, 2, 3], 1.0),
        ([1, 2, 4], 0.0),
        ([-1, -1, -1], 0.0),
    ] {
        assert_eq!(sampler.value(voxel.into()), [expected], "{voxel:?}");
    }
    assert_eq!(density.bounds(0.0), Some([IVec3::new(1, 0, 0), IVec3::new(8191, 4095, 4095)]));
    assert_eq!(density.bounds(0.8), Some([IVec3::new(1, 2, 3); 2]));
}

#[test]
fn inactive_values_are_read_in_every_form() {
    let content = content("good_inactive");
    let density = read::<1>(&VdbFile::parse(&content).unwrap(), "density");
    let inactive = [[2.0, 2.0], [-2.0, -2.0], [5.0, 5.0], [-2.0, 2.0], [2.0, 5.0], [5.0, 6.0]];
    let mut sampler = density.sampler();
    for leaf in 0..7_usize {
        for index in 0..512_usize {
            let voxel = sparse_grid::voxel_of(index, 3) + IVec3::X * (8 * leaf) as i32;
            let expected = match inactive.get(leaf) {
                _ if index % 3 == 0 => field(voxel),
                Some(values) => values[index % 2],
                None => index as f32,
            };
            assert_eq!(sampler.value(voxel), [expected], "leaf {leaf} at {voxel}");
        }
    }
    assert_eq!(sampler.value(IVec3::splat(-1)), [2.0]);
}

#[test]
fn a_shared_tree_is_read_for_both_grids() {
    let content = content("good_shared");
    let file = VdbFile::parse(&content).unwrap();
    assert_eq!(file.grids().len(), 2);
    for name in ["density", "flame"] {
        assert_field(name, &read::<1>(&file, name), IVec3::ZERO, HIGH);
    }
}

/// Reads all grids as vectors or numbers. Fails only by an error.
fn read_all(content: &[u8]) -> Result<(), String> {
    let file = VdbFile::parse(content)?;
    for grid in file.grids() {
        match grid.numbers() {
            3 => drop(file.read::<3>(grid)?),
            _ => drop(file.read::<1>(grid)?),
        }
    }
    Ok(())
}

#[test]
fn files_that_were_cut_or_overwritten_are_refused() {
    for name in ["good_half_blosc", "good_zip", "good_cubes", "good_uncompressed"] {
        let whole = content(name);
        read_all(&whole).unwrap();
        for length in (0..whole.len()).step_by(211) {
            assert!(read_all(&whole[..length]).is_err(), "{name}: {length} bytes");
            // The end is there, but empty: some of these are valid.
            let mut cleared = whole.clone();
            cleared[length..].fill(0);
            let _ = read_all(&cleared);
            cleared[length..].fill(255);
            let _ = read_all(&cleared);
        }
    }
}

#[test]
fn other_versions_and_files_are_refused() {
    let mut content = content("good_blosc");
    content[8] = 221;
    let refused = VdbFile::parse(&content).err();
    assert_eq!(refused.as_deref(), Some("version 221 of the VDB format; expected 222 to 224 (OpenVDB 2 to 13)"));
    assert_eq!(
        VdbFile::parse(b"ply\nformat").err().as_deref(),
        Some("this is no VDB file; expected one that OpenVDB has written")
    );
}

#[test]
fn bits_of_masks_are_counted_from_the_lowest() {
    let mask = [0b0000_0001, 0b1000_0000];
    let set: Vec<_> = (0..20).filter(|index| is_set(&mask, *index)).collect();
    assert_eq!(set, [0, 15]);
}

#[test]
fn written_files_are_read_back() {
    // Over the border of two children of the root.
    let bounds = [IVec3::new(-3, 120, 4090), IVec3::new(9, 130, 4100)];
    let is_inside = |voxel: IVec3| voxel.cmpge(bounds[0]).all() && voxel.cmple(bounds[1]).all() && voxel.x != 2;
    let density = |voxel: IVec3| [if is_inside(voxel) { voxel.x as f32 + voxel.z as f32 / 4096.0 } else { 0.0 }];
    let velocity = |voxel: IVec3| if is_inside(voxel) { voxel.as_vec3().to_array() } else { [0.0; 3] };
    let transform = GridTransform { voxel: 0.125, offset: DVec3::new(1.0, -2.0, 0.5) };
    let mut writer = VdbWriter::new("haze");
    writer.add(&GridToWrite { name: "density", transform, bounds, value: &density });
    writer.add(&GridToWrite { name: "vel", transform, bounds, value: &velocity });
    let written = writer.finish();
    let file = VdbFile::parse(&written).unwrap();
    let found = [read::<1>(&file, "density").transform, read::<3>(&file, "vel").transform];
    assert_eq!(found, [transform; 2]);
    assert!(file.grids().iter().all(|grid| grid.creator == "haze"));
    let smoke = read::<1>(&file, "density");
    let wind = read::<3>(&file, "vel");
    let (mut smoke, mut wind) = (smoke.sampler(), wind.sampler());
    for voxel in voxels(bounds[0] - 2, bounds[1] + 2) {
        assert_eq!(smoke.value(voxel), density(voxel), "{voxel}");
        assert_eq!(wind.value(voxel), velocity(voxel), "{voxel}");
    }
}
