//! Files of a sequence, the frames of the sheet among them, and their recording.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::UVec2;
use haze_core::assets::bounded_read;
use haze_core::error::{AssetError, FieldError};
use haze_preset::UpAxis;

use super::super::bake::Recording;
use super::super::framing::Window;
use super::super::recorded_frame::Extent;
use super::super::sim_recipe::{DEFAULT_BLEND, FrameLoop, View};
use super::cell_grid::{Axes, Bounds, CellGrid, Scales};
use super::frame_grids::{FrameGrids, GridNames};
use super::heat_scale::HeatScale;
use crate::sprite::bake::SheetLayout;
use crate::vdb::{GridTransform, MAX_FILE_BYTES, VdbFile};

/// Fraction of the largest density of a frame below which smoke does not enlarge the box.
const MIN_DENSITY: f32 = 1.0e-3;
/// Most frames of a sheet without given columns and rows.
const MAX_FRAMES: u32 = 64;
/// Programs by a part of the name that they give as creator, and the axis that points up in their files.
const CREATORS: [(&str, UpAxis); 5] = [
    ("blender", UpAxis::Z),
    ("mantaflow", UpAxis::Z),
    ("houdini", UpAxis::Y),
    ("embergen", UpAxis::Y),
    ("haze", UpAxis::Y),
];

/// Files of volumes, one per frame.
#[derive(Clone, Debug)]
pub struct VolumeSequence {
    pub(super) path: PathBuf,
    /// Numbers of the frames, in order, and their files.
    pub(super) files: Vec<(u32, PathBuf)>,
}

/// Choices of a bake.
#[derive(Clone, Debug)]
pub struct VolumeOptions {
    /// Name of the grid of the smoke.
    pub density: String,
    /// Axis of the files that points up. `None`: by the program that wrote them.
    pub up: Option<UpAxis>,
    /// Most cells along a side of the box around the smoke.
    pub resolution: u32,
    /// Frames per second, by which velocities move smoke from one frame to the next.
    pub fps: f32,
    /// Frames on the sheet.
    pub sheet: SheetLayout,
    /// End of the flipbook.
    pub frame_loop: FrameLoop,
    /// Appearance of the smoke.
    pub view: View,
}

impl Default for VolumeOptions {
    fn default() -> Self {
        Self {
            density: "density".into(),
            up: None,
            resolution: 192,
            fps: 24.0,
            sheet: SheetLayout::default(),
            frame_loop: FrameLoop::Once,
            view: View::default(),
        }
    }
}

/// Smoke of a sequence, and lines that say what was read.
pub struct VolumeRecording {
    /// Frames to bake.
    pub recording: Recording,
    /// Lines for a user.
    pub notes: Vec<String>,
}

/// Properties of all frames.
struct Summary {
    names: GridNames,
    up: UpAxis,
    up_note: String,
    transform: GridTransform,
    bounds: Bounds,
    density: f32,
    heat: f32,
    has_heat: bool,
}

impl VolumeSequence {
    /// Finds one file, or those of a sequence if the file name contains `#` instead of the frame number's digits.
    ///
    /// # Errors
    /// [`AssetError::Io`] if there are none.
    pub fn find(path: &Path) -> Result<Self, AssetError> {
        Ok(Self { path: path.into(), files: haze_preset::frame_files(path)? })
    }

