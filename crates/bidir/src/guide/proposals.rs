//! P(z | y) = ε / K + (1 - ε) Γ(c_z | c_y) / K_c is the probability that, of K cached light vertices, z is the
//! candidate for the camera vertex y. It depends on their cells c; K_c of the K vertices are in the cell of z. Γ is
//! learned before the first pass, and then fixed, in the spirit of the subspaces of \[Su22\].
//!
//! Let X be the weighted contribution of a connection, with its visibility, and κ_c the mean of K_c for a light
//! subpath. The variance of one candidate is least for Γ(c | r) ∝ κ_c √E[X² | r, c]. Training draws candidates
//! uniformly, so that pairs of cells occur in proportion to κ_c, and this is √(κ_c Σ X²), with the sum over the
//! candidates of the pair. A path that any strategy finds adds to the sums of all connections that could have made it
//! (docs/derivations/mis-weights.md): they have the same mean, with less noise.
//!
//! **Weights** need the number of samples that a strategy takes of a path, as a function only of the path. K and K_c
//! depend on the group, so κ and κ_c replace them:
//!
//! n = (M / κ) (ε + (1 - ε) Γ(c | r) κ / κ_c),
//!
//! with M candidates for the camera vertex.
//!
//! **Visibility.** Candidates have contributions C, of which fractions V arrive. The sum over the chosen ones varies
//! least if the probability of choosing is ∝ √E[C² V], which for binary V is C √V̂: this is the score of candidates.
//! V̂ is the fraction of the connections between two cells that were visible in training.

use super::cells::{Cell, Cells};
use std::array::from_fn;

/// The number of bits of a unit's number. Γ and ε are whole units, of which all proposals to a vertex have 2^16. So
/// draws lead to each cell with exactly the probability that weights and shares use, and the tables of all pairs of
/// cells stay in the cache beside the vertices.
const UNIT_BITS: u32 = 16;
const UNITS: u32 = 1 << UNIT_BITS;

/// ε in units, a fifth: the fraction of uniform proposals. It bounds the growth of variance by 1/ε, for connections
/// that training did not see.
const UNIFORM_UNITS: u16 = 13_107;
/// ε.
const UNIFORM_PART: f64 = UNIFORM_UNITS as f64 / UNITS as f64;

/// The least V̂: if all connections of a pair were blocked in training, its score is a quarter of what it is if all
/// arrived.
const LEAST_VISIBILITY: f64 = 1.0 / 16.0;

/// The number of units in √V̂ = 1.
const VISIBILITY_UNITS: u8 = u8::MAX;

/// The number of parts of the range of random numbers. Each part stores the first cell that its numbers may lead to:
/// a guide table \[Chen74\].
const PARTS: usize = 512;
/// The number of units of a part.
const UNITS_OF_PART: u16 = (UNITS / PARTS as u32) as u16;
const _: () = assert!(
    Cells::COUNT <= Cells::NAMES,
    "the number of a cell takes a byte"
);

/// The proposals of cached light vertices to camera vertices.
#[derive(Clone, Debug)]
pub struct LightProposals {
    pub(super) cells: Cells,
    /// One row for each cell of camera vertices.
    rows: Vec<ProposalRow>,
    /// For each cell of light vertices, κ / κ_c times a unit of (1 - ε) Γ; 0 if κ_c is 0.
    count_factors: [f64; Cells::NAMES],
}

/// The proposals to camera vertices of one cell r.
#[derive(Clone, Debug)]
pub(crate) struct ProposalRow {
    /// The last unit of the uniform proposals, which come first; then the last unit of (1 - ε) Γ(c | r) of each cell
    /// c, which equals the one before if Γ is 0; the rest is the last unit of all.
    last: LastUnits,
    /// The first cell c that the numbers of each part lead to: draws search from it.
    first: [u8; PARTS],
    /// √V̂ for each cell of light vertices. Unit: 1 / [`VISIBILITY_UNITS`].
    root_visibility: [u8; Cells::NAMES],
}

type LastUnits = [u16; 1 + Cells::NAMES];

