//! Groups of training samples, taken as the image takes its own.

use super::{STRIDE, Settings, path_context};
use crate::integrator::{Integrator, Sample, Workspace};
use crate::path::{Connections, PathContext};
use crate::sampler::{Domain, Sampler};
use crate::scene::Scene;
use std::ops::Range;

/// The samples of a group.
pub(super) const GROUP: u64 = 256;

/// What samples are taken of, and how.
#[derive(Clone, Copy)]
pub(super) struct Probe<'a> {
    pub(super) scene: &'a Scene,
    pub(super) settings: &'a Settings,
    pub(super) connections: Connections<'a>,
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

impl Probe<'_> {
    /// Takes the samples of group number `group`.
    pub(super) fn group(
        &self,
        integrator: &dyn Integrator,
        group: u64,
        workspace: &mut Workspace,
        witness: &mut impl Witness,
    ) {
        let begin = self.first + group * GROUP;
        let numbers = begin..begin + GROUP;
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
        let crop = self.scene.film().crop;
        let sampler = Sampler::new(self.settings.sampler, self.settings.seed);
        let (round, place) = {
            let number = number - self.first;
            (number / self.pixels, self.first + number % self.pixels)
        };
        let ray = if round == 1 { place } else { number };
        Sample {
            pass: 0,
            pixel: crop.pixel((place.wrapping_mul(STRIDE) % crop.area()) as usize),
            ray: sampler.stream(Domain::TrainingCamera, ray, 0),
            camera: sampler.stream(Domain::TrainingCamera, number, 0),
            light: sampler.stream(Domain::TrainingLight, 0, number),
        }
    }

    pub(super) fn context(&self, sample: &Sample) -> PathContext<'_> {
        path_context(self.scene, self.settings, self.connections, sample)
    }
}
