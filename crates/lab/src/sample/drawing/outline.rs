//! Where the surface that is seen ends, or bends: what rays of a parallel view find, as lines.
//!
//! A grid of rays looks at the scene; between two neighbours that see different surfaces more rays
//! find the place, and in each cell these places are joined (marching squares). What lies in front of
//! a plane is cut away, so that one looks into rooms.

use super::lines::{joined, simplified};
use super::view::View;
use bidir::math::{Vec2, Vec3};
use bidir::sampler::{Domain, SampleStream, Sampler, SamplerKind};
use bidir::scene::{Chances, Scene};

/// Rays of the grid from left to right.
const COLUMNS: usize = 240;
/// How often the distance between two rays is halved.
const HALVINGS: usize = 6;
/// The least cosine between the normals of one surface.
const LEAST_COSINE: f32 = 0.8;
/// How far a line may be from what was found. Unit: cells of the grid.
const TOLERANCE: f32 = 0.3;

/// What a ray found.
#[derive(Clone, Copy)]
struct Seen {
    point: Vec3,
    normal: Vec3,
}

/// A view into a scene, from a plane.
struct Grid<'a> {
    scene: &'a Scene,
    stream: SampleStream,
    view: &'a View,
    /// The depth of the plane from which rays start.
    near: f32,
    origin: Vec2,
    /// The distance between rays.
    cell: f32,
    columns: usize,
    rows: usize,
}

/// The outlines of what `view` sees of a scene behind the plane at depth `near`, within a window, as
/// lines in the units of the view.
pub(super) fn outlines(
    scene: &Scene,
    view: &View,
    [min, max]: [Vec2; 2],
    near: f32,
) -> Vec<Vec<Vec2>> {
    let cell = (max.x - min.x) / COLUMNS as f32;
    let rows = ((max.y - min.y) / cell).clamp(1.0, 4.0 * COLUMNS as f32) as usize;
    let sampler = Sampler::new(SamplerKind::Independent, 0);
    let grid = Grid {
        scene,
        stream: sampler.stream(Domain::Camera, 0, 0),
        view,
        near,
        origin: min,
        cell,
        columns: COLUMNS,
        rows,
    };
    let lines = joined(&grid.links());
    let simple = lines.iter().map(|line| simplified(line, TOLERANCE * cell));
    simple.collect()
}

impl Grid<'_> {
    fn at(&self, column: usize, row: usize) -> Vec2 {
        self.origin + Vec2::new(column as f32, row as f32) * self.cell
    }

    fn look(&self, at: Vec2) -> Option<Seen> {
        let origin = self.view.place(at, self.near);
        let chances = Chances::new(&self.stream, 1);
        let hit = self.scene.intersect(origin, self.view.away, chances)?;
        Some(Seen {
            point: hit.surface.point,
            normal: hit.surface.n_g,
        })
    }

    /// True where two rays may have found one surface.
    fn is_same(&self, a: Option<Seen>, b: Option<Seen>) -> bool {
        let (Some(a), Some(b)) = (a, b) else {
            return a.is_none() && b.is_none();
        };
        let across = b.point - a.point;
        let off = across.dot(a.normal).abs().max(across.dot(b.normal).abs());
        a.normal.dot(b.normal).abs() >= LEAST_COSINE && off <= 0.5 * self.cell
    }

    /// Where the surface ends between two rays. None: both found the same.
    fn crossing(&self, a: (Vec2, Option<Seen>), b: (Vec2, Option<Seen>)) -> Option<Vec2> {
        if self.is_same(a.1, b.1) {
            return None;
        }
        let [mut inside, mut outside] = [a.0, b.0];
        for _ in 0..HALVINGS {
            let middle = inside.midpoint(outside);
            if self.is_same(a.1, self.look(middle)) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        Some(inside.midpoint(outside))
    }

    /// What the rays of a row found.
    fn row(&self, row: usize) -> Vec<(Vec2, Option<Seen>)> {
        let at = (0..=self.columns).map(|column| self.at(column, row));
        at.map(|at| (at, self.look(at))).collect()
    }

    /// The pieces of lines in all cells.
    fn links(&self) -> Vec<[Vec2; 2]> {
        let mut links = Vec::new();
        let mut below = self.row(0);
        let mut below_crossings = self.crossings_along(&below);
        for row in 1..=self.rows {
            let above = self.row(row);
            let above_crossings = self.crossings_along(&above);
            let pairs = below.iter().zip(&above);
            let between: Vec<_> = pairs.map(|(a, b)| self.crossing(*a, *b)).collect();
            for i in 0..self.columns {
                let sides = [
                    below_crossings[i],
                    between[i + 1],
                    above_crossings[i],
                    between[i],
                ];
                link(sides, &mut links);
            }
            (below, below_crossings) = (above, above_crossings);
        }
        links
    }

    fn crossings_along(&self, row: &[(Vec2, Option<Seen>)]) -> Vec<Option<Vec2>> {
        let pairs = row.windows(2);
        pairs.map(|pair| self.crossing(pair[0], pair[1])).collect()
    }
}

/// Joins the places on the sides of a cell: two with each other, more in their middle.
fn link(sides: [Option<Vec2>; 4], links: &mut Vec<[Vec2; 2]>) {
    let places: Vec<_> = sides.into_iter().flatten().collect();
    if let [a, b] = places[..] {
        links.push([a, b]);
    } else if places.len() > 2 {
        let middle = places.iter().sum::<Vec2>() / places.len() as f32;
        links.extend(places.iter().map(|place| [*place, middle]));
    }
}
