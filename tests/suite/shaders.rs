//! Shaders loaded from a folder: edits change the image, and errors report file, line and column.

use std::path::Path;

use glam::{UVec2, Vec4};
use haze::shader::{self, Sources};
use haze::{Context, SceneDepthKind, WarmUp, read_only_depth_is_supported, wgpu};
use haze_core::assets::image::Image;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::Error;
use haze_core::settings::{DebugView, Lighting, RenderPath, Settings, SpriteAnimation};
use tempfile::TempDir;

use crate::gpu::{gpu, is_tiled_available, shared_context};
use crate::psnr::psnr;
use crate::test_host::Host;
use crate::test_scene::{TestScene, six_way_of};

const SIZE: UVec2 = UVec2::new(96, 64);

/// Temporary folder with the files of a shader author.
struct ShaderFolder(TempDir);

impl ShaderFolder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, file: &str, text: impl AsRef<[u8]>) -> &Self {
        let path = self.0.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
        self
    }

    /// Writes one of haze's shader files, with the first `from` replaced by `to`.
    fn edit(&self, file: &str, from: &str, to: &str) -> &Self {
        let text = shader::source(file).unwrap();
        assert!(text.contains(from), "{file} has no {from:?}");
        self.write(file, text.replacen(from, to, 1))
    }

    fn context(&self) -> Result<Context, Error> {
        Ok(shared_context().with_shaders(&Sources::from_folder(self.0.path())?)?)
    }

    fn image(&self) -> Image<Vec4> {
        draw(Some(&self.context().unwrap()))
    }

    /// Returns the error message of the folder, with file names relative to the folder.
    fn refusal(&self) -> String {
        let error = self.context().unwrap_err();
        gpu().check().unwrap();
        error.to_string().replace(&format!("{}/", self.0.path().display()), "")
    }
}

/// Stage with a cloud of puff sprites, each at a different time between two flipbook frames.
fn puffs(size: UVec2) -> TestScene {
    let mut scene = TestScene::new(size);
    let layout = SpriteLayout { columns: 4, rows: 2, y_down: false };
    scene.material.sprite = Sprite::load(Path::new("sprites/puff.png"), layout).unwrap();
    scene.material.six_way = Some(six_way_of(&scene.material.sprite));
    scene.material.detail = None;
    (0..).zip(&mut scene.particles).for_each(|(index, particle)| particle.frame = index as f32 * 0.37);
    scene
}

#[test]
fn trimming_transparent_borders_of_sprites_does_not_change_the_image() {
    let folder = ShaderFolder::new();
    let whole = folder.edit("lib/sprite_vertex.wgsl", "if CHECKERBOARD || MOTION {", "if true {").context().unwrap();
    type Change = fn(&mut Settings);
    let changes: [(&str, Change); 4] = [
        ("soft", |_| ()),
        ("six-way", |settings| settings.lighting = Lighting::SixWay),
        ("one frame", |settings| settings.sprite.animation = SpriteAnimation::Nearest),
        ("forward", |settings| settings.path = RenderPath::Forward),
    ];
    // At the small size, coarse mip levels are sampled.
    let sizes = [1, 8].map(|times| SIZE * times);
    for (size, (name, change)) in sizes.into_iter().flat_map(|size| changes.map(|change| (size, change))) {
        let mut scene = puffs(size);
        change(&mut scene.settings);
        let drawn = |context| {
            let mut host = Host::with_context(gpu(), &scene, context).unwrap();
            host.draw(gpu(), &scene).unwrap();
            host.image(gpu()).unwrap()
        };
        // Positions interpolated between other corners round differently. GPUs also snap each corner to 1/256 texel
        // first.
        let quality = psnr(&drawn(None), &drawn(Some(&whole)));
        println!("{name} at {size}: {quality:.1} dB");
        let is_cpu = gpu().adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        assert!(quality > if is_cpu { 85.0 } else { 70.0 }, "{name} at {size}: {quality:.1} dB");
    }
}

