//! The light image, t = 1: every light vertex is connected to a lens point of its own, and splatted where that
//! sees it. The film divides by its number of pixels; where there are fewer light subpaths, each counts more.

use super::super::journal::enter;
use super::super::{Entry, Link, Sample, Walks, Worker};
use super::media::TracedShadow;
use super::trace::trace;
use crate::contribution::Term;
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::math::Vec2;
use crate::path::{
    DiffuseEnd, EndSums, Job, JoinedPath, PathSums, RunningSums, Scattering, Segment, Vertex,
    Weights,
};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::Spectrum;
use crate::stats::Stage;
use crate::strategy::Strategy;

/// The weights of a light image.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Weighting {
    /// 1: no other strategy makes its paths.
    Alone,
    /// MIS weights of all strategies that take part.
    Combined,
}

/// Connects the samples' light subpaths to the lens, and traces all of these shadow rays.
#[inline(never)]
pub(in super::super) fn light_image(
    job: &Job<'_>,
    walks: &Walks,
    splats: &mut Vec<Entry>,
    worker: &mut Worker,
    weighting: Weighting,
) {
    let first = walks.first_light();
    for (index, sample) in walks.samples.iter().enumerate() {
        let walk = walks.light.get(first + index);
        for s in 1..=walk.vertices.len() {
            if weighting == Weighting::Combined && !job.takes(s, 1) {
                continue;
            }
            let lens = lens_vertex(job, sample, s);
            let Some(image) = LightImage::new(job, &walk.vertices[..s], &lens) else {
                continue;
            };
            let of_vertex = (&walks.light.sums, walk.first + s - 1);
            let sums = (weighting == Weighting::Combined).then_some(of_vertex);
            if let Some((term, shadow)) = image.weighted_term(job, sums, &mut worker.weights) {
                let (link, stats) = (image.link(job, sample), &mut worker.stats);
                let entry = enter(splats, stats, index, sample, term, link);
                shadow.apply(entry, stats);
            }
        }
    }
    trace(job, splats, &mut worker.shadow_rays, &mut worker.stats);
    worker.stopwatch.end(Stage::LightImage);
}

/// Returns the lens point for light vertex number `s`.
pub(in super::super) fn lens_vertex(job: &Job<'_>, sample: &Sample, s: usize) -> Vertex {
    let at = Dimension::at(s, Purpose::LightImageLens);
    let camera = job.view.camera();
    let lens = camera.sample_lens(|| sample.light.get_2d(at));
    Vertex::camera(&lens, job.medium)
}

/// A light vertex and the lens point that sees it, before visibility.
struct LightImage<'a> {
    light: &'a [Vertex],
    /// The last of `light`.
    z: &'a Vertex,
    lens: &'a Vertex,
    /// From the light vertex to the lens.
    segment: Segment,
    raster: Vec2,
}

impl<'a> LightImage<'a> {
    /// Returns the last vertex of a light subpath, as a lens point sees it. None: its image is not on the film.
    fn new(job: &Job<'_>, light: &'a [Vertex], lens: &'a Vertex) -> Option<Self> {
        let z = light.last()?;
        // The image of a Dirac light itself would be a Dirac distribution: such lights are invisible.
        if matches!(z.scattering, Scattering::Light) && z.is_on_delta_light(job) {
            return None;
        }
        if lens.locus.is_infinite() && z.locus.is_infinite() {
            return None;
        }
        let segment = z.segment_to(lens);
        let on_ray = if lens.locus.is_infinite() {
            z.locus.point
        } else {
            lens.locus.point
        };
        let raster = job.view.camera().raster(on_ray, -segment.w)?;
        reaches_film(job, raster).then_some(Self {
            light,
            z,
            lens,
            segment,
            raster,
        })
    }

    /// Returns its term, and the media on its way, where its vertex has this number in the sums; of weight 1 without
    /// sums. None: it is zero.
    #[inline]
    fn weighted_term(
        &self,
        job: &Job<'_>,
        sums: Option<(&RunningSums, usize)>,
        weights: &mut Weights,
    ) -> Option<(Term, TracedShadow)> {
        let Some((sums, z)) = sums else {
            return self.of_any(job, |_| 1.0);
        };
        let light = sums.at(z);
        let is_plain = |end: &&DiffuseEnd| !end.is_turned(self.segment.w);
        if let Some(end) = sums.diffuse(z).filter(is_plain) {
            let s = self.light.len();
            let found = end.light_image(job, s, self.z, light, self.lens, &self.segment);
            let (contribution, weight) = found?;
            let term = self.term(job, contribution, weight)?;
            // Diffuse ends are those whose rays go through no medium.
            return Some((term, TracedShadow::Clear));
        }
        let sums = PathSums {
            light,
            camera: &EndSums::NONE,
            next_event: None,
        };
        self.of_any(job, |path| weights.connection(job, path, &sums))
    }

    /// The same for any vertex and any weight, which is not asked for where nothing arrives.
    fn of_any(
        &self,
        job: &Job<'_>,
        weight: impl FnOnce(&JoinedPath<'_>) -> f32,
    ) -> Option<(Term, TracedShadow)> {
        let lens = std::slice::from_ref(self.lens);
        let mut path = JoinedPath::along(self.light, lens, self.segment);
        let mut term = self.term(job, path.contribution(job), 0.0)?;
        let shadow = TracedShadow::between(job, || self.ends(job));
        if let Some(edge) = shadow.edge() {
            path.segment.pass(edge);
        }
        if !shadow.is_blocked() {
            term.weight = weight(&path);
        }
        Some((term, shadow))
    }

    /// Returns the term with contribution `c`, scaled to the number of light subpaths in a pass. None: it is zero.
    fn term(&self, job: &Job<'_>, c: Spectrum, weight: f32) -> Option<Term> {
        let share = job.view.film().pixel_count() as f64 / job.counts.light_subpaths;
        let contribution = c * share as f32;
        (contribution != Spectrum::ZERO).then_some(Term {
            strategy: Strategy::new(self.light.len(), 1),
            light: self.light[0].light?,
            contribution,
            weight,
        })
    }

    /// Returns the ends of its shadow ray: the light vertex, and the lens point, or the place of a parallel ray on the
    /// camera's plane, behind which nothing is in its way.
    fn ends(&self, job: &Job<'_>) -> [Locus; 2] {
        let [z, lens] = [self.z.locus, self.lens.locus];
        if !lens.is_infinite() {
            return [z, lens];
        }
        let depth = job.view.camera().depth(z.point);
        [z, Locus::in_space(z.point + lens.point * depth)]
    }

    /// Returns the link to the film, with the ends of its shadow ray.
    fn link(&self, job: &Job<'_>, sample: &Sample) -> Link {
        let at = Dimension::at(self.light.len(), Purpose::LightImagePixel);
        let place = SplatPlace {
            raster: self.raster,
            u: sample.light.get_2d(at),
        };
        Link::LightImage(self.ends(job), place)
    }
}

/// Returns true where the filter of some pixel of the crop may reach `raster`.
fn reaches_film(job: &Job<'_>, raster: Vec2) -> bool {
    let film = job.view.film();
    let corner = |c: [u32; 2]| Vec2::new(c[0] as f32, c[1] as f32);
    let margin = film.filter.radius();
    let (min, max) = (
        corner(film.crop.min) - margin,
        corner(film.crop.max) + margin,
    );
    raster.cmpge(min).all() && raster.cmple(max).all()
}
