//! Choice of the graphics driver: by environment variables, named in the output, or missing.

use std::process::{Command, Output};

use haze::wgpu::DeviceType;
use haze_demo::headless::Headless;

use super::{folder, haze, stderr};

fn with(variables: &[(&str, &str)], arguments: &[&str]) -> Output {
    let folder = folder();
    let mut command = Command::new(env!("CARGO_BIN_EXE_haze"));
    command.args(arguments).current_dir(folder.path()).env("XDG_RUNTIME_DIR", folder.path());
    command.envs(variables.iter().copied()).output().unwrap()
}

const RENDER: [&str; 5] = ["render", "--size", "64x36", "-o", "a.png"];

#[test]
fn an_unknown_adapter_or_backend_is_refused_with_the_available_ones() {
    let adapter = Headless::new().unwrap().adapter.get_info().name;
    let backend = if cfg!(target_os = "macos") { "metal" } else { "vulkan" };
    for (variable, there) in [("WGPU_ADAPTER_NAME", adapter.as_str()), ("WGPU_BACKEND", backend)] {
        for arguments in [&RENDER[..], &["info"]] {
            let output = with(&[(variable, "nonsense")], arguments);
            let text = stderr(&output);
            assert_eq!((output.status.code(), text.lines().count()), (Some(2), 1), "{text}");
            assert!(text.starts_with(&format!("haze: {variable}: \"nonsense\"")) && text.contains(there), "{text}");
        }
    }
    assert!(with(&[("WGPU_ADAPTER_NAME", &adapter.to_uppercase())], &RENDER).status.success());
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_driver_one_line_says_so() {
    let none = [("VK_DRIVER_FILES", "/nonexistent"), ("VK_ICD_FILENAMES", "/nonexistent"), ("WGPU_BACKEND", "vulkan")];
    let gpu = with(&none, &[&RENDER[..], &["--backend", "gpu"]].concat());
    let auto = with(&none, &RENDER);
    assert_eq!((gpu.status.code(), auto.status.code()), (Some(2), Some(0)));
    for text in [stderr(&gpu), stderr(&auto)] {
        assert_eq!(text.lines().count(), 1, "{text}");
        assert!(text.contains("apt-get install") && text.contains("WGPU_BACKEND"), "{text}");
    }
}

#[test]
fn output_names_software_adapters_as_software() {
    let gpu = Headless::new().unwrap();
    let is_software = gpu.adapter.get_info().device_type == DeviceType::Cpu;
    let folder = folder();
    let bench = ["bench", "soft-particles", "--loops", "1", "--rounds", "1", "--size", "8x8"];
    for arguments in [&RENDER[..], &["info"], &bench] {
        let text = String::from_utf8(haze(folder.path(), arguments).stdout).unwrap();
        let line = text.lines().find(|line| line.contains(&gpu.description())).unwrap();
        assert_eq!(line.contains(", software)"), is_software, "{line}");
    }
}
