//! Paths that connect two subpaths: their contribution C = β_L · scatter(z) · G(z, y) · scatter(y) · β_C
//! [Veach97, §10.2], and their weight.
//!
//! No ray is traced here: visibility is the caller's to ask for.

use super::{Job, LightChoiceKind, PathDensities, ScatteringEvent, Segment, Vertex};
use crate::bsdf::TransportMode;
use crate::light::{ChosenEmitter, LightChoice, LightPoint, LightSample, Part};
use crate::math::Vec2;
use crate::spectrum::Spectrum;

/// A path that connects a light subpath and a camera subpath, of at least one vertex each, and how their
/// ends see each other. s = 0 is a [`HitPath`](super::HitPath).
#[derive(Clone, Debug)]
pub struct JoinedPath<'a> {
    /// The light's part.
    pub light: &'a [Vertex],
    /// The camera's part.
    pub camera: &'a [Vertex],
    /// From the last light vertex, z, to the last camera vertex, y.
    pub segment: Segment,
    /// z and y, each between the vertex before it and the other.
    pub(super) events: [ScatteringEvent<'a>; 2],
}

impl<'a> JoinedPath<'a> {
    /// Returns the path that connects the ends of two subpaths.
    #[inline]
    pub fn new(light: &'a [Vertex], camera: &'a [Vertex]) -> Self {
        let (z, y) = (&light[light.len() - 1], &camera[camera.len() - 1]);
        Self::along(light, camera, z.segment_to(y))
    }

    /// The same path, where the segment between the ends is known.
    #[inline]
    pub(crate) fn along(light: &'a [Vertex], camera: &'a [Vertex], segment: Segment) -> Self {
        let (z, y) = (&light[light.len() - 1], &camera[camera.len() - 1]);
        Self {
            light,
            camera,
            segment,
            events: [
                z.event(z.wo, segment.w, TransportMode::Importance),
                y.event(y.wo, -segment.w, TransportMode::Radiance),
            ],
        }
    }

    /// Returns the last light vertex.
    #[inline]
    pub(crate) fn z(&self) -> &'a Vertex {
        &self.light[self.light.len() - 1]
    }

    /// Returns the last camera vertex.
    #[inline]
    pub(crate) fn y(&self) -> &'a Vertex {
        &self.camera[self.camera.len() - 1]
    }

    /// Returns x_i.
    #[inline]
    pub(super) fn vertex(&self, i: usize) -> &'a Vertex {
        let s = self.light.len();
        if i < s {
            &self.light[i]
        } else {
            &self.camera[self.len() - 1 - i]
        }
    }

    /// Returns the number of vertices.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.light.len() + self.camera.len()
    }

    /// Returns the contribution of a connection, before weight and visibility:
    /// β_L · scatter(z) · G(z, y) · scatter(y) · β_C. Zero where either end is a Dirac scattering. Unit: that
    /// of a pixel's radiance.
    #[inline]
    pub fn contribution(&self, job: &Job<'_>) -> Spectrum {
        let (z, y) = (self.z(), self.y());
        let geometry_term = self.segment.geometry_term;
        if geometry_term == 0.0 || z.is_delta() || y.is_delta() {
            return Spectrum::ZERO;
        }
        let [at_z, at_y] = &self.events;
        let at_light = at_z.scatter(job);
        if at_light.is_black() {
            return Spectrum::ZERO;
        }
        let at_camera = at_y.scatter(job);
        z.beta * at_light * at_camera * y.beta * geometry_term
    }

    /// Returns the weight of making the path in this way.
    #[inline]
    pub fn weight(&self, job: &Job<'_>, densities: &mut PathDensities) -> f32 {
        densities.gather_connection(job, self);
        densities.weight(job, self.light.len())
    }
}

/// Returns a light point drawn for the vertex `x1` of a camera subpath: the light's index, and the point with
/// its density e(x_0 | x_1), the light's probability included.
///
/// The number `u_light` is asked for where there is a choice of lights, `u_depth` in media that glow. None: there is no
/// light, the draw has no density, or nothing of the light is there.
#[inline]
pub fn sample_next_event(
    job: &Job<'_>,
    x1: &Vertex,
    u_light: impl FnOnce() -> f32,
    u: Vec2,
    u_depth: impl FnOnce() -> f32,
) -> Option<(u32, LightSample)> {
    let scene = job.scene;
    let ChosenEmitter { light, part, prob } = match job.settings.light_choice {
        LightChoiceKind::Power => {
            let (light, prob) = scene.light_choice().sample(u_light)?;
            let (light, part) = (light as u32, Part::Whole);
            ChosenEmitter { light, part, prob }
        }
        LightChoiceKind::Tree => {
            let tree = scene.light_tree();
            tree.sample(|| x1.receiver(x1.wo), u_light)?
        }
    };
    let lights = scene.light_context();
    let of_light = scene.light(light);
    let mut sample = of_light.sample_next_event(&lights, part, x1.locus.point, u, u_depth)?;
    sample.pdf *= prob;
    let is_there = sample.alpha > 0.0 && sample.pdf > 0.0 && scene.is_lit(of_light, &sample.at);
    is_there.then_some((light, sample))
}

/// Returns the density e(x_0 | x_1) with which [`sample_next_event`] draws the point `at` of light number
/// `light` for `x1`, a vertex of any subpath. Measure: that of the point, as in the table of [`crate::light`].
#[inline]
pub fn next_event_pdf(job: &Job<'_>, x1: &Vertex, light: u32, at: &LightPoint) -> f32 {
    let scene = job.scene;
    let (part, prob) = match job.settings.light_choice {
        LightChoiceKind::Power => (Part::Whole, scene.light_choice().prob(light as usize)),
        LightChoiceKind::Tree => {
            let receiver = || x1.receiver(at.locus.direction_from(x1.locus.point));
            let found = scene.light_tree().find(receiver, light, at.primitive);
            (found.part, found.prob)
        }
    };
    let lights = scene.light_context();
    let of_light = scene.light(light);
    prob * of_light.pdf_next_event(&lights, part, x1.locus.point, at)
}

impl Job<'_> {
    /// Returns true where strategy (s, t) takes part.
    #[inline]
    pub fn takes(&self, s: usize, t: usize) -> bool {
        self.settings.strategies.contains(s, t)
    }

    /// Returns how light subpaths choose the light that they begin on.
    #[inline]
    pub(super) fn emission(&self) -> &LightChoice {
        let learned = self.guide.light_start;
        learned.unwrap_or_else(|| self.scene.light_choice())
    }

    /// Returns √V̂ of the shadow ray between a light vertex `z` and a camera vertex `y`: 1 if nothing is learned, and
    /// at infinity, where there are no places.
    #[inline]
    pub(crate) fn root_visibility(&self, z: &Vertex, y: &Vertex) -> f32 {
        if z.locus.is_infinite() {
            1.0
        } else {
            self.guide.of_camera(y.cell).root_visibility(z.cell)
        }
    }
}
