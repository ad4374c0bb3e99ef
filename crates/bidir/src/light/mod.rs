//! Lights: the sources of light.
//!
//! A path starts at a [`LightPoint`]: a point on a light, or, for lights at infinity, a direction.
//! Three densities describe how one is drawn, each in its own measure:
//!
//! | | surface | medium | light at infinity |
//! |---|---|---|---|
//! | `pdf_position` of the light point (a light subpath's x₀) | area, 1/m² | volume, 1/m³ | solid angle, 1/sr |
//! | `pdf_direction` of leaving it (x₁) | solid angle, 1/sr | solid angle, 1/sr | area of the disk that the rays cross, 1/m² |
//! | `pdf_next_event` of the point drawn for a given receiver | area, 1/m² | volume, 1/m³ | solid angle, 1/sr |
//!
//! A Dirac endpoint (point, spot and distant lights) counts 1 for the density it lacks: it cancels,
//! because no strategy can hit such a light by chance ([`Light::is_delta`]).
//!
//! Light subpaths choose a light by power ([`LightChoice`]), next-event estimation by power or by a tree
//! that knows the receiver ([`LightTree`]).
//!
//! **Adding one**: a file, a variant in [`Light`] with an arm in each match, and a mapping in the
//! scene reader.

mod area;
mod choice;
mod infinite;
mod point;
mod tree;
mod volume;

#[cfg(test)]
mod tests;

pub use area::{AreaLight, EmissionSides};
pub use choice::LightChoice;
pub use infinite::{DistantLight, InfiniteLight, Radiance};
pub use point::{PointLight, SpotLight};
pub use tree::{ChosenEmitter, Facing, LightTree, Receiver};
pub use volume::VolumeLight;

use crate::locus::Locus;
use crate::math::{Vec2, Vec3};
use crate::medium::{Medium, MediumId};
use crate::shape::{Shape, SurfacePoint};
use crate::spectrum::{Lanes, Spectrum};
use tree::{Cone, EmitterBounds};

/// The start of a path.
#[derive(Clone, Copy, Debug)]
pub struct LightPoint {
    /// Its position and normal.
    pub locus: Locus,
    /// The primitive of the emitting shape; 0 if there is no shape.
    pub primitive: u32,
}

impl LightPoint {
    /// Makes a point on an emitting surface.
    pub fn on_surface(surface: &SurfacePoint, primitive: u32) -> Self {
        Self {
            locus: surface.locus(),
            primitive,
        }
    }

    /// Makes a point in space.
    pub fn in_space(point: Vec3) -> Self {
        Self {
            locus: Locus::in_space(point),
            primitive: 0,
        }
    }

    /// Makes a point in a medium that emits.
    pub fn in_medium(point: Vec3, medium: MediumId) -> Self {
        Self {
            locus: Locus::in_medium(point, medium),
            primitive: 0,
        }
    }

    /// Makes the light point of a light at infinity in the unit `direction`.
    pub fn at_infinity(direction: Vec3) -> Self {
        Self {
            locus: Locus::at_infinity(direction),
            primitive: 0,
        }
    }
}

/// A light point with its density.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// The point or direction.
    pub at: LightPoint,
    /// Its density, in the measure of the module's table.
    pub pdf: f32,
    /// The coverage of the surface at the point: a factor of its emission that no density includes. Range: `[0, 1]`.
    pub alpha: f32,
}

impl LightSample {
    /// Makes a sample with full coverage.
    pub fn new(at: LightPoint, pdf: f32) -> Self {
        Self {
            at,
            pdf,
            alpha: 1.0,
        }
    }
}

/// A ray that leaves a light.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// The light point that it leaves.
    pub from: LightSample,
    /// The origin of the ray: the light point, or for a light at infinity a point outside the
    /// scene.
    pub origin: Vec3,
    /// The unit direction it travels in.
    pub direction: Vec3,
    /// The density of `direction`, in the measure of the module's table.
    pub pdf_direction: f32,
    /// The emitted radiance or intensity, times the cosine at the light if it has a surface.
    pub emitted_cos: Spectrum,
}

