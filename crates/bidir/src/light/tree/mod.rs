//! The choice of an emitter for next-event estimation that depends on the receiver: P(emitter | receiver) = a
//! P(power) + (1 - a) Π I_child / Σ I, by a tree over the emitters \[Conty18\] whose nodes have four children.
//!
//! An emitter is a light, or a triangle of an emitting mesh of more than two. From the root down, a child is chosen
//! by its importance I, an estimate of the irradiance that it causes: Φ cosθ / d² for one emitter of intensity Φ
//! [PBRT4, §12.6.3]. The bounds of a child are a ball of radius r at distance d, normals within θ_o of an axis, and
//! emission within θ_e of a normal. Each factor takes its largest value within these bounds:
//!
//! - d is the distance of the centre, and at least r, so that I does not depend on the position within the ball;
//! - θ' = max(0, θ - θ_o - θ_u) is the least angle between a normal and the direction to the receiver, with θ the
//!   angle between the axis and the direction from the centre to the receiver, and θ_u that in which the ball is
//!   seen, sinθ_u = r/d. Beyond θ_e nothing is emitted;
//! - θ_r' = max(0, θ_r - θ_u), with θ_r the angle between the direction to the centre and the receiver's shading
//!   normal, on the side at which the path goes on. If the surface transmits, |cosθ_r| replaces cosθ_r.
//!
//! Inside the ball all cosines are 1. If the bounds exclude all light, a thousandth of it is left, because bounds are
//! rounded, and because a choice is needed. Above the horizon the receiver's cosine counts as at least a tenth,
//! because glossy surfaces reflect much at grazing angles.
//!
//! I ignores occlusion and lights at infinity. For both, a fraction a of the choices is only by power. It bounds the
//! cost of what I ignores: the second moment of next-event estimation is at most 1/a times that of a choice by power.
//! Without lights at infinity a is 1/16; with them it is 1/2, so that neither the sky nor the lamps cost more than
//! twice what they must.
//!
//! Below a child that is at least eight radii away, and whose emitters emit evenly or in similar directions, the
//! choice is only by intensity: more nodes would add little.
//!
//! All levels use one random number, so that its stratification is kept. The probability of a given emitter can be
//! computed, because its path from the root is stored, as bits.

mod bounds;
mod build;
mod hierarchy;
mod node;

pub(super) use bounds::{Cone, EmitterBounds};

use super::{Light, LightContext, Part};
use crate::math::{Distribution1d, ONE_MINUS_EPSILON, Vec3};
use build::Item;
use hierarchy::Hierarchy;

/// The fraction of choices by power if there is light at infinity.
const POWER_BESIDE_INFINITY: f32 = 0.5;
/// The fraction of choices by power if there is no light at infinity.
const POWER: f32 = 1.0 / 16.0;

/// The sides whose light a surface scatters.
#[derive(Clone, Copy, Debug)]
pub enum Facing {
    /// From the side of this unit normal.
    Front(Vec3),
    /// From both sides.
    Both(Vec3),
    /// From all directions alike.
    Anywhere,
}

impl Facing {
    #[inline]
    fn normal(self) -> Vec3 {
        match self {
            Self::Front(n) | Self::Both(n) => n,
            Self::Anywhere => Vec3::ZERO,
        }
    }
}

/// The surface point that a light is chosen for.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// The point.
    pub point: Vec3,
    /// The side of the surface.
    pub facing: Facing,
}

/// An emitter that was chosen, or that a point lies on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChosenEmitter {
    /// The light, by index.
    pub light: u32,
    /// All of it, or a primitive.
    pub part: Part,
    /// The probability. Unitless.
    pub prob: f32,
}

/// The choice of an emitter for a receiver.
#[derive(Clone, Debug)]
pub struct LightTree {
    emitters: Vec<(u32, Part)>,
    /// The index of the first emitter of each light; the other primitives of a mesh follow.
    first: Vec<u32>,
    by_power: Distribution1d,
    /// a. Range: `[0, 1]`.
    power_part: f32,
    tree: Hierarchy,
}

