//! s ≥ 1 and t ≥ 2: the connections of light vertices with camera vertices, before visibility.

use super::super::batch::{NextEvent, drop_term};
use super::super::cache::CachedEnd;
use super::super::{Batch, Sample};
use super::pairs::Pairs;
use crate::contribution::{Term, is_summable};
use crate::path::{
    DiffuseEnd, EndSums, Job, JoinedPath, PathContext, PathSums, RunningSums, Subpath, Subpaths,
    Vertex, Weights,
};
use crate::select::Candidate;
use crate::spectrum::Spectrum;
use crate::stats::{Stage, Stats};
use crate::strategy::Strategy;
use std::iter::Peekable;
use std::slice::Iter;

/// The origin of light vertices, besides those of next-event estimation.
#[derive(Clone, Copy)]
pub(in super::super) enum Source {
    /// The sample's own light subpath.
    Own,
    /// The light vertex cache, of which [`draw_cached`](super::draw_cached) drew some.
    Cache,
}

/// Evaluates the connections of all camera vertices.
#[inline(never)]
pub(in super::super) fn connect(job: &Job<'_>, batch: &mut Batch, source: Source) {
    let first = match source {
        Source::Own => batch.first_light(),
        Source::Cache => 0,
    };
    let Batch {
        samples,
        camera,
        light,
        next_events,
        camera_sums,
        light_sums,
        cached,
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
    };
    let mut drawn = Drawn {
        next_events: next_events.iter().peekable(),
        cached: cached.iter().peekable(),
    };
    for (number, sample) in samples.iter().enumerate() {
        let walk = camera.get(number);
        let connector = Connector {
            context: sample.context(job),
            sample,
            camera: walk,
            camera_sums,
            weights,
            candidates,
            unoffered,
            stats,
        };
        let own = match source {
            Source::Own => Some(first + number),
            Source::Cache => None,
        };
        connector.offer_all(number, &lights, &mut drawn, own);
        candidates_end.push(candidates.len());
    }
    debug_assert!(drawn.next_events.next().is_none() && drawn.cached.next().is_none());
    batch.stopwatch.end(Stage::Candidates);
}

/// All light vertices.
struct Lights<'a> {
    walks: &'a Subpaths,
    sums: &'a RunningSums,
}

/// The light vertices that were drawn for camera vertices, in the order of these.
struct Drawn<'a> {
    next_events: Peekable<Iter<'a, NextEvent>>,
    cached: Peekable<Iter<'a, CachedEnd>>,
}

/// A light vertex to connect, with the subpath up to it.
struct LightEnd<'a> {
    /// From x_0 to the vertex.
    vertices: &'a [Vertex],
    sums: &'a EndSums,
    /// The vertex as a diffuse one.
    diffuse: Option<&'a DiffuseEnd>,
    /// The light that the subpath begins on.
    light: Option<u32>,
    /// The density of a light point that was drawn for the camera vertex.
    next_event: Option<f32>,
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
    fn point(&self, drawn: &NextEvent) -> LightEnd<'a> {
        let z = drawn.z;
        let point = &self.walks.vertices()[z];
        LightEnd {
            vertices: std::slice::from_ref(point),
            sums: &EndSums::NONE,
            diffuse: None,
            light: point.light,
            next_event: Some(drawn.pdf),
            z,
            number: 0,
            share: 1.0,
        }
    }

    /// A vertex of the cache.
    #[inline]
    fn cached(&self, cached: &CachedEnd) -> LightEnd<'a> {
        LightEnd {
            number: cached.entry as usize + 1,
            share: cached.share,
            light: cached.place.light,
            ..self.at(cached.place.z as usize, cached.place.s.into())
        }
    }

    /// Vertex number `z` of all, the last of `s` of its subpath.
    #[inline]
    fn at(&self, z: usize, s: usize) -> LightEnd<'a> {
        LightEnd {
            vertices: &self.walks.vertices()[z + 1 - s..=z],
            sums: self.sums.at(z),
            diffuse: self.sums.diffuse(z),
            light: None,
            next_event: None,
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
    camera_sums: &'a RunningSums,
    weights: &'a mut Weights,
    candidates: &'a mut Vec<Candidate>,
    unoffered: &'a mut Vec<Candidate>,
    stats: &'a mut Stats,
}

