use super::*;
use crate::deterministic_math::tests::hash;
use crate::ramp::blend_space::srgb_from_linear;

fn recipe(stops: &[(f32, &str)]) -> RampRecipe {
    let stop = |&(at, color): &(f32, &str)| RampStop::new(at, color.to_owned().try_into().unwrap());
    let stops = stops.iter().map(stop).collect();
    RampRecipe { width: 64, rows: vec![RampRow { stops, ..RampRow::default() }], ..RampRecipe::default() }
}

#[test]
fn a_gradient_has_the_exact_colors_of_its_stops() {
    let recipe = recipe(&[(0.0, "#102030"), (0.3, "#ff8040"), (1.0, "#ffffff")]);
    for stop in &recipe.rows[0].stops {
        let color = recipe.gradient().unwrap().sample(stop.at, 0.0);
        for (channel, expected) in color.to_array().into_iter().zip(stop.color.0) {
            assert!((srgb_from_linear(channel) * 255.0 - f32::from(expected)).abs() < 0.5, "{color}");
        }
    }
    let image = recipe.bake().unwrap().to_rgb8();
    assert_eq!(image.get_pixel(0, 0).0, [0x10, 0x20, 0x30]);
    assert_eq!(image.get_pixel(63, 0).0, [255, 255, 255]);
}

#[test]
fn the_curve_never_overshoots() {
    let recipe = recipe(&[(0.0, "#000000"), (0.5, "#000000"), (0.55, "#ffffff"), (1.0, "#ffffff")]);
    let mut last = 0.0;
    for step in 0..=400 {
        let gray = recipe.gradient().unwrap().sample(step as f32 / 400.0, 0.0).y;
        assert!(gray >= last - 1e-5 && gray <= 1.0 + 1e-4, "{step}: {gray} after {last}");
        last = gray;
    }
}

#[test]
fn stops_that_almost_coincide_form_an_edge() {
    for gap in [f32::from_bits(1), 1.0e-20, 1.0e-7] {
        let recipe = recipe(&[(0.0, "#000000"), (gap, "#404040"), (2.0 * gap, "#808080"), (1.0, "#ffffff")]);
        for u in [0.0, gap / 2.0, gap, 1.5 * gap, 2.0 * gap, 3.0 * gap, 0.5] {
            let color = recipe.gradient().unwrap().sample(u, 0.0);
            assert!(color.is_finite() && color.max_element() < 1.001, "{gap:e} {u:e}: {color}");
        }
        assert!(recipe.gradient().unwrap().sample(0.5, 0.0).x > 0.05);
    }
}

#[test]
fn baking_time_does_not_grow_with_the_number_of_stops_and_rows() {
    let rows = |rows: u32, stops: u32| {
        let place = |index: u32, count: u32| index as f32 / count as f32;
        let stop = |index| RampStop::new(place(index, stops), HexColor([index as u8; 3]));
        let stops: Vec<_> = (0..stops).map(stop).collect();
        let row = |index| RampRow { at: place(index, rows), stops: stops.clone(), ..RampRow::default() };
        let rows = (0..rows).map(row).collect();
        RampRecipe { width: 1024, height: 256, rows, ..RampRecipe::default() }
    };
    let started = std::time::Instant::now();
    rows(1, 100_000).bake().unwrap();
    rows(2_000, 20).bake().unwrap();
    // Takes tenths of a second. Time proportional to texels times stops or rows would be minutes.
    assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
}

#[test]
fn rows_are_interpolated_like_stops_along_a_row() {
    let mut tall = recipe(&[(0.0, "#102030"), (1.0, "#ff8040")]);
    let stops = |color: &str| vec![RampStop::new(0.0, color.to_owned().try_into().unwrap())];
    let colors = ["#000000", "#404040", "#505050", "#606060", "#ffffff"];
    let row =
        |(index, color): (usize, &&str)| RampRow { at: index as f32 / 4.0, stops: stops(color), ..RampRow::default() };
    tall.rows = colors.iter().enumerate().map(row).collect();
    // The same colors as stops of one row.
    let long = recipe(&[0, 1, 2, 3, 4].map(|index| (index as f32 / 4.0, colors[index])));
    for step in 0..=64 {
        let at = step as f32 / 64.0;
        assert_eq!(tall.gradient().unwrap().sample(0.3, at), long.gradient().unwrap().sample(at, 0.0), "{at}");
    }
}

