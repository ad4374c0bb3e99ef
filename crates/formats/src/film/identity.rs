//! The identity of a film: a description of its render, for film files and for the attributes of images.
//!
//! Names are those of flags: `light-point`, not `light_point`.

use super::header::FilmHeader;
use super::settings::SettingsText;
use crate::image::MetadataValue;
use bidir::ESTIMATOR_VERSION;
use bidir::driver::{Settings, Training};
use bidir::scene::Scene;
use bidir::settings::{flag, text};
use bidir::stats::Stats;
use bidir::view::View;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The version of the program.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// A setting that is known only after training.
const TRAINED_MEAN: &str = "trained-mean";
/// The number of training samples. Present only if the time did not suffice for all of them.
const TRAINING: &str = "training";
/// The plan of `auto`, known only after training.
const PLAN: &str = "plan";

/// A scene to render, and the view of it.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The name of the scene file as it was given.
    pub name: String,
    /// The hash of all files that were read for the scene, as text.
    pub digest: String,
    /// The scene.
    pub scene: Arc<Scene>,
    /// The view of it.
    pub view: View,
}

impl Subject {
    /// Returns the header of an empty film of this scene. `training` is None before training, and for
    /// renders that need none.
    pub fn header(&self, settings: &Settings, training: Option<&Training>) -> FilmHeader {
        new(&self.name, self.all_settings(settings, training))
    }

    /// Returns everything that the bits of the picture depend on, except the passes, by name.
    fn all_settings(
        &self,
        settings: &Settings,
        training: Option<&Training>,
    ) -> BTreeMap<String, String> {
        let film = self.view.film();
        let mut settings = SettingsText::from(settings).by_flag();
        let [width, height] = film.resolution;
        let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
        let own = [
            ("version", VERSION.to_owned()),
            ("estimator-version", ESTIMATOR_VERSION.to_string()),
            ("scene-digest", self.digest.clone()),
            ("size", format!("{width} x {height}")),
            ("crop", format!("{left},{top},{right},{bottom}")),
        ];
        settings.extend(own.map(|(name, value)| (name.to_owned(), value)));
        if let Some(training) = training {
            let mean = format!("{:e}", training.mean_luminance);
            settings.insert(TRAINED_MEAN.to_owned(), mean);
            if training.is_short {
                settings.insert(TRAINING.to_owned(), training.samples.to_string());
            }
            let plan = training
                .plan
                .map(|plan| (PLAN.to_owned(), plan.to_string()));
            settings.extend(plan);
        }
        settings
    }
}

/// Returns the name and version of the program for files.
pub fn program() -> String {
    format!("bidir {VERSION}")
}

pub(super) fn new(name: &str, settings: BTreeMap<String, String>) -> FilmHeader {
    FilmHeader::new(&program(), name.to_owned(), settings)
}

/// Returns the number of samples that training was limited to. None: it was not limited.
pub(super) fn training_samples(header: &FilmHeader) -> Option<u64> {
    header.settings.get(TRAINING)?.parse().ok()
}

/// Returns the header without the settings that are known only after training.
pub(super) fn untrained(header: &FilmHeader) -> FilmHeader {
    let mut settings = header.settings.clone();
    for name in [TRAINED_MEAN, TRAINING, PLAN] {
        settings.remove(name);
    }
    new(&header.scene, settings)
}

/// Returns the counts for film files: numbers that add up when films are merged.
pub(super) fn counts(stats: &Stats, training: Option<&Training>) -> Value {
    let rays = &stats.rays;
    json!({
        "samples": stats.samples,
        "rays": {
            "camera": rays.camera,
            "light": rays.light,
            "connection": rays.connection,
            "light_image": rays.light_image,
            // The sum of those above.
            "total": rays.total(),
            "training": training.map_or(0, |training| training.rays.total()),
        },
        "connections_blocked": stats.connections_blocked,
        "light_image_blocked": stats.light_image_blocked,
        // The name `candidates` is that of a setting.
        "candidates_evaluated": stats.candidates,
        "dropped": stats.dropped,
    })
}

/// Returns the counts by name, such as `rays.camera`.
pub fn counts_by_name(header: &FilmHeader) -> Vec<(String, String)> {
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

/// Returns the attributes of an image of the film with this header, by pbrt's names where pbrt has one.
/// Time and counts are sums over all runs.
pub fn metadata(header: &FilmHeader) -> Vec<(String, MetadataValue)> {
    let passes = i32::try_from(header.passes.len()).unwrap_or(i32::MAX);
    let seconds = header.seconds as f32;
    let pbrt = [
        ("samplesPerPixel", MetadataValue::Integer(passes)),
        ("renderTimeSeconds", MetadataValue::Float(seconds)),
    ];
    let own = [
        ("scene", header.scene_name()),
        ("identity", header.identity.clone()),
        ("passes", header.passes.to_string()),
        ("stopping", header.stopping.name().to_owned()),
    ];
    let texts = header.settings.clone().into_iter();
    let all = texts
        .chain(own.map(|(name, text)| (name.to_owned(), text)))
        .chain(counts_by_name(header));
    pbrt.map(|(name, value)| (name.to_owned(), value))
        .into_iter()
        .chain(all.map(|(name, text)| (format!("bidir/{name}"), MetadataValue::Text(text))))
        .collect()
}
