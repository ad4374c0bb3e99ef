//! s ≥ 1 and t ≥ 2: the connections of light vertices with camera vertices, before visibility.

use super::super::batch::{NextEvent, drop_term};
use super::super::cache::{LightCache, Place};
use super::super::{Batch, CandidateCount, Sample};
use super::pairs::Pairs;
use crate::contribution::{Term, is_summable};
use crate::path::{
    Job, JoinedPath, LightSums, PathContext, PathSums, RunningSums, Subpath, Subpaths, Vertex,
    Weights,
};
use crate::sampler::{Dimension, Purpose};
use crate::select::Candidate;
use crate::spectrum::Spectrum;
use crate::stats::{Stage, Stats};
use crate::strategy::Strategy;

/// The origin of light vertices, besides those of next-event estimation.
#[derive(Clone, Copy)]
pub(in super::super) enum Source {
    /// The sample's own light subpath.
    Own,
    /// The light vertex cache, by so many draws for each camera vertex.
    Cache(CandidateCount),
}

/// Evaluates the connections of all camera vertices.
#[inline(never)]
pub(in super::super) fn connect(job: &Job<'_>, batch: &mut Batch, source: Source) {
    let first = match source {
        Source::Own => batch.first_light(),
        Source::Cache(_) => 0,
    };
    let Batch {
        samples,
        camera,
        light,
        next_events,
        camera_sums,
        light_sums,
        cache,
        weights,
        candidates,
        candidates_end,
        unoffered,
        stats,
        ..
    } = batch;
    let lights = Lights {
        walks: light,
        sums: light_sums,
        cache,
    };
    let of_sample = next_events.chunk_by(|a, b| a.sample == b.sample);
    let mut of_sample = of_sample.peekable();
    for (number, sample) in samples.iter().enumerate() {
        let walk = camera.get(number);
        let connector = Connector {
            context: sample.context(job),
            sample,
            camera: walk,
            camera_sums: camera_sums.camera(walk.first),
            weights,
            candidates,
            unoffered,
            stats,
        };
        let next_events = of_sample.next_if(|events| events[0].sample as usize == number);
        let next_events = next_events.unwrap_or_default();
        connector.offer_all(next_events, &lights, source, first + number);
        candidates_end.push(candidates.len());
    }
    debug_assert!(of_sample.next().is_none());
    batch.stopwatch.end(Stage::Candidates);
}

/// All light vertices.
struct Lights<'a> {
    walks: &'a Subpaths,
    sums: &'a RunningSums,
    cache: &'a LightCache,
}

/// A light vertex to connect, with the subpath up to it.
struct LightEnd<'a> {
    /// From x_0 to the vertex.
    vertices: &'a [Vertex],
    sums: LightSums<'a>,
    /// The number of the vertex among all light vertices.
    z: usize,
    /// The number of the vertex in the sample; 0 for all light points of next-event estimation.
    number: usize,
    /// How much its connection counts.
    share: f32,
}

impl<'a> Lights<'a> {
    /// A light point of next-event estimation.
    #[inline]
    fn point(&self, z: usize) -> LightEnd<'a> {
        LightEnd {
            vertices: std::slice::from_ref(&self.walks.vertices()[z]),
            sums: LightSums::NONE,
            z,
            number: 0,
            share: 1.0,
        }
    }

    /// The vertex at `place`.
    #[inline]
    fn at(&self, place: Place) -> LightEnd<'a> {
        let Place { z, subpath, s } = place;
        let (z, s) = (z as usize, usize::from(s));
        LightEnd {
            vertices: &self.walks.vertices()[z + 1 - s..=z],
            sums: self.sums.light(subpath as usize, z + 1 - s),
            z,
            number: s - 1,
            share: 1.0,
        }
    }
}

/// Connects the camera subpath of a sample.
struct Connector<'a> {
    context: PathContext<'a>,
    sample: &'a Sample,
    camera: Subpath<'a>,
    camera_sums: &'a [f64],
    weights: &'a mut Weights,
    candidates: &'a mut Vec<Candidate>,
    unoffered: &'a mut Vec<Candidate>,
    stats: &'a mut Stats,
}

