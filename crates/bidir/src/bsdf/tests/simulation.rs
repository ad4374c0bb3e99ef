//! Light in a dielectric layer over an opaque base, event by event: the reference for closed forms.
//!
//! It is position-free, in double precision, and shares nothing with the closed forms but the physics:
//! Fresnel's equations by Snell's law, GGX facets drawn as spherical caps \[Dupuy23\], height-correlated
//! masking, exponential free flights, and scattering by Henyey and Greenstein. At the interface nothing
//! is left to chance: the part that leaves is counted, and the rest goes on.

use crate::sampler::{Dimension, Purpose, SampleStream};
use glam::DVec3;
use std::f64::consts::TAU;

/// The events after which pbrt-v4's walk ends by default.
pub(super) const PBRT_EVENTS: usize = 10;
/// Events of a walk: roulette ends it long before.
const MOST: usize = 1000;

/// The base under the layer.
#[derive(Clone, Copy)]
pub(super) enum Base {
    /// Lambertian, of this reflectance.
    Diffuse(f64),
    /// A metal with facets of slope `alpha`; `eta` and `k` are relative to the layer.
    Metal { eta: f64, k: f64, alpha: f64 },
}

/// A layer over a base. All is grey.
#[derive(Clone, Copy)]
pub(super) struct Stack {
    /// Index of the layer, divided by that outside.
    pub(super) eta: f64,
    /// Slope of the facets of its interface.
    pub(super) alpha: f64,
    pub(super) thickness: f64,
    pub(super) albedo: f64,
    pub(super) g: f64,
    pub(super) base: Base,
}

/// The part of the light that one walk carries out of the layer.
#[derive(Clone, Copy, Default)]
pub(super) struct Leaving {
    /// All of it.
    pub(super) all: f64,
    /// After at most [`PBRT_EVENTS`] events.
    pub(super) early: f64,
}

/// An event in the layer.
pub(super) enum Met {
    /// Light, with its direction before, at a particle of the filling, which has absorbed its part.
    Particle(Light),
    /// The part that reaches the base.
    Base(f64),
    /// The part that leaves through the interface.
    Interface(f64),
}

/// A direction that light leaves an interface along, and the part that does.
pub(super) type Ray = (DVec3, f64);

impl Stack {
    /// One walk of light from `wo`.
    pub(super) fn walk(&self, wo: DVec3, stream: &SampleStream) -> Leaving {
        let mut leaving = Leaving::default();
        let (reflected, refracted) = self.interface(wo, self.eta, pair(stream, 0, Purpose::Lens));
        if let Some((_, part)) = reflected {
            leaving.all += part;
            leaving.early += part;
        }
        let mut state = refracted.map(|(w, part)| Light {
            w,
            part,
            height: self.thickness,
        });
        for event in 1..MOST {
            let Some((met, next)) = state.and_then(|light| self.event(light, stream, event)) else {
                break;
            };
            if let Met::Interface(out) = met {
                leaving.all += out;
                leaving.early += if event <= PBRT_EVENTS { out } else { 0.0 };
            }
            state = next;
        }
        leaving
    }

    /// Returns the next event of `light`, and what goes on. None: the light ended before.
    pub(super) fn event(
        &self,
        light: Light,
        stream: &SampleStream,
        event: usize,
    ) -> Option<(Met, Option<Light>)> {
        let light = light.roulette(stream.get_1d(Dimension::at(event, Purpose::Roulette)))?;
        let Light { w, part, height } = light;
        let u = pair(stream, event, Purpose::Lens);
        let way = if w.z > 0.0 {
            self.thickness - height
        } else {
            height
        };
        let mut part = part;
        if self.albedo > 0.0 {
            let [u_flight, _] = pair(stream, event, Purpose::Scatter);
            let flight = -libm::log(1.0 - u_flight) * w.z.abs();
            if flight < way {
                let (part, height) = (part * self.albedo, height + flight.copysign(w.z));
                let met = Light { w, part, height };
                let w = henyey_greenstein(w, self.g, u);
                return Some((Met::Particle(met), Some(Light { w, ..met })));
            }
        } else {
            part *= libm::exp(-way / w.z.abs());
        }
        let going_on = |w, share, height| Light {
            w,
            part: part * share,
            height,
        };
        if w.z < 0.0 {
            let reflected = self.base.reflect(-w, u);
            let next = reflected.map(|(w, reflectance)| going_on(w, reflectance, 0.0));
            return Some((Met::Base(part), next));
        }
        // From within, seen in the frame that is mirrored at a point.
        let (reflected, refracted) = self.interface(w, 1.0 / self.eta, u);
        let next = reflected.map(|(w, share)| going_on(-w, share, self.thickness));
        let leaving = refracted.map_or(0.0, |(_, share)| part * share);
        Some((Met::Interface(leaving), next))
    }

    /// Returns the rays that a facet sends light from `v` to, which is above it, with `eta` the index below
    /// relative to that above. None: the wrong side of the surface.
    pub(super) fn interface(&self, v: DVec3, eta: f64, u: [f64; 2]) -> (Option<Ray>, Option<Ray>) {
        let m = visible_facet(self.alpha, v, u);
        let cos = v.dot(m);
        let (reflectance, cos_t) = fresnel(cos, eta);
        let mirrored = m * (2.0 * cos) - v;
        let bent = m * (cos / eta - cos_t) - v / eta;
        let seen = |out: DVec3| unshadowed(self.alpha, v, out);
        let reflected = (mirrored.z > 0.0).then(|| (mirrored, reflectance * seen(mirrored)));
        let passes = reflectance < 1.0 && bent.z < 0.0;
        let refracted = passes.then(|| (bent.normalize(), (1.0 - reflectance) * seen(bent)));
        (reflected, refracted)
    }
}

