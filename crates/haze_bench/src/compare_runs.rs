//! `haze bench compare`: compares two runs of one machine row by row.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use clap::Args;
use haze_core::error::{AssetError, Error};
use haze_export::output::{Failures, print_error, print_line};

use super::report::{Report, Row};
use super::report_json;

#[derive(Args)]
pub struct Arguments {
    /// JSON report of the first run, as `--json` writes it.
    before: PathBuf,
    /// JSON report of the second run.
    after: PathBuf,
    /// Percent by which a row may be slower, beyond its statistical uncertainty, before the command exits with 1.
    #[arg(long, value_name = "PERCENT", default_value = "10", allow_hyphen_values = true)]
    #[arg(value_parser = parse_percent)]
    slower: f64,
}

fn parse_percent(text: &str) -> Result<f64, String> {
    let percent = text.trim_end_matches('%').parse::<f64>().ok().filter(|percent| (0.0..=1000.0).contains(percent));
    percent.ok_or_else(|| format!("{text:?} is not a percentage; expected 0 to 1000, for example 10"))
}

/// Ratio of the median times of a row, second run to first run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ratio {
    ratio: f64,
    /// Half width of the 95 % confidence interval, as a fraction of the ratio.
    uncertainty: f64,
}

pub fn run(arguments: &Arguments) -> Result<(), Failures> {
    let [before, after] = [read(&arguments.before)?, read(&arguments.after)?];
    for (what, before, after) in [
        ("adapter", &before.adapter.name, &after.adapter.name),
        ("driver", &before.adapter.driver, &after.adapter.driver),
    ] {
        if before != after {
            print_error(format_args!("the runs differ in their {what}: {before:?} and {after:?}"));
        }
    }
    let known: HashMap<_, _> = before.rows.iter().map(|row| ((&row.suite, &row.case), row)).collect();
    let both: Vec<_> =
        after.rows.iter().filter_map(|row| Some((row, ratio(known.get(&(&row.suite, &row.case))?, row)))).collect();
    if both.is_empty() {
        let what = format!(
            "no case of this run is also in {}: one measures {}, the other {}; expected runs with a suite in common",
            arguments.before.display(),
            distinct(&after.rows, |row| &row.suite),
            distinct(&before.rows, |row| &row.suite)
        );
        let error = std::io::Error::new(std::io::ErrorKind::InvalidData, what);
        return Err(Error::from(AssetError::Io { path: arguments.after.clone(), error }).into());
    }
    let [first, second] = [&before, &after].map(|report| distinct(&report.rows, |row| &row.size));
    if first != second {
        print_error(format_args!(
            "the runs differ in their size: {first} and {second}; ratios compare a case of one size with the same case of the other"
        ));
    }
    print_line!("{:<10} {:<44} {:>10} {:>10} {:>8} {:>8}", "suite", "case", "before ms", "after ms", "ratio", "±")?;
    let mut slower = 0;
    for (row, Ratio { ratio, uncertainty }) in &both {
        let is_slower = ratio * (1.0 - uncertainty) > 1.0 + arguments.slower / 100.0;
        slower += u32::from(is_slower);
        print_line!(
            "{:<10} {:<44} {:>10.3} {:>10.3} {ratio:>8.3} {:>7.1}%{}",
            row.suite,
            row.case,
            row.gpu_ms.median / ratio,
            row.gpu_ms.median,
            100.0 * uncertainty,
            if is_slower { "  slower" } else { "" }
        )?;
    }
    let mean = (both.iter().map(|(_, ratio)| ratio.ratio.ln()).sum::<f64>() / both.len() as f64).exp();
    let alone = before.rows.len() + after.rows.len() - 2 * both.len();
    print_line!(
        "{} rows compared, geometric mean of the ratios {mean:.3}; {alone} rows are in one run only",
        both.len()
    )?;
    if slower == 0 {
        return Ok(());
    }
    let path = arguments.after.clone();
    let what = format!("{slower} of {} rows are more than {} % slower", both.len(), arguments.slower);
    Err(Error::from(AssetError::Io { path, error: std::io::Error::other(what) }).into())
}

/// Different texts of a field of some rows.
fn distinct(rows: &[Row], field: impl Fn(&Row) -> &String) -> String {
    let texts: BTreeSet<&str> = rows.iter().map(|row| field(row).as_str()).collect();
    if texts.is_empty() { "nothing".into() } else { texts.into_iter().collect::<Vec<_>>().join(", ") }
}

/// Reads a report whose times can be compared. An incomplete one is reported.
fn read(path: &Path) -> Result<Report, Error> {
    let report = report_json::read(path)?;
    for (index, row) in report.rows.iter().enumerate() {
        let name = format!("rows[{index}] ({} {})", row.suite, row.case);
        row.gpu_ms.validate(&name).map_err(|error| Error::from(AssetError::JsonField { path: path.into(), error }))?;
    }
    if !report.complete {
        let path = path.display();
        print_error(format_args!("{path}: an incomplete run; only its {} rows are compared", report.rows.len()));
    }
    Ok(report)
}

fn ratio(before: &Row, after: &Row) -> Ratio {
    // Standard error of a median of normally distributed times: sqrt(π/2) · σ / √n, with σ = half the interquartile
    // range / 0.6745; the constants give 1.858.
    let off = |row: &Row| 1.858 * row.gpu_ms.spread() / f64::from(row.samples.max(1)).sqrt();
    let uncertainty = 1.96 * off(before).hypot(off(after));
    Ratio { ratio: after.gpu_ms.median / before.gpu_ms.median, uncertainty }
}
