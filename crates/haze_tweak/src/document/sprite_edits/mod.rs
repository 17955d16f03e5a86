//! Sprites of a preset that the Sprite tab has shown: baked during an edit, written when the step is complete.

pub mod sprite_bake_job;
pub mod sprite_source;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use haze::MaterialAssets;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::Error;
use haze_preset::{AssetFolders, MaterialSources, Preset};

use super::Document;
use crate::platform::asset_loading::image_path;
use sprite_bake_job::{BakeOrder, BakeResult, Baked, FinishedBake, FullBake, SpriteBakeJob};
use sprite_source::{SpriteOrigin, SpriteState, Stamps, copy, detail_of, recipe_of, recipe_of_built_in, stamps};

/// Sprites by their names in the preset.
#[derive(Default)]
pub struct SpriteEdits {
    /// Path of the preset that they belong to.
    preset: PathBuf,
    known: BTreeMap<String, EditedSprite>,
    bake_job: Option<SpriteBakeJob>,
    /// Built-in sprite that is to be copied, and the index of the system it is for.
    wanted: Option<(usize, String)>,
    /// The preset must first be saved to a file.
    pub needs_saved_preset: bool,
}

/// Sprite with its recipe and its bakes.
pub struct EditedSprite {
    pub image: PathBuf,
    /// Layout that the preset has for it.
    layout: SpriteLayout,
    pub source: SpriteOrigin,
    stamps: Stamps,
    /// Findings of its check, one per line.
    pub findings: Vec<String>,
    /// Error in the recipe's file. The last valid recipe is kept.
    pub broken: Option<String>,
    /// Recipe that the files on disk were baked from.
    written: Option<SpriteRecipe>,
    /// Sprite that is shown instead of the files.
    live: Option<Baked>,
    live_is_full: bool,
    /// Number of the latest coarse bake, while it is in progress.
    coarse: Option<u64>,
    /// Full bake in progress.
    pub full: Option<BakeOrder>,
    /// Numbers of all jobs in progress, wanted or not.
    jobs: Vec<u64>,
    /// A file was written, so the stamps must be compared.
    is_stale: bool,
}

impl SpriteEdits {
    /// Returns a sprite. Requests it if it is not known yet; `None` if no thread can be started. `wake` is called from
    /// other threads.
    pub fn ask(
        &mut self,
        names: &MaterialSources,
        folders: &AssetFolders,
        wake: impl Fn() + Clone + Send + 'static,
    ) -> Option<&mut EditedSprite> {
        if self.bake_job.is_none() {
            self.bake_job = SpriteBakeJob::new(wake);
        }
        let bake_job = self.bake_job.as_mut()?;
        let layout = SpriteLayout { columns: names.columns, rows: names.rows, y_down: names.y_down };
        let known = self.known.entry(names.sprite.clone()).or_insert_with(|| {
            let mut known = EditedSprite::new(image_path(&names.sprite, folders), layout, SpriteOrigin::Reading);
            known.read_sprite(&names.sprite, bake_job);
            known
        });
        // A recipe determines its own layout.
        if known.layout != layout && known.jobs.is_empty() && !matches!(known.source, SpriteOrigin::Recipe(_)) {
            known.layout = layout;
            known.read_sprite(&names.sprite, bake_job);
        }
        Some(known)
    }

    /// Returns a sprite that was asked for.
    #[cfg(test)]
    pub fn known(&self, name: &str) -> Option<&EditedSprite> {
        self.known.get(name)
    }

    /// Requests a copy of a built-in sprite for a system. A built-in preset must be saved first.
    pub fn request_copy(&mut self, system: usize, name: &str, is_built_in: bool) {
        self.wanted = Some((system, name.to_owned()));
        self.needs_saved_preset = is_built_in;
    }

    /// Forgets the requested copy.
    pub fn cancel_copy(&mut self) {
        self.wanted = None;
    }

