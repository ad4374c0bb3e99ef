//! The light vertices that camera vertices are connected with: light points of their own (s = 1), and vertices of the
//! sample's own light subpath or of a cache.

use super::super::cache::{LightCache, LightVertexRef};
use super::super::{CandidateCount, Lists, Sample, Walks, Worker};
use super::pairs::Pairs;
use crate::contribution::Term;
use crate::math::ONE_MINUS_EPSILON;
use crate::path::{Job, LightPointChoice, Subpaths, Vertex, sample_next_event};
use crate::sampler::{Dimension, Purpose, kronecker_number, kronecker_point};
use crate::select::Candidate;
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use crate::strategy::Strategy;

/// A light vertex that a camera vertex is connected with.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LightEnd {
    /// The vertex.
    pub(super) vertex: LightVertexRef,
    /// [`Candidate::light_vertex`].
    pub(super) light_vertex: u32,
    /// The factor of the connection: 1/π(n) of `Pairs`, or 1 / (M N P) for a vertex of a cache. That of a light point is
    /// in its β.
    pub(super) share: f32,
}

impl LightEnd {
    /// Returns the candidate that connects it with camera vertex number `t`, which is number `y` of a batch. The score
    /// is raised to a positive minimum, so that every candidate may be chosen.
    #[inline(always)]
    pub(super) fn candidate(
        &self,
        [t, y]: [usize; 2],
        contribution: Spectrum,
        weight: f32,
        score: f32,
    ) -> Candidate {
        Candidate {
            term: Term {
                strategy: Strategy::new(self.vertex.s.into(), t),
                light: self.vertex.light,
                contribution,
                weight,
            },
            score: score.max(f32::MIN_POSITIVE),
            vertices: [self.vertex.z, y as u32],
            light_vertex: self.light_vertex,
        }
    }
}

/// A light point of next-event estimation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NextEvent {
    /// The point as a light vertex.
    pub(super) end: LightEnd,
    /// e, the density that it was drawn with.
    pub(super) pdf: f32,
}

/// The light vertices of each camera vertex from t = 2 on: a list for each, empty or not, in the order of samples and t.
/// Where light points are shared, `points` has no lists at all.
#[derive(Debug, Default)]
pub(in super::super) struct LightEnds {
    /// Its own light points.
    pub(super) points: Lists<NextEvent>,
    /// Vertices of light subpaths.
    pub(super) vertices: Lists<LightEnd>,
}

impl LightEnds {
    /// Forgets all, and keeps the memory.
    pub(in super::super) fn clear(&mut self) {
        self.points.clear();
        self.vertices.clear();
    }
}

/// Draws light points for each camera vertex, as many as `counts` says, and adds them behind the light subpaths. The
/// choice of the light is stratified; points on lights follow a sequence that fills them evenly.
#[inline(never)]
pub(in super::super) fn next_events(
    job: &Job<'_>,
    walks: &mut Walks,
    ends: &mut LightEnds,
    counts: CandidateCount,
) {
    if job.settings.light_point != LightPointChoice::Fresh {
        return;
    }
    let longest = job.settings.max_vertices() - 1;
    for (i, sample) in walks.samples.iter().enumerate() {
        for (t, y) in (2..).zip(walks.camera.get(i).vertices.iter().skip(1)) {
            if t <= longest && !y.is_delta() && job.takes(1, t) {
                let count = counts.at(t);
                ends.points.open().make_room(count.into());
                for k in 0..count {
                    if let Some(event) = add_point(&mut walks.light, job, sample, t, y, [k, count])
                    {
                        ends.points.open().write(event, 1);
                    }
                }
            }
            ends.points.close();
        }
    }
}

