//! What `auto` renders with: of a few plans the one with the least product of variance and cost,
//! both of training samples [Veach97, §10.3.2; Grittmann22].
//!
//! Variances count relative to the square of a block's mean m, so that dark corners matter as bright
//! ones do: V / (m² + ε), with m the mean over all plans and ε a hundredth of the square of the image's.

use super::probe::Probe;
use super::trial::{self, BLOCKS, Trial};
use super::{Settings, Training};
use crate::integrator::{BlindSpot, IntegratorKind, SamplesPerSubpath, blind_spots};
use crate::path::{Connections, LightPointChoice, MisHeuristic, PathRoulette};
use crate::scene::Scene;
use crate::select::ShadowRays;
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

const BDPT: Plan = Plan {
    integrator: IntegratorKind::Bdpt,
    roulette: PathRoulette::Albedo { start: 0 },
    samples_per_subpath: SamplesPerSubpath::power_of_two(0),
};

const fn lvc(exponent: u32) -> Plan {
    Plan {
        integrator: IntegratorKind::Lvc,
        roulette: PathRoulette::Albedo { start: 0 },
        samples_per_subpath: SamplesPerSubpath::power_of_two(exponent),
    }
}

/// Path tracing with the roulette of those that have light images.
const ALIKE: Plan = path(0);

/// All plans.
const PLANS: [Plan; 7] = [ALIKE, path(1), path(2), BDPT, lvc(0), lvc(1), lvc(2)];

impl Default for Plan {
    /// What training is done for.
    fn default() -> Self {
        lvc(1)
    }
}

impl Plan {
    /// `settings` with this plan; a roulette and a choice of shadow rays that they name stay.
    pub(super) fn apply(&self, settings: &Settings) -> Settings {
        let mut settings = settings.clone();
        settings.integrator = self.integrator;
        settings.lvc.samples_per_subpath = self.samples_per_subpath;
        if settings.path.roulette == PathRoulette::Suited {
            settings.path.roulette = self.roulette;
        }
        if settings.shadow_rays == ShadowRays::Suited {
            settings.shadow_rays = self.integrator.shadow_rays();
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
        self.integrator != IntegratorKind::Path
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
            pixels: trial::PIXELS,
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

/// The product of variance and cost of each, relative to those of others.
fn products(pixels: f64, mis: MisHeuristic, tried: &[Tried]) -> Vec<f64> {
    let scale = Scale::new(pixels, tried);
    let missed = Missed::new(&scale, mis, tried);
    let product = |(plan, trial): &Tried| {
        let found = scale.sum(|i| trial.variance(i, pixels));
        let missed = if plan.has_light_images() {
            0.0
        } else {
            missed.beside(found)
        };
        (found + missed) * trial.cost(plan.integrator)
    };
    tried.iter().map(product).collect()
}

/// What variances are relative to.
struct Scale {
    pixels: f64,
    /// The mean of a pixel of each block, by all plans.
    means: Vec<f64>,
    /// ε.
    least: f64,
}

impl Scale {
    fn new(pixels: f64, tried: &[Tried]) -> Self {
        let mean = |i| {
            let means = tried.iter().map(|(_, trial)| trial.mean(i, pixels));
            means.sum::<f64>() / tried.len() as f64
        };
        let means: Vec<f64> = (0..BLOCKS).map(mean).collect();
        let whole = means.iter().sum::<f64>() / BLOCKS as f64;
        let least = 0.01 * whole * whole + f64::MIN_POSITIVE;
        Self {
            pixels,
            means,
            least,
        }
    }

    /// The sum over the blocks of what `variance` tells of each.
    fn sum(&self, variance: impl Fn(usize) -> f64) -> f64 {
        let relative = |(i, mean): (usize, &f64)| variance(i) / (mean * mean + self.least);
        self.means.iter().enumerate().map(relative).sum()
    }
}

/// The variance of path tracing that its samples missed and light images tell of.
///
/// What they tell is a bound where walks end as theirs do ([`ALIKE`]). The part of it that the samples
/// of that plan missed is missing in all path tracing.
#[derive(Default)]
struct Missed {
    /// Of [`ALIKE`].
    missed: f64,
    /// What its samples found.
    found: f64,
}

impl Missed {
    fn new(scale: &Scale, mis: MisHeuristic, tried: &[Tried]) -> Self {
        let is_told = |plan: &Plan| mis == MisHeuristic::Balance && plan.has_light_images();
        let with_light = tried.iter().filter(|(plan, _)| is_told(plan));
        let hidden = with_light
            .map(|(_, trial)| scale.sum(|i| trial.hidden_spread(i, scale.pixels, scale.means[i])));
        // The least of several says less than it should rather than more.
        let hidden = hidden.reduce(f64::min).unwrap_or(0.0);
        let alike = tried.iter().find(|(plan, _)| *plan == ALIKE);
        let of_alike = |(_, trial): &Tried| Self {
            missed: (hidden - scale.sum(|i| trial.spread(i, scale.pixels))).max(0.0),
            found: scale.sum(|i| trial.variance(i, scale.pixels)),
        };
        alike.map(of_alike).unwrap_or_default()
    }

    /// That of a plan whose samples found so much.
    fn beside(&self, found: f64) -> f64 {
        if self.found > 0.0 {
            self.missed * found / self.found
        } else {
            self.missed
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Path tracing that found next to nothing, and bidirectional path tracing with these light images.
    fn chosen(splats: &[[f64; 2]]) -> Plan {
        let tried = [
            (ALIKE, Trial::of(&[[1.0, 1.1]], &[])),
            (path(1), Trial::of(&[[1.0, 1.1]], &[])),
            (BDPT, Trial::of(&[[0.0, 2.0]], splats)),
        ];
        best(BLOCKS as u64, MisHeuristic::Balance, &tried)
    }

    #[test]
    fn what_light_images_tell_counts_against_path_tracing() {
        assert_eq!(chosen(&[]), ALIKE);
        // Light images of what path tracing makes as often do not.
        assert_eq!(chosen(&[[0.1, 0.5]; 4]), ALIKE);
        assert_eq!(chosen(&[[1.0, 0.999]; 4]), BDPT);
    }

    #[test]
    fn nothing_to_see_is_traced_from_the_camera() {
        let tried = PLANS.map(|plan| (plan, Trial::of(&[[0.0; 2]], &[])));
        assert_eq!(best(1, MisHeuristic::Balance, &tried), ALIKE);
    }
}
