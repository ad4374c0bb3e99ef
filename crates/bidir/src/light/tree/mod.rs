//! P(emitter | receiver) = a P(power) + (1 - a) Π I_child / Σ I: a choice for next-event estimation
//! that knows where its receiver is, by a tree over the emitters \[Conty18\] with four children to a
//! node.
//!
//! An emitter is a light, or a triangle of a mesh that emits from more than two. From the root down,
//! a child is chosen by its importance I, about the irradiance that it gives, Φ cosθ / d² for one
//! emitter of intensity Φ [PBRT4, §12.6.3]. For a child that is a ball of radius r at distance d, with normals within
//! θ_o of an axis and emission within θ_e of those, each factor takes its greatest value:
//!
//! - d² is that of the centre, and r² at the least, so that what is within does not depend on where;
//! - θ' = max(0, θ - θ_o - θ_u), with θ from the axis to the receiver, and sinθ_u = r/d the cone in
//!   which the ball is seen: no normal is nearer to the receiver's direction. Beyond θ_e none emits;
//! - θ_r' = max(0, θ_r - θ_u), from the receiver's shading normal to the centre, on the side that
//!   the path goes on at. If the surface transmits, it is |cosθ_r|.
//!
//! Inside of the ball all cosines are 1. If bounds exclude all light, a thousandth is
//! left, as they are rounded, and as a choice has to be made; within the horizon the receiver's
//! cosine is taken for a tenth at least, as much that shines does so at grazing angles.
//!
//! I knows nothing of what is in the way, nor of lights at infinity. For both there is the part a, in
//! which emitters are chosen by power alone. It bounds what ignorance costs: next-event estimation
//! has at most 1/a times the second moment that choosing by power has. Without lights at infinity a
//! is 1/16, so a sixteenth of the samples ignores the tree; with them it is 1/2, so that neither the sky nor the
//! lamps can cost more than twice what they must.
//!
//! Below a child that is at least eight radii away, and whose emitters send their light in much the
//! same directions, or evenly, the choice is by intensity alone: more nodes would add little.
//!
//! One number is used at every level, so that its stratification is kept. The probability of an
//! emitter for a receiver can be found again: each knows its path from the root, as bits.

mod bounds;
mod build;
mod hierarchy;
mod node;

pub(super) use bounds::{Cone, EmitterBounds};

use super::{Light, LightContext, Part};
use crate::math::{Distribution1d, ONE_MINUS_EPSILON, Vec3};
use build::Item;
use hierarchy::Hierarchy;

/// The part of choices by power where there is light at infinity.
const POWER_BESIDE_INFINITY: f32 = 0.5;
/// The same elsewhere.
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
    /// The first emitter of each light; the others of a mesh follow, by primitive.
    first: Vec<u32>,
    by_power: Distribution1d,
    /// a. Range: `[0, 1]`.
    power_part: f32,
    tree: Hierarchy,
}

/// Returns a, for this number of emitters in the tree.
fn power_part(in_tree: usize, beside_infinity: bool) -> f32 {
    match (in_tree, beside_infinity) {
        // There is nothing to choose among.
        (0, _) | (1, false) => 1.0,
        (_, true) => POWER_BESIDE_INFINITY,
        (_, false) => POWER,
    }
}

impl LightTree {
    /// Returns the choice among `lights`.
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

    /// Draws an emitter. None: there is no light. The receiver and the number `u` are
    /// asked for only if there is a choice.
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

    /// Returns the emitter that primitive number `primitive` of a light is, or is a part of, with the
    /// probability that [`sample`](Self::sample) draws it with.
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

    /// Returns the emitter with its probability, of which `in_tree` is the tree's.
    #[inline]
    fn chosen(&self, emitter: usize, in_tree: f32) -> ChosenEmitter {
        let ((light, part), a) = (self.emitters[emitter], self.power_part);
        let prob = a * self.by_power.prob(emitter) + (1.0 - a) * in_tree;
        ChosenEmitter { light, part, prob }
    }
}
