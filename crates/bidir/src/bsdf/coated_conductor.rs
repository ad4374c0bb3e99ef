//! A dielectric layer over metal: lacquer, anodised or wet metal.
//!
//! f = F D G₂ / (4 |cosθ_o cosθ_i|) + T(wo) T(wi) A(wo) A(wi) (f_m(wo', wi') / η² + M) [1/sr], with f_m the metal's
//! own reflection, for an index relative to the layer's and between the directions refracted by a smooth interface. A
//! rough interface, which scatters what it refracts, broadens the facets of f_m: variances of slopes add [Belcour18,
//! §4]. T and A are fitted so that as much light leaves as in random walks between both surfaces, and f_m is a little
//! brighter, because light meets facets more steeply than in its closed form.
//!
//! M is the light that the metal reflects more than once, with reflections at the interface in between. It is E(wo)
//! E(wi) / (π Ē) · Σ_k m_k F̄^k, k ≥ 2, as if it had lost its direction \[Kulla17\]. E, the fraction that white metal
//! reflects so, and m_k, the share of k reflections, are tabulated by random walks ([`Reflections`]). If both
//! surfaces are smooth, there is one mirrored direction, and the sum over all reflections is exact.
//!
//! Light that the layer scatters (ϖ > 0) continues as if it had not been scattered.

use super::coat::{
    Coat, Curve, Layer, METAL_SHAPES, MetalCoat, Reflections, Seen, all_orders, seen_through,
};
use super::microfacet::Ggx;
use super::{BsdfSample, BsdfValue, InterlayerMedium, fresnel, same_hemisphere};
use crate::math::{INV_PI, Vec2, Vec3, sqr, warp};
use crate::spectrum::Spectrum;

/// A dielectric layer over metal; both sides of the surface look alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedConductor {
    coat: MetalCoat,
    /// The index and the facets of the metal. They are not a struct, whose padding would enlarge all vertices.
    eta: Spectrum,
    k: Spectrum,
    facets: Ggx,
    /// e.
    trapped: Curve<METAL_SHAPES>,
    /// Ē Σ_k m_k F̄^k.
    multiple: Spectrum,
    /// s of [`Reflections`]: how much more steeply than in the closed form light meets the metal in a single
    /// reflection.
    steepness: f32,
}

/// A metal under a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatedMetal {
    /// Real part of the index of refraction, relative to the layer's.
    pub eta: Spectrum,
    /// Imaginary part, likewise.
    pub k: Spectrum,
    /// The facets.
    pub ggx: Ggx,
}

impl CoatedMetal {
    #[inline]
    fn fresnel(&self, cos: f32) -> Spectrum {
        fresnel::conductor(cos, self.eta, self.k)
    }
}

/// A lobe: a way in which light leaves.
#[derive(Clone, Copy, PartialEq)]
enum Lobe {
    /// Off the interface.
    Coat,
    /// Off the metal, once.
    Once,
    /// Off the metal, more than once.
    Trapped,
}

/// The factors of f and of the lobes' shares that depend on only one direction.
struct MetalSeen {
    coat: Seen,
    /// The refracted direction within the layer. None: total reflection.
    inner: Option<Vec3>,
    /// (1-μ)⁵.
    grazing: f32,
    /// E / Ē.
    trapped: f32,
}

impl CoatedConductor {
    /// Makes `metal` under an interface of `ggx`, with the tables of the two surfaces.
    pub fn new(
        layer: &Layer,
        reflections: &Reflections,
        ggx: Ggx,
        medium: &InterlayerMedium,
        metal: CoatedMetal,
    ) -> Self {
        let absorption = medium.absorption();
        let coat = Coat::new(
            layer,
            ggx,
            reflections.ratio,
            absorption,
            reflections.length,
        );
        let metal = CoatedMetal {
            ggx: seen_through(metal.ggx, ggx, coat.eta()),
            ..metal
        };
        let [cosine, deviation] = reflections.cosine;
        let steep = metal.fresnel((cosine - deviation).max(0.0));
        let average = (steep + metal.fresnel((cosine + deviation).min(1.0))) * 0.5;
        let trip = absorption.map(|depth| libm::expf(-depth * reflections.path));
        let multiple = average.zip(trip, |average, trip| {
            reflections.mean * reflections.remaining(average, trip)
        });
        Self {
            coat,
            eta: metal.eta,
            k: metal.k,
            facets: metal.ggx,
            trapped: reflections.shape,
            multiple,
            steepness: reflections.steepness,
        }
    }

