//! Learns from the connections of the survey, before the first pass: which light vertices to propose to camera
//! vertices, which of them are visible, and where light subpaths begin.

use super::constants::{LEARNING_SAMPLES, MOST_PARTS};
use super::counts::Counts;
use super::emission::{self, Connection, Evidence};
use super::survey::Survey;
use super::{Settings, Task, Training};
use crate::contribution;
use crate::film::FilmSettings;
use crate::guide::{Cell, Cells, LightProposals, PairSums};
use crate::integrator::{Batch, LightStart, ProposalKind, connectable};
use crate::light::LightChoice;
use crate::math::Vec3;
use crate::path::{ConnectionPart, Job};
use crate::select::Candidate;
use crate::strategy::Strategy;

/// The ends of a connection.
#[derive(Clone, Copy)]
struct Ends {
    /// The places of its light vertex and of its camera vertex, by number.
    places: [u32; 2],
    /// The light that its light subpath begins on. None: it is with a light point of next-event estimation.
    light: Option<u32>,
}

/// A connection that could have made a path.
#[derive(Clone, Copy)]
pub(super) struct Possible {
    ends: Ends,
    /// The strategy that has this connection.
    pub(super) strategy: Strategy,
    /// The number of the path's term.
    pub(super) term: u32,
    /// Its part of the survey's D.
    pub(super) part: f32,
}

/// Vertices and connections of samples.
#[derive(Default)]
pub(super) struct Found {
    /// Points and normals of vertices.
    places: Vec<[Vec3; 2]>,
    /// The light vertices that can be connected, by place, with the light that their subpath begins on.
    light: Vec<(u32, u32)>,
    /// The camera vertices that can be connected, by place.
    camera: Vec<u32>,
    /// The connections that were traced, and if they arrived.
    traced: Vec<(Ends, bool)>,
    possible: Vec<Possible>,
    /// The first places of the sample that was begun last.
    sample: Places,
}

/// The numbers of the first places of a sample's light vertices and camera vertices.
#[derive(Clone, Copy, Default)]
struct Places {
    light: u32,
    camera: u32,
}

impl Places {
    /// Returns the places of light vertex number `z` and of camera vertex number `y`.
    fn of(self, [z, y]: [u32; 2]) -> [u32; 2] {
        [self.light + z, self.camera + y]
    }

    /// Returns the places of the vertices x_{j-1} and x_j of a path of `strategy`, whose light vertices end before
    /// number `end`.
    fn of_edge(self, strategy: Strategy, end: u32, j: u16) -> [u32; 2] {
        let (s, t) = (u32::from(strategy.s), u32::from(strategy.t));
        [j - 1, j].map(u32::from).map(|i| {
            if i < s {
                self.light + end + i - s
            } else {
                self.camera + s + t - 1 - i
            }
        })
    }
}

impl Found {
    /// Adds what other samples found, whose terms have numbers from `terms` on.
    pub(super) fn add(&mut self, more: Self, terms: u32) {
        let places = self.places.len() as u32;
        self.places.extend(more.places);
        let light = more.light.iter();
        self.light
            .extend(light.map(|&(place, light)| (place + places, light)));
        let camera = more.camera.iter().map(|place| place + places);
        self.camera.extend(camera);
        let moved = |ends: Ends| Ends {
            places: ends.places.map(|place| place + places),
            ..ends
        };
        let traced = more.traced.iter();
        self.traced
            .extend(traced.map(|&(ends, has_arrived)| (moved(ends), has_arrived)));
        let possible = more.possible.iter();
        self.possible.extend(possible.map(|possible| Possible {
            ends: moved(possible.ends),
            term: possible.term + terms,
            ..*possible
        }));
    }

