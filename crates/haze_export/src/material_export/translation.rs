//! Translation of a material's WGSL to HLSL and GLSL by naga.

use std::collections::HashSet;

use haze::FieldError;
use haze_core::error::Error;
use naga::back::{glsl, hlsl};
use naga::compact::{KeepUnused, compact};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Arena, Block, Expression, Handle, Literal, Module, ShaderStage, Statement, front};

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

/// Returns the functions as GLSL ES 3.0, without a header. `sampler2D` are parameters.
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
    Ok(kept)
}

fn parse(wgsl: &str) -> Result<(Module, ModuleInfo), Error> {
    let parsed = front::wgsl::parse_str(wgsl);
    let mut module = parsed.map_err(|error| untranslated("WGSL", &error.emit_to_string(wgsl)))?;
    take_branches(&mut module);
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
    let info = validator.validate(&module).map_err(|error| untranslated("WGSL", &error.emit_to_string(wgsl)))?;
    Ok((module, info))
}

/// Replaces branches on constants, which choose a mode of the settings, by the side that is taken.
fn take_branches(module: &mut Module) {
    for (_, function) in module.functions.iter_mut() {
        let body = with_taken_branches(&function.body, &function.expressions);
        let mut computed = HashSet::new();
        add_computed(&body, &mut computed);
        function.named_expressions.retain(|expression, _| computed.contains(expression));
        function.body = body;
    }
    // Results of calls that are gone would not pass validation.
    compact(module, KeepUnused::Yes);
}

fn with_taken_branches(block: &Block, expressions: &Arena<Expression>) -> Block {
    let mut kept = Block::new();
    for (statement, span) in block.span_iter() {
        let Statement::If { condition, accept, reject } = statement else {
            kept.push(statement.clone(), *span);
            continue;
        };
        let accept = with_taken_branches(accept, expressions);
        let reject = with_taken_branches(reject, expressions);
        match expressions[*condition] {
            Expression::Literal(Literal::Bool(true)) => kept.extend_block(accept),
            Expression::Literal(Literal::Bool(false)) => kept.extend_block(reject),
            _ => kept.push(Statement::If { condition: *condition, accept, reject }, *span),
        }
        if matches!(kept.last(), Some(Statement::Return { .. })) {
            break;
        }
    }
    kept
}

/// Adds the expressions that the statements of a block compute. The functions of a material have no loops.
fn add_computed(block: &Block, computed: &mut HashSet<Handle<Expression>>) {
    for statement in block {
        match statement {
            Statement::Emit(range) => computed.extend(range.clone()),
            Statement::Call { result, .. } => computed.extend(result),
            Statement::Block(inner) => add_computed(inner, computed),
            Statement::If { accept, reject, .. } => {
                add_computed(accept, computed);
                add_computed(reject, computed);
            }
            _ => {}
        }
    }
}

/// Error of a step that fails for no preset.
pub fn untranslated(language: &str, error: &dyn std::fmt::Display) -> Error {
    let problem = format!("the material was not translated to {language}: {error}");
    FieldError::from_problem("material", problem, "a report of this bug").into()
}
