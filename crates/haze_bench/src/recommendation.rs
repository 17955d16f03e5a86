//! Conclusions from the figures: the overdraw from which a saving pays off, and what to ship.

use super::report::{Report, Row};
use super::suites::Suite;

/// Linear cost model of one way of drawing: milliseconds of a frame without layers, and of each layer.
#[derive(Clone, Debug, PartialEq)]
pub struct BreakEven {
    pub path: String,
    pub scale: u32,
    pub format: String,
    /// Milliseconds of a frame without a layer.
    pub base_ms: f64,
    /// Milliseconds of each layer.
    pub layer_ms: f64,
    /// Layers from which it is cheaper than forward; `None` if it never is.
    pub from_layers: Option<f64>,
}

impl BreakEven {
    /// Layers over the whole image that fit into a frame of 1/30 second.
    pub fn layers_at_30(&self) -> f64 {
        ((1000.0 / 30.0 - self.base_ms) / self.layer_ms.max(1.0e-9)).max(0.0)
    }
}

/// Least PSNR, dB, and greatest FLIP of an image that is as good as full resolution.
const GOOD_PSNR: f64 = 35.0;
const GOOD_FLIP: f64 = 0.05;

/// Returns the model of every scale, path and format of the suite `scale`, in the order of the rows.
pub fn break_even(report: &Report) -> Vec<BreakEven> {
    let rows: Vec<&Row> = report.rows.iter().filter(|row| row.is_of(Suite::Scale)).collect();
    let line = |matches: &dyn Fn(&Row) -> bool| {
        let points = rows.iter().filter(|row| matches(row));
        fit(&points.filter_map(|row| Some((row.layers?, row.gpu_ms.median))).collect::<Vec<_>>())
    };
    let Some((forward_base, forward_layer)) = line(&|row| row.path.as_deref() == Some("forward")) else {
        return Vec::new();
    };
    let mut found: Vec<BreakEven> = Vec::new();
    for row in &rows {
        let (Some(path), Some(scale), Some(format)) = (&row.path, row.scale, &row.format) else { continue };
        if found.iter().any(|known| (&known.path, known.scale, &known.format) == (path, scale, format)) {
            continue;
        }
        let same = |row: &Row| {
            (&row.path, row.scale, &row.format) == (&Some(path.clone()), Some(scale), &Some(format.clone()))
        };
        if let Some((base_ms, layer_ms)) = line(&same) {
            let from_layers = match (base_ms - forward_base, forward_layer - layer_ms) {
                (more, _) if more <= 0.0 && layer_ms <= forward_layer => Some(0.0),
                (more, saved) if saved > 0.0 => Some(more / saved),
                _ => None,
            };
            found.push(BreakEven { path: path.clone(), scale, format: format.clone(), base_ms, layer_ms, from_layers });
        }
    }
    found
}

/// Choice of the path `auto`, beside the two paths it chooses from. Times are those of the fastest frame, because
/// disturbances only lengthen a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct AutoCase {
    pub what: String,
    pub layers: f64,
    pub raster_ms: f64,
    pub tiled_ms: f64,
    pub auto_ms: f64,
    /// Path that `auto` chose.
    pub chosen_path: String,
    /// Loss of that path, from the better of its two measurements, against the faster path, as a fraction; 0 if it is the
    /// faster one.
    pub loss: f64,
}

/// Returns all cases of the suite `auto` that were measured on both paths.
pub fn auto_cases(report: &Report) -> Vec<AutoCase> {
    let rows = || report.rows.iter().filter(|row| row.is_of(Suite::Auto));
    let of = |path: &str, what: &str| rows().find(|row| row.case == format!("{path} {what}")).map(|row| row.gpu_ms.min);
    let case = |row: &Row| {
        let what = row.case.strip_prefix("auto ")?;
        let raster_ms = of("raster", what)?;
        let tiled_ms = of("tiled", what)?;
        let chosen_path = row.mode.clone()?;
        let layers = row.layers?;
        let auto_ms = row.gpu_ms.min;
        let taken_ms = auto_ms.min(if chosen_path == "tiled" { tiled_ms } else { raster_ms });
        let loss = taken_ms / raster_ms.min(tiled_ms).min(taken_ms) - 1.0;
        Some(AutoCase { what: what.into(), layers, raster_ms, tiled_ms, auto_ms, chosen_path, loss })
    };
    rows().filter_map(case).collect()
}

/// Fits a line by least squares; returns intercept and slope. `None` if the points have fewer than two different x.
fn fit(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
    let width: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let slope = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / width;
    (width > 1e-9).then_some((y - slope * x, slope))
}

/// Returns true if an image is as good as full resolution. Full resolution itself has no figures and is good.
pub fn is_good(row: &Row) -> bool {
    row.psnr_db.is_none_or(|psnr| psnr >= GOOD_PSNR) && row.flip.is_none_or(|flip| flip <= GOOD_FLIP)
}

