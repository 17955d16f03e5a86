//! Errors in the log: one line for each, however many frames meet it.

use std::sync::{Mutex, Once, PoisonError};

use bevy::log::tracing::field::{Field, Visit};
use bevy::log::tracing::{Event, Level, Metadata, Subscriber, subscriber};
use bevy::log::tracing_subscriber::layer::{Context, Layer, SubscriberExt as _};
use bevy::log::tracing_subscriber::registry;
use bevy::prelude::*;
use bevy_haze::{Smoke, SmokeAsset};

use crate::host::host;

/// Errors that this process has logged.
static ERRORS: Mutex<Vec<String>> = Mutex::new(Vec::new());

struct Recorder;

impl<S: Subscriber> Layer<S> for Recorder {
    fn enabled(&self, metadata: &Metadata<'_>, _: Context<'_, S>) -> bool {
        *metadata.level() == Level::ERROR
    }

    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        struct Text(String);
        impl Visit for Text {
            fn record_debug(&mut self, _: &Field, value: &dyn std::fmt::Debug) {
                self.0 += &format!("{value:?}");
            }
        }
        let mut text = Text(String::new());
        event.record(&mut text);
        ERRORS.lock().unwrap_or_else(PoisonError::into_inner).push(text.0);
    }
}

/// Errors that name something. Other tests log theirs into the same list.
fn errors(what: &str) -> Vec<String> {
    let errors = ERRORS.lock().unwrap_or_else(PoisonError::into_inner);
    errors.iter().filter(|error| error.contains(what)).cloned().collect()
}

fn record() {
    static RECORDED: Once = Once::new();
    RECORDED.call_once(|| subscriber::set_global_default(registry().with(Recorder)).unwrap());
}

#[test]
fn invalid_settings_are_logged_once_until_they_are_valid_again() {
    record();
    let mut host = host("assets".as_ref());
    host.camera();
    let mut asset = SmokeAsset::builtin("column").unwrap();
    asset.systems[0].preset.settings.boost = -7.25;
    let smoke = host.app.world_mut().resource_mut::<Assets<SmokeAsset>>().add(asset);
    host.app.world_mut().spawn(Smoke::from(smoke.clone()));
    host.update(8);
    let logged = errors("boost: -7.25");
    assert!(logged.len() == 1 && logged[0].contains("systems[0].settings.boost"), "{logged:?}");
    for boost in [1.0, -7.25] {
        let mut assets = host.app.world_mut().resource_mut::<Assets<SmokeAsset>>();
        assets.get_mut(&smoke).unwrap().systems[0].preset.settings.boost = boost;
        host.update(4);
    }
    assert_eq!(errors("boost: -7.25").len(), 2);
}

#[test]
fn presets_that_cannot_be_read_are_logged_once() {
    record();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("torn.smoke.json"), "{\"version\": 1,").unwrap();
    let mut host = host(folder.path());
    host.camera();
    for name in ["torn.smoke.json", "absent.smoke.json"] {
        let smoke: Handle<SmokeAsset> = host.app.world().resource::<AssetServer>().load(name);
        host.app.world_mut().spawn(Smoke::from(smoke));
    }
    for _ in 0..200 {
        host.update(1);
        std::thread::sleep(std::time::Duration::from_millis(2));
        if !errors("absent.smoke.json").is_empty() && !errors("torn.smoke.json").is_empty() {
            break;
        }
    }
    host.update(4);
    for (name, part) in [("torn.smoke.json", "torn.smoke.json:1:"), ("absent.smoke.json", "absent.smoke.json")] {
        let logged = errors(name);
        assert!(logged.len() == 1 && logged[0].contains(part), "{logged:?}");
    }
}
