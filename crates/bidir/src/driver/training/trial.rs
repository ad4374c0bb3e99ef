//! What the samples of a plan find: their variance, block by block of the film, and their cost.
//!
//! **Variance** is that of a pixel in one pass, in the mean over a block. Three samples (a, b, c) are taken of
//! a pixel, so that what pixels differ by is no variance. For a block of B pixels with n_b of the n / 3
//! triples, and light images with the sum of squares Q in it, of P samples in a pass,
//!
//! V = Σ (a - c)² / (2 n_b) + Q / (n P B),
//!
//! as the light images of a pass are many, each of them rare. As a and b have a camera ray in common, (a - b)²
//! in place of (a - c)² tells what is left *behind the rays*, without what the pixel varies by.
//!
//! **Hidden variance.** A few thousand samples of path tracing may miss the bright rare paths that make
//! most of its variance. Light images find them: with f the contribution of a path, p the density of the
//! light image, of which there are P in a pass, and q that of path tracing, the weight w of a light image
//! of value v = w f / p tells that r = P p (1 - w) / w is what all others take, of which q is a part, where
//! walks end with the same probabilities. So path tracing adds f / q ≥ f / r = v / (P (1 - w)) to a pixel,
//! and its second moment beyond a value that none of its samples reached is, in the mean over a block, not
//! below
//!
//! (1 / B) ∫ f² / r = Σ v² / (w (1 - w)) / (n P B),
//!
//! with the sum over the light images of n samples that landed in the block and tell of more than that value.
//! Other heuristics than the balance heuristic do not tell so much, and are not asked.
//!
//! **Cost** is a sum over what was counted, with constant weights: the same on every machine, in
//! every run. They fit the times of 41 scenes to 7 % (docs/performance.md).

use super::Settings;
use super::blocks::{BLOCKS, Blocks};
use super::effort::Late;
use super::probe::{Probe, Witness, groups, landed};
use crate::integrator::{IntegratorKind, Sample, Workspace};
use crate::path::PathContext;
use crate::stats::{RayCounts, Stats};
use std::ops::AddAssign;

#[cfg(test)]
pub(super) mod tests;

/// The samples of a pixel: a, b and c.
pub(super) const THIRDS: u64 = 3;

/// Above this a weight says no more than that others are rare: 1 - w is a difference of rounded numbers.
const MOST_WEIGHT: f64 = 0.9999;

/// What a ray of a camera walk takes where its vertices are connected with shared light subpaths.
const CONNECTED_CAMERA_RAY: f64 = 1.8;
/// What a ray of a light walk takes, with the light that it begins on.
const LIGHT_RAY: f64 = 1.75;
/// What a connection ray takes, without what it connects.
const CONNECTION_RAY: f64 = 0.55;
/// What evaluating a connection takes.
const CANDIDATE: f64 = 0.4;
/// What a light image takes, with its ray.
const LIGHT_IMAGE: f64 = 1.0;

/// What the samples of a plan found in a block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    samples: f64,
    own: f64,
    triples: f64,
    /// Σ (a - c)² / 2 over triples of samples of one pixel.
    differences: f64,
    /// Σ (a - b)² / 2.
    behind: f64,
    splats: f64,
    splat_squares: f64,
    largest_splat_square: f64,
}

impl AddAssign<&Self> for Block {
    fn add_assign(&mut self, more: &Self) {
        self.samples += more.samples;
        self.own += more.own;
        self.triples += more.triples;
        self.differences += more.differences;
        self.behind += more.behind;
        self.splats += more.splats;
        self.splat_squares += more.splat_squares;
        let largest = self.largest_splat_square;
        self.largest_splat_square = largest.max(more.largest_splat_square);
    }
}

/// What a light image tells of path tracing.
#[derive(Clone, Copy, Debug)]
struct Told {
    block: usize,
    /// v / (1 - w): P times what path tracing adds to a pixel, or less.
    value: f64,
    /// v² / (w (1 - w)).
    square: f64,
}

