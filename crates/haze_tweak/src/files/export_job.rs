//! Export of images, sequences and sheets. A worker thread renders them as the command line does, while editing goes
//! on.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use eframe::egui;
use glam::UVec2;
use haze::FieldError;
use haze_core::error::{AssetError, Error};
use haze_demo::shot::Shot;
use haze_export::backend::Backend;
use haze_export::debug_view_sheet;
use haze_export::frame_range::FrameNames;
use image::{DynamicImage, RgbImage};

use super::value_spread::spread_values;
use crate::document::display_names::display_name;
use crate::platform::file_io::{CompressionEffort, write_png};
use crate::platform::render_job::{
    Engine, EngineFlipbook, ExportProgress, FlipbookChoices, Frames, ImageFormat, SCENE,
};
use crate::platform::worker::{Ticket, Worker};
use crate::platform::{IS_PAGE, file_io, render_job};
use crate::session::Session;
use crate::session::macro_param::MacroParam;

/// Kind of export.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExportKind {
    Image,
    Sequence,
    Flipbook,
    Gif,
    /// Sheets of color, normals, motion vectors and fire, for an engine. Not on a page.
    EngineFlipbook,
    /// Ramps and lighting formula of the selected system, for an engine. Not on a page.
    Material,
    DebugView,
    /// Sheet of nine seeds.
    Seeds,
    /// Sheet of one field at several values; holds the path of the field.
    Values(String),
}

impl ExportKind {
    /// Returns true for sheets, which are shown before they are saved.
    pub fn is_sheet(&self) -> bool {
        matches!(self, Self::DebugView | Self::Seeds | Self::Values(_))
    }

    /// Returns what the name of the file says about its content, and the ending.
    fn file_ending(&self, file: FileKind) -> (&str, &'static str) {
        match self {
            Self::Image => ("", file.ending()),
            Self::Sequence => ("frames", ""),
            Self::Flipbook => ("flipbook", ".png"),
            Self::Gif => ("", ".gif"),
            Self::EngineFlipbook => ("engine_flipbook", ""),
            Self::Material => ("material", ""),
            Self::DebugView => ("debug_views", ".png"),
            Self::Seeds => ("seeds", ".png"),
            Self::Values(path) => (path.rsplit('.').next().unwrap_or(path), ".png"),
        }
    }
}

/// Kind of the files of images and sequences.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileKind {
    #[default]
    Png,
    /// Not on a page.
    Exr,
}

impl FileKind {
    fn ending(self) -> &'static str {
        match self {
            Self::Png => ".png",
            Self::Exr => ".exr",
        }
    }
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
    /// Size of a frame of a flipbook for an engine, pixels.
    pub frame_size: UVec2,
    pub file: FileKind,
    pub format: ImageFormat,
    /// Of a material, and of a flipbook for an engine.
    pub engine: Engine,
    pub engine_flipbook: FlipbookChoices,
    /// System of a material. The selected one, when the export begins.
    pub system: usize,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            size: UVec2::new(1280, 720),
            first: 0,
            last: 31,
            rate: 25.0,
            cells: UVec2::new(4, 8),
            frame_size: UVec2::splat(256),
            file: FileKind::default(),
            format: ImageFormat::default(),
            engine: Engine::default(),
            engine_flipbook: FlipbookChoices::default(),
            system: 0,
        }
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
    /// Folder of the last export.
    pub folder: Option<PathBuf>,
    /// Export that waits for the user's choice of a path.
    waiting: Option<Waiting>,
    /// Suggested path, until the user is asked.
    question: Option<PathBuf>,
}

/// Export that waits for a path.
enum Waiting {
    Export(ExportKind),
    /// The shown sheet.
    Sheet,
}

/// Finished sheet.
pub struct Sheet {
    pub image: RgbImage,
    /// Kind, for the name of its file.
    kind: ExportKind,
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
    Sheet(RgbImage, ExportKind),
    Failed(Error),
}

