//! Test of every file that the window writes, with names that lead to devices, pipes, folders, themselves, or files of
//! other users.

use std::fs;
use std::os::unix::fs::{MetadataExt, chown, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc::channel;
use std::time::Duration;

use glam::UVec2;
use haze::FieldError;
use haze_author::ramp::template::TEMPLATES;
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::error::Error;
use haze_demo::shot::Shot;
use haze_export::backend::Backend;
use haze_export::frame_range::FrameNames;
use haze_preset::Preset;

use super::persistence::Layout;
use super::window_screenshot;
use crate::document::copied_assets::copy_assets;
use crate::document::recovery::Recovery;
use crate::document::sprite_edits::sprite_source::{self, recipe_of_built_in};
use crate::document::{Document, ramp_edits};
use crate::platform::file_io::CompressionEffort;
use crate::platform::json_store;
use crate::platform::lock_file::Lock;
use crate::platform::render_job::{ExportProgress, Frames, SCENE, write_gif, write_sequence};

/// Origin of a file's name.
#[derive(Clone, Copy, PartialEq)]
enum Name {
    /// Chosen by the program: files of the state folder.
    State,
    /// Chosen by the user, or beside a file that the user chose.
    User,
    /// As above, but a file that is there already is not replaced.
    New,
}

struct Writer {
    file: &'static str,
    name: Name,
    write: fn(&Path) -> Result<(), Error>,
}

/// Every file that the window writes.
const WRITERS: [Writer; 13] = [
    Writer { file: "layout.json", name: Name::State, write: layout },
    Writer { file: "recovery-1.json", name: Name::State, write: recovery },
    Writer { file: "recovery-1.lock", name: Name::State, write: lock },
    Writer { file: "my.json", name: Name::User, write: preset },
    Writer { file: "mine.ramp.json", name: Name::User, write: ramp },
    Writer { file: "mine.png", name: Name::User, write: ramp },
    Writer { file: "mine.sprite.json", name: Name::User, write: sprite },
    Writer { file: "mine.detail.png", name: Name::User, write: sprite },
    Writer { file: "mine.png", name: Name::User, write: sprite },
    Writer { file: "copied.png", name: Name::New, write: copy },
    Writer { file: "shot_0000.png", name: Name::User, write: sequence },
    Writer { file: "shot.gif", name: Name::User, write: gif },
    Writer { file: "window.png", name: Name::User, write: screenshot },
];

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap()
}

fn layout(path: &Path) -> Result<(), Error> {
    json_store::write(folder_of(path), "layout", &Layout::default())
}

/// Writes the recovery file a second time. In the first write, it uses only numbers without a file.
fn recovery(path: &Path) -> Result<(), Error> {
    let aside = path.with_extension("aside");
    fs::rename(path, &aside).unwrap();
    let mut document = Document::open("column".as_ref())?;
    let mut recovery = Recovery::new(folder_of(path));
    document.preset.camera.exposure = 1.0;
    recovery.write(&document)?;
    fs::rename(&aside, path).unwrap();
    document.preset.camera.exposure = 2.0;
    recovery.write(&document)
}

fn lock(path: &Path) -> Result<(), Error> {
    let refused = || FieldError::new("lock", path.display(), "a file").into();
    Lock::take(path).ok_or_else(refused).map(|mut lock| lock.write("column").unwrap())
}

fn preset(path: &Path) -> Result<(), Error> {
    Document::open("column".as_ref())?.begin_saving_as(path)?.write()
}

fn ramp(path: &Path) -> Result<(), Error> {
    let recipe = TEMPLATES[0].recipe();
    ramp_edits::write(&folder_of(path).join("mine.png"), &recipe, &recipe.bake()?)
}

fn sprite(path: &Path) -> Result<(), Error> {
    let recipe = SpriteRecipe { size: 16, columns: 1, rows: 1, ..recipe_of_built_in("puff")? };
    let baked = recipe.bake(|_| Ok::<_, FieldError>(()))?;
    let image = folder_of(path).join("mine.png");
    let files = sprite_source::encode(&image, recipe.layout(), baked)?;
    sprite_source::write(&image, &recipe, &files)
}

