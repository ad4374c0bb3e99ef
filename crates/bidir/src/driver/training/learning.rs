//! Learns from the connections of the survey, before the first pass: which light vertices to propose to camera
//! vertices, which of them are visible, and where light subpaths begin.

use super::constants::LEARNING_SAMPLES;
use super::counts::Counts;
use super::emission::{self, Connection, Evidence};
use super::log::Ends;
use super::survey::Survey;
use super::{Settings, TrainingInput};
use crate::film::FilmSettings;
use crate::guide::{Cell, Cells, PairSums};
use crate::integrator::{LightStart, ProposalKind};
use crate::light::LightChoice;

impl Survey {
    /// Returns the connections of the survey: first those that were traced, then those that could have made paths.
    /// Squares are of values with `counts` samples.
    pub(super) fn connections(
        &self,
        film: &FilmSettings,
        cells: &Cells,
        counts: &Counts,
    ) -> Vec<Connection> {
        let connection = |ends: Ends, evidence| Connection {
            light: ends.light,
            cells: self.log.cells_of(cells, ends),
            evidence,
        };
        let traced = (self.log.traced.iter())
            .map(|&(ends, arrived)| connection(ends, Evidence::Traced(arrived)));
        let possible = self.log.possible.iter().map(|possible| {
            let value = self.terms[possible.term as usize].value_by(film, counts);
            let count = counts.of_connection(possible.strategy);
            let square = count * value * value * f64::from(possible.part);
            connection(possible.ends, Evidence::Square(square))
        });
        traced.chain(possible).collect()
    }

    /// Returns sums that hold no connections, only the number of light vertices in each cell per light subpath, if
    /// each light begins `gain` times as many subpaths as in the survey.
    fn pair_sums(&self, cells: &Cells, gain: impl Fn(u32) -> f64) -> PairSums {
        let mut light_vertices = vec![0.0; Cells::COUNT];
        for (cell, light) in self.log.light_vertices(cells) {
            light_vertices[cell.index()] += gain(light) / self.samples();
        }
        PairSums::uniform(light_vertices)
    }
}

/// The knowledge of connections that a survey gives.
pub(super) struct Lessons {
    pub(super) cells: Cells,
    pub(super) sums: PairSums,
    power: LightChoice,
    pub(super) light_start: Option<LightChoice>,
    /// Σ_c √(κ_c Σ X²) for each cell of camera vertices.
    roots: Vec<f64>,
    /// κ for light subpaths that begin by the learned choice.
    pub(super) light_vertices: f64,
}

impl Lessons {
    /// Learns for the estimator of `settings`. None: it does not learn, or `survey` has too few samples.
    pub(super) fn of(
        input: TrainingInput<'_>,
        settings: &Settings,
        survey: &Survey,
        cells: &Cells,
    ) -> Option<Self> {
        let is_enough = survey.stats.samples >= LEARNING_SAMPLES && survey.light_vertices() > 0.0;
        if !settings.learns() || !is_enough {
            return None;
        }
        let (power, cells) = (input.scene.light_choice(), cells.clone());
        let film = input.view.film();
        let counts = Counts::new(
            settings,
            settings.path.roulette,
            survey.light_vertices(),
            film.crop.area(),
        );
        let connections = survey.connections(film, &cells, &counts);
        let light_start = match settings.lvc.light_start {
            LightStart::Learned => emission::learned(power, &connections, survey.samples()),
            LightStart::Power => None,
        };
        let gain = |light| emission::gain(power, light_start.as_ref(), light);
        let mut sums = survey.pair_sums(&cells, gain);
        if settings.lvc.proposal == ProposalKind::Learned {
            for connection in &connections {
                let pair = Cells::pair(connection.cells[0], connection.cells[1]);
                match connection.evidence {
                    Evidence::Traced(has_arrived) => sums.see(pair, has_arrived),
                    // If a light begins g times as many subpaths, each of them contributes 1/g.
                    Evidence::Square(square) => {
                        sums.squares[pair] += square / connection.light.map_or(1.0, gain);
                    }
                }
            }
        }
        let roots = sums.roots();
        let light_vertices = sums.light_vertices.iter().sum();
        Some(Self {
            cells,
            sums,
            power: power.clone(),
            light_start,
            roots,
            light_vertices,
        })
    }

    /// Returns the factor by which more light subpaths begin on `light` than by power.
    pub(super) fn gain(&self, light: u32) -> f64 {
        emission::gain(&self.power, self.light_start.as_ref(), light)
    }

    /// Returns n κ / M of a connection between these cells.
    pub(super) fn factor(&self, cells: [Cell; 2]) -> f64 {
        self.factor_with(cells, [0.0; 2])
    }

    /// Returns the [`factor`](Self::factor) without what `connection` itself taught, as if each light subpath had
    /// `more` light vertices in its cell.
    pub(super) fn factor_without(&self, connection: &Connection, more: f64) -> f64 {
        let Evidence::Square(square) = connection.evidence else {
            return self.factor(connection.cells);
        };
        let square = square / connection.light.map_or(1.0, |light| self.gain(light));
        self.factor_with(connection.cells, [square, more])
    }

    fn factor_with(&self, [light, camera]: [Cell; 2], changes: [f64; 2]) -> f64 {
        let others = [self.light_vertices, self.roots[camera.index()]];
        self.sums.count_factor(others, [light, camera], changes)
    }

    /// Returns √V̂ of the cells of `connection`, without what it taught itself. It is 1 if the connection was not
    /// traced.
    pub(super) fn root_visibility_without(&self, connection: &Connection) -> f32 {
        let Evidence::Traced(has_arrived) = connection.evidence else {
            return 1.0;
        };
        let pair = Cells::pair(connection.cells[0], connection.cells[1]);
        self.sums.root_visibility_without(pair, has_arrived)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::{
        Effort,
        tests::{WHOLE, input, room, survey_of, view},
    };
    use crate::integrator::IntegratorKind;
    use crate::testing::check_close;

    /// Two estimates of the second moment of connections: by the paths that they made, and by their parts of all
    /// paths.
    #[test]
    fn all_strategies_tell_the_second_moment_of_connections() {
        let (scene, view) = (room(), view(WHOLE));
        let settings = Settings::new(IntegratorKind::Lvc);
        let survey = survey_of(input(&scene, &view, &settings), Effort::WHOLE);
        let light_vertices = survey.light_vertices();
        let counts = Counts::new(&settings, settings.path.roulette, light_vertices, 256);
        let own = survey.terms.iter().map(|term| {
            let candidates = match (term.strategy.s, term.strategy.t) {
                (0 | 1, _) | (_, 1) => 0.0,
                (_, 2) => 12.0,
                _ => 1.0,
            };
            let value = term.value_by(view.film(), &counts);
            candidates / light_vertices * value * value
        });
        let own: f64 = own.sum();
        let all = survey.connections(view.film(), &survey.log.cells(), &counts);
        let square = |connection: &Connection| match connection.evidence {
            Evidence::Square(square) => square,
            Evidence::Traced(_) => 0.0,
        };
        let all: f64 = all.iter().map(square).sum();
        check_close(all, own, 0.02, "all strategies");
    }
}
