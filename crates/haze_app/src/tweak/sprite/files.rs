//! The sprites of a preset that the page has shown: what they are made from, baked while that is changed, written when it is done.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use haze::preset::{MaterialNames, PictureFolders, Preset};
use haze::sprite::{Sprite, SpriteLayout};
use haze::{Error, MaterialAssets};
use haze_author::sprite::bake::SpriteRecipe;

use super::bakery::{Baked, Bakery, Done, Order, What, Whole};
use super::source::{Looked, Source, Stamps, copy, detail_of, recipe_of, recipe_of_built_in, stamps};
use crate::tweak::document::document::Document;
use crate::tweak::platform::assets::place_of;

/// By the names that the preset has for them.
#[derive(Default)]
pub struct SpriteFiles {
    /// The preset that they are of.
    preset: PathBuf,
    known: BTreeMap<String, Known>,
    bakery: Option<Bakery>,
    /// The built-in sprite that a system is to have a copy of.
    wanted: Option<(usize, String)>,
    /// The preset has no place yet for it.
    pub wants_place: bool,
}

/// What is known of a sprite.
pub struct Known {
    picture: PathBuf,
    /// As the preset has it.
    layout: SpriteLayout,
    pub source: Source,
    stamps: Stamps,
    /// What a check says, line by line.
    pub findings: Vec<String>,
    /// What is wrong with the recipe's file: the last good one is kept.
    pub broken: Option<String>,
    /// What the files on disk are made by.
    written: Option<SpriteRecipe>,
    /// What is shown in place of them.
    live: Option<Baked>,
    live_is_whole: bool,
    /// The last coarse one, if it is on its way.
    coarse: Option<u64>,
    /// A whole one that is wanted.
    pub whole: Option<Order>,
    /// All that is on its way, wanted or not.
    jobs: Vec<u64>,
    /// Something was written: its files may be others.
    is_stale: bool,
}

impl SpriteFiles {
    /// What a sprite is; nothing before it was asked about, or where there are no threads. `wake` is called from other threads.
    pub fn ask(
        &mut self,
        names: &MaterialNames,
        folders: &PictureFolders,
        wake: impl Fn() + Clone + Send + 'static,
    ) -> Option<&mut Known> {
        if self.bakery.is_none() {
            self.bakery = Bakery::new(wake);
        }
        let bakery = self.bakery.as_mut()?;
        let layout = SpriteLayout { columns: names.columns, rows: names.rows, y_down: names.y_down };
        let known = self.known.entry(names.sprite.clone()).or_insert_with(|| {
            let mut known = Known::new(place_of(&names.sprite, folders), layout, Source::Reading);
            known.look(&names.sprite, bakery);
            known
        });
        // A recipe has a layout of its own.
        if known.layout != layout && known.jobs.is_empty() && !matches!(known.source, Source::Recipe(_)) {
            known.layout = layout;
            known.look(&names.sprite, bakery);
        }
        Some(known)
    }

    /// A copy of a built-in sprite is wanted for a system; where the preset is built in, that is saved first.
    pub fn want_own(&mut self, system: usize, name: &str, is_built_in: bool) {
        (self.wanted, self.wants_place) = (Some((system, name.to_owned())), is_built_in);
    }

    /// Writes the copy that is wanted, and names it in the preset, once that is a file.
    pub fn make_own(&mut self, document: &mut Document) -> Result<(), Error> {
        let Some((system, name)) = self.wanted.take_if(|_| !document.is_built_in()) else { return Ok(()) };
        let (recipe, file) = (recipe_of_built_in(&name)?, copy(&name, document.path())?);
        let picture = document.path().with_file_name(&file);
        if let Some(system) = document.preset.systems.get_mut(system) {
            system.material.detail = detail_of(Path::new(&file)).display().to_string();
            system.material.sprite.clone_from(&file);
            lay_out(&mut system.material, &recipe);
        }
        // What was copied is known.
        let mut known = Known::new(picture, recipe.layout(), Source::Recipe(recipe.clone()));
        known.written = Some(recipe);
        if let Some(origin) = self.known.get(&name) {
            known.findings.clone_from(&origin.findings);
        }
        self.known.insert(file, known);
        Ok(())
    }

    /// Once a frame, after the panels: has baked what was changed, whole and written unless a control is held.
    pub fn advance(&mut self, document: &mut Document, is_held: bool) -> Result<(), Error> {
        if self.preset != document.path() {
            self.known.clear();
            self.preset = document.path().into();
        }
        let Some(bakery) = &mut self.bakery else { return Ok(()) };
        let mut said = Ok(());
        while let Some(done) = bakery.poll() {
            // A job that panicked has been said to standard error, and is never done.
            let Some(Done { job, what }) = done else { continue };
            let Some((name, known)) = self.known.iter_mut().find(|(_, known)| known.jobs.contains(&job)) else {
                continue;
            };
            known.jobs.retain(|other| *other != job);
            said = known.take(name, job, what, document).and(said);
        }
        for (name, known) in &mut self.known {
            known.follow(name, document, bakery, is_held);
        }
        said
    }

