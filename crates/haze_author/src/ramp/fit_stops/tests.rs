use super::*;
use haze_core::assets::image::decode_png;
use haze_preset::builtin;
use image::{ImageBuffer, Rgb};
use std::path::Path;

/// Fits an image and bakes the result; returns the fit and its largest error.
fn fit_and_bake(name: &str, image: &DynamicImage) -> (RampFit, f32) {
    let fitted = fit_image(image, None).unwrap();
    let baked = fitted.recipe.bake().unwrap().into_rgb16();
    let image = image.to_rgb16();
    let off = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y))).map(|(x, y)| {
        let a = image.get_pixel(x, y).0;
        let b = baked.get_pixel(x, y * baked.height() / image.height()).0;
        a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap()
    });
    let off = f32::from(off.max().unwrap()) / 257.0;
    let stops: usize = fitted.recipe.rows.iter().map(|row| row.stops.len()).sum();
    println!("{name}: {} rows, {stops} stops, {} off", fitted.recipe.rows.len(), fitted.error);
    assert!((off - fitted.error).abs() < 0.01, "{name}: {off} is not {}", fitted.error);
    (fitted, off)
}

#[test]
fn every_built_in_ramp_is_reproduced_by_its_fit() {
    for ramp in builtin::RAMPS {
        let image = decode_png(Path::new(ramp.name), ramp.bytes).unwrap();
        let (fitted, off) = fit_and_bake(ramp.name, &image);
        assert!(off <= 2.0, "{}: {off}", ramp.name);
        let stops: usize = fitted.recipe.rows.iter().map(|row| row.stops.len()).sum();
        assert!(stops <= if image.height() == 1 { 12 } else { 400 }, "{}: {stops} stops", ramp.name);
    }
}

fn strip(color: impl Fn(u32) -> [u16; 3]) -> DynamicImage {
    DynamicImage::ImageRgb16(ImageBuffer::from_fn(256, 1, |x, _| Rgb(color(x))))
}

#[test]
fn hard_edges_are_preserved() {
    let toon = strip(|x| [[9000, 8000, 12000], [30000, 21000, 22000], [60000, 55000, 50000]][(x / 90) as usize]);
    let (fitted, off) = fit_and_bake("toon", &toon);
    assert!(off <= 0.51, "{off}");
    let stops = &fitted.recipe.rows[0].stops;
    assert_eq!(
        stops.iter().map(|stop| stop.curve).collect::<Vec<_>>(),
        [Curve::Constant, Curve::Constant, Curve::Monotone]
    );
    assert!((stops[1].at - 89.5 / 255.0).abs() < 1.0e-5 && (stops[2].at - 179.5 / 255.0).abs() < 1.0e-5);

    // Slopes on both sides of an edge: two stops at one position.
    let slopes = strip(|x| [(x * 60 + if x < 100 { 0 } else { 30000 }) as u16; 3]);
    let (fitted, off) = fit_and_bake("slopes", &slopes);
    let stops = &fitted.recipe.rows[0].stops;
    assert!(off <= DEFAULT_MAX_ERROR && stops.windows(2).any(|pair| (pair[1].at - pair[0].at).abs() < 1.0e-9));

    // A dark line, alternating texels, noise, a single color.
    let hash = |x: u32| (x.wrapping_mul(2_654_435_761) >> 16) as u16;
    let ink = strip(|x| if x == 77 { [0; 3] } else { [(x * 250) as u16, 30000, 65535] });
    let comb = strip(|x| [if x % 2 == 0 { 65535 } else { 0 }, 0, 0]);
    for (name, image) in [("ink", ink), ("comb", comb), ("noise", strip(|x| [hash(x), hash(x + 999), 0]))] {
        let (_, off) = fit_and_bake(name, &image);
        assert!(off <= 4.0, "{name}: {off}");
    }
    let (flat, _) = fit_and_bake("flat", &strip(|_| [257 * 7; 3]));
    assert_eq!(flat.recipe.rows[0].stops, [RampStop::new(0.0, HexColor([7; 3]))]);
    // Hard edges between rows.
    let steps = DynamicImage::ImageRgb16(ImageBuffer::from_fn(64, 48, |x, y| {
        Rgb([if y < 20 { 60000 } else { 900 * x as u16 }, (x / 20 * 15000) as u16, 0])
    }));
    let (fitted, off) = fit_and_bake("steps", &steps);
    assert!(off <= DEFAULT_MAX_ERROR && fitted.recipe.rows.len() == 2, "{off}");
}

