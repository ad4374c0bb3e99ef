//! The first samples: of the full estimator, which traces every connection. They tell how bright the
//! image is, and where vertices are.

use super::Settings;
use super::probe::{GROUP, Probe, groups, landed};
use crate::integrator::{Integrator, IntegratorKind, LvcSettings, Workspace, connectable};
use crate::math::Vec3;
use crate::path::{Cells, Connections, PairSums, PathContext};
use crate::scene::Scene;
use crate::select::ShadowRays;
use crate::stats::RayCounts;

/// Enough for the mean luminance to within a few percent in most scenes.
pub(super) const SAMPLES: u64 = 1 << 14;

/// A light vertex that can be connected.
#[derive(Clone, Copy)]
pub(super) struct LightVertex {
    /// Point and normal.
    place: [Vec3; 2],
    /// The light that its subpath begins on.
    light: u32,
}

/// What the samples of every connection found.
#[derive(Default)]
pub(super) struct Survey {
    /// The sum of luminances that samples add to the mean pixel.
    pub(super) luminance: f64,
    /// The light vertices that can be connected.
    pub(super) light: Vec<LightVertex>,
    /// The camera vertices that can be, by their points.
    camera: Vec<Vec3>,
    pub(super) rays: RayCounts,
}

impl Survey {
    pub(super) fn run(scene: &Scene, settings: &Settings) -> Self {
        let integrator =
            IntegratorKind::Bdpt.integrator(ShadowRays::All.selector(0.0), &LvcSettings::default());
        let probe = Probe {
            scene,
            settings,
            connections: Connections::ONE_SUBPATH,
            first: 0,
            pixels: u64::MAX,
        };
        let groups = groups(SAMPLES / GROUP, |group, workspace| {
            let mut survey = Self::default();
            for number in group * GROUP..(group + 1) * GROUP {
                survey.sample(&probe, &*integrator, number, workspace);
            }
            survey
        });
        let mut all = Self::default();
        for (group, stats) in groups {
            all.luminance += group.luminance;
            all.light.extend(group.light);
            all.camera.extend(group.camera);
            all.rays += stats.rays;
        }
        all
    }

    fn sample(
        &mut self,
        probe: &Probe<'_>,
        integrator: &dyn Integrator,
        number: u64,
        workspace: &mut Workspace,
    ) {
        let (scene, sample) = (probe.scene, probe.sample(number));
        let context = probe.context(&sample);
        integrator.sample(&context, &sample, workspace);
        let splats: f64 = landed(&context, workspace).map(|splat| splat.value).sum();
        let own = f64::from(context.luminance(workspace.value));
        self.luminance += own + splats / scene.film().crop.area() as f64;
        self.keep_vertices(&context, workspace);
    }

    fn keep_vertices(&mut self, context: &PathContext<'_>, workspace: &Workspace) {
        let light = &workspace.light.vertices;
        let connectable = connectable(context.settings.light_point, light);
        let vertex = |i: usize| {
            Some(LightVertex {
                place: light[i].place(),
                light: light[0].light?,
            })
        };
        self.light.extend(connectable.filter_map(vertex));
        let camera = workspace.camera.vertices.iter().skip(1);
        let camera = camera.filter(|y| !y.is_delta());
        self.camera.extend(camera.map(|y| y.point));
    }

    /// Cells that suit the vertices.
    pub(super) fn cells(&self) -> Cells {
        let light = self.light.iter().map(|vertex| vertex.place[0]);
        let mut points: Vec<_> = light.chain(self.camera.iter().copied()).collect();
        Cells::new(&mut points)
    }

    /// How many light vertices each cell has where a light begins `gain` times as many subpaths as here.
    pub(super) fn pair_sums(&self, cells: &Cells, gain: impl Fn(u32) -> f64) -> PairSums {
        let mut light_vertices = vec![0.0; Cells::COUNT];
        for vertex in &self.light {
            let [point, n] = vertex.place;
            light_vertices[cells.of(point, n).index()] += gain(vertex.light) / SAMPLES as f64;
        }
        PairSums::uniform(light_vertices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::trial::tests::lamp;
    use crate::driver::{Resources, Session};
    use crate::film::PixelRect;
    use crate::spectrum::luminance;

    /// Light images of pixels that are not rendered are none of the image.
    #[test]
    fn the_mean_is_that_of_the_image() {
        let scene = lamp(PixelRect {
            min: [7, 2],
            max: [9, 4],
        });
        let settings = Settings {
            shadow_rays: ShadowRays::RayRoulette(1.0),
            ..Settings::default()
        };
        let mut session =
            Session::new(&scene, settings, &Resources::default()).expect("the film is small");
        let trained = session.training().map(|training| training.mean_luminance);
        while session.film().passes().len() < 4096 && session.step(&()) {}
        let pixels = session.film().develop().pixels;
        let mean = pixels.iter().copied().map(luminance).sum::<f32>() / pixels.len() as f32;
        let trained = trained.expect("roulette is trained");
        assert!((trained / mean - 1.0).abs() < 0.04, "{trained} for {mean}");
    }
}
