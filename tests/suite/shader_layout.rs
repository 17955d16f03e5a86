//! Compares definitions that exist in both Rust and WGSL: struct layouts, constants, and the numbers of setting enums.

use haze::{Particle, shader};
use haze_core::formula::uniforms::{
    EmitterUniform, LightUniform, MeasureUniform, SceneShadowUniform, ScreenShadowUniform, ShadowMapUniform,
    ShadowMarchUniform, ShadowVisibilityUniform, SplatUniform, SystemUniform, TilesUniform, UniformField, ViewUniform,
};
use haze_core::{formula, frame, settings, view_setup};
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn parse(name: &str, source: &str) -> naga::Module {
    let module =
        naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{name}:\n{}", e.emit_to_string(source)));
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{name}:\n{}", e.emit_to_string(source)));
    module
}

fn composed(file: &str) -> naga::Module {
    let source = shader::compose(shader::source(file).unwrap()).unwrap();
    parse(file, &source)
}

#[test]
fn every_shader_file_validates_without_optional_capabilities() {
    // Completed by the passes that import it, one with a buffer and one with a texture.
    let is_complete = |file: &str| file != "lib/shadow_march.wgsl";
    for (file, text) in shader::sources().iter().filter(|(file, _)| is_complete(file)) {
        parse(file, &shader::compose(text).unwrap());
    }
}

#[test]
fn uniform_buffers_have_sizes_that_webgl_takes() {
    // WebGL 2 binds multiples of 16 bytes. Others make a pass invalid, which draws nothing.
    let of_demo = ("tonemap_pass.wgsl", include_str!("../../crates/haze_demo/src/tonemap_pass.wgsl"));
    let of_library = shader::sources().iter().filter(|(file, _)| !file.starts_with("lib/"));
    for (file, text) in of_library.copied().chain([of_demo]) {
        let module = parse(file, &shader::compose(text).unwrap());
        let uniforms = module.global_variables.iter().filter(|(_, held)| held.space == naga::AddressSpace::Uniform);
        for (_, uniform) in uniforms {
            let size = module.types[uniform.ty].inner.size(module.to_ctx());
            assert_eq!(size % 16, 0, "{file}: {:?} has {size} bytes", uniform.name);
        }
    }
}

