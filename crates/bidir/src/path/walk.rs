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
use crate::scene::{Chances, SurfaceHit};
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

/// One walk, from its end of the path.
#[derive(Clone, Copy, Debug, Default)]
pub struct Subpath<'a> {
    /// The number of its first vertex among all of [`Subpaths`].
    pub first: usize,
    /// The vertices; empty where the walk could not start.
    pub vertices: &'a [Vertex],
    /// The walk's escape from the scene, if it left it.
    pub escape: Option<Escape>,
}

/// The walks of a batch, one behind the other, and behind them single points.
#[derive(Debug, Default)]
pub struct Subpaths {
    vertices: Vec<Vertex>,
    walks: Vec<Walk>,
}

/// How a walk ended.
#[derive(Clone, Copy, Debug)]
struct Walk {
    /// One past the number of its last vertex.
    end: usize,
    escape: Option<Escape>,
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

/// Walks a camera subpath that starts with `ray` and the weight `weight` of its film position, and adds it to
/// `subpaths`.
pub fn camera_subpath(
    context: &PathContext<'_>,
    stream: &SampleStream,
    ray: &CameraRay,
    weight: f32,
    subpaths: &mut Subpaths,
    stats: &mut Stats,
) {
    let walker = Walker {
        context,
        mode: TransportMode::Radiance,
        stream,
        max_vertices: context.job.settings.max_vertices(),
    };
    // Cameras draw rays in proportion to their importance: its weight leaves the film's alone.
    let step = Step {
        direction: ray.direction,
        beta: Spectrum::splat(weight),
        pdf_w: context.job.view.camera().pdf_direction(ray.direction),
    };
    let first = subpaths.vertices.len();
    subpaths.vertices.push(Vertex::camera(&ray.lens));
    let walked = &mut subpaths.vertices;
    let escape = walker.walk(walked, first, ray.origin, step, &mut stats.rays.camera);
    subpaths.end(escape);
}

/// Walks a light subpath, and adds it to `subpaths`.
pub fn light_subpath(
    context: &PathContext<'_>,
    stream: &SampleStream,
    subpaths: &mut Subpaths,
    stats: &mut Stats,
) {
    let Some((start, emission)) = draw_emission(context, stream) else {
        return subpaths.end(None);
    };
    let emitted = context
        .job
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
    let walker = Walker {
        context,
        mode: TransportMode::Importance,
        stream,
        // At least the lens is the camera's.
        max_vertices: context.job.settings.max_vertices() - 1,
    };
    let first = subpaths.vertices.len();
    subpaths.vertices.push(start);
    let walked = &mut subpaths.vertices;
    let escape = walker.walk(walked, first, origin, step, &mut stats.rays.light);
    subpaths.end(escape);
}

/// Draws the start of a light subpath and the ray that leaves it. None: the draw has no density, or the light
/// is cut out there.
fn draw_emission(
    context: &PathContext<'_>,
    stream: &SampleStream,
) -> Option<(Vertex, EmissionSample)> {
    let scene = context.job.scene;
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

impl Subpaths {
    /// Forgets all, and keeps the memory.
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.walks.clear();
    }

    /// The number of walks.
    pub fn count(&self) -> usize {
        self.walks.len()
    }

    /// Walk number `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Subpath<'_> {
        let first = if i == 0 { 0 } else { self.walks[i - 1].end };
        let Walk { end, escape } = self.walks[i];
        Subpath {
            first,
            vertices: &self.vertices[first..end],
            escape,
        }
    }

    /// All vertices, those of the single points last.
    #[inline]
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// Begins to load vertex number `i` and the one before it.
    #[inline]
    pub(crate) fn load_ahead(&self, i: usize) {
        accel::load_ahead(&self.vertices[i.saturating_sub(1)..=i]);
    }

    /// Begins to load the place of vertex number `i`.
    #[inline]
    pub(crate) fn load_locus_ahead(&self, i: usize) {
        accel::load_ahead(std::slice::from_ref(&self.vertices[i].locus));
    }

    /// The number of vertices of walks, behind which the single points are.
    #[inline]
    pub(crate) fn walked(&self) -> usize {
        self.walks.last().map_or(0, |walk| walk.end)
    }

    /// Adds a single point; returns its number among all vertices. Points are forgotten before the next walk.
    #[inline]
    pub(crate) fn add_point(&mut self, point: &Vertex) -> usize {
        self.vertices.push(*point);
        self.vertices.len() - 1
    }

    /// Forgets the single points.
    pub(crate) fn forget_points(&mut self) {
        self.vertices.truncate(self.walked());
    }

    /// Adds a walk of these vertices.
    #[cfg(test)]
    pub(crate) fn add(&mut self, vertices: impl Iterator<Item = Vertex>) {
        self.vertices.extend(vertices);
        self.end(None);
    }

    /// Ends a walk.
    fn end(&mut self, escape: Option<Escape>) {
        let end = self.vertices.len();
        self.walks.push(Walk { end, escape });
    }
}

impl Walker<'_> {
    /// Extends the walk, `vertices` from `first` on, until it escapes, ends by roulette, or is full.
    fn walk(
        &self,
        vertices: &mut Vec<Vertex>,
        first: usize,
        origin: Vec3,
        step: Step,
        rays: &mut u64,
    ) -> Option<Escape> {
        let (mut origin, mut step) = (origin, step);
        let start = magnitude(step.beta);
        let mut count = 1;
        while count < self.max_vertices {
            *rays += 1;
            let chances = Chances::new(self.stream, count);
            let hit = self
                .context
                .job
                .scene
                .intersect(origin, step.direction, chances);
            let Some(hit) = hit else {
                return Some(Escape {
                    direction: step.direction,
                    beta: step.beta,
                    pdf_fwd: step.pdf_w,
                });
            };
            self.add_surface(vertices, &hit, &step, count)?;
            count += 1;
            if count == self.max_vertices {
                return None;
            }
            step = self.scatter(&mut vertices[first..], start)?;
            origin = vertices[vertices.len() - 1]
                .locus
                .ray_origin(step.direction);
        }
        None
    }

    /// Adds vertex number `index`, the `hit` that `step` led to. None: by rounding it is the vertex before it, in a
    /// corner; it has no density.
    #[inline]
    fn add_surface(
        &self,
        vertices: &mut Vec<Vertex>,
        hit: &SurfaceHit,
        step: &Step,
        index: usize,
    ) -> Option<()> {
        let u_mix = || self.stream.get_1d(Dimension::at(index, Purpose::Mix));
        let wo = -step.direction;
        let mut vertex = Vertex::surface(self.context, hit, wo, step.beta, u_mix);
        let from = vertices[vertices.len() - 1].locus;
        let segment = Segment::along(&from, &vertex.locus, step.direction);
        vertex.pdf_fwd = step.pdf_w * segment.to_b;
        vertex.to_previous = segment.to_a;
        if vertex.pdf_fwd == 0.0 {
            return None;
        }
        vertices.push(vertex);
        Some(())
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
        let survival = self.context.job.settings.roulette.survival_prob(
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
