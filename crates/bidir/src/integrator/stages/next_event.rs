//! s = 1: light points for camera vertices, where these have their own.

use super::super::ends::{Ends, NextEvent};
use super::super::{CandidateCount, Sample, Walked};
use crate::math::ONE_MINUS_EPSILON;
use crate::path::{Job, LightPointChoice, Subpaths, Vertex, sample_next_event};
use crate::sampler::{Dimension, Purpose, kronecker_number, kronecker_point};
use crate::spectrum::Spectrum;

/// Draws light points for each camera vertex, one of each of as many parts of the lights, at points of a
/// sequence that fills them evenly, and adds them behind the light subpaths.
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
                    if let Some(event) = add_point(light, job, sample, (t, y), [k, count]) {
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
    (t, y): (usize, &Vertex),
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
    x0.beta = Spectrum::splat(drawn.coverage / (drawn.pdf * f32::from(count)));
    let z = light.add_point(&x0);
    Some(NextEvent::new(z, number, drawn.pdf))
}
