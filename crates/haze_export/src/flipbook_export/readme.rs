//! Page that goes with a flipbook: its files, and how to use them.

use super::numbers::FlipbookNumbers;
use super::sheets::{COLOR, EMISSION, MOTION, NORMALS, SIX_WAY};
use crate::engine::Engine;
use crate::image_format::{Alpha, Emission};

pub fn readme(engine: Engine, title: &str, numbers: &FlipbookNumbers) -> String {
    let FlipbookNumbers { columns, rows, frames, rate, alpha, emission, motion_scale, .. } = numbers;
    let FlipbookNumbers { six_way_intensity, six_way_emission, .. } = numbers;
    let mut text = format!(
        "# {title}: flipbook\n\n{frames} frames in {columns} columns and {rows} rows, left to right, then down; {rate} frames \
         per second. `flipbook.json` has the numbers, `color.json` the frames by name, as PixiJS and Phaser read them.\n\n| file | color space | content |\n|---|---|---|\n",
    );
    let packing = match engine {
        Engine::Unity => ["right, top, back", "left, bottom, front"],
        _ => ["right, left, top", "bottom, back, front"],
    };
    let green = if engine.normals_point_up() { "up (OpenGL)" } else { "down (DirectX)" };
    let motion_down = if engine.first_row_is_at_the_top() { "down" } else { "up" };
    for name in numbers.files.iter().map(|file| file.name.as_str()) {
        let (space, content) = match name {
            COLOR => {
                let kind = match alpha {
                    Alpha::Straight => "**straight**: not multiplied by opacity",
                    Alpha::Premultiplied => {
                        "**premultiplied**: times opacity, in linear light; glow stays where opacity is low"
                    }
                };
                ("sRGB", format!("light, exposed and tonemapped, {kind}; a: opacity"))
            }
            NORMALS => ("linear", format!("n/2 + 1/2 in view space: right, {green}, to the viewer")),
            MOTION => {
                let half = "0.5 is rest, 0 and 1 the scale below";
                ("linear", format!("rg: way until the next frame, right and {motion_down}; {half}"))
            }
            EMISSION => {
                let use_of_it = match emission {
                    Some(Emission::Separate) => "**not** part of `color.png`: to be added to the blended color",
                    _ => {
                        "part of `color.png` already: to be added only by a material without that, such as one lit by `normals.png` \
                         or by the six-way maps"
                    }
                };
                ("sRGB", format!("light of fire alone, exposed and tonemapped, **premultiplied**; {use_of_it}"))
            }
            name if name == SIX_WAY[0] => ("linear", format!("light from {}; a: opacity", packing[0])),
            _ => {
                let alpha = match (engine.six_way_packing().has_emission(), six_way_emission) {
                    (false, _) => "opacity",
                    (true, None) => "emission, 0 without fire",
                    (true, Some(_)) => "emission: luminance of fire, not multiplied by opacity",
                };
                ("linear", format!("light from {}; a: {alpha}", packing[1]))
            }
        };
        text += &format!("| `{name}` | {space} | {content} |\n");
    }
    let clear = match alpha {
        Alpha::Straight => "",
        Alpha::Premultiplied => "; those of `color.png` are black, as premultiplied color is",
    };
    text += &format!(
        "\nClear texels continue the smoke beside them, so that filtered edges stay bright{clear}.\n\n**Motion**: full red or green is \
         a way of {motion_scale:.5} of a frame's width or height. Between frames n and n + 1, at a fraction t of the time, mix both \
         by t, the first sampled at uv − m·t and the second at uv + m·(1 − t), with m = (2·rg − 1) · {motion_scale:.5} of the \
         respective frame, in coordinates of one frame. Keep the coordinates half a texel inside the frame: the sheet has another \
         frame beside it.\n\n",
    );
    text += &format!(
        "**Blending**: opacity is that of linear light. Blended as sRGB codes, thin smoke is 0.06 to 0.13 too dark. {}\n\n",
        linear_light(engine),
    );
    if let Some(intensity) = six_way_intensity {
        text += &format!(
            "**Six-way light**: white is {intensity:.3} of the light. Multiply by {intensity:.3}, and by the smoke's color, \
             for the brightness of the preset.\n\n",
        );
    }
    if let Some(emission) = six_way_emission {
        text +=
            &format!("**Emission**: full alpha of `six_way_2.png` is {emission:.3}, in the unit of six-way light.\n\n");
    }
    text + &steps(engine, numbers)
}

