//! Lights at infinity: an environment of radiance by direction, and parallel rays.
//!
//! Directions have the density p(square) / 4π (solid angle, 1/sr), in proportion to the texels'
//! luminance; a ray then crosses the disk of radius r around the scene evenly, 1/(πr²) (1/m²).
//! Texels are not interpolated.

use super::{EmissionSample, LightContext, LightPoint, LightSample};
use crate::math::{
    Distribution2d, Frame, Mat3, PI, Vec2, Vec3, direction_to_square, sqr, square_to_direction,
    warp,
};
use crate::spectrum::{Illuminant, Lanes, Spectrum, luminance};
use crate::texture::Image;

/// Returns the density of the point at which a ray from infinity crosses the disk around the scene, which is
/// perpendicular to the ray. Measure: area, 1/m².
#[inline]
pub(super) fn pdf_disk(context: &LightContext<'_>) -> f32 {
    1.0 / (PI * sqr(context.radius))
}

/// Returns a ray from the light at infinity through a uniformly drawn point of the disk around the scene.
#[inline]
fn ray_from_infinity(
    context: &LightContext<'_>,
    from: LightSample,
    emitted: Spectrum,
    u: Vec2,
) -> EmissionSample {
    let to_light = from.at.locus.point;
    let disk = warp::concentric_disk(u);
    let across = Frame::from_z(to_light).to_world(disk.extend(1.0));
    EmissionSample {
        from,
        origin: context.centre + across * context.radius,
        direction: -to_light,
        pdf_direction: pdf_disk(context),
        emitted_cos: emitted,
    }
}

/// Parallel rays from one direction.
#[derive(Clone, Debug)]
pub struct DistantLight {
    /// The unit direction towards the light.
    pub to_light: Vec3,
    /// Irradiance on a surface that faces it. Unit: W/m².
    pub irradiance: Illuminant,
}

impl DistantLight {
    pub(super) fn power(&self, context: &LightContext<'_>) -> f32 {
        PI * sqr(context.radius) * self.irradiance.luminance()
    }

    #[inline]
    pub(super) fn at(&self) -> LightSample {
        LightSample::new(LightPoint::at_infinity(self.to_light), 1.0)
    }

    #[inline]
    pub(super) fn sample_emission(
        &self,
        context: &LightContext<'_>,
        u: Vec2,
        lanes: Lanes,
    ) -> EmissionSample {
        ray_from_infinity(context, self.at(), lanes.light(&self.irradiance), u)
    }
}

/// Radiance by direction.
#[derive(Clone, Debug)]
pub enum Radiance {
    /// The same radiance from all directions.
    Constant(Illuminant),
    /// An equal-area octahedral image ([`square_to_direction`]), with z up in its own space; each
    /// texel is one value. `distribution` is over its texels' luminance.
    Image {
        /// The texels.
        image: Image<3>,
        /// The choice of a texel.
        distribution: Distribution2d,
    },
}

/// An environment around the scene.
#[derive(Clone, Debug)]
pub struct InfiniteLight {
    radiance: Radiance,
    scale: f32,
    world_from_light: Mat3,
}

impl InfiniteLight {
    /// Makes a sky of constant radiance.
    pub fn constant(radiance: impl Into<Illuminant>) -> Self {
        let radiance = Radiance::Constant(radiance.into());
        Self {
            radiance,
            scale: 1.0,
            world_from_light: Mat3::IDENTITY,
        }
    }

    /// Makes an environment of `scale` times an equal-area octahedral image of finite, non-negative texels, turned by
    /// the rotation `world_from_light`.
    pub fn image(image: Image<3>, scale: f32, world_from_light: Mat3) -> Self {
        let weights: Vec<f32> = image
            .texels()
            .iter()
            .map(|&texel| luminance(texel))
            .collect();
        let distribution = Distribution2d::new(&weights, image.width());
        Self {
            radiance: Radiance::Image {
                image,
                distribution,
            },
            scale,
            world_from_light,
        }
    }

    pub(super) fn power(&self, context: &LightContext<'_>) -> f32 {
        let mean = match &self.radiance {
            Radiance::Constant(radiance) => radiance.luminance(),
            Radiance::Image { distribution, .. } => distribution.mean() as f32 * self.scale,
        };
        4.0 * PI * mean * PI * sqr(context.radius)
    }

    /// Returns the radiance from the unit direction `to_light`.
    #[inline]
    pub(super) fn radiance(&self, to_light: Vec3, lanes: Lanes) -> Spectrum {
        match &self.radiance {
            Radiance::Constant(radiance) => lanes.light(radiance),
            Radiance::Image { image, .. } => {
                let p = self.square(to_light);
                let x = ((p.x * image.width() as f32) as usize).min(image.width() - 1);
                let y = ((p.y * image.height() as f32) as usize).min(image.height() - 1);
                lanes.illuminant(image.texel(x, y)) * self.scale
            }
        }
    }

    #[inline]
    fn square(&self, to_light: Vec3) -> Vec2 {
        let local = self.world_from_light.transpose() * to_light;
        direction_to_square(local).clamp(Vec2::ZERO, Vec2::ONE)
    }

    /// Returns the density of the direction `to_light`. Measure: solid angle, 1/sr.
    #[inline]
    pub(super) fn pdf(&self, to_light: Vec3) -> f32 {
        match &self.radiance {
            Radiance::Constant(_) => 1.0 / (4.0 * PI),
            Radiance::Image { distribution, .. } => {
                distribution.pdf(self.square(to_light)) / (4.0 * PI)
            }
        }
    }

    #[inline]
    pub(super) fn sample(&self, u: Vec2) -> Option<LightSample> {
        let (to_light, pdf) = match &self.radiance {
            Radiance::Constant(_) => (warp::uniform_sphere(u), 1.0 / (4.0 * PI)),
            Radiance::Image { distribution, .. } => {
                let (p, _) = distribution.sample(u);
                let to_light = self.world_from_light * square_to_direction(p);
                // Looked up again: rounding may have moved the direction to the next texel.
                (to_light, self.pdf(to_light))
            }
        };
        (pdf > 0.0).then(|| LightSample::new(LightPoint::at_infinity(to_light), pdf))
    }

    #[inline]
    pub(super) fn sample_emission(
        &self,
        context: &LightContext<'_>,
        u_position: Vec2,
        u_direction: Vec2,
        lanes: Lanes,
    ) -> Option<EmissionSample> {
        let from = self.sample(u_position)?;
        let emitted = self.radiance(from.at.locus.point, lanes);
        Some(ray_from_infinity(context, from, emitted, u_direction))
    }
}