impl Connector<'_> {
    /// Connects all camera vertices of sample `number` with the light vertices that were drawn for them, and with
    /// its own light subpath, number `own`, if it has one.
    fn offer_all(
        mut self,
        number: usize,
        lights: &Lights<'_>,
        drawn: &mut Drawn<'_>,
        own: Option<usize>,
    ) {
        let mut pairs = Pairs::new(&self.context, &self.sample.camera);
        for t in 2..=self.camera.vertices.len() {
            if self.camera.vertices[t - 1].is_delta() {
                continue;
            }
            let is_due = |of: [u32; 2]| of == [number as u32, t as u32];
            while let Some(event) = drawn.next_events.next_if(|it| is_due([it.sample, it.t])) {
                self.offer(t, &lights.point(event));
            }
            while let Some(cached) = drawn.cached.next_if(|it| is_due([it.sample, it.t])) {
                self.offer(t, &lights.cached(cached));
            }
            if let Some(own) = own {
                self.offer_own(t, lights, own, &mut pairs);
            }
        }
    }

    /// Connects camera vertex number `t` with the vertices of the sample's own light subpath.
    fn offer_own(&mut self, t: usize, lights: &Lights<'_>, number: usize, pairs: &mut Pairs) {
        let settings = self.context.job.settings;
        let walk = lights.walks.get(number);
        let longest = walk.vertices.len().min(settings.max_vertices() - t);
        for s in settings.light_point.first_walked()..=longest {
            if let Some(share) = pairs.take(s + t) {
                let end = LightEnd {
                    light: walk.vertices[0].light,
                    share,
                    ..lights.at(walk.first + s - 1, s)
                };
                self.offer(t, &end);
            }
        }
    }

    /// Evaluates a connection, and offers it for selection. It is compared by its luminance times the √V̂ of its
    /// shadow ray.
    #[inline]
    fn offer(&mut self, t: usize, end: &LightEnd<'_>) {
        let Some((term, root_visibility)) = self.term(t, end) else {
            return;
        };
        self.stats.count_candidate(term.strategy);
        let value = term.value();
        let luminance = self.context.luminance(value.map(f32::abs));
        let candidate = Candidate {
            term,
            score: Candidate::score(luminance * root_visibility),
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

    /// The term of a connection, and the √V̂ of its shadow ray. None: the term is zero.
    #[inline]
    fn term(&mut self, t: usize, end: &LightEnd<'_>) -> Option<(Term, f32)> {
        let (s, y) = (end.vertices.len(), self.camera.first + t - 1);
        if !self.context.takes(s, t) {
            return None;
        }
        let light = end.light?;
        let (contribution, weight, root_visibility) =
            match (end.diffuse, self.camera_sums.diffuse(y)) {
                (Some(z), Some(y)) => {
                    let cells = [z.cell(), y.cell()];
                    let count = self.context.count(s, t, cells) as f32;
                    let (contribution, weight) = z.connect(y, count)?;
                    let guide = &self.context.job.guide;
                    (
                        contribution,
                        weight,
                        guide.root_visibility(cells[0], cells[1]),
                    )
                }
                _ => self.general(t, end)?,
            };
        let term = Term {
            strategy: Strategy::new(s, t),
            light,
            contribution: contribution * end.share,
            weight,
        };
        Some((term, root_visibility))
    }

    /// C of a connection of any two vertices, its weight, and the √V̂ of its shadow ray. None: C is zero. Media
    /// are guessed.
    fn general(&mut self, t: usize, end: &LightEnd<'_>) -> Option<(Spectrum, f32, f32)> {
        let mut path = JoinedPath::connection(end.vertices, &self.camera.vertices[..t]);
        let contribution = path.contribution(&self.context);
        if contribution == Spectrum::ZERO {
            return None;
        }
        let sums = PathSums {
            light: end.sums,
            camera: self.camera_sums.at(self.camera.first + t - 1),
            next_event: end.next_event,
        };
        let (z, y) = (path.z(), path.y());
        let mut arrives = self.context.root_visibility(z, y);
        let scene = self.context.job.scene;
        if !scene.is_clear(&z.locus, &y.locus) {
            let guess = scene.guessed_edge(&z.locus, &y.locus, &self.context.wavelengths);
            path.pass(&guess);
            arrives *= scene.color().mean(guess.transmittance);
        }
        let weight = self.weights.weight(&self.context, &path, &sums);
        Some((contribution, weight, arrives))
    }
}
