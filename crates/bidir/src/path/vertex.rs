//! Vertices: f = Π scatter · Π G over geometric cosines, one function of the path, whichever end a
//! walk began at [Veach97, §5.3].
//!
//! `scatter` is in 1/sr at a surface; densities are per area, 1/m² (solid angle, 1/sr, for a light
//! at infinity). Visibility and roulette are no part of a vertex.

use super::PathContext;
use crate::bsdf::{Bsdf, Diffuse, TransportMode};
use crate::camera::LensSample;
use crate::light::LightPoint;
use crate::math::{Frame, Vec2, Vec3};
use crate::scene::{SegmentEnd, SurfaceHit};
use crate::spectrum::Spectrum;

/// What a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexKind {
    /// A point on the lens: the start of a camera subpath.
    Camera,
    /// A point on a light, or a direction towards one at infinity: the start of a light subpath.
    Light,
    /// A point of a surface, emissive or not.
    Surface,
}

/// A vertex of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// What it is.
    pub kind: VertexKind,
    /// The point; for a light at infinity the unit direction towards it.
    pub point: Vec3,
    /// The geometric normal; zero for a point in space.
    pub n_g: Vec3,
    /// What ray origins are pushed off the surface by.
    pub error: f32,
    /// The shading frame of a surface.
    pub shading: Frame,
    /// The unit direction towards the previous vertex of the walk.
    pub wo: Vec3,
    /// The scattering of a surface.
    pub bsdf: Bsdf,
    /// Throughput up to this vertex, without the scattering at it.
    pub beta: Spectrum,
    /// The density of this vertex as its walk drew it, without roulette.
    pub pdf_fwd: f32,
    /// The density of this vertex drawn from its successor by a walk in the other direction,
    /// without roulette; set when the successor scatters.
    pub pdf_rev: f32,
    /// The largest lane of the albedo seen from the previous vertex.
    pub albedo_fwd: f32,
    /// The largest lane of the albedo seen from the next vertex; set when this vertex scatters.
    pub albedo_rev: f32,
    /// The light that the vertex lies on, by index.
    pub light: Option<u32>,
    /// The primitive of the light's shape.
    pub light_primitive: u32,
    /// True for a light at infinity.
    pub is_infinite: bool,
}

/// A direction drawn at a vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattered {
    /// The unit direction.
    pub(super) wi: Vec3,
    /// Scattering times geometric cosine over density.
    pub(super) weight: Spectrum,
    /// The density of `wi`, or the coefficient of its Dirac factor. Measure: solid angle.
    pub(super) pdf: f32,
    /// The same of drawing `wo` by a walk that arrives along `wi`.
    pub(super) pdf_reverse: f32,
}

impl Vertex {
    /// A vertex of which only the kind, the point and its normal matter.
    fn endpoint(kind: VertexKind, point: Vec3, n_g: Vec3) -> Self {
        Self {
            kind,
            point,
            n_g,
            error: 0.0,
            shading: Frame {
                x: Vec3::ZERO,
                y: Vec3::ZERO,
                z: Vec3::ZERO,
            },
            wo: Vec3::ZERO,
            bsdf: Bsdf::Diffuse(Diffuse {
                reflectance: Spectrum::ZERO,
            }),
            beta: Spectrum::ONE,
            pdf_fwd: 0.0,
            pdf_rev: 0.0,
            albedo_fwd: 1.0,
            albedo_rev: 1.0,
            light: None,
            light_primitive: 0,
            is_infinite: false,
        }
    }

    /// A lens point; `beta` is one over its density.
    pub fn camera(lens: &LensSample) -> Self {
        Self {
            beta: Spectrum::splat(1.0 / lens.pdf),
            pdf_fwd: lens.pdf,
            ..Self::endpoint(VertexKind::Camera, lens.point, lens.n_g)
        }
    }

