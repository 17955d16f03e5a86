//! Export of images, sequences and sheets. A worker thread renders them as the command line does, while editing goes
//! on.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use eframe::egui;
use glam::UVec2;
use haze::preset::Preset;
use haze::settings::set_field;
use haze::{Error, FieldError};
use haze_demo::shot::Shot;
use image::RgbImage;

use super::value_spread::spread_values;
use crate::backend::Backend;
use crate::debug_view_sheet;
use crate::frame_range::FrameNames;
use crate::tweak::platform::file_io::{CompressionEffort, write_png};
use crate::tweak::platform::render_job::{ExportProgress, Frames};
use crate::tweak::platform::worker::{Ticket, Worker};
use crate::tweak::platform::{file_io, render_job};
use crate::tweak::session::Session;
use crate::tweak::session::macro_param::MacroParam;

/// Kind of export.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExportKind {
    Image,
    Sequence,
    Flipbook,
    Gif,
    DebugView,
    /// Sheet of nine seeds.
    Seeds,
    /// Sheet of one field at several values; holds the path of the field.
    Values(String),
}

/// Parameters of an export.
#[derive(Clone, Debug)]
pub struct ExportOptions {
    /// Size of an image in pixels. For a sheet: the size of all its cells together.
    pub size: UVec2,
    pub first: u32,
    pub last: u32,
    /// Frames per second.
    pub rate: f32,
    /// Rows (`x`) and columns (`y`) of a flipbook.
    pub cells: UVec2,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self { size: UVec2::new(1280, 720), first: 0, last: 31, rate: 25.0, cells: UVec2::new(4, 8) }
    }
}

/// Longest side of an image, pixels.
pub const MAX_PIXELS: u32 = 8192;

/// Export jobs, and the state of the export dialog.
pub struct ExportJob {
    worker: Worker<ExportResult>,
    progress: Arc<Progress>,
    pub is_open: bool,
    pub product: ExportKind,
    pub options: ExportOptions,
    /// Search text for the field to vary.
    pub wanted: String,
    /// Finished sheet that is shown.
    pub sheet: Option<Sheet>,
}

/// Finished sheet.
pub struct Sheet {
    pub picture: RgbImage,
    /// Path to save it under.
    path: PathBuf,
    /// GPU texture, made when the sheet is first shown.
    pub texture: Option<egui::TextureHandle>,
}

#[derive(Default)]
struct Progress {
    done: AtomicU32,
    count: AtomicU32,
    is_stopped: AtomicBool,
}

enum ExportResult {
    Written(PathBuf),
    Sheet(RgbImage, PathBuf),
    Failed(Error),
}

impl ExportJob {
    /// `wake` is called from the worker thread when a result is ready.
    ///
    /// # Errors
    /// [`Error::Io`] if the system cannot start another thread.
    pub fn new(wake: impl Fn() + Send + 'static) -> Result<Self, Error> {
        let worker = Worker::new("haze export", wake);
        let worker = worker.map_err(|error| Error::Io { path: "a thread to export".into(), error })?;
        Ok(Self {
            worker,
            progress: Arc::default(),
            is_open: false,
            product: ExportKind::Sequence,
            options: ExportOptions::default(),
            wanted: String::new(),
            sheet: None,
        })
    }

    /// Returns the number of finished images and of all images while an export runs.
    pub fn progress(&self) -> Option<(u32, u32)> {
        let read = |number: &AtomicU32| number.load(Ordering::Relaxed);
        self.worker.is_busy().then(|| (read(&self.progress.done), read(&self.progress.count)))
    }

    /// Stops the running export. Every file that is already there is complete.
    pub fn stop(&self) {
        self.progress.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Starts an export of the current view.
    pub fn begin(&mut self, product: ExportKind, session: &mut Session) {
        if self.worker.is_busy() {
            return session.messages.error("export", "an export is running; stop it or wait for it");
        }
        let mut size = self.options.size;
        if product == ExportKind::Image {
            // A single image has the aspect ratio of the viewport.
            size.x = ((size.y as f32 * session.view.aspect).round() as u32).clamp(1, MAX_PIXELS);
        }
        let shot = session.shot(size);
        let place = ExportPath::new(session.document.path(), &shot.preset);
        let progress = Arc::<Progress>::default();
        self.progress = Arc::clone(&progress);
        let (options, shaders) = (self.options.clone(), session.shaders.clone());
        self.worker.submit_async(async move |ticket: Ticket| {
            let go_on = |done, count| {
                progress.done.store(done, Ordering::Relaxed);
                progress.count.store(count, Ordering::Relaxed);
                !progress.is_stopped.load(Ordering::Relaxed) && !ticket.is_cancelled()
            };
            let progress = ExportProgress::Callback(&go_on);
            let made = match render_job::open_backend(shaders.as_ref()) {
                Ok(backend) => make(&backend, &product, &shot, &options, &place, &progress).await,
                Err(error) => Err(error),
            };
            made.unwrap_or_else(ExportResult::Failed)
        });
    }

    /// Closes the sheet, or else the export dialog. Returns true if either was open.
    pub fn dismiss(&mut self) -> bool {
        self.sheet.take().is_some() || std::mem::take(&mut self.is_open)
    }

    /// Writes the shown sheet to its file and closes it.
    pub fn save_sheet(&mut self) {
        if let Some(Sheet { picture, path, .. }) = self.sheet.take() {
            self.worker.submit(move |_| write(path, picture).unwrap_or_else(ExportResult::Failed));
        }
    }

    /// Reports finished exports. Call once a frame.
    pub fn advance(&mut self, session: &mut Session) {
        while let Some(done) = self.worker.poll() {
            match done {
                Some(ExportResult::Written(path)) => {
                    session.messages.info("export", format!("written: {}", path.display()));
                    file_io::offer_download(&path);
                }
                Some(ExportResult::Sheet(picture, path)) => self.sheet = Some(Sheet { picture, path, texture: None }),
                Some(ExportResult::Failed(error)) => session.messages.error("export", error),
                None => session.messages.error("export", "nothing exported: internal error on the export thread"),
            }
        }
    }
}

/// Folder and name prefix of exported files.
struct ExportPath {
    folder: PathBuf,
    stem: String,
}

impl ExportPath {
    /// Uses the folder of the preset's file, and the preset's name and time.
    fn new(document: &Path, preset: &Preset) -> Self {
        let plain = |c: char| if c.is_alphanumeric() || c == '-' { c } else { '_' };
        let name: String = preset.name.chars().map(plain).take(60).collect();
        let folder = document.parent().unwrap_or(Path::new("")).to_owned();
        Self { folder, stem: format!("{name}_{:.2}s", preset.time) }
    }

