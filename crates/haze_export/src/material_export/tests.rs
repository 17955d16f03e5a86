use std::collections::BTreeSet;
use std::io::Write as _;
use std::process::{Command, Stdio};

use glam::{Vec2, Vec3, Vec4, vec3};
use haze::{Settings, wgpu};
use haze_core::formula::lighting::{backlight_weight, coverage, painted_fraction};
use haze_core::formula::ramp::sample_ramp;
use haze_core::formula::response::{diffuse_response, fire_response, soft_scatter_curve};
use haze_core::settings::{Backlight, CoverageMode, RampFilter, SoftScatterMode};
use haze_demo::headless::Headless;

use haze_preset::{ImageSource, Preset};

use super::*;

const ENGINES: [Engine; 5] = [Engine::Unreal, Engine::Unity, Engine::Godot, Engine::Wgsl, Engine::Three];

/// Settings that use every ramp, as far as they choose, with numbers that differ from each other.
fn settings(has_ramps: bool, ramp_filter: RampFilter) -> Settings {
    let mut settings = Settings { ramp_filter, boost: 1.7, ..Settings::default() };
    settings.diffuse.intensity = 0.8;
    settings.soft_scatter.intensity = 1.3;
    let scatter = &mut settings.soft_scatter;
    scatter.scatter_amount = 0.1;
    scatter.scatter_smooth = 0.5;
    scatter.scatter_color = vec3(0.6, 0.5, 0.2);
    scatter.ambient_color = vec3(0.1, 0.2, 0.4);
    if has_ramps {
        settings.diffuse.backlight = Backlight::Ramp;
        settings.soft_scatter.mode = SoftScatterMode::Ramp;
        settings.coverage = CoverageMode::Ramp;
        settings.fire.intensity = 2.5;
    }
    settings
}

fn all_settings() -> [Settings; 3] {
    [settings(false, RampFilter::Bilinear), settings(true, RampFilter::Bilinear), settings(true, RampFilter::Nearest)]
}

fn assets() -> MaterialAssets {
    let names = haze_preset::MaterialSources {
        diffuse_ramp: "diffuse_soft_toon".into(),
        backlight_ramp: "backlight_traced_steam".into(),
        ..haze_preset::MaterialSources::default()
    };
    names.load(ImageSource::BuiltIn).unwrap()
}

/// Normal, vectors to light and viewer, amount and heat.
struct Case {
    vectors: [Vec3; 3],
    amount: f32,
    heat: f32,
}

fn cases() -> Vec<Case> {
    let case = |index: u32| {
        let random = |channel: u32| {
            haze_core::assets::noise::unit(haze_core::assets::noise::pcg3d(glam::UVec3::new(index, channel, 5)).x)
        };
        let vector = |first| vec3(random(first), random(first + 1), random(first + 2)) * 2.0 - 1.0;
        let vectors = [0, 3, 6].map(|first| vector(first).normalize_or(Vec3::Z));
        Case { vectors, amount: random(9), heat: random(10) }
    };
    (0..512).map(case).collect()
}

/// Diffuse response and coverage, soft scatter, and emission, from `formula/`.
fn expected(settings: &Settings, assets: &MaterialAssets, case: &Case) -> [Vec4; 3] {
    let [normal, to_light, to_viewer] = case.vectors;
    let amount = case.amount;
    let filter = settings.ramp_filter;
    let covered = coverage(amount, settings.boost);
    let against = match settings.diffuse.backlight {
        Backlight::Ramp => backlight_weight(to_light, to_viewer),
        Backlight::Same => 0.0,
    };
    let ramps = [&assets.diffuse_ramp, &assets.backlight_ramp];
    let diffuse = diffuse_response(ramps, filter, normal, to_light, covered, against);
    let opacity = match settings.coverage {
        CoverageMode::Linear => covered,
        CoverageMode::Ramp => painted_fraction(sample_ramp(&assets.coverage_ramp, filter, covered)),
    };
    let curve = &settings.soft_scatter;
    let scatter = match curve.mode {
        SoftScatterMode::Ramp => sample_ramp(&assets.soft_scatter_ramp, filter, amount),
        SoftScatterMode::Smoothstep => soft_scatter_curve(
            amount,
            curve.scatter_color,
            curve.ambient_color,
            curve.scatter_amount,
            curve.scatter_smooth,
        ),
    };
    let fire = match settings.burns() {
        true => fire_response(&assets.fire_ramp, filter, Vec2::new(case.heat, 1.0), amount, settings.boost),
        false => Vec3::ZERO,
    };
    [
        (diffuse * settings.diffuse.intensity).extend(opacity),
        (scatter * curve.intensity).extend(0.0),
        (fire * settings.fire.intensity).extend(0.0),
    ]
}

