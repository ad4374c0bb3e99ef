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
use std::array::from_fn;

/// ε: the fraction of uniform proposals. Connections that training did not see cost at most 1/ε times as much as
/// without it.
const UNIFORM_PART: f32 = 0.2;

/// The least V̂: where all connections of training were blocked, others are chosen a quarter as often
/// as if all had arrived.
const LEAST_VISIBILITY: f64 = 1.0 / 16.0;

/// Γ and √V̂ come in whole numbers of units, so that all pairs of cells stay in the cache beside the vertices.
const UNITS: u16 = u16::MAX;
const VISIBILITY_UNITS: u8 = u8::MAX;

/// Into how many parts the numbers of a draw are divided, each of which knows the first cell that it
/// may lead to: a guide table \[Chen74\].
const PARTS: usize = 128;
/// The units of a part.
const UNITS_OF_PART: u16 = UNITS / PARTS as u16 + 1;
const _: () = assert!(Cells::COUNT <= 256, "the number of a cell takes a byte");

/// The proposals of light vertices of a cache to camera vertices.
#[derive(Clone, Debug)]
pub struct LightProposals {
    cells: Cells,
    /// By the cell of camera vertices.
    rows: Vec<ProposalRow>,
    /// For each cell of light vertices (1 - ε) κ / κ_c for a unit of Γ; 0 where κ_c is 0.
    count_factors: Vec<f64>,
}

/// The proposals to camera vertices of one cell r.
#[derive(Clone, Debug)]
pub(crate) struct ProposalRow {
    /// Σ_{c' < c} Γ(c' | r), in units.
    cumulative: [u16; Cells::COUNT + 1],
    /// The first cell c that numbers of each part lead to: draws begin there instead of at the first cell of all.
    first: [u8; PARTS],
    /// √V̂, in units, by the cell of light vertices.
    root_visibility: [u8; Cells::COUNT],
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
        let kappa = &sums.light_vertices;
        let all: f64 = kappa.iter().sum();
        let learned = (1.0 - f64::from(UNIFORM_PART)) * all / f64::from(UNITS);
        let count_factor = |&kappa: &f64| if kappa > 0.0 { learned / kappa } else { 0.0 };
        let squares = sums.squares.chunks_exact(Cells::COUNT);
        let arrived = sums.arrived.chunks_exact(Cells::COUNT);
        let pairs = squares.zip(arrived);
        Self {
            cells,
            rows: pairs
                .map(|(squares, arrived)| ProposalRow::new(kappa, squares, arrived))
                .collect(),
            count_factors: kappa.iter().map(count_factor).collect(),
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
        let learned = self.count_factors[light.index()] * self.row(camera).units(light);
        f64::from(UNIFORM_PART) + learned
    }

    /// √V̂ of a light vertex in the cell `light` and a camera vertex in the cell `camera`.
    #[inline]
    pub(super) fn root_visibility(&self, light: Cell, camera: Cell) -> f32 {
        let units = self.row(camera).root_visibility[light.index()];
        f32::from(units) * (1.0 / f32::from(VISIBILITY_UNITS))
    }

    /// The proposals to camera vertices in the cell `camera`.
    #[inline]
    pub(crate) fn row(&self, camera: Cell) -> &ProposalRow {
        &self.rows[camera.index()]
    }
}

impl ProposalRow {
    fn new(kappa: &[f64], squares: &[f64], arrived: &[[u32; 2]]) -> Self {
        let cumulative = accumulated(kappa, squares);
        Self {
            cumulative,
            first: from_fn(|part| first_end_beyond(&cumulative, part)),
            root_visibility: from_fn(|light| root_visibility(arrived[light])),
        }
    }

    /// Draws a cell of light vertices.
    #[inline]
    pub(crate) fn draw(&self, u: f64) -> CellDraw {
        let part = f64::from(UNIFORM_PART);
        if u < part {
            return CellDraw::All(u * (1.0 / part));
        }
        let units = (u - part) * (f64::from(UNITS) / (1.0 - part));
        let unit = (units as u16).min(UNITS - 1);
        let mut cell = usize::from(self.first[usize::from(unit / UNITS_OF_PART)]);
        while self.cumulative[cell + 1] <= unit {
            cell += 1;
        }
        let [from, to] = [self.cumulative[cell], self.cumulative[cell + 1]].map(f64::from);
        CellDraw::One(Cells::cell(cell), (units - from) / (to - from))
    }

    /// 1 / P(z | y) for a light vertex in the cell `light`, where `[K, K_c]` = `counts`.
    #[inline]
    pub(crate) fn inverse_prob(&self, light: Cell, counts: [usize; 2]) -> f64 {
        let [all, of_cell] = counts.map(|count| count as f64);
        let part = f64::from(UNIFORM_PART);
        let learned = (1.0 - part) / f64::from(UNITS) * self.units(light);
        all * of_cell / (part * of_cell + learned * all)
    }

