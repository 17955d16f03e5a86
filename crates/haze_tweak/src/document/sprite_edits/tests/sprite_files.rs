//! Tests of sprite files: written, copied, changed by other programs.

use eframe::egui::{ViewportCommand, ViewportEvent, ViewportId};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::super::sprite_bake_job::{BakeResult, SpriteBakeJob};
use super::super::sprite_source::{BakeSprite, NotBaked, ReadSprite, SpriteOrigin, stamps};
use super::*;
use crate::platform::portable_job::PortableJob;
use crate::window::testing;

#[test]
fn files_changed_by_another_program_are_not_overwritten_until_requested() {
    let folder = Folder::new();
    let mut harness = folder.open();
    set(&mut harness, "Bump", 3.0);
    until(&mut harness, |harness| !harness.state().session.sprites.is_baking());
    let other = SpriteRecipe { seed: 77, ..small() };
    write_png(&folder.path("mine.png"), &baked(&other).image.into(), CompressionEffort::Quick).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake recipe").is_some());
    until(&mut harness, |harness| Some(used(harness)) == folder.sprite());
    assert!(harness.query_by_label("Erosion").is_none() && (folder.recipe().bump - 3.0).abs() < 1e-6);
    // A recipe that is written by hand is another recipe as well.
    std::fs::write(folder.path("mine.sprite.json"), other.to_json()).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake recipe").is_none());
    std::fs::write(folder.path("mine.sprite.json"), small().to_json()).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake recipe").is_some());
    harness.get_by_label("Bake recipe").click();
    until(&mut harness, |_| folder.is_baked());
    assert_eq!(folder.recipe(), small());
}

#[test]
fn a_built_in_sprite_is_copied_beside_the_preset() {
    let folder = Folder::new();
    let name = "puff";
    let mut preset = Preset::load("column").unwrap();
    preset.systems[0].material.sprite = name.into();
    folder.write_preset(&preset);
    let mut harness = folder.open();
    let sprite = used(&harness);
    assert!(slider(&harness, "Erosion").accesskit_node().is_disabled());
    harness.get_by_label("Make my own…").click();
    harness.run_steps(4);
    harness.get_by_label("Make Copy").click();
    harness.run_steps(4);
    let file = format!("{name}_mine.png");
    assert_eq!(harness.state().session.document.preset.systems[0].material.sprite, file);
    assert!(folder.path("puff_mine.detail.png").is_file());
    assert_eq!(SpriteRecipe::load(&folder.path("puff_mine.sprite.json")).unwrap(), recipe_of_built_in(name).unwrap());
    until(&mut harness, |harness| {
        let session = &harness.state().session;
        session.loaded_materials.of(&session.document.preset)[0].detail.is_some()
    });
    assert_eq!(used(&harness), sprite, "it looks as it did");
    assert!(!slider(&harness, "Erosion").accesskit_node().is_disabled());
    assert!(!has_error(&harness));
}

#[test]
fn a_new_window_shows_the_flipbook_and_continues_the_bake() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let before = shown(&mut harness, "Flipbook");
    let memory = harness.ctx.memory(Clone::clone);
    set(&mut harness, "Columns", 8.0);
    assert!(harness.state().session.sprites.is_baking());
    let start = harness.into_state().into_start();
    let mut harness = testing::open(start, Vec2::new(1280.0, 1400.0), Theme::Dark);
    harness.ctx.memory_mut(|new| *new = memory);
    until(&mut harness, |harness| !harness.state().session.sprites.is_baking());
    assert!(folder.recipe().columns == 8 && folder.is_baked());
    let after = shown(&mut harness, "Flipbook");
    assert!((after - before).abs() < 2.0, "{before} {after}");
}

#[test]
fn an_outdated_bake_is_cancelled_and_not_written() {
    let folder = Folder::new();
    let image = folder.path("mine.png");
    let before = stamps(&image);
    let mut bake_job = SpriteBakeJob::new(|| ()).unwrap();
    let long = SpriteRecipe { size: 128, columns: 16, rows: 16, ..small() };
    let order = bake_job.full(long, image.clone(), before);
    let start = Instant::now();
    while order.frames() < 2 {
        assert!(start.elapsed() < LONG);
    }
    order.stop();
    let wait = |bake_job: &SpriteBakeJob| loop {
        assert!(start.elapsed() < LONG);
        if let Some(done) = bake_job.poll() {
            return done.unwrap();
        }
    };
    let done = wait(&bake_job);
    assert!(done.job == order.job && matches!(done.what, BakeResult::GivenUp) && order.frames() < 100);
    // Files that another program has changed are not overwritten either.
    std::fs::write(folder.path("mine.sprite.json"), "{}").unwrap();
    bake_job.full(small(), image.clone(), before);
    assert!(matches!(wait(&bake_job).what, BakeResult::GivenUp));
    assert_eq!(std::fs::read_to_string(folder.path("mine.sprite.json")).unwrap(), "{}");
    assert_eq!(stamps(&image)[..2], before[..2]);
}

