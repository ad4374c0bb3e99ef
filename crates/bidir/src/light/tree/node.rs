//! The importance I = Φ max(cosθ' cosθ_r', ε) / d² of the four children of a node at once: an estimate of the
//! irradiance at a receiver by all emitters of a child. Unit: W/m², luminance.

#[cfg(test)]
mod tests;

use super::{Cone, EmitterBounds, Facing, Receiver};
use crate::math::lanes::{Vec3x4, dot, offset};
use accel::Aabb;
use glam::Vec4;

/// The number of children of a node.
pub(super) const WIDTH: usize = 4;

/// The factor of the importance if bounds exclude all light: they are rounded, and a choice is needed even if all
/// emitters turn away from the receiver.
const LEAST: f32 = 1e-3;
/// The least cosine of a receiver above its horizon: glossy surfaces reflect at grazing angles, too.
const GRAZING: f32 = 0.1;

/// A child of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Child {
    /// No child.
    None,
    /// An emitter, by number.
    Leaf(u32),
    /// A node, by index.
    Inner(u32),
}

/// The distance, in radii, from which emitters are alike: their distances differ by an eighth at most.
const FAR: f32 = 8.0;
/// The largest spread of normals of emitters that are alike. Unit: rad.
const NARROW: f32 = 0.35;
/// The narrowest emission of emitters that are alike: of narrower cones a receiver may be in some, but not in others.
/// Unit: rad.
const OPEN: f32 = 1.0;

/// Four children, each with a ball around its emitters and a cone around their normals.
#[derive(Clone, Debug)]
pub(super) struct Node {
    centre: Vec3x4,
    radius2: Vec4,
    axis: Vec3x4,
    /// Cosine and sine of θ_o.
    spread: Angle,
    /// cosθ_e.
    cos_opening: Vec4,
    /// 1 if emission is mirrored, else 0.
    mirrored: Vec4,
    /// Φ; 0 if there is no child. Unit: W/sr, luminance.
    intensity: Vec4,
    /// The square of the distance beyond which the emitters of a child are alike. Unit: m².
    far2: Vec4,
    pub(super) children: [Child; WIDTH],
}

/// The shares of the children for a receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    /// I / Σ I of each child.
    pub(super) of: [f32; WIDTH],
    /// A bit for each child, 1 if its emitters are alike.
    alike: u32,
}

impl Shares {
    /// Returns true if the emitters of child number `i` differ only in intensity.
    #[inline]
    pub(super) fn are_alike(&self, i: usize) -> bool {
        self.alike >> i & 1 == 1
    }
}

/// Cosine and sine of angles from 0 to π.
#[derive(Clone, Copy, Debug)]
struct Angle {
    cos: Vec4,
    sin: Vec4,
}

impl Angle {
    #[inline]
    fn of_cos(cos: Vec4) -> Self {
        let sin = (Vec4::ONE - cos * cos).max(Vec4::ZERO).sqrt();
        Self { cos, sin }
    }

    /// Subtracts `other`; the result is at least 0.
    #[inline]
    fn less(&self, other: &Self) -> Self {
        let is_within = self.cos.cmpgt(other.cos);
        let cos = self.cos * other.cos + self.sin * other.sin;
        let sin = self.sin * other.cos - self.cos * other.sin;
        Self {
            cos: Vec4::select(is_within, Vec4::ONE, cos),
            sin: Vec4::select(is_within, Vec4::ZERO, sin),
        }
    }
}

