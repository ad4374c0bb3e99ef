//! The results of a sample: subpaths, candidates, chosen rays and contributions, in buffers
//! that the next sample uses again. A value that no film can sum is dropped and counted here.

use super::lvc::LightCache;
use super::{Entry, Fate, Journal, Link};
use crate::camera::CameraRay;
use crate::contribution::{Contribution, Term, is_summable};
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::math::Vec2;
use crate::path::{
    Connections, PathContext, PathSettings, RunningSums, Strategy, Subpath, Vertex, camera_subpath,
    light_subpath,
};
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::scene::Scene;
use crate::select::{Candidate, Chosen, LightVertex};
use crate::spectrum::Spectrum;
use crate::stats::{Clock, Dropped, Stage, Stats, Stopwatch};
use crate::view::View;

/// One camera sample, with the light subpath that goes with it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The pass.
    pub pass: u64,
    /// The pixel.
    pub pixel: [u32; 2],
    /// The random numbers of the camera ray.
    pub ray: SampleStream,
    /// The random numbers of the camera subpath behind it, and of its connections.
    pub camera: SampleStream,
    /// The random numbers of the light subpath and of its light image.
    pub light: SampleStream,
}

impl Sample {
    /// The context of the sample, with the wavelengths that it draws.
    pub(crate) fn context<'a>(
        &self,
        scene: &'a Scene,
        view: &'a View,
        settings: &'a PathSettings,
        connections: Connections<'a>,
    ) -> PathContext<'a> {
        let u = self.camera.get_1d(Dimension::at(0, Purpose::Wavelengths));
        PathContext {
            scene,
            view,
            settings,
            wavelengths: scene.color().sample_wavelengths(u),
            connections,
        }
    }
}

/// A contribution to the light image.
#[derive(Clone, Copy, Debug)]
pub struct Splat {
    /// The contribution that is added.
    pub contribution: Contribution,
    /// Its place.
    pub place: SplatPlace,
}

/// A light subpath that a sample brings to its group, with its light images and the journal of their terms.
#[derive(Debug, Default)]
pub(crate) struct BroughtLight {
    subpath: Subpath,
    splats: Vec<Splat>,
    entries: Vec<Entry>,
}

/// The state that a thread keeps from sample to sample, so that no sample allocates: buffers, the
/// contributions of the last sample, and counters.
#[derive(Debug, Default)]
pub struct Workspace {
    /// The camera subpath.
    pub camera: Subpath,
    /// The light subpath.
    pub light: Subpath,
    /// The light points of s = 1, in the order of the camera vertices that they were drawn for.
    pub next_events: Vec<Vertex>,
    /// The connections that may be traced.
    pub candidates: Vec<Candidate>,
    /// The connections that were traced.
    pub chosen: Vec<Chosen>,
    /// The contributions to the sample's own pixel.
    pub contributions: Vec<Contribution>,
    /// Their sum.
    pub value: Spectrum,
    /// The contributions to the light image.
    pub splats: Vec<Splat>,
    /// The luminance that the sample adds to its own pixel by each strategy that has an image in the film.
    pub(crate) luminances: Vec<(Strategy, f64)>,
    /// The number of terms so far.
    terms: u32,
    /// The counters.
    pub stats: Stats,
    /// The outcome of every term; kept if somebody asks for it.
    pub journal: Option<Journal>,
    /// Measures stages, where the host has a clock for it.
    pub stopwatch: Stopwatch,
    /// Weights of the paths that the two subpaths make.
    pub(super) weights: RunningSums,
    /// The light subpaths that some samples share.
    pub(super) light_cache: LightCache,
}

impl Workspace {
    /// A workspace that keeps a journal.
    pub(crate) fn with_journal() -> Self {
        Self {
            journal: Some(Journal::default()),
            ..Self::default()
        }
    }

    /// A workspace that measures its stages where there is a clock.
    pub(crate) fn timed_by(clock: Option<Clock>) -> Self {
        Self {
            stopwatch: Stopwatch::new(clock),
            ..Self::default()
        }
    }

    /// Forgets the last sample.
    pub(super) fn begin(&mut self) {
        self.camera.clear();
        self.light.clear();
        self.next_events.clear();
        self.candidates.clear();
        self.chosen.clear();
        self.contributions.clear();
        self.splats.clear();
        self.value = Spectrum::ZERO;
        self.terms = 0;
        if let Some(journal) = &mut self.journal {
            journal.entries.clear();
        }
    }

    /// Walks the camera subpath of `sample`.
    pub(super) fn walk_camera(&mut self, context: &PathContext<'_>, sample: &Sample) {
        self.stats.samples += 1;
        let (ray, weight) = camera_ray(context, sample);
        let (camera, stats) = (&mut self.camera, &mut self.stats);
        camera_subpath(context, &sample.camera, &ray, weight, camera, stats);
        self.stopwatch.end(Stage::Walk);
    }

    /// Walks the light subpath of `sample`.
    pub(super) fn walk_light(&mut self, context: &PathContext<'_>, sample: &Sample) {
        light_subpath(context, &sample.light, &mut self.light, &mut self.stats);
        self.stopwatch.end(Stage::Walk);
    }

    /// Prepares the weights of the paths that the two subpaths make.
    pub(super) fn sum_weights(&mut self, context: &PathContext<'_>) {
        self.weights.sum(context, &self.light, &self.camera);
        self.stopwatch.end(Stage::Walk);
    }

