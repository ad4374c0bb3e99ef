//! The render before the first pass: the mean luminance of the image, by which shadow-ray roulette
//! sets its threshold. Sample i, at pixel i·STRIDE modulo the number of pixels, is one of the full
//! estimator that traces every connection.

use super::Settings;
use super::session::path_context;
use crate::integrator::{
    CandidateCount, Integrator, IntegratorKind, Sample, Workspace, connectable,
};
use crate::sampler::{Domain, Sampler};
use crate::scene::Scene;
use crate::select::ShadowRays;
use crate::spectrum::luminance;
use crate::stats::RayCounts;

/// What a short render before the first pass found: a pure function of scene and settings. Its
/// samples have random numbers of their own and never enter the film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Training {
    /// The mean luminance of the image.
    pub mean_luminance: f32,
    /// The mean number of vertices of a light subpath that camera vertices can be connected with.
    pub light_vertices: f64,
    /// The samples it took.
    pub samples: u64,
    /// The rays it cost.
    pub rays: RayCounts,
}

/// Enough for the mean luminance to within a few percent in most scenes.
const SAMPLES: u64 = 1 << 14;

/// The distance between the pixels of successive samples: a prime above any number of pixels, so
/// that they spread evenly.
const STRIDE: u64 = 2_654_435_761;

impl Training {
    /// Renders a few samples spread over the film, tracing every connection.
    pub(super) fn run(scene: &Scene, settings: &Settings) -> Self {
        let integrator = IntegratorKind::Bdpt
            .integrator(ShadowRays::All.selector(0.0), CandidateCount::default());
        let mut workspace = Workspace::default();
        let (mut sum, mut vertices) = (0.0, 0);
        for i in 0..SAMPLES {
            let (luminance, light_vertices) =
                sample(scene, settings, &*integrator, i, &mut workspace);
            sum += luminance;
            vertices += light_vertices;
        }
        Self {
            mean_luminance: (sum / SAMPLES as f64) as f32,
            light_vertices: vertices as f64 / SAMPLES as f64,
            samples: SAMPLES,
            rays: workspace.stats.rays,
        }
    }
}

/// The luminance that sample `i` adds to the mean pixel, and the number of its light vertices that can be
/// connected.
fn sample(
    scene: &Scene,
    settings: &Settings,
    integrator: &dyn Integrator,
    i: u64,
    workspace: &mut Workspace,
) -> (f64, usize) {
    let crop = scene.film().crop;
    let sampler = Sampler::new(settings.sampler, settings.seed);
    let pixel = crop.pixel((i.wrapping_mul(STRIDE) % crop.area()) as usize);
    let sample = Sample {
        pass: 0,
        pixel,
        camera: sampler.stream(Domain::TrainingCamera, i, 0),
        light: sampler.stream(Domain::TrainingLight, 0, i),
    };
    let context = path_context(scene, settings, 1.0, &sample);
    integrator.sample(&context, &sample, workspace);
    let y = |light| f64::from(luminance(scene.color().to_rgb(light, &context.wavelengths)));
    let splats: f64 = workspace
        .splats
        .iter()
        .map(|splat| y(splat.contribution.value))
        .sum();
    let luminance = y(workspace.value) + splats / crop.area() as f64;
    let light_vertices = connectable(&context, &workspace.light.vertices).count();
    (luminance, light_vertices)
}
