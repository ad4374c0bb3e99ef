//! f = F D G₂ / (4 |cosθ_o cosθ_i|) + T(wo) T(wi) (A(wo) A(wi) ρ Σ_k (ρ R)^k / (π η²) + M(wo, wi)),
//! 1/sr: varnish, plastic, polished wood.
//!
//! The base is Lambertian, so light that interface and medium return to it is like any other diffuse light: each
//! round trip leaves the fraction ρ R ([`Filled`]). The sum over all k is 1 / (1 - ρ R): pbrt-v4's random walk in
//! closed form [PBRT4, §14.3], without its limit of events.
//!
//! Light that scatters within the layer and leaves without reaching the base has M = Ē e(wo) e(wi) / π, as if it had
//! lost its direction: its energy is right for every direction, its distribution an approximation. So the reflectance
//! is exact, up to tables.

use super::coat::{Coat, Curve, Filled, LENGTHS, Layer, RATIOS, SHAPES, Seen, Slab, all_orders};
use super::microfacet::Ggx;
use super::{BsdfSample, BsdfValue, same_hemisphere};
use crate::math::{INV_PI, PI, Vec2, Vec3, sqr, warp};
use crate::spectrum::Spectrum;

/// A dielectric layer over a diffuse base; both sides of the surface look alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedDiffuse {
    coat: Coat<RATIOS, LENGTHS>,
    /// ρ / (π η² (1 - ρ R)).
    base: Spectrum,
    /// Ē.
    thrown: Spectrum,
    /// e.
    shape: Curve<SHAPES>,
    /// The approximate fraction of entering light that leaves again.
    entering: Spectrum,
}

/// The medium that fills a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterlayerMedium {
    /// The optical depth of the layer, scattering and absorption together.
    pub thickness: f32,
    /// The fraction of it that scatters.
    pub albedo: Spectrum,
    /// The mean cosine of the angle of scattering.
    pub g: f32,
}

impl InterlayerMedium {
    /// Returns the optical depth of absorption.
    #[inline]
    pub(crate) fn absorption(&self) -> Spectrum {
        self.albedo.map(|albedo| self.thickness * (1.0 - albedo))
    }
}

impl CoatedDiffuse {
    /// Makes a base of `reflectance` under an interface of `ggx`, tabulated as `layer`. `filled` has the
    /// table of each lane, and `mean` the mean over lanes that carry light.
    pub fn new(
        layer: &Layer,
        ggx: Ggx,
        filled: &[Filled; 4],
        mean: &Filled,
        reflectance: Spectrum,
    ) -> Self {
        let lanes = |value: fn(&Filled) -> f32| Spectrum(filled.each_ref().map(value));
        let depth = lanes(|lane| lane.depth);
        let coat = Coat::new(layer, ggx, layer.ratio, depth, mean.length);
        let trips = lanes(|lane| lane.internal);
        let base = reflectance.zip(trips, |rho, trip| {
            rho * all_orders(rho * trip) * INV_PI / sqr(coat.eta())
        });
        let thrown = lanes(|lane| lane.thrown);
        // ∫ T cosθ dω of the base's light leaves a clear layer.
        let escape = PI * layer.transmitted;
        Self {
            coat,
            base,
            thrown,
            shape: mean.shape,
            entering: base * coat.attenuation(Vec3::Z, Vec3::Z) * escape + thrown,
        }
    }

    /// Returns true if all scattering is a Dirac distribution: the coat is smooth, and nothing below it scatters.
    #[inline]
    pub(super) fn is_delta(&self) -> bool {
        self.coat.is_smooth() && self.is_black_within()
    }

    #[inline]
    fn is_black_within(&self) -> bool {
        self.base.is_black() && self.thrown.is_black()
    }

    /// Returns the roughness of the interface.
    pub(super) fn gloss(&self) -> f32 {
        self.coat.ggx.gloss()
    }

