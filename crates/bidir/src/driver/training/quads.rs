//! The covariance of terms of one sample, which share a camera subpath W and a light subpath. The survey takes four
//! samples of a pixel: of two camera subpaths W and W', each with two light subpaths A and B and with its own light
//! points, so that products of samples estimate products of expectations. With S the sum of the values that plan k
//! adds on average for each term of the survey,
//!
//! Var_W E[S | W] = E[½ (S_WA - S_W'A) (S_WB - S_W'B)].
//!
//! If the plan's walks go on ρ times as often, S counts each term ρ times. A product of two terms of one walk counts
//! as often as the walk reaches both: the larger ρ times.
//!
//! Given W, draws are independent. If the plan draws a kind of term N times at a camera vertex, its second moment is
//! less by 1/N of the square of E[S_kind | W], which S_kind,WA S_kind,WB estimates. Light points of the first camera
//! vertex are drawn from N equal parts of the lights, one from each: their second moment is less by 1/N of the
//! variance between the means of parts.
//!
//! The connections T with one of N light subpaths, which G samples share, vary with this subpath: by Var_A E[T | W] /
//! N in a pixel. Neighbours have ½ (T_WA - T_WB) (T_W'A - T_W'B) / N of it in common.

use super::counts::{Counts, STARTS};

/// The number of classes of depth. The last one has all deeper camera vertices.
const DEPTHS: usize = 8;

/// A kind of term.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    /// s = 0; `is_seen` if the camera sees the light directly.
    Hit { is_seen: bool },
    /// s = 1.
    LightPoint,
    /// A connection with a light walk.
    Connection,
}

/// The length of a walk, and its probability relative to the survey.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// The number of camera vertices.
    pub(super) t: usize,
    /// The number of surfaces that may end the walk in the survey, but not in the plan.
    pub(super) surfaces: usize,
    /// ρ.
    pub(super) longer: f64,
}

/// Returns the sum over depths of the products of `a` and `b`, each divided by the number of draws at the first depth
/// or at later ones.
fn products(a: &[f64; DEPTHS], b: &[f64; DEPTHS], counts: [f64; 2]) -> f64 {
    let pairs = a.iter().zip(b).enumerate();
    pairs
        .map(|(depth, (a, b))| a * b / counts[usize::from(depth > 0)])
        .sum()
}

/// The sums of the values of a sample's terms.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Values, by the number of surfaces that may end the walk in the survey, but not in the plan.
    reached: [f64; STARTS],
    /// ρ, by the same number; 0 if no term has it.
    longer: [f64; STARTS],
    light_points: [f64; DEPTHS],
    /// The random number that chose the light of the first light point.
    light_number: f32,
    connections: [f64; DEPTHS],
    /// The sum of the squares of hits of lights that the camera does not see directly.
    hit_squares: f64,
    connection_squares: f64,
}

impl Sums {
    /// Returns S.
    fn all(&self) -> f64 {
        (self.reached.iter().zip(self.longer))
            .fold(0.0, |sum, (value, longer)| sum + value * longer)
    }

    /// Returns the sum of the products of terms of this sample with terms of another sample of the same walk.
    fn of_walk(&self, other: &Self) -> f64 {
        let longer = |i: usize| self.longer[i].max(other.longer[i]);
        let pairs = (0..STARTS).flat_map(|i| (0..STARTS).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| self.reached[i] * other.reached[j] * longer(i.max(j)))
            .sum()
    }

    /// Returns an estimate of the variance Σ m² / N - m̄² between the means of N = `count` parts of the lights, for
    /// the first light point. Σ m² comes from pairs of points in one part, which are 1/N of all pairs. Subtracting a
    /// value near both, the mean of the other walk, changes only the noise of the estimate.
    fn of_parts(&self, other: &Self, near: [&Self; 2], count: f64) -> f64 {
        let part = |sums: &Self| (f64::from(sums.light_number) * count) as u32;
        let near = (near[0].light_points[0] + near[1].light_points[0]) / 2.0;
        let product = (self.light_points[0] - near) * (other.light_points[0] - near);
        if part(self) == part(other) {
            product * (count - 1.0)
        } else {
            -product
        }
    }

    /// Returns T.
    fn connected(&self) -> f64 {
        self.connections.iter().sum()
    }

    /// Returns the sum of the products of different connections.
    fn pairs(&self) -> f64 {
        self.connected() * self.connected() - self.connection_squares
    }
}

