//! a_i and b_i: the density of each vertex x_i drawn from the light and from the camera, area
//! measure, 1/m² (solid angle, 1/sr, for x_0 at infinity), roulette included where it is local.
//!
//! They describe the path, not the strategy that made it, so that every strategy finds the same
//! weight (docs/derivations/mis-weights.md).

use super::{JoinedPath, Junction, LightPointChoice, PathContext, Vertex, next_event_pdf};

/// How likely one vertex of a path is to be drawn from either side, roulette included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexDensities {
    /// By a walk from the light. Measure: area, 1/m²; see [`crate::path`] for x_0.
    pub from_light: f32,
    /// By a walk from the camera. The same measure.
    pub from_camera: f32,
    /// True where the path scatters by a Dirac distribution here.
    pub is_delta: bool,
}

/// The densities of a whole path x_0 … x_{n-1}: all that weights depend on.
#[derive(Clone, Debug, Default)]
pub struct PathDensities {
    /// One entry per vertex, from the light.
    pub vertices: Vec<VertexDensities>,
    /// The density e of x_0 when strategy s = 1 draws it.
    pub next_event: f32,
    /// True where no ray can hit the light by chance.
    pub light_is_delta: bool,
}

impl PathDensities {
    /// Collects the densities of `path`.
    ///
    /// Stored densities hold but next to the junction, where each end has a new neighbour: the two
    /// ends and the vertices before them are evaluated again.
    pub fn gather(&mut self, context: &PathContext<'_>, path: &JoinedPath<'_>) {
        let JoinedPath {
            light,
            camera,
            junction,
            ..
        } = *path;
        let (s, n) = (light.len(), path.len());
        self.vertices.clear();
        // A vertex between two of its walk does on this path what the walk did; an end that is
        // connected scatters by its other lobes.
        let lobes = |subpath: &[Vertex], walked: usize, i: usize| VertexDensities {
            from_light: 0.0,
            from_camera: 0.0,
            is_delta: i < walked && subpath[i].went_by_delta,
        };
        let steps = match junction {
            Junction::Connection => [s - 1, camera.len() - 1],
            Junction::Hit => [0, camera.len()],
        };
        self.vertices
            .extend((0..s).map(|i| lobes(light, steps[0], i)));
        let of_camera = (0..camera.len()).rev().map(|i| lobes(camera, steps[1], i));
        self.vertices.extend(of_camera);
        for (i, pdf) in walked_densities(context, light, n).enumerate() {
            self.vertices[i].from_light = pdf[0];
            if i + 2 < s {
                self.vertices[i].from_camera = pdf[1];
            }
        }
        for (c, pdf) in walked_densities(context, camera, n).enumerate() {
            let x = &mut self.vertices[n - 1 - c];
            x.from_camera = pdf[0];
            if c + 2 < camera.len() || junction == Junction::Hit {
                x.from_light = pdf[1];
            }
        }
        self.join(context, path);
        // Of a camera and a light both at infinity no connection makes a path: the camera has to see
        // the light by itself.
        if n == 2 && light[0].is_infinite && camera[0].is_infinite {
            self.vertices[0].from_light = 0.0;
        }
        self.describe_light(context, path);
    }

    /// Evaluates the densities next to the junction.
    fn join(&mut self, context: &PathContext<'_>, path: &JoinedPath<'_>) {
        let (s, t) = (path.light.len(), path.camera.len());
        let (z, y, segment) = (path.z(), path.y(), &path.segment);
        let w = segment.w;
        let x = &mut self.vertices;
        x[s].from_light =
            z.pdf_direction(context, z.wo, w) * segment.to_b * factor(context, s, z.albedo_fwd);
        if path.junction == Junction::Hit {
            x[0].from_camera = z.pdf_rev * factor(context, t, y.albedo_fwd);
            return;
        }
        x[s - 1].from_camera =
            y.pdf_direction(context, y.wo, -w) * segment.to_a * factor(context, t, y.albedo_fwd);
        if s > 1 {
            let survival = factor(context, t + 1, z.albedo_from(w));
            x[s - 2].from_camera = z.pdf_direction(context, w, z.wo) * z.to_previous * survival;
        }
        if t > 1 {
            let survival = factor(context, s + 1, y.albedo_from(-w));
            x[s + 1].from_light = y.pdf_direction(context, -w, y.wo) * y.to_previous * survival;
        }
    }

    /// Notes how next-event estimation would draw x_0 for x_1.
    fn describe_light(&mut self, context: &PathContext<'_>, path: &JoinedPath<'_>) {
        let x0 = &path.light[0];
        let Some(index) = x0.light else { return };
        self.light_is_delta = context.scene.light(index).is_delta();
        // A path of two vertices has its s = 1 by t = 1, which uses the light subpath's x_0.
        let shared = context.settings.light_point == LightPointChoice::Shared || path.len() == 2;
        self.next_event = if shared {
            self.vertices[0].from_light
        } else {
            let x1 = path.light.get(1).unwrap_or(path.y());
            next_event_pdf(context, x1.point, index, &x0.light_point())
        };
    }
}

/// The roulette's part of the density of vertex number `index` of a walk (0 is its end of the
/// path), with the albedo that the walk meets at the vertex before it.
#[inline]
fn factor(context: &PathContext<'_>, index: usize, albedo: f32) -> f32 {
    // Vertex 1 is drawn by the end of the path itself, which no roulette guards.
    if index < 2 {
        1.0
    } else {
        context.settings.roulette.density_factor(index - 2, albedo)
    }
}

/// The densities of a subpath's vertices as stored: by its own walk, and by one from the other end
/// of a path of `n` vertices. The latter is not valid for the last two.
fn walked_densities(
    context: &PathContext<'_>,
    subpath: &[Vertex],
    n: usize,
) -> impl Iterator<Item = [f32; 2]> {
    subpath.iter().enumerate().map(move |(i, vertex)| {
        let before = if i > 0 {
            subpath[i - 1].albedo_fwd
        } else {
            1.0
        };
        let after = subpath.get(i + 1).map_or(1.0, |next| next.albedo_rev);
        [
            vertex.pdf_fwd * factor(context, i, before),
            vertex.pdf_rev * factor(context, n - 1 - i, after),
        ]
    })
}
