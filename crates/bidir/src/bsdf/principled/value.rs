//! The value of the scattering: the sum of all lobes that are no Dirac distributions.

use super::{Principled, Side, Wall, coat_fresnel, mirrored_below, sheen};
use crate::bsdf::{TransportMode, same_hemisphere};
use crate::math::Vec3;
use crate::spectrum::Spectrum;

impl Principled {
    #[inline]
    pub(in crate::bsdf) fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        if wo.z == 0.0 || wi.z == 0.0 {
            return Spectrum::ZERO;
        }
        let (wo, wi) = (self.along_grain(wo), self.along_grain(wi));
        if same_hemisphere(wo, wi) {
            self.eval_reflection(wo, wi)
        } else {
            self.eval_transmission(wo, wi, mode)
        }
    }

    #[inline]
    fn eval_reflection(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        let mut base = Spectrum::ZERO;
        if !self.ggx.is_smooth() {
            let (facets, cos) = self.ggx.mirror(wo, wi);
            let (reflected, _) = self.facet(cos.abs().copysign(wo.z));
            base += reflected * facets;
        }
        if self.diffuse > 0.0 {
            base += self.tint * (self.diffuse * self.uncovered(wo) * self.uncovered(wi));
        }
        base *= Spectrum::splat(self.layers(wo) * self.layers(wi));
        if self.is_bare(wo) {
            return base;
        }
        let under_coat = (1.0 - self.coat_albedo(wo)) * (1.0 - self.coat_albedo(wi));
        if !self.sheen.is_black() {
            base += self.sheen * (sheen::eval(wo, wi, self.sheen_alpha) * under_coat);
        }
        base + Spectrum::splat(self.eval_coat(wo, wi))
    }

    #[inline]
    fn eval_coat(&self, wo: Vec3, wi: Vec3) -> f32 {
        let ggx = self.coat_ggx();
        if self.coat <= 0.0 || ggx.is_smooth() {
            return 0.0;
        }
        let (facets, cos) = ggx.mirror(wo, wi);
        self.coat * facets * coat_fresnel(cos.abs())
    }

    #[inline]
    fn eval_transmission(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        let mut f = Spectrum::ZERO;
        if !self.through.is_black() {
            f += self.through * (self.uncovered(wo) * self.uncovered(wi));
        }
        if self.glass > 0.0 && !self.ggx.is_smooth() {
            f += match self.wall {
                Wall::Solid => self.eval_refraction(wo, wi, mode),
                Wall::Thin => {
                    let (facets, cos) = self.ggx.mirror(wo, mirrored_below(wi));
                    self.facet(cos).1 * facets
                }
            };
        }
        f * (self.layers(wo) * self.layers(wi))
    }

    #[inline]
    fn eval_refraction(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Spectrum {
        let interface = self.interface();
        let Some((m, Side::Transmission)) = interface.facet(wo, wi) else {
            return Spectrum::ZERO;
        };
        let facets = self.ggx.d(m) * self.ggx.g2(wo, wi) / (wo.z * wi.z).abs();
        let bend = (wo.dot(m) * wi.dot(m)).abs() * interface.refraction_jacobian(wo, wi, m);
        self.facet(wo.dot(m)).1 * (facets * bend * interface.crossing_scale(wo, mode))
    }
}