/// The results of training for pairs of cells.
#[derive(Clone, Debug)]
pub struct PairSums {
    /// κ_c.
    pub light_vertices: Vec<f64>,
    /// Σ X² of each pair, in the order of `Cells::pair`. Unit: squared luminance, of any scale.
    pub squares: Vec<f64>,
    /// For each pair, the number of connections that were traced, and the number of those that were visible.
    pub arrived: Vec<[u32; 2]>,
}

impl PairSums {
    /// Makes sums without knowledge of pairs, for cells with these numbers of light vertices per light subpath.
    pub fn uniform(light_vertices: Vec<f64>) -> Self {
        Self {
            light_vertices,
            squares: vec![0.0; Cells::COUNT * Cells::COUNT],
            arrived: vec![[0; 2]; Cells::COUNT * Cells::COUNT],
        }
    }

    /// Counts a traced connection of pair number `pair`.
    pub(crate) fn see(&mut self, pair: usize, has_arrived: bool) {
        let [traced, arrived] = &mut self.arrived[pair];
        *traced += 1;
        *arrived += u32::from(has_arrived);
    }

    /// Returns Σ_c √(κ_c Σ X²) for each cell of camera vertices.
    pub(crate) fn roots(&self) -> Vec<f64> {
        let rows = self.squares.chunks_exact(Cells::COUNT);
        rows.map(|squares| {
            let pairs = self.light_vertices.iter().zip(squares);
            pairs.map(|(kappa, square)| (kappa * square).sqrt()).sum()
        })
        .collect()
    }

    /// Returns n κ / M of a connection between the cells `light` and `camera`, as if its own `square` were not in the
    /// sums, and as if each light subpath had `more` light vertices in its cell. `all` is κ, and `sum` the element of
    /// [`roots`](Self::roots) for `camera`.
    pub(crate) fn count_factor(
        &self,
        [all, sum]: [f64; 2],
        [light, camera]: [Cell; 2],
        [square, more]: [f64; 2],
    ) -> f64 {
        let kappa = self.light_vertices[light.index()];
        let squares = self.squares[Cells::pair(light, camera)];
        let root = |squares: f64| (kappa * squares.max(0.0)).sqrt();
        let own = root(squares - square);
        let others = sum - root(squares) + own;
        let learned = if others <= 1e-9 * sum {
            // Without knowledge all light vertices are equally likely.
            1.0
        } else if kappa > 0.0 {
            own / others * all / (kappa + more)
        } else {
            0.0
        };
        UNIFORM_PART + (1.0 - UNIFORM_PART) * learned
    }

    /// Returns √V̂ of pair number `pair`, as if one traced connection, visible if `has_arrived`, were not in the
    /// sums.
    pub(crate) fn root_visibility_without(&self, pair: usize, has_arrived: bool) -> f32 {
        let [traced, arrived] = self.arrived[pair];
        let others = [
            traced.saturating_sub(1),
            arrived.saturating_sub(u32::from(has_arrived)),
        ];
        f32::from(root_visibility(Some(&others))) / f32::from(VISIBILITY_UNITS)
    }
}

/// A drawn cell of light vertices, with the random number that is left.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CellDraw {
    /// No cell: the light vertex is at this fraction of all.
    All(Part),
    /// A cell, with its units: the light vertex is at this fraction of those in the cell.
    One(Cell, u16, Part),
}

/// A fraction of a range of numbers: the count of numbers before, and of all numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part(u32, f64);

impl Part {
    /// Returns the fraction `number` / 2^32.
    #[inline]
    pub(crate) fn of_all(number: u32) -> Self {
        Self(number, 4_294_967_296.0)
    }

    /// Returns the index at this fraction of `count`. It is less than `count`, unless that is 0.
    #[inline]
    pub(crate) fn pick(self, count: u32) -> usize {
        /// A sum with this constant has the nearest whole number in its last digits, in one step on every machine.
        const WHOLE: f64 = 1.5 * 4_503_599_627_370_496.0;
        // Divisions of f64 are faster than those of integers, and their rounding is far less than the resolution of
        // the numbers.
        let Self(before, all) = self;
        let middle = f64::from(before) * f64::from(count) / all - 0.5;
        (middle + WHOLE).to_bits() as u32 as usize
    }
}

