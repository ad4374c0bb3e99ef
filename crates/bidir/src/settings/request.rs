//! A [`Request`]: the settings that a person asks for.

use super::{Choice, Settings};
use crate::integrator::{
    CandidateCount, IntegratorKind, LightStart, ProposalKind, SamplesPerSubpath,
};
use crate::names::Parse;
use crate::path::{LightChoiceKind, LightPointChoice, MisHeuristic, PathRoulette, Strategies};
use crate::sampler::SamplerKind;
use crate::select::ShadowRays;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::str::FromStr;

#[cfg(test)]
mod tests;

/// Settings that are asked for; None leaves one to what lies below, or to its default. The comments are the help
/// of the command.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(
    feature = "clap",
    derive(clap::Args),
    command(next_help_heading = "Integrator")
)]
#[allow(
    clippy::doc_markdown,
    rustdoc::broken_intra_doc_links,
    reason = "the comments are the help of the command"
)]
pub struct Request {
    /// path, light, bdpt, lvc, or auto to choose by a short survey [default: the scene's].
    ///
    /// path: path tracing. light: light tracing. bdpt: bidirectional path tracing. lvc: the same with
    /// light subpaths shared by many samples (light vertex cache). auto: takes path, bdpt or lvc, by
    /// the variance × cost that a few samples of bdpt predict, a count of rays and candidates. A glTF file names no
    /// integrator and is rendered with auto.
    #[cfg_attr(
        feature = "clap",
        arg(long, env = "BIDIR_INTEGRATOR", value_name = "NAME")
    )]
    pub integrator: Option<IntegratorKind>,
    /// Maximum number of bounces; 0 is unlimited [default: the scene's].
    #[serde(deserialize_with = "whole")]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N"))]
    pub max_depth: Option<u32>,
    /// MIS heuristic: balance, power or uniform [default: balance].
    ///
    /// Strategies that make the same path are weighted by their densities, by the squares of these, or
    /// equally.
    #[cfg_attr(
        feature = "clap",
        arg(long, env = "BIDIR_MIS", value_name = "HEURISTIC")
    )]
    pub mis: Option<MisHeuristic>,
    /// Strategies (s, t) in use, such as all,-s0 or s2t3 (bdpt, lvc, auto) [default: all].
    ///
    /// s counts vertices from the light, t from the camera. The list has rules such as all, -s0
    /// (without s = 0), -t1 and s2t3; the last rule that matches a strategy wins. A list that begins
    /// with a removal begins with all strategies, any other with none.
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "LIST", allow_hyphen_values = true)
    )]
    pub strategies: Option<Strategies>,
    /// Russian roulette of subpaths: albedo[:START], throughput[:START], off, auto [default: the
    /// integrator's].
    ///
    /// albedo, throughput: subpaths survive with the albedo that they meet, or with their throughput.
    /// START (0 if left out) is the first bounce that it applies to. off: subpaths end by --max-depth or
    /// by leaving the scene. auto: the integrator's default. Defaults: albedo:1 for path, albedo:2 for light,
    /// albedo:0 for bdpt, albedo:0 for lvc, chosen by a survey for auto.
    #[cfg_attr(feature = "clap", arg(long, value_name = "RULE"))]
    pub path_roulette: Option<Choice<PathRoulette>>,
    /// How next-event estimation picks a light: tree or power (path, bdpt, lvc, auto) [default: tree].
    ///
    /// tree: a hierarchy of the lights estimates the light that arrives from each. power: by power
    /// alone.
    #[cfg_attr(feature = "clap", arg(long, value_name = "RULE"))]
    pub light_choice: Option<LightChoiceKind>,
    /// Light point of next-event estimation (bdpt, lvc, auto) [default: fresh].
    ///
    /// fresh: one per camera vertex. shared: the start of the light subpath.
    #[cfg_attr(feature = "clap", arg(long, value_name = "RULE"))]
    pub light_point: Option<LightPointChoice>,
    /// Sampler: sobol or independent [default: the scene's].
    ///
    /// sobol: Owen-scrambled Sobol' points, stratified over the samples of a pixel. independent:
    /// independent uniform numbers.
    #[cfg_attr(
        feature = "clap",
        arg(long, env = "BIDIR_SAMPLER", value_name = "NAME")
    )]
    pub sampler: Option<SamplerKind>,
    /// Random seed [default: the scene's, or 0].
    ///
    /// Images of different seeds have independent noise.
    #[serde(deserialize_with = "whole")]
    #[cfg_attr(feature = "clap", arg(long, env = "BIDIR_SEED", value_name = "N"))]
    pub seed: Option<u64>,
    /// Which connections are traced (bdpt, lvc, auto) [default: the integrator's].
    ///
    /// all: all that can carry light. per-light-vertex, per-camera-vertex, per-pair: one for each light
    /// vertex, camera vertex or pair of subpaths, drawn by unoccluded contribution (optimisations 1, 2
    /// and 3 of Lafortune and Willems, 1995). ray-roulette[:T]: Russian roulette below the fraction T
    /// (0.1) of the image's mean. budget:K: at most K per sample, the largest for certain. auto: the
    /// integrator's default. No rule is biased. Defaults: all for bdpt, budget:6 for lvc, chosen by
    /// a survey for auto.
    #[cfg_attr(
        feature = "clap",
        arg(
            long,
            env = "BIDIR_SHADOW_RAYS",
            value_name = "RULE",
            help_heading = "Shadow rays"
        )
    )]
    pub shadow_rays: Option<Choice<ShadowRays>>,
    /// Light vertices considered per camera vertex: M at the first, N at later ones (lvc, auto)
    /// [default: the integrator's].
    ///
    /// Each from 1 to 4096; one number is for all vertices; auto: the integrator's default. Defaults:
    /// 12,1 for lvc, chosen by a survey for auto.
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "M[,N]", help_heading = "Shared light subpaths")
    )]
    pub candidates: Option<Choice<CandidateCount>>,
    /// Light samples per camera vertex: M at the first, N at later ones (lvc, auto) [default: the
    /// integrator's].
    ///
    /// Each from 1 to 4096; one number is for all vertices; auto: the integrator's default. Defaults:
    /// 2,1 for lvc, chosen by a survey for auto.
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "M[,N]", help_heading = "Shared light subpaths")
    )]
    pub next_events: Option<Choice<CandidateCount>>,
    /// How candidates are drawn: learned in training, or uniform (lvc, auto) [default: learned].
    ///
    /// Training is a short render before the first pass.
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "RULE", help_heading = "Shared light subpaths")
    )]
    pub proposal: Option<ProposalKind>,
    /// How light subpaths pick their light: learned, or by power (lvc, auto) [default: learned].
    ///
    /// learned: by the light of each that reached visible surfaces in training.
    #[serde(alias = "emission")]
    #[cfg_attr(
        feature = "clap",
        arg(
            long,
            alias = "emission",
            value_name = "RULE",
            help_heading = "Shared light subpaths"
        )
    )]
    pub light_start: Option<LightStart>,
    /// Samples per light subpath, a power of two up to 256 (lvc) [default: 2].
    ///
    /// More samples share each if the subpaths of a group would fill more than about 30 MB.
    #[cfg_attr(
        feature = "clap",
        arg(long, value_name = "K", help_heading = "Shared light subpaths")
    )]
    pub samples_per_subpath: Option<SamplesPerSubpath>,
}

