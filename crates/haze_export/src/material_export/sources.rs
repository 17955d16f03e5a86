//! Source files of a material, in the language of each engine.

use haze::Error;

use crate::engine::Engine;

use super::snippet::{Function, Snippet};
use super::translation::{glsl_functions, hlsl_functions};

/// Input that only fire has.
const HEAT: &str = "heat";

/// Returns the names and texts of an engine's files.
pub fn sources(engine: Engine, snippet: &Snippet) -> Result<Vec<(&'static str, String)>, Error> {
    Ok(match engine {
        Engine::Wgsl => vec![("haze_material.wgsl", format!("{NOTE}\n{}", snippet.wgsl))],
        Engine::Unreal => {
            let functions = hlsl_functions(&snippet.wgsl)?;
            vec![
                ("haze_material.ush", format!("{NOTE}#pragma once\n\n{functions}")),
                ("custom_node.hlsl", custom_node(snippet, &functions)),
            ]
        }
        Engine::Unity => vec![("haze_material.hlsl", custom_function(snippet, &hlsl_functions(&snippet.wgsl)?))],
        Engine::Godot => vec![("haze_material.gdshader", spatial_shader(snippet, &glsl_functions(&snippet.wgsl)?))],
    })
}

const NOTE: &str = "// Light of smoke, exported from a haze preset. README.md says how to use it.\n";

/// Text that calls a function. `ramp`: expression of a ramp by its name; `sampler`: of the sampler, if the language has any.
fn call(
    function: &Function,
    ramp: impl Fn(&str) -> String,
    sampler: Option<&str>,
    input: impl Fn(&str) -> String,
) -> String {
    let sampler = sampler.filter(|_| !function.ramps.is_empty()).map(str::to_owned);
    let ramps = function.ramps.iter().map(|name| ramp(name));
    let inputs = function.inputs.iter().map(|(name, _)| input(name));
    format!("{}({})", function.name, ramps.chain(sampler).chain(inputs).collect::<Vec<_>>().join(", "))
}

/// Calls of the functions that a material has, by name.
struct Calls {
    diffuse: String,
    soft_scatter: String,
    coverage: String,
    emission: Option<String>,
}

impl Calls {
    fn new(snippet: &Snippet, call: impl Fn(&Function) -> String) -> Self {
        let find = |name: &str| snippet.functions.iter().find(|function| function.name == name).map(&call);
        let required = |name: &str| find(name).unwrap_or_default();
        Self {
            diffuse: required("haze_diffuse"),
            soft_scatter: required("haze_soft_scatter"),
            coverage: required("haze_coverage"),
            emission: find("haze_emission"),
        }
    }

    /// Sum of all light, under one light.
    fn light(&self, light_color: &str) -> String {
        let emission = self.emission.as_ref().map(|emission| format!(" + {emission}")).unwrap_or_default();
        format!("{} * {light_color} + {}{emission}", self.diffuse, self.soft_scatter)
    }
}

/// Body of a Custom node of Unreal Engine. It may not define functions, but a struct with functions.
fn custom_node(snippet: &Snippet, functions: &str) -> String {
    let (mut constants, mut body) = (String::new(), String::new());
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

/// Spatial shader of Godot, for sprites that face the camera.
fn spatial_shader(snippet: &Snippet, functions: &str) -> String {
    // Godot refuses a parameter with the name of a uniform or varying.
    let uniform = |name: &str| format!("{name}_texture");
    let uniforms = snippet.ramps.iter().map(|ramp| {
        format!("uniform sampler2D {} : source_color, filter_linear, repeat_disable;\n", uniform(ramp.name))
    });
    let uniforms: String = uniforms.collect();
    let input = |name: &str| {
        match name {
            "normal" => "NORMAL",
            "to_light" => "LIGHT",
            "to_viewer" => "VIEW",
            HEAT => "smoke_heat",
            _ => "smoke_amount",
        }
        .to_owned()
    };
    let calls = Calls::new(snippet, |function| call(function, uniform, None, input));
    let heat = match calls.emission {
        Some(_) => "// 0: cold, 1: hottest.\nuniform float smoke_heat : hint_range(0.0, 1.0) = 1.0;\n",
        None => "",
    };
    let emission = calls.emission.as_ref().map(|emission| format!(" + {emission}")).unwrap_or_default();
    let Calls { diffuse, soft_scatter, coverage, .. } = &calls;
    format!(
        "{NOTE}shader_type spatial;\n\
         render_mode blend_mix, depth_draw_never, cull_disabled, ambient_light_disabled, specular_disabled;\n\n\
         // A sprite of haze: normal/2 + 1/2 in rgb, amount in a. Not sRGB.\n\
         uniform sampler2D sprite_texture : filter_linear_mipmap, repeat_disable;\n\
         // Its columns and rows, and the frame that is shown.\n\
         uniform vec2 sprite_cells = vec2(1.0);\nuniform float sprite_frame = 0.0;\n{uniforms}{heat}\n\
         varying float smoke_amount;\n\n{functions}\n\
         // Turns the quad towards the camera.\n\
         void vertex() {{\n    vec3 size = vec3(length(MODEL_MATRIX[0]), length(MODEL_MATRIX[1]), \
         length(MODEL_MATRIX[2]));\n    \
         MODELVIEW_MATRIX = VIEW_MATRIX * mat4(\n        \
         INV_VIEW_MATRIX[0] * size.x, INV_VIEW_MATRIX[1] * size.y, INV_VIEW_MATRIX[2] * size.z, MODEL_MATRIX[3]\n    \
         );\n}}\n\n\
         void fragment() {{\n    float frame = floor(sprite_frame);\n    \
         vec2 cell = vec2(mod(frame, sprite_cells.x), floor(frame / sprite_cells.x));\n    \
         vec4 texel = texture(sprite_texture, (UV + cell) / sprite_cells);\n    smoke_amount = texel.a * COLOR.a;\n    \
         NORMAL = normalize(texel.rgb * 2.0 - 1.0);\n    ALBEDO = vec3(1.0);\n    \
         EMISSION = {soft_scatter}{emission};\n    ALPHA = {coverage};\n}}\n\n\
         // Godot multiplies the colors of lights by PI.\n\
         void light() {{\n    DIFFUSE_LIGHT += {diffuse} * LIGHT_COLOR * (ATTENUATION / PI);\n}}\n",
    )
}