/// Runs the functions of a snippet on the GPU.
fn run(gpu: &Headless, snippet: &Snippet, text: &str, assets: &MaterialAssets, cases: &[Case]) -> Vec<[Vec4; 3]> {
    let call = |name: &str| {
        let function = snippet.functions.iter().find(|function| function.name == name)?;
        let ramps = function.ramps.iter().map(|ramp| format!("{ramp}_bound"));
        let sampler = (!function.ramps.is_empty()).then(|| "bound_sampler".to_owned());
        let inputs = function.inputs.iter().map(|(name, _)| match *name {
            "normal" => "a.xyz".to_owned(),
            "to_light" => "b.xyz".to_owned(),
            "to_viewer" => "c.xyz".to_owned(),
            "heat" => "b.w".to_owned(),
            _ => "a.w".to_owned(),
        });
        Some(format!("{name}({})", ramps.chain(sampler).chain(inputs).collect::<Vec<_>>().join(", ")))
    };
    let bindings: String = (3..).zip(&snippet.ramps).fold(String::new(), |text, (index, ramp)| {
        text + &format!("@group(0) @binding({index}) var {}_bound: texture_2d<f32>;\n", ramp.name)
    });
    let source = format!(
        "{text}
         @group(0) @binding(0) var<storage, read> cases: array<vec4f>;
         @group(0) @binding(1) var<storage, read_write> results: array<vec4f>;
         @group(0) @binding(2) var bound_sampler: sampler;
         {bindings}
         @compute @workgroup_size(1) fn main(@builtin(workgroup_id) id: vec3u) {{
             let a = cases[id.x * 3u];
             let b = cases[id.x * 3u + 1u];
             let c = cases[id.x * 3u + 2u];
             results[id.x * 3u] = vec4f({}, {});
             results[id.x * 3u + 1u] = vec4f({}, 0.0);
             results[id.x * 3u + 2u] = vec4f({}, 0.0);
         }}",
        call("haze_diffuse").unwrap(),
        call("haze_coverage").unwrap(),
        call("haze_soft_scatter").unwrap(),
        call("haze_emission").unwrap_or_else(|| "vec3f(0.0)".into()),
    );
    let inputs: Vec<f32> = cases
        .iter()
        .flat_map(|case| {
            let [a, b, c] = case.vectors;
            [a.extend(case.amount), b.extend(case.heat), c.extend(0.0)].map(|v| v.to_array()).concat()
        })
        .collect();
    let size = (inputs.len() * 4) as u64;
    let device = &gpu.device;
    let buffer = |usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::STORAGE | usage,
            mapped_at_creation: false,
        })
    };
    let input = buffer(wgpu::BufferUsages::COPY_DST);
    let output = buffer(wgpu::BufferUsages::COPY_SRC);
    gpu.queue.write_buffer(&input, 0, bytemuck::cast_slice(&inputs));
    let textures: Vec<_> = snippet.ramps.iter().map(|ramp| upload(gpu, (ramp.of)(assets))).collect();
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..wgpu::SamplerDescriptor::default()
    });
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("material"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("material"),
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let fixed = [input.as_entire_binding(), output.as_entire_binding(), wgpu::BindingResource::Sampler(&sampler)];
    let resources = fixed.into_iter().chain(textures.iter().map(wgpu::BindingResource::TextureView));
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    let layout = pipeline.get_bind_group_layout(0);
    let group =
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(cases.len() as u32, 1, 1);
    }
    gpu.submit(encoder).unwrap();
    let results: Vec<[f32; 12]> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&output).unwrap());
    let vectors = |row: &[f32; 12]| [0, 4, 8].map(|at| Vec4::from_slice(&row[at..]));
    results.iter().map(vectors).collect()
}