impl Base {
    /// Returns the direction of light from `v`, and the part that goes there. None: it is lost.
    pub(super) fn reflect(self, v: DVec3, u: [f64; 2]) -> Option<Ray> {
        match self {
            Self::Diffuse(reflectance) => {
                let sin = u[0].sqrt();
                let (y, x) = libm::sincos(TAU * u[1]);
                let w = DVec3::new(sin * x, sin * y, (1.0 - u[0]).sqrt());
                Some((w, reflectance))
            }
            Self::Metal { eta, k, alpha } => {
                let m = visible_facet(alpha, v, u);
                let cos = v.dot(m);
                let mirrored = m * (2.0 * cos) - v;
                let part = metal_reflectance(cos, eta, k) * unshadowed(alpha, v, mirrored);
                (mirrored.z > 0.0).then_some((mirrored, part))
            }
        }
    }
}

/// Light within the layer, on its way along `w`.
#[derive(Clone, Copy)]
pub(super) struct Light {
    pub(super) w: DVec3,
    pub(super) part: f64,
    pub(super) height: f64,
}

impl Light {
    /// Goes on with half of the chance where little is left. None: it does not.
    pub(super) fn roulette(self, u: f32) -> Option<Self> {
        if self.part > 0.02 {
            return Some(self);
        }
        (u < 0.5).then_some(Self {
            part: 2.0 * self.part,
            ..self
        })
    }
}

pub(super) fn pair(stream: &SampleStream, event: usize, purpose: Purpose) -> [f64; 2] {
    let u = stream.get_2d(Dimension::at(event, purpose));
    [f64::from(u.x), f64::from(u.y)]
}

/// Returns the reflectance of a dielectric facet of relative index `eta`, and the cosine of the refracted
/// direction.
pub(super) fn fresnel(cos: f64, eta: f64) -> (f64, f64) {
    let sin2_t = (1.0 - cos * cos) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos - cos_t) / (eta * cos + cos_t);
    let perpendicular = (cos - eta * cos_t) / (cos + eta * cos_t);
    let sum = parallel * parallel + perpendicular * perpendicular;
    (sum / 2.0, cos_t)
}

/// Returns the reflectance of a facet of metal, by complex Snell's law: `cos_t` is a + ib there.
fn metal_reflectance(cos: f64, eta: f64, k: f64) -> f64 {
    // η cosθ_t = √(η² - sin²θ), in the quadrant of a wave that fades.
    let (re, im) = (eta * eta - k * k - (1.0 - cos * cos), 2.0 * eta * k);
    let modulus = (re * re + im * im).sqrt();
    let [a, b] = [modulus + re, modulus - re].map(|sum| (sum / 2.0).max(0.0).sqrt());
    let square = |z: [f64; 2]| z[0] * z[0] + z[1] * z[1];
    let ratio = |n, d| square(n) / square(d);
    let perpendicular = ratio([cos - a, b], [cos + a, b]);
    // η² cosθ against η cosθ_t.
    let (x, y) = ((eta * eta - k * k) * cos, 2.0 * eta * k * cos);
    let parallel = ratio([x - a, y - b], [x + a, y + b]);
    f64::midpoint(perpendicular, parallel)
}

/// Returns a facet that `v` sees, drawn as a spherical cap.
fn visible_facet(alpha: f64, v: DVec3, u: [f64; 2]) -> DVec3 {
    if alpha <= 0.0 {
        return DVec3::Z;
    }
    let stretch = DVec3::new(alpha, alpha, 1.0);
    let v = (v * stretch).normalize();
    let z = (1.0 - u[0]) * (1.0 + v.z) - v.z;
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let phi = TAU * u[1];
    let cap = DVec3::new(sin * libm::cos(phi), sin * libm::sin(phi), z);
    ((cap + v) * stretch).normalize()
}

/// Returns G₂(v, out) / G₁(v).
pub(super) fn unshadowed(alpha: f64, v: DVec3, out: DVec3) -> f64 {
    let lambda = |w: DVec3| {
        let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        ((1.0 + alpha * alpha * tan2).sqrt() - 1.0) / 2.0
    };
    (1.0 + lambda(v)) / (1.0 + lambda(v) + lambda(out))
}

/// Returns the density of scattering by an angle of this cosine. Unit: 1/sr.
pub(super) fn henyey_greenstein_value(cos: f64, g: f64) -> f64 {
    let base = 1.0 + g * g - 2.0 * g * cos;
    (1.0 - g * g) / (2.0 * TAU * base * base.sqrt())
}

/// Returns the direction after scattering of light along `w`.
pub(super) fn henyey_greenstein(w: DVec3, g: f64, u: [f64; 2]) -> DVec3 {
    let cos = if g.abs() < 1e-3 {
        1.0 - 2.0 * u[0]
    } else {
        let fraction = (1.0 - g * g) / (1.0 + g - 2.0 * g * u[0]);
        (1.0 + g * g - fraction * fraction) / (2.0 * g)
    };
    let (across, along) = w.any_orthonormal_pair();
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let phi = TAU * u[1];
    across * (sin * libm::cos(phi)) + along * (sin * libm::sin(phi)) + w * cos
}