    /// Returns the files in order.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|(_, file)| file.as_path())
    }

    /// Returns the number of frames from the first to the last, missing ones included.
    pub fn frame_count(&self) -> u32 {
        match (self.files.first(), self.files.last()) {
            (Some((first, _)), Some((last, _))) => (last - first).saturating_add(1),
            _ => 0,
        }
    }

    /// Returns the numbers of the frames that are missing between others, as `3, 7 to 9`; `None` if all are there.
    pub fn missing(&self) -> Option<String> {
        let gap = |pair: &[(u32, PathBuf)]| match [pair[0].0 + 1, pair[1].0 - 1] {
            [first, last] if first > last => None,
            [first, last] if first == last => Some(first.to_string()),
            [first, last] => Some(format!("{first} to {last}")),
        };
        let gaps: Vec<_> = self.files.windows(2).filter_map(gap).collect();
        (!gaps.is_empty()).then(|| gaps.join(", "))
    }

    /// Returns the columns and rows of a sheet for as many frames as there are, at most 64.
    pub fn default_grid(&self, frame_loop: FrameLoop) -> UVec2 {
        let fits = |frames: u32| frames + frame_loop.blended_frames(frames, DEFAULT_BLEND) <= self.frame_count();
        // Near-square sheets; of few frames also a single row.
        let grid = |frames: u32| {
            let columns =
                (1..=frames).find(|columns| columns * columns >= frames && frames.is_multiple_of(*columns))?;
            let rows = frames / columns;
            (columns <= 2 * rows || frames <= 3).then_some(UVec2::new(columns, rows))
        };
        (1..=MAX_FRAMES).rev().filter(|frames| fits(*frames)).find_map(grid).unwrap_or(UVec2::ONE)
    }

    /// Returns the files of the moments of the sheet, evenly spaced. For a missing frame, that is the one before.
    pub(super) fn moments(&self, options: &VolumeOptions) -> Result<Vec<&Path>, FieldError> {
        let frames = options.sheet.frame_count();
        let moments = frames + options.frame_loop.blended_frames(frames, DEFAULT_BLEND);
        let span = self.frame_count();
        if moments > span {
            let problem = format!("{moments} frames from {span}");
            return Err(FieldError::from_problem("columns and rows", problem, format!("at most {span}")));
        }
        let first = self.files.first().map_or(0, |(first, _)| *first);
        let file = |moment: u32| {
            let number = first + (u64::from(moment) * u64::from(span) / u64::from(moments)) as u32;
            let after = self.files.partition_point(|(other, _)| *other <= number);
            self.files.get(after.checked_sub(1)?).map(|(_, file)| file.as_path())
        };
        Ok((0..moments).filter_map(file).collect())
    }

    /// Returns the number of files that [`Self::record`] reads, twice each.
    ///
    /// # Errors
    /// [`FieldError`] if the sheet has more frames than there are.
    pub fn step_count(&self, options: &VolumeOptions) -> Result<u32, FieldError> {
        Ok(2 * self.moments(options)?.len() as u32)
    }

    /// Reads the frames of the sheet. `progress` is called with the number of finished steps, of
    /// [`Self::step_count`]; an error from it cancels the work.
    ///
    /// # Errors
    /// Those of `progress`; [`FieldError`] if the sheet has more frames than there are; [`AssetError::Io`] and
    /// [`AssetError::Image`] name the file, the grid, and what would be right.
    pub fn record<E: From<AssetError>>(
        &self,
        options: &VolumeOptions,
        progress: impl Fn(u32) -> Result<(), E>,
    ) -> Result<VolumeRecording, E> {
        let moments = self.moments(options).map_err(AssetError::from)?;
        let mut summary: Option<Summary> = None;
        let mut scanned = BTreeSet::new();
        for (done, file) in (0..).zip(&moments) {
            progress(done)?;
            // Missing frames repeat a file.
            if scanned.insert(*file) {
                with_grids(file, options, |grids| Summary::add(&mut summary, grids, options))?;
            }
        }
        let summary = summary.filter(|summary| summary.density > 0.0).ok_or_else(|| {
            let reason = format!("{}: no value above 0 in any frame; expected smoke", options.density);
            AssetError::Image { path: self.path.clone(), reason }
        })?;
        let count = moments.len() as u32;
        let Summary { transform, bounds, up, .. } = summary;
        let cells = CellGrid::new(bounds, transform, Axes(up), options.resolution, count);
        let scales = Scales { density: summary.density, heat: HeatScale::of_largest(summary.heat) };
        let mut frames = Vec::new();
        for (done, file) in (count..).zip(&moments) {
            progress(done)?;
            frames.push(with_grids(file, options, |grids| Ok(cells.record(&grids.read()?, scales, &options.view)))?);
        }
        progress(2 * count)?;
        let extent = frames.iter().map(|frame| frame.extent).fold(Extent::EMPTY, Extent::union);
        let frames_per_moment = if count > 1 { self.frame_count() as f32 / count as f32 } else { 0.0 };
        let recording = Recording {
            sheet: options.sheet,
            view: options.view.clone(),
            frames,
            seconds_per_frame: frames_per_moment / options.fps,
            has_velocity: !summary.names.velocity.is_empty(),
            has_heat: summary.has_heat,
            fine: cells.domain,
            window: Window::new(&options.view, cells.domain, false, extent),
        };
        Ok(VolumeRecording { recording, notes: self.notes(&summary, &cells, count) })
    }

    fn notes(&self, summary: &Summary, cells: &CellGrid, moments: u32) -> Vec<String> {
        let GridNames { density, heat, velocity, unread } = &summary.names;
        let mut read = format!("smoke from {density}, of which {} is 1", summary.density);
        if !heat.is_empty() {
            read += &format!("; heat from {heat}{}", HeatScale::of_largest(summary.heat).description());
        }
        if !velocity.is_empty() {
            read += &format!("; motion from {velocity}");
        }
        let size = cells.domain.grid.size;
        let voxels = match cells.voxels_per_cell {
            1 => "a voxel".into(),
            voxels => format!("{voxels} voxels along each side"),
        };
        let mut notes = vec![read, summary.up_note.clone()];
        notes.push(format!("{}x{}x{} cells of {voxels}", size.x, size.y, size.z));
        if self.frame_count() > moments {
            notes.push(format!("{moments} of {} frames, evenly spaced", self.frame_count()));
        }
        if !unread.is_empty() {
            notes.push(format!("not read: {}", unread.join(", ")));
        }
        notes
    }
}