fn copy(path: &Path) -> Result<(), Error> {
    let from = tempfile::tempdir().unwrap();
    let mut preset = Preset::load("column")?;
    preset.systems[0].material.sprite = "copied.png".into();
    image::RgbImage::new(1, 1).save(from.path().join("copied.png")).unwrap();
    copy_assets(&preset, from.path(), folder_of(path))
}

fn frames() -> Frames {
    Frames { range: 0..=0, rate: 1.0, format: SCENE }
}

fn sequence(path: &Path) -> Result<(), Error> {
    let names = FrameNames::parse(&folder_of(path).join("shot_%04d.png"))?;
    let shot = Shot::load("column", UVec2::splat(8))?;
    let effort = CompressionEffort::Quick;
    let progress = ExportProgress::Callback(&|_, _| true);
    pollster::block_on(write_sequence(&Backend::Cpu, &shot, &frames(), &names, effort, &progress))
}

fn gif(path: &Path) -> Result<(), Error> {
    let shot = Shot::load("column", UVec2::splat(8))?;
    let progress = ExportProgress::Callback(&|_, _| true);
    pollster::block_on(write_gif(&Backend::Cpu, &shot, &frames(), path, &progress))
}

fn screenshot(path: &Path) -> Result<(), Error> {
    window_screenshot::write(path, &eframe::egui::ColorImage::filled([2, 2], eframe::egui::Color32::RED))
}

/// Creates targets: a device, a pipe, a folder, a link to itself, and a file, of another user if the test runs as root.
fn make_targets(folder: &Path) -> [&'static str; 5] {
    let is_done = |program: &str, arguments: &[&str]| {
        Command::new(program).args(arguments).current_dir(folder).stderr(Stdio::null()).status().unwrap().success()
    };
    // Only root may create a device, and give files away.
    if !is_done("mknod", &["device", "c", "1", "3"]) {
        symlink("/dev/null", folder.join("device")).unwrap();
    }
    assert!(is_done("mkfifo", &["pipe"]) && is_done("mkdir", &["folder"]) && is_done("ln", &["-s", "loop", "loop"]));
    fs::write(folder.join("file"), "other").unwrap();
    let _ = chown(folder.join("file"), Some(65534), Some(65534));
    ["device", "pipe", "folder", "loop", "file"]
}

/// Returns a result of work that may block for ever.
fn within_a_minute<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Option<T> {
    let (send, done) = channel();
    std::thread::spawn(move || send.send(work()));
    done.recv_timeout(Duration::from_secs(60)).ok()
}

#[test]
fn the_window_replaces_only_files_and_writes_its_state_through_no_link() {
    let targets = tempfile::tempdir().unwrap();
    for target in make_targets(targets.path()).map(|name| targets.path().join(name)) {
        for Writer { file, name, write } in WRITERS {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(file);
            symlink(&target, &path).unwrap();
            let before = fs::symlink_metadata(&target).unwrap();
            let case = format!("{file} to {}", target.display());
            let link = path.clone();
            let written = within_a_minute(move || write(&link).map_err(|error| error.to_string()));
            let written = written.unwrap_or_else(|| panic!("{case}: waits for ever"));
            let after = fs::symlink_metadata(&target).unwrap();
            assert!(path.is_symlink(), "{case}");
            assert_eq!((after.file_type(), after.uid()), (before.file_type(), before.uid()), "{case}");
            if before.is_file() && name == Name::User {
                assert_eq!(written, Ok(()), "{case}");
                assert_ne!(fs::read(&target).unwrap(), b"other", "{case}");
                fs::write(&target, "other").unwrap();
                continue;
            }
            let error = written.expect_err(&case);
            assert!(error.contains("; expected ") && error.lines().count() == 1, "{case}: {error}");
            assert!(!before.is_file() || fs::read(&target).unwrap() == b"other", "{case}");
        }
    }
}
