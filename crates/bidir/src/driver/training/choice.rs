//! The best plan: the one with the least product of variance and cost, both of training samples
//! [Veach97, §10.3.2; Grittmann22] (docs/derivations/choosing-a-plan.md).
//!
//! Variances count relative to the square of a block's mean m, so that dark corners matter as bright
//! ones do: V / (m² + ε), with m the mean over all plans and ε a hundredth of the square of the image's.
//! What neighbouring pixels have in common by shared light subpaths is not in V, and trials have noise: of
//! plans that are nearly as good, one is taken without them, and one whose walks do not end at once.
//!
//! What is close is tried again with more samples, and the largest light image of each plan is left out, as
//! few samples mistake what is bright and rare.
//!
//! Plans that share light subpaths are compared among themselves by the first samples, of which all have as
//! many, and where points are of a sequence by what varies behind the camera rays: what a pixel varies by is
//! the same with all of them, and the sequence evens it out.

use super::Settings;
use super::blocks::{BLOCKS, Blocks};
use super::plan::{Plan, Tried};
use super::trial::Trial;
use crate::integrator::IntegratorKind;
use crate::path::{MisHeuristic, PathRoulette};
use crate::sampler::SamplerKind;

#[cfg(test)]
mod tests;

/// By so much shared light subpaths have to be better, as the noise of neighbours is alike.
const COMMON_NOISE: f64 = 1.1;

/// By so much path tracing whose walks may end at their first vertex has to be better: of 38 scenes it is
/// in five, and points of a sequence even out less of it than of others.
const EARLY_END: f64 = 1.2;

/// A plan that finds less than this part of what is there varies by what it has not found yet: what its
/// samples tell of its variance is next to nothing.
const LEAST_FOUND: f64 = 1.0 / 16.0;

/// What is by so much behind the best may yet be better: variances of some thousand samples are too small
/// where bright ones are rare.
const NEAR: f64 = 1.5;

/// The plans that were tried with some settings on a film, as they are compared.
pub(super) struct Judge<'a> {
    tried: &'a [Tried],
    scale: Scale<'a>,
    missed: Missed,
    is_even: bool,
}

impl<'a> Judge<'a> {
    pub(super) fn new(blocks: &'a Blocks, settings: &Settings, tried: &'a [Tried]) -> Self {
        let scale = Scale::new(blocks, tried);
        Self {
            missed: Missed::new(&scale, settings, tried),
            scale,
            tried,
            is_even: settings.sampler == SamplerKind::Sobol,
        }
    }

    /// The plans of which more samples are to tell which is the best; none where it is plain.
    ///
    /// Of those that share light subpaths the best alone: they have most of their noise in common, and few
    /// samples compare them. Path tracing with each roulette, or with none: what light images tell is of one
    /// of them, relative to what its samples found.
    pub(super) fn close(&self) -> Vec<Plan> {
        let product = |tried: &Tried| self.product(tried);
        let best = least(self.tried.iter(), product).map_or(0.0, product);
        if best <= 0.0 {
            return Vec::new();
        }
        let is_near = |tried: &&Tried| product(tried) <= NEAR * best;
        let (light, path): (Vec<_>, Vec<_>) = (self.tried.iter())
            .filter(|(plan, _)| !plan.is_shared())
            .partition(|(plan, _)| plan.has_light_images());
        let shared = least(self.shared(), product);
        let mut near: Vec<_> = light.into_iter().chain(shared).filter(is_near).collect();
        if path.iter().any(is_near) {
            near.extend(path);
        }
        if near.len() < 2 {
            return Vec::new();
        }
        near.into_iter().map(|(plan, _)| *plan).collect()
    }

    /// The best of those with the most samples; where that shares light subpaths, `shared`, the best of these
    /// by as many samples of each. None: no plan found any light.
    pub(super) fn best(&self, shared: Option<Plan>) -> Option<Plan> {
        let samples = |(_, trial): &Tried| trial.stats.samples;
        let most = self.tried.iter().map(samples).max()?;
        let tried_most = self.tried.iter().filter(|tried| samples(tried) == most);
        let (best, _) = least(tried_most, |tried| self.product(tried))?;
        let best = shared.filter(|_| best.is_shared()).unwrap_or(*best);
        self.scale.has_light().then_some(best)
    }

    /// The best of those that share light subpaths.
    pub(super) fn best_shared(&self) -> Option<Plan> {
        let best = if self.is_even {
            least(self.shared(), |tried| self.product_behind(tried))
        } else {
            least(self.shared(), |tried| self.product(tried))
        };
        best.map(|(plan, _)| *plan)
    }

    fn shared(&self) -> impl Iterator<Item = &'a Tried> {
        self.tried.iter().filter(|(plan, _)| plan.is_shared())
    }

    /// The product of what varies behind camera rays and of cost.
    fn product_behind(&self, (plan, trial): &Tried) -> f64 {
        let behind = |i| trial.behind(i, self.scale.blocks);
        let varies = self.scale.sum_but_largest(trial, behind);
        self.told(trial, varies * trial.cost(plan.integrator))
    }

    /// The product of variance and cost, relative to those of others.
    fn product(&self, (plan, trial): &Tried) -> f64 {
        let variance = |i| trial.variance(i, self.scale.blocks);
        let found = self.scale.sum_but_largest(trial, variance);
        let missed = if plan.has_light_images() {
            0.0
        } else {
            self.missed.beside(found)
        };
        let product = (found + missed) * handicap(plan) * trial.cost(plan.integrator);
        self.told(trial, product)
    }

    /// `product`, or more than any where the samples of `trial` found too little to tell.
    fn told(&self, trial: &Trial, product: f64) -> f64 {
        if self.scale.part_found(trial) < LEAST_FOUND {
            f64::INFINITY
        } else {
            product
        }
    }
}

