//! The terms of the survey, and the knowledge of them that estimators learn.

use super::counts::Counts;
use crate::film::FilmSettings;
use crate::integrator::Entry;
use crate::path::{Job, Shares};
use crate::strategy::Strategy;

/// A contribution to the image of the survey, or a connection that is not visible.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurveyTerm {
    /// The number of its sample.
    pub(super) sample: u32,
    /// The number of its pixel in the crop.
    pub(super) pixel: u32,
    pub(super) strategy: Strategy,
    /// The light that its path begins on.
    pub(super) light: u32,
    /// v; 0 if it is not visible. Unit: luminance.
    pub(super) value: f32,
    /// The score of a candidate without learned visibility; 0 for other terms.
    pub(super) score: f32,
    /// True for next-event estimation, s = 1 with a light point of its own.
    pub(super) is_next_event: bool,
    /// The number of its connection among those traced. None: it has none, or its light vertex is at infinity.
    pub(super) edge: Option<u32>,
    pub(super) shares: Shares,
}

impl SurveyTerm {
    /// Makes the term of a contribution of sample number `sample`; the filter adds the fraction `part` of it to
    /// `pixel`.
    pub(super) fn new(
        job: &Job<'_>,
        sample: u64,
        entry: &Entry,
        pixel: usize,
        part: f32,
        shares: Shares,
    ) -> Self {
        Self {
            sample: sample as u32,
            pixel: pixel as u32,
            strategy: entry.term.strategy,
            light: entry.term.light,
            value: job.lanes.luminance(entry.value()) * part,
            score: 0.0,
            edge: None,
            is_next_event: usize::from(entry.term.strategy.s)
                < job.settings.light_point.min_subpath_s(),
            shares,
        }
    }

    pub(super) fn is_light_image(&self) -> bool {
        self.strategy.t == 1
    }

    /// Returns the value that it adds to the mean pixel of `film`: a pixel has its own sample, and the whole film
    /// shares a splat.
    pub(super) fn of_mean_pixel(&self, film: &FilmSettings) -> f64 {
        if self.is_light_image() {
            f64::from(self.value) / film.pixel_count() as f64
        } else {
            self.value.into()
        }
    }

    /// Returns f / D_k, its value in a pixel of `film` if the numbers of samples are `counts`.
    pub(super) fn value_by(&self, film: &FilmSettings, counts: &Counts) -> f64 {
        self.of_mean_pixel(film) / counts.density_ratio(&self.shares).all
    }
}

/// The learned numbers of samples of the connections of a term's path, and the learned visibility of its own
/// connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// The shares of its path, by the learned numbers of samples.
    pub(super) shares: Shares,
    /// Σ n_j² p_j / D over connections with light walks, for t = 2 and for t > 2. n_j has only its learned factor.
    pub(super) squares: [f64; 2],
    /// Σ n_j p_j (e - 1) / D, if a connection has e times the second moment because its cell has few light vertices.
    pub(super) excess: [f64; 2],
    /// The factor by which learning changes the number of samples of its own connection.
    pub(super) rate: f64,
    /// √V̂.
    pub(super) root_visibility: f32,
}

impl Known {
    /// Returns the knowledge if nothing is learned.
    pub(super) fn nothing(term: &SurveyTerm) -> Self {
        Self {
            shares: term.shares,
            squares: term.shares.connections.map(f64::from),
            excess: [0.0; 2],
            rate: 1.0,
            root_visibility: 1.0,
        }
    }
}
