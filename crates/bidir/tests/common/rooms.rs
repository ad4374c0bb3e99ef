//! Closed rooms, for the tests of whole paths.

use super::materials::{
    diffuse, glass, lacquer, metal, mix, paper, principled_layers, slant, slanted, varnish,
};
use super::scenes::{
    Shot, ShotBuilder, add_lit_walls, add_walls, builder, emission, medium, octahedron,
    parallelogram, quad, sphere, tilted,
};
use bidir::light::EmissionSides;
use bidir::math::Vec3;
use bidir::medium::{Glow, MediumId, MediumSides};
use bidir::scene::Emission;
use bidir::shape::Shape;

/// Walls, a ceiling light, and floors and balls whose normals are far from those of the mesh: diffuse, metal,
/// plastic, and layers of which the coat has normals of its own. Nothing is a Dirac distribution.
pub(crate) fn steep_room(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    add_lit_walls(&mut builder, slanted(diffuse([0.7, 0.6, 0.5])));
    let [coated, apart] = [None, Some(slant(-0.5, 0.3))].map(|map| principled_layers(0.5, map));
    let materials = [metal(0.4), varnish(0.3), glass(0.5), coated, apart];
    for (i, material) in (0u8..).zip(materials) {
        let material = builder.material(slanted(material));
        let x = -1.4 + 0.7 * f32::from(i);
        builder.shape(sphere(Vec3::new(x, -1.2, 0.3), 0.33), material, None);
        let panel = quad(Vec3::new(x - 0.3, -0.7, 1.8), Vec3::Y * 1.9, Vec3::X * 0.6);
        builder.shape(panel, material, None);
    }
    builder.build()
}

/// A closed room with a ceiling light, a sphere light, a tilted-normal panel, rough metal and
/// rough glass: every density differs from every other, and nothing is a Dirac distribution but
/// the lens.
pub(crate) fn room(lens_radius: f32) -> Shot {
    room_of(8, lens_radius)
}

/// The same with a film of `size` × `size` pixels.
pub(crate) fn room_of(size: u32, lens_radius: f32) -> Shot {
    furnished(size, lens_radius).0.build()
}

/// The same full of fog, with a bubble that only absorbs.
pub(crate) fn foggy_room(lens_radius: f32) -> Shot {
    let (mut builder, _) = furnished(8, lens_radius);
    let outside = builder.fill(medium([0.05, 0.1, 0.0], [0.1, 0.2, 0.4], 0.4));
    let inside = builder.medium(medium([0.2, 0.5, 1.0], [0.0; 3], 0.4));
    builder.bound(sphere(Vec3::new(0.2, 0.3, 0.3), 0.6), outside, inside);
    builder.build()
}

/// The same with ink in the rough glass alone.
pub(crate) fn room_with_ink(lens_radius: f32) -> Shot {
    let (mut builder, glass) = furnished(8, lens_radius);
    let inside = builder.medium(medium([0.5, 0.2, 0.1], [0.4, 0.3, 0.0], 0.4));
    let outside = MediumId::VACUUM;
    builder.sides(glass, MediumSides { outside, inside });
    builder.build()
}

/// The same with a ball of burning gas beside the glass.
pub(crate) fn room_with_fire(lens_radius: f32) -> Shot {
    let (mut builder, _) = furnished(8, lens_radius);
    let gas =
        medium([0.5, 0.2, 0.1], [0.4, 0.3, 0.1], 0.4).glowing(Glow::Even([6.0, 3.0, 1.0].into()));
    let gas = builder.medium(gas.expect("light that can be computed with"));
    let ball = sphere(Vec3::new(0.2, 0.3, 0.3), 0.6);
    builder.bound(ball, MediumId::VACUUM, gas);
    builder.build()
}

/// Walls, lights and the rest of [`room`], and the number of the ball of rough glass.
fn furnished(size: u32, lens_radius: f32) -> (ShotBuilder, usize) {
    let mut builder = builder(size, lens_radius);
    let wall = add_lit_walls(&mut builder, diffuse([0.7, 0.6, 0.5]));
    let bulb = sphere(Vec3::new(1.3, -0.4, 0.8), 0.3);
    builder.shape(bulb, wall, emission([2.0, 3.0, 4.0]));
    builder.shape(tilted_panel(), wall, None);
    builder.add(sphere(Vec3::new(-0.8, -1.2, 0.2), 0.7), metal(0.4));
    let glass = builder.add(sphere(Vec3::new(0.6, -1.1, -0.2), 0.6), glass(0.5));
    (builder, glass)
}

fn tilted_panel() -> Shape {
    let panel = parallelogram(Vec3::new(-1.8, -1.0, 1.5), Vec3::Y * 2.0, Vec3::X * 2.0);
    tilted(panel, Vec3::new(0.5, 0.8, 0.0))
}

fn hanging_sheet() -> Shape {
    let along = Vec3::new(1.0, 0.0, 0.4);
    quad(Vec3::new(0.4, -0.2, 1.0), Vec3::Y * 1.2, along)
}

/// A closed room with many lamps: a mesh, a ball, and quadrilaterals of one and of two sides, on the
/// walls and among what they light.
pub(crate) fn lamp_room(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    let wall = builder.material(diffuse([0.7, 0.6, 0.5]));
    add_walls(&mut builder, wall);
    let mesh = octahedron(Vec3::new(-0.9, 0.3, 0.4), 0.4);
    builder.shape(Shape::Mesh(mesh), wall, emission([2.0, 3.0, 4.0]));
    for i in 0..5u8 {
        let corner = Vec3::new(-1.5 + 0.6 * f32::from(i), 1.9 - 0.3 * f32::from(i % 3), 0.5);
        let sides = match i % 2 {
            0 => EmissionSides::Front,
            _ => EmissionSides::Both,
        };
        let emission = emission([6.0, 5.0, 4.0]).map(|light| Emission { sides, ..light });
        let lamp = quad(corner, Vec3::X * 0.2, Vec3::Z * 0.3);
        builder.shape(lamp, wall, emission);
    }
    let ball = sphere(Vec3::new(1.3, -0.4, 0.8), 0.3);
    builder.shape(ball, wall, emission([2.0, 3.0, 4.0]));
    builder.add(hanging_sheet(), paper());
    builder.add(sphere(Vec3::new(-0.2, -1.1, -0.2), 0.6), glass(0.5));
    builder.build()
}

/// A closed room of varnished walls with a ceiling light, a varnished panel with tilted normals, a
/// sheet of paper, and balls of lacquered metal and of a mixture.
pub(crate) fn gallery(lens_radius: f32) -> Shot {
    let mut builder = builder(8, lens_radius);
    add_lit_walls(&mut builder, varnish(0.0));
    builder.add(tilted_panel(), varnish(0.3));
    builder.add(hanging_sheet(), paper());
    let mixture = mix([metal(0.4), diffuse([0.3, 0.6, 0.9])], 0.5);
    builder.add(sphere(Vec3::new(-0.8, -1.2, 0.2), 0.7), lacquer(0.0, 0.4));
    builder.add(sphere(Vec3::new(0.6, -1.3, -0.2), 0.4), lacquer(0.3, 0.3));
    builder.add(sphere(Vec3::new(1.3, -1.4, 0.8), 0.4), mixture);
    builder.build()
}