/// Says in one sentence what to ship on this adapter; `None` without the suite `scale`.
pub fn recommendation(report: &Report) -> Option<String> {
    // Compares at the most layers that forward was measured at.
    let rows = || report.rows.iter().filter(|row| row.is_of(Suite::Scale));
    let forwards = rows().filter(|row| row.path.as_deref() == Some("forward"));
    let forward = forwards.max_by(|a, b| a.layers.unwrap_or(0.0).total_cmp(&b.layers.unwrap_or(0.0)))?;
    let layers = forward.layers?;
    let forward_ms = forward.gpu_ms.median;
    let is_as_deep = |row: &&Row| row.particles == forward.particles && row.scale.is_some() && is_good(row);
    let best = rows().filter(is_as_deep).min_by(|a, b| a.gpu_ms.median.total_cmp(&b.gpu_ms.median))?;
    let path = best.path.as_deref()?;
    let scale = best.scale?;
    let format = best.format.as_deref()?;
    let image = match (best.psnr_db, best.flip) {
        (Some(psnr), Some(flip)) => format!("with {psnr:.0} dB PSNR and FLIP {flip:.3} against full resolution"),
        _ => "with the image of full resolution".into(),
    };
    let times = forward_ms / best.gpu_ms.median;
    if times <= 1.0 {
        return Some(format!(
            "Ship forward: at {layers:.0} layers it takes {forward_ms:.2} ms, less than any deferred image of the same quality."
        ));
    }
    let known = break_even(report);
    let from =
        known.iter().find(|known| (known.path.as_str(), known.scale, known.format.as_str()) == (path, scale, format));
    let below = match from.and_then(|known| known.from_layers) {
        Some(layers) if layers >= 1.0 => format!("; below {layers:.0} layers draw forward"),
        _ => String::new(),
    };
    Some(format!(
        "Ship {path} at 1/{scale} in {format}: at {layers:.0} layers {:.2} ms, {times:.1} times as fast as forward, {image}{below}.",
        best.gpu_ms.median
    ))
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::super::report::{Adapter, Clock, Milliseconds};
    use super::*;

    /// Path, scale, milliseconds without layers, milliseconds per layer, PSNR.
    type Way = (&'static str, Option<u32>, f64, f64, Option<f64>);

    fn report(ways: &[Way]) -> Report {
        let mut rows = Vec::new();
        for &(path, scale, base, layer, psnr_db) in ways {
            for layers in [4.0, 16.0, 64.0] {
                let gpu_ms = Milliseconds::of(&mut [base + layer * layers]).unwrap();
                rows.push(Row {
                    path: Some(path.into()),
                    scale,
                    format: Some("rgba16float".into()),
                    layers: Some(layers),
                    particles: Some(layers as u32),
                    psnr_db,
                    flip: psnr_db.map(|_| 0.01),
                    ..Row::of(
                        Suite::Scale,
                        format!("{path} {scale:?} {layers}"),
                        UVec2::new(64, 36),
                        Clock::Gpu,
                        gpu_ms,
                    )
                });
            }
        }
        let text = String::new;
        let adapter =
            Adapter { name: text(), backend: text(), driver: text(), software: false, wgpu: text(), haze: text() };
        Report { version: 1, adapter, complete: true, discarded: 0, rows, left_out: Vec::new() }
    }

    #[test]
    fn break_even_is_where_the_cost_lines_cross() {
        let report = report(&[
            ("forward", None, 1.0, 0.5, None),
            ("raster", Some(1), 6.0, 0.25, None),
            ("raster", Some(2), 3.0, 0.1, Some(40.0)),
            ("raster", Some(4), 2.0, 0.05, Some(30.0)),
            ("raster", Some(8), 2.0, 0.6, Some(20.0)),
        ]);
        let found = break_even(&report);
        let from: Vec<_> = found.iter().map(|way| way.from_layers.map(f64::round)).collect();
        assert_eq!(from, [Some(20.0), Some(5.0), Some(2.0), None]);
        assert!((found[1].layer_ms - 0.1).abs() < 1e-9 && (found[1].base_ms - 3.0).abs() < 1e-9);
        assert!((found[1].layers_at_30() - 303.33).abs() < 0.01, "{}", found[1].layers_at_30());
        // A quarter of the resolution is cheaper, but its PSNR is too low.
        let sentence = recommendation(&report).unwrap();
        assert!(
            sentence.starts_with("Ship raster at 1/2 in rgba16float: at 64 layers 9.40 ms, 3.5 times"),
            "{sentence}"
        );
        assert!(sentence.ends_with("; below 5 layers draw forward."), "{sentence}");
    }

    #[test]
    fn loss_of_auto_is_the_extra_time_of_the_chosen_path() {
        let mut report = report(&[]);
        let mut add = |path: &str, what: &str, ms: f64, mode: &str| {
            report.rows.push(Row {
                mode: Some(mode.into()),
                layers: Some(3.0),
                ..Row::of(
                    Suite::Auto,
                    format!("{path} {what}"),
                    UVec2::new(64, 36),
                    Clock::Gpu,
                    Milliseconds::of(&mut [ms]).unwrap(),
                )
            });
        };
        for (what, taken) in [("a", "raster"), ("b", "tiled")] {
            add("raster", what, 2.0, "ramp");
            add("tiled", what, 3.0, "visible");
            add("auto", what, 9.0, taken);
        }
        // A case without both paths is left out.
        add("raster", "c", 2.0, "ramp");
        add("auto", "c", 2.0, "raster");
        let found: Vec<_> =
            auto_cases(&report).into_iter().map(|case| (case.what, case.chosen_path, case.loss)).collect();
        assert_eq!(found, [("a".into(), "raster".into(), 0.0), ("b".into(), "tiled".into(), 0.5)]);
    }

    #[test]
    fn recommendation_is_forward_where_it_is_cheapest() {
        let report = report(&[("forward", None, 0.0, 0.1, None), ("raster", Some(2), 3.0, 0.2, Some(40.0))]);
        assert_eq!(break_even(&report)[0].from_layers, None);
        assert!(recommendation(&report).unwrap().starts_with("Ship forward: at 64 layers it takes 6.40 ms"));
    }
}
