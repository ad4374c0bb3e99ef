//! P(z | y) = ε / K + (1 - ε) Γ(c_z | c_y) / K_c: which of K cached light vertices z is a candidate for
//! the camera vertex y, by their cells c; K_c of the K are in the cell of z. Γ is learned before the
//! first pass, and frozen: in the spirit of the subspaces of \[Su22\].
//!
//! With X the contribution of a connection, weighted and behind what is in its way, the variance of
//! one candidate is least where Γ(c | r) ∝ κ_c √E[X² | r, c], κ_c the mean of K_c for a light subpath.
//! In a training render whose candidates are uniform, pairs of cells come up in proportion to κ_c, so
//! that this is √(κ_c Σ X²), the sum over the candidates of the pair. A path that any strategy finds adds to
//! the sums of all connections that could have made it (docs/derivations/mis-weights.md): the same sum on
//! average, with less noise.
//!
//! **Weights** need the number of samples that a strategy takes of a path, as a function of the path
//! alone: K and K_c are of the group at hand, and κ and κ_c stand in for them,
//!
//! n = (M / κ) (ε + (1 - ε) Γ(c | r) κ / κ_c),
//!
//! with M candidates for the camera vertex.
//!
//! **Visibility.** Of candidates with contributions C of which parts V arrive, the sum over chosen ones
//! varies least where the probability to be chosen is ∝ √E[C² V] = C √V̂ for binary V: that is what
//! they are compared by, V̂ being the part of the connections of two cells that arrived in training.

use super::cells::{Cell, Cells};

/// ε: the fraction of uniform proposals. Connections that training did not see cost at most 1/ε times as much as
/// without it.
const UNIFORM_PART: f32 = 0.2;

/// The least V̂: where all connections of training were blocked, others are chosen a quarter as often
/// as if all had arrived.
const LEAST_VISIBILITY: f64 = 1.0 / 16.0;

/// Into how many parts the numbers of a draw are divided, each of which knows the first cell that it
/// may lead to: a guide table \[Chen74\].
const PARTS: usize = 64;
const _: () = assert!(Cells::COUNT <= 256, "the number of a cell takes a byte");

/// The proposals of light vertices of a cache to camera vertices.
#[derive(Clone, Debug)]
pub struct LightProposals {
    cells: Cells,
    /// For each cell of camera vertices Σ_{c' < c} Γ(c' | r), and 1 at the end.
    cumulative: Vec<f32>,
    /// For each cell of camera vertices the first cell c that numbers of each part lead to: draws begin
    /// there instead of at the first cell of all.
    first: Vec<u8>,
    /// For each pair of cells, by that of camera vertices first, n κ / M.
    count_factors: Vec<f32>,
    /// For each pair √V̂.
    root_visibility: Vec<f32>,
}

/// The results of training for pairs of cells.
#[derive(Clone, Debug)]
pub struct PairSums {
    /// κ_c.
    pub light_vertices: Vec<f64>,
    /// Σ X², by the cell of camera vertices first. Unit: squared luminance, of any scale.
    pub squares: Vec<f64>,
    /// Of how many connections it is known whether they arrived, and how many did.
    pub arrived: Vec<[u32; 2]>,
}

impl PairSums {
    /// Of cells with so many light vertices for each light subpath; nothing is known of pairs.
    pub fn uniform(light_vertices: Vec<f64>) -> Self {
        Self {
            light_vertices,
            squares: vec![0.0; Cells::COUNT * Cells::COUNT],
            arrived: vec![[0; 2]; Cells::COUNT * Cells::COUNT],
        }
    }

    /// Adds to Σ X² of pair number `pair`.
    pub(crate) fn add(&mut self, pair: usize, square: f64) {
        self.squares[pair] += square;
    }

    /// Adds a connection of pair number `pair` that was traced.
    pub(crate) fn see(&mut self, pair: usize, has_arrived: bool) {
        let [traced, arrived] = &mut self.arrived[pair];
        *traced += 1;
        *arrived += u32::from(has_arrived);
    }
}

