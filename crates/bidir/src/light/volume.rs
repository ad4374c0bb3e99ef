//! Media that emit σ_a L_e (W/(m³ sr)) in all directions from each point. Their power is 4π ∫ σ_a L_e dV, but at most
//! π times the area of the box times the largest L_e: no more leaves a thick medium.
//!
//! A point is drawn by the cells of the medium's box, in proportion to the light of each (1/m³), and a direction
//! uniformly, 1/(4π) (1/sr). A camera walk hits the light where it stops in the medium.

use super::{
    Cone, EmissionSample, EmitterBounds, LightContext, LightPoint, LightSample, PointLight,
};
use crate::math::{Affine3A, Distribution3d, ONE_MINUS_EPSILON, PI, Vec2, Vec3, warp};
use crate::medium::{GlowCells, Medium, MediumId};
use crate::spectrum::{Lanes, Spectrum};
use accel::Aabb;

/// A medium that emits light.
#[derive(Clone, Debug)]
pub struct VolumeLight {
    medium: MediumId,
    /// The distribution of points. None: only camera walks find points of the light.
    cells: Option<Cells>,
    /// True if the medium extends beyond the cells, or has none.
    is_endless: bool,
}

/// The distribution of points over the cells of a box.
#[derive(Clone, Debug)]
struct Cells {
    world_from_cube: Affine3A,
    cube_from_world: Affine3A,
    points: Distribution3d,
    /// Unit: 1/m³.
    inverse_volume: f32,
    bounds: Aabb,
    /// ∫ σ_a L_e dV, or less if the medium is so thick that less leaves it. Unit: W/sr, luminance.
    intensity: f32,
}

impl VolumeLight {
    /// Makes the light of a medium of a scene that is not built yet.
    pub(crate) fn of(medium: MediumId) -> Self {
        Self {
            medium,
            cells: None,
            is_endless: true,
        }
    }

    /// Makes the light of medium number `id`. If the medium has no box of its own, it is within `bounds`.
    pub(crate) fn new(id: MediumId, medium: &Medium, bounds: Option<Aabb>) -> Self {
        let cells = medium.glow_cells(bounds).and_then(|cells| {
            let bounds = medium.bounds().or(bounds)?;
            Cells::new(&cells, bounds, medium.brightest())
        });
        Self {
            medium: id,
            is_endless: cells.is_none(),
            cells,
        }
    }

    /// Notes that the medium surrounds the scene: unless it has a box of its own, it is endless.
    pub(crate) fn set_around(&mut self, medium: &Medium) {
        self.is_endless |= medium.bounds().is_none();
    }

    pub(super) fn is_endless(&self) -> bool {
        self.is_endless
    }

    /// Returns the medium.
    pub fn medium(&self) -> MediumId {
        self.medium
    }

    pub(super) fn power(&self) -> f32 {
        4.0 * PI * self.cells.as_ref().map_or(0.0, |cells| cells.intensity)
    }

    pub(super) fn bounds(&self) -> EmitterBounds {
        self.cells
            .as_ref()
            .map_or(EmitterBounds::NOTHING, |cells| EmitterBounds {
                bounds: cells.bounds,
                cone: Cone::EVERYWHERE,
                intensity: cells.intensity,
            })
    }

    #[inline]
    pub(super) fn emitted(
        &self,
        context: &LightContext<'_>,
        at: &LightPoint,
        lanes: Lanes,
    ) -> Spectrum {
        let medium = self.medium.index().map(|index| &context.media[index]);
        medium.map_or(Spectrum::ZERO, |medium| {
            medium.emission(at.locus.point, lanes)
        })
    }

    /// Draws a point of the medium's box. The medium may end before the point; the scene checks that.
    #[inline]
    pub(super) fn sample(&self, u: Vec3) -> Option<LightSample> {
        let cells = self.cells.as_ref()?;
        let (p, pdf) = cells.points.sample(u);
        let point = cells.world_from_cube.transform_point3(p);
        let at = LightPoint::in_medium(point, self.medium);
        Some(LightSample::new(at, pdf * cells.inverse_volume))
    }

    /// Returns the density of a point. Measure: volume, 1/m³.
    #[inline]
    pub(super) fn pdf(&self, at: &LightPoint) -> f32 {
        self.cells
            .as_ref()
            .map_or(0.0, |cells| cells.pdf(at.locus.point))
    }

    #[inline]
    pub(super) fn sample_emission(
        &self,
        context: &LightContext<'_>,
        u_position: Vec3,
        u_direction: Vec2,
        lanes: Lanes,
    ) -> Option<EmissionSample> {
        let from = self.sample(u_position)?;
        Some(EmissionSample {
            from,
            origin: from.at.locus.point,
            direction: warp::uniform_sphere(u_direction),
            pdf_direction: PointLight::PDF_DIRECTION,
            emitted_cos: self.emitted(context, &from.at, lanes),
        })
    }
}

impl Cells {
    /// Makes the distribution over `cells`. None: they emit nothing, or numbers would overflow.
    fn new(cells: &GlowCells, bounds: Aabb, brightest: f32) -> Option<Self> {
        /// The largest intensity, with which the sum over all lights stays finite.
        const MOST: f32 = 1e30;
        let volume = cells.world_from_cube.matrix3.determinant().abs();
        let sum: f64 = cells.emission.iter().copied().map(f64::from).sum();
        let emitted = (sum / cells.emission.len() as f64) as f32 * volume;
        // A convex surface of area A and radiance L emits π A L, and a medium within it no more.
        let intensity = emitted.min(0.5 * bounds.half_area() * brightest);
        let [nx, ny, _] = cells.size;
        let fits = intensity > 0.0 && intensity < MOST && (1.0 / volume).is_finite();
        fits.then(|| Self {
            world_from_cube: cells.world_from_cube,
            cube_from_world: cells.world_from_cube.inverse(),
            points: Distribution3d::new(&cells.emission, [nx, ny]),
            inverse_volume: 1.0 / volume,
            bounds,
            intensity,
        })
    }

    #[inline]
    fn pdf(&self, point: Vec3) -> f32 {
        /// The tolerance, as a fraction of the side of the box: by rounding, points of its faces may lie outside.
        const ERROR: f32 = 1e-5;
        let p = self.cube_from_world.transform_point3(point);
        let within = p.clamp(Vec3::ZERO, Vec3::splat(ONE_MINUS_EPSILON));
        if (p - within).abs().max_element() > ERROR {
            return 0.0;
        }
        self.points.pdf(within) * self.inverse_volume
    }
}
