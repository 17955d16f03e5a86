//! `--shaders`: results and errors of edited shaders on the command line.

use std::path::Path;

use super::{folder, haze, refusal, stderr};

const COLOR: &str = include_str!("../../../../../shaders/lib/color.wgsl");

fn write(folder: &Path, text: &str) {
    std::fs::create_dir_all(folder.join("shaders/lib")).unwrap();
    std::fs::write(folder.join("shaders/lib/color.wgsl"), text).unwrap();
}

#[test]
fn a_broken_shader_gives_one_line_and_a_valid_one_changes_the_image() {
    let folder = folder();
    let folder = folder.path();
    let arguments = ["render", "--size", "64x36", "--backend", "gpu", "--shaders", "shaders", "-o", "a.png"];
    let image = || {
        let output = haze(folder, &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        std::fs::read(folder.join("a.png")).unwrap()
    };
    write(folder, COLOR);
    let plain = image();
    write(folder, &COLOR.replace("return min(light,", "return min(light * 0.5,"));
    assert_ne!(image(), plain);

    write(folder, &COLOR.replace("saturate(light)", "saturat(light)"));
    let line = COLOR.lines().position(|line| line.contains("saturate(light)")).unwrap() + 1;
    let said = format!("haze: shaders/lib/color.wgsl:{line}:17: no definition in scope for identifier: `saturat`\n");
    assert_eq!(refusal(folder, &arguments), said);
    for command in ["debug-views", "techniques"] {
        assert_eq!(refusal(folder, &[command, "--size", "64x36", "--shaders", "shaders", "-o", "b.png"]), said);
    }
    let absent = refusal(folder, &["render", "--shaders", "shader", "-o", "a.png"]);
    assert!(absent.starts_with("haze: shader: No such file"), "{absent}");
}

#[test]
fn shaders_need_a_gpu() {
    let folder = folder();
    write(folder.path(), COLOR);
    let said = refusal(folder.path(), &["render", "--shaders", "shaders", "--backend", "cpu", "-o", "a.png"]);
    assert_eq!(
        said,
        "haze: --backend: cpu is not valid; expected auto or gpu with --shaders: the CPU runs no shaders\n"
    );
}
