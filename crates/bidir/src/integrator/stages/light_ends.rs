//! The vertices of light subpaths that camera vertices are connected with.

use super::super::cache::{LightCache, Place};
use super::super::ends::{Ends, LightEnd};
use super::super::{CandidateCount, Walked, Worker};
use super::pairs::Pairs;
use crate::path::Job;
use crate::sampler::{Dimension, Purpose};
use crate::stats::Stage;

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

/// Draws for each camera vertex as many vertices of the cache as `counts` says, one of each of as many parts of it.
/// They lie anywhere in the memory of a group, and are loaded while others are drawn.
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
                    cache.draw_all(row, (count, u), |entry, place, share| {
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
