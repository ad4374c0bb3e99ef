//! The terms of the survey, and what estimators know of them.

use super::counts::Counts;
use crate::contribution::Contribution;
use crate::film::FilmSettings;
use crate::path::{Job, Shares};
use crate::strategy::Strategy;

/// A contribution to the image of the survey, or a connection that did not arrive.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurveyTerm {
    /// The number of its sample.
    pub(super) sample: u32,
    /// The number of its pixel in the crop.
    pub(super) pixel: u32,
    pub(super) strategy: Strategy,
    /// The light that its path begins on.
    pub(super) light: u32,
    /// v; 0 where it did not arrive. Unit: luminance.
    pub(super) value: f32,
    /// The score of a candidate, where nothing is learned.
    pub(super) score: f32,
    /// True of s = 1 where it draws a light point of its own.
    pub(super) is_next_event: bool,
    /// The number of its connection among those traced, if it is one that has places.
    pub(super) edge: Option<u32>,
    pub(super) shares: Shares,
}

impl SurveyTerm {
    /// Makes the term of a contribution of sample number `sample`, of which the filter takes `part` into `pixel`.
    pub(super) fn new(
        job: &Job<'_>,
        sample: u64,
        contribution: &Contribution,
        pixel: usize,
        part: f32,
        shares: Shares,
    ) -> Self {
        Self {
            sample: sample as u32,
            pixel: pixel as u32,
            strategy: contribution.term.strategy,
            light: contribution.term.light,
            value: job.lanes.luminance(contribution.value()) * part,
            score: 0.0,
            edge: None,
            is_next_event: usize::from(contribution.term.strategy.s)
                < job.settings.light_point.first_walked(),
            shares,
        }
    }

    pub(super) fn is_light_image(&self) -> bool {
        self.strategy.t == 1
    }

    /// Returns its part of the mean of `film`: there is a sample for each pixel, and a light image for the film.
    pub(super) fn of_mean_pixel(&self, film: &FilmSettings) -> f64 {
        if self.is_light_image() {
            f64::from(self.value) / film.light_paths() as f64
        } else {
            self.value.into()
        }
    }

    /// Returns f / D_k: what it is of the value of a pixel of `film` where the numbers of samples are `counts`.
    pub(super) fn value_by(&self, film: &FilmSettings, counts: &Counts) -> f64 {
        self.of_mean_pixel(film) / counts.density_ratio(&self.shares).all
    }
}

/// The learned numbers of samples of a term's connections, and their visibility.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// The shares of its path, with the numbers of samples that are learned.
    pub(super) shares: Shares,
    /// Σ n_j² p_j / D of connections with light walks, of t = 2 and of t > 2, where n_j has what is learned alone.
    pub(super) squares: [f64; 2],
    /// Σ n_j p_j (e - 1) / D, where a connection has e times the second moment, as light vertices of its cell are few.
    pub(super) excess: [f64; 2],
    /// The factor by which its own connection has more samples.
    pub(super) rate: f64,
    /// √V̂.
    pub(super) root_visibility: f32,
}

impl Known {
    /// Returns the knowledge where nothing is learned.
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
