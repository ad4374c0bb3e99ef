//! Identities that must hold exactly for every path, on real subpaths.
//!
//! A path that one strategy made is taken apart and made again, from its points alone, as every
//! other strategy would have made it. The product that is stored with a subpath is so compared
//! with one that is computed from scratch.

use crate::common::prelude::*;
use crate::common::rooms::{
    foggy_room, gallery, lamp_room, room, room_with_fire, room_with_ink, steep_room,
};
use crate::common::walks::{edge, for_each_pair, for_some_pairs, some_light_start, some_proposals};
use bidir::bsdf::TransportMode;
use bidir::guide::Guide;
use bidir::light::Part;
use bidir::path::{
    Arrival, HitPath, Job, JoinedPath, LightChoiceKind, LightPointChoice, MisHeuristic,
    PathDensities, PathRoulette, PathSettings, SampleCounts, Vertex,
};

fn settings(mis: MisHeuristic, light_point: LightPointChoice) -> PathSettings {
    PathSettings {
        max_depth: Some(6),
        roulette: PathRoulette::Albedo { start: 1 },
        mis,
        light_point,
        ..PathSettings::default()
    }
}

/// The part of roulette in the density of vertex `index` of a walk.
fn survival(job: &Job<'_>, index: usize, before: &Vertex) -> f32 {
    if index < 2 {
        return 1.0;
    }
    let albedo = before.albedo(before.wo).max_lane();
    job.settings.roulette.density_factor(index - 2, || albedo)
}

/// Walks again over `points`, the first of which is an end with its own `pdf_fwd` and `beta`:
/// everything that a walk stores is computed from scratch. None: no walk goes there.
fn rewalk(job: &Job<'_>, points: &[Vertex], mode: TransportMode) -> Option<Vec<Vertex>> {
    let mut walk: Vec<Vertex> = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let mut vertex = *point;
        if i > 0 {
            let before = walk[i - 1];
            let mut segment = before.segment_to(&vertex);
            let edge = edge(job, &before, &vertex)?;
            segment.pass(&edge);
            vertex.wo = -segment.w;
            vertex.pdf_fwd = before.event(before.wo, segment.w, mode).pdf(job) * segment.to_b;
            vertex.to_previous = segment.to_a;
            let roulette = survival(job, i, &before);
            let scatter = before.event(before.wo, -vertex.wo, mode).scatter(job);
            let step = segment.geometry_term / (vertex.pdf_fwd * roulette);
            // The first camera density counts samples per pixel, and so does importance.
            vertex.beta = before.beta * scatter * edge.transmittance * step;
            vertex.albedo_fwd = vertex.albedo(vertex.wo).max_lane();
        }
        walk.push(vertex);
    }
    for i in 0..walk.len().saturating_sub(1) {
        let (next, vertex) = (walk[i + 1], walk[i]);
        if let Some(after) = walk.get(i + 2).copied() {
            let (wi, mut back) = (next.segment_to(&after).w, next.segment_to(&vertex));
            back.pass(&edge(job, &next, &vertex)?);
            walk[i].pdf_rev = next.event(wi, back.w, mode.reversed()).pdf(job) * back.to_b;
            walk[i + 1].albedo_rev = next.albedo(wi).max_lane();
        }
    }
    Some(walk)
}

fn are_close(a: f32, b: f32) -> bool {
    (a - b).abs() <= 2e-3 * a.abs().max(b.abs()) + 1e-12
}

#[track_caller]
fn assert_close(a: f32, b: f32, what: &str) {
    assert!(are_close(a, b), "{what}: {a} and {b}");
}

#[track_caller]
fn assert_spectra_close(a: Spectrum, b: Spectrum, what: &str) {
    (0..3).for_each(|lane| assert_close(a[lane], b[lane], what));
}

