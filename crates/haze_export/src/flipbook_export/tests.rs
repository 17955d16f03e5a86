use glam::{IVec2, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::{Image, read_png};
use haze_core::formula::color::{linear_from_srgb, luminance, srgb_from_linear};
use haze_core::formula::tonemap::DisplayTransform;
use haze_core::settings::{BlendMode, Tonemap};
use haze_demo::tonemap_pass::{encoded, rgba8};
use haze_preset::{CompressionEffort, Ease, KeyValue, Keyframe, Track};
use image::RgbaImage;
use pollster::block_on;

use super::*;
use crate::image_format::{Alpha, Background, Emission, ImageFormat};
use crate::smoke_layers::SmokeLayers;

/// Shows light that is exposed.
const EXPOSED: DisplayTransform = DisplayTransform { exposure: 1.0, tonemap: Tonemap::Aces };

mod motion;

const ENGINES: [Engine; 7] =
    [Engine::Unreal, Engine::Unity, Engine::Godot, Engine::Wgsl, Engine::Three, Engine::Babylon, Engine::Playcanvas];
const SIDE: u32 = 64;
const GO_ON: ExportProgress<'_> = ExportProgress::Callback(&|_, _| true);

fn shot(name: &str) -> Shot {
    Shot::load(name, UVec2::splat(SIDE)).unwrap()
}

fn frames(count: u32, rate: f32) -> Frames {
    Frames { range: 0..=count - 1, rate, format: ImageFormat::default() }
}

fn options(engine: Engine) -> FlipbookOptions {
    let cells = UVec2::splat(2);
    let effort = CompressionEffort::Quick;
    FlipbookOptions {
        engine,
        cells,
        alpha: Some(Alpha::Straight),
        emission: Emission::Contained,
        loop_fade: 0,
        has_six_way: false,
        effort,
    }
}

#[test]
fn frames_are_as_far_apart_after_hours_as_at_first() {
    let mut shot = shot("column");
    shot.preset.time = 10_000.0;
    let frames = frames(10, 60.0);
    let times: Vec<_> = (0..10).map(|frame| frames.shot(&shot, frame).preset.time).collect();
    assert!(times.windows(2).all(|pair| (pair[1] - pair[0] - 1.0 / 60.0).abs() < 1.0e-6), "{times:?}");
}

#[test]
fn engines_of_browsers_get_a_module_that_plays_the_flipbook() {
    let flipbook = |engine| Flipbook::new(&shot("column"), &frames(2, 24.0), options(engine));
    for (engine, call) in [
        (Engine::Three, "HazeFlipbook.load()"),
        (Engine::Babylon, "HazeFlipbook.load(BABYLON, scene)"),
        (Engine::Playcanvas, "HazeFlipbook.load(pc, app)"),
    ] {
        let made = flipbook(engine);
        let module = std::fs::read_to_string(made.folder.path().join(MODULE)).unwrap();
        assert!(module.len() <= 15_000 && module.contains("export class HazeFlipbook") && module.contains(call));
        let readme = std::fs::read_to_string(made.folder.path().join(README)).unwrap();
        assert!(readme.contains(call), "{readme}");
    }
    assert!(!flipbook(Engine::Godot).folder.path().join(MODULE).exists());
}

/// A flipbook, read back from its files.
struct Flipbook {
    folder: tempfile::TempDir,
    numbers: FlipbookNumbers,
}

impl Flipbook {
    fn new(shot: &Shot, frames: &Frames, options: FlipbookOptions) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let export = block_on(FlipbookExport::render(&Backend::Cpu, shot, frames, options, &GO_ON, folder.path()));
        let export = export.unwrap();
        export.write(folder.path()).unwrap();
        assert!(export.files().all(|name| folder.path().join(name).is_file() && FILES.contains(&name)));
        let numbers = std::fs::read(folder.path().join(NUMBERS)).unwrap();
        Self { folder, numbers: serde_json::from_slice(&numbers).unwrap() }
    }

    /// Cuts a frame out of a sheet, as an engine does.
    fn frame(&self, name: &str, index: u32) -> RgbaImage {
        let sheet = read_png(&self.folder.path().join(name)).unwrap().into_rgba8();
        let FlipbookNumbers { columns, rows, .. } = self.numbers;
        let size = UVec2::new(sheet.width() / columns, sheet.height() / rows);
        let at = UVec2::new(index % columns, index / columns) * size;
        image::imageops::crop_imm(&sheet, at.x, at.y, size.x, size.y).to_image()
    }
}

