//! What the samples of a plan find: their variance, block by block of the film, and their cost.
//!
//! **Variance** is that of a pixel in one pass, in the mean over a block. For a block of B pixels, n
//! samples, of which n_b fell into the block and have the variance v, and light images with the sum of
//! squares Q in it, of P samples in a pass,
//!
//! V = v + Q / (n P B),
//!
//! as the light images of a pass are many, each of them rare.
//!
//! **Hidden variance.** A few thousand samples of path tracing may miss the bright rare paths that make
//! most of its variance. Light images find them: with f the contribution of a path, p the density of the
//! light image, of which there are P in a pass, and q that of path tracing, the weight w of a light image
//! of value v = w f / p tells that P p (1 - w) / w is what all others take, of which q is a part. So the
//! second moment of path tracing, in the mean over a block, is not below
//!
//! (1 / B) ∫ f² / q ≥ (1 / B) ∫ f² w / (P p (1 - w)) = Σ v² / (w (1 - w)) / (n P B)
//!
//! with the sum over the light images of n samples that landed in the block. Other heuristics than the
//! balance heuristic do not tell so much, and are not asked.
//!
//! **Cost** is a sum over what was counted, with constant weights: the same on every machine, in
//! every run. They fit the times of ten scenes to 6 % (docs/performance.md).

use super::Settings;
use super::probe::{Probe, Witness};
use crate::film::PixelRect;
use crate::integrator::{IntegratorKind, Sample, Workspace};
use crate::path::PathContext;
use crate::spectrum::{Spectrum, luminance};
use crate::stats::{RayCounts, Stats};
use rayon::prelude::*;

/// The groups that a plan is tried with.
const GROUPS: u64 = 32;
/// Blocks along each side of the film.
const SIDE: usize = 16;
/// The blocks.
pub(super) const BLOCKS: usize = SIDE * SIDE;

/// Above this a weight says no more than that others are rare: 1 - w is a difference of rounded numbers.
const MOST_WEIGHT: f64 = 0.9999;

/// What a ray of a camera walk takes where its vertices are connected with shared light subpaths.
const CONNECTED_CAMERA_RAY: f64 = 1.5;
/// What a connection ray takes, without what it connects.
const CONNECTION_RAY: f64 = 0.4;
/// What evaluating a connection takes.
const CANDIDATE: f64 = 0.3;
/// What a light image takes, with its ray.
const LIGHT_IMAGE: f64 = 1.1;

/// What the samples of a plan found in a block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    samples: f64,
    own: f64,
    own_squares: f64,
    splats: f64,
    splat_squares: f64,
    /// Σ v² / (w (1 - w)).
    hidden: f64,
}

impl Block {
    /// Adds a light image of which its strategy has the share `weight`, by the balance heuristic.
    fn add_splat(&mut self, value: f64, weight: f64) {
        self.splats += value;
        self.splat_squares += value * value;
        let w = weight.min(MOST_WEIGHT);
        if w > 0.0 {
            self.hidden += value * value / (w * (1.0 - w));
        }
    }
}

/// What the samples of a plan found.
pub(super) struct Trial {
    blocks: Vec<Block>,
    pub(super) stats: Stats,
}

impl Default for Trial {
    fn default() -> Self {
        Self {
            blocks: vec![Block::default(); BLOCKS],
            stats: Stats::default(),
        }
    }
}

/// The block of pixel number `index` of the crop.
fn block(crop: &PixelRect, index: u64) -> usize {
    let [width, rows] = [u64::from(crop.width()), crop.area()].map(|size| size.max(1));
    let rows = rows.div_ceil(width);
    let part = |i: u64, size: u64| i * SIDE as u64 / size;
    (part(index / width, rows) * SIDE as u64 + part(index % width, width)) as usize
}

fn y(context: &PathContext<'_>, value: Spectrum) -> f64 {
    f64::from(luminance(
        context.scene.color().to_rgb(value, &context.wavelengths),
    ))
}

impl Witness for Trial {
    fn light(&mut self, context: &PathContext<'_>, workspace: &Workspace) {
        let film = context.scene.film();
        for splat in &workspace.splats {
            let Some((index, weight)) = film.pick_pixel(splat.place) else {
                continue;
            };
            let value = y(context, splat.contribution.value) * f64::from(weight);
            let block = &mut self.blocks[block(&film.crop, index as u64)];
            block.add_splat(value, f64::from(splat.contribution.weight));
        }
    }

    fn sample(&mut self, context: &PathContext<'_>, sample: &Sample, workspace: &Workspace) {
        let crop = &context.scene.film().crop;
        let [x, top] = sample.pixel.map(i64::from);
        let Some(index) = crop.index(x, top) else {
            return;
        };
        let value = y(context, workspace.value);
        let block = &mut self.blocks[block(crop, index as u64)];
        block.samples += 1.0;
        block.own += value;
        block.own_squares += value * value;
    }
}

