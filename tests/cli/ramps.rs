//! `haze ramp`: the authoring loop.

use std::fmt::Write as _;
use std::fs;
use std::time::{Duration, Instant};

use super::{folder, haze, stderr};

#[test]
fn a_ramp_of_very_many_stops_is_soon_baked() {
    let folder = folder();
    let recipe = |rows: u32, stops: u32, height: u32| {
        let mut text = format!(r#"{{"version": 2, "width": 256, "height": {height}, "rows": ["#);
        for row in 0..rows {
            let _ =
                write!(text, r#"{}{{"at": {}, "stops": ["#, if row > 0 { "," } else { "" }, row as f32 / rows as f32);
            for stop in 0..stops {
                let (at, colour) = (stop as f32 / stops as f32, (row * 7919 + stop * 104_729) % 0x100_0000);
                let _ =
                    write!(text, r##"{}{{"at": {at}, "colour": "#{colour:06x}"}}"##, if stop > 0 { "," } else { "" });
            }
            text += "]}";
        }
        text + "]}"
    };
    fs::write(folder.path().join("wide.ramp.json"), recipe(100, 1000, 256)).unwrap();
    fs::write(folder.path().join("long.ramp.json"), recipe(1, 10_000, 1)).unwrap();
    let started = Instant::now();
    let output = haze(folder.path(), &["ramp", "bake", "wide.ramp.json", "long.ramp.json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    // 0.3 s for a release build on two cores; here other tests run at the same time, and serde_json is not optimised.
    assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());
}