fn draw(context: Option<&Context>) -> Image<Vec4> {
    let scene = TestScene::new(SIZE);
    let mut host = Host::with_context(gpu(), &scene, context).unwrap();
    host.draw(gpu(), &scene).unwrap();
    host.image(gpu()).unwrap()
}

/// Returns `file:line:column` (1-based) of the first `what` in one of haze's shader files.
fn location(file: &str, what: &str) -> String {
    let before = shader::source(file).unwrap().split(what).next().unwrap();
    let line = before.matches('\n').count() + 1;
    format!("{file}:{line}:{}", before.rsplit('\n').next().unwrap().chars().count() + 1)
}

#[test]
fn shader_errors_report_file_line_and_column() {
    let refused = |from: &str, to: &str| ShaderFolder::new().edit("lib/color.wgsl", from, to).refusal();
    let says = |from: &str, to: &str, what: &str, reason: &str| {
        assert_eq!(refused(from, to), format!("{}: {reason}", location("lib/color.wgsl", what)), "{to}");
    };
    let shown = "saturate(light)";
    says(shown, "saturat(light)", shown, "no definition in scope for identifier: `saturat`");
    // An error in the validation of a function is reported at the expression that causes it.
    let sum = "Function 'srgb_color' is invalid: Operation Add can't work with vec3<f32> and vec2<f32>";
    says(shown, "saturate(light) + vec2f(f32(1u ^ 2u))", shown, sum);
    let returned =
        "Function 'srgb_from_linear' is invalid: The `return` expression does not match the declared return type";
    says("return linear * 12.92", "return vec3f(linear * 12.92)", "linear * 12.92", returned);
    // Columns count characters, not bytes; a tab is one character.
    let behind = refused("    let shown", "\t/* ü→ü */ let shown: vec2f");
    let location_of_shown = location("lib/color.wgsl", shown);
    let line = location_of_shown.strip_suffix(":17").unwrap();
    assert!(behind.starts_with(&format!("{line}:16: ")), "{behind}");
    let behind = refused("saturate(light)", "/* ü→ü */ saturat(light)");
    assert!(behind.starts_with(&format!("{line}:27: ")), "{behind}");
    // The compiler would report this missing brace in the file that is composed after this one.
    says(
        "    return min(light, vec3f(MAX_HALF_FLOAT_LIGHT));\n}",
        "",
        "{\n    return min(light, vec",
        "`{` is never closed",
    );
    let unended = refused("fn bounded_light", "/* fn bounded_light");
    assert_eq!(unended, format!("{}: unterminated block comment", location("lib/color.wgsl", "fn bounded_light")));
    // The error may be in an embedded file that no longer matches the edited one.
    let renamed = refused("fn overdraw_color", "fn overdrawn_color");
    let called = location("transfer.wgsl", "overdraw_color");
    assert!(renamed.starts_with(&format!("builtin:/{called}: no definition in scope")), "{renamed}");
}

