//! Draws charts as self-contained SVG: a line or dots for each series, on linear or logarithmic axes.

use std::fmt::Write as _;

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Linear; it includes 0.
    Linear,
    /// Logarithmic; values up to 0 are left out.
    Logarithmic,
}

/// Points of one color, with or without a line.
pub struct Series {
    pub name: String,
    /// x, y and tooltip of each point.
    pub points: Vec<(f64, f64, String)>,
    pub has_line: bool,
}

pub struct Chart<'a> {
    pub title: &'a str,
    pub x: (&'a str, Axis),
    pub y: (&'a str, Axis),
    pub series: Vec<Series>,
}

const SIZE: (f64, f64) = (640.0, 400.0);
const LEFT: f64 = 64.0;
const BOTTOM: f64 = 52.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
/// Number of series colors in page.css.
pub const COLORS: usize = 8;

/// Maps the values of an axis to SVG coordinates.
struct Scale {
    axis: Axis,
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    fn new(axis: Axis, values: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let usable = values.filter(|&value| value.is_finite() && (axis == Axis::Linear || value > 0.0));
        let (low, high): (f64, f64) =
            usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return None;
        }
        let (low, high) = match axis {
            Axis::Linear => (low.min(0.0), if high > 0.0 { high * 1.05 } else { 1.0 }),
            Axis::Logarithmic => (low / 1.2, high * 1.2),
        };
        Some(Self { axis, low, high, from, to })
    }

    fn place(&self, value: f64) -> f64 {
        let fraction = match self.axis {
            Axis::Linear => (value - self.low) / (self.high - self.low),
            Axis::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
        };
        self.from + (self.to - self.from) * fraction
    }

    /// Returns about five round values.
    fn ticks(&self) -> Vec<f64> {
        match self.axis {
            Axis::Linear => {
                let rough = (self.high - self.low) / 5.0;
                let power = 10.0_f64.powf(rough.log10().floor());
                let step = [1.0, 2.0, 5.0, 10.0].map(|step| step * power).into_iter().find(|&step| step >= rough);
                let step = step.unwrap_or(rough);
                let first = (self.low / step).ceil() as i64;
                (first..).map(|index| index as f64 * step).take_while(|&tick| tick <= self.high).collect()
            }
            Axis::Logarithmic => {
                let powers = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
                let is_wide = self.high / self.low > 300.0;
                let steps: &[f64] = if is_wide { &[1.0] } else { &[1.0, 2.0, 5.0] };
                let ticks = powers.flat_map(|power| steps.iter().map(move |step| step * 10.0_f64.powi(power)));
                ticks.filter(|tick| (self.low..=self.high).contains(tick)).collect()
            }
        }
    }
}

impl Chart<'_> {
    /// Returns the chart with its legend as HTML; an empty string if no point can be shown.
    pub fn figure(&self) -> String {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let x = Scale::new(self.x.1, points().map(|point| point.0), LEFT, SIZE.0 - RIGHT);
        let y = Scale::new(self.y.1, points().map(|point| point.1), SIZE.1 - BOTTOM, TOP);
        let (Some(x), Some(y)) = (x, y) else { return String::new() };
        let mut svg = String::new();
        self.axes(&mut svg, &x, &y);
        for (index, series) in self.series.iter().enumerate() {
            series.draw(&mut svg, index % COLORS, &x, &y);
        }
        let legend: String = self
            .series
            .iter()
            .enumerate()
            .map(|(index, series)| format!("<span class=\"c{}\">{}</span>", index % COLORS, escaped(&series.name)))
            .collect();
        format!(
            "<figure><figcaption>{title}</figcaption><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{title}\">{svg}</svg>\
             <p class=\"legend\">{legend}</p></figure>\n",
            SIZE.0,
            SIZE.1,
            title = escaped(self.title),
        )
    }

    fn axes(&self, svg: &mut String, x: &Scale, y: &Scale) {
        let right = SIZE.0 - RIGHT;
        let bottom = SIZE.1 - BOTTOM;
        // Writing to a string cannot fail.
        for tick in y.ticks() {
            let at = y.place(tick);
            let _ = write!(svg, "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{right}\"/>");
            let _ =
                write!(svg, "<text x=\"{}\" y=\"{:.1}\" class=\"end\">{}</text>", LEFT - 6.0, at + 4.0, number(tick));
        }
        for tick in x.ticks() {
            let at = x.place(tick);
            let _ = write!(svg, "<path class=\"grid\" d=\"M{at:.1} {TOP}V{bottom}\"/>");
            let _ = write!(svg, "<text x=\"{at:.1}\" y=\"{}\" class=\"middle\">{}</text>", bottom + 18.0, number(tick));
        }
        let middle = (LEFT + right) * 0.5;
        let _ =
            write!(svg, "<text x=\"{middle}\" y=\"{}\" class=\"middle\">{}</text>", SIZE.1 - 10.0, escaped(self.x.0));
        let middle = (TOP + bottom) * 0.5;
        let turned = format!("transform=\"translate(14 {middle}) rotate(-90)\"");
        let _ = write!(svg, "<text {turned} class=\"middle\">{}</text>", escaped(self.y.0));
    }
}

impl Series {
    fn draw(&self, svg: &mut String, color: usize, x: &Scale, y: &Scale) {
        let positions: Vec<(f64, f64, &str)> =
            self.points.iter().map(|(at, value, note)| (x.place(*at), y.place(*value), note.as_str())).collect();
        if self.has_line {
            let line: Vec<String> = positions.iter().map(|(x, y, _)| format!("{x:.1} {y:.1}")).collect();
            let _ = write!(svg, "<path class=\"line c{color}\" d=\"M{}\"/>", line.join("L"));
        }
        for (x, y, note) in positions {
            let _ = write!(
                svg,
                "<circle class=\"dot c{color}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"><title>{}</title></circle>",
                escaped(note)
            );
        }
    }
}

/// Formats a number without insignificant digits.
pub fn number(value: f64) -> String {
    let digits = match value.abs() {
        0.0 => 0,
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 0.1 => 2,
        size if size >= 0.01 => 3,
        _ => 4,
    };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// Escapes text for HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_ticks_are_round_and_within_the_axis() {
        let scale = |axis, low: f64, high: f64| Scale::new(axis, [low, high].into_iter(), 0.0, 100.0).unwrap();
        assert_eq!(scale(Axis::Linear, 3.0, 10.0).ticks(), [0.0, 5.0, 10.0]);
        assert_eq!(scale(Axis::Logarithmic, 1.0, 9.0).ticks(), [1.0, 2.0, 5.0, 10.0]);
        let log = scale(Axis::Logarithmic, 4.0, 1024.0);
        assert!(log.place(4.0) > 0.0 && log.place(64.0) > 40.0 && log.place(1024.0) < 100.0);
        // No scale without a value that the axis can show.
        assert!(Scale::new(Axis::Logarithmic, [0.0, -1.0].into_iter(), 0.0, 1.0).is_none());
        assert!(Scale::new(Axis::Linear, [f64::NAN].into_iter(), 0.0, 1.0).is_none());
    }

    #[test]
    fn text_is_escaped_and_numbers_are_short() {
        assert_eq!(escaped("a<b & \"c\""), "a&lt;b &amp; &quot;c&quot;");
        assert_eq!([0.0, 0.0125, 0.5, 2.0, 12.34, 640.0].map(number), ["0", "0.013", "0.5", "2", "12.3", "640"]);
    }
}