impl Told {
    /// Of a light image that landed in a block, of which its strategy has the share `weight`, by the
    /// balance heuristic. None: it has nothing.
    fn new(block: usize, value: f64, weight: f64) -> Option<Self> {
        let w = weight.min(MOST_WEIGHT);
        (w > 0.0).then(|| Self {
            block,
            value: value / (1.0 - w),
            square: value * value / (w * (1.0 - w)),
        })
    }
}

/// What the samples of a plan found.
#[derive(Clone)]
pub(super) struct Trial {
    found: Vec<Block>,
    /// The block and the value of each sample, in order.
    values: Vec<(usize, f64)>,
    told: Vec<Told>,
    pub(super) stats: Stats,
}

impl Default for Trial {
    fn default() -> Self {
        Self {
            found: vec![Block::default(); BLOCKS],
            values: Vec::new(),
            told: Vec::new(),
            stats: Stats::default(),
        }
    }
}

/// The samples of a group, as they come.
struct Trying<'a> {
    blocks: &'a Blocks,
    trial: Trial,
}

impl Witness for Trying<'_> {
    fn light(&mut self, context: &PathContext<'_>, workspace: &Workspace) {
        self.add_splats(context, workspace);
    }

    fn sample(&mut self, context: &PathContext<'_>, sample: &Sample, workspace: &Workspace) {
        // Those of a light subpath of its own.
        self.add_splats(context, workspace);
        let crop = &context.view.film().crop;
        let [x, top] = sample.pixel.map(i64::from);
        let Some(index) = crop.index(x, top) else {
            return;
        };
        let value = f64::from(context.luminance(workspace.value));
        self.trial.values.push((self.blocks.of(index), value));
    }
}

impl Trying<'_> {
    fn add_splats(&mut self, context: &PathContext<'_>, workspace: &Workspace) {
        for splat in landed(context, workspace) {
            let block = self.blocks.of(splat.pixel);
            self.trial.add_splat(block, splat.value, splat.weight);
        }
    }
}

impl Trial {
    /// `mean` is the mean luminance of the image.
    pub(super) fn run(probe: &Probe<'_>, mean: f32) -> Result<Self, Late> {
        let Settings {
            shadow_rays,
            integrator,
            lvc,
            ..
        } = probe.settings;
        let blocks = Blocks::new(probe.view.film().crop);
        let samples = THIRDS * probe.pixels;
        let count = samples / probe.extent.group();
        let groups = groups(count, probe.is_late, |group, workspace| {
            let mut trying = Trying {
                blocks: &blocks,
                trial: Self::default(),
            };
            let integrator = integrator.integrator(shadow_rays.selector(mean), lvc);
            probe.group(&*integrator, group, workspace, &mut trying);
            trying.trial
        })?;
        let mut all = Self::default();
        for (trial, stats) in groups {
            all.add(trial);
            all.stats += &stats;
        }
        all.sum_values();
        Ok(all)
    }

    /// Adds what more samples found.
    pub(super) fn add(&mut self, more: Self) {
        self.stats += &more.stats;
        self.values.extend(more.values);
        self.told.extend(more.told);
        for (sum, found) in self.found.iter_mut().zip(&more.found) {
            *sum += found;
        }
    }

    /// All thirds of the samples have the same pixels in the same order.
    fn sum_values(&mut self) {
        for &(block, value) in &self.values {
            let block = &mut self.found[block];
            block.samples += 1.0;
            block.own += value;
        }
        let count = self.values.len() / 3;
        let half_square = |x: f64| 0.5 * x * x;
        for i in 0..count {
            let [(block, a), (_, b), (_, c)] =
                [0, 1, 2].map(|third| self.values[third * count + i]);
            let block = &mut self.found[block];
            block.triples += 1.0;
            block.differences += half_square(a - c);
            block.behind += half_square(a - b);
        }
    }

