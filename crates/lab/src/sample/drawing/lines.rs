//! Pieces of lines, put together and simplified.

use bidir::math::Vec2;
use std::collections::{BTreeMap, BTreeSet};

/// A place, by its bits: those of pieces that touch are equal.
type Key = [u32; 2];

fn key(place: Vec2) -> Key {
    // -0 and 0 are one place.
    (place + Vec2::ZERO).to_array().map(f32::to_bits)
}

/// Pieces that touch, as long lines. A line ends where other than two pieces meet.
pub(super) fn joined(pieces: &[[Vec2; 2]]) -> Vec<Vec<Vec2>> {
    let mut at: BTreeMap<Key, Vec<usize>> = BTreeMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        for end in piece {
            at.entry(key(*end)).or_default().push(i);
        }
    }
    let mut left: BTreeSet<usize> = (0..pieces.len()).collect();
    let mut lines = Vec::new();
    // Lines with ends first: what is left then are rings.
    let is_end = |place: &Vec2| at[&key(*place)].len() != 2;
    let starts = |i: &usize| pieces[*i].iter().any(is_end);
    let mut order: Vec<usize> = (0..pieces.len()).filter(starts).collect();
    order.extend(0..pieces.len());
    for first in order {
        if left.remove(&first) {
            let [a, b] = pieces[first];
            let mut line = if is_end(&a) { vec![a, b] } else { vec![b, a] };
            follow(pieces, &at, &mut left, &mut line);
            lines.push(line);
        }
    }
    lines
}

/// Goes on from the end of `line` until it ends, or closes.
fn follow(
    pieces: &[[Vec2; 2]],
    at: &BTreeMap<Key, Vec<usize>>,
    left: &mut BTreeSet<usize>,
    line: &mut Vec<Vec2>,
) {
    while let Some(end) = line.last().copied() {
        let around = &at[&key(end)];
        let next = around.iter().find(|i| left.contains(i));
        let Some(&next) = next.filter(|_| around.len() == 2) else {
            return;
        };
        left.remove(&next);
        let [a, b] = pieces[next];
        line.push(if key(a) == key(end) { b } else { a });
    }
}

/// A line without the places that are within `tolerance` of it \[Douglas73\].
pub(super) fn simplified(line: &[Vec2], tolerance: f32) -> Vec<Vec2> {
    let mut keeps = vec![false; line.len()];
    let mut parts = vec![(0, line.len().saturating_sub(1))];
    while let Some((first, last)) = parts.pop() {
        for end in [first, last] {
            if let Some(keep) = keeps.get_mut(end) {
                *keep = true;
            }
        }
        let between = (first + 1)..last;
        let off = |i: &usize| distance(line[*i], line[first], line[last]);
        let farthest = between.max_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(i) = farthest.filter(|i| off(i) > tolerance) {
            parts.extend([(first, i), (i, last)]);
        }
    }
    let kept = line.iter().zip(keeps).filter(|(_, keep)| *keep);
    kept.map(|(place, _)| *place).collect()
}

/// How far `p` is from the piece between `a` and `b`.
fn distance(p: Vec2, a: Vec2, b: Vec2) -> f32 {
    let along = b - a;
    let part = (p - a).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
    p.distance(a + along * part.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(xs: &[[f32; 2]]) -> Vec<Vec2> {
        xs.iter().map(|x| Vec2::from_array(*x)).collect()
    }

    #[test]
    fn pieces_become_lines_and_rings() {
        let square = points(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let sides = [[0, 1], [2, 3], [1, 2], [3, 0]];
        let mut pieces = sides.map(|side| side.map(|i| square[i])).to_vec();
        let ring = joined(&pieces);
        assert_eq!(ring.len(), 1);
        assert_eq!((ring[0].len(), ring[0][0]), (5, ring[0][4]));
        // A line that meets the ring is a line of its own.
        pieces.push([square[2], Vec2::splat(2.0)]);
        pieces.push([Vec2::splat(2.0), Vec2::splat(3.0)]);
        let lines = joined(&pieces);
        let mut lengths: Vec<_> = lines.iter().map(Vec::len).collect();
        lengths.sort_unstable();
        assert_eq!(lengths, [3, 5]);
    }

    #[test]
    fn lines_keep_their_corners() {
        let line = points(&[[0.0, 0.0], [1.0, 0.01], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0]]);
        let simple = simplified(&line, 0.1);
        assert_eq!(simple, points(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]));
        assert_eq!(simplified(&[], 0.1), []);
    }
}
