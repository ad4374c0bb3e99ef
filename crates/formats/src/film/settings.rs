//! The settings of a render as texts, for identities of films and attributes of images.

use bidir::driver::Settings;
use bidir::film::StrategyImages;
use bidir::settings::{Request, flag, text};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// The settings that an image depends on, and its layers. Settings without effect are null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SettingsText {
    /// The settings of the estimator.
    #[serde(flatten)]
    pub request: Request,
    /// The layers.
    pub aov: String,
    /// The light groups with layers of their own.
    pub light_groups: String,
    /// The maximum number of vertices of paths whose strategies have layers of their own.
    pub strategy_layers: usize,
    /// True if strategies also have raw layers; omitted if they do not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub raw_strategies: bool,
}

impl SettingsText {
    /// Returns the settings by the names of flags: `light-point`, not `light_point`.
    pub fn by_flag(&self) -> BTreeMap<String, String> {
        let Ok(Value::Object(mut texts)) = serde_json::to_value(self) else {
            unreachable!("settings are an object of texts and numbers")
        };
        texts.retain(|_, value| !value.is_null());
        texts.iter().map(|(k, v)| (flag(k), text(v))).collect()
    }

    /// Returns the settings of these names in one line, such as `shadow rays all, seed 0`.
    pub fn line(&self, names: &[&str]) -> String {
        let texts = self.by_flag();
        let pair = |&name: &&str| Some(format!("{} {}", name.replace('-', " "), texts.get(name)?));
        let pairs: Vec<_> = names.iter().filter_map(pair).collect();
        pairs.join(", ")
    }
}

/// Joins names with commas.
fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(",")
    }
}

impl From<&Settings> for SettingsText {
    fn from(settings: &Settings) -> Self {
        let layers = &settings.layers;
        Self {
            request: Request::of(settings),
            aov: list(layers.aovs().iter().map(|aov| aov.name())),
            light_groups: list(layers.light_groups().iter().map(String::as_str)),
            strategy_layers: layers.strategy_vertices(),
            raw_strategies: layers.strategy_images() == StrategyImages::WeightedAndRaw,
        }
    }
}
