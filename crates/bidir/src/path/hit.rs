//! s = 0: the light that a camera walk comes upon by itself, at a vertex on a light or where it escapes.

use super::{Escape, Job, PathDensities, Segment, Subpath, Vertex};
use crate::light::LightPoint;
use crate::math::Vec3;
use crate::scene::Scene;
use crate::spectrum::Spectrum;

/// A camera walk that came upon a light.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// The light, by index.
    pub light: u32,
    /// Its point.
    pub at: LightPoint,
    /// The unit direction back along the walk.
    pub wo: Vec3,
    /// Throughput up to the light.
    pub beta: Spectrum,
    /// The density of the point as the walk drew it, without roulette. Measure: area, 1/m²; in a medium volume, 1/m³;
    /// at infinity solid angle, 1/sr.
    pub pdf: f32,
    /// The factor that turns a density of the direction `wo` into one of the vertex before.
    pub to_previous: f32,
}

impl Arrival {
    /// Returns the arrival at a vertex of the walk. None: it is on no light.
    #[inline]
    pub(crate) fn at(vertex: &Vertex) -> Option<Self> {
        Some(Self {
            light: vertex.light?,
            at: vertex.light_point(),
            wo: vertex.wo,
            beta: vertex.beta,
            pdf: vertex.pdf_fwd,
            to_previous: vertex.to_previous,
        })
    }

    /// Returns the arrivals of the walk `camera` at lights, on its vertices and where it escaped to those at infinity,
    /// each with the vertices before it.
    #[inline]
    pub fn all<'a>(
        scene: &'a Scene,
        camera: &Subpath<'a>,
    ) -> impl Iterator<Item = (&'a [Vertex], Self)> {
        let Subpath {
            vertices, escape, ..
        } = *camera;
        let met = move |i| Some((&vertices[..i], Self::at(&vertices[i])?));
        let escaped = move |escape| Self::of_escape(scene, escape);
        let at_infinity = escape.into_iter().flat_map(escaped);
        (1..vertices.len())
            .filter_map(met)
            .chain(at_infinity.map(move |arrival| (vertices, arrival)))
    }

    /// Returns the arrivals at the lights at infinity that the walk escaped to.
    #[inline]
    pub(crate) fn of_escape(scene: &Scene, escape: Escape) -> impl Iterator<Item = Self> {
        scene.environment().iter().map(move |&light| Self {
            light,
            at: LightPoint::at_infinity(escape.direction),
            wo: -escape.direction,
            beta: escape.beta,
            pdf: escape.pdf_fwd,
            to_previous: escape.to_previous,
        })
    }

    /// Returns C = β L_e: the contribution before its weight.
    #[inline]
    pub fn contribution(&self, job: &Job<'_>) -> Spectrum {
        self.beta * job.emitted(self.light, &self.at, self.wo)
    }
}

/// s = 0: the path of a camera walk that went from its last vertex, y, to a light at x_0.
#[derive(Clone, Debug)]
pub struct HitPath<'a> {
    /// The light, as the first vertex of a light subpath.
    pub x0: Vertex,
    /// The vertices of the walk.
    pub camera: &'a [Vertex],
    /// From x_0 to y.
    pub(super) segment: Segment,
    /// The density of x_0 as the walk drew it, without roulette.
    pub(super) drawn_pdf: f32,
}

impl<'a> HitPath<'a> {
    /// Returns the path of the walk `camera` that arrived at a light.
    #[inline]
    pub fn new(job: &Job<'_>, arrival: &Arrival, camera: &'a [Vertex]) -> Self {
        let x0 = Vertex::light(job, arrival.light, &arrival.at);
        let mut segment = x0.segment_to(&camera[camera.len() - 1]);
        // Without media, the ends of the segment know the way back.
        if job.scene.has_media() && arrival.to_previous > 0.0 {
            segment.to_b = arrival.to_previous;
        }
        Self {
            x0,
            camera,
            segment,
            drawn_pdf: arrival.pdf,
        }
    }

    /// Returns the last vertex of the walk.
    #[inline]
    pub(super) fn y(&self) -> &'a Vertex {
        &self.camera[self.camera.len() - 1]
    }

    /// Returns the weight of coming to the path in this way.
    #[inline]
    pub fn weight(&self, job: &Job<'_>, densities: &mut PathDensities) -> f32 {
        densities.gather_hit(job, self);
        densities.weight(job, 0)
    }
}