fn upload(gpu: &Headless, ramp: &Ramp) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: ramp.size().x, height: ramp.size().y, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("ramp"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * size.width), rows_per_image: None };
    gpu.queue.write_texture(texture.as_image_copy(), &ramp.bytes(), layout, size);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Largest difference from `formula/`, relative to max(1, |expected|).
fn error(settings: &Settings, assets: &MaterialAssets, cases: &[Case], found: &[[Vec4; 3]]) -> f32 {
    let difference = |(case, found): (&Case, &[Vec4; 3])| {
        let pairs = expected(settings, assets, case).into_iter().zip(found);
        pairs
            .map(|(expected, found)| ((expected - *found).abs() / expected.abs().max(Vec4::ONE)).max_element())
            .fold(0.0, f32::max)
    };
    cases.iter().zip(found).map(difference).fold(0.0, f32::max)
}

#[test]
fn wgsl_computes_what_the_renderers_compute() {
    let gpu = Headless::new().unwrap();
    let assets = assets();
    let cases = cases();
    for settings in all_settings() {
        let snippet = Snippet::new(&settings, Engine::Wgsl).unwrap();
        let exact = snippet.wgsl.replace("EXACT_FILTERING: bool = false", "EXACT_FILTERING: bool = true");
        let worst = |text: &str| error(&settings, &assets, &cases, &run(&gpu, &snippet, text, &assets, &cases));
        // The precision that Vulkan allows `pow`.
        assert!(worst(&exact) < 2.0e-4, "{}", worst(&exact));
        // Samplers filter with weights of 8 bits; one step of the toon ramp is nearly the whole range.
        assert!(worst(&snippet.wgsl) < 1.0 / 128.0, "{}", worst(&snippet.wgsl));
        // The comparison finds a wrong number, and a swapped vector.
        for (from, to) in [
            ("HAZE_BOOST: f32 = 1.7", "HAZE_BOOST: f32 = 1.6"),
            ("HAZE_DIFFUSE_INTENSITY: f32 = 0.8", "HAZE_DIFFUSE_INTENSITY: f32 = 0.9"),
            ("HAZE_SOFT_SCATTER_INTENSITY: f32 = 1.3", "HAZE_SOFT_SCATTER_INTENSITY: f32 = 1.4"),
            ("diffuse_coordinate(normal, to_light)", "diffuse_coordinate(normal, -to_light)"),
        ] {
            let mutant = exact.replace(from, to);
            assert!(mutant != exact && worst(&mutant) > 2.0e-3, "{to}: {}", worst(&mutant));
        }
    }
}

/// Compiles a source by glslang; `None` without glslang.
fn glslang(arguments: &[&str], source: &str) -> Option<Result<(), String>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("source.frag");
    std::fs::File::create(&path).unwrap().write_all(source.as_bytes()).unwrap();
    let run = Command::new("glslangValidator").args(arguments).arg(&path).stderr(Stdio::piped()).output().ok()?;
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    Some(if run.status.success() { Ok(()) } else { Err(format!("{said}\n{source}")) })
}

const HLSL: [&str; 8] = ["-D", "-V", "-e", "main", "-S", "frag", "-o", "/dev/null"];
const GLSL: [&str; 2] = ["-S", "frag"];

