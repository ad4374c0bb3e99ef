//! The data of vertices. The integrand f = Π scatter · Π G, over geometric cosines, is one function of the path,
//! whichever end a walk began at [Veach97, §5.3]; `scatter` and `segment` (G) have its factors.
//!
//! `scatter` is in 1/sr at a surface, in 1/(m sr) in a medium; densities are per area, 1/m² (per volume, 1/m³, in
//! a medium; solid angle, 1/sr, for a light at infinity). Visibility and roulette are no part of a vertex.

use super::scatter::albedo_seen;
use super::{Job, Segment};
use crate::bsdf::Bsdf;
use crate::camera::LensSample;
use crate::guide::Cell;
use crate::light::{Facing, LightPoint, Receiver};
use crate::locus::Locus;
use crate::math::{Frame, Vec3};
use crate::medium::{MediumId, MediumScattering, MediumSides};
use crate::scene::SurfaceHit;
use crate::spectrum::Spectrum;
use crate::texture::TexturePoint;

/// The effect of a vertex on light, by its kind.
#[derive(Clone, Copy, Debug)]
pub enum Scattering {
    /// The importance of a point on the lens, or of the direction towards a camera at infinity: the start of a
    /// camera subpath.
    Camera,
    /// The emission of a point on a light, or of a direction towards one at infinity: the start of a light
    /// subpath.
    Light,
    /// The BSDF of a point of a surface, emissive or not.
    Surface(Bsdf),
    /// The scattering of a point in a medium.
    Medium(MediumScattering),
}

/// A vertex of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// The place.
    pub locus: Locus,
    /// Its effect on light.
    pub scattering: Scattering,
    /// The frame that scattering is evaluated in; zero at the ends of paths, which have none.
    pub frame: Frame,
    /// The unit direction towards the previous vertex of the walk.
    pub wo: Vec3,
    /// Throughput up to this vertex, without the scattering at it.
    pub beta: Spectrum,
    /// The density with which its own walk draws this vertex, without roulette. For a point that was drawn on a light
    /// it is always that of a light subpath that begins there, even if next-event estimation drew the point.
    pub pdf_fwd: f32,
    /// The density of this vertex drawn from its successor by a walk in the other direction,
    /// without roulette; set when the successor scatters.
    pub pdf_rev: f32,
    /// The factor that turns a density of the direction `wo` here into one of the previous vertex; 0 where there is
    /// none.
    pub to_previous: f32,
    /// The largest lane of the albedo seen from the previous vertex.
    pub albedo_fwd: f32,
    /// The largest lane of the albedo seen from the next vertex; set when this vertex scatters.
    pub albedo_rev: f32,
    /// True if the walk went on by a Dirac lobe: then this vertex is a Dirac one on paths that use the
    /// walk's next step. Set when this vertex scatters.
    pub went_by_delta: bool,
    /// The light that the vertex lies on, by index.
    pub light: Option<u32>,
    /// The primitive of the light's shape.
    pub light_primitive: u32,
    /// The cell for which training learns about its connections.
    pub cell: Cell,
}

const _: () = assert!(size_of::<Vertex>() == 304);

impl Vertex {
    /// Makes a vertex without the data of a walk.
    fn new(locus: Locus, scattering: Scattering) -> Self {
        Self {
            locus,
            scattering,
            frame: Frame {
                x: Vec3::ZERO,
                y: Vec3::ZERO,
                z: Vec3::ZERO,
            },
            wo: Vec3::ZERO,
            beta: Spectrum::ONE,
            pdf_fwd: 0.0,
            pdf_rev: 0.0,
            to_previous: 0.0,
            albedo_fwd: 1.0,
            albedo_rev: 1.0,
            went_by_delta: false,
            light: None,
            light_primitive: 0,
            cell: Cell::default(),
        }
    }

    /// Makes a lens point in a medium, or a camera at infinity; `beta` is one over its density.
    pub fn camera(lens: &LensSample, medium: MediumId) -> Self {
        let media = MediumSides::all(medium);
        Self {
            beta: Spectrum::splat(1.0 / lens.pdf),
            pdf_fwd: lens.pdf,
            ..Self::new(lens.locus.within(media), Scattering::Camera)
        }
    }

    /// Makes a point on light number `light`, which light subpaths draw with density `pdf_fwd`.
    pub fn light(job: &Job<'_>, light: u32, at: &LightPoint) -> Self {
        let scene = job.scene;
        let prob = job.emission().prob(light as usize);
        let pdf_position = scene.light(light).pdf_position(&scene.light_context(), at);
        Self::on_light(job, light, at, prob * pdf_position)
    }

    /// Makes a point on light number `light`, the density of which is known.
    pub(super) fn on_light(job: &Job<'_>, light: u32, at: &LightPoint, pdf_fwd: f32) -> Self {
        let scene = job.scene;
        let mut locus = at.locus;
        if scene.has_media() {
            locus.media = scene.light_media(light);
        }
        Self {
            cell: job.guide.cell(at.locus.point, at.locus.n_g),
            pdf_fwd,
            light: Some(light),
            light_primitive: at.primitive,
            ..Self::new(locus, Scattering::Light)
        }
    }

