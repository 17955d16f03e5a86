//! Choice of an adapter, by speed or by environment variables.

use haze_core::error::{Error, FieldError};

use super::address_space::check_address_space;

/// Hint for machines without an adapter.
const NO_ADAPTER_HINT: &str = "no graphics adapter was found; on Debian and Ubuntu \
    `apt-get install mesa-vulkan-drivers` installs a software one";

/// Returns the fastest adapter, or the one that `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` select.
pub(super) fn find_adapter() -> Result<wgpu::Adapter, Error> {
    check_address_space()?;
    let variable = |name| std::env::var_os(name).unwrap_or_default().to_string_lossy().into_owned();
    let backends = variable("WGPU_BACKEND");
    let name = variable("WGPU_ADAPTER_NAME");
    let built_in = wgpu::Instance::enabled_backend_features();
    let list = || {
        let names: Vec<_> = wgpu::Backend::ALL.into_iter().filter(|&b| built_in.contains(b.into())).collect();
        names.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
    };
    let mut wanted = wgpu::Backends::all();
    if !backends.is_empty() {
        wanted = wgpu::Backends::from_comma_list(&backends);
        if wanted.is_empty() {
            return Err(
                FieldError::new("WGPU_BACKEND", format!("{backends:?}"), format!("one or more of {}", list())).into()
            );
        }
    }
    let mut others = Vec::new();
    // OpenGL last: opening it prints warnings on machines without a display.
    for group in [wgpu::Backends::PRIMARY, wgpu::Backends::SECONDARY] {
        let group = group & wanted & built_in;
        if group.is_empty() {
            continue;
        }
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: group,
            ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
        });
        if name.is_empty() {
            let options = wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                ..Default::default()
            };
            if let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) {
                return Ok(adapter);
            }
        } else {
            for adapter in pollster::block_on(instance.enumerate_adapters(group)) {
                let info = adapter.get_info();
                if info.name.to_lowercase().contains(&name.to_lowercase()) {
                    return Ok(adapter);
                }
                others.push(format!("{:?} ({})", info.name, info.backend));
            }
        }
    }
    if !others.is_empty() {
        let expected = format!("a part of a name: {}", others.join(" or "));
        return Err(FieldError::new("WGPU_ADAPTER_NAME", format!("{name:?}"), expected).into());
    }
    let mut reason = NO_ADAPTER_HINT.to_owned();
    if !backends.is_empty() {
        reason += &format!("; WGPU_BACKEND allows only {backends:?} of {}", list());
    }
    Err(Error::NoDevice(reason))
}
