//! Tests of saving.

use super::*;
use crate::files::persistence::PanelSize;

#[test]
fn changes_are_saved_by_menu_by_key_and_under_another_name() {
    let mut bench = bench();
    bench.change(1.5);
    assert!(bench.window.query_by_label("•").is_some());
    bench.press(Modifiers::COMMAND, Key::S);
    bench.until(|bench| bench.said().starts_with("Saved "));
    bench.window.step();
    assert_eq!(exposure(&bench.path("my.json")), 150);
    assert!(bench.window.query_by_label("•").is_none());
    bench.change(0.5);
    bench.click("File");
    bench.window.get_by_label_contains("Save As…").click();
    bench.window.run_steps(3);
    assert!(bench.window.query_by_label_contains("has no file dialog. Type the path").is_some());
    let folder = format!("In {}", bench.folder.path().display());
    assert!(bench.window.query_by_label(&folder).is_some(), "{folder}");
    let other = bench.path("other.json");
    bench.type_path(&other);
    bench.until(|bench| bench.session().document.path().ends_with("other.json"));
    bench.window.run_steps(2);
    assert!(bench.window.query_by_label("other").is_some() && bench.window.query_by_label("my").is_none());
    assert_eq!((exposure(&other), exposure(&bench.path("my.json"))), (50, 150));
    assert_eq!(bench.session().document.path(), other);
    // The question about unsaved work names the file, not the preset inside.
    bench.change(0.7);
    bench.close();
    assert!(bench.window.query_by_label("Save changes to other.json?").is_some());
    bench.click("Cancel");
    // A name that is not valid for a preset.
    bench.press(COMMAND_SHIFT, Key::S);
    let image = bench.path("a.png");
    bench.type_path(&image);
    assert!(bench.said().contains("a name that ends in .json") && !image.exists(), "{}", bench.said());
    assert_eq!(bench.session().document.path(), other);
}

#[test]
fn a_slow_disk_does_not_block_the_window() {
    let mut bench = bench();
    bench.change(1.5);
    let (go_on, wait) = std::sync::mpsc::channel::<()>();
    bench.window.state().file_actions.worker.submit(move |_| {
        let _ = wait.recv();
        FileResult::Failed(FieldError::new("disk", "slow", "a quicker one").into())
    });
    bench.press(Modifiers::COMMAND, Key::S);
    // Editing continues, a second save is not started, and closing waits for the first.
    bench.change(0.5);
    bench.press(Modifiers::COMMAND, Key::S);
    assert_eq!(bench.said(), "Saving already");
    bench.close();
    assert!(bench.window.state().file_actions.waiting.is_none() && exposure(&bench.path("my.json")) == 55);
    go_on.send(()).unwrap();
    bench.until(|bench| !bench.session().document.is_being_saved());
    assert_eq!(exposure(&bench.path("my.json")), 150);
    // Changes made during the save are unsaved, so the window asks about them.
    bench.until(|bench| bench.window.state().file_actions.waiting.is_some());
    assert_eq!((bench.session().document.preset.camera.exposure * 100.0) as i32, 50);
    assert!(!bench.session().is_changed_on_disk && bench.session().document.is_dirty());
    bench.window.run_steps(2);
    bench.click("Save");
    bench.until(|bench| !bench.session().document.is_dirty());
    assert_eq!(exposure(&bench.path("my.json")), 50);
}

#[test]
fn a_failed_save_is_reported_and_the_work_stays_unsaved() {
    let mut bench = bench();
    bench.change(1.5);
    let full = bench.path("full");
    fs::create_dir(&full).unwrap();
    let is_mounted = std::process::Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=16k", "none"])
        .arg(&full)
        .output()
        .is_ok_and(|output| output.status.success());
    let gone = bench.path("gone/shot.json");
    let mut locations = vec![(gone, "No such file")];
    if is_mounted {
        fs::write(full.join("my.json"), "old").unwrap();
        let _ = fs::write(full.join("rest"), vec![0; 1 << 20]);
        locations.push((full.join("my.json"), "the disk is full"));
    }
    for (path, expected) in locations {
        bench.press(COMMAND_SHIFT, Key::S);
        bench.window.state_mut().file_actions.typed.as_mut().unwrap().text = path.display().to_string();
        bench.window.run_steps(2);
        let button = if path.exists() { "Replace" } else { "Save" };
        bench.click(button);
        bench.until(|bench| bench.said().contains(expected));
        assert!(!path.exists() || fs::read_to_string(&path).unwrap() == "old");
        assert!(bench.session().document.is_dirty() && bench.session().document.path().ends_with("my.json"));
    }
    if is_mounted {
        assert_eq!(fs::read_dir(&full).unwrap().count(), 2, "nothing half lies there");
        assert!(std::process::Command::new("umount").arg(&full).status().unwrap().success());
    }
}

#[test]
fn work_left_by_a_crash_is_offered_and_a_normal_exit_leaves_none() {
    let mut bench = bench();
    let state = bench.path("state");
    bench.change(1.5);
    assert!(state.join("recovery-1.json").exists());
    // As after a panic or a kill: nothing is cleaned up.
    bench.window = window(&bench.path("my.json"), Some(bench.path("else")));
    bench.window = window(&bench.path("my.json"), Some(state.clone()));
    bench.click("Recover");
    assert_eq!((bench.session().document.preset.camera.exposure * 100.0) as i32, 150);
    assert!(bench.session().document.is_dirty());
    assert!(bench.window.query_by_label("Recover").is_none());
    let persistence = bench.window.state_mut().persistence.take().unwrap();
    persistence.finish(&Layout { settings_width: Some(PanelSize { size: 400.0, room: 1000.0 }), ..Layout::default() });
    let left: Vec<_> = fs::read_dir(&state).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["layout.json"]);
    assert_eq!(Layout::read(&state).0.settings_width.map(|panel| panel.size), Some(400.0));
}
