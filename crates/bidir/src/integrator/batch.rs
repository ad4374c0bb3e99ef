//! The samples in flight, and what each stage leaves for the next: arrays that the next batch uses again.

use super::cache::{LightCache, Place};
use super::stages::{ShadowPassage, lens_vertex};
use super::{Entry, Fate, Link, List};
use crate::contribution::{Term, is_summable};
use crate::path::{
    Arrival, ConnectionPart, Job, JoinedPath, PathDensities, RunningSums, Shares, Subpaths, Weights,
};
use crate::sampler::SampleStream;
use crate::scene::ShadowRays;
use crate::select::{Candidate, Chosen};
use crate::spectrum::Spectrum;
use crate::stats::{Clock, Dropped, Stats, Stopwatch};
use crate::strategy::Strategy;

/// One camera sample, with the light subpath that goes with it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The pass.
    pub pass: u64,
    /// The pixel.
    pub pixel: [u32; 2],
    /// The random numbers of the camera subpath, and of its connections.
    pub camera: SampleStream,
    /// The random numbers of the light points of the camera subpath.
    pub points: SampleStream,
    /// The random numbers of the light subpath and of its light image.
    pub light: SampleStream,
}

impl Sample {
    /// Returns the sample of `pixel` in `pass` with the random numbers of its camera subpath and of its light subpath.
    #[inline]
    pub fn new(pass: u64, pixel: [u32; 2], camera: SampleStream, light: SampleStream) -> Self {
        Self {
            pass,
            pixel,
            camera,
            points: camera,
            light,
        }
    }
}

/// A light vertex that a camera vertex is connected with.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LightEnd {
    /// Its place.
    pub(super) place: Place,
    /// Its number in the sample, as [`Candidate::light_vertex`] has it.
    pub(super) number: u32,
    /// How much the connection counts.
    pub(super) share: f32,
}

impl LightEnd {
    /// Vertex number `z` of all, a point on `light` by next-event estimation.
    #[inline]
    pub(super) fn point(z: usize, light: u32) -> Self {
        Self {
            place: Place {
                z: z as u32,
                s: 1,
                is_diffuse: false,
                light,
            },
            number: 0,
            share: 1.0,
        }
    }

    /// Returns the term of its connection with camera vertex number `t`.
    #[inline(always)]
    pub(super) fn term(&self, t: usize, contribution: Spectrum, weight: f32) -> Term {
        Term {
            strategy: Strategy::new(self.place.s.into(), t),
            light: self.place.light,
            contribution,
            weight,
        }
    }

    /// Returns the candidate that is such a `term`, with number `y` of all camera vertices.
    #[inline(always)]
    pub(super) fn candidate(&self, term: Term, score: f32, y: u32) -> Candidate {
        Candidate {
            term,
            score: Candidate::score(score),
            vertices: [self.place.z, y],
            light_vertex: self.number,
        }
    }
}

/// A light point of next-event estimation.
#[derive(Clone, Copy, Debug)]
pub(super) struct NextEvent {
    /// The sample, by number.
    pub(super) sample: u32,
    /// The number of the camera vertex that it was drawn for.
    pub(super) t: u32,
    /// The point as a light vertex.
    pub(super) end: LightEnd,
    /// e, the density that it was drawn with.
    pub(super) pdf: f32,
}

/// The samples in flight, with all that was made of them so far.
#[derive(Debug, Default)]
pub struct Batch {
    /// The samples.
    pub samples: Vec<Sample>,
    /// The camera subpath of each sample.
    pub camera: Subpaths,
    /// Light subpaths: of each sample, or of the group that shares them; and the light points of s = 1.
    pub light: Subpaths,
    pub(super) next_events: Vec<NextEvent>,
    pub(super) camera_sums: RunningSums,
    pub(super) light_sums: RunningSums,
    pub(super) weights: Weights,
    pub(super) cache: LightCache,
    /// The vertices of light subpaths that camera vertices are connected with, camera vertex by camera vertex.
    pub(super) light_ends: List<LightEnd>,
    /// For each camera vertex from t = 2 on the end of its light vertices.
    pub(super) light_ends_end: Vec<usize>,
    /// The connections that may be traced, sample by sample.
    pub candidates: List<Candidate>,
    /// For each sample the end of its candidates.
    pub(super) candidates_end: Vec<usize>,
    /// Connections that are not offered: their value is zero, or no film can sum it.
    pub(crate) unoffered: Vec<Candidate>,
    /// The candidates that were chosen; the last of the entries are theirs.
    pub chosen: Vec<Chosen>,
    /// The terms for the samples' own pixels.
    pub entries: Vec<Entry>,
    /// Their sum for each sample.
    pub values: Vec<Spectrum>,
    /// The terms of the light image.
    pub splats: Vec<Entry>,
    pub(super) shadow_rays: ShadowRays,
    /// Memory of the driver: the luminance that each sample adds to its own pixel by a strategy.
    pub(crate) luminances: Vec<((u32, Strategy), f64)>,
    /// The counters.
    pub stats: Stats,
    /// Measures stages, where the host has a clock for it.
    pub stopwatch: Stopwatch,
}

impl Batch {
    /// Makes a batch that measures its stages where there is a clock.
    pub(crate) fn timed_by(clock: Option<Clock>) -> Self {
        Self {
            stopwatch: Stopwatch::new(clock),
            ..Self::default()
        }
    }

