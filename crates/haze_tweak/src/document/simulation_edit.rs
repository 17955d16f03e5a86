//! Simulation that the Sprite tab edits: shown at a low resolution while its recipe changes, then baked to the sprite of a
//! system.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use haze::{FieldError, MaterialAssets};
use haze_author::simulation::{FrameLoop, SimRecipe, Simulation};
use haze_core::assets::image::decode_png;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::Error;
use haze_core::settings::{Lighting, SpriteAnimation};
use haze_preset::{Preset, PresetSystem, encode_baked_png, is_baked_png};
use image::DynamicImage;
use serde::{Deserialize, Serialize};

use super::Document;
use super::sprite_edits::sprite_source::{BakedFiles, NotBaked, detail_of, encode, recipe_of, simulation_of};
use crate::platform::file_io;
use crate::platform::portable_job::PortableJob;
use crate::platform::worker::{Ticket, Worker};

/// The simulation on the Sprite tab, if one is open.
#[derive(Default)]
pub struct SimulationEdit {
    open: Option<OpenSimulation>,
    worker: Option<Worker<FinishedSimulation>>,
    /// The preset must first be saved to a file.
    pub needs_saved_preset: bool,
}

pub struct OpenSimulation {
    /// Index of the system whose sprite it becomes.
    system: usize,
    /// Image that it was read for, or the name of a built-in recipe.
    source: SimulationSource,
    pub recipe: SimRecipe,
    preview: Option<Preview>,
    running: Option<RunningSimulation>,
    /// Simulated in full, as soon as the preset is a file.
    is_bake_wanted: bool,
}

/// Origin of a simulation's recipe.
#[derive(Clone, Debug)]
pub enum SimulationSource {
    /// Name of a built-in recipe: the images get a new name.
    BuiltIn(String),
    /// Image beside the recipe, which is replaced.
    Image(PathBuf),
}

/// Low resolution of a recipe, as it is shown.
struct Preview {
    recipe: SimRecipe,
    /// The last good images, if the recipe is not valid.
    images: Option<[Sprite; 2]>,
}

/// Simulation in progress.
pub struct RunningSimulation {
    /// As it was edited: not that of the preview.
    recipe: SimRecipe,
    pub is_full: bool,
    finished: Arc<AtomicU32>,
    /// Number of moments.
    pub count: u32,
    ticket: Ticket,
}

struct FinishedSimulation {
    files: Result<SimulatedFiles, NotBaked>,
}

/// Job that simulates a recipe and bakes its images.
#[derive(Serialize, Deserialize)]
pub struct SimulateSprite {
    recipe: SimRecipe,
    /// Image that it is baked for.
    image: PathBuf,
}

/// Contents of the files of a simulated sprite.
#[derive(Serialize, Deserialize)]
pub struct SimulatedFiles {
    sprite: BakedFiles,
    heat: Option<Vec<u8>>,
}

impl PortableJob for SimulateSprite {
    const NAME: &'static str = "simulate_sprite";
    type Output = Result<SimulatedFiles, NotBaked>;

    fn stopped() -> Option<Self::Output> {
        Some(Err(NotBaked::Stopped))
    }

    fn run(self, progress: &dyn Fn(u32) -> bool) -> Self::Output {
        let Self { recipe, image } = self;
        let mut simulation = Simulation::new(&recipe)?;
        while simulation.finished_moments() < recipe.moment_count() {
            if !progress(simulation.finished_moments()) {
                return Err(NotBaked::Stopped);
            }
            simulation.advance();
        }
        let baked = simulation.into_recording().bake();
        let heat = baked.heat.map(|heat| encode_baked_png(&heat_of(&image), &heat.into()).map_err(Error::from));
        let files = encode(&image, layout(&recipe), baked.sprite)
            .and_then(|sprite| Ok(SimulatedFiles { sprite, heat: heat.transpose()? }));
        files.map_err(|error| {
            let expected = "an image that can be written as PNG";
            FieldError::from_problem("sprite", error.to_string(), expected).into()
        })
    }
}

impl RunningSimulation {
    /// Returns the number of finished moments.
    pub fn finished(&self) -> u32 {
        self.finished.load(Ordering::Relaxed)
    }
}

impl OpenSimulation {
    /// Name of the simulation, without ending.
    pub fn name(&self) -> String {
        match &self.source {
            SimulationSource::Image(image) => image.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            SimulationSource::BuiltIn(name) => name.clone(),
        }
    }

    pub fn running(&self) -> Option<&RunningSimulation> {
        self.running.as_ref()
    }

    /// Returns true if the full simulation was asked for, and is not finished.
    pub fn is_baking(&self) -> bool {
        self.is_bake_wanted || self.running.as_ref().is_some_and(|running| running.is_full)
    }

