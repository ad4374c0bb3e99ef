//! From a sample's workspace to the running pass: the picture, its parts, and raw images.

use crate::contribution::Contribution;
use crate::film::{Layers, PassBuffer};
use crate::integrator::{Splat, Workspace};
use crate::path::{PathContext, Strategy};
use crate::spectrum::{Rgb, Spectrum, luminance};
use crate::stats::Stats;

/// The destination of the contributions of a sample.
pub(super) struct Deposit<'a> {
    pub(super) context: &'a PathContext<'a>,
    pub(super) layers: &'a Layers,
    pub(super) buffer: &'a PassBuffer,
    pub(super) pixel: usize,
}

impl Deposit<'_> {
    /// Moves the contributions of the last sample to the pass.
    pub(super) fn take(&self, workspace: &mut Workspace) {
        self.buffer
            .set_camera_sample(self.pixel, self.rgb(workspace.value));
        if self.layers.parts() > 0 {
            for contribution in &workspace.contributions {
                self.part_of_pixel(contribution);
            }
        }
        self.take_light(workspace);
    }

    /// Moves what came from a light subpath, where that was not walked for one sample.
    pub(super) fn take_light(&self, workspace: &mut Workspace) {
        for splat in &workspace.splats {
            let contribution = &splat.contribution;
            let (place, value) = (splat.place, self.rgb(contribution.value()));
            let parts = self.parts_of(contribution);
            let film = self.context.view.film();
            self.buffer.splat(film, place, value, parts);
        }
        if self.layers.strategy_vertices() > 0 {
            self.strategies(workspace);
        }
    }

    fn rgb(&self, value: Spectrum) -> Rgb {
        let PathContext { scene, view, .. } = self.context;
        let light = scene.color().to_rgb(value, &self.context.wavelengths);
        view.film().sensor.respond(light)
    }

    /// Adds to the parts of the sample's own pixel.
    fn part_of_pixel(&self, contribution: &Contribution) {
        let value = self.rgb(contribution.value());
        for part in self.parts_of(contribution) {
            self.buffer.add_to_part(self.pixel, part, value);
        }
    }

    /// The parts of the picture that a contribution is in.
    fn parts_of(&self, contribution: &Contribution) -> impl Iterator<Item = usize> {
        let group = self.context.scene.light_group(contribution.term.light);
        self.layers.parts_of(contribution.term.strategy, group)
    }

    /// Adds to raw images, and counts squares.
    fn strategies(&self, workspace: &mut Workspace) {
        let Workspace {
            contributions,
            luminances,
            splats,
            stats,
            ..
        } = workspace;
        luminances.clear();
        for contribution in contributions.iter() {
            self.add_luminance(contribution, luminances);
            if let Some((part, value)) = self.raw(contribution, stats) {
                self.buffer.add_to_part(self.pixel, part, value);
            }
        }
        for &(strategy, luminance) in luminances.iter() {
            stats.add_square(strategy, luminance);
        }
        for splat in splats.iter() {
            self.splat(splat, stats);
        }
    }

    /// Adds to what a sample gives the weighted image of a strategy, if there is one. A strategy may
    /// contribute often, and others in between: by several light points, by several vertices of a light
    /// cache, by each environment that a walk escapes to.
    fn add_luminance(&self, contribution: &Contribution, sums: &mut Vec<(Strategy, f64)>) {
        let strategy = contribution.term.strategy;
        if self.layers.weighted_part(strategy).is_none() {
            return;
        }
        let luminance = self.luminance(contribution);
        match sums.iter_mut().find(|(known, _)| *known == strategy) {
            Some((_, sum)) => *sum += luminance,
            None => sums.push((strategy, luminance)),
        }
    }

    /// The same for a splat, where it reaches the film.
    fn splat(&self, splat: &Splat, stats: &mut Stats) {
        let (film, contribution) = (self.context.view.film(), &splat.contribution);
        let Some((_, weight)) = film.pick_pixel(splat.place) else {
            return;
        };
        // A light subpath has one splat by each strategy.
        if self
            .layers
            .weighted_part(contribution.term.strategy)
            .is_some()
        {
            let luminance = self.luminance(contribution) * f64::from(weight);
            stats.add_square(contribution.term.strategy, luminance);
        }
        if let Some((part, value)) = self.raw(contribution, stats) {
            self.buffer.splat_to_part(film, splat.place, value, part);
        }
    }

    fn luminance(&self, contribution: &Contribution) -> f64 {
        f64::from(luminance(self.rgb(contribution.value())))
    }

    /// The raw image of a contribution, and the value added to it. None: it has none, or the value is
    /// counted as dropped from it.
    fn raw(&self, contribution: &Contribution, stats: &mut Stats) -> Option<(usize, Rgb)> {
        let part = self.layers.raw_part(contribution.term.strategy)?;
        let Some(value) = contribution.unweighted() else {
            stats.drop_raw(contribution.term.strategy);
            return None;
        };
        Some((part, self.rgb(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contribution::Term;
    use crate::film::{Film, FilmSettings, Filter, SplatPlace};
    use crate::light::{InfiniteLight, Light};
    use crate::math::Vec2;
    use crate::path::{Connections, PathSettings};
    use crate::scene::{Scene, SceneBuilder};
    use crate::spectrum::Wavelengths;

    /// A sky.
    fn scene() -> Scene {
        let mut builder = SceneBuilder::new();
        builder.light(Light::Infinite(InfiniteLight::constant([1.0; 3])));
        builder.build().unwrap()
    }

    /// A contribution C w of this strategy.
    fn contribution((s, t): (usize, usize), c: f32, weight: f32) -> Contribution {
        let strategy = Strategy::new(s, t);
        Term::new(strategy, 0, Spectrum::splat(c), weight).certain(1.0)
    }

    /// The film and the counters after one sample that leaves these behind, the last as a splat.
    fn deposit(contributions: &[Contribution], splat: Contribution) -> (Film, Stats) {
        let view = crate::testing::view(FilmSettings::new([1, 1], Filter::default()));
        let (scene, layers) = (scene(), Layers::new(&[], &[], 3).with_raw());
        let mut film = Film::with_layers(view.film().clone(), layers, u64::MAX).unwrap();
        let buffer = PassBuffer::new(film.settings(), film.layers()).unwrap();
        let mut workspace = Workspace::default();
        workspace.contributions.extend(contributions);
        workspace.splats.push(Splat {
            contribution: splat,
            place: SplatPlace {
                raster: Vec2::splat(0.5),
                u: Vec2::splat(0.5),
            },
        });
        let context = PathContext {
            scene: &scene,
            view: &view,
            settings: &PathSettings::default(),
            wavelengths: Wavelengths::default(),
            connections: Connections::ONE_SUBPATH,
        };
        Deposit {
            context: &context,
            layers: film.layers(),
            buffer: &buffer,
            pixel: 0,
        }
        .take(&mut workspace);
        film.add_pass(0, &buffer);
        (film, workspace.stats)
    }

    #[track_caller]
    fn check_image(film: &Film, part: Option<usize>, value: f32) {
        let pixel = film.part_pixels(part.unwrap()).next().unwrap();
        assert!((pixel[0] - value).abs() <= 1e-6 * value, "{pixel:?}");
    }

    #[test]
    fn raw_values_that_are_too_large_are_counted_and_harm_nothing() {
        let fine = contribution((1, 2), 2.0, 0.25);
        let large = contribution((0, 3), 3e30, 1e-30);
        let splat = contribution((2, 1), 7e30, 1e-30);
        let (film, stats) = deposit(&[fine, large], splat);
        let layers = film.layers();
        check_image(&film, layers.raw_part(fine.term.strategy), 2.0);
        for (contribution, weighted) in [(fine, 0.5), (large, 3.0), (splat, 7.0)] {
            check_image(
                &film,
                layers.weighted_part(contribution.term.strategy),
                weighted,
            );
        }
        for contribution in [large, splat] {
            check_image(&film, layers.raw_part(contribution.term.strategy), 0.0);
            let counts = stats.strategy_images.get(contribution.term.strategy);
            assert_eq!(counts.raw_dropped, 1);
        }
        assert_eq!(stats.strategy_images.get(fine.term.strategy).raw_dropped, 0);
    }

    #[test]
    fn all_that_a_strategy_adds_to_a_sample_is_one_square() {
        let [a, b] = [2.0, 3.0].map(|value| contribution((0, 3), value, 1.0));
        let other = contribution((1, 2), 4.0, 1.0);
        let splat = contribution((2, 1), 5.0, 1.0);
        for order in [[a, b, other], [a, other, b]] {
            let (_, stats) = deposit(&order, splat);
            for (strategy, square) in [((0, 3), 25.0), ((1, 2), 16.0), ((2, 1), 25.0)] {
                let strategy = Strategy::new(strategy.0, strategy.1);
                let found = stats.strategy_images.get(strategy).squares();
                assert!((found - square).abs() < 1e-5, "{strategy}: {found}");
            }
        }
    }

    #[test]
    fn a_weight_of_zero_leaves_nothing() {
        let nothing = contribution((1, 2), 0.0, 0.0);
        assert_eq!(nothing.unweighted(), Some(Spectrum::ZERO));
    }
}
