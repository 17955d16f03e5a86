//! From the timestamps of a frame to milliseconds.

use crate::renderer::auto::PathChoice;

/// GPU time of one frame, by pass. See [`Timing`](crate::Timing).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameTimes {
    /// A number that grows from frame to frame: by it a host knows a new result from one that it has seen.
    pub frame: u64,
    /// In the order in which the frame first recorded them.
    pub passes: Vec<PassTime>,
    /// From the first beginning to the last end, milliseconds, with all that the GPU did in between.
    pub whole_ms: f32,
    /// What the path `auto` took in that frame, by the keys of the systems.
    pub choices: Vec<(u64, PathChoice)>,
    /// Intervals that are in none of the sums: the GPU gave no time, or an end before its beginning, or there were more than are
    /// measured.
    pub discarded: u32,
}

/// GPU time of all passes of one name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassTime {
    /// A pass's own name (`"accumulate"`), or the host's label.
    pub name: &'static str,
    /// Milliseconds.
    pub ms: f32,
    /// True for a pass of the host. It contains what haze draws in it.
    pub of_host: bool,
}

impl FrameTimes {
    /// What the smoke costs, milliseconds: all passes that the device could measure, but the host's.
    pub fn smoke_ms(&self) -> f32 {
        self.passes.iter().filter(|pass| !pass.of_host).map(|pass| pass.ms).sum()
    }
}

/// An interval that is measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub name: &'static str,
    pub of_host: bool,
    /// Where its beginning is written; its end is written next to it.
    pub query: u32,
}

/// What was read last.
#[derive(Debug, Default)]
pub(crate) struct Results {
    pub latest: Option<FrameTimes>,
    /// By query. What was not written in a frame still holds what it held.
    seen: Vec<u64>,
}

impl Results {
    /// Takes the timestamps of a frame, by query. `missed`: intervals that were not measured.
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
        (times.frame, times.discarded) = (frame, missed);
        times.passes.clear();
        choices.clone_into(&mut times.choices);
        let (mut first, mut last) = (u64::MAX, 0);
        for span in spans {
            let ticks = [tick(span.query), tick(span.query + 1)];
            let at = span.query as usize;
            self.seen.resize(self.seen.len().max(at + 2), 0);
            let is_written = ticks.iter().zip(&self.seen[at..]).all(|(tick, seen)| *tick != 0 && tick != seen);
            self.seen[at..at + 2].copy_from_slice(&ticks);
            let [begin, end] = ticks;
            if !is_written || end < begin {
                times.discarded += 1;
                continue;
            }
            (first, last) = (first.min(begin), last.max(end));
            let ms = ((end - begin) as f64 * ms_per_tick) as f32;
            match times.passes.iter_mut().find(|pass| (pass.name, pass.of_host) == (span.name, span.of_host)) {
                Some(pass) => pass.ms += ms,
                None => times.passes.push(PassTime { name: span.name, ms, of_host: span.of_host }),
            }
        }
        times.whole_ms = (last.saturating_sub(first) as f64 * ms_per_tick) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads spans of haze's own with these timestamps.
    fn read(results: &mut Results, spans: &[(&'static str, u64, u64)], missed: u32) -> FrameTimes {
        let ticks: Vec<_> = spans.iter().flat_map(|span| [span.1, span.2]).collect();
        let spans: Vec<_> = (0..)
            .zip(spans)
            .map(|(index, &(name, ..))| Span { name, of_host: name == "host", query: 2 * index })
            .collect();
        results.read(7, &spans, &[], missed, 0.5, |query| ticks[query as usize]);
        results.latest.clone().unwrap()
    }

    fn named(times: &FrameTimes) -> Vec<(&str, f32)> {
        times.passes.iter().map(|pass| (pass.name, pass.ms)).collect()
    }

    #[test]
    fn intervals_of_one_name_add_up_in_order_of_the_frame() {
        let spans = [("host", 1, 41), ("b", 10, 14), ("a", 15, 16), ("b", 20, 30)];
        let times = read(&mut Results::default(), &spans, 0);
        assert_eq!(named(&times), [("host", 20.0), ("b", 7.0), ("a", 0.5)]);
        assert_eq!((times.frame, times.discarded, times.whole_ms), (7, 0, 20.0));
        assert!((times.smoke_ms() - 7.5).abs() < f32::EPSILON);
    }

    #[test]
    fn what_cannot_be_is_counted_and_not_shown() {
        let mut results = Results::default();
        let times = read(&mut results, &[("reversed", 9, 8), ("unwritten", 0, 0), ("half", 0, 5), ("a", 8, 10)], 3);
        assert_eq!((named(&times), times.discarded, times.whole_ms), (vec![("a", 1.0)], 6, 1.0));
        // Neither is what still holds the times of an earlier frame; a coarse clock may well stand still within a pass.
        let times = read(&mut results, &[("a", 20, 20), ("b", 21, 24), ("c", 30, 31), ("stale", 8, 10)], 0);
        assert_eq!((named(&times), times.discarded), (vec![("a", 0.0), ("b", 1.5), ("c", 0.5)], 1));
        // Nothing is left of a frame without passes.
        let times = read(&mut results, &[], 0);
        assert_eq!((times.passes.len(), times.whole_ms, times.discarded), (0, 0.0, 0));
    }
}
