//! Adds a batch to the running pass: to the picture, its parts, and raw images.

use super::features::Features;
use crate::contribution::Contribution;
use crate::film::{Layers, PassBuffer, SplatPlace};
use crate::integrator::{Batch, Entry, Sample, Worker};
use crate::path::{Job, Strategy};
use crate::spectrum::{Rgb, Spectrum, luminance};
use crate::stats::Stats;

/// The destination of the contributions of a batch.
pub(super) struct Deposit<'a> {
    pub(super) job: &'a Job<'a>,
    pub(super) layers: &'a Layers,
    pub(super) buffer: &'a PassBuffer,
}

impl Deposit<'_> {
    /// Adds the samples of `batch` to the pass.
    pub(super) fn take(&self, batch: &mut Batch) {
        for (sample, &value) in batch.walked.samples.iter().zip(&batch.values) {
            if let Some(pixel) = self.pixel(sample) {
                self.buffer.set_camera_sample(pixel, self.rgb(value));
            }
        }
        if self.layers.parts() > 0 {
            for (sample, entry) in added(&batch.walked.samples, &batch.entries) {
                self.part_of_pixel(sample, &entry.contribution);
            }
        }
        self.take_splats(batch);
    }

    /// Adds the splats of `batch`, and images of single strategies.
    pub(super) fn take_splats(&self, batch: &mut Batch) {
        for (contribution, place) in splats(&batch.splats) {
            let value = self.rgb(contribution.value());
            let parts = self.parts_of(contribution);
            let film = self.job.view.film();
            self.buffer.splat(film, place, value, parts);
        }
        if self.layers.strategy_vertices() > 0 {
            self.strategies(batch);
        }
    }

    /// Adds the features of the one sample of `batch`.
    pub(super) fn take_features(&self, batch: &Batch, features: &Features) {
        if let Some(pixel) = self.pixel(&batch.walked.samples[0]) {
            let values = features.values(self.layers);
            self.buffer.set_features(pixel, values);
        }
    }

    /// Returns the index of a sample's pixel in the crop.
    fn pixel(&self, sample: &Sample) -> Option<usize> {
        let [x, y] = sample.pixel.map(i64::from);
        self.job.view.film().crop.index(x, y)
    }

    fn rgb(&self, value: Spectrum) -> Rgb {
        let Job { lanes, view, .. } = self.job;
        view.film().sensor.respond(lanes.to_rgb(value))
    }

    /// Adds a contribution to the parts at the sample's own pixel.
    fn part_of_pixel(&self, sample: &Sample, contribution: &Contribution) {
        let value = self.rgb(contribution.value());
        for part in self.parts_of(contribution) {
            self.add_to_part(sample, part, value);
        }
    }

    fn add_to_part(&self, sample: &Sample, part: usize, value: Rgb) {
        if let Some(pixel) = self.pixel(sample) {
            self.buffer.add_to_part(pixel, part, value);
        }
    }

    /// Returns the parts of the picture that a contribution is in.
    fn parts_of(&self, contribution: &Contribution) -> impl Iterator<Item = usize> {
        let group = self.job.scene.light_group(contribution.term.light);
        self.layers.parts_of(contribution.term.strategy, group)
    }

    /// Adds raw values to the raw images of strategies, and squares of weighted luminances to the counts.
    fn strategies(&self, batch: &mut Batch) {
        let Batch {
            walked,
            entries,
            luminances,
            splats: of_light,
            worker: Worker { stats, .. },
            ..
        } = batch;
        for (sample, entry) in added(&walked.samples, entries) {
            let value = self.raw(&entry.contribution, stats);
            if let Some((part, value)) = value {
                self.add_to_part(sample, part, value);
            }
            self.add_luminance(entry, luminances);
        }
        for ((_, strategy), luminance) in luminances.drain(..) {
            stats.add_square(strategy, luminance);
        }
        for (contribution, place) in splats(of_light) {
            self.splat(contribution, place, stats);
        }
    }

    /// Adds a contribution's luminance to the sum of its sample and strategy, if the strategy has a weighted image. A
    /// strategy may contribute to a sample several times, and not in a row: by several light points, by several
    /// vertices of a light cache, by each environment that a walk escapes to.
    fn add_luminance(&self, entry: &Entry, sums: &mut Vec<((u32, Strategy), f64)>) {
        let strategy = entry.contribution.term.strategy;
        if self.layers.weighted_part(strategy).is_none() {
            return;
        }
        let luminance = self.luminance(&entry.contribution);
        let place = (entry.sample, strategy);
        match sums.iter_mut().find(|(known, _)| *known == place) {
            Some((_, sum)) => *sum += luminance,
            None => sums.push((place, luminance)),
        }
    }

    /// Adds a splat to its strategy's raw image, and counts its square, if it reaches the film.
    fn splat(&self, contribution: &Contribution, place: SplatPlace, stats: &mut Stats) {
        let (film, strategy) = (self.job.view.film(), contribution.term.strategy);
        let Some((_, weight)) = film.pick_pixel(place) else {
            return;
        };
        // A light subpath has one splat by each strategy.
        if self.layers.weighted_part(strategy).is_some() {
            let luminance = self.luminance(contribution) * f64::from(weight);
            stats.add_square(strategy, luminance);
        }
        if let Some((part, value)) = self.raw(contribution, stats) {
            self.buffer.splat_to_part(film, place, value, part);
        }
    }

    fn luminance(&self, contribution: &Contribution) -> f64 {
        f64::from(luminance(self.rgb(contribution.value())))
    }

    /// Returns the part that is the raw image of a contribution's strategy, and the value to add to it. None: there
    /// is no such image, or no film can sum the value, which is counted as dropped.
    fn raw(&self, contribution: &Contribution, stats: &mut Stats) -> Option<(usize, Rgb)> {
        let part = self.layers.raw_part(contribution.term.strategy)?;
        let Some(value) = contribution.unweighted() else {
            stats.drop_raw(contribution.term.strategy);
            return None;
        };
        Some((part, self.rgb(value)))
    }
}

