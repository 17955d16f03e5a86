//! Files that change on disk while a window shows them: image and messages.

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use image::{Rgb, RgbImage};
use tempfile::TempDir;

use super::*;
use crate::files::export_job::ExportKind;
use crate::window::Window;
use crate::window::testing::{brightness, screenshot, window_with};

#[cfg(target_os = "linux")]
mod soak;

const COLOR: &str = include_str!("../../../../../shaders/lib/color.wgsl");

/// Preset with a ramp of its own in a temporary folder, and a window that shows it.
struct Bench {
    folder: TempDir,
    window: Harness<'static, Window>,
}

impl Bench {
    fn new(size: Vec2) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut preset = Preset::load("column").unwrap();
        preset.systems[0].material.diffuse_ramp = "mine.png".into();
        fs::write(folder.path().join("my.json"), preset.to_json("")).unwrap();
        fs::create_dir_all(folder.path().join("shaders/lib")).unwrap();
        fs::write(folder.path().join("shaders/lib/color.wgsl"), COLOR).unwrap();
        write_ramp(folder.path(), 200);
        let path = folder.path().join("my.json");
        let shaders = ShaderFolder::Given(folder.path().join("shaders"));
        let window = window_with(path.to_str().unwrap(), size, Theme::Dark, shaders);
        let mut bench = Self { folder, window };
        bench.rest();
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn session(&mut self) -> &mut Session {
        &mut self.window.state_mut().session
    }

    /// Returns the present error message.
    fn said(&mut self) -> Option<String> {
        self.session().messages.latest().filter(|message| message.is_error).map(|message| message.text.clone())
    }

