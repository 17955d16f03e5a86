//! Spatial shader of Godot, for sprites that face the camera.

use super::calls::{Calls, HEAT, NOTE, call};
use super::snippet::Snippet;
use super::sprite_texture::SpriteTexture;

/// Textures and light in both kinds of renderers. Compatibility leaves textures as they are encoded, and decodes `EMISSION` by a
/// cubic; the other renderers work in linear light. (Godot, `drivers/gles3/shaders/scene.glsl`)
const COLOR_SPACES: &str = "\
// Color of a texture, linear.
vec4 haze_decoded(vec4 color) {
#if CURRENT_RENDERER == RENDERER_COMPATIBILITY
    vec3 high = pow((color.rgb + 0.055) / 1.055, vec3(2.4));
    color.rgb = mix(color.rgb / 12.92, high, step(vec3(0.04045), color.rgb));
#endif
    return color;
}

vec4 haze_texture(sampler2D ramp, vec2 at, float level) {
    return haze_decoded(textureLod(ramp, at, level));
}

vec4 haze_texel(sampler2D ramp, ivec2 at, int level) {
    return haze_decoded(texelFetch(ramp, at, level));
}

// Light in the code of EMISSION.
vec3 haze_encoded(vec3 light) {
#if CURRENT_RENDERER == RENDERER_COMPATIBILITY
    // Inverse of Godot's decoding, by Newton's method: the cubic is convex, and the start is above the root.
    vec3 code = min(sqrt(light / 0.682171111), pow(light / 0.305306011, vec3(1.0 / 3.0)));
    for (int count = 0; count < 5; count++) {
        vec3 decoded = code * (code * (code * 0.305306011 + 0.682171111) + 0.012522878);
        code -= (decoded - light) / (code * (code * 0.915918033 + 1.364342222) + 0.012522878);
    }
    return code;
#else
    return light;
#endif
}
";

/// Turns the quad towards the camera.
const VERTEX: &str = "\
// Turns the quad towards the camera. INSTANCE_CUSTOM of particles: angle, time since birth and frame, both of these 0 to 1, and
// the time of death. On other meshes all are 0.
void vertex() {
    vec3 size = vec3(length(MODEL_MATRIX[0]), length(MODEL_MATRIX[1]), length(MODEL_MATRIX[2]));
    haze_turn = vec2(cos(INSTANCE_CUSTOM.x), sin(INSTANCE_CUSTOM.x));
    vec4 right = INV_VIEW_MATRIX[0] * haze_turn.x - INV_VIEW_MATRIX[1] * haze_turn.y;
    vec4 up = INV_VIEW_MATRIX[0] * haze_turn.y + INV_VIEW_MATRIX[1] * haze_turn.x;
    MODELVIEW_MATRIX = VIEW_MATRIX * mat4(right * size.x, up * size.y, INV_VIEW_MATRIX[2] * size.z, MODEL_MATRIX[3]);
    haze_frame = mod(haze_sprite_frame + INSTANCE_CUSTOM.z * haze_sprite_frames, haze_sprite_frames);
    haze_tint = COLOR.rgb;
";

/// Age of a particle, 0 to 1. Without a time of death, as of CPUParticles3D, all die at 1.
const AGE: &str = "    float age = INSTANCE_CUSTOM.y / (INSTANCE_CUSTOM.w > 0.0 ? INSTANCE_CUSTOM.w : 1.0);\n";

/// Blends two frames of the sprite.
const FRAMES: &str = "\
vec4 haze_frame_texel(float frame, vec2 uv) {
    float index = mod(frame, haze_sprite_frames);
    vec2 cell = vec2(mod(index, haze_sprite_cells.x), floor(index / haze_sprite_cells.x));
    return texture(haze_sprite, (uv + cell) / haze_sprite_cells);
}
";

/// `functions`: those of the material, in GLSL. All global names begin with `haze`, so that they are none of Godot's.
/// `sprite`: of the system.
pub fn spatial_shader(snippet: &Snippet, functions: &str, sprite: &SpriteTexture) -> String {
    // Godot refuses a parameter with the name of a uniform or varying.
    let uniform = |name: &str| format!("haze_{name}");
    let uniforms = snippet.ramps.iter().map(|ramp| {
        format!("uniform sampler2D {} : source_color, filter_linear, repeat_disable;\n", uniform(ramp.name))
    });
    let uniforms: String = uniforms.collect();
    let input = |name: &str| {
        match name {
            "normal" => "NORMAL",
            "to_light" => "LIGHT",
            "to_viewer" => "VIEW",
            HEAT => "haze_particle_heat",
            "age" => "age",
            _ => "haze_amount",
        }
        .to_owned()
    };
    let calls = Calls::new(snippet, |function| call(function, uniform, None, input));
    let (heat, hot_varying, vertex_heat) = match &calls.heat {
        Some(by_age) => (
            "// Multiplies the heat by age. 0: cold.\nuniform float haze_heat : hint_range(0.0, 1.0) = 1.0;\n",
            "varying float haze_particle_heat;\n",
            format!("{AGE}    haze_particle_heat = haze_heat * {by_age};\n"),
        ),
        None => ("", "", String::new()),
    };
    let emission = calls.emission.as_ref().map(|emission| format!(" + {emission}")).unwrap_or_default();
    let Calls { diffuse, soft_scatter, coverage, .. } = &calls;
    let [columns, rows, frames] = [sprite.cells.x, sprite.cells.y, sprite.frames].map(|count| format!("{count}.0"));
    let functions = functions.replace("textureLod(", "haze_texture(").replace("texelFetch(", "haze_texel(");
    format!(
        "{NOTE}shader_type spatial;\n\
         render_mode blend_mix, depth_draw_never, cull_disabled, ambient_light_disabled, specular_disabled;\n\n\
         // A sprite of haze: normal/2 + 1/2 in rgb, amount in a. Not sRGB.\n\
         uniform sampler2D haze_sprite : filter_linear_mipmap, repeat_disable;\n\
         // Its columns and rows, its frames, and the first frame that is shown.\n\
         uniform vec2 haze_sprite_cells = vec2({columns}, {rows});\nuniform float haze_sprite_frames = {frames};\n\
         uniform float haze_sprite_frame = 0.0;\n{uniforms}{heat}\n\
         // Cosine and sine of the particle's angle.\n\
         varying vec2 haze_turn;\nvarying float haze_frame;\nvarying vec3 haze_tint;\nvarying float haze_amount;\n{hot_varying}\n\
         {COLOR_SPACES}\n{functions}\n{FRAMES}\n{VERTEX}{vertex_heat}}}\n\n\
         void fragment() {{\n    float first = floor(haze_frame + 1e-3);\n    \
         vec4 texel = mix(haze_frame_texel(first, UV), haze_frame_texel(first + 1.0, UV), clamp(haze_frame - first, 0.0, 1.0));\n    \
         haze_amount = texel.a * COLOR.a;\n    \
         vec3 normal = normalize(texel.rgb * 2.0 - 1.0);\n    \
         NORMAL = vec3(dot(normal.xy, haze_turn), dot(normal.yx, haze_turn * vec2(1.0, -1.0)), normal.z);\n    \
         ALBEDO = vec3(1.0);\n    EMISSION = haze_encoded({soft_scatter}{emission});\n    ALPHA = {coverage};\n}}\n\n\
         // Godot multiplies the colors of lights by PI.\n\
         void light() {{\n    DIFFUSE_LIGHT += {diffuse} * haze_tint * LIGHT_COLOR * (ATTENUATION / PI);\n}}\n",
    )
}
