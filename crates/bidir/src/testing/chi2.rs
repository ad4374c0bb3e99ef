//! χ² = Σ (observed - expected)² / expected, over cells of even measure: whether samples follow the
//! density that is claimed for them.

use crate::math::{Frame, Vec2, Vec3, sqr};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::PI;

/// The domain of a density. Each is the image of the unit square under a map of even measure.
#[derive(Clone, Copy)]
pub(crate) enum Domain {
    /// The unit square, as points with z = 0.
    Square,
    /// The disk of this radius around the origin, as points with z = 0.
    Disk(f32),
    /// Unit directions within 1 - cosθ below the number, around the frame's z; 2 is the sphere.
    Cone(Frame, f32),
}

impl Domain {
    /// Returns the sphere of directions, its poles along ±y: the horizon is then a line of every grid, and
    /// the lobes in the xz plane lie where cells are near to square.
    pub(crate) fn sphere() -> Self {
        let [x, y, z] = [Vec3::Z, Vec3::X, Vec3::Y];
        Self::Cone(Frame { x, y, z }, 2.0)
    }

    fn measure(&self) -> f64 {
        match self {
            Self::Square => 1.0,
            Self::Disk(radius) => PI * f64::from(sqr(*radius)),
            Self::Cone(_, height) => 2.0 * PI * f64::from(*height),
        }
    }

    fn point(&self, x: f64, y: f64) -> Vec3 {
        let (sin, cos) = libm::sincos(2.0 * PI * y);
        match self {
            Self::Square => Vec3::new(x as f32, y as f32, 0.0),
            Self::Disk(radius) => {
                let r = x.sqrt();
                Vec3::new((r * cos) as f32, (r * sin) as f32, 0.0) * *radius
            }
            Self::Cone(frame, height) => {
                let drop = x * f64::from(*height);
                let r = (drop * (2.0 - drop)).sqrt();
                let local = Vec3::new((r * cos) as f32, (r * sin) as f32, (1.0 - drop) as f32);
                frame.to_world(local).normalize()
            }
        }
    }

    fn square(&self, p: Vec3) -> Vec2 {
        let turn = |x: f32, y: f32| {
            let turn = libm::atan2f(y, x) / (2.0 * PI as f32);
            if turn < 0.0 { turn + 1.0 } else { turn }
        };
        match self {
            Self::Square => p.truncate(),
            Self::Disk(radius) => {
                Vec2::new(p.truncate().length_squared() / sqr(*radius), turn(p.x, p.y))
            }
            Self::Cone(frame, height) => {
                let local = frame.to_local(p);
                // 1 - cosθ, with its digits where the cone is narrow.
                let sin2 = local.truncate().length_squared();
                let drop = if local.z > 0.0 {
                    sin2 / (1.0 + local.z)
                } else {
                    1.0 - local.z
                };
                Vec2::new(drop / height, turn(local.x, local.y))
            }
        }
    }
}

/// A domain cut into cells of even measure.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    domain: Domain,
    columns: usize,
    rows: usize,
}

impl Grid {
    pub(crate) fn new(domain: Domain, [columns, rows]: [usize; 2]) -> Self {
        Self {
            domain,
            columns,
            rows,
        }
    }

    pub(crate) fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// Returns how many points lie in each cell; last, how many are None.
    pub(super) fn histogram(&self, draws: impl Iterator<Item = Option<Vec3>>) -> Vec<u64> {
        let mut counts = vec![0; self.cells() + 1];
        for draw in draws {
            counts[draw.map_or(self.cells(), |point| self.cell(point))] += 1;
        }
        counts
    }

    fn cell(&self, point: Vec3) -> usize {
        let p = self.domain.square(point);
        // Rounding may lead out of the square, error much farther: that must not go unseen.
        let is_inside = p.min_element() > -1e-3 && p.max_element() < 1.001;
        assert!(is_inside, "{point} is out of the domain");
        let x = ((p.x * self.columns as f32) as usize).min(self.columns - 1);
        let y = ((p.y * self.rows as f32) as usize).min(self.rows - 1);
        y * self.columns + x
    }

    /// Returns the probability of each cell, exact to far less than `n` samples resolve; last, that of
    /// None.
    pub(super) fn expected(&self, pdf: impl Fn(Vec3) -> f32, n: u64) -> Vec<f64> {
        let measure = self.domain.measure();
        let integrand = |x: f64, y: f64| f64::from(pdf(self.domain.point(x, y))) * measure;
        let size = [1.0 / self.columns as f64, 1.0 / self.rows as f64];
        let mut expected: Vec<f64> = (0..self.cells())
            .map(|cell| {
                let (x, y) = ((cell % self.columns) as f64, (cell / self.columns) as f64);
                let square = Rectangle {
                    corner: [x * size[0], y * size[1]],
                    size,
                };
                // A corner of a step that all points of a coarse rule miss would go unnoticed.
                let parts = square.quarters().into_iter().flat_map(Rectangle::quarters);
                parts.map(|part| part.integrate(&integrand, n as f64)).sum()
            })
            .collect();
        expected.push((1.0 - expected.iter().sum::<f64>()).max(0.0));
        expected
    }
}

#[derive(Clone, Copy)]
struct Rectangle {
    corner: [f64; 2],
    size: [f64; 2],
}

