//! Area lights: each emitting side of a surface has radiance L, times a pattern, and power π ∫ L dA.
//!
//! A point is drawn by area, or by the solid angle of its shape from the receiver (1/m²); a direction by |cosθ|/π
//! (1/sr), or half of it if both sides emit.

use super::{Cone, EmissionSample, EmitterBounds, LightContext, LightPoint, LightSample, Part};
use crate::math::{Distribution1d, Frame, PI, Vec2, Vec3, warp};
use crate::shape::{Normals, Shape, ShapeSample, SurfacePoint};
use crate::spectrum::{Illuminant, Lanes, Spectrum};
use crate::texture::clamped_alpha;
use crate::texture::{ColorTexture, FloatTexture, TexturePoint};

/// The largest number of primitives of a mesh that a tree of lights takes for one emitter: a quadrilateral has two.
const UNDIVIDED: usize = 2;
/// The number of points that estimate a pattern's mean, by which lights are chosen.
const PATTERN_POINTS: usize = 4096;

/// The sides of a surface that emit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmissionSides {
    /// The front.
    #[default]
    Front,
    /// Front and back alike.
    Both,
}

/// A shape that emits the same radiance in all directions of its emitting sides.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// The index of the shape.
    shape: usize,
    radiance: Illuminant,
    /// The factor of the radiance at each point. None: the radiance is constant.
    pattern: Option<ColorTexture>,
    /// The mean radiance over the area, with the pattern. Unit: luminance.
    mean: f32,
    sides: EmissionSides,
    /// The choice of a primitive, by area.
    primitives: Distribution1d,
    /// One over the area; 0 if that is 0. Unit: 1/m².
    inverse_area: f32,
    /// The coverage of the surface. None: it is 1 everywhere.
    alpha: Option<FloatTexture>,
    /// True if no ray can hit the surface.
    is_hidden: bool,
}

impl AreaLight {
    /// Makes the light of `shape`, which has number `index` in the scene.
    pub fn new(
        index: usize,
        shape: &Shape,
        radiance: impl Into<Illuminant>,
        sides: EmissionSides,
    ) -> Self {
        let radiance: Illuminant = radiance.into();
        let areas = (0..shape.primitive_count()).map(|i| shape.primitive_area(i));
        let primitives = Distribution1d::new(areas);
        let area = primitives.total();
        let inverse_area = if area > 0.0 { (1.0 / area) as f32 } else { 0.0 };
        Self {
            inverse_area,
            shape: index,
            mean: radiance.luminance(),
            radiance,
            pattern: None,
            sides,
            primitives,
            alpha: None,
            is_hidden: false,
        }
    }

    /// Sets the factor of the radiance at each point of `shape`, the light's own shape. Negative values count as
    /// black.
    pub(crate) fn set_pattern(&mut self, shape: &Shape, pattern: ColorTexture) {
        self.pattern = Some(pattern);
        let points = (0..PATTERN_POINTS).map(|i| {
            // The additive recurrence of the plastic number: even in the square [Roberts18].
            let u = Vec2::new(0.754_877_7, 0.569_840_3) * (i as f32 + 0.5);
            let (u, v) = (u.x.fract(), u.y.fract());
            let (primitive, _, rest) = self.primitives.sample(u);
            shape.sample(primitive, Vec2::new(rest, v)).surface
        });
        let sum: f32 = points
            .map(|surface| Lanes::Rgb.luminance(self.radiance_at(&surface, Lanes::Rgb)))
            .sum();
        // A light that may emit somewhere needs a probability above 0.
        let least = 1e-3 * self.radiance.luminance();
        self.mean = (sum / PATTERN_POINTS as f32).max(least);
    }

    /// Returns the radiance of a point of the surface.
    #[inline]
    fn radiance_at(&self, surface: &SurfacePoint, lanes: Lanes) -> Spectrum {
        let radiance = lanes.light(&self.radiance);
        self.pattern.as_ref().map_or(radiance, |pattern| {
            let factor = pattern.eval(&TexturePoint::new(surface));
            radiance * lanes.albedo(factor.map(|channel| channel.max(0.0)))
        })
    }

