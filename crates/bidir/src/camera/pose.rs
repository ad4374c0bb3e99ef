//! Where a camera stands, and which way it looks.

use crate::math::{Affine3A, Vec3, sqr};

/// A camera's place: x right, y up, z forward, all of unit length. Mirrored cameras have a
/// left-handed frame in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where it stands.
    pub origin: Vec3,
    /// The picture's right.
    pub right: Vec3,
    /// The picture's up.
    pub up: Vec3,
    /// The optical axis.
    pub forward: Vec3,
    /// Length in the world of a unit of camera space.
    pub(super) scale: f32,
}

impl Pose {
    /// The place of a camera. None: the map is no even scaling with rotation and mirroring, or not
    /// finite.
    pub(super) fn new(world_from_camera: &Affine3A) -> Option<Self> {
        let m = world_from_camera.matrix3;
        let axes = [m.x_axis, m.y_axis, m.z_axis].map(Vec3::from);
        let scale = axes[0].length();
        let even = axes
            .iter()
            .all(|axis| (axis.length() - scale).abs() <= 1e-3 * scale);
        let square = (0..3).all(|i| axes[i].dot(axes[(i + 1) % 3]).abs() <= 1e-3 * sqr(scale));
        let [right, up, forward] = axes.map(|axis| axis / scale);
        (even && square && scale > 0.0 && world_from_camera.is_finite()).then(|| Self {
            origin: world_from_camera.translation.into(),
            right,
            up,
            forward,
            scale,
        })
    }

    /// A world vector in the camera's axes.
    #[inline]
    pub(super) fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(self.right.dot(v), self.up.dot(v), self.forward.dot(v))
    }

    /// The world vector of one in the camera's axes.
    #[inline]
    pub(super) fn to_world(self, v: Vec3) -> Vec3 {
        self.right * v.x + self.up * v.y + self.forward * v.z
    }
}