#[test]
fn errors_that_only_pipeline_creation_detects_are_reported() {
    let is_cpu = gpu().adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    for pass in shader::sources().iter().map(|(file, _)| *file).filter(|file| !file.starts_with("lib/")) {
        // An entry point that every device of this kind compiles.
        let entry_point = match pass {
            // OpenGL cannot read multisampled depth.
            "depth_resolve.wgsl" if !read_only_depth_is_supported(&gpu().device) => continue,
            "emit.wgsl" => "emit",
            "measure.wgsl" => "sum_particles",
            "density_splat.wgsl" => "add_sprite",
            "shadow_march.wgsl" => "march_cells",
            "shadow_visibility.wgsl" => "look_up_cells",
            "sort.wgsl" => "count_digits",
            "depth_sort.wgsl" => "depth_keys",
            "tile_project.wgsl" => "project",
            "tile_gather.wgsl" => "gather",
            "upsample_lit.wgsl" => "pixels",
            "tile_bin.wgsl" if is_cpu => "allocate_per_invocation",
            "tile_bin.wgsl" => "build_lists_in_one_dispatch",
            // Compiled only where each invocation traverses the lists on its own.
            "tile_refine.wgsl" if !is_cpu => continue,
            "tile_refine.wgsl" => "refine",
            "tile_accumulate.wgsl" if is_cpu => "per_invocation",
            "tile_accumulate.wgsl" => "cooperative",
            _ => "fragment",
        };
        if entry_point != "fragment" && !is_tiled_available() {
            continue;
        }
        let refusal = ShaderFolder::new().edit(pass, &format!("fn {entry_point}("), "fn another(").refusal();
        assert_eq!(refusal, format!("{pass}:1:1: Unable to find entry point '{entry_point}'"));
    }
    let refused = |file: &str, from: &str, to: &str| ShaderFolder::new().edit(file, from, to).refusal();
    let gone = refused("lib/bounding_box.wgsl", "override BACK_FACES: bool", "const BACK_FACES: bool");
    assert!(gone.starts_with("builtin:/transfer.wgsl:1:1: ") && gone.contains("'BACK_FACES' not found"), "{gone}");
    let input = refused("lib/particle.wgsl", "@location(0)", "@location(9)");
    assert!(input.contains("accumulate.wgsl:1:1: Input is not provided"), "{input}");
    let divided = refused("transfer.wgsl", "if amount <= 0.0 {", "if amount <= f32(1u / DEBUG_VIEW) {");
    assert!(divided.ends_with("fragment shader: Division by zero"), "{divided}");
}

#[test]
fn warm_up_reports_errors_that_only_other_settings_compile() {
    let folder = ShaderFolder::new();
    // Valid for the final image, where DEBUG_VIEW is 0.
    folder.edit("transfer.wgsl", "if amount <= 0.0 {", "if amount <= f32(1u / (DEBUG_VIEW - 1u)) {");
    let mut scene = TestScene::new(SIZE);
    let host = Host::with_context(gpu(), &scene, Some(&folder.context().unwrap())).unwrap();
    let settings = [std::mem::take(&mut scene.settings)];
    let scene_depth = SceneDepthKind::Buffer(wgpu::TextureFormat::Depth32Float);
    let expected = WarmUp { view: scene.view, scene_depth, settings: &settings, debug_views: &[DebugView::Final] };
    host.renderer.warm_up(&expected).unwrap();
    let compiled = host.renderer.context().pipeline_count();
    let combined = WarmUp { debug_views: &[DebugView::Combined], ..expected };
    let error = host.renderer.warm_up(&combined).unwrap_err().to_string();
    assert!(
        error.ends_with("transfer.wgsl:1:1: Pipeline constant error in fragment shader: Division by zero"),
        "{error}"
    );
    gpu().check().unwrap();
    assert_eq!(host.renderer.context().pipeline_count(), compiled);
}

#[test]
fn missing_and_circular_imports_are_reported_at_the_import_line() {
    let imports = |import: &str| {
        let folder = ShaderFolder::new();
        folder.edit(
            "lib/color.wgsl",
            "const MAX_HALF_FLOAT_LIGHT",
            &format!("#import \"{import}\"\nconst MAX_HALF_FLOAT_LIGHT"),
        );
        folder
            .write("lib/round.wgsl", "#import \"lib/about.wgsl\"\n")
            .write("lib/about.wgsl", "\n#import \"lib/round.wgsl\"");
        (folder.refusal(), location("lib/color.wgsl", "const MAX_HALF_FLOAT_LIGHT").replace(":1", ":9"))
    };
    let (unknown, location) = imports("lib/nothing.wgsl");
    assert_eq!(unknown, format!("{location}: there is no shader file \"lib/nothing.wgsl\" to import"));
    for outside in ["../../etc", "/etc/hostname", "lib/../../secret.wgsl", "lib", "", "\0.wgsl"] {
        let (refused, location) = imports(outside);
        let reason = format!("there is no shader file {outside:?} to import; expected a .wgsl file inside the folder");
        assert_eq!(refused, format!("{location}: {reason}"));
    }
    let circle = "circular import: lib/round.wgsl → lib/about.wgsl → lib/round.wgsl";
    assert_eq!(imports("lib/round.wgsl").0, format!("lib/about.wgsl:2:9: {circle}"));
    let (itself, location) = imports("lib/color.wgsl");
    assert_eq!(itself, format!("{location}: circular import: lib/color.wgsl → lib/color.wgsl"));
}