#[test]
fn the_largest_baked_image_can_be_read() {
    let mut large = recipe(&[(0.0, "#102030")]);
    large.width = 4096;
    large.height = 4096;
    let error = large.validate().unwrap_err().to_string();
    assert_eq!(error, "height: 4096 is not valid; expected 1 to 2730 texels");
    large.height = 2730;
    let mut png = Vec::new();
    let baked = large.bake().unwrap();
    baked.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
    assert_eq!(haze_core::assets::image::decode_png(Path::new("large.png"), &png).unwrap().height(), 2730);
}

#[test]
fn stops_are_sorted_stably_and_invalid_ones_are_refused_by_name() {
    let color = |recipe: &RampRecipe, u: f32| {
        HexColor::from_srgb(recipe.gradient().unwrap().sample(u, 0.0).map(srgb_from_linear)).0[0]
    };
    let mixed = recipe(&[(1.0, "#ffffff"), (0.5, "#404040"), (0.0, "#000000"), (0.5, "#555555"), (0.5, "#808080")]);
    let sorted = recipe(&[(0.0, "#000000"), (0.5, "#404040"), (0.5, "#555555"), (0.5, "#808080"), (1.0, "#ffffff")]);
    assert_eq!(mixed.bake().unwrap(), sorted.bake().unwrap());
    // Of several stops at one position, the first ends the gradient below and the last begins the gradient above.
    assert_eq!((color(&mixed, 0.499_999), color(&mixed, 0.5)), (0x40, 0x80));
    assert_eq!(color(&recipe(&[(0.3, "#123456")]), 0.9), 0x12);

    let refused = |at: f32| recipe(&[(0.5, "#000000"), (at, "#ffffff")]).validate().unwrap_err().to_string();
    for (at, text) in [(f32::NAN, "NaN"), (-0.1, "-0.1"), (1.1, "1.1"), (f32::INFINITY, "inf")] {
        assert_eq!(refused(at), format!("rows[0].stops[1].at: {text} is not valid; expected 0 to 1"));
    }
    assert_eq!(recipe(&[]).validate().unwrap_err().field, "rows[0].stops");
    assert_eq!(RampRecipe { rows: Vec::new(), ..recipe(&[]) }.bake().unwrap_err().field, "rows");
    assert!(HexColor::try_from("red".to_owned()).unwrap_err().contains("#rrggbb"));
    for bad in ["#12é45", "#+1+2+3", "#12345", "#1234567", "123456", "#12 456"] {
        assert!(HexColor::try_from(bad.to_owned()).is_err(), "{bad}");
    }
    assert_eq!(HexColor::try_from("#0aFf80".to_owned()), Ok(HexColor([0x0a, 0xff, 0x80])));
}

#[test]
fn rows_are_sorted_stably() {
    let row = |at: f32, color: [u8; 3]| RampRow {
        at,
        stops: vec![RampStop::new(0.0, HexColor(color))],
        ..RampRow::default()
    };
    let rows = vec![row(1.0, [9; 3]), row(0.5, [5; 3]), row(0.0, [1; 3]), row(0.5, [6; 3])];
    let baked = RampRecipe { width: 2, height: 101, rows, ..RampRecipe::default() }.bake().unwrap().into_rgb8();
    let column: Vec<_> = [100, 51, 50, 0].map(|y| baked.get_pixel(0, y).0[0]).into();
    assert_eq!(column, [1, 5, 6, 9]);
}

#[test]
fn every_curve_has_its_shape() {
    let gray = |curve: Curve, u: f32| {
        let mut recipe = recipe(&[(0.0, "#000000"), (0.5, "#808080"), (1.0, "#ffffff")]);
        recipe.blend = Blend::Srgb;
        recipe.rows[0].stops[0].curve = curve;
        srgb_from_linear(recipe.gradient().unwrap().sample(u, 0.0).x) * 255.0
    };
    for (curve, quarter) in [(Curve::Constant, 0.0), (Curve::Linear, 32.0), (Curve::Ease, 20.0)] {
        assert!((gray(curve, 0.125) - quarter).abs() < 0.01, "{}: {}", curve.name(), gray(curve, 0.125));
        assert!((gray(curve, 0.5) - 128.0).abs() < 0.01);
    }
    // The monotone curve is flat at the end of the ramp and has a continuous slope at a stop.
    assert!(gray(Curve::Monotone, 0.125) < 31.0);
    let slope = |u: f32| (gray(Curve::Monotone, u + 0.001) - gray(Curve::Monotone, u - 0.001)) / 0.002;
    assert!((slope(0.498) - slope(0.502)).abs() < 3.0, "{} {}", slope(0.498), slope(0.502));
    // The curve is flat beside an edge, as at the end of a ramp.
    let mut edge = recipe(&[(0.0, "#000000"), (0.5, "#808080"), (0.5, "#a0a0a0"), (1.0, "#ffffff")]);
    let flat = |recipe: &RampRecipe, u: f32| recipe.gradient().unwrap().sample(u, 0.0).x;
    assert!(flat(&edge, 0.49) > 0.99 * flat(&edge, 0.499_999) && flat(&edge, 0.51) < 1.01 * flat(&edge, 0.5));
    edge.rows[0].stops[1].at = 0.4;
    edge.rows[0].stops[1].curve = Curve::Constant;
    assert!(flat(&edge, 0.39) > 0.99 * flat(&edge, 0.45));
}

