//! Walks down the tree: draws an emitter for a receiver, or finds the probability of a given emitter.

use super::Receiver;
use super::build::{Built, Item, build};
use super::node::{Child, WIDTH};
use crate::math::ONE_MINUS_EPSILON;
use std::ops::Range;

/// The path of an emitter that is not in the tree: no path is that long.
const NOWHERE: u64 = u64::MAX;

/// A tree over numbered emitters.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    built: Built,
    /// The sum of the intensities of the first n emitters in the tree's order, from n = 0 on.
    sums: Vec<f64>,
    /// The index of each emitter in that order.
    places: Vec<u32>,
}

impl Hierarchy {
    /// Makes the tree over `items`, which are some of `count` emitters.
    pub(super) fn new(items: &mut [Item], count: usize) -> Self {
        let mut built = Built {
            paths: vec![NOWHERE; count],
            ..Built::default()
        };
        if !items.is_empty() {
            built = build(items, built.paths);
        }
        let mut places = vec![0; count];
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        for (place, &(emitter, intensity)) in (0..).zip(&built.order) {
            places[emitter as usize] = place;
            sum += f64::from(intensity);
            sums.push(sum);
        }
        Self {
            built,
            sums,
            places,
        }
    }

    /// Draws an emitter, and returns its probability with it. There has to be an emitter.
    #[inline]
    pub(super) fn sample(&self, receiver: &Receiver, u: f32) -> (usize, f32) {
        let (mut u, mut prob, mut node) = (u, 1.0, 0);
        loop {
            let shares = self.built.nodes[node].shares(receiver);
            let (i, share) = choose(&mut u, shares.of);
            prob *= share;
            match self.built.nodes[node].children[i] {
                Child::Inner(_) if shares.are_alike(i) => {
                    let range = self.below(node, i);
                    let place = self.choose_alike(&range, u);
                    let (emitter, _) = self.built.order[place];
                    return (emitter as usize, prob * self.prob_alike(&range, place));
                }
                Child::Inner(next) => node = next as usize,
                Child::Leaf(emitter) => return (emitter as usize, prob),
                Child::None => unreachable!("what is not there has no share"),
            }
        }
    }

    /// Returns the probability with which [`sample`](Self::sample) draws `emitter`: the products are the same, hence
    /// the number is.
    #[inline]
    pub(super) fn prob(&self, receiver: &Receiver, emitter: usize) -> f32 {
        let mut path = self.built.paths[emitter];
        if path == NOWHERE {
            return 0.0;
        }
        let (mut prob, mut node) = (1.0, 0);
        loop {
            let i = (path & 3) as usize;
            path >>= 2;
            let shares = self.built.nodes[node].shares(receiver);
            prob *= shares.of[i];
            let Child::Inner(next) = self.built.nodes[node].children[i] else {
                return prob;
            };
            if shares.are_alike(i) {
                let place = self.places[emitter] as usize;
                return prob * self.prob_alike(&self.below(node, i), place);
            }
            node = next as usize;
        }
    }

    /// Returns the range, in the tree's order, of the emitters below child number `i` of a node.
    #[inline]
    fn below(&self, node: usize, i: usize) -> Range<usize> {
        let begins = &self.built.begins[node];
        begins[i] as usize..begins[i + 1] as usize
    }

    /// Draws an index in a range by intensity.
    #[inline]
    fn choose_alike(&self, range: &Range<usize>, u: f32) -> usize {
        let (from, to) = (self.sums[range.start], self.sums[range.end]);
        let target = from + f64::from(u) * (to - from);
        let ends = &self.sums[range.start + 1..range.end];
        range.start + ends.partition_point(|&end| end <= target)
    }

    /// Returns the probability of [`choose_alike`](Self::choose_alike).
    #[inline]
    fn prob_alike(&self, range: &Range<usize>, place: usize) -> f32 {
        let width = |from: usize, to: usize| self.sums[to] - self.sums[from];
        (width(place, place + 1) / width(range.start, range.end)) as f32
    }
}

/// Chooses one of the shares, which sum to 1, and rescales the rest of `u` to `[0, 1)`.
#[inline]
fn choose(u: &mut f32, shares: [f32; WIDTH]) -> (usize, f32) {
    let mut before = 0.0;
    let mut chosen = (0, 0.0, 0.0);
    for (i, &share) in shares.iter().enumerate() {
        // The last share that begins at or before u; by rounding, u may be behind the end of all.
        if share > 0.0 && (before <= *u || chosen.1 <= 0.0) {
            chosen = (i, share, before);
        }
        before += share;
    }
    let (i, share, from) = chosen;
    *u = ((*u - from) / share).clamp(0.0, ONE_MINUS_EPSILON);
    (i, share)
}
