//! β_{i+1} = β_i · scatter · |cosθ| / (p q), p the density of the direction (solid angle, 1/sr) and
//! q the roulette's: walks from the lens and from a light, which note the densities of both
//! directions.
//!
//! A walk ends by escape, by roulette, where nothing scatters, or at the limit of path length. It
//! adds nothing to any image.

use super::{PathContext, Segment, Vertex};
use crate::bsdf::TransportMode;
use crate::camera::CameraRay;
use crate::light::EmissionSample;
use crate::locus::Locus;
use crate::math::Vec3;
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::scene::Chances;
use crate::spectrum::Spectrum;
use crate::stats::Stats;

/// A camera walk that left the scene.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// The unit direction.
    pub direction: Vec3,
    /// Throughput, the last scattering included.
    pub beta: Spectrum,
    /// The density of the direction, without roulette. Measure: solid angle, 1/sr.
    pub pdf_fwd: f32,
}

/// The vertices of one walk, from its end of the path.
#[derive(Debug, Default)]
pub struct Subpath {
    /// The vertices; empty where the walk could not start.
    pub vertices: Vec<Vertex>,
    /// The walk's escape from the scene, if it left it.
    pub escape: Option<Escape>,
}

/// The state of a walk between two vertices.
struct Step {
    direction: Vec3,
    beta: Spectrum,
    /// The density of `direction` at the last vertex.
    pdf_w: f32,
}

/// The data that a walk does not change.
struct Walker<'a> {
    context: &'a PathContext<'a>,
    mode: TransportMode,
    stream: &'a SampleStream,
    max_vertices: usize,
}

/// Walks a camera subpath that starts with `ray` and the weight `weight` of its film position.
pub fn camera_subpath(
    context: &PathContext<'_>,
    stream: &SampleStream,
    ray: &CameraRay,
    weight: f32,
    subpath: &mut Subpath,
    stats: &mut Stats,
) {
    subpath.clear();
    subpath.vertices.push(Vertex::camera(&ray.lens));
    let walker = Walker {
        context,
        mode: TransportMode::Radiance,
        stream,
        max_vertices: context.settings.max_vertices(),
    };
    let step = Step {
        direction: ray.direction,
        beta: Spectrum::splat(weight),
        pdf_w: context.view.camera().pdf_direction(ray.direction),
    };
    walker.walk(subpath, ray.origin, step, &mut stats.rays.camera);
}

/// Walks a light subpath.
pub fn light_subpath(
    context: &PathContext<'_>,
    stream: &SampleStream,
    subpath: &mut Subpath,
    stats: &mut Stats,
) {
    subpath.clear();
    let Some((start, emission)) = draw_emission(context, stream) else {
        return;
    };
    let emitted = context
        .scene
        .color()
        .illuminant(emission.emitted_cos, &context.wavelengths);
    let step = Step {
        direction: emission.direction,
        beta: emitted * (emission.from.coverage / (start.pdf_fwd * emission.pdf_direction)),
        pdf_w: emission.pdf_direction,
    };
    let start_of_ray = Locus {
        point: emission.origin,
        ..start.locus
    };
    let origin = start_of_ray.ray_origin(emission.direction);
    subpath.vertices.push(start);
    let walker = Walker {
        context,
        mode: TransportMode::Importance,
        stream,
        // At least the lens is the camera's.
        max_vertices: context.settings.max_vertices() - 1,
    };
    walker.walk(subpath, origin, step, &mut stats.rays.light);
}

