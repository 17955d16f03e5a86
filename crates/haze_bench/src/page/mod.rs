//! Renders the report as one self-contained HTML page: verdict, charts and tables, for light and dark color schemes
//! and any width.

mod chart;

use std::collections::{BTreeMap, BTreeSet};

use haze_core::settings::{RenderPath, Traversal};

use self::chart::{Axis, COLORS, Chart, Series, escaped, number};
use super::recommendation::{break_even, recommendation};
use super::report::{Report, Row};
use super::suites::Suite;

const STYLE: &str = include_str!("page.css");

/// Renders the whole page.
pub fn page(report: &Report) -> String {
    let adapter = &report.adapter;
    let software = if adapter.software { " <b>software</b>" } else { "" };
    let partial = if report.complete { "" } else { "<p class=\"partial\">Partial: the run ended early.</p>" };
    let recommendation =
        recommendation(report).map(|text| format!("<p class=\"verdict\">{}</p>", escaped(&text))).unwrap_or_default();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>haze bench: {name}</title><style>{STYLE}</style></head><body><main>\n\
         <h1>Cost of smoke</h1><p>{name}{software} · {}, {} · wgpu {} · haze {}</p>{partial}{recommendation}\n\
         {}<div class=\"charts\">{}{}{}{}</div>\n{}{}{}</main></body></html>\n",
        adapter.backend,
        escaped(&adapter.driver),
        adapter.wgpu,
        escaped(&adapter.haze),
        frames_by_pass(report),
        cost_by_scale(report),
        cost_by_overdraw(report),
        cost_by_error(report),
        layers_by_pass(report),
        break_even_table(report),
        rows_table(report),
        skipped_list(report),
        name = escaped(&adapter.name),
    )
}

/// Groups the rows of a suite into lines of a chart. `name` returns the name of a row's line, or `None` to leave the
/// row out.
fn lines(report: &Report, suite: Suite, name: impl Fn(&Row) -> Option<String>) -> BTreeMap<String, Vec<&Row>> {
    let mut lines = BTreeMap::<_, Vec<_>>::new();
    for row in report.rows.iter().filter(|row| row.is_of(suite)) {
        if let Some(name) = name(row) {
            lines.entry(name).or_default().push(row);
        }
    }
    lines
}

fn note(row: &Row) -> String {
    format!("{}: {} ms", row.case, number(row.gpu_ms.median))
}

fn cost_by_scale(report: &Report) -> String {
    let name = |row: &Row| Some(format!("{} {}, {} sprites", row.path.as_ref()?, row.format.as_ref()?, row.particles?));
    let series = lines(report, Suite::Scale, name).into_iter().map(|(name, rows)| {
        // Forward has no scale: it renders at full resolution.
        let point = |row: &&Row| (f64::from(row.scale.unwrap_or(1)), row.gpu_ms.median, note(row));
        let points: Vec<_> = rows.iter().map(point).collect();
        Series { name, has_line: points.len() > 1, points }
    });
    Chart {
        title: "Cost against buffer scale",
        x: ("pixels per texel", Axis::Logarithmic),
        y: ("ms", Axis::Logarithmic),
        series: series.collect(),
    }
    .figure()
}

fn cost_by_overdraw(report: &Report) -> String {
    // Only sprites as large as the image. Where alpha does not change the cost, only the alpha nearest to 0.1.
    let is_large = |row: &Row| row.layers.zip(row.particles).is_some_and(|(deep, all)| deep > 0.25 * f64::from(all));
    let alphas = report.rows.iter().filter(|row| row.is_of(Suite::Overdraw)).filter_map(|row| row.alpha);
    let usual = alphas.min_by(|a, b| (a - 0.1).abs().total_cmp(&(b - 0.1).abs()));
    let name = |row: &Row| {
        let path = row.path.as_ref()?;
        let alpha = row.alpha.filter(|_| is_large(row))?;
        match row.mode.as_deref().filter(|_| path == RenderPath::Tiled.name()) {
            Some(mode) if mode == Traversal::UntilOpaque.name() => {
                Some(format!("{path}, {mode} layers, alpha {alpha}"))
            }
            mode => (row.alpha == usual).then(|| mode.map_or(path.clone(), |mode| format!("{path}, {mode} layers"))),
        }
    };
    let series = lines(report, Suite::Overdraw, name).into_iter().map(|(name, rows)| {
        let points = rows.iter().filter_map(|row| Some((row.layers?, row.gpu_ms.median, note(row)))).collect();
        Series { name, points, has_line: true }
    });
    Chart {
        title: "Cost against overdraw",
        x: ("layers", Axis::Logarithmic),
        y: ("ms", Axis::Logarithmic),
        series: series.collect(),
    }
    .figure()
}

