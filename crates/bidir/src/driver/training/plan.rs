//! What `auto` renders with: of a few plans the one with the least product of variance and cost,
//! both of training samples [Veach97, §10.3.2; Grittmann22].
//!
//! Variances count relative to the square of a block's mean m, so that dark corners matter as bright
//! ones do: V / (m² + ε), with m the mean over all plans and ε a hundredth of the square of the image's.

use super::probe::Probe;
use super::trial::{BLOCKS, Trial};
use super::{Settings, Training};
use crate::integrator::{BlindSpot, IntegratorKind, SamplesPerSubpath, blind_spots};
use crate::path::{Connections, LightPointChoice, MisHeuristic, PathRoulette};
use crate::scene::Scene;
use std::fmt;

/// What is rendered with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The estimator.
    pub integrator: IntegratorKind,
    /// How walks end at random.
    pub roulette: PathRoulette,
    /// How many samples there are for a light subpath, where these are shared.
    pub samples_per_subpath: SamplesPerSubpath,
}

const fn path(start: u32) -> Plan {
    Plan {
        integrator: IntegratorKind::Path,
        roulette: PathRoulette::Albedo { start },
        samples_per_subpath: SamplesPerSubpath::power_of_two(0),
    }
}

const fn lvc(exponent: u32) -> Plan {
    Plan {
        integrator: IntegratorKind::Lvc,
        roulette: PathRoulette::Albedo { start: 0 },
        samples_per_subpath: SamplesPerSubpath::power_of_two(exponent),
    }
}

/// All plans.
const PLANS: [Plan; 5] = [path(1), path(2), lvc(0), lvc(1), lvc(2)];

impl Default for Plan {
    /// What training is done for.
    fn default() -> Self {
        lvc(1)
    }
}

impl Plan {
    /// `settings` with this plan; a roulette that they name stays.
    pub(super) fn apply(&self, settings: &Settings) -> Settings {
        let mut settings = settings.clone();
        settings.integrator = self.integrator;
        settings.lvc.samples_per_subpath = self.samples_per_subpath;
        if settings.path.roulette == PathRoulette::Suited {
            settings.path.roulette = self.roulette;
        }
        settings
    }

    /// How many connections a camera vertex makes.
    fn connections<'a>(&self, settings: &Settings, training: &'a Training) -> Connections<'a> {
        match self.integrator {
            IntegratorKind::Lvc => Connections {
                samples_per_subpath: f64::from(self.samples_per_subpath.get()),
                ..training.connections(settings.lvc)
            },
            _ => Connections::ONE_SUBPATH,
        }
    }

    /// True where light subpaths are connected to the lens.
    fn has_light_images(&self) -> bool {
        self.integrator == IntegratorKind::Lvc
    }

    /// True where it makes all light paths that the settings ask for, and misses none that another
    /// plan finds.
    fn is_possible(&self, scene: &Scene, settings: &Settings) -> bool {
        let missing = |integrator| {
            let spots = blind_spots(scene, integrator).into_iter();
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
        let mut names = IntegratorKind::NAMES.iter();
        let name = names.find(|(_, kind)| *kind == self.integrator);
        write!(
            f,
            "{}, {}",
            name.map_or("", |(name, _)| name),
            self.roulette
        )?;
        match (self.integrator, self.samples_per_subpath.get()) {
            (IntegratorKind::Lvc, count) if count > 1 => {
                write!(f, ", {count} samples for each light subpath")
            }
            _ => Ok(()),
        }
    }
}

/// A plan with what its samples found.
pub(super) type Tried = (Plan, Trial);

/// Tries the plans that are possible, with samples from number `first` on.
pub(super) fn try_all(
    scene: &Scene,
    settings: &Settings,
    training: &Training,
    first: u64,
) -> Vec<Tried> {
    let possible = PLANS.into_iter();
    let possible = possible.filter(|plan| plan.is_possible(scene, settings));
    let attempt = |plan: Plan| {
        let settings = plan.apply(settings);
        let probe = Probe {
            scene,
            settings: &settings,
            connections: plan.connections(&settings, training),
            first,
        };
        (plan, Trial::run(&probe, training.mean_luminance))
    };
    possible.map(attempt).collect()
}

/// The best of the plans that were tried, under a heuristic, on a film of `pixels`.
pub(super) fn best(pixels: u64, mis: MisHeuristic, tried: &[Tried]) -> Plan {
    let products = products(pixels as f64, mis, tried);
    let plans = tried.iter().map(|(plan, _)| *plan).zip(products);
    let best = plans.min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or_else(Plan::default, |(plan, _)| plan)
}

/// The product of variance and cost of each, relative to those of others. Path tracing has at least the
/// variance that the light images of others tell of.
fn products(pixels: f64, mis: MisHeuristic, tried: &[Tried]) -> Vec<f64> {
    let means: Vec<_> = (0..BLOCKS).map(|i| mean(i, pixels, tried)).collect();
    let whole = means.iter().sum::<f64>() / BLOCKS as f64;
    let least = 0.01 * whole * whole + f64::MIN_POSITIVE;
    let sum = |variance: &dyn Fn(usize) -> f64| -> f64 {
        let relative = |i: usize| variance(i) / (means[i] * means[i] + least);
        (0..BLOCKS).map(relative).sum()
    };
    let hidden = |trial: &Trial| sum(&|i| trial.hidden_variance(i, pixels, means[i]));
    let is_told = |plan: &Plan| mis == MisHeuristic::Balance && plan.has_light_images();
    let with_light = tried.iter().filter(|(plan, _)| is_told(plan));
    let hidden: Vec<_> = with_light.map(|(_, trial)| hidden(trial)).collect();
    let hidden = hidden.iter().sum::<f64>() / hidden.len().max(1) as f64;
    let product = |(plan, trial): &Tried| {
        let found = sum(&|i| trial.variance(i, pixels));
        let variance = if plan.has_light_images() {
            found
        } else {
            found.max(hidden)
        };
        variance * trial.cost(plan.integrator)
    };
    tried.iter().map(product).collect()
}

/// The mean of a pixel of block number `i`, by all plans.
fn mean(i: usize, pixels: f64, tried: &[Tried]) -> f64 {
    let means = tried.iter().map(|(_, trial)| trial.mean(i, pixels));
    means.sum::<f64>() / tried.len() as f64
}