/// True where the direction between two points, found again from the points, has few digits left
/// in its cosines: it is rounded the more the nearer they are.
fn is_fragile(before: &Vertex, vertex: &Vertex) -> bool {
    let w = vertex.segment_to(before).w;
    let cos = [before, vertex].map(|v| match v.locus.n_g {
        n if n == Vec3::ZERO => 1.0,
        n => n.dot(w).abs(),
    });
    cos[0].min(cos[1]) * before.locus.point.distance(vertex.locus.point) < 0.03
}

/// Counts comparisons, and those that differ by more than rounding.
#[derive(Default)]
struct Comparisons {
    all: usize,
    different: usize,
}

impl Comparisons {
    fn compare(&mut self, a: f32, b: f32) {
        self.all += 1;
        self.different += usize::from(!are_close(a, b));
    }
}

#[test]
fn stored_quantities_are_those_of_a_walk_from_scratch() {
    for room in [room, foggy_room, room_with_fire] {
        check_stored(&room(0.05));
    }
}

#[track_caller]
fn check_stored(scene: &Shot) {
    let settings = settings(MisHeuristic::Balance, LightPointChoice::Fresh);
    let mut comparisons: [Comparisons; 5] = Default::default();
    let [pdf_fwd, pdf_rev, albedo_fwd, albedo_rev, beta] = &mut comparisons;
    for_each_pair(&settings, scene, |job, light, camera| {
        let modes = [TransportMode::Importance, TransportMode::Radiance];
        for (subpath, mode) in [light, camera].into_iter().zip(modes) {
            let stored = subpath.vertices;
            let Some(fresh) = rewalk(job, stored, mode) else {
                continue;
            };
            for i in 1..stored.len() {
                if is_fragile(&fresh[i - 1], &fresh[i]) {
                    continue;
                }
                pdf_fwd.compare(stored[i].pdf_fwd, fresh[i].pdf_fwd);
                albedo_fwd.compare(stored[i].albedo_fwd, fresh[i].albedo_fwd);
                // Step by step, so that no error is carried along.
                let step = |walk: &[Vertex]| walk[i].beta[0] / walk[i - 1].beta[0];
                beta.compare(step(stored), step(&fresh));
                let after = fresh.get(i + 1);
                if after.is_some_and(|after| !is_fragile(&fresh[i], after)) {
                    pdf_rev.compare(stored[i - 1].pdf_rev, fresh[i - 1].pdf_rev);
                    albedo_rev.compare(stored[i].albedo_rev, fresh[i].albedo_rev);
                }
            }
        }
    });
    for (i, Comparisons { all, different }) in comparisons.iter().enumerate() {
        // Near the angle of total reflection Fresnel's equations magnify rounding.
        let are_few = *all > 1000 && different * 200 <= *all;
        assert!(are_few, "{i}: {different} of {all} differ");
    }
}

/// The whole path as points, from the light, with ends that have the densities of subpaths.
fn whole_path(job: &Job<'_>, light: &[Vertex], camera: &[Vertex]) -> Vec<Vertex> {
    let mut path: Vec<Vertex> = light.iter().chain(camera.iter().rev()).copied().collect();
    let at = path[0].light_point();
    let index = path[0].light.expect("a light subpath begins on a light");
    path[0] = Vertex::light(job, index, &at);
    path[0].beta = Spectrum::splat(1.0 / path[0].pdf_fwd);
    // An end of a subpath is connected, whatever its walk did next.
    for vertex in &mut path {
        vertex.went_by_delta = false;
    }
    path
}

/// True where a walk took a Dirac lobe between the vertices of `subpath`.
fn took_a_dirac_lobe(subpath: &[Vertex]) -> bool {
    let [between @ .., _] = subpath else {
        return false;
    };
    between.iter().any(|vertex| vertex.went_by_delta)
}