    fn add_splat(&mut self, block: usize, value: f64, weight: f64) {
        let (found, square) = (&mut self.found[block], value * value);
        found.splats += value;
        found.splat_squares += square;
        found.largest_splat_square = found.largest_splat_square.max(square);
        self.told.extend(Told::new(block, value, weight));
    }

    /// The mean of a pixel of block number `i` of these.
    pub(super) fn mean(&self, i: usize, blocks: &Blocks) -> f64 {
        let found = &self.found[i];
        found.own / found.samples.max(1.0) + found.splats / (self.samples() * blocks.size(i))
    }

    /// The variance of a pixel of it in one pass.
    pub(super) fn variance(&self, i: usize, blocks: &Blocks) -> f64 {
        let found = &self.found[i];
        found.differences / found.triples.max(1.0) + self.splat_variance(i, blocks)
    }

    /// The same of what is behind the camera rays.
    pub(super) fn behind(&self, i: usize, blocks: &Blocks) -> f64 {
        let found = &self.found[i];
        found.behind / found.triples.max(1.0) + self.splat_variance(i, blocks)
    }

    fn splat_variance(&self, i: usize, blocks: &Blocks) -> f64 {
        self.of_splats(self.found[i].splat_squares, i, blocks)
    }

    /// What a single light image adds to variances at most, times `relative` of its block.
    pub(super) fn largest_splat(&self, blocks: &Blocks, relative: impl Fn(usize) -> f64) -> f64 {
        let square = |i: usize| self.found[i].largest_splat_square;
        let of_block = |i| self.of_splats(square(i), i, blocks) * relative(i);
        (0..BLOCKS).map(of_block).fold(0.0, f64::max)
    }

    /// The variance of a pixel of block number `i` by light images with this sum of squares.
    fn of_splats(&self, squares: f64, i: usize, blocks: &Blocks) -> f64 {
        squares / (self.samples() * blocks.pixels() * blocks.size(i))
    }

    /// The largest square of a sample, times `relative` of its block.
    pub(super) fn largest_square(&self, relative: impl Fn(usize) -> f64) -> f64 {
        let squares = self.values.iter();
        let squares = squares.map(|&(block, value)| value * value * relative(block));
        squares.fold(0.0, f64::max)
    }

    /// The second moment of path tracing beyond squares of `most`, both times `relative` of each block, in
    /// the sum over the blocks: a lower bound by the light images of this trial, and its largest term.
    pub(super) fn hidden(
        &self,
        most: f64,
        blocks: &Blocks,
        relative: impl Fn(usize) -> f64,
    ) -> [f64; 2] {
        let pixels = blocks.pixels();
        let is_beyond = |told: &&Told| {
            let value = told.value / pixels;
            value * value * relative(told.block) > most
        };
        let beyond = self.told.iter().filter(is_beyond);
        let terms = beyond.map(|told| told.square * relative(told.block) / blocks.size(told.block));
        let sums = terms.fold([0.0, 0.0], |[sum, largest]: [f64; 2], term| {
            [sum + term, largest.max(term)]
        });
        sums.map(|sum| sum / (self.samples() * pixels))
    }

    fn samples(&self) -> f64 {
        self.stats.samples as f64
    }

    /// What a sample of `integrator` costs. Unit: rays of path tracing's walks.
    pub(super) fn cost(&self, integrator: IntegratorKind) -> f64 {
        let camera_ray = match integrator {
            IntegratorKind::Lvc => CONNECTED_CAMERA_RAY,
            _ => 1.0,
        };
        let RayCounts {
            camera,
            light,
            connection,
            light_image,
        } = self.stats.rays;
        let walked = camera as f64 * camera_ray + light as f64 * LIGHT_RAY;
        let connected = connection as f64 * CONNECTION_RAY;
        let evaluated = self.stats.candidates as f64 * CANDIDATE;
        (walked + connected + evaluated + light_image as f64 * LIGHT_IMAGE) / self.samples()
    }
}
