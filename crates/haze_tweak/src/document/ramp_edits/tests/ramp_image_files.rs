//! Tests of ramp files: written, copied, changed by other programs.

use super::*;

#[test]
fn an_image_painted_outside_takes_precedence_and_stops_can_be_fitted_to_it() {
    let folder = Folder::new();
    let mut harness = folder.open();
    harness.get_by_label("Flip").click();
    harness.run_steps(4);
    let flipped = folder.recipe();
    let painted = Template::find("hard_toon").unwrap().recipe().bake().unwrap();
    write_png(&folder.path("mine.png"), &painted, CompressionEffort::Quick).unwrap();
    wait(&mut harness);
    let name = "Fit stops to image: mine.png";
    let why = "Another program changed mine.png, so its stops can no longer be edited";
    assert!(harness.query_all_by_label_contains(why).next().is_some());
    assert!(harness.query_by_label_contains("The image does not match mine.ramp.json").is_some());
    assert!(harness.query_by_label(name).is_some() && harness.query_by_label("stop 1").is_none());
    assert_eq!(folder.recipe(), flipped, "nothing is written over it");
    assert_eq!(read_color_png(&folder.path("mine.png")).unwrap(), painted);
    let seen = harness.state().session.materials()[0].diffuse_ramp.clone();
    assert_eq!(seen, Ramp::from_image(&painted));
    harness.get_by_label(name).click();
    harness.run_steps(4);
    assert!(harness.query_by_label("stop 3").is_some());
    assert!(harness.query_all_by_label_contains("mine.png: 3 stops, largest error 0.").next().is_some());
    assert_eq!(read_color_png(&folder.path("mine.png")).unwrap(), painted, "until a stop is changed");
    harness.get_by_label("stop 2").focus();
    harness.run_steps(3);
    press(&mut harness, Key::Delete, Modifiers::NONE);
    assert_eq!(folder.recipe().rows[0].stops.len(), 2);
    assert!(folder.is_baked());
}

#[test]
fn a_painted_gradient_of_visible_steps_is_imported_and_baked() {
    let folder = Folder::new();
    std::fs::remove_file(folder.path("mine.ramp.json")).unwrap();
    let code = |x: u32| [40 + x * 40 / 256, 30 + x * 30 / 256, 60].map(|code| code as u8);
    let steps = image::RgbImage::from_fn(256, 1, |x, _| image::Rgb(code(x)));
    steps.save(folder.path("mine.png")).unwrap();
    let mut harness = folder.open();
    harness.get_by_label("Import and bake: mine.png").click();
    wait(&mut harness);
    assert!(harness.query_by_label("stop 1").is_some() && folder.is_baked());
    let baked = read_color_png(&folder.path("mine.png")).unwrap();
    assert_eq!(lint_ramp(&baked, None), []);
    let off = baked.to_rgb8().iter().zip(steps.iter()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(off <= Some(2), "{off:?}");
}

#[test]
fn rows_of_a_ramp_are_simplified_in_one_step() {
    let folder = Folder::new();
    let stops = |red: u8| [0.0, 0.5, 1.0].map(|at| RampStop::new(at, HexColor([red, (200.0 * at) as u8, 40])));
    let row = |index: u8| RampRow { at: f32::from(index) / 8.0, stops: stops(20 * index).into(), ..RampRow::default() };
    let recipe =
        RampRecipe { height: 32, rows: (0..=8).map(row).collect(), blend: Blend::Srgb, ..RampRecipe::default() };
    std::fs::write(folder.path("mine.ramp.json"), recipe.to_json()).unwrap();
    write_png(&folder.path("mine.png"), &recipe.bake().unwrap(), CompressionEffort::Quick).unwrap();
    let mut harness = folder.open();
    click(&mut harness, "Simplify rows");
    click(&mut harness, "Within 3 of 255");
    let simple = folder.recipe();
    assert!(simple.rows.len() <= 5 && folder.is_baked(), "{} rows", simple.rows.len());
    assert!(harness.query_all_by_label_contains("largest error").next().is_some());
    assert_eq!(harness.state().session.document.history().undo_name(), Some("Simplify rows: mine.png"));
    harness.state_mut().session.undo();
    harness.run_steps(4);
    assert_eq!(folder.recipe(), recipe);
}

#[test]
fn files_are_compared_after_a_write_and_before_they_are_overwritten() {
    let folder = Folder::new();
    let folders = AssetFolders::for_preset_file(&folder.preset());
    let mut document = Document::open(&folder.preset()).unwrap();
    let mut ramps = RampEdits::default();
    let painted = Template::find("hard_toon").unwrap().recipe().bake().unwrap();
    let is_recipe = |ramps: &mut RampEdits, document: &mut Document, is_held: bool| {
        ramps.advance(document, &folders, is_held).unwrap();
        matches!(ramps.source("mine.png", &folders), RampOrigin::Recipe(_))
    };
    assert!(is_recipe(&mut ramps, &mut document, false));
    write_png(&folder.path("mine.png"), &painted, CompressionEffort::Quick).unwrap();
    assert!(is_recipe(&mut ramps, &mut document, false), "nobody has said that there is something to look at");
    ramps.mark_stale();
    assert!(is_recipe(&mut ramps, &mut document, true) && !is_recipe(&mut ramps, &mut document, false));
    // The step ends before the change on disk was reported.
    let folder = Folder::new();
    let folders = AssetFolders::for_preset_file(&folder.preset());
    let mut document = Document::open(&folder.preset()).unwrap();
    let mut ramps = RampEdits::default();
    ramps.advance(&mut document, &folders, false).unwrap();
    assert!(matches!(ramps.source("mine.png", &folders), RampOrigin::Recipe(_)));
    document.recipes.ramps.set("mine.png", Template::find("moon").unwrap().recipe());
    ramps.advance(&mut document, &folders, true).unwrap();
    write_png(&folder.path("mine.png"), &painted, CompressionEffort::Quick).unwrap();
    ramps.advance(&mut document, &folders, false).unwrap();
    assert_eq!(read_color_png(&folder.path("mine.png")).unwrap(), painted);
}

#[test]
fn a_built_in_ramp_is_copied_beside_the_preset() {
    let folder = Folder::new();
    let mut preset = Preset::load("column").unwrap();
    let name = preset.systems[0].material.diffuse_ramp.clone();
    preset.name = "other".into();
    std::fs::write(folder.preset(), serde_json::to_string(&preset).unwrap()).unwrap();
    let mut harness = folder.open();
    click(&mut harness, &format!("Make my own…: {name}"));
    assert!(harness.query_by_label_contains("written beside own.json").is_some());
    click(&mut harness, "Make Copy");
    let file = format!("{name}_mine.png");
    assert_eq!(harness.state().session.document.preset.systems[0].material.diffuse_ramp, file);
    let own = RampRecipe::load(&folder.path(&file).with_extension("ramp.json")).unwrap();
    let loaded = Ramp::load(&folder.path(&file)).unwrap();
    assert_eq!(loaded, Ramp::from_image(&own.bake().unwrap()));
    assert_eq!(loaded, harness.state().session.materials()[0].diffuse_ramp, "it looks as it did");
    assert!(harness.query_by_label("stop 1").is_some());
}

#[test]
fn a_built_in_preset_must_be_saved_before_a_ramp_is_copied() {
    let mut harness = ramps_of("column");
    let name = harness.state().session.document.preset.systems[0].material.diffuse_ramp.clone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.json");
    let ask = |harness: &mut Harness<'static, Window>| {
        click(harness, &format!("Make my own…: {name}"));
        assert!(harness.query_by_label_contains("column is a built-in preset, so it is saved").is_some());
        click(harness, "Save Preset and Copy…");
        assert!(harness.state().file_actions.typed.is_some());
    };
    // Cancelled at once, or when the path is asked for: a later save copies nothing.
    click(&mut harness, &format!("Make my own…: {name}"));
    click(&mut harness, "Cancel");
    assert!(harness.state().file_actions.typed.is_none());
    ask(&mut harness);
    let Window { file_actions, session, .. } = harness.state_mut();
    file_actions.finish_typing(None, session);
    harness.run_steps(4);
    assert!(harness.state().session.document.is_built_in());
    let Window { file_actions, session, .. } = harness.state_mut();
    file_actions.save_as(session);
    file_actions.finish_typing(Some(&folder.path().join("plain.json")), session);
    wait(&mut harness);
    assert_eq!(harness.state().session.document.preset.systems[0].material.diffuse_ramp, name);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let mut harness = ramps_of("column");
    ask(&mut harness);
    let Window { file_actions, session, .. } = harness.state_mut();
    file_actions.finish_typing(Some(&path), session);
    wait(&mut harness);
    let file = format!("{name}_mine.png");
    assert_eq!(harness.state().session.document.preset.systems[0].material.diffuse_ramp, file);
    assert!(folder.path().join(&file).is_file() && folder.path().join(format!("{name}_mine.ramp.json")).is_file());
}

