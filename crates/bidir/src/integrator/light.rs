//! Light tracing, and the light image (t = 1) that the bidirectional estimator shares: every light
//! vertex is connected to a lens point of its own, and lands wherever on the film that is. A splat
//! is divided by the number of light paths by the film, not here.

use super::{Integrator, Sample, Splat, Workspace};
use crate::math::Vec2;
use crate::path::{PathContext, Strategy, Vertex, VertexKind, connect};
use crate::sampler::{Dimension, Purpose};
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
            let Some((lens, splat)) = light_image(context, sample, &workspace.light.vertices[..s])
            else {
                continue;
            };
            workspace.splat(context, sample, s, &lens, splat);
        }
    }
}

/// Connects the last vertex of a light subpath to a lens point of its own: the lens vertex, and the
/// splat without weight or visibility. None: nothing arrives on the film.
pub(super) fn light_image(
    context: &PathContext<'_>,
    sample: &Sample,
    light: &[Vertex],
) -> Option<(Vertex, Splat)> {
    let scene = context.scene;
    let (s, end) = (light.len(), light.last()?);
    // The image of a Dirac light itself would be a Dirac distribution: such lights are invisible.
    if end.kind == VertexKind::Light && end.light.is_none_or(|i| scene.light(i).is_delta()) {
        return None;
    }
    let at = |purpose| sample.light.get_2d(Dimension::at(s, purpose));
    let lens = Vertex::camera(&scene.camera().sample_lens(at(Purpose::LightImageLens)));
    let raster = scene.camera().raster(lens.point, lens.toward(end))?;
    if !reaches_film(context, raster) {
        return None;
    }
    let value = connect(context, light, &[lens]);
    if value == Spectrum::ZERO {
        return None;
    }
    Some((
        lens,
        Splat {
            raster,
            value,
            u: at(Purpose::LightImagePixel),
        },
    ))
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
    /// Traces the light-image ray of strategy (s, 1) and keeps its splat if it arrives.
    pub(super) fn splat(
        &mut self,
        context: &PathContext<'_>,
        sample: &Sample,
        s: usize,
        lens: &Vertex,
        splat: Splat,
    ) {
        let visible = self.accepts(sample, Strategy::new(s, 1), splat.value)
            && self.trace_light_image(context.scene, &self.light.vertices[s - 1].clone(), lens);
        if visible {
            self.splats.push(splat);
        }
    }
}