    /// Adds the vertices of the one sample of `batch`. The connections that follow are of this sample.
    pub(super) fn begin(&mut self, job: &Job<'_>, batch: &Batch) {
        let [walk, camera] =
            [&batch.walked.light, &batch.walked.camera].map(|walks| walks.get(0).vertices);
        let light = batch.walked.light.vertices();
        let first = self.places.len() as u32;
        self.sample = Places {
            light: first,
            camera: first + light.len() as u32,
        };
        let all = light.iter().chain(camera);
        self.places.extend(all.map(crate::path::Vertex::place));
        let [z, y] = self.sample.of([0; 2]);
        let light_vertex = |i: usize| Some((z + i as u32, walk[0].light?));
        let connectable = connectable(job.settings.light_point, walk);
        self.light.extend(connectable.filter_map(light_vertex));
        let ends = (1..camera.len()).filter(|&i| !camera[i].is_delta());
        self.camera.extend(ends.map(|i| y + i as u32));
    }

    /// Adds a connection that was traced, and returns its number. None: it has no places.
    pub(super) fn trace(
        &mut self,
        batch: &Batch,
        candidate: &Candidate,
        has_arrived: bool,
    ) -> Option<u32> {
        let z = candidate.vertices[0] as usize;
        if batch.walked.light.vertices()[z].locus.is_infinite() {
            return None;
        }
        let is_walked = z < batch.walked.light.get(0).vertices.len();
        let ends = Ends {
            places: self.sample.of(candidate.vertices),
            light: is_walked.then_some(candidate.term.light),
        };
        self.traced.push((ends, has_arrived));
        Some(self.traced.len() as u32 - 1)
    }

    /// Adds the connections, by their `parts`, that could have made the path of `made`, the term with number
    /// `term`; `candidate` is the candidate that it was, if it was one.
    pub(super) fn path(
        &mut self,
        made: &contribution::Term,
        candidate: Option<&Candidate>,
        parts: &[ConnectionPart],
        term: u32,
    ) {
        let s = u32::from(made.strategy.s);
        let end = candidate.map_or(s, |candidate| candidate.vertices[0] + 1);
        let (sample, count) = (self.sample, self.places.len() as u32);
        let is_long = parts.len() > MOST_PARTS;
        let is_own = |j: u16| candidate.is_some() && u32::from(j) == s;
        let counted = parts.iter().filter(|&&(j, _)| !is_long || is_own(j));
        let possible = counted.map(|&(j, part)| Possible {
            ends: Ends {
                places: sample.of_edge(made.strategy, end, j),
                light: Some(made.light),
            },
            strategy: made.strategy.with_light_vertices(j),
            term,
            part: if is_long { 1.0 } else { part },
        });
        // A walk that escaped to the light has no vertex there, and a light of no power begins no subpath.
        let exists = |possible: &Possible| {
            possible.ends.places[0] < count && possible.part > 0.0 && possible.part.is_finite()
        };
        self.possible.extend(possible.filter(exists));
    }

    /// Returns the number of connections that were traced.
    pub(super) fn traced(&self) -> u32 {
        self.traced.len() as u32
    }

    /// Cells that suit the vertices.
    pub(super) fn cells(&self) -> Cells {
        let light = self.light.iter().map(|&(place, _)| place);
        let all = light.chain(self.camera.iter().copied());
        let mut points: Vec<_> = all.map(|place| self.places[place as usize][0]).collect();
        Cells::new(&mut points)
    }

    fn cell(&self, cells: &Cells, place: u32) -> Cell {
        let [point, n] = self.places[place as usize];
        cells.of(point, n)
    }
}

impl Survey {
    /// Returns κ: the mean number of vertices of a light subpath that can be connected.
    pub(super) fn light_vertices(&self) -> f64 {
        self.found.light.len() as f64 / self.samples()
    }

    /// Returns the connections that could have made paths.
    pub(super) fn possible(&self) -> impl Iterator<Item = &Possible> {
        self.found.possible.iter()
    }

