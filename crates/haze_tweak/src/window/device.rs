//! Choice of the graphics device of a window.

use eframe::{egui_wgpu, wgpu};

/// Returns the setup for the fastest adapter, or for the one that WGPU_ADAPTER_NAME and WGPU_BACKEND name.
pub fn setup() -> egui_wgpu::WgpuSetup {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = std::sync::Arc::new(device);
    setup.into()
}

/// Returns the descriptor of a window's device, with compute shaders and timestamp queries if the adapter has them.
pub fn device(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    // Those of `haze render`, so that the window draws the same image.
    let usual = wgpu::Limits::default();
    let limits = if usual.check_limits(&adapter.limits()) { usual } else { wgpu::Limits::downlevel_webgl2_defaults() };
    let timing = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
    wgpu::DeviceDescriptor {
        label: Some("haze window"),
        required_features: timing & adapter.features(),
        required_limits: limits.using_resolution(adapter.limits()),
        ..Default::default()
    }
}
