//! The effect of a vertex on light: its value scatter(wo, wi) in the integrand, the directions that walks
//! draw there, and their densities. Visibility and roulette are no part of it.

use super::{PathContext, Scattering, Vertex};
use crate::bsdf::{BsdfValue, TransportMode};
use crate::light::LightPoint;
use crate::math::{Vec2, Vec3};
use crate::medium::MediumScattering;
use crate::spectrum::Spectrum;
use std::cell::Cell;

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
    /// The largest lane of the albedo that such a walk meets.
    pub(super) albedo_reverse: f32,
    /// True where a Dirac lobe was drawn.
    pub(super) is_delta: bool,
}

/// A vertex with the directions towards both of its neighbours on a path.
///
/// A walk of `mode` came from `wo` and goes on along `wi`. All questions share the local coordinates of both, and the
/// value of the BSDF or the medium, which is evaluated for the first of them that needs it.
#[derive(Clone, Debug)]
pub struct Turn<'a> {
    vertex: &'a Vertex,
    mode: TransportMode,
    wo: Side,
    wi: Side,
    value: Cell<Option<BsdfValue>>,
}

/// A unit direction at a vertex.
#[derive(Clone, Copy, Debug)]
struct Side {
    world: Vec3,
    /// In the shading frame of a surface.
    local: Vec3,
    /// The cosine to its geometric normal.
    cos_g: f32,
}

impl Side {
    #[inline]
    fn new(vertex: &Vertex, world: Vec3) -> Self {
        Self {
            world,
            local: vertex.frame.to_local(world),
            cos_g: vertex.locus.n_g.dot(world),
        }
    }

    /// True where both normals see it on the same side.
    #[inline]
    fn agrees(&self) -> bool {
        self.local.z * self.cos_g > 0.0
    }

    /// |ω·n_s| / |ω·n_g|.
    #[inline]
    fn normal_ratio(&self) -> f32 {
        (self.local.z / self.cos_g).abs()
    }
}

impl<'a> Turn<'a> {
    /// The vertex.
    #[inline]
    pub fn vertex(&self) -> &'a Vertex {
        self.vertex
    }

    /// The value of a surface or of a medium; cameras and lights have none. This is the only caller of `Bsdf::eval`.
    #[inline]
    fn value(&self) -> BsdfValue {
        self.value.get().unwrap_or_else(|| {
            let Self { wo, wi, .. } = self;
            let value = match &self.vertex.scattering {
                Scattering::Surface(bsdf) => bsdf.eval(wo.local, wi.local, self.mode),
                Scattering::Medium(medium) => phase_value(medium, wo.world, wi.world),
                Scattering::Camera | Scattering::Light => BsdfValue::NONE,
            };
            self.value.set(Some(value));
            value
        })
    }

    /// The value of the vertex in the measurement contribution: scattering, emission or
    /// importance.
    ///
    /// The whole integrand is Π scatter · Π G over **geometric** cosines, so scattering carries
    /// |ω·n_s| / |ω·n_g| with ω the direction that light comes from: `wi` for radiance, `wo` for
    /// importance. That is the adjoint of shading normals [Veach97, §5.3]; it makes the
    /// integrand one function of the path, whichever end a walk began at. If shading and
    /// geometric normal disagree on the side of a direction, nothing is scattered.
    #[inline]
    pub fn scatter(&self, context: &PathContext<'_>) -> Spectrum {
        let Self { vertex, wo, wi, .. } = self;
        match &vertex.scattering {
            Scattering::Camera | Scattering::Light => vertex.leaving(context, wi.world),
            Scattering::Surface(_) => {
                if !wo.agrees() || !wi.agrees() {
                    return Spectrum::ZERO;
                }
                let from = match self.mode {
                    TransportMode::Radiance => wi,
                    TransportMode::Importance => wo,
                };
                self.value().f * from.normal_ratio()
            }
            Scattering::Medium(_) => self.value().f,
        }
    }

    /// Density of drawing `wi` by a walk that came along -`wo`. Measure: solid angle, 1/sr; from a
    /// light at infinity area of the disk that its rays cross, 1/m². Without Dirac lobes: it integrates
    /// to the probability of the others.
    #[inline]
    pub fn pdf(&self, context: &PathContext<'_>) -> f32 {
        match &self.vertex.scattering {
            Scattering::Camera | Scattering::Light => {
                self.vertex.pdf_leaving(context, self.wi.world)
            }
            Scattering::Surface(_) | Scattering::Medium(_) => self.value().pdf,
        }
    }

    /// Density of drawing `wo` by a walk that comes along -`wi`, in the measure of [`pdf`](Self::pdf), and the largest
    /// lane of the albedo that the walk meets. At a camera or a light the density is 0, as paths end there.
    #[inline]
    pub(super) fn reversed(&self) -> (f32, f32) {
        match &self.vertex.scattering {
            Scattering::Surface(_) | Scattering::Medium(_) => {
                let value = self.value();
                (value.pdf_reverse, value.albedo_reverse)
            }
            Scattering::Camera | Scattering::Light => (0.0, 1.0),
        }
    }
}

