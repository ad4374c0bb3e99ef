//! Lights of every kind in each battery: how rays leave them, how they are connected to, how they
//! are chosen.

mod densities;
mod emission;
mod power;
mod tree;

use super::{
    AreaLight, DistantLight, EmissionSample, EmissionSides, InfiniteLight, Light, LightContext,
    LightSample, Part, SpotLight, VolumeLight,
};
use crate::math::{Frame, Mat3, PI};
use crate::medium::{Glow, Grid, Medium, MediumId};
use crate::sampler::SampleStream;
use crate::shape::{Cylinder, Disk, Mesh, Orientation, Shape, Sphere};
use crate::spectrum::{Lanes, Rgb};
use crate::testing::{check_variants, prelude::*};
use crate::texture::{Bilerp, Image, Mapping};
use accel::Aabb;
use std::sync::Arc;

const COLOR: Rgb = [1.0, 2.0, 0.5];

/// Shapes and media that the lights below refer to.
struct Surroundings {
    shapes: Vec<Shape>,
    media: Vec<Medium>,
}

impl Surroundings {
    fn new() -> Self {
        let map = Affine3A::from_mat3_translation(Mat3::from_rotation_x(0.8) * 1.5, Vec3::ONE);
        let stretched = map * Affine3A::from_scale(Vec3::new(1.0, 0.6, 1.4));
        let (front, limits) = (Orientation::Natural, Vec3::new(-0.2, 0.6, 5.0));
        Self {
            shapes: vec![
                Shape::Mesh(kite()),
                Shape::Sphere(Sphere::new(map, 0.5, front)),
                Shape::Sphere(Sphere::new(stretched, 0.5, Orientation::Reversed)),
                Shape::Disk(Disk::new(stretched, 0.1, [0.2, 1.0], 5.0, front)),
                Shape::Cylinder(Cylinder::new(stretched, 0.4, limits, front)),
            ],
            media: vec![fire(Glow::Even(COLOR.into())), gas()],
        }
    }

    fn context(&self) -> LightContext<'_> {
        LightContext {
            shapes: &self.shapes,
            media: &self.media,
            centre: Vec3::new(0.5, -1.0, 2.0),
            radius: 4.0,
        }
    }
}