    /// A point on light number `light`, which light subpaths draw with density `pdf_fwd`.
    pub fn light(context: &PathContext<'_>, light: u32, at: &LightPoint) -> Self {
        let scene = context.scene;
        let prob = scene.light_choice().prob(light as usize);
        let pdf_position = scene.light(light).pdf_position(&scene.light_context(), at);
        Self {
            error: at.error,
            pdf_fwd: prob * pdf_position,
            light: Some(light),
            light_primitive: at.primitive,
            is_infinite: at.is_infinite,
            ..Self::endpoint(VertexKind::Light, at.point, at.n_g)
        }
    }

    /// A surface point reached along `-wo` with throughput `beta`.
    pub fn surface(context: &PathContext<'_>, hit: &SurfaceHit, wo: Vec3, beta: Spectrum) -> Self {
        let surface = &hit.surface;
        let material = context.scene.material(hit.material);
        let bsdf = material.bsdf(surface.uv, context.scene.color(), &context.wavelengths);
        Self {
            error: surface.error,
            shading: surface.shading,
            wo,
            bsdf,
            beta,
            albedo_fwd: bsdf.albedo(surface.shading.to_local(wo)).max_lane(),
            light: hit.light.map(|(light, _)| light),
            light_primitive: hit.light.map_or(0, |(_, at)| at.primitive),
            ..Self::endpoint(VertexKind::Surface, surface.point, surface.n_g)
        }
    }

    /// The vertex as a point of the light that it lies on.
    #[inline]
    pub fn light_point(&self) -> LightPoint {
        LightPoint {
            point: self.point,
            n_g: self.n_g,
            error: self.error,
            primitive: self.light_primitive,
            is_infinite: self.is_infinite,
        }
    }

    /// The vertex as an end of a shadow ray.
    #[inline]
    pub fn segment_end(&self) -> SegmentEnd {
        SegmentEnd {
            point: self.point,
            n_g: self.n_g,
            error: self.error,
            is_infinite: self.is_infinite,
        }
    }

    /// True where the scattering is a Dirac distribution, so that nothing can connect here.
    #[inline]
    pub fn is_delta(&self) -> bool {
        self.kind == VertexKind::Surface && self.bsdf.is_delta()
    }

    /// The unit direction from here to `other`; at most one of the two is at infinity.
    #[inline]
    pub fn toward(&self, other: &Self) -> Vec3 {
        if other.is_infinite {
            other.point
        } else if self.is_infinite {
            -self.point
        } else {
            (other.point - self.point).normalize_or_zero()
        }
    }

    /// |cosθ| between the geometric normal and `w`; 1 where there is no surface.
    #[inline]
    fn abs_cos(&self, w: Vec3) -> f32 {
        if self.n_g == Vec3::ZERO {
            1.0
        } else {
            self.n_g.dot(w).abs()
        }
    }

    /// G = |cosθ cosθ'| / d²; towards a light at infinity only the cosine of the other end.
    /// Visibility is no part of it. Unit: 1/m².
    #[inline]
    pub fn geometry_term(&self, other: &Self) -> f32 {
        let w = self.toward(other);
        let cosines = self.abs_cos(w) * other.abs_cos(w);
        if self.is_infinite || other.is_infinite {
            return cosines;
        }
        let distance2 = self.point.distance_squared(other.point);
        if distance2 > 0.0 {
            cosines / distance2
        } else {
            0.0
        }
    }

    /// The value of this vertex in the measurement contribution: scattering, emission or
    /// importance between `wo` (towards the previous vertex) and `wi` (towards the next).
    ///
    /// The whole integrand is Π scatter · Π G over **geometric** cosines, so scattering carries
    /// |ω·n_s| / |ω·n_g| with ω the direction that light comes from: `wi` for radiance, `wo` for
    /// importance. That is the adjoint of shading normals [Veach97, §5.3]; it makes the
    /// integrand one function of the path, whichever end a walk began at. Where shading and
    /// geometric normal disagree on the side of a direction, nothing is scattered.
    ///
    /// This is the only caller of `Bsdf::eval`.
    #[inline]
    pub fn scatter(
        &self,
        context: &PathContext<'_>,
        wo: Vec3,
        wi: Vec3,
        mode: TransportMode,
    ) -> Spectrum {
        let scene = context.scene;
        match (self.kind, self.light) {
            (VertexKind::Camera, _) => Spectrum::splat(scene.camera().importance(wi)),
            (VertexKind::Light, Some(light)) => {
                let emitted = scene.light(light).emitted(&self.light_point(), wi);
                scene.color().illuminant(emitted, &context.wavelengths)
            }
            (VertexKind::Light, None) => Spectrum::ZERO,
            (VertexKind::Surface, _) => {
                if !self.sides_agree(wo) || !self.sides_agree(wi) {
                    return Spectrum::ZERO;
                }
                let (local_o, local_i) = (self.shading.to_local(wo), self.shading.to_local(wi));
                let f = self.bsdf.eval(local_o, local_i, mode);
                f * match mode {
                    TransportMode::Radiance => self.normal_ratio(wi),
                    TransportMode::Importance => self.normal_ratio(wo),
                }
            }
        }
    }