    /// Runs frames until a condition holds.
    fn until(&mut self, is_so: impl Fn(&mut Self) -> bool) {
        let start = Instant::now();
        loop {
            self.window.step();
            if is_so(self) {
                return;
            }
            assert!(start.elapsed() < Duration::from_secs(30), "never; said: {:?}", self.said());
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Runs frames until no load is in progress.
    fn rest(&mut self) {
        self.until(|bench| !bench.window.state().hot_reload.worker.is_busy());
        self.window.step();
    }

    /// Returns the brightness of the viewport.
    fn shown(&mut self) -> f64 {
        let part = self.window.get_by_label("viewport").rect();
        brightness(&screenshot(&mut self.window), part)
    }

    fn images(&mut self) -> MaterialAssets {
        let preset = self.session().document.preset.clone();
        self.session().loaded_materials.of(&preset).remove(0)
    }
}

/// Expected message, and the action on a path that causes it.
type Way<'a> = (&'a str, &'a dyn Fn(&Path));

/// Writes a ramp of a single gray.
fn write_ramp(folder: &Path, gray: u8) {
    let image = RgbImage::from_pixel(64, 1, Rgb([gray; 3]));
    haze_preset::write_png(&folder.join("mine.png"), &image.into(), haze_preset::CompressionEffort::Quick).unwrap();
}

const SIZE: Vec2 = Vec2::new(640.0, 400.0);

#[test]
fn a_saved_ramp_is_shown_and_a_broken_one_is_reported_until_it_is_fixed() {
    let mut bench = Bench::new(SIZE);
    let before = bench.shown();
    let bright = bench.images();
    write_ramp(bench.folder.path(), 20);
    bench.until(|bench| !bench.images().shares_memory(&bright));
    let dark = bench.shown();
    assert!(dark < before - 3.0, "{before} {dark}");
    fs::write(bench.path("mine.png"), "no image").unwrap();
    bench.until(|bench| bench.said().is_some());
    let said = bench.said().unwrap();
    assert!(
        said.contains("my.json: systems[0].material.diffuse_ramp: ") && said.contains("mine.png: not a PNG"),
        "{said}"
    );
    assert!((bench.shown() - dark).abs() < 0.5, "the last good one stays");
    // The file is replaced in different ways.
    let good = {
        write_ramp(&bench.path("shaders"), 90);
        fs::read(bench.path("shaders/mine.png")).unwrap()
    };
    let mut huge = good.clone();
    huge[16..24].copy_from_slice(&[0, 0, 255, 255, 0, 0, 255, 255]);
    let ways: &[Way<'_>] = &[
        ("65535x65535 pixels", &|path| fs::write(path, &huge).unwrap()),
        ("ends too early", &|path| fs::write(path, &good[..good.len() / 2]).unwrap()),
        ("1073741824 bytes", &|path| fs::File::create(path).unwrap().set_len(1 << 30).unwrap()),
        ("a folder, not a file", &|path| fs::create_dir(path).unwrap()),
        #[cfg(unix)]
        ("which is not there", &|path| std::os::unix::fs::symlink("gone.png", path).unwrap()),
    ];
    for (words, way) in ways {
        let path = bench.path("mine.png");
        let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir(&path));
        way(&path);
        bench.until(|bench| bench.said().is_some_and(|said| said.contains(words)));
        assert!((bench.shown() - dark).abs() < 0.5, "{words}: the last good one stays");
    }
    fs::remove_file(bench.path("mine.png")).unwrap();
    write_ramp(bench.folder.path(), 200);
    bench.until(|bench| bench.said().is_none());
    assert!((bench.shown() - before).abs() < 0.5);
}

#[test]
fn a_shared_ramp_is_reloaded() {
    let mut bench = Bench::new(SIZE);
    let team = bench.path("team");
    let own = bench.images();
    fs::create_dir(&team).unwrap();
    write_ramp(&team, 90);
    fs::rename(team.join("mine.png"), team.join("theirs.png")).unwrap();
    bench.session().assets = Some(team.clone());
    bench.session().document.preset.systems[0].material.diffuse_ramp = "theirs.png".into();
    bench.until(|bench| !bench.images().shares_memory(&own));
    let theirs = bench.images();
    write_ramp(&team, 20);
    fs::rename(team.join("mine.png"), team.join("theirs.png")).unwrap();
    bench.until(|bench| !bench.images().shares_memory(&theirs));
    assert_eq!(bench.said(), None);
}

#[test]
fn a_changed_preset_file_is_loaded_unless_there_are_unsaved_changes() {
    let mut bench = Bench::new(SIZE);
    let path = bench.path("my.json");
    let write = |exposure: f32| {
        let mut preset = Preset::load(&path).unwrap_or_default();
        preset.camera.exposure = exposure;
        fs::write(&path, preset.to_json("")).unwrap();
    };
    // In hundredths.
    let exposure = |bench: &mut Bench| (bench.session().document.preset.camera.exposure * 100.0) as i32;
    write(1.5);
    bench.until(|bench| exposure(bench) == 150);
    assert!(!bench.session().document.is_dirty());
    fs::write(&path, "{\n\"version\": x").unwrap();
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("my.json:2:12")));
    assert_eq!(exposure(&mut bench), 150);
    fs::remove_file(&path).unwrap();
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("was deleted")));
    let saved = bench.session().document.preset.to_json("");
    fs::write(&path, saved).unwrap();
    bench.until(|bench| bench.said().is_none());
    // Changed both in the file and in the window.
    bench.session().document.preset.camera.exposure = -1.0;
    write(0.5);
    bench.until(|bench| bench.session().is_changed_on_disk);
    assert_eq!(exposure(&mut bench), -100);
    bench.window.step();
    bench.window.get_by_label("Keep my changes").click();
    bench.window.run_steps(2);
    assert!(exposure(&mut bench) == -100 && bench.session().document.is_dirty());
    assert!(bench.window.query_by_label("Keep my changes").is_none());
    write(0.25);
    bench.until(|bench| bench.session().is_changed_on_disk);
    bench.window.step();
    bench.window.get_by_label("Reload file").click();
    bench.window.run_steps(2);
    assert!(exposure(&mut bench) == 25 && !bench.session().document.is_dirty());
    bench.session().undo();
    assert_eq!(exposure(&mut bench), -100);
}

