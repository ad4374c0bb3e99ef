//! What a method wants otherwise than the scene: settings under the names of the flags of
//! `bidir render`, with the values that these take.

use super::names::nearest;
use bidir::driver::Settings;
use bidir::integrator::{
    CandidateCount, Candidates, EmissionKind, IntegratorKind, ProposalKind, SamplesPerSubpath,
};
use bidir::path::{
    LightChoiceKind, LightPointChoice, MisCount, MisHeuristic, PathRoulette, Strategies,
};
use bidir::sampler::SamplerKind;
use bidir::select::ShadowRays;
use formats::film::{SettingsText, has_influence, name_of};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::str::FromStr;

/// Settings that differ from the scene's; None leaves the scene's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// The estimator.
    pub integrator: Option<IntegratorKind>,
    /// Which connections are traced.
    pub shadow_rays: Option<ShadowRays>,
    /// The cached light vertices that are candidates for each camera vertex.
    pub candidates: Option<Candidates>,
    /// How many light points are drawn for each camera vertex.
    pub next_events: Option<CandidateCount>,
    /// How cached light vertices are chosen.
    pub proposal: Option<ProposalKind>,
    /// How light subpaths choose the light that they begin on.
    pub emission: Option<EmissionKind>,
    /// How many samples bring one light subpath to the cache.
    pub samples_per_subpath: Option<SamplesPerSubpath>,
    /// What weights take for the number of samples of a strategy whose light subpaths are shared.
    pub mis_count: Option<MisCount>,
    /// How strategies share paths.
    pub mis: Option<MisHeuristic>,
    /// The strategies that take part.
    pub strategies: Option<Strategies>,
    /// Where next-event estimation takes its light point from.
    pub light_point: Option<LightPointChoice>,
    /// How it chooses the light.
    pub light_choice: Option<LightChoiceKind>,
    /// How subpaths end by chance.
    pub path_roulette: Option<PathRoulette>,
    /// The random numbers.
    pub sampler: Option<SamplerKind>,
    /// The most bounces of a path; 0 is no limit.
    pub max_depth: Option<u32>,
}

impl Changes {
    /// The names of all settings.
    pub const NAMES: [&'static str; 15] = [
        "integrator",
        "shadow-rays",
        "candidates",
        "next-events",
        "proposal",
        "light-start",
        "samples-per-subpath",
        "mis-count",
        "mis",
        "strategies",
        "light-point",
        "light-choice",
        "path-roulette",
        "sampler",
        "max-depth",
    ];

    /// Changes the setting that is called `name`, one of [`Self::NAMES`].
    ///
    /// Errors: what is wrong with the value, in words.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "integrator" => self.integrator = Some(named(&IntegratorKind::NAMES, value)?),
            "shadow-rays" => self.shadow_rays = Some(parsed(value)?),
            "candidates" => self.candidates = Some(parsed(value)?),
            "next-events" => self.next_events = Some(parsed(value)?),
            "samples-per-subpath" => self.samples_per_subpath = Some(parsed(value)?),
            "proposal" => self.proposal = Some(named(&ProposalKind::NAMES, value)?),
            // The latter is the older name.
            "light-start" | "emission" => self.emission = Some(named(&EmissionKind::NAMES, value)?),
            "mis-count" => self.mis_count = Some(named(&MisCount::NAMES, value)?),
            "mis" => self.mis = Some(named(&MisHeuristic::NAMES, value)?),
            "strategies" => self.strategies = Some(parsed(value)?),
            "light-point" => self.light_point = Some(named(&LightPointChoice::NAMES, value)?),
            "light-choice" => self.light_choice = Some(named(&LightChoiceKind::NAMES, value)?),
            "path-roulette" => self.path_roulette = Some(parsed(value)?),
            "sampler" => self.sampler = Some(named(&SamplerKind::NAMES, value)?),
            "max-depth" => {
                let depth = value.parse().map_err(|_| "expected a whole number")?;
                self.max_depth = Some(depth);
            }
            _ => return Err(format!("there is no setting `{name}`")),
        }
        Ok(())
    }

    /// These changes, and `defaults` where there is none.
    #[must_use]
    pub fn or(self, defaults: &Self) -> Self {
        Self {
            integrator: self.integrator.or(defaults.integrator),
            shadow_rays: self.shadow_rays.or(defaults.shadow_rays),
            candidates: self.candidates.or(defaults.candidates),
            next_events: self.next_events.or(defaults.next_events),
            proposal: self.proposal.or(defaults.proposal),
            emission: self.emission.or(defaults.emission),
            samples_per_subpath: self.samples_per_subpath.or(defaults.samples_per_subpath),
            mis_count: self.mis_count.or(defaults.mis_count),
            mis: self.mis.or(defaults.mis),
            strategies: self.strategies.or_else(|| defaults.strategies.clone()),
            light_point: self.light_point.or(defaults.light_point),
            light_choice: self.light_choice.or(defaults.light_choice),
            path_roulette: self.path_roulette.or(defaults.path_roulette),
            sampler: self.sampler.or(defaults.sampler),
            max_depth: self.max_depth.or(defaults.max_depth),
        }
    }

    /// The first setting here without effect on `integrator`.
    pub(super) fn without_effect(&self, integrator: IntegratorKind) -> Option<&'static str> {
        let given = [
            ("shadow-rays", self.shadow_rays.is_some()),
            ("candidates", self.candidates.is_some()),
            ("next-events", self.next_events.is_some()),
            ("proposal", self.proposal.is_some()),
            ("light-start", self.emission.is_some()),
            ("samples-per-subpath", self.samples_per_subpath.is_some()),
            ("mis-count", self.mis_count.is_some()),
            ("mis", self.mis.is_some()),
            ("strategies", self.strategies.is_some()),
            ("light-point", self.light_point.is_some()),
            ("light-choice", self.light_choice.is_some()),
        ];
        let given = given.into_iter().filter(|(_, is_given)| *is_given);
        let mut names = given.map(|(name, _)| name);
        names.find(|name| !has_influence(name, integrator))
    }

    /// The settings of a scene with these changes.
    pub fn apply(&self, scene: &Settings) -> Settings {
        let mut settings = scene.clone();
        // Another integrator brings what suits it.
        if let Some(integrator) = self.integrator {
            settings.set_integrator(integrator);
        }
        let lvc = &mut settings.lvc;
        lvc.candidates = self.candidates.unwrap_or(lvc.candidates);
        lvc.next_events = self.next_events.unwrap_or(lvc.next_events);
        lvc.proposal = self.proposal.unwrap_or(lvc.proposal);
        lvc.emission = self.emission.unwrap_or(lvc.emission);
        lvc.samples_per_subpath = self.samples_per_subpath.unwrap_or(lvc.samples_per_subpath);
        lvc.mis_count = self.mis_count.unwrap_or(lvc.mis_count);
        let path = &mut settings.path;
        path.mis = self.mis.unwrap_or(path.mis);
        path.light_point = self.light_point.unwrap_or(path.light_point);
        path.light_choice = self.light_choice.unwrap_or(path.light_choice);
        path.roulette = self.path_roulette.unwrap_or(path.roulette);
        if let Some(depth) = self.max_depth {
            path.max_depth = (depth > 0).then_some(depth);
        }
        if let Some(strategies) = &self.strategies {
            path.strategies = strategies.clone();
        }
        settings.shadow_rays = self.shadow_rays.unwrap_or(settings.shadow_rays);
        settings.sampler = self.sampler.unwrap_or(settings.sampler);
        settings
    }
}

