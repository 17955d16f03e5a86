//! Source files of a material, in the language of each engine.

use haze::FieldError;
use haze_core::error::Error;
use haze_core::settings::Settings;

use crate::engine::Engine;

use super::calls::{Calls, HEAT, NOTE, call};
use super::snippet::{Snippet, used_glsl};
use super::spatial_shader::spatial_shader;
use super::sprite_texture::SpriteTexture;
use super::three_js;
use super::translation::{glsl_functions, hlsl_functions};

/// Returns the names and texts of an engine's files.
pub fn sources(
    engine: Engine,
    settings: &Settings,
    snippet: &Snippet,
    sprite: &SpriteTexture,
) -> Result<Vec<(&'static str, String)>, Error> {
    let names: Vec<_> = snippet.functions.iter().map(|function| function.name).collect();
    Ok(match engine {
        Engine::Three => {
            let functions = used_glsl(&glsl_functions(&snippet.wgsl)?, &names);
            vec![
                (three_js::WEBGL_FILE, three_js::webgl_module(snippet, &functions)),
                (three_js::WEBGPU_FILE, three_js::webgpu_module(settings)),
                (three_js::TEXTURES_FILE, three_js::textures_module(snippet, sprite)),
            ]
        }
        Engine::Babylon | Engine::Playcanvas => {
            let name = if engine == Engine::Babylon { "babylon" } else { "playcanvas" };
            let expected = format!("unreal, unity, godot, wgsl or three; for {name}, `haze export flipbook`");
            return Err(FieldError::new("--engine", name, expected).into());
        }
        Engine::Wgsl => vec![("haze_material.wgsl", format!("{NOTE}\n{}", snippet.wgsl))],
        Engine::Unreal => {
            let functions = hlsl_functions(&snippet.wgsl)?;
            vec![
                ("haze_material.ush", format!("{NOTE}#pragma once\n\n{functions}")),
                ("custom_node.hlsl", custom_node(snippet, &functions)),
            ]
        }
        Engine::Unity => vec![("haze_material.hlsl", custom_function(snippet, &hlsl_functions(&snippet.wgsl)?))],
        Engine::Godot => {
            let functions = used_glsl(&glsl_functions(&snippet.wgsl)?, &names);
            vec![("haze_material.gdshader", spatial_shader(snippet, &functions, sprite))]
        }
    })
}

/// Body of a Custom node of Unreal Engine. It may not define functions, but a struct with functions.
fn custom_node(snippet: &Snippet, functions: &str) -> String {
    let mut constants = String::new();
    let mut body = String::new();
    for line in functions.lines() {
        let constant = line.strip_prefix("static const ").and_then(|rest| rest.strip_suffix(';'));
        match constant.and_then(|rest| rest.split_once(" = ")) {
            // A function inside a function cannot read the constants around it.
            Some((declared, value)) => {
                let name = declared.rsplit(' ').next().unwrap_or_default();
                constants += &format!("#define {name} ({value})\n");
            }
            None if line.is_empty() => body += "\n",
            None => body += &format!("    {line}\n"),
        }
    }
    let sampler = "diffuse_rampSampler";
    let calls =
        Calls::new(snippet, |function| format!("haze.{}", call(function, str::to_owned, Some(sampler), str::to_owned)));
    let light = calls.light("light_color");
    let coverage = &calls.coverage;
    let body = body.trim_end();
    format!(
        "{NOTE}// Text of a Custom node. Inputs: see README.md. Output: CMOT Float 4, light in rgb and opacity in a.\n\
         {constants}\nstruct HazeMaterial {{\n{}\n}};\n\nHazeMaterial haze;\nfloat3 light = {light};\n\
         return float4(light, {coverage});\n",
        body.trim_start_matches('\n'),
    )
}

/// Include file for a Custom Function node of Unity's Shader Graph.
fn custom_function(snippet: &Snippet, functions: &str) -> String {
    let has_heat = snippet.functions.iter().any(|function| function.inputs.iter().any(|(name, _)| *name == HEAT));
    let ramps: String = snippet.ramps.iter().map(|ramp| format!("    UnityTexture2D {},\n", ramp.name)).collect();
    let heat = if has_heat { "    float heat,\n" } else { "" };
    let ramp = |name: &str| format!("{name}.tex");
    let calls = Calls::new(snippet, |function| call(function, ramp, Some("diffuse_ramp.samplerstate"), str::to_owned));
    let light = calls.light("light_color");
    let coverage = &calls.coverage;
    format!(
        "{NOTE}#ifndef HAZE_MATERIAL\n#define HAZE_MATERIAL\n\n{functions}\n\
         // Function of the node, under the name HazeSmoke: light in `color`, not yet multiplied by `opacity`.\n\
         void HazeSmoke_float(\n{ramps}    float3 normal,\n    float3 to_light,\n    float3 to_viewer,\n    \
         float3 light_color,\n    float amount,\n{heat}    out float3 color,\n    out float opacity\n) {{\n    \
         color = {light};\n    opacity = {coverage};\n}}\n\n#endif\n",
    )
}
