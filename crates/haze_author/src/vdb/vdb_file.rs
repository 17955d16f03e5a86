//! Header of a file, and the grids in it.

use glam::DVec3;
use haze_core::error::one_line;

use super::sparse_grid::{GridTransform, SparseGrid};
use super::tree_reader::TreeReader;
use super::values::{ACTIVE_MASK, BLOSC, Number, ValueFormat, ZIP};
use crate::bytes::Bytes;

/// First bytes of a file, and of the library's number of the same name.
pub const MAGIC: [u8; 8] = *b" BDV\0\0\0\0";
/// Versions of the format that are read: since active masks compress, and since points are indexed.
const VERSIONS: std::ops::RangeInclusive<u32> = 222..=224;
/// Bytes of the identifier after the header.
const IDENTIFIER: usize = 36;
/// Separates a grid's name from a number that makes it unique.
const NAME_END: char = '\u{1e}';
/// Ending of the type of a grid whose arrays are of half floats.
const HALF_ENDING: &str = "_HalfFloat";
/// Largest relative difference between the sides of a voxel that is a cube.
const CUBE_TOLERANCE: f64 = 1.0e-4;

/// A grid that a file lists.
#[derive(Clone, Debug)]
pub struct GridInfo {
    /// Name.
    pub name: String,
    /// Type of values and tree, for example `Tree_float_5_4_3`.
    pub tree: String,
    /// Class, for example `fog volume`; empty if the file names no class.
    pub class: String,
    /// Program that made the grid, or the file; empty if neither has one.
    pub creator: String,
    has_half_arrays: bool,
    unique_name: String,
    /// Unique name of the grid whose tree this one shares; empty for one with its own.
    parent: String,
    start: i64,
}

/// A file whose header was read.
pub struct VdbFile<'a> {
    bytes: &'a [u8],
    grids: Vec<GridInfo>,
}

/// Beginning of a grid: everything but its tree.
struct GridStart<'a> {
    compression: u32,
    class: String,
    creator: String,
    /// Bytes from the transform on.
    bytes: Bytes<'a>,
}

impl<'a> VdbFile<'a> {
    /// Reads the header, and the metadata of all grids.
    ///
    /// # Errors
    /// The reason, without the file's name.
    pub fn parse(all: &'a [u8]) -> Result<Self, String> {
        let mut bytes = Bytes::starting_at(all, 0)?;
        if !all.starts_with(&MAGIC) {
            return Err("this is no VDB file; expected one that OpenVDB has written".into());
        }
        bytes.take(MAGIC.len())?;
        let version = bytes.u32()?;
        if !VERSIONS.contains(&version) {
            let [first, last] = [VERSIONS.start(), VERSIONS.end()];
            return Err(format!("version {version} of the VDB format; expected {first} to {last} (OpenVDB 2 to 13)"));
        }
        // Version of the library.
        bytes.take(8)?;
        if bytes.u8()? == 0 {
            return Err("a stream without positions of its grids; expected a file of OpenVDB's io::File".into());
        }
        bytes.take(IDENTIFIER)?;
        let [_, creator] = metadata(&mut bytes, ["class", "creator"])?;
        let mut grids = Vec::new();
        for _ in 0..bytes.u32()? {
            let unique_name = bytes.string()?;
            let tree = bytes.string()?;
            let parent = bytes.string()?;
            let start = bytes.i64()?;
            let _start_of_leaves = bytes.i64()?;
            let end = bytes.i64()?;
            let next = Bytes::starting_at(all, end)?;
            if next.position() <= bytes.position() {
                return Err(format!("a grid is said to end at byte {end}; expected a later one"));
            }
            bytes = next;
            let found = start_of_grid(all, start)?;
            grids.push(GridInfo {
                name: unique_name.split(NAME_END).next().unwrap_or_default().into(),
                tree: tree.strip_suffix(HALF_ENDING).unwrap_or(&tree).into(),
                class: found.class,
                creator: if found.creator.is_empty() { creator.clone() } else { found.creator },
                has_half_arrays: tree.ends_with(HALF_ENDING),
                unique_name,
                parent,
                start,
            });
        }
        Ok(Self { bytes: all, grids })
    }