fn texel(image: &RgbaImage, at: IVec2) -> Vec4 {
    let at = at.clamp(IVec2::ZERO, IVec2::splat(SIDE as i32 - 1)).as_uvec2();
    Vec4::from(image.get_pixel(at.x, at.y).0.map(f32::from)) / 255.0
}

/// Bilinear filter; `uv` of one frame, from the upper left corner.
fn sample(image: &RgbaImage, uv: Vec2) -> Vec4 {
    let position = uv * SIDE as f32 - 0.5;
    let low = position.floor().as_ivec2();
    let fraction = position - position.floor();
    let row = |y: i32| texel(image, low + IVec2::new(0, y)).lerp(texel(image, low + IVec2::new(1, y)), fraction.x);
    row(0).lerp(row(1), fraction.y)
}

fn pixels() -> impl Iterator<Item = UVec2> {
    (0..SIDE * SIDE).map(|index| UVec2::new(index % SIDE, index / SIDE))
}

/// Mean squared difference of premultiplied images.
fn difference(a: impl Fn(UVec2) -> Vec4, b: impl Fn(UVec2) -> Vec4) -> f32 {
    let premultiplied = |texel: Vec4| (texel.xyz() * texel.w).extend(texel.w);
    pixels().map(|at| (premultiplied(a(at)) - premultiplied(b(at))).length_squared()).sum::<f32>()
        / (SIDE * SIDE) as f32
}

#[test]
fn frames_of_the_sheets_are_those_of_the_renderer() {
    for (name, engine) in [("column", Engine::Unreal), ("campfire", Engine::Unity), ("column", Engine::Godot)] {
        let shot = shot(name);
        let frames = frames(3, 8.0);
        let flipbook = Flipbook::new(&shot, &frames, options(engine));
        let now = frames.shot(&shot, 2);
        let format = ImageFormat { background: Background::Transparent, ..ImageFormat::default() };
        let direct = block_on(format.render(&now, async |shot| shot.render_on_cpu())).unwrap().into_rgba8();
        let layers = block_on(SmokeLayers::new(&Backend::Cpu, &now)).unwrap();
        let normals = block_on(layers.normals()).unwrap();
        let color = flipbook.frame(sheets::COLOR, 2);
        let normal = flipbook.frame(sheets::NORMALS, 2);
        let mut compared = 0;
        for at in pixels() {
            let [found, expected] = [&color, &direct].map(|image| image.get_pixel(at.x, at.y).0);
            assert_eq!(found[3], expected[3], "{name} {at}");
            if found[3] < 8 {
                continue;
            }
            compared += 1;
            // Dithering depends on the position on the sheet, and moves either value by up to a step.
            let apart = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max();
            assert!(apart <= Some(2), "{name} {at}: {found:?}, not {expected:?}");
            let mean = normals.load(at.as_ivec2()).xyz().normalize_or(Vec3::Z);
            let green = if engine == Engine::Unreal { -1.0 } else { 1.0 };
            let decoded = (texel(&normal, at.as_ivec2()).xyz() * 2.0 - 1.0) * Vec3::new(1.0, green, 1.0);
            // Half a step of 8 bits in each component.
            assert!((decoded - mean).length() < 0.01, "{name} {at}: {decoded}, not {mean}");
        }
        assert!(compared > 200, "{name}: {compared}");
        // Unused cells are clear.
        assert!(flipbook.frame(sheets::COLOR, 3).pixels().all(|pixel| pixel.0[3] == 0));
        assert_eq!(flipbook.folder.path().join(sheets::EMISSION).exists(), name == "campfire");
    }
}

