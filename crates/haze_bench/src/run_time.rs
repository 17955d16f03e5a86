//! Time of a run: what is left of it, and what its cases need at least.

use std::time::{Duration, Instant};

/// Clock of a run that should take `whole`.
pub struct RunTime {
    whole: Duration,
    started: Instant,
    /// Time that the cases so far needed at least: their preparation, their check, and the fewest rounds.
    least: Duration,
    cases: usize,
    is_told: bool,
}

impl RunTime {
    pub fn start(whole: Duration) -> Self {
        Self { whole, started: Instant::now(), least: Duration::ZERO, cases: 0, is_told: false }
    }

    /// Adds the least time of some cases.
    pub fn add(&mut self, least: Duration, cases: usize) {
        self.least += least;
        self.cases += cases;
    }

    /// Time of the next `cases` of the `left` that are still to be measured. Time that a group does not use goes to the later ones.
    pub fn budget(&self, cases: usize, left: usize) -> Duration {
        self.unused().mul_f64(cases as f64 / left.max(1) as f64)
    }

    /// Time until the end of the run, with `left` cases to be measured.
    pub fn remaining(&self, left: usize) -> Duration {
        self.unused().max(self.needed(left))
    }

    /// Says once that the run takes longer than it should.
    pub fn overrun(&mut self, left: usize) -> Option<String> {
        let needed = self.needed(left);
        if self.is_told || needed <= self.unused() {
            return None;
        }
        self.is_told = true;
        let all = self.started.elapsed() + needed;
        Some(format!(
            "haze: {} s do not suffice to prepare, check and measure the cases: the run will take about {} s",
            self.whole.as_secs(),
            all.as_secs_f64().ceil()
        ))
    }

    fn unused(&self) -> Duration {
        self.whole.saturating_sub(self.started.elapsed())
    }

    fn needed(&self, left: usize) -> Duration {
        self.least.mul_f64(left as f64 / self.cases.max(1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_says_once_that_it_takes_longer_and_how_long() {
        let mut time = RunTime::start(Duration::from_secs(20));
        assert_eq!(time.overrun(11), None, "nothing is known yet");
        assert!(time.remaining(11) <= Duration::from_secs(20));
        time.add(Duration::from_secs(10), 1);
        let text = time.overrun(10).unwrap();
        assert!(text.ends_with("the run will take about 101 s"), "{text}");
        assert_eq!(time.remaining(10), Duration::from_secs(100));
        assert_eq!(time.overrun(9), None, "said already");
    }

    #[test]
    fn cases_share_the_time_that_is_left() {
        let mut time = RunTime::start(Duration::from_secs(100));
        time.add(Duration::from_secs(1), 5);
        let budget = time.budget(5, 20).as_secs_f64();
        assert!((24.0..=25.0).contains(&budget), "{budget}");
        assert_eq!(time.overrun(20), None);
    }
}
