//! The light image, t = 1: every light vertex is connected to a lens point of its own, and splatted where that
//! sees it. The film divides by its number of pixels; where there are fewer light subpaths, each counts more.

use super::super::batch::enter;
use super::super::{Batch, Link, Sample};
use super::media::ShadowPassage;
use super::trace::trace;
use crate::contribution::Term;
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::math::Vec2;
use crate::path::{
    DiffuseEnd, EndSums, Job, JoinedPath, PathContext, PathSums, Scattering, Segment, Vertex,
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
pub(in super::super) fn light_image(job: &Job<'_>, batch: &mut Batch, weighting: Weighting) {
    let first = batch.first_light();
    let Batch {
        samples,
        light,
        light_sums,
        weights,
        splats,
        shadow_rays,
        stats,
        ..
    } = batch;
    for (number, sample) in samples.iter().enumerate() {
        let context = sample.context(job);
        let walk = light.get(first + number);
        for s in 1..=walk.vertices.len() {
            if weighting == Weighting::Combined && !context.takes(s, 1) {
                continue;
            }
            let lens = lens_vertex(&context, sample, s);
            let Some(image) = LightImage::new(&context, &walk.vertices[..s], &lens) else {
                continue;
            };
            let z = walk.first + s - 1;
            let found = if let Some(end) = light_sums.diffuse(z) {
                image.of_diffuse(&context, end, light_sums.at(z))
            } else {
                let weights = (weighting == Weighting::Combined).then_some(&mut *weights);
                image.of_any(&context, weights, light_sums.at(z))
            };
            if let Some((term, passage)) = found {
                let link = image.link(&context, sample);
                let entry = enter(splats, stats, (number, sample), term, link);
                passage.settle(entry, stats);
            }
        }
    }
    trace(job.scene, splats, shadow_rays, stats);
    batch.stopwatch.end(Stage::LightImage);
}

/// The lens point for light vertex number `s`.
pub(in super::super) fn lens_vertex(
    context: &PathContext<'_>,
    sample: &Sample,
    s: usize,
) -> Vertex {
    let at = Dimension::at(s, Purpose::LightImageLens);
    let camera = context.job.view.camera();
    let lens = camera.sample_lens(|| sample.light.get_2d(at));
    Vertex::camera(&lens, context.job.medium)
}

/// A light vertex and the lens point that sees it, before visibility.
struct LightImage<'a> {
    light: &'a [Vertex],
    lens: &'a Vertex,
    /// From the light vertex to the lens.
    segment: Segment,
    raster: Vec2,
}

impl<'a> LightImage<'a> {
    /// The last vertex of a light subpath, as a lens point sees it. None: its image is not on the film.
    fn new(context: &PathContext<'_>, light: &'a [Vertex], lens: &'a Vertex) -> Option<Self> {
        let end = light.last()?;
        // The image of a Dirac light itself would be a Dirac distribution: such lights are invisible.
        if matches!(end.scattering, Scattering::Light) && end.is_on_delta_light(context) {
            return None;
        }
        if lens.locus.is_infinite() && end.locus.is_infinite() {
            return None;
        }
        let segment = end.segment_to(lens);
        let on_ray = if lens.locus.is_infinite() {
            end.locus.point
        } else {
            lens.locus.point
        };
        let raster = context.job.view.camera().raster(on_ray, -segment.w)?;
        reaches_film(context, raster).then_some(Self {
            light,
            lens,
            segment,
            raster,
        })
    }

    /// Its term where its vertex is `z`, diffuse, with these sums. None: it is zero.
    fn of_diffuse(
        &self,
        context: &PathContext<'_>,
        z: &DiffuseEnd,
        sums: &EndSums,
    ) -> Option<(Term, ShadowPassage)> {
        let s = self.light.len();
        let found = z.light_image(context, s, (self.lens, sums), &self.segment);
        let (contribution, weight) = found?;
        let term = self.term(context, contribution, weight)?;
        Some((term, ShadowPassage::Clear))
    }

    /// Its term, whatever its vertex is, and the media on its way; of weight 1 without `weights`. None: it is zero.
    fn of_any(
        &self,
        context: &PathContext<'_>,
        weights: Option<&mut Weights>,
        sums: &EndSums,
    ) -> Option<(Term, ShadowPassage)> {
        let mut path = JoinedPath::connection(self.light, std::slice::from_ref(self.lens));
        let term = self.term(context, path.contribution(context), 1.0)?;
        let passage = ShadowPassage::between(context, || self.ends(context));
        if let Some(edge) = passage.edge() {
            path.pass(edge);
        }
        let weight = match weights {
            None => 1.0,
            Some(_) if passage.is_blocked() => 0.0,
            Some(weights) => {
                let sums = PathSums {
                    light: sums,
                    camera: &EndSums::NONE,
                    next_event: None,
                };
                weights.weight(context, &path, &sums)
            }
        };
        Some((Term { weight, ..term }, passage))
    }

    /// The term of C, of which a pass has so many light subpaths. None: it is zero.
    fn term(&self, context: &PathContext<'_>, c: Spectrum, weight: f32) -> Option<Term> {
        let share =
            context.job.view.film().light_paths() as f64 / context.job.counts.light_subpaths;
        let contribution = c * share as f32;
        (contribution != Spectrum::ZERO).then_some(Term {
            strategy: Strategy::new(self.light.len(), 1),
            light: self.light[0].light?,
            contribution,
            weight,
        })
    }

    /// The ends of its shadow ray.
    fn ends(&self, context: &PathContext<'_>) -> [Locus; 2] {
        let end = &self.light[self.light.len() - 1];
        [end.locus, camera_end(context, self.lens, end)]
    }

    fn link(&self, context: &PathContext<'_>, sample: &Sample) -> Link {
        let at = Dimension::at(self.light.len(), Purpose::LightImagePixel);
        let place = SplatPlace {
            raster: self.raster,
            u: sample.light.get_2d(at),
        };
        Link::LightImage(self.ends(context), place)
    }
}

/// The point that a camera sees the vertex `end` from: the lens point, or the place of a parallel ray on the
/// camera's plane, behind which nothing is in its way.
fn camera_end(context: &PathContext<'_>, lens: &Vertex, end: &Vertex) -> Locus {
    if !lens.locus.is_infinite() {
        return lens.locus;
    }
    let depth = context.job.view.camera().depth(end.locus.point);
    Locus::in_space(end.locus.point + lens.locus.point * depth)
}

/// True where the filter of some pixel of the crop may reach `raster`.
fn reaches_film(context: &PathContext<'_>, raster: Vec2) -> bool {
    let film = context.job.view.film();
    let corner = |c: [u32; 2]| Vec2::new(c[0] as f32, c[1] as f32);
    let margin = film.filter.radius();
    let (min, max) = (
        corner(film.crop.min) - margin,
        corner(film.crop.max) + margin,
    );
    raster.cmpge(min).all() && raster.cmple(max).all()
}