#[test]
fn premultiplied_flipbooks_keep_the_glow_of_fire() {
    let shot = shot("campfire");
    let frames = frames(2, 8.0);
    let premultiplied = FlipbookOptions { alpha: None, ..options(Engine::Unity) };
    let color = |options| Flipbook::new(&shot, &frames, options).frame(sheets::COLOR, 1);
    let [kept, straight] = [premultiplied, options(Engine::Unity)].map(color);
    let [before_black, _] = crate::smoke_alone::before_two_skies(&frames.shot(&shot, 1));
    let before_black = haze_demo::tonemap_pass::tonemap(&before_black.render_on_cpu().unwrap(), &before_black);
    let over_black =
        |texel: Vec4| Vec3::from(texel.xyz().to_array().map(|code| srgb_from_linear(linear_from_srgb(code) * texel.w)));
    let mut clear = 0;
    let mut error = 0.0;
    for at in pixels() {
        let [found, divided] = [&kept, &straight].map(|image| image.get_pixel(at.x, at.y).0);
        let expected = before_black.get_pixel(at.x, at.y).0;
        assert_eq!(found[3], divided[3], "{at}");
        // Dithering depends on the position on the sheet, and moves either value by up to a step.
        let apart = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max();
        assert!(apart <= Some(2), "{at}: {found:?}, not {expected:?}");
        clear += u32::from(found == [0; 4]);
        let apart = over_black(texel(&straight, at.as_ivec2())) - texel(&kept, at.as_ivec2()).xyz();
        error += apart.length_squared() / (3 * SIDE * SIDE) as f32;
    }
    // 31 dB at 256 pixels.
    assert!(clear > 200 && -10.0 * error.log10() < 40.0, "{clear} clear, {} dB", -10.0 * error.log10());
}

#[test]
fn flipbooks_are_premultiplied_if_a_system_burns_at_any_time() {
    let frames = frames(2, 1.0);
    let mut fire = Shot::load("campfire", UVec2::splat(16)).unwrap();
    fire.preset.systems.truncate(1);
    let key = |time, intensity| Keyframe { time, value: KeyValue::Number(intensity), ease: Ease::Hold };
    let start = fire.preset.time as f32;
    let keys = vec![key(start, 0.0), key(start + 0.5, 1.0)];
    fire.preset.animation =
        vec![Track { setting: "systems[0].settings.fire.intensity".into(), keys, ..Track::default() }];
    let unset = FlipbookOptions { alpha: None, ..options(Engine::Unity) };
    assert_eq!(Flipbook::new(&fire, &frames, unset).numbers.alpha, Alpha::Premultiplied);
    // Nor is glow that hides nothing.
    let mut glow = Shot::load("column", UVec2::splat(16)).unwrap();
    glow.preset.systems[0].settings.blend_mode = BlendMode::Additive;
    assert_eq!(Flipbook::new(&glow, &frames, unset).numbers.alpha, Alpha::Premultiplied);
}

#[test]
fn pages_of_flipbooks_name_the_blend_mode() {
    for (engine, straight, premultiplied, linear) in [
        (
            Engine::Unreal,
            "`Translucent`",
            "`AlphaComposite (Premultiplied Alpha)`",
            "Unreal Engine blends linear light",
        ),
        (
            Engine::Unity,
            "`Blend SrcAlpha OneMinusSrcAlpha`",
            "`Blend One OneMinusSrcAlpha`",
            "*Project Settings > Player > Color Space* is `Linear`",
        ),
        (Engine::Godot, "`blend_mix`", "`blend_premul_alpha`", "Compatibility blends codes"),
        (
            Engine::Wgsl,
            "`BlendState::ALPHA_BLENDING`",
            "`BlendState::PREMULTIPLIED_ALPHA_BLENDING`",
            "`Bgra8UnormSrgb`",
        ),
    ] {
        let wanted = [(Alpha::Straight, straight, premultiplied), (Alpha::Premultiplied, premultiplied, straight)];
        for (alpha, named, other) in wanted {
            let readme = page(engine, alpha);
            assert!(readme.contains(named) && !readme.contains(other), "{engine:?}: {readme}");
            assert!(readme.contains(linear), "{engine:?}: {readme}");
        }
    }
}

/// Page of a flipbook with all files.
fn page(engine: Engine, alpha: Alpha) -> String {
    let scales = Scales { motion: 0.1, six_way_intensity: Some(2.0), six_way_emission: Some(3.0) };
    let images = FILES[..6].iter().copied();
    let numbers = FlipbookNumbers::new(&options(engine), alpha, UVec2::splat(SIDE), 4, 24.0, &scales, images);
    readme::readme(engine, "Fire", &numbers)
}

