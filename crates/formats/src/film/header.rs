//! The header of a film file: the render that the film belongs to, and its passes.

use super::broken;
use super::layers::LayerNames;
use crate::error::Result;
use bidir::driver::Stopping;
use bidir::film::{Film, FilmSettings, Filter, Layers, PassSet, PixelRect};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;

/// The first part of a film file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FilmHeader {
    /// The program that wrote the file, with its version.
    pub program: String,
    /// The name of the scene file as it was given.
    pub scene: String,
    /// Hash of everything that the picture's bits depend on, except the passes. Films with equal hashes can be
    /// merged.
    pub identity: String,
    /// The settings that the identity is a hash of, by name. They explain a difference of two identities.
    pub settings: BTreeMap<String, String>,
    /// Width and height of the whole film. Unit: pixels.
    pub resolution: [u32; 2],
    /// Left, top, right and bottom of the rendered part, the last two exclusive. Unit: pixels.
    pub crop: [u32; 4],
    /// The factor on developed values.
    pub exposure: f32,
    /// The layers of the film.
    #[serde(default, skip_serializing_if = "LayerNames::is_empty")]
    pub layers: LayerNames,
    /// The passes in the sums.
    #[serde(with = "passes")]
    pub passes: PassSet,
    /// The rule that ended the render.
    pub stopping: Stopping,
    /// The time of rendering. Unit: seconds.
    pub seconds: f64,
    /// Counts of rays and other events, which add up when films are merged.
    pub counts: Value,
}

impl FilmHeader {
    /// Returns the header of an empty film. Its identity is the hash of `settings`, which must contain
    /// everything that the picture's bits depend on, except the passes.
    pub fn new(program: &str, scene: String, settings: BTreeMap<String, String>) -> Self {
        let mut hash = Sha256::new();
        for text in settings.iter().flat_map(|(name, value)| [name, value]) {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        }
        let digest = hash.finalize();
        let identity = digest.iter().map(|byte| format!("{byte:02x}"));
        Self {
            program: program.to_owned(),
            scene,
            identity: identity.collect(),
            settings,
            resolution: [1; 2],
            crop: [0, 0, 1, 1],
            exposure: 1.0,
            layers: LayerNames::default(),
            passes: PassSet::default(),
            stopping: Stopping::Fixed,
            seconds: 0.0,
            counts: Value::Null,
        }
    }

    /// Returns the name of the scene file without its folders.
    pub fn scene_name(&self) -> String {
        scene_name(&self.scene)
    }

    /// Returns the header of the sum of two films: time and counts are added.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        Self {
            passes: self.passes.union(&other.passes),
            stopping: self.stopping.max(other.stopping),
            seconds: self.seconds + other.seconds,
            counts: sum(&self.counts, &other.counts),
            ..self.clone()
        }
    }

    /// Returns the same header with the passes and geometry of `film`.
    #[must_use]
    pub fn of(&self, film: &Film) -> Self {
        let settings = film.settings();
        let PixelRect { min, max } = settings.crop;
        Self {
            resolution: settings.resolution,
            crop: [min[0], min[1], max[0], max[1]],
            exposure: settings.exposure,
            layers: film.layers().into(),
            passes: film.passes().clone(),
            ..self.clone()
        }
    }

    pub(super) fn to_json(&self) -> String {
        serde_json::to_string(self).expect("a header is numbers and texts")
    }

    pub(super) fn from_json(json: &[u8]) -> Result<Self> {
        let header: Self = serde_json::from_slice(json)
            .map_err(|error| broken(format!("damaged: the header is wrong: {error}")))?;
        let [left, top, right, bottom] = header.crop;
        let [width, height] = header.resolution;
        let fits = left < right && top < bottom && right <= width && bottom <= height;
        if fits && header.exposure.is_finite() {
            Ok(header)
        } else {
            Err(broken("damaged: the crop or the exposure is invalid"))
        }
    }

    /// Returns the layers of the film.
    pub(super) fn layers(&self) -> Result<Layers> {
        let message = "the film has layers that this program does not know";
        self.layers.layers().ok_or_else(|| broken(message))
    }

    /// Returns the film's geometry with a default filter, which is not used.
    pub(super) fn film_settings(&self) -> FilmSettings {
        let [left, top, right, bottom] = self.crop;
        FilmSettings {
            crop: PixelRect {
                min: [left, top],
                max: [right, bottom],
            },
            exposure: self.exposure,
            ..FilmSettings::new(self.resolution, Filter::default())
        }
    }

    /// Describes why films of the two headers cannot be merged. None: they can.
    ///
    /// Names the first setting that differs with both values. The integrator comes first, as other defaults
    /// depend on it.
    pub fn difference(&self, other: &Self) -> Option<String> {
        self.difference_between(other, ["here", "there"])
    }

    /// Describes a difference as [`Self::difference`] does, with phrases for the two headers, such as `in the film`.
    pub fn difference_between(&self, other: &Self, [here, there]: [&str; 2]) -> Option<String> {
        if self.identity == other.identity {
            return None;
        }
        let keys = self.settings.keys().chain(other.settings.keys());
        let names = std::iter::once("integrator").chain(keys.map(String::as_str));
        let value = |header: &Self, name: &str| {
            header
                .settings
                .get(name)
                .map_or("nothing", |v| v)
                .to_owned()
        };
        for name in names {
            let (a, b) = (value(self, name), value(other, name));
            if a != b {
                return Some(format!("{name} is {a} {here} and {b} {there}"));
            }
        }
        Some("their identities differ".to_owned())
    }
}

/// Returns the name of a scene file without its folders.
pub fn scene_name(name: &str) -> String {
    let file = Path::new(name).file_name();
    file.unwrap_or(name.as_ref()).to_string_lossy().into_owned()
}

/// Adds numbers, and objects key by key. Of two other values, returns `a`.
fn sum(a: &Value, b: &Value) -> Value {
    match (a, b) {
        (Value::Null, other) | (other, Value::Null) => other.clone(),
        (Value::Number(x), Value::Number(y)) => match (x.as_u64(), y.as_u64()) {
            (Some(x), Some(y)) => x.saturating_add(y).into(),
            _ => (x.as_f64().unwrap_or(0.0) + y.as_f64().unwrap_or(0.0)).into(),
        },
        (Value::Object(x), Value::Object(y)) => {
            let mut all = y.clone();
            for (key, value) in x {
                let added = sum(value, y.get(key).unwrap_or(&Value::Null));
                all.insert(key.clone(), added);
            }
            Value::Object(all)
        }
        _ => a.clone(),
    }
}

/// Serializes passes as text.
mod passes {
    use bidir::film::PassSet;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(super) fn serialize<S: Serializer>(passes: &PassSet, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(passes)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<PassSet, D::Error> {
        String::deserialize(from)?.parse().map_err(D::Error::custom)
    }
}
