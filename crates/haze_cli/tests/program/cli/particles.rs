//! Particle files of a simulation: named in a preset or on the command line, checked, shown, copied, rendered.

use std::path::Path;

use super::{folder, haze, refusal, render, stderr};

/// Three frames of two particles, as Houdini writes them.
fn simulate(folder: &Path) {
    for frame in 7..10 {
        let text = format!("id,P[x],P[y],P[z],pscale,Alpha\n1,0,1.{frame},0,0.8,1\n2,0.5,1,0,0.6,0.9\n");
        std::fs::write(folder.join(format!("smoke_{frame:04}.csv")), text).unwrap();
    }
}

#[test]
fn particle_files_set_on_the_command_line_are_rendered() {
    let folder = folder();
    simulate(folder.path());
    let render = |output: &str, set: &[&str]| {
        let arguments = ["render", "column", "--size", "96x54", "--backend", "cpu", "--time", "0.05", "-o", output];
        let output_of = haze(folder.path(), &[&arguments[..], set].concat());
        assert!(output_of.status.success(), "{}", stderr(&output_of));
        std::fs::read(folder.path().join(output)).unwrap()
    };
    let path = "systems[0].particle_files.path=smoke_####.csv";
    let drawn = render("a.png", &["--set", path]);
    assert_ne!(drawn, render("b.png", &["--set", path, "--set", "particle_files.up=z"]));
    assert_ne!(drawn, render("c.png", &["--set", path, "--set", "particle_files.start=1"]));
    // A sequence of images.
    let arguments = ["render", "column", "--size", "32x18", "--backend", "cpu", "--frames", "0..2", "-o", "f_%04d.png"];
    let output = haze(folder.path(), &[&arguments[..], &["--set", path]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    // The files are also found in the shared folder.
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let line = refusal(&folder.path().join("sub"), &["render", "-o", "d.png", "--set", path]);
    assert!(line.contains("systems[0].particle_files.path: ") && line.contains("No such file in "), "{line}");
    let shared = ["render", "--size", "32x18", "--backend", "cpu", "-o", "d.png", "--set", path, "--assets", ".."];
    assert!(haze(&folder.path().join("sub"), &shared).status.success());
}

#[test]
fn rendering_says_which_columns_are_not_used() {
    let folder = folder();
    std::fs::write(folder.path().join("a.csv"), "x,y,z,nx,heat\n0,1,0,0,1\n").unwrap();
    let said = |more: &[&str]| {
        let arguments = ["column", "--set", "systems[0].particle_files.path=a.csv"];
        let output = render(folder.path(), &[&arguments[..], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let start = "haze: systems[0].particle_files.path: a.csv: ";
    let unread = format!("{start}nx: not read; expected names that docs/particles.md lists\n");
    assert_eq!(said(&[]), format!("{unread}{start}heat: no effect; expected a fire.intensity above 0\n"));
    assert_eq!(said(&["--set", "fire.intensity=1"]), unread);
}

#[test]
fn particle_files_are_checked_shown_and_copied_with_their_preset() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    simulate(folder.path());
    let write = |name: &str| {
        let files = format!(r#"{{"path": "{name}", "units": 0.01, "up": "z"}}"#);
        let system = format!(r#"{{"name": "s", "particle_files": {files}, "emitter": {{"rate": 9}}}}"#);
        let text = format!(r#"{{"version": 1, "name": "x", "systems": [{system}]}}"#);
        std::fs::write(path("my.json"), text).unwrap();
    };
    write("smoke_####.csv");
    let check = haze(folder.path(), &["preset", "check", "my.json"]);
    let said = String::from_utf8(check.stdout).unwrap();
    let read = "systems[0].particle_files.path: smoke_0007.csv: position from P[x], P[y], P[z]; radius from pscale; amount from Alpha; id from id";
    assert_eq!(
        said,
        format!("my.json: good\n  {read}\n  systems[0].emitter.rate has no effect: the particles come from files\n")
    );
    let show = haze(folder.path(), &["preset", "show", "my.json", "--changed"]);
    let said = String::from_utf8(show.stdout).unwrap();
    for wanted in [
        "systems[0].particle_files.path",
        "\"smoke_####.csv\"",
        "default \"\"",
        "systems[0].particle_files.units",
        "0.01",
        "\"z\"",
    ] {
        assert!(said.contains(wanted), "{said}");
    }
    assert!(haze(folder.path(), &["preset", "new", "copy/own", "--from", "my.json"]).status.code() == Some(0));
    for name in ["smoke_0007.csv", "smoke_0009.csv"] {
        assert_eq!(std::fs::read(path("copy").join(name)).unwrap(), std::fs::read(path(name)).unwrap());
    }
    write("smok_####.csv");
    let line = refusal(folder.path(), &["preset", "check", "my.json"]);
    assert!(
        line.contains("my.json: systems[0].particle_files.path: ")
            && line.contains("nearest name is \"smoke_0007.csv\""),
        "{line}"
    );
    write("smoke_####.csv");
    std::fs::write(path("smoke_0008.csv"), "x,y,z\n1,2\n").unwrap();
    let line = refusal(folder.path(), &["preset", "check", "my.json"]);
    assert!(line.trim_end().ends_with("smoke_0008.csv:2:4: 2 cells; expected 3, one for each column"), "{line}");
}
