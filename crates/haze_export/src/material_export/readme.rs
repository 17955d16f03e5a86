//! Page that goes with a material: its files, and how to use them.

use haze_core::settings::RampFilter;
use haze_preset::PresetSystem;

use super::godot_scene::{SCENE, left_out};
use super::snippet::{Function, Snippet};
use crate::engine::Engine;

pub fn readme(engine: Engine, title: &str, system: &PresetSystem, snippet: &Snippet) -> String {
    let part = &system.name;
    let intro = format!(
        "# {title}: {part}\n\nThe light of this smoke, exported from haze: the ramps as textures, and the formula with the \
         preset's numbers. It is the formula of haze's own shaders.\n\nIt takes the **normal** and the **amount** of smoke \
         at a point: for one sprite, rgb (n/2 + 1/2) and alpha of its texture. Particles, blending of sprites before they \
         are lit, shadow, and ambient light are those of the engine: overlapping sprites look denser and less even than \
         in haze.\n\n",
    );
    intro + &textures(engine, system, snippet) + &functions(snippet) + &steps(engine, system, snippet)
}

fn textures(engine: Engine, system: &PresetSystem, snippet: &Snippet) -> String {
    let mut text = "## Textures\n\n| file | axes |\n|---|---|\n".to_owned();
    for ramp in &snippet.ramps {
        text += &format!("| `{}` | {} |\n", ramp.file(), ramp.axes);
    }
    if engine.takes_sprite() {
        text +=
            "| `sprite.png` | frames of the sprite: rgb is n/2 + 1/2 (right, up, to the viewer), a is the amount |\n";
    }
    let row = if engine.first_row_is_at_the_top() { "first (top)" } else { "bottom" };
    let filter = match system.settings.ramp_filter {
        RampFilter::Bilinear => "linear",
        RampFilter::Nearest => "nearest",
    };
    if engine == Engine::Three {
        return text
            + "\nRamps are **sRGB**, 8 bits, the sprite is not; rows count from the first (top). The modules load them so.\n\n";
    }
    if engine == Engine::Godot {
        return text
            + "\nRamps are **sRGB**, 8 bits, the sprite is not; rows count from the first (top). The `.import` files have the settings \
               of the import: lossless, the ramps without mipmaps.\n\n";
    }
    text + &format!(
        "\nColor is **sRGB**, 8 bits. Rows count from the {row} row of the image. Import without mipmaps, without lossy \
         compression, without resizing; filter {filter}; the edges are clamped by the formula itself.\n\n"
    )
}

fn functions(snippet: &Snippet) -> String {
    let row = |function: &Function| {
        let doc = function.doc.replace('\n', " ");
        let inputs: Vec<_> = function.inputs.iter().map(|(name, _)| *name).collect();
        format!("| `{}` | {} | {doc} |\n", function.name, inputs.join(", "))
    };
    let rows: String = snippet.functions.iter().map(row).collect();
    format!(
        "## Functions\n\n| function | of | result |\n|---|---|---|\n{rows}\nLight is linear. Color over the background: \
         `light * opacity + background * (1 - opacity)`.\n\n",
    )
}

