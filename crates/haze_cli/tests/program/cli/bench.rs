//! `haze bench`: outputs, interruption, comparison of runs.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{folder, haze, refusal, stderr};

const SMALL: [&str; 6] = ["--quick", "--seconds", "0", "--size", "64x36", "--json"];

/// Runs a suite briefly and returns its JSON report.
fn run(folder: &Path, suite: &str, more: &[&str]) -> Value {
    let output = haze(folder, &[&["bench", suite], &SMALL[..], &["run.json"], more].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&fs::read(folder.join("run.json")).unwrap()).unwrap()
}

/// Files of a run of the suite `scale`, which several tests read.
struct ScaleRun {
    json: Vec<u8>,
    csv: String,
    page: String,
    said: String,
}

impl ScaleRun {
    fn get() -> &'static Self {
        static RUN: OnceLock<ScaleRun> = OnceLock::new();
        RUN.get_or_init(|| {
            let folder = folder();
            let outputs = ["run.json", "--csv", "run.csv", "--html", "run.html"];
            let output = haze(folder.path(), &[&["bench", "scale"], &SMALL[..], &outputs].concat());
            assert!(output.status.success(), "{}", stderr(&output));
            let text = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
            Self { json: text("run.json").into(), csv: text("run.csv"), page: text("run.html"), said: stderr(&output) }
        })
    }

    fn report(&self) -> Value {
        serde_json::from_slice(&self.json).unwrap()
    }
}

fn rows(report: &Value) -> &Vec<Value> {
    report["rows"].as_array().unwrap()
}

#[test]
fn the_suite_scale_has_figures_and_says_what_it_left_out() {
    assert_has_figures("scale", &ScaleRun::get().report());
}

#[test]
fn a_run_that_takes_longer_than_it_should_says_how_long() {
    let said = &ScaleRun::get().said;
    let lines: Vec<_> = said.lines().filter(|line| line.starts_with("haze: 0 s do not suffice")).collect();
    assert!(matches!(lines[..], [line] if line.ends_with(" s")), "{said}");
}

/// A test for each suite, so that they run side by side.
macro_rules! test_suites {
    ($($name:ident: $suite:literal,)+) => { $(
        #[test]
        fn $name() {
            assert_has_figures($suite, &run(folder().path(), $suite, &[]));
        }
    )+ };
}

test_suites! {
    the_suite_auto_has_figures_and_says_what_it_left_out: "auto",
    the_suite_lights_has_figures_and_says_what_it_left_out: "lights",
    the_suite_limits_has_figures_and_says_what_it_left_out: "limits",
    the_suite_overdraw_has_figures_and_says_what_it_left_out: "overdraw",
    the_suite_particles_has_figures_and_says_what_it_left_out: "particles",
    the_suite_presets_has_figures_and_says_what_it_left_out: "presets",
    the_suite_soft_has_figures_and_says_what_it_left_out: "soft",
    the_suite_upsample_has_figures_and_says_what_it_left_out: "upsample",
}

