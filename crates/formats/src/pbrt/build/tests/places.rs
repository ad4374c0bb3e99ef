//! Scenes far from the origin of the world, or of an unusual size: their render space, and the rounding
//! errors of vertices.

use super::{STRICT, load_text};
use crate::import::Loaded;
use bidir::camera::Camera;
use bidir::light::Light;
use bidir::material::Relief;
use bidir::math::{DVec3, Vec2, Vec3};
use bidir::scene::RenderSpace;
use bidir::shape::Shape;
use bidir::texture::TexturePoint;

/// Returns a scene of a quad, 2 units wide, a sphere and `more`, moved by `place`, and a camera moved by the
/// inverse, `away`.
fn scene(away: &str, place: &str, more: &str) -> Loaded {
    let text = format!(
        "LookAt 0 1 -4 0 1 0 0 1 0 {away} Camera \"perspective\" \"float lensradius\" 0.25
         WorldBegin {place} {more}
         Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3]
         \"point3 P\" [-1 0 0 -1 2 0 1 2 0 1 0 0]
         Translate 0 0 1 Shape \"sphere\" \"float radius\" 0.5"
    );
    load_text(&text, &STRICT)
}

fn moved(by: [f64; 3], more: &str) -> Loaded {
    let text = |[x, y, z]: [f64; 3]| format!("Translate {x} {y} {z}");
    scene(&text(by.map(|x| -x)), &text(by), more)
}

fn scaled(by: f64, more: &str) -> Loaded {
    let text = |by: f64| format!("Scale {by} {by} {by}");
    scene(&text(1.0 / by), &text(by), more)
}

#[track_caller]
fn check_near(actual: DVec3, expected: [f64; 3], error: f64) {
    assert!(
        actual.distance(expected.into()) < error,
        "{actual}, not {expected:?}"
    );
}

#[test]
fn a_distant_scene_keeps_its_shape() {
    for by in [[1e7, 0.0, 0.0], [1e4, -3e6, 7e5]] {
        let Loaded { scene, view, .. } = moved(by, "");
        let space = scene.space();
        assert_eq!(space.unit.to_bits(), 1.0f64.to_bits());
        let of_world = |[x, y, z]: [f64; 3]| [by[0] + x, by[1] + y, by[2] + z];
        let Shape::Mesh(mesh) = &scene.shapes()[0] else {
            panic!("the first shape is a mesh");
        };
        for (vertex, expected) in [(0, [-1.0, 0.0, 0.0]), (2, [1.0, 2.0, 0.0])] {
            let world = space.world_point(mesh.positions[vertex]);
            check_near(world, of_world(expected), 1e-6);
        }
        let eye = space.world_point(view.camera().pose().origin);
        check_near(eye, of_world([0.0, 1.0, -4.0]), 1e-6);
        let bounds = scene.bvh().bounds();
        check_near(
            space.world_point(bounds.max),
            of_world([1.0, 2.0, 1.5]),
            1e-5,
        );
        assert!(bounds.max.length() < 4.0, "{bounds:?}");
    }
}

#[test]
fn a_scene_at_the_origin_stays_as_it_is() {
    assert_eq!(*moved([0.0; 3], "").scene.space(), RenderSpace::WORLD);
    assert_eq!(*moved([50.0; 3], "").scene.space(), RenderSpace::WORLD);
    assert_eq!(*scaled(1e3, "").scene.space(), RenderSpace::WORLD);
}

#[test]
fn lengths_and_intensities_follow_the_unit() {
    let more = "LightSource \"point\" \"rgb I\" [3 3 3] \"point3 from\" [0 4 0]
         Texture \"h\" \"float\" \"constant\" \"float value\" 0.5
         Material \"diffuse\" \"texture displacement\" \"h\"";
    for by in [1e-12, 1e10] {
        let Loaded { scene, view, .. } = scaled(by, more);
        let unit = scene.space().unit;
        assert_ne!(unit.to_bits(), 1.0f64.to_bits());
        assert!(libm::frexp(unit).0.to_bits() == 0.5f64.to_bits(), "{unit}");
        let Light::Point(light) = scene.light(0) else {
            panic!("the light is a point");
        };
        let distance2 = f64::from(light.position.y * light.position.y);
        let irradiance = f64::from(light.intensity.color()[0]) / distance2;
        let expected = 3.0 / (16.0 * by * by);
        assert!((irradiance / expected - 1.0).abs() < 1e-5, "{irradiance}");
        let Some(Relief::Displacement(height)) = scene.materials()[1].relief() else {
            panic!("the material has heights");
        };
        let at = TexturePoint::of_parameters(Vec2::ZERO);
        assert!((f64::from(height.eval(&at)) * unit - 0.5).abs() < 1e-6);
        let Camera::Perspective(_) = view.camera() else {
            panic!("the camera is one of perspective");
        };
        let lens = |x| view.camera().sample_lens(|| Vec2::new(x, 0.5)).locus.point;
        let radius = scene.space().world_length(lens(1.0).distance(lens(0.5)));
        assert!(
            (f64::from(radius) / (0.25 * by) - 1.0).abs() < 1e-4,
            "{radius}"
        );
    }
}

#[test]
fn shared_objects_far_from_their_origin_get_another_one() {
    let text = "Camera \"perspective\" WorldBegin ObjectBegin \"o\" Translate 1e6 0 0
         Shape \"sphere\" ObjectEnd
         AttributeBegin Translate -1e6 0 3 ObjectInstance \"o\" AttributeEnd
         AttributeBegin Translate -1000003 0 3 ObjectInstance \"o\" AttributeEnd";
    let scene = load_text(text, &STRICT).scene;
    assert_eq!(*scene.space(), RenderSpace::WORLD);
    let of_object = scene.shapes()[0].primitive(0).bounds();
    assert!(of_object.max.length() < 3.0, "{of_object:?}");
    let bounds = scene.bvh().bounds();
    let expected = [Vec3::new(-4.0, -1.0, 2.0), Vec3::new(1.0, 1.0, 4.0)];
    assert!(bounds.min.distance(expected[0]) < 1e-4, "{bounds:?}");
    assert!(bounds.max.distance(expected[1]) < 1e-4, "{bounds:?}");
}
