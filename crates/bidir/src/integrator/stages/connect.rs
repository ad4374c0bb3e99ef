//! s ≥ 1 and t ≥ 2: the connections of light vertices with camera vertices, before visibility.

use super::super::batch::{LightEnd, drop_term};
use super::super::{Batch, List, Sample};
use crate::contribution::is_summable;
use crate::guide::CellGuide;
use crate::math::fixed::LARGEST_CONTRIBUTION;
use crate::path::{
    DiffuseConnections, DiffuseEnd, EndSums, Job, JoinedPath, PathSums, RunningSums, Subpath,
    Subpaths, Weights,
};
use crate::select::Candidate;
use crate::spectrum::Spectrum;
use crate::stats::{Stage, Stats};
use glam::Vec4;
use std::array::from_fn;

/// Evaluates the connections of all camera vertices.
#[inline(never)]
pub(in super::super) fn connect(job: &Job<'_>, batch: &mut Batch) {
    let mut next_events = batch.next_events.iter().peekable();
    let mut light_ends = &batch.light_ends[..];
    let (mut begin, mut ends_of_lists) = (0, batch.light_ends_end.iter());
    for (number, sample) in batch.samples.iter().enumerate() {
        let mut connector = Connector {
            job,
            sample,
            camera: batch.camera.get(number),
            camera_sums: &batch.camera_sums,
            light: &batch.light,
            light_sums: &batch.light_sums,
            weights: &mut batch.weights,
            first: [batch.candidates.len(), batch.unoffered.len()],
            candidates: &mut batch.candidates,
            unoffered: &mut batch.unoffered,
            stats: &mut batch.stats,
        };
        for t in 2..=connector.camera.vertices.len() {
            let is_due = |of: [u32; 2]| of == [number as u32, t as u32];
            while let Some(event) = next_events.next_if(|it| is_due([it.sample, it.t])) {
                connector.candidates.make_room(1);
                connector.offer_next_event(t, &event.end, event.pdf);
            }
            let end = *ends_of_lists.next().expect("each vertex has a list");
            let (of_vertex, others) = light_ends.split_at(end - begin);
            connector.offer_all(t, of_vertex);
            (light_ends, begin) = (others, end);
        }
        connector.count();
        batch.candidates_end.push(batch.candidates.len());
    }
    debug_assert!(next_events.next().is_none() && ends_of_lists.next().is_none());
    batch.stopwatch.end(Stage::Candidates);
}

/// A connection that is not zero, before visibility.
#[derive(Clone, Copy)]
struct Connection {
    /// C.
    contribution: Spectrum,
    /// T of the media between its ends, where it is known before its shadow ray is traced; else 1.
    transmittance: Spectrum,
    weight: f32,
    /// √V̂ of its shadow ray, times a guess at the mean of T.
    root_visibility: f32,
}

/// Connects the camera subpath of a sample.
struct Connector<'a> {
    job: &'a Job<'a>,
    sample: &'a Sample,
    camera: Subpath<'a>,
    camera_sums: &'a RunningSums,
    light: &'a Subpaths,
    light_sums: &'a RunningSums,
    weights: &'a mut Weights,
    /// How many candidates, and connections that are not offered, other samples have.
    first: [usize; 2],
    candidates: &'a mut List<Candidate>,
    unoffered: &'a mut Vec<Candidate>,
    stats: &'a mut Stats,
}