    /// Writes the requested copy and names it in the preset, as soon as the preset is a file.
    pub fn write_requested_copy(&mut self, document: &mut Document) -> Result<(), Error> {
        let Some((system, name)) = self.wanted.take_if(|_| !document.is_built_in()) else { return Ok(()) };
        let recipe = recipe_of_built_in(&name)?;
        let file = copy(&name, document.path())?;
        let image = document.path().with_file_name(&file);
        if let Some(system) = document.preset.systems.get_mut(system) {
            system.material.detail = detail_of(Path::new(&file)).display().to_string();
            system.material.sprite.clone_from(&file);
            lay_out(&mut system.material, &recipe);
        }
        // The content of the copy is known, so it is not read again.
        let mut known = EditedSprite::new(image, recipe.layout(), SpriteOrigin::Recipe(recipe.clone()));
        known.written = Some(recipe);
        if let Some(origin) = self.known.get(&name) {
            known.findings.clone_from(&origin.findings);
        }
        self.known.insert(file, known);
        Ok(())
    }

    /// Requests bakes of changed recipes; they are full and written unless a control is held. Call once a frame, after
    /// the panels.
    pub fn advance(&mut self, document: &mut Document, is_held: bool) -> Result<(), Error> {
        if self.preset != document.path() {
            self.known.clear();
            self.preset = document.path().into();
        }
        let Some(bake_job) = &mut self.bake_job else { return Ok(()) };
        let mut said = Ok(());
        while let Some(done) = bake_job.poll() {
            // The panic of a job was printed to standard error; the job never finishes.
            let Some(FinishedBake { job, what }) = done else { continue };
            let Some((name, known)) = self.known.iter_mut().find(|(_, known)| known.jobs.contains(&job)) else {
                continue;
            };
            known.jobs.retain(|other| *other != job);
            said = known.take(name, job, what, document).and(said);
        }
        for (name, known) in &mut self.known {
            known.follow(name, document, bake_job, is_held);
        }
        said
    }

    /// Replaces loaded sprites by their edited versions.
    pub fn apply(&self, preset: &Preset, materials: &mut [MaterialAssets]) {
        for (system, assets) in preset.systems.iter().zip(materials) {
            let live = self.known.get(&system.material.sprite).and_then(|known| known.live.as_ref());
            let Some(live) = live else { continue };
            // Six-way maps belong to the sprite as it was. Coarse sprites, and sprites with another number of frames,
            // have none.
            let frames = live.sprite.frame_count();
            let fits = |maps: &Sprite| (maps.size(), maps.frame_count()) == (live.sprite.size(), 2 * frames);
            if system.settings.is_six_way() && !assets.six_way.as_ref().is_some_and(fits) {
                continue;
            }
            assets.six_way = assets.six_way.take().filter(fits);
            assets.sprite = live.sprite.clone();
            // A detail image of another sprite must have the same number of frames.
            let is_own = Path::new(&system.material.detail) == detail_of(Path::new(&system.material.sprite));
            if let Some(detail) = &mut assets.detail
                && (is_own || detail.frame_count() != live.sprite.frame_count())
            {
                *detail = live.detail.clone();
            }
        }
    }

    /// Marks all sprites, so that changed files are read again.
    pub fn mark_stale(&mut self) {
        self.known.values_mut().for_each(|known| known.is_stale = true);
    }

    /// Forgets all sprites, because the document is replaced. Bakes in progress are still written.
    pub fn forget(&mut self) {
        self.known = BTreeMap::new();
        self.wanted = None;
    }

    /// Returns true while files do not yet match the recipes.
    pub fn is_baking(&self) -> bool {
        self.known.values().any(|known| known.full.is_some() || known.coarse.is_some())
    }
}

/// Changes the recipe of a sprite, and the layout that systems have for its sheet.
pub fn set_recipe(document: &mut Document, name: &str, recipe: SpriteRecipe) {
    let systems = document.preset.systems.iter_mut().filter(|system| system.material.sprite == name);
    systems.for_each(|system| lay_out(&mut system.material, &recipe));
    document.recipes.sprites.set(name, recipe);
}

fn lay_out(names: &mut MaterialSources, recipe: &SpriteRecipe) {
    SpriteLayout { columns: names.columns, rows: names.rows, y_down: names.y_down } = recipe.layout();
}

