//! Groups of training samples, taken as the image takes its own.

use super::super::spread;
use super::effort::{IsLate, Late};
use super::extent::Extent;
use super::{Settings, path_context};
use crate::integrator::{Integrator, Sample, Workspace};
use crate::path::{Connections, PathContext};
use crate::sampler::{Domain, Sampler};
use crate::scene::Scene;
use crate::stats::Stats;
use crate::view::View;
use rayon::prelude::*;
use std::ops::Range;

/// What samples are taken of, and how.
#[derive(Clone, Copy)]
pub(super) struct Probe<'a> {
    pub(super) scene: &'a Scene,
    pub(super) view: &'a View,
    pub(super) settings: &'a Settings,
    pub(super) connections: Connections<'a>,
    /// Whether training is given up, asked before each group.
    pub(super) is_late: IsLate<'a>,
    /// How many samples, and in which groups.
    pub(super) extent: Extent,
    /// The first sample's number.
    pub(super) first: u64,
    /// After so many samples their pixels come again; the first time with the same camera rays.
    pub(super) pixels: u64,
}

/// What looks at a workspace, after a sample or after a light subpath that samples share.
pub(super) trait Witness {
    /// After a light subpath.
    fn light(&mut self, context: &PathContext<'_>, workspace: &Workspace);

    /// After a sample.
    fn sample(&mut self, context: &PathContext<'_>, sample: &Sample, workspace: &Workspace);
}

/// A light image on the film.
pub(super) struct Landed {
    /// The number of its pixel in the crop.
    pub(super) pixel: usize,
    /// The luminance of its value, times the filter's part.
    pub(super) value: f64,
    /// The share of its strategy.
    pub(super) weight: f64,
}

/// The most that a group keeps of a kind: walks that never end have millions of connections, and what is
/// learnt are ratios of sums.
const MOST_KEPT: usize = 1 << 16;

/// Keeps `one` where there is not enough of it yet.
pub(super) fn keep<T>(kept: &mut Vec<T>, one: T) {
    if kept.len() < MOST_KEPT {
        kept.push(one);
    }
}

/// The light images in a workspace that land on the film.
pub(super) fn landed<'a>(
    context: &'a PathContext<'_>,
    workspace: &'a Workspace,
) -> impl Iterator<Item = Landed> + 'a {
    workspace.splats.iter().filter_map(|splat| {
        let (pixel, part) = context.view.film().pick_pixel(splat.place)?;
        let value = context.luminance(splat.contribution.value) * part;
        Some(Landed {
            pixel,
            value: value.into(),
            weight: splat.contribution.weight.into(),
        })
    })
}

/// What `of_group` finds of each of so many groups, with what was counted, in their order, whichever threads
/// had them.
pub(super) fn groups<T: Send>(
    count: u64,
    is_late: IsLate<'_>,
    of_group: impl Fn(u64, &mut Workspace) -> T + Sync,
) -> Result<Vec<(T, Stats)>, Late> {
    let groups = (0..count).into_par_iter();
    let found = groups.map_init(Workspace::default, |workspace, group| {
        if is_late() {
            return Err(Late);
        }
        let found = of_group(group, workspace);
        Ok((found, std::mem::take(&mut workspace.stats)))
    });
    found.collect()
}

