//! Light tracing, and the light image (t = 1) that the bidirectional estimator shares: every light
//! vertex is connected to a lens point of its own, and lands wherever on the film that is. A splat
//! is divided by the number of light paths by the film, not here.

use super::{Integrator, Link, Sample, Splat, Term, Workspace};
use crate::math::{Vec2, Vec3};
use crate::path::{PathContext, Strategy, Vertex, VertexKind, connect};
use crate::sampler::{Dimension, Purpose};
use crate::scene::SegmentEnd;
use crate::spectrum::Spectrum;

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
            if let Some(image) = light_image(context, sample, &workspace.light.vertices[..s]) {
                workspace.splat(context, sample, &image, 1.0);
            }
        }
    }
}

/// A light vertex as a lens point of its own sees it, before weight and visibility.
pub(super) struct LightImage {
    strategy: Strategy,
    light: u32,
    pub(super) lens: Vertex,
    /// The camera's end of the shadow ray.
    camera_end: SegmentEnd,
    raster: Vec2,
    contribution: Spectrum,
}

/// Connects the last vertex of a light subpath to a lens point of its own. None: nothing arrives on
/// the film.
pub(super) fn light_image(
    context: &PathContext<'_>,
    sample: &Sample,
    light: &[Vertex],
) -> Option<LightImage> {
    let scene = context.scene;
    let (s, end) = (light.len(), light.last()?);
    // The image of a Dirac light itself would be a Dirac distribution: such lights are invisible.
    if end.kind == VertexKind::Light && end.light.is_none_or(|i| scene.light(i).is_delta()) {
        return None;
    }
    let start = light[0].light?;
    let u_lens = sample
        .light
        .get_2d(Dimension::at(s, Purpose::LightImageLens));
    let lens = Vertex::camera(&scene.camera().sample_lens(u_lens));
    if lens.is_infinite && end.is_infinite {
        return None;
    }
    let on_ray = if lens.is_infinite {
        end.point
    } else {
        lens.point
    };
    let raster = scene.camera().raster(on_ray, lens.toward(end))?;
    if !reaches_film(context, raster) {
        return None;
    }
    let contribution = connect(context, light, &[lens]);
    (contribution != Spectrum::ZERO).then_some(LightImage {
        strategy: Strategy::new(s, 1),
        light: start,
        camera_end: camera_end(context, &lens, end),
        lens,
        raster,
        contribution,
    })
}

/// Where a camera sees the vertex `end` from: the lens point, or the place of a parallel ray on the
/// camera's plane, behind which nothing is in its way.
fn camera_end(context: &PathContext<'_>, lens: &Vertex, end: &Vertex) -> SegmentEnd {
    if !lens.is_infinite {
        return lens.segment_end();
    }
    let depth = context.scene.camera().depth(end.point);
    SegmentEnd {
        point: end.point + lens.point * depth,
        n_g: Vec3::ZERO,
        is_infinite: false,
        ..lens.segment_end()
    }
}

/// True where the filter of some pixel of the crop may reach `raster`.
fn reaches_film(context: &PathContext<'_>, raster: Vec2) -> bool {
    let film = context.scene.film();
    let corner = |c: [u32; 2]| Vec2::new(c[0] as f32, c[1] as f32);
    let margin = film.filter.radius();
    let (min, max) = (
        corner(film.crop.min) - margin,
        corner(film.crop.max) + margin,
    );
    raster.cmpge(min).all() && raster.cmple(max).all()
}

impl Workspace {
    /// Traces a ray of the light image, and keeps the splat if it arrives.
    pub(super) fn splat(
        &mut self,
        context: &PathContext<'_>,
        sample: &Sample,
        image: &LightImage,
        weight: f32,
    ) {
        let strategy = image.strategy;
        let s = usize::from(strategy.s);
        let term = Term {
            strategy,
            light: image.light,
            contribution: image.contribution,
            weight,
        };
        let mut splat = Splat {
            contribution: term.whole(),
            raster: image.raster,
            u: sample
                .light
                .get_2d(Dimension::at(s, Purpose::LightImagePixel)),
        };
        let end = self.light.vertices[s - 1].segment_end();
        let ends = [end, image.camera_end];
        self.count(term, |_| Link::LightImage(ends, splat));
        if self.accepts(sample, strategy, term.value())
            && let Some(arrives) = self.trace(context.scene, strategy, &ends)
        {
            splat.contribution = splat.contribution.behind(arrives);
            self.add_splat(splat);
        }
    }
}
