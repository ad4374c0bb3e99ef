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
use crate::path::{EndSums, Job, JoinedPath, PathContext, PathSums, Scattering, Vertex};
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
            let Some(mut image) = LightImage::new(&context, &walk.vertices[..s], &lens) else {
                continue;
            };
            let passage = ShadowPassage::between(&context, || image.ends());
            if let Some(edge) = passage.edge() {
                image.path.pass(edge);
            }
            let weight = match weighting {
                Weighting::Alone => 1.0,
                Weighting::Combined if passage.is_blocked() => 0.0,
                Weighting::Combined => {
                    let sums = PathSums {
                        light: light_sums.at(walk.first + s - 1),
                        camera: &EndSums::NONE,
                        next_event: None,
                    };
                    weights.weight(&context, &image.path, &sums)
                }
            };
            let (term, link) = image.term(sample, weight);
            let entry = enter(splats, stats, (number, sample), term, link);
            passage.settle(entry, stats);
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

/// A light vertex as a lens point of its own sees it, before visibility.
struct LightImage<'a> {
    light: u32,
    /// From the light to the lens.
    path: JoinedPath<'a>,
    /// The camera's end of the shadow ray.
    camera_end: Locus,
    raster: Vec2,
    contribution: Spectrum,
}

impl<'a> LightImage<'a> {
    /// Connects the last vertex of a light subpath to a lens point. None: nothing arrives on the film.
    fn new(context: &PathContext<'_>, light: &'a [Vertex], lens: &'a Vertex) -> Option<Self> {
        let scene = context.job.scene;
        let end = light.last()?;
        // The image of a Dirac light itself would be a Dirac distribution: such lights are invisible.
        let is_start = matches!(end.scattering, Scattering::Light);
        if is_start && end.light.is_none_or(|i| scene.light(i).is_delta()) {
            return None;
        }
        if lens.locus.is_infinite() && end.locus.is_infinite() {
            return None;
        }
        let path = JoinedPath::connection(light, std::slice::from_ref(lens));
        let on_ray = if lens.locus.is_infinite() {
            end.locus.point
        } else {
            lens.locus.point
        };
        let raster = context.job.view.camera().raster(on_ray, -path.segment.w)?;
        if !reaches_film(context, raster) {
            return None;
        }
        let share =
            context.job.view.film().light_paths() as f64 / context.job.counts.light_subpaths;
        let contribution = path.contribution(context) * share as f32;
        (contribution != Spectrum::ZERO).then_some(Self {
            light: light[0].light?,
            camera_end: camera_end(context, lens, end),
            path,
            raster,
            contribution,
        })
    }

    /// The ends of its shadow ray.
    fn ends(&self) -> [Locus; 2] {
        [self.path.z().locus, self.camera_end]
    }

    /// Its term with this weight, and its link.
    fn term(&self, sample: &Sample, weight: f32) -> (Term, Link) {
        let s = self.path.light.len();
        let at = Dimension::at(s, Purpose::LightImagePixel);
        let place = SplatPlace {
            raster: self.raster,
            u: sample.light.get_2d(at),
        };
        let term = Term {
            strategy: Strategy::new(s, 1),
            light: self.light,
            contribution: self.contribution,
            weight,
        };
        (term, Link::LightImage(self.ends(), place))
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
