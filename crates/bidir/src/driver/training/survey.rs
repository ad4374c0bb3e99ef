//! The first samples: of the full estimator, which traces every connection. They tell how bright the
//! image is, and where vertices are.

use super::effort::Late;
use super::extent::{Extent, work};
use super::pilot;
use super::probe::{Probe, groups, landed};
use super::{Settings, Task};
use crate::integrator::{Integrator, IntegratorKind, LvcSettings, Workspace, connectable};
use crate::math::Vec3;
use crate::path::{Cells, Connections, PairSums, PathContext};
use crate::scene::Scene;
use crate::select::ShadowRays;
use crate::stats::Stats;
use crate::view::View;

/// Samples seldom cost so much where the length of paths is limited, or surfaces absorb something. Unit: as
/// [`work`].
const USUAL: f64 = 256.0;
/// The same of samples that learn about connections.
const USUAL_OF_LEARNING: f64 = 384.0;
/// The first samples, by which the others are counted.
const FIRST: u64 = 16;

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
    pub(super) stats: Stats,
}

/// How samples of every connection are taken.
struct Full<'a> {
    probe: Probe<'a>,
    integrator: Box<dyn Integrator>,
}

impl Survey {
    pub(super) fn run(task: Task<'_>) -> Result<Self, Late> {
        let full = Full::new(task);
        let first = full.take(FIRST, 1)?;
        let extent = Extent::new(USUAL, work(&first.stats) / FIRST as f64);
        full.take(extent.groups(), extent.group())
    }

    /// A few samples, which take no time.
    pub(super) fn short(scene: &Scene, view: &View, settings: &Settings) -> Self {
        let task = Task {
            scene,
            view,
            settings,
            is_late: &|| false,
        };
        // It is never late.
        Full::new(task).take(FIRST, 1).unwrap_or_default()
    }

    fn add(&mut self, group: Self, stats: &Stats) {
        self.luminance += group.luminance;
        self.light.extend(group.light);
        self.camera.extend(group.camera);
        self.stats += stats;
    }

    /// The number of samples.
    pub(super) fn samples(&self) -> f64 {
        self.stats.samples as f64
    }

    /// How many samples connections are learnt from.
    pub(super) fn extent_of_learning(&self) -> Extent {
        let connected = 2 * u64::from(pilot::CANDIDATES) * self.stats.rays.camera;
        let work = work(&self.stats) + connected as f64;
        Extent::new(USUAL_OF_LEARNING, work / self.samples())
    }

    /// How many samples compare plans.
    pub(super) fn extent_of_trials(&self) -> Extent {
        Extent::new(USUAL, work(&self.stats) / self.samples())
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
        self.camera.extend(camera.map(|y| y.locus.point));
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
            light_vertices[cells.of(point, n).index()] += gain(vertex.light) / self.samples();
        }
        PairSums::uniform(light_vertices)
    }
}

impl<'a> Full<'a> {
    fn new(task: Task<'a>) -> Self {
        let probe = Probe {
            scene: task.scene,
            view: task.view,
            settings: task.settings,
            connections: Connections::ONE_SUBPATH,
            is_late: task.is_late,
            extent: Extent::new(USUAL, 0.0),
            first: 0,
            pixels: u64::MAX,
        };
        let all = ShadowRays::All.selector(0.0);
        Self {
            probe,
            integrator: IntegratorKind::Bdpt.integrator(all, &LvcSettings::default()),
        }
    }

    /// Takes the first samples, in so many groups of `size`.
    fn take(&self, count: u64, size: u64) -> Result<Survey, Late> {
        let groups = groups(count, self.probe.is_late, |group, workspace| {
            let mut survey = Survey::default();
            for number in group * size..(group + 1) * size {
                self.sample(number, workspace, &mut survey);
            }
            survey
        })?;
        let mut all = Survey::default();
        for (group, stats) in groups {
            all.add(group, &stats);
        }
        Ok(all)
    }