/// Rows of the table of `flipbook.json` in the documentation: key, type, content.
fn documented_keys() -> Vec<[String; 3]> {
    let text = include_str!("../../../../docs/export.md");
    let table = text.split("| key | type | content |").nth(1).unwrap();
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let row = |line: &str| {
        let mut cells = line.trim_matches('|').splitn(3, '|').map(|cell| cell.trim().to_owned());
        [(); 3].map(|()| cells.next().unwrap())
    };
    rows.map(row).map(|[key, kind, content]| [key.trim_matches('`').to_owned(), kind, content]).collect()
}

#[test]
fn flipbook_json_is_as_documented() {
    let shot = Shot::load("campfire", UVec2::splat(16)).unwrap();
    let frames = frames(2, 12.5);
    let documented = documented_keys();
    for engine in ENGINES {
        let options = FlipbookOptions { alpha: None, loop_fade: 1, has_six_way: true, ..options(engine) };
        let flipbook = Flipbook::new(&shot, &frames, options);
        let text = std::fs::read_to_string(flipbook.folder.path().join(NUMBERS)).unwrap();
        let numbers: serde_json::Value = serde_json::from_str(&text).unwrap();
        let all = numbers.as_object().unwrap();
        let files = numbers["files"].as_array().unwrap().iter().flat_map(|file| file.as_object().unwrap());
        let of_files = files.map(|(key, value)| (format!("files[].{key}"), value));
        let mut seen = Vec::new();
        for (key, value) in all.iter().map(|(key, value)| (key.clone(), value)).chain(of_files) {
            let [_, kind, content] =
                documented.iter().find(|[name, ..]| *name == key).unwrap_or_else(|| panic!("{key}"));
            let is_kind = match kind.as_str() {
                "integer" => value.is_u64(),
                "number" => value.is_number(),
                "boolean" => value.is_boolean(),
                "array" => value.is_array(),
                _ => value.as_str().is_some_and(|value| content.contains(&format!("`{value}`"))),
            };
            assert!(is_kind, "{engine:?}: {key} is {value}, not {kind}: {content}");
            seen.push(key);
        }
        let missing = documented.iter().map(|[key, ..]| key).find(|key| !seen.contains(key));
        let expected = if engine == Engine::Unity { None } else { Some("six_way_emission") };
        assert_eq!(missing.map(String::as_str), expected, "{engine:?}");
        let FlipbookNumbers { version, frame_width, rate, is_loop, normal_green, motion_green, .. } = flipbook.numbers;
        assert!(version == 1 && frame_width == 16 && rate.to_bits() == 12.5_f32.to_bits() && is_loop);
        let [up, down] = [numbers::Direction::Up, numbers::Direction::Down];
        assert_eq!(normal_green, if engine == Engine::Unreal { down } else { up });
        assert_eq!(motion_green, if engine == Engine::Unity { up } else { down });
        // The images are those of the files, in the same order, and have alpha where it is told.
        for file in numbers["files"].as_array().unwrap() {
            let image = read_png(&flipbook.folder.path().join(file["name"].as_str().unwrap())).unwrap();
            assert_eq!(image.color().has_alpha(), file["alpha"] != "none", "{file}");
        }
    }
}

#[test]
fn separate_emission_is_the_part_that_the_color_lacks() {
    let shot = shot("campfire");
    let frames = frames(1, 8.0);
    let separate = FlipbookOptions { emission: Emission::Separate, alpha: None, ..options(Engine::Godot) };
    let whole = FlipbookOptions { alpha: Some(Alpha::Premultiplied), ..options(Engine::Godot) };
    let layers = block_on(SmokeLayers::new(&Backend::Cpu, &shot)).unwrap();
    let fire = block_on(layers.fire()).unwrap();
    let transform = display_transform(&shot);
    let exposure = transform.exposure;
    let burning = pixels().filter(|at| fire.load(at.as_ivec2()).x * exposure > 0.5).count();
    let [part, whole] = [separate, whole].map(|options| Flipbook::new(&shot, &frames, options));
    // Without the glow, straight color keeps all.
    assert_eq!((part.numbers.alpha, part.numbers.emission), (Alpha::Straight, Some(Emission::Separate)));
    assert_eq!(whole.numbers.emission, Some(Emission::Contained));
    let [part_color, color] = [&part, &whole].map(|flipbook| flipbook.frame(sheets::COLOR, 0));
    let emission = part.frame(sheets::EMISSION, 0);
    let same =
        pixels().all(|at| emission.get_pixel(at.x, at.y) == whole.frame(sheets::EMISSION, 0).get_pixel(at.x, at.y));
    assert!(same && burning > 10, "{burning}");
    for at in pixels().map(UVec2::as_ivec2) {
        let light = layers.light.load(at);
        let fire = fire.load(at);
        let rest = (light.xyz() - fire.xyz()).max(Vec3::ZERO).extend(light.w);
        if light.w > 0.05 {
            let rest = Image { size: UVec2::ONE, texels: vec![(rest.xyz() / rest.w).extend(rest.w)] };
            let apart = (encoded(&rest, transform).load(IVec2::ZERO) - texel(&part_color, at)).abs().max_element();
            // Half a step of 8 bits, and dithering by up to a step.
            assert!(apart < 1.6 / 255.0, "{at}: {apart}");
        }
        if fire.x * exposure > 0.5 {
            assert!(texel(&part_color, at).x * light.w < texel(&color, at).x, "{at}");
        }
    }
    let none = FlipbookOptions { emission: Emission::Separate, ..options(Engine::Godot) };
    let refused = none.check(&self::shot("column"), &frames).unwrap_err().to_string();
    assert_eq!(refused, "--emission: separate, but no system burns in these frames; expected contained");
}

