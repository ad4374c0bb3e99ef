//! Choices in proportion to weights: p_i = w_i / Σ w, by inversion of the sums. A guide table shortens the search to a
//! step or two \[Chen74\].
//!
//! Densities are over the unit interval, square and cube; a caller that maps these to another domain divides by its
//! measure.

use super::ONE_MINUS_EPSILON;
use glam::{Vec2, Vec3};

/// The most cells for which a search without a guide table is as fast.
const FEW: usize = 8;

/// A piecewise-constant distribution over `[0, 1)`, which is also a choice of one of `n` cells.
///
/// Sums are f64, so that a million small weights are summed accurately.
#[derive(Clone, Debug)]
pub struct Distribution1d {
    /// The sums of the first `i` weights, normalised: `n + 1` values from 0 to 1.
    cdf: Vec<f64>,
    /// The guide table: for each of 2^k equal parts of the interval, the cell in which the part begins; then the last
    /// cell of positive width.
    parts: Vec<u32>,
    /// The first stride of the search: the largest power of two that is at most the number of cells between the ends
    /// of the longest part; 0 if every part lies in one cell.
    stride: usize,
    /// The sum of the weights as they were given.
    total: f64,
}

impl Distribution1d {
    /// Makes the distribution proportional to `weights`, which are finite and not negative. If all are zero, or there
    /// are none, it is uniform over `max(1, n)` cells and its [`total`](Self::total) is zero.
    ///
    /// # Panics
    ///
    /// Panics with 2³² weights or more.
    pub fn new(weights: impl IntoIterator<Item = f32>) -> Self {
        let mut cdf = vec![0.0];
        let mut total = 0.0;
        for weight in weights {
            debug_assert!(weight.is_finite() && weight >= 0.0);
            total += f64::from(weight);
            cdf.push(total);
        }
        if cdf.len() == 1 {
            cdf.push(0.0);
        }
        let cells = cdf.len() - 1;
        for (i, value) in cdf.iter_mut().enumerate() {
            *value = if total > 0.0 {
                *value / total
            } else {
                i as f64 / cells as f64
            };
        }
        let parts = Self::parts_of(&cdf);
        let longest = parts.windows(2).map(|part| part[1] - part[0]).max();
        let stride = longest
            .and_then(u32::checked_ilog2)
            .map_or(0, |log| 1 << log);
        Self {
            cdf,
            parts,
            stride,
            total,
        }
    }

    /// Returns the guide table. It has as many parts as there are cells, or up to twice as many; a single one for up to
    /// [`FEW`] cells.
    fn parts_of(cdf: &[f64]) -> Vec<u32> {
        let cells = cdf.len() - 1;
        assert!(
            u32::try_from(cells).is_ok(),
            "cells are numbered in 32 bits"
        );
        let parts = if cells > FEW {
            cells.next_power_of_two()
        } else {
            1
        };
        // By rounding, a number near 1 must not lead beyond this cell.
        let has_width = |&i: &usize| cdf[i] < cdf[i + 1];
        let last = (0..cells).rev().find(has_width).unwrap_or(0);
        let mut cell = 0;
        let begins = (0..parts).map(|part| {
            let begin = part as f64 / parts as f64;
            while cell < last && cdf[cell + 1] <= begin {
                cell += 1;
            }
            cell as u32
        });
        begins.chain([last as u32]).collect()
    }

    /// Returns the number of cells.
    pub fn len(&self) -> usize {
        self.cdf.len() - 1
    }

    /// Returns false: there is at least one cell.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Returns the sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Returns the probability of cell `i`. Unitless.
    #[inline]
    pub fn prob(&self, i: usize) -> f32 {
        (self.cdf[i + 1] - self.cdf[i]) as f32
    }

    /// Draws a cell. Returns its index, its probability, and the rest of `u`, uniform in `[0, 1)`.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        let u = f64::from(u);
        let parts = self.parts.len() - 1;
        let part = if parts > 1 {
            // Exact, as the number of parts is a power of two.
            ((u * parts as f64) as usize).min(parts - 1)
        } else {
            0
        };
        let (mut i, last) = (self.parts[part] as usize, self.parts[part + 1] as usize);
        // Finds the last cell that begins at or before u; it skips cells without width. The number of steps is the
        // same for every u, so that the processor predicts the end of the loop.
        let mut stride = self.stride;
        while stride > 0 {
            let next = (i + stride).min(last);
            i = if self.cdf[next] <= u { next } else { i };
            stride /= 2;
        }
        let width = self.cdf[i + 1] - self.cdf[i];
        let rest = ((u - self.cdf[i]) / width) as f32;
        (i, width as f32, rest.clamp(0.0, ONE_MINUS_EPSILON))
    }

    /// Draws a point of `[0, 1)`. Returns the point, its density, and its cell.
    #[inline]
    pub fn sample_continuous(&self, u: f32) -> (f32, f32, usize) {
        let (i, prob, rest) = self.sample(u);
        let n = self.len() as f32;
        (((i as f32 + rest) / n).min(ONE_MINUS_EPSILON), prob * n, i)
    }

    /// Returns the density of [`sample_continuous`](Self::sample_continuous) at `x` in `[0, 1)`.
    #[inline]
    pub fn pdf(&self, x: f32) -> f32 {
        let n = self.len();
        let i = ((x * n as f32) as usize).min(n - 1);
        self.prob(i) * n as f32
    }
}

