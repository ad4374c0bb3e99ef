//! P(emitter | receiver) = a P(power) + (1 - a) Π I_child / Σ I: a choice for next-event estimation
//! that knows where its receiver is, by a tree over the emitters [Conty18] with four children to a
//! node.
//!
//! An emitter is a light, or a triangle of a mesh that emits from more than two. From the root down,
//! a child is chosen by its importance I, about the irradiance that it gives, Φ cosθ / d² for one
//! emitter of intensity Φ. For a child that is a ball of radius r at distance d, with normals within
//! θ_o of an axis and emission within θ_e of those, each factor takes its greatest value:
//!
//! - d² is that of the centre, and r² at the least: no point of the ball is a better guess;
//! - θ' = max(0, θ - θ_o - θ_u), with θ from the axis to the receiver, and sinθ_u = r/d the cone in
//!   which the ball is seen: no normal is nearer to the receiver's direction. Beyond θ_e none emits;
//! - θ_r' = max(0, θ_r - θ_u), from the receiver's shading normal to the centre, on the side that
//!   the path goes on at. Where the surface transmits, it is |cosθ_r|.
//!
//! Inside of the ball all cosines are 1. Where bounds say that no light can come, a thousandth is
//! left, as they are rounded, and as a choice has to be made; within the horizon the receiver's
//! cosine is taken for a tenth at least, as much that shines does so at grazing angles.
//!
//! I knows nothing of what is in the way, nor of lights at infinity. For both there is the part a, in
//! which emitters are chosen by power alone. It bounds what ignorance costs: next-event estimation
//! has at most 1/a times the second moment that choosing by power has. Without lights at infinity a
//! is 1/16, which costs as much of the tree's; with them it is 1/2, so that neither the sky nor the
//! lamps can cost more than twice what they must.
//!
//! Below a child that is at least eight radii away, and whose emitters send their light in much the
//! same directions, or evenly, the choice is by intensity alone: more nodes would tell little more.
//!
//! One number is used at every level, so that its stratification is kept. What a receiver is given
//! for an emitter can be found again: each knows its path from the root, as bits.

mod bounds;
mod build;
mod node;

pub(super) use bounds::{Cone, EmitterBounds};

use super::{Light, LightContext, Part};
use crate::math::{Distribution1d, ONE_MINUS_EPSILON, Vec3};
use build::{Built, Item, build};
use node::Child;
use std::ops::Range;

/// The part of choices by power where there is light at infinity.
const POWER_BESIDE_INFINITY: f32 = 0.5;
/// The same elsewhere.
const POWER: f32 = 1.0 / 16.0;

/// The path of an emitter that is not in the tree: no path ends with so many bits.
const NOWHERE: u64 = u64::MAX;

/// Where the light that a surface scatters comes from.
#[derive(Clone, Copy, Debug)]
pub enum Facing {
    /// From the side of this unit normal.
    Front(Vec3),
    /// From both sides.
    Both(Vec3),
}

impl Facing {
    #[inline]
    fn normal(self) -> Vec3 {
        match self {
            Self::Front(n) | Self::Both(n) => n,
        }
    }
}

/// Whom a light is chosen for.
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
    tree: Built,
    /// Sums of the intensities of the first emitters in the tree's order, from 0.
    sums: Vec<f64>,
    /// The place of each emitter in that order.
    places: Vec<u32>,
}

impl LightTree {
    /// The choice among `lights`.
    pub fn new(lights: &[Light], context: &LightContext<'_>) -> Self {
        let mut first = Vec::with_capacity(lights.len());
        let mut emitters = Vec::new();
        for (i, light) in (0..).zip(lights) {
            first.push(emitters.len() as u32);
            emitters.extend(light.parts(context).map(|part| (i, part)));
        }
        let light = |i: u32| &lights[i as usize];
        let powers = emitters.iter().map(|&(i, part)| match part {
            Part::Whole => light(i).power(context),
            Part::Primitive(primitive) => light(i).primitive_power(context, primitive),
        });
        let mut items: Vec<Item> = (0..)
            .zip(&emitters)
            .filter_map(|(emitter, &(i, part))| {
                let around = light(i).bounds(context, part)?;
                let is_lit = around.intensity > 0.0;
                is_lit.then_some(Item { emitter, around })
            })
            .collect();
        let shines = |light: &Light| light.is_infinite() && light.power(context) > 0.0;
        let power_part = match (items.len(), lights.iter().any(shines)) {
            // There is nothing to choose among.
            (0, _) | (1, false) => 1.0,
            (_, true) => POWER_BESIDE_INFINITY,
            (_, false) => POWER,
        };
        let by_power = Distribution1d::new(powers);
        let paths = vec![NOWHERE; emitters.len()];
        let tree = if power_part < 1.0 {
            build(&mut items, paths)
        } else {
            Built {
                paths,
                ..Built::default()
            }
        };
        let mut places = vec![0; emitters.len()];
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        for (place, &(emitter, intensity)) in (0..).zip(&tree.order) {
            places[emitter as usize] = place;
            sum += f64::from(intensity);
            sums.push(sum);
        }
        Self {
            emitters,
            first,
            by_power,
            power_part,
            tree,
            sums,
            places,
        }
    }

