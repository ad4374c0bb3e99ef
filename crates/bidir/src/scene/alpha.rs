//! α, the coverage of a surface. Rays pass it with probability 1 - α, as if it did not exist; a surface that a ray
//! passes is not a vertex, and is in no density.
//!
//! A walk decides at random whether it hits a surface. Each surface has a random number of its own, so that the order
//! in which the intersector finds surfaces does not matter. The throughput needs no factor: the probability α of a
//! vertex, or 1 - α of passing, is the factor of the integrand. A shadow ray does not decide: it returns the
//! transmittance Π (1 - α) exactly.
//!
//! The light of a point that a light draws on such a surface has the factor α
//! ([`LightSample::alpha`](crate::light::LightSample::alpha)); a walk that hits the light has decided before.
//! Textures of α are not filtered: they are the same for all rays.

use super::{Opacity, Scene};
use crate::math::Vec2;
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::texture::{TexturePoint, clamped_alpha};
use accel::{Hit, Stop};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// The random numbers that decide which surfaces a ray of a walk passes, and how far it gets in media.
#[derive(Clone, Copy)]
pub struct RayDraws<'a> {
    stream: &'a SampleStream,
    dimension: Dimension,
    pub(super) stop: Stop<'a>,
}

impl<'a> RayDraws<'a> {
    /// Makes the draws of the ray that finds vertex number `vertex` of a subpath.
    #[inline]
    pub fn new(stream: &'a SampleStream, vertex: usize) -> Self {
        Self {
            stream,
            dimension: Dimension::at(vertex, Purpose::Alpha),
            stop: Stop::NEVER,
        }
    }

    /// Lets the ray end anywhere as soon as `stop` is asked for.
    #[inline]
    pub(crate) fn until(self, stop: Stop<'a>) -> Self {
        Self { stop, ..self }
    }

    /// Returns the random numbers of the lane and of the optical depth by which a ray stops in media.
    #[inline]
    pub(super) fn flight(&self) -> [f32; 2] {
        let dimension = self.dimension.with_purpose(Purpose::Flight);
        self.stream.get_2d(dimension).to_array()
    }

    /// Returns the random number that decides whether the ray passes `hit`. A ray that hits a primitive twice decides
    /// twice.
    #[inline]
    fn draw(&self, hit: &Hit) -> f32 {
        let surface = u64::from(hit.instance) << 32 | u64::from(hit.primitive);
        // The factor is odd, so that different distances remain different keys of one surface.
        let distance = u64::from(hit.t.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.stream.get_for(self.dimension, surface ^ distance)
    }
}

impl Scene {
    /// Returns α at a hit: 1 if the surface is opaque, or if its texture is NaN.
    #[inline]
    pub(super) fn alpha(&self, ray: &accel::Ray, hit: &Hit) -> f32 {
        let (_, primitive) = self.resolve(hit);
        let (number, index) = (primitive.shape as usize, primitive.index as usize);
        let texture = match self.surfaces[number].opacity {
            Opacity::Opaque => return 1.0,
            Opacity::Texture(texture) => &self.alphas[texture as usize],
            Opacity::Boundary | Opacity::Invisible => return 0.0,
        };
        let (shape, uv) = (&self.shapes[number], Vec2::new(hit.u, hit.v));
        // Most textures need only the parameters, not the rest of the surface.
        let at = if texture.needs().surface {
            TexturePoint::new(&self.surface_at(ray, hit))
        } else {
            TexturePoint::of_parameters(shape.uv(index, uv))
        };
        clamped_alpha(texture.eval(&at))
    }

    /// Returns the nearest surface that a ray of a walk does not pass. Calls `cross` for surfaces that it passes;
    /// some may be behind that surface.
    #[inline]
    pub(super) fn closest(
        &self,
        ray: &accel::Ray,
        draws: RayDraws<'_>,
        cross: impl Fn(&Hit),
    ) -> Option<Hit> {
        let (bvh, stop) = (self.bvh.until(draws.stop), draws.stop);
        if self.is_opaque {
            return bvh.closest(ray, accel::accept_all);
        }
        bvh.closest(ray, |hit| {
            if stop.is_asked() {
                return true;
            }
            let stops = self.stops(ray, hit, draws);
            if !stops {
                cross(hit);
            }
            stops
        })
    }

    /// Returns true if a surface stops a ray of a walk.
    #[inline]
    pub(super) fn stops(&self, ray: &accel::Ray, hit: &Hit, draws: RayDraws<'_>) -> bool {
        let alpha = self.alpha(ray, hit);
        alpha >= 1.0 || alpha > 0.0 && draws.draw(hit) < alpha
    }

