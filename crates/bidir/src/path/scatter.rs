//! The effect of a vertex on light: its value scatter(wo, wi) in the integrand, the directions that walks
//! draw there, and their densities. Visibility and roulette are no part of it.

use super::visible::on_side;
use super::{Job, Scattering, Vertex};
use crate::bsdf::{Bsdf, BsdfSample, BsdfValue, TransportMode};
use crate::light::LightPoint;
use crate::math::{Frame, Vec2, Vec3};
use crate::medium::MediumScattering;
use crate::spectrum::Spectrum;
use std::cell::Cell;

/// A vertex with the directions towards both of its neighbours on a path.
///
/// A walk of `mode` came from `wo` and goes on along `wi`. All questions share the local coordinates of both, and the
/// value of the BSDF or the medium, which is evaluated for the first of them that needs it.
#[derive(Clone, Debug)]
pub struct ScatteringEvent<'a> {
    pub(crate) vertex: &'a Vertex,
    mode: TransportMode,
    wo: Side,
    wi: Side,
    value: Cell<Option<BsdfValue>>,
}

/// A unit direction at a vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) world: Vec3,
    /// In the shading frame of a surface.
    pub(super) local: Vec3,
    /// The cosine to its geometric normal.
    pub(super) cos_g: f32,
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

    /// Makes a direction where there are no normals.
    #[inline]
    fn in_space(world: Vec3) -> Self {
        Self {
            world,
            local: Vec3::ZERO,
            cos_g: 0.0,
        }
    }

    /// Returns true where both normals see it on the same side.
    #[inline]
    fn agrees(&self) -> bool {
        self.local.z * self.cos_g > 0.0
    }

    /// |ω·n_s| / |ω·n_g|.
    #[inline]
    fn normal_ratio(&self) -> f32 {
        (self.local.z / self.cos_g).abs()
    }

    /// The same, 0 where the normals disagree.
    #[inline]
    fn lit_ratio(&self) -> f32 {
        if self.agrees() {
            self.normal_ratio()
        } else {
            0.0
        }
    }
}

impl ScatteringEvent<'_> {
    /// Returns the value of a surface or of a medium, f with the ratio of [`scatter`](Self::scatter); cameras and
    /// lights have none.
    #[inline]
    fn value(&self) -> BsdfValue {
        self.value.get().unwrap_or_else(|| {
            let Self { wo, wi, .. } = self;
            let value = match &self.vertex.scattering {
                Scattering::Surface(bsdf) => self.surface_value(bsdf),
                Scattering::Medium(medium) => phase_value(medium, wo.world, wi.world),
                Scattering::Camera | Scattering::Light => BsdfValue::NONE,
            };
            self.value.set(Some(value));
            value
        })
    }

    #[inline]
    fn surface_value(&self, bsdf: &Bsdf) -> BsdfValue {
        let Self { wo, wi, mode, .. } = self;
        let (camera, light) = match mode {
            TransportMode::Radiance => (wo, wi),
            TransportMode::Importance => (wi, wo),
        };
        if !self.vertex.is_seen_plainly(bsdf, camera) {
            return self
                .vertex
                .value_by_frames(bsdf, [wo.world, wi.world], *mode);
        }
        let value = bsdf.eval(wo.local, wi.local, *mode);
        let f = value.f * light.lit_ratio();
        BsdfValue { f, ..value }
    }

    /// Returns the value of the vertex in the measurement contribution: scattering, emission or
    /// importance.
    ///
    /// The whole integrand is Π scatter · Π G over **geometric** cosines, so scattering carries
    /// |ω·n_s| / |ω·n_g| with ω the direction that light comes from: `wi` for radiance, `wo` for
    /// importance. That is the adjoint of shading normals [Veach97, §5.3]; it makes the
    /// integrand one function of the path, whichever end a walk began at. If shading and
    /// geometric normal disagree on the side of ω, nothing is scattered; towards the camera the shading normal
    /// turns (`visible`).
    #[inline]
    pub fn scatter(&self, job: &Job<'_>) -> Spectrum {
        match &self.vertex.scattering {
            Scattering::Camera | Scattering::Light => self.vertex.leaving(job, self.wi.world),
            Scattering::Surface(_) | Scattering::Medium(_) => self.value().f,
        }
    }

    /// Returns the density of drawing `wi` by a walk that came along -`wo`. Measure: solid angle, 1/sr; from a
    /// light at infinity area of the disk that its rays cross, 1/m². Without Dirac lobes: it integrates
    /// to the probability of the others.
    #[inline]
    pub fn pdf(&self, job: &Job<'_>) -> f32 {
        match &self.vertex.scattering {
            Scattering::Camera | Scattering::Light => self.vertex.pdf_leaving(job, self.wi.world),
            Scattering::Surface(_) | Scattering::Medium(_) => self.value().pdf,
        }
    }

    /// Returns the density of drawing `wo` by a walk that comes along -`wi`, in the measure of [`pdf`](Self::pdf), and
    /// the largest lane of the albedo that the walk meets. At a camera or a light the density is 0, as paths end there.
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

/// Returns σ_s p and the densities of a medium, which are p in both directions.
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