/// Override constants of a target with as many textures as it can have, for the shaders that read them.
fn full_target(module: &naga::Module) -> naga::back::PipelineConstants {
    let constants = [("ATTACHMENT_COUNT", 4.0), ("SIX_WAY_SLOT", 2.0), ("WEIGHTS_SLOT", 3.0)];
    let is_read = |name: &str| module.overrides.iter().any(|(_, constant)| constant.name.as_deref() == Some(name));
    constants.into_iter().filter(|(name, _)| is_read(name)).map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Translates one shader stage of a pass to GLSL ES 3.00, the language of WebGL2.
fn glsl_es_300(
    module: &naga::Module,
    shader_stage: naga::ShaderStage,
    entry_point: &str,
    constants: &naga::back::PipelineConstants,
) -> Result<String, String> {
    use naga::back::glsl;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(module).map_err(|error| error.to_string())?;
    let entry = Some((shader_stage, entry_point));
    let (module, info) = naga::back::pipeline_constants::process_overrides(module, &info, entry, constants)
        .map_err(|error| error.to_string())?;
    let options = glsl::Options { version: glsl::Version::new_gles(300), ..Default::default() };
    let stage = glsl::PipelineOptions { shader_stage, entry_point: entry_point.to_owned(), multiview: None };
    let mut text = String::new();
    glsl::Writer::new(&mut text, &module, &info, &options, &stage, naga::proc::BoundsCheckPolicies::default())
        .and_then(|mut writer| writer.write())
        .map_err(|error| error.to_string())?;
    Ok(text)
}

#[test]
fn every_render_pass_translates_to_webgl2() {
    for (file, _) in shader::sources().iter().filter(|(file, _)| !file.starts_with("lib/")) {
        let module = composed(file);
        // Compute passes belong to the path `tiled`, which WebGL2 does not have.
        // It cannot read multisampled depth either; `prepare` refuses it there.
        let is_compute = module.entry_points.iter().all(|entry| entry.stage == naga::ShaderStage::Compute);
        if is_compute || *file == "depth_resolve.wgsl" {
            continue;
        }
        for (stage, entry_point) in [(naga::ShaderStage::Vertex, "vertex"), (naga::ShaderStage::Fragment, "fragment")] {
            for constants in [naga::back::PipelineConstants::default(), full_target(&module)] {
                let text = glsl_es_300(&module, stage, entry_point, &constants)
                    .unwrap_or_else(|e| panic!("{file}, {entry_point}: {e}"));
                let reads_depth = text.contains("sampler2DShadow");
                assert!(!reads_depth, "{file}: sampler2DShadow: WebGL2 cannot read depth through it");
            }
        }
    }
    // Mutant: a storage buffer, which WebGL2 does not support.
    let storage = "@group(0) @binding(0) var<storage, read> a: array<f32>;
        @vertex fn vertex() -> @builtin(position) vec4f { return vec4f(a[0]); }";
    assert!(glsl_es_300(&parse("storage", storage), naga::ShaderStage::Vertex, "vertex", &Default::default()).is_err());
}

/// Returns (name, offset) of every member of a WGSL struct, and the size of the struct, in bytes.
fn wgsl_struct(module: &naga::Module, name: &str) -> (Vec<(String, u32)>, u32) {
    let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
    let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is not a struct") };
    (members.iter().map(|member| (member.name.clone().unwrap(), member.offset)).collect(), *span)
}

/// Asserts that fields and size of a Rust struct match the WGSL struct.
fn assert_layout(module: &naga::Module, wgsl: &str, fields: &[UniformField], size: usize) {
    let (members, span) = wgsl_struct(module, wgsl);
    let rust: Vec<_> = fields.iter().map(|&(name, offset, _)| (name.to_owned(), offset as u32)).collect();
    // WGSL may name padding differently; all other fields must be present and in the same order.
    let named = |list: &[(String, u32)]| -> Vec<(String, u32)> {
        list.iter().filter(|(name, _)| !name.starts_with("padding")).cloned().collect()
    };
    assert_eq!(named(&members), named(&rust), "{wgsl}");
    assert_eq!(span as usize, size, "{wgsl}");
    // The fields leave no gaps: every uploaded byte belongs to a field.
    assert_eq!(fields.iter().map(|(_, _, size)| size).sum::<usize>(), size, "{wgsl}");
}

#[test]
fn wgsl_structs_match_rust() {
    let module = composed("lib/bindings.wgsl");
    assert_layout(&module, "View", ViewUniform::FIELDS, size_of::<ViewUniform>());
    assert_layout(&module, "Light", LightUniform::FIELDS, size_of::<LightUniform>());
    assert_layout(&module, "System", SystemUniform::FIELDS, size_of::<SystemUniform>());
    assert_layout(&composed("lib/tiles.wgsl"), "Tiles", TilesUniform::FIELDS, size_of::<TilesUniform>());
    assert_layout(&composed("lib/flight.wgsl"), "Emitter", EmitterUniform::FIELDS, size_of::<EmitterUniform>());
    assert_layout(&composed("measure.wgsl"), "Measure", MeasureUniform::FIELDS, size_of::<MeasureUniform>());
    assert_layout(&composed("density_splat.wgsl"), "Splat", SplatUniform::FIELDS, size_of::<SplatUniform>());
    let screen = composed("screen_shadow.wgsl");
    assert_layout(&screen, "ScreenShadow", ScreenShadowUniform::FIELDS, size_of::<ScreenShadowUniform>());
    let scene = composed("lib/haze_transmittance.wgsl");
    assert_layout(&scene, "SceneShadow", SceneShadowUniform::FIELDS, size_of::<SceneShadowUniform>());
    let maps = composed("shadow_visibility.wgsl");
    assert_layout(&maps, "ShadowMap", ShadowMapUniform::FIELDS, size_of::<ShadowMapUniform>());
    assert_layout(&maps, "ShadowVisibility", ShadowVisibilityUniform::FIELDS, size_of::<ShadowVisibilityUniform>());
    let lit = composed("transfer_lit.wgsl");
    assert_eq!(constant(&lit, "CELL_SIDE"), f64::from(formula::smoke_tiles::CELL_SIDE));
    assert_eq!(constant(&lit, "MIN_TILE_PIXELS"), f64::from(formula::smoke_tiles::MIN_TILE_PIXELS));
    let march = composed("shadow_march.wgsl");
    assert_layout(&march, "ShadowMarch", ShadowMarchUniform::FIELDS, size_of::<ShadowMarchUniform>());
}

#[test]
fn measured_extent_is_laid_out_as_in_the_systems_uniforms() {
    let (measured, _) = wgsl_struct(&composed("measure.wgsl"), "MeasuredExtent");
    let first = std::mem::offset_of!(SystemUniform, center);
    for (name, offset) in &measured[..4] {
        let field = SystemUniform::FIELDS.iter().find(|(field, ..)| field == name).unwrap();
        assert_eq!(field.1 - first, *offset as usize, "{name}");
    }
}

#[test]
fn particle_matches_the_vertex_attributes() {
    use naga::VectorSize::{Quad, Tri};
    use std::mem::offset_of;
    // Each attribute is named after the fields that it contains.
    let attributes = [
        ("position_radius", offset_of!(Particle, position), Quad),
        ("rotation_amount_frame_age", offset_of!(Particle, rotation), Quad),
        ("velocity", offset_of!(Particle, velocity), Tri),
        // Bytes, which the hardware converts.
        ("tint_heat", offset_of!(Particle, tint), Quad),
    ];
    assert_eq!(attributes.map(|(_, offset, _)| offset), [0, 16, 32, 44]);
    let others = [offset_of!(Particle, radius), offset_of!(Particle, amount), offset_of!(Particle, frame)];
    assert_eq!(others, [12, 20, 24]);
    assert_eq!((offset_of!(Particle, age), offset_of!(Particle, heat)), (28, 47));
    assert_eq!(size_of::<Particle>(), 48);
    for file in ["accumulate.wgsl", "forward.wgsl"] {
        let module = composed(file);
        let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Particle")).unwrap();
        let naga::TypeInner::Struct { members, .. } = &ty.inner else { panic!("{file}: Particle is not a struct") };
        assert_eq!(members.len(), attributes.len(), "{file}");
        for (index, (member, (name, _, size))) in members.iter().zip(&attributes).enumerate() {
            assert_eq!(member.name.as_deref(), Some(*name), "{file}");
            let location = match member.binding {
                Some(naga::Binding::Location { location, .. }) => location as usize,
                _ => panic!("{file}: {name} has no location"),
            };
            assert_eq!(location, index, "{file}");
            let vector = naga::TypeInner::Vector { size: *size, scalar: naga::Scalar::F32 };
            assert_eq!(module.types[member.ty].inner, vector, "{file}");
        }
    }
}

/// Returns the value of a module constant.
fn constant(module: &naga::Module, name: &str) -> f64 {
    let (_, constant) = module
        .constants
        .iter()
        .find(|(_, constant)| constant.name.as_deref() == Some(name))
        .unwrap_or_else(|| panic!("no constant {name}"));
    match module.global_expressions[constant.init] {
        naga::Expression::Literal(naga::Literal::F32(value)) => f64::from(value),
        naga::Expression::Literal(naga::Literal::U32(value)) => f64::from(value),
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn wgsl_constants_match_rust() {
    let transfer = composed("transfer.wgsl");
    assert_eq!(constant(&transfer, "MAX_LIGHTS"), frame::MAX_LIGHTS as f64);
    assert_eq!(constant(&transfer, "SKY_VIEW_DEPTH"), f64::from(formula::depth::SKY_VIEW_DEPTH));
    let attachments = view_setup::MAX_TARGET_ATTACHMENTS as f64;
    assert_eq!(constant(&transfer, "MAX_TARGET_ATTACHMENTS"), attachments);
    let accumulate = composed("accumulate.wgsl");
    assert_eq!(constant(&accumulate, "OPTICAL_DEPTH_KNOTS"), formula::order::OPTICAL_DEPTH_KNOTS as f64);
    assert_eq!(constant(&accumulate, "MAX_MAGNITUDE"), f64::from(frame::MAX_MAGNITUDE));
    assert_eq!(constant(&accumulate, "MOTION_RANGE"), f64::from(formula::sprite::MOTION_RANGE));
    assert_eq!(constant(&transfer, "SURFACE_DEPTH_TOLERANCE"), f64::from(formula::upsample::SURFACE_DEPTH_TOLERANCE));
    assert_eq!(constant(&transfer, "MAX_HALF_FLOAT_LIGHT"), f64::from(formula::color::MAX_HALF_FLOAT_LIGHT));
    assert_eq!(constant(&transfer, "SMOKE_DEPTH_TOLERANCE"), f64::from(formula::upsample::SMOKE_DEPTH_TOLERANCE));
    assert_eq!(constant(&transfer, "VISIBILITY_TAPS"), f64::from(formula::lighting::VISIBILITY_TAPS));
    let accumulate = composed("tile_accumulate.wgsl");
    assert_eq!(constant(&accumulate, "RUN"), f64::from(formula::tiles::RUN));
    assert_eq!(constant(&accumulate, "BITS_PER_WORD"), f64::from(formula::tiles::BITS_PER_WORD));
    assert_eq!(constant(&accumulate, "NO_LIST"), f64::from(formula::tiles::NO_LIST));
    assert_eq!(constant(&accumulate, "HIDDEN_KEY"), f64::from(formula::tiles::HIDDEN_KEY));
    assert_eq!(constant(&accumulate, "OPAQUE"), f64::from(formula::tiles::OPAQUE));
    let maps = composed("shadow_visibility.wgsl");
    assert_eq!(constant(&maps, "MAX_SHADOW_LAYERS"), formula::shadow_map::MAX_SHADOW_LAYERS as f64);
    assert_eq!(constant(&transfer, "DEPTH_SAMPLES"), f64::from(formula::depth_moments::DEPTH_SAMPLES));
    let march = composed("shadow_march.wgsl");
    assert_eq!(constant(&march, "SHADOWED_LIGHTS"), formula::shadow::SHADOWED_LIGHTS as f64);
    assert_eq!(constant(&march, "LIGHTS_PER_BLOCK"), formula::shadow::LIGHTS_PER_BLOCK as f64);
    assert_eq!(constant(&march, "LIGHT_BLOCKS"), formula::shadow::LIGHT_BLOCKS as f64);
    assert_eq!(constant(&march, "SKY_DIRECTIONS"), formula::ambient::SKY_DIRECTIONS as f64);
    assert_eq!(constant(&march, "SKY_STEPS"), f64::from(formula::ambient::SKY_STEPS));
    assert_eq!(constant(&march, "SHADOW_STEPS"), f64::from(formula::shadow::SHADOW_STEPS));
    assert_eq!(constant(&march, "MAX_OPTICAL_DEPTH"), f64::from(formula::shadow::MAX_OPTICAL_DEPTH));
}

macro_rules! assert_choices {
    ($module:expr, $prefix:literal, $choice:ty) => {
        for &choice in <$choice>::ALL {
            let name = format!("{}_{}", $prefix, choice.name().to_uppercase());
            assert_eq!(constant(&$module, &name), f64::from(choice as u32), "{name}");
        }
    };
}

#[test]
fn wgsl_constants_of_setting_enums_match_rust() {
    let transfer = composed("transfer.wgsl");
    assert_choices!(transfer, "UPSAMPLE", settings::Upsample);
    assert_choices!(transfer, "NORMAL_ENCODING", settings::NormalEncoding);
    assert_choices!(transfer, "NORMAL_DECODE", settings::NormalDecode);
    assert_choices!(transfer, "DIFFUSE_MODE", settings::DiffuseMode);
    assert_choices!(transfer, "SOFT_SCATTER_MODE", settings::SoftScatterMode);
    assert_choices!(transfer, "BACKLIGHT", settings::Backlight);
    assert_choices!(transfer, "COVERAGE_MODE", settings::CoverageMode);
    assert_choices!(transfer, "RAMP_FILTER", settings::RampFilter);
    assert_choices!(transfer, "DEBUG_VIEW", settings::DebugView);
    let accumulate = composed("accumulate.wgsl");
    assert_choices!(accumulate, "FADE_CURVE", settings::FadeCurve);
    assert_choices!(accumulate, "TECHNIQUE", settings::Technique);
    assert_choices!(accumulate, "SPRITE_ANIMATION", settings::SpriteAnimation);
    assert_choices!(composed("depth_downsample.wgsl"), "DEPTH_DOWNSAMPLE", settings::DepthDownsample);
    assert_choices!(composed("forward.wgsl"), "BLEND_MODE", settings::BlendMode);
    assert_choices!(composed("lib/tonemap.wgsl"), "TONEMAP", settings::Tonemap);
    assert_choices!(composed("lib/flight.wgsl"), "EMITTER_SHAPE", haze_core::emitter::EmitterShape);
}
