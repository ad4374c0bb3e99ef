use super::world;
use bidir::math::{Vec2, Vec3};
use bidir::shape::Shape;

/// The normal at the first corner of the only mesh.
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
    // Mirrored in x, the triangle is seen from the same side as before.
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

#[test]
fn instances_are_copies_at_their_places() {
    let scene = world(
        "ObjectBegin \"o\" Translate 0 1 0 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] ObjectEnd\n\
         ObjectBegin \"unused\" Shape \"sphere\" ObjectEnd\n\
         ObjectInstance \"o\" Scale 2 2 2 ObjectInstance \"o\"",
    );
    let corners: Vec<Vec3> = scene
        .shapes()
        .iter()
        .map(|shape| match shape {
            Shape::Mesh(mesh) => mesh.positions[1],
            _ => panic!("only meshes are placed"),
        })
        .collect();
    assert_eq!(
        corners,
        [Vec3::new(1.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 0.0)]
    );
}