/// The density with which strategy s = 1 draws x_0.
fn next_event_density(job: &Job<'_>, path: &[Vertex]) -> f32 {
    let index = path[0].light.expect("x_0 is on a light");
    let (light, lights) = (job.scene.light(index), job.scene.light_context());
    let at = path[0].light_point();
    let by_power = job.scene.light_choice();
    let emission = job.guide.light_start.unwrap_or(by_power);
    if job.settings.light_point == LightPointChoice::Shared || path.len() == 2 {
        return emission.prob(index as usize) * light.pdf_position(&lights, &at);
    }
    let x1 = &path[1];
    let (part, prob) = match job.settings.light_choice {
        LightChoiceKind::Power => (Part::Whole, by_power.prob(index as usize)),
        LightChoiceKind::Tree => {
            // Light leaves on the side that it goes on at.
            let receiver = || x1.receiver(path[2].locus.point - x1.locus.point);
            let tree = job.scene.light_tree();
            let chosen = tree.find(receiver, index, at.primitive);
            (chosen.part, chosen.prob)
        }
    };
    prob * light.pdf_next_event(&lights, part, x1.locus.point, &at)
}

/// For every strategy that can make the path: its index, its weight, and f / (p n) with the
/// density p as the product over the vertices. None: nothing arrives on one of its segments.
fn strategies(job: &Job<'_>, path: &[Vertex]) -> Option<Vec<(usize, f32, Spectrum)>> {
    let n = path.len();
    let reversed: Vec<Vertex> = path.iter().rev().copied().collect();
    let mut densities = PathDensities::default();
    let mut result = Vec::new();
    let is_drawn = |walk: &[Vertex]| walk.iter().all(|vertex| vertex.pdf_fwd > 0.0);
    for s in 0..n {
        let camera = rewalk(job, &reversed[..n - s], TransportMode::Radiance)?;
        // Walks from a light end where its shading normal faces away.
        if !is_drawn(&camera) {
            continue;
        }
        if s == 0 {
            let at_light = &camera[n - 1];
            let arrival = Arrival {
                light: path[0].light?,
                at: path[0].light_point(),
                wo: at_light.wo,
                beta: at_light.beta,
                pdf: at_light.pdf_fwd,
                to_previous: at_light.to_previous,
            };
            let hit = HitPath::new(job, &arrival, &camera[..n - 1]);
            let w = hit.weight(job, &mut densities);
            result.push((s, w, arrival.contribution(job)));
            continue;
        }
        let mut light = rewalk(job, &path[..s], TransportMode::Importance)?;
        if !is_drawn(&light) {
            continue;
        }
        let edge = edge(job, &path[s - 1], &path[s])?;
        let mut joined = JoinedPath::new(&light, &camera);
        joined.segment.pass(&edge);
        let w = joined.weight(job, &mut densities);
        if s == 1 {
            let density = next_event_density(job, path);
            light[0].beta = Spectrum::splat(1.0 / density);
        }
        let count = count(job, s, path) as f32;
        let value = JoinedPath::new(&light, &camera).contribution(job);
        result.push((s, w, value * edge.transmittance / count));
    }
    Some(result)
}

/// n_s of these connections.
fn count(job: &Job<'_>, s: usize, path: &[Vertex]) -> f64 {
    let SampleCounts {
        next_events,
        light_subpaths,
        ..
    } = job.counts;
    let is_guided = job.guide.proposals.is_some();
    match (s, path.len() - s) {
        (_, 1) => light_subpaths,
        (1, t) => next_events[usize::from(t > 2)],
        (s, t) if s > 0 && is_guided => job.count(s, t, [path[s - 1].cell, path[s].cell]),
        _ => 1.0,
    }
}

#[track_caller]
fn check_paths(scene: &Shot, mis: MisHeuristic, light_point: LightPointChoice) {
    check_job(scene.job(&settings(mis, light_point)));
}

fn check_job(job: Job<'_>) {
    let settings = job.settings;
    let mut paths = 0;
    for_some_pairs(400, job, |job, light, camera| {
        for s in 1..=light.vertices.len() {
            for t in 1..=camera.vertices.len() {
                let (light, camera) = (&light.vertices[..s], &camera.vertices[..t]);
                let path = JoinedPath::new(light, camera);
                let contributes = !path.contribution(job).is_black();
                // Such a step cannot be made again from points alone.
                let is_bound = took_a_dirac_lobe(light) || took_a_dirac_lobe(camera);
                if s + t > settings.max_vertices() || !contributes || is_bound {
                    continue;
                }
                let path = whole_path(job, light, camera);
                paths += usize::from(check_path(job, &path, settings.mis));
            }
        }
    });
    assert!(paths > 1000, "{paths} paths");
}

