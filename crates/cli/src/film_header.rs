//! Whose film it is: what a film file says of the render that it belongs to.

use crate::scene_io::{FilmHeader, LoadedScene};
use crate::settings::SettingsText;
use crate::stats::counts;
use bidir::driver::Session;
use serde_json::Value;
use std::collections::BTreeMap;
use std::time::Duration;

/// The program that writes, with its version.
const PROGRAM: &str = concat!("bidir ", env!("CARGO_PKG_VERSION"));

/// The header of an empty film of `session`, whose scene is called `name`.
pub(crate) fn header(name: String, loaded: &LoadedScene, session: &Session<'_>) -> FilmHeader {
    FilmHeader::new(PROGRAM, name, settings(loaded, session))
}

/// Everything that the bits of the picture depend on but the passes, by name.
fn settings(loaded: &LoadedScene, session: &Session<'_>) -> BTreeMap<String, String> {
    let film = loaded.scene.film();
    let texts = serde_json::to_value(SettingsText::from(session.settings()));
    let mut settings: BTreeMap<_, _> = match texts {
        Ok(Value::Object(texts)) => texts.into_iter().map(|(k, v)| (k, text(&v))).collect(),
        _ => unreachable!("settings are an object of texts and numbers"),
    };
    let [width, height] = film.resolution;
    let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
    let own = [
        ("program", PROGRAM.to_owned()),
        ("scene", loaded.digest.clone()),
        ("size", format!("{width} x {height}")),
        ("crop", format!("{left},{top},{right},{bottom}")),
    ];
    settings.extend(own.map(|(name, value)| (name.to_owned(), value)));
    if let Some(training) = session.training() {
        let mean = format!("{:e}", training.mean_luminance);
        settings.insert("trained mean".to_owned(), mean);
    }
    settings
}

/// A value as flags write it.
fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "none".to_owned(),
        value => value.to_string(),
    }
}

/// The header with the time and the counts of this run.
pub(crate) fn of_run(header: &FilmHeader, session: &Session<'_>, time: Duration) -> FilmHeader {
    FilmHeader {
        seconds: time.as_secs_f64(),
        counts: counts(session),
        ..header.clone()
    }
}