    /// Returns the radiance at a light point. It depends only on the point, not on the strategy that drew it.
    #[inline]
    fn radiance(&self, context: &LightContext<'_>, at: &LightPoint, lanes: Lanes) -> Spectrum {
        if self.pattern.is_none() {
            return lanes.light(&self.radiance);
        }
        let (shape, primitive) = (&context.shapes[self.shape], at.primitive as usize);
        let parameters = shape.parameters(primitive, at.locus.point);
        self.radiance_at(
            &shape.surface_point(primitive, parameters, at.locus.point),
            lanes,
        )
    }

    /// Hides the surface from rays; it still emits.
    pub(crate) fn hide(&mut self) {
        self.is_hidden = true;
    }

    /// Returns the index of the shape.
    pub(crate) fn shape_index(&self) -> usize {
        self.shape
    }

    pub(super) fn is_hidden(&self) -> bool {
        self.is_hidden
    }

    /// Sets the coverage of the surface, which is also a factor of its emission.
    pub(crate) fn set_alpha(&mut self, alpha: FloatTexture) {
        self.alpha = Some(alpha);
    }

    /// Returns false if all primitives of the shape are degenerate.
    pub fn has_area(&self) -> bool {
        self.inverse_area > 0.0
    }

    pub(super) fn power(&self) -> f32 {
        self.sides() * PI * self.primitives.total() as f32 * self.mean
    }

    /// Returns the power of a primitive, by its area.
    pub(super) fn primitive_power(&self, context: &LightContext<'_>, primitive: u32) -> f32 {
        let area = context.shapes[self.shape].primitive_area(primitive as usize);
        self.sides() * PI * area * self.mean
    }

    fn sides(&self) -> f32 {
        match self.sides {
            EmissionSides::Front => 1.0,
            EmissionSides::Both => 2.0,
        }
    }

    /// Returns the number of emitters that it is for a tree of lights. None: it is one.
    pub(super) fn divided_into(&self, context: &LightContext<'_>) -> Option<u32> {
        let count = context.shapes[self.shape].primitive_count();
        (count > UNDIVIDED).then_some(count as u32)
    }

    /// Returns bounds of `part`, and of the directions in which it emits.
    pub(super) fn bounds(&self, context: &LightContext<'_>, part: Part) -> EmitterBounds {
        let shape = &context.shapes[self.shape];
        let of_primitive = |i| self.primitive_bounds(shape, i);
        match part {
            Part::Primitive(i) => of_primitive(i as usize),
            Part::Whole => {
                let all = (0..shape.primitive_count()).map(of_primitive);
                let union = |sum: EmitterBounds, bounds| sum.union(&bounds);
                all.reduce(union).unwrap_or(EmitterBounds::NOTHING)
            }
        }
    }

    fn primitive_bounds(&self, shape: &Shape, i: usize) -> EmitterBounds {
        let both = self.sides == EmissionSides::Both;
        let facing = shape.primitive_area(i) * self.mean;
        let (cone, intensity) = match shape.normals(i) {
            Normals::One(n) => (Cone::flat(n, both), facing),
            Normals::Opposite(n) => (Cone::flat(n, true), facing),
            // On average over directions, the projected area of a convex surface is a quarter of its area.
            Normals::Any => (Cone::EVERYWHERE, facing / 4.0),
        };
        EmitterBounds {
            bounds: shape.primitive(i).bounds(),
            cone,
            intensity,
        }
    }

    #[inline]
    pub(super) fn emitted(
        &self,
        context: &LightContext<'_>,
        at: &LightPoint,
        w: Vec3,
        lanes: Lanes,
    ) -> Spectrum {
        if self.sides == EmissionSides::Both || at.locus.n_g.dot(w) > 0.0 {
            self.radiance(context, at, lanes)
        } else {
            Spectrum::ZERO
        }
    }

    /// Draws a point of the shape: chooses a primitive, and calls `sample` with it and the remaining numbers.
    #[inline]
    fn sample_shape(&self, u: Vec2, sample: impl Fn(usize, Vec2) -> ShapeSample) -> LightSample {
        let (primitive, prob, rest) = self.primitives.sample(u.x);
        let drawn = sample(primitive, Vec2::new(rest, u.y));
        let sample = self.light_sample(primitive as u32, &drawn);
        LightSample {
            pdf: sample.pdf * prob,
            ..sample
        }
    }

