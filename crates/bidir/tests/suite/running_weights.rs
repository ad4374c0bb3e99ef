//! Weights from running sums are those of the pure form, for every path that pairs of subpaths
//! make, and for every way to weigh them.

use crate::common::prelude::*;
use crate::common::rooms::{
    foggy_room, gallery, lamp_room, room, room_with_fire, room_with_ink, steep_room,
};
use crate::common::walks::{edge, for_some_pairs, some_light_start, some_proposals};
use bidir::camera::{Camera, Orthographic, OrthographicSettings};
use bidir::guide::Guide;
use bidir::light::{DistantLight, Light, PointLight};
use bidir::path::{
    Arrival, DiffuseEnd, HitPath, Job, JoinedPath, LightChoiceKind, LightPointChoice, MisHeuristic,
    PathDensities, PathRoulette, PathSettings, PathSums, RunningSums, SampleCounts, Strategies,
    Subpath, Vertex, Weights, sample_next_event,
};
use std::array::from_fn;

/// Both forms take the same densities, and sum in f64; weights are f32.
const TOLERANCE: f32 = 1e-6;
/// Weights below this are compared absolutely.
const SMALL: f32 = 1e-30;

/// The two computations of weights, and the number of paths compared.
#[derive(Default)]
struct Comparison {
    sums: [RunningSums; 2],
    weights: Weights,
    densities: PathDensities,
    /// e, if it is known.
    next_event: Option<f32>,
    paths: usize,
    /// Of paths with five vertices or more, whose strategies share.
    shared: usize,
    /// Of diffuse vertices: with light points, with lens points, and with each other.
    diffuse: [usize; 3],
}

impl Comparison {
    #[track_caller]
    fn compare(&mut self, job: &Job<'_>, path: &JoinedPath<'_>) {
        let [s, t] = [path.light, path.camera].map(<[Vertex]>::len);
        if !job.takes(s, t) {
            return;
        }
        let pure = path.weight(job, &mut self.densities);
        let [of_light, of_camera] = &self.sums;
        let sums = PathSums {
            light: of_light.at(s - 1),
            camera: of_camera.at(t - 1),
            next_event: self.next_event,
        };
        let running = self.weights.connection(job, path, &sums);
        self.check(job, (s, t), [running, pure]);
    }

    #[track_caller]
    fn compare_hit(&mut self, job: &Job<'_>, arrival: &Arrival, camera: &[Vertex]) {
        let t = camera.len() + 1;
        if !job.takes(0, t) {
            return;
        }
        let path = HitPath::new(job, arrival, camera);
        let pure = path.weight(job, &mut self.densities);
        let sums = self.sums[1].at(camera.len() - 1);
        let running = self.weights.hit(job, &path, sums);
        self.check(job, (0, t), [running, pure]);
    }

    #[track_caller]
    fn check(&mut self, job: &Job<'_>, (s, t): (usize, usize), [running, pure]: [f32; 2]) {
        check_weight(job, (s, t), running, [pure, TOLERANCE]);
        self.paths += 1;
        self.shared += usize::from(s + t > 4 && (0.01..0.99).contains(&pure));
    }

    /// All paths that the two subpaths make.
    fn compare_pair(&mut self, job: &Job<'_>, light: &Subpath<'_>, camera: &Subpath<'_>) {
        self.weights.set(job.settings);
        self.sums.iter_mut().for_each(RunningSums::clear);
        if self.weights.uses_sums() {
            self.sums[0].add(job, light);
            self.sums[1].add(job, camera);
        }
        self.compare_hits(job, camera);
        self.compare_light_images(job, light.vertices);
        self.compare_next_events(job, camera.vertices);
        let fresh = job.settings.light_point == LightPointChoice::Fresh;
        for t in 2..=camera.vertices.len() {
            for s in 1 + usize::from(fresh)..=light.vertices.len() {
                let (light, camera) = (&light.vertices[..s], &camera.vertices[..t]);
                self.compare_connection(job, light, camera);
                self.compare_diffuse(job, light, camera);
            }
        }
    }

    fn compare_connection(&mut self, job: &Job<'_>, light: &[Vertex], camera: &[Vertex]) {
        let mut path = JoinedPath::new(light, camera);
        let edge = edge(job, &light[light.len() - 1], &camera[camera.len() - 1]);
        if let Some(edge) = edge
            && !path.contribution(job).is_black()
        {
            path.segment.pass(&edge);
            self.compare(job, &path);
        }
    }