#[test]
fn a_saved_shader_is_used_and_an_error_is_reported_with_its_line() {
    let mut bench = Bench::new(SIZE);
    let before = bench.shown();
    let write = |bench: &Bench, text: &str| fs::write(bench.path("shaders/lib/color.wgsl"), text).unwrap();
    write(&bench, &COLOR.replace("saturate(light)", "saturat(light)"));
    bench.until(|bench| bench.said().is_some());
    let said = bench.said().unwrap();
    let line = COLOR.lines().position(|line| line.contains("saturate(light)")).unwrap() + 1;
    let expected = format!("color.wgsl:{line}:17: no definition in scope for identifier: `saturat`");
    assert!(said.contains(&expected), "{said}");
    assert!((bench.shown() - before).abs() < 0.5, "the last good one stays");
    write(&bench, &COLOR.replace("return min(light,", "return min(light * 0.25,"));
    bench.until(|bench| bench.said().is_none());
    bench.rest();
    let dark = bench.shown();
    assert!(dark < before - 3.0, "{before} {dark}");
    // A file that replaces a built-in shader only from now on.
    let blending = shader::source("lib/blending.wgsl").unwrap();
    fs::write(bench.path("shaders/lib/blending.wgsl"), blending.to_owned() + "\nfn (").unwrap();
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("lib/blending.wgsl:")));
    fs::remove_file(bench.path("shaders/lib/blending.wgsl")).unwrap();
    bench.until(|bench| bench.said().is_none());
}

#[test]
fn a_missing_or_binary_import_is_watched_until_it_is_fixed() {
    let mut bench = Bench::new(SIZE);
    let path = bench.path("shaders/lib/mine.wgsl");
    fs::write(bench.path("shaders/lib/color.wgsl"), format!("#import \"lib/mine.wgsl\"\n{COLOR}")).unwrap();
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("\"lib/mine.wgsl\" to import")));
    bench.rest();
    fs::write(&path, "fn mine() {}").unwrap();
    bench.until(|bench| bench.said().is_none());
    bench.rest();
    fs::write(&path, [b'f', b'n', 0xff]).unwrap();
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("mine.wgsl:1:3: not a text")));
    bench.rest();
    fs::write(&path, "fn mine() {}").unwrap();
    bench.until(|bench| bench.said().is_none());
}

#[test]
fn exports_use_the_shaders_of_the_watched_folder() {
    let mut bench = Bench::new(SIZE);
    let export = |bench: &mut Bench| {
        let window = bench.window.state_mut();
        window.export_job.options.size = glam::UVec2::new(96, 54);
        window.export_job.start(ExportKind::Image, &mut window.session);
        let path = window.export_job.take_question();
        window.export_job.answer(path, &mut window.session);
        bench.until(|bench| bench.window.state().export_job.progress().is_none());
        bench.window.run_steps(2);
        let said = bench.session().messages.latest().unwrap().text.clone();
        let image = haze_core::assets::image::read_png(Path::new(said.strip_prefix("Exported ").unwrap())).unwrap();
        image.into_rgb8().as_raw().iter().map(|byte| u32::from(*byte)).sum::<u32>()
    };
    let before = export(&mut bench);
    let dark = COLOR.replace("return min(light,", "return min(light * 0.25,");
    fs::write(bench.path("shaders/lib/color.wgsl"), dark).unwrap();
    let shaders = |bench: &mut Bench| format!("{:?}", bench.session().shaders).contains("light * 0.25");
    bench.until(shaders);
    let after = export(&mut bench);
    assert!(after * 10 < before * 9, "{before} {after}");
}

/// Returns the times from a save until the frame has the image, and until its pixels can be read, in milliseconds over
/// `count` saves; sorted.
fn latencies(bench: &mut Bench, count: u32) -> (Vec<u128>, Vec<u128>) {
    let (mut loaded, mut seen): (Vec<_>, Vec<_>) = (0..count)
        .map(|index| {
            let before = bench.images();
            let shown = screenshot(&mut bench.window);
            write_ramp(bench.folder.path(), if index % 2 == 0 { 20 } else { 200 });
            let start = Instant::now();
            bench.until(|bench| !bench.images().shares_memory(&before));
            let loaded = start.elapsed().as_millis();
            assert!(screenshot(&mut bench.window) != shown);
            (loaded, start.elapsed().as_millis())
        })
        .unzip();
    loaded.sort_unstable();
    seen.sort_unstable();
    (loaded, seen)
}

