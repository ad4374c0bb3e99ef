//! Cameras and sensors.

use super::{STRICT, load_text, world};
use bidir::camera::Camera;
use bidir::film::Aov;
use bidir::math::Vec3;

fn camera(text: &str) -> Camera {
    *load_text(&format!("{text} WorldBegin"), &STRICT)
        .view
        .camera()
}

/// Returns the origins and directions of the rays through the middle and through a corner of the film.
fn rays(text: &str) -> [(Vec3, Vec3); 2] {
    let film = "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20";
    let camera = camera(&format!("{text} {film}"));
    [[20.0, 10.0], [0.0, 0.0]].map(|raster| {
        let ray = camera.sample_ray(raster.into(), || [0.5, 0.5].into());
        (ray.origin, ray.direction)
    })
}

#[test]
fn parallel_rays_begin_on_the_screen() {
    let [centre, corner] = rays("Scale 0.5 0.5 0.5 Camera \"orthographic\"");
    assert_eq!(centre, (Vec3::ZERO, Vec3::Z));
    assert_eq!(corner, (Vec3::new(-4.0, 2.0, 0.0), Vec3::Z));
}

/// Stretched and sheared cameras look where pbrt-v4 looks: at the screen point that the map takes to the world.
#[test]
fn cameras_may_be_scaled_unevenly() {
    let [centre, corner] = rays("Scale 2 1 1 Camera \"orthographic\"");
    assert_eq!(centre, (Vec3::ZERO, Vec3::Z));
    assert_eq!(corner, (Vec3::new(-1.0, 1.0, 0.0), Vec3::Z));
    let [_, corner] = rays("Scale 1 4 2 Camera \"perspective\"");
    let expected = Vec3::new(-2.0, 0.25, 0.5).normalize();
    assert!(corner.1.distance(expected) < 1e-6, "{corner:?}");
    // The columns are the images of the axes of the world: x' = x + y/2.
    let shear = "ConcatTransform [1 0 0 0 .5 1 0 0 0 0 1 0 0 0 0 1]";
    let [_, corner] = rays(&format!("{shear} Camera \"perspective\""));
    let expected = Vec3::new(-2.5, 1.0, 1.0).normalize();
    assert!(corner.1.distance(expected) < 1e-6, "{corner:?}");
    let [_, corner] = rays(&format!("{shear} Camera \"orthographic\""));
    assert!(
        corner.0.distance(Vec3::new(-2.5, 1.0, 0.0)) < 1e-6,
        "{corner:?}"
    );
    let [centre, _] =
        rays("Scale 1 2 1 Camera \"spherical\" \"string mapping\" \"equirectangular\"");
    assert!(centre.1.distance(Vec3::NEG_X) < 1e-6, "{centre:?}");
}

/// The rays of one raster position meet where the parallel ray crosses the plane of focus.
#[test]
fn a_lens_of_parallel_rays_is_sharp_at_its_focal_distance() {
    let camera = camera(
        "Camera \"orthographic\" \"float lensradius\" .3 \"float focaldistance\" 5
         Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 20",
    );
    for u in [[0.1, 0.2], [0.7, 0.4], [0.5, 0.9]] {
        let ray = camera.sample_ray([0.0, 0.0].into(), || u.into());
        let t = 5.0 / ray.direction.z;
        let met = ray.origin + ray.direction * t;
        assert!((met - Vec3::new(-2.0, 1.0, 5.0)).length() < 1e-5, "{met}");
    }
}

#[test]
fn spherical_cameras_have_the_filter_of_a_pixel() {
    let loaded = load_text(
        "Camera \"spherical\" \"string mapping\" \"equirectangular\" \"float lensradius\" 1
         PixelFilter \"gaussian\" WorldBegin",
        &STRICT,
    );
    assert!(loaded.view.film().filter.radius().max_element() <= 0.5);
}

#[test]
fn a_sensor_has_white_balance_and_a_limit() {
    let film = |text: &str| {
        let text = format!("Film \"rgb\" \"float iso\" 200 {text} WorldBegin");
        load_text(&text, &STRICT).view.film().clone()
    };
    assert!(film("").sensor.balance.is_none() && film("").sensor.limit.is_none());
    let warm = film("\"float whitebalance\" 3200");
    let [r, g, b] = warm.sensor.respond([1.0; 3]);
    assert!(r < 0.5 && (g - 1.1).abs() < 0.1 && b > 2.5, "{r} {g} {b}");
    let limited = film("\"float maxcomponentvalue\" 10");
    // The limit applies before exposure, which doubles it.
    let cut = Vec3::from(limited.sensor.respond([10.0, 5.0, 0.0]));
    assert!((cut - Vec3::new(5.0, 2.5, 0.0)).length() < 1e-6, "{cut}");
}

#[test]
fn a_gbuffer_has_layers() {
    let loaded = load_text(
        "Film \"gbuffer\" \"string coordinatesystem\" \"world\" WorldBegin",
        &STRICT,
    );
    assert!(loaded.settings.aovs.contains(&Aov::ShadingNormal));
}

#[test]
fn spectra_become_colours() {
    let intensity = |text: &str| {
        let scene = world(&format!("LightSource \"point\" {text}"));
        match scene.lights() {
            [bidir::light::Light::Point(light)] => light.intensity.clone(),
            _ => panic!("the scene has a point light"),
        }
    };
    let lamp = intensity("\"blackbody I\" 2856 \"float scale\" 2");
    let [r, g, b] = lamp.color();
    // The hue of incandescent lamps, 1 : 0.45 : 0.13.
    assert!((g / r - 0.448).abs() < 0.01 && (b / r - 0.127).abs() < 0.01);
    assert!((lamp.luminance() - 2.0).abs() < 1e-2);
    // Wien's law, which is nearly right here: S ∝ exp(-c2 / λT) / λ⁵.
    let hue = lamp.hue().expect("lamps keep their spectra");
    let wien = libm::exp(-1.438_776_877e-2 / 2856.0 * (1.0 / 450e-9 - 1.0 / 650e-9));
    let expected = wien * libm::pow(650.0 / 450.0, 5.0);
    assert!((hue.at(450.0) / hue.at(650.0) / expected - 1.0).abs() < 1e-3);
    let even = intensity("\"spectrum I\" [300 7 900 7]");
    assert!((even.luminance() - 1.0).abs() < 1e-3, "{even:?}");
}