#[test]
fn sprite_sheets_have_the_place_of_each_frame() {
    let numbers = |columns| {
        let options = FlipbookOptions { cells: UVec2::new(2, columns), ..options(Engine::Wgsl) };
        let scales = Scales { motion: 0.1, six_way_intensity: None, six_way_emission: None };
        FlipbookNumbers::new(&options, Alpha::Straight, UVec2::new(32, 16), 5, 24.0, &scales, FILES.into_iter())
    };
    let text = sprite_sheet::sprite_sheet("Camp Fire", &numbers(3));
    let sheet: serde_json::Value = serde_json::from_str(&text).unwrap();
    let frame = &sheet["frames"]["camp_fire_0004"];
    assert_eq!(frame["frame"], serde_json::json!({ "x": 32, "y": 16, "w": 32, "h": 16 }));
    assert_eq!(frame["sourceSize"], serde_json::json!({ "w": 32, "h": 16 }));
    assert_eq!(sheet["frames"].as_object().unwrap().len(), 5);
    assert_eq!(sheet["animations"]["camp_fire"][4], "camp_fire_0004");
    let meta = &sheet["meta"];
    assert!(meta["image"] == "color.png" && meta["size"] == serde_json::json!({ "w": 96, "h": 32 }), "{meta}");
}

#[test]
fn faded_flipbooks_loop() {
    let shot = shot("column");
    let frames = frames(4, 4.0);
    let gap = |fade: u32| {
        let flipbook = Flipbook::new(&shot, &frames, FlipbookOptions { loop_fade: fade, ..options(Engine::Godot) });
        let image = |index| flipbook.frame(sheets::COLOR, index);
        let first = image(0);
        let last = image(3);
        let second = image(2);
        let apart =
            |a: &RgbaImage, b: &RgbaImage| difference(|at| texel(a, at.as_ivec2()), |at| texel(b, at.as_ivec2()));
        (apart(&last, &first), apart(&second, &last))
    };
    let (open, _) = gap(0);
    let (closed, usual) = gap(2);
    // The first frame follows the last as the last follows the one before.
    assert!(
        closed < 1.5 * usual && closed < 0.8 * open,
        "{open} without a fade, {closed} with, {usual} between frames"
    );
    let options = FlipbookOptions { loop_fade: 4, ..options(Engine::Godot) };
    let refused = block_on(FlipbookExport::render(&Backend::Cpu, &shot, &frames, options, &GO_ON, "x".as_ref()));
    assert_eq!(
        refused.err().unwrap().to_string(),
        "--loop: 4 is not valid; expected less than the number of frames, 4"
    );
}