fn cost_by_error(report: &Report) -> String {
    let with_error = |row: &&Row| {
        [Suite::Scale, Suite::Upsample, Suite::Presets].iter().any(|suite| row.is_of(*suite)) && row.flip.is_some()
    };
    // Only deferred rows: forward smoke is lit differently, which is no error.
    let rows: Vec<&Row> = report.rows.iter().filter(with_error).filter(|row| row.scale.is_some()).collect();
    let suites: BTreeSet<&str> = rows.iter().map(|row| row.suite.as_str()).collect();
    let point = |row: &Row| (row.gpu_ms.median, row.flip.unwrap_or(0.0), note(row));
    let mut series: Vec<_> = suites
        .iter()
        .map(|suite| Series {
            name: (*suite).into(),
            points: rows.iter().filter(|row| row.suite == *suite).map(|row| point(row)).collect(),
            has_line: false,
        })
        .collect();
    // Pareto front of the rows that show the same smoke.
    let deepest = rows.iter().filter(|row| row.is_of(Suite::Scale)).filter_map(|row| row.particles).max();
    let same = rows.iter().filter(|row| row.is_of(Suite::Scale) && row.particles == deepest);
    let mut same: Vec<_> = same.map(|row| point(row)).collect();
    same.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut least = f64::INFINITY;
    same.retain(|point| {
        point.1 < least && {
            least = point.1;
            true
        }
    });
    series.push(Series { name: "Pareto front of scale".into(), points: same, has_line: true });
    Chart {
        title: "Cost against error",
        x: ("ms", Axis::Logarithmic),
        y: ("FLIP against full resolution", Axis::Linear),
        series,
    }
    .figure()
}

/// Draws the passes of every preset's frame at every scale.
fn frames_by_pass(report: &Report) -> String {
    let rows: Vec<&Row> = report.rows.iter().filter(|row| row.is_of(Suite::Frame)).collect();
    bars_by_pass("Milliseconds of a frame by preset and scale, by pass", &rows)
}

/// Draws the passes of the rows of suite `scale` with the most sprites.
fn layers_by_pass(report: &Report) -> String {
    let deepest = report.rows.iter().filter(|row| row.is_of(Suite::Scale)).filter_map(|row| row.particles).max();
    let is_shown = |row: &&Row| row.is_of(Suite::Scale) && row.particles == deepest;
    bars_by_pass("Milliseconds by pass", &report.rows.iter().filter(is_shown).collect::<Vec<_>>())
}