    fn stop(&mut self) {
        self.is_bake_wanted = false;
        self.running.take().iter().for_each(|running| running.ticket.cancel());
    }

    /// Keeps the last preview for a recipe that makes none.
    fn refuse(&mut self) {
        self.running.take().iter().for_each(|running| running.ticket.cancel());
        let images = self.preview.take().and_then(|last| last.images);
        self.preview = Some(Preview { recipe: self.recipe.clone(), images });
    }

    fn start(&mut self, worker: &Worker<FinishedSimulation>, is_full: bool, image: PathBuf) {
        self.running.take().iter().for_each(|running| running.ticket.cancel());
        let recipe = if is_full { self.recipe.clone() } else { self.recipe.preview() };
        let count = recipe.moment_count();
        let finished = Arc::new(AtomicU32::new(0));
        let progress = {
            let finished = Arc::clone(&finished);
            move |moments| {
                finished.store(moments, Ordering::Relaxed);
                true
            }
        };
        let job = SimulateSprite { recipe, image };
        let ticket = worker.submit_portable(job, progress, |files| FinishedSimulation { files });
        self.running = Some(RunningSimulation { recipe: self.recipe.clone(), is_full, finished, count, ticket });
    }

    /// Returns the image that is written: its own, unless that was painted since.
    fn image(&self, document: &Document) -> PathBuf {
        if let SimulationSource::Image(image) = &self.source
            && is_baked_png(image)
        {
            return image.clone();
        }
        let folder = document.path().parent().unwrap_or(Path::new(""));
        let file = file_io::free_copy_name(&self.name(), |file| {
            let image = folder.join(file);
            let files = [image.clone(), detail_of(&image), heat_of(&image), simulation_of(&image), recipe_of(&image)];
            files.iter().all(|path| !file_io::is_taken(path))
        });
        folder.join(file)
    }
}

impl SimulationEdit {
    /// Opens a simulation for a system. `recipe` is valid.
    pub fn open(&mut self, system: usize, source: SimulationSource, recipe: SimRecipe) {
        self.close();
        let open = OpenSimulation { system, source, recipe, preview: None, running: None, is_bake_wanted: false };
        self.open = Some(open);
    }

    /// Closes the simulation; nothing is written.
    pub fn close(&mut self) {
        self.open.take().iter_mut().for_each(OpenSimulation::stop);
    }

    /// Returns the simulation of a system, if it is open.
    pub fn of_system(&mut self, system: usize) -> Option<&mut OpenSimulation> {
        self.open.as_mut().filter(|open| open.system == system)
    }

    /// Asks for the full simulation. A built-in preset must be saved first.
    pub fn bake(&mut self, is_built_in: bool) {
        if let Some(open) = &mut self.open {
            open.is_bake_wanted = true;
            self.needs_saved_preset = is_built_in;
        }
    }

    /// Stops the full simulation: nothing is written.
    pub fn stop(&mut self) {
        self.open.iter_mut().for_each(OpenSimulation::stop);
    }

    /// Forgets the full simulation that waits until the preset is saved.
    pub fn cancel_bake(&mut self) {
        self.open.iter_mut().for_each(|open| open.is_bake_wanted = false);
    }

    /// Returns true while images are made that will be written.
    pub fn is_baking(&self) -> bool {
        self.open.as_ref().is_some_and(|open| open.running.as_ref().is_some_and(|running| running.is_full))
    }

    /// Simulates what was changed, and writes what was asked for. Returns the name of the image that was written. Call once
    /// a frame, after the panels. `wake` is called from another thread.
    ///
    /// # Errors
    /// That of the recipe, or of writing.
    pub fn advance(
        &mut self,
        document: &mut Document,
        is_held: bool,
        wake: impl Fn() + Send + 'static,
    ) -> Result<Option<String>, Error> {
        if self.open.is_none() {
            return Ok(None);
        }
        if self.worker.is_none() {
            self.worker = Worker::new("haze simulation", wake).ok();
        }
        let (Some(open), Some(worker)) = (&mut self.open, &self.worker) else { return Ok(None) };
        while let Some(done) = worker.poll() {
            let Some(running) = open.running.take() else { continue };
            let Some(FinishedSimulation { files }) = done else {
                // The panic of a job was printed to standard error; it is not tried again.
                open.refuse();
                continue;
            };
            if !running.is_full {
                let images = preview_images(&running.recipe, files);
                let last = open.preview.take();
                let mut shown = Preview { recipe: running.recipe, images: last.and_then(|last| last.images) };
                let said = images.map(|images| shown.images = Some(images));
                open.preview = Some(shown);
                said?;
                continue;
            }
            let image = open.image(document);
            write(&image, &running.recipe, files)?;
            let name = image.file_name().unwrap_or_default().to_string_lossy().into_owned();
            use_in(document, open.system, &name, &running.recipe);
            self.open = None;
            return Ok(Some(name));
        }
        if open.is_bake_wanted && !document.is_built_in() {
            open.is_bake_wanted = false;
            open.start(worker, true, open.image(document));
        }
        let known = open.running.as_ref().map(|running| &running.recipe);
        let known = known.or(open.preview.as_ref().map(|preview| &preview.recipe));
        if !open.is_baking() && !is_held && known != Some(&open.recipe) {
            if let Err(error) = open.recipe.validate() {
                open.refuse();
                return Err(error.into());
            }
            open.start(worker, false, "preview.png".into());
        }
        Ok(None)
    }