    /// Replaces the samples, and clears the output of all stages but light subpaths.
    pub fn fill(&mut self, samples: impl IntoIterator<Item = Sample>) {
        self.samples.clear();
        self.samples.extend(samples);
        self.camera.clear();
        self.camera_sums.clear();
        self.light.forget_points();
        self.next_events.clear();
        self.light_ends.clear();
        self.light_ends_end.clear();
        self.candidates.clear();
        self.candidates_end.clear();
        self.unoffered.clear();
        self.chosen.clear();
        self.entries.clear();
        self.splats.clear();
        self.values.clear();
        self.values.resize(self.samples.len(), Spectrum::ZERO);
    }

    /// Clears the light subpaths, with their sums and the cache.
    pub(super) fn forget_light(&mut self) {
        self.light.clear();
        self.light_sums.clear();
        self.cache.clear();
    }

    /// Returns the number of the first sample's light subpath, where each has its own.
    pub(super) fn first_light(&self) -> usize {
        self.light.count() - self.samples.len()
    }

    /// Returns true if a connection is evaluated together with others: both of its vertices are diffuse.
    pub(crate) fn is_diffuse(&self, connection: &Candidate) -> bool {
        let [z, y] = connection.vertices.map(|number| number as usize);
        self.light_sums.diffuse(z).is_some() && self.camera_sums.diffuse(y).is_some()
    }

    /// Returns the candidates, each with its entry if it was chosen.
    pub(crate) fn connections(&self) -> impl Iterator<Item = (&Candidate, Option<&Entry>)> {
        let mut entries = vec![None; self.candidates.len()];
        let of_chosen = &self.entries[self.entries.len() - self.chosen.len()..];
        for (chosen, entry) in self.chosen.iter().zip(of_chosen) {
            entries[chosen.candidate as usize] = Some(entry);
        }
        self.candidates.iter().zip(entries)
    }

    /// Returns the entry of a candidate that was not chosen, or was not offered.
    pub(crate) fn untraced(&self, candidate: &Candidate) -> Entry {
        let fate = if is_summable(candidate.term.value()) {
            Fate::NotTraced
        } else {
            Fate::Dropped
        };
        let link = Link::Connection(candidate.ends(&self.light, &self.camera));
        let entry = Entry::certain(0, candidate.term, link);
        Entry { fate, ..entry }
    }

    /// Returns the shares of the path of `entry`; `candidate` is the candidate that it was, if it was one. None: the
    /// sample has no such path. `parts` gets those of single connections.
    pub(crate) fn shares(
        &self,
        job: &Job<'_>,
        entry: &Entry,
        candidate: Option<&Candidate>,
        densities: &mut PathDensities,
        parts: &mut Vec<ConnectionPart>,
    ) -> Option<Shares> {
        let (number, term) = (entry.sample as usize, &entry.contribution.term);
        let (s, t) = (usize::from(term.strategy.s), usize::from(term.strategy.t));
        let walk = self.camera.get(number);
        let passage = entry
            .link
            .ends()
            .map(|ends| ShadowPassage::between(job, || *ends));
        let edge = passage.as_ref().and_then(ShadowPassage::edge);
        let mut shares = |mut path: JoinedPath<'_>| {
            if let Some(edge) = edge {
                path.pass(edge);
            }
            path.shares(job, densities, parts)
        };
        Some(match candidate {
            Some(candidate) => {
                let z = candidate.vertices[0] as usize;
                let light = &self.light.vertices()[z + 1 - s..=z];
                shares(JoinedPath::connection(light, &walk.vertices[..t]))
            }
            None if s == 0 => {
                let arrival = Arrival::of(job.scene, &walk, t - 1, term.light)?;
                let x0 = arrival.vertex(job);
                shares(JoinedPath::hit(&x0, &walk.vertices[..t - 1]))
            }
            None => {
                let lens = lens_vertex(job, &self.samples[number], s);
                let light = &self.light.get(self.first_light() + number).vertices[..s];
                shares(JoinedPath::connection(light, std::slice::from_ref(&lens)))
            }
        })
    }

    /// Adds the entries to the values of their samples, but for those that no film can sum.
    pub(super) fn arrive(&mut self) {
        for entry in &mut self.entries {
            if !entry.is_added() {
                continue;
            }
            let value = entry.contribution.value();
            if is_summable(value) {
                self.values[entry.sample as usize] += value;
            } else {
                entry.fate = Fate::Dropped;
                let sample = &self.samples[entry.sample as usize];
                drop_term(&mut self.stats, sample, entry.contribution.term.strategy);
            }
        }
    }
}

/// Counts a term of sample number `number` that is certain to take part, and adds its entry, untraced, to `entries`.
#[inline]
pub(super) fn enter<'e>(
    entries: &'e mut Vec<Entry>,
    stats: &mut Stats,
    (number, sample): (usize, &Sample),
    term: Term,
    link: Link,
) -> &'e mut Entry {
    stats.count_candidate(term.strategy);
    let last = entries.len();
    entries.push(Entry::certain(number, term, link));
    let entry = &mut entries[last];
    if !is_summable(term.value()) {
        drop_term(stats, sample, term.strategy);
        entry.fate = Fate::Dropped;
    }
    entry
}

/// Counts a term of `sample` that no film can sum.
#[cold]
pub(super) fn drop_term(stats: &mut Stats, sample: &Sample, strategy: Strategy) {
    stats.drop_contribution(Dropped {
        pass: sample.pass,
        pixel: sample.pixel,
        strategy,
    });
}