fn steps(engine: Engine, numbers: &FlipbookNumbers) -> String {
    let FlipbookNumbers { columns, rows, frames, rate, motion_scale, .. } = numbers;
    let blending = blending(engine, numbers.alpha);
    let emissive = if numbers.six_way_emission.is_some() { "Single Channel" } else { "None" };
    match engine {
        Engine::Unreal => format!(
            "## In Unreal Engine\n\n\
             1. Import the sheets: *sRGB* on for `color.png` and `emission.png`, off for all others; *Compression Settings* \
             `Normalmap` for `normals.png`, `BC7` or `VectorDisplacementmap` for `motion.png`.\n\
             2. In Niagara, *Sub Image Size* {columns} × {rows} in the sprite renderer, *Sub UV Animation* with {frames} frames \
             at {rate} per second, *Sub UV Blending* on.\n\
             3. In the material, {blending} and *Shading Model* `Unlit`. *Particle Sub UV* reads `color.png`: rgb is *Emissive \
             Color*, a is *Opacity*. For motion vectors the function *FlipBook\\_MotionVectors* \
             takes `motion.png` and a strength of {motion_scale:.5}.\n",
        ),
        Engine::Unity => format!(
            "## In Unity\n\n\
             1. Import the sheets: *sRGB* on for `color.png` and `emission.png`, off for all others; *Alpha Is Transparency* off; \
             *Texture Type* `Normal map` for `normals.png`; no compression for `motion.png`.\n\
             2. In VFX Graph, *Uv Mode* `Flipbook Motion Blend`, *Flip Book Size* {columns} × {rows}, *Motion Vector Map* \
             `motion.png`, *Motion Vector Scale* {motion_scale:.5}, and *Flipbook Player* at {rate} frames per second; {blending}.\n\
             3. For six-way light, *Material Type* `Six Way Smoke Lit`: *Positive Axes Lightmap* `six_way_1.png`, *Negative Axes \
             Lightmap* `six_way_2.png`, *Emissive Mode* `{emissive}`. The alpha of the second map is emission: `Single Channel` \
             colors it by a gradient.\n",
        ),
        Engine::Godot => format!(
            "## In Godot 4\n\n\
             1. Import the sheets with *Compress Mode* `Lossless` and mipmaps; *Fix Alpha Border* off, which would replace the \
             colors of nearly clear texels.\n\
             2. In a *StandardMaterial3D*: *Transparency* `Alpha`, {blending}, *Shading Mode* `Unshaded`, *Albedo* `color.png`, *Billboard \
             Mode* `Particle Billboard`, *H Frames* {columns}, *V Frames* {rows}.\n\
             3. In the process material, *Animation Speed* 1 plays all {frames} frames in a particle's life.\n\
             4. Motion vectors need a shader: the formula above, in `fragment()`, and sheets without mipmaps, which would blur the motion.\n",
        ),
        Engine::Three => "## In three.js\n\n\
             `haze_flipbook.js` shows the flipbook on a square that faces the camera, with motion vectors, the blend mode of its color, \
             and without the frames beside. It needs `three` as an import, and the files of this folder beside it.\n\n\
             ```js\n\
             import { HazeFlipbook } from './haze_flipbook.js';\n\n\
             const smoke = await HazeFlipbook.load();\n\
             scene.add(smoke);\n\
             // Before each frame; any time, in any order.\n\
             smoke.update(clock.getElapsedTime());\n\
             ```\n"
            .into(),
        Engine::Babylon => {
            let setup = "// BABYLON: the global of babylon.js, or `import * as BABYLON from '@babylonjs/core'`.\n\
                         const smoke = await HazeFlipbook.load(BABYLON, scene);\n";
            module_steps("Babylon.js", setup, numbers)
        }
        Engine::Playcanvas => {
            let setup = "// pc: `import * as pc from 'playcanvas'`.\n\
                         const smoke = await HazeFlipbook.load(pc, app);\n\
                         app.root.addChild(smoke.entity);\n";
            module_steps("PlayCanvas", setup, numbers)
        }
        Engine::Wgsl => format!(
            "## In WGSL\n\nUpload `color.png` and `emission.png` as `Rgba8UnormSrgb`, the others as `Rgba8Unorm`, and sample \
             them as above. Blend with {blending}.\n",
        ),
    }
}

