//! Sheets of many images: `haze debug-views`, `haze techniques`; and the table of `haze bench soft-particles`.

use std::collections::BTreeSet;

use haze_core::settings::DebugView;

use super::{folder, haze, refusal, render, size_of, stderr};

#[test]
fn sheet_of_debug_views_shows_every_stage() {
    let folder = folder();
    let output = haze(folder.path(), &["debug-views", "--size", "256x144", "--backend", "cpu", "-o", "sheet.png"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let sheet = haze_core::assets::image::read_png(&folder.path().join("sheet.png")).unwrap().to_rgb8();
    // Every stage is on the sheet as `haze render --view` renders it, in three rows of four.
    let mut corners = BTreeSet::new();
    for stage in DebugView::ALL {
        let output = render(folder.path(), &["--view", stage.name()]);
        assert!(output.status.success(), "{}", stderr(&output));
        let alone = haze_core::assets::image::read_png(&folder.path().join("out.png")).unwrap().to_rgb8();
        let is_at =
            |x: u32, y: u32| alone.enumerate_pixels().all(|(dx, dy, pixel)| sheet.get_pixel(x + dx, y + dy) == pixel);
        let right = sheet.width() - alone.width();
        let bottom = sheet.height() - alone.height();
        let corner = (0..=bottom).find_map(|y| (0..=right).find(|&x| is_at(x, y)).map(|x| (x, y)));
        corners.insert(corner.unwrap_or_else(|| panic!("no {} on the sheet", stage.name())));
    }
    let distinct = |list: Vec<u32>| list.into_iter().collect::<BTreeSet<_>>().len();
    let columns = distinct(corners.iter().map(|corner| corner.0).collect());
    let rows = distinct(corners.iter().map(|corner| corner.1).collect());
    assert_eq!((corners.len(), columns, rows), (11, 4, 3));
}

#[test]
fn techniques_sheet_shows_every_technique_with_its_cost() {
    let folder = folder();
    for backend in ["cpu", "gpu"] {
        let arguments = ["techniques", "--size", "128x72", "--backend", backend, "-o", "t.png", "--curves", "c.png"];
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        // Two columns of 64 pixels, five rows of 36, with margins, labels and lines below.
        let (width, height) = size_of(&folder.path().join("t.png"));
        let foot = height - (5 * (36 + 12 + 28) + 12);
        assert!(width == 2 * (64 + 12) + 12 && foot >= 24 && foot.is_multiple_of(24), "{width}x{height}");
        assert_eq!(size_of(&folder.path().join("c.png")), (800, 360));
    }
    let help = String::from_utf8(haze(folder.path(), &["techniques", "--help"]).stdout).unwrap();
    assert!(help.contains("Twice the size of an image on the sheet"), "{help}");
    let unknown = refusal(folder.path(), &["render", "--technique", "softest", "-o", "a.png"]);
    assert!(unknown.contains("volumetric_soft"), "{unknown}");
}

#[test]
fn without_visible_smoke_costs_are_left_out() {
    let folder = folder();
    let run = |time: &str| {
        let arguments =
            ["techniques", "colored_lights", "--size", "400x40", "--backend", "cpu", "--time", time, "-o", "t.png"];
        let output = haze(folder.path(), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        let sheet = haze_core::assets::image::read_png(&folder.path().join("t.png")).unwrap().to_rgb8();
        // Right of the name of the first cell, `hard`, and above its image.
        let costs = image::imageops::crop_imm(&sheet, 70, 12, 130, 28).to_image();
        let paper = *sheet.get_pixel(0, 0);
        (stderr(&output), costs.pixels().any(|pixel| *pixel != paper))
    };
    assert_eq!(run("0.5"), (String::new(), true));
    assert_eq!(run("1000"), ("haze: no smoke is visible: costs are left out\n".into(), false));
}

#[test]
fn nv_experiment_prints_the_papers_figures_beside_its_own() {
    let folder = folder();
    let output = haze(folder.path(), &["bench", "soft-particles", "--loops", "2", "--rounds", "1", "--size", "64x36"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let table = String::from_utf8(output.stdout).unwrap();
    let paper = [("hard", "34.6", "1.00"), ("soft", "13.3", "2.60"), ("soft_linear", "26.7", "1.30")];
    for source in ["reduced", "host"] {
        for (technique, fps, ratio) in paper {
            let rows = table.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
            let row = rows.into_iter().find(|row| row[..2] == [source, technique]).unwrap();
            assert_eq!(row[5..], [fps, ratio], "{table}");
            assert_eq!(row[3], "-", "one round has no spread: {table}");
            assert!(row[2].parse::<f64>().unwrap() > 0.0, "{table}");
        }
    }
    assert!(table.contains("one round"), "{table}");
    for bad in [["--loops", "0"], ["--loops", "-1"], ["--rounds", "x"]] {
        refusal(folder.path(), &[&["bench", "soft-particles"][..], &bad].concat());
    }
}
