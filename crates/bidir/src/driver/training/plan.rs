//! What `auto` may render with, and how each is tried.

use super::effort::Late;
use super::probe::Probe;
use super::trial::{self, Trial};
use super::{Settings, Task, Training};
use crate::integrator::{
    BlindSpot, CandidateCount, IntegratorKind, SamplesPerSubpath, blind_spots,
};
use crate::path::{Connections, LightPointChoice, PathRoulette};
use crate::scene::Scene;
use crate::select::ShadowRays;
use crate::view::View;
use std::fmt;

#[cfg(test)]
mod tests;

/// What is rendered with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The estimator.
    pub integrator: IntegratorKind,
    /// How walks end at random.
    pub roulette: PathRoulette,
    /// How many samples there are for a light subpath, where these are shared.
    pub samples_per_subpath: SamplesPerSubpath,
    /// How many candidates camera vertices have there.
    pub candidates: CandidateCount,
    /// Which connections are traced.
    pub shadow_rays: ShadowRays,
}

pub(super) const fn path(start: u32) -> Plan {
    Plan {
        integrator: IntegratorKind::Path,
        roulette: PathRoulette::Albedo { start },
        samples_per_subpath: SamplesPerSubpath::power_of_two(0),
        candidates: CandidateCount::DEFAULT,
        shadow_rays: ShadowRays::All,
    }
}

pub(super) const BDPT: Plan = Plan {
    integrator: IntegratorKind::Bdpt,
    roulette: PathRoulette::Albedo { start: 0 },
    ..path(0)
};

/// With 2^`exponent` samples for a light subpath, and `rays` of a sample's candidates traced.
const fn lvc(exponent: u32, candidates: CandidateCount, rays: u32) -> Plan {
    Plan {
        integrator: IntegratorKind::Lvc,
        roulette: PathRoulette::Albedo { start: 0 },
        samples_per_subpath: SamplesPerSubpath::power_of_two(exponent),
        candidates,
        shadow_rays: ShadowRays::Budget(rays),
    }
}

/// What [`IntegratorKind::Lvc`] does where nothing else is said.
pub(super) const LVC: Plan = lvc(1, CandidateCount::DEFAULT, 6);
/// More connections, where the light is found by many bounces or through gaps.
pub(super) const MANY: Plan = lvc(1, CandidateCount::new(20, 3), 8);
/// The most of them, of as many light subpaths as there are samples.
const MOST: Plan = lvc(0, CandidateCount::new(24, 4), 10);

/// All plans.
pub(super) const PLANS: [Plan; 8] = [
    path(0),
    path(1),
    path(2),
    BDPT,
    lvc(2, CandidateCount::DEFAULT, 6),
    LVC,
    MANY,
    MOST,
];

impl Default for Plan {
    /// What training is done for.
    fn default() -> Self {
        LVC
    }
}

impl Plan {
    /// The same but for the settings that are not left open.
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
        self
    }

    /// `settings` with this plan.
    pub(super) fn apply(&self, settings: &Settings) -> Settings {
        let mut settings = settings.clone();
        settings.set_integrator(self.integrator);
        settings.path.roulette = self.roulette;
        settings.shadow_rays = self.shadow_rays;
        settings.lvc.samples_per_subpath = self.samples_per_subpath;
        settings.lvc.candidates = self.candidates;
        settings
    }

    /// How many connections a camera vertex makes.
    fn connections<'a>(&self, settings: &Settings, training: &'a Training) -> Connections<'a> {
        if !self.is_shared() {
            return Connections::ONE_SUBPATH;
        }
        Connections {
            samples_per_subpath: f64::from(self.samples_per_subpath.get()),
            ..training.connections(settings.lvc)
        }
    }

    /// True where samples share light subpaths.
    pub(super) fn is_shared(&self) -> bool {
        self.integrator == IntegratorKind::Lvc
    }

    /// True where light subpaths are connected to the lens.
    pub(super) fn has_light_images(&self) -> bool {
        self.integrator != IntegratorKind::Path
    }

    /// True where it makes all light paths that the settings ask for, and misses none that another
    /// plan finds.
    fn is_possible(&self, scene: &Scene, view: &View, settings: &Settings) -> bool {
        let missing = |integrator| {
            let spots = blind_spots(scene, view, integrator).into_iter();
            spots
                .filter(|spot| spot.is_missing())
                .collect::<Vec<BlindSpot>>()
        };
        let of_lvc = missing(IntegratorKind::Lvc);
        self.has_light_images()
            || settings.path.strategies.is_all()
                && settings.path.light_point == LightPointChoice::Fresh
                && missing(self.integrator)
                    .iter()
                    .all(|spot| of_lvc.contains(spot))
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.integrator, self.roulette)?;
        if !self.is_shared() {
            return Ok(());
        }
        if self.samples_per_subpath.get() > 1 {
            let count = self.samples_per_subpath;
            write!(f, ", {count} samples for each light subpath")?;
        }
        write!(f, ", {} candidates, {}", self.candidates, self.shadow_rays)
    }
}

/// A plan with what its samples found.
pub(super) type Tried = (Plan, Trial);

/// All plans that `settings` leave open, each once.
fn open_plans(settings: &Settings) -> Vec<Plan> {
    let mut plans = Vec::with_capacity(PLANS.len());
    for plan in PLANS.map(|plan| plan.keeping(settings)) {
        if !plans.contains(&plan) {
            plans.push(plan);
        }
    }
    plans
}

/// As many samples of an [`Extent`](super::extent::Extent) are for a pixel that plans are tried with at first.
const SAMPLES_PER_PIXEL: u64 = 4;
/// So many times the pixels are tried the next time, where several plans may be the best.
const MORE: u64 = 3;

/// Where plans are tried.
pub(super) struct Trials<'a> {
    pub(super) task: Task<'a>,
    pub(super) training: &'a Training,
}

impl Trials<'_> {
    /// Tries the plans that are possible.
    pub(super) fn run(&self) -> Result<Vec<Tried>, Late> {
        let Task {
            scene, settings, ..
        } = self.task;
        let mut plans = open_plans(settings);
        plans.retain(|plan| plan.is_possible(scene, self.task.view, settings));
        let attempt = |plan| Ok((plan, self.attempt(&plan, 0, self.pixels())?));
        plans.into_iter().map(attempt).collect()
    }

    /// Tries those of `plans` with more samples.
    pub(super) fn run_more(&self, plans: &[Plan], tried: &mut [Tried]) -> Result<(), Late> {
        for (plan, trial) in tried {
            if plans.contains(plan) {
                let first = trial::THIRDS * self.pixels();
                trial.add(self.attempt(plan, first, MORE * self.pixels())?);
            }
        }
        Ok(())
    }

    /// The pixels that each plan is tried with at first.
    fn pixels(&self) -> u64 {
        self.training.trials.samples() / SAMPLES_PER_PIXEL
    }

    /// Tries `plan` with so many pixels; there were `first` samples before.
    fn attempt(&self, plan: &Plan, first: u64, pixels: u64) -> Result<Trial, Late> {
        let settings = plan.apply(self.task.settings);
        let probe = Probe {
            scene: self.task.scene,
            view: self.task.view,
            settings: &settings,
            is_late: self.task.is_late,
            connections: plan.connections(&settings, self.training),
            extent: self.training.trials,
            first: self.training.samples + first,
            pixels,
        };
        Trial::run(&probe, self.training.mean_luminance)
    }
}