    fn sample(&self, number: u64, workspace: &mut Workspace, survey: &mut Survey) {
        let sample = self.probe.sample(number);
        let context = self.probe.context(&sample);
        self.integrator.sample(&context, &sample, workspace);
        let splats: f64 = landed(&context, workspace).map(|splat| splat.value).sum();
        let own = f64::from(context.luminance(workspace.value));
        let pixels = context.view.film().crop.area() as f64;
        survey.luminance += own + splats / pixels;
        survey.keep_vertices(&context, workspace);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::training::trial::tests::{lamp, view};
    use crate::driver::{Resources, Session};
    use crate::film::PixelRect;
    use crate::film::{FilmSettings, Filter};
    use crate::light::{Light, PointLight};
    use crate::material::Material;
    use crate::math::Affine3A;
    use crate::path::{MAX_VERTICES, PathSettings};
    use crate::scene::SceneBuilder;
    use crate::shape::{Orientation, Shape, Sphere};
    use crate::spectrum::luminance;
    use crate::texture::ColorTexture;

    /// A camera and a lamp in a white sphere: no walk ends before it is as long as any may be.
    fn white_room() -> Scene {
        let mut builder = SceneBuilder::new();
        let white = builder.material(Material::Diffuse {
            reflectance: ColorTexture::Constant([1.0; 3]),
        });
        let wall = Sphere::new(Affine3A::IDENTITY, 1.0, Orientation::Natural);
        builder.shape(Shape::Sphere(wall), white, None);
        builder.light(Light::Point(PointLight {
            position: Vec3::new(0.0, 0.5, 0.0),
            intensity: [1.0; 3],
        }));
        builder.build().expect("the scene is valid")
    }

    #[test]
    fn where_walks_do_not_end_samples_and_training_do() {
        let (scene, view) = (
            white_room(),
            crate::testing::view(FilmSettings::new([8; 2], Filter::default())),
        );
        let settings = Settings {
            path: PathSettings {
                max_depth: None,
                ..PathSettings::default()
            },
            ..Settings::default()
        };
        let count = 4;
        let task = Task {
            scene: &scene,
            view: &view,
            settings: &settings,
            is_late: &|| false,
        };
        let survey = Full::new(task).take(count, 1).expect("nothing is late");
        let longest = count * (MAX_VERTICES as u64 - 1);
        assert_eq!(survey.stats.rays.camera, longest);
        // All pairs are half a million.
        let of_sample = work(&survey.stats) / survey.samples();
        assert!((20_000.0..40_000.0).contains(&of_sample), "{of_sample}");
        let [learning, trials] = [survey.extent_of_learning(), survey.extent_of_trials()];
        assert_eq!([learning, trials].map(Extent::samples), [64; 2]);
    }

    /// Compares the mean of training with that of the image by these strategies.
    #[track_caller]
    fn check_mean(strategies: &str, tolerance: f32) {
        let scene = lamp();
        let view = view(PixelRect {
            min: [7, 2],
            max: [9, 4],
        });
        let mut settings = Settings {
            shadow_rays: ShadowRays::RayRoulette(1.0),
            ..Settings::default()
        };
        settings.path.strategies = strategies.parse().expect("a list of strategies");
        let mut session = Session::new(&scene, &view, settings, &Resources::default())
            .expect("the film is small");
        let trained = session.training().map(|training| training.mean_luminance);
        while session.film().passes().len() < 4096 && session.step(&()) {}
        let pixels = session.film().develop().pixels;
        let mean = pixels.iter().copied().map(luminance).sum::<f32>() / pixels.len() as f32;
        let trained = trained.expect("roulette is trained");
        let difference = (trained / mean - 1.0).abs();
        assert!(difference < tolerance, "{strategies}: {trained} for {mean}");
    }

    /// Light images of pixels that are not rendered are none of the image: with them it would be more than
    /// twice as bright where light images alone make it.
    #[test]
    fn the_mean_is_that_of_the_image() {
        check_mean("all", 0.04);
        check_mean("all,-s0", 0.2);
    }
}
