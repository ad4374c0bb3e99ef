//! The space of a scene's numbers: world = `origin` + `unit` · p.
//!
//! Points are `f32`, whose steps grow with the distance from the origin, and squares of distances overflow long
//! before the distances do. Hence a reader places a scene that is far from the world's origin, or very large or
//! small, in a space without these problems: by a translation and a scale, so that directions do not change. Pixels
//! do not depend on the space. Points and lengths for users are converted here.

use crate::math::{DAffine3, DVec3, Vec3};

/// A space with the axes of the world, another origin, and another unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSpace {
    /// Its origin. Space: world.
    pub origin: DVec3,
    /// Its unit of length, in units of the world. Positive; a power of two keeps the digits of coordinates.
    pub unit: f64,
}

impl Default for RenderSpace {
    fn default() -> Self {
        Self::WORLD
    }
}

impl RenderSpace {
    /// The world itself.
    pub const WORLD: Self = Self {
        origin: DVec3::ZERO,
        unit: 1.0,
    };

    /// Returns the map from the world to this space.
    pub fn from_world(&self) -> DAffine3 {
        let scale = DVec3::splat(1.0 / self.unit);
        DAffine3::from_scale(scale) * DAffine3::from_translation(-self.origin)
    }

    /// Returns the point `p` of this space in the world.
    #[inline]
    pub fn world_point(&self, p: Vec3) -> DVec3 {
        self.origin + self.unit * p.as_dvec3()
    }

    /// Returns a length of this space in the world's unit.
    #[inline]
    pub fn world_length(&self, length: f32) -> f32 {
        (self.unit * f64::from(length)) as f32
    }

    /// Returns a radiant intensity of the world in this space: the irradiance I / d² does not change.
    pub fn intensity(&self, intensity: f32) -> f32 {
        (f64::from(intensity) / (self.unit * self.unit)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_return_to_the_world() {
        let space = RenderSpace {
            origin: DVec3::new(1e7, -3.0, 0.5),
            unit: 0.25,
        };
        let world = DVec3::new(1e7 + 2.0, -4.0, 0.75);
        let p = space.from_world().transform_point3(world);
        assert_eq!(p, DVec3::new(8.0, -4.0, 1.0));
        assert_eq!(space.world_point(p.as_vec3()), world);
        assert!((space.world_length(8.0) - 2.0).abs() < 1e-6);
        let irradiance = space.intensity(1.0) / (8.0 * 8.0);
        assert!((irradiance - 1.0 / (2.0 * 2.0)).abs() < 1e-6);
    }
}