/// The parts of the scene that lights need.
#[derive(Clone, Copy)]
pub struct LightContext<'a> {
    /// The shapes that area lights refer to.
    pub shapes: &'a [Shape],
    /// The media of the scene.
    pub media: &'a [Medium],
    /// The centre of a sphere around the scene.
    pub centre: Vec3,
    /// The radius of this sphere.
    pub radius: f32,
}

/// The part of a light that a point is drawn on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of the light.
    Whole,
    /// A primitive of its shape, by number.
    Primitive(u32),
}

/// A light of the scene.
#[derive(Clone, Debug)]
pub enum Light {
    /// A shape that emits.
    Area(AreaLight),
    /// A point that emits evenly.
    Point(PointLight),
    /// A point that emits into a cone.
    Spot(SpotLight),
    /// Parallel rays from one direction.
    Distant(DistantLight),
    /// An environment around the scene.
    Infinite(InfiniteLight),
    /// A medium that emits.
    Volume(VolumeLight),
}

impl Light {
    /// Returns the name of its kind, in one word.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Area(_) => "area",
            Self::Point(_) => "point",
            Self::Spot(_) => "spot",
            Self::Distant(_) => "distant",
            Self::Infinite(_) => "infinite",
            Self::Volume(_) => "volume",
        }
    }

    /// Returns true if no ray can hit the light by chance: its position or its direction is a Dirac distribution, or
    /// its surface is hidden.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Point(_) | Self::Spot(_) | Self::Distant(_) => true,
            Self::Area(light) => light.is_hidden(),
            Self::Infinite(_) | Self::Volume(_) => false,
        }
    }

    /// Returns true for a medium of infinite extent: only camera walks reach all of its points.
    pub fn is_endless(&self) -> bool {
        matches!(self, Self::Volume(light) if light.is_endless())
    }

    /// Returns true for lights outside the scene.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Distant(_) | Self::Infinite(_))
    }

    /// Returns the approximate power that enters the scene, for the choice of lights. Unit: W, luminance.
    pub fn power(&self, context: &LightContext<'_>) -> f32 {
        match self {
            Self::Area(light) => light.power(),
            Self::Point(light) => light.power(),
            Self::Spot(light) => light.power(),
            Self::Distant(light) => light.power(context),
            Self::Infinite(light) => light.power(context),
            Self::Volume(light) => light.power(),
        }
    }

    /// Returns the position of a light that is a point. Unit: m. None: it has an extent, or is at infinity.
    pub(crate) fn position(&self) -> Option<Vec3> {
        match self {
            Self::Point(light) => Some(light.position),
            Self::Spot(light) => Some(light.position),
            Self::Area(_) | Self::Distant(_) | Self::Infinite(_) | Self::Volume(_) => None,
        }
    }

    /// Returns the radiance from `at` along the unit direction `w` away from the light; intensity for point
    /// and spot lights, irradiance on a facing surface for a distant light, σ_a L_e in a medium.
    #[inline]
    pub fn emitted(
        &self,
        context: &LightContext<'_>,
        at: &LightPoint,
        w: Vec3,
        lanes: Lanes,
    ) -> Spectrum {
        match self {
            Self::Area(light) => light.emitted(context, at, w, lanes),
            Self::Point(light) => lanes.light(&light.intensity),
            Self::Spot(light) => light.intensity(w, lanes),
            Self::Distant(light) => lanes.light(&light.irradiance),
            Self::Infinite(light) => light.radiance(at.locus.point, lanes),
            Self::Volume(light) => light.emitted(context, at, lanes),
        }
    }

    /// Draws a ray that leaves the light. Calls `u_depth` only for a medium. None: the draw has no density.
    #[inline]
    pub fn sample_emission(
        &self,
        context: &LightContext<'_>,
        u_position: Vec2,
        u_depth: impl FnOnce() -> f32,
        u_direction: Vec2,
        lanes: Lanes,
    ) -> Option<EmissionSample> {
        match self {
            Self::Area(light) => light.sample_emission(context, u_position, u_direction, lanes),
            Self::Point(light) => Some(light.sample_emission(u_direction, lanes)),
            Self::Spot(light) => Some(light.sample_emission(u_direction, lanes)),
            Self::Distant(light) => Some(light.sample_emission(context, u_direction, lanes)),
            Self::Infinite(light) => light.sample_emission(context, u_position, u_direction, lanes),
            Self::Volume(light) => {
                light.sample_emission(context, u_position.extend(u_depth()), u_direction, lanes)
            }
        }
    }

    /// Returns the density of the light point `at` in [`sample_emission`](Self::sample_emission).
    #[inline]
    pub fn pdf_position(&self, context: &LightContext<'_>, at: &LightPoint) -> f32 {
        match self {
            Self::Area(light) => light.pdf_position(context, at),
            Self::Point(_) | Self::Spot(_) | Self::Distant(_) => 1.0,
            Self::Infinite(light) => light.pdf(at.locus.point),
            Self::Volume(light) => light.pdf(at),
        }
    }

    /// Returns the density of leaving `at` along `w` in [`sample_emission`](Self::sample_emission).
    #[inline]
    pub fn pdf_direction(&self, context: &LightContext<'_>, at: &LightPoint, w: Vec3) -> f32 {
        match self {
            Self::Area(light) => light.pdf_direction(at, w),
            Self::Point(_) | Self::Volume(_) => PointLight::PDF_DIRECTION,
            Self::Spot(light) => light.pdf_direction(w),
            Self::Distant(_) | Self::Infinite(_) => infinite::pdf_disk(context),
        }
    }

    /// Returns the parts that are emitters of their own: the whole light, or each primitive.
    fn parts(&self, context: &LightContext<'_>) -> impl Iterator<Item = Part> {
        let primitives = match self {
            Self::Area(light) => light.divided_into(context),
            _ => None,
        };
        (0..primitives.unwrap_or(1)).map(move |i| match primitives {
            Some(_) => Part::Primitive(i),
            None => Part::Whole,
        })
    }

    /// Returns the power of a part, its share of [`power`](Self::power). Unit: W, luminance.
    fn part_power(&self, context: &LightContext<'_>, part: Part) -> f32 {
        match (self, part) {
            (Self::Area(light), Part::Primitive(i)) => light.primitive_power(context, i),
            _ => self.power(context),
        }
    }

    /// Returns bounds of a part, and of the directions in which it emits. None: it is at infinity.
    fn bounds(&self, context: &LightContext<'_>, part: Part) -> Option<EmitterBounds> {
        match self {
            Self::Area(light) => Some(light.bounds(context, part)),
            Self::Point(light) => Some(light.bounds()),
            Self::Spot(light) => Some(light.bounds()),
            Self::Distant(_) | Self::Infinite(_) => None,
            Self::Volume(light) => Some(light.bounds()),
        }
    }

    /// Draws a light point of `part` for a receiver at `reference`. Calls `u_depth` only for a medium. None: the draw
    /// has no density.
    #[inline(always)]
    pub fn sample_next_event(
        &self,
        context: &LightContext<'_>,
        part: Part,
        reference: Vec3,
        u: Vec2,
        u_depth: impl FnOnce() -> f32,
    ) -> Option<LightSample> {
        match self {
            Self::Area(light) => light.sample_next_event(context, part, reference, u),
            Self::Point(light) => Some(light.at()),
            Self::Spot(light) => Some(light.at()),
            Self::Distant(light) => Some(light.at()),
            Self::Infinite(light) => light.sample(u),
            Self::Volume(light) => light.sample(u.extend(u_depth())),
        }
    }

    /// Returns the density of `at` in [`sample_next_event`](Self::sample_next_event).
    #[inline]
    pub fn pdf_next_event(
        &self,
        context: &LightContext<'_>,
        part: Part,
        reference: Vec3,
        at: &LightPoint,
    ) -> f32 {
        match self {
            Self::Area(light) => light.pdf_next_event(context, part, reference, at),
            Self::Point(_) | Self::Spot(_) | Self::Distant(_) => 1.0,
            Self::Infinite(light) => light.pdf(at.locus.point),
            Self::Volume(light) => light.pdf(at),
        }
    }
}