/// Returns the entries that add to an image, with their samples.
fn added<'a>(
    samples: &'a [Sample],
    entries: &'a [Entry],
) -> impl Iterator<Item = (&'a Sample, &'a Entry)> {
    let added = entries.iter().filter(|entry| entry.is_added());
    added.map(|entry| (&samples[entry.sample as usize], entry))
}

/// Returns the splats that add to the light image, with their places.
fn splats(entries: &[Entry]) -> impl Iterator<Item = (&Contribution, SplatPlace)> {
    let splats = entries.iter();
    splats.filter_map(|entry| Some((&entry.contribution, entry.splat_place()?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contribution::Term;
    use crate::film::Film;
    use crate::integrator::{Fate, Link};
    use crate::locus::Locus;
    use crate::path::PathSettings;
    use crate::sampler::{Domain, Sampler, SamplerKind};
    use crate::testing::prelude::*;

    /// Returns an entry C w of this strategy.
    fn entry((s, t): (usize, usize), c: f32, weight: f32) -> Entry {
        let place = SplatPlace {
            raster: Vec2::splat(0.5),
            u: Vec2::splat(0.5),
        };
        let term = Term {
            strategy: Strategy::new(s, t),
            light: 0,
            contribution: Spectrum::splat(c),
            weight,
        };
        Entry {
            sample: 0,
            contribution: term.certain(1.0),
            link: match t {
                1 => Link::LightImage([Locus::in_space(Vec3::ZERO); 2], place),
                _ => Link::Walk,
            },
            fate: Fate::Added,
        }
    }

    /// Returns the film and the counters after one sample that leaves these behind, the last as a splat.
    fn deposit(entries: &[Entry], splat: Entry) -> (Film, Stats) {
        let mut builder = builder(1, 0.0);
        builder.sky([1.0; 3]);
        let (shot, layers) = (builder.build(), Layers::new(&[], &[], 3).with_raw());
        let mut film = Film::with_layers(shot.view.film().clone(), layers, u64::MAX).unwrap();
        let buffer = PassBuffer::new(film.settings(), film.layers()).unwrap();
        let stream = Sampler::new(SamplerKind::Independent, 1).stream(Domain::Camera, 0, 0);
        let mut batch = Batch::default();
        batch.fill([Sample::new(0, [0; 2], stream, stream)]);
        batch.entries.extend(entries);
        batch.splats.push(splat);
        let settings = PathSettings::default();
        let job = shot.job(&settings);
        Deposit {
            job: &job,
            layers: film.layers(),
            buffer: &buffer,
        }
        .take(&mut batch);
        film.add_pass(0, &buffer);
        (film, batch.worker.stats)
    }

    #[track_caller]
    fn check_image(film: &Film, part: Option<usize>, value: f32) {
        let pixel = film.part_pixels(part.unwrap()).next().unwrap();
        check_close(pixel[0], value, 1e-6, "a pixel");
    }

    #[test]
    fn raw_values_that_are_too_large_are_counted_and_harm_nothing() {
        let fine = entry((1, 2), 2.0, 0.25);
        let large = entry((0, 3), 3e30, 1e-30);
        let splat = entry((2, 1), 7e30, 1e-30);
        let (film, stats) = deposit(&[fine, large], splat);
        let layers = film.layers();
        let strategy = |entry: &Entry| entry.contribution.term.strategy;
        let dropped = |entry: &Entry| stats.strategy_images.get(strategy(entry)).raw_dropped;
        check_image(&film, layers.raw_part(strategy(&fine)), 2.0);
        for (entry, weighted) in [(fine, 0.5), (large, 3.0), (splat, 7.0)] {
            check_image(&film, layers.weighted_part(strategy(&entry)), weighted);
        }
        for entry in [large, splat] {
            check_image(&film, layers.raw_part(strategy(&entry)), 0.0);
            assert_eq!(dropped(&entry), 1);
        }
        assert_eq!(dropped(&fine), 0);
    }

    #[test]
    fn all_that_a_strategy_adds_to_a_sample_is_one_square() {
        let [a, b] = [2.0, 3.0].map(|value| entry((0, 3), value, 1.0));
        let other = entry((1, 2), 4.0, 1.0);
        let splat = entry((2, 1), 5.0, 1.0);
        for order in [[a, b, other], [a, other, b]] {
            let (_, stats) = deposit(&order, splat);
            for (strategy, square) in [((0, 3), 25.0), ((1, 2), 16.0), ((2, 1), 25.0)] {
                let strategy = Strategy::new(strategy.0, strategy.1);
                let found = stats.strategy_images.get(strategy).squares();
                check_near(found, square, 1e-5, strategy);
            }
        }
    }

    #[test]
    fn a_weight_of_zero_leaves_nothing() {
        let nothing = entry((1, 2), 0.0, 0.0);
        assert_eq!(nothing.contribution.unweighted(), Some(Spectrum::ZERO));
    }
}
