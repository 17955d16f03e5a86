//! Thousands of valid and broken file versions: memory and open files must not grow.

use std::fs;
use std::path::Path;

use haze_preset::Preset;

use super::{Bench, COLOR, SIZE, write_ramp};
use crate::document::history::MAX_STEPS;
use crate::window::testing::screenshot;

/// Resources of the process.
#[derive(Clone, Copy)]
struct Held {
    /// Open files.
    files: u64,
    /// Resident memory, bytes.
    resident: u64,
    /// Bytes that are allocated and not freed.
    live: u64,
}

impl Held {
    fn now() -> Self {
        let status = fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
        let kilobytes: u64 = line.trim().trim_end_matches(" kB").parse().unwrap();
        let files = fs::read_dir("/proc/self/fd").unwrap().count() as u64;
        Self { files, resident: kilobytes * 1024, live: live() }
    }
}

impl std::fmt::Display for Held {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} files, {} KiB in use, {} KiB resident", self.files, self.live / 1024, self.resident / 1024)
    }
}

/// Bytes allocated according to the allocator, including those of the driver.
fn live() -> u64 {
    #[cfg(target_env = "gnu")]
    #[allow(unsafe_code, reason = "glibc has no safe wrapper; the call takes no arguments and is always allowed")]
    {
        // glibc: the fifth field counts bytes in mmapped chunks, the eighth those in all other chunks in use.
        #[repr(C)]
        struct Mallinfo2([usize; 10]);
        unsafe extern "C" {
            fn mallinfo2() -> Mallinfo2;
        }
        let Mallinfo2(info) = unsafe { mallinfo2() };
        (info[4] + info[7]) as u64
    }
    #[cfg(not(target_env = "gnu"))]
    0
}

/// Saves valid and broken shaders alternately, with an import of their own.
fn reload_shaders(bench: &mut Bench, count: u32) {
    let path = bench.path("shaders/lib/color.wgsl");
    for index in 0..count {
        let good = format!("#import \"lib/mine.wgsl\"\n// {index}\n{COLOR}");
        let (text, is_good) = match index % 4 {
            0 | 2 => (good, true),
            1 => (good.replace("saturate(light)", &format!("saturate{index}(light)")), false),
            _ => (good.replace("lib/mine.wgsl", &format!("lib/mine_{index}.wgsl")), false),
        };
        fs::write(bench.path("shaders/lib/mine.wgsl"), format!("const MINE = {index};")).unwrap();
        fs::write(&path, text).unwrap();
        bench.until(|bench| match is_good {
            true => {
                bench.said().is_none() && format!("{:?}", bench.session().shaders).contains(&format!("// {index}\\n"))
            }
            false => bench.said().is_some_and(|said| said.contains(&index.to_string())),
        });
        if index % 10 == 0 {
            screenshot(&mut bench.window);
        }
    }
    fs::write(&path, COLOR).unwrap();
    bench.until(|bench| bench.said().is_none());
    bench.rest();
}

/// Writes a sprite of one frame with this alpha.
fn write_sheet(folder: &Path, alpha: u8) {
    let inside = |x, y| (1..31).contains(&x) && (1..31).contains(&y);
    let texel = |x, y| image::Rgba([128, 128, 255, if inside(x, y) { alpha } else { 0 }]);
    let image = image::RgbaImage::from_fn(32, 32, texel);
    haze_preset::write_png(&folder.join("sheet.png"), &image.into(), haze_preset::CompressionEffort::Quick).unwrap();
}

