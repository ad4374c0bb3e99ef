//! What a sample leaves behind: subpaths, candidates, chosen rays and contributions, in buffers
//! that the next sample uses again. A value that no film can sum is dropped and counted here.

use crate::film::fixed::LARGEST_CONTRIBUTION;
use crate::math::Vec2;
use crate::path::{
    PathContext, PathDensities, Strategy, Subpath, Vertex, camera_subpath, light_subpath,
};
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::scene::Scene;
use crate::select::{Candidate, Chosen};
use crate::spectrum::Spectrum;
use crate::stats::{Dropped, Stats};

/// One camera sample, with the light subpath that goes with it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The pass.
    pub pass: u64,
    /// The pixel.
    pub pixel: [u32; 2],
    /// The random numbers of the camera subpath and of its connections.
    pub camera: SampleStream,
    /// The random numbers of the light subpath and of its light image.
    pub light: SampleStream,
}

/// A contribution to the light image.
#[derive(Clone, Copy, Debug)]
pub struct Splat {
    /// Where it lands on the film.
    pub raster: Vec2,
    /// Its value.
    pub value: Spectrum,
    /// The numbers that draw the pixel.
    pub u: Vec2,
}

/// What a thread keeps from sample to sample, so that no sample allocates: buffers, the
/// contributions of the last sample, and counters.
#[derive(Debug, Default)]
pub struct Workspace {
    /// The camera subpath.
    pub camera: Subpath,
    /// The light subpath.
    pub light: Subpath,
    /// The light points of s = 1, by camera vertex.
    pub next_events: Vec<Option<Vertex>>,
    /// The connections that may be traced.
    pub candidates: Vec<Candidate>,
    /// The connections that were traced.
    pub chosen: Vec<Chosen>,
    /// The contribution to the sample's own pixel.
    pub value: Spectrum,
    /// The contributions to the light image.
    pub splats: Vec<Splat>,
    /// What was counted.
    pub stats: Stats,
    /// The densities of the path whose weight is computed.
    pub(super) densities: PathDensities,
}

impl Workspace {
    /// Forgets the last sample.
    pub(super) fn begin(&mut self) {
        self.camera.vertices.clear();
        self.camera.escape = None;
        self.light.vertices.clear();
        self.next_events.clear();
        self.candidates.clear();
        self.chosen.clear();
        self.splats.clear();
        self.value = Spectrum::ZERO;
    }

    /// Walks the camera subpath of `sample`.
    pub(super) fn walk_camera(&mut self, context: &PathContext<'_>, sample: &Sample) {
        self.stats.samples += 1;
        let at = |purpose| sample.camera.get_2d(Dimension::at(0, purpose));
        let (offset, weight) = context.scene.film().filter.sample(at(Purpose::Film));
        let raster = Vec2::new(sample.pixel[0] as f32, sample.pixel[1] as f32) + 0.5 + offset;
        let ray = context.scene.camera().sample_ray(raster, at(Purpose::Lens));
        let (camera, stats) = (&mut self.camera, &mut self.stats);
        camera_subpath(context, &sample.camera, &ray, weight, camera, stats);
    }

    /// Walks the light subpath of `sample`.
    pub(super) fn walk_light(&mut self, context: &PathContext<'_>, sample: &Sample) {
        light_subpath(context, &sample.light, &mut self.light, &mut self.stats);
    }

    /// The light vertex and the camera vertex that a candidate connects.
    pub fn ends(&self, strategy: Strategy) -> (Vertex, Vertex) {
        let (s, t) = (usize::from(strategy.s), usize::from(strategy.t));
        let z = match self.next_events[t - 1] {
            Some(x0) if s == 1 => x0,
            _ => self.light.vertices[s - 1],
        };
        (z, self.camera.vertices[t - 1])
    }

    /// True where a contribution can be summed; else it is counted as dropped.
    pub(super) fn accepts(&mut self, sample: &Sample, strategy: Strategy, value: Spectrum) -> bool {
        let fine = value
            .0
            .iter()
            .all(|lane| lane.abs() <= LARGEST_CONTRIBUTION);
        if !fine {
            let dropped = Dropped {
                pass: sample.pass,
                pixel: sample.pixel,
                strategy,
            };
            self.stats.drop_contribution(dropped);
        }
        fine
    }

    /// Adds a contribution to the sample's own pixel, if it can be summed.
    pub(super) fn add(&mut self, sample: &Sample, strategy: Strategy, value: Spectrum) {
        if self.accepts(sample, strategy, value) {
            self.value += value;
        }
    }

    /// Traces a connection ray: true where nothing is in its way.
    pub(super) fn trace_connection(&mut self, scene: &Scene, a: &Vertex, b: &Vertex) -> bool {
        self.stats.rays.connection += 1;
        let occluded = scene.occluded(&a.segment_end(), &b.segment_end());
        self.stats.connections_blocked += u64::from(occluded);
        !occluded
    }

    /// Traces a ray of the light image: true where nothing is in its way.
    pub(super) fn trace_light_image(&mut self, scene: &Scene, a: &Vertex, b: &Vertex) -> bool {
        self.stats.rays.light_image += 1;
        let occluded = scene.occluded(&a.segment_end(), &b.segment_end());
        self.stats.light_image_blocked += u64::from(occluded);
        !occluded
    }
}
