//! The samples of training: they are samples of `bdpt`, with a light subpath each, and every connection is traced.
//! They have random numbers of their own and are spread evenly over the film.

use super::super::spread;
use super::constants::{FIRST_SAMPLES, GROUPS};
use super::effort::{Effort, IsLate};
use super::extent;
use super::log::ConnectionLog;
use super::terms::SurveyTerm;
use super::work::WorkCounts;
use super::{Settings, TrainingInput};
use crate::integrator::{Batch, Entry, Link, Method, Sample};
use crate::path::{Job, MisHeuristic, PathDensities};
use crate::sampler::{Dimension, Domain, Purpose, Sampler};
use crate::select::{Candidate, ShadowRays};
use crate::stats::Stats;
use accel::Stop;
use rayon::prelude::*;
use std::ops::Range;

/// The number of samples of a pixel: two camera subpaths, each with two light subpaths.
pub(super) const QUAD: u64 = 4;

/// The results of the samples of training.
#[derive(Default)]
pub(super) struct Survey {
    /// The sum over samples of the luminance that each adds to the mean pixel.
    pub(super) luminance: f64,
    /// The terms of the image, and connections that are not visible.
    pub(super) terms: Vec<SurveyTerm>,
    pub(super) work: WorkCounts,
    /// The random number of each sample that chooses the light of its first light point.
    pub(super) light_numbers: Vec<f32>,
    /// The vertices and connections to learn from.
    pub(super) log: ConnectionLog,
    pub(super) stats: Stats,
    /// True if the effort allowed fewer samples than training needs.
    pub(super) is_short: bool,
}

impl Survey {
    /// Takes the samples of training. None: the host asked to stop.
    pub(super) fn run(input: TrainingInput<'_>, effort: Effort<'_>) -> Option<Self> {
        let surveyor = Surveyor::new(input, effort.stop);
        let mut survey = surveyor.round(0..FIRST_SAMPLES, &|| false)?;
        let pixels = input.view.film().crop.area();
        let wanted = extent::samples(pixels, extent::work(&survey.stats));
        loop {
            let count = survey.stats.samples;
            survey.is_short = count < wanted;
            if !survey.is_short || 2 * count > effort.samples {
                return Some(survey);
            }
            let Some(more) = surveyor.round(count..2 * count, effort.is_late) else {
                return (!effort.stop.is_asked()).then_some(survey);
            };
            survey.add(more);
        }
    }

    /// Returns the number of samples.
    pub(super) fn samples(&self) -> f64 {
        self.stats.samples as f64
    }

    /// Returns κ, the mean number of connectable vertices of a light subpath.
    pub(super) fn light_vertices(&self) -> f64 {
        self.log.light.len() as f64 / self.samples()
    }

    fn add(&mut self, more: Self) {
        let traced = self.log.traced.len() as u32;
        let terms = more.terms.iter().map(|term| SurveyTerm {
            edge: term.edge.map(|edge| edge + traced),
            ..*term
        });
        self.log.add(more.log, self.terms.len() as u32);
        self.terms.extend(terms);
        self.light_numbers.extend(more.light_numbers);
        self.luminance += more.luminance;
        self.work += more.work;
        self.stats += &more.stats;
    }

    /// Records the results of sample number `number`, the only one of `batch`.
    fn record(&mut self, job: &Job<'_>, number: u64, batch: &Batch) {
        let sample = &batch.walks.samples[0];
        let film = job.view.film();
        let [x, y] = sample.pixel.map(i64::from);
        let own = film.crop.index(x, y).map(|pixel| (pixel, 1.0));
        let (mut densities, mut parts) = (PathDensities::default(), Vec::new());
        self.log.begin(job, batch);
        let mut record = |entry: &Entry, candidate: Option<&Candidate>| {
            let edge =
                candidate.and_then(|candidate| self.log.trace(batch, candidate, entry.is_added()));
            let landed = match entry.link {
                Link::Walk | Link::Connection(_) => own,
                Link::LightImage(_, place) => film.pick_pixel(place),
            };
            let shares = batch.shares(job, entry, candidate, &mut densities, &mut parts)?;
            let (pixel, part) = landed?;
            let mut term = SurveyTerm::new(job, number, entry, pixel, part, shares);
            term.edge = edge;
            term.score = candidate.map_or(0.0, |candidate| candidate.score);
            self.luminance += term.of_mean_pixel(film);
            if entry.is_added() {
                self.log
                    .path(&entry.term, candidate, &parts, self.terms.len() as u32);
            }
            self.terms.push(term);
            Some(())
        };
        let entries = batch.entries.iter().chain(&batch.splats);
        let certain = |entry: &&Entry| !matches!(entry.link, Link::Connection(_));
        for entry in entries.filter(certain).filter(|entry| entry.is_added()) {
            record(entry, None);
        }
        for (candidate, entry) in batch.connections() {
            if let Some(entry) = entry {
                record(entry, Some(candidate));
            }
        }
        self.work.add(job, batch);
        let first = Dimension::at(1, Purpose::NextEventLight);
        self.light_numbers.push(sample.points.get_1d(first));
    }
}

/// Takes the samples.
struct Surveyor<'a> {
    input: TrainingInput<'a>,
    settings: Settings,
    method: Method,
    stop: Stop<'a>,
}

