//! The choice by a tree: an emitter is drawn with the probability that is found again, and all that
//! light a receiver have one.

use super::{Surroundings, examples, receivers};
use crate::light::{
    AreaLight, ChosenEmitter, EmissionSides, Facing, Light, LightTree, Part, Receiver,
};
use crate::math::{PI, sin_cos, warp};
use crate::shape::{Mesh, Shape};
use crate::spectrum::Lanes;
use crate::testing::prelude::*;

/// Shapes, lights of all kinds and a tree over them.
struct World {
    surroundings: Surroundings,
    lights: Vec<Light>,
}

impl World {
    /// With the lights that `keeps` keeps.
    fn new(keeps: impl Fn(&Light) -> bool) -> Self {
        let mut surroundings = Surroundings::new();
        surroundings.shapes.push(Shape::Mesh(ring()));
        let index = surroundings.shapes.len() - 1;
        let examples = examples(&surroundings).into_iter();
        let mut lights: Vec<Light> = examples.map(|(_, light)| light).collect();
        for sides in [EmissionSides::Front, EmissionSides::Both] {
            let shape = &surroundings.shapes[index];
            let light = AreaLight::new(index, shape, [0.5, 1.0, 4.0], sides);
            lights.push(Light::Area(light));
        }
        lights.retain(keeps);
        Self {
            surroundings,
            lights,
        }
    }

    fn tree(&self) -> LightTree {
        LightTree::new(&self.lights, &self.surroundings.context())
    }

    /// Returns all primitives of all lights.
    fn primitives(&self) -> Vec<(u32, u32)> {
        let count = |light: &Light| match light {
            Light::Area(light) => self.surroundings.shapes[light.shape_index()].primitive_count(),
            _ => 1,
        };
        let all = (0..).zip(&self.lights);
        all.flat_map(|(i, light)| (0..count(light) as u32).map(move |primitive| (i, primitive)))
            .collect()
    }

    /// Returns every emitter once, with its probability.
    fn emitters(&self, tree: &LightTree, receiver: &Receiver) -> Vec<ChosenEmitter> {
        let find = |(light, primitive)| tree.find(|| *receiver, light, primitive);
        let mut emitters: Vec<_> = self.primitives().into_iter().map(find).collect();
        emitters.dedup();
        emitters
    }
}

/// Returns a band of triangles that faces outwards all around, and is not flat.
fn ring() -> Mesh {
    const N: u32 = 24;
    let position = |i: u32| {
        let (sin, cos) = sin_cos(PI * i as f32 / N as f32);
        let radius = 3.0 + 0.4 * (i % 3) as f32;
        let z = (i % 2) as f32 + 0.1 * (i % 5) as f32;
        Vec3::new(radius * cos, radius * sin, z)
    };
    let triangle = |i: u32| match i % 2 {
        0 => [i, (i + 2) % (2 * N), i + 1],
        _ => [i, (i + 1) % (2 * N), (i + 2) % (2 * N)],
    };
    Mesh {
        positions: (0..2 * N).map(position).collect(),
        triangles: (0..2 * N).map(triangle).collect(),
        ..Mesh::default()
    }
}

/// Places far away, among the emitters, and on one of them, on either side and on both.
fn all_receivers() -> Vec<Receiver> {
    let n = Vec3::new(0.48, -0.6, 0.64);
    let on_a_lamp = ring().positions[4];
    let others = [on_a_lamp, Vec3::ZERO, Vec3::splat(1e4)];
    let (front, back) = (Facing::Front(n), Facing::Front(-n));
    let facings = [front, back, Facing::Both(n), Facing::Anywhere];
    let at = |point| facings.map(|facing| Receiver { point, facing });
    receivers().into_iter().chain(others).flat_map(at).collect()
}

