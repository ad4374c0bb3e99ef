//! Learned proposals change the number of samples of a connection, and the choice of the connections that are traced.
//! The survey judges a term by what the other terms teach: samples of the film do not know the term's own square and
//! visibility, so the sums leave them out.

use super::counts::Counts;
use super::learning::Lessons;
use super::moments::{Judgement, RelativeTerm};
use super::survey::Survey;
use super::terms::Known;
use super::{Settings, TrainingInput};
use crate::film::FilmSettings;
use crate::guide::Cells;

/// Estimates the variance of plans from a survey.
pub(super) struct Judge<'a> {
    input: TrainingInput<'a>,
    survey: &'a Survey,
    nothing: Vec<Known>,
    /// The knowledge of each term that `lvc` learns. None: it learns nothing.
    learned: Option<Vec<Known>>,
    /// κ.
    light_vertices: f64,
}

impl<'a> Judge<'a> {
    /// Learns from `survey` for all plans, by one plan's settings, `typical`.
    pub(super) fn new(
        input: TrainingInput<'a>,
        typical: &Settings,
        survey: &'a Survey,
        cells: &Cells,
    ) -> Self {
        let lessons = Lessons::of(input, typical, survey, cells);
        let mut judge = Self {
            input,
            survey,
            nothing: survey.terms.iter().map(Known::nothing).collect(),
            learned: None,
            light_vertices: survey.light_vertices(),
        };
        if let Some(lessons) = lessons {
            let counts = judge.counts(typical);
            judge.learned = Some(survey.known(input.view.film(), &lessons, &counts));
            judge.light_vertices = lessons.light_vertices;
        }
        judge
    }

    /// Returns the counts of the estimator of `settings`.
    pub(super) fn counts(&self, settings: &Settings) -> Counts {
        let surveyed = self.input.settings.path.roulette;
        let pixels = self.input.view.film().crop.area();
        Counts::new(settings, surveyed, self.light_vertices, pixels)
    }

    /// Returns the variance of the estimator of `settings`.
    pub(super) fn judge(&self, settings: &Settings, terms: &[RelativeTerm]) -> Judgement {
        let learned = self.learned.as_ref().filter(|_| settings.learns());
        let known = learned.unwrap_or(&self.nothing);
        self.survey.judge(terms, known, &self.counts(settings))
    }
}

impl Survey {
    /// Returns what `lessons` teach of each term, if the numbers of samples are `counts`.
    pub(super) fn known(
        &self,
        film: &FilmSettings,
        lessons: &Lessons,
        counts: &Counts,
    ) -> Vec<Known> {
        let mut known: Vec<_> = self.terms.iter().map(Known::nothing).collect();
        // For each term, the sums over its connections of their parts times powers of the learned factor, for t = 2
        // and for t > 2.
        let mut parts = vec![[[0.0; 4]; 2]; self.terms.len()];
        // A drawn light vertex is one more than the mean number of all light subpaths in its cell: this much for each
        // subpath.
        let one = counts
            .draws
            .as_ref()
            .map_or(0.0, |draws| 1.0 / draws.subpaths);
        let connections = self.connections(film, &lessons.cells, counts);
        let (traced, possible) = connections.split_at(self.log.traced.len());
        for (possible, connection) in self.log.possible.iter().zip(possible) {
            let [factor, crowded] = [0.0, one].map(|more| lessons.factor_without(connection, more));
            let of_term = &mut parts[possible.term as usize][usize::from(possible.strategy.t > 2)];
            let part = f64::from(possible.part);
            let excess = factor * (factor / crowded - 1.0);
            for (sum, of) in of_term
                .iter_mut()
                .zip([1.0, factor, factor * factor, excess])
            {
                *sum += part * of;
            }
            if possible.strategy == self.terms[possible.term as usize].strategy {
                known[possible.term as usize].rate = factor;
            }
        }
        for ((known, term), parts) in known.iter_mut().zip(&self.terms).zip(&parts) {
            let connection = term.edge.map(|edge| &traced[edge as usize]);
            if let Some(connection) = connection {
                known.root_visibility = lessons.root_visibility_without(connection);
            }
            let has_none = parts.iter().all(|[part, ..]| *part == 0.0);
            if let Some(connection) = connection.filter(|_| has_none && !term.is_next_event) {
                known.rate = lessons.factor(connection.cells);
            }
            let gain = lessons.gain(term.light);
            for (deeper, &[uniform, learned, squares, excess]) in parts.iter().enumerate() {
                let [factor, square, excess] = match uniform {
                    0.0 => [known.rate, known.rate * known.rate, 0.0],
                    _ => [learned, squares, excess].map(|sum| sum / uniform),
                };
                let part = f64::from(known.shares.connections[deeper]);
                known.excess[deeper] = part * excess * gain;
                known.shares.connections[deeper] *= (factor * gain) as f32;
                known.squares[deeper] *= square * gain;
            }
            known.rate *= gain;
            known.shares.light_images *= gain as f32;
        }
        known
    }
}
