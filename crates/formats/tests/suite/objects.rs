//! Shared objects look like copies under any rotation, stretch or reflection.

use crate::statistics::{Shown, WHOLE, check_agree, replicates};
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::math::Vec3;
use bidir::path::PathSettings;
use bidir::sampler::{Domain, Sampler, SamplerKind};
use bidir::scene::{RayDraws, Scene, SurfaceHit};
use bidir_formats::pbrt::{LoadOptions, Loaded, build, parse_text};

const HEAD: &str = r#"
LookAt 0 1.2 -3.4  0 0.7 0  0 1 0
Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
PixelFilter "box"
WorldBegin
Material "diffuse" "rgb reflectance" [0.6 0.5 0.4]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-3 0 -3 -3 0 3 3 0 3 3 0 -3]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-3 0 2 -3 3 2 3 3 2 3 0 2]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [6 7 8]
  Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 3 -1 1 3 -1 1 3 1 -1 3 1]
AttributeEnd
"#;

/// A smooth tent, a roof without normals, a reversed and stretched sphere, and a part of a disk.
const SHAPES: &str = r#"
Material "diffuse" "rgb reflectance" [0.3 0.6 0.7]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3 0 3 1]
  "point3 P" [0 0.9 0 0.4 0 0 -0.2 0 0.35 -0.2 0 -0.35] "point2 uv" [0 0 1 0 1 1 0 1]
  "normal N" [0 1 0 0.9 0.3 0 -0.5 0.3 0.8 -0.5 0.3 -0.8]
Shape "trianglemesh" "integer indices" [0 1 2 1 3 2]
  "point3 P" [-0.4 1.3 -0.4 0.3 1.3 -0.4 -0.4 1.6 0.1 0.4 1.6 0.1]
AttributeBegin
  Translate 0.2 1.1 0.1 Scale 1 0.5 0.8
  ReverseOrientation
  Shape "sphere" "float radius" 0.25 "float zmin" -0.2
AttributeEnd
Translate 0 0.7 -0.3 Rotate 70 1 0 0
Shape "disk" "float radius" 0.3 "float innerradius" 0.1 "float phimax" 250
"#;

const PLACES: [&str; 5] = [
    "Translate -1.1 0 0.2",
    "Translate 0 0 0.9 Rotate 40 0 1 0 Scale 1.5 1.5 1.5",
    "Translate 1.1 0.1 0 Scale -1 1 1",
    "Translate 0.3 0 -0.9 Rotate -130 0 1 0 Scale 0.5 0.8 -0.6",
    "Translate -0.6 0 -0.6 ConcatTransform [0.6 0 0.2 0 0.1 0.7 0 0 0 0.1 0.5 0 0 0 0 1]",
];

fn load(world: &str) -> Loaded {
    let description = parse_text("objects.pbrt", &format!("{HEAD}{world}")).expect("it is valid");
    build(&description, &LoadOptions::default()).expect("it is supported")
}

fn shared() -> Loaded {
    let place =
        |place: &&str| format!("AttributeBegin {place} ObjectInstance \"o\" AttributeEnd\n");
    let places: String = PLACES.iter().map(place).collect();
    load(&format!("ObjectBegin \"o\" {SHAPES} ObjectEnd\n{places}"))
}

fn copied() -> Loaded {
    let place = |place: &&str| format!("AttributeBegin {place} {SHAPES} AttributeEnd\n");
    load(&PLACES.iter().map(place).collect::<String>())
}

#[test]
fn shared_objects_are_kept_once() {
    let (shared, copied) = (shared(), copied());
    let (own, object) = (6, 7);
    assert_eq!(shared.summary.primitives, own + object);
    assert_eq!(
        (shared.summary.instances, shared.scene.instance_count()),
        (5, 5)
    );
    assert_eq!(shared.scene.unique_primitives(), own + object);
    assert_eq!(shared.scene.placed_primitives(), own + 5 * object);
    assert_eq!(copied.scene.placed_primitives(), own + 5 * object);
    assert_eq!(
        (
            copied.scene.unique_primitives(),
            copied.scene.instance_count()
        ),
        (own + 5 * object, 0)
    );
}

/// Returns rays through the places from all directions.
fn rays() -> impl Iterator<Item = (Vec3, Vec3)> {
    let sampler = Sampler::new(SamplerKind::Independent, 1);
    (0..20_000).map(move |i| {
        let stream = sampler.stream(Domain::Camera, 0, i);
        let vector = |vertex| {
            let at = |purpose| stream.get_2d(bidir::sampler::Dimension::at(vertex, purpose));
            let (a, b) = (
                at(bidir::sampler::Purpose::Film),
                at(bidir::sampler::Purpose::Lens),
            );
            2.0 * Vec3::new(a.x, a.y, b.x) - 1.0
        };
        let target = Vec3::new(1.5, 0.6, 1.2) * vector(0) + Vec3::Y * 0.6;
        let origin = target + 3.0 * vector(1);
        (origin, (target - origin).normalize_or(Vec3::Y))
    })
}