/// Returns the albedo of a surface of these shading frame and geometric normal along `w`, seen from the side of that
/// normal.
#[inline]
pub(super) fn albedo_seen(bsdf: &Bsdf, frame: &Frame, n_g: Vec3, w: Vec3) -> Spectrum {
    // A diffuse albedo is the same in all directions, so the local one is not needed.
    if let Bsdf::Diffuse(bsdf) = bsdf {
        return bsdf.reflectance;
    }
    let local = frame.to_local(w);
    let cos = local.z.abs().copysign(n_g.dot(w));
    bsdf.albedo(local.with_z(cos))
}

impl Vertex {
    /// Returns the emission or importance of the first vertex of a walk along `w`; zero for other vertices.
    #[inline]
    pub(super) fn leaving(&self, job: &Job<'_>, w: Vec3) -> Spectrum {
        match (&self.scattering, self.light) {
            (Scattering::Camera, _) => Spectrum::splat(job.view.camera().importance(w)),
            (Scattering::Light, Some(light)) => job.emitted(light, &self.light_point(), w),
            _ => Spectrum::ZERO,
        }
    }

    /// Returns the density of `w` in walks that begin here, in the measure of [`ScatteringEvent::pdf`]; zero where none does.
    #[inline]
    pub(super) fn pdf_leaving(&self, job: &Job<'_>, w: Vec3) -> f32 {
        let scene = job.scene;
        match (&self.scattering, self.light) {
            (Scattering::Camera, _) => job.view.camera().pdf_direction(w),
            (Scattering::Light, Some(light)) => {
                let (light, at) = (scene.light(light), self.light_point());
                light.pdf_direction(&scene.light_context(), &at, w)
            }
            _ => 0.0,
        }
    }

    /// Returns the albedo for a walk that comes along -`w`; 1 at the ends of paths.
    #[inline]
    pub fn albedo(&self, w: Vec3) -> Spectrum {
        match &self.scattering {
            Scattering::Surface(bsdf) => albedo_seen(bsdf, &self.frame, self.locus.n_g, w),
            Scattering::Medium(medium) => medium.albedo,
            Scattering::Camera | Scattering::Light => Spectrum::ONE,
        }
    }

    /// Returns the vertex of a walk of `mode` that came along -`wo` and goes on along `wi`.
    #[inline]
    pub fn event(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> ScatteringEvent<'_> {
        let side = |w| match self.scattering {
            Scattering::Surface(_) => Side::new(self, w),
            Scattering::Medium(_) | Scattering::Camera | Scattering::Light => Side::in_space(w),
        };
        ScatteringEvent {
            vertex: self,
            mode,
            wo: side(wo),
            wi: side(wi),
            value: Cell::new(None),
        }
    }

    /// Draws the next direction of a walk, in world space; its weight has the geometric cosine. None: nothing is
    /// scattered.
    #[inline(always)] // Into both kinds of walks.
    pub(super) fn sample_scatter(
        &self,
        mode: TransportMode,
        u_lobe: impl FnOnce() -> f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let bsdf = match &self.scattering {
            Scattering::Surface(bsdf) => bsdf,
            Scattering::Medium(medium) => return self.sample_phase(medium, u),
            Scattering::Camera | Scattering::Light => return None,
        };
        let wo = Side::new(self, self.wo);
        let is_plain = match mode {
            TransportMode::Radiance => self.is_seen_plainly(bsdf, &wo),
            TransportMode::Importance => wo.agrees() && bsdf.coat_normal().is_none(),
        };
        if !is_plain {
            return self.sample_by_frames(bsdf, mode, u_lobe(), u);
        }
        let sample = bsdf.sample(wo.local, mode, u_lobe, u)?;
        let wi = Side::new(self, self.frame.to_world(sample.wi));
        // `sample.weight` has the shading cosine of `wi`: for radiance that is `scatter` times the
        // geometric cosine already.
        let weight = match mode {
            TransportMode::Radiance if wi.agrees() => sample.weight,
            TransportMode::Importance if self.is_seen_plainly(bsdf, &wi) => {
                sample.weight * (wo.normal_ratio() / wi.normal_ratio())
            }
            TransportMode::Radiance => return None,
            // A Dirac lobe leads elsewhere by the frame that this direction sees.
            TransportMode::Importance if sample.is_delta => return None,
            TransportMode::Importance => {
                let wi = on_side(wi.world, wi.local.z * wi.cos_g);
                return self.finite_scattered(bsdf, wi, mode);
            }
        };
        Some(BsdfSample {
            wi: wi.world,
            weight,
            ..sample
        })
    }

    /// Draws the next direction of a walk by the phase function. None: the medium only absorbs.
    #[inline(never)]
    fn sample_phase(&self, medium: &MediumScattering, u: Vec2) -> Option<BsdfSample> {
        let wi = medium.phase.sample(self.wo, u);
        let pdf = medium.phase.eval(self.wo, wi);
        (!medium.coefficient.is_black()).then(|| BsdfSample {
            wi,
            weight: medium.coefficient,
            pdf,
            pdf_reverse: pdf,
            albedo_reverse: medium.albedo.max_lane(),
            is_delta: false,
        })
    }
}

impl Job<'_> {
    /// Returns the emission of light number `light` from `at` along the unit direction `w`: radiance, intensity or
    /// irradiance, as [`Light::emitted`](crate::light::Light::emitted) says.
    #[inline]
    pub(crate) fn emitted(&self, light: u32, at: &LightPoint, w: Vec3) -> Spectrum {
        let scene = self.scene;
        let light = scene.light(light);
        light.emitted(&scene.light_context(), at, w, self.lanes)
    }
}