/// Returns a, for this number of emitters in the tree.
fn power_part(in_tree: usize, beside_infinity: bool) -> f32 {
    match (in_tree, beside_infinity) {
        // There is no choice.
        (0, _) | (1, false) => 1.0,
        (_, true) => POWER_BESIDE_INFINITY,
        (_, false) => POWER,
    }
}

impl LightTree {
    /// Makes the choice among `lights`.
    pub fn new(lights: &[Light], context: &LightContext<'_>) -> Self {
        let mut first = Vec::with_capacity(lights.len());
        let mut emitters = Vec::new();
        for (i, light) in (0..).zip(lights) {
            first.push(emitters.len() as u32);
            emitters.extend(light.parts(context).map(|part| (i, part)));
        }
        let light = |i: u32| &lights[i as usize];
        let powers = emitters
            .iter()
            .map(|&(i, part)| light(i).part_power(context, part));
        let finite = (0..).zip(&emitters).filter_map(|(emitter, &(i, part))| {
            let around = light(i).bounds(context, part)?;
            Some(Item { emitter, around })
        });
        let mut items: Vec<Item> = finite.filter(|item| item.around.intensity > 0.0).collect();
        let shines = |light: &Light| light.is_infinite() && light.power(context) > 0.0;
        Self {
            power_part: power_part(items.len(), lights.iter().any(shines)),
            by_power: Distribution1d::new(powers),
            tree: Hierarchy::new(&mut items, emitters.len()),
            emitters,
            first,
        }
    }

    /// Draws an emitter. Calls `receiver` and `u` only if there is a choice. None: there is no light.
    #[inline]
    pub fn sample(
        &self,
        receiver: impl FnOnce() -> Receiver,
        u: impl FnOnce() -> f32,
    ) -> Option<ChosenEmitter> {
        if self.emitters.len() < 2 {
            let &(light, part) = self.emitters.first()?;
            let prob = 1.0;
            return Some(ChosenEmitter { light, part, prob });
        }
        Some(self.sample_among(&receiver(), u()))
    }

    /// Draws among several emitters. Outlined: keeps the path with one emitter small.
    #[inline(never)]
    fn sample_among(&self, receiver: &Receiver, u: f32) -> ChosenEmitter {
        let a = self.power_part;
        let (emitter, in_tree) = if u < a {
            let (emitter, ..) = self.by_power.sample((u / a).min(ONE_MINUS_EPSILON));
            (emitter, self.tree.prob(receiver, emitter))
        } else {
            self.tree
                .sample(receiver, ((u - a) / (1.0 - a)).min(ONE_MINUS_EPSILON))
        };
        self.chosen(emitter, in_tree)
    }

    /// Returns the emitter that primitive number `primitive` of a light is, or belongs to, with the probability that
    /// [`sample`](Self::sample) draws it.
    #[inline]
    pub fn find(
        &self,
        receiver: impl FnOnce() -> Receiver,
        light: u32,
        primitive: u32,
    ) -> ChosenEmitter {
        if self.emitters.len() < 2 {
            let (part, prob) = (Part::Whole, 1.0);
            return ChosenEmitter { light, part, prob };
        }
        self.find_among(&receiver(), light, primitive)
    }

    #[inline(never)]
    fn find_among(&self, receiver: &Receiver, light: u32, primitive: u32) -> ChosenEmitter {
        let first = self.first[light as usize] as usize;
        let emitter = match self.emitters[first].1 {
            Part::Whole => first,
            Part::Primitive(_) => first + primitive as usize,
        };
        self.chosen(emitter, self.tree.prob(receiver, emitter))
    }

    /// Returns an emitter with its probability; `in_tree` is its probability by the tree only.
    #[inline]
    fn chosen(&self, emitter: usize, in_tree: f32) -> ChosenEmitter {
        let ((light, part), a) = (self.emitters[emitter], self.power_part);
        let prob = a * self.by_power.prob(emitter) + (1.0 - a) * in_tree;
        ChosenEmitter { light, part, prob }
    }
}
