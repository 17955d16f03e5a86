//! Conversion of a frame's timestamps to milliseconds.

use crate::renderer::auto::PathChoice;

/// GPU time of one frame, by pass. See [`Timing`](crate::Timing).
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FrameTimes {
    /// Frame number, which increases. A host compares it to detect a new result.
    pub frame: u64,
    /// Passes, in the order in which the frame first recorded them.
    pub passes: Vec<PassTime>,
    /// Time from the first begin to the last end, milliseconds, including other GPU work in between.
    pub whole_ms: f32,
    /// Choices of the path `auto` in that frame, by system key.
    pub choices: Vec<(u64, PathChoice)>,
    /// Intervals that are excluded from all sums: the GPU wrote no timestamp, the end precedes the begin, or there were
    /// more intervals than can be measured.
    pub discarded: u32,
}

/// GPU time of all passes of one name.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PassTime {
    /// Name of the pass (`"accumulate"`), or the host's label.
    pub name: &'static str,
    /// Milliseconds.
    pub ms: f32,
    /// True for a pass of the host. Its time includes what haze draws in it.
    pub is_host: bool,
}

impl FrameTimes {
    /// Returns the GPU time of the smoke, milliseconds: the sum of all measured passes except the host's.
    pub fn smoke_ms(&self) -> f32 {
        self.passes.iter().filter(|pass| !pass.is_host).map(|pass| pass.ms).sum()
    }
}

/// A measured interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub name: &'static str,
    pub is_host: bool,
    /// Index of the query for its begin. The query for its end is the next one.
    pub query: u32,
}

/// Latest result, and the timestamps that it was read from.
#[derive(Debug, Default)]
pub(crate) struct Results {
    pub latest: Option<FrameTimes>,
    /// Last timestamp by query. A query that a frame does not write keeps its old value.
    last_ticks: Vec<u64>,
}

impl Results {
    /// Converts the timestamps of a frame. `tick` returns the timestamp of a query; `missed`: number of intervals that
    /// were not measured.
    pub fn read(
        &mut self,
        frame: u64,
        spans: &[Span],
        choices: &[(u64, PathChoice)],
        missed: u32,
        ms_per_tick: f64,
        tick: impl Fn(u32) -> u64,
    ) {
        let times = self.latest.get_or_insert_default();
        times.frame = frame;
        times.discarded = missed;
        times.passes.clear();
        choices.clone_into(&mut times.choices);
        let mut first = u64::MAX;
        let mut last = 0;
        for span in spans {
            let ticks = [tick(span.query), tick(span.query + 1)];
            let at = span.query as usize;
            self.last_ticks.resize(self.last_ticks.len().max(at + 2), 0);
            let is_written = ticks.iter().zip(&self.last_ticks[at..]).all(|(tick, last)| *tick != 0 && tick != last);
            self.last_ticks[at..at + 2].copy_from_slice(&ticks);
            let [begin, end] = ticks;
            if !is_written || end < begin {
                times.discarded += 1;
                continue;
            }
            first = first.min(begin);
            last = last.max(end);
            let ms = ((end - begin) as f64 * ms_per_tick) as f32;
            match times.passes.iter_mut().find(|pass| (pass.name, pass.is_host) == (span.name, span.is_host)) {
                Some(pass) => pass.ms += ms,
                None => times.passes.push(PassTime { name: span.name, ms, is_host: span.is_host }),
            }
        }
        times.whole_ms = (last.saturating_sub(first) as f64 * ms_per_tick) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads spans with these timestamps; a span named "host" belongs to the host.
    fn read(results: &mut Results, spans: &[(&'static str, u64, u64)], missed: u32) -> FrameTimes {
        let ticks: Vec<_> = spans.iter().flat_map(|span| [span.1, span.2]).collect();
        let spans: Vec<_> = (0..)
            .zip(spans)
            .map(|(index, &(name, ..))| Span { name, is_host: name == "host", query: 2 * index })
            .collect();
        results.read(7, &spans, &[], missed, 0.5, |query| ticks[query as usize]);
        results.latest.clone().unwrap()
    }

    fn named(times: &FrameTimes) -> Vec<(&str, f32)> {
        times.passes.iter().map(|pass| (pass.name, pass.ms)).collect()
    }

    #[test]
    fn intervals_of_one_name_are_summed_in_recording_order() {
        let spans = [("host", 1, 41), ("b", 10, 14), ("a", 15, 16), ("b", 20, 30)];
        let times = read(&mut Results::default(), &spans, 0);
        assert_eq!(named(&times), [("host", 20.0), ("b", 7.0), ("a", 0.5)]);
        assert_eq!((times.frame, times.discarded, times.whole_ms), (7, 0, 20.0));
        assert!((times.smoke_ms() - 7.5).abs() < f32::EPSILON);
    }

    #[test]
    fn invalid_intervals_are_counted_and_excluded() {
        let mut results = Results::default();
        let times = read(&mut results, &[("reversed", 9, 8), ("unwritten", 0, 0), ("half", 0, 5), ("a", 8, 10)], 3);
        assert_eq!((named(&times), times.discarded, times.whole_ms), (vec![("a", 1.0)], 6, 1.0));
        // Timestamps that an earlier frame left are excluded too. Equal begin and end are valid: a coarse clock may not
        // advance within a pass.
        let times = read(&mut results, &[("a", 20, 20), ("b", 21, 24), ("c", 30, 31), ("stale", 8, 10)], 0);
        assert_eq!((named(&times), times.discarded), (vec![("a", 0.0), ("b", 1.5), ("c", 0.5)], 1));
        // A frame without passes clears the previous result.
        let times = read(&mut results, &[], 0);
        assert_eq!((times.passes.len(), times.whole_ms, times.discarded), (0, 0.0, 0));
    }
}