    /// The vertices that a candidate connects: light vertex and camera vertex.
    #[inline]
    pub(crate) fn vertices(&self, strategy: Strategy, light_vertex: LightVertex) -> [&Vertex; 2] {
        let (s, t) = (usize::from(strategy.s), usize::from(strategy.t));
        let light = match light_vertex {
            LightVertex::Cached(number) => self.light_cache.get(number as usize).light,
            _ => own_light_vertices(&self.light, &self.next_events, s, light_vertex),
        };
        [&light[s - 1], &self.camera.vertices[t - 1]]
    }

    /// The ends of the segment that a candidate connects.
    #[inline]
    pub(super) fn ends(&self, strategy: Strategy, light_vertex: LightVertex) -> [Locus; 2] {
        let vertices = self.vertices(strategy, light_vertex);
        vertices.map(|vertex| vertex.locus)
    }

    /// The candidates, each with what of it arrived, if anything.
    pub(crate) fn connections(&self) -> impl Iterator<Item = (&Candidate, Option<&Contribution>)> {
        let mut contributions = self.contributions.iter().peekable();
        self.candidates.iter().map(move |candidate| {
            // Both are in the order of terms; hits are no candidates.
            let number = candidate.term.number;
            while contributions.next_if(|c| c.term.number < number).is_some() {}
            (
                candidate,
                contributions.next_if(|c| c.term.number == number),
            )
        })
    }

    /// Counts a term that is not zero, and numbers it; `link` is asked for the journal only.
    #[inline]
    pub(super) fn count(&mut self, term: Term, link: impl FnOnce(&Self) -> Link) -> Term {
        self.stats.count_candidate(term.strategy);
        if let Some(mut journal) = self.journal.take() {
            journal.begin(term, link(self));
            self.journal = Some(journal);
        }
        let number = self.terms;
        self.terms += 1;
        Term { number, ..term }
    }

    /// True where a contribution can be summed; else it is counted as dropped.
    pub(super) fn accepts(&mut self, sample: &Sample, term: &Term, value: Spectrum) -> bool {
        let fine = is_summable(value);
        if !fine {
            let dropped = Dropped {
                pass: sample.pass,
                pixel: sample.pixel,
                strategy: term.strategy,
            };
            self.stats.drop_contribution(dropped);
            self.note(term, Fate::Dropped, Spectrum::ZERO);
        }
        fine
    }

    /// Adds a contribution to the sample's own pixel, if it can be summed.
    pub(super) fn add(&mut self, sample: &Sample, contribution: Contribution) {
        let (term, value) = (&contribution.term, contribution.value());
        if self.accepts(sample, term, value) {
            self.contributions.push(contribution);
            self.value += value;
            self.note(term, Fate::Added, value);
        }
    }

    /// Adds the light that a camera walk found by itself: s = 0.
    pub(super) fn add_hit(&mut self, sample: &Sample, term: Term) {
        let term = self.count(term, |_| Link::Walk);
        self.add(sample, term.certain(1.0));
    }

    /// Adds a contribution to the light image.
    pub(super) fn add_splat(&mut self, splat: Splat) {
        self.splats.push(splat);
        let Contribution { term, .. } = &splat.contribution;
        self.note(term, Fate::Added, splat.contribution.value());
    }

    /// Takes the light subpath that was walked last.
    pub(crate) fn take_light(&mut self) -> BroughtLight {
        let entries = self.journal.iter().flat_map(|journal| &journal.entries);
        BroughtLight {
            entries: entries.copied().collect(),
            subpath: std::mem::take(&mut self.light),
            splats: std::mem::take(&mut self.splats),
        }
    }

    /// Puts the light images of such a subpath beside what the sample left; returns the subpath.
    pub(crate) fn add_light(&mut self, brought: BroughtLight) -> Subpath {
        self.splats.extend(brought.splats);
        if let Some(journal) = &mut self.journal {
            journal.entries.extend(brought.entries);
        }
        brought.subpath
    }

    /// Traces the shadow ray of a term: how much of it arrives. None: nothing.
    pub(super) fn trace(&mut self, scene: &Scene, term: &Term, [a, b]: &[Locus; 2]) -> Option<f32> {
        self.stats.count_shadow_ray(term.strategy);
        let transmittance = scene.transmittance(a, b);
        if transmittance > 0.0 {
            return Some(transmittance);
        }
        self.stats.count_blocked(term.strategy);
        self.note(term, Fate::Blocked, Spectrum::ZERO);
        None
    }

    /// Completes the journal of a term.
    #[inline]
    fn note(&mut self, term: &Term, fate: Fate, added: Spectrum) {
        if let Some(journal) = &mut self.journal {
            journal.end(term.number, fate, added);
        }
    }
}

/// The ray of a camera sample, and the weight of its film position.
pub(crate) fn camera_ray(context: &PathContext<'_>, sample: &Sample) -> (CameraRay, f32) {
    let get = |purpose| sample.ray.get_2d(Dimension::at(0, purpose));
    let (offset, weight) = context.view.film().filter.sample(get(Purpose::Film));
    let raster = Vec2::new(sample.pixel[0] as f32, sample.pixel[1] as f32) + 0.5 + offset;
    let ray = context
        .view
        .camera()
        .sample_ray(raster, || get(Purpose::Lens));
    (ray, weight)
}

/// The first `s` light vertices of a connection that uses none of the light cache.
#[inline]
pub(super) fn own_light_vertices<'a>(
    light: &'a Subpath,
    next_events: &'a [Vertex],
    s: usize,
    light_vertex: LightVertex,
) -> &'a [Vertex] {
    match light_vertex {
        LightVertex::NextEvent(number) => std::slice::from_ref(&next_events[number as usize]),
        _ => &light.vertices[..s],
    }
}
