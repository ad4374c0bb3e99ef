//! The light vertices that camera vertices are connected with: light points of their own (s = 1), and vertices of the
//! sample's own light subpath or of a cache.

use super::super::cache::{LightCache, Place};
use super::super::ends::{Ends, LightEnd, NextEvent};
use super::super::{CandidateCount, Sample, Walked, Worker};
use super::pairs::Pairs;
use crate::math::ONE_MINUS_EPSILON;
use crate::path::{Job, LightPointChoice, Subpaths, Vertex, sample_next_event};
use crate::sampler::{Dimension, Purpose, kronecker_number, kronecker_point};
use crate::spectrum::Spectrum;
use crate::stats::Stage;

/// Draws light points for each camera vertex, as many as `counts` says, and adds them behind the light subpaths. The
/// choice of the light is stratified; points on lights follow a sequence that fills them evenly.
#[inline(never)]
pub(in super::super) fn next_events(
    job: &Job<'_>,
    walked: &mut Walked,
    ends: &mut Ends,
    counts: CandidateCount,
) {
    if job.settings.light_point != LightPointChoice::Fresh {
        return;
    }
    let Walked {
        samples,
        camera,
        light,
    } = walked;
    let longest = job.settings.max_vertices() - 1;
    for (index, sample) in samples.iter().enumerate() {
        for (t, y) in (2..).zip(camera.get(index).vertices.iter().skip(1)) {
            if t <= longest && !y.is_delta() && job.takes(1, t) {
                let count = counts.at(t);
                ends.next_events.open().make_room(count.into());
                for k in 0..count {
                    if let Some(event) = add_point(light, job, sample, t, y, [k, count]) {
                        ends.next_events.open().write(event, 1);
                    }
                }
            }
            ends.next_events.close();
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
    let (number, drawn) = sample_next_event(job, y, u_light, point, u_depth)?;
    let mut x0 = Vertex::light(job, number, &drawn.at);
    x0.beta = Spectrum::splat(drawn.alpha / (drawn.pdf * f32::from(count)));
    let z = light.add_point(&x0);
    Some(NextEvent::new(z, number, drawn.pdf))
}

/// Lists for each camera vertex the vertices of the sample's own light subpath.
#[inline(never)]
pub(in super::super) fn own_light(
    job: &Job<'_>,
    walked: &Walked,
    ends: &mut Ends,
    worker: &mut Worker,
) {
    let Walked {
        samples,
        camera,
        light,
    } = walked;
    let first = walked.first_light();
    let settings = job.settings;
    for (number, sample) in samples.iter().enumerate() {
        let subpath = light.get(first + number);
        let mut pairs = Pairs::new(job, &sample.camera);
        for (t, y) in (2..).zip(camera.get(number).vertices.iter().skip(1)) {
            let longest = if y.is_delta() {
                0
            } else {
                subpath.vertices.len().min(settings.max_vertices() - t)
            };
            let list = ends.walked.open();
            list.make_room(longest);
            for s in settings.light_point.first_walked()..=longest {
                // Every pair in turn, whatever becomes of it: each moves the pointer.
                let share = pairs.take(s + t);
                let place = Place::new(&subpath, s - 1, &light.sums);
                let (Some(share), Some(place)) = (share, place) else {
                    continue;
                };
                let connects = place.is_diffuse || !subpath.vertices[s - 1].is_delta();
                let end = LightEnd {
                    place,
                    number: s as u32 - 1,
                    share,
                };
                list.write(end, usize::from(connects && job.takes(s, t)));
            }
            ends.walked.close();
        }
    }
    worker.stopwatch.end(Stage::Candidates);
}

/// Draws for each camera vertex as many vertices of the cache as `counts` says, stratified over the proposals. They lie
/// anywhere in the memory of a group, and each is loaded while others are drawn.
#[inline(never)]
pub(in super::super) fn draw_cached(
    job: &Job<'_>,
    walked: &Walked,
    cache: &LightCache,
    ends: &mut Ends,
    counts: CandidateCount,
    worker: &mut Worker,
) {
    let Walked {
        samples,
        camera,
        light,
    } = walked;
    let takes_all = job.settings.strategies.is_all();
    for (number, sample) in samples.iter().enumerate() {
        for (t, y) in (2..).zip(camera.get(number).vertices.iter().skip(1)) {
            // s vertices at most.
            let longest = job.settings.max_vertices().saturating_sub(t);
            if !y.is_delta() {
                let u = (sample.camera).get_bits(Dimension::at(t - 1, Purpose::CachedVertex));
                let (row, count) = (job.guide.of_camera(y.cell).row(), counts.at(t));
                ends.walked.open().write_some(count.into(), |room| {
                    let mut taken = 0;
                    cache.draw_all(row, count, u, |entry, place, share| {
                        let s = usize::from(place.s);
                        if place.is_diffuse {
                            light.sums.load_ahead(place.z as usize);
                        } else {
                            light.load_ahead(place.z as usize);
                        }
                        room[taken] = LightEnd {
                            place: *place,
                            number: entry as u32 + 1,
                            share,
                        };
                        taken += usize::from(s <= longest && (takes_all || job.takes(s, t)));
                    });
                    taken
                });
            }
            ends.walked.close();
        }
    }
    worker.stopwatch.end(Stage::Candidates);
}
