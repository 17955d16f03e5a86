use std::fs;
use std::process::Command;
use std::time::{Duration, Instant};

use haze_core::settings::set_field;

use super::*;

impl Document {
    /// Saves on this thread.
    pub fn save(&mut self) -> Result<(), Error> {
        let saving = self.begin_saving()?;
        self.write(saving)
    }

    pub fn save_as(&mut self, path: &Path) -> Result<(), Error> {
        let saving = self.begin_saving_as(path)?;
        self.write(saving)
    }

    fn write(&mut self, saving: Saving) -> Result<(), Error> {
        let done = saving.write();
        self.finish_saving(saving, done.is_ok());
        done
    }
}

fn shot(folder: &Path) -> PathBuf {
    let path = folder.join("shot.json");
    fs::write(&path, Preset::load("column").unwrap().to_json("")).unwrap();
    path
}

#[test]
fn a_change_modifies_one_line_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = Document::open(Path::new("column")).unwrap();
    assert!(document.is_built_in() && !document.is_dirty() && document.files(&AssetFolders::default()).is_empty());
    let refused = document.save().unwrap_err().to_string();
    assert_eq!(refused, "save: column is a built-in preset; expected another name");
    let refused = document.save_as(&folder.path().join("shot")).unwrap_err().to_string();
    assert!(refused.ends_with("shot is not valid; expected a name that ends in .json"), "{refused}");
    let path = folder.path().join("shot.json");
    document.save_as(&path).unwrap();
    let shipped = fs::read_to_string("../../presets/column.json").unwrap();
    assert_eq!((document.path(), fs::read_to_string(&path).unwrap()), (&*path, shipped.clone()));
    assert!(!document.is_built_in());

    document.preset.systems[0].settings.boost = 2.25;
    assert!(document.is_dirty());
    document.save().unwrap();
    assert!(!document.is_dirty());
    let text = fs::read_to_string(&path).unwrap();
    let changed: Vec<_> = text.lines().zip(shipped.lines()).filter(|(now, before)| now != before).collect();
    assert_eq!(changed, [("        \"boost\": 2.25,", "        \"boost\": 1.5,")]);
    assert_eq!(Document::open(&path).unwrap().preset, document.preset);
    // There is no other file in the folder.
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn an_invalid_preset_is_not_saved_and_the_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = shot(folder.path());
    let before = fs::read(&path).unwrap();
    let mut document = Document::open(&path).unwrap();
    document.preset.systems[0].settings.boost = f32::NAN;
    let refused = document.save().unwrap_err().to_string();
    assert_eq!(refused, "systems[0].settings.boost: NaN is not valid; expected 0 to 16");
    assert!(document.save_as(&folder.path().join("other.json")).is_err());
    assert_eq!((fs::read(&path).unwrap(), fs::read_dir(folder.path()).unwrap().count()), (before, 1));
    let missing = document.save_as(&folder.path().join("missing/shot.json"));
    assert!(missing.is_err() && document.path() == path);
}

#[test]
fn undo_works_across_save_revert_and_paste() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = Document::open(&shot(folder.path())).unwrap();
    let first = document.preset.clone();
    document.preset.camera.exposure = 1.0;
    document.track(false);
    document.save().unwrap();
    document.preset.lights.remove(0);
    // No frame has seen this change yet; it is a step of its own nevertheless.
    document.revert().unwrap();
    assert_eq!((document.preset.lights.len(), document.is_dirty()), (3, false));
    document.paste(&Preset::load("fence").unwrap().to_json("")).unwrap();
    assert!(document.is_dirty());
    let names: Vec<_> = std::iter::from_fn(|| document.undo().map(str::to_owned)).collect();
    assert_eq!(names, ["Paste", "Revert", "Light removed", "Exposure"]);
    assert_eq!(document.preset, first);
    assert_eq!((document.history().undo_name(), document.history().redo_name()), (None, Some("Exposure")));
    assert_eq!(document.redo(), Some("Exposure"));
    assert!(!document.is_dirty());
}

#[test]
fn a_pasted_preset_is_validated_like_a_file() {
    let mut document = Document::open(Path::new("column")).unwrap();
    let text = document.to_json();
    let line = 1 + text.lines().position(|line| line.contains("\"boost\"")).unwrap();
    let not_a_value = format!("pasted text:{line}:18: systems: not a value; expected a number");
    let unknown_field = format!("pasted text:{line}:14: systems[0].settings: unknown field `bost`");
    for (from, to, said) in [
        ("\"boost\": 1.5", "\"boost\": NaN", not_a_value.as_str()),
        (
            "\"boost\": 1.5",
            "\"boost\": 99",
            "pasted text: systems[0].settings.boost: 99 is not valid; expected 0 to 16",
        ),
        ("\"boost\"", "\"bost\"", unknown_field.as_str()),
        ("\"version\": 1", "\"version\": 2", "pasted text:2:3: version 2 is newer"),
        (text.as_str(), "", "pasted text:1:1: the file ends where a value should be"),
    ] {
        let error = document.paste(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.starts_with(said) && !error.contains('\n'), "{error}");
        assert!(!document.is_dirty() && document.history().undo_name().is_none());
    }
    set_field(&mut document.preset, "boost", "3").unwrap();
    let mut other = Document::open(Path::new("fence")).unwrap();
    other.paste(&document.to_json()).unwrap();
    assert_eq!(other.preset, document.preset);
}