    /// A connection of diffuse vertices against the general form.
    #[track_caller]
    fn compare_diffuse(&mut self, job: &Job<'_>, light: &[Vertex], camera: &[Vertex]) {
        let (s, t) = (light.len(), camera.len());
        let [of_light, of_camera] = &self.sums;
        let (Some(z), Some(y)) = (of_light.diffuse(s - 1), of_camera.diffuse(t - 1)) else {
            return;
        };
        let path = JoinedPath::new(light, camera);
        let count = job.count(s, t, [light[s - 1].cell, camera[t - 1].cell]);
        // Other vertices, with counts of their own, are in the other lanes.
        let own = (s + t) % 4;
        let ends = from_fn(|lane| match of_light.diffuse((s + lane) % 8) {
            _ if lane == own => z,
            other => other.unwrap_or(&DiffuseEnd::NONE),
        });
        let counts = from_fn(|lane| count as f32 * if lane == own { 1.0 } else { 3.0 });
        let connections = y.connect(ends, counts);
        if let Some(found) = connections.get(own) {
            self.check_diffuse(job, &path, Some(found).filter(|(c, _)| !c.is_black()));
        }
    }

    /// C and the weight of a connection of a diffuse vertex against the general form.
    #[track_caller]
    fn check_diffuse(
        &mut self,
        job: &Job<'_>,
        path: &JoinedPath<'_>,
        found: Option<(Spectrum, f32)>,
    ) {
        let contribution = path.contribution(job);
        let (s, t) = (path.light.len(), path.camera.len());
        let Some((found, weight)) = found else {
            assert!(
                contribution.is_black(),
                "s = {s}, t = {t}: {contribution:?}"
            );
            return;
        };
        for (found, expected) in found.0.into_iter().zip(contribution.0) {
            let is_near = (found - expected).abs() <= 3.0 * TOLERANCE * expected;
            assert!(is_near, "s = {s}, t = {t}: {found} instead of {expected}");
        }
        let pure = path.weight(job, &mut self.densities);
        check_weight(job, (s, t), weight, [pure, 3.0 * TOLERANCE]);
        self.diffuse[if s == 1 { 0 } else { t.min(2) }] += 1;
    }

    fn compare_hits(&mut self, job: &Job<'_>, camera: &Subpath<'_>) {
        for (before, arrival) in Arrival::all(job.scene, camera) {
            self.compare_hit(job, &arrival, before);
        }
    }

    fn compare_light_images(&mut self, job: &Job<'_>, light: &[Vertex]) {
        let lens = job.view.camera().sample_lens(|| Vec2::new(0.3, 0.8));
        let medium = job.scene.medium_at(lens.locus.point);
        let lens = Vertex::camera(&lens, medium);
        for s in 1..=light.len() {
            let (z, lens) = (&light[s - 1], std::slice::from_ref(&lens));
            if z.locus.is_infinite() && lens[0].locus.is_infinite() {
                continue;
            }
            self.compare_connection(job, &light[..s], lens);
            let sums = &self.sums[0];
            let segment = z.segment_to(&lens[0]);
            if job.takes(s, 1)
                && let Some(end) = sums.diffuse(s - 1)
                && !end.is_turned(segment.w)
            {
                let found = end.light_image(job, s, z, sums.at(s - 1), &lens[0], &segment);
                let path = JoinedPath::new(&light[..s], lens);
                self.check_diffuse(job, &path, found);
            }
        }
    }

    fn compare_next_events(&mut self, job: &Job<'_>, camera: &[Vertex]) {
        for t in 2..=camera.len() {
            let (u_light, u) = (0.17 * t as f32 % 1.0, Vec2::new(0.4, 0.11 * t as f32 % 1.0));
            let drawn = sample_next_event(job, &camera[t - 1], || u_light, u, || u.x);
            let Some((light, drawn)) = drawn else {
                continue;
            };
            let x0 = Vertex::light(job, light, &drawn.at);
            let is_fresh = job.settings.light_point == LightPointChoice::Fresh;
            self.next_event = is_fresh.then_some(drawn.pdf);
            let of_light = std::slice::from_ref(&x0);
            self.compare_connection(job, of_light, &camera[..t]);
            self.next_event = None;
            if is_fresh
                && job.takes(1, t)
                && let Some(y) = self.sums[1].diffuse(t - 1)
            {
                let segment = camera[t - 1].segment_to(&x0);
                let found = y.next_event(job, t, &x0, drawn.pdf, &segment);
                let path = JoinedPath::new(of_light, &camera[..t]);
                self.check_diffuse(job, &path, found);
            }
        }
    }
}

