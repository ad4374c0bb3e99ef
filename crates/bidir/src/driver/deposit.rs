//! Adds a batch to the running pass: to the picture, its parts, and raw images.

use super::features::Features;
use crate::film::{Layers, PassBuffer, SplatPlace};
use crate::integrator::{Batch, Entry, Sample, splats};
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
        for (sample, &value) in batch.walks.samples.iter().zip(&batch.values) {
            if let Some(pixel) = self.pixel(sample) {
                self.buffer.set_camera_sample(pixel, self.rgb(value));
            }
        }
        if self.layers.parts() > 0 {
            self.take_parts(batch);
        }
        self.take_splats(batch);
    }

    /// Adds the splats of `batch`, also to images of single strategies.
    pub(super) fn take_splats(&self, batch: &mut Batch) {
        let film = self.job.view.film();
        for (entry, place) in splats(&batch.splats) {
            let parts = self.parts_of(entry);
            self.buffer
                .splat(film, place, self.rgb(entry.value()), parts);
            if self.layers.strategy_vertices() > 0 {
                self.splat_raw(entry, place, &mut batch.worker.stats);
            }
        }
    }

    /// Adds the features of the one sample of `batch`.
    pub(super) fn take_features(&self, batch: &Batch, features: &Features) {
        if let Some(pixel) = self.pixel(&batch.walks.samples[0]) {
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

    /// Returns the parts of the picture that a term is in.
    fn parts_of(&self, entry: &Entry) -> impl Iterator<Item = usize> {
        let group = self.job.scene.light_group(entry.term.light);
        self.layers.parts_of(entry.term.strategy, group)
    }

    /// Adds the entries of `batch` to the parts of the picture, their raw values to the raw images of strategies, and
    /// squares of weighted luminances to the counts.
    fn take_parts(&self, batch: &mut Batch) {
        let (stats, sums) = (&mut batch.worker.stats, &mut batch.luminances);
        for entry in batch.entries.iter().filter(|entry| entry.is_added()) {
            let Some(pixel) = self.pixel(&batch.walks.samples[entry.sample as usize]) else {
                continue;
            };
            let value = self.rgb(entry.value());
            for part in self.parts_of(entry) {
                self.buffer.add_to_part(pixel, part, value);
            }
            if let Some((part, value)) = self.raw(entry, stats) {
                self.buffer.add_to_part(pixel, part, value);
            }
            self.add_luminance(entry, sums);
        }
        for ((_, strategy), luminance) in sums.drain(..) {
            stats.strategy_images.of(strategy).add_square(luminance);
        }
    }

    /// Adds the luminance of a term to the sum of its sample and strategy, if the strategy has a weighted image. A
    /// strategy may contribute to a sample several times, and not in a row: by several light points, by several
    /// vertices of a light cache, by each environment that a walk escapes to.
    fn add_luminance(&self, entry: &Entry, sums: &mut Vec<((u32, Strategy), f64)>) {
        let strategy = entry.term.strategy;
        if self.layers.weighted_part(strategy).is_none() {
            return;
        }
        let luminance = self.luminance(entry);
        let key = (entry.sample, strategy);
        match sums.iter_mut().find(|(known, _)| *known == key) {
            Some((_, sum)) => *sum += luminance,
            None => sums.push((key, luminance)),
        }
    }

    /// Adds a splat to its strategy's raw image, and counts its square, if it reaches the film.
    fn splat_raw(&self, entry: &Entry, place: SplatPlace, stats: &mut Stats) {
        let strategy = entry.term.strategy;
        let Some((pixel, weight)) = self.job.view.film().pick_pixel(place) else {
            return;
        };
        // A light subpath has one splat by each strategy.
        if self.layers.weighted_part(strategy).is_some() {
            let luminance = self.luminance(entry) * f64::from(weight);
            stats.strategy_images.of(strategy).add_square(luminance);
        }
        if let Some((part, value)) = self.raw(entry, stats) {
            self.buffer.splat_to_part(pixel, part, value, weight);
        }
    }

    fn luminance(&self, entry: &Entry) -> f64 {
        f64::from(luminance(self.rgb(entry.value())))
    }

    /// Returns the part that is the raw image of a term's strategy, and the value to add to it. None: there is no
    /// such image, or no film can sum the value, which is counted as dropped.
    fn raw(&self, entry: &Entry, stats: &mut Stats) -> Option<(usize, Rgb)> {
        let part = self.layers.raw_part(entry.term.strategy)?;
        let Some(value) = entry.unweighted() else {
            stats.strategy_images.of(entry.term.strategy).raw_dropped += 1;
            return None;
        };
        Some((part, self.rgb(value)))
    }
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
            term,
            prob: 1.0,
            transmittance: 1.0,
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
        let strategy = |entry: &Entry| entry.term.strategy;
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
        assert_eq!(nothing.unweighted(), Some(Spectrum::ZERO));
    }
}
