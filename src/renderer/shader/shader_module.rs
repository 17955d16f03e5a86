//! Shader modules from sources, with compiler errors located in the file that contains them.

use std::convert::Infallible;

use super::compose::Composed;
use super::naga_messages::{plain, pointed_at};
use super::sources::Sources;
use crate::error::Error;
use crate::renderer::gpu::error_scopes::{answer, checked};
use crate::renderer::gpu::pipeline::Shader;

/// Creates the embedded shader of a pass.
pub(crate) fn embedded_shader(device: &wgpu::Device, name: &'static str) -> Result<Shader, Infallible> {
    // A test composes every embedded shader, so this cannot fail. The device would report an empty module like any
    // other error.
    let composed = Sources::embedded().compose(&file_of(name)).unwrap_or_default();
    Ok(Shader { module: create(device, name, &composed), path: composed.path })
}

/// Creates the shader of a pass from sources that may contain errors.
///
/// # Errors
/// [`Error::Shader`]: the first error.
pub(crate) fn checked_shader(device: &wgpu::Device, name: &'static str, sources: &Sources) -> Result<Shader, Error> {
    let composed = sources.compose(&file_of(name))?;
    let mut module = None;
    let created = checked(device, || module.insert(create(device, name, &composed)).clone());
    match created {
        Ok(module) => Ok(Shader { module, path: composed.path }),
        Err(reason) => Err(sources.find_unclosed_bracket().unwrap_or_else(|| {
            let info = module.and_then(|module| answer(module.get_compilation_info()));
            match info.and_then(|info| info.messages.into_iter().next()) {
                Some(wgpu::CompilationMessage { message, location: Some(place), .. }) => {
                    let of_naga = || {
                        let line = place.line_number as usize;
                        (line, composed.column(line, place.line_position as usize))
                    };
                    let (line, column) = pointed_at(&message, &composed.text).unwrap_or_else(of_naga);
                    composed.mistake(line, column, &plain(&message))
                }
                _ => composed.mistake(1, 1, &reason),
            }
        })),
    }
}

fn file_of(name: &str) -> String {
    format!("{name}.wgsl")
}

fn create(device: &wgpu::Device, name: &'static str, composed: &Composed) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(composed.text.as_str().into()),
    })
}