    /// Returns the knowledge of connections, first of those that were traced, then of those that could have made paths;
    /// squares are those where the numbers of samples are `counts`.
    pub(super) fn connections(
        &self,
        film: &FilmSettings,
        cells: &Cells,
        counts: &Counts,
    ) -> Vec<Connection> {
        let connection = |ends: Ends, evidence| Connection {
            light: ends.light,
            cells: ends.places.map(|place| self.found.cell(cells, place)),
            evidence,
        };
        let traced = (self.found.traced.iter())
            .map(|&(ends, arrived)| connection(ends, Evidence::Traced(arrived)));
        let possible = self.found.possible.iter().map(|possible| {
            let value = self.terms[possible.term as usize].value_by(film, counts);
            let count = counts.of_connection(possible.strategy);
            let square = count * value * value * f64::from(possible.part);
            connection(possible.ends, Evidence::Square(square))
        });
        traced.chain(possible).collect()
    }

    /// Sums without connections, with the light vertices of each cell where a light begins `gain` times as many
    /// subpaths as here.
    fn pair_sums(&self, cells: &Cells, gain: impl Fn(u32) -> f64) -> PairSums {
        let mut light_vertices = vec![0.0; Cells::COUNT];
        for &(place, light) in &self.found.light {
            let cell = self.found.cell(cells, place);
            light_vertices[cell.index()] += gain(light) / self.samples();
        }
        PairSums::uniform(light_vertices)
    }
}

/// The knowledge of connections that a survey has.
pub(super) struct Lessons {
    pub(super) cells: Cells,
    pub(super) sums: PairSums,
    power: LightChoice,
    light_start: Option<LightChoice>,
    /// By the cell of camera vertices Σ_c √(κ_c Σ X²).
    roots: Vec<f64>,
    /// κ.
    light_vertices: f64,
}

