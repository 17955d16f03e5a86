//! Tests of the flipbook and of the tab's layout.

use super::*;

#[test]
fn a_sprite_without_a_recipe_shows_that_and_the_findings_of_its_check() {
    let folder = Folder::new();
    std::fs::remove_file(folder.path("mine.sprite.json")).unwrap();
    let colors = image::RgbaImage::from_fn(192, 96, |x, y| {
        let is_border = x % 96 % 95 == 0 || y % 95 == 0;
        image::Rgba([200, 120, 20, if is_border { 0 } else { 255 }])
    });
    write_png(&folder.path("mine.png"), &colors.into(), CompressionEffort::Quick).unwrap();
    let mut harness = folder.open();
    assert!(harness.query_by_label_contains("This sprite has no recipe (mine.sprite.json)").is_some());
    assert!(harness.query_by_label_contains("normals: colors, not normals").is_some());
    harness.get_by_label("New from template").click();
    harness.run_steps(3);
    harness.get_by_label("ball").click();
    harness.run_steps(4);
    harness.get_by_label("Make Copy").click();
    harness.run_steps(4);
    let material = &harness.state().session.document.preset.systems[0].material;
    assert_eq!((material.sprite.as_str(), material.columns, material.rows), ("ball_mine.png", 2, 2));
    assert!(harness.query_by_label_contains("normals: ").is_none());
    unfold(&mut harness);
    assert!(!slider(&harness, "Erosion").accesskit_node().is_disabled());
}

#[test]
fn the_light_follows_its_controls_and_a_drag() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let mut halves = |azimuth| {
        harness.state_mut().session.view.sprite.light = Angles { azimuth, elevation: 0.0 };
        let rect = harness.get_by_label("Flipbook").rect();
        let image = screenshot(&mut harness);
        let middle = rect.center().x;
        [rect.with_max_x(middle), rect.with_min_x(middle)].map(|half: Rect| brightness(&image, half))
    };
    let [left, right] = halves(-90.0);
    assert!(left > right + 5.0, "{left} {right}");
    let [left, right] = halves(90.0);
    assert!(right > left + 5.0, "{left} {right}");
    // A drag to the left and up moves it along.
    let middle = harness.get_by_label("Flipbook").rect().center();
    let to = middle - Vec2::new(100.0, 50.0);
    harness.drag_at(middle);
    harness.hover_at(to);
    harness.step();
    harness.drop_at(to);
    harness.run_steps(2);
    let light = harness.state().session.view.sprite.light;
    assert!(light.azimuth < 60.0 && light.elevation > 10.0, "{light:?}");
}

#[test]
fn the_recipe_can_be_scrolled_to_in_the_smallest_window() {
    let mut harness = window("column", Vec2::new(640.0, 400.0), Theme::Dark);
    harness.state_mut().session.view.sprite.is_playing = false;
    harness.get_by_label("Sprite").click();
    until(&mut harness, |harness| harness.query_by_label("Reading the sprite…").is_none());
    slider(&harness, "Upright").scroll_to_me();
    harness.run_steps(8);
    let row = slider(&harness, "Upright").rect();
    let page = harness.get_by_label("viewport").rect();
    assert!(row.top() > page.top() && row.bottom() < page.bottom(), "{row} beside {page}");
}

#[test]
fn the_sprite_tab_is_as_wide_as_the_others() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let width = |harness: &Harness<'_, Window>| 1000.0 - harness.get_by_label("viewport").rect().right();
    harness.run_steps(10);
    let page = width(&harness);
    harness.get_by_label("Light").click();
    harness.run_steps(10);
    assert!((page - width(&harness)).abs() < 0.5 && page < 371.0, "{page}");
}

#[test]
fn the_flipbook_repaints_only_while_it_is_visible_and_playing() {
    let folder = Folder::new();
    let mut harness = folder.open();
    let is_still = |harness: &mut Harness<'_, Window>| {
        harness.run_steps(6);
        harness.output().viewport_output.values().all(|viewport| viewport.repaint_delay > Duration::from_secs(1))
    };
    // The thumbnail of the system comes in a pause.
    let started = Instant::now();
    while !is_still(&mut harness) {
        assert!(started.elapsed() < LONG, "never still");
    }
    let before = screenshot(&mut harness);
    harness.get_by_label("Play flipbook").click();
    assert!(!is_still(&mut harness));
    assert_ne!(screenshot(&mut harness), before);
    let frame = harness.state().session.view.sprite.frame;
    assert!(frame > 0.0);
    harness.get_by_label("Look").click();
    assert!(is_still(&mut harness));
    let frame = harness.state().session.view.sprite.frame;
    harness.run_steps(3);
    assert!((harness.state().session.view.sprite.frame - frame).abs() < 1e-6);
    harness.state_mut().session.view.sprite.is_playing = false;
    harness.state_mut().session.view.sprite.is_turning = true;
    harness.get_by_label("Sprite").click();
    assert!(!is_still(&mut harness));
}

/// `HAZE_LOOK=DIR` names the folder to write to.
#[test]
#[ignore = "writes images for visual inspection"]
fn write_images_of_the_sprite_tab() {
    let into = PathBuf::from(std::env::var_os("HAZE_LOOK").unwrap());
    let folder = Folder::new();
    let mut harness = window(folder.path("own.json").to_str().unwrap(), Vec2::new(1280.0, 800.0), Theme::Dark);
    harness.get_by_label("Sprite").click();
    until(&mut harness, |harness| harness.query_by_label("Reading the sprite…").is_none());
    for theme in [Theme::Dark, Theme::Light] {
        harness.ctx.set_theme(theme);
        harness.run_steps(3);
        screenshot(&mut harness).save(into.join(format!("sprite_own_{theme:?}.png"))).unwrap();
    }
    for (index, (_, name, _)) in crate::session::sprite_view::SPRITE_CHANNELS.iter().enumerate() {
        harness.get_by_label(name).click();
        harness.run_steps(3);
        screenshot(&mut harness).save(into.join(format!("sprite_shown_{index}.png"))).unwrap();
    }
}