/// The values of four samples: WA, WB, W'A, W'B.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quad([Sums; 4]);

impl Quad {
    /// Makes four samples without terms, whose first light points chose their lights by these random numbers.
    pub(super) fn new(light_numbers: [f32; 4]) -> Self {
        Self(light_numbers.map(|light_number| Sums {
            light_number,
            ..Sums::default()
        }))
    }

    /// Adds the mean value of a plan's term to sample number `i` of the four, if the walk reaches it.
    pub(super) fn add(&mut self, i: usize, part: Part, reach: Reach, value: f64) {
        let (sums, depth) = (&mut self.0[i], (reach.t - 2).min(DEPTHS - 1));
        sums.reached[reach.surfaces] += value;
        sums.longer[reach.surfaces] = reach.longer;
        match part {
            Part::Hit { is_seen: true } => {}
            Part::Hit { is_seen: false } => sums.hit_squares += value * value * reach.longer,
            Part::LightPoint => sums.light_points[depth] += value * reach.longer.sqrt(),
            Part::Connection => {
                sums.connections[depth] += value;
                sums.connection_squares += value * value;
            }
        }
    }

    /// Returns the variance of the camera subpath, minus the squares of the means of draws, minus the second moments
    /// of hits, which the second moment of all terms includes.
    fn alone(&self, counts: &Counts) -> f64 {
        let [wa, wb, va, vb] = &self.0;
        let walks = wa.of_walk(wb) + va.of_walk(vb) - wa.all() * vb.all() - wb.all() * va.all();
        let hits: f64 = self.0.iter().map(|sums| sums.hit_squares).sum();
        let drawn = [[wa, wb], [va, vb]].map(|[a, b]| {
            let light_points = products(&a.light_points, &b.light_points, counts.next_events);
            let connections = match &counts.draws {
                Some(draws) => products(&a.connections, &b.connections, draws.candidates),
                // Connections of one light subpath vary together.
                None => a.connected() * b.connected() - (a.pairs() + b.pairs()) / 2.0,
            };
            2.0 * (light_points + connections)
        });
        2.0 * walks - hits - drawn[0] - drawn[1]
    }

    /// Returns the reduction of variance by drawing the first light points from parts of the lights.
    fn parts(&self, counts: &Counts) -> f64 {
        let [wa, wb, va, vb] = &self.0;
        let [count, _] = counts.next_events;
        let parts = wa.of_parts(wb, [va, vb], count) + va.of_parts(vb, [wa, wb], count);
        2.0 * parts / count
    }
}

/// The sums of quads over pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct QuadVariance {
    /// The sum of `Quad::alone`.
    alone: f64,
    /// The sum of `Quad::parts`.
    parts: f64,
    /// The sum of the squares of `Quad::parts`.
    parts_squares: f64,
    /// The sum of the products of different connections of one light subpath.
    pub(super) pairs: f64,
    /// Σ E[T | W]².
    pub(super) mean_squares: f64,
    /// Σ Var_A E[T | W].
    pub(super) spread: f64,
    /// The part of `spread` that two camera subpaths have in common.
    common: f64,
}

impl QuadVariance {
    /// Adds four samples, with the weight `scale` of each square.
    pub(super) fn add(&mut self, quad: &Quad, counts: &Counts, scale: f64) {
        self.alone += quad.alone(counts) * scale;
        let parts = quad.parts(counts) * scale;
        self.parts += parts;
        self.parts_squares += parts * parts;
        self.pairs += quad.0.iter().map(Sums::pairs).sum::<f64>() * scale;
        let [wa, wb, va, vb] = quad.0.each_ref().map(Sums::connected);
        self.mean_squares += 2.0 * (wa * wb + va * vb) * scale;
        let [w, v] = [wa - wb, va - vb];
        self.spread += (w * w + v * v) * scale;
        self.common += 2.0 * w * v * scale;
    }

    /// Returns the sum of `Quad::alone`, minus the sum of `Quad::parts` as far as that exceeds its standard error.
    pub(super) fn alone(&self) -> f64 {
        self.alone - (self.parts - self.parts_squares.sqrt()).max(0.0)
    }