#[track_caller]
fn check_weight(job: &Job<'_>, (s, t): (usize, usize), found: f32, [pure, tolerance]: [f32; 2]) {
    let (is_near, settings) = (
        (found - pure).abs() <= tolerance * pure + SMALL,
        job.settings,
    );
    let of = || format!("s = {s}, t = {t}; {}", describe(settings));
    assert!(is_near, "{found} instead of {pure}: {}", of());
}

/// Every heuristic, light point and kind of roulette, with some sets of strategies.
fn all_settings() -> Vec<PathSettings> {
    let roulettes = ["albedo:0", "albedo:3", "throughput:0", "off"]
        .map(|text| text.parse::<PathRoulette>().expect("it is a roulette"));
    let strategies = ["all", "-s1,all", "-s0", "-t1", "-s1", "all,-s2t3,-t4"]
        .map(|text| text.parse::<Strategies>().expect("they are strategies"));
    let all = vec![PathSettings {
        max_depth: Some(10),
        ..PathSettings::default()
    }];
    let all = vary(&all, &MisHeuristic::NAMES, |s, (_, mis)| s.mis = mis);
    let choices = [
        (LightPointChoice::Fresh, LightChoiceKind::Power),
        (LightPointChoice::Fresh, LightChoiceKind::Tree),
        (LightPointChoice::Shared, LightChoiceKind::Tree),
    ];
    let all = vary(&all, &choices, |s, (point, choice)| {
        (s.light_point, s.light_choice) = (point, choice);
    });
    let all = vary(&all, &roulettes, |s, roulette| s.roulette = roulette);
    vary(&all, &strategies, |s, strategies| s.strategies = strategies)
}

/// All settings with every choice.
fn vary<T: Clone>(
    all: &[PathSettings],
    choices: &[T],
    set: impl Fn(&mut PathSettings, T),
) -> Vec<PathSettings> {
    let mut varied = Vec::new();
    for settings in all {
        for choice in choices {
            let mut settings = settings.clone();
            set(&mut settings, choice.clone());
            varied.push(settings);
        }
    }
    varied
}

/// Settings in words.
fn describe(settings: &PathSettings) -> String {
    let PathSettings {
        roulette,
        strategies,
        light_point,
        light_choice,
        mis,
        ..
    } = settings;
    format!("{mis:?}, {light_point:?}, {light_choice:?}, {roulette}, {strategies}")
}

/// Compares all paths of these pairs, among them more than `diffuse` connections of diffuse vertices of each kind.
#[track_caller]
fn check(scene: &Shot, pairs: u64, diffuse: usize) {
    let found = compared(scene, pairs);
    assert!(found > diffuse, "{found} connections are diffuse");
}

/// Returns how many connections of diffuse vertices there were, of the kind with the fewest.
#[track_caller]
fn compared(scene: &Shot, pairs: u64) -> usize {
    let (mut comparison, mut least) = (Comparison::default(), 0);
    let proposals = some_proposals(scene);
    let light_start = some_light_start(scene);
    let counts = SampleCounts {
        connections: [2.7, 0.6],
        next_events: [3.0, 2.0],
        light_subpaths: 16.0,
    };
    let guide = Guide {
        proposals: Some(&proposals),
        light_start: Some(&light_start),
    };
    for settings in all_settings() {
        let own = scene.job(&settings);
        let guided = Job {
            counts,
            guide,
            ..own
        };
        let uniform = Job {
            guide: Guide {
                proposals: None,
                ..guide
            },
            ..guided
        };
        for_some_pairs(pairs, guided, |_, light, camera| {
            for job in [&own, &uniform, &guided] {
                comparison.compare_pair(job, light, camera);
            }
        });
        least += pairs as usize;
    }
    let Comparison {
        paths,
        shared,
        diffuse,
        ..
    } = comparison;
    assert!(paths >= least, "{paths} paths of {least} pairs");
    assert!(shared * 20 >= least, "{shared} of {least} are shared");
    diffuse.into_iter().min().unwrap_or(0)
}