/// A pixel shader around one source of an engine, with stand-ins for what the engine declares.
/// `renderer`: 0 for Godot's Compatibility, 2 for Forward+.
fn shader_around(file: &str, text: &str, snippet: &Snippet, renderer: u32) -> String {
    let ramps =
        |declare: &dyn Fn(&str) -> String| -> String { snippet.ramps.iter().map(|ramp| declare(ramp.name)).collect() };
    let heat = if snippet.functions.len() > 3 { "float heat = 0.5;" } else { "" };
    let inputs = format!(
        "float3 normal = float3(0, 0, 1); float3 to_light = normal; float3 to_viewer = normal; \
         float3 light_color = normal; float amount = uv.x; {heat}"
    );
    match file {
        "custom_node.hlsl" => {
            let textures = ramps(&|name| format!("Texture2D {name}; SamplerState {name}Sampler;\n"));
            // Unreal makes a function of the node's text. glslang 12 crashed on a shader of that form, so it is split here.
            let (declared, body) = text.split_once("HazeMaterial haze;").unwrap();
            format!(
                "{textures}{declared}float4 node(float2 uv) {{\n{inputs}\nHazeMaterial haze;{body}\n}}\n\
                 float4 main(float2 uv : TEXCOORD0) : SV_Target {{ return node(uv); }}\n"
            )
        }
        "haze_material.ush" => {
            format!("{text}\nfloat4 main(float2 uv : TEXCOORD0) : SV_Target {{ return float4(uv, 0, 1); }}\n")
        }
        "haze_material.hlsl" => {
            let textures = ramps(&|name| format!("Texture2D {name}_texture; SamplerState {name}_sampler;\n"));
            let arguments = ramps(&|name| {
                format!("UnityTexture2D {name}; {name}.tex = {name}_texture; {name}.samplerstate = {name}_sampler;\n")
            });
            let names = ramps(&|name| format!("{name}, "));
            let heat = if heat.is_empty() { "" } else { ", heat" };
            format!(
                "struct UnityTexture2D {{ Texture2D tex; SamplerState samplerstate; }};\n{text}\n{textures}\
                 float4 main(float2 uv : TEXCOORD0) : SV_Target {{\n{inputs}\n{arguments}float3 color; float opacity;\n\
                 HazeSmoke_float({names}normal, to_light, to_viewer, light_color, amount{heat}, color, opacity);\n\
                 return float4(color, opacity);\n}}\n"
            )
        }
        _ => {
            let line = |line: &str| {
                let declared = line.split([':', '=']).next().unwrap_or_default().trim_end().trim_end_matches(';');
                match line.split(' ').next() {
                    Some("shader_type" | "render_mode") => String::new(),
                    Some("uniform") => format!("{declared};\n"),
                    Some("varying") => format!("{};\n", declared.trim_start_matches("varying ")),
                    _ => format!("{line}\n"),
                }
            };
            let text: String = text.lines().map(line).collect();
            format!(
                "#version 300 es\n#define RENDERER_COMPATIBILITY 0\n#define CURRENT_RENDERER {renderer}\n\
                 precision highp float;\nprecision highp int;\n\
                 const float PI = 3.14159265;\nvec2 UV;\nvec4 COLOR, INSTANCE_CUSTOM;\nvec3 NORMAL, ALBEDO, EMISSION, VIEW;\nfloat ALPHA;\n\
                 vec3 LIGHT, LIGHT_COLOR, DIFFUSE_LIGHT;\nfloat ATTENUATION;\n\
                 mat4 MODEL_MATRIX, VIEW_MATRIX, INV_VIEW_MATRIX, MODELVIEW_MATRIX;\nout vec4 result;\n\
                 {text}\nvoid main() {{\n    vertex();\n    fragment();\n    light();\n    \
                 result = vec4(DIFFUSE_LIGHT + EMISSION, ALPHA);\n}}\n"
            )
        }
    }
}