/// The plan of which `product` is least.
fn least<'a>(
    tried: impl Iterator<Item = &'a Tried>,
    product: impl Fn(&Tried) -> f64,
) -> Option<&'a Tried> {
    let products = tried.map(|tried| (tried, product(tried)));
    let least = products.min_by(|a, b| a.1.total_cmp(&b.1));
    least.map(|(tried, _)| tried)
}

/// What the product of a plan counts, by what is known before any trial.
fn handicap(plan: &Plan) -> f64 {
    match (plan.integrator, plan.roulette) {
        (IntegratorKind::Lvc, _) => COMMON_NOISE,
        (IntegratorKind::Path, PathRoulette::Albedo { start: 0 }) => EARLY_END,
        _ => 1.0,
    }
}

/// What variances are relative to.
struct Scale<'a> {
    blocks: &'a Blocks,
    /// The mean of a pixel of each block, by all plans.
    means: Vec<f64>,
    /// ε.
    least: f64,
}

impl<'a> Scale<'a> {
    fn new(blocks: &'a Blocks, tried: &[Tried]) -> Self {
        let mean = |i| {
            let means = tried.iter().map(|(_, trial)| trial.mean(i, blocks));
            means.sum::<f64>() / tried.len() as f64
        };
        let means: Vec<f64> = (0..BLOCKS).map(mean).collect();
        let whole = means.iter().sum::<f64>() / BLOCKS as f64;
        let least = 0.01 * whole * whole + f64::MIN_POSITIVE;
        Self {
            blocks,
            means,
            least,
        }
    }

    /// False where no plan found any.
    fn has_light(&self) -> bool {
        self.means.iter().any(|mean| *mean > 0.0)
    }

    /// The sum over the blocks of what `variance` tells of each.
    fn sum(&self, variance: impl Fn(usize) -> f64) -> f64 {
        let relative = |i| variance(i) * self.relative(i);
        (0..self.means.len()).map(relative).sum()
    }

    /// The same without the largest of the light images of `trial`: where these are bright and rare, one
    /// alone may be most of the sum, of whichever plan happened to make it.
    fn sum_but_largest(&self, trial: &Trial, variance: impl Fn(usize) -> f64) -> f64 {
        let largest = trial.largest_splat(self.blocks, |i| self.relative(i));
        (self.sum(variance) - largest).max(0.0)
    }

    /// The part of what all plans find that a trial found, by the mean over the blocks that have anything:
    /// a single bright sample of another plan is in one of them.
    fn part_found(&self, trial: &Trial) -> f64 {
        let bright = (0..self.means.len()).filter(|&i| self.means[i] > 0.0);
        let parts = bright.map(|i| (trial.mean(i, self.blocks) / self.means[i]).min(1.0));
        let [sum, count] = parts.fold([0.0, 0.0], |[sum, count], part| [sum + part, count + 1.0]);
        if count > 0.0 { sum / count } else { 1.0 }
    }

    /// What the light images of `trial` tell of path tracing beyond squares of `most`, and the largest term.
    fn hidden(&self, trial: &Trial, most: f64) -> [f64; 2] {
        trial.hidden(most, self.blocks, |i| self.relative(i))
    }

    /// 1 / (m² + ε) of block number `i`.
    fn relative(&self, i: usize) -> f64 {
        let mean = self.means[i];
        1.0 / (mean * mean + self.least)
    }
}

/// True where weights of light images tell how often all others make a path: by the balance heuristic,
/// where path tracing's strategies count in full, and densities have the roulette in them.
fn is_told(settings: &Settings, plan: &Plan) -> bool {
    let is_in_densities = !matches!(plan.roulette, PathRoulette::Throughput { .. });
    let has_weights = settings.path.mis == MisHeuristic::Balance && is_in_densities;
    plan.has_light_images() && has_weights
}

/// The variance of path tracing that its samples missed and light images tell of.
///
/// They tell of values that no sample of path tracing reached whose walks end as theirs do. What these
/// samples missed is missing in all path tracing.
#[derive(Default)]
struct Missed {
    /// With that roulette.
    missed: f64,
    /// What its samples found.
    found: f64,
}

impl Missed {
    fn new(scale: &Scale<'_>, settings: &Settings, tried: &[Tried]) -> Self {
        let with_light = tried.iter().filter(|(plan, _)| is_told(settings, plan));
        let with_light: Vec<_> = with_light.collect();
        let roulette = with_light.first().map(|(plan, _)| plan.roulette);
        let is_alike = |plan: &Plan| !plan.has_light_images() && Some(plan.roulette) == roulette;
        let alike = tried.iter().find(|(plan, _)| is_alike(plan));
        let of_alike = |(_, trial): &Tried| {
            let most = trial.largest_square(|i| scale.relative(i));
            let hidden = with_light
                .iter()
                .map(|(_, trial)| scale.hidden(trial, most));
            Self {
                missed: mean_but_largest(hidden),
                found: scale.sum(|i| trial.variance(i, scale.blocks)),
            }
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

/// The mean of sums without the largest term of all, as one alone may be most of it, and tells little.
fn mean_but_largest(sums: impl ExactSizeIterator<Item = [f64; 2]>) -> f64 {
    let count = sums.len() as f64;
    let [sum, largest] = sums.fold([0.0, 0.0], |[sum, largest]: [f64; 2], [s, l]| {
        [sum + s, largest.max(l)]
    });
    (sum - largest) / count
}
