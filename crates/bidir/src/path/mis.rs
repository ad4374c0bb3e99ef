//! Multiple importance sampling: the weight of a strategy as a pure function of its whole path.

use super::PathDensities;
use crate::names::named;

/// The part of a share that a cutoff leaves: too little to be seen, and enough to recover the value
/// without the weight.
const CUTOFF_REMAINDER: f64 = 1e-9;

/// How strategies that can make the same path share it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MisHeuristic {
    /// w_s ∝ n_s p_s \[Veach95\].
    #[default]
    Balance,
    /// w_s ∝ (n_s p_s)² \[Veach95\].
    Power,
    /// w_s = 1 / (number of strategies that can make the path): the weights under which the claim
    /// of \[Lafortune95\] holds.
    Uniform,
}

named!(MisHeuristic {
    "balance" => Balance,
    "power" => Power,
    "uniform" => Uniform,
});

impl MisHeuristic {
    /// Returns the share of a strategy with n_j p_j = `density`, relative to another.
    #[inline]
    pub(super) fn apply(self, density: f64) -> f64 {
        match self {
            Self::Balance => density,
            Self::Power => density * density,
            Self::Uniform => f64::from(density > 0.0),
        }
    }

    /// Applies the cutoff heuristic \[Veach97, §9.2.3\] to light that is seen directly, which strategies (0, 2) and (1, 1)
    /// make: returns the share `image` of (1, 1), or a billionth of it if (1, 1) takes at most twice as many samples as
    /// (0, 2), whose share is `hit`.
    ///
    /// If light that is seen directly covers a pixel evenly, hits have no variance, but the number
    /// of samples of the image varies. A lamp that is small in a pixel has far more of these.
    #[inline]
    pub(super) fn cut_off_image(self, image: f64, hit: f64) -> f64 {
        let cutoff = match self {
            Self::Balance | Self::Power => self.apply(2.0) * hit,
            Self::Uniform => 0.0,
        };
        if image > cutoff {
            image
        } else {
            CUTOFF_REMAINDER * image
        }
    }

    /// Returns the weight of a strategy with density `p`, where one other, with density `q` in the same
    /// measure, is all that can make the path too: share(p) / (share(p) + share(q)).
    #[inline]
    pub fn weight_of_two(self, p: f32, q: f32) -> f32 {
        1.0 / (1.0 + self.apply(f64::from(q / p)) as f32)
    }
}

/// Returns the weight of strategy `s`: share(n_s p_s) / Σ_j share(n_j p_j).
///
/// `counts(j)` is n_j, the expected number of samples that strategy j takes of this path in a pass; 0
/// switches it off.
#[inline]
pub fn mis_weight(
    path: &PathDensities,
    counts: impl Fn(usize) -> f64,
    heuristic: MisHeuristic,
    s: usize,
) -> f64 {
    let own = heuristic.apply(counts(s));
    let mut others = 0.0;
    for_each_other(path, s, |j, ratio| {
        others += heuristic.apply(counts(j) * ratio);
    });
    let [own, others] = match (path.vertices.len(), s) {
        (2, 0) => [own, heuristic.cut_off_image(others, own)],
        (2, 1) => [heuristic.cut_off_image(own, others), others],
        _ => [own, others],
    };
    own / (own + others)
}