/// σ_s p and the densities of a medium, which are p in both directions.
#[inline]
fn phase_value(medium: &MediumScattering, wo: Vec3, wi: Vec3) -> BsdfValue {
    let p = medium.phase.eval(wo, wi);
    BsdfValue {
        f: medium.coefficient * p,
        pdf: p,
        pdf_reverse: p,
        albedo_reverse: medium.albedo.max_lane(),
    }
}

impl Vertex {
    /// The emission or importance of the first vertex of a walk along `w`; zero for other vertices.
    #[inline]
    pub(super) fn leaving(&self, context: &PathContext<'_>, w: Vec3) -> Spectrum {
        match (&self.scattering, self.light) {
            (Scattering::Camera, _) => Spectrum::splat(context.job.view.camera().importance(w)),
            (Scattering::Light, Some(light)) => context.emitted(light, &self.light_point(), w),
            _ => Spectrum::ZERO,
        }
    }

    /// The density of `w` in walks that begin here, in the measure of [`Turn::pdf`]; zero where none does.
    #[inline]
    pub(super) fn pdf_leaving(&self, context: &PathContext<'_>, w: Vec3) -> f32 {
        let scene = context.job.scene;
        match (&self.scattering, self.light) {
            (Scattering::Camera, _) => context.job.view.camera().pdf_direction(w),
            (Scattering::Light, Some(light)) => {
                let (light, at) = (scene.light(light), self.light_point());
                light.pdf_direction(&scene.light_context(), &at, w)
            }
            _ => 0.0,
        }
    }

    /// The albedo for a walk that comes along -`w`; 1 at the ends of paths.
    pub fn albedo(&self, w: Vec3) -> Spectrum {
        match &self.scattering {
            Scattering::Surface(bsdf) => bsdf.albedo(self.frame.to_local(w)),
            Scattering::Medium(medium) => medium.albedo,
            Scattering::Camera | Scattering::Light => Spectrum::ONE,
        }
    }

    /// The vertex of a walk of `mode` that came along -`wo` and goes on along `wi`.
    #[inline]
    pub fn turn(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Turn<'_> {
        Turn {
            vertex: self,
            mode,
            wo: Side::new(self, wo),
            wi: Side::new(self, wi),
            value: Cell::new(None),
        }
    }

    /// Draws the next direction of a walk. None: nothing is scattered.
    #[inline(always)] // Into both kinds of walks.
    pub(super) fn sample_scatter(
        &self,
        mode: TransportMode,
        u_lobe: impl FnOnce() -> f32,
        u: Vec2,
    ) -> Option<Scattered> {
        let bsdf = match &self.scattering {
            Scattering::Surface(bsdf) => bsdf,
            Scattering::Medium(medium) => return self.sample_phase(medium, u),
            Scattering::Camera | Scattering::Light => return None,
        };
        let wo = Side::new(self, self.wo);
        let sample = bsdf.sample(wo.local, mode, u_lobe, u)?;
        let wi = Side::new(self, self.frame.to_world(sample.wi));
        if !wo.agrees() || !wi.agrees() {
            return None;
        }
        // `sample.weight` has the shading cosine of `wi`: for radiance that is `scatter` times the
        // geometric cosine already.
        let weight = match mode {
            TransportMode::Radiance => sample.weight,
            TransportMode::Importance => sample.weight * (wo.normal_ratio() / wi.normal_ratio()),
        };
        Some(Scattered {
            wi: wi.world,
            weight,
            pdf: sample.pdf,
            pdf_reverse: sample.pdf_reverse,
            albedo_reverse: sample.albedo_reverse,
            is_delta: sample.is_delta,
        })
    }

    /// Draws the next direction of a walk by the phase function. None: the medium only absorbs.
    #[inline(never)]
    fn sample_phase(&self, medium: &MediumScattering, u: Vec2) -> Option<Scattered> {
        let wi = medium.phase.sample(self.wo, u);
        let pdf = medium.phase.eval(self.wo, wi);
        (!medium.coefficient.is_black()).then(|| Scattered {
            wi,
            weight: medium.coefficient,
            pdf,
            pdf_reverse: pdf,
            albedo_reverse: medium.albedo.max_lane(),
            is_delta: false,
        })
    }
}

impl PathContext<'_> {
    /// The emission of light number `light` from `at` along the unit direction `w`: radiance, intensity or
    /// irradiance, as [`Light::emitted`](crate::light::Light::emitted) says.
    #[inline]
    pub(crate) fn emitted(&self, light: u32, at: &LightPoint, w: Vec3) -> Spectrum {
        let scene = self.job.scene;
        let emitted = scene.light(light).emitted(&scene.light_context(), at, w);
        scene.color().illuminant(emitted, &self.wavelengths)
    }
}