fn steps(engine: Engine, system: &PresetSystem, snippet: &Snippet) -> String {
    let names = |before: &str, prefix: &str| {
        let names: Vec<_> = snippet.ramps.iter().map(|ramp| format!("{before}`{prefix}{}`", ramp.name)).collect();
        names.join(", ")
    };
    let burns = snippet.functions.iter().any(|function| function.name == "haze_emission");
    let heat = if burns { ", `heat` (0 to 1, for example by a particle's age)" } else { "" };
    match engine {
        Engine::Unreal => format!(
            "## In Unreal Engine\n\n\
             1. Import the textures: *sRGB* on, *Compression Settings* `UserInterface2D (RGBA)`, *Mip Gen Settings* \
             `NoMipmaps`.\n\
             2. Make a material: *Blend Mode* `Translucent`, *Shading Model* `Unlit`.\n\
             3. Add a **Custom** node, *Output Type* `CMOT Float 4`, and paste `custom_node.hlsl` as its code.\n\
             4. Name its inputs: {} (each a *Texture Object*), `normal`, `to_light`, `to_viewer`, `light_color`, \
             `amount`{heat}.\n\
             5. Connect `to_viewer` with *Camera Vector WS*; `to_light` and `light_color` with the light, for example \
             *SkyAtmosphereLightDirection* and *SkyAtmosphereLightIlluminance*, or a parameter collection; `normal` \
             with the sprite's normal in world space; `amount` with its alpha times *Particle Color* alpha.\n\
             6. Connect rgb with *Emissive Color* and a with *Opacity*.\n\n\
             `haze_material.ush` has the same functions for a plugin's shader folder: *Include File Paths* of the node, and \
             only the last lines of `custom_node.hlsl` as its code, without `haze.`\n",
            names("", ""),
        ),
        Engine::Unity => format!(
            "## In Unity\n\n\
             1. Import the textures: *sRGB (Color Texture)* on, *Generate Mip Maps* off, *Non-Power of 2* `None`, \
             *Compression* `None`, *Wrap Mode* `Clamp`.\n\
             2. Make an unlit, transparent Shader Graph and add a **Custom Function** node: *Type* `File`, *Source* \
             `haze_material.hlsl`, *Name* `HazeSmoke`, precision `Single`.\n\
             3. Give it these inputs, in this order: {} (each `Texture2D`), `normal`, `to_light`, `to_viewer`, \
             `light_color` (each `Vector3`), `amount`{} (`Float`); and the outputs `color` (`Vector3`), `opacity` \
             (`Float`).\n\
             4. Connect the vectors in one space, for example *View Direction* in world space; `amount` with alpha of the \
             sprite times that of the vertex color. `to_light` and `light_color` are those of the main light, from \
             *Main Light Direction* (negated) or `GetMainLight()`.\n",
            names("", ""),
            if burns { ", `heat`" } else { "" },
        ),
        Engine::Godot => godot_steps(system, &names("", "haze_"), burns),
        Engine::Three => {
            let heat = if burns { "; the age is the position in the heat ramp" } else { "" };
            let scale = if burns { ", `material.numbers.heat.value` their heat" } else { "" };
            format!(
                "## In three.js\n\n\
                 `haze_material.js` is for `WebGLRenderer` and imports `three`; `haze_material_webgpu.js` is for `WebGPURenderer`, with and \
                 without WebGPU, and imports `three/webgpu` and `three/tsl`: `HazeNodeMaterial` there is `HazeMaterial` here. Both need the files \
                 of this folder beside them.\n\n\
                 ```js\n\
                 import {{ HazeMaterial }} from './haze_material.js';\n\n\
                 const material = await HazeMaterial.load();\n\
                 const smoke = new THREE.InstancedMesh(new THREE.PlaneGeometry(), material, count);\n\
                 // Of each particle: angle, age, frame and amount; all but the angle are 0 to 1.\n\
                 const particles = new THREE.InstancedBufferAttribute(new Float32Array(4 * count), 4);\n\
                 smoke.geometry.setAttribute('hazeParticle', particles);\n\
                 scene.add(smoke);\n\
                 ```\n\n\
                 Squares turn towards the camera; their matrices set center and size. Without the attribute, as on a mesh of its own, a \
                 square shows the first frame with all of its amount{heat}. `material.numbers.amount.value` multiplies the amount of all{scale}, \
                 `material.numbers.frame.value` is their first frame. Sort instances from back to front.\n\n\
                 Directional, point and spot lights of the scene light the smoke, as they light a white Lambert surface that faces them: \
                 intensity π is 1 in haze. Fog, tonemapping and, with `receiveShadow`, shadows of the scene apply. The smoke casts \
                 no shadow, and ambient, hemisphere and area lights, light probes and environments do not light it.\n\n\
                 Opacity is that of linear light, which `WebGPURenderer` blends. `WebGLRenderer` blends codes on a canvas, and thin smoke is \
                 too dark: render into half floats, as `EffectComposer` does, with `OutputPass` as its last pass.\n",
            )
        }
        Engine::Wgsl | Engine::Babylon | Engine::Playcanvas => format!(
            "## In WGSL\n\n\
             Put `haze_material.wgsl` before your own shader: it declares functions and constants alone, no bindings. Bind {} \
             as `texture_2d<f32>` of a format such as `Rgba8UnormSrgb`, with a linear sampler.\n\n\
             ```wgsl\n\
             var light = haze_soft_scatter(amount);\n\
             light += haze_diffuse(diffuse_ramp, ramp_sampler, normal, to_light, to_viewer, amount) * light_color;\n\
             let opacity = haze_coverage(amount);\n\
             return vec4f(light * opacity, opacity); // premultiplied\n\
             ```\n\n\
             Functions with further ramps take them before the sampler.\n",
            names("", ""),
        ),
    }
}

fn godot_steps(system: &PresetSystem, parameters: &str, burns: bool) -> String {
    let heat = if burns { "; the age is the position in the heat ramp" } else { "" };
    let material = format!(
        "`haze_material.gdshader` is the shader of a *ShaderMaterial* for quads: it turns them towards the camera, by the angle of \
         each particle, and blends the frames of the sprite{heat}. The color of a particle multiplies the light on it, its alpha the \
         amount. Parameters: `haze_sprite`, its columns and rows (`haze_sprite_cells`), its number of frames (`haze_sprite_frames`), \
         {parameters}. For another sprite, import a PNG of haze in the same way.\n\n\
         All lights of the scene light the smoke, by `light()`: an energy of 1 is an intensity of 1 in haze. The Compatibility renderer \
         blends sRGB codes: thin smoke looks darker there.\n",
    );
    let intro = "## In Godot 4\n\nFor Godot 4.4 or later, all renderers. ";
    if system.particle_files.is_used() {
        return format!("{intro}There is no scene with particles: those of this smoke come from files.\n\n{material}");
    }
    let left_out = left_out(system);
    let rows: String = left_out.iter().map(|(name, text)| format!("| {name} | {text} |\n")).collect();
    let other = match left_out.is_empty() {
        true => String::new(),
        false => format!("\nOther than in haze:\n\n| setting | in Godot |\n|---|---|\n{rows}"),
    };
    format!(
        "{intro}Copy the folder into a project and put `{SCENE}` into a scene, at the origin of haze's world: a `GPUParticles3D` with \
         the preset's emitter.\n\n\
         | of the emitter | in Godot |\n|---|---|\n\
         | rate, lives | *Amount* over *Lifetime*, the longest life; *Lifetime Randomness* |\n\
         | velocity, drag, buoyancy, wind and its shear, speed over the life | *Directional Velocity*, by a curve |\n\
         | random velocity, burst, orbit | *Initial Velocity*, *Radial Velocity*, *Orbit Velocity* |\n\
         | radius over the life | *Scale*, by a curve |\n\
         | amount over the life | *Alpha Curve* |\n\
         | colors | *Color Initial Ramp*, *Color Ramp* |\n\
         | rotation, spin, frames | *Angle*, *Angular Velocity*, *Animation* |\n\
         | anchor | *Center Offset* of the quad |\n{other}\n\
         Shadow, ambient light and the glow of lights behind the smoke are not part of it, either.\n\n{material}",
    )
}
