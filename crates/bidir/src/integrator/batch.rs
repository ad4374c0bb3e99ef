//! The samples in flight, and what each stage leaves for the next: arrays that the next batch uses again.

use super::cache::LightCache;
use super::journal::drop_term;
use super::stages::LightEnds;
use super::{Entry, Fate, Lists};
use crate::contribution::is_summable;
use crate::path::{Subpaths, Vertex, Weights};
use crate::sampler::SampleStream;
use crate::scene::ShadowRayBuffers;
use crate::select::{Candidate, Chosen};
use crate::spectrum::Spectrum;
use crate::stats::{Clock, Stats, Stopwatch};
use crate::strategy::Strategy;

/// One camera sample, with the light subpath that goes with it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The pass.
    pub pass: u64,
    /// The pixel.
    pub pixel: [u32; 2],
    /// The random numbers of the camera subpath, and of its connections.
    pub camera: SampleStream,
    /// The random numbers of the light points of the camera subpath: those of `camera`, but in a survey, which draws
    /// points anew.
    pub points: SampleStream,
    /// The random numbers of the light subpath and of its light image.
    pub light: SampleStream,
}

impl Sample {
    /// Returns the sample of `pixel` in `pass` with the random numbers of its camera subpath and of its light subpath.
    #[inline]
    pub fn new(pass: u64, pixel: [u32; 2], camera: SampleStream, light: SampleStream) -> Self {
        Self {
            pass,
            pixel,
            camera,
            points: camera,
            light,
        }
    }
}

/// The samples, and the subpaths that were walked for them.
#[derive(Debug, Default)]
pub struct Walks {
    /// The samples.
    pub samples: Vec<Sample>,
    /// The camera subpath of each sample.
    pub camera: Subpaths,
    /// Light subpaths: of each sample, or of the group that shares them; and the light points of s = 1.
    pub light: Subpaths,
}

impl Walks {
    /// Returns the number of the first sample's light subpath. The samples' walks must be the last ones.
    pub(super) fn first_light(&self) -> usize {
        self.light.count() - self.samples.len()
    }

    /// Returns the vertices of a `connection`, those of its light subpath and those of its camera subpath.
    pub(super) fn subpaths(&self, connection: &Candidate) -> [&[Vertex]; 2] {
        let Strategy { s, t } = connection.term.strategy;
        let [z, y] = connection.vertices.map(|vertex| vertex as usize);
        [
            &self.light.vertices()[z + 1 - usize::from(s)..=z],
            &self.camera.vertices()[y + 1 - usize::from(t)..=y],
        ]
    }
}

/// Connections, before and after the choice of those that are traced.
#[derive(Debug, Default)]
pub struct Candidates {
    /// The connections of each sample that may be traced.
    pub offered: Lists<Candidate>,
    /// Connections that are not offered: their value is zero, or no film can sum it.
    pub(crate) unoffered: Vec<Candidate>,
    /// The candidates that were chosen. The last entries of the batch are theirs, in this order.
    pub chosen: Vec<Chosen>,
}

/// The belongings of a thread: memory that stages use, counters, and a clock.
#[derive(Debug, Default)]
pub struct Worker {
    pub(super) weights: Weights,
    pub(super) shadow_rays: ShadowRayBuffers,
    /// The counters.
    pub stats: Stats,
    /// Measures stages, where the host has a clock for it.
    pub stopwatch: Stopwatch,
}

/// The samples in flight, with all that was made of them so far.
#[derive(Debug, Default)]
pub struct Batch {
    /// The samples and their subpaths.
    pub walks: Walks,
    pub(super) cache: LightCache,
    pub(super) light_ends: LightEnds,
    /// The connections.
    pub candidates: Candidates,
    /// The terms for the samples' own pixels.
    pub entries: Vec<Entry>,
    /// Their sum for each sample.
    pub values: Vec<Spectrum>,
    /// The terms of the light image.
    pub splats: Vec<Entry>,
    /// Memory of the driver: the luminance that each sample adds to its own pixel by a strategy.
    pub(crate) luminances: Vec<((u32, Strategy), f64)>,
    /// The memory, counters and clock of the thread that computes the batch.
    pub worker: Worker,
}

impl Batch {
    /// Makes a batch that measures its stages where there is a clock.
    pub(crate) fn timed_by(clock: Option<Clock>) -> Self {
        let mut batch = Self::default();
        batch.worker.stopwatch = Stopwatch::new(clock);
        batch
    }

    /// Replaces the samples, and clears the output of all stages but light subpaths.
    pub fn fill(&mut self, samples: impl IntoIterator<Item = Sample>) {
        self.walks.samples.clear();
        self.walks.samples.extend(samples);
        self.walks.camera.clear();
        self.walks.light.forget_points();
        self.light_ends.clear();
        self.candidates.offered.clear();
        self.candidates.unoffered.clear();
        self.candidates.chosen.clear();
        self.entries.clear();
        self.splats.clear();
        self.values.clear();
        let count = self.walks.samples.len();
        self.values.resize(count, Spectrum::ZERO);
    }

    /// Clears the light subpaths, with their sums and the cache.
    pub fn forget_light(&mut self) {
        self.walks.light.clear();
        self.cache.clear();
    }

    /// Adds the entries to the values of their samples, but for those that no film can sum.
    pub(super) fn sum_entries(&mut self) {
        for entry in &mut self.entries {
            if !entry.is_added() {
                continue;
            }
            let value = entry.value();
            if is_summable(value) {
                self.values[entry.sample as usize] += value;
            } else {
                entry.fate = Fate::Dropped;
                let sample = &self.walks.samples[entry.sample as usize];
                let strategy = entry.term.strategy;
                drop_term(&mut self.worker.stats, sample, strategy);
            }
        }
    }
}