/// Two triangles of unlike size in one plane, and one without any.
fn kite() -> Mesh {
    let corners = [(0.0f32, 0.0f32), (1.0, 0.0), (1.0, 1.0), (-1.0, 2.0)];
    let plane = |(x, y)| Vec3::new(1.0 + x, y, 0.5 * x - 0.25 * y);
    Mesh {
        positions: corners.map(plane).to_vec(),
        triangles: vec![[0, 1, 2], [0, 0, 1], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// The number of cells of a fire.
const FIRE: [usize; 3] = [4, 3, 5];

/// Returns the place of the fires' box.
fn fireplace() -> Affine3A {
    Affine3A::from_mat3_translation(turn(), Vec3::new(-0.5, 0.2, 0.0))
        * Affine3A::from_scale(Vec3::new(1.0, 2.0, 0.5))
}

/// Returns a number for a cell of a fire.
fn ember(i: usize) -> f32 {
    (i * 7 % 5) as f32
}

/// Dense in places, and thin in others.
fn fire(glow: Glow) -> Medium {
    let density = (0..60).map(|i| [ember(i)]).collect();
    let density = Grid::new(FIRE, density, fireplace()).unwrap();
    let smoke = smoke(coefficients([0.1, 0.2, 0.4], [0.1; 3]), density, 0.0);
    smoke.glowing(glow).unwrap()
}

/// The same light all over.
fn gas() -> Medium {
    let gas = medium([0.1; 3], [0.0; 3], 0.0);
    gas.glowing(Glow::Even(COLOR.into())).unwrap()
}

/// Returns a dark environment with a bright texel, some even ones and some black.
fn environment() -> InfiniteLight {
    let texel = |i: u16| match i {
        27 => [40.0, 60.0, 30.0],
        _ if i.is_multiple_of(3) => [0.0; 3],
        _ => [0.5, f32::from(i % 7), 1.0],
    };
    let image = Image::new(8, (0..64).map(texel).collect()).unwrap();
    InfiniteLight::image(image, 1.5, turn())
}

/// Bright where u is large, and not at all where v is small.
fn pattern() -> ColorTexture {
    ColorTexture::Bilerp(Arc::new(Bilerp {
        corners: [[-0.5; 3], [1.5, 2.0, 1.0], [0.2; 3], [3.0, 1.0, 2.0]],
        mapping: Mapping::IDENTITY,
    }))
}

fn turn() -> Mat3 {
    Mat3::from_rotation_y(0.9) * Mat3::from_rotation_x(-0.4)
}

fn examples(surroundings: &Surroundings) -> Vec<(&'static str, Light)> {
    let area = |index: usize, sides| {
        let shape = &surroundings.shapes[index];
        Light::Area(AreaLight::new(index, shape, COLOR, sides))
    };
    let patterned = |index: usize| {
        let shape = &surroundings.shapes[index];
        let mut light = AreaLight::new(index, shape, COLOR, EmissionSides::Front);
        light.set_pattern(shape, pattern());
        Light::Area(light)
    };
    let position = Vec3::new(0.3, -2.0, 1.0);
    let axis = Vec3::new(0.6, 0.0, -0.8);
    let volume = |medium: &Medium| {
        let index = surroundings.media.iter().position(|other| other == medium);
        let id = MediumId::new(index.unwrap()).unwrap();
        let bounds = Aabb::around(&[Vec3::NEG_ONE, Vec3::new(0.5, 1.0, 2.0)]);
        Light::Volume(VolumeLight::new(id, medium, Some(bounds)))
    };
    let spot = |angles| Light::Spot(SpotLight::new(position, axis, COLOR, angles));
    let distant = DistantLight {
        to_light: -axis,
        irradiance: COLOR.into(),
    };
    let (front, both) = (EmissionSides::Front, EmissionSides::Both);
    vec![
        ("mesh", area(0, front)),
        ("mesh, both sides", area(0, both)),
        ("ball", area(1, front)),
        ("ellipsoid, reversed", area(2, front)),
        ("ring, both sides", area(3, both)),
        ("cylinder", area(4, front)),
        ("patterned ring", patterned(3)),
        ("patterned mesh", patterned(0)),
        ("point", point_light(position)),
        ("spot", spot([0.3, 0.7])),
        ("spot, hard rim", spot([0.5, 0.5])),
        ("spot, narrow", spot([0.001, 0.01])),
        ("spot, wide", spot([1.0, 2.5])),
        ("distant", Light::Distant(distant)),
        ("constant environment", sky(COLOR)),
        ("environment", Light::Infinite(environment())),
        ("fire", volume(&surroundings.media[0])),
        ("glowing gas", volume(&surroundings.media[1])),
    ]
}

#[test]
fn every_variant_has_an_example() {
    let surroundings = Surroundings::new();
    let lights = examples(&surroundings).into_iter().map(|(_, light)| light);
    check_variants!(lights, Light: Area Point Spot Distant Infinite Volume);
}

/// Calls `check` with every example.
fn for_each_light(mut check: impl FnMut(&'static str, &Light, &LightContext<'_>)) {
    let surroundings = Surroundings::new();
    for (name, light) in examples(&surroundings) {
        check(name, &light, &surroundings.context());
    }
}

/// Draws a ray of a light with the numbers of one emission: two and a third for the position, and two for the direction.
fn emission_of(
    light: &Light,
    context: &LightContext<'_>,
    sample: &SampleStream,
) -> Option<EmissionSample> {
    let (u_position, u_depth, u_direction) = numbers(sample);
    light.sample_emission(context, u_position, || u_depth, u_direction, Lanes::Rgb)
}

/// Returns the numbers of an emission.
fn numbers(sample: &SampleStream) -> (Vec2, f32, Vec2) {
    let get = |purpose| sample.get_2d(Dimension::at(0, purpose));
    let [u_position, u_direction] = [Purpose::LightPosition, Purpose::LightDirection].map(get);
    let u_depth = sample.get_1d(Dimension::at(0, Purpose::LightDepth));
    (u_position, u_depth, u_direction)
}

/// Draws a point of all of a light for a receiver.
fn point_for(
    light: &Light,
    context: &LightContext<'_>,
    receiver: Vec3,
    u: Vec2,
) -> Option<LightSample> {
    light.sample_next_event(context, Part::Whole, receiver, u, || 0.3)
}

/// Returns a frame with narrow lights' axis as its pole.
fn pole() -> Frame {
    Frame::from_z(Vec3::new(0.6, 0.0, -0.8))
}

/// Places that light falls on.
fn receivers() -> [Vec3; 3] {
    [
        Vec3::new(0.0, 0.0, 3.0),
        Vec3::new(1.2, 1.0, 1.1),
        Vec3::new(-6.0, 2.0, 0.0) * PI,
    ]
}