#[test]
fn a_bake_and_a_reading_give_the_same_when_they_are_sent_as_text() {
    fn sent<T: Serialize + DeserializeOwned>(value: &T) -> T {
        serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
    }
    let folder = Folder::new();
    let image = folder.path("mine.png");
    let bake = || BakeSprite { recipe: small(), image: image.clone() };
    let [here, there] = [bake(), sent(&bake())].map(|job| job.run(&|_| true).ok().unwrap());
    let there = sent(&there);
    assert!(here.image == there.image && here.detail == there.detail && here.findings == there.findings);
    assert!(matches!(sent(&bake().run(&|_| false)), Err(NotBaked::Stopped)));
    let refused = BakeSprite { recipe: SpriteRecipe { columns: 0, ..small() }, ..bake() };
    assert!(matches!(sent(&refused.run(&|_| true)), Err(NotBaked::Refused { field, .. }) if field == "columns"));

    let read = || ReadSprite { name: "mine.png".into(), image: image.clone(), layout: small().layout() };
    // A page sends the files that the job names.
    let files = ["mine.png", "mine.sprite.json", "mine.sim.json"].map(|name| folder.path(name));
    assert_eq!(read().reads(), files);
    let [here, there] = [read(), sent(&read())].map(|job| job.run(&|_| true));
    let there = sent(&there);
    assert!(matches!(here.source, SpriteOrigin::Recipe(_)));
    assert_eq!((here.source, here.findings, here.broken), (there.source, there.findings, there.broken));
}

#[test]
fn closing_the_window_waits_for_the_bake_to_be_written() {
    let folder = Folder::new();
    let mut harness = folder.open();
    set(&mut harness, "Columns", 8.0);
    assert!(harness.state().session.sprites.is_baking());
    let close = |harness: &mut Harness<'_, Window>| {
        let viewport = harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
        viewport.events.push(ViewportEvent::Close);
        harness.step();
    };
    let asked = |harness: &Harness<'_, Window>, command: &ViewportCommand| {
        let output = &harness.output().viewport_output;
        output.values().any(|viewport| viewport.commands.contains(command))
    };
    close(&mut harness);
    assert!(asked(&harness, &ViewportCommand::CancelClose));
    let start = Instant::now();
    while !asked(&harness, &ViewportCommand::Close) {
        assert!(start.elapsed() < LONG);
        harness.step();
    }
    assert!(folder.is_baked());
}

#[test]
fn a_built_in_preset_must_be_saved_before_a_sprite_is_copied() {
    let mut harness = page_of("column");
    let name = harness.state().session.document.preset.systems[0].material.sprite.clone();
    let copy = format!("{name}_mine.png");
    harness.get_by_label("Make my own…").click();
    harness.run_steps(4);
    harness.get_by_label("Save Preset and Copy…").click();
    harness.run_steps(4);
    let folder = tempfile::tempdir().unwrap();
    let Window { file_actions, session, .. } = harness.state_mut();
    file_actions.finish_typing(Some(&folder.path().join("mine.json")), session);
    until(&mut harness, |_| folder.path().join(&copy).is_file());
    assert_eq!(harness.state().session.document.preset.systems[0].material.sprite, copy);
}

#[test]
fn a_write_error_is_reported() {
    let folder = Folder::new();
    std::fs::remove_file(folder.path("mine.detail.png")).unwrap();
    std::fs::create_dir(folder.path("mine.detail.png")).unwrap();
    let mut preset = Preset::load(folder.path("own.json")).unwrap();
    preset.systems[0].material.detail.clear();
    folder.write_preset(&preset);
    let mut harness = folder.open();
    set(&mut harness, "Bump", 3.0);
    until(&mut harness, |harness| !harness.state().session.sprites.is_baking());
    let said = harness.state().session.messages.latest().map(|message| message.text.clone());
    assert!(has_error(&harness) && said.as_ref().is_some_and(|said| said.contains("mine.detail.png")), "{said:?}");
    std::fs::remove_dir(folder.path("mine.detail.png")).unwrap();
    until(&mut harness, |harness| harness.query_by_label("Bake recipe").is_some());
    harness.get_by_label("Bake recipe").click();
    until(&mut harness, |_| folder.is_baked() && folder.path("mine.detail.png").is_file());
}