    /// Draws the next direction of a walk. None: nothing is scattered.
    #[inline]
    pub(super) fn sample_scatter(
        &self,
        mode: TransportMode,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<Scattered> {
        let wo = self.shading.to_local(self.wo);
        let sample = self.bsdf.sample(wo, mode, u_lobe, u)?;
        let wi = self.shading.to_world(sample.wi);
        if !self.sides_agree(self.wo) || !self.sides_agree(wi) {
            return None;
        }
        // `sample.weight` has the shading cosine of `wi`: for radiance that is `scatter` times the
        // geometric cosine already.
        let weight = match mode {
            TransportMode::Radiance => sample.weight,
            TransportMode::Importance => {
                sample.weight * (self.normal_ratio(self.wo) / self.normal_ratio(wi))
            }
        };
        Some(Scattered {
            wi,
            weight,
            pdf: sample.pdf,
            pdf_reverse: sample.pdf_reverse,
        })
    }

    /// |w·n_s| / |w·n_g|.
    #[inline]
    fn normal_ratio(&self, w: Vec3) -> f32 {
        (self.shading.z.dot(w) / self.n_g.dot(w)).abs()
    }

    /// True where both normals see `w` on the same side.
    #[inline]
    fn sides_agree(&self, w: Vec3) -> bool {
        self.shading.z.dot(w) * self.n_g.dot(w) > 0.0
    }

    /// Turns a density of directions at this vertex into that of the vertex `next` which the
    /// direction leads to.
    #[inline]
    pub(super) fn density_at(&self, pdf_w: f32, next: &Self) -> f32 {
        if next.is_infinite {
            return pdf_w;
        }
        let cos = next.abs_cos(self.toward(next));
        if self.is_infinite {
            return pdf_w * cos;
        }
        let distance2 = self.point.distance_squared(next.point);
        if distance2 > 0.0 {
            pdf_w * cos / distance2
        } else {
            0.0
        }
    }

    /// Density of drawing `next` from this vertex by a walk that came along `-wo`, without
    /// roulette. Measure: area at `next`, 1/m²; solid angle for a light at infinity. Zero where
    /// the scattering is a Dirac distribution.
    #[inline]
    pub fn pdf_to(&self, context: &PathContext<'_>, wo: Vec3, next: &Self) -> f32 {
        let scene = context.scene;
        let wi = self.toward(next);
        let pdf_w = match (self.kind, self.light) {
            (VertexKind::Camera, _) => scene.camera().pdf_direction(wi),
            (VertexKind::Light, Some(light)) => {
                let at = self.light_point();
                scene
                    .light(light)
                    .pdf_direction(&scene.light_context(), &at, wi)
            }
            (VertexKind::Light, None) => 0.0,
            (VertexKind::Surface, _) => self
                .bsdf
                .pdf(self.shading.to_local(wo), self.shading.to_local(wi)),
        };
        self.density_at(pdf_w, next)
    }

    /// The largest lane of the albedo that a walk along `-wo` meets here.
    #[inline]
    pub(super) fn albedo_from(&self, wo: Vec3) -> f32 {
        match self.kind {
            VertexKind::Surface => self.bsdf.albedo(self.shading.to_local(wo)).max_lane(),
            VertexKind::Camera | VertexKind::Light => 1.0,
        }
    }
}