#[test]
fn six_way_maps_are_the_smoke_under_each_light() {
    for engine in [Engine::Unity, Engine::Unreal] {
        let shot = shot("column");
        let frames = frames(1, 8.0);
        let flipbook = Flipbook::new(&shot, &frames, FlipbookOptions { has_six_way: true, ..options(engine) });
        let layers = block_on(SmokeLayers::new(&Backend::Cpu, &shot)).unwrap();
        let [positive, negative] = block_on(layers.six_way()).unwrap();
        let maps = sheets::SIX_WAY.map(|name| flipbook.frame(name, 0));
        let intensity = flipbook.numbers.six_way_intensity.unwrap();
        let mut compared = 0;
        let mut means = [Vec3::ZERO; 2];
        for at in pixels().map(|at| IVec2::new(at.x as i32, at.y as i32)) {
            let opacity = layers.light.load(at).w;
            if opacity < 0.05 {
                continue;
            }
            compared += 1;
            let [first, second] = maps.each_ref().map(|map| texel(map, at));
            let emission = if engine == Engine::Unity { 0.0 } else { first.w };
            assert!(second.w.to_bits() == emission.to_bits() && (first.w - opacity).abs() < 0.003, "{engine:?} {at}");
            let found = engine.six_way_packing().six_way(first.xyz(), second.xyz());
            let sides = [(found.positive, &positive), (found.negative, &negative)];
            for ((found, expected), mean) in sides.into_iter().zip(&mut means) {
                let expected = expected.load(at).xyz() / opacity;
                // Half a step of 8 bits.
                assert!((found * intensity - expected).abs().max_element() < 0.003 * intensity, "{engine:?} {at}");
                *mean += expected;
            }
        }
        assert!(compared > 200);
        // Light from the viewer's side is brighter than light from behind.
        assert!(means[0].z > 1.2 * means[1].z, "{means:?}");
    }
}

#[test]
fn emission_of_six_way_maps_is_the_luminance_of_the_fire() {
    let shot = shot("campfire");
    let frames = frames(1, 8.0);
    let flipbook = |engine| Flipbook::new(&shot, &frames, FlipbookOptions { has_six_way: true, ..options(engine) });
    let unity = flipbook(Engine::Unity);
    let map = unity.frame(sheets::SIX_WAY[1], 0);
    let full = unity.numbers.six_way_emission.unwrap();
    let layers = block_on(SmokeLayers::new(&Backend::Cpu, &shot)).unwrap();
    let fire = block_on(layers.fire()).unwrap();
    let mut compared = 0_u32;
    let mut brightest = 0.0_f32;
    for at in pixels().map(UVec2::as_ivec2) {
        let opacity = layers.light.load(at).w;
        if opacity < 0.06 {
            continue;
        }
        let expected = luminance(fire.load(at).xyz()) / opacity;
        // Half a step of 8 bits.
        let apart = texel(&map, at).w * full - expected;
        assert!(apart.abs() < 0.003 * full, "{at}: {apart} of {expected}");
        compared += u32::from(expected > 0.1 * full);
        brightest = brightest.max(texel(&map, at).w);
    }
    assert!(compared > 10 && brightest > 0.3, "{compared} {brightest}");
    assert_eq!(flipbook(Engine::Unreal).numbers.six_way_emission, None);
    assert!(page(Engine::Unity, Alpha::Straight).contains("*Emissive Mode* `Single Channel`"));
}

#[test]
fn smoke_that_borders_cut_off_is_told_and_fits_a_wider_view() {
    let frames = frames(4, 4.0);
    let options = options(Engine::Unity);
    let cut = |shot: &Shot| {
        let folder = tempfile::tempdir().unwrap();
        let export = block_on(FlipbookExport::render(&Backend::Cpu, shot, &frames, options, &GO_ON, folder.path()));
        let export = export.unwrap();
        assert_eq!(export.cut_smoke.is_some(), export.readme.contains("cuts off smoke"));
        export.cut_smoke
    };
    let mut shot = shot("column");
    shot.preset.camera.fov = 20.0;
    let found = cut(&shot).unwrap();
    assert!(found.frame == 0 && found.frames == 4 && found.alpha > 0.2, "{found:?}");
    let text = found.to_string();
    assert!(text.starts_with(&format!("frame 0 cuts off smoke on its {} side, with alpha", found.side)), "{text}");
    let fov = found.fitting_fov.unwrap();
    assert!(text.ends_with(&format!("a camera.fov of {fov:.1} degrees holds all of it (--fit)")), "{text}");
    block_on(options.fit(&Backend::Cpu, &mut shot, &frames, &GO_ON)).unwrap();
    assert_eq!(shot.preset.camera.fov.to_bits(), fov.to_bits());
    assert_eq!(cut(&shot), None);
    // A view that is a tenth narrower is too narrow.
    shot.preset.camera.fov *= 0.9;
    assert!(cut(&shot).is_some());
    // Inside the smoke nothing fits.
    shot.preset.camera.position = shot.preset.camera.target;
    shot.preset.camera.target.x += 1.0;
    let refused = block_on(options.fit(&Backend::Cpu, &mut shot, &frames, &GO_ON)).unwrap_err().to_string();
    assert_eq!(refused, "--fit: no field of view holds all of the smoke; expected a camera further back");
}