#[test]
fn sources_for_engines_compile() {
    let sprite = SpriteTexture::new(&assets().sprite);
    for settings in all_settings() {
        for engine in ENGINES {
            let snippet = Snippet::new(&settings, engine).unwrap();
            for (file, text) in sources::sources(engine, &settings, &snippet, &sprite).unwrap() {
                if file.ends_with(".js") {
                    // scripts/test_engines compiles it: three.js adds the lights.
                    continue;
                }
                if file.ends_with(".wgsl") {
                    // The comparison with the renderers compiles it; here, that it needs nothing else.
                    naga::front::wgsl::parse_str(&text).unwrap();
                    continue;
                }
                let is_glsl = file.ends_with(".gdshader");
                let arguments: &[&str] = if is_glsl { &GLSL } else { &HLSL };
                let renderers: &[u32] = if is_glsl { &[0, 2] } else { &[0] };
                for renderer in renderers {
                    let source = shader_around(file, &text, &snippet, *renderer);
                    let Some(compiled) = glslang(arguments, &source) else {
                        let required = std::env::var("HAZE_REQUIRE").unwrap_or_default();
                        assert!(!required.contains("glslang"), "glslangValidator is not installed");
                        println!("skipped: glslangValidator is not installed");
                        return;
                    };
                    compiled.unwrap_or_else(|error| panic!("{file}: {error}"));
                    // A call of a missing function is an error: the formula was compiled.
                    let broken = source.replacen("clamp(", "no_function(", 1).replacen("saturate(", "no_function(", 1);
                    assert!(glslang(arguments, &broken).is_some_and(|compiled| compiled.is_err()), "{file}");
                }
            }
        }
    }
}

/// Names that Godot declares in spatial shaders. (Godot 4.6, `servers/rendering/shader_types.cpp`)
const BUILT_INS: &str = "
    TIME PI TAU E OUTPUT_IS_SRGB CLIP_SPACE_FAR VIEWPORT_SIZE IN_SHADOW_PASS
    VERTEX NORMAL TANGENT BINORMAL POSITION UV UV2 COLOR ROUGHNESS POINT_SIZE INSTANCE_ID INSTANCE_CUSTOM VERTEX_ID
    MODEL_MATRIX MODEL_NORMAL_MATRIX MODELVIEW_MATRIX MODELVIEW_NORMAL_MATRIX VIEW_MATRIX INV_VIEW_MATRIX
    PROJECTION_MATRIX INV_PROJECTION_MATRIX MAIN_CAM_INV_VIEW_MATRIX VIEW_INDEX VIEW_MONO_LEFT VIEW_RIGHT EYE_OFFSET
    NODE_POSITION_WORLD NODE_POSITION_VIEW CAMERA_POSITION_WORLD CAMERA_DIRECTION_WORLD CAMERA_VISIBLE_LAYERS
    CUSTOM0 CUSTOM1 CUSTOM2 CUSTOM3 BONE_INDICES BONE_WEIGHTS Z_CLIP_SCALE
    FRAGCOORD VIEW FRONT_FACING POINT_COORD SCREEN_UV SCREEN_MATRIX DEPTH ALBEDO ALPHA ALPHA_SCISSOR_THRESHOLD
    ALPHA_HASH_SCALE ALPHA_ANTIALIASING_EDGE ALPHA_TEXTURE_COORDINATE PREMUL_ALPHA_FACTOR METALLIC SPECULAR RIM RIM_TINT
    CLEARCOAT CLEARCOAT_ROUGHNESS ANISOTROPY ANISOTROPY_FLOW SSS_STRENGTH SSS_TRANSMITTANCE_COLOR
    SSS_TRANSMITTANCE_DEPTH SSS_TRANSMITTANCE_BOOST BACKLIGHT AO AO_LIGHT_AFFECT EMISSION FOG RADIANCE IRRADIANCE
    NORMAL_MAP NORMAL_MAP_DEPTH BENT_NORMAL_MAP LIGHT_VERTEX
    LIGHT LIGHT_COLOR LIGHT_IS_DIRECTIONAL ATTENUATION DIFFUSE_LIGHT SPECULAR_LIGHT SPECULAR_AMOUNT
    CURRENT_RENDERER RENDERER_COMPATIBILITY RENDERER_MOBILE RENDERER_FORWARD_PLUS
    SCREEN_TEXTURE DEPTH_TEXTURE NORMAL_ROUGHNESS_TEXTURE";

/// Returns the names that a Godot shader declares outside functions.
fn global_names(text: &str) -> Vec<&str> {
    let names = text.lines().filter_map(|line| {
        let line = line.strip_prefix("#define ").map_or(line, |rest| rest);
        let is_declaration = !line.starts_with([' ', '/', '#', '}']) && line.contains(' ');
        let declared = line.split(['(', '=', ':', ';', '{', '[']).next().filter(|_| is_declaration)?.trim_end();
        declared.rsplit(' ').next()
    });
    names.filter(|name| !["spatial", "specular_disabled", "vertex", "fragment", "light"].contains(name)).collect()
}