/// Steps with a module that gets its engine as an argument. `setup`: lines of JavaScript that make `smoke`.
fn module_steps(name: &str, setup: &str, numbers: &FlipbookNumbers) -> String {
    let blending = blending(numbers.engine, numbers.alpha);
    format!(
        "## In {name}\n\n`haze_flipbook.js` shows the flipbook on a square that faces the camera, with motion vectors, {blending}, and \
         without the frames beside. It needs WebGL 2, and the files of this folder beside it.\n\n\
         ```js\nimport {{ HazeFlipbook }} from './haze_flipbook.js';\n\n{setup}\
         // Before each frame; any time, in any order.\nsmoke.update(seconds);\n```\n",
    )
}

/// Settings with which an engine blends linear light.
fn linear_light(engine: Engine) -> &'static str {
    match engine {
        Engine::Unreal => "Unreal Engine blends linear light.",
        Engine::Unity => {
            "Unity blends linear light if *Project Settings > Player > Color Space* is `Linear`, and codes if it is `Gamma`."
        }
        Engine::Godot => {
            "Godot's renderers Forward+ and Mobile blend linear light in 3D, and in 2D with *Project Settings > Rendering > \
             Viewport > HDR 2D*. Compatibility blends codes."
        }
        Engine::Three => {
            "three.js blends codes on a canvas, and linear light in the half floats of an `EffectComposer`, with `OutputPass` as its last \
             pass."
        }
        Engine::Babylon => {
            "Babylon.js blends codes on a canvas, and linear light in a `DefaultRenderingPipeline` with `hdr`."
        }
        Engine::Playcanvas => "PlayCanvas blends codes on a canvas, and linear light in a `CameraFrame`.",
        Engine::Wgsl => {
            "wgpu blends linear light on targets whose format is sRGB or float, such as `Bgra8UnormSrgb` and `Rgba16Float`; on \
             `Bgra8Unorm`, codes are blended. Bevy blends linear light."
        }
    }
}

/// Setting of an engine that blends the color.
fn blending(engine: Engine, alpha: Alpha) -> &'static str {
    match (engine, alpha) {
        (Engine::Unreal, Alpha::Straight) => "*Blend Mode* `Translucent`",
        (Engine::Unreal, Alpha::Premultiplied) => "*Blend Mode* `AlphaComposite (Premultiplied Alpha)`",
        (Engine::Unity, Alpha::Straight) => {
            "*Blend Mode* `Alpha`. In a particle shader of URP: *Blending Mode* `Alpha`; in a shader of your own: `Blend \
             SrcAlpha OneMinusSrcAlpha`"
        }
        (Engine::Unity, Alpha::Premultiplied) => {
            "*Blend Mode* `Alpha Premultiplied`. In a particle shader of URP: *Blending Mode* `Premultiply`; in a shader of \
             your own: `Blend One OneMinusSrcAlpha`"
        }
        (Engine::Godot, Alpha::Straight) => "*Blend Mode* `Mix` (`blend_mix` in a shader)",
        (Engine::Godot, Alpha::Premultiplied) => {
            "*Blend Mode* `Premultiplied Alpha` (`blend_premul_alpha` in a shader)"
        }
        (Engine::Three, Alpha::Straight) => "`NormalBlending`",
        (Engine::Three, Alpha::Premultiplied) => "`CustomBlending` of `OneFactor` and `OneMinusSrcAlphaFactor`",
        (Engine::Babylon, Alpha::Straight) => "*alphaMode* `ALPHA_COMBINE`",
        (Engine::Babylon, Alpha::Premultiplied) => "*alphaMode* `ALPHA_PREMULTIPLIED_PORTERDUFF`",
        (Engine::Playcanvas, Alpha::Straight) => "*blendType* `BLEND_NORMAL`",
        (Engine::Playcanvas, Alpha::Premultiplied) => "*blendType* `BLEND_PREMULTIPLIED`",
        (Engine::Wgsl, Alpha::Straight) => "`BlendState::ALPHA_BLENDING`, in Bevy `AlphaMode::Blend`",
        (Engine::Wgsl, Alpha::Premultiplied) => {
            "`BlendState::PREMULTIPLIED_ALPHA_BLENDING`, in Bevy `AlphaMode::Premultiplied`"
        }
    }
}
