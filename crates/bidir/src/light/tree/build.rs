//! Builds the tree from the root: divides emitters where the sum of Φ r² m over both sides is least. r is the radius
//! of the ball around a side, and m, from 1 to 4, grows with the spread of its directions. This is the surface-area
//! orientation heuristic of \[Conty18\], with the ball of the importance in place of the box, and without cones,
//! which would need a union for each possible division.
//!
//! With c the length of the mean of the axes, weighted by Φ, m = 4 - 3 c³ is within 5 % of 1/π times the measure of
//! \[Conty18\], for a cone that normals of flat emitters fill evenly.

use super::bounds::EmitterBounds;
use super::node::{Child, Node, WIDTH, is_narrow, radius2};
use crate::math::{PI, Vec3};
use accel::Aabb;

/// The number of bins along each axis: planes of division lie between bins.
const BINS: usize = 16;
/// The level from which emitters are divided into halves by number: 20 levels of quarters suffice for all, and a path
/// has room for 32.
const HEURISTIC_LEVELS: u32 = 12;

/// An emitter, with its number and its bounds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) emitter: u32,
    pub(super) around: EmitterBounds,
}

/// A tree, whose root is the first node.
#[derive(Clone, Debug, Default)]
pub(super) struct Built {
    pub(super) nodes: Vec<Node>,
    /// For each node, where the range of each child begins in `order`; it ends where the next one begins.
    pub(super) begins: Vec<[u32; WIDTH + 1]>,
    /// The emitters with their intensities; those below a node are neighbours.
    pub(super) order: Vec<(u32, f32)>,
    /// The path to each emitter: two bits for each level, those of the root lowest.
    pub(super) paths: Vec<u64>,
}

/// Builds the tree over `items`, of which there is at least one; `paths` has an element for each emitter.
pub(super) fn build(items: &mut [Item], paths: Vec<u64>) -> Built {
    let mut built = Built {
        paths,
        ..Built::default()
    };
    built.node(items, 0, 0);
    built
}

impl Built {
    /// Adds the node of `items` and all nodes below it. Returns its index and its bounds.
    fn node(&mut self, items: &mut [Item], path: u64, level: u32) -> (u32, EmitterBounds) {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        self.begins.push([0; WIDTH + 1]);
        let mut around: Option<EmitterBounds> = None;
        for (i, part) in quarters(items, level).into_iter().enumerate() {
            self.begins[index][i] = self.order.len() as u32;
            let is_uniform = are_even(part);
            let path = path | (i as u64) << (2 * level);
            let (child, of_child) = match part {
                [] => continue,
                [item] => {
                    self.paths[item.emitter as usize] = path;
                    self.order.push((item.emitter, item.around.intensity));
                    (Child::Leaf(item.emitter), item.around)
                }
                items => {
                    let (index, around) = self.node(items, path, level + 1);
                    (Child::Inner(index), around)
                }
            };
            self.nodes[index].set(i, child, &of_child);
            if is_uniform || is_narrow(&of_child.cone) {
                self.nodes[index].set_uniform(i);
            }
            around = Some(around.map_or(of_child, |around| around.union(&of_child)));
        }
        self.begins[index][WIDTH] = self.order.len() as u32;
        let around = around.unwrap_or_else(|| unreachable!("a node has an emitter"));
        (index as u32, around)
    }
}

/// Returns true if all emit in all directions.
fn are_even(items: &[Item]) -> bool {
    items.iter().all(|item| item.around.cone.spread >= PI)
}

/// Divides emitters among the children of a node; children of one half are neighbours.
fn quarters(items: &mut [Item], level: u32) -> [&mut [Item]; WIDTH] {
    let [a, b] = halves(items, level);
    let [[a, b], [c, d]] = [halves(a, level), halves(b, level)];
    [a, b, c, d]
}

/// Divides `items` in two. Neither part is empty if there are two items or more.
fn halves(items: &mut [Item], level: u32) -> [&mut [Item]; 2] {
    let plane = if level < HEURISTIC_LEVELS && items.len() > 1 {
        best_plane(items)
    } else {
        None
    };
    let middle = match plane {
        Some(plane) => partition(items, |item| plane.is_before(item)),
        None => items.len().div_ceil(2),
    };
    let (a, b) = items.split_at_mut(middle);
    [a, b]
}

/// Moves the items that satisfy `is_before` to the front, and returns their number.
fn partition(items: &mut [Item], is_before: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if is_before(&items[i]) {
            items.swap(i, count);
            count += 1;
        }
    }
    count
}

/// The bins along an axis.
#[derive(Clone, Copy)]
struct Axis {
    k: usize,
    from: f32,
    extent: f32,
    bins: usize,
}

impl Axis {
    /// Returns the bin of an emitter's centre.
    fn bin(&self, item: &Item) -> usize {
        let part = (item.around.bounds.center()[self.k] - self.from) / self.extent;
        ((part * self.bins as f32) as usize).min(self.bins - 1)
    }
}

/// A plane of division: it lies before bin number `bin` of `axis`.
struct Plane {
    axis: Axis,
    bin: usize,
}