impl Trial {
    /// `mean` is the mean luminance of the image.
    pub(super) fn run(probe: &Probe<'_>, mean: f32) -> Self {
        let Settings {
            shadow_rays,
            integrator,
            lvc,
            ..
        } = probe.settings;
        let groups: Vec<_> = (0..GROUPS)
            .into_par_iter()
            .map_init(Workspace::default, |workspace, group| {
                let mut trial = Self::default();
                let integrator = integrator.integrator(shadow_rays.selector(mean), lvc.candidates);
                probe.group(&*integrator, group, workspace, &mut trial);
                trial.stats = std::mem::take(&mut workspace.stats);
                trial
            })
            .collect();
        let mut all = Self::default();
        for group in &groups {
            all += group;
        }
        all
    }

    /// The mean of a pixel of block number `i` of a film of `pixels`.
    pub(super) fn mean(&self, i: usize, pixels: f64) -> f64 {
        let block = &self.blocks[i];
        let of_block = pixels / BLOCKS as f64;
        block.own / block.samples.max(1.0) + block.splats / (self.samples() * of_block)
    }

    /// The variance of a pixel of it in one pass.
    pub(super) fn variance(&self, i: usize, pixels: f64) -> f64 {
        let block = &self.blocks[i];
        let (count, of_block) = (block.samples.max(2.0), pixels / BLOCKS as f64);
        let squares = block.own_squares - block.own * block.own / count;
        squares / (count - 1.0) + block.splat_squares / (self.samples() * pixels * of_block)
    }

    /// A lower bound of the variance of path tracing there, by what the light images of this trial
    /// found.
    pub(super) fn hidden_variance(&self, i: usize, pixels: f64, mean: f64) -> f64 {
        let of_block = pixels / BLOCKS as f64;
        let square = self.blocks[i].hidden / (self.samples() * pixels * of_block);
        (square - mean * mean).max(0.0)
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
        let walked = camera as f64 * camera_ray + light as f64;
        let connected = connection as f64 * CONNECTION_RAY;
        let evaluated = self.stats.candidates as f64 * CANDIDATE;
        (walked + connected + evaluated + light_image as f64 * LIGHT_IMAGE) / self.samples()
    }
}

impl std::ops::AddAssign<&Self> for Trial {
    fn add_assign(&mut self, other: &Self) {
        self.stats += &other.stats;
        for (sum, block) in self.blocks.iter_mut().zip(&other.blocks) {
            sum.samples += block.samples;
            sum.own += block.own;
            sum.own_squares += block.own_squares;
            sum.splats += block.splats;
            sum.splat_squares += block.splat_squares;
            sum.hidden += block.hidden;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three paths of known contribution, and densities of both ways to make them: what light images
    /// tell is Σ f² / q.
    #[test]
    fn light_images_tell_of_the_second_moment_of_path_tracing() {
        let pixels = BLOCKS as f64;
        let paths = [(3.0, 0.25, 1e-4), (1.0, 0.5, 0.3), (2.0, 0.125, 0.02)];
        let mut trial = Trial::default();
        let n = 800.0;
        trial.stats.samples = 800;
        for (f, p, q) in paths {
            let w = pixels * p / (pixels * p + q);
            for _ in 0..(n * p) as u32 {
                trial.blocks[7].add_splat(w * f / p, w);
            }
        }
        let exact: f64 = paths.iter().map(|(f, _, q)| f * f / q).sum();
        let told = trial.hidden_variance(7, pixels, 0.0);
        // Of the first path 1 - w is less than what weights can tell.
        let least: f64 = paths[1..].iter().map(|(f, _, q)| f * f / q).sum();
        assert!(told > least && told < exact, "{least} {told} {exact}");
        trial.blocks[7].add_splat(0.0, 0.0);
        assert!((trial.hidden_variance(7, pixels, 0.0) - told).abs() < 1e-9);
        let told_of = |(f, p, q): (f64, f64, f64)| {
            let w = pixels * p / (pixels * p + q);
            let known = w.min(MOST_WEIGHT);
            f * f * w * w / (pixels * p * known * (1.0 - known))
        };
        let expected: f64 = paths.into_iter().map(told_of).sum();
        assert!((told / expected - 1.0).abs() < 1e-9, "{told} {expected}");
        assert!(trial.hidden_variance(7, pixels, 1e9) <= 0.0);
    }

    #[test]
    fn blocks_divide_the_crop() {
        let crop = PixelRect {
            min: [3, 5],
            max: [3 + 40, 5 + 20],
        };
        let mut counts = vec![0; BLOCKS];
        for index in 0..crop.area() {
            counts[block(&crop, index)] += 1;
        }
        assert_eq!(counts.iter().sum::<u64>(), crop.area());
        assert!(
            counts.iter().all(|&count| (2..=6).contains(&count)),
            "{counts:?}"
        );
    }
}