impl<'a> Surveyor<'a> {
    fn new(input: TrainingInput<'a>, stop: Stop<'a>) -> Self {
        let mut settings = input.settings.clone();
        // The shares of paths are by these weights.
        settings.path.mis = MisHeuristic::Balance;
        let all = ShadowRays::All.selector(0.0);
        Self {
            input,
            settings,
            method: Method::Bdpt(all),
            stop,
        }
    }

    /// Takes samples in groups. Their results are in the order of groups, whichever threads took them. None:
    /// `is_late` returned true, or the host asked to stop.
    fn round(&self, numbers: Range<u64>, is_late: IsLate<'_>) -> Option<Survey> {
        let count = numbers.end - numbers.start;
        let size = (count / GROUPS).max(QUAD);
        let groups = (0..count / size).into_par_iter();
        let surveys = groups.map_init(Batch::default, |batch, group| {
            if is_late() {
                return None;
            }
            let begin = numbers.start + group * size;
            let mut survey = Survey::default();
            for number in begin..begin + size {
                self.sample(number, batch, &mut survey);
                if self.stop.is_asked() {
                    return None;
                }
            }
            survey.stats = std::mem::take(&mut batch.worker.stats);
            Some(survey)
        });
        let of_groups: Vec<Survey> = surveys.collect::<Option<_>>()?;
        let mut all = Survey::default();
        for group in of_groups {
            all.add(group);
        }
        Some(all)
    }

    /// Takes sample number `number`, one of the four of its pixel.
    fn sample(&self, number: u64, batch: &mut Batch, survey: &mut Survey) {
        let TrainingInput { scene, view, .. } = self.input;
        let quad = number / QUAD;
        let [walk, of_light] = [number / 2 % 2, number % 2].map(|i| 2 * quad + i);
        let sampler = Sampler::new(self.settings.sampler, self.settings.seed);
        let camera = sampler.stream(Domain::TrainingCamera, walk, 0);
        let light = sampler.stream(Domain::TrainingLight, 0, of_light);
        let pixel = spread::point(&view.film().crop, quad);
        let job = Job {
            stop: self.stop,
            ..Job::of_own_subpaths(scene, view, &self.settings.path)
        };
        batch.fill([Sample {
            points: sampler.stream(Domain::TrainingCamera, number, 1),
            ..Sample::new(0, pixel, camera, light)
        }]);
        self.method.run(&job, batch);
        survey.record(&job, number, batch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::tests::{input, lamp, survey_of, view};
    use crate::driver::{Resources, Session};
    use crate::film::PixelRect;
    use crate::path::MAX_VERTICES;
    use crate::spectrum::luminance;
    use crate::testing::prelude::*;

    /// Returns a lamp in a white sphere: no walk ends before it is as long as any may be.
    fn white_room() -> Shot {
        let camera = narrow_camera(Vec3::ZERO, 8, 1.0);
        let mut builder = ShotBuilder::new(camera, 8);
        builder.add(sphere(Vec3::ZERO, 1.0), diffuse([1.0; 3]));
        builder.light(point_light(Vec3::new(0.0, 0.5, 0.0)));
        builder.build()
    }

    #[test]
    fn where_walks_do_not_end_samples_and_training_do() {
        let (room, mut settings) = (white_room(), Settings::default());
        settings.path.max_depth = None;
        let input = input(&room.scene, &room.view, &settings);
        let survey = survey_of(input, Effort::WHOLE);
        let longest = survey.stats.samples * (MAX_VERTICES as u64 - 1);
        assert_eq!(survey.stats.rays.camera, longest);
        // All pairs are half a million.
        let of_sample = extent::work(&survey.stats);
        assert!((20_000.0..40_000.0).contains(&of_sample), "{of_sample}");
        let samples = survey.stats.samples;
        assert_eq!((samples, survey.is_short), (FIRST_SAMPLES, false));
    }

    /// Compares the mean of training with that of the image by these strategies.
    #[track_caller]
    fn check_mean(strategies: &str, tolerance: f64) {
        let scene = lamp();
        let view = view(PixelRect {
            min: [7, 2],
            max: [9, 4],
        });
        let mut settings = Settings {
            shadow_rays: ShadowRays::RayRoulette(1.0),
            ..Settings::default()
        };
        settings.path.strategies = strategies.parse().expect("a list of strategies");
        let trainings = (0..16).map(|seed| {
            let settings = Settings {
                seed,
                ..settings.clone()
            };
            let survey = survey_of(input(&scene, &view, &settings), Effort::WHOLE);
            survey.luminance / survey.samples()
        });
        let trained = trainings.sum::<f64>() / 16.0;
        let session = Session::new(&scene, &view, settings, &Resources::default());
        let mut session = session.expect("the film is small");
        while session.film().passes().len() < 4096 && session.step(&()) {}
        let pixels = session.film().develop().pixels;
        let mean = pixels.iter().copied().map(luminance).sum::<f32>() / pixels.len() as f32;
        check_close(trained, mean, tolerance, strategies);
    }

    /// Light images of pixels that are not rendered are none of the image: with them it would be more than
    /// twice as bright where light images alone make it.
    #[test]
    fn the_mean_is_that_of_the_image() {
        check_mean("all", 0.04);
        check_mean("all,-s0", 0.2);
    }
}