/// A draw of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CellDraw {
    /// None: all light vertices, at this part of them.
    All(f64),
    /// One, at this part of its light vertices.
    One(Cell, f64),
}

impl LightProposals {
    /// The proposals that suit `sums`.
    pub fn new(cells: Cells, sums: &PairSums) -> Self {
        let mut cumulative = Vec::with_capacity(Cells::COUNT * (Cells::COUNT + 1));
        let mut first = Vec::with_capacity(Cells::COUNT * PARTS);
        let mut count_factors = Vec::with_capacity(Cells::COUNT * Cells::COUNT);
        let kappa = &sums.light_vertices;
        let all: f64 = kappa.iter().sum();
        for squares in sums.squares.chunks_exact(Cells::COUNT) {
            let begin = cumulative.len();
            accumulate(kappa, squares, &mut cumulative);
            let ends = &cumulative[begin..];
            first.extend((0..PARTS).map(|part| first_end_beyond(ends, part)));
            let of_cell = |(&kappa, ends): (&f64, &[f32])| match kappa {
                0.0 => UNIFORM_PART,
                kappa => {
                    let prob = f64::from(ends[1] - ends[0]);
                    UNIFORM_PART + (1.0 - UNIFORM_PART) * (prob * all / kappa) as f32
                }
            };
            count_factors.extend(kappa.iter().zip(ends.windows(2)).map(of_cell));
        }
        Self {
            cells,
            cumulative,
            first,
            count_factors,
            root_visibility: sums.arrived.iter().copied().map(root_visibility).collect(),
        }
    }

    /// The cells of vertices.
    #[inline]
    pub(super) fn cells(&self) -> &Cells {
        &self.cells
    }

    /// n κ / M of a light vertex in the cell `light` for a camera vertex in the cell `camera`.
    #[inline]
    pub(super) fn count_factor(&self, light: Cell, camera: Cell) -> f64 {
        f64::from(self.count_factors[Cells::pair(light, camera)])
    }

    /// √V̂ of a light vertex in the cell `light` and a camera vertex in the cell `camera`.
    #[inline]
    pub(super) fn root_visibility(&self, light: Cell, camera: Cell) -> f32 {
        self.root_visibility[Cells::pair(light, camera)]
    }

    /// Draws a cell of light vertices for a camera vertex in the cell `camera`.
    #[inline]
    pub(crate) fn draw(&self, camera: Cell, u: f64) -> CellDraw {
        let part = f64::from(UNIFORM_PART);
        if u < part {
            return CellDraw::All(u / part);
        }
        let u = (u - part) / (1.0 - part);
        let row = self.row(camera);
        let part = camera.index() * PARTS + ((u * PARTS as f64) as usize).min(PARTS - 1);
        let mut cell = usize::from(self.first[part]);
        while cell + 1 < Cells::COUNT && f64::from(row[cell + 1]) <= u {
            cell += 1;
        }
        let [from, to] = [row[cell], row[cell + 1]].map(f64::from);
        CellDraw::One(Cells::cell(cell), (u - from) / (to - from))
    }

    /// P(z | y) for a light vertex in the cell `light`, where `[K, K_c]` = `counts`.
    #[inline]
    pub(crate) fn prob(&self, light: Cell, camera: Cell, [all, of_cell]: [usize; 2]) -> f64 {
        let (row, cell) = (self.row(camera), light.index());
        let gamma = f64::from(row[cell + 1] - row[cell]);
        let part = f64::from(UNIFORM_PART);
        part / all as f64 + (1.0 - part) * gamma / of_cell as f64
    }

    #[inline]
    fn row(&self, camera: Cell) -> &[f32] {
        let begin = camera.index() * (Cells::COUNT + 1);
        &self.cumulative[begin..=begin + Cells::COUNT]
    }
}

