//! C = β_L · scatter(z) · G(z, y) · scatter(y) · β_C: what a connection of two subpaths is worth
//! [Veach97, §10.2]; its weight; and n_j, how often each strategy has the chance.
//!
//! No ray is traced here: visibility is the caller's to ask for.

use super::{Junction, PathContext, PathDensities, Vertex, mis_weight};
use crate::bsdf::TransportMode;
use crate::light::LightPoint;
use crate::math::Vec2;
use crate::spectrum::Spectrum;

/// The contribution of joining the ends of two subpaths, before weight and visibility:
/// β_L · scatter(z) · G(z, y) · scatter(y) · β_C. Zero where either end is a Dirac scattering.
#[inline]
pub fn connect(context: &PathContext<'_>, light: &[Vertex], camera: &[Vertex]) -> Spectrum {
    let (Some(z), Some(y)) = (light.last(), camera.last()) else {
        return Spectrum::ZERO;
    };
    if z.is_delta() || y.is_delta() {
        return Spectrum::ZERO;
    }
    let geometry = z.geometry_term(y);
    if geometry == 0.0 {
        return Spectrum::ZERO;
    }
    let w = z.toward(y);
    let at_light = z.scatter(context, z.wo, w, TransportMode::Importance);
    if at_light.is_black() {
        return Spectrum::ZERO;
    }
    let at_camera = y.scatter(context, y.wo, -w, TransportMode::Radiance);
    z.beta * at_light * at_camera * y.beta * geometry
}

/// A light point of its own for the camera vertex `receiver`: the light subpath of strategy s = 1.
///
/// None: there is no light, the draw has no density, or nothing of the light is there.
#[inline]
pub fn next_event_vertex(
    context: &PathContext<'_>,
    receiver: &Vertex,
    u_light: f32,
    u: Vec2,
) -> Option<Vertex> {
    let scene = context.scene;
    let (light, prob) = scene.light_choice().sample(u_light)?;
    let lights = scene.light_context();
    let sample = scene.lights()[light].sample_next_event(&lights, receiver.point, u)?;
    let mut vertex = Vertex::light(context, light as u32, &sample.at);
    vertex.beta = Spectrum::splat(sample.coverage / (prob * sample.pdf));
    (sample.coverage > 0.0).then_some(vertex)
}

/// The density e(x_0 | x_1) with which [`next_event_vertex`] draws the point `at` of light number
/// `light` for the camera vertex `receiver`. Measure: area, 1/m²; solid angle, 1/sr, for a light at
/// infinity.
#[inline]
pub fn next_event_pdf(
    context: &PathContext<'_>,
    receiver: &Vertex,
    light: u32,
    at: &LightPoint,
) -> f32 {
    let scene = context.scene;
    let prob = scene.light_choice().prob(light as usize);
    prob * scene
        .light(light)
        .pdf_next_event(&scene.light_context(), receiver.point, at)
}

/// The weight of making the path that joins `light` and `camera` by strategy `s`.
///
/// For s = 0 the light subpath is the vertex that was hit, as a light vertex
/// ([`Junction::Hit`]); else `s` is its length.
#[inline]
pub fn weight(
    context: &PathContext<'_>,
    densities: &mut PathDensities,
    light: &[Vertex],
    camera: &[Vertex],
    junction: Junction,
) -> f32 {
    densities.gather(context, light, camera, junction);
    let n = light.len() + camera.len();
    let s = match junction {
        Junction::Hit => 0,
        Junction::Connection => light.len(),
    };
    mis_weight(
        densities,
        |j| context.count(j, n - j),
        context.settings.mis,
        s,
    ) as f32
}

impl PathContext<'_> {
    /// n_j: how many samples strategy (s, t) takes of each of its paths in a pass. Camera densities
    /// count per pixel, so every strategy that begins at the camera takes one; the light image takes
    /// one per light subpath. This is the only place where normalisation meets weights.
    #[inline]
    pub fn count(&self, s: usize, t: usize) -> f64 {
        match t {
            _ if !self.settings.strategies.contains(s, t) => 0.0,
            1 => self.scene.film().light_paths() as f64,
            _ => 1.0,
        }
    }
}