impl Lessons {
    /// Learns for the estimator of `settings`, where that learns and `survey` has enough samples.
    pub(super) fn of(
        task: Task<'_>,
        settings: &Settings,
        survey: &Survey,
        cells: &Cells,
    ) -> Option<Self> {
        let is_enough = survey.stats.samples >= LEARNING_SAMPLES && survey.light_vertices() > 0.0;
        if !settings.learns() || !is_enough {
            return None;
        }
        let (power, cells) = (task.scene.light_choice(), cells.clone());
        let film = task.view.film();
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
                    // Of a light that begins g times as many subpaths each contributes 1/g.
                    Evidence::Square(square) => {
                        sums.add(pair, square / connection.light.map_or(1.0, gain));
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

    /// Returns κ where light subpaths begin as is learned.
    pub(super) fn light_vertices(&self) -> f64 {
        self.light_vertices
    }

    /// Returns how many times as many light subpaths begin on a light.
    pub(super) fn gain(&self, light: u32) -> f64 {
        emission::gain(&self.power, self.light_start.as_ref(), light)
    }

    /// Returns n κ / M of a connection of these cells.
    pub(super) fn factor(&self, cells: [Cell; 2]) -> f64 {
        self.factor_with(cells, [0.0; 2])
    }

    /// The same without what a connection taught, if `more` light vertices of each light subpath were in its cell.
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

    /// Returns √V̂ of its cells without what a connection taught.
    pub(super) fn root_visibility_without(&self, connection: &Connection) -> f32 {
        let Evidence::Traced(has_arrived) = connection.evidence else {
            return 1.0;
        };
        let pair = Cells::pair(connection.cells[0], connection.cells[1]);
        self.sums.root_visibility_without(pair, has_arrived)
    }
}

impl Training {
    /// Learns for the estimator of `settings`, where that learns and `survey` has enough samples.
    pub(super) fn learn(
        &mut self,
        task: Task<'_>,
        settings: &Settings,
        survey: &Survey,
        cells: &Cells,
    ) {
        let Some(lessons) = Lessons::of(task, settings, survey, cells) else {
            return;
        };
        self.light_vertices = lessons.light_vertices();
        if settings.lvc.proposal == ProposalKind::Learned {
            self.proposals = Some(LightProposals::new(lessons.cells, &lessons.sums));
        }
        self.light_start = lessons.light_start;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::{
        Effort, Task,
        tests::{WHOLE, room, survey_of, view},
    };
    use crate::integrator::IntegratorKind;

    /// Whichever round and group a sample was in, its connections lead to its own vertices and terms.
    #[test]
    fn connections_know_their_vertices() {
        let (scene, view) = (room(), view(WHOLE));
        let task = Task {
            scene: &scene,
            view: &view,
            settings: &Settings::new(IntegratorKind::Lvc),
        };
        let survey = survey_of(task, Effort::at_most(1024));
        let Found {
            places,
            light,
            camera,
            traced,
            possible,
            ..
        } = &survey.found;
        // The walls and the balls, by the distance from their centres.
        let is_on_surface = |place: u32| {
            let point = places[place as usize][0];
            let distance = |z: f32| point.distance(Vec3::new(0.0, 0.0, z));
            let surfaces = [(0.0, 6.0), (3.5, 1.0), (-3.0, 1.0)];
            surfaces
                .iter()
                .any(|&(z, radius)| (distance(z) - radius).abs() < 1e-3)
        };
        assert!(camera.iter().all(|&place| is_on_surface(place)));
        assert!(light.iter().all(|&(place, _)| is_on_surface(place)));
        let is_walked = |z: u32| light.binary_search_by_key(&z, |&(place, _)| place).is_ok();
        let mut arrived = [0; 2];
        for &(ends, has_arrived) in traced {
            let [z, y] = ends.places;
            assert!(camera.binary_search(&y).is_ok() && is_on_surface(z));
            assert_eq!(is_walked(z), ends.light.is_some());
            arrived[usize::from(is_walked(z))] += usize::from(has_arrived);
        }
        assert!(arrived.iter().all(|&count| count > 1000), "{arrived:?}");
        for possible in possible {
            let [z, y] = possible.ends.places;
            assert!(is_on_surface(z) && is_on_surface(y));
            // Strategies that could have made the path have a share of it.
            assert!(survey.terms[possible.term as usize].has_share_of_connections());
        }
    }

    /// Vertices of a path lie in the light walk before the camera walk, backwards.
    #[test]
    fn edges_of_a_path_have_the_places_of_its_vertices() {
        let sample = Places {
            light: 100,
            camera: 200,
        };
        for (s, t, end, j, expected) in [
            // The connection itself, and its neighbours on both sides.
            (3, 3, 3, 3, [102, 202]),
            (3, 3, 3, 2, [101, 102]),
            (3, 3, 3, 4, [202, 201]),
            // A hit, a light image, and a light point behind a walk of four vertices.
            (0, 5, 0, 2, [203, 202]),
            (5, 1, 5, 3, [102, 103]),
            (1, 4, 5, 1, [104, 203]),
            (1, 4, 5, 2, [203, 202]),
        ] {
            let strategy = Strategy::new(s, t);
            assert_eq!(sample.of_edge(strategy, end, j), expected, "{strategy} {j}");
        }
    }

    /// Two estimates of the second moment of connections: by the paths that they made, and by their parts of all
    /// paths.
    #[test]
    fn all_strategies_tell_the_second_moment_of_connections() {
        let (scene, view) = (room(), view(WHOLE));
        let settings = Settings::new(IntegratorKind::Lvc);
        let task = Task {
            scene: &scene,
            view: &view,
            settings: &settings,
        };
        let survey = survey_of(task, Effort::WHOLE);
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
        let all = survey.connections(view.film(), &survey.found.cells(), &counts);
        let square = |connection: &Connection| match connection.evidence {
            Evidence::Square(square) => square,
            Evidence::Traced(_) => 0.0,
        };
        let all: f64 = all.iter().map(square).sum();
        assert!((all / own - 1.0).abs() < 0.02, "{all} for {own}");
    }
}