/// Draws a bar for each row, in parts by pass. Those that take least share the last color.
fn bars_by_pass(title: &str, rows: &[&Row]) -> String {
    let mut totals = BTreeMap::<&str, f64>::new();
    for (name, ms) in rows.iter().flat_map(|row| &row.passes) {
        *totals.entry(name).or_default() += ms;
    }
    let most = rows.iter().map(|row| row.passes.values().sum::<f64>()).fold(0.0, f64::max);
    if most <= 0.0 {
        return String::new();
    }
    let mut names: Vec<&str> = totals.keys().copied().collect();
    names.sort_by(|a, b| totals[b].total_cmp(&totals[a]));
    let others = names.split_off(names.len().min(COLORS - 1));
    let bar = |row: &&Row| {
        let sum = |names: &[&str]| names.iter().filter_map(|name| row.passes.get(*name)).sum::<f64>();
        let parts = names.iter().map(|name| (*name, sum(&[name]))).chain([("others", sum(&others))]);
        let part = |(index, (name, ms)): (usize, (&str, f64))| {
            let width = 100.0 * ms / most;
            let title = format!("{name}: {} ms", number(ms));
            format!("<i class=\"c{index}\" style=\"width:{width:.2}%\" title=\"{title}\"></i>")
        };
        let parts: String = parts.enumerate().filter(|(_, (_, ms))| *ms > 0.0).map(part).collect();
        format!(
            "<tr><th>{}</th><td class=\"bar\">{parts}</td><td>{}</td></tr>",
            escaped(&row.case),
            number(row.gpu_ms.median)
        )
    };
    let all = others.join(", ");
    let legend = names.iter().copied().chain((!others.is_empty()).then_some(all.as_str())).enumerate();
    format!(
        "<figure><figcaption>{title}</figcaption><div class=\"wide\"><table class=\"bars\">{}</table></div>\
         <p class=\"legend\">{}</p></figure>\n",
        rows.iter().map(bar).collect::<String>(),
        legend.map(|(index, name)| format!("<span class=\"c{index}\">{name}</span>")).collect::<String>()
    )
}

fn break_even_table(report: &Report) -> String {
    let ways = break_even(report);
    if ways.is_empty() {
        return String::new();
    }
    let row = |way: &super::recommendation::BreakEven| {
        let from = way.from_layers.map_or("never".into(), |layers| format!("from {} layers", number(layers)));
        let cells = [
            way.path.clone(),
            format!("1/{}", way.scale),
            way.format.clone(),
            number(way.base_ms),
            number(way.layer_ms),
            number(way.layers_at_30().round()),
            from,
        ];
        format!("<tr>{}</tr>", cells.map(|cell| format!("<td>{}</td>", escaped(&cell))).concat())
    };
    format!(
        "<h2>Overdraw from which deferred is cheaper</h2><div class=\"wide\"><table><tr><th>path</th><th>scale</th><th>format</th>\
         <th>ms at 0 layers</th><th>ms per layer</th><th>layers in 33 ms</th><th>cheaper than forward</th></tr>{}</table></div>\n",
        ways.iter().map(row).collect::<String>()
    )
}

fn rows_table(report: &Report) -> String {
    let shown = |value: Option<f64>| value.map_or("–".into(), number);
    let row = |row: &Row| {
        let spread = format!("{:.1}", 100.0 * row.gpu_ms.spread());
        let cells = [
            row.suite.clone(),
            row.case.clone(),
            number(row.gpu_ms.median),
            spread,
            row.clock.name().into(),
            shown(row.layers),
            shown(row.gfragments_per_s),
            shown(row.bytes.map(|bytes| bytes as f64 / row.gpu_ms.median / 1.0e6)),
            shown(row.limit_ratio),
            shown(row.psnr_db),
            shown(row.edge_psnr_db),
            shown(row.flip),
        ];
        format!("<tr>{}</tr>", cells.map(|cell| format!("<td>{}</td>", escaped(&cell))).concat())
    };
    let heads = [
        "suite",
        "case",
        "ms",
        "± %",
        "clock",
        "layers",
        "Gfrag/s",
        "GB/s",
        "× limit",
        "PSNR dB",
        "edge PSNR dB",
        "FLIP",
    ];
    format!(
        "<h2>All figures</h2><div class=\"wide\"><table><tr>{}</tr>{}</table></div>\n",
        heads.map(|head| format!("<th>{head}</th>")).concat(),
        report.rows.iter().map(row).collect::<String>()
    )
}

fn skipped_list(report: &Report) -> String {
    let line = |left: &super::report::LeftOut| {
        format!("<li>{}: {}: {}</li>", escaped(&left.suite), escaped(&left.case), escaped(&left.reason))
    };
    let lines: String = report.left_out.iter().map(line).collect();
    let discarded = match report.discarded {
        0 => String::new(),
        count => format!("<p>{count} timestamps were reversed or zero and were discarded.</p>"),
    };
    if lines.is_empty() { discarded } else { format!("<h2>Left out</h2><ul>{lines}</ul>{discarded}") }
}