#[test]
fn only_writes_by_other_programs_count_as_changes_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = shot(folder.path());
    let mut document = Document::open(&path).unwrap();
    assert_eq!(document.on_disk(), OnDisk::Same);
    document.preset.camera.exposure = 1.0;
    document.save().unwrap();
    assert_eq!((document.on_disk(), document.on_disk()), (OnDisk::Same, OnDisk::Same));
    // Rewritten with the same text: no change.
    fs::write(&path, fs::read(&path).unwrap()).unwrap();
    assert_eq!(document.on_disk(), OnDisk::Same);
    // Same length and same modification time.
    let before = fs::metadata(&path).unwrap().modified().unwrap();
    fs::write(&path, fs::read_to_string(&path).unwrap().replace("\"exposure\": 1.0", "\"exposure\": 2.0")).unwrap();
    fs::File::options().write(true).open(&path).unwrap().set_modified(before).unwrap();
    assert_eq!((document.on_disk(), document.on_disk()), (OnDisk::Changed, OnDisk::Changed));
    document.keep_mine();
    assert!(document.on_disk() == OnDisk::Same && document.is_dirty());
    document.revert().unwrap();
    assert_eq!((document.preset.camera.exposure, document.is_dirty()), (2.0, false));
    let read = document.preset.clone();
    fs::remove_file(&path).unwrap();
    assert_eq!(document.on_disk(), OnDisk::Gone);
    assert!(document.revert().is_err() && document.preset == read);
    document.save().unwrap();
    assert_eq!(document.on_disk(), OnDisk::Same);
}

#[test]
fn images_are_copied_to_another_folder_on_save() {
    let folder = tempfile::tempdir().unwrap();
    let old = folder.path().join("old");
    let new = folder.path().join("new");
    fs::create_dir_all(old.join("ramps")).unwrap();
    fs::create_dir(&new).unwrap();
    let mut document = Document::open(&shot(&old)).unwrap();
    document.preset.systems[0].material.diffuse_ramp = "ramps/own.png".into();
    document.preset.systems[0].material.motif = "missing.png".into();
    assert_eq!(
        document.files(&AssetFolders::new(&old)),
        ["shot.json", "ramps/own.png", "missing.png"].map(|name| old.join(name))
    );
    fs::copy("../../ramps/diffuse_soft.png", old.join("ramps/own.png")).unwrap();
    fs::copy("../../ramps/diffuse_soft.ramp.json", old.join("ramps/own.ramp.json")).unwrap();
    document.save_as(&new.join("shot.json")).unwrap();
    let recipe = fs::read(new.join("ramps/own.ramp.json")).unwrap();
    assert_eq!(recipe, fs::read("../../ramps/diffuse_soft.ramp.json").unwrap());
    assert_eq!(fs::read(new.join("ramps/own.png")).unwrap(), fs::read("../../ramps/diffuse_soft.png").unwrap());
    assert!(!new.join("missing.png").exists());
    // Saved again over identical files.
    let mut document = Document::open(&shot(&old)).unwrap();
    document.preset.systems[0].material.diffuse_ramp = "ramps/own.png".into();
    document.save_as(&new.join("shot.json")).unwrap();
    // A different file of that name is not replaced.
    let mut document = Document::open(&shot(&old)).unwrap();
    document.preset.systems[0].material.diffuse_ramp = "ramps/own.png".into();
    fs::write(new.join("ramps/own.ramp.json"), "other").unwrap();
    let error = document.save_as(&new.join("second.json")).unwrap_err().to_string();
    assert!(error.contains("new/ramps/own.ramp.json: differs from "), "{error}");
    fs::write(new.join("ramps/own.png"), "other").unwrap();
    let error = document.save_as(&new.join("second.json")).unwrap_err().to_string();
    assert!(error.contains("new/ramps/own.png: differs from "), "{error}");
    assert!(!new.join("second.json").exists() && fs::read(new.join("ramps/own.png")).unwrap() == b"other");
    assert_eq!(document.path(), old.join("shot.json"));
}

#[cfg(unix)]
#[test]
fn saving_keeps_symbolic_links_and_file_modes() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let path = shot(folder.path());
    let link = folder.path().join("link.json");
    symlink("shot.json", &link).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    let mut document = Document::open(&link).unwrap();
    document.preset.camera.exposure = 1.0;
    document.save().unwrap();
    assert!(link.is_symlink() && document.on_disk() == OnDisk::Same);
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    assert_eq!(Preset::load(&path).unwrap(), document.preset);
}

#[cfg(unix)]
#[test]
fn a_file_that_is_no_preset_is_refused_at_once() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::File::create(path("huge.json")).unwrap().set_len(10 << 30).unwrap();
    fs::create_dir(path("folder.json")).unwrap();
    assert!(Command::new("mkfifo").arg(path("pipe.json")).status().unwrap().success());
    fs::write(path("binary.json"), [0u8, 159, 146, 150]).unwrap();
    shot(folder.path());
    fs::set_permissions(path("shot.json"), fs::Permissions::from_mode(0o0)).unwrap();
    let mut refused = vec![
        ("huge.json", "10737418240 bytes; expected a JSON file of at most 1048576 bytes (1 MiB)"),
        ("folder.json", "a folder, not a file; expected a JSON file"),
        ("pipe.json", "a pipe, not a file; expected a JSON file"),
        ("binary.json", "not UTF-8; expected JSON as UTF-8 text"),
        ("none.json", "No such file"),
    ];
    // Root can read every file.
    if fs::File::open(path("shot.json")).is_err() {
        refused.push(("shot.json", "Permission denied"));
    }
    let start = Instant::now();
    for (name, said) in refused {
        let error = Document::open(&path(name)).err().unwrap().to_string();
        assert!(error.contains(name) && error.contains(said) && !error.contains('\n'), "{error}");
    }
    assert!(start.elapsed() < Duration::from_secs(1), "{:?}", start.elapsed());
}
