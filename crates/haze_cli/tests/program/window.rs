//! The tweaker's window: the program under an X server without a screen, on any adapter.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "window/x11.rs"]
mod x11;

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use haze_preset::Preset;
use image::RgbImage;
use tempfile::TempDir;
use x11::{Display, Key};

/// Allows one window at a time, because some tests measure time.
fn window_lock() -> MutexGuard<'static, ()> {
    static ONE: Mutex<()> = Mutex::new(());
    ONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the command of a program that keeps its state in `folder`.
fn haze(folder: &Path, display: &str, variables: &[(&str, &str)], arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_haze"));
    command.args(arguments).current_dir(folder).stderr(Stdio::piped()).env_remove("WAYLAND_DISPLAY");
    command.env("DISPLAY", display).env("XDG_RUNTIME_DIR", folder).env("HAZE_STATE", folder.join("state"));
    command.envs(variables.iter().copied());
    command
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs a program that must end with this code and one line on stderr; returns the line.
fn line(mut command: Command, code: i32) -> String {
    let output = command.output().unwrap();
    let text = stderr(&output);
    assert_eq!((output.status.code(), text.lines().count()), (Some(code), 1), "{text}");
    text
}

const BRIGHT: [&str; 4] = ["--set", "camera.exposure=2.5", "--set", "time=3"];

/// Returns a screenshot of the window with these arguments, and the time it took.
fn image(display: &Display, variables: &[(&str, &str)], arguments: &[&str]) -> (RgbImage, Duration) {
    let folder = folder();
    let all = [&["tweak", "--size", "700x420", "--screenshot", "a.png"], arguments].concat();
    let start = Instant::now();
    let output = haze(folder.path(), &display.name, variables, &all).output().unwrap();
    let taken = start.elapsed();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
    (haze_core::assets::image::read_png(&folder.path().join("a.png")).unwrap().into_rgb8(), taken)
}

fn brightness(image: &RgbImage) -> f64 {
    image.as_raw().iter().map(|channel| f64::from(*channel)).sum::<f64>() / image.as_raw().len() as f64
}

#[test]
fn screenshots_follow_settings_and_a_lost_device_changes_nothing() {
    let _lock = window_lock();
    let display = Display::start();
    let (plain, _) = image(&display, &[], &[]);
    assert_eq!(plain.dimensions(), (700, 420));
    // Both compile the same pipelines, so neither time depends on the machine alone. It may be busy: the best of some tries.
    let is_rebuilt_as_fast_as_opened = (0..4).any(|_| {
        let (bright, opened) = image(&display, &[], &BRIGHT);
        assert!(brightness(&bright) > brightness(&plain) + 5.0);
        let (again, opened_twice) = image(&display, &[("HAZE_TEST_LOSE_DEVICE", "3")], &BRIGHT);
        assert!(again == bright, "a lost device changed settings, time, undo or panels");
        opened_twice < 2 * opened
    });
    assert!(is_rebuilt_as_fast_as_opened, "a lost device took longer than opening the window");
}

#[test]
fn a_device_lost_twice_ends_the_program_and_keeps_unsaved_work() {
    // On a busy machine the first two losses can be more than ten seconds apart.
    const FRAMES: &str = "3,6,9,12,15,18";
    let _lock = window_lock();
    let display = Display::start();
    let folder = folder();
    let command = |arguments: &[&str]| {
        haze(
            folder.path(),
            &display.name,
            &[("HAZE_TEST_LOSE_DEVICE", FRAMES)],
            &[&["tweak", "column"], arguments].concat(),
        )
    };
    let text = line(command(&BRIGHT), 1);
    assert!(text.contains("lost twice within 10 seconds") && text.contains("kept for the next start"), "{text}");
    let kept = Preset::load(folder.path().join("state/recovery-1.json")).unwrap();
    assert!((kept.camera.exposure - 2.5).abs() < 1e-6 && (kept.time - 3.0).abs() < 1e-6);
    // Unchanged work is not kept.
    assert!(line(command(&[]), 1).contains("there was no unsaved work"));
    assert!(!folder.path().join("state/recovery-2.json").exists());
}

#[test]
fn without_a_display_the_first_command_renders_an_image() {
    let folder = folder();
    let column = |file: &str| haze_core::assets::image::read_png(&folder.path().join(file)).unwrap();
    // Neither run replaces a file.
    for file in ["column.png", "column_2.png"] {
        let output = haze(folder.path(), "", &[], &[]).output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout);
        let reason = stderr(&output);
        assert!(output.status.success() && text.starts_with(&format!("{file}: Dense column on ")), "{text}{reason}");
        assert!(reason.lines().count() == 1 && reason.contains("to open") && reason.contains("DISPLAY"), "{reason}");
        assert_eq!((column(file).width(), column(file).height()), (1280, 720));
    }
    assert!(column("column.png") == column("column_2.png"));
}