/// The message for a setting without effect on an integrator.
pub(super) fn no_effect(name: &str, integrator: IntegratorKind) -> String {
    let integrator = name_of(&IntegratorKind::NAMES, integrator);
    format!("`{name}` has no effect on the integrator `{integrator}`")
}

/// All settings but the seed, by the names of [`Changes::NAMES`] and as [`Changes::set`] takes them.
pub fn texts(settings: &Settings) -> BTreeMap<String, String> {
    let mut texts = SettingsText::from(settings).by_flag();
    texts.retain(|name, _| Changes::NAMES.contains(&name.as_str()));
    if settings.path.max_depth.is_none() {
        texts.insert("max-depth".to_owned(), "0".to_owned());
    }
    texts
}

/// The value that a table of the library has under a name.
pub(super) fn named<T: Copy>(
    names: &'static [(&'static str, T)],
    given: &str,
) -> Result<T, String> {
    let found = names.iter().find(|(name, _)| *name == given);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let known = names.iter().map(|(name, _)| *name);
        let hint = nearest(given, known.clone()).map_or_else(
            || format!("expected {}", known.collect::<Vec<_>>().join(", ")),
            |near| format!("did you mean `{near}`?"),
        );
        format!("there is no `{given}`: {hint}")
    })
}

fn parsed<T: FromStr<Err: Display>>(value: &str) -> Result<T, String> {
    value.parse().map_err(|error: T::Err| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read_as_they_are_written() {
        let mut changes = Changes::default();
        let values = [
            "light",
            "per-pair",
            "9,2",
            "3,1",
            "uniform",
            "power",
            "4",
            "correlated",
            "uniform",
            "all,-s0",
            "shared",
            "power",
            "off",
            "sobol",
            "7",
        ];
        for (name, value) in Changes::NAMES.into_iter().zip(values) {
            changes.set(name, value).unwrap();
        }
        let settings = changes.apply(&Settings::default());
        let written = texts(&settings);
        for (name, value) in Changes::NAMES.into_iter().zip(values) {
            assert_eq!(written[name], value);
        }
        assert_eq!(Changes::default().or(&changes), changes);
        assert_eq!(texts(&Changes::default().apply(&settings)), written);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let mut changes = Changes::default();
        let mut wrong = |name, value| changes.set(name, value).unwrap_err();
        assert_eq!(
            wrong("mis", "balence"),
            "there is no `balence`: did you mean `balance`?"
        );
        assert_eq!(
            wrong("light-point", "x"),
            "there is no `x`: expected fresh, shared"
        );
        assert!(wrong("strategies", "s").contains("is not a strategy"));
        assert_eq!(wrong("max-depth", "-1"), "expected a whole number");
        assert!(wrong("candidates", "0").contains("from 1 to 4096"));
    }
}
