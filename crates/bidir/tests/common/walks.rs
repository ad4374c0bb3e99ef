//! Pairs of subpaths, walked in a scene.

use super::scenes::Shot;
use bidir::guide::{Cells, LightProposals, PairSums};
use bidir::light::LightChoice;
use bidir::path::{Job, PathSettings, Subpath, Subpaths, Vertex, camera_subpath, light_subpath};
use bidir::sampler::{Dimension, Domain, Purpose, Sampler, SamplerKind};
use bidir::scene::Edge;
use bidir::spectrum::Spectrum;
use bidir::stats::Stats;

/// How many pairs a scene gets.
const PAIRS: u64 = 400;

/// Walks the light subpath and the camera subpath of a pair.
fn walk(job: &Job<'_>, index: u64, [light, camera]: [&mut Subpaths; 2]) {
    let sampler = Sampler::new(SamplerKind::Independent, 5);
    let stream = sampler.stream(Domain::Camera, 0, index);
    let raster = stream.get_2d(Dimension::at(0, Purpose::Film)) * 8.0;
    let lens = stream.get_2d(Dimension::at(0, Purpose::Lens));
    let ray = job.view.camera().sample_ray(raster, || lens);
    let mut stats = Stats::default();
    camera.clear();
    camera_subpath(job, &stream, &ray, 1.0, camera, &mut stats);
    light.clear();
    let stream = sampler.stream(Domain::Light, 0, index);
    light_subpath(job, &stream, light, &mut stats);
}

/// The media between two vertices. None: nothing arrives, as far as a scene with media says so; one without says
/// nothing.
pub(crate) fn edge(job: &Job<'_>, a: &Vertex, b: &Vertex) -> Option<Edge> {
    let scene = job.scene;
    if scene.has_media() {
        return scene.edge([&a.locus, &b.locus], job.lanes, job.stop);
    }
    Some(Edge {
        transmittance: Spectrum::splat(1.0),
        to_b: 1.0,
        to_a: 1.0,
        is_guessed: false,
    })
}

/// Calls `f` with the job of a scene and a number of subpath pairs.
pub(crate) fn for_each_pair(
    settings: &PathSettings,
    scene: &Shot,
    f: impl FnMut(&Job<'_>, &Subpath<'_>, &Subpath<'_>),
) {
    for_some_pairs(PAIRS, scene.job(settings), f);
}

/// Proposals for cells of the scene that say something else of every pair, and nothing of some.
pub(crate) fn some_proposals(scene: &Shot) -> LightProposals {
    let (mut points, settings) = (Vec::new(), PathSettings::default());
    for_each_pair(&settings, scene, |_, light, camera| {
        let vertices = light.vertices.iter().chain(camera.vertices);
        points.extend(vertices.map(|vertex| vertex.locus.point));
    });
    // Any numbers, zero among them.
    let number = |i: usize| (i.wrapping_mul(2_654_435_761) >> 7) % 11;
    let numbers = |count: usize| (0..count).map(|i| number(i) as f64);
    let sums = PairSums {
        light_vertices: numbers(Cells::COUNT).collect(),
        squares: numbers(Cells::COUNT * Cells::COUNT).collect(),
        arrived: vec![[0; 2]; Cells::COUNT * Cells::COUNT],
    };
    LightProposals::new(Cells::new(&mut points), &sums)
}

/// Another choice of lights than by power.
pub(crate) fn some_light_start(scene: &Shot) -> LightChoice {
    let lights = 0..scene.light_choice().count();
    LightChoice::with_weights(lights.map(|light| (7 - light * 5 % 7) as f32))
}

/// Calls `f` with `job` and the first `pairs` pairs of subpaths.
pub(crate) fn for_some_pairs(
    pairs: u64,
    job: Job<'_>,
    mut f: impl FnMut(&Job<'_>, &Subpath<'_>, &Subpath<'_>),
) {
    let [mut light, mut camera] = [Subpaths::default(), Subpaths::default()];
    for index in 0..pairs {
        walk(&job, index, [&mut light, &mut camera]);
        f(&job, &light.get(0), &camera.get(0));
    }
}
