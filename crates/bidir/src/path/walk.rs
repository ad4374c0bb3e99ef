//! Walks that make camera and light subpaths. Each step has β_{i+1} = β_i · scatter · |cosθ| / (p q), with p the density
//! of the direction (solid angle, 1/sr) and q the probability that the walk goes on. Vertices get the densities of both
//! directions.
//!
//! A walk ends by escape, by roulette, where nothing scatters, or at the limit of path length. It
//! adds nothing to any image.

use super::{Escape, Job, Segment, Subpaths, Vertex};
use crate::bsdf::TransportMode;
use crate::camera::CameraRay;
use crate::light::EmissionSample;
use crate::locus::Locus;
use crate::math::Vec3;
use crate::sampler::{Dimension, Purpose, SampleStream};
use crate::scene::{Advance, Edge, Interaction, RayDraws, SurfaceHit, Transmittance};
use crate::spectrum::Spectrum;
use crate::stats::Stats;
use std::ops::ControlFlow::{self, Break, Continue};

/// Break: the walk ends, with its escape if it left the scene.
type Flow = ControlFlow<Option<Escape>>;

/// The state of a walk between two vertices.
struct Step {
    /// The origin of its ray.
    origin: Vec3,
    direction: Vec3,
    beta: Spectrum,
    /// The density of `direction` at the last vertex.
    pdf_w: f32,
}

/// The data that a walk does not change.
struct Walker<'a> {
    job: &'a Job<'a>,
    mode: TransportMode,
    stream: &'a SampleStream,
}

/// Walks a camera subpath that starts with `ray` and the weight `weight` of its film position, and adds it to
/// `subpaths`.
pub fn camera_subpath(
    job: &Job<'_>,
    stream: &SampleStream,
    ray: &CameraRay,
    weight: f32,
    subpaths: &mut Subpaths,
    stats: &mut Stats,
) {
    let walker = Walker {
        job,
        mode: TransportMode::Radiance,
        stream,
    };
    // Cameras draw rays in proportion to W_e |cosθ|, so that β begins with the filter's weight.
    let step = Step {
        origin: ray.origin,
        direction: ray.direction,
        beta: Spectrum::splat(weight),
        pdf_w: job.view.camera().pdf_direction(ray.direction),
    };
    let start = Vertex::camera(&ray.lens, job.medium);
    walker.walk(subpaths, &start, step, &mut stats.rays.camera);
}

/// Walks a light subpath, and adds it to `subpaths`.
pub fn light_subpath(
    job: &Job<'_>,
    stream: &SampleStream,
    subpaths: &mut Subpaths,
    stats: &mut Stats,
) {
    let Some((start, emission)) = draw_emission(job, stream) else {
        return subpaths.end(None);
    };
    let start_of_ray = Locus {
        point: emission.origin,
        ..start.locus
    };
    let step = Step {
        origin: start_of_ray.ray_origin(emission.direction),
        direction: emission.direction,
        beta: emission.emitted_cos
            * (emission.from.alpha / (start.pdf_fwd * emission.pdf_direction)),
        pdf_w: emission.pdf_direction,
    };
    let walker = Walker {
        job,
        mode: TransportMode::Importance,
        stream,
    };
    walker.walk(subpaths, &start, step, &mut stats.rays.light);
}

/// Draws the start of a light subpath and the ray that leaves it. None: its density is 0, the light is cut out at this
/// point, the point is outside of the medium that glows, or a medium without end lies before a light at infinity.
fn draw_emission(job: &Job<'_>, stream: &SampleStream) -> Option<(Vertex, EmissionSample)> {
    let scene = job.scene;
    let at = |purpose| Dimension::at(0, purpose);
    let u_light = || stream.get_1d(at(Purpose::Light));
    let (light, prob) = job.emission().sample(u_light)?;
    let u_position = stream.get_2d(at(Purpose::LightPosition));
    let u_direction = stream.get_2d(at(Purpose::LightDirection));
    let lights = scene.light_context();
    let of_light = &scene.lights()[light];
    let u_depth = || stream.get_1d(at(Purpose::LightDepth));
    let emission =
        of_light.sample_emission(&lights, u_position, u_depth, u_direction, job.lanes)?;
    let from = &emission.from;
    if !scene.is_lit(of_light, &from.at) {
        return None;
    }
    let mut start = Vertex::on_light(job, light as u32, &from.at, prob * from.pdf);
    if start.locus.is_infinite() && !scene.is_open() {
        return None;
    }
    start.beta = Spectrum::splat(from.alpha / start.pdf_fwd);
    (from.alpha > 0.0).then_some((start, emission))
}