#[test]
fn every_blend_space_gives_its_midpoint() {
    let at = |blend: Blend, from: &str, to: &str, u: f32| {
        let mut recipe = RampRecipe { blend, ..recipe(&[(0.0, from), (1.0, to)]) };
        recipe.rows[0].stops[0].curve = Curve::Linear;
        HexColor::from_srgb(recipe.gradient().unwrap().sample(u, 0.0).map(srgb_from_linear)).0
    };
    let middle = |blend, from, to| at(blend, from, to, 0.5);
    assert_eq!(middle(Blend::Srgb, "#ff0000", "#0000ff"), [128, 0, 128]);
    assert_eq!(middle(Blend::Linear, "#ff0000", "#0000ff"), [188, 0, 188]);
    assert_eq!(middle(Blend::Oklab, "#ff0000", "#0000ff"), [140, 83, 162]);
    assert_eq!(middle(Blend::HsvNear, "#ff0000", "#0000ff"), [255, 0, 255]);
    assert_eq!(middle(Blend::HsvFar, "#ff0000", "#0000ff"), [0, 255, 0]);
    assert_eq!(at(Blend::HsvNear, "#ff00ff", "#ffff00", 0.5), [255, 0, 0]);
    // Grays and black have no hue.
    assert_eq!(middle(Blend::HsvNear, "#ffffff", "#0000ff"), [128, 128, 255]);
    assert_eq!(middle(Blend::HsvNear, "#0000ff", "#000000"), [0, 0, 128]);
    assert_eq!(middle(Blend::HsvFar, "#ff0000", "#800000"), [192, 0, 0]);
}

#[test]
fn the_place_formula_and_the_times_gradient_vary_along_both_axes() {
    let stop = |at, gray| RampStop { curve: Curve::Linear, ..RampStop::new(at, HexColor([gray; 3])) };
    let rows = vec![RampRow { stops: vec![stop(0.0, 0), stop(1.0, 255)], ..RampRow::default() }];
    let plain = RampRecipe { blend: Blend::Linear, height: 64, rows, ..RampRecipe::default() };
    let times = vec![stop(0.0, 255), stop(1.0, 0)];
    let gradient = RampRecipe { place: "u * u + v".into(), times, ..plain.clone() }.gradient().unwrap();
    for (u, v) in [(0.0_f32, 0.0_f32), (0.5, 0.25), (0.3, 0.9), (0.9, 0.9)] {
        let expected = (u * u + v).min(1.0) * (1.0 - v);
        assert!((gradient.sample(u, v).y - expected).abs() < 1.0e-5, "{u} {v}");
    }
    let error = RampRecipe { place: "u v".into(), ..plain }.bake().unwrap_err();
    assert_eq!(error.field, "place");
}

#[test]
fn eight_bits_are_dithered_and_exact_colors_stay() {
    let slope = RampRecipe { bits: 8, width: 1024, ..recipe(&[(0.0, "#101010"), (1.0, "#141414")]) };
    let fine = RampRecipe { bits: 16, ..slope.clone() }.bake().unwrap();
    let coarse = slope.bake().unwrap();
    assert_eq!((fine.color().bits_per_pixel(), coarse.color().bits_per_pixel()), (48, 24));
    let fine = fine.to_rgb16();
    let coarse = coarse.to_rgb8();
    for start in (0..1024).step_by(32) {
        let mean = |value: &dyn Fn(u32) -> f32| (start..start + 32).map(value).sum::<f32>() / 32.0;
        let exact = mean(&|x| f32::from(fine.get_pixel(x, 0).0[1]) / 257.0);
        let dithered = mean(&|x| f32::from(coarse.get_pixel(x, 0).0[1]));
        assert!((exact - dithered).abs() < 0.1, "{start}: {exact} {dithered}");
    }
    let flat = RampRecipe { bits: 8, height: 64, ..recipe(&[(0.0, "#0aff81")]) }.bake().unwrap().into_rgb8();
    assert!(flat.pixels().all(|pixel| pixel.0 == [0x0a, 0xff, 0x81]));
    assert_eq!(RampRecipe { bits: 12, ..recipe(&[(0.0, "#000000")]) }.validate().unwrap_err().expected, "8 or 16");
}