    /// Returns a path that does not exist yet.
    fn free(&self, what: &str, end: &str) -> PathBuf {
        let what = if what.is_empty() { String::new() } else { format!("_{what}") };
        let name = |number| match number {
            1 => format!("{}{what}{end}", self.stem),
            _ => format!("{}{what}_{number}{end}", self.stem),
        };
        let paths = (1..10_000).map(|number| self.folder.join(name(number)));
        let path = paths.into_iter().find(|path| !file_io::is_taken(path)).unwrap_or_else(|| self.folder.join(name(1)));
        file_io::absolute(&path)
    }
}

fn write(path: PathBuf, picture: RgbImage) -> Result<ExportResult, Error> {
    write_png(&path, &picture.into(), CompressionEffort::Quick)?;
    Ok(ExportResult::Written(path))
}

async fn make(
    backend: &Backend,
    product: &ExportKind,
    shot: &Shot,
    options: &ExportOptions,
    place: &ExportPath,
    watch: &ExportProgress<'_>,
) -> Result<ExportResult, Error> {
    let frames = Frames { range: options.first..=options.last.max(options.first), rate: options.rate };
    let sheet = async |name: &str, cells: Vec<(String, Shot)>| {
        let path = place.free(name, ".png");
        let columns = render_job::column_count(cells.len());
        let size = (shot.size / columns).max(UVec2::ONE);
        let small = |(label, shot): (String, Shot)| (label, Shot { size, ..shot });
        let cells: Vec<_> = cells.into_iter().map(small).collect();
        let mut sheet = render_job::render_sheet(backend, &cells, columns, &path, watch).await?;
        sheet.add_footer(&format!("{name}; {}, {}", shot.preset.name, backend.description()));
        Ok(ExportResult::Sheet(sheet.picture, path))
    };
    match product {
        ExportKind::Image => {
            let path = place.free("", ".png");
            let one = Frames { range: 0..=0, rate: 1.0 };
            let picture = render_job::render_flipbook(backend, shot, &one, UVec2::ONE, &path, watch).await?;
            write(path, picture)
        }
        ExportKind::Sequence => {
            let folder = place.free("frames", "");
            file_io::make_folder(&folder)?;
            let names = FrameNames::parse(&folder.join("%04d.png"))?;
            render_job::write_sequence(backend, shot, &frames, &names, CompressionEffort::Quick, watch).await?;
            Ok(ExportResult::Written(folder))
        }
        ExportKind::Flipbook => {
            render_job::check_flipbook(shot.size, &frames, options.cells)?;
            let path = place.free("flipbook", ".png");
            let picture = render_job::render_flipbook(backend, shot, &frames, options.cells, &path, watch).await?;
            write(path, picture)
        }
        ExportKind::Gif => {
            let path = place.free("", ".gif");
            render_job::write_gif(backend, shot, &frames, &path, watch).await?;
            Ok(ExportResult::Written(path))
        }
        ExportKind::DebugView => sheet("shade_tree", debug_view_sheet::stages(shot)).await,
        ExportKind::Seeds => sheet("seeds", seeds(shot)).await,
        ExportKind::Values(path) => {
            let cells = variations(shot, path);
            if cells.is_empty() {
                return Err(FieldError::new("export", path, "a number, a choice, or an on/off setting").into());
            }
            sheet(path.rsplit('.').next().unwrap_or(path), cells).await
        }
    }
}

/// Returns nine shots: with the present seed and the eight after it.
fn seeds(shot: &Shot) -> Vec<(String, Shot)> {
    let with = |more: u32| {
        let mut shot = shot.clone();
        for system in &mut shot.preset.systems {
            system.emitter.seed = system.emitter.seed.wrapping_add(more);
        }
        let seed = shot.preset.systems.first().map_or(more, |system| system.emitter.seed);
        (format!("seed {seed}"), shot)
    };
    (0..9).map(with).collect()
}

/// Returns shots with a field at the values of its [`spread_values`], without those that are not valid.
fn variations(shot: &Shot, path: &str) -> Vec<(String, Shot)> {
    let with = |text: String| {
        let mut shot = shot.clone();
        match MacroParam::find(path) {
            Some((system, made)) => (made.set)(shot.preset.systems.get_mut(system)?, text.parse().ok()?),
            None => drop(set_field(&mut shot.preset, path, &text).ok()?),
        }
        shot.preset.validate().ok()?;
        Some((text, shot))
    };
    spread_values(&shot.preset, path).into_iter().filter_map(with).collect()
}

#[cfg(test)]
mod tests;