/// Saves broken and valid files of every kind alternately.
fn reload(bench: &mut Bench, count: u32) {
    let folder = bench.folder.path().to_owned();
    let path = bench.path("my.json");
    let shader = bench.path("shaders/lib/color.wgsl");
    let before = fs::read_to_string(&path).unwrap();
    write_sheet(&folder, 90);
    let mut preset = Preset::load(&path).unwrap();
    preset.systems[0].material.sprite = "sheet.png".into();
    fs::write(&path, preset.to_json("")).unwrap();
    bench.until(|bench| bench.session().document.preset == preset);
    bench.rest();
    for index in 0..count {
        let images = bench.images();
        let is_good = index % 2 == 1;
        // A shader takes as long as all the others together.
        let kind = index / 2 % 5;
        match (kind, is_good) {
            (0 | 4, true) => write_ramp(&folder, (index % 251) as u8),
            (0 | 4, false) => fs::write(folder.join("mine.png"), "no image").unwrap(),
            (1, true) => write_sheet(&folder, 1 + (index % 251) as u8),
            (1, false) => fs::write(folder.join("sheet.png"), "no image").unwrap(),
            (2, true) => {
                preset.name = format!("column {index}");
                fs::write(&path, preset.to_json("")).unwrap();
            }
            (2, false) => fs::write(&path, &before[..before.len() / 2]).unwrap(),
            (_, true) => fs::write(&shader, format!("// {index}\n{COLOR}")).unwrap(),
            (_, false) => {
                fs::write(&shader, COLOR.replace("saturate(light)", &format!("saturate{index}(light)"))).unwrap();
            }
        }
        bench.until(|bench| match (kind, is_good) {
            (_, false) => bench.said().is_some(),
            (2, true) => bench.said().is_none() && bench.session().document.preset.name == preset.name,
            (3, true) => {
                bench.said().is_none() && format!("{:?}", bench.session().shaders).contains(&format!("// {index}\\n"))
            }
            (_, true) => bench.said().is_none() && !bench.images().shares_memory(&images),
        });
        if index % 50 == 0 {
            screenshot(&mut bench.window);
        }
    }
    fs::write(&path, &before).unwrap();
    fs::write(&shader, format!("// at rest\n{COLOR}")).unwrap();
    bench.until(|bench| {
        let is_last = format!("{:?}", bench.session().shaders).contains("// at rest\\n");
        is_last && bench.said().is_none() && bench.session().document.preset.name == "Dense column"
    });
    bench.rest();
}

/// Makes the allocator return free memory. It keeps about 300 MiB, the peak of compiling shaders, and more after every
/// higher peak, which would look like growth.
fn give_back() {
    #[cfg(target_env = "gnu")]
    #[allow(unsafe_code, reason = "glibc has no safe wrapper; the call takes no pointer and is always allowed")]
    {
        unsafe extern "C" {
            fn malloc_trim(pad: usize) -> i32;
        }
        unsafe { malloc_trim(0) };
    }
}

/// Returns the resources at rest. The device frees unused resources while images are drawn.
fn held_at_rest(bench: &mut Bench) -> Held {
    let looks: Vec<_> = std::iter::repeat_with(|| {
        screenshot(&mut bench.window);
        give_back();
        Held::now()
    })
    .take(20)
    .collect();
    let least = |of: fn(&Held) -> u64| looks.iter().map(of).min().unwrap();
    Held { files: least(|held| held.files), resident: least(|held| held.resident), live: least(|held| held.live) }
}

/// HAZE_RELOADS sets the number instead of 5,000. A shader takes most of a second on two cores.
fn soak(reload: fn(&mut Bench, u32)) {
    let count = std::env::var("HAZE_RELOADS").ok().and_then(|count| count.parse().ok()).unwrap_or(5000);
    let mut bench = Bench::new(SIZE);
    // Each preset read from disk is an undo step, so the history is filled first and does not grow afterwards.
    let exposure = bench.session().document.preset.camera.exposure;
    for step in 0..=MAX_STEPS {
        let document = &mut bench.session().document;
        document.preset.camera.exposure = exposure + (step % 2) as f32;
        document.track(false);
    }
    reload(&mut bench, count / 5 + 4);
    let before = held_at_rest(&mut bench);
    eprintln!("0 reloads: {before}");
    let mut after = before;
    for part in 1..=5 {
        reload(&mut bench, count / 5);
        after = held_at_rest(&mut bench);
        eprintln!("{} reloads: {after}", part * count / 5);
    }
    assert!(after.files <= before.files, "{before}; then {after}");
    // 64 bytes a reload allow for hash tables in wgpu and its allocator that grow now and then.
    assert!(after.live < before.live + 64 * u64::from(count).max(4096), "{before}; then {after}");
    // The allocator cannot return fragments between blocks in use.
    assert!(after.resident < before.resident + (16 << 20), "{before}; then {after}");
}

#[test]
#[ignore = "takes minutes; needs a process of its own"]
fn five_thousand_reloads_do_not_leak() {
    soak(reload);
}

#[test]
#[ignore = "takes many minutes; needs a process of its own"]
fn five_thousand_shader_reloads_do_not_leak() {
    soak(reload_shaders);
}

#[test]
fn alternating_valid_and_broken_files_are_handled() {
    reload(&mut Bench::new(SIZE), 20);
    reload_shaders(&mut Bench::new(SIZE), 8);
}