    /// Draws an emitter. None: there is no light. The number `u` is asked for where there is a choice.
    #[inline]
    pub fn sample(&self, receiver: &Receiver, u: impl FnOnce() -> f32) -> Option<ChosenEmitter> {
        if self.emitters.len() < 2 {
            let &(light, part) = self.emitters.first()?;
            let prob = 1.0;
            return Some(ChosenEmitter { light, part, prob });
        }
        let (u, a) = (u(), self.power_part);
        let (emitter, in_tree) = if u < a {
            let (emitter, ..) = self.by_power.sample((u / a).min(ONE_MINUS_EPSILON));
            (emitter, self.prob_in_tree(receiver, emitter))
        } else {
            self.descend(receiver, ((u - a) / (1.0 - a)).min(ONE_MINUS_EPSILON))
        };
        Some(self.chosen(emitter, in_tree))
    }

    /// The emitter that primitive number `primitive` of a light is, or is a part of, with the
    /// probability that [`sample`](Self::sample) draws it with.
    #[inline]
    pub fn find(&self, receiver: &Receiver, light: u32, primitive: u32) -> ChosenEmitter {
        let first = self.first[light as usize] as usize;
        if self.emitters.len() < 2 {
            let (part, prob) = (Part::Whole, 1.0);
            return ChosenEmitter { light, part, prob };
        }
        let emitter = match self.emitters[first].1 {
            Part::Whole => first,
            Part::Primitive(_) => first + primitive as usize,
        };
        self.chosen(emitter, self.prob_in_tree(receiver, emitter))
    }

    /// The emitter with its probability, of which `in_tree` is the tree's.
    #[inline]
    fn chosen(&self, emitter: usize, in_tree: f32) -> ChosenEmitter {
        let ((light, part), a) = (self.emitters[emitter], self.power_part);
        let prob = a * self.by_power.prob(emitter) + (1.0 - a) * in_tree;
        ChosenEmitter { light, part, prob }
    }

    /// Draws an emitter of the tree with its probability.
    #[inline]
    fn descend(&self, receiver: &Receiver, u: f32) -> (usize, f32) {
        let (mut u, mut prob, mut node) = (u, 1.0, 0);
        loop {
            let shares = self.tree.nodes[node].shares(receiver);
            let (i, share) = choose(&mut u, shares.of);
            prob *= share;
            match self.tree.nodes[node].children[i] {
                Child::Inner(_) if shares.are_alike(i) => {
                    let range = self.below(node, i);
                    let place = self.choose_alike(&range, u);
                    let (emitter, _) = self.tree.order[place];
                    return (emitter as usize, prob * self.prob_alike(&range, place));
                }
                Child::Inner(next) => node = next as usize,
                Child::Leaf(emitter) => return (emitter as usize, prob),
                Child::None => unreachable!("what is not there has no share"),
            }
        }
    }

    /// The probability that [`descend`](Self::descend) draws `emitter` with: the same products.
    #[inline]
    fn prob_in_tree(&self, receiver: &Receiver, emitter: usize) -> f32 {
        let mut path = self.tree.paths[emitter];
        if path == NOWHERE {
            return 0.0;
        }
        let (mut prob, mut node) = (1.0, 0);
        loop {
            let i = (path & 3) as usize;
            path >>= 2;
            let shares = self.tree.nodes[node].shares(receiver);
            prob *= shares.of[i];
            let Child::Inner(next) = self.tree.nodes[node].children[i] else {
                return prob;
            };
            if shares.are_alike(i) {
                let place = self.places[emitter] as usize;
                return prob * self.prob_alike(&self.below(node, i), place);
            }
            node = next as usize;
        }
    }

    /// The places of the emitters below child number `i` of a node.
    #[inline]
    fn below(&self, node: usize, i: usize) -> Range<usize> {
        let begins = &self.tree.begins[node];
        begins[i] as usize..begins[i + 1] as usize
    }

    /// Draws one of the places of a range by intensity.
    #[inline]
    fn choose_alike(&self, range: &Range<usize>, u: f32) -> usize {
        let (from, to) = (self.sums[range.start], self.sums[range.end]);
        let target = from + f64::from(u) * (to - from);
        let ends = &self.sums[range.start + 1..range.end];
        range.start + ends.partition_point(|&end| end <= target)
    }

    /// The probability of [`choose_alike`](Self::choose_alike).
    #[inline]
    fn prob_alike(&self, range: &Range<usize>, place: usize) -> f32 {
        let width = |from: usize, to: usize| self.sums[to] - self.sums[from];
        (width(place, place + 1) / width(range.start, range.end)) as f32
    }
}

/// Chooses one of the shares, which sum to 1, and stretches what is left of `u` to `[0, 1)`.
#[inline]
fn choose(u: &mut f32, shares: [f32; node::WIDTH]) -> (usize, f32) {
    let mut before = 0.0;
    let mut chosen = (0, 0.0, 0.0);
    for (i, &share) in shares.iter().enumerate() {
        // The last that begins at or before u; rounding may leave a little after the last one.
        if share > 0.0 && (before <= *u || chosen.1 <= 0.0) {
            chosen = (i, share, before);
        }
        before += share;
    }
    let (i, share, from) = chosen;
    *u = ((*u - from) / share).clamp(0.0, ONE_MINUS_EPSILON);
    (i, share)
}