impl ExportJob {
    /// `wake` is called from the worker thread when a result is ready. `folder` is that of the last export.
    ///
    /// # Errors
    /// [`AssetError::Io`] if the system cannot start another thread.
    pub fn new(wake: impl Fn() + Send + 'static, folder: Option<PathBuf>) -> Result<Self, Error> {
        let worker = Worker::new("haze export", wake);
        let worker =
            worker.map_err(|error| Error::from(AssetError::Io { path: "a thread to export".into(), error }))?;
        Ok(Self {
            worker,
            progress: Arc::default(),
            is_open: false,
            product: ExportKind::Sequence,
            options: ExportOptions::default(),
            wanted: String::new(),
            sheet: None,
            folder,
            waiting: None,
            question: None,
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

    /// Starts an export of the current view. A sheet is made at once; for anything else, the user is asked for a path.
    /// On a page, the browser downloads the file.
    pub fn start(&mut self, product: ExportKind, session: &mut Session) {
        if self.worker.is_busy() {
            session.messages.error("export", "An export is running. Stop it, or wait until it ends.");
        } else if product.is_sheet() {
            // It has no path yet.
            self.begin(product, PathBuf::new(), session);
        } else {
            self.ask(Waiting::Export(product), session);
        }
    }

    /// Asks where to save the shown sheet.
    pub fn save_sheet(&mut self, session: &mut Session) {
        self.ask(Waiting::Sheet, session);
    }

    fn ask(&mut self, waiting: Waiting, session: &mut Session) {
        let kind = match (&waiting, &self.sheet) {
            (Waiting::Export(kind), _) => kind,
            (Waiting::Sheet, Some(sheet)) => &sheet.kind,
            (Waiting::Sheet, None) => return,
        };
        let (content, ending) = kind.file_ending(self.options.file);
        let suggested = free_path(self.folder.as_deref(), session, content, ending);
        self.waiting = Some(waiting);
        if IS_PAGE {
            self.answer(Some(suggested), session);
        } else {
            self.question = Some(suggested);
        }
    }

    /// Returns the path to suggest to the user, once.
    pub fn take_question(&mut self) -> Option<PathBuf> {
        self.question.take()
    }

    /// Continues with the path that the user has chosen; `None` cancels the export.
    pub fn answer(&mut self, path: Option<PathBuf>, session: &mut Session) {
        let Some((waiting, path)) = self.waiting.take().zip(path) else { return };
        self.folder = path.parent().map(Path::to_owned);
        match waiting {
            Waiting::Export(kind) => {
                let path = with_ending(path, kind.file_ending(self.options.file).1);
                self.begin(kind, path, session);
            }
            Waiting::Sheet => {
                if let Some(Sheet { image, .. }) = self.sheet.take() {
                    let path = with_ending(path, ".png");
                    self.worker.submit(move |_| write(path, image).unwrap_or_else(ExportResult::Failed));
                }
            }
        }
    }

    fn begin(&mut self, product: ExportKind, path: PathBuf, session: &Session) {
        let is_for_engine = product == ExportKind::EngineFlipbook;
        let mut size = if is_for_engine { self.options.frame_size } else { self.options.size };
        if product == ExportKind::Image {
            // A single image has the aspect ratio of the viewport.
            size.x = ((size.y as f32 * session.view.aspect).round() as u32).clamp(1, MAX_PIXELS);
        }
        let shot = session.animated_shot(size);
        let target = Target { path, title: session.document.title() };
        let progress = Arc::<Progress>::default();
        self.progress = Arc::clone(&progress);
        self.options.system = session.view.system;
        let options = self.options.clone();
        let shaders = session.shaders.clone();
        self.worker.submit_async(async move |ticket: Ticket| {
            let go_on = |done, count| {
                progress.done.store(done, Ordering::Relaxed);
                progress.count.store(count, Ordering::Relaxed);
                !progress.is_stopped.load(Ordering::Relaxed) && !ticket.is_cancelled()
            };
            let progress = ExportProgress::Callback(&go_on);
            let made = match render_job::open_backend(shaders.as_ref()) {
                Ok(backend) => make(&backend, product, &shot, &options, &target, &progress).await,
                Err(error) => Err(error),
            };
            made.unwrap_or_else(ExportResult::Failed)
        });
    }

    /// Closes the sheet, or else the export dialog. Returns true if either was open.
    pub fn dismiss(&mut self) -> bool {
        self.sheet.take().is_some() || std::mem::take(&mut self.is_open)
    }

    /// Reports finished exports. Call once a frame.
    pub fn advance(&mut self, session: &mut Session) {
        while let Some(done) = self.worker.poll() {
            match done {
                Some(ExportResult::Written(path)) => {
                    session.messages.info("export", format!("Exported {}", path.display()));
                    file_io::offer_download(&path);
                }
                Some(ExportResult::Sheet(image, kind)) => self.sheet = Some(Sheet { image, kind, texture: None }),
                Some(ExportResult::Failed(error)) => session.messages.error("export", error),
                None => session.messages.error("export", "Not exported: internal error"),
            }
        }
    }
}

/// Path of an export, and title of the document.
struct Target {
    path: PathBuf,
    title: String,
}

/// Returns a path that does not exist yet: in the folder of the last export or of the document, with the name of the
/// document and the time.
fn free_path(folder: Option<&Path>, session: &Session, content: &str, ending: &str) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() || c == '-' { c } else { '_' };
    let title: String = session.document.title().chars().map(plain).take(60).collect();
    let stem = format!("{title}_{:.2}s", session.playback.time);
    let folder = folder.or(session.document.path().parent()).unwrap_or(Path::new(""));
    let content = if content.is_empty() { String::new() } else { format!("_{content}") };
    let name = |number| match number {
        1 => format!("{stem}{content}{ending}"),
        _ => format!("{stem}{content}_{number}{ending}"),
    };
    let paths = (1..10_000).map(|number| folder.join(name(number)));
    let path = paths.into_iter().find(|path| !file_io::is_taken(path)).unwrap_or_else(|| folder.join(name(1)));
    file_io::absolute(&path)
}

/// Returns a path with an ending, unless it has one.
fn with_ending(path: PathBuf, ending: &str) -> PathBuf {
    if ending.is_empty() || path.extension().is_some() {
        return path;
    }
    path.with_extension(ending.trim_start_matches('.'))
}

fn write(path: PathBuf, image: impl Into<DynamicImage>) -> Result<ExportResult, Error> {
    write_png(&path, &image.into(), CompressionEffort::Quick)?;
    Ok(ExportResult::Written(path))
}

async fn make(
    backend: &Backend,
    product: ExportKind,
    shot: &Shot,
    options: &ExportOptions,
    Target { path, title }: &Target,
    watch: &ExportProgress<'_>,
) -> Result<ExportResult, Error> {
    let format = options.format;
    let frames = Frames { range: options.first..=options.last.max(options.first), rate: options.rate, format };
    let cells = match &product {
        ExportKind::Image if options.file == FileKind::Exr => {
            render_job::write_exr(backend, shot, format.background, path).await?;
            return Ok(ExportResult::Written(path.clone()));
        }
        ExportKind::Image => {
            let one = Frames { range: 0..=0, rate: 1.0, format };
            let image = render_job::render_flipbook(backend, shot, &one, UVec2::ONE, path, watch).await?;
            return write(path.clone(), image);
        }
        ExportKind::Sequence => {
            file_io::make_folder(path)?;
            let names = FrameNames::parse(&path.join(format!("%04d{}", options.file.ending())))?;
            if options.file == FileKind::Exr {
                render_job::write_exr_sequence(backend, shot, &frames, &names, watch).await?;
                return Ok(ExportResult::Written(path.clone()));
            }
            render_job::write_sequence(backend, shot, &frames, &names, CompressionEffort::Quick, watch).await?;
            return Ok(ExportResult::Written(path.clone()));
        }
        ExportKind::Flipbook => {
            render_job::check_flipbook(shot.size, &frames, options.cells)?;
            let image = render_job::render_flipbook(backend, shot, &frames, options.cells, path, watch).await?;
            return write(path.clone(), image);
        }
        ExportKind::Gif => {
            let frames = Frames { format: SCENE, ..frames };
            render_job::write_gif(backend, shot, &frames, path, watch).await?;
            return Ok(ExportResult::Written(path.clone()));
        }
        ExportKind::EngineFlipbook => {
            let flipbook =
                EngineFlipbook { engine: options.engine, cells: options.cells, choices: options.engine_flipbook };
            render_job::write_engine_flipbook(backend, shot, &frames, flipbook, path, watch).await?;
            return Ok(ExportResult::Written(path.clone()));
        }
        ExportKind::Material => {
            render_job::write_material(shot, options.system, options.engine, path)?;
            return Ok(ExportResult::Written(path.clone()));
        }
        ExportKind::DebugView => debug_view_sheet::stages(shot),
        ExportKind::Seeds => seeds(shot),
        ExportKind::Values(field) => {
            let cells = variations(shot, field);
            if cells.is_empty() {
                return Err(FieldError::new("export", field, "a number, a choice, or an on/off setting").into());
            }
            cells
        }
    };
    let name = product.file_ending(FileKind::Png).0.to_owned();
    let columns = render_job::column_count(cells.len());
    let size = (shot.size / columns).max(UVec2::ONE);
    let small = |(label, shot): (String, Shot)| (label, Shot { size, ..shot });
    let cells: Vec<_> = cells.into_iter().map(small).collect();
    let mut sheet = render_job::render_sheet(backend, &cells, columns, Path::new(&name), watch).await?;
    sheet.add_footer(&format!("{}; {title}, {}", display_name(&name), backend.description()));
    Ok(ExportResult::Sheet(sheet.image, product))
}

/// Returns nine shots: with the present seed and the eight after it.
fn seeds(shot: &Shot) -> Vec<(String, Shot)> {
    let with = |more: u32| {
        let mut shot = shot.at_its_time().into_owned();
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
            None => drop(shot.preset.set_field(path, &text).ok()?),
        }
        shot.preset.validate().ok()?;
        Some((text, shot))
    };
    let shot = &*shot.at_its_time();
    spread_values(&shot.preset, path).into_iter().filter_map(with).collect()
}

#[cfg(test)]
mod tests;
