//! The settings of a render as flags write them: identities of films are made of these.

use bidir::driver::Settings;
use bidir::film::{Aov, StrategyImages};
use bidir::integrator::{EmissionKind, IntegratorKind, LvcSettings, ProposalKind};
use bidir::path::{LightChoiceKind, LightPointChoice, MisCount, MisHeuristic, PathSettings};
use bidir::sampler::SamplerKind;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::str::FromStr;

/// All settings, as flags write them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SettingsText {
    /// The estimator.
    pub integrator: &'static str,
    /// Which connections are traced.
    pub shadow_rays: String,
    /// How strategies share paths.
    pub mis: &'static str,
    /// Which take part.
    pub strategies: String,
    /// Where next-event estimation takes its point from.
    pub light_point: &'static str,
    /// How it chooses the light.
    pub light_choice: &'static str,
    /// How subpaths end by chance.
    pub path_roulette: String,
    /// The most bounces. None: no limit.
    pub max_depth: Option<u32>,
    /// The cached light vertices that are candidates for the first vertex of a camera subpath and for those
    /// behind it.
    pub candidates: String,
    /// The light points that are drawn for these.
    pub next_events: String,
    /// How cached light vertices are chosen.
    pub proposal: &'static str,
    /// How light subpaths choose the light that they begin on.
    pub light_start: &'static str,
    /// How many samples bring one light subpath to the cache.
    pub samples_per_subpath: u16,
    /// What weights take for the number of samples of a strategy whose light subpaths are shared.
    pub mis_count: &'static str,
    /// The random numbers.
    pub sampler: &'static str,
    /// Their seed.
    pub seed: u64,
    /// The images beside the picture.
    pub aov: String,
    /// The groups of lights with images of their own.
    pub light_groups: String,
    /// The most vertices of paths whose strategies have images of their own.
    pub strategy_layers: usize,
    /// True where strategies have raw images too; left out where they have none.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub raw_strategies: bool,
}

impl SettingsText {
    /// The same by the names of flags: `light-point`, not `light_point`.
    pub fn by_flag(&self) -> BTreeMap<String, String> {
        match serde_json::to_value(self) {
            Ok(Value::Object(texts)) => texts.iter().map(|(k, v)| (flag(k), text(v))).collect(),
            _ => unreachable!("settings are an object of texts and numbers"),
        }
    }
}

/// The settings that [`SettingsText::by_flag`] wrote, but for the layers, which are left out.
///
/// None: a setting is missing, or has a value that this program does not know.
pub fn settings_from_flags(flags: &BTreeMap<String, String>) -> Option<Settings> {
    fn parse<T: FromStr>(text: &str) -> Option<T> {
        text.parse().ok()
    }
    let flag = |name: &str| flags.get(name).map(String::as_str);
    let max_depth = flag("max-depth")?;
    let settings = Settings {
        integrator: named(&IntegratorKind::NAMES, flag("integrator")?)?,
        shadow_rays: parse(flag("shadow-rays")?)?,
        path: PathSettings {
            max_depth: match max_depth {
                "none" => None,
                number => Some(parse(number)?),
            },
            roulette: parse(flag("path-roulette")?)?,
            strategies: parse(flag("strategies")?)?,
            mis: named(&MisHeuristic::NAMES, flag("mis")?)?,
            light_point: named(&LightPointChoice::NAMES, flag("light-point")?)?,
            light_choice: named(&LightChoiceKind::NAMES, flag("light-choice")?)?,
        },
        lvc: LvcSettings {
            candidates: parse(flag("candidates")?)?,
            next_events: parse(flag("next-events")?)?,
            proposal: named(&ProposalKind::NAMES, flag("proposal")?)?,
            emission: named(&EmissionKind::NAMES, flag("light-start")?)?,
            samples_per_subpath: parse(flag("samples-per-subpath")?)?,
            mis_count: named(&MisCount::NAMES, flag("mis-count")?)?,
        },
        sampler: named(&SamplerKind::NAMES, flag("sampler")?)?,
        seed: parse(flag("seed")?)?,
        ..Settings::default()
    };
    Some(settings)
}