/// Draws the start of a light subpath and the ray that leaves it. None: the draw has no density, or
/// nothing of the light is there.
fn draw_emission(
    context: &PathContext<'_>,
    stream: &SampleStream,
) -> Option<(Vertex, EmissionSample)> {
    let scene = context.scene;
    let at = |purpose| Dimension::at(0, purpose);
    let u_light = || stream.get_1d(at(Purpose::Light));
    let (light, prob) = context.emission().sample(u_light)?;
    let u_position = stream.get_2d(at(Purpose::LightPosition));
    let u_direction = stream.get_2d(at(Purpose::LightDirection));
    let lights = scene.light_context();
    let emission = scene.lights()[light].sample_emission(&lights, u_position, u_direction)?;
    let from = &emission.from;
    let mut start = Vertex::on_light(context, light as u32, &from.at, prob * from.pdf);
    start.beta = Spectrum::splat(from.coverage / start.pdf_fwd);
    (from.coverage > 0.0).then_some((start, emission))
}

impl Subpath {
    /// Forgets the walk, and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.vertices.clear();
        self.escape = None;
    }
}

impl Walker<'_> {
    /// Extends the subpath vertex by vertex until it escapes, ends by roulette, or is full.
    fn walk(&self, subpath: &mut Subpath, origin: Vec3, step: Step, rays: &mut u64) {
        let (mut origin, mut step) = (origin, step);
        let start = magnitude(step.beta);
        while subpath.vertices.len() < self.max_vertices {
            *rays += 1;
            let chances = Chances::new(self.stream, subpath.vertices.len());
            let hit = self
                .context
                .scene
                .intersect(origin, step.direction, chances);
            let Some(hit) = hit else {
                subpath.escape = Some(Escape {
                    direction: step.direction,
                    beta: step.beta,
                    pdf_fwd: step.pdf_w,
                });
                return;
            };
            let at = Dimension::at(subpath.vertices.len(), Purpose::Mix);
            let u_mix = || self.stream.get_1d(at);
            let wo = -step.direction;
            let mut vertex = Vertex::surface(self.context, &hit, wo, step.beta, u_mix);
            let last = subpath.vertices.len() - 1;
            let from = subpath.vertices[last].locus;
            let segment = Segment::along(&from, &vertex.locus, step.direction);
            vertex.pdf_fwd = step.pdf_w * segment.to_b;
            vertex.to_previous = segment.to_a;
            // Rounding put the vertex on the one before it, in a corner: no density, no path.
            if vertex.pdf_fwd == 0.0 {
                return;
            }
            subpath.vertices.push(vertex);
            if subpath.vertices.len() == self.max_vertices {
                return;
            }
            let Some(next) = self.scatter(&mut subpath.vertices, start) else {
                return;
            };
            let vertex = &subpath.vertices[last + 1];
            origin = vertex.locus.ray_origin(next.direction);
            step = next;
        }
    }

    /// Scatters at the last of `vertices`. None: the walk ends there.
    fn scatter(&self, vertices: &mut [Vertex], start: f32) -> Option<Step> {
        let index = vertices.len() - 1;
        let [.., previous, vertex] = vertices else {
            return None;
        };
        let at = |purpose| Dimension::at(index, purpose);
        let u_lobe = || self.stream.get_1d(at(Purpose::Lobe));
        let u = self.stream.get_2d(at(Purpose::Scatter));
        let scattered = vertex.sample_scatter(self.mode, u_lobe, u)?;
        previous.pdf_rev = scattered.pdf_reverse * vertex.to_previous;
        vertex.went_by_delta = scattered.is_delta;
        vertex.albedo_rev = scattered.albedo_reverse;
        let beta = vertex.beta * scattered.weight;
        let survival = self.context.settings.roulette.survival_prob(
            index - 1,
            vertex.albedo_fwd,
            magnitude(beta) / start,
        );
        // Only a probability below 1 costs a number; zero ends the walk for sure.
        if survival < 1.0 && self.stream.get_1d(at(Purpose::Roulette)) >= survival {
            return None;
        }
        Some(Step {
            direction: scattered.wi,
            beta: beta / survival,
            pdf_w: scattered.pdf,
        })
    }
}

/// The largest lane, whatever its sign: a filter may be negative. Never zero, so that throughput
/// relative to it is defined.
#[inline]
fn magnitude(beta: Spectrum) -> f32 {
    beta.map(f32::abs).max_lane().max(f32::MIN_POSITIVE)
}
