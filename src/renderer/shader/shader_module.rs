//! Shader modules from sources, with compiler errors located in the file that contains them.

use std::convert::Infallible;

use haze_core::error::PrepareError;

use super::naga_messages::{marked_location, to_wgsl_terms};
use super::nesting::check_nesting;
use super::sources::Sources;
use crate::renderer::gpu::error_scopes::{poll_once, with_error_scopes};
use crate::renderer::gpu::pipeline::Shader;

/// Composes the embedded shader of a pass.
pub(crate) fn embedded_shader(name: &'static str) -> Result<Shader, Infallible> {
    // A test composes every embedded shader, so this cannot fail. The device would report an empty module like any
    // other error.
    let composed = Sources::embedded().compose(&file_of(name)).unwrap_or_default();
    Ok(Shader::new(name, composed.path, composed.text.into(), true))
}

/// Creates the shader of a pass from sources that may contain errors, or returns `known`, the shader of an earlier context, if
/// its text is the same.
///
/// # Errors
/// [`PrepareError::Shader`]: the first error.
pub(crate) fn checked_shader(
    device: &wgpu::Device,
    name: &'static str,
    sources: &Sources,
    known: Option<&Shader>,
) -> Result<Shader, PrepareError> {
    let composed = sources.compose(&file_of(name))?;
    if let Some(known) = known.filter(|known| *known.text == *composed.text) {
        return Ok(known.clone());
    }
    check_nesting(&composed.text).map_err(|deep| composed.error_at(deep.line, deep.column, &deep.reason))?;
    let shader = Shader::new(name, composed.path.clone(), composed.text.as_str().into(), false);
    match with_error_scopes(device, || _ = shader.module(device)) {
        Ok(()) => Ok(shader),
        Err(reason) => Err(sources.find_unclosed_bracket().unwrap_or_else(|| {
            let info = poll_once(shader.module(device).get_compilation_info());
            match info.and_then(|info| info.messages.into_iter().next()) {
                Some(wgpu::CompilationMessage { message, location: Some(location), .. }) => {
                    let naga_location = || {
                        let line = location.line_number as usize;
                        (line, composed.column(line, location.line_position as usize))
                    };
                    let (line, column) = marked_location(&message, &composed.text).unwrap_or_else(naga_location);
                    composed.error_at(line, column, &to_wgsl_terms(&message))
                }
                _ => composed.error_at(1, 1, &reason),
            }
        })),
    }
}

fn file_of(name: &str) -> String {
    format!("{name}.wgsl")
}
