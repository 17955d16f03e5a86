//! Translation of a material's WGSL to HLSL and GLSL by naga.

use haze::{Error, FieldError};
use naga::back::{glsl, hlsl};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage, front};

/// Name of the entry point that the GLSL back end asks for; everything from it on is left out.
const ENTRY_POINT: &str = "haze_entry_point";

/// Returns the functions of a material as HLSL. `Texture2D` and `SamplerState` are parameters.
pub fn hlsl_functions(wgsl: &str) -> Result<String, Error> {
    let (module, info) = parse(wgsl)?;
    let options = hlsl::Options { shader_model: hlsl::ShaderModel::V5_0, ..hlsl::Options::default() };
    let mut text = String::new();
    let pipeline = hlsl::PipelineOptions::default();
    let written = hlsl::Writer::new(&mut text, &options, &pipeline).write(&module, &info, None);
    written.map_err(|error| untranslated("HLSL", &error))?;
    Ok(text.trim().to_owned() + "\n")
}

/// Returns the functions of a material as GLSL ES 3.0, without a header. `sampler2D` are parameters.
pub fn glsl_functions(wgsl: &str) -> Result<String, Error> {
    let entry_point = format!("{wgsl}\n@fragment fn {ENTRY_POINT}() -> @location(0) vec4f {{ return vec4f(0.0); }}\n");
    let (module, info) = parse(&entry_point)?;
    let options = glsl::Options {
        version: glsl::Version::Embedded { version: 300, is_webgl: false },
        writer_flags: glsl::WriterFlags::empty(),
        ..glsl::Options::default()
    };
    let pipeline =
        glsl::PipelineOptions { shader_stage: ShaderStage::Fragment, entry_point: ENTRY_POINT.into(), multiview: None };
    let mut text = String::new();
    let policies = BoundsCheckPolicies::default();
    let written = glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write());
    written.map_err(|error| untranslated("GLSL", &error))?;
    let body = text.split("void main()").next().unwrap_or_default();
    let is_header = |line: &&str| ["#version", "precision ", "layout("].iter().any(|start| line.starts_with(start));
    // Godot chooses the precision of textures itself.
    let plain = |line: &str| line.replace("highp sampler2D", "sampler2D") + "\n";
    let kept: String = body.lines().filter(|line| !is_header(line)).map(plain).collect();
    Ok(kept.trim().to_owned() + "\n")
}

fn parse(wgsl: &str) -> Result<(Module, ModuleInfo), Error> {
    let module = front::wgsl::parse_str(wgsl).map_err(|error| untranslated("WGSL", &error.emit_to_string(wgsl)))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    let info = validator.validate(&module).map_err(|error| untranslated("WGSL", &error.emit_to_string(wgsl)))?;
    Ok((module, info))
}

/// Error of a step that fails for no preset.
pub fn untranslated(language: &str, error: &dyn std::fmt::Display) -> Error {
    let problem = format!("the material was not translated to {language}: {error}");
    FieldError::from_problem("material", problem, "a report of this bug").into()
}