#[test]
fn global_names_of_shaders_for_godot_are_none_of_its_own() {
    let sprite = SpriteTexture::new(&assets().sprite);
    let mut kinds = BTreeSet::new();
    for settings in all_settings() {
        let snippet = Snippet::new(&settings, Engine::Godot).unwrap();
        let [(_, text)] = &sources::sources(Engine::Godot, &settings, &snippet, &sprite).unwrap()[..] else {
            panic!("one file")
        };
        let names = global_names(text);
        assert!(names.len() > 20, "{names:?}");
        for name in names {
            assert!(name.starts_with("haze_") || name.starts_with("HAZE_"), "{name}");
            assert!(!BUILT_INS.split_whitespace().any(|own| own == name), "{name}");
            kinds.insert(name.to_owned());
        }
    }
    // Constants, uniforms, varyings, and functions of the library and of the material.
    for name in ["HAZE_BOOST", "haze_heat_ramp", "haze_turn", "haze_lib_coverage", "haze_coverage"] {
        assert!(kinds.contains(name), "{name} is not in {kinds:?}");
    }
    let named = "const uint BACKLIGHT = 0u;\nuniform vec2 size = vec2(1.0);\nvarying float amount;\nvoid vertex() {\n    x = 1;\n}";
    assert_eq!(global_names(named), ["BACKLIGHT", "size", "amount"]);
}

#[test]
fn materials_for_godot_have_the_heat_by_age() {
    let preset = Preset::load("campfire").unwrap();
    let assets = preset.load_materials("campfire".as_ref()).unwrap();
    for engine in ENGINES {
        let export = MaterialExport::new(&preset.name, 0, &preset.systems[0], &assets[0], engine).unwrap();
        let is_godot = engine == Engine::Godot;
        let knows_age = is_godot || engine == Engine::Three;
        assert_eq!(export.files().any(|file| file == "heat_ramp.png"), knows_age, "{engine:?}");
        let readme = &export.texts.iter().find(|(name, _)| name == "README.md").unwrap().1;
        assert_eq!(readme.contains("`haze_heat_ramp`"), is_godot, "{readme}");
        assert_eq!(readme.contains("| `heat_ramp.png` |"), knows_age, "{readme}");
        let by_age = "haze_particle_heat = haze_heat * haze_heat_by_age(haze_heat_ramp, age);";
        assert_eq!(export.texts[0].1.contains(by_age), is_godot, "{}", export.texts[0].1);
    }
}

/// Files of the first system of a preset for Godot.
fn godot_export(preset: &Preset) -> MaterialExport {
    let assets = preset.load_materials("column".as_ref()).unwrap();
    MaterialExport::new(&preset.name, 0, &preset.systems[0], &assets[0], Engine::Godot).unwrap()
}

fn text_of<'a>(export: &'a MaterialExport, file: &str) -> Option<&'a str> {
    export.texts.iter().find(|(name, _)| name == file).map(|(_, text)| text.as_str())
}

#[test]
fn scenes_for_godot_refer_to_what_is_there() {
    for name in haze_preset::builtin::PRESETS.iter().map(|preset| preset.name) {
        let preset = Preset::load(name).unwrap();
        let export = godot_export(&preset);
        let scene = text_of(&export, SCENE).unwrap();
        let quoted = |before: &str| -> BTreeSet<String> {
            scene.split(before).skip(1).map(|rest| rest.split('"').next().unwrap().to_owned()).collect()
        };
        let [external, internal] = [quoted("ExtResource(\""), quoted("SubResource(\"")];
        let used: BTreeSet<_> = external.union(&internal).cloned().collect();
        assert_eq!(used, quoted(" id=\""), "{name}");
        let files: BTreeSet<_> = export.files().map(str::to_owned).collect();
        for file in quoted(" path=\"") {
            assert!(files.contains(&file), "{name}: {file}");
            assert_eq!(file.ends_with(".png"), files.contains(&format!("{file}.import")), "{name}: {file}");
        }
        let is_no_number = |word: &str| matches!(word, "NaN" | "inf" | "-inf");
        assert!(!scene.split([' ', ',', '(', ')', '[', ']', '\n']).any(is_no_number), "{name}");
    }
}