    /// Returns the grids in order.
    pub fn grids(&self) -> &[GridInfo] {
        &self.grids
    }

    /// Reads a grid of values of `N` numbers.
    ///
    /// # Errors
    /// The reason, which names the grid: values or a tree of another type, a transform that is not of cubes, damage.
    pub fn read<const N: usize>(&self, grid: &GridInfo) -> Result<SparseGrid<N>, String> {
        let name = |reason| format!("{}: {reason}", one_line(&grid.name));
        self.read_grid(grid).map_err(name)
    }

    fn read_grid<const N: usize>(&self, grid: &GridInfo) -> Result<SparseGrid<N>, String> {
        let (numbers, number) = grid.values()?;
        if numbers != N {
            return Err(format!("{numbers} numbers in each voxel; expected {N}"));
        }
        let mut start = start_of_grid(self.bytes, grid.start)?;
        let transform = transform(&mut start.bytes)?;
        let mut shares = grid;
        if !grid.parent.is_empty() {
            let parent = self.grids.iter().find(|other| other.unique_name == grid.parent && other.parent.is_empty());
            let refuse = || format!("it shares the tree of {}; expected a grid of this file", one_line(&grid.parent));
            shares = parent.filter(|parent| parent.tree == grid.tree).ok_or_else(refuse)?;
            start = start_of_grid(self.bytes, shares.start)?;
            skip_transform(&mut start.bytes)?;
        }
        let known = ZIP | ACTIVE_MASK | BLOSC;
        if start.compression & !known != 0 {
            return Err(format!("compression {}; expected Zip, Blosc or none", start.compression));
        }
        let in_arrays = if shares.has_half_arrays { Number::Half } else { number };
        let format = ValueFormat { number, in_arrays, compression: start.compression, background: [0.0; N] };
        TreeReader::read(start.bytes, format, transform)
    }
}

impl GridInfo {
    /// Returns the number of numbers in a value, and their type.
    fn values(&self) -> Result<(usize, Number), String> {
        let expected = "expected float, half, double or vectors of them, in a tree of 5, 4 and 3 levels";
        if self.has_points() {
            return Err("points; expected a volume: rasterize them, or export them as CSV or PLY for particles".into());
        }
        let parts: Vec<_> = self.tree.split('_').collect();
        let ["Tree", value, "5", "4", "3"] = parts[..] else {
            return Err(format!("{}; {expected}", one_line(&self.tree)));
        };
        match value {
            "half" => Ok((1, Number::Half)),
            "float" => Ok((1, Number::Float)),
            "double" => Ok((1, Number::Double)),
            "vec3h" => Ok((3, Number::Half)),
            "vec3s" => Ok((3, Number::Float)),
            "vec3d" => Ok((3, Number::Double)),
            _ => Err(format!("values of {}; {expected}", one_line(value))),
        }
    }

    /// Number of numbers in a value; 0 for values that are not read.
    pub fn numbers(&self) -> usize {
        self.values().map_or(0, |(numbers, _)| numbers)
    }

    /// True for points.
    pub fn has_points(&self) -> bool {
        self.tree.contains("ptdataidx") || self.tree.contains("ptidx")
    }

    /// Type for messages: `float`, `vec3s`, `points`.
    pub fn kind(&self) -> String {
        let value = self.tree.split('_').nth(1).unwrap_or_default();
        one_line(if self.has_points() { "points" } else { value })
    }
}