/// Why a setting cannot be read: there is none of that name, or it has no such value.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("{0}")]
pub struct RequestError(String);

impl Request {
    /// Returns the settings that an image depends on, each with its value: the same request gives the same image.
    pub fn of(settings: &Settings) -> Self {
        use IntegratorKind::{Auto, Light, Lvc};
        let (path, lvc, open) = (&settings.path, &settings.lvc, settings.open);
        let integrator = settings.integrator;
        let connecting = integrator.has_candidates().then_some(path);
        let next_event = (integrator != Light).then_some(path);
        let shared = matches!(integrator, Lvc | Auto).then_some(lvc);
        Self {
            integrator: Some(integrator),
            max_depth: Some(path.max_depth.unwrap_or(0)),
            mis: next_event.map(|path| path.mis),
            strategies: connecting.map(|path| path.strategies.clone()),
            path_roulette: Some(Choice::new(open.roulette, path.roulette)),
            light_choice: next_event.map(|path| path.light_choice),
            light_point: connecting.map(|path| path.light_point),
            sampler: Some(settings.sampler),
            seed: Some(settings.seed),
            shadow_rays: connecting.map(|_| Choice::new(open.shadow_rays, settings.shadow_rays)),
            candidates: shared.map(|lvc| Choice::new(open.candidates, lvc.candidates)),
            next_events: shared.map(|lvc| Choice::new(open.next_events, lvc.next_events)),
            proposal: shared.map(|lvc| lvc.proposal),
            light_start: shared.map(|lvc| lvc.light_start),
            samples_per_subpath: (integrator == Lvc).then_some(lvc.samples_per_subpath),
        }
    }