#[test]
#[ignore = "measurement; run it alone on an idle machine"]
fn a_saved_ramp_is_on_screen_within_a_quarter_of_a_second() {
    let mut bench = Bench::new(SIZE);
    bench.session().view.has_strip = false;
    let (loaded, seen) = latencies(&mut bench, 50);
    for (what, taken) in [("loaded", &loaded), ("seen", &seen)] {
        eprintln!("{what}: median {} ms, p95 {} ms, most {} ms", taken[25], taken[47], taken[49]);
    }
    assert!(seen[47] <= 250, "{seen:?}");
}

#[test]
fn particle_files_are_reloaded_and_the_last_valid_ones_stay() {
    let mut bench = Bench::new(SIZE);
    let folder = bench.folder.path().to_owned();
    let write = |frame: u32, text: &str| fs::write(folder.join(format!("smoke_{frame:04}.csv")), text).unwrap();
    let count = |bench: &mut Bench| {
        let cache = bench.session().particle_frames().remove(0);
        cache.map_or(0, |cache| cache.frames().iter().map(|(_, frame)| frame.particles().len()).sum::<usize>())
    };
    let set =
        |bench: &mut Bench, path: &str| bench.session().document.preset.systems[0].particle_files.path = path.into();
    let without = bench.shown();
    write(1, "x,y,z\n0,1,0\n");
    set(&mut bench, "smoke_####.csv");
    bench.until(|bench| count(bench) == 1);
    assert!((bench.shown() - without).abs() > 0.5, "one small sprite in place of a column");
    write(1, "x,y,z\n0,1,0\n0,2,0\n");
    bench.until(|bench| count(bench) == 2);
    // A simulation appends one frame after the other.
    for frame in 2..5 {
        write(frame, "x,y,z\n0,1,0\n");
        bench.until(|bench| count(bench) == frame as usize + 1);
    }
    write(2, "x,y,z\n0,one,0\n");
    bench.until(|bench| bench.said().is_some());
    let said = bench.said().unwrap();
    assert!(
        said.contains("my.json: systems[0].particle_files.path: ") && said.contains("smoke_0002.csv:2:3: y: \"one\""),
        "{said}"
    );
    assert_eq!(count(&mut bench), 5);
    write(2, "x,y,z\n");
    bench.until(|bench| bench.said().is_none() && count(bench) == 4);
    // A name without files keeps the present particles.
    set(&mut bench, "smok_####.csv");
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("nearest name is \"smoke_0001.csv\"")));
    assert_eq!(count(&mut bench), 4);
    set(&mut bench, "");
    bench.until(|bench| bench.said().is_none() && count(bench) == 0);
    assert!((bench.shown() - without).abs() < 0.5, "the emitter's again");
}

#[test]
fn a_changed_scene_is_shown_and_a_broken_one_leaves_the_last() {
    let mut bench = Bench::new(Vec2::new(400.0, 300.0));
    let example = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/own_scene").join(name);
    let court = fs::read(example("court.glb")).unwrap();
    fs::write(bench.path("court.glb"), &court[..300]).unwrap();
    bench.session().document.preset.environment.scene_file = "court.glb".into();
    let scene = |bench: &mut Bench| bench.session().shot(glam::UVec2::new(16, 9)).backdrop.scene;
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("environment.scene_file: ")));
    assert!(scene(&mut bench).is_none());
    fs::write(bench.path("court.glb"), &court).unwrap();
    bench.until(|bench| scene(bench).is_some());
    let shown = scene(&mut bench).unwrap();
    bench.until(|bench| bench.said().is_none());
    fs::write(bench.path("court.glb"), "no scene").unwrap();
    bench.until(|bench| bench.said().is_some_and(|said| said.contains("expected a whole glTF 2.0 file")));
    assert!(Arc::ptr_eq(&scene(&mut bench).unwrap(), &shown), "the last good scene stays");
    bench.session().document.preset.environment.scene_file.clear();
    bench.until(|bench| scene(bench).is_none() && bench.said().is_none());
}
