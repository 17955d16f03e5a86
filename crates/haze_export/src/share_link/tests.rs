//! Tests of links: looks are restored, old links open for ever, hostile ones are refused.

use haze::Light;
use haze_author::ramp::{HexColor, RampRow, RampStop};
use haze_core::settings::set_field;
use haze_preset::{Ease, KeyValue, Keyframe, Track};

use super::*;

fn look(base: &'static str) -> Look {
    Look { base, preset: Preset::load(base).unwrap(), ramps: BTreeMap::new() }
}

/// A look with changes everywhere, another light, and a ramp of its own.
fn changed_look() -> Look {
    let mut look = look("column");
    for (field, value) in [
        ("camera.position", "1.5,2.25,-3.125"),
        ("camera.exposure", "1.35"),
        ("systems[0].settings.accumulate.downscale", "4"),
        ("systems[0].emitter.rate", "17.5"),
        ("systems[0].material.diffuse_ramp", "mine.png"),
    ] {
        set_field(&mut look.preset, field, value).unwrap();
    }
    let key = |time, value| Keyframe { time, value: KeyValue::Number(value), ease: Ease::Linear };
    let keys = vec![key(0.0, 2.0), key(1.5, 9.0)];
    look.preset.animation = vec![Track { setting: "lights[0].intensity".into(), keys, ..Track::default() }];
    look.preset.lights.push(Light { intensity: 33.3, ..Light::default() });
    let stops = (0..8).map(|at| RampStop::new(at as f32 / 7.0, HexColor([30 * at, 100, 255 - 30 * at]))).collect();
    let recipe = RampRecipe { rows: vec![RampRow { stops, ..RampRow::default() }], ..RampRecipe::default() };
    look.ramps.insert("mine.png".into(), recipe);
    look
}

#[test]
fn every_look_is_restored_and_short() {
    for preset in builtin::PRESETS {
        let look = look(preset.name);
        let fragment = look.to_fragment().unwrap();
        assert!(fragment.len() < 30, "{fragment}");
        assert_eq!(Look::from_fragment(&fragment).unwrap(), look);
    }
    let look = changed_look();
    let fragment = look.to_fragment().unwrap();
    assert_eq!(Look::from_fragment(&fragment).unwrap(), look);
    assert!(fragment.len() < 500, "{}", fragment.len());
    assert!(fragment.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte)));
    assert_eq!(super::fragment(&format!("https://example.org/haze/#{fragment}")), Some(&*fragment));
    assert_eq!(super::fragment("presets/mine#.json"), None);
}

/// A preset that has nothing in common with its base fits, too.
#[test]
fn any_built_in_preset_fits_over_any_other() {
    for base in ["column", "oil_fire"] {
        for other in builtin::PRESETS {
            let look = Look { base, ..look(other.name) };
            let fragment = look.to_fragment().unwrap();
            assert_eq!(Look::from_fragment(&fragment).unwrap(), look, "{} over {base}", other.name);
        }
    }
}

#[test]
fn links_of_version_1_open_for_ever() {
    let links = include_str!("links_1.txt").lines().filter(|line| !line.starts_with("//"));
    let mut count = 0;
    for (number, link) in (1..).zip(links) {
        let look = Look::from_fragment(fragment(link).unwrap()).unwrap_or_else(|error| panic!("{number}: {error}"));
        match number {
            1 => assert_eq!(look.base, "oil_fire"),
            2 => {
                let changed = changed_look();
                assert_eq!(
                    (&look.preset.camera, &look.preset.lights),
                    (&changed.preset.camera, &changed.preset.lights)
                );
                assert_eq!(look.preset.systems[0].settings.accumulate.downscale, 4);
                assert_eq!(look.ramps, changed.ramps);
            }
            _ => {}
        }
        count += 1;
    }
    assert!(count >= 2);
}

#[test]
fn links_with_names_of_before_open() {
    let settings = r#"{"density":{"density":6},"sprite":{"debug_loop":3},"accumulate":{"scale":4}}"#;
    let difference = format!(r#"{{"systems":{{"0":{{"cache":{{"up":"z"}},"settings":{settings}}}}}}}"#);
    let text = format!(r#"{{"b":"column","d":{difference}}}"#);
    let look = Look::from_fragment(&format!("1{}", packed_text::pack(&text).unwrap())).unwrap();
    let mut expected = Preset::load("column").unwrap();
    let system = &mut expected.systems[0];
    system.particle_files.up = haze_preset::UpAxis::Z;
    system.settings.exponential.density = 6.0;
    system.settings.debug.draw_count = 3;
    system.settings.accumulate.downscale = 4;
    assert_eq!(look.preset, expected);
}

#[test]
fn a_look_that_is_too_large_is_refused_with_the_reason() {
    let mut look = look("column");
    let mut random = 1_u32;
    look.preset.description = (0..3000)
        .map(|_| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            char::from(b'a' + (random >> 24) as u8 % 26)
        })
        .collect();
    let error = look.to_fragment().unwrap_err().to_string();
    assert!(error.contains("characters; expected at most 1800 characters; save the preset as a file"), "{error}");
}

#[test]
fn hostile_links_are_refused_with_one_line() {
    let pack = |text: &str| format!("1{}", packed_text::pack(text).unwrap());
    let ramp = |name: &str, size: u32| {
        let recipe = format!(
            r##"{{"version":1,"width":{size},"height":{size},"rows":[{{"stops":[{{"at":0,"color":"#000000"}}]}}]}}"##
        );
        pack(&format!(r#"{{"b":"column","r":{{"{name}":{recipe}}}}}"#))
    };
    let deep = format!(r#"{{"b":"column","d":{}1{}}}"#, r#"{"a":"#.repeat(3000), "}".repeat(3000));
    for (link, expected) in [
        (String::from("1"), "damaged"),
        ("1AAAA".into(), "damaged"),
        ("1%00%ff".into(), "damaged"),
        ("2AAAA".into(), "version"),
        ("1".repeat(MAX_LENGTH + 1), "too many"),
        (pack("not json"), "damaged"),
        (pack(r#"{"b":"nothing"}"#), "damaged"),
        (pack(r#"{"b":"column","x":1}"#), "damaged"),
        (pack(&deep), "damaged"),
        (pack(r##"{"b":"column","d":{"lights":{"#":4000000000}}}"##), "damaged"),
        (pack(r#"{"b":"column","d":{"camera":null,"lights":7}}"#), "link"),
        (pack(r#"{"b":"column","d":{"camera":{"exposure":1e30}}}"#), "exposure"),
        (pack(r#"{"b":"column","d":{"systems":{"0":{"emitter":{"rate":1e9}}}}}"#), "rate"),
        (pack(r#"{"b":"column","d":{"unknown":1}}"#), "unknown"),
        (ramp("../../etc/passwd.png", 2), "not valid for a ramp"),
        (ramp("a.json", 2), "not valid for a ramp"),
        (ramp("a.png", 2048), "texels"),
    ] {
        let error = Look::from_fragment(&link).unwrap_err().to_string();
        assert!(error.contains(expected) && !error.contains('\n'), "{expected}: {error}");
    }
    // Bits that were changed anywhere: an error or another valid look, but no panic.
    let whole = changed_look().to_fragment().unwrap();
    for at in 1..whole.len() {
        let mut link = whole.clone().into_bytes();
        link[at] = if link[at] == b'A' { b'B' } else { b'A' };
        let _ = Look::from_fragment(&String::from_utf8(link).unwrap());
        let _ = Look::from_fragment(&whole[..at]);
    }
}