    #[inline]
    pub(super) fn is_delta(&self) -> bool {
        self.facets.is_smooth()
    }

    /// Returns the reflectance along the mirrored direction if all is smooth: F + T² a F_m / (1 - F a F_m), with a
    /// the fraction that the layer does not absorb in one trip.
    #[inline]
    fn mirror_reflectance(&self, wo: Vec3) -> Spectrum {
        let reflected = self.coat.reflectance(wo);
        let Some(inner) = self.coat.refracted(wo) else {
            return Spectrum::ONE;
        };
        let trip = self.fresnel(inner.z.abs()) * self.coat.attenuation(wo, wo);
        trip.map(|trip| reflected + sqr(1.0 - reflected) * trip * all_orders(reflected * trip))
    }

    /// Returns the factors of the direction `w`.
    #[inline]
    fn seen(&self, w: Vec3) -> MetalSeen {
        let [seen, _] = self.seen_from([w; 2]);
        seen
    }

    /// Returns the factors of each of two directions.
    #[inline]
    fn seen_from(&self, w: [Vec3; 2]) -> [MetalSeen; 2] {
        let coats = self.coat.interfaces(w);
        let trapped = self.trapped.at_both(w.map(|w| w.z.abs()));
        [0, 1].map(|i| MetalSeen {
            coat: coats[i],
            inner: self.coat.refracted(w[i]),
            grazing: fresnel::schlick(w[i].z.abs()),
            trapped: (1.0 - coats[i].reflected) * trapped[i].max(0.0),
        })
    }

    /// Returns the approximate albedo of each lobe. It depends only on |cosθ|.
    #[inline]
    fn shares(&self, seen: &MetalSeen) -> [Spectrum; 3] {
        let coat = Spectrum::splat(seen.coat.reflected);
        let Some(inner) = seen.inner else {
            return [coat, Spectrum::ZERO, Spectrum::ZERO];
        };
        let once = self.once_fresnel(inner.z.abs(), seen.grazing) * sqr(seen.coat.through);
        [coat, once, self.multiple * seen.trapped]
    }

    /// Returns the reflectance of the metal's facets.
    #[inline]
    fn fresnel(&self, cos: f32) -> Spectrum {
        fresnel::conductor(cos, self.eta, self.k)
    }

    /// Returns the metal's reflectance of light reflected once, at a facet of cosine `cos`; `grazing` is the mean
    /// (1-μ)⁵ of both directions.
    #[inline]
    fn once_fresnel(&self, cos: f32, grazing: f32) -> Spectrum {
        let more = self.steepness * grazing;
        let fresnel = self.fresnel(cos);
        fresnel.map(|part| part + (1.0 - part) * more)
    }

    /// Returns the probabilities of drawing from each lobe. All are zero where nothing is scattered.
    #[inline]
    fn probs(shares: &[Spectrum; 3]) -> [f32; 3] {
        let shares = shares.map(Spectrum::max_lane);
        let sum = shares[0] + shares[1] + shares[2];
        shares.map(|share| if sum > 0.0 { share / sum } else { 0.0 })
    }

    /// Returns the albedo: the sum of the shares, at most 1.
    #[inline]
    fn albedo_of([coat, once, trapped]: &[Spectrum; 3]) -> Spectrum {
        (*coat + *once + *trapped).map(|lane| lane.min(1.0))
    }

    #[inline]
    pub(super) fn albedo(&self, wo: Vec3) -> Spectrum {
        if self.is_delta() {
            return self.mirror_reflectance(wo);
        }
        Self::albedo_of(&self.shares(&self.seen(wo)))
    }

    #[inline]
    pub(super) fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfValue {
        if self.is_delta() || !same_hemisphere(wo, wi) {
            return BsdfValue::NONE;
        }
        let seen = self.seen_from([wo, wi]);
        let shares = seen.each_ref().map(|seen| self.shares(seen));
        let (coat, of_coat) = self.coat.eval(wo, wi);
        let (metal, of_once) = self.eval_metal([wo, wi], &seen);
        let pdf = |from: usize, to: Vec3| {
            let [coat, once, trapped] = Self::probs(&shares[from]);
            let even = warp::cosine_hemisphere_pdf(to.z.abs());
            coat * of_coat[from] + once * of_once[from] + trapped * even
        };
        BsdfValue {
            f: Spectrum::splat(coat) + metal,
            pdf: pdf(0, wi),
            pdf_reverse: pdf(1, wo),
            albedo_reverse: Self::albedo_of(&shares[1]).max_lane(),
        }
    }

