//! A look into a batch, for replays and for training.

use super::stages::{TracedShadow, lens_vertex};
use super::{Batch, Candidates, Entry, Fate, Link};
use crate::contribution::is_summable;
use crate::path::{
    Arrival, ConnectionPart, HitPath, Job, JoinedPath, PathDensities, Shares, Vertex,
};
use crate::select::Candidate;
use std::slice;

impl Batch {
    /// Returns true if a connection is evaluated together with others: both of its vertices are diffuse.
    pub(crate) fn is_diffuse(&self, connection: &Candidate) -> bool {
        let [z, y] = connection.vertices.map(|vertex| vertex as usize);
        let [light, camera] = [&self.walks.light, &self.walks.camera];
        light.sums.diffuse(z).is_some() && camera.sums.diffuse(y).is_some()
    }

    /// Returns the candidates, each with its entry if it was chosen.
    pub(crate) fn connections(&self) -> impl Iterator<Item = (&Candidate, Option<&Entry>)> {
        let Candidates {
            offered, chosen, ..
        } = &self.candidates;
        let mut entries = vec![None; offered.len()];
        let of_chosen = &self.entries[self.entries.len() - chosen.len()..];
        for (chosen, entry) in chosen.iter().zip(of_chosen) {
            entries[chosen.candidate as usize] = Some(entry);
        }
        offered.iter().zip(entries)
    }

    /// Returns the entry of a candidate that was not chosen, or was not offered.
    pub(crate) fn untraced(&self, candidate: &Candidate) -> Entry {
        let fate = if is_summable(candidate.term.value()) {
            Fate::NotTraced
        } else {
            Fate::Dropped
        };
        let link = Link::Connection(candidate.ends(&self.walks.light, &self.walks.camera));
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
        let (index, term) = (entry.sample as usize, &entry.term);
        let (s, t) = (usize::from(term.strategy.s), usize::from(term.strategy.t));
        let walks = &self.walks;
        let shadow = entry
            .link
            .ends()
            .map(|ends| TracedShadow::between(job, || *ends));
        let mut gather_connection = |[light, camera]: [&[Vertex]; 2]| {
            let mut path = JoinedPath::new(light, camera);
            if let Some(edge) = shadow.as_ref().and_then(TracedShadow::edge) {
                path.segment.pass(edge);
            }
            densities.gather_connection(job, &path);
            path.camera_albedos()
        };
        let albedos = match candidate {
            Some(candidate) => gather_connection(walks.subpaths(candidate)),
            None if s == 0 => {
                let walk = walks.camera.get(index);
                let mut arrivals = Arrival::all(job.scene, &walk);
                let (before, arrival) = arrivals.find(|(before, arrival)| {
                    before.len() + 1 == t && arrival.light == term.light
                })?;
                let path = HitPath::new(job, &arrival, before);
                densities.gather_hit(job, &path);
                path.camera_albedos()
            }
            None => {
                let lens = lens_vertex(job, &walks.samples[index], s);
                let light = walks.light.get(walks.first_light() + index);
                gather_connection([&light.vertices[..s], slice::from_ref(&lens)])
            }
        };
        Some(densities.shares(job, s, albedos, parts))
    }
}