impl Probe<'_> {
    /// Takes the samples of group number `group`.
    pub(super) fn group(
        &self,
        integrator: &dyn Integrator,
        group: u64,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        let size = self.extent.group();
        let begin = self.first + group * size;
        let numbers = begin..begin + size;
        self.walk_light(integrator, numbers.clone(), workspace, witness);
        for number in numbers {
            let sample = self.sample(number);
            let context = self.context(&sample);
            integrator.sample(&context, &sample, workspace);
            witness.sample(&context, &sample, workspace);
        }
    }

    fn walk_light(
        &self,
        integrator: &dyn Integrator,
        numbers: Range<u64>,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        let Some(shared) = integrator.shared_light() else {
            return;
        };
        shared.begin(workspace);
        for number in numbers.step_by(self.connections.samples_per_subpath as usize) {
            let sample = self.sample(number);
            let context = self.context(&sample);
            shared.walk(&context, &sample, workspace);
            witness.light(&context, workspace);
        }
        shared.end(self.connections, workspace);
    }

    /// Sample number `number` of training: spread over the film, with random numbers of its own.
    pub(super) fn sample(&self, number: u64) -> Sample {
        let crop = self.view.film().crop;
        let sampler = Sampler::new(self.settings.sampler, self.settings.seed);
        let (round, place) = {
            let number = number - self.first;
            (number / self.pixels, self.first + number % self.pixels)
        };
        let ray = if round == 1 { place } else { number };
        let samples_per_subpath = self.connections.samples_per_subpath as u64;
        let subpath = self.first + (number - self.first) / samples_per_subpath;
        Sample {
            pass: 0,
            pixel: spread::point(&crop, place),
            ray: sampler.stream(Domain::TrainingCamera, ray, 0),
            camera: sampler.stream(Domain::TrainingCamera, number, 0),
            light: sampler.stream(Domain::TrainingLight, 0, subpath),
        }
    }

    pub(super) fn context(&self, sample: &Sample) -> PathContext<'_> {
        path_context(
            self.scene,
            self.view,
            self.settings,
            self.connections,
            sample,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::blocks::{BLOCKS, Blocks};
    use crate::driver::training::trial::tests::{lamp, view};
    use crate::film::PixelRect;
    use crate::sampler::{Dimension, Purpose};

    #[test]
    fn samples_are_spread_over_films_of_all_sizes() {
        for &max in &spread::tests::SIZES[..6] {
            let crop = PixelRect { min: [0; 2], max };
            let blocks = Blocks::new(crop);
            let mut counts = [0; BLOCKS];
            for i in 0..16 * BLOCKS as u64 {
                let [x, y] = spread::point(&crop, 32_768 + i).map(i64::from);
                counts[blocks.of(crop.index(x, y).expect("a pixel of the film"))] += 1;
            }
            let most = counts.iter().max().copied().unwrap_or(0);
            let least = counts.iter().min().copied().unwrap_or(0);
            assert!(least >= 8 && most <= 24, "{max:?}: {least} to {most}");
        }
    }

    /// As in the image: points of a sequence are even where none is left out.
    #[test]
    fn light_subpaths_of_many_samples_are_one_after_the_other() {
        let max = [16; 2];
        let (scene, settings) = (lamp(), Settings::default());
        let light = |samples_per_subpath, number| {
            let probe = Probe {
                scene: &scene,
                view: &view(PixelRect { min: [0; 2], max }),
                settings: &settings,
                connections: Connections {
                    samples_per_subpath,
                    ..Connections::ONE_SUBPATH
                },
                is_late: &|| false,
                extent: Extent::new(1.0, 1e9),
                first: 768,
                pixels: u64::MAX,
            };
            let light = Dimension::at(0, Purpose::Light);
            probe.sample(number).light.get_1d(light).to_bits()
        };
        let own: Vec<_> = (768..776).map(|number| light(1.0, number)).collect();
        let shared: Vec<_> = (768..800).map(|number| light(4.0, number)).collect();
        assert!(own.windows(2).all(|pair| pair[0] != pair[1]));
        for (one, of_four) in own.iter().zip(shared.chunks(4)) {
            assert!(of_four.iter().all(|light| light == one));
        }
    }

    #[test]
    fn no_more_is_kept_than_is_needed() {
        let mut kept = Vec::new();
        for i in 0..MOST_KEPT + 2 {
            keep(&mut kept, i);
        }
        assert_eq!(
            (kept.len(), kept.last()),
            (MOST_KEPT, Some(&(MOST_KEPT - 1)))
        );
    }
}