impl Summary {
    /// Adds a frame. The first one decides the axes.
    fn add(summary: &mut Option<Self>, grids: &FrameGrids<'_>, options: &VolumeOptions) -> Result<(), String> {
        let (density, heat) = grids.read_smoke()?;
        let names = grids.names();
        let summary = summary.get_or_insert_with(|| {
            let (up, up_note) = up_axis(options.up, grids.creator());
            Self {
                names: names.clone(),
                up,
                up_note,
                transform: density.transform,
                bounds: Bounds::EMPTY,
                density: 0.0,
                heat: 0.0,
                has_heat: false,
            }
        });
        // A frame without smoke may lack grids.
        for (known, name) in [(&mut summary.names.heat, names.heat), (&mut summary.names.velocity, names.velocity)] {
            if known.is_empty() {
                *known = name;
            }
        }
        let axes = Axes(summary.up);
        let largest = density.max();
        summary.density = summary.density.max(largest);
        summary.bounds = summary.bounds.union(Bounds::of_grid(&density, largest * MIN_DENSITY, axes));
        if let Some(heat) = heat {
            summary.has_heat = true;
            let largest = heat.max();
            summary.heat = summary.heat.max(largest);
            if options.view.flame > 0.0 {
                summary.bounds = summary.bounds.union(Bounds::of_grid(&heat, largest * MIN_DENSITY, axes));
            }
        }
        Ok(())
    }
}

/// Reads a file, and calls `f` with its grids.
fn with_grids<T>(
    path: &Path,
    options: &VolumeOptions,
    f: impl FnOnce(&FrameGrids<'_>) -> Result<T, String>,
) -> Result<T, AssetError> {
    let content = bounded_read::read(path, "VDB file", MAX_FILE_BYTES)?;
    let of_content = || {
        let file = VdbFile::parse(&content)?;
        f(&FrameGrids::find(&file, &options.density)?)
    };
    of_content().map_err(|reason| AssetError::Image { path: path.into(), reason })
}

/// Returns the axis that points up, and a line that says why.
fn up_axis(given: Option<UpAxis>, creator: &str) -> (UpAxis, String) {
    if let Some(up) = given {
        return (up, format!("up is {}, as --up says", up.name()));
    }
    let creator_name = creator.to_ascii_lowercase();
    match CREATORS.into_iter().find(|(name, _)| creator_name.contains(name)) {
        Some((name, up)) => (up, format!("up is {}, as {name} writes", up.name())),
        None => {
            let up = UpAxis::default();
            let note = format!("up is {}, because the file names no program that is known; --up z for z", up.name());
            (up, note)
        }
    }
}
