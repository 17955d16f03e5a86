//! Time of the plugin on the CPU beside that of haze alone. Run it with `--release`: both are slow without optimization.

use std::time::Duration;

use bevy::diagnostic::{Diagnostic, DiagnosticsStore};

use crate::alone;
use crate::host::host;

const FRAMES: u32 = 200;
const WARM_UP: usize = 20;

#[test]
#[ignore = "a measurement, not a check"]
fn cpu_time_of_a_view() {
    let mut host = host("assets".as_ref());
    host.scene();
    let mut alone: Vec<_> = alone::draw(&host, FRAMES).1.iter().map(Duration::as_secs_f64).collect();
    let mut plugin = Vec::new();
    for _ in 0..FRAMES {
        host.update(1);
        let store = host.app.world().resource::<DiagnosticsStore>();
        let spans = store.iter().filter(|span| span.path().as_str().ends_with("smoke/elapsed_cpu"));
        plugin.extend(spans.filter_map(Diagnostic::value).map(|milliseconds| milliseconds / 1e3));
    }
    for (name, times) in [("haze alone", &mut alone), ("plugin with haze", &mut plugin)] {
        times.drain(..WARM_UP.min(times.len()));
        times.sort_by(f64::total_cmp);
        let at = |fraction: f64| times[(fraction * (times.len() - 1) as f64) as usize] * 1e3;
        println!("{name}: median {:.3} ms, half of the frames {:.3} to {:.3} ms", at(0.5), at(0.25), at(0.75));
    }
}
