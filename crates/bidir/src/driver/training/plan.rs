//! The plans of `auto`, and the choice among them: the plan with the least product of variance and cost, both
//! estimated from the survey (docs/derivations/choosing-a-plan.md).

use super::known::Judge;
use super::moments::Judgement;
use super::survey::Survey;
use super::{Settings, TrainingInput};
use crate::analysis::{BlindSpot, blind_spots};
use crate::guide::Cells;
use crate::integrator::{CandidateCount, IntegratorKind, SamplesPerSubpath};
use crate::path::{LightPointChoice, PathRoulette};
use crate::select::ShadowRays;
use std::fmt;

#[cfg(test)]
mod tests;

/// The estimator that `auto` renders with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The estimator.
    pub integrator: IntegratorKind,
    /// The roulette of walks.
    pub roulette: PathRoulette,
    /// The number of samples for each light subpath, if the estimator is `lvc`.
    pub samples_per_subpath: SamplesPerSubpath,
    /// The number of candidates of each camera vertex, likewise.
    pub candidates: CandidateCount,
    /// The number of light points of each camera vertex, likewise.
    pub next_events: CandidateCount,
    /// The rule that chooses the connections to trace.
    pub shadow_rays: ShadowRays,
}

/// Path tracing whose roulette begins at the third surface.
pub(super) const PATH: Plan = Plan {
    integrator: IntegratorKind::Path,
    roulette: PathRoulette::Albedo { start: 2 },
    samples_per_subpath: SamplesPerSubpath::power_of_two(0),
    candidates: CandidateCount::DEFAULT,
    next_events: CandidateCount::NEXT_EVENTS,
    shadow_rays: ShadowRays::All,
};

/// Path tracing whose roulette begins at the second surface: between bright surfaces its walks are shorter.
pub(super) const SHORT_PATH: Plan = Plan {
    roulette: PathRoulette::Albedo { start: 1 },
    ..PATH
};

pub(super) const BDPT: Plan = Plan {
    integrator: IntegratorKind::Bdpt,
    roulette: PathRoulette::Albedo { start: 0 },
    ..PATH
};

pub(super) const LVC: Plan = Plan {
    integrator: IntegratorKind::Lvc,
    samples_per_subpath: SamplesPerSubpath::power_of_two(1),
    shadow_rays: ShadowRays::Budget(6),
    ..BDPT
};

/// Returns `lvc` with these numbers of candidates and light points at the first vertex, and of shadow rays.
pub(super) const fn lvc_of(candidates: u16, light_points: u16, rays: u32) -> Plan {
    Plan {
        candidates: CandidateCount::new(candidates, 1),
        next_events: CandidateCount::new(light_points, 1),
        shadow_rays: ShadowRays::Budget(rays),
        ..LVC
    }
}

/// Returns `settings` with a typical plan of `lvc`; training with any other would learn much the same.
pub(super) fn typical(settings: &Settings) -> Settings {
    lvc_of(24, 2, 6).keeping(settings).apply(settings)
}

/// The plans that `auto` compares. Plans that differ only in their shadow rays follow each other.
pub(super) const PLANS: [Plan; 15] = [
    PATH,
    SHORT_PATH,
    BDPT,
    LVC,
    lvc_of(24, 2, 6),
    lvc_of(24, 2, 9),
    lvc_of(24, 2, 12),
    lvc_of(24, 4, 6),
    lvc_of(24, 4, 9),
    lvc_of(24, 8, 6),
    lvc_of(24, 8, 12),
    lvc_of(36, 2, 12),
    lvc_of(36, 4, 12),
    lvc_of(48, 2, 18),
    lvc_of(48, 4, 18),
];

impl Plan {
    /// Returns the plan with the least product of variance and cost. If the survey found no light, it is `lvc`, which
    /// makes the most paths, or `path` if the scene has no lights.
    pub(super) fn best(input: TrainingInput<'_>, survey: &Survey, cells: &Cells) -> Self {
        let settings = input.settings;
        let Some(terms) = survey.relative_terms(input.view.film()) else {
            let has_lights = !input.scene.lights().is_empty();
            return if has_lights { LVC } else { PATH }.keeping(settings);
        };
        let judge = Judge::new(input, &typical(settings), survey, cells);
        let (mut best, mut least) = (LVC.keeping(settings), f64::INFINITY);
        let mut judged: Option<(Self, Judgement)> = None;
        for plan in PLANS.map(|plan| plan.keeping(settings)) {
            let applied = plan.apply(settings);
            // A judgement serves all plans that differ only in their shadow rays, which follow each other.
            let draws = Self {
                shadow_rays: ShadowRays::All,
                ..plan
            };
            let (_, judgement) = judged
                .take_if(|(judged, _)| *judged == draws)
                .unwrap_or_else(|| (draws, judge.judge(&applied, &terms)));
            let variance = judgement.variance(plan.shadow_rays).mean();
            let product = variance * survey.cost(&applied, &judge.counts(&applied));
            if product < least && plan.is_possible(input) {
                (best, least) = (plan, product);
            }
            judged = Some((draws, judgement));
        }
        best
    }

    /// Returns the plan with the values of all settings that are not left open.
    pub(super) fn keeping(mut self, settings: &Settings) -> Self {
        if !settings.open.roulette {
            self.roulette = settings.path.roulette;
        }
        if !settings.open.shadow_rays {
            self.shadow_rays = settings.shadow_rays;
        }
        if !settings.open.candidates {
            self.candidates = settings.lvc.candidates;
        }
        if !settings.open.next_events {
            self.next_events = settings.lvc.next_events;
        }
        self
    }

    /// Returns `settings` with this plan.
    pub(super) fn apply(&self, settings: &Settings) -> Settings {
        let mut settings = settings.clone();
        settings.set_integrator(self.integrator);
        settings.path.roulette = self.roulette;
        settings.shadow_rays = self.shadow_rays;
        settings.lvc.samples_per_subpath = self.samples_per_subpath;
        settings.lvc.candidates = self.candidates;
        settings.lvc.next_events = self.next_events;
        settings
    }

    /// Returns true if the plan makes all light paths that the settings ask for, and misses none that `lvc` finds.
    fn is_possible(&self, input: TrainingInput<'_>) -> bool {
        let path = &input.settings.path;
        let missing = |integrator| {
            let spots = blind_spots(input.scene, input.view, integrator).into_iter();
            spots.filter(|spot: &BlindSpot| spot.is_missing())
        };
        let of_lvc: Vec<_> = missing(IntegratorKind::Lvc).collect();
        let is_whole = path.strategies.is_all() && path.light_point == LightPointChoice::Fresh;
        self.integrator != IntegratorKind::Path
            || is_whole && missing(self.integrator).all(|spot| of_lvc.contains(&spot))
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.integrator, self.roulette)?;
        if self.integrator != IntegratorKind::Lvc {
            return Ok(());
        }
        if self.samples_per_subpath.get() > 1 {
            let count = self.samples_per_subpath;
            write!(f, ", {count} samples for each light subpath")?;
        }
        write!(f, ", {} candidates", self.candidates)?;
        if self.next_events != CandidateCount::NEXT_EVENTS {
            write!(f, ", {} next events", self.next_events)?;
        }
        write!(f, ", {}", self.shadow_rays)
    }
}
