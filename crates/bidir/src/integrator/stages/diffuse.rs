//! Connections of diffuse camera vertices, as `connect` finds those of any vertices: with light points one by one, with
//! vertices of light subpaths four at a time.

use super::connect::{Connection, Connector};
use super::light_ends::LightEnd;
use crate::guide::CellGuide;
use crate::math::fixed::LARGEST_CONTRIBUTION;
use crate::path::{Bounce, DiffuseConnections, DiffuseEnd};
use crate::spectrum::Spectrum;
use glam::Vec4;
use std::array::from_fn;

impl Connector<'_> {
    /// Returns the connection of the diffuse camera vertex `y`, number `t`, with a light point that was drawn for it with
    /// density `pdf`. None: it is zero.
    pub(super) fn diffuse_next_event(
        &self,
        t: usize,
        y: &DiffuseEnd,
        end: &LightEnd,
        pdf: f32,
    ) -> Option<Connection> {
        let (vertex, job) = (&self.camera.vertices[t - 1], self.job);
        let x0 = &self.walks.light.vertices()[end.vertex.z as usize];
        let segment = vertex.segment_to(x0);
        let (contribution, weight) = y.next_event(job, t, x0, pdf, &segment)?;
        Some(Connection {
            contribution,
            transmittance: Spectrum::ONE,
            weight,
            score_factor: job.root_visibility(x0, vertex),
        })
    }

    /// Connects the diffuse camera vertex `y`, number `t`, with vertices of light subpaths.
    pub(super) fn offer_diffuse(&mut self, t: usize, y: &DiffuseEnd, ends: &[LightEnd]) {
        let of_camera = self.job.guide.of_camera(y.cell());
        let (fours, others) = ends.as_chunks();
        for four in fours {
            self.offer_four(t, y, of_camera, four);
        }
        if !others.is_empty() {
            let last = from_fn(|lane| others.get(lane).copied().unwrap_or_default());
            self.offer_four(t, y, of_camera, &last);
        }
    }

    /// Connects the diffuse camera vertex `y`, number `t`, with four vertices of light subpaths, or with less: s = 0
    /// stands for none.
    #[inline]
    fn offer_four(
        &mut self,
        t: usize,
        y: &DiffuseEnd,
        of_camera: CellGuide<'_>,
        four: &[LightEnd; 4],
    ) {
        let light_sums = &self.walks.light.sums;
        let z = |lane: usize| {
            let vertex = &four[lane].vertex;
            let z = light_sums.diffuse_or_none(vertex.z as usize);
            if vertex.is_diffuse {
                z
            } else {
                &DiffuseEnd::NONE
            }
        };
        // Written out, so that lanes stay in registers.
        let z = [z(0), z(1), z(2), z(3)];
        let bounce = Bounce::of(t);
        let count = |lane: usize| self.job.count_from(bounce, of_camera, z[lane].cell()) as f32;
        let connections = y.connect(z, [count(0), count(1), count(2), count(3)]);
        let root_visibility = z.map(|z| of_camera.root_visibility(z.cell()));
        let is_plain = |end: &LightEnd| end.vertex.is_diffuse || end.vertex.s == 0;
        if four.iter().all(is_plain) && connections.turned == 0 {
            self.offer_plain(t, four, &connections, root_visibility);
        } else {
            self.offer_each(t, four, &connections, root_visibility);
        }
    }

    /// Offers connections with four diffuse vertices, or with none, as [`offer_each`](Self::offer_each) does.
    #[inline(always)]
    fn offer_plain(
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
        let numbers = [t, self.camera.first + t - 1];
        // Half of all connections may be zero, at random: no branch tells them apart.
        let is_offered = is_offered.bitmask() as usize;
        self.candidates
            .offered
            .open()
            .write_some(four.len(), |room| {
                let mut offered = 0;
                let is_there = |(_, end): &(usize, &LightEnd)| end.vertex.s > 0;
                for (lane, end) in four.iter().enumerate().take_while(is_there) {
                    room[offered] =
                        end.candidate(numbers, contributions[lane], weights[lane], scores[lane]);
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
            let connection = connections.get(lane).filter(|_| end.vertex.is_diffuse);
            if let Some((contribution, weight)) = connection {
                let connection = Connection {
                    contribution,
                    transmittance: Spectrum::ONE,
                    weight,
                    score_factor: root_visibility[lane],
                };
                self.offer(t, end, connection);
            } else if end.vertex.s > 0 {
                self.offer_general(t, end);
            }
        }
    }
}