/// Calls `visit` with every strategy j other than `s` that can make the path, and with p_j / p_s. The ratios run
/// outwards from s [Veach97, §10.2.1].
#[inline]
pub(super) fn for_each_other(path: &PathDensities, s: usize, mut visit: impl FnMut(usize, f64)) {
    let mut visit_possible = |j: usize, ratio: f64| {
        if path.is_possible(j) {
            visit(j, ratio);
        }
    };
    let mut ratio = 1.0;
    for j in s..path.vertices.len() - 1 {
        ratio *= path.ratio(j);
        visit_possible(j + 1, ratio);
    }
    ratio = 1.0;
    for j in (0..s).rev() {
        ratio /= path.ratio(j);
        visit_possible(j, ratio);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::Cell;
    use crate::path::VertexDensities;
    use proptest::prelude::*;

    fn vertex() -> impl Strategy<Value = VertexDensities> {
        (1e-6f32..1e6, 1e-6f32..1e6, prop::bool::weighted(0.2)).prop_map(
            |(from_light, from_camera, is_delta)| VertexDensities {
                from_light,
                from_camera,
                is_delta,
                cell: Cell::FIRST,
            },
        )
    }

    fn path() -> impl Strategy<Value = PathDensities> {
        (
            prop::collection::vec(vertex(), 2..9),
            prop_oneof![9 => 1e-6f32..1e6, 1 => Just(0.0f32)],
            any::<bool>(),
        )
            .prop_map(|(mut vertices, next_event, light_is_delta)| {
                // The ends do not scatter.
                let last = vertices.len() - 1;
                vertices[0].is_delta = false;
                vertices[last].is_delta = false;
                PathDensities {
                    vertices,
                    next_event,
                    light_is_delta,
                }
            })
    }

    /// Returns p_j by its definition, as a product over the whole path.
    fn density(path: &PathDensities, j: usize) -> f64 {
        let density = |(i, x): (usize, &VertexDensities)| match (i < j, i, j) {
            (true, 0, 1) => f64::from(path.next_event),
            (true, ..) => f64::from(x.from_light),
            (false, ..) => f64::from(x.from_camera),
        };
        let product: f64 = path.vertices.iter().enumerate().map(density).product();
        if path.is_possible(j) { product } else { 0.0 }
    }

    proptest! {
        #[test]
        fn weights_are_those_of_the_definition_and_sum_to_one(
            path in path(),
            counts in prop::collection::vec(prop_oneof![Just(0.0), 0.1f64..1e6], 10),
            heuristic in prop::sample::select(MisHeuristic::NAMES.map(|(_, h)| h).to_vec()),
        ) {
            let n = path.vertices.len();
            let share = |j: usize| heuristic.apply(counts[j] * density(&path, j));
            // Light seen directly: an image of twice as many samples as hits or fewer is cut off.
            let few = heuristic != MisHeuristic::Uniform
                && counts[1] * density(&path, 1) <= 2.0 * counts[0] * density(&path, 0);
            let kept = |s: usize| if n == 2 && s == 1 && few { 1e-9 * share(s) } else { share(s) };
            let total: f64 = (0..n).map(kept).sum();
            let mut sum = 0.0;
            for s in (0..n).filter(|&s| share(s) > 0.0) {
                let weight = mis_weight(&path, |j| counts[j], heuristic, s);
                prop_assert!((weight - kept(s) / total).abs() < 1e-9);
                sum += weight;
            }
            prop_assert!(total == 0.0 || (sum - 1.0).abs() < 1e-9);
        }

        #[test]
        fn two_strategies_share_by_the_same_rule(
            p in 1e-6f32..1e6,
            q in prop_oneof![9 => 1e-6f32..1e6, 1 => Just(0.0f32)],
            heuristic in prop::sample::select(MisHeuristic::NAMES.map(|(_, h)| h).to_vec()),
        ) {
            // By way of a surface: x_0 is hit with density p, or drawn with density q.
            let x = |from_camera| VertexDensities { from_light: 1.0, from_camera, is_delta: false, cell: Cell::FIRST };
            let path = PathDensities {
                vertices: vec![x(p), x(1.0), x(1.0)],
                next_event: q,
                light_is_delta: false,
            };
            let count = |s: usize| f64::from(s < 2);
            let [hit, drawn] = [0, 1].map(|s| mis_weight(&path, count, heuristic, s));
            prop_assert!((f64::from(heuristic.weight_of_two(p, q)) - hit).abs() < 1e-6);
            if q > 0.0 {
                prop_assert!((f64::from(heuristic.weight_of_two(q, p)) - drawn).abs() < 1e-6);
            }
        }
    }
}
