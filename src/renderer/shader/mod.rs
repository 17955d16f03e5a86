//! WGSL sources, and their composition from `#import "FILE"` lines.
//!
//! An import is replaced by the text of the file, once per composed shader. Names are not changed, so driver messages,
//! frame captures and searches show the names of the sources. (naga_oil renames imported items.)

mod compose;
mod embedded;
mod naga_messages;
mod nesting;
mod shader_module;
mod sources;

pub use embedded::{source, sources};
pub use sources::Sources;

pub(crate) use shader_module::{checked_shader, embedded_shader};

use haze_core::error::PrepareError;

/// Replaces every `#import "lib/X.wgsl"` line of `text` by that embedded file, and the imports in it, each file once.
/// Hosts can use it to call haze's functions from their own shaders.
///
/// # Errors
/// Names the line of an import that is not an embedded file.
pub fn compose(text: &str) -> Result<String, String> {
    match Sources::embedded().compose_text(text) {
        Ok(composed) => Ok(composed.text),
        Err(PrepareError::Shader { line, reason, .. }) => Err(format!("line {line}: {reason}")),
        Err(other) => Err(other.to_string()),
    }
}

/// Returns the WGSL function `haze_transmittance(world_position: vec3f, light: u32) -> vec3f` for a host's shaders: the
/// fraction of a light that reaches a point through the smoke. It is composed text, to be placed before the host's own.
/// `group`: the group at which the host binds [`Renderer::scene_shadow_bind_group`](crate::Renderer::scene_shadow_bind_group).
pub fn scene_shadow_wgsl(group: u32) -> String {
    let text = Sources::embedded().compose_text("#import \"lib/haze_transmittance.wgsl\"\n");
    // The embedded file exists: the tests compose it.
    text.map(|composed| composed.text).unwrap_or_default().replace("@group(3)", &format!("@group({group})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_imported_once() {
        let composed = compose("#import \"lib/sprite_vertex.wgsl\"\n#import \"lib/view.wgsl\"\n").unwrap();
        assert_eq!(composed.matches("struct View {").count(), 1);
        assert!(!composed.contains("#import"));
    }

    #[test]
    fn an_unknown_import_is_named_with_its_line() {
        let error = compose("fn f() {}\n#import \"lib/nothing.wgsl\"\n").unwrap_err();
        assert_eq!(error, "line 2: there is no shader file \"lib/nothing.wgsl\" to import");
    }
}
