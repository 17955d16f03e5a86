//! Background bakes of sprites: at a low resolution while a control is held, in full when it is released.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use haze::FieldError;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::assets::image::decode_png;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::Error;
use image::DynamicImage;

use super::sprite_source::{BakeSprite, BakedFiles, NotBaked, ReadSprite, SpriteState, Stamps, stamps, write};
use crate::platform::worker::Worker;

/// Two threads, so that a coarse bake does not wait for a full one.
pub struct SpriteBakeJob {
    coarse: Worker<FinishedBake>,
    full: Worker<FinishedBake>,
    next: u64,
}

/// Finished job with its number.
pub struct FinishedBake {
    pub job: u64,
    pub what: BakeResult,
}

pub enum BakeResult {
    /// State, and the stamps of the files that were read.
    Read(SpriteState, Stamps),
    /// Bake of a recipe at a low resolution.
    Coarse(Result<Baked, Error>),
    Full(Box<FullBake>),
    /// The order was cancelled, or another program has changed the files: nothing was written.
    GivenUp,
}

/// Recipe and the images baked from it.
pub struct Baked {
    pub recipe: SpriteRecipe,
    pub sprite: Sprite,
    pub detail: Sprite,
}

/// Result of a full bake that was written.
pub struct FullBake {
    pub baked: Option<Baked>,
    pub stamps: Stamps,
    /// Findings of its check, or the error of writing.
    pub written: Result<Vec<String>, Error>,
}

/// Full bake in progress.
pub struct BakeOrder {
    pub job: u64,
    pub recipe: SpriteRecipe,
    is_stopped: Arc<AtomicBool>,
    frames: Arc<AtomicU32>,
}

impl BakeOrder {
    /// Cancels the bake, because another is wanted.
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Returns the number of baked frames.
    pub fn frames(&self) -> u32 {
        self.frames.load(Ordering::Relaxed)
    }
}

/// Largest frame size in texels, and number of columns and rows, of a coarse bake, which takes some milliseconds.
const COARSE: [u32; 2] = [64, 2];

impl SpriteBakeJob {
    /// `wake` is called from other threads when a job is done. Returns `None` if the system cannot start another
    /// thread.
    pub fn new(wake: impl Fn() + Clone + Send + 'static) -> Option<Self> {
        let coarse = Worker::new("haze coarse sprite", wake.clone()).ok()?;
        Some(Self { coarse, full: Worker::new("haze sprite", wake).ok()?, next: 0 })
    }

    /// Returns the oldest finished job; the inner `None` means that a job panicked.
    pub fn poll(&self) -> Option<Option<FinishedBake>> {
        self.coarse.poll().or_else(|| self.full.poll())
    }

    /// Reads a sprite and its recipe. Returns the number of the job.
    pub fn read_sprite(&mut self, name: &str, image: PathBuf, layout: SpriteLayout) -> u64 {
        let job = self.number();
        // Stamps are taken before the files are read, so that a write in between counts as a change.
        let stamps = stamps(&image);
        let read = ReadSprite { name: name.to_owned(), image, layout };
        let finish = move |state| FinishedBake { job, what: BakeResult::Read(state, stamps) };
        self.full.submit_portable(read, |_| true, finish);
        job
    }

    /// Bakes a recipe at a low resolution. Returns the number of the job.
    pub fn coarse(&mut self, recipe: SpriteRecipe) -> u64 {
        let job = self.number();
        let [size, frames] = COARSE;
        let columns = recipe.columns.min(frames);
        let rows = recipe.rows.min(frames);
        let small = SpriteRecipe { size: recipe.size.min(size), columns, rows, ..recipe.clone() };
        let layout = small.layout();
        let bake = BakeSprite { recipe: small, image: "sprite.png".into() };
        self.coarse.submit_portable(
            bake,
            |_| true,
            move |baked| {
                let shown = match baked {
                    Ok(files) => Baked::new(recipe, layout, "sprite.png".as_ref(), &files),
                    Err(NotBaked::Refused { field, problem, expected }) => {
                        Err(FieldError::from_problem(field, problem, expected).into())
                    }
                    Err(NotBaked::Stopped) => return FinishedBake { job, what: BakeResult::GivenUp },
                };
                FinishedBake { job, what: BakeResult::Coarse(shown) }
            },
        );
        job
    }

    /// Bakes a recipe in full and writes it, if the files still have the stamps `before`.
    pub fn full(&mut self, recipe: SpriteRecipe, image: PathBuf, before: Stamps) -> BakeOrder {
        let job = self.number();
        let is_stopped = Arc::new(AtomicBool::new(false));
        let frames = Arc::new(AtomicU32::new(0));
        let order =
            BakeOrder { job, recipe: recipe.clone(), is_stopped: Arc::clone(&is_stopped), frames: Arc::clone(&frames) };
        let go_on = move || !is_stopped.load(Ordering::Relaxed);
        let may_finish = go_on.clone();
        let progress = move |done| {
            frames.store(done, Ordering::Relaxed);
            go_on()
        };
        let bake = BakeSprite { recipe: recipe.clone(), image: image.clone() };
        self.full.submit_portable(bake, progress, move |baked| {
            let what = match baked {
                Err(NotBaked::Refused { field, problem, expected }) => {
                    let error = FieldError::from_problem(field, problem, expected);
                    BakeResult::Full(Box::new(FullBake { baked: None, stamps: before, written: Err(error.into()) }))
                }
                Ok(baked) if may_finish() && stamps(&image) == before => {
                    BakeResult::Full(Box::new(written(recipe, &image, baked)))
                }
                _ => BakeResult::GivenUp,
            };
            FinishedBake { job, what }
        });
        order
    }

    fn number(&mut self) -> u64 {
        self.next += 1;
        self.next
    }
}

impl Baked {
    /// Decodes the images of a bake.
    fn new(recipe: SpriteRecipe, layout: SpriteLayout, path: &Path, files: &BakedFiles) -> Result<Self, Error> {
        let sprite = |bytes: &[u8]| {
            let sheet = decode_png(path, bytes).map(DynamicImage::into_rgba8)?;
            Sprite::from_image(path, &sheet, layout).map_err(Error::from)
        };
        Ok(Self { sprite: sprite(&files.image)?, detail: sprite(&files.detail)?, recipe })
    }
}

fn written(recipe: SpriteRecipe, image: &Path, baked: BakedFiles) -> FullBake {
    let written = write(image, &recipe, &baked);
    let layout = recipe.layout();
    let shown = Baked::new(recipe, layout, image, &baked).ok();
    FullBake { baked: shown, stamps: stamps(image), written: written.map(|()| baked.findings) }
}
