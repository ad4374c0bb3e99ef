//! From a sample's workspace to the running pass: the picture, its parts, and raw images.

use crate::film::{Layers, PassBuffer};
use crate::integrator::{Contribution, Splat, Workspace};
use crate::path::PathContext;
use crate::spectrum::{Rgb, Spectrum, luminance};
use crate::stats::Stats;

/// Where the contributions of a sample go.
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
        for splat in &workspace.splats {
            let contribution = &splat.contribution;
            let (place, value) = ((splat.raster, splat.u), self.rgb(contribution.value));
            let parts = self.parts_of(contribution);
            let film = self.context.scene.film();
            self.buffer.splat(film, place, value, parts);
        }
        if self.layers.strategy_vertices() > 0 {
            self.strategies(workspace);
        }
    }

    fn rgb(&self, value: Spectrum) -> Rgb {
        let color = self.context.scene.color();
        color.to_rgb(value, &self.context.wavelengths)
    }

    /// Adds to the parts of the sample's own pixel.
    fn part_of_pixel(&self, contribution: &Contribution) {
        let value = self.rgb(contribution.value);
        for part in self.parts_of(contribution) {
            self.buffer.add_to_part(self.pixel, part, value);
        }
    }

    /// The parts of the picture that a contribution is in.
    fn parts_of(&self, contribution: &Contribution) -> impl Iterator<Item = usize> {
        let group = self.context.scene.light_group(contribution.light);
        self.layers.parts_of(contribution.strategy, group)
    }

    /// Adds to raw images, and counts squares.
    fn strategies(&self, workspace: &mut Workspace) {
        let Workspace {
            contributions,
            splats,
            stats,
            ..
        } = workspace;
        // Environments that a walk escapes to come one after the other, all by one strategy.
        for group in contributions.chunk_by(|a, b| a.strategy == b.strategy) {
            let luminances = group.iter().map(|one| self.luminance(one));
            self.count_square(&group[0], luminances.sum(), stats);
            for contribution in group {
                let raw = self.raw(contribution, stats);
                if let Some((part, value)) = raw {
                    self.buffer.add_to_part(self.pixel, part, value);
                }
            }
        }
        splats.iter().for_each(|splat| self.splat(splat, stats));
    }

    /// The same for a splat, where it reaches the film.
    fn splat(&self, splat: &Splat, stats: &mut Stats) {
        let (film, contribution) = (self.context.scene.film(), &splat.contribution);
        let Some((_, weight)) = film.pick_pixel(splat.raster, splat.u) else {
            return;
        };
        let luminance = self.luminance(contribution) * f64::from(weight);
        self.count_square(contribution, luminance, stats);
        if let Some((part, value)) = self.raw(contribution, stats) {
            let place = (splat.raster, splat.u);
            self.buffer.splat_to_part(film, place, value, part);
        }
    }

    fn luminance(&self, contribution: &Contribution) -> f64 {
        f64::from(luminance(self.rgb(contribution.value)))
    }

    /// Counts the square of what a sample adds to a weighted image, if there is one.
    fn count_square(&self, contribution: &Contribution, luminance: f64, stats: &mut Stats) {
        let strategy = contribution.strategy;
        if self.layers.weighted_part(strategy).is_some() {
            stats.add_square(strategy, luminance);
        }
    }

    /// What a contribution adds to which raw image. None: it has none, or the value is counted as
    /// dropped from it.
    fn raw(&self, contribution: &Contribution, stats: &mut Stats) -> Option<(usize, Rgb)> {
        let part = self.layers.raw_part(contribution.strategy)?;
        let Some(value) = contribution.unweighted() else {
            stats.drop_raw(contribution.strategy);
            return None;
        };
        Some((part, self.rgb(value)))
    }
}
