//! Whose film it is: what a film file says of the render that it belongs to, and its image likewise.
//!
//! Names are those of flags: `light-point`, not `light_point`.

use crate::scene_io::{FilmHeader, LoadedScene, MetadataValue};
use crate::settings::SettingsText;
use crate::stats::counts;
use bidir::ESTIMATOR_VERSION;
use bidir::driver::{Session, Settings, Training};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// The version of the program that writes.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The setting that is known after training only.
const TRAINED_MEAN: &str = "trained-mean";

/// The header of an empty film of the scene that is called `name`.
pub(crate) fn header(
    name: &str,
    loaded: &LoadedScene,
    settings: &Settings,
    training: Option<&Training>,
) -> FilmHeader {
    new(name, all_settings(loaded, settings, training))
}

fn new(name: &str, settings: BTreeMap<String, String>) -> FilmHeader {
    FilmHeader::new(&format!("bidir {VERSION}"), name.to_owned(), settings)
}

/// The same before training: what can be compared before it.
pub(crate) fn untrained(header: &FilmHeader) -> FilmHeader {
    let mut settings = header.settings.clone();
    settings.remove(TRAINED_MEAN);
    new(&header.scene, settings)
}

/// Everything that the bits of the picture depend on but the passes, by name.
fn all_settings(
    loaded: &LoadedScene,
    settings: &Settings,
    training: Option<&Training>,
) -> BTreeMap<String, String> {
    let film = loaded.scene.film();
    let texts = serde_json::to_value(SettingsText::from(settings));
    let mut settings: BTreeMap<_, _> = match texts {
        Ok(Value::Object(texts)) => texts.iter().map(|(k, v)| (flag(k), text(v))).collect(),
        _ => unreachable!("settings are an object of texts and numbers"),
    };
    let [width, height] = film.resolution;
    let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
    let own = [
        ("version", VERSION.to_owned()),
        ("estimator-version", ESTIMATOR_VERSION.to_string()),
        ("scene-digest", loaded.digest.clone()),
        ("size", format!("{width} x {height}")),
        ("crop", format!("{left},{top},{right},{bottom}")),
    ];
    settings.extend(own.map(|(name, value)| (name.to_owned(), value)));
    if let Some(training) = training {
        let mean = format!("{:e}", training.mean_luminance);
        settings.insert(TRAINED_MEAN.to_owned(), mean);
    }
    settings
}

/// The name of a field as flags are spelt.
fn flag(field: &str) -> String {
    field.replace('_', "-")
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

/// What was counted, by name, such as `rays.camera`.
pub(crate) fn counts_by_name(header: &FilmHeader) -> Vec<(String, String)> {
    let mut counts = Vec::new();
    flatten(String::new(), &header.counts, &mut counts);
    counts
}

fn flatten(name: String, value: &Value, counts: &mut Vec<(String, String)>) {
    match value {
        Value::Object(fields) => {
            let dot = if name.is_empty() { "" } else { "." };
            for (field, value) in fields {
                flatten(format!("{name}{dot}{}", flag(field)), value, counts);
            }
        }
        Value::Null => {}
        value => counts.push((name, text(value))),
    }
}

/// The attributes of an image of the film with this header, whichever command writes it: pbrt's
/// where it has such, else our own. Time and counts are those of all runs.
pub(crate) fn metadata(header: &FilmHeader) -> Vec<(String, MetadataValue)> {
    let passes = i32::try_from(header.passes.len()).unwrap_or(i32::MAX);
    let seconds = header.seconds as f32;
    let pbrt = [
        ("samplesPerPixel", MetadataValue::Integer(passes)),
        ("renderTimeSeconds", MetadataValue::Float(seconds)),
    ];
    let own = [
        ("scene", file_name(&header.scene)),
        ("identity", header.identity.clone()),
        ("passes", header.passes.to_string()),
        ("stopping", header.stopping.name().to_owned()),
    ];
    let own = own.map(|(name, text)| (name.to_owned(), text));
    let texts = header.settings.clone().into_iter();
    let texts = texts.chain(own).chain(counts_by_name(header));
    let texts = texts.map(|(name, text)| (format!("bidir/{name}"), MetadataValue::Text(text)));
    let pbrt = pbrt.map(|(name, value)| (name.to_owned(), value));
    pbrt.into_iter().chain(texts).collect()
}

/// The name of a file without its folders, which are of no interest to others.
pub(crate) fn file_name(path: &str) -> String {
    let name = Path::new(path).file_name();
    name.map_or_else(
        || path.to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}