impl LightProposals {
    /// Makes proposals from the sums of training.
    pub fn new(cells: Cells, sums: &PairSums) -> Self {
        let kappa = &sums.light_vertices;
        let all: f64 = kappa.iter().sum();
        let unit = all / f64::from(UNITS);
        let count_factor = |kappa: f64| if kappa > 0.0 { unit / kappa } else { 0.0 };
        let squares = sums.squares.chunks_exact(Cells::COUNT);
        let arrived = sums.arrived.chunks_exact(Cells::COUNT);
        let pairs = squares.zip(arrived);
        Self {
            cells,
            rows: pairs
                .map(|(squares, arrived)| ProposalRow::new(kappa, squares, arrived))
                .collect(),
            count_factors: from_fn(|cell| {
                kappa.get(cell).map_or(0.0, |&kappa| count_factor(kappa))
            }),
        }
    }

    /// Returns n κ / M of a light vertex in the cell `light` for a camera vertex with the proposals `row`.
    #[inline]
    pub(super) fn count_factor(&self, light: Cell, row: &ProposalRow) -> f64 {
        UNIFORM_PART + self.count_factors[light.index()] * f64::from(row.units(light))
    }

    /// Returns the proposals to camera vertices in the cell `camera`.
    #[inline]
    pub(crate) fn row(&self, camera: Cell) -> &ProposalRow {
        &self.rows[camera.index()]
    }
}

impl ProposalRow {
    fn new(kappa: &[f64], squares: &[f64], arrived: &[[u32; 2]]) -> Self {
        let last = last_units(kappa, squares);
        Self {
            last,
            first: from_fn(|part| first_cell_of_part(&last, part)),
            root_visibility: from_fn(|light| root_visibility(arrived.get(light))),
        }
    }

    /// Draws a cell of light vertices by `number`, which is uniform among 2^32.
    #[inline]
    pub(crate) fn draw(&self, number: u32) -> CellDraw {
        let unit = (number >> UNIT_BITS) as u16;
        if unit < UNIFORM_UNITS {
            return CellDraw::All(Part(number, numbers_of(UNIFORM_UNITS)));
        }
        let mut cell = self.first[usize::from(unit / UNITS_OF_PART)];
        while self.last[usize::from(cell) + 1] < unit {
            cell = cell.wrapping_add(1);
        }
        let light = Cells::cell(cell.into());
        let begin = (u32::from(self.last[usize::from(cell)]) + 1) << UNIT_BITS;
        let units = self.units(light);
        CellDraw::One(light, units, Part(number - begin, numbers_of(units)))
    }

    /// Returns (1 - ε) Γ(c | r) of the cell c = `light`, in units.
    #[inline]
    pub(crate) fn units(&self, light: Cell) -> u16 {
        let cell = light.index();
        self.last[cell + 1] - self.last[cell]
    }

    /// Returns √V̂ of a light vertex in the cell `light`.
    #[inline]
    pub(crate) fn root_visibility(&self, light: Cell) -> f32 {
        f32::from(self.root_visibility[light.index()]) * (1.0 / f32::from(VISIBILITY_UNITS))
    }
}

/// Returns 1 / P(z | y) for a light vertex in a cell c with `units` of (1 - ε) Γ(c | r), where `[K, K_c]` = `counts`.
#[inline]
pub(crate) fn inverse_prob(units: u16, counts: [u32; 2]) -> f32 {
    let [all, of_cell] = counts.map(|count| count as f32);
    let sum = f32::from(UNIFORM_UNITS) * of_cell + f32::from(units) * all;
    UNITS as f32 * all * of_cell / sum
}

/// Returns how many of 2^32 numbers lead to `units` units.
#[inline]
const fn numbers_of(units: u16) -> f64 {
    units as f64 * UNITS as f64
}

/// Returns the first cell whose last unit is in this part, or behind it.
fn first_cell_of_part(last: &LastUnits, part: usize) -> u8 {
    let begin = part as u16 * UNITS_OF_PART;
    last[1..Cells::COUNT].partition_point(|&last| last < begin) as u8
}