    /// Shows the low resolution in place of the system's sprite.
    pub fn apply(&self, preset: &Preset, materials: &mut [MaterialAssets]) {
        let Some(open) = &self.open else { return };
        let images = open.preview.as_ref().and_then(|preview| preview.images.as_ref());
        let has_normals = |system: &&PresetSystem| !system.settings.is_six_way();
        let shown = preset.systems.get(open.system).filter(has_normals);
        if let Some(((assets, [sprite, detail]), _)) = materials.get_mut(open.system).zip(images).zip(shown) {
            assets.sprite = sprite.clone();
            assets.detail = Some(detail.clone());
            assets.six_way = None;
        }
    }

    /// Stays with its system, whose index has changed. `index`: the new one; `None` closes the simulation.
    pub fn renumber(&mut self, index: impl Fn(usize) -> Option<usize>) {
        let Some(open) = &mut self.open else { return };
        match index(open.system) {
            Some(index) => open.system = index,
            None => self.close(),
        }
    }
}

fn heat_of(image: &Path) -> PathBuf {
    image.with_extension("heat.png")
}

fn layout(recipe: &SimRecipe) -> SpriteLayout {
    SpriteLayout { columns: recipe.sheet.columns, rows: recipe.sheet.rows, y_down: false }
}

/// Returns sprite and detail map of a preview. `recipe`: as it was edited.
fn preview_images(recipe: &SimRecipe, files: Result<SimulatedFiles, NotBaked>) -> Result<[Sprite; 2], Error> {
    let BakedFiles { image, detail, .. } = files.map_err(refusal)?.sprite;
    let layout = layout(&recipe.preview());
    let sprite = |bytes: &[u8]| {
        let path = Path::new("preview.png");
        let sheet = decode_png(path, bytes).map(DynamicImage::into_rgba8)?;
        Ok::<_, Error>(Sprite::from_image(path, &sheet, layout)?)
    };
    Ok([sprite(&image)?, sprite(&detail)?])
}

/// Writes the recipe first, because the images can be made again from it.
fn write(image: &Path, recipe: &SimRecipe, files: Result<SimulatedFiles, NotBaked>) -> Result<(), Error> {
    let SimulatedFiles { sprite, heat } = files.map_err(refusal)?;
    file_io::write(&simulation_of(image), recipe.to_json().as_bytes())?;
    file_io::write(&detail_of(image), &sprite.detail)?;
    if let Some(heat) = heat {
        file_io::write(&heat_of(image), &heat)?;
    }
    file_io::write(image, &sprite.image)
}

fn refusal(problem: NotBaked) -> Error {
    match problem {
        NotBaked::Refused { field, problem, expected } => FieldError::from_problem(field, problem, expected).into(),
        NotBaked::Stopped => FieldError::from_problem("simulation", "stopped", "to be finished").into(),
    }
}

/// Names the images in the preset. A flipbook that ends is played over the life of a particle. Six-way maps of another sprite do not
/// fit.
fn use_in(document: &mut Document, system: usize, name: &str, recipe: &SimRecipe) {
    let Some(system) = document.preset.systems.get_mut(system) else { return };
    system.material.sprite = name.into();
    system.material.detail = detail_of(Path::new(name)).display().to_string();
    SpriteLayout { columns: system.material.columns, rows: system.material.rows, y_down: system.material.y_down } =
        layout(recipe);
    system.material.six_way.clear();
    if system.settings.is_six_way() {
        system.settings.lighting = Lighting::default();
    }
    let sprite = &mut system.settings.sprite;
    sprite.motion = 1.0;
    sprite.animation = match recipe.time.frame_loop {
        FrameLoop::Once => SpriteAnimation::Volume,
        FrameLoop::CrossBlend => SpriteAnimation::Flipbook,
    };
}

#[cfg(test)]
mod tests;