/// Adds light point number `k` of `count` for `y`, camera vertex number `t`, which counts 1 / `count`. None: there is no
/// light point.
fn add_point(
    light: &mut Subpaths,
    job: &Job<'_>,
    sample: &Sample,
    t: usize,
    y: &Vertex,
    [k, count]: [u16; 2],
) -> Option<NextEvent> {
    let at = |purpose| Dimension::at(t - 1, purpose);
    let part = |u: f32| ((f32::from(k) + u) / f32::from(count)).min(ONE_MINUS_EPSILON);
    let u_light = || part(sample.points.get_1d(at(Purpose::NextEventLight)));
    let u = sample.points.get_2d(at(Purpose::NextEventPosition));
    let u_depth = || kronecker_number(sample.points.get_1d(at(Purpose::NextEventDepth)), k);
    let point = kronecker_point(u, k);
    let (light_index, drawn) = sample_next_event(job, y, u_light, point, u_depth)?;
    let mut x0 = Vertex::light(job, light_index, &drawn.at);
    x0.beta = Spectrum::splat(drawn.alpha / (drawn.pdf * f32::from(count)));
    let vertex = LightVertexRef {
        z: light.add_point(&x0) as u32,
        s: 1,
        is_diffuse: false,
        light: light_index,
    };
    let end = LightEnd {
        vertex,
        light_vertex: 0,
        share: 1.0,
    };
    Some(NextEvent {
        end,
        pdf: drawn.pdf,
    })
}

/// Lists for each camera vertex the vertices of the sample's own light subpath.
#[inline(never)]
pub(in super::super) fn own_light(
    job: &Job<'_>,
    walks: &Walks,
    ends: &mut LightEnds,
    worker: &mut Worker,
) {
    let settings = job.settings;
    for (i, sample) in walks.samples.iter().enumerate() {
        let subpath = walks.light.get(walks.first_light() + i);
        let mut pairs = Pairs::new(job, &sample.camera);
        for (t, y) in (2..).zip(walks.camera.get(i).vertices.iter().skip(1)) {
            let longest = if y.is_delta() {
                0
            } else {
                subpath.vertices.len().min(settings.max_vertices() - t)
            };
            let list = ends.vertices.open();
            list.make_room(longest);
            for s in settings.light_point.min_subpath_s()..=longest {
                // Every pair in turn, whatever becomes of it: each moves the pointer.
                let Some(share) = pairs.take(s + t) else {
                    continue;
                };
                let vertex = LightVertexRef::new(&subpath, s - 1, &walks.light.sums);
                let connects = vertex.is_diffuse || !subpath.vertices[s - 1].is_delta();
                let end = LightEnd {
                    vertex,
                    light_vertex: s as u32 - 1,
                    share,
                };
                list.write(end, usize::from(connects && job.takes(s, t)));
            }
            ends.vertices.close();
        }
    }
    worker.stopwatch.end(Stage::Candidates);
}

/// Draws for each camera vertex as many vertices of the cache as `counts` says, stratified over the proposals. They lie
/// anywhere in the memory of a group, and each is loaded while others are drawn.
#[inline(never)]
pub(in super::super) fn draw_cached(
    job: &Job<'_>,
    walks: &Walks,
    cache: &LightCache,
    ends: &mut LightEnds,
    counts: CandidateCount,
    worker: &mut Worker,
) {
    let light = &walks.light;
    let takes_all = job.settings.strategies.is_all();
    for (i, sample) in walks.samples.iter().enumerate() {
        for (t, y) in (2..).zip(walks.camera.get(i).vertices.iter().skip(1)) {
            // s vertices at most.
            let longest = job.settings.max_vertices().saturating_sub(t);
            if !y.is_delta() {
                let u = (sample.camera).get_bits(Dimension::at(t - 1, Purpose::CachedVertex));
                let (row, count) = (job.guide.of_camera(y.cell).row(), counts.at(t));
                ends.vertices.open().write_some(count.into(), |room| {
                    let mut taken = 0;
                    cache.draw_all(row, count, u, |entry, vertex, share| {
                        let s = usize::from(vertex.s);
                        if vertex.is_diffuse {
                            light.sums.load_ahead(vertex.z as usize);
                        } else {
                            light.load_ahead(vertex.z as usize);
                        }
                        room[taken] = LightEnd {
                            vertex: *vertex,
                            light_vertex: entry as u32 + 1,
                            share,
                        };
                        taken += usize::from(s <= longest && (takes_all || job.takes(s, t)));
                    });
                    taken
                });
            }
            ends.vertices.close();
        }
    }
    worker.stopwatch.end(Stage::Candidates);
}
