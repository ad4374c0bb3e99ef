use super::*;
use crate::math::Vec3;
use crate::math::{Vec2, warp};
use crate::testing::check_property;
use proptest::prelude::*;

fn unit() -> impl Strategy<Value = Vec3> {
    (0.0f32..1.0, 0.0f32..1.0).prop_map(|(x, y)| warp::uniform_sphere(Vec2::new(x, y)))
}

/// A flat emitter at a point.
#[derive(Clone, Copy, Debug)]
struct Flat {
    point: Vec3,
    n: Vec3,
    is_mirrored: bool,
}

impl Flat {
    fn around(&self) -> EmitterBounds {
        EmitterBounds {
            bounds: Aabb::around(&[self.point]),
            cone: Cone::flat(self.n, self.is_mirrored),
            intensity: 1.0,
        }
    }

    /// Returns the product of both cosines.
    fn cosines(&self, receiver: &Receiver) -> f32 {
        let w = (self.point - receiver.point).normalize();
        let leaves = match -self.n.dot(w) {
            cos if self.is_mirrored => cos.abs(),
            cos => cos,
        };
        let arrives = match receiver.facing {
            Facing::Front(n) => n.dot(w),
            Facing::Both(n) => n.dot(w).abs(),
            Facing::Anywhere => 1.0,
        };
        leaves.max(0.0) * arrives.max(0.0)
    }
}

fn emitters() -> impl Strategy<Value = Vec<Flat>> {
    let one = (unit(), unit(), prop::bool::weighted(0.2)).prop_map(|(p, n, is_mirrored)| Flat {
        point: p * 0.5,
        n: (n + Vec3::Z * 2.0).normalize(),
        is_mirrored,
    });
    prop::collection::vec(one, 1..6)
}

fn receiver() -> impl Strategy<Value = Receiver> {
    (unit(), 0.0f32..4.0, unit(), 0..3).prop_map(|(p, distance, n, kind)| Receiver {
        point: p * distance,
        facing: match kind {
            0 => Facing::Front(n),
            1 => Facing::Both(n),
            _ => Facing::Anywhere,
        },
    })
}

#[test]
fn no_cosine_of_an_emitter_is_above_the_bound() {
    check_property(&(emitters(), receiver()), |(emitters, receiver)| {
        let all = emitters.iter().map(Flat::around);
        let around = all.reduce(|sum, other| sum.union(&other)).unwrap();
        let mut node = Node::EMPTY;
        node.set(2, Child::Leaf(0), &around);
        let distance2 = receiver.point.distance_squared(around.bounds.center());
        let clamped = distance2.max(radius2(&around.bounds));
        let across = offset(receiver.point, &node.centre);
        let bound = node.importances(&receiver, &across)[2] * clamped / around.intensity;
        for emitter in &emitters {
            let is_bounded = emitter.cosines(&receiver) <= bound * 1.001 + 1e-4;
            prop_assert!(is_bounded, "{bound}");
        }
        prop_assert!(bound <= 1.001);
        Ok(())
    });
}

#[test]
fn nothing_is_zero_or_infinite() {
    for scale in [1e-30, 1e-18, 1.0, 1e18, 1e30] {
        let mut node = Node::EMPTY;
        for (i, x) in [0.0, scale].into_iter().enumerate() {
            let flat = Flat {
                point: Vec3::X * x,
                n: Vec3::X,
                is_mirrored: false,
            };
            node.set(i, Child::Leaf(i as u32), &flat.around());
        }
        for point in [Vec3::ZERO, Vec3::X * scale, -Vec3::X * scale] {
            let facing = Facing::Front(-Vec3::X);
            let [a, b, c, d] = node.shares(&Receiver { point, facing }).of;
            assert!(a + b > 0.999 && a + b < 1.001, "{a} and {b}");
            assert!(a >= 0.0 && b >= 0.0 && c + d <= 0.0);
        }
    }
}