impl Rectangle {
    fn quarters(self) -> [Self; 4] {
        let [w, h] = self.size.map(|size| size / 2.0);
        [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)].map(|(x, y)| Self {
            corner: [self.corner[0] + x, self.corner[1] + y],
            size: [w, h],
        })
    }

    fn gauss(&self, f: &impl Fn(f64, f64) -> f64) -> f64 {
        let offset = 0.15f64.sqrt();
        let nodes = [
            (0.5 - offset, 5.0 / 18.0),
            (0.5, 8.0 / 18.0),
            (0.5 + offset, 5.0 / 18.0),
        ];
        let mut sum = 0.0;
        for (x, weight_x) in nodes {
            for (y, weight_y) in nodes {
                let [x, y] = [
                    self.corner[0] + x * self.size[0],
                    self.corner[1] + y * self.size[1],
                ];
                sum += weight_x * weight_y * f(x, y);
            }
        }
        sum * self.size[0] * self.size[1]
    }

    /// Adaptive: an error of a fiftieth of the counts' own deviation is good enough.
    fn integrate(self, f: &impl Fn(f64, f64) -> f64, n: f64) -> f64 {
        let coarse = self.gauss(f);
        let tolerance = 0.02 * (n * coarse).max(1.0).sqrt() / n;
        self.refine(f, coarse, tolerance, 7)
    }

    fn refine(self, f: &impl Fn(f64, f64) -> f64, coarse: f64, tolerance: f64, depth: u32) -> f64 {
        let parts = self.quarters().map(|part| (part, part.gauss(f)));
        let fine: f64 = parts.iter().map(|(_, value)| value).sum();
        if depth == 0 || (fine - coarse).abs() <= tolerance {
            return fine;
        }
        let refine = |(part, value): (Self, f64)| part.refine(f, value, tolerance / 2.0, depth - 1);
        parts.map(refine).iter().sum()
    }
}

/// Returns the chance of counts at least as far from `expected` (probabilities) as `observed`.
pub(super) fn p_value(observed: &[u64], expected: &[f64]) -> f64 {
    let n = observed.iter().sum::<u64>() as f64;
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|&a, &b| expected[a].total_cmp(&expected[b]));
    // Cells that expect fewer than five join the next larger ones.
    let (mut statistic, mut bins) = (0.0, 0.0);
    let (mut pooled_observed, mut pooled_expected) = (0.0, 0.0);
    for cell in order {
        pooled_observed += observed[cell] as f64;
        pooled_expected += expected[cell] * n;
        if pooled_expected >= 5.0 {
            let difference: f64 = pooled_observed - pooled_expected;
            statistic += difference * difference / pooled_expected;
            bins += 1.0;
            (pooled_observed, pooled_expected) = (0.0, 0.0);
        }
    }
    assert!(bins > 1.0, "nothing to compare");
    ChiSquared::new(bins - 1.0)
        .expect("freedom is positive")
        .sf(statistic)
}

/// Returns `expected` with its first half of the probability raised by the relative `bias`, and the rest
/// lowered to make up for it.
pub(super) fn biased(expected: &[f64], bias: f64) -> Vec<f64> {
    let halves = || {
        expected.iter().scan(0.0, |before, probability| {
            let is_first = *before < 0.5;
            *before += probability;
            Some((is_first, probability))
        })
    };
    let first = halves().filter(|(is_first, _)| *is_first);
    let raised: f64 = first.map(|(_, probability)| probability).sum();
    let [up, down] = [1.0 + bias, 1.0 - bias * raised / (1.0 - raised)];
    let shift = |(is_first, probability)| probability * if is_first { up } else { down };
    halves().map(shift).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{check_close, check_near};

    #[test]
    fn domains_map_to_the_square_and_back() {
        let cone = Domain::Cone(Frame::from_z(Vec3::new(0.6, 0.0, -0.8)), 1e-4);
        for domain in [Domain::Square, Domain::Disk(0.3), Domain::sphere(), cone] {
            for (x, y) in [(0.1, 0.2), (0.9, 0.6), (0.5, 0.97)] {
                let back = domain.square(domain.point(x, y));
                let error = back - Vec2::new(x as f32, y as f32);
                assert!(error.length() < 1e-4, "{back}");
            }
        }
    }

    #[test]
    fn cells_of_a_rough_density_are_integrated_exactly() {
        // A step along a slanted line, on top of a peak.
        let step = |p: Vec3| if p.x + 0.3 * p.y < 0.7 { 1.0 } else { 0.2 };
        let peak = |p: Vec3| 1.0 / (1e-3 + sqr(p.x - 0.31) + sqr(p.y - 0.52));
        let [coarse, fine] = [4, 64].map(|n| Grid::new(Domain::Square, [n, n]));
        let expected: f64 = coarse.expected(step, 1 << 20)[..16].iter().sum();
        check_near(expected, 0.55 + 0.2 * 0.45, 1e-4, "step");
        let fine = fine.expected(peak, 1 << 20);
        let cells = (0..16).flat_map(|y| &fine[64 * y..64 * y + 16]);
        let (sum, cell): (f64, _) = (cells.sum(), coarse.expected(peak, 1 << 20)[0]);
        check_close(cell, sum, 1e-5, "peak");
    }
}