    /// Converts a point drawn on a primitive; its density is among the points of this primitive.
    #[inline]
    fn light_sample(&self, primitive: u32, drawn: &ShapeSample) -> LightSample {
        let alpha = self.alpha.as_ref();
        LightSample {
            at: LightPoint::on_surface(&drawn.surface, primitive),
            pdf: drawn.pdf,
            alpha: alpha.map_or(1.0, |alpha| {
                clamped_alpha(alpha.eval(&TexturePoint::new(&drawn.surface)))
            }),
        }
    }

    #[inline]
    pub(super) fn sample_emission(
        &self,
        context: &LightContext<'_>,
        u_position: Vec2,
        u_direction: Vec2,
        lanes: Lanes,
    ) -> Option<EmissionSample> {
        let shape = &context.shapes[self.shape];
        let from = self.sample_shape(u_position, |i, u| shape.sample(i, u));
        let mut u = u_direction;
        let mut side = 1.0;
        if self.sides == EmissionSides::Both {
            side = if u.x < 0.5 { 1.0 } else { -1.0 };
            u.x = (u.x * 2.0).fract();
        }
        let local = warp::cosine_hemisphere(u);
        let direction = Frame::from_z(from.at.locus.n_g * side).to_world(local);
        let pdf_direction = self.pdf_direction(&from.at, direction);
        (pdf_direction > 0.0 && from.pdf > 0.0).then(|| EmissionSample {
            from,
            origin: from.at.locus.point,
            direction,
            pdf_direction,
            emitted_cos: self.radiance(context, &from.at, lanes)
                * from.at.locus.n_g.dot(direction).abs(),
        })
    }

    #[inline]
    pub(super) fn pdf_position(&self, context: &LightContext<'_>, at: &LightPoint) -> f32 {
        match &context.shapes[self.shape] {
            // A primitive chosen by area, and a uniform point on it: a uniform point of the shape.
            Shape::Mesh(_) | Shape::Disk(_) => self.inverse_area,
            Shape::Sphere(sphere) => sphere.pdf(at.locus.point),
            Shape::Cylinder(cylinder) => cylinder.pdf(at.locus.point),
        }
    }

    #[inline]
    pub(super) fn pdf_direction(&self, at: &LightPoint, w: Vec3) -> f32 {
        let cos = at.locus.n_g.dot(w);
        match self.sides {
            EmissionSides::Front => warp::cosine_hemisphere_pdf(cos),
            EmissionSides::Both => warp::cosine_hemisphere_pdf(cos.abs()) / 2.0,
        }
    }

    #[inline]
    pub(super) fn sample_next_event(
        &self,
        context: &LightContext<'_>,
        part: Part,
        reference: Vec3,
        u: Vec2,
    ) -> Option<LightSample> {
        let shape = &context.shapes[self.shape];
        let draw = |i, u| shape.sample_from(i, reference, u);
        let sample = match part {
            Part::Whole => self.sample_shape(u, draw),
            Part::Primitive(i) => self.light_sample(i, &draw(i as usize, u)),
        };
        (sample.pdf > 0.0).then_some(sample)
    }

    #[inline]
    pub(super) fn pdf_next_event(
        &self,
        context: &LightContext<'_>,
        part: Part,
        reference: Vec3,
        at: &LightPoint,
    ) -> f32 {
        let shape = &context.shapes[self.shape];
        match (part, shape) {
            (Part::Primitive(i), _) => {
                shape.pdf_from(i as usize, reference, at.locus.point, at.locus.n_g)
            }
            (Part::Whole, Shape::Mesh(_) | Shape::Disk(_)) => self.inverse_area,
            (Part::Whole, Shape::Sphere(sphere)) => {
                sphere.pdf_from(reference, at.locus.point, at.locus.n_g)
            }
            (Part::Whole, Shape::Cylinder(cylinder)) => cylinder.pdf(at.locus.point),
        }
    }
}
