//! Edges of the surfaces that a view sees, found by a grid of rays.
//!
//! In each cell of the grid, a line joins the points between neighbouring rays that hit different surfaces
//! (marching squares). The near plane cuts away nearer surfaces, so that the inside of rooms is visible.

use super::shapes::px;
use super::view::View;
use bidir::math::{Vec2, Vec3};
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::RayDraws;

/// The distance between rays. Unit: pixels of the page.
const CELL: f32 = 3.0;
/// The number of halvings of the distance between two rays.
const HALVINGS: usize = 5;
/// The least cosine between the normals of one surface.
const LEAST_COSINE: f32 = 0.8;

/// A ray: its position on the page, with point and normal of the first surface behind the near plane.
#[derive(Clone, Copy)]
struct Sight {
    at: Vec2,
    hit: Option<[Vec3; 2]>,
}

impl View<'_> {
    /// Returns all edges in the panel.
    pub(super) fn outline(&self) -> String {
        let [columns, rows] = (self.size() / CELL).to_array().map(|count| count as usize);
        let at = |x, y| self.corner + Vec2::new(x as f32, y as f32) * CELL;
        let row = |y: usize| (0..=columns).map(|x| self.look(at(x, y))).collect();
        let sights: Vec<Vec<_>> = (0..=rows).map(row).collect();
        let mut edges = String::new();
        for rows in sights.windows(2) {
            for (above, below) in rows[0].windows(2).zip(rows[1].windows(2)) {
                edges += &self.edges([above[0], above[1], below[1], below[0]]);
            }
        }
        format!("<path class=\"outline\" d=\"{edges}\"/>\n")
    }

    fn look(&self, at: Vec2) -> Sight {
        // The chances of surfaces that are there only in part are the same for all rays.
        let stream = Sampler::new(SamplerKind::Independent, 0).stream(Domain::Camera, 0, 0);
        let (origin, chances) = (self.near_point(at), RayDraws::new(&stream, 1));
        let found = self.scene.intersect(origin, self.away(), chances);
        let hit = found.map(|hit| [hit.surface.point, hit.surface.n_g]);
        Sight { at, hit }
    }

    /// Returns the edges in the cell between four rays, as steps of a path.
    fn edges(&self, cell: [Sight; 4]) -> String {
        let points = (0..4).filter_map(|i| self.parting(cell[i], cell[(i + 1) % 4]));
        let places: Vec<_> = points.collect();
        let middle = places.iter().sum::<Vec2>() / places.len() as f32;
        match places[..] {
            [a, b] => step(a, b),
            _ => places.iter().map(|place| step(*place, middle)).collect(),
        }
    }

    /// Returns the point between two rays where the surface of the first ends. None: both hit one surface.
    fn parting(&self, a: Sight, b: Sight) -> Option<Vec2> {
        if self.is_one_surface(a, b) {
            return None;
        }
        let (mut at, mut along) = (a.at, b.at - a.at);
        for _ in 0..HALVINGS {
            along *= 0.5;
            if self.is_one_surface(a, self.look(at + along)) {
                at += along;
            }
        }
        Some(at + 0.5 * along)
    }

    fn is_one_surface(&self, a: Sight, b: Sight) -> bool {
        let (Some([p, n]), Some([q, m])) = (a.hit, b.hit) else {
            return a.hit.is_none() && b.hit.is_none();
        };
        let off = (q - p).dot(n).abs().max((q - p).dot(m).abs());
        n.dot(m).abs() >= LEAST_COSINE && off * self.scale <= 0.5 * CELL
    }
}

fn step(from: Vec2, to: Vec2) -> String {
    let along = to - from;
    let [x, y, dx, dy] = [from.x, from.y, along.x, along.y].map(px);
    format!("M{x} {y}l{dx} {dy}")
}
