//! The log of the survey's vertices and connections, from which estimators learn.

use super::constants::MOST_PARTS;
use crate::contribution::Term;
use crate::guide::{Cell, Cells};
use crate::integrator::{Batch, connectable};
use crate::math::Vec3;
use crate::path::{ConnectionPart, Job, Vertex};
use crate::select::Candidate;
use crate::strategy::Strategy;

/// The ends of a connection.
#[derive(Clone, Copy)]
pub(super) struct Ends {
    /// The numbers of its light vertex and of its camera vertex.
    vertices: [u32; 2],
    /// The light that its light subpath begins on. None: its light vertex is a light point of next-event estimation.
    pub(super) light: Option<u32>,
}

/// A connection that could have made a path.
#[derive(Clone, Copy)]
pub(super) struct Possible {
    pub(super) ends: Ends,
    /// The strategy that has this connection.
    pub(super) strategy: Strategy,
    /// The number of the path's term.
    pub(super) term: u32,
    /// n_j p_j / D in the survey.
    pub(super) part: f32,
}

/// Vertices and connections of samples.
#[derive(Default)]
pub(super) struct ConnectionLog {
    /// The point and the normal of each vertex.
    vertices: Vec<[Vec3; 2]>,
    /// The numbers of the light vertices that can be connected, each with the light that its subpath begins on.
    pub(super) light: Vec<(u32, u32)>,
    /// The numbers of the camera vertices that can be connected.
    camera: Vec<u32>,
    /// The connections that were traced, each with true if it is visible.
    pub(super) traced: Vec<(Ends, bool)>,
    /// The connections that could have made paths.
    pub(super) possible: Vec<Possible>,
    /// The first vertices of the sample that was begun last.
    sample: FirstVertices,
}

/// The numbers of a sample's first light vertex and first camera vertex.
#[derive(Clone, Copy, Default)]
struct FirstVertices {
    light: u32,
    camera: u32,
}

impl FirstVertices {
    /// Returns the numbers in the log of the sample's light vertex `z` and camera vertex `y`.
    fn of(self, [z, y]: [u32; 2]) -> [u32; 2] {
        [self.light + z, self.camera + y]
    }

    /// Returns the numbers in the log of the vertices x_{j-1} and x_j of a path of `strategy`, whose last light
    /// vertex is number `end - 1` of the sample.
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

impl ConnectionLog {
    /// Adds the log of other samples, whose term number 0 becomes number `terms`.
    pub(super) fn add(&mut self, more: Self, terms: u32) {
        let known = self.vertices.len() as u32;
        let moved = |ends: Ends| Ends {
            vertices: ends.vertices.map(|vertex| vertex + known),
            ..ends
        };
        self.vertices.extend(more.vertices);
        let light = more.light.into_iter();
        self.light
            .extend(light.map(|(vertex, light)| (vertex + known, light)));
        let camera = more.camera.into_iter();
        self.camera.extend(camera.map(|vertex| vertex + known));
        let traced = more.traced.into_iter();
        self.traced
            .extend(traced.map(|(ends, has_arrived)| (moved(ends), has_arrived)));
        let possible = more.possible.into_iter();
        self.possible.extend(possible.map(|possible| Possible {
            ends: moved(possible.ends),
            term: possible.term + terms,
            ..possible
        }));
    }

    /// Adds the vertices of the one sample of `batch`. The connections that are added next belong to this sample.
    pub(super) fn begin(&mut self, job: &Job<'_>, batch: &Batch) {
        let [walk, camera] =
            [&batch.walks.light, &batch.walks.camera].map(|walks| walks.get(0).vertices);
        let light = batch.walks.light.vertices();
        let first = self.vertices.len() as u32;
        self.sample = FirstVertices {
            light: first,
            camera: first + light.len() as u32,
        };
        let all = light.iter().chain(camera);
        self.vertices.extend(all.map(Vertex::point_and_normal));
        let [z, y] = self.sample.of([0; 2]);
        let light_vertex = |i: usize| Some((z + i as u32, walk[0].light?));
        let connectable = connectable(job.settings.light_point, walk);
        self.light.extend(connectable.filter_map(light_vertex));
        let ends = (1..camera.len()).filter(|&i| !camera[i].is_delta());
        self.camera.extend(ends.map(|i| y + i as u32));
    }

    /// Adds a traced connection, and returns its number. None: its light vertex is at infinity.
    pub(super) fn trace(
        &mut self,
        batch: &Batch,
        candidate: &Candidate,
        has_arrived: bool,
    ) -> Option<u32> {
        let z = candidate.vertices[0] as usize;
        if batch.walks.light.vertices()[z].locus.is_infinite() {
            return None;
        }
        let is_walked = z < batch.walks.light.get(0).vertices.len();
        let ends = Ends {
            vertices: self.sample.of(candidate.vertices),
            light: is_walked.then_some(candidate.term.light),
        };
        self.traced.push((ends, has_arrived));
        Some(self.traced.len() as u32 - 1)
    }