#[test]
fn without_a_display_or_an_adapter_one_line_says_what_to_do() {
    let _lock = window_lock();
    let display = Display::start();
    let folder = folder();
    let text = line(haze(folder.path(), "", &[], &["tweak"]), 2);
    assert!(text.contains("DISPLAY") && text.contains("`haze render`"), "{text}");
    let text = line(haze(folder.path(), ":987", &[], &["tweak"]), 2);
    assert!(
        text.contains("none could be opened with DISPLAY=:987; expected ") && text.contains("`haze render`"),
        "{text}"
    );
    assert!(!text.contains(".rs"), "{text}");
    // Neither a Vulkan nor an OpenGL driver.
    let none = [
        ("VK_DRIVER_FILES", "/nonexistent"),
        ("VK_ICD_FILENAMES", "/nonexistent"),
        ("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent"),
    ];
    let text = line(haze(folder.path(), &display.name, &none, &["tweak"]), 2);
    assert!(text.contains("apt-get install mesa-vulkan-drivers") && text.contains("`haze render`"), "{text}");
}

/// Waits for a program, which must end soon and successfully.
fn wait_for_success(mut child: Child) {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() && start.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let _ = child.kill();
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
}

/// Waits until a condition holds.
fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60), "never: {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn unsaved_work_of_a_killed_window_is_offered_by_the_next_one() {
    let _lock = window_lock();
    let display = Display::start();
    let folder = folder();
    let first = folder.path().join("state/recovery-1.json");
    let second = folder.path().join("state/recovery-2.json");
    let start = || haze(folder.path(), &display.name, &[], &["tweak", "column", "--size", "700x420"]).spawn().unwrap();
    let mut client = display.connect();
    let mut child = start();
    let window = client.window();
    client.focus(window);
    // Moves the camera until the work is kept, and then once more.
    wait_until("work is kept", || {
        client.key(&[], Key::Three);
        first.exists()
    });
    client.key(&[Key::Control], Key::Three);
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = Preset::load(&first).unwrap();
    assert_ne!(kept.camera, Preset::load("column").unwrap().camera);

    let child = start();
    let window = client.window();
    // Searches the bar below the menus for its first button, from the left.
    let mut positions = (150..650).step_by(15).cycle();
    wait_for_rest(&child, ANSWERED);
    wait_until("the work is offered", || {
        client.click(positions.next().unwrap(), 45);
        // A second click before the answer to the first would hit what the bar has covered.
        wait_for_rest(&child, ANSWERED);
        !first.exists()
    });
    assert!(Preset::load(&second).unwrap() == kept);
    client.focus(window);
    wait_until("it is undone", || {
        client.key(&[Key::Control], Key::Z);
        !second.exists()
    });
    client.close(window);
    wait_for_success(child);
    let left: Vec<_> =
        std::fs::read_dir(folder.path().join("state")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["layout.json"]);
}

/// CPU time of a program, in clock ticks of a hundredth of a second.
fn cpu_ticks(child: &Child) -> u64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    let fields: Vec<_> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    fields[11..13].iter().map(|field| field.parse::<u64>().unwrap()).sum()
}

/// Time without CPU use after which an event is answered, and after which a window is idle.
const ANSWERED: Duration = Duration::from_millis(300);
const IDLE: Duration = Duration::from_millis(700);

/// Waits until a window has done the work that follows an event, and has used no CPU time for so long.
fn wait_for_rest(child: &Child, quiet: Duration) {
    wait_until("the window rests", || {
        let before = cpu_ticks(child);
        std::thread::sleep(quiet);
        cpu_ticks(child) - before <= 1
    });
}

#[test]
fn a_window_of_any_size_runs_idles_and_closes() {
    let _lock = window_lock();
    let display = Display::start();
    let folder = folder();
    let mut child = haze(folder.path(), &display.name, &[], &["tweak", "column", "--size", "700x420"]).spawn().unwrap();
    let mut client = display.connect();
    let window = client.window();
    wait_for_rest(&child, IDLE);
    for (width, height) in [(1, 1), (3, 900), (1500, 2), (64, 64), (700, 420)] {
        client.resize(window, width, height);
        wait_for_rest(&child, IDLE);
        assert!(child.try_wait().unwrap().is_none(), "{width}x{height}");
    }
    client.unmap(window);
    wait_for_rest(&child, IDLE);
    client.map(window);
    wait_for_rest(&child, IDLE);
    client.close(window);
    wait_for_success(child);
}