    /// Puts sprites as they are now in the place of those that were loaded.
    pub fn apply(&self, preset: &Preset, materials: &mut [MaterialAssets]) {
        for (system, assets) in preset.systems.iter().zip(materials) {
            let live = self.known.get(&system.material.sprite).and_then(|known| known.live.as_ref());
            let Some(live) = live else { continue };
            // Of the sprite as it was: coarse ones and those of other frames have none.
            let frames = live.sprite.frame_count();
            let fits = |maps: &Sprite| (maps.size(), maps.frame_count()) == (live.sprite.size(), 2 * frames);
            if system.settings.is_six_way() && !assets.six_way.as_ref().is_some_and(fits) {
                continue;
            }
            assets.six_way = assets.six_way.take().filter(fits);
            assets.sprite = live.sprite.clone();
            // Another's must have as many frames.
            let is_own = Path::new(&system.material.detail) == detail_of(Path::new(&system.material.sprite));
            if let Some(detail) = &mut assets.detail
                && (is_own || detail.frame_count() != live.sprite.frame_count())
            {
                *detail = live.detail.clone();
            }
        }
    }

    /// Something was written: files that are others are read again.
    pub fn look_again(&mut self) {
        self.known.values_mut().for_each(|known| known.is_stale = true);
    }

    /// Another document takes the place of theirs. What is on its way is written all the same.
    pub fn forget(&mut self) {
        (self.known, self.wanted) = (BTreeMap::new(), None);
    }

    /// Files are not yet what the preset says of them.
    pub fn is_baking(&self) -> bool {
        self.known.values().any(|known| known.whole.is_some() || known.coarse.is_some())
    }
}

/// Changes the recipe of a sprite, and what systems say of its sheet.
pub fn set_recipe(document: &mut Document, name: &str, recipe: SpriteRecipe) {
    let systems = document.preset.systems.iter_mut().filter(|system| system.material.sprite == name);
    systems.for_each(|system| lay_out(&mut system.material, &recipe));
    document.recipes.sprites.set(name, recipe);
}

fn lay_out(names: &mut MaterialNames, recipe: &SpriteRecipe) {
    SpriteLayout { columns: names.columns, rows: names.rows, y_down: names.y_down } = recipe.layout();
}

impl Known {
    fn new(picture: PathBuf, layout: SpriteLayout, source: Source) -> Self {
        let stamps = stamps(&picture);
        Self {
            picture,
            layout,
            source,
            stamps,
            findings: Vec::new(),
            broken: None,
            written: None,
            live: None,
            live_is_whole: false,
            coarse: None,
            whole: None,
            jobs: Vec::new(),
            is_stale: false,
        }
    }

    /// Where its recipe is, or would be.
    pub fn recipe_file(&self) -> PathBuf {
        recipe_of(&self.picture)
    }

    /// Makes the recipe beside it its own again: it is baked and written.
    pub fn adopt(&mut self) {
        if let Source::Apart(recipe) = &self.source {
            self.source = Source::Recipe(recipe.clone());
            self.written = None;
        }
    }

    fn look(&mut self, name: &str, bakery: &mut Bakery) {
        self.jobs.push(bakery.look(name, self.picture.clone(), self.layout));
    }

    fn take(&mut self, name: &str, job: u64, what: What, document: &mut Document) -> Result<(), Error> {
        match what {
            What::Looked(Looked { source, stamps, findings, broken }) => {
                (self.stamps, self.broken) = (stamps, broken);
                if self.broken.is_some() && matches!(self.source, Source::Recipe(_)) {
                    // The last good one is kept.
                    return Ok(());
                }
                self.written = if let Source::Recipe(recipe) = &source { Some(recipe.clone()) } else { None };
                (self.source, self.findings, self.live) = (source, findings, None);
                // Another program has the last word.
                document.recipes.sprites.forget(name);
            }
            What::Coarse(baked) => {
                self.coarse = self.coarse.filter(|coarse| *coarse != job);
                let baked = baked?;
                let is_better = |live: &Baked| self.live_is_whole && live.recipe == baked.recipe;
                if !self.live.as_ref().is_some_and(is_better) {
                    (self.live, self.live_is_whole) = (Some(baked), false);
                }
            }
            What::Whole(whole) => {
                let Whole { baked, stamps, written } = *whole;
                let order = self.whole.take_if(|order| order.job == job);
                // Also where it could not be: the next change tries again.
                self.written = baked.as_ref().map(|baked| baked.recipe.clone()).or(order.map(|order| order.recipe));
                self.stamps = stamps;
                (self.live, self.live_is_whole) = (baked, true);
                self.findings = written?;
            }
            What::GivenUp => {
                self.whole = self.whole.take().filter(|order| order.job != job);
                // It may be that files are others: before it is baked once more that is seen.
                self.is_stale = true;
            }
        }
        Ok(())
    }

    fn follow(&mut self, name: &str, document: &Document, bakery: &mut Bakery, is_held: bool) {
        if !is_held
            && self.jobs.is_empty()
            && std::mem::take(&mut self.is_stale)
            && self.stamps != stamps(&self.picture)
        {
            return self.look(name, bakery);
        }
        let Source::Recipe(recipe) = &self.source else { return };
        let wanted = document.recipes.sprites.get(name).unwrap_or(recipe);
        if let Some(order) = self.whole.take_if(|order| order.recipe != *wanted) {
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
            let job = bakery.coarse(wanted.clone());
            self.coarse = Some(job);
            self.jobs.push(job);
        }
        // A file that someone is mending is not written over.
        if !is_held && self.whole.is_none() && self.broken.is_none() {
            let order = bakery.whole(wanted.clone(), self.picture.clone(), self.stamps);
            self.jobs.push(order.job);
            self.whole = Some(order);
        }
    }
}