fn hit(scene: &Scene, (origin, direction): (Vec3, Vec3)) -> Option<SurfaceHit> {
    let stream = Sampler::new(SamplerKind::Independent, 0).stream(Domain::Camera, 0, 0);
    scene.intersect(origin, direction, RayDraws::new(&stream, 1))
}

#[test]
fn shared_objects_have_the_geometry_of_copies() {
    let (shared, copied) = (shared(), copied());
    let (mut hits, mut different) = (0, 0);
    for ray in rays() {
        let (a, b) = (hit(&shared.scene, ray), hit(&copied.scene, ray));
        let (Some(a), Some(b)) = (a, b) else {
            different += usize::from(a.is_some() != b.is_some());
            continue;
        };
        hits += 1;
        let (a, b) = (a.surface, b.surface);
        // A ray near a silhouette may hit only one of the two.
        if a.point.distance(b.point) > 1e-3 {
            different += 1;
            continue;
        }
        let slant = ray.1.dot(b.n_g).abs().max(1e-3);
        assert!(
            a.point.distance(b.point) < 1e-5 / slant,
            "{ray:?} {a:?} {b:?}"
        );
        assert!(a.n_g.dot(b.n_g) > 1.0 - 1e-4 / slant, "{ray:?} {a:?} {b:?}");
        let shading = (a.shading.z.dot(b.shading.z), a.shading.x.dot(b.shading.x));
        let near = 1.0 - 1e-3 / slant;
        assert!(shading.0 > near && shading.1 > near, "{ray:?} {a:?} {b:?}");
        assert!(a.uv.distance(b.uv) < 1e-4 / slant, "{ray:?} {a:?} {b:?}");
        // The error is larger than that of a copy, by the error in the object's own space.
        assert!(
            a.error >= b.error && a.error < 20.0 * b.error,
            "{a:?} {b:?}"
        );
    }
    assert!(
        hits > 5000 && different < 20,
        "{hits} hits, {different} differ"
    );
}

fn settings(integrator: IntegratorKind) -> Settings {
    Settings {
        path: PathSettings {
            max_depth: Some(3),
            ..PathSettings::default()
        },
        ..Settings::new(integrator)
    }
}

#[test]
fn pictures_of_shared_objects_and_of_copies_agree() {
    let (shared, copied) = (shared(), copied());
    let [shared, copied] = [&shared, &copied].map(|loaded| Shown {
        scene: &loaded.scene,
        view: &loaded.view,
    });
    let path = |shown| replicates(shown, &settings(IntegratorKind::Path), 4096);
    let reference = path(copied);
    let blocks = [WHOLE, 1];
    check_agree("shared", &path(shared), &reference, &blocks);
    let bdpt = replicates(shared, &settings(IntegratorKind::Bdpt), 3072);
    check_agree("shared, bdpt", &bdpt, &reference, &blocks);
}

#[test]
fn a_forest_takes_the_memory_of_a_tree() {
    // A height field of ten thousand triangles, a thousand times.
    let n = 71;
    let point = |i: usize| {
        let (x, z) = (i % n, i / n);
        format!("{x} {} {z} ", (x * 7 + z * 11) % 13)
    };
    let points: String = (0..n * n).map(point).collect();
    let corners = (0..n * n).filter(|i| i % n + 1 < n && i / n + 1 < n);
    let square = |i: usize| {
        let (a, b, c, d) = (i, i + 1, i + n, i + n + 1);
        format!("{a} {b} {c} {b} {d} {c} ")
    };
    let indices: String = corners.map(square).collect();
    let tree = format!(
        "ObjectBegin \"tree\" Shape \"trianglemesh\" \"point3 P\" [{points}] \"integer indices\" [{indices}] ObjectEnd\n"
    );
    let places = (0..1000).map(|i| {
        let (x, z) = (100 * (i % 32), 100 * (i / 32));
        format!("AttributeBegin Translate {x} 0 {z} ObjectInstance \"tree\" AttributeEnd\n")
    });
    let loaded = load(&(tree + &places.collect::<String>()));
    let scene = &loaded.scene;
    assert_eq!(scene.placed_primitives(), 6 + 9_800_000);
    let bytes = scene.bvh().memory_bytes();
    assert!(bytes < 2 << 20, "{bytes} bytes");
    let down = hit(scene, (Vec3::new(1234.5, 50.0, 2020.5), -Vec3::Y));
    assert!(down.expect("a tree is below").surface.point.y > 0.0);
}