impl EditedSprite {
    fn new(image: PathBuf, layout: SpriteLayout, source: SpriteOrigin) -> Self {
        let stamps = stamps(&image);
        Self {
            image,
            layout,
            source,
            stamps,
            findings: Vec::new(),
            broken: None,
            written: None,
            live: None,
            live_is_full: false,
            coarse: None,
            full: None,
            jobs: Vec::new(),
            is_stale: false,
        }
    }

    /// Returns the path of its recipe, whether it exists or not.
    pub fn recipe_file(&self) -> PathBuf {
        recipe_of(&self.image)
    }

    /// Uses the recipe beside the image again: it is baked and written.
    pub fn adopt(&mut self) {
        if let SpriteOrigin::Apart(recipe) = &self.source {
            self.source = SpriteOrigin::Recipe(recipe.clone());
            self.written = None;
        }
    }

    fn read_sprite(&mut self, name: &str, bake_job: &mut SpriteBakeJob) {
        self.jobs.push(bake_job.read_sprite(name, self.image.clone(), self.layout));
    }

    fn take(&mut self, name: &str, job: u64, what: BakeResult, document: &mut Document) -> Result<(), Error> {
        match what {
            BakeResult::Read(SpriteState { source, findings, broken }, stamps) => {
                self.stamps = stamps;
                self.broken = broken;
                if self.broken.is_some() && matches!(self.source, SpriteOrigin::Recipe(_)) {
                    // The last valid recipe is kept.
                    return Ok(());
                }
                self.written = if let SpriteOrigin::Recipe(recipe) = &source { Some(recipe.clone()) } else { None };
                self.source = source;
                self.findings = findings;
                self.live = None;
                // A change by another program takes precedence.
                document.recipes.sprites.forget(name);
            }
            BakeResult::Coarse(baked) => {
                self.coarse = self.coarse.filter(|coarse| *coarse != job);
                let baked = baked?;
                let is_better = |live: &Baked| self.live_is_full && live.recipe == baked.recipe;
                if !self.live.as_ref().is_some_and(is_better) {
                    self.live = Some(baked);
                    self.live_is_full = false;
                }
            }
            BakeResult::Full(full) => {
                let FullBake { baked, stamps, written } = *full;
                let order = self.full.take_if(|order| order.job == job);
                // Also set after a write error; the next change tries again.
                self.written = baked.as_ref().map(|baked| baked.recipe.clone()).or(order.map(|order| order.recipe));
                self.stamps = stamps;
                self.live = baked;
                self.live_is_full = true;
                self.findings = written?;
            }
            BakeResult::GivenUp => {
                self.full = self.full.take().filter(|order| order.job != job);
                // The files may have been changed by another program, which is checked before the next bake.
                self.is_stale = true;
            }
        }
        Ok(())
    }

    fn follow(&mut self, name: &str, document: &Document, bake_job: &mut SpriteBakeJob, is_held: bool) {
        if !is_held && self.jobs.is_empty() && std::mem::take(&mut self.is_stale) && self.stamps != stamps(&self.image)
        {
            return self.read_sprite(name, bake_job);
        }
        let SpriteOrigin::Recipe(recipe) = &self.source else { return };
        let wanted = document.recipes.sprites.get(name).unwrap_or(recipe);
        if let Some(order) = self.full.take_if(|order| order.recipe != *wanted) {
            order.stop();
        }
        let is_live = self.live.as_ref().is_some_and(|live| live.recipe == *wanted);
        if self.written.as_ref() == Some(wanted) {
            if !is_live {
                self.live = None;
            }
            return;
        }
        if !is_live && self.coarse.is_none() {
            let job = bake_job.coarse(wanted.clone());
            self.coarse = Some(job);
            self.jobs.push(job);
        }
        // A file with an error that the user is about to fix is not overwritten.
        if !is_held && self.full.is_none() && self.broken.is_none() {
            let order = bake_job.full(wanted.clone(), self.image.clone(), self.stamps);
            self.jobs.push(order.job);
            self.full = Some(order);
        }
    }
}

#[cfg(test)]
mod tests;