/// A recipe that uses every field.
fn rich() -> RampRecipe {
    let stops = |colors: [&str; 4]| {
        let at = [0.0, 0.25, 0.25, 0.8];
        let stop = |(color, index): (&str, usize)| RampStop {
            curve: Curve::ALL[index],
            ..RampStop::new(at[index], color.to_owned().try_into().unwrap())
        };
        colors.into_iter().zip(0..).map(stop).collect::<Vec<_>>()
    };
    let row = |(index, blue): (usize, &str)| RampRow {
        at: index as f32 / 3.0,
        curve: Curve::ALL[index],
        stops: stops(["#102030", "#ff8040", blue, "#ffffff"]),
    };
    RampRecipe {
        width: 96,
        height: 33,
        place: "u / (0.3 + v) ^ 1.5".into(),
        times: stops(["#222222", "#8899aa", "#ffeedd", "#334455"]),
        rows: ["#0000ff", "#00ff00", "#123456", "#fedcba"].into_iter().enumerate().map(|(i, c)| row((i, c))).collect(),
        ..RampRecipe::default()
    }
}

#[test]
fn every_machine_bakes_the_same_bytes() {
    let of = |blend, bits| hash(RampRecipe { blend, bits, ..rich() }.bake().unwrap().into_rgb16().into_raw());
    let hashes = Blend::ALL.iter().flat_map(|&blend| [16, 8].map(|bits| of(blend, bits)));
    let all = hashes.fold(0_u64, |all, hash| all.rotate_left(7) ^ hash);
    assert_eq!(all, 0x5a51_82ea_18d9_b975, "{all:#x}");
}

#[test]
fn a_written_recipe_is_read_back_equal() {
    let recipe = RampRecipe { bits: 8, blend: Blend::HsvFar, ..rich() };
    let text = recipe.to_json();
    assert_eq!(RampRecipe::parse(Path::new("a.ramp.json"), &text).unwrap(), recipe);
    assert!(text.contains("\n        { \"at\": 0.25, \"color\": \"#ff8040\", \"curve\": \"linear\" },\n"), "{text}");
    let plain = RampRecipe::default().to_json();
    let expected = r##"{
  "version": 1,
  "width": 256,
  "height": 1,
  "rows": [
    {
      "at": 0.0,
      "stops": [
        { "at": 0.0, "color": "#000000" }
      ]
    }
  ]
}
"##;
    assert_eq!(plain, expected);
}

#[test]
fn other_versions_are_refused() {
    let row = r##""rows": [{"stops": [{"at": 0, "color": "#000000"}]}]"##;
    let parse = |version: u32| {
        let text = format!(r#"{{"version": {version}, "width": 8, "height": 1, {row}}}"#);
        RampRecipe::parse(Path::new("a.ramp.json"), &text).map_err(|error| error.to_string())
    };
    assert_eq!(parse(1).unwrap().version, 1);
    assert!(parse(0).unwrap_err().contains("version 0 does not exist"));
    assert!(parse(2).unwrap_err().contains("version 2 is newer than this program, which reads up to 1"));
}

#[test]
fn the_ramps_document_lists_every_name_and_its_example_parses() {
    let document = include_str!("../../../../../docs/ramps.md");
    let recipe = document.split("```json").nth(1).unwrap().split("```").next().unwrap();
    let recipe = RampRecipe::parse(Path::new("ramps.md"), recipe).unwrap();
    assert_eq!((recipe.height, recipe.times.len(), recipe.rows[0].stops[0].curve), (64, 2, Curve::Ease));
    let names = Blend::NAMES.iter().chain(Curve::NAMES).chain(["bits", "place", "times"].iter());
    for name in names {
        assert!(document.contains(&format!("`{name}`")), "{name}");
    }
}