#[test]
fn editing_an_imported_file_changes_the_image_and_undoing_restores_it() {
    let plain = draw(None);
    let folder = ShaderFolder::new();
    folder.edit("lib/color.wgsl", "return min(light, vec3f(", "return min(light * SHADE, vec3f(");
    assert!(folder.refusal().contains("`SHADE`"));
    // SHADE is defined in a separate file, which the others import.
    folder.edit("lib/blending.wgsl", "//", "#import \"mine/tint.wgsl\"\n//");
    folder.edit("lib/normal.wgsl", "//", "#import \"mine/tint.wgsl\"\n//");
    let text = std::fs::read_to_string(folder.0.path().join("lib/color.wgsl")).unwrap();
    folder.write("lib/color.wgsl", format!("#import \"mine/tint.wgsl\"\n{text}"));
    folder.write("mine/tint.wgsl", "const SHADE = vec3f(0.5);\n");
    assert_ne!(folder.image(), plain);
    folder.write("mine/tint.wgsl", "const SHADE = vec3f(1.0);\n");
    assert_eq!(folder.image(), plain);
    let read: Vec<_> = Sources::from_folder(folder.0.path()).unwrap().paths().map(Path::to_owned).collect();
    let files = ["lib/blending.wgsl", "lib/color.wgsl", "lib/normal.wgsl", "mine/tint.wgsl"];
    assert_eq!(read, files.map(|file| folder.0.path().join(file)));
}

#[test]
fn an_edit_compiles_the_pipelines_of_its_pass_alone() {
    let folder = ShaderFolder::new();
    let with_shaders =
        |context: &Context| context.with_shaders(&Sources::from_folder(folder.0.path()).unwrap()).unwrap();
    folder.edit("specular_scatter.wgsl", "//", "//");
    let unedited = with_shaders(&shared_context());
    assert_eq!(with_shaders(&unedited).pipeline_count(), 0);
    folder.edit("specular_scatter.wgsl", "//", "// Edited.\n//");
    let edited = with_shaders(&unedited);
    assert!((1..=4).contains(&edited.pipeline_count()), "{}", edited.pipeline_count());
    // The next one takes over edited passes, too.
    assert_eq!(with_shaders(&edited).pipeline_count(), 0);
}

#[test]
fn byte_order_marks_and_crlf_line_endings_are_accepted() {
    let plain = draw(None);
    let folder = ShaderFolder::new();
    for (file, text) in shader::sources() {
        folder.write(file, format!("\u{feff}{}", text.replace('\n', "\r\n")));
    }
    assert_eq!(folder.image(), plain);
    let text = shader::source("lib/color.wgsl").unwrap().replace('\n', "\r\n");
    folder.write("lib/color.wgsl", format!("\u{feff}{}", text.replace("saturate(light)", "saturat(light)")));
    let location = location("lib/color.wgsl", "saturate(light)");
    assert_eq!(folder.refusal(), format!("{location}: no definition in scope for identifier: `saturat`"));
}

/// Loops without a counter, and why they end.
const OTHER_LOOPS: &[(&str, &str)] = &[
    ("loop {", "leaves if no sprite is left"),
    ("while bits == 0u && next < end {", "`next` grows"),
    ("while slot < HAZE_SHADOWED_LIGHTS &&", "`slot` grows"),
];