    /// Adds the connections that could have made the path of the term `made`, which has number `term`; `parts` are
    /// their parts of D. `candidate` is the connection that made the path, if one did.
    pub(super) fn path(
        &mut self,
        made: &Term,
        candidate: Option<&Candidate>,
        parts: &[ConnectionPart],
        term: u32,
    ) {
        let s = u32::from(made.strategy.s);
        let end = candidate.map_or(s, |candidate| candidate.vertices[0] + 1);
        let (sample, count) = (self.sample, self.vertices.len() as u32);
        let is_long = parts.len() > MOST_PARTS;
        let is_own = |j: u16| candidate.is_some() && u32::from(j) == s;
        let counted = parts.iter().filter(|&&(j, _)| !is_long || is_own(j));
        let possible = counted.map(|&(j, part)| Possible {
            ends: Ends {
                vertices: sample.of_edge(made.strategy, end, j),
                light: Some(made.light),
            },
            strategy: made.strategy.with_light_vertices(j),
            term,
            part: if is_long { 1.0 } else { part },
        });
        // If a walk escaped to the light, no vertex lies there; a light without power begins no subpath.
        let exists = |possible: &Possible| {
            possible.ends.vertices[0] < count && possible.part > 0.0 && possible.part.is_finite()
        };
        self.possible.extend(possible.filter(exists));
    }

    /// Returns the cell and the light of each light vertex that can be connected.
    pub(super) fn light_vertices<'a>(
        &'a self,
        cells: &'a Cells,
    ) -> impl Iterator<Item = (Cell, u32)> + 'a {
        let light = self.light.iter();
        light.map(|&(vertex, light)| (self.cell(cells, vertex), light))
    }

    /// Makes cells that divide the vertices evenly.
    pub(super) fn cells(&self) -> Cells {
        let light = self.light.iter().map(|&(vertex, _)| vertex);
        let all = light.chain(self.camera.iter().copied());
        let mut points: Vec<_> = all
            .map(|vertex| self.vertices[vertex as usize][0])
            .collect();
        Cells::new(&mut points)
    }

    /// Returns the cells of the ends of a connection.
    pub(super) fn cells_of(&self, cells: &Cells, ends: Ends) -> [Cell; 2] {
        ends.vertices.map(|vertex| self.cell(cells, vertex))
    }

    fn cell(&self, cells: &Cells, vertex: u32) -> Cell {
        let [point, n] = self.vertices[vertex as usize];
        cells.of(point, n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::Settings;
    use crate::driver::training::{
        Effort,
        tests::{WHOLE, input, room, survey_of, view},
    };
    use crate::integrator::IntegratorKind;

    /// Whichever round and group a sample was in, its connections lead to its own vertices and terms.
    #[test]
    fn connections_know_their_vertices() {
        let (scene, view) = (room(), view(WHOLE));
        let settings = Settings::new(IntegratorKind::Lvc);
        let survey = survey_of(input(&scene, &view, &settings), Effort::at_most(1024));
        let ConnectionLog {
            vertices,
            light,
            camera,
            traced,
            possible,
            ..
        } = &survey.log;
        // The walls and the balls, by the distance from their centres.
        let is_on_surface = |vertex: u32| {
            let point = vertices[vertex as usize][0];
            let distance = |z: f32| point.distance(Vec3::new(0.0, 0.0, z));
            let is_at = |(z, radius): (f32, f32)| (distance(z) - radius).abs() < 1e-3;
            [(0.0, 6.0), (3.5, 1.0), (-3.0, 1.0)].into_iter().any(is_at)
        };
        assert!(camera.iter().all(|&vertex| is_on_surface(vertex)));
        assert!(light.iter().all(|&(vertex, _)| is_on_surface(vertex)));
        let is_walked = |z: u32| {
            light
                .binary_search_by_key(&z, |&(vertex, _)| vertex)
                .is_ok()
        };
        let mut arrived = [0; 2];
        for &(ends, has_arrived) in traced {
            let [z, y] = ends.vertices;
            assert!(camera.binary_search(&y).is_ok() && is_on_surface(z));
            assert_eq!(is_walked(z), ends.light.is_some());
            arrived[usize::from(is_walked(z))] += usize::from(has_arrived);
        }
        assert!(arrived.iter().all(|&count| count > 1000), "{arrived:?}");
        for possible in possible {
            let [z, y] = possible.ends.vertices;
            assert!(is_on_surface(z) && is_on_surface(y));
            // Strategies that could have made the path have a share of it.
            assert!(survey.terms[possible.term as usize].has_share_of_connections());
        }
    }

    /// Vertices of a path lie in the light walk before the camera walk, backwards.
    #[test]
    fn edges_of_a_path_have_its_vertices() {
        let sample = FirstVertices {
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
}
