//! Describes the adapter, and the versions of wgpu and haze.

use haze::wgpu;
use haze_demo::headless::Headless;

use super::report::Adapter;

/// Returns the adapter, the driver and the versions that a report names.
pub fn adapter(gpu: &Headless) -> Adapter {
    let info = gpu.adapter.get_info();
    let revision = revision().map(|revision| format!(" ({revision})")).unwrap_or_default();
    Adapter {
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        backend: format!("{:?}", info.backend),
        software: info.device_type == wgpu::DeviceType::Cpu,
        name: info.name,
        wgpu: env!("HAZE_WGPU_VERSION").to_owned(),
        haze: format!("{}{revision}", env!("CARGO_PKG_VERSION")),
    }
}

/// Returns the git revision: `HAZE_REVISION` if it is set, else that of the source checkout; `None` without either.
fn revision() -> Option<String> {
    let found = || {
        let arguments = ["-C", env!("CARGO_MANIFEST_DIR"), "describe", "--always", "--dirty", "--exclude=*"];
        let output =
            std::process::Command::new("git").args(arguments).stderr(std::process::Stdio::null()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    std::env::var("HAZE_REVISION").ok().or_else(found)
}
