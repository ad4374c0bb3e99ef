use super::*;
use crate::camera::{Camera, Perspective, PerspectiveSettings};
use crate::driver::training::extent::Extent;
use crate::film::{FilmSettings, Filter, FilterKind, PixelRect};
use crate::light::EmissionSides;
use crate::material::Material;
use crate::math::{Affine3A, Vec2, Vec3};
use crate::path::Connections;
use crate::scene::{Emission, Scene, SceneBuilder};
use crate::shape::{Orientation, Shape, Sphere};
use crate::texture::ColorTexture;
use crate::view::View;

/// Blocks of a pixel each.
pub(in crate::driver::training) fn square() -> Blocks {
    Blocks::new(PixelRect {
        min: [0; 2],
        max: [16; 2],
    })
}

impl Trial {
    /// Of pairs of samples, each in a block of its own, that took a camera ray each, the second of them
    /// twice; and of light images in the first block: value and weight.
    pub(in crate::driver::training) fn of(pairs: &[[f64; 2]], splats: &[[f64; 2]]) -> Self {
        let mut trial = Self::default();
        for half in [0, 1, 1] {
            let values = pairs.iter().enumerate();
            trial.values.extend(values.map(|(i, pair)| (i, pair[half])));
        }
        trial.sum_values();
        for &[value, weight] in splats {
            trial.add_splat(0, value, weight);
        }
        trial.stats.samples = trial.values.len() as u64;
        trial.stats.rays.camera = trial.stats.samples;
        trial
    }

    /// As if what is behind the camera rays of block number `i` varied so much.
    pub(in crate::driver::training) fn set_behind(&mut self, i: usize, variance: f64) {
        let block = &mut self.found[i];
        block.behind = variance * block.triples;
    }
}

#[test]
fn what_pixels_differ_by_is_no_variance() {
    // Two pixels of block 3, and one of block 5.
    let values = [
        [(3, 1.0), (3, 7.0), (5, 2.0)],
        [(3, 1.0), (3, 7.0), (5, 3.0)],
        [(3, 1.0), (3, 7.0), (5, 4.0)],
    ]
    .concat();
    let mut trial = Trial {
        values,
        ..Trial::default()
    };
    trial.sum_values();
    trial.stats.samples = 9;
    let blocks = square();
    let variances = [3, 5].map(|i| trial.variance(i, &blocks));
    let behind = [3, 5].map(|i| trial.behind(i, &blocks));
    assert_eq!((variances, behind), ([0.0, 2.0], [0.0, 0.5]));
    let largest = trial.largest_square(|i| if i == 3 { 0.5 } else { 2.0 });
    assert!((largest - 32.0).abs() < 1e-12, "{largest}");
    assert!((trial.mean(3, &blocks) - 4.0).abs() < 1e-12);
}

/// Three paths of known contribution, and densities of both ways to make them: what light images
/// tell is Σ f² / q.
#[test]
fn light_images_tell_of_the_second_moment_of_path_tracing() {
    let (blocks, pixels) = (square(), BLOCKS as f64);
    let paths = [(3.0, 0.25, 1e-4), (1.0, 0.5, 0.3), (2.0, 0.125, 0.02)];
    let mut trial = Trial::default();
    let n = 800.0;
    trial.stats.samples = 800;
    for (f, p, q) in paths {
        let w = pixels * p / (pixels * p + q);
        for _ in 0..(n * p) as u32 {
            trial.add_splat(7, w * f / p, w);
        }
    }
    trial.add_splat(7, 0.0, 0.0);
    let told_beyond = |value: f64| trial.hidden(4.0 * value * value, &blocks, |_| 4.0);
    let told_of = |(f, p, q): (f64, f64, f64)| {
        let w = pixels * p / (pixels * p + q);
        // Of the first path 1 - w is less than what weights can tell.
        let known = w.min(MOST_WEIGHT);
        4.0 * f * f * w * w / (pixels * p * known * (1.0 - known))
    };
    let [first, second, third] = paths.map(told_of);
    let exact = paths.map(|(f, _, q)| 4.0 * f * f / q);
    assert!(first < exact[0] && (second / exact[1] - 1.0).abs() < 1e-9);
    // Path tracing makes the second path of value 10 / 3, the third of 100, the first of 30 000.
    for (value, expected) in [
        (0.0, first + second + third),
        (50.0, first + third),
        (200.0, first),
        (1e5, 0.0),
    ] {
        let [told, largest] = told_beyond(value);
        assert!(
            (told - expected).abs() < 1e-9 * exact[0],
            "beyond {value}: {told} {expected}"
        );
        let largest_expected = if expected > 0.0 { first / 200.0 } else { 0.0 };
        assert!((largest - largest_expected).abs() < 1e-9 * exact[0]);
    }
}