    /// Γ(c | r) of the cell c = `light`, in units.
    #[inline]
    fn units(&self, light: Cell) -> f64 {
        let cell = light.index();
        f64::from(self.cumulative[cell + 1] - self.cumulative[cell])
    }
}

/// The first cell that ends behind the begin of this part.
fn first_end_beyond(cumulative: &[u16; Cells::COUNT + 1], part: usize) -> u8 {
    let begin = part as u16 * UNITS_OF_PART;
    let ends = &cumulative[1..Cells::COUNT];
    ends.partition_point(|&end| end <= begin) as u8
}

/// √V̂ in units if so many connections were traced and arrived. Pairs of cells that training did not see count as
/// visible, and none counts as hidden for sure.
fn root_visibility([traced, arrived]: [u32; 2]) -> u8 {
    let visible = f64::from(arrived + 1) / f64::from(traced + 1);
    let root = visible.max(LEAST_VISIBILITY).sqrt();
    (root * f64::from(VISIBILITY_UNITS)).round() as u8
}

/// The sums of Γ(c | r) ∝ √(κ_c Σ X²), or of κ_c where nothing was found, in units.
fn accumulated(kappa: &[f64], squares: &[f64]) -> [u16; Cells::COUNT + 1] {
    let learned = || kappa.iter().zip(squares).map(|(k, q)| (k * q).sqrt());
    let total: f64 = learned().sum();
    let all: f64 = kappa.iter().sum();
    let mut sums = [0; Cells::COUNT + 1];
    let mut sum = 0.0;
    for ((end, kappa), learned) in sums[1..].iter_mut().zip(kappa).zip(learned()) {
        sum += if total > 0.0 {
            learned / total
        } else {
            kappa / all
        };
        *end = (sum * f64::from(UNITS)).round() as u16;
    }
    sums[Cells::COUNT] = UNITS;
    sums
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
        let half_a_unit = 0.5 / f64::from(VISIBILITY_UNITS);
        let check = |light, expected: f64| {
            let error = (root(light) - expected).abs();
            assert!(error < 1.01 * half_a_unit, "{} for {expected}", root(light));
        };
        check(seen, libm::sqrt(0.26));
        // Not hidden for sure.
        check(hidden, 0.25);
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
        let root = f64::from(after.root_visibility(z, y));
        assert!((root - libm::sqrt(0.26)).abs() < 1.0 / f64::from(VISIBILITY_UNITS));
        for (after, before) in after.rows.iter().zip(&before.rows) {
            assert_eq!(after.cumulative, before.cumulative);
        }
        assert_eq!(after.count_factors, before.count_factors);
    }

    /// Where each cell has its usual part K_c / K = κ_c / κ of the vertices, n κ / M is K P.
    #[test]
    fn counts_of_weights_are_those_of_draws() {
        let kappa = |cell: usize| (1 + cell % 5) as f64;
        let mut sums = PairSums::uniform((0..Cells::COUNT).map(kappa).collect());
        let y = Cells::cell(5);
        (0..Cells::COUNT)
            .step_by(3)
            .for_each(|z| sums.add(Cells::pair(Cells::cell(z), y), (z % 11) as f64));
        let all: f64 = sums.light_vertices.iter().sum();
        let proposals = LightProposals::new(Cells::new(&mut []), &sums);
        for cell in 0..Cells::COUNT {
            let (z, counts) = (
                Cells::cell(cell),
                [all, kappa(cell)].map(|k| 2 * k as usize),
            );
            let drawn = 2.0 * all / proposals.row(y).inverse_prob(z, counts);
            let counted = proposals.count_factor(z, y);
            assert!(
                (drawn - counted).abs() < 1e-12 * counted,
                "{drawn}, {counted}"
            );
        }
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
        let proposals = LightProposals::new(cells.clone(), &sums);
        let row = proposals.row(y);
        let ends = &row.cumulative;
        let uniform = f64::from(UNIFORM_PART);
        let last = 1.0 - f64::EPSILON / 2.0;
        let within = (0..4096).map(|i| (f64::from(i) + 0.5) / 4096.0);
        for u in within.chain([0.0, last]) {
            let units = u * f64::from(UNITS);
            let CellDraw::One(cell, _) = row.draw((uniform + (1.0 - uniform) * u).min(last)) else {
                panic!("the part of all vertices ends at {uniform}");
            };
            let [from, to] = [ends[cell.index()], ends[cell.index() + 1]].map(f64::from);
            assert!(
                from <= units && units < to,
                "{units} leads to {from} .. {to}"
            );
        }
    }
}