impl Node {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        centre: [Vec4::ZERO; 3],
        radius2: Vec4::ZERO,
        axis: [Vec4::ZERO; 3],
        spread: Angle {
            cos: Vec4::ONE,
            sin: Vec4::ZERO,
        },
        cos_opening: Vec4::ZERO,
        mirrored: Vec4::ZERO,
        intensity: Vec4::ZERO,
        far2: Vec4::INFINITY,
        children: [Child::None; WIDTH],
    };

    /// Sets child number `i`.
    pub(super) fn set(&mut self, i: usize, child: Child, around: &EmitterBounds) {
        let (bounds, cone) = (&around.bounds, &around.cone);
        let centre = bounds.center();
        for k in 0..3 {
            self.centre[k][i] = centre[k];
            self.axis[k][i] = cone.axis[k];
        }
        self.radius2[i] = radius2(bounds);
        self.spread.cos[i] = libm::cosf(cone.spread);
        self.spread.sin[i] = libm::sinf(cone.spread).max(0.0);
        self.cos_opening[i] = libm::cosf(cone.opening);
        self.mirrored[i] = f32::from(cone.is_mirrored);
        self.intensity[i] = around.intensity;
        self.children[i] = child;
    }

    /// Marks the emitters of child number `i` as emitting evenly, or in similar directions.
    pub(super) fn set_uniform(&mut self, i: usize) {
        self.far2[i] = FAR * FAR * self.radius2[i];
    }

    /// Returns the shares of the children for `receiver`.
    #[inline]
    pub(super) fn shares(&self, receiver: &Receiver) -> Shares {
        let across = offset(receiver.point, &self.centre);
        let importances = self.importances(receiver, &across);
        let [a, b, c, d] = importances.to_array();
        Shares {
            of: (importances / ((a + b) + (c + d))).to_array(),
            alike: dot(&across, &across).cmpgt(self.far2).bitmask(),
        }
    }

    /// Returns I of each child: positive, or 0 if there is no child. Unit: W/m², luminance.
    #[inline]
    fn importances(&self, receiver: &Receiver, across: &Vec3x4) -> Vec4 {
        let distance2 = dot(across, across);
        let is_outside = distance2.cmpgt(self.radius2);
        // Seen from outside, the ball is in a cone around its centre.
        let inverse = Vec4::ONE / distance2.max(Vec4::splat(f32::MIN_POSITIVE));
        let seen = Angle::of_cos((Vec4::ONE - self.radius2 * inverse).max(Vec4::ZERO).sqrt());
        let inverse_distance = inverse.sqrt();
        let cos = dot(across, &self.axis) * inverse_distance;
        let leaves = self.emission(cos, &seen);
        let n = receiver.facing.normal();
        let cos = (across[0] * n.x + across[1] * n.y + across[2] * n.z) * -inverse_distance;
        let arrives = reception(receiver.facing, cos, &seen);
        let cosines = (leaves * arrives).max(Vec4::splat(LEAST));
        let factor = Vec4::select(is_outside, cosines, Vec4::ONE);
        let irradiance = self.intensity / distance2.max(self.radius2) * factor;
        // Neither zero nor infinite, so that every child has a share.
        let [least, most] = [f32::MIN_POSITIVE, f32::MAX / 8.0].map(Vec4::splat);
        let is_there = self.intensity.cmpgt(Vec4::ZERO);
        Vec4::select(is_there, irradiance.clamp(least, most), Vec4::ZERO)
    }

    /// Returns cosθ', where θ is between the axes and the direction to the receiver; 0 beyond θ_e.
    #[inline]
    fn emission(&self, cos: Vec4, seen: &Angle) -> Vec4 {
        let cos = Vec4::select(self.mirrored.cmpgt(Vec4::ZERO), cos.abs(), cos);
        let least = Angle::of_cos(cos).less(&self.spread).less(seen).cos;
        Vec4::select(least.cmpgt(self.cos_opening), least, Vec4::ZERO)
    }
}

/// Returns cosθ_r', where θ_r is between the receiver's normal and the direction to the centre; 0 below the
/// horizon.
#[inline]
fn reception(facing: Facing, cos: Vec4, seen: &Angle) -> Vec4 {
    let cos = match facing {
        Facing::Front(_) => cos,
        Facing::Both(_) => cos.abs(),
        Facing::Anywhere => return Vec4::ONE,
    };
    let least = Angle::of_cos(cos).less(seen).cos;
    let lit = least.max(Vec4::splat(GRAZING));
    Vec4::select(least.cmpgt(Vec4::ZERO), lit, Vec4::ZERO)
}

/// Returns true if `cone` is so narrow that its emitters' directions hardly matter from far away.
pub(super) fn is_narrow(cone: &Cone) -> bool {
    cone.spread <= NARROW && cone.opening >= OPEN
}

/// Returns the square of the radius of a ball around the box. Unit: m².
pub(super) fn radius2(bounds: &Aabb) -> f32 {
    bounds.max.distance_squared(bounds.center())
}
