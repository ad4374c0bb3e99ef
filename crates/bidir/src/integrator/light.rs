//! Light tracing, and the light image (t = 1) that the bidirectional estimator shares: every light
//! vertex is connected to a lens point of its own, and lands wherever on the film that is. A splat
//! is divided by the number of light paths by the film, not here.

use super::{Integrator, Link, Sample, Splat, Workspace};
use crate::contribution::Term;
use crate::film::SplatPlace;
use crate::locus::Locus;
use crate::math::Vec2;
use crate::path::{JoinedPath, PathContext, Strategy, Vertex, VertexKind};
use crate::sampler::{Dimension, Purpose};
use crate::spectrum::Spectrum;
use crate::stats::Stage;

/// Light tracing: strategies t = 1 alone, each with weight 1.
///
/// Unbiased for every path that does not end by a Dirac scattering at the last surface before the
/// lens.
#[derive(Clone, Copy, Debug)]
pub struct LightTracer;

impl Integrator for LightTracer {
    fn sample(&self, context: &PathContext<'_>, sample: &Sample, workspace: &mut Workspace) {
        workspace.begin();
        workspace.stats.samples += 1;
        workspace.walk_light(context, sample);
        for s in 1..=workspace.light.vertices.len() {
            let lens = lens_vertex(context, sample, s);
            let light = &workspace.light.vertices[..s];
            if let Some(image) = light_image(context, light, &lens) {
                let image = image.weighted(1.0);
                workspace.splat(context, sample, &image);
            }
        }
        workspace.stopwatch.end(Stage::LightImage);
    }
}

/// A light vertex as a lens point of its own sees it, before visibility.
pub(super) struct LightImage<'a> {
    light: u32,
    /// From the light to the lens.
    pub(super) path: JoinedPath<'a>,
    /// The camera's end of the shadow ray.
    camera_end: Locus,
    raster: Vec2,
    contribution: Spectrum,
}

/// The lens point for light vertex number `s`.
pub(super) fn lens_vertex(context: &PathContext<'_>, sample: &Sample, s: usize) -> Vertex {
    let camera = context.view.camera();
    let u = || {
        sample
            .light
            .get_2d(Dimension::at(s, Purpose::LightImageLens))
    };
    Vertex::camera(&camera.sample_lens(u))
}

/// Connects the last vertex of a light subpath to a lens point. None: nothing arrives on the film.
pub(super) fn light_image<'a>(
    context: &PathContext<'_>,
    light: &'a [Vertex],
    lens: &'a Vertex,
) -> Option<LightImage<'a>> {
    let scene = context.scene;
    let end = light.last()?;
    // The image of a Dirac light itself would be a Dirac distribution: such lights are invisible.
    if end.kind == VertexKind::Light && end.light.is_none_or(|i| scene.light(i).is_delta()) {
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
    let raster = context.view.camera().raster(on_ray, -path.segment.w)?;
    if !reaches_film(context, raster) {
        return None;
    }
    let contribution = path.contribution(context) * context.connections.samples_per_subpath as f32;
    (contribution != Spectrum::ZERO).then_some(LightImage {
        light: light[0].light?,
        camera_end: camera_end(context, lens, end),
        path,
        raster,
        contribution,
    })
}

/// The point that a camera sees the vertex `end` from: the lens point, or the place of a parallel ray on the
/// camera's plane, behind which nothing is in its way.
fn camera_end(context: &PathContext<'_>, lens: &Vertex, end: &Vertex) -> Locus {
    if !lens.locus.is_infinite() {
        return lens.locus;
    }
    let depth = context.view.camera().depth(end.locus.point);
    Locus::in_space(end.locus.point + lens.locus.point * depth)
}

/// True where the filter of some pixel of the crop may reach `raster`.
fn reaches_film(context: &PathContext<'_>, raster: Vec2) -> bool {
    let film = context.view.film();
    let corner = |c: [u32; 2]| Vec2::new(c[0] as f32, c[1] as f32);
    let margin = film.filter.radius();
    let (min, max) = (
        corner(film.crop.min) - margin,
        corner(film.crop.max) + margin,
    );
    raster.cmpge(min).all() && raster.cmple(max).all()
}

impl LightImage<'_> {
    /// With its weight.
    pub(super) fn weighted(&self, weight: f32) -> WeightedImage {
        let [light, camera] = [self.path.light, self.path.camera].map(<[Vertex]>::len);
        WeightedImage {
            term: Term::new(
                Strategy::new(light, camera),
                self.light,
                self.contribution,
                weight,
            ),
            raster: self.raster,
            ends: [self.path.light[light - 1].locus, self.camera_end],
        }
    }
}

/// A light image with its weight.
pub(super) struct WeightedImage {
    term: Term,
    raster: Vec2,
    /// The ends of its shadow ray: light vertex and camera.
    ends: [Locus; 2],
}

impl Workspace {
    /// Traces a ray of the light image, and keeps the splat if it arrives.
    pub(super) fn splat(
        &mut self,
        context: &PathContext<'_>,
        sample: &Sample,
        image: &WeightedImage,
    ) {
        let WeightedImage { term, raster, ends } = *image;
        let s = usize::from(term.strategy.s);
        let u = sample
            .light
            .get_2d(Dimension::at(s, Purpose::LightImagePixel));
        let place = SplatPlace { raster, u };
        let term = self.count(term, |_| Link::LightImage(ends, place));
        if self.accepts(sample, &term, term.value())
            && let Some(transmittance) = self.trace(context.scene, &term, &ends)
        {
            self.add_splat(Splat {
                contribution: term.certain(transmittance),
                place,
            });
        }
    }
}