#[test]
fn stopped_flipbooks_leave_no_file() {
    let shot = shot("column");
    let frames = frames(3, 8.0);
    let folder = tempfile::tempdir().unwrap();
    let options = FlipbookOptions { loop_fade: 1, ..options(Engine::Unity) };
    let stop = ExportProgress::Callback(&|done, _| done < 2);
    let stopped = block_on(FlipbookExport::render(&Backend::Cpu, &shot, &frames, options, &stop, folder.path()));
    let said = stopped.err().unwrap().to_string();
    assert!(said.contains("stopped: not written; 2 of 4 images were rendered"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn searches_for_a_view_can_be_stopped_and_say_how_far_they_are() {
    let mut shot = shot("column");
    let frames = frames(3, 8.0);
    let seen = std::cell::RefCell::new(Vec::new());
    let stop = |done, count| {
        seen.borrow_mut().push((done, count));
        done < 2
    };
    let progress = ExportProgress::Callback(&stop);
    let options = options(Engine::Unity);
    let stopped = options.fit(&Backend::Cpu, &mut shot, &frames, &progress);
    let said = block_on(stopped).unwrap_err().to_string();
    assert!(said.contains("--fit: stopped: nothing is written; 2 of 3 images fit"), "{said}");
    let seen = seen.into_inner();
    assert!(seen.is_sorted() && seen.first() == Some(&(0, 3)) && seen.last() == Some(&(2, 3)), "{seen:?}");
}

#[test]
fn a_view_that_keyframes_set_is_not_told_to_fit() {
    let mut shot = shot("column");
    let frames = frames(2, 8.0);
    shot.preset.camera.fov = 20.0;
    let key = |time, fov| Keyframe { time, value: KeyValue::Number(fov), ease: Ease::Smooth };
    let keys = vec![key(0.0, 20.0), key(100.0, 20.0)];
    shot.preset.animation = vec![Track { setting: "camera.fov".into(), keys, ..Track::default() }];
    let folder = tempfile::tempdir().unwrap();
    let options = options(Engine::Unity);
    let export = FlipbookExport::render(&Backend::Cpu, &shot, &frames, options, &GO_ON, folder.path());
    let cut = block_on(export).unwrap().cut_smoke.unwrap();
    let fov = cut.fitting_fov.unwrap();
    let text = cut.to_string();
    assert!(
        text.ends_with(&format!("; a camera.fov of {fov:.1} degrees, without keyframes, holds all of it")),
        "{text}"
    );
    // Refused at once.
    let never = ExportProgress::Callback(&|_, _| false);
    let refused = block_on(options.fit(&Backend::Cpu, &mut shot, &frames, &never)).unwrap_err().to_string();
    assert_eq!(refused, "--fit: keyframes set camera.fov; expected a preset whose camera.fov has none");
}

#[test]
fn sheets_hold_one_row_of_frames() {
    for (preset, has_six_way) in [("column", false), ("campfire", true)] {
        let shot = shot(preset);
        let frames = frames(1, 8.0);
        let burns = frames.burns(&shot, 1);
        let layers = block_on(FrameLayers::render(&Backend::Cpu, &shot, 0.1, burns, has_six_way)).unwrap();
        let light = encoded(&layers.light, EXPOSED);
        let folder = tempfile::tempdir().unwrap();
        for rows in [1, 5] {
            let frame = shot.size;
            let cells = UVec2::new(rows, 3);
            let effort = CompressionEffort::Quick;
            let layout = SheetLayout {
                engine: Engine::Unity,
                frame,
                cells,
                alpha: Alpha::Straight,
                emission: Emission::Contained,
                tonemap: Tonemap::Aces,
                effort,
                folder: folder.path(),
            };
            let mut sheets = Sheets::new(layout, burns, has_six_way).unwrap();
            for _ in 0..3 * rows {
                sheets.place(&layers, HalfwayImages { before: Some(&light), after: Some(&light) }).unwrap();
            }
            let pixels = u64::from(3 * SIDE * SIDE);
            let expected = sheets::row_bytes_per_pixel(burns, has_six_way) * pixels;
            assert_eq!(sheets.bytes() as u64, expected, "{preset}, {rows} rows");
        }
        // Temporary files have no names.
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

#[test]
fn sheets_of_rows_are_those_of_whole_images() {
    let shot = shot("campfire");
    let frames = frames(3, 8.0);
    let at = |index| {
        let shot = frames.shot(&shot, index);
        block_on(FrameLayers::render(&Backend::Cpu, &shot, 1.0 / 8.0, true, true)).unwrap()
    };
    let layers = [at(0), at(1), at(2)];
    let light = layers.each_ref().map(|layers| encoded(&layers.light, EXPOSED));
    let flipbook = Flipbook::new(&shot, &frames, FlipbookOptions { has_six_way: true, ..options(Engine::Unreal) });
    let whole = |layer: &dyn Fn(usize) -> Image<Vec4>| {
        let mut sheet = Image::new(UVec2::splat(2 * SIDE), Vec4::ZERO);
        let frames: Vec<_> = (0..3).map(layer).collect();
        sheet.for_each(|at, texel| {
            let cell = at / SIDE;
            if let Some(frame) = frames.get((cell.x + 2 * cell.y) as usize) {
                *texel = frame.load((at % SIDE).as_ivec2());
            }
        });
        sheet
    };
    let file = |name: &str| read_png(&flipbook.folder.path().join(name)).unwrap();
    let colors = rgba8(&encoded(&whole(&|index| fill::filled(&layers[index].light)), EXPOSED));
    assert_eq!(file(sheets::COLOR).into_rgba8(), colors);
    let fire = rgba8(&encoded(&whole(&|index| layers[index].fire.clone().unwrap()), EXPOSED));
    assert_eq!(file(sheets::EMISSION).into_rgb8(), image::DynamicImage::from(fire).into_rgb8());
    let halfway = [0, 1].map(|index| {
        let light = block_on(frame_light(&Backend::Cpu, &frames.shot_halfway(&shot, index))).unwrap();
        encoded(&light, EXPOSED)
    });
    let motion = whole(&|index| {
        let neighbors =
            HalfwayImages { before: index.checked_sub(1).map(|at| &halfway[at]), after: halfway.get(index) };
        let motion = fill::filled(&layers[index].motion);
        motion_fit::kept_inside(&motion_fit::followed(&motion, &light[index], neighbors))
    });
    let visible = |image: &Image<Vec4>, value: &dyn Fn(&Vec4) -> f32| {
        image.texels.iter().filter(|texel| texel.w > 0.05).map(value).fold(0.0, f32::max)
    };
    let scale = visible(&motion, &|way| way.xy().abs().max_element());
    assert_eq!(scale.to_bits(), flipbook.numbers.motion_scale.to_bits());
    let sides = [0, 1].map(|side| whole(&|index| fill::filled(&layers[index].six_way.as_ref().unwrap()[side])));
    let brightest = sides.each_ref().map(|side| visible(side, &|light| light.xyz().max_element()));
    let intensity = brightest[0].max(brightest[1]);
    assert_eq!(Some(intensity.to_bits()), flipbook.numbers.six_way_intensity.map(f32::to_bits));
    let code = |value: f32| (value * 255.0).round() as u8;
    let motions = file(sheets::MOTION).into_rgb8();
    let positive = file(sheets::SIX_WAY[0]).into_rgba8();
    for (index, pixel) in (0..).zip(motions.pixels()) {
        let at = IVec2::new(index % (2 * SIDE as i32), index / (2 * SIDE as i32));
        let way = (motion.load(at).xy() / scale * Vec2::new(1.0, -1.0)).clamp(Vec2::NEG_ONE, Vec2::ONE) * 0.5 + 0.5;
        assert_eq!(pixel.0, [code(way.x), code(way.y), 128], "{at}");
        let [p, n] = sides.each_ref().map(|side| side.load(at) * (1.0 / intensity).max(0.0));
        // Right, left, top; opacity is not scaled.
        let expected = [p.x, n.x, p.y, sides[0].load(at).w].map(code);
        assert_eq!(positive.get_pixel(at.x as u32, at.y as u32).0, expected, "{at}");
    }
}
