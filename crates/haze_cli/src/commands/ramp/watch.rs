//! `haze ramp watch`: bakes recipes whenever they are saved.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::time::Duration;

use clap::Args;
use haze_core::error::{AssetError, Error};
use haze_export::interrupt;
use haze_export::output::{Failures, FileChecks, print_error};
use haze_export::recipe_files::image_path;
use haze_tweak::file_watcher::Watcher;

use crate::bake_job::{BakeJob, PaintedPng, RAMPS};

#[derive(Args)]
pub struct Arguments {
    /// `*.ramp.json` and `*.motif.json` files, and folders with such files.
    #[arg(required = true)]
    recipes: Vec<PathBuf>,
}

/// Interval of the checks for Ctrl-C and for new recipes in folders.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

pub fn run(Arguments { recipes }: &Arguments) -> Result<(), Failures> {
    Failures::of_each(recipes, |path| match fs::metadata(path) {
        Ok(found) if found.is_dir() => Ok(()),
        Ok(_) => RAMPS.find(path).map(drop),
        Err(error) => Err(io_error(path, error)),
    })
    .1
    .into_result()?;
    let (wake, woken) = channel();
    let wake = move || {
        let _ = wake.send(());
    };
    let watcher = Watcher::new(wake).map_err(|error| io_error(Path::new("cannot start the watcher thread"), error))?;
    interrupt::catch();
    let mut known = BTreeSet::new();
    while !interrupt::is_requested() {
        watcher.watch_unread(watched_recipes(recipes));
        let _ = woken.recv_timeout(CHECK_INTERVAL);
        if let Some(message) = watcher.take_message() {
            print_error(message);
        }
        for path in watcher.poll() {
            // When a recipe is seen for the first time, an image newer than it is up to date or was painted over.
            if !known.insert(path.clone()) || !is_newer(&image_path(&path), &path) {
                bake(&path).unwrap_or_else(print_error);
            }
        }
    }
    Ok(())
}

fn io_error(path: &Path, error: std::io::Error) -> Error {
    Error::from(AssetError::Io { path: path.into(), error })
}

/// Returns the recipes to watch now.
fn watched_recipes(recipes: &[PathBuf]) -> BTreeSet<PathBuf> {
    let mut files = BTreeSet::new();
    for path in recipes {
        match fs::read_dir(path) {
            Ok(folder) => {
                let inside = folder.flatten().map(|entry| entry.path());
                files.extend(inside.filter(|path| RAMPS.find(path).is_ok()));
            }
            // A deleted folder may be created again.
            Err(error) if error.kind() == ErrorKind::NotFound && RAMPS.find(path).is_err() => {}
            Err(_) => drop(files.insert(path.clone())),
        }
    }
    files
}

fn is_newer(image: &Path, recipe: &Path) -> bool {
    // A folder instead of the image counts as older, so that baking reports that it cannot be replaced.
    let modified = |path: &Path| fs::metadata(path).ok().filter(fs::Metadata::is_file)?.modified().ok();
    modified(image).is_some_and(|image| modified(recipe) <= Some(image))
}

fn bake(path: &Path) -> Result<(), Error> {
    BakeJob::load(path, &RAMPS, &mut FileChecks::for_inputs([path]), PaintedPng::Keep)?.bake()
}