/// Weights sum to 1, f is the same whatever strategy makes the path, and under the balance
/// heuristic w_s / (n_s p_s) is the same for all. False: there is no such path.
fn check_path(job: &Job<'_>, path: &[Vertex], mis: MisHeuristic) -> bool {
    let Some(all) = strategies(job, path) else {
        return false;
    };
    let all = all.iter();
    let possible: Vec<_> = all.filter(|(_, _, value)| !value.is_black()).collect();
    if possible.is_empty() {
        return false;
    }
    let sum: f32 = possible.iter().map(|(_, w, _)| w).sum();
    let (n, is_one) = (path.len(), (sum - 1.0).abs() < 2e-3);
    assert!(is_one, "the weights of {n} vertices sum to {sum}");
    if mis == MisHeuristic::Balance {
        // w_s ∝ n_s p_s and the value is f / (n_s p_s): their product is one constant.
        let constant = possible[0].2 * possible[0].1;
        for (s, w, value) in &possible {
            if *w > 1e-5 {
                assert_spectra_close(*value * *w, constant, &format!("w·f/(n·p), s = {s}"));
            }
        }
    }
    true
}

#[test]
fn weights_sum_to_one_and_all_strategies_see_the_same_integrand() {
    let (pinhole, lens) = (room(0.0), room(0.1));
    check_paths(&pinhole, MisHeuristic::Balance, LightPointChoice::Fresh);
    check_paths(&lens, MisHeuristic::Balance, LightPointChoice::Fresh);
    check_paths(&lens, MisHeuristic::Balance, LightPointChoice::Shared);
    check_paths(&lens, MisHeuristic::Power, LightPointChoice::Fresh);
    check_paths(&pinhole, MisHeuristic::Uniform, LightPointChoice::Shared);
}

/// The same where surfaces have layers, transmit, are mixtures, and have Dirac lobes beside others; where the camera sees
/// other shading normals than light does, and layers have normals of their own; in fog, through a medium that only absorbs,
/// in rough glass that is not empty, and from a fire.
#[test]
fn paths_are_one_function_in_rooms_of_all_kinds() {
    check_stored(&steep_room(0.1));
    for room in [
        gallery,
        steep_room,
        foggy_room,
        room_with_ink,
        room_with_fire,
    ] {
        let scene = room(0.1);
        check_paths(&scene, MisHeuristic::Balance, LightPointChoice::Fresh);
        check_paths(&scene, MisHeuristic::Power, LightPointChoice::Shared);
    }
}

/// The same where next-event estimation chooses among many lamps, and where it does so by power.
#[test]
fn lamps_are_one_function_of_the_path_however_they_are_chosen() {
    let scene = lamp_room(0.1);
    for (_, light_choice) in LightChoiceKind::NAMES {
        for mis in [MisHeuristic::Balance, MisHeuristic::Power] {
            let settings = PathSettings {
                light_choice,
                ..settings(mis, LightPointChoice::Fresh)
            };
            check_job(scene.job(&settings));
        }
    }
}

/// The same where connections are proposed from place to place, to light subpaths of other samples.
#[test]
fn proposals_are_one_function_of_the_path() {
    for scene in [room(0.1), gallery(0.1)] {
        let proposals = some_proposals(&scene);
        let light_start = some_light_start(&scene);
        let counts = SampleCounts {
            connections: [1.7, 0.4],
            next_events: [3.0, 2.0],
            light_subpaths: 16.0,
        };
        let guide = Guide {
            proposals: Some(&proposals),
            light_start: Some(&light_start),
        };
        for mis in [MisHeuristic::Balance, MisHeuristic::Power] {
            let settings = settings(mis, LightPointChoice::Fresh);
            check_job(Job {
                counts,
                guide,
                ..scene.job(&settings)
            });
        }
    }
}