    /// Returns the fraction of the variance of T that two camera subpaths of a pixel have in common.
    pub(super) fn correlation(&self) -> f64 {
        if self.spread > 0.0 {
            (self.common / self.spread).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::Settings;
    use crate::integrator::{CandidateCount, IntegratorKind};
    use crate::path::PathRoulette;
    use crate::sampler::{Dimension, Purpose};
    use crate::testing::{check_close, check_near, numbers, samples};

    /// Returns where paths of camera subpaths of t vertices reach.
    fn reach(t: usize) -> Reach {
        Reach {
            t,
            surfaces: 0,
            longer: 1.0,
        }
    }

    /// Standard normal numbers.
    fn normals() -> impl FnMut() -> f64 {
        let mut numbers = numbers(0x1234_5678_9abc_def1);
        move || (0..12).map(|_| numbers()).sum::<f64>() - 6.0
    }

    #[test]
    fn one_bright_pair_tells_nothing_of_parts_of_the_lights() {
        let mut settings = Settings::new(IntegratorKind::Lvc);
        settings.lvc.next_events = CandidateCount::new(8, 1);
        let counts = Counts::new(&settings, PathRoulette::Off, 1.0, 1 << 22);
        let alone = |numbers| {
            let mut quad = Quad::new(numbers);
            for (i, value) in [100.0, 100.0, 1.0, 1.0].into_iter().enumerate() {
                quad.add(i, Part::LightPoint, reach(2), value);
            }
            let mut sums = QuadVariance::default();
            sums.add(&quad, &counts, 1.0);
            sums.alone()
        };
        let [in_one, in_two] = [0.1, 0.9].map(|second| alone([0.1, second, 0.6, 0.6]));
        check_close(in_one, in_two, 1e-9, "both");
    }

    /// A camera subpath has a hit of the value 1 + W, light points 2 + W + X ± 1 and connections 3 + W + Y + Z, with standard
    /// normal W, X and Z of their own and Y of the light subpath; the sign is that of one half of the lights. With their
    /// second moments the variance is known.
    #[test]
    fn products_of_samples_tell_what_terms_have_in_common() {
        for (integrator, expected) in [
            // Three W; X / 2, with a point of each half; (Y + Z) / 3, with 3 + W + Y + Z drawn thrice.
            (IntegratorKind::Lvc, 9.0 + 1.0 / 2.0 + 2.0 / 3.0),
            // Three W, X, the sign, Y and Z.
            (IntegratorKind::Bdpt, 9.0 + 4.0),
        ] {
            let mut settings = Settings::new(integrator);
            settings.lvc.candidates = CandidateCount::new(3, 1);
            settings.lvc.next_events = CandidateCount::new(2, 1);
            let counts = Counts::new(&settings, PathRoulette::Off, 1.0, 1 << 22);
            let [points, draws] = match integrator {
                IntegratorKind::Lvc => [2.0, 3.0],
                _ => [1.0; 2],
            };
            let (mut next, mut sums, mut moment) = (normals(), QuadVariance::default(), 0.0);
            let quads = 60_000_u32;
            let mut parts = samples("light points", u64::from(4 * quads))
                .map(|sample| sample.get_1d(Dimension::at(0, Purpose::NextEventLight)));
            for _ in 0..quads {
                let (walks, lights) = ([next(), next()], [next(), next()]);
                let numbers = [(); 4].map(|()| parts.next().unwrap_or_default());
                let mut quad = Quad::new(numbers);
                for (i, number) in numbers.into_iter().enumerate() {
                    let (w, y) = (walks[i / 2], lights[i % 2]);
                    let hit = 1.0 + w;
                    let sign = if number < 0.5 { 1.0 } else { -1.0 };
                    let (x, z) = (2.0 + w + next() + sign, 3.0 + w + y + next());
                    quad.add(i, Part::Hit { is_seen: false }, reach(3), hit);
                    quad.add(i, Part::LightPoint, reach(2), x);
                    quad.add(i, Part::Connection, reach(2), z);
                    moment += hit * hit + x * x / points + z * z / draws;
                }
                sums.add(&quad, &counts, 1.0);
            }
            let found = (moment + sums.alone()) / (4.0 * f64::from(quads));
            check_close(found, expected, 0.02, integrator);
            // The light subpath has Y alone in common, and two camera subpaths share that but not Z.
            check_near(sums.correlation(), 0.5, 0.02, "correlation");
            let squares = sums.mean_squares / (4.0 * f64::from(quads));
            check_close(squares, 10.0, 0.02, "squares");
        }
    }
}