#[test]
fn scenes_for_godot_have_the_numbers_of_the_emitter() {
    let mut preset = Preset::load("column").unwrap();
    let number = |preset: &Preset, name: &str| -> String {
        let export = godot_export(preset);
        let scene = text_of(&export, SCENE).unwrap();
        let line = scene.lines().find_map(|line| line.strip_prefix(&format!("{name} = ")));
        line.unwrap_or_else(|| panic!("{name}")).to_owned()
    };
    let emitter = &mut preset.systems[0].emitter;
    emitter.rate = 20.0;
    emitter.lifetime = 4.0;
    emitter.lifetime_spread = 0.25;
    emitter.turbulence = 0.0;
    emitter.velocity_spread = 0.6;
    emitter.drag = 0.5;
    assert_eq!(number(&preset, "lifetime"), "5.0");
    assert_eq!(number(&preset, "amount"), "100");
    assert_eq!(number(&preset, "lifetime_randomness"), "0.4");
    assert_eq!(number(&preset, "preprocess"), "5.0");
    assert_eq!(number(&preset, "initial_velocity_max"), "0.6");
    assert_eq!(number(&preset, "damping_max"), "0.1");
    preset.systems[0].emitter.size = 4.0;
    assert_eq!([number(&preset, "lifetime"), number(&preset, "amount")], ["10.0", "100"]);
    preset.systems[0].emitter.size = 1.0;
    preset.systems[0].emitter.duration = 2.0;
    assert_eq!([number(&preset, "amount"), number(&preset, "explosiveness")], ["40", "0.6"]);
    preset.systems[0].emitter.period = 8.0;
    assert_eq!(number(&preset, "amount"), "25");
}

#[test]
fn readmes_for_godot_say_what_its_particles_do_not_do() {
    let mut preset = Preset::load("column").unwrap();
    let has = |preset: &Preset, name: &str| {
        text_of(&godot_export(preset), "README.md").unwrap().contains(&format!("| `{name}` |"))
    };
    for name in ["period", "attraction", "ring_speed", "heat_spread", "obstacle"] {
        assert!(!has(&preset, name), "{name}");
    }
    let system = &mut preset.systems[0];
    system.emitter.duration = 1.0;
    system.emitter.period = 2.0;
    system.emitter.heat_spread = 0.5;
    system.emitter.attraction = 1.0;
    system.emitter.ring_speed = 1.0;
    system.emitter.obstacle_margin = 1.0;
    system.settings.fire.intensity = 2.0;
    for name in ["period", "attraction", "ring_speed", "heat_spread", "obstacle", "small_fraction", "turbulence"] {
        assert!(has(&preset, name), "{name}");
    }
    assert!(text_of(&godot_export(&preset), SCENE).is_some());
    preset.systems[0].particle_files.path = "smoke_####.ply".into();
    let export = godot_export(&preset);
    assert!(text_of(&export, SCENE).is_none());
    assert!(text_of(&export, "README.md").unwrap().contains("There is no scene with particles"));
}