fn worlds() -> [(&'static str, World); 4] {
    let is_point = |light: &Light| matches!(light, Light::Point(_));
    [
        ("all kinds", World::new(|_| true)),
        ("finite", World::new(|light| !light.is_infinite())),
        ("infinite", World::new(Light::is_infinite)),
        (
            "one finite",
            World::new(|light| light.is_infinite() || is_point(light)),
        ),
    ]
}

#[test]
fn probabilities_sum_to_one_and_are_those_of_the_draws() {
    for (name, world) in worlds() {
        let tree = world.tree();
        for (receiver, k) in all_receivers().into_iter().zip(0..) {
            let emitters = world.emitters(&tree, &receiver);
            let sum: f32 = emitters.iter().map(|emitter| emitter.prob).sum();
            let case = format!("{name}, receiver {k}");
            check_close(sum, 1.0, 1e-4, &case);
            check_draws(&tree, &receiver, &emitters, &case);
        }
    }
}

/// Checks that even numbers lead to each emitter in proportion to its probability. An emitter takes
/// one interval of them, so that its count is off by one or two and nothing else.
#[track_caller]
fn check_draws(tree: &LightTree, receiver: &Receiver, emitters: &[ChosenEmitter], case: &str) {
    const N: u16 = 1 << 15;
    let mut counts = vec![0u16; emitters.len()];
    for i in 0..N {
        let u = (f32::from(i) + 0.5) / f32::from(N);
        let drawn = tree.sample(|| *receiver, || u).unwrap();
        // The same number, so that both ends of a path agree.
        let found = emitters.iter().position(|emitter| *emitter == drawn);
        counts[found.unwrap_or_else(|| panic!("{case}: {drawn:?}"))] += 1;
    }
    for (emitter, count) in emitters.iter().zip(counts) {
        let expected = emitter.prob * f32::from(N);
        let error = (f32::from(count) - expected).abs();
        assert!(error < 2.5, "{case}: {count} of {N} draws of {emitter:?}");
    }
}

#[test]
fn whatever_lights_a_receiver_can_be_drawn() {
    let world = World::new(|_| true);
    let (tree, context) = (world.tree(), world.surroundings.context());
    let mut lit = 0;
    for sample in samples("lit", 300) {
        let get = |dimension| sample.get_2d(Dimension::at(dimension, Purpose::Scatter));
        let (n, place) = (warp::uniform_sphere(get(0)), warp::uniform_sphere(get(1)));
        let point = place * (8.0 * get(2).x) + Vec3::new(0.5, -1.0, 1.0);
        let facing = Facing::Front(n);
        let receiver = Receiver { point, facing };
        for emitter in world.emitters(&tree, &receiver) {
            let ChosenEmitter { light, part, prob } = emitter;
            let light = &world.lights[light as usize];
            let shines = (3..20).any(|i| {
                let drawn = light.sample_next_event(&context, part, point, get(i), || 0.3);
                // A triangle without area is drawn by nobody else.
                let Some(drawn) = drawn.filter(|drawn| drawn.pdf.is_finite()) else {
                    return false;
                };
                let w = drawn.at.locus.direction_from(point).normalize();
                let emitted = light.emitted(&context, &drawn.at, -w, Lanes::Rgb);
                n.dot(w) > 0.0 && !emitted.is_black()
            });
            assert!(prob > 0.0 || !shines, "{emitter:?} at {point}");
            lit += usize::from(shines);
        }
    }
    assert!(lit > 5000, "{lit}");
}

/// The point of a part has the density that is found again from the point alone.
#[test]
fn points_of_parts_have_the_density_that_is_found_again() {
    let world = World::new(|_| true);
    let (tree, context) = (world.tree(), world.surroundings.context());
    let mut primitives = 0;
    for (receiver, k) in all_receivers().into_iter().zip(0..) {
        for sample in samples(&format!("parts {k}"), 500) {
            let get = |purpose| Dimension::at(0, purpose);
            let u = sample.get_1d(get(Purpose::NextEventLight));
            let drawn = tree.sample(|| receiver, || u).unwrap();
            let light = &world.lights[drawn.light as usize];
            let u = sample.get_2d(get(Purpose::NextEventPosition));
            let point = light.sample_next_event(&context, drawn.part, receiver.point, u, || 0.3);
            let Some(point) = point else { continue };
            let found = tree.find(|| receiver, drawn.light, point.at.primitive);
            assert_eq!(found, drawn);
            let pdf = light.pdf_next_event(&context, found.part, receiver.point, &point.at);
            check_close(point.pdf, pdf, 1e-3, "a point");
            primitives += usize::from(found.part != Part::Whole);
        }
    }
    assert!(primitives > 1000, "{primitives}");
}

#[test]
fn half_of_the_choices_know_of_the_sky() {
    let world = World::new(|_| true);
    let (tree, context) = (world.tree(), world.surroundings.context());
    let power = |light: &Light| light.power(&context);
    let total: f32 = world.lights.iter().map(power).sum();
    for receiver in all_receivers() {
        for (i, light) in (0..).zip(&world.lights).filter(|(_, l)| l.is_infinite()) {
            let expected = 0.5 * power(light) / total;
            check_close(tree.find(|| receiver, i, 0).prob, expected, 1e-4, "a sky");
        }
    }
}

#[test]
fn one_emitter_takes_no_number() {
    let world = World::new(|light| matches!(light, Light::Point(_)));
    let receiver = all_receivers()[0];
    let tree = world.tree();
    let drawn = tree.sample(|| receiver, || panic!("a number is asked for"));
    assert_eq!(drawn, Some(tree.find(|| receiver, 0, 0)));
    assert!((drawn.unwrap().prob - 1.0).abs() <= 0.0);
    let dark = World::new(|_| false);
    assert!(dark.tree().sample(|| receiver, || 0.5).is_none());
}

/// Emitters that are near are preferred, as are those that face the receiver.
#[test]
fn what_is_near_and_faces_the_receiver_is_preferred() {
    let world = World::new(|light| matches!(light, Light::Area(_)));
    let ring = world.lights.len() as u32 - 2;
    let outside = Receiver {
        point: Vec3::new(8.0, 0.0, 0.5),
        facing: Facing::Front(-Vec3::X),
    };
    let [near, far, a, b] = [0, 24, 12, 36].map(|i| world.tree().find(|| outside, ring, i).prob);
    let is_preferred = near > 5.0 * far && near > a.max(b);
    assert!(is_preferred, "{near}, {far}, {a}, {b}");
}