impl Plane {
    fn is_before(&self, item: &Item) -> bool {
        self.axis.bin(item) < self.bin
    }
}

/// Returns the plane of least cost. None: all centres are one point, or all costs overflow.
fn best_plane(items: &[Item]) -> Option<Plane> {
    let centres = items.iter().fold(Aabb::EMPTY, |bounds, item| {
        let p = item.around.bounds.center();
        bounds.union(Aabb { min: p, max: p })
    });
    let (extent, longest) = (centres.extent(), centres.extent().max_element());
    let axes = (0..3).filter(|&k| extent[k] > 0.0).map(|k| Axis {
        k,
        from: centres.min[k],
        extent: extent[k],
        bins: items.len().min(BINS),
    });
    // Thin slices are penalised [Conty18].
    let planes = axes.filter_map(|axis| {
        let (cost, bin) = best_bin(items, &axis)?;
        Some((cost * longest / axis.extent, Plane { axis, bin }))
    });
    planes
        .min_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, plane)| plane)
}

/// Returns the least cost of a division along an axis, and the bin before which the plane lies.
fn best_bin(items: &[Item], axis: &Axis) -> Option<(f32, usize)> {
    let mut bins = [Sum::EMPTY; BINS];
    for item in items {
        bins[axis.bin(item)].add(&Sum::of(&item.around));
    }
    let mut before = [0.0; BINS];
    let mut sum = Sum::EMPTY;
    for i in 1..axis.bins {
        sum.add(&bins[i - 1]);
        before[i] = sum.cost();
    }
    let mut best = None;
    sum = Sum::EMPTY;
    for i in (1..axis.bins).rev() {
        sum.add(&bins[i]);
        let cost = before[i] + sum.cost();
        if cost.is_finite() && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, i));
        }
    }
    best
}

/// The sum of some emitters.
#[derive(Clone, Copy)]
struct Sum {
    bounds: Aabb,
    intensity: f32,
    /// The sum of the mean directions, weighted by intensity.
    directions: Vec3,
}

impl Sum {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        intensity: 0.0,
        directions: Vec3::ZERO,
    };

    fn of(around: &EmitterBounds) -> Self {
        Self {
            bounds: around.bounds,
            intensity: around.intensity,
            directions: around.cone.mean() * around.intensity,
        }
    }

    fn add(&mut self, other: &Self) {
        self.bounds = self.bounds.union(other.bounds);
        self.intensity += other.intensity;
        self.directions += other.directions;
    }

    /// Returns Φ r² m. It is infinite without emitters, so that no side of a plane is empty.
    fn cost(&self) -> f32 {
        if self.intensity <= 0.0 {
            return f32::INFINITY;
        }
        let order = self.directions.length() / self.intensity;
        let unlike = 4.0 - 3.0 * order * order * order;
        self.intensity * radius2(&self.bounds) * unlike
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::tree::bounds::Cone;

    fn item(emitter: u32, p: Vec3) -> Item {
        Item {
            emitter,
            around: EmitterBounds {
                bounds: Aabb { min: p, max: p },
                cone: Cone::EVERYWHERE,
                intensity: 1.0,
            },
        }
    }

    /// Returns the emitter at the end of a path, and the levels it takes.
    fn follow(built: &Built, emitter: u32) -> (u32, u32) {
        let (mut path, mut node, mut levels) = (built.paths[emitter as usize], 0, 0);
        loop {
            levels += 1;
            match built.nodes[node].children[(path & 3) as usize] {
                Child::Leaf(found) => return (found, levels),
                Child::Inner(next) => node = next as usize,
                Child::None => panic!("the path of emitter {emitter} ends nowhere"),
            }
            path >>= 2;
        }
    }

    #[track_caller]
    fn check(positions: &[Vec3], most_levels: u32) {
        let mut items: Vec<Item> = (0..).zip(positions).map(|(i, &p)| item(i, p)).collect();
        let built = build(&mut items, vec![0; positions.len()]);
        for emitter in 0..positions.len() as u32 {
            let (found, levels) = follow(&built, emitter);
            assert_eq!(found, emitter);
            assert!(levels <= most_levels, "{levels} levels");
        }
    }

    #[test]
    fn every_path_ends_at_its_emitter() {
        let at = |i: u32| Vec3::new(i as f32 % 7.0, i as f32 % 11.0, (i / 77) as f32);
        for count in [2, 3, 4, 5, 17, 1000] {
            let positions: Vec<_> = (0..count).map(at).collect();
            check(&positions, 10);
        }
    }

    #[test]
    fn any_places_fit_the_path() {
        check(&[Vec3::ONE; 1000], 6);
        // Each is twice as far as the one before: the heuristic alone would divide one by one.
        let powers: Vec<_> = (0..120).map(|i| Vec3::X * libm::exp2f(i as f32)).collect();
        check(&powers, 20);
        let far = [Vec3::X * -3e38, Vec3::X * 3e38, Vec3::ZERO];
        check(&far, 3);
    }
}
