//! Learns from the connections of the survey, before the first pass: which light vertices to propose to camera
//! vertices, which of them are visible, and where light subpaths begin.

use super::constants::LEAST_SAMPLES;
use super::emission::{self, Connection};
use super::moments::Counts;
use super::survey::Survey;
use super::{Settings, Training};
use crate::integrator::{Batch, Job, LightStart, ProposalKind, connectable};
use crate::math::Vec3;
use crate::path::{Cell, Cells, LightProposals, PairSums};
use crate::scene::Scene;

/// A connection that was traced.
#[derive(Clone, Copy)]
struct Traced {
    /// The places of its light vertex and of its camera vertex, by number.
    places: [u32; 2],
    /// The light that its light subpath begins on. None: it is with a light point of next-event estimation.
    light: Option<u32>,
    /// The number of its term. None: it was blocked.
    term: Option<u32>,
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
    traced: Vec<Traced>,
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
        self.traced.extend(more.traced.iter().map(|traced| Traced {
            places: traced.places.map(|place| place + places),
            term: traced.term.map(|term| term + terms),
            ..*traced
        }));
    }

    /// Adds the vertices and connections of the one sample of `batch`; `terms` has the numbers of the connections'
    /// terms.
    pub(super) fn keep(&mut self, job: &Job<'_>, batch: &Batch, terms: &[Option<u32>]) {
        let [walk, camera] = [&batch.light, &batch.camera].map(|walks| walks.get(0).vertices);
        let first = self.places.len();
        let place = |i: usize| (first + i) as u32;
        let light = batch.light.vertices();
        let camera_place = |i: usize| place(light.len() + i);
        let all = light.iter().chain(camera);
        self.places.extend(all.map(crate::path::Vertex::place));
        let light_vertex = |i: usize| Some((place(i), walk[0].light?));
        let connectable = connectable(job.settings.light_point, walk);
        self.light.extend(connectable.filter_map(light_vertex));
        let ends = (1..camera.len()).filter(|&i| !camera[i].is_delta());
        self.camera.extend(ends.map(camera_place));
        for (candidate, &term) in batch.candidates.iter().zip(terms) {
            let [z, y] = candidate.vertices.map(|vertex| vertex as usize);
            if !light[z].locus.is_infinite() {
                self.traced.push(Traced {
                    places: [place(z), camera_place(y)],
                    light: (z < walk.len()).then_some(candidate.term.light),
                    term,
                });
            }
        }
    }

    /// Cells that suit the vertices.
    fn cells(&self) -> Cells {
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
    /// κ: the mean number of vertices of a light subpath that can be connected.
    pub(super) fn light_vertices(&self) -> f64 {
        self.found.light.len() as f64 / self.samples()
    }

    /// The connections, by what they contribute where the numbers of samples are `counts`.
    fn connections(&self, cells: &Cells, counts: &Counts) -> Vec<Connection> {
        let square = |term: u32| {
            let value = self.terms[term as usize].value_by(counts);
            value * value
        };
        let connection = |traced: &Traced| Connection {
            light: traced.light,
            cells: traced.places.map(|place| self.found.cell(cells, place)),
            square: traced.term.map(square),
        };
        self.found.traced.iter().map(connection).collect()
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

impl Training {
    /// Learns for the estimator of `settings`, where that learns and `survey` has enough samples.
    pub(super) fn learn(&mut self, scene: &Scene, settings: &Settings, survey: &Survey) {
        let is_enough = survey.stats.samples >= LEAST_SAMPLES && self.light_vertices > 0.0;
        if !settings.learns() || !is_enough {
            return;
        }
        let (power, cells) = (scene.light_choice(), survey.found.cells());
        let counts = Counts::new(settings, settings.path.roulette, self.light_vertices);
        let connections = survey.connections(&cells, &counts);
        if settings.lvc.light_start == LightStart::Learned {
            self.emission = emission::learned(power, &connections, survey.samples());
        }
        let gain = |light| emission::gain(power, self.emission.as_ref(), light);
        let mut sums = survey.pair_sums(&cells, gain);
        self.light_vertices = sums.light_vertices.iter().sum();
        if settings.lvc.proposal == ProposalKind::Learned {
            for connection in &connections {
                let pair = Cells::pair(connection.cells[0], connection.cells[1]);
                match connection.light {
                    // Of a light that begins g times as many subpaths each contributes 1/g.
                    Some(light) => sums.add(pair, connection.square.map(|x| x / gain(light))),
                    None => sums.see(pair, connection.square.is_some()),
                }
            }
            self.proposals = Some(LightProposals::new(cells, &sums));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::{
        Effort, Task,
        tests::{WHOLE, room, view},
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
        let survey = Survey::run(task, Effort::at_most(1024));
        let Found {
            places,
            light,
            camera,
            traced,
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
        let mut arrived = [0; 2];
        for connection in traced {
            let [z, y] = connection.places;
            assert!(camera.binary_search(&y).is_ok() && is_on_surface(z));
            let is_walked = light.binary_search_by_key(&z, |&(place, _)| place).is_ok();
            assert_eq!(is_walked, connection.light.is_some());
            if let Some(term) = connection.term {
                arrived[usize::from(is_walked)] += 1;
                // The strategy that made the path has a share of it.
                assert!(survey.terms[term as usize].has_share_of(is_walked));
            }
        }
        assert!(arrived.iter().all(|&count| count > 1000), "{arrived:?}");
    }
}