    /// Returns Π (1 - α) over the surfaces that a shadow ray hits, except those of nested volumes. Calls `cross` for
    /// surfaces that it passes: for all of them, if the product is not 0. The result is arbitrary once `stop` is
    /// asked for.
    #[inline]
    pub(super) fn visible_part(
        &self,
        ray: &accel::Ray,
        stop: Stop<'_>,
        mut cross: impl FnMut(&Hit),
    ) -> f32 {
        let bvh = self.bvh.until(stop);
        if self.is_opaque {
            return f32::from(!bvh.is_blocked(ray));
        }
        let mut factors = Factors::default();
        let flow = bvh.each_hit(ray, |hit| match self.alpha(ray, hit) {
            _ if stop.is_asked() => ControlFlow::Break(()),
            _ if self.is_of_nested(hit) => ControlFlow::Continue(()),
            alpha if alpha >= 1.0 => ControlFlow::Break(()),
            alpha => {
                cross(hit);
                if alpha > 0.0 {
                    factors.push(1.0 - alpha);
                }
                ControlFlow::Continue(())
            }
        });
        if flow.is_break() {
            0.0
        } else {
            factors.product()
        }
    }
}

/// Factors that are added in any order, with a product that does not depend on it.
#[derive(Default)]
struct Factors(SmallVec<[f32; 32]>);

impl Factors {
    #[inline]
    fn push(&mut self, factor: f32) {
        self.0.push(factor);
    }

    /// Returns the product in ascending order, rounded once.
    fn product(mut self) -> f32 {
        self.0.sort_unstable_by(f32::total_cmp);
        let product: f64 = self.0.iter().map(|&factor| f64::from(factor)).product();
        product as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::{Domain, Sampler, SamplerKind};
    use crate::testing::prelude::*;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    #[test]
    fn products_do_not_depend_on_order() {
        for count in [0_u8, 1, 5, 32, 33, 100] {
            let number = |i| (1.0 + f32::from(i)) / (1.7 + f32::from(i));
            let numbers: Vec<f32> = (0..count).map(number).collect();
            let product = |order: &mut dyn Iterator<Item = &f32>| {
                let mut factors = Factors::default();
                order.for_each(|&factor| factors.push(factor));
                factors.product()
            };
            let forwards = product(&mut numbers.iter());
            let backwards = product(&mut numbers.iter().rev());
            assert_eq!(forwards.to_bits(), backwards.to_bits());
            let expected: f64 = numbers.iter().map(|&x| f64::from(x)).product();
            check_close(forwards, expected, 1e-6, count);
        }
    }

    /// Of a hundred veils in the way of a ray, those are passed that it comes to before somebody asks to stop.
    #[test]
    fn stopped_rays_look_at_no_more_surfaces() {
        let mut builder = builder(1, 0.0);
        for _ in 0..100 {
            let veil = builder.add(sphere(Vec3::ZERO, 1.0), diffuse([0.5; 3]));
            builder.alpha(veil, FloatTexture::Constant(1e-3));
        }
        let scene = builder.build().scene;
        let ray = accel::Ray::new(Vec3::ZERO, Vec3::Z);
        let stream = Sampler::new(SamplerKind::Independent, 1).stream(Domain::Camera, 0, 0);
        for (stops, expected) in [(false, 100), (true, 1)] {
            let seen = [(); 2].map(|()| AtomicUsize::new(0));
            let flags = [(); 2].map(|()| AtomicBool::new(false));
            let cross = |i: usize| {
                seen[i].fetch_add(1, Ordering::Relaxed);
                flags[i].store(stops, Ordering::Relaxed);
            };
            scene.visible_part(&ray, Stop::when(&flags[0]), |_| cross(0));
            let draws = RayDraws::new(&stream, 1).until(Stop::when(&flags[1]));
            scene.closest(&ray, draws, |_| cross(1));
            assert_eq!(seen[0].load(Ordering::Relaxed), expected);
            let walked = seen[1].load(Ordering::Relaxed);
            assert!(if stops { walked == 1 } else { walked > 80 }, "{walked}");
        }
    }

    #[test]
    fn what_is_no_number_is_opaque() {
        let expected = [(f32::NAN, 1.0), (-1.0, 0.0), (0.25, 0.25), (7.0, 1.0)];
        for (alpha, clear) in expected {
            assert!((clamped_alpha(alpha) - clear).abs() <= 0.0, "{alpha}");
        }
    }
}