impl Walker<'_> {
    /// Adds a walk that begins with a vertex and a step.
    fn walk(&self, subpaths: &mut Subpaths, start: &Vertex, step: Step, rays: &mut u64) {
        let first = subpaths.vertices.len();
        subpaths.vertices.push(*start);
        let escape = self.extend(&mut subpaths.vertices, first, step, rays);
        subpaths.end(escape);
    }

    /// Extends the walk, `vertices` from `first` on, until it escapes, ends by roulette, or is full.
    fn extend(
        &self,
        vertices: &mut Vec<Vertex>,
        first: usize,
        mut step: Step,
        rays: &mut u64,
    ) -> Option<Escape> {
        let start = magnitude(step.beta);
        // Each strategy has t ≥ 1: a light walk leaves one vertex for the lens.
        let for_lens = usize::from(self.mode == TransportMode::Importance);
        let most = self.job.settings.max_vertices() - for_lens;
        for count in 1..most {
            *rays += 1;
            if let Break(escape) = self.advance(vertices, &step, count) {
                return escape;
            }
            if count + 1 < most {
                step = self.scatter(&mut vertices[first..], start)?;
            }
        }
        None
    }

    /// Adds vertex number `index`, the surface or the point in a medium that `step` leads to.
    #[inline(always)]
    fn advance(&self, vertices: &mut Vec<Vertex>, step: &Step, index: usize) -> Flow {
        let scene = self.job.scene;
        if scene.has_media() {
            return self.advance_in_media(vertices, step, index);
        }
        let chances = RayDraws::new(self.stream, index).until(self.job.stop);
        let Some(hit) = scene.intersect(step.origin, step.direction, chances) else {
            let from = vertices[vertices.len() - 1].locus;
            return Break(self.escape(&from, step, None));
        };
        vertices.push(self.surface(&hit, step, index));
        reach(vertices, step, None)
    }

    /// The same where media are in the scene.
    #[inline(never)]
    fn advance_in_media(&self, vertices: &mut Vec<Vertex>, step: &Step, index: usize) -> Flow {
        let from = vertices[vertices.len() - 1].locus;
        let chances = RayDraws::new(self.stream, index).until(self.job.stop);
        let (scene, lanes) = (self.job.scene, self.job.lanes);
        let ray = accel::Ray::new(step.origin, step.direction);
        let medium = from.medium_toward(step.direction);
        let Advance {
            interaction,
            transmittance,
        } = scene.advance(&ray, medium, chances, lanes);
        let vertex = match &interaction {
            Interaction::Escape => return Break(self.escape(&from, step, Some(transmittance))),
            Interaction::Surface(hit, media) => {
                let mut vertex = self.surface(hit, step, index);
                vertex.locus.media = *media;
                vertex
            }
            Interaction::Medium(locus, scattering) => {
                Vertex::medium(self.job, *locus, *scattering, -step.direction, step.beta)
            }
        };
        let edge = scene.edge_of(transmittance, [&from, &vertex.locus], lanes);
        vertices.push(vertex);
        reach(vertices, step, Some(&edge))
    }

    #[inline(always)]
    fn surface(&self, hit: &SurfaceHit, step: &Step, index: usize) -> Vertex {
        let u_mix = || self.stream.get_1d(Dimension::at(index, Purpose::Mix));
        Vertex::surface(self.job, hit, -step.direction, step.beta, u_mix)
    }

    /// Returns the escape of a walk from the place `from` past media of this T. None: nothing arrives.
    #[inline(never)]
    fn escape(
        &self,
        from: &Locus,
        step: &Step,
        transmittance: Option<Transmittance>,
    ) -> Option<Escape> {
        let to = Locus::at_infinity(step.direction);
        let mut segment = Segment::along(from, &to, step.direction);
        let mut beta = step.beta;
        if let Some(transmittance) = transmittance {
            let job = self.job;
            let edge = job.scene.edge_of(transmittance, [from, &to], job.lanes);
            segment.pass(&edge);
            beta *= edge.throughput();
        }
        (segment.to_b > 0.0).then_some(Escape {
            direction: step.direction,
            beta,
            pdf_fwd: step.pdf_w * segment.to_b,
            to_previous: segment.to_a,
        })
    }

    /// Scatters at the last of `vertices`. None: the walk ends there.
    #[inline(always)]
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
        let survival = self.job.settings.roulette.survival_prob(
            index - 1,
            vertex.albedo_fwd,
            magnitude(beta) / start,
        );
        // Only a probability below 1 costs a number; zero ends the walk for sure.
        if survival < 1.0 && self.stream.get_1d(at(Purpose::Roulette)) >= survival {
            return None;
        }
        Some(Step {
            origin: vertex.locus.ray_origin(scattered.wi),
            direction: scattered.wi,
            beta: beta / survival,
            pdf_w: scattered.pdf,
        })
    }
}

/// Sets the densities of the last of `vertices`, which `step` reached through the media of `edge`. Removes it and ends
/// the walk where its density is 0: rounding put it on the vertex before, in a corner, or media let nothing through.
#[inline(always)]
fn reach(vertices: &mut Vec<Vertex>, step: &Step, edge: Option<&Edge>) -> Flow {
    let [.., from, vertex] = &mut vertices[..] else {
        return Break(None);
    };
    let mut segment = Segment::along(&from.locus, &vertex.locus, step.direction);
    if let Some(edge) = edge {
        segment.pass(edge);
        vertex.beta *= edge.throughput();
    }
    vertex.pdf_fwd = step.pdf_w * segment.to_b;
    vertex.to_previous = segment.to_a;
    if vertex.pdf_fwd == 0.0 {
        vertices.pop();
        return Break(None);
    }
    Continue(())
}

/// Returns the largest lane, whatever its sign: a filter may be negative. Never zero, so that throughput
/// relative to it is defined.
#[inline]
fn magnitude(beta: Spectrum) -> f32 {
    beta.map(f32::abs).max_lane().max(f32::MIN_POSITIVE)
}
