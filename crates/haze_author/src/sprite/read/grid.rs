//! Columns and rows of frames on a sheet, and the frames that are not clear.
//!
//! Frames resemble the frames beside them, and gaps between them are clear: a sheet that is moved by one frame looks like
//! itself, and lines between frames cross little smoke. Of grids for which both hold, the finest is right, because a
//! coarser one would have several puffs in a frame.

use glam::UVec2;
use haze_core::assets::image::Image;
use haze_core::assets::sprite::MAX_FRAMES;

use super::answer::Answer;
use super::file_name::grid_of;
use super::frame_grid::FrameGrid;
use super::sheet_file::SheetFile;

/// Smallest side of a frame that is looked for, texels.
const MIN_FRAME: u32 = 8;
/// Most columns or rows that are looked for.
const MAX_CELLS: u32 = 64;

/// Smoke on a sheet by how far each texel is from clear: alpha, or the difference from the color of clear texels.
pub(super) fn activity(file: &SheetFile) -> Image<f32> {
    let background = file.background();
    let mut activity = Image::new(file.size(), 0.0);
    activity.for_each(|at, value| {
        let [r, g, b, a] = file.image.get_pixel(at.x, at.y).0;
        let off = [r, g, b].into_iter().zip(background).map(|(code, clear)| code.abs_diff(clear)).max();
        *value = f32::from(if file.has_alpha { a } else { off.unwrap_or(0) }) / 255.0;
    });
    activity
}

/// Finds columns and rows. Names of files, as `_8x8`, decide between grids that are nearly as good.
pub(super) fn find_cells(activity: &Image<f32>, files: &[SheetFile]) -> Answer<UVec2> {
    let size = activity.size;
    let columns = scores(activity);
    let rows = scores(&transposed(activity));
    let named: Vec<_> = files.iter().filter_map(|file| grid_of(&file.stem())).collect();
    let mut grids: Vec<(UVec2, f32)> = Vec::new();
    for &(x, of_x) in &columns {
        for &(y, of_y) in &rows {
            let cells = UVec2::new(x, y);
            let is_square = size.x / x == size.y / y;
            let is_named = named.contains(&cells);
            let score = of_x + of_y + if is_square { 0.3 } else { 0.0 } + if is_named { 0.6 } else { 0.0 };
            if cells.element_product() <= MAX_FRAMES {
                grids.push((cells, score));
            }
        }
    }
    let best = grids.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((cells, score)) = best else { return Answer::found(UVec2::ONE, 0.0) };
    // A coarser grid explains no less, but puts several puffs in a frame.
    let is_coarser = |other: UVec2| (cells % other) == UVec2::ZERO;
    let rivals = grids.iter().filter(|(other, _)| !is_coarser(*other)).map(|(_, score)| *score);
    let second = rivals.fold(0.0, f32::max);
    Answer::found(cells, ((score - second) / 0.5).min(score))
}

fn transposed(image: &Image<f32>) -> Image<f32> {
    let mut turned = Image::new(UVec2::new(image.size.y, image.size.x), 0.0);
    turned.for_each(|at, value| *value = image.texels[(at.x * image.size.x + at.y) as usize]);
    turned
}

/// Scores every number of columns that divides the width.
fn scores(activity: &Image<f32>) -> Vec<(u32, f32)> {
    let side = activity.size.x;
    let counts =
        (1..=MAX_CELLS).filter(|&count| side.is_multiple_of(count) && (count == 1 || side / count >= MIN_FRAME));
    let lines = line_means(activity);
    counts.map(|count| (count, score(activity, &lines, count))).collect()
}

/// Mean activity of every column of texels.
fn line_means(activity: &Image<f32>) -> Vec<f32> {
    let width = activity.size.x as usize;
    let mut sums = vec![0.0; width];
    for row in activity.texels.chunks(width) {
        sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
    }
    sums.iter_mut().for_each(|sum| *sum /= activity.size.y as f32);
    sums
}

/// Score of a number of columns: the resemblance of neighbors, less the smoke in the gaps, and a little for fineness.
fn score(activity: &Image<f32>, lines: &[f32], count: u32) -> f32 {
    let width = activity.size.x as usize;
    let period = width / count as usize;
    let mean = lines.iter().sum::<f32>() / width as f32;
    let edges = (0..count as usize).flat_map(|cell| [cell * period, (cell + 1) * period - 1]);
    let in_gaps = edges.map(|line| lines[line]).sum::<f32>() / (2 * count) as f32;
    let gap = in_gaps / mean.max(1.0e-6);
    if count == 1 {
        // Nothing to compare with.
        return 0.2 - 0.5 * gap;
    }
    correlation(activity, period) - 1.5 * gap + 0.03 * (count as f32).log2()
}

/// Correlation of an image with itself, moved to the left by a number of texels.
fn correlation(activity: &Image<f32>, period: usize) -> f32 {
    let width = activity.size.x as usize;
    // Every fourth row: smoke is smooth.
    let rows = || activity.texels.chunks(width).step_by(if activity.size.y > 256 { 4 } else { 1 });
    let [mut n, mut a, mut b, mut aa, mut bb, mut ab] = [0.0_f64; 6];
    for row in rows() {
        let [mut row_a, mut row_b, mut row_aa, mut row_bb, mut row_ab] = [0.0_f32; 5];
        for (&near, &far) in row.iter().zip(&row[period..]) {
            row_a += near;
            row_b += far;
            row_aa += near * near;
            row_bb += far * far;
            row_ab += near * far;
        }
        n += (width - period) as f64;
        a += f64::from(row_a);
        b += f64::from(row_b);
        aa += f64::from(row_aa);
        bb += f64::from(row_bb);
        ab += f64::from(row_ab);
    }
    let variance = |square: f64, sum: f64| square / n - (sum / n).powi(2);
    let spread = (variance(aa, a) * variance(bb, b)).max(0.0).sqrt();
    let covariance = ab / n - a * b / (n * n);
    if spread > 1.0e-9 { (covariance / spread) as f32 } else { 0.0 }
}

/// Counts the frames up to the last one that is not clear.
pub(super) fn count_frames(activity: &Image<f32>, grid: &FrameGrid) -> Answer<u32> {
    let size = activity.size / grid.cells;
    let brightest = |frame: u32| {
        let origin = grid.cell(frame) * size;
        let rows = (origin.y..origin.y + size.y).map(|y| (y * activity.size.x + origin.x) as usize);
        rows.flat_map(|start| &activity.texels[start..start + size.x as usize]).copied().fold(0.0, f32::max)
    };
    let cells = grid.cells.element_product();
    let last = (0..cells).rev().find(|&frame| brightest(frame) > 0.02);
    let count = last.map_or(cells, |last| last + 1);
    // Cells that hold nothing at all are no frames; faint ones at the end may be those of smoke that fades.
    let after = (count..cells).map(brightest).fold(0.0, f32::max);
    Answer::found(count, if after > 0.0 { 0.6 } else { 1.0 })
}
