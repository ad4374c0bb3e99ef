//! What a film file says about its film: whose render it is, and which part.

use super::broken;
use super::layers::LayerNames;
use crate::error::Result;
use bidir::film::{Film, FilmSettings, Filter, Layers, PassSet, PixelRect};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;

/// How the number of passes was decided. What looks at noise or at a clock may depend on the
/// picture, which makes its mean slightly biased.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stopping {
    /// Before the render.
    Fixed,
    /// By a clock or a signal.
    Time,
    /// By the noise of the picture.
    Noise,
}

impl Stopping {
    /// As a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Time => "time",
            Self::Noise => "noise",
        }
    }
}

/// The first part of a film file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FilmHeader {
    /// The program that wrote it, with its version.
    pub program: String,
    /// The scene file, as it was named.
    pub scene: String,
    /// Hash of everything that the picture's bits depend on but the passes: films can be merged
    /// where it is the same.
    pub identity: String,
    /// What the identity was made of, by name: where two differ, these say why.
    pub settings: BTreeMap<String, String>,
    /// Width and height of the whole film. Unit: pixels.
    pub resolution: [u32; 2],
    /// Left, top, right, bottom of what is rendered, the last two exclusive. Unit: pixels.
    pub crop: [u32; 4],
    /// What developed values are multiplied by.
    pub exposure: f32,
    /// What is kept beside the picture.
    #[serde(default, skip_serializing_if = "LayerNames::is_empty")]
    pub layers: LayerNames,
    /// The passes that are summed.
    #[serde(with = "passes")]
    pub passes: PassSet,
    /// How the number of passes was decided.
    pub stopping: Stopping,
    /// Time that rendering took. Unit: seconds.
    pub seconds: f64,
    /// Whatever was counted, for those who read it.
    pub counts: Value,
}

impl FilmHeader {
    /// The header of an empty film: the identity is a hash of `settings`, which must name everything
    /// that the picture's bits depend on but the passes.
    pub fn new(program: &str, scene: String, settings: BTreeMap<String, String>) -> Self {
        let mut hash = Sha256::new();
        for text in settings.iter().flat_map(|(name, value)| [name, value]) {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        }
        let hash = hash.finalize();
        let identity = hash.iter().map(|byte| format!("{byte:02x}"));
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

    /// The name of the scene file without its folders, which are of no interest to others.
    pub fn scene_name(&self) -> String {
        let name = Path::new(&self.scene).file_name();
        name.map_or_else(
            || self.scene.clone(),
            |name| name.to_string_lossy().into_owned(),
        )
    }

    /// The header of both films: time and counts are added.
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

    /// The same with the passes and geometry of `film`.
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

    /// What is kept beside the picture.
    pub(super) fn layers(&self) -> Result<Layers> {
        let message = "the film has layers that this program does not know";
        self.layers.layers().ok_or_else(|| broken(message))
    }

    /// The film's geometry, with a filter that nobody asks for.
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

    /// Why a film of `self` is not one of `other`; None: it is. The first setting that differs is
    /// named with both values: the integrator, which decides what others usually are, before them.
    pub fn difference(&self, other: &Self) -> Option<String> {
        self.difference_between(other, ["here", "there"])
    }

    /// [`Self::difference`] with phrases for both places, such as `in the film`.
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

/// Adds numbers, in objects key by key; of anything else there is the first.
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

/// Passes as text.
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