/// Returns √V̂ from the numbers of traced and of visible connections. A pair without traced connections counts as
/// visible, and no pair as surely hidden. Unit: 1 / [`VISIBILITY_UNITS`].
fn root_visibility(arrived: Option<&[u32; 2]>) -> u8 {
    let [traced, arrived] = arrived.copied().unwrap_or_default();
    let visible = f64::from(arrived + 1) / f64::from(traced + 1);
    let root = visible.max(LEAST_VISIBILITY).sqrt();
    (root * f64::from(VISIBILITY_UNITS)).round() as u8
}

/// Returns the last unit of the uniform proposals and of each cell, with Γ(c | r) ∝ √(κ_c Σ X²), or ∝ κ_c if training
/// found nothing.
fn last_units(kappa: &[f64], squares: &[f64]) -> LastUnits {
    let learned = || kappa.iter().zip(squares).map(|(k, q)| (k * q).sqrt());
    let total: f64 = learned().sum();
    let all: f64 = kappa.iter().sum();
    let mut last = [u16::MAX; 1 + Cells::NAMES];
    last[0] = UNIFORM_UNITS - 1;
    let mut sum = 0.0;
    for ((last, kappa), learned) in last[1..Cells::COUNT].iter_mut().zip(kappa).zip(learned()) {
        sum += if total > 0.0 {
            learned / total
        } else {
            kappa / all
        };
        let units = sum * f64::from(UNITS - u32::from(UNIFORM_UNITS));
        *last = UNIFORM_UNITS - 1 + units.round() as u16;
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::testing::{check_close, check_near};

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
        let root = |light| f64::from(proposals.row(y).root_visibility(light));
        let half_a_unit = 0.5 / f64::from(VISIBILITY_UNITS);
        // Not hidden for sure.
        for (light, expected) in [(seen, libm::sqrt(0.26)), (hidden, 0.25), (unknown, 1.0)] {
            check_near(root(light), expected, 1.01 * half_a_unit, "a root");
        }
    }

    #[test]
    fn traced_connections_change_visibility_alone() {
        let cells = Cells::new(&mut []);
        let mut sums = PairSums::uniform(vec![1.0; Cells::COUNT]);
        let [z, y] = [3, 5].map(Cells::cell);
        sums.squares[Cells::pair(y, y)] += 1.0;
        let before = LightProposals::new(cells.clone(), &sums);
        for i in 0..99 {
            sums.see(Cells::pair(z, y), i % 4 == 0);
        }
        let after = LightProposals::new(cells, &sums);
        let unit = 1.0 / f64::from(VISIBILITY_UNITS);
        check_near(
            after.row(y).root_visibility(z),
            libm::sqrt(0.26),
            unit,
            "a root",
        );
        for (after, before) in after.rows.iter().zip(&before.rows) {
            assert_eq!(after.last, before.last);
        }
        let bits = |proposals: &LightProposals| proposals.count_factors.map(f64::to_bits);
        assert_eq!(bits(&after), bits(&before));
    }

    /// Where each cell has its usual part K_c / K = κ_c / κ of the vertices, n κ / M is K P.
    #[test]
    fn counts_of_weights_are_those_of_draws() {
        let kappa = |cell: usize| (1 + cell % 5) as f64;
        let mut sums = PairSums::uniform((0..Cells::COUNT).map(kappa).collect());
        let y = Cells::cell(5);
        for z in (0..Cells::COUNT).step_by(3) {
            sums.squares[Cells::pair(Cells::cell(z), y)] += f64::from(z as u32 % 11);
        }
        let all: f64 = sums.light_vertices.iter().sum();
        let proposals = LightProposals::new(Cells::new(&mut []), &sums);
        for cell in 0..Cells::COUNT {
            let (z, counts) = (Cells::cell(cell), [all, kappa(cell)].map(|k| 2 * k as u32));
            let row = proposals.row(y);
            let drawn = 2.0 * all / f64::from(inverse_prob(row.units(z), counts));
            let counted = proposals.count_factor(z, row);
            check_close(drawn, counted, 1e-6, cell);
        }
    }

    /// Some cells take most of the numbers, others none.
    fn uneven() -> LightProposals {
        let mut sums = PairSums::uniform(vec![1.0; Cells::COUNT]);
        for light in (0..Cells::COUNT).filter(|light| light % 11 > 2) {
            let square = (light % 7 * light % 11) as f64;
            sums.squares[Cells::pair(Cells::cell(light), Cells::cell(5))] += square;
        }
        LightProposals::new(Cells::new(&mut []), &sums)
    }

    /// Each cell gets as many of all units as it is told to have: probabilities sum to 1 exactly.
    #[test]
    fn every_unit_leads_to_a_cell_that_has_it() {
        let proposals = uneven();
        // Cell 7 learned nothing.
        for row in [5, 7].map(|y| proposals.row(Cells::cell(y))) {
            let (mut uniform, mut of_cell) = (0_u32, [0_u32; Cells::COUNT]);
            for unit in 0..UNITS {
                let number = unit << UNIT_BITS | unit;
                match row.draw(number) {
                    CellDraw::All(_) => uniform += 1,
                    CellDraw::One(cell, ..) => of_cell[cell.index()] += 1,
                }
            }
            assert_eq!(uniform, u32::from(UNIFORM_UNITS));
            for (cell, &count) in of_cell.iter().enumerate() {
                let units = row.units(Cells::cell(cell));
                assert_eq!(count, u32::from(units), "cell {cell}");
            }
        }
    }

    /// The parts of a cell's numbers are evenly spaced from 0 to 1, and so are those of all vertices.
    #[test]
    fn numbers_of_a_cell_lead_to_all_parts_of_it() {
        let proposals = uneven();
        let row = proposals.row(Cells::cell(5));
        let count = 1000;
        let mut begin = 0;
        for cell in 0..=Cells::COUNT {
            let units = match cell.checked_sub(1) {
                Some(cell) => row.units(Cells::cell(cell)),
                None => UNIFORM_UNITS,
            };
            let numbers = u64::from(units) << UNIT_BITS;
            // The first and the last number of each thousandth.
            for i in (0..count).filter(|_| numbers > 0) {
                let ends = [i * numbers / 1000, (i + 1) * numbers / 1000].map(|part| begin + part);
                for number in [ends[0] + 1, ends[1] - 1] {
                    let (CellDraw::All(part) | CellDraw::One(_, _, part)) = row.draw(number as u32);
                    assert_eq!(part.pick(count as u32), i as usize);
                }
            }
            begin += numbers;
        }
        assert_eq!(begin, 1 << 32);
    }

    #[test]
    fn parts_of_nothing_are_found_nowhere() {
        for number in [0, 1, u32::MAX] {
            let part = Part::of_all(number);
            assert_eq!(part.pick(0), 0);
            assert_eq!(part.pick(1), 0);
            assert!(part.pick(1 << 22) < 1 << 22);
        }
    }

    /// What one connection taught can be taken back.
    #[test]
    fn a_connection_is_judged_by_the_others() {
        let cells = Cells::new(&mut []);
        let [y, z, other] = [Vec3::X, Vec3::Y, Vec3::Z].map(|n| cells.of(Vec3::ZERO, n));
        let mut sums = PairSums::uniform(vec![1.0; Cells::COUNT]);
        let (own, pair) = (5.0, Cells::pair(z, y));
        for (pair, square, has_arrived) in [(pair, 2.0, true), (Cells::pair(other, y), 3.0, false)]
        {
            sums.squares[pair] += square;
            sums.see(pair, has_arrived);
        }
        let before = LightProposals::new(cells.clone(), &sums);
        sums.squares[pair] += own;
        sums.see(pair, false);
        let all = [Cells::COUNT as f64, sums.roots()[y.index()]];
        for light in [z, other] {
            let square = if light == z { own } else { 0.0 };
            let found = sums.count_factor(all, [light, y], [square, 0.0]);
            let all = LightProposals::new(cells.clone(), &sums);
            let known = if light == z { &before } else { &all };
            let expected = known.count_factor(light, known.row(y));
            check_close(found, expected, 1e-3, "a factor");
        }
        let found = sums.root_visibility_without(pair, false);
        check_near(found, before.row(y).root_visibility(z), 1e-6, "a root");
    }
}