impl Connector<'_> {
    /// Connects all camera vertices with the sample's light points and with other light vertices; `number` is that
    /// of its own light subpath.
    fn offer_all(
        mut self,
        next_events: &[NextEvent],
        lights: &Lights<'_>,
        source: Source,
        number: usize,
    ) {
        let mut pairs = Pairs::new(&self.context, &self.sample.camera);
        let mut next_events = next_events.iter().peekable();
        for t in 2..=self.camera.vertices.len() {
            if self.camera.vertices[t - 1].is_delta() {
                continue;
            }
            // Light points are drawn in the same order.
            while let Some(event) = next_events.next_if(|event| event.t as usize == t) {
                self.offer(t, &lights.point(event.z));
            }
            match source {
                Source::Own => self.offer_own(t, lights, number, &mut pairs),
                Source::Cache(counts) => self.offer_cached(t, lights, counts.at(t)),
            }
        }
        debug_assert!(next_events.next().is_none());
    }

    /// Connects camera vertex number `t` with the vertices of the sample's own light subpath.
    fn offer_own(&mut self, t: usize, lights: &Lights<'_>, number: usize, pairs: &mut Pairs) {
        let settings = self.context.job.settings;
        let walk = lights.walks.get(number);
        let longest = walk.vertices.len().min(settings.max_vertices() - t);
        for s in settings.light_point.first_walked()..=longest {
            if let Some(share) = pairs.take(s + t) {
                let end = lights.at(Place {
                    z: (walk.first + s - 1) as u32,
                    subpath: number as u32,
                    s: s as u16,
                });
                self.offer(t, &LightEnd { share, ..end });
            }
        }
    }

    /// Connects camera vertex number `t` with `count` vertices of the cache, one of each of as many parts of it.
    fn offer_cached(&mut self, t: usize, lights: &Lights<'_>, count: u16) {
        let proposals = self.context.job.guide.proposals;
        let at = Dimension::at(t - 1, Purpose::CachedVertex);
        let u = f64::from(self.sample.camera.get_1d(at));
        let cell = self.camera.vertices[t - 1].cell;
        for m in 0..count {
            let u = (f64::from(m) + u) / f64::from(count);
            let Some(draw) = lights.cache.draw(proposals, cell, u) else {
                continue;
            };
            let place = lights.cache.place(draw.entry);
            if usize::from(place.s) + t <= self.context.job.settings.max_vertices() {
                let end = LightEnd {
                    number: draw.entry + 1,
                    share: (draw.share / f64::from(count)) as f32,
                    ..lights.at(place)
                };
                self.offer(t, &end);
            }
        }
    }

    /// Evaluates a connection, and offers it for selection. It is compared by its luminance times the √V̂ of its
    /// shadow ray.
    #[inline]
    fn offer(&mut self, t: usize, end: &LightEnd<'_>) {
        let Some(term) = self.term(t, end) else {
            return;
        };
        self.stats.count_candidate(term.strategy);
        let value = term.value();
        let luminance = self.context.luminance(value.map(f32::abs));
        let [z, y] = [
            &end.vertices[end.vertices.len() - 1],
            &self.camera.vertices[t - 1],
        ];
        let candidate = Candidate {
            term,
            score: Candidate::score(luminance * self.context.root_visibility(z, y)),
            vertices: [end.z, self.camera.first + t - 1].map(|vertex| vertex as u32),
            light_vertex: end.number as u32,
        };
        if is_summable(value) && !value.is_black() {
            self.candidates.push(candidate);
        } else {
            self.set_aside(candidate);
        }
    }

    #[cold]
    fn set_aside(&mut self, candidate: Candidate) {
        if !is_summable(candidate.term.value()) {
            drop_term(self.stats, self.sample, candidate.term.strategy);
        }
        self.unoffered.push(candidate);
    }

    /// The term of a connection. None: it is zero.
    #[inline]
    fn term(&mut self, t: usize, end: &LightEnd<'_>) -> Option<Term> {
        let s = end.vertices.len();
        if !self.context.takes(s, t) {
            return None;
        }
        let light = end.vertices[0].light?;
        let path = JoinedPath::connection(end.vertices, &self.camera.vertices[..t]);
        let contribution = path.contribution(&self.context);
        (contribution != Spectrum::ZERO).then(|| {
            let sums = PathSums {
                light: end.sums,
                camera: self.camera_sums,
            };
            Term {
                strategy: Strategy::new(s, t),
                light,
                contribution: contribution * end.share,
                weight: self.weights.weight(&self.context, &path, &sums),
            }
        })
    }
}