/// A black lamp before nothing.
pub(in crate::driver::training) fn lamp() -> Scene {
    sphere(3.0, Some([2.0; 3]))
}

/// A view of the lamp, of which these pixels of 16 x 16 are rendered.
pub(in crate::driver::training) fn view(crop: PixelRect) -> View {
    let filter = Filter::new(FilterKind::Triangle, Vec2::splat(1.0));
    let camera = Perspective::new(&PerspectiveSettings {
        world_from_camera: Affine3A::IDENTITY,
        resolution: Vec2::splat(16.0),
        screen: [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)],
        lens_radius: 0.1,
        focal_distance: 2.0,
    });
    let film = FilmSettings {
        crop,
        ..FilmSettings::new([16; 2], filter)
    };
    let camera = Camera::Perspective(camera.expect("a rigid camera"));
    View::new(camera, film).expect("the film is not empty")
}

/// A black sphere of this radiance, at this place before the camera.
pub(in crate::driver::training) fn sphere(z: f32, radiance: Option<[f32; 3]>) -> Scene {
    let mut builder = SceneBuilder::new();
    let black = builder.material(Material::Diffuse {
        reflectance: ColorTexture::Constant([0.0; 3]),
    });
    let place = Affine3A::from_translation(Vec3::new(0.0, 0.0, z));
    let sphere = Shape::Sphere(Sphere::new(place, 1.5, Orientation::Natural));
    let light = radiance.map(|radiance| Emission {
        radiance,
        pattern: None,
        sides: EmissionSides::Front,
    });
    builder.shape(sphere, black, light);
    builder.build().expect("the scene is valid")
}

#[test]
fn two_of_three_samples_share_their_camera_ray() {
    let settings = Settings::new(IntegratorKind::Path);
    let probe = Probe {
        is_late: &|| false,
        extent: Extent::new(1.0, 1e9),
        scene: &lamp(),
        view: &view(PixelRect {
            min: [0; 2],
            max: [16; 2],
        }),
        settings: &settings,
        connections: Connections::ONE_SUBPATH,
        first: 77,
        pixels: 4096,
    };
    let trial = Trial::run(&probe, 0.0).expect("nothing is late");
    let sum = |of_block: &dyn Fn(usize) -> f64| (0..BLOCKS).map(of_block).sum::<f64>();
    // What is seen depends on the ray alone, and differs from ray to ray along the lamp's edge.
    assert!(sum(&|i| trial.mean(i, &square())) > 1.0);
    assert!(sum(&|i| trial.variance(i, &square())) > 1.0);
    assert!(sum(&|i| trial.behind(i, &square())) <= 0.0);
}

#[test]
fn more_samples_are_as_if_all_had_been_taken_at_once() {
    let [first, more] = [[[1.0, 3.0], [2.0, 5.0]], [[4.0, 1.0], [0.0, 2.0]]];
    let mut added = Trial::of(&first, &[[2.0, 0.5]]);
    added.add(Trial::of(&more, &[[1.0, 0.25]]));
    let blocks = square();
    for (i, [a, b]) in [(0, [2.0, 3.0]), (1, [3.0, 2.0])] {
        // Half the squares of the differences, of two triples; light images of twelve samples land in block 0.
        let splats = if i == 0 { 5.0 / (12.0 * 256.0) } else { 0.0 };
        let expected = (a * a + b * b) / 4.0 + splats;
        assert!((added.variance(i, &blocks) - expected).abs() < 1e-12);
    }
    let sum_of_first_block = (1.0 + 3.0 + 3.0 + 4.0 + 1.0 + 1.0) / 6.0;
    let splats = 3.0 / 12.0;
    assert!((added.mean(0, &blocks) - sum_of_first_block - splats).abs() < 1e-12);
    assert!((added.largest_square(|_| 1.0) - 25.0).abs() < 1e-12);
    let [told, _] = added.hidden(0.0, &blocks, |_| 1.0);
    let squares = 4.0 / 0.25 + 1.0 / 0.1875;
    assert!((told - squares / (12.0 * 256.0)).abs() < 1e-12);
}