/// Reads the compression and the metadata of a grid.
fn start_of_grid(all: &[u8], start: i64) -> Result<GridStart<'_>, String> {
    let mut bytes = Bytes::starting_at(all, start)?;
    let compression = bytes.u32()?;
    let [class, creator] = metadata(&mut bytes, ["class", "creator"])?;
    Ok(GridStart { compression, class, creator, bytes })
}

/// Reads metadata, and returns the texts of some names; empty ones if they are not there.
fn metadata<const N: usize>(bytes: &mut Bytes<'_>, names: [&str; N]) -> Result<[String; N], String> {
    let mut found = [const { String::new() }; N];
    for _ in 0..bytes.u32()? {
        let name = bytes.string()?;
        let kind = bytes.string()?;
        let value = bytes.sized()?;
        if let Some(index) = names.iter().position(|known| *known == name && kind == "string") {
            found[index] = String::from_utf8_lossy(value).into_owned();
        }
    }
    Ok(found)
}

/// Reads past the transform of a grid whose tree another one shares.
fn skip_transform(bytes: &mut Bytes<'_>) -> Result<(), String> {
    let name = bytes.string()?;
    bytes.take(transform_size(&name)?).map(drop)
}

/// Bytes of a transform after its name.
fn transform_size(name: &str) -> Result<usize, String> {
    match name {
        "TranslationMap" => Ok(3 * 8),
        // A scale, and four vectors that follow from it.
        "ScaleMap" | "UniformScaleMap" => Ok(5 * 3 * 8),
        "ScaleTranslateMap" | "UniformScaleTranslateMap" => Ok(6 * 3 * 8),
        "AffineMap" | "UnitaryMap" => Ok(16 * 8),
        "NonlinearFrustumMap" => Err("a frustum of a camera; expected a grid in a box: resample it".into()),
        _ => Err(format!("the transform {}; expected a scale and a translation", one_line(name))),
    }
}

/// Reads a transform of a uniform scale and a translation.
fn transform(bytes: &mut Bytes<'_>) -> Result<GridTransform, String> {
    let name = bytes.string()?;
    let mut numbers = Vec::new();
    for _ in 0..transform_size(&name)? / 8 {
        numbers.push(bytes.f64()?);
    }
    let (scale, offset) = match (name.as_str(), &numbers[..]) {
        ("TranslationMap", offset) => (DVec3::ONE, vector(offset)),
        ("ScaleMap" | "UniformScaleMap", scale) => (vector(scale), DVec3::ZERO),
        // Four rows of four numbers; the last row is the translation.
        ("AffineMap" | "UnitaryMap", matrix) => {
            let is_off_diagonal = |index: &usize| !index.is_multiple_of(5) && *index < 12;
            let off_diagonal = (0..16).filter(is_off_diagonal).map(|index| matrix[index].abs()).fold(0.0, f64::max);
            let scale = DVec3::new(matrix[0], matrix[5], matrix[10]);
            if off_diagonal > CUBE_TOLERANCE * scale.abs().max_element() {
                return Err("turned or sheared voxels; expected a scale and a translation: resample it".into());
            }
            (scale, vector(&matrix[12..]))
        }
        (_, both) => (vector(&both[3..]), vector(both)),
    };
    let voxel = scale.x;
    let is_cube = (scale - voxel).abs().max_element() <= CUBE_TOLERANCE * voxel.abs();
    // A transform that is not of a sensible size would overflow in later arithmetic.
    let is_sensible = (1.0e-9..1.0e9).contains(&voxel) && offset.abs().max_element() < 1.0e12;
    if !is_cube || !is_sensible {
        return Err(format!("voxels of {} x {} x {} at {offset}; expected cubes", scale.x, scale.y, scale.z));
    }
    Ok(GridTransform { voxel, offset })
}

/// Returns the first three numbers; 0 where there are fewer.
fn vector(numbers: &[f64]) -> DVec3 {
    let [x, y, z] = [0, 1, 2].map(|index| numbers.get(index).copied().unwrap_or_default());
    DVec3::new(x, y, z)
}
