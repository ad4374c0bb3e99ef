//! Features of camera samples: of the first surface, and the cost of the sample.
//!
//! Each feature is a number, or three, of one sample; the film makes means or sums of them. The camera subpath finds
//! the surface; an estimator that walks no camera subpath traces one ray for it.

use super::Progress;
use crate::film::{Aov, AovKind, Layers};
use crate::integrator::{Batch, camera_ray};
use crate::math::Vec3;
use crate::path::{Job, Vertex};
use crate::sampler::{Dimension, Purpose};
use crate::scene::RayDraws;
use crate::spectrum::Spectrum;

/// The work of a thread so far: the difference of two readings is the cost of a sample.
pub(super) struct Meter {
    rays: u64,
    nanoseconds: u64,
}

impl Meter {
    /// Reads the counters, and the host's clock if `layers` ask for times.
    #[inline]
    pub(super) fn read(layers: &Layers, batch: &Batch, progress: &dyn Progress) -> Self {
        let is_timed = layers.feature(Aov::Time).is_some();
        Self {
            rays: batch.worker.stats.rays.total(),
            nanoseconds: if is_timed { progress.nanoseconds() } else { 0 },
        }
    }
}

/// The features of one camera sample.
pub(super) struct Features {
    surface: Option<FirstSurface>,
    rays: f32,
    seconds: f32,
}

/// The first surface along a camera ray.
struct FirstSurface {
    albedo: [f32; 3],
    point: Vec3,
    n_g: Vec3,
    n_s: Vec3,
    depth: f32,
}

impl Features {
    /// Returns the features of the one sample of `batch`, with the meters read before and after the sample.
    pub(super) fn new(
        job: &Job<'_>,
        layers: &Layers,
        batch: &mut Batch,
        [before, after]: [&Meter; 2],
    ) -> Self {
        let kinds = [AovKind::Surface, AovKind::Sample];
        let sees = layers.aovs().iter().any(|aov| kinds.contains(&aov.kind()));
        let surface = sees.then(|| FirstSurface::find(job, batch));
        Self {
            surface: surface.flatten(),
            rays: (after.rays - before.rays) as f32,
            seconds: after.nanoseconds.saturating_sub(before.nanoseconds) as f32 * 1e-9,
        }
    }

    /// Returns the numbers of all images, in the order of [`Layers::aovs`].
    pub(super) fn values<'a>(&'a self, layers: &'a Layers) -> impl Iterator<Item = f32> + 'a {
        let aovs = layers.aovs().iter();
        aovs.flat_map(|&aov| self.value(aov).into_iter().take(aov.sums()))
    }

    /// Returns the numbers of an image, one for each of its sums.
    fn value(&self, aov: Aov) -> [f32; 3] {
        let of = |get: fn(&FirstSurface) -> [f32; 3]| self.surface.as_ref().map_or([0.0; 3], get);
        match aov {
            Aov::Albedo => of(|surface| surface.albedo),
            Aov::Position => of(|surface| surface.point.to_array()),
            Aov::Normal => of(|surface| surface.n_g.to_array()),
            Aov::ShadingNormal => of(|surface| surface.n_s.to_array()),
            Aov::Depth => of(|surface| [surface.depth; 3]),
            Aov::Coverage => of(|_| [1.0; 3]),
            Aov::Rays => [self.rays; 3],
            Aov::Time => [self.seconds; 3],
            Aov::Samples | Aov::Variance => [0.0; 3],
        }
    }
}

impl FirstSurface {
    /// Finds the first surface of the one sample of `batch`. None: the ray escapes.
    fn find(job: &Job<'_>, batch: &mut Batch) -> Option<Self> {
        let sample = &batch.walks.samples[0];
        // A walk in a medium may scatter before it reaches a surface.
        if batch.walks.camera.count() > 0 && !job.scene.has_media() {
            let surface = batch.walks.camera.get(0).vertices.get(1)?;
            return Some(Self::new(job, surface));
        }
        let (ray, _) = camera_ray(job, sample);
        batch.worker.stats.rays.camera += 1;
        let draws = RayDraws::new(&sample.camera, 1).until(job.stop);
        let hit = job.scene.intersect(ray.origin, ray.direction, draws)?;
        let u_mix = || sample.camera.get_1d(Dimension::at(1, Purpose::Mix));
        let (wo, beta) = (-ray.direction, Spectrum::ONE);
        let surface = Vertex::surface(job, &hit, wo, beta, u_mix);
        Some(Self::new(job, &surface))
    }

    fn new(job: &Job<'_>, surface: &Vertex) -> Self {
        let wo = surface.wo;
        let space = job.scene.space();
        let [_, n_s] = surface.point_and_normal();
        let albedo = surface.albedo(wo);
        let toward_camera = |n: Vec3| if n.dot(wo) < 0.0 { -n } else { n };
        Self {
            albedo: job.lanes.to_rgb(albedo),
            point: space.world_point(surface.locus.point).as_vec3(),
            n_g: toward_camera(surface.locus.n_g),
            n_s: toward_camera(n_s),
            depth: space.world_length(job.view.camera().depth(surface.locus.point)),
        }
    }
}
