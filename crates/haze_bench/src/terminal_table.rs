//! Prints the report on a terminal.

use haze_core::error::Error;
use haze_export::output::print_line;

use super::recommendation::{AutoCase, BreakEven, auto_cases, break_even, recommendation};
use super::report::{Clock, Report, Row};

pub fn write(report: &Report) -> Result<(), Error> {
    let adapter = &report.adapter;
    let software = if adapter.software { ", software" } else { "" };
    print_line!(
        "{} ({}, {}{software}), wgpu {}, haze {}",
        adapter.name,
        adapter.backend,
        adapter.driver,
        adapter.wgpu,
        adapter.haze
    )?;
    let mut suite = "";
    for row in &report.rows {
        if row.suite != suite {
            suite = &row.suite;
            print_line!("")?;
            print_line!(
                "{:<44} {:>10} {:>7} {:>8} {:>9} {:>7} {:>6} {:>6} {:>6}",
                suite,
                "ms",
                "spread",
                "layers",
                "Gfrag/s",
                "limit",
                "PSNR",
                "edges",
                "FLIP"
            )?;
        }
        print_line!("{}", line(row))?;
    }
    if !report.left_out.is_empty() {
        print_line!("")?;
    }
    for left in &report.left_out {
        print_line!("left out: {}: {}: {}", left.suite, left.case, left.reason)?;
    }
    if report.discarded > 0 {
        print_line!("{} timestamps were reversed or zero and were discarded", report.discarded)?;
    }
    let ways = break_even(report);
    if !ways.is_empty() {
        print_line!("")?;
        let heads = ["fixed ms", "ms/layer", "layers/33 ms"].map(|head| format!("{head:>12}")).join(" ");
        print_line!("{:<30} {heads}   cheaper than forward", "deferred against forward")?;
    }
    for way in ways {
        let fits = way.layers_at_30();
        let BreakEven { path, scale, format, base_ms, layer_ms, from_layers } = way;
        let from = from_layers.map_or("never".into(), |layers| format!("from {layers:.1} layers"));
        let name = format!("{path} 1/{scale} {format}");
        print_line!("{name:<30} {base_ms:>12.3} {layer_ms:>12.4} {fits:>12.0}   {from}")?;
    }
    let cases = auto_cases(report);
    if !cases.is_empty() {
        print_line!("")?;
        print_line!(
            "{:<52} {:>7} {:>9} {:>9} {:>9}   chosen   loss",
            "choices of auto",
            "layers",
            "raster",
            "tiled",
            "auto"
        )?;
    }
    for AutoCase { what, layers, raster_ms, tiled_ms, auto_ms, chosen_path, loss } in cases {
        print_line!(
            "{what:<52} {layers:>7.1} {raster_ms:>9.3} {tiled_ms:>9.3} {auto_ms:>9.3}   {chosen_path:<6} {:>5.1}%",
            100.0 * loss
        )?;
    }
    if let Some(text) = recommendation(report) {
        print_line!("")?;
        print_line!("{text}")?;
    }
    if !report.complete {
        print_line!("partial: the run ended early")?;
    }
    Ok(())
}

fn line(row: &Row) -> String {
    let shown = |value: Option<f64>, digits: usize| value.map_or("-".into(), |value| format!("{value:.digits$}"));
    let clock = if row.clock == Clock::Gpu { "" } else { row.clock.name() };
    format!(
        "{:<44} {:>10.3} {:>6.1}% {:>8} {:>9} {:>7} {:>6} {:>6} {:>6} {clock}",
        row.case,
        row.gpu_ms.median,
        100.0 * row.gpu_ms.spread(),
        shown(row.layers, 1),
        shown(row.gfragments_per_s, 3),
        shown(row.limit_ratio, 2),
        shown(row.psnr_db, 1),
        shown(row.edge_psnr_db, 1),
        shown(row.flip, 3),
    )
}
