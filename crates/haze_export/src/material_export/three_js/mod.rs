//! Modules for three.js: a material for its WebGLRenderer, and one of nodes for its WebGPURenderer.

use haze_core::settings::{Backlight, CoverageMode, RampFilter, Settings, SoftScatterMode};

use super::calls::{Calls, HEAT, NOTE, call};
use super::snippet::Snippet;
use super::sprite_texture::SpriteTexture;

const WEBGL: &str = include_str!("haze_material.js");
const WEBGPU: &str = include_str!("haze_material_webgpu.js");
const TEXTURES: &str = include_str!("haze_textures.js");

/// Names of the files.
pub const WEBGL_FILE: &str = "haze_material.js";
pub const WEBGPU_FILE: &str = "haze_material_webgpu.js";
pub const TEXTURES_FILE: &str = "haze_textures.js";

/// Text of the module that loads the textures for both.
pub fn textures_module(snippet: &Snippet, sprite: &SpriteTexture) -> String {
    let names: Vec<_> = snippet.ramps.iter().map(|ramp| format!("'{}'", ramp.name)).collect();
    filled(
        TEXTURES,
        &[
            ("RAMPS", names.join(", ")),
            ("COLUMNS", sprite.cells.x.to_string()),
            ("ROWS", sprite.cells.y.to_string()),
            ("FRAMES", sprite.frames.to_string()),
        ],
    )
}

/// Text of the material for `WebGLRenderer`. `functions`: those of the material, in GLSL.
pub fn webgl_module(snippet: &Snippet, functions: &str) -> String {
    let uniform = |name: &str| format!("haze_{name}");
    let calls = |amount: &str| {
        let input = |name: &str| {
            match name {
                "normal" => "normal",
                "to_light" => "from.direction",
                "to_viewer" => "to_viewer",
                HEAT => "haze_particle_heat",
                "age" => "hazeParticle.y",
                _ => amount,
            }
            .to_owned()
        };
        Calls::new(snippet, |function| call(function, uniform, None, input))
    };
    let diffuse = calls("amount").diffuse;
    // In `main`, the amount is what the chunk of lights calls a material.
    let calls = calls("material");
    let emission = calls.emission.as_ref().map(|emission| format!(" + {emission}")).unwrap_or_default();
    let uniforms: String =
        snippet.ramps.iter().map(|ramp| format!("uniform sampler2D {};\n", uniform(ramp.name))).collect();
    let varying = "varying float haze_particle_heat;\n";
    let heat = calls.heat.as_ref();
    let burns = |text: String| if heat.is_some() { text } else { String::new() };
    filled(
        WEBGL,
        &[
            ("VERTEX_FUNCTIONS", burns("${FUNCTIONS}".into())),
            ("HEAT_PARAMETERS", burns(format!("uniform float haze_heat;\n{varying}"))),
            ("HEAT_VARYING", burns(varying.into())),
            ("HEAT_VALUE", burns(", heat: { value: 1 }".into())),
            (
                "HEAT",
                heat.map(|by_age| format!("    haze_particle_heat = haze_heat * {by_age};\n")).unwrap_or_default(),
            ),
            ("UNIFORMS", uniforms),
            ("FUNCTIONS", functions.to_owned()),
            ("DIFFUSE", diffuse),
            ("EVEN_LIGHT", format!("{}{emission}", calls.soft_scatter)),
            ("COVERAGE", calls.coverage.clone()),
        ],
    )
}

/// Fraction that a color of a coverage or heat ramp stands for: `painted_fraction` of the shaders.
const PAINTED: &str = "\
const paintedFraction = paint => tsl.sRGBTransferOETF(vec3(tsl.luminance(paint).saturate())).x;

";

/// Text of the material for `WebGPURenderer`, in nodes of TSL, which also run without WebGPU.
pub fn webgpu_module(settings: &Settings) -> String {
    let number = |name: &str, value: f32| format!("const {name} = {value:?};\n");
    let scatter = &settings.soft_scatter;
    let mut constants = number("BOOST", settings.boost) + &number("DIFFUSE_INTENSITY", settings.diffuse.intensity);
    let soft_scatter = match scatter.mode {
        SoftScatterMode::Ramp => "sampleRamp(textures.soft_scatter_ramp, amount)".to_owned(),
        SoftScatterMode::Smoothstep => {
            let color = |c: glam::Vec3| format!("vec3({:?}, {:?}, {:?})", c.x, c.y, c.z);
            // The smallest width is that of `soft_scatter_weight` of the shaders.
            let end = scatter.scatter_amount + scatter.scatter_smooth.max(1.0e-4);
            let weight = format!("amount.smoothstep({:?}, {end:?})", scatter.scatter_amount);
            format!("mix({}, {}, {weight})", color(scatter.scatter_color), color(scatter.ambient_color))
        }
    };
    constants += &number("SOFT_SCATTER_INTENSITY", scatter.intensity);
    let mut even_light = format!("{soft_scatter}.mul(SOFT_SCATTER_INTENSITY)");
    let burns = settings.burns();
    if burns {
        constants += &number("FIRE_INTENSITY", settings.fire.intensity);
        even_light += ".add(sampleRamp(textures.fire_ramp, heat, covered).mul(FIRE_INTENSITY))";
    }
    let covers_by_ramp = settings.coverage == CoverageMode::Ramp;
    let coverage =
        if covers_by_ramp { "paintedFraction(sampleRamp(textures.coverage_ramp, covered))" } else { "covered" };
    let diffuse = match settings.diffuse.backlight {
        Backlight::Same => "sampleRamp(textures.diffuse_ramp, ...at)",
        Backlight::Ramp => {
            "mix(\n                \
             sampleRamp(textures.diffuse_ramp, ...at),\n                \
             sampleRamp(textures.backlight_ramp, ...at),\n                \
             float(0.5).sub(toLight.dot(tsl.positionViewDirection).mul(0.5)).saturate().pow(3),\n            )"
        }
    };
    let sample = match settings.ramp_filter {
        RampFilter::Bilinear => "texture(ramp, texel.add(0.5).div(size)).level(0)",
        RampFilter::Nearest => "tsl.textureLoad(ramp, tsl.ivec2(texel.add(0.5)))",
    };
    let if_it_burns = |text: &str| if burns { text.to_owned() } else { String::new() };
    let heat = "        const byAge = paintedFraction(sampleRamp(textures.heat_ramp, particle.y));\n        \
                const heat = varying(byAge.mul(this.numbers.heat));\n";
    filled(
        WEBGPU,
        &[
            ("CONSTANTS", constants),
            ("SAMPLE", sample.into()),
            ("PAINTED", if burns || covers_by_ramp { PAINTED.to_owned() } else { String::new() }),
            ("HEAT_UNIFORM", if_it_burns(", heat: uniform(1)")),
            ("HEAT", if_it_burns(heat)),
            ("COVERAGE", coverage.into()),
            ("EVEN_LIGHT", even_light),
            ("DIFFUSE", diffuse.into()),
        ],
    )
}

/// Replaces `$NAME$` by texts.
fn filled(template: &str, texts: &[(&str, String)]) -> String {
    let replace = |text: String, (name, value): &(&str, String)| text.replace(&format!("${name}$"), value);
    texts.iter().fold(template.replace("$NOTE$", NOTE), replace)
}
