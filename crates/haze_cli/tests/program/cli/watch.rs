//! `haze ramp watch`: bakes recipes whenever they are saved.

#![cfg(unix)]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use super::{MOTIF, folder, haze, refusal};

/// Timeout, long enough for a busy machine.
const TIMEOUT: Duration = Duration::from_secs(20);
/// Time after which no further line is expected.
const QUIET_TIME: Duration = Duration::from_millis(700);

/// A running `haze ramp watch`, and the lines that it prints.
struct Watching {
    child: Child,
    lines: Receiver<String>,
}

impl Watching {
    fn new(folder: &Path, arguments: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_haze"));
        command.args(["ramp", "watch"]).args(arguments).current_dir(folder);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let (send, lines) = channel();
        let streams: [Box<dyn Read + Send>; 2] =
            [Box::new(child.stdout.take().unwrap()), Box::new(child.stderr.take().unwrap())];
        for stream in streams {
            let send = send.clone();
            std::thread::spawn(move || {
                BufReader::new(stream).lines().map_while(Result::ok).for_each(|line| drop(send.send(line)));
            });
        }
        Self { child, lines }
    }

    /// Waits for one line, and checks that no other follows.
    fn says(&self, line: &str, what: &str) {
        let said = self.lines.recv_timeout(TIMEOUT).unwrap_or_default();
        assert!(said.starts_with(line), "{what}: {said}");
        self.is_still(what);
    }

    fn is_still(&self, what: &str) {
        let more = self.lines.recv_timeout(QUIET_TIME).ok();
        assert_eq!(more, None, "{what}");
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill().and_then(|()| self.child.wait());
    }
}

fn recipe(color: u32) -> String {
    format!(
        r##"{{"version": 1, "width": 2, "height": 1, "rows": [{{"stops": [{{"at": 0, "color": "#{color:06x}"}}]}}]}}"##
    )
}

fn color(path: &Path) -> u32 {
    let [r, g, b] = haze_core::assets::image::read_png(path).unwrap().to_rgb8()[(0, 0)].0;
    u32::from_be_bytes([0, r, g, b])
}

#[test]
fn every_way_of_saving_bakes_once() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let save = |name: &str, color| fs::write(path(name), recipe(color)).unwrap();
    save("a.ramp.json", 1);
    save("b.ramp.json", 1);
    let watching = Watching::new(folder.path(), &["a.ramp.json", "./b.ramp.json"]);
    let mut first = [(); 2].map(|()| watching.lines.recv_timeout(TIMEOUT).unwrap());
    first.sort();
    assert_eq!(first, ["./b.png: 2x1", "a.png: 2x1"]);
    let ways: [(&str, &dyn Fn()); 4] = [
        ("in place", &|| save("a.ramp.json", 2)),
        ("renamed over", &|| {
            save("partial", 3);
            fs::rename(path("partial"), path("a.ramp.json")).unwrap();
        }),
        ("removed and made", &|| {
            fs::remove_file(path("a.ramp.json")).unwrap();
            std::thread::sleep(Duration::from_millis(60));
            save("a.ramp.json", 4);
        }),
        ("slowly", &|| {
            let text = recipe(5);
            (1..=text.len()).for_each(|end| {
                fs::write(path("a.ramp.json"), &text[..end]).unwrap();
                std::thread::sleep(Duration::from_millis(1));
            });
        }),
    ];
    for (what, way) in ways {
        let before = color(&path("a.png"));
        way();
        watching.says("a.png: 2x1", what);
        assert_eq!(color(&path("a.png")), before + 1, "{what}");
    }
    assert_eq!(color(&path("b.png")), 1);
    // An error is reported, and the image stays.
    fs::write(path("a.ramp.json"), "{").unwrap();
    watching.says("haze: a.ramp.json:1:1", "broken");
    assert_eq!(color(&path("a.png")), 5);
    save("a.ramp.json", 6);
    watching.says("a.png: 2x1", "mended");
    assert_eq!(color(&path("a.png")), 6);
}