/// A diffuse floor and wall with tilted normals, balls of smooth glass, smooth metal and smooth varnish, under lights of all
/// kinds, `unit` times the size it has at 1.
fn yard(unit: f32, camera: Camera) -> Shot {
    let mut builder = ShotBuilder::new(camera, 8);
    let grey = builder.material(diffuse([0.7, 0.6, 0.5]));
    let quad = |corner: Vec3, a: Vec3, b: Vec3| {
        let flat = parallelogram(corner * unit, a * unit, b * unit);
        tilted(flat, Vec3::new(0.9, 0.3, 0.3))
    };
    let ball = |centre: Vec3, radius: f32| sphere(centre * unit, radius * unit);
    let floor = quad(Vec3::new(-3.0, -1.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0);
    let wall = quad(Vec3::new(-3.0, -1.0, 2.0), Vec3::Y * 4.0, Vec3::X * 6.0);
    builder.shape(floor, grey, None);
    builder.shape(wall, grey, None);
    builder.add(ball(Vec3::new(-0.7, -0.5, 0.5), 0.5), glass(0.0));
    builder.add(ball(Vec3::new(0.5, -0.4, 0.9), 0.6), metal(0.0));
    builder.add(ball(Vec3::new(0.2, -0.7, -0.2), 0.3), varnish(0.0));
    let lamp = ball(Vec3::new(1.2, 0.9, 0.2), 0.3);
    builder.shape(lamp, grey, emission([4.0, 3.0, 2.0]));
    let intensity = [unit * unit; 3];
    builder.light(Light::Point(PointLight {
        position: Vec3::new(-1.0, 1.0, 0.0) * unit,
        intensity: intensity.into(),
    }));
    builder.light(Light::Distant(DistantLight {
        to_light: Vec3::new(0.3, 0.9, -0.3).normalize(),
        irradiance: [0.5; 3].into(),
    }));
    builder.sky([0.3, 0.4, 0.5]);
    builder.build()
}

/// Looks along +z, with a lens.
fn perspective(unit: f32) -> Camera {
    camera_with(Vec3::Z * -3.0 * unit, 8, 0.5, [0.1 * unit, 3.0 * unit])
}

#[test]
fn rooms_and_layers() {
    check(&room(0.1), 20, 1000);
    check(&steep_room(0.1), 20, 300);
    compared(&gallery(0.1), 20);
    compared(&lamp_room(0.1), 20);
}

#[test]
fn media() {
    let diffuse = compared(&foggy_room(0.1), 20);
    assert_eq!(diffuse, 0, "they know nothing of fog");
    check(&room_with_ink(0.1), 20, 1000);
    compared(&room_with_fire(0.1), 20);
}

#[test]
fn glass_mirrors_and_lights_of_all_kinds_at_any_size() {
    for unit in [1.0, 1e-4, 1e4] {
        check(&yard(unit, perspective(unit)), 150, 1000);
    }
}

#[test]
fn a_camera_at_infinity() {
    let settings = OrthographicSettings {
        world_from_camera: Affine3A::from_translation(Vec3::Z * -3.0),
        resolution: Vec2::splat(8.0),
        screen: [Vec2::new(-1.5, 1.5), Vec2::new(1.5, -1.5)],
    };
    let camera = Orthographic::new(&settings).expect("the camera is rigid");
    check(&yard(1.0, Camera::Orthographic(camera)), 150, 500);
}

/// Long walks, where ratios multiply up.
#[test]
fn long_paths() {
    let scene = room(0.05);
    for (_, mis) in MisHeuristic::NAMES {
        let settings = PathSettings {
            max_depth: Some(60),
            roulette: PathRoulette::Off,
            mis,
            ..PathSettings::default()
        };
        let mut comparison = Comparison::default();
        for_some_pairs(4, scene.job(&settings), |job, light, camera| {
            comparison.compare_pair(job, light, camera);
        });
        assert!(comparison.shared > 400, "{} are shared", comparison.shared);
    }
}