    #[inline]
    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        let Seen { reflected, through } = self.coat.interface(wo);
        self.entering
            .map(|part| (reflected + part * through).min(1.0))
    }

    /// Returns the approximate fractions of light that the interface reflects, and that the base scatters in its
    /// brightest lane.
    #[inline]
    fn shares(&self, seen: Seen) -> [f32; 2] {
        [seen.reflected, self.entering.max_lane() * seen.through]
    }

    /// Returns the probability of drawing from the interface. It depends only on |cosθ|, so that a mirrored direction
    /// has the same.
    #[inline]
    fn coat_prob(&self, seen: Seen) -> f32 {
        let [coat, base] = self.shares(seen);
        if coat > 0.0 {
            coat / (coat + base)
        } else {
            0.0
        }
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfValue {
        if !same_hemisphere(wo, wi) {
            return BsdfValue::NONE;
        }
        let seen = self.coat.interfaces([wo, wi]);
        let mut within = self.base * self.coat.attenuation(wo, wi);
        if !self.thrown.is_black() {
            let shapes = self.shape.at_both([wo, wi].map(|w| w.z.abs()));
            within += self.thrown * (INV_PI * shapes[0].max(0.0) * shapes[1].max(0.0));
        }
        let (coat, densities) = self.coat.eval(wo, wi);
        let pdf = |from: usize, to: Vec3| {
            let prob = self.coat_prob(seen[from]);
            let base = warp::cosine_hemisphere_pdf(to.z.abs());
            prob * densities[from] + (1.0 - prob) * base
        };
        let [reflected, entered] = self.shares(seen[1]);
        BsdfValue {
            f: Spectrum::splat(coat) + within * (seen[0].through * seen[1].through),
            pdf: pdf(0, wi),
            pdf_reverse: pdf(1, wo),
            albedo_reverse: (reflected + entered).min(1.0),
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let seen = self.coat.interface(wo);
        let prob = self.coat_prob(seen);
        let wi = if u_lobe >= prob {
            if self.is_black_within() {
                return None;
            }
            let wi = warp::cosine_hemisphere(u);
            Vec3::new(wi.x, wi.y, wi.z.copysign(wo.z))
        } else if self.coat.is_smooth() {
            let reflectance = Spectrum::splat(seen.reflected);
            return Some(BsdfSample::mirror(wo, reflectance, prob, self.albedo(wo)));
        } else {
            self.coat.sample(wo, u)?
        };
        BsdfSample::of_value(wi, &self.eval(wo, wi))
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let coated = |eta, [x, y]: [f32; 2], thickness, albedo: [f32; 4]| {
            let ggx = Ggx::new(x, y);
            let layer = Layer::new(eta, ggx.mean_alpha());
            let tables = Slab::new(&layer, thickness, 0.3).tables(&layer, &albedo);
            let filled: [Filled; 4] = std::array::from_fn(|i| tables[i]);
            let mean = Filled::mean(filled.into_iter());
            let reflectance = Spectrum([0.9, 0.5, 0.05, 1.0]);
            Self::new(&layer, ggx, &filled, &mean, reflectance)
        };
        let clear = [0.0; 4];
        [
            ("coated diffuse smooth", coated(1.5, [0.0; 2], 0.01, clear)),
            ("coated diffuse, thick", coated(1.3, [0.0; 2], 0.7, clear)),
            ("coated diffuse sharp", coated(1.5, [0.1; 2], 0.01, clear)),
            ("coated diffuse rough", coated(1.5, [0.4; 2], 0.3, [0.8; 4])),
            (
                "coated diffuse, coloured haze",
                coated(1.5, [0.0; 2], 1.0, [0.2, 0.9, 1.0, 0.0]),
            ),
            (
                "coated diffuse anisotropic",
                coated(1.8, [0.5, 0.2], 0.0, clear),
            ),
        ]
        .into_iter()
    }
}