/// The first of the cells that end at `ends[1..]` that holds a number of this part or ends behind it.
fn first_end_beyond(ends: &[f32], part: usize) -> u8 {
    let begin = part as f64 / PARTS as f64;
    let cell = ends[1..Cells::COUNT].partition_point(|&end| f64::from(end) <= begin);
    cell as u8
}

/// √V̂ if so many connections were traced and arrived. Pairs of cells that training did not see count as
/// visible, and none counts as hidden for sure.
fn root_visibility([traced, arrived]: [u32; 2]) -> f32 {
    let visible = f64::from(arrived + 1) / f64::from(traced + 1);
    visible.max(LEAST_VISIBILITY).sqrt() as f32
}

/// Appends the sums of Γ(c | r) ∝ √(κ_c Σ X²), or of κ_c where nothing was found.
fn accumulate(kappa: &[f64], squares: &[f64], sums: &mut Vec<f32>) {
    let learned = || kappa.iter().zip(squares).map(|(k, q)| (k * q).sqrt());
    let total: f64 = learned().sum();
    let all: f64 = kappa.iter().sum();
    let mut sum = 0.0;
    sums.push(0.0);
    for (kappa, learned) in kappa.iter().zip(learned()) {
        sum += if total > 0.0 {
            learned / total
        } else {
            kappa / all
        };
        sums.push(sum.min(1.0) as f32);
    }
    if let Some(last) = sums.last_mut() {
        *last = 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn visibility_is_what_arrives() {
        let cells = Cells::new(&mut []);
        let [y, seen, hidden, unknown] =
            [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Z].map(|n| cells.of(Vec3::ZERO, n));
        let mut sums = PairSums::uniform(vec![1.0; Cells::COUNT]);
        for i in 0..99 {
            sums.see(Cells::pair(seen, y), i % 4 == 0);
            sums.see(Cells::pair(hidden, y), false);
        }
        let proposals = LightProposals::new(cells, &sums);
        let root = |light| f64::from(proposals.root_visibility(light, y));
        assert!((root(seen) - libm::sqrt(0.26)).abs() < 1e-6);
        assert!((root(hidden) - 0.25).abs() < 1e-6, "not hidden for sure");
        assert!((root(unknown) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn traced_connections_change_visibility_alone() {
        let cells = Cells::new(&mut []);
        let mut sums = PairSums::uniform(vec![1.0; Cells::COUNT]);
        let [z, y] = [3, 5].map(Cells::cell);
        sums.add(Cells::pair(y, y), 1.0);
        let before = LightProposals::new(cells.clone(), &sums);
        for i in 0..99 {
            sums.see(Cells::pair(z, y), i % 4 == 0);
        }
        let after = LightProposals::new(cells, &sums);
        assert!((f64::from(after.root_visibility(z, y)) - libm::sqrt(0.26)).abs() < 1e-6);
        assert_eq!(after.cumulative, before.cumulative);
        assert_eq!(after.count_factors, before.count_factors);
    }

    #[test]
    fn every_number_leads_to_the_cell_that_holds_it() {
        let cells = Cells::new(&mut []);
        let mut sums = PairSums::uniform(vec![1.0; Cells::COUNT]);
        let y = Cells::cell(5);
        // Some cells take most of the numbers, others none.
        for light in (0..Cells::COUNT).filter(|light| light % 7 > 2) {
            let square = (light % 7 * light % 11) as f64;
            sums.add(Cells::pair(Cells::cell(light), y), square);
        }
        let proposals = LightProposals::new(cells, &sums);
        let row = proposals.row(y);
        let uniform = f64::from(UNIFORM_PART);
        for i in 0..4096 {
            let u = (f64::from(i) + 0.5) / 4096.0;
            let CellDraw::One(cell, _) = proposals.draw(y, uniform + (1.0 - uniform) * u) else {
                panic!("the part of all vertices ends at {uniform}");
            };
            let [from, to] = [row[cell.index()], row[cell.index() + 1]].map(f64::from);
            assert!(from <= u && u < to, "{u} leads to {from} .. {to}");
        }
    }
}
