//! Finds the albedo α with which a deep layer of an isotropic medium, under a smooth surface, reflects a given part of
//! diffuse light.
//!
//! Inside, the layer returns the radiance I_down that goes down as radiance I_up, at the cosine μ:
//!
//! I_up(μ) = α/2 H(μ) ∫ H(ν) ν / (μ + ν) I_down(ν) dν, 1 / H(μ) = √(1 - α) + α/2 ∫ ν H(ν) / (μ + ν) dν
//!
//! \[Chandrasekhar60, §37\]. The surface reflects some of it down again: I_down = e + F I_up, where e is the light that
//! enters. Integrals are Gaussian quadratures on both sides of the critical angle.

use bidir::bsdf::fresnel::dielectric;

/// Points and weights of Gaussian quadrature in `[-1, 1]`, only the points above 0 \[Press07, §4.6\].
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_5],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_3],
];
/// An iteration ends when no value changes by as much as this, or after [`STEPS`] steps.
const CHANGE: f64 = 1e-7;
const STEPS: usize = 4096;

/// A direction inside the layer.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// The cosine μ.
    cos: f64,
    /// The quadrature weight dμ.
    weight: f64,
    /// The internal reflectance F of the surface.
    reflectance: f64,
}

/// A layer under a surface.
#[derive(Debug)]
pub(super) struct Layer {
    points: Vec<Point>,
    /// e: for each direction inside, the radiance that enters from diffuse light of radiance 1 outside.
    entering: Vec<f64>,
}

impl Layer {
    /// Returns a layer under a surface of the relative index of refraction `eta`.
    pub(super) fn new(eta: f32) -> Self {
        let square = f64::from(eta) * f64::from(eta);
        let critical = (1.0 - 1.0 / square).max(0.0).sqrt();
        let points: Vec<Point> = [[0.0, critical], [critical, 1.0]]
            .iter()
            .flat_map(|&range| nodes(range))
            .map(|[cos, weight]| Point {
                cos,
                weight,
                reflectance: f64::from(dielectric(-cos as f32, eta)),
            })
            .collect();
        let entering = |at: &Point| square * (1.0 - at.reflectance);
        Self {
            entering: points.iter().map(entering).collect(),
            points,
        }
    }

    /// Returns the 1 - α for which `part` of the diffuse light that enters comes back.
    pub(super) fn absorption(&self, part: f64) -> f64 {
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            // Of 1 - α, because reflectance rises steeply where α is almost 1.
            if self.reflectance(1.0 - middle * middle) > part {
                low = middle;
            } else {
                high = middle;
            }
        }
        low * low
    }

    /// Returns the part of the entering diffuse light that comes back from a layer of this albedo.
    fn reflectance(&self, albedo: f64) -> f64 {
        let h = self.chandrasekhar(albedo);
        let up = converged(vec![0.0; self.points.len()], |up| {
            let returned = self.points.iter().zip(up);
            let back = returned.map(|(at, up)| at.reflectance * up);
            let down: Vec<f64> = back.zip(&self.entering).map(|(back, e)| back + e).collect();
            let from_below = |at: &Point, h_at: f64| {
                let terms = self.points.iter().zip(&h).zip(&down);
                let sum: f64 = terms
                    .map(|((to, h), down)| to.weight * h * to.cos / (at.cos + to.cos) * down)
                    .sum();
                0.5 * albedo * h_at * sum
            };
            let points = self.points.iter().zip(&h);
            points.map(|(at, &h)| from_below(at, h)).collect()
        });
        let leaves = |at: &Point| at.weight * at.cos * (1.0 - at.reflectance);
        let flux = |radiance: &[f64], part: &dyn Fn(&Point) -> f64| -> f64 {
            self.points
                .iter()
                .zip(radiance)
                .map(|(at, i)| part(at) * i)
                .sum()
        };
        flux(&up, &leaves) / flux(&self.entering, &|at| at.weight * at.cos)
    }

    /// Returns H at each of the points.
    fn chandrasekhar(&self, albedo: f64) -> Vec<f64> {
        converged(vec![1.0; self.points.len()], |h| {
            let inverse = |at: &Point| {
                let terms = self.points.iter().zip(h);
                let sum: f64 = terms
                    .map(|(to, h)| to.weight * to.cos * h / (at.cos + to.cos))
                    .sum();
                (1.0 - albedo).sqrt() + 0.5 * albedo * sum
            };
            // Half a step, as whole ones overshoot.
            let next = self.points.iter().zip(h);
            next.map(|(at, h)| 0.5 * (h + 1.0 / inverse(at))).collect()
        })
    }
}

/// Repeats `step` until no value changes by [`CHANGE`].
fn converged(mut values: Vec<f64>, step: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    for _ in 0..STEPS {
        let next = step(&values);
        let changes = next.iter().zip(&values).map(|(new, old)| (new - old).abs());
        let change = changes.fold(0.0, f64::max);
        values = next;
        if change < CHANGE {
            break;
        }
    }
    values
}

/// Returns the points of Gaussian quadrature in a range, with their weights.
fn nodes([from, to]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let signed = GAUSS.into_iter().flat_map(|[x, w]| [[-x, w], [x, w]]);
    let placed = signed.map(move |[x, w]| [middle + half * x, half * w]);
    placed.filter(|[_, weight]| *weight > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_without_a_surface_has_the_albedo_of_the_closed_form() {
        let layer = Layer::new(1.0);
        // 1 - 2 √(1 - α) ∫ H μ dμ with 400 points.
        let closed = [
            (0.3, 0.07445),
            (0.5, 0.14654),
            (0.8, 0.34187),
            (0.95, 0.59667),
            (0.99, 0.79456),
        ];
        for (albedo, expected) in closed {
            let found = layer.reflectance(albedo);
            assert!((found / expected - 1.0).abs() < 1e-3, "{albedo}: {found}");
        }
    }

    #[test]
    fn albedos_give_the_part_asked_for() {
        for eta in [1.0, 1.33, 2.0, 4.0] {
            let layer = Layer::new(eta);
            for part in [0.01, 0.2, 0.5, 0.8, 0.95] {
                let found = layer.reflectance(1.0 - layer.absorption(part));
                assert!((found - part).abs() < 1e-4, "{eta}, {part}: {found}");
            }
        }
    }
}