    /// Returns `settings` with what is asked for. Another integrator brings what suits it.
    #[must_use]
    pub fn apply(&self, settings: &Settings) -> Settings {
        let asked = self.clone();
        let mut settings = settings.clone();
        if let Some(integrator) = asked.integrator {
            settings.set_integrator(integrator);
        }
        let own = Settings::new(settings.integrator);
        let (lvc, path, open) = (&mut settings.lvc, &mut settings.path, &mut settings.open);
        let depth = asked.max_depth.map(|depth| (depth > 0).then_some(depth));
        put(&mut settings.sampler, asked.sampler);
        put(&mut settings.seed, asked.seed);
        put(&mut path.max_depth, depth);
        put(&mut path.mis, asked.mis);
        put(&mut path.strategies, asked.strategies);
        put(&mut path.light_choice, asked.light_choice);
        put(&mut path.light_point, asked.light_point);
        put(&mut lvc.proposal, asked.proposal);
        put(&mut lvc.light_start, asked.light_start);
        put(&mut lvc.samples_per_subpath, asked.samples_per_subpath);
        if let Some(rule) = asked.path_roulette {
            (path.roulette, open.roulette) = rule.decide(own.path.roulette, own.integrator);
        }
        if let Some(rule) = asked.shadow_rays {
            (settings.shadow_rays, open.shadow_rays) = rule.decide(own.shadow_rays, own.integrator);
        }
        if let Some(count) = asked.candidates {
            (lvc.candidates, open.candidates) = count.decide(own.lvc.candidates, own.integrator);
        }
        if let Some(count) = asked.next_events {
            (lvc.next_events, open.next_events) = count.decide(own.lvc.next_events, own.integrator);
        }
        settings
    }

    /// Returns these settings, and those of `below` where there is none.
    #[must_use]
    pub fn over(&self, below: &Self) -> Self {
        let mut map = below.map();
        map.extend(self.map());
        from_map(map).unwrap_or_else(|_| unreachable!("both are requests"))
    }

    /// Asks for the setting that is called `name`, with `-` or `_` between words.
    ///
    /// Errors: there is none, or it has no such value.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), RequestError> {
        let mut map = self.map();
        let name = name.replace('-', "_");
        let is_whole = value.bytes().all(|byte| byte.is_ascii_digit());
        let number = value.parse::<u64>().ok().filter(|_| is_whole);
        map.insert(name, number.map_or_else(|| value.into(), Value::from));
        *self = from_map(map).map_err(|error| RequestError(error.to_string()))?;
        Ok(())
    }

    /// Returns the request of [`Self::texts`]; other names are passed over. None: a setting has no such value.
    pub fn read(texts: &BTreeMap<String, String>) -> Option<Self> {
        let mut request = Self::default();
        for name in Self::names() {
            if let Some(value) = texts.get(&name) {
                request.set(&name, value).ok()?;
            }
        }
        Some(request)
    }

    /// Returns the settings that are asked for, as texts by the names of flags.
    pub fn texts(&self) -> BTreeMap<String, String> {
        let map = self.map();
        map.iter().map(|(k, v)| (flag(k), text(v))).collect()
    }

    /// Returns the names of the settings that are asked for and that an image by `settings` does not depend on, as
    /// flags are spelt.
    pub fn ignored(&self, settings: &Settings) -> Vec<String> {
        let used = Self::of(settings).map();
        let mut names = self.map();
        names.retain(|name, _| !used.contains_key(name));
        names.into_iter().map(|(name, _)| flag(&name)).collect()
    }

    /// Returns the names of all settings, as flags are spelt.
    pub fn names() -> impl Iterator<Item = String> {
        fields(&Self::default())
            .into_iter()
            .map(|(name, _)| flag(&name))
    }

    fn map(&self) -> Map<String, Value> {
        let mut map = fields(self);
        map.retain(|_, value| !value.is_null());
        map
    }
}

/// Reads a whole number, or its text.
fn whole<'de, D: Deserializer<'de>, T: FromStr>(from: D) -> Result<Option<T>, D::Error> {
    let number = from.deserialize_any(Parse::<Whole<T>>::default());
    number.map(|Whole(number)| Some(number))
}

struct Whole<T>(T);

impl<T: FromStr> FromStr for Whole<T> {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = text.parse().map(Self);
        number.map_err(|_| "expected a whole number")
    }
}

fn put<T>(setting: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *setting = value;
    }
}

fn fields(request: &Request) -> Map<String, Value> {
    match serde_json::to_value(request) {
        Ok(Value::Object(map)) => map,
        _ => unreachable!("a request is a map of texts and numbers"),
    }
}

fn from_map(map: Map<String, Value>) -> Result<Request, serde_json::Error> {
    serde_json::from_value(Value::Object(map))
}

/// Returns a value as flags are spelt.
pub fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}

/// Returns the name of a field as flags are spelt.
pub fn flag(field: &str) -> String {
    field.replace('_', "-")
}
