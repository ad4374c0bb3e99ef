//! Lights without size: radiant intensity (W/sr) by direction from one point. Their position is a
//! Dirac distribution, its density counted 1; directions are drawn evenly over the sphere, 1/(4π),
//! or the cone, 1/(2π(1 - cosθ_end)), both 1/sr.

use super::{Cone, EmissionSample, EmitterBounds, LightPoint, LightSample};
use crate::math::{Frame, PI, Vec2, Vec3, sqr, warp};
use crate::spectrum::{Illuminant, Lanes, Spectrum};
use accel::Aabb;

/// A point that emits the same intensity in all directions.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Its position.
    pub position: Vec3,
    /// Radiant intensity. Unit: W/sr.
    pub intensity: Illuminant,
}

impl PointLight {
    /// The density of every direction. Measure: solid angle.
    pub(super) const PDF_DIRECTION: f32 = 1.0 / (4.0 * PI);

    pub(super) fn power(&self) -> f32 {
        4.0 * PI * self.intensity.luminance()
    }

    pub(super) fn bounds(&self) -> EmitterBounds {
        EmitterBounds {
            bounds: Aabb::around(&[self.position]),
            cone: Cone::EVERYWHERE,
            intensity: self.intensity.luminance(),
        }
    }

    /// Returns the point itself.
    #[inline]
    pub(super) fn at(&self) -> LightSample {
        LightSample::new(LightPoint::in_space(self.position), 1.0)
    }

    #[inline]
    pub(super) fn sample_emission(&self, u: Vec2, lanes: Lanes) -> EmissionSample {
        EmissionSample {
            from: self.at(),
            origin: self.position,
            direction: warp::uniform_sphere(u),
            pdf_direction: Self::PDF_DIRECTION,
            emitted_cos: lanes.light(&self.intensity),
        }
    }
}

/// A point that emits into a cone, with a soft rim.
///
/// Angles are stored as 1 - cosθ, which is precise for narrow cones.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// Its position.
    pub position: Vec3,
    axis: Frame,
    intensity: Illuminant,
    full_height: f32,
    end_height: f32,
    rim: Rim,
}

/// The falloff of intensity as a function of x, which is 1 at the end of the full cone and 0 at the rim, and linear
/// in the cosine between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Rim {
    /// x² (3 - 2x).
    SmoothStep,
    /// x², as glTF suggests.
    Squared,
}

impl Rim {
    #[inline]
    fn falloff(self, x: f32) -> f32 {
        match self {
            Self::SmoothStep => x * x * (3.0 - 2.0 * x),
            Self::Squared => x * x,
        }
    }

    /// Returns the mean of the falloff.
    fn mean(self) -> f32 {
        match self {
            Self::SmoothStep => 1.0 / 2.0,
            Self::Squared => 1.0 / 3.0,
        }
    }
}

impl SpotLight {
    /// Makes a spot along the unit vector `axis` with `intensity` (W/sr) within the half angle `full`,
    /// falling to nothing at the half angle `end`. Unit: radians.
    pub fn new(
        position: Vec3,
        axis: Vec3,
        intensity: impl Into<Illuminant>,
        [full, end]: [f32; 2],
    ) -> Self {
        let [full_height, end_height] = [full, end].map(|angle| 2.0 * sqr(libm::sinf(angle / 2.0)));
        Self {
            position,
            axis: Frame::from_z(axis),
            intensity: intensity.into(),
            full_height,
            end_height,
            rim: Rim::SmoothStep,
        }
    }

    /// Makes a spot with the rim of glTF's spots, whose intensity is the square of a number that is linear in the
    /// cosine.
    pub fn squared(
        position: Vec3,
        axis: Vec3,
        intensity: impl Into<Illuminant>,
        angles: [f32; 2],
    ) -> Self {
        Self {
            rim: Rim::Squared,
            ..Self::new(position, axis, intensity, angles)
        }
    }

    pub(super) fn power(&self) -> f32 {
        let rim = self.rim.mean() * (self.end_height - self.full_height);
        2.0 * PI * (self.full_height + rim) * self.intensity.luminance()
    }

    /// Returns bounds with the intensity of the full cone up to the end of the rim.
    pub(super) fn bounds(&self) -> EmitterBounds {
        let angle = |height: f32| 2.0 * libm::asinf((height / 2.0).sqrt().min(1.0));
        let [full, end] = [self.full_height, self.end_height].map(angle);
        EmitterBounds {
            bounds: Aabb::around(&[self.position]),
            cone: Cone {
                axis: self.axis.z,
                spread: full.min(end),
                opening: (end - full).max(0.0),
                is_mirrored: false,
            },
            intensity: self.intensity.luminance(),
        }
    }

    /// Returns 1 - cosθ of the unit direction `w`.
    #[inline]
    fn height(&self, w: Vec3) -> f32 {
        self.axis.z.distance_squared(w) / 2.0
    }

    /// Returns the intensity along the unit direction `w`.
    #[inline]
    pub(super) fn intensity(&self, w: Vec3, lanes: Lanes) -> Spectrum {
        let height = self.height(w);
        let falloff = if height <= self.full_height {
            1.0
        } else if height >= self.end_height {
            0.0
        } else {
            let x = (self.end_height - height) / (self.end_height - self.full_height);
            self.rim.falloff(x)
        };
        lanes.light(&self.intensity) * falloff
    }

    /// Returns the point itself.
    #[inline]
    pub(super) fn at(&self) -> LightSample {
        LightSample::new(LightPoint::in_space(self.position), 1.0)
    }

    #[inline]
    pub(super) fn sample_emission(&self, u: Vec2, lanes: Lanes) -> EmissionSample {
        let direction = self.axis.to_world(warp::uniform_cone(u, self.end_height));
        EmissionSample {
            from: self.at(),
            origin: self.position,
            direction,
            pdf_direction: self.pdf_cone(),
            emitted_cos: self.intensity(direction, lanes),
        }
    }

    #[inline]
    fn pdf_cone(&self) -> f32 {
        1.0 / (2.0 * PI * self.end_height)
    }

    #[inline]
    pub(super) fn pdf_direction(&self, w: Vec3) -> f32 {
        if self.height(w) <= self.end_height {
            self.pdf_cone()
        } else {
            0.0
        }
    }
}
