//! What a vertex does to light: its value scatter(wo, wi) in the integrand, the directions that walks
//! draw there, and their densities. Visibility and roulette are no part of it.

use super::{PathContext, Vertex, VertexKind};
use crate::bsdf::TransportMode;
use crate::light::LightPoint;
use crate::math::{Vec2, Vec3};
use crate::spectrum::Spectrum;

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
    /// True where a Dirac lobe was drawn.
    pub(super) is_delta: bool,
}

impl Vertex {
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
        match (self.kind, self.light) {
            (VertexKind::Camera, _) => Spectrum::splat(context.scene.camera().importance(wi)),
            (VertexKind::Light, Some(light)) => context.emitted(light, &self.light_point(), wi),
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
        u_lobe: impl FnOnce() -> f32,
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
            is_delta: sample.is_delta,
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

    /// Density of drawing the direction `wi` here by a walk that came along `-wo`. Measure: solid
    /// angle, 1/sr; from a light at infinity area of the disk that its rays cross, 1/m². Dirac lobes
    /// are no part of it but for the probability that they take.
    #[inline]
    pub fn pdf_direction(&self, context: &PathContext<'_>, wo: Vec3, wi: Vec3) -> f32 {
        let scene = context.scene;
        match (self.kind, self.light) {
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
        }
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

impl PathContext<'_> {
    /// What light number `light` sends from `at` along the unit direction `w`: radiance, intensity or
    /// irradiance, as [`Light::emitted`](crate::light::Light::emitted) says.
    #[inline]
    pub(crate) fn emitted(&self, light: u32, at: &LightPoint, w: Vec3) -> Spectrum {
        let scene = self.scene;
        let emitted = scene.light(light).emitted(&scene.light_context(), at, w);
        scene.color().illuminant(emitted, &self.wavelengths)
    }
}
