use super::world;
use bidir::math::{Vec2, Vec3};
use bidir::scene::Scene;
use bidir::shape::Shape;
use bidir::spectrum::Lanes;

/// Returns the normal at the first corner of the only mesh.
#[track_caller]
fn front(text: &str) -> Vec3 {
    let scene = world(text);
    scene.shapes()[0]
        .surface_point(0, Vec2::ZERO, Vec3::ZERO)
        .n_g
}

#[test]
fn the_front_follows_winding_mirrors_reversal_and_normals() {
    let triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    assert_eq!(front(triangle), Vec3::Z);
    assert_eq!(front(&format!("ReverseOrientation {triangle}")), -Vec3::Z);
    // Mirrored in x, the triangle has its front on the same side as before.
    assert_eq!(front(&format!("Scale -1 1 1 {triangle}")), Vec3::Z);
    assert_eq!(front(&format!("Scale 1 1 -1 {triangle}")), -Vec3::Z);
    let normals = "\"normal N\" [0 0 -1 0 0 -1 0 0 -1]";
    assert_eq!(front(&format!("{triangle} {normals}")), -Vec3::Z);
    assert_eq!(
        front(&format!("ReverseOrientation {triangle} {normals}")),
        Vec3::Z
    );
    assert_eq!(
        front(&format!("Scale -1 1 1 {triangle} {normals}")),
        -Vec3::Z
    );
}

const OBJECT: &str = "ObjectBegin \"o\" Translate 0 1 0 \
    Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ObjectEnd\n";

#[test]
fn objects_with_one_place_are_not_shared() {
    let once = "ObjectBegin \"unused\" Shape \"sphere\" ObjectEnd Scale 2 2 2 ObjectInstance \"o\"";
    let scene = world(&format!("{OBJECT}{once}"));
    assert_eq!((scene.instance_count(), scene.unique_primitives()), (0, 1));
    assert_eq!(corners(&scene), [Vec3::new(2.0, 2.0, 0.0)]);
}

#[test]
fn objects_with_several_places_are_shared() {
    let twice = "ObjectInstance \"o\" Scale 2 2 2 ObjectInstance \"o\"";
    let scene = world(&format!("{OBJECT}{twice}"));
    assert_eq!(corners(&scene), [Vec3::new(1.0, 1.0, 0.0)]);
    assert_eq!((scene.instance_count(), scene.unique_primitives()), (2, 1));
    assert_eq!(scene.placed_primitives(), 2);
    let bounds = scene.bvh().bounds();
    assert!(
        bounds.max.distance(Vec3::new(2.0, 4.0, 0.0)) < 1e-4,
        "{bounds:?}"
    );
}

#[test]
fn shapes_of_objects_that_emit_are_lights_at_each_place() {
    let scene = world(
        "ObjectBegin \"o\" Shape \"disk\" AreaLightSource \"diffuse\" Shape \"sphere\" ObjectEnd\n\
         ObjectInstance \"o\" Translate 5 0 0 ObjectInstance \"o\"",
    );
    assert_eq!((scene.lights().len(), scene.instance_count()), (2, 2));
    assert_eq!(
        (scene.unique_primitives(), scene.placed_primitives()),
        (3, 4)
    );
}

/// Returns the second corners of all meshes.
fn corners(scene: &Scene) -> Vec<Vec3> {
    let corner = |shape: &Shape| match shape {
        Shape::Mesh(mesh) => mesh.positions[1],
        _ => panic!("only meshes are placed"),
    };
    scene.shapes().iter().map(corner).collect()
}

/// Returns true if the only light emits to the side of its shape's own z axis, or to its outside.
#[track_caller]
fn emits_to_the_front(world_text: &str) -> bool {
    let scene = world(&format!("AreaLightSource \"diffuse\" {world_text}"));
    let (light, lights) = (&scene.lights()[0], scene.light_context());
    let sample = light.sample_emission(
        &lights,
        Vec2::new(0.3, 0.4),
        || 0.5,
        Vec2::new(0.2, 0.1),
        Lanes::Rgb,
    );
    let sample = sample.expect("it emits");
    let at = sample.from.at;
    // The normal at a hit agrees with that of the sampled point.
    let shape = &scene.shapes()[0];
    let surface = shape.surface_point(0, Vec2::splat(0.3), at.locus.point);
    assert!(surface.n_g.dot(at.locus.n_g) > 0.0);
    let radiance = |w: Vec3| light.emitted(&lights, &at, w, Lanes::Rgb)[0] > 0.0;
    assert!(radiance(sample.direction) && !radiance(-sample.direction));
    match shape {
        Shape::Sphere(_) => sample.direction.dot(at.locus.point) > 0.0,
        _ => sample.direction.z > 0.0,
    }
}

#[test]
fn the_side_that_emits_follows_reversal_and_not_mirrors() {
    let mesh = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    let with_normals = format!("{mesh} \"normal N\" [0 0 1 0 0 1 0 0 1]");
    let against = format!("{mesh} \"normal N\" [0 0 -1 0 0 -1 0 0 -1]");
    let (sphere, disk) = ("Shape \"sphere\"", "Shape \"disk\"");
    // A mirror in x keeps the front of a flat shape, a mirror in z turns it with the shape.
    for (shape, front) in [
        (mesh, true),
        (&with_normals, true),
        (&against, false),
        (sphere, true),
        (disk, true),
    ] {
        let is_sphere = shape == sphere;
        for (map, turns) in [
            ("", false),
            ("Scale -1 1 1", false),
            ("Scale 1 -2 1", false),
            ("Scale 1 1 -1", true),
            ("Scale -1 -1 -1", true),
        ] {
            let expected = front != (turns && !is_sphere);
            assert_eq!(
                emits_to_the_front(&format!("{map} {shape}")),
                expected,
                "{map} {shape}"
            );
            let reversed = format!("ReverseOrientation {map} {shape}");
            assert_eq!(emits_to_the_front(&reversed), !expected, "{reversed}");
        }
    }
}

/// Returns the only mesh of a scene.
fn mesh(text: &str) -> bidir::shape::Mesh {
    let scene = world(text);
    match scene.shapes() {
        [Shape::Mesh(mesh)] => mesh.clone(),
        _ => panic!("the scene has one mesh"),
    }
}

#[test]
fn patches_and_subdivided_meshes_become_triangles() {
    let square = "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]";
    let patch = mesh(&format!("Shape \"bilinearmesh\" {square}"));
    assert_eq!(patch.triangles, [[0, 1, 3], [0, 3, 2]]);
    let tetrahedron = "\"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1] \
        \"integer indices\" [0 2 1 0 1 3 1 2 3 2 0 3]";
    let smooth = mesh(&format!(
        "Shape \"loopsubdiv\" \"integer levels\" 2 {tetrahedron}"
    ));
    assert_eq!((smooth.triangles.len(), smooth.normals.len()), (64, 34));
}

#[test]
fn normals_without_direction_are_those_of_faces() {
    let placed = mesh(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \
         \"integer indices\" [0 1 2 0 2 3 1 1 2] \"normal N\" [0 0 0 0 0 -2 0 0 -2 0 0 -2]",
    );
    assert_eq!(placed.normals, [Vec3::NEG_Z; 4]);
    assert_eq!(placed.triangles.len(), 3);
}
