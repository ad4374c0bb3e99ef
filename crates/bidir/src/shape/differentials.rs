//! Derivatives of a surface along its parameters: tangents (metres per unit of the parameter) and the change of the
//! normal. Only surfaces with relief, or with textures that depend on the width of a pixel, need them.

use super::{Orientation, Placement};
use crate::math::{Frame, Vec3, sqr};

/// Derivatives along the parameters, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Differentials {
    /// ∂p/∂u. Unit: m.
    pub dp_du: Vec3,
    /// ∂p/∂v.
    pub dp_dv: Vec3,
    /// ∂n_s/∂u of the unit shading normal.
    pub dn_du: Vec3,
    /// ∂n_s/∂v.
    pub dn_dv: Vec3,
}

impl Differentials {
    /// Returns the differentials of a flat surface. If the tangents are parallel or zero, arbitrary unit tangents
    /// around `normal` replace them.
    pub(super) fn flat(normal: Vec3, [dp_du, dp_dv]: [Vec3; 2]) -> Self {
        let area2 = dp_du.cross(dp_dv).length_squared();
        let spans = area2 > 1e-12 * dp_du.length_squared() * dp_dv.length_squared();
        let frame = Frame::from_z(normal);
        let [dp_du, dp_dv] = if spans && area2.is_finite() {
            [dp_du, dp_dv]
        } else {
            [frame.x, frame.y]
        };
        Self {
            dp_du,
            dp_dv,
            dn_du: Vec3::ZERO,
            dn_dv: Vec3::ZERO,
        }
    }

    /// Returns ∇u and ∇v, the change of the parameters along a step on the surface. They are zero if the tangents are
    /// nearly parallel. Unit: 1/m.
    pub fn gradients(&self) -> [Vec3; 2] {
        let (e, f, g) = (
            self.dp_du.length_squared(),
            self.dp_du.dot(self.dp_dv),
            self.dp_dv.length_squared(),
        );
        let area2 = e * g - sqr(f);
        if area2.is_nan() || area2 <= 1e-10 * e * g {
            return [Vec3::ZERO; 2];
        }
        [
            (self.dp_du * g - self.dp_dv * f) / area2,
            (self.dp_dv * e - self.dp_du * f) / area2,
        ]
    }
}

/// Returns the derivative of the unit normal n = N/|N|, given N and its derivative.
pub(super) fn normal_derivative(normal: Vec3, derivative: Vec3) -> Vec3 {
    let length2 = normal.length_squared();
    if length2 == 0.0 {
        return Vec3::ZERO;
    }
    (derivative - normal * (normal.dot(derivative) / length2)) / length2.sqrt()
}

impl Placement {
    /// Returns the derivatives in the world, given the local tangents, the local normal and its derivatives.
    pub(super) fn differentials(
        &self,
        tangents: [Vec3; 2],
        normal: Vec3,
        changes: [Vec3; 2],
        orientation: Orientation,
    ) -> Differentials {
        let n = self.normal(normal) * orientation.sign();
        let tangents = tangents.map(|tangent| self.world_from_local.transform_vector3(tangent));
        let change = |local| normal_derivative(n, self.normal(local) * orientation.sign());
        let [dn_du, dn_dv] = changes.map(change);
        Differentials {
            dn_du,
            dn_dv,
            ..Differentials::flat(n.normalize_or(Vec3::Z), tangents)
        }
    }
}