#[test]
fn equal_rows_become_one_and_the_width_is_kept() {
    let slope = |x: u32| Rgb([(x * 3) as u8, 90, 200 - (x * 2) as u8]);
    let strip = |width, height| DynamicImage::ImageRgb8(ImageBuffer::from_fn(width, height, |x, _| slope(x)));
    let size = |image: &DynamicImage| {
        let recipe = fit_image(image, None).unwrap().recipe;
        (recipe.width, recipe.height, recipe.rows.len())
    };
    assert_eq!(size(&strip(64, 16)), (64, 1, 1));
    assert_eq!(size(&strip(1, 1)), (2, 1, 1));
    assert_eq!(size(&strip(3, 1)), (3, 1, 1));
    // Rows that differ only by dithering become one.
    let dithered =
        RampRecipe { bits: 8, height: 8, ..fit_image(&strip(64, 1), Some(1.0)).unwrap().recipe }.bake().unwrap();
    assert_eq!(size(&dithered), (64, 1, 1));
    assert_eq!(fit_image(&strip(64, 1), Some(0.5)).unwrap_err().field, "error");
    assert_eq!(fit_image(&DynamicImage::new_rgb8(0, 0), None).unwrap_err().field, "image");
}

/// Image of 8 bits with noise of up to two steps in every channel, as of a brush.
fn noisy(width: u32, height: u32, color: impl Fn(f32, f32) -> [f32; 3]) -> DynamicImage {
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) % 5
    };
    let fraction = |texel: u32, count: u32| texel as f32 / (count - 1).max(1) as f32;
    DynamicImage::ImageRgb8(ImageBuffer::from_fn(width, height, |x, y| {
        let code = color(fraction(x, width), 1.0 - fraction(y, height));
        Rgb(code.map(|code| (code.round() + noise() as f32 - 2.0) as u8))
    }))
}

#[test]
fn noise_of_paint_adds_no_stops() {
    let slope = |u: f32| [20.0 + 200.0 * u, 30.0 + 150.0 * u * u, 90.0 - 60.0 * u];
    let painted = noisy(256, 32, |u, _| slope(u));
    let (fitted, off) = fit_and_bake("painted", &painted);
    let [row] = &fitted.recipe.rows[..] else { panic!("{} rows", fitted.recipe.rows.len()) };
    assert!(row.stops.len() <= 12 && off <= 6.0, "{} stops, {off} off", row.stops.len());
    // A bound is kept exactly.
    let exact = fit_image(&painted, Some(DEFAULT_MAX_ERROR)).unwrap();
    assert!(exact.recipe.rows.len() > 1 && exact.error <= 2.0, "{}", exact.error);
    // Noise of one row is as large as that of many.
    let (one, _) = fit_and_bake("painted strip", &noisy(256, 1, |u, _| slope(u)));
    assert!(one.recipe.rows[0].stops.len() <= 12, "{}", one.recipe.rows[0].stops.len());
    // Rows that differ by more than noise stay rows.
    let (plane, _) = fit_and_bake("painted plane", &noisy(64, 32, |u, v| [40.0 + 150.0 * u, 30.0 + 60.0 * v, 90.0]));
    let stops: usize = plane.recipe.rows.iter().map(|row| row.stops.len()).sum();
    assert!((2..=6).contains(&plane.recipe.rows.len()) && stops <= 40, "{} rows", plane.recipe.rows.len());
}