/// Settings as files name them, by today's names: older files have `emission` for `light-start`, and
/// rules with the value `suited` for `auto`.
pub fn renamed(settings: BTreeMap<String, String>) -> BTreeMap<String, String> {
    let today = |(mut name, mut value): (String, String)| {
        if name == "emission" {
            "light-start".clone_into(&mut name);
        }
        let is_rule = ["candidates", "path-roulette", "shadow-rays"].contains(&name.as_str());
        if is_rule && value == "suited" {
            "auto".clone_into(&mut value);
        }
        (name, value)
    };
    settings.into_iter().map(today).collect()
}

/// True where the setting that is called `name` may change an image by `integrator`.
pub fn has_influence(name: &str, integrator: IntegratorKind) -> bool {
    use IntegratorKind::{Auto, Light, Lvc};
    match name {
        "strategies" | "light-point" | "shadow-rays" => integrator.has_candidates(),
        "light-choice" | "mis" => integrator != Light,
        "candidates" | "next-events" | "proposal" | "light-start" | "mis-count" => {
            matches!(integrator, Lvc | Auto)
        }
        "samples-per-subpath" => integrator == Lvc,
        _ => true,
    }
}

/// The value of a name in a table of the library. None: it is not there.
fn named<T: Copy>(names: &[(&'static str, T)], name: &str) -> Option<T> {
    let mut names = names.iter();
    names.find(|(known, _)| *known == name).map(|entry| entry.1)
}

/// The name of a field as flags are spelt.
pub(super) fn flag(field: &str) -> String {
    field.replace('_', "-")
}

/// A value as flags write it.
pub(super) fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "none".to_owned(),
        value => value.to_string(),
    }
}

/// The name of a value in a table of the library.
pub fn name_of<T: Copy + PartialEq>(names: &'static [(&'static str, T)], value: T) -> &'static str {
    names
        .iter()
        .find(|(_, named)| *named == value)
        .map_or("", |(name, _)| name)
}

/// Names with commas between them.
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
        // Taken apart, so that no setting can be forgotten: identities of films are made of these.
        let Settings {
            integrator,
            shadow_rays,
            lvc,
            path,
            sampler,
            seed,
            layers,
        } = settings;
        let PathSettings {
            max_depth,
            roulette,
            strategies,
            mis,
            light_point,
            light_choice,
        } = path;
        let LvcSettings {
            candidates,
            next_events,
            proposal,
            emission,
            samples_per_subpath,
            mis_count,
        } = lvc;
        Self {
            integrator: name_of(&IntegratorKind::NAMES, *integrator),
            shadow_rays: shadow_rays.to_string(),
            mis: name_of(&MisHeuristic::NAMES, *mis),
            strategies: strategies.to_string(),
            light_point: name_of(&LightPointChoice::NAMES, *light_point),
            light_choice: name_of(&LightChoiceKind::NAMES, *light_choice),
            path_roulette: roulette.to_string(),
            max_depth: *max_depth,
            candidates: candidates.to_string(),
            next_events: next_events.to_string(),
            proposal: name_of(&ProposalKind::NAMES, *proposal),
            light_start: name_of(&EmissionKind::NAMES, *emission),
            samples_per_subpath: samples_per_subpath.get(),
            mis_count: name_of(&MisCount::NAMES, *mis_count),
            sampler: name_of(&SamplerKind::NAMES, *sampler),
            seed: *seed,
            aov: list(layers.aovs().iter().map(|aov| name_of(&Aov::NAMES, *aov))),
            light_groups: list(layers.light_groups().iter().map(String::as_str)),
            strategy_layers: layers.strategy_vertices(),
            raw_strategies: layers.strategy_images() == StrategyImages::WeightedAndRaw,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_as_they_were_written() {
        let mut settings = Settings {
            integrator: IntegratorKind::Path,
            shadow_rays: "budget:3".parse().unwrap(),
            seed: u64::MAX,
            ..Settings::default()
        };
        settings.path.strategies = "all,-s0,-t1".parse().unwrap();
        settings.path.light_point = LightPointChoice::Shared;
        settings.path.light_choice = LightChoiceKind::Power;
        for max_depth in [None, Some(7)] {
            settings.path.max_depth = max_depth;
            let mut flags = SettingsText::from(&settings).by_flag();
            let read = settings_from_flags(&flags).unwrap();
            assert_eq!(SettingsText::from(&read).by_flag(), flags);
            flags.insert("mis".to_owned(), "best".to_owned());
            assert!(settings_from_flags(&flags).is_none());
        }
    }
}