#[test]
fn textures_hold_the_ramps_in_the_row_order_of_the_engine() {
    let preset = Preset::load("wildfire_sky").unwrap();
    let assets = preset.load_materials("wildfire_sky".as_ref()).unwrap();
    for engine in ENGINES {
        let export = MaterialExport::new(&preset.name, 0, &preset.systems[0], &assets[0], engine).unwrap();
        let names: Vec<_> = export.textures.iter().map(|(name, _)| name.as_str()).collect();
        let sprite = matches!(engine, Engine::Godot | Engine::Three).then_some("sprite.png");
        assert!(
            names.into_iter().eq(["diffuse_ramp.png", "backlight_ramp.png"].into_iter().chain(sprite)),
            "{engine:?}"
        );
        // Images of ramps have row 0 at the bottom.
        let mut image = export.textures[0].1.clone();
        if engine != Engine::Unity {
            image = image.flipv();
        }
        let read = Ramp::from_image(&image);
        let ramp = &assets[0].diffuse_ramp;
        assert_eq!(read.size(), ramp.size());
        for y in 0..ramp.size().y {
            for x in 0..ramp.size().x {
                let at = UVec2::new(x, y);
                // Half a code of 8 bits: 1/510 in sRGB is at most 0.0045 in linear light.
                let error = (read.texel(at) - ramp.texel(at)).abs().max_element();
                assert!(error < 0.005, "{engine:?} {at}: {error}");
            }
        }
        assert!(ramp.size().y == 1 || ramp.texel(UVec2::ZERO) != ramp.texel(UVec2::new(0, ramp.size().y - 1)));
    }
}

#[test]
fn materials_for_engines_of_flipbooks_alone_are_refused() {
    let preset = Preset::load("column").unwrap();
    let refused = |engine| {
        let made = MaterialExport::new(&preset.name, 0, &preset.systems[0], &assets(), engine);
        made.err().unwrap().to_string()
    };
    assert_eq!(
        refused(Engine::Babylon),
        "--engine: babylon is not valid; expected unreal, unity, godot, wgsl or three; for babylon, `haze export flipbook`"
    );
    assert!(refused(Engine::Playcanvas).starts_with("--engine: playcanvas is not valid; expected unreal, unity"));
}

#[test]
fn modules_for_three_js_hold_the_functions_that_they_call() {
    let sprite = SpriteTexture::new(&assets().sprite);
    for settings in all_settings() {
        let snippet = Snippet::new(&settings, Engine::Three).unwrap();
        let sources = sources::sources(Engine::Three, &settings, &snippet, &sprite).unwrap();
        let size: usize = sources.iter().map(|(_, text)| text.len()).sum();
        assert!(size <= 15_000, "{size} bytes");
        for (name, text) in sources {
            let left: Vec<_> =
                text.split('$').filter(|part| !part.is_empty() && part.chars().all(is_placeholder)).collect();
            assert!(left.is_empty(), "{name}: {left:?}");
            assert_eq!(text.contains("heat_ramp"), settings.burns(), "{name}");
        }
    }
}

fn is_placeholder(c: char) -> bool {
    c.is_ascii_uppercase() || c == '_'
}

#[test]
fn sprites_are_written_frame_by_frame() {
    let sprite = &assets().sprite;
    let sheet = SpriteTexture::new(sprite);
    let size = sprite.size();
    assert_eq!(sheet.frames, sprite.frame_count());
    assert!(sheet.cells.element_product() >= sheet.frames && sheet.cells.y * (sheet.cells.x - 1) < sheet.frames);
    assert_eq!(sheet.image.dimensions(), (sheet.cells * size).into());
    for frame in 0..sheet.frames {
        let cell = UVec2::new(frame % sheet.cells.x, frame / sheet.cells.x) * size;
        for (x, y) in [(size / 2, size / 2), (size / 3, size / 2), (size / 2, size / 3)] {
            let texel = sheet.image.get_pixel(cell.x + x, cell.y + y).0.map(f32::from);
            assert_eq!(Vec4::from(texel) / 255.0, sprite.texel(0, frame, x, y), "{frame} {x} {y}");
        }
    }
}

#[test]
fn light_that_comes_from_no_ramp_is_refused() {
    let mut preset = Preset::load("column").unwrap();
    let assets = assets();
    let refused = |preset: &Preset| {
        let made = MaterialExport::new(&preset.name, 0, &preset.systems[0], &assets, Engine::Wgsl);
        made.err().unwrap().to_string()
    };
    preset.systems[0].settings.diffuse.mode = DiffuseMode::PaintedMotif;
    assert!(refused(&preset).starts_with("systems[0].settings.diffuse.mode: \"painted_motif\" is not valid; expected"));
    preset.systems[0].settings.lighting = haze_core::settings::Lighting::SixWay;
    assert!(refused(&preset).contains("`haze sprite export` writes the six-way maps"));
}