fn assert_has_figures(suite: &str, report: &Value) {
    assert!(report["complete"] == true && report["version"] == 1, "{suite}");
    let rows = rows(report);
    assert!(rows.len() > 2, "{suite}: {report}");
    let names: BTreeSet<_> = rows.iter().map(|row| row["case"].as_str().unwrap()).collect();
    assert_eq!(names.len(), rows.len(), "{suite}: a case occurs twice");
    for row in rows {
        assert_eq!(row["suite"], suite);
        assert!(row["gpu_ms"]["median"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["path"] != "auto" || row["mode"] == "raster" || row["mode"] == "tiled", "{row}");
    }
    // Every image was right; only slow cases may be left out.
    for left in report["left_out"].as_array().unwrap() {
        assert!(left["reason"].as_str().unwrap().starts_with("a frame would take"), "{left}");
    }
}

#[test]
fn a_run_writes_json_csv_and_a_page() {
    let folder = folder();
    let ScaleRun { json, csv, page, .. } = ScaleRun::get();
    let report = ScaleRun::get().report();
    let rows = rows(&report);
    let deferred: Vec<_> = rows.iter().filter(|row| row["path"] == "raster").collect();
    // A coarser scale has fewer fragments and a larger error.
    let [full, half, eighth] = [1, 2, 8].map(|scale| deferred.iter().rfind(|row| row["scale"] == scale).unwrap());
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
    assert!(number(half, "fragments") < 0.3 * number(full, "fragments"));
    assert!(full["psnr_db"].is_null() && number(half, "psnr_db") > number(eighth, "psnr_db"));
    assert!(number(full, "flip") < 1e-6 && number(half, "flip") < number(eighth, "flip"));
    assert!(number(full, "limit_ratio") > 1.0, "{full}");

    let mut lines = csv.lines();
    let columns: Vec<_> = lines.next().unwrap().split(',').collect();
    assert_eq!(columns[..3], ["suite", "case", "size"]);
    assert!(columns.contains(&"gpu_ms.median") && columns.contains(&"limit_ratio"), "{columns:?}");
    assert_eq!(lines.clone().count(), rows.len());
    assert!(lines.all(|line| line.split(',').count() == columns.len()));

    assert!(page.contains("Cost against buffer scale") && page.contains("Cost against error"));
    // The same page is made from the JSON report.
    fs::write(folder.path().join("run.json"), json).unwrap();
    fs::write(folder.path().join("run.csv"), csv).unwrap();
    let output = haze(folder.path(), &["bench", "page", "run.json", "-o", "again.html"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(*page == fs::read_to_string(folder.path().join("again.html")).unwrap());
    refusal(folder.path(), &["bench", "page", "run.csv", "-o", "again.html"]);
    for outside in ["http:", "https:", "src=", "@import"] {
        assert!(!page.contains(outside), "{outside} needs a network");
    }
}

#[test]
fn the_page_fits_browser_windows_of_any_width() {
    let folder = folder();
    let page = &ScaleRun::get().page;
    // The browser writes into the title whether the page fits and the charts are drawn.
    let script = "<script>document.title = [document.documentElement.scrollWidth <= innerWidth, \
        document.querySelectorAll('svg circle').length > 10, \
        [...document.querySelectorAll('svg')].every(svg => svg.getBoundingClientRect().width > 250)].join()</script></body>";
    fs::write(folder.path().join("told.html"), page.replace("</body>", script)).unwrap();
    let path = format!("file://{}", folder.path().join("told.html").display());
    for width in [500, 1280] {
        let output = Command::new("chromium")
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"])
            .arg(format!("--window-size={width},900"))
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .arg(&path)
            .stderr(Stdio::null())
            .output()
            .unwrap();
        let shown = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(shown.contains("<title>true,true,true</title>"), "{width}: {}", &shown[..shown.len().min(400)]);
    }
}

/// Waits until a process handles SIGHUP, SIGINT and SIGTERM, as a run does from its first measurement on.
#[cfg(target_os = "linux")]
pub fn wait_for_handlers(child: &Child) {
    let is_handled = |line: &str| {
        let mask = line.strip_prefix("SigCgt:").and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        mask.is_some_and(|mask| [1, 2, 15].iter().all(|number| mask >> (number - 1) & 1 == 1))
    };
    let status = format!("/proc/{}/status", child.id());
    let started = Instant::now();
    while !fs::read_to_string(&status).unwrap().lines().any(is_handled) {
        // A run that has failed never handles them.
        assert!(started.elapsed() < Duration::from_secs(120), "the run does not begin");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_request_to_stop_writes_a_partial_report() {
    let runs = ["INT", "TERM", "HUP"].map(|signal| {
        let folder = folder();
        let child = Command::new(env!("CARGO_BIN_EXE_haze"))
            .args(["bench", "scale", "--quick", "--seconds", "600", "--size", "64x36", "--json", "run.json"])
            .current_dir(folder.path())
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        (signal, folder, child)
    });
    // A few seconds: no pipeline's compilation ends early, and the three runs share the processors.
    for (signal, folder, child) in runs {
        wait_for_handlers(&child);
        let arguments = [&format!("-{signal}"), &child.id().to_string()];
        assert!(Command::new("kill").args(arguments).status().unwrap().success());
        let asked = Instant::now();
        let output = child.wait_with_output().unwrap();
        assert!(asked.elapsed() < Duration::from_secs(6), "{signal}: {:?}", asked.elapsed());
        assert_eq!(output.status.code(), Some(1), "{signal}");
        let name = if signal == "INT" { "Ctrl-C".into() } else { format!("SIG{signal}") };
        let said = stderr(&output);
        assert!(said.contains(&format!("haze bench: stopped by {name}; the report is partial")), "{said}");
        let report: Value = serde_json::from_slice(&fs::read(folder.path().join("run.json")).unwrap()).unwrap();
        assert_eq!(report["complete"], false, "{signal}");
    }
}

#[test]
fn runs_are_compared_row_by_row() {
    let folder = folder();
    fs::write(folder.path().join("run.json"), &ScaleRun::get().json).unwrap();
    let mut report = ScaleRun::get().report();
    let compare = |arguments: &[&str]| {
        let output = haze(folder.path(), &[&["bench", "compare", "run.json", "after.json"], arguments].concat());
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned(), stderr(&output))
    };
    let write = |report: &Value| fs::write(folder.path().join("after.json"), report.to_string()).unwrap();
    write(&report);
    let (code, text, _) = compare(&[]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("geometric mean of the ratios 1.000; 0 rows are in one run only"), "{text}");
    // One row takes twice as long, with a small uncertainty.
    let row = &mut report["rows"][1];
    let slow = 2.0 * row["gpu_ms"]["median"].as_f64().unwrap();
    row["gpu_ms"] = serde_json::json!({"median": slow, "min": slow, "max": slow, "quartiles": [slow, slow]});
    row["samples"] = 1000.into();
    let before = fs::read(folder.path().join("run.json")).unwrap();
    let mut certain: Value = serde_json::from_slice(&before).unwrap();
    certain["rows"][1]["samples"] = 1_000_000.into();
    fs::write(folder.path().join("run.json"), certain.to_string()).unwrap();
    write(&report);
    let (code, text, said) = compare(&[]);
    assert_eq!((code, text.matches("  slower").count()), (Some(1), 1), "{text}");
    assert!(said.contains("1 of ") && said.contains("rows are more than 10 % slower"), "{said}");
    assert_eq!(compare(&["--slower", "150"]).0, Some(0));

    // Cases of another size are compared, and it says so; other suites have no case in common.
    let mut other = certain.clone();
    other["rows"].as_array_mut().unwrap().iter_mut().for_each(|row| row["size"] = "99x9".into());
    write(&other);
    let (code, text, said) = compare(&[]);
    assert!(code == Some(0) && text.contains("0 rows are in one run only"), "{text}");
    assert!(said.contains("differ in their size: ") && said.contains(" and 99x9; ratios"), "{said}");
    other["rows"].as_array_mut().unwrap().iter_mut().for_each(|row| row["suite"] = "upsample".into());
    write(&other);
    let said = compare(&[]).2;
    assert!(said.contains("one measures upsample, the other scale; expected runs with a suite in common"), "{said}");

    // An invalid report is refused with the position of the error.
    fs::write(folder.path().join("after.json"), "{\"version\": 1, \"rows\": [}").unwrap();
    let text = refusal(folder.path(), &["bench", "compare", "run.json", "after.json"]);
    assert!(text.contains("after.json:1:"), "{text}");
    refusal(folder.path(), &["bench", "compare", "run.json", "gone.json"]);
    refusal(folder.path(), &["bench", "compare", "run.json", "run.json", "--slower", "-1"]);
}

#[test]
fn times_that_cannot_be_compared_and_incomplete_runs_are_reported() {
    let folder = folder();
    let report = |median: &str, quartiles: &str, complete: bool| {
        let adapter =
            r#"{"name": "a", "backend": "Vulkan", "driver": "d", "software": true, "wgpu": "1", "haze": "1"}"#;
        let times = format!(r#"{{"median": {median}, "min": 0, "max": 2, "quartiles": {quartiles}}}"#);
        let row = format!(
            r#"{{"suite": "scale", "case": "full", "size": "8x8", "clock": "gpu", "samples": 9, "gpu_ms": {times},
            "passes": {{}}}}"#
        );
        format!(
            r#"{{"version": 1, "adapter": {adapter}, "complete": {complete}, "discarded": 0, "rows": [{row}],
            "left_out": []}}"#
        )
    };
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("good.json", report("1", "[1, 1]", true));
    for (median, quartiles, field) in [
        ("0", "[1, 1]", "rows[0] (scale full).gpu_ms.median: 0 is not valid; expected 1e-9 to 1e9 milliseconds"),
        ("-1", "[1, 1]", "rows[0] (scale full).gpu_ms.median: -1 is not valid"),
        ("null", "[1, 1]", "rows[0].gpu_ms.median: null is not valid"),
        ("1", "[1, 1e300]", "rows[0] (scale full).gpu_ms.quartiles[1]: 1000"),
    ] {
        write("bad.json", report(median, quartiles, true));
        for files in [["good.json", "bad.json"], ["bad.json", "good.json"]] {
            let line = refusal(folder.path(), &["bench", "compare", files[0], files[1]]);
            assert!(line.contains("bad.json:") && line.contains(field), "{line}");
        }
    }
    write("part.json", report("1", "[1, 1]", false));
    let output = haze(folder.path(), &["bench", "compare", "good.json", "part.json"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(stderr(&output), "haze: part.json: an incomplete run; only its 1 rows are compared\n");
}

#[test]
fn unwritable_outputs_are_refused_before_the_run() {
    let folder = folder();
    for output in [["--json", "none/a.json"], ["--csv", "a.json"], ["--html", "."]] {
        refusal(folder.path(), &[&["bench", "limits"][..], &output].concat());
    }
    refusal(folder.path(), &["bench", "scales"]);
}

#[test]
fn the_committed_schema_is_the_programs() {
    let folder = folder();
    let output = haze(folder.path(), &["bench", "schema"]);
    let committed = include_str!("../../../../../bench/report.schema.json");
    assert!(
        committed == String::from_utf8(output.stdout).unwrap(),
        "run `haze bench schema > bench/report.schema.json`"
    );
}