#[test]
fn a_curve_and_a_blend_space_are_chosen_and_undone() {
    let folder = Folder::new();
    let recipe = Template::find("neutral").unwrap().recipe();
    std::fs::write(folder.path("mine.ramp.json"), recipe.to_json()).unwrap();
    write_png(&folder.path("mine.png"), &recipe.bake().unwrap(), CompressionEffort::Quick).unwrap();
    let mut harness = folder.open();
    let choose = |harness: &mut Harness<'static, Window>, control: &str, entry: &str| {
        let control = harness.get_all_by_label(control).find(|node| node.accesskit_node().role() == Role::ComboBox);
        control.unwrap().click_accesskit();
        harness.run_steps(3);
        harness.get_by_label(entry).click_accesskit();
        harness.run_steps(4);
    };
    choose(&mut harness, "Curve", "Constant");
    assert_eq!(folder.recipe().rows[0].stops[0].curve, Curve::Constant);
    choose(&mut harness, "Blend in", "HSV, far hue");
    assert_eq!(folder.recipe().blend, Blend::HsvFar);
    assert!(folder.is_baked());
    assert!(harness.state().session.messages.latest().is_none_or(|message| !message.is_error));
    for _ in 0..2 {
        harness.state_mut().session.undo();
        harness.run_steps(4);
    }
    assert_eq!(folder.recipe(), recipe);
}

#[test]
fn a_write_error_is_reported() {
    let folder = Folder::new();
    let mut harness = folder.open();
    std::fs::remove_file(folder.path("mine.ramp.json")).unwrap();
    std::fs::create_dir(folder.path("mine.ramp.json")).unwrap();
    wait(&mut harness);
    // A folder has replaced the recipe's file, so the ramp has no recipe any more.
    assert!(harness.query_by_label("Fit stops to image: mine.png").is_some());
    harness.get_by_label("Fit stops to image: mine.png").click();
    harness.run_steps(3);
    harness.get_by_label("Flip").click();
    harness.run_steps(4);
    let message = harness.state().session.messages.latest().map(|message| (message.is_error, message.text.clone()));
    let (is_error, text) = message.unwrap();
    assert!(is_error && text.contains("mine.ramp.json"), "{text}");
    assert!(Path::new(&folder.path("mine.png")).is_file());
}