impl Connector<'_> {
    /// Connects camera vertex number `t` with vertices of light subpaths: diffuse ones four at a time, if it is
    /// diffuse itself.
    fn offer_all(&mut self, t: usize, ends: &[LightEnd]) {
        self.candidates.make_room(ends.len());
        let Some(y) = self.camera_sums.diffuse(self.camera.first + t - 1) else {
            for end in ends {
                self.offer_general(t, end, None);
            }
            return;
        };
        let of_camera = self.job.guide.of_camera(y.cell());
        let (fours, others) = ends.as_chunks();
        for four in fours {
            self.offer_four(t, (y, of_camera), four);
        }
        if !others.is_empty() {
            let last = from_fn(|lane| others.get(lane).copied().unwrap_or_default());
            self.offer_four(t, (y, of_camera), &last);
        }
    }

    /// Connects the diffuse camera vertex `y`, number `t`, with four vertices of light subpaths, or with less: s = 0
    /// stands for none.
    #[inline]
    fn offer_four(
        &mut self,
        t: usize,
        (y, of_camera): (&DiffuseEnd, CellGuide<'_>),
        four: &[LightEnd; 4],
    ) {
        let light_sums = self.light_sums;
        let z = |lane: usize| {
            let place = &four[lane].place;
            let z = light_sums.diffuse_or_none(place.z as usize);
            if place.is_diffuse {
                z
            } else {
                &DiffuseEnd::NONE
            }
        };
        // Written out, so that lanes stay in registers.
        let z = [z(0), z(1), z(2), z(3)];
        let count = |lane: usize| self.job.count_from(t, of_camera, z[lane].cell()) as f32;
        let connections = y.connect(z, [count(0), count(1), count(2), count(3)]);
        let root_visibility = z.map(|z| of_camera.root_visibility(z.cell()));
        let is_plain = |end: &LightEnd| end.place.is_diffuse || end.place.s == 0;
        if four.iter().all(is_plain) && connections.turned == 0 {
            self.offer_diffuse(t, four, &connections, root_visibility);
        } else {
            self.offer_each(t, four, &connections, root_visibility);
        }
    }

    /// Offers connections with four diffuse vertices, or with none, as [`offer_each`](Self::offer_each) does.
    #[inline(always)]
    fn offer_diffuse(
        &mut self,
        t: usize,
        four: &[LightEnd; 4],
        connections: &DiffuseConnections,
        root_visibility: [f32; 4],
    ) {
        let shares = Vec4::from_array(four.each_ref().map(|end| end.share));
        let contributions = connections.contributions * shares;
        let values = contributions * connections.weights;
        let is_zero = connections.contributions.are_black();
        let is_offered = values.are_within(LARGEST_CONTRIBUTION) & !values.are_black();
        if !(is_zero | is_offered).all() {
            return self.offer_each(t, four, connections, root_visibility);
        }
        let means = values.abs_means(self.job.lanes);
        let scores = means * Vec4::from_array(root_visibility);
        let (contributions, weights) = (contributions.each(), connections.weights.to_array());
        let y = (self.camera.first + t - 1) as u32;
        // Half of all connections may be zero, at random: no branch tells them apart.
        let is_offered = is_offered.bitmask() as usize;
        self.candidates.write_some(four.len(), |room| {
            let mut offered = 0;
            let is_there = |(_, end): &(usize, &LightEnd)| end.place.s > 0;
            for (lane, end) in four.iter().enumerate().take_while(is_there) {
                let term = end.term(t, contributions[lane], weights[lane]);
                room[offered] = end.candidate(term, scores[lane], y);
                offered += is_offered >> lane & 1;
            }
            offered
        });
    }

    /// Offers connections with four vertices one by one, whatever these are.
    #[inline(never)]
    fn offer_each(
        &mut self,
        t: usize,
        four: &[LightEnd; 4],
        connections: &DiffuseConnections,
        root_visibility: [f32; 4],
    ) {
        for (lane, end) in four.iter().enumerate() {
            let connection = connections.get(lane).filter(|_| end.place.is_diffuse);
            if let Some((contribution, weight)) = connection {
                let connection = Connection {
                    contribution,
                    transmittance: Spectrum::ONE,
                    weight,
                    root_visibility: root_visibility[lane],
                };
                self.offer(t, end, connection);
            } else if end.place.s > 0 {
                self.offer_general(t, end, None);
            }
        }
    }

    /// Connects camera vertex number `t` with a light point that was drawn for it with density `e`.
    fn offer_next_event(&mut self, t: usize, end: &LightEnd, e: f32) {
        let Some(y) = self.camera_sums.diffuse(self.camera.first + t - 1) else {
            return self.offer_general(t, end, Some(e));
        };
        let (vertex, job) = (&self.camera.vertices[t - 1], self.job);
        let x0 = &self.light.vertices()[end.place.z as usize];
        let segment = vertex.segment_to(x0);
        if let Some((contribution, weight)) = y.next_event(job, t, (x0, e), &segment) {
            let connection = Connection {
                contribution,
                transmittance: Spectrum::ONE,
                weight,
                root_visibility: job.root_visibility(x0, vertex),
            };
            self.offer(t, end, connection);
        }
    }

    /// Connects camera vertex number `t` with any light vertex. `next_event` is the density of a light point that was
    /// drawn for it.
    fn offer_general(&mut self, t: usize, end: &LightEnd, next_event: Option<f32>) {
        if let Some(connection) = self.general(t, end, next_event) {
            self.offer(t, end, connection);
        }
    }

    /// Returns the connection of any two vertices. None: it is zero. Media are guessed.
    fn general(&mut self, t: usize, end: &LightEnd, next_event: Option<f32>) -> Option<Connection> {
        let (z, s) = (end.place.z as usize, usize::from(end.place.s));
        let light = &self.light.vertices()[z + 1 - s..=z];
        let mut path = JoinedPath::connection(light, &self.camera.vertices[..t]);
        let contribution = path.contribution(self.job);
        if contribution == Spectrum::ZERO {
            return None;
        }
        let sums = PathSums {
            light: match next_event {
                Some(_) => &EndSums::NONE,
                None => self.light_sums.at(z),
            },
            camera: self.camera_sums.at(self.camera.first + t - 1),
            next_event,
        };
        let (z, y) = (path.z(), path.y());
        let mut root_visibility = self.job.root_visibility(z, y);
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
            path.pass(&edge);
            root_visibility *= self.job.lanes.mean(edge.transmittance);
        }
        Some(Connection {
            contribution,
            transmittance,
            weight: self.weights.weight(self.job, &path, &sums),
            root_visibility,
        })
    }

    /// Offers a connection for selection, unless it is zero. It is compared by the mean of its lanes times the √V̂ of its
    /// shadow ray.
    #[inline]
    fn offer(&mut self, t: usize, end: &LightEnd, connection: Connection) {
        if connection.contribution.is_black() {
            return;
        }
        let mut term = end.term(t, connection.contribution * end.share, connection.weight);
        let value = term.value();
        let mean = self.job.lanes.mean(value.map(f32::abs));
        term.contribution *= connection.transmittance;
        let y = (self.camera.first + t - 1) as u32;
        let candidate = end.candidate(term, mean * connection.root_visibility, y);
        if is_summable(value) & !value.is_black() {
            self.candidates.write(candidate, 1);
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

    /// Counts all that was found.
    fn count(self) {
        let [offered, others] = self.first;
        for found in [&self.candidates[offered..], &self.unoffered[others..]] {
            let strategies = found.iter().map(|candidate| candidate.term.strategy);
            self.stats.count_connections(strategies);
        }
    }
}
