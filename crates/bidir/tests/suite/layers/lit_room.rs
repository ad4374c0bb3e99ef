//! A room with three lamps, which can be lit one by one.

use crate::common::prelude::*;

/// A group of lights of the lit room.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Lamp {
    Ceiling,
    Ball,
    Sky,
}

/// A room without a front wall, seen from outside, of which some lamps are on.
pub(crate) fn lit_room(size: u32, lamps: &[Lamp]) -> Shot {
    let mut builder = builder(size, 0.0);
    let wall = builder.material(diffuse([0.7, 0.5, 0.3]));
    let back = quad(Vec3::new(-2.0, -2.0, 2.0), Vec3::Y * 4.0, Vec3::X * 4.0);
    builder.shape(back, wall, None);
    let floor = quad(Vec3::new(-2.0, -2.0, 2.0), Vec3::X * 4.0, Vec3::Z * -2.0);
    builder.shape(floor, wall, None);
    let lit = |lamp, radiance| emission(radiance).filter(|_| lamps.contains(&lamp));
    builder.light_group(Some("ceiling"));
    let panel = quad(Vec3::new(-0.7, 1.9, 0.5), Vec3::X * 1.4, Vec3::Z);
    builder.shape(panel, wall, lit(Lamp::Ceiling, [6.0, 2.0, 1.0]));
    builder.light_group(None);
    let ball = sphere(Vec3::new(0.9, -0.4, 0.8), 0.3);
    builder.shape(ball, wall, lit(Lamp::Ball, [2.0, 3.0, 9.0]));
    if lamps.contains(&Lamp::Sky) {
        builder.sky([0.2, 0.4, 0.3]);
    }
    builder.build()
}

pub(crate) const LAMPS: [Lamp; 3] = [Lamp::Ceiling, Lamp::Ball, Lamp::Sky];