/// A piecewise-constant distribution over the unit square: a row, then a cell of the row.
#[derive(Clone, Debug)]
pub struct Distribution2d {
    rows: Distribution1d,
    columns: Vec<Distribution1d>,
}

impl Distribution2d {
    /// Makes the distribution proportional to `weights`, row by row, each row `width` long.
    pub fn new(weights: &[f32], width: usize) -> Self {
        let columns: Vec<_> = weights
            .chunks_exact(width.max(1))
            .map(|row| Distribution1d::new(row.iter().copied()))
            .collect();
        let rows = Distribution1d::new(columns.iter().map(|row| row.total() as f32));
        Self { rows, columns }
    }

    /// Draws a point `(x, y)` of the unit square. Returns it, and its density over the square's area.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (y, pdf_y, row) = self.rows.sample_continuous(u.y);
        let (x, pdf_x, _) = self.columns[row].sample_continuous(u.x);
        (Vec2::new(x, y), pdf_x * pdf_y)
    }

    /// Returns the density of [`sample`](Self::sample) at `p`, over the square's area.
    #[inline]
    pub fn pdf(&self, p: Vec2) -> f32 {
        let n = self.rows.len();
        let row = ((p.y * n as f32) as usize).min(n - 1);
        self.rows.pdf(p.y) * self.columns[row].pdf(p.x)
    }

    /// Returns the mean of the weights.
    pub fn mean(&self) -> f64 {
        self.rows.total() / (self.columns.len() * self.columns[0].len()) as f64
    }
}

/// A piecewise-constant distribution over the unit cube: a slab, then a point of it.
#[derive(Clone, Debug)]
pub struct Distribution3d {
    slabs: Distribution1d,
    planes: Vec<Distribution2d>,
}

impl Distribution3d {
    /// Makes the distribution proportional to `weights`, x fastest, in planes of `nx` by `ny` cells.
    pub fn new(weights: &[f32], [nx, ny]: [usize; 2]) -> Self {
        let planes: Vec<_> = weights
            .chunks_exact((nx * ny).max(1))
            .map(|plane| Distribution2d::new(plane, nx))
            .collect();
        let slabs = Distribution1d::new(planes.iter().map(|plane| plane.rows.total() as f32));
        Self { slabs, planes }
    }

    /// Draws a point of the unit cube. Returns it, and its density over the cube's volume.
    #[inline]
    pub fn sample(&self, u: Vec3) -> (Vec3, f32) {
        let (z, pdf_z, slab) = self.slabs.sample_continuous(u.z);
        let (p, pdf) = self.planes[slab].sample(u.truncate());
        (p.extend(z), pdf * pdf_z)
    }

    /// Returns the density of [`sample`](Self::sample) at `p`, over the cube's volume.
    #[inline]
    pub fn pdf(&self, p: Vec3) -> f32 {
        let n = self.slabs.len();
        let slab = ((p.z * n as f32) as usize).min(n - 1);
        self.slabs.pdf(p.z) * self.planes[slab].pdf(p.truncate())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_near;

    #[track_caller]
    fn check_frequencies(weights: &[f32]) {
        let distribution = Distribution1d::new(weights.iter().copied());
        let n = 100_000;
        let mut counts = vec![0usize; distribution.len()];
        for i in 0..n {
            let (cell, prob, rest) = distribution.sample((i as f32 + 0.5) / n as f32);
            assert!(prob > 0.0 && (0.0..1.0).contains(&rest));
            counts[cell] += 1;
        }
        for (cell, &count) in counts.iter().enumerate() {
            let frequency = count as f32 / n as f32;
            check_near(frequency, distribution.prob(cell), 2e-5, cell);
        }
    }

    #[test]
    fn cells_are_drawn_with_their_probabilities() {
        for weights in [
            &[1.0, 2.0, 3.0][..],
            &[0.0, 2.0, 0.0, 5.0, 0.0],
            &[0.0, 0.0],
            &[1e-6, 1e6],
            &[],
        ] {
            check_frequencies(weights);
        }
    }

    #[test]
    fn the_table_of_parts_leads_to_the_cell_that_a_search_finds() {
        let uneven = (0..1000).map(|i| if i % 7 < 3 { 0.0 } else { (i % 31) as f32 });
        let steep = (0..77).map(|i| libm::exp2f(-(i as f32)));
        for weights in [uneven.collect::<Vec<_>>(), steep.collect()] {
            let distribution = Distribution1d::new(weights);
            for i in 0..100_000 {
                let u = i as f32 / 1e5;
                let is_over = |&end: &f64| end <= f64::from(u);
                let searched = distribution.cdf[1..].partition_point(is_over);
                assert_eq!(distribution.sample(u).0, searched, "{u}");
            }
        }
    }

    #[test]
    fn the_largest_random_number_ends_in_a_possible_cell() {
        let distribution = Distribution1d::new([1.0, 1.0, 0.0]);
        let (cell, prob, _) = distribution.sample(ONE_MINUS_EPSILON);
        assert_eq!(cell, 1);
        assert!(prob > 0.0);
    }
}