    /// Makes a surface point reached along `-wo` with throughput `beta`. The number `u_mix` chooses among
    /// mixed materials; others do not ask for it.
    pub fn surface(
        job: &Job<'_>,
        hit: &SurfaceHit,
        wo: Vec3,
        beta: Spectrum,
        u_mix: impl FnOnce() -> f32,
    ) -> Self {
        let (scene, surface) = (job.scene, &hit.surface);
        let mut at = TexturePoint::new(surface);
        if let Some(differentials) = &hit.differentials {
            at = at.seen(job.view.footprint(surface.point), differentials);
        }
        let material = scene.material(hit.material).choose(&at, u_mix);
        let mut bsdf = material.bsdf(&at, job.lanes);
        bsdf.put_within(hit.around);
        let mut frame = surface.shading;
        if let Some(differentials) = &hit.differentials {
            if let Some(relief) = material.relief() {
                frame = relief.frame(surface, differentials, &at);
            }
            let coat = material.coat_normal(surface, &at);
            let is_apart = |n: &Vec3| n.distance_squared(frame.z) > 1e-10;
            if let Some(n) = coat.filter(is_apart) {
                bsdf.put_coat_normal(frame.to_local(n));
            }
        }
        let locus = surface.locus();
        Self {
            frame,
            wo,
            beta,
            albedo_fwd: albedo_seen(&bsdf, &frame, locus.n_g, wo).max_lane(),
            light: hit.light.map(|(light, _)| light),
            light_primitive: hit.light.map_or(0, |(_, at)| at.primitive),
            cell: job.guide.cell(surface.point, frame.z),
            ..Self::new(locus, Scattering::Surface(bsdf))
        }
    }

    /// Makes a point in a medium reached along `-wo` with throughput `beta`.
    pub fn medium(
        job: &Job<'_>,
        locus: Locus,
        scattering: MediumScattering,
        wo: Vec3,
        beta: Spectrum,
    ) -> Self {
        Self {
            wo,
            beta,
            albedo_fwd: scattering.albedo.max_lane(),
            light: job.scene.glow(locus.media.outside),
            cell: job.guide.cell(locus.point, locus.n_g),
            ..Self::new(locus, Scattering::Medium(scattering))
        }
    }

    /// Returns the vertex as a point of the light that it lies on.
    #[inline]
    pub fn light_point(&self) -> LightPoint {
        LightPoint {
            locus: self.locus,
            primitive: self.light_primitive,
        }
    }

    /// Returns its point and its unit normal: that of the shading frame where there is one.
    pub(crate) fn point_and_normal(&self) -> [Vec3; 2] {
        let n = match &self.scattering {
            Scattering::Surface(_) => self.frame.z,
            Scattering::Camera | Scattering::Light | Scattering::Medium(_) => self.locus.n_g,
        };
        [self.locus.point, n]
    }

    /// Returns the vertex as a receiver of light on a path that goes on along `w`, a vector of any length towards the
    /// light or towards the camera. Both give the same receiver: an opaque surface has both on one side.
    #[inline]
    pub fn receiver(&self, w: Vec3) -> Receiver {
        let facing = match &self.scattering {
            Scattering::Surface(bsdf) if !bsdf.transmits() => {
                let is_below = self.locus.n_g.dot(w) < 0.0;
                let n = self.frame.z;
                Facing::Front(if is_below { -n } else { n })
            }
            Scattering::Surface(_) => Facing::Both(self.frame.z),
            Scattering::Medium(_) => Facing::Anywhere,
            Scattering::Camera | Scattering::Light => Facing::Both(self.locus.n_g),
        };
        let point = self.locus.point;
        Receiver { point, facing }
    }

    /// Returns true if all scattering is a Dirac distribution, or there is none: nothing can connect here.
    /// [`went_by_delta`](Self::went_by_delta) is about the walk's own step.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match &self.scattering {
            Scattering::Surface(bsdf) => bsdf.is_delta(),
            Scattering::Medium(medium) => medium.coefficient.is_black(),
            Scattering::Camera | Scattering::Light => false,
        }
    }

    /// Returns true for a point on the lens, or a camera at infinity.
    #[inline]
    pub fn is_camera(&self) -> bool {
        matches!(self.scattering, Scattering::Camera)
    }

    /// Returns true if it is on a light that no ray can hit by chance.
    #[inline]
    pub(crate) fn is_on_delta_light(&self, job: &Job<'_>) -> bool {
        self.light
            .is_some_and(|light| job.scene.light(light).is_delta())
    }

    /// This vertex and `other` as they see each other; at most one of the two is at infinity.
    #[inline]
    pub fn segment_to(&self, other: &Self) -> Segment {
        Segment::between(&self.locus, &other.locus)
    }
}
