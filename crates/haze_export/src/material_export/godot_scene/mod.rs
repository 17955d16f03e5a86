//! Scene of Godot: a system's emitter as GPUParticles3D, as well as its ParticleProcessMaterial can.

mod left_out;
mod process;
mod text;

use haze::MaterialAssets;
use haze_preset::PresetSystem;

pub use left_out::left_out;

use super::snippet::Snippet;
use super::sprite_texture::SPRITE;
use process::Process;
use text::{Properties, sub_resource};

/// Name of the file.
pub const SCENE: &str = "haze_particles.tscn";

/// Returns the text of the scene. `frames`: of the sprite.
pub fn scene(system: &PresetSystem, assets: &MaterialAssets, snippet: &Snippet, frames: u32) -> String {
    let process = Process::new(system);
    let mut text =
        "[gd_scene format=3]\n\n[ext_resource type=\"Shader\" path=\"haze_material.gdshader\" id=\"shader\"]\n"
            .to_owned();
    let mut shader = Properties::default();
    shader.add("shader", "ExtResource(\"shader\")");
    let ramps = snippet.ramps.iter().map(|ramp| (ramp.name, ramp.file()));
    for (name, file) in ramps.chain([("sprite", SPRITE.to_owned())]) {
        text += &format!("[ext_resource type=\"Texture2D\" path=\"{file}\" id=\"{name}\"]\n");
        shader.add(&format!("shader_parameter/haze_{name}"), format_args!("ExtResource(\"{name}\")"));
    }
    if system.settings.burns() {
        // The mean of all particles.
        shader.number("shader_parameter/haze_heat", 1.0 - 0.5 * system.emitter.heat_spread);
    }
    // A radius of 1, which the scale of a particle multiplies.
    let mut quad = Properties::default();
    quad.add("material", "SubResource(\"material\")");
    quad.add("size", "Vector2(2, 2)");
    quad.add("center_offset", format_args!("Vector3(0, {:?}, 0)", system.emitter.anchor));
    text += &process.resources(assets);
    text += &sub_resource("ParticleProcessMaterial", "process", &process.material(frames));
    text += &sub_resource("ShaderMaterial", "material", &shader);
    text += &sub_resource("QuadMesh", "quad", &quad);
    let name = node_name(&system.name);
    text + &format!(
        "\n[node name=\"Smoke\" type=\"Node3D\"]\n\n[node name=\"{name}\" type=\"GPUParticles3D\" parent=\".\"]\n{}",
        process.node().0,
    )
}

/// Name of a node: Godot refuses some characters in it, and a text others.
fn node_name(name: &str) -> String {
    let kept: String = name.chars().filter(|c| !".:@/\"%\\".contains(*c) && !c.is_control()).collect();
    if kept.trim().is_empty() { "particles".to_owned() } else { kept }
}

/// Import settings of a texture, beside it: Godot would compress it when it sees it in 3D. The sprite has mipmaps.
pub fn import_settings(file: &str) -> String {
    let has_mipmaps = file == SPRITE;
    format!(
        "[remap]\n\nimporter=\"texture\"\ntype=\"CompressedTexture2D\"\n\n[params]\n\ncompress/mode=0\ncompress/normal_map=2\n\
         mipmaps/generate={has_mipmaps}\nprocess/fix_alpha_border=false\nprocess/premult_alpha=false\nprocess/size_limit=0\n\
         detect_3d/compress_to=0\n",
    )
}
