use super::{EmissionSample, LightPoint, LightSample};
use crate::math::{Frame, PI, Vec2, Vec3, warp};
use crate::spectrum::{Rgb, luminance};

/// A point that emits the same intensity in all directions.
#[derive(Clone, Copy, Debug)]
pub struct PointLight {
    /// Where it is.
    pub position: Vec3,
    /// Radiant intensity. Unit: W/sr.
    pub intensity: Rgb,
}

impl PointLight {
    /// The density of every direction. Measure: solid angle.
    pub(super) const PDF_DIRECTION: f32 = 1.0 / (4.0 * PI);

    pub(super) fn power(&self) -> f32 {
        4.0 * PI * luminance(self.intensity)
    }

    #[inline]
    pub(super) fn sample_emission(&self, u: Vec2) -> EmissionSample {
        EmissionSample {
            from: LightSample {
                at: LightPoint::in_space(self.position),
                pdf: 1.0,
            },
            origin: self.position,
            direction: warp::uniform_sphere(u),
            pdf_direction: Self::PDF_DIRECTION,
            emitted_cos: self.intensity,
        }
    }
}

/// A point that emits into a cone, with a soft rim.
#[derive(Clone, Copy, Debug)]
pub struct SpotLight {
    /// Where it is.
    pub position: Vec3,
    axis: Frame,
    intensity: Rgb,
    cos_full: f32,
    cos_end: f32,
}

impl SpotLight {
    /// A spot along the unit vector `axis` with `intensity` (W/sr) within the half angle `full`,
    /// falling to nothing at the half angle `end`. Unit: radians.
    pub fn new(position: Vec3, axis: Vec3, intensity: Rgb, [full, end]: [f32; 2]) -> Self {
        let (cos_full, cos_end) = (libm::cosf(full), libm::cosf(end));
        Self {
            position,
            axis: Frame::from_z(axis),
            intensity,
            cos_full,
            cos_end,
        }
    }

    pub(super) fn power(&self) -> f32 {
        let full = 1.0 - self.cos_full;
        let rim = (self.cos_full - self.cos_end) / 2.0;
        2.0 * PI * (full + rim) * luminance(self.intensity)
    }

    /// A smooth step in the cosine, from the rim to the full cone.
    #[inline]
    pub(super) fn intensity(&self, w: Vec3) -> Rgb {
        let cos = self.axis.z.dot(w);
        let falloff = if cos >= self.cos_full {
            1.0
        } else if cos <= self.cos_end {
            0.0
        } else {
            let x = (cos - self.cos_end) / (self.cos_full - self.cos_end);
            x * x * (3.0 - 2.0 * x)
        };
        self.intensity.map(|i| i * falloff)
    }

    #[inline]
    pub(super) fn sample_emission(&self, u: Vec2) -> EmissionSample {
        let direction = self
            .axis
            .to_world(warp::uniform_cone(u, 1.0 - self.cos_end));
        EmissionSample {
            from: LightSample {
                at: LightPoint::in_space(self.position),
                pdf: 1.0,
            },
            origin: self.position,
            direction,
            pdf_direction: 1.0 / (2.0 * PI * (1.0 - self.cos_end)),
            emitted_cos: self.intensity(direction),
        }
    }

    #[inline]
    pub(super) fn pdf_direction(&self, w: Vec3) -> f32 {
        let inside = self.axis.z.dot(w) >= self.cos_end;
        if inside {
            1.0 / (2.0 * PI * (1.0 - self.cos_end))
        } else {
            0.0
        }
    }
}