/// Steps of counters. They change by constants, or by numbers that are never 0.
const STEPS: &[&str] = &[
    "++",
    "--",
    "/= 2u",
    "*= 2u",
    "&= bits - 1u",
    "+= 64u",
    "+= BITS_PER_WORD",
    "+= COUNTERS",
    "+= DIGITS",
    "+= SCAN_SIZE",
    "+= WORKGROUP",
    "+= measure.workgroups * WORKGROUP",
    "+= fraction",
    "+= stride",
];

#[test]
fn every_loop_of_the_shaders_ends() {
    for (file, text) in shader::sources() {
        let code: Vec<_> = text.lines().map(|line| line.split("//").next().unwrap().trim()).collect();
        for (at, line) in code.iter().enumerate() {
            let is_listed = || OTHER_LOOPS.iter().any(|(start, _)| line.starts_with(start));
            let is_loop = line.starts_with("loop {") || line.starts_with("while ");
            assert!(!is_loop || is_listed(), "{file}:{}: {line} is not listed", at + 1);
            if line.starts_with("for (") {
                let header = code[at..].join(" ");
                let header = header.split_once(" {").unwrap().0.trim_end_matches(')').trim();
                assert!(STEPS.iter().any(|step| header.ends_with(step)), "{file}:{}: {header}", at + 1);
            }
        }
    }
}

#[test]
fn folders_without_readable_shaders_are_rejected_with_a_reason() {
    let expected = "expected accumulate.wgsl, density_splat.wgsl, depth_downsample.wgsl, depth_resolve.wgsl, depth_slopes.wgsl, depth_sort.wgsl, diffuse_bake.wgsl, emit.wgsl, \
                    forward.wgsl, light_target.wgsl, mark_cells.wgsl, measure.wgsl, screen_shadow.wgsl, shadow_march.wgsl, shadow_march_slice.wgsl, shadow_visibility.wgsl, shadow_visibility_slice.wgsl, sort.wgsl, specular_scatter.wgsl, tile_accumulate.wgsl, tile_bin.wgsl, \
                    tile_gather.wgsl, tile_project.wgsl, tile_refine.wgsl, transfer.wgsl, transfer_lit.wgsl, upsample_lit.wgsl or a file of lib/ in it";
    let said = |path: &Path| Sources::from_folder(path).unwrap_err().to_string();
    let folder = ShaderFolder::new();
    let path = folder.0.path();
    assert_eq!(said(path), format!("{}: a folder without any of haze's shaders; {expected}", path.display()));
    let absent = path.join("absent");
    assert!(said(&absent).starts_with(&format!("{}: No such file", absent.display())), "{}", said(&absent));
    folder.write("readme.txt", "");
    assert!(said(&path.join("readme.txt")).ends_with(&format!("readme.txt: not a folder; {expected}")));

    assert_eq!(
        folder.write("lib/ramp.wgsl", b"// f\xc3\xbcr\n// f\xfcr\n").refusal(),
        "lib/ramp.wgsl:2:5: not a text file; expected UTF-8"
    );
    folder.write("lib/ramp.wgsl", vec![b' '; (1 << 20) + 1]);
    assert_eq!(folder.refusal(), "lib/ramp.wgsl: 1048577 bytes; expected a WGSL file of at most 1048576 bytes (1 MiB)");
    // The number of imported files is limited.
    folder.edit("lib/ramp.wgsl", "//", "#import \"0.wgsl\"\n//");
    for link in 0..300 {
        folder.write(&format!("{link}.wgsl"), format!("#import \"{}.wgsl\"\n", link + 1));
    }
    let last = 256 - shader::sources().len() - 1;
    assert_eq!(folder.refusal(), format!("{last}.wgsl:1:9: more than 256 files"));
}
