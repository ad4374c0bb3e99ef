//! s ≥ 1 and t ≥ 2: the connections of light vertices with camera vertices, before visibility.
//!
//! Any two vertices are connected by [`JoinedPath`], whose contribution and weight are the definition. Where both are
//! diffuse, or one is and the other is a light point, `diffuse` finds the same numbers faster.

use super::super::journal::drop_term;
use super::super::{Candidates, Sample, Walks, Worker};
use super::light_ends::{LightEnd, LightEnds, NextEvent};
use crate::contribution::is_summable;
use crate::path::{DiffuseEnd, EndSums, Job, JoinedPath, PathSums, Subpath};
use crate::select::Candidate;
use crate::spectrum::Spectrum;
use crate::stats::Stage;

/// Evaluates the connections of all camera vertices.
#[inline(never)]
pub(in super::super) fn connect(
    job: &Job<'_>,
    walks: &Walks,
    ends: &LightEnds,
    candidates: &mut Candidates,
    worker: &mut Worker,
) {
    // Its lists in `ends`.
    let mut list = 0;
    for (i, sample) in walks.samples.iter().enumerate() {
        let mut connector = Connector {
            job,
            sample,
            walks,
            camera: walks.camera.get(i),
            candidates,
            worker,
        };
        for t in 2..=connector.camera.vertices.len() {
            for event in ends.points.get(list) {
                connector.offer_next_event(t, event);
            }
            connector.offer_vertices(t, ends.vertices.get(list));
            list += 1;
        }
        candidates.offered.close();
    }
    for found in [&candidates.offered[..], &candidates.unoffered] {
        let strategies = found.iter().map(|candidate| candidate.term.strategy);
        worker.stats.count_connections(strategies);
    }
    worker.stopwatch.end(Stage::Candidates);
}

/// A connection that is not zero, before visibility.
#[derive(Clone, Copy)]
pub(super) struct Connection {
    /// C.
    pub(super) contribution: Spectrum,
    /// T of the media between its ends, where it is known before its shadow ray is traced; else 1.
    pub(super) transmittance: Spectrum,
    pub(super) weight: f32,
    /// The factor of its score: √V̂ of its shadow ray, times a guess at the mean of T.
    pub(super) score_factor: f32,
}

/// Connects the camera subpath of a sample.
pub(super) struct Connector<'a> {
    pub(super) job: &'a Job<'a>,
    sample: &'a Sample,
    pub(super) walks: &'a Walks,
    pub(super) camera: Subpath<'a>,
    pub(super) candidates: &'a mut Candidates,
    worker: &'a mut Worker,
}

impl<'a> Connector<'a> {
    /// Connects camera vertex number `t` with vertices of light subpaths.
    fn offer_vertices(&mut self, t: usize, ends: &[LightEnd]) {
        self.candidates.offered.open().make_room(ends.len());
        if let Some(y) = self.diffuse(t) {
            self.offer_diffuse(t, y, ends);
        } else {
            for end in ends {
                self.offer_general(t, end);
            }
        }
    }

    /// Returns camera vertex number `t` for connections with diffuse ones. None: it is no diffuse one.
    fn diffuse(&self, t: usize) -> Option<&'a DiffuseEnd> {
        self.walks.camera.sums.diffuse(self.camera.first + t - 1)
    }

    /// Connects camera vertex number `t` with a light point that was drawn for it.
    fn offer_next_event(&mut self, t: usize, NextEvent { end, pdf }: &NextEvent) {
        self.candidates.offered.open().make_room(1);
        let connection = match self.diffuse(t) {
            Some(y) => self.diffuse_next_event(t, y, end, *pdf),
            None => self.general(t, end, Some(*pdf)),
        };
        if let Some(connection) = connection {
            self.offer(t, end, connection);
        }
    }

    /// Connects camera vertex number `t` with a vertex of a light subpath, whatever both are.
    pub(super) fn offer_general(&mut self, t: usize, end: &LightEnd) {
        if let Some(connection) = self.general(t, end, None) {
            self.offer(t, end, connection);
        }
    }

    /// Returns the connection of any two vertices; `next_event` is the density of a light point that was drawn for the
    /// camera vertex. None: it is zero. The weight takes a guess of media, unless the scene foresees them.
    fn general(&mut self, t: usize, end: &LightEnd, next_event: Option<f32>) -> Option<Connection> {
        let (z, s) = (end.vertex.z as usize, usize::from(end.vertex.s));
        let light = &self.walks.light.vertices()[z + 1 - s..=z];
        let mut path = JoinedPath::new(light, &self.camera.vertices[..t]);
        let contribution = path.contribution(self.job);
        if contribution == Spectrum::ZERO {
            return None;
        }
        let sums = PathSums {
            light: match next_event {
                Some(_) => &EndSums::NONE,
                None => self.walks.light.sums.at(z),
            },
            camera: self.walks.camera.sums.at(self.camera.first + t - 1),
            next_event,
        };
        let (z, y) = (path.z(), path.y());
        let mut score_factor = self.job.root_visibility(z, y);
        let scene = self.job.scene;
        let mut transmittance = Spectrum::ONE;
        if !scene.is_clear(&z.locus, &y.locus) {
            let (a, b, lanes) = (&z.locus, &y.locus, self.job.lanes);
            let edge = if scene.foresees_media() {
                let edge = scene.foreseen_edge(a, b, lanes)?;
                transmittance = edge.transmittance;
                edge
            } else {
                scene.guessed_edge(a, b, lanes)
            };
            path.segment.pass(&edge);
            score_factor *= self.job.lanes.mean(edge.transmittance);
        }
        Some(Connection {
            contribution,
            transmittance,
            weight: self.worker.weights.connection(self.job, &path, &sums),
            score_factor,
        })
    }

    /// Offers a connection for selection, unless it is zero. It is compared by the mean of its lanes times the √V̂ of its
    /// shadow ray.
    #[inline]
    pub(super) fn offer(&mut self, t: usize, end: &LightEnd, connection: Connection) {
        if connection.contribution.is_black() {
            return;
        }
        let in_vacuum = connection.contribution * end.share;
        let value = in_vacuum * connection.weight;
        let score = self.job.lanes.mean(value.map(f32::abs)) * connection.score_factor;
        let contribution = in_vacuum * connection.transmittance;
        let numbers = [t, self.camera.first + t - 1];
        let candidate = end.candidate(numbers, contribution, connection.weight, score);
        if is_summable(value) & !value.is_black() {
            self.candidates.offered.open().write(candidate, 1);
        } else {
            self.set_aside(candidate);
        }
    }

    #[cold]
    fn set_aside(&mut self, candidate: Candidate) {
        if !is_summable(candidate.term.value()) {
            drop_term(&mut self.worker.stats, self.sample, candidate.term.strategy);
        }
        self.candidates.unoffered.push(candidate);
    }
}