    /// Returns f of the metal under the interface, and the densities of drawing either direction by one reflection at
    /// the metal: the density of the direction within the layer, times dω'/dω = |cosθ| / (η² |cosθ'|).
    #[inline]
    fn eval_metal(
        &self,
        [wo, wi]: [Vec3; 2],
        [seen_o, seen_i]: &[MetalSeen; 2],
    ) -> (Spectrum, [f32; 2]) {
        let (Some(inner_o), Some(inner_i)) = (seen_o.inner, seen_i.inner) else {
            return (Spectrum::ZERO, [0.0; 2]);
        };
        let mirror = self.facets.mirror(inner_o, inner_i);
        let bend = 1.0 / sqr(self.coat.eta());
        let through = seen_o.coat.through * seen_i.coat.through;
        let grazing = (seen_o.grazing + seen_i.grazing) * 0.5;
        let once = self.once_fresnel(mirror.cos, grazing) * (mirror.facets * through * bend);
        let trapped = self.multiple * (seen_o.trapped * seen_i.trapped * INV_PI);
        let f = (once + trapped) * self.coat.attenuation(wo, wi);
        let [pdf, pdf_reverse] = mirror.densities;
        let stretch = |w: Vec3, inner: Vec3| bend * (w.z / inner.z).abs();
        let densities = [
            pdf * stretch(wi, inner_i),
            pdf_reverse * stretch(wo, inner_o),
        ];
        (f, densities)
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        if self.is_delta() {
            let reflectance = self.mirror_reflectance(wo);
            return Some(BsdfSample::mirror(wo, reflectance, 1.0, reflectance));
        }
        let seen = self.seen(wo);
        let shares = self.shares(&seen);
        let [coat, once, _] = Self::probs(&shares);
        let lobe = match u_lobe {
            u if u < coat => Lobe::Coat,
            u if u < coat + once => Lobe::Once,
            _ => Lobe::Trapped,
        };
        if lobe == Lobe::Coat && self.coat.is_smooth() {
            let reflectance = Spectrum::splat(seen.coat.reflected);
            let albedo = Self::albedo_of(&shares);
            return Some(BsdfSample::mirror(wo, reflectance, coat, albedo));
        }
        let wi = self.sample_lobe(lobe, wo, u)?;
        BsdfSample::of_value(wi, &self.eval(wo, wi))
    }

    /// Draws a direction from a lobe that is not a Dirac distribution. None: the light does not leave.
    #[inline]
    fn sample_lobe(&self, lobe: Lobe, wo: Vec3, u: Vec2) -> Option<Vec3> {
        match lobe {
            Lobe::Coat => self.coat.sample(wo, u),
            Lobe::Once => {
                let inner = self.coat.refracted(wo)?;
                self.coat.emerging(self.facets.sample_mirror(inner, u)?)
            }
            Lobe::Trapped => {
                let wi = warp::cosine_hemisphere(u);
                Some(Vec3::new(wi.x, wi.y, wi.z.copysign(wo.z)))
            }
        }
    }

    pub(super) fn examples() -> impl Iterator<Item = (&'static str, Self)> {
        let coated = |eta, coat: f32, metal: [f32; 2], thickness| {
            let (ggx, facets) = (Ggx::new(coat, coat), Ggx::new(metal[0], metal[1]));
            let (layer, alpha) = (Layer::new(eta, coat), facets.mean_alpha());
            let reflections = Reflections::new(&layer, alpha, thickness);
            let medium = InterlayerMedium {
                thickness,
                albedo: Spectrum::splat(0.0),
                g: 0.0,
            };
            let metal = CoatedMetal {
                eta: Spectrum([0.14, 0.64, 0.78, 0.78]),
                k: Spectrum([2.4, 1.7, 1.6, 1.6]),
                ggx: facets,
            };
            Self::new(&layer, &reflections, ggx, &medium, metal)
        };
        [
            ("coated conductor smooth", coated(1.5, 0.0, [0.0; 2], 0.01)),
            (
                "coated conductor under smooth coat",
                coated(1.5, 0.0, [0.3; 2], 0.01),
            ),
            (
                "coated conductor under rough coat",
                coated(1.5, 0.3, [0.0; 2], 0.2),
            ),
            ("coated conductor rough", coated(1.3, 0.4, [0.6; 2], 0.01)),
            (
                "coated conductor anisotropic",
                coated(1.5, 0.0, [0.5, 0.15], 0.0),
            ),
        ]
        .into_iter()
    }
}