#[test]
fn recipes_of_a_folder_are_followed_and_painted_images_are_kept() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("painted.ramp.json"), recipe(1)).unwrap();
    assert!(haze(folder.path(), &["ramp", "bake", "painted.ramp.json"]).status.success());
    let image = fs::read(path("painted.png")).unwrap();
    fs::write(path("odd.ramp.json"), recipe(1)).unwrap();
    fs::create_dir(path("odd.png")).unwrap();
    let watching = Watching::new(folder.path(), &["."]);
    watching.says("haze: output: ./odd.png is a folder, not a file", "a folder in place of the image");
    fs::write(path("new.ramp.json"), recipe(7)).unwrap();
    watching.says("./new.png: 2x1", "new");
    fs::write(path("ball.motif.json"), MOTIF).unwrap();
    watching.says("./ball.png: 8x8", "a motif");
    fs::write(path("other.json"), "{").unwrap();
    fs::remove_file(path("new.ramp.json")).unwrap();
    watching.is_still("a file of another kind, and a deleted recipe");
    fs::write(path("new.ramp.json"), recipe(8)).unwrap();
    watching.says("./new.png: 2x1", "back");
    assert_eq!(color(&path("new.png")), 8);
    assert_eq!(fs::read(path("painted.png")).unwrap(), image);
    fs::write(path("painted.ramp.json"), recipe(2)).unwrap();
    watching.says("./painted.png: 2x1", "saved");
}

#[test]
fn painted_images_are_kept_and_baked_ones_are_replaced_after_a_restart() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let paint = |name: &str| image::RgbImage::from_pixel(2, 1, image::Rgb([9; 3])).save(path(name)).unwrap();
    let kept = "haze: output: a.png was painted, or changed after it was baked, and is kept; expected no such PNG";
    // A new recipe beside a painted image.
    paint("a.png");
    assert!(haze(folder.path(), &["ramp", "new", "-o", "a.ramp.json"]).status.success());
    let watching = Watching::new(folder.path(), &["a.ramp.json"]);
    watching.says(kept, "a painted image");
    fs::write(path("a.ramp.json"), recipe(2)).unwrap();
    watching.says(kept, "a saved recipe");
    assert_eq!(color(&path("a.png")), 0x09_0909);
    fs::remove_file(path("a.png")).unwrap();
    fs::write(path("a.ramp.json"), recipe(3)).unwrap();
    watching.says("a.png: 2x1", "a deleted image");
    drop(watching);
    // A recipe that was saved while nothing watched it.
    std::thread::sleep(Duration::from_millis(20));
    fs::write(path("a.ramp.json"), recipe(4)).unwrap();
    let watching = Watching::new(folder.path(), &["a.ramp.json"]);
    watching.says("a.png: 2x1", "restarted");
    assert_eq!(color(&path("a.png")), 4);
    // An image that is painted over while its recipe is watched.
    paint("a.png");
    fs::write(path("a.ramp.json"), recipe(5)).unwrap();
    watching.says(kept, "painted over");
    assert_eq!(color(&path("a.png")), 0x09_0909);
}

#[test]
fn ctrl_c_ends_the_watch_with_exit_code_0() {
    let folder = folder();
    fs::write(folder.path().join("a.ramp.json"), recipe(1)).unwrap();
    let mut watching = Watching::new(folder.path(), &["."]);
    watching.says("./a.png: 2x1", "begun");
    assert!(Command::new("kill").args(["-INT", &watching.child.id().to_string()]).status().unwrap().success());
    assert_eq!(watching.child.wait().unwrap().code(), Some(0));
    watching.is_still("an end");
}

#[test]
fn files_of_other_kinds_and_missing_files_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("a.json"), "{}").unwrap();
    let line = |name: &str| refusal(folder.path(), &["ramp", "watch", name]);
    assert!(line("a.json").contains("a *.ramp.json or *.motif.json file"));
    assert!(line("gone.ramp.json").starts_with("haze: gone.ramp.json: "));
}
