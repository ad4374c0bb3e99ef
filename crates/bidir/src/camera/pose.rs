//! The position and the axes of a camera. Moves keep the frame's handedness: a mirrored
//! camera stays mirrored, and its right is the picture's right.

use crate::math::{Affine3A, Mat3, PI, Vec2, Vec3, sin_cos, sqr};

/// The largest angle between a turned camera's axis and the horizon: beyond it right and left would
/// change places. Unit: radians.
const STEEPEST: f32 = 89.0 / 180.0 * PI;

/// The position and the axes of a camera: x right, y up, z forward, all of unit length. Mirrored cameras have a
/// left-handed frame in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Its position.
    pub origin: Vec3,
    /// The direction to the right of the picture. Unit length.
    pub right: Vec3,
    /// The upward direction of the picture. Unit length.
    pub up: Vec3,
    /// The optical axis.
    pub forward: Vec3,
}

/// An upper triangular matrix S: with the frame Q of a [`Pose`], any camera's map to the world is Q S.
///
/// An even scale is the diagonal (1, 1, 1) times `unit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// S / S_zz. Its columns are the camera's axes in the frame.
    pub(super) axes: [Vec3; 3],
    /// S_zz: length in the world of a unit along the axis.
    pub(super) unit: f32,
}

impl Stretch {
    const EVEN: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

    /// Returns the position on the plane z = 1 of one on the plane z = 1 of camera space.
    #[inline]
    pub(super) fn on_plane(&self, p: Vec2) -> Vec2 {
        self.vector(p) + self.axes[2].truncate()
    }

    /// Returns the vector in planes of equal depth of one in camera space, in the unit along the axis.
    #[inline]
    pub(super) fn vector(&self, v: Vec2) -> Vec2 {
        let [x, y, _] = self.axes;
        Vec2::new(x.x * v.x + y.x * v.y, y.y * v.y)
    }

    /// Returns the area of one of camera space in planes of equal depth.
    pub(super) fn area(&self) -> f32 {
        (self.axes[0].x * self.axes[1].y).abs()
    }

    /// Returns the matrix S, scaled to determinant ±1. None: it is even, which turns no direction.
    pub(super) fn of_directions(&self) -> Option<Mat3> {
        let [x, y, z] = self.axes;
        let size = libm::cbrtf((x.x * y.y * z.z).abs());
        (self.axes != Self::EVEN).then(|| Mat3::from_cols(x / size, y / size, z / size))
    }
}

/// A change of the direction in which a camera looks. Unit: radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// The angle towards the right of the picture.
    pub right: f32,
    /// The angle towards the vertical.
    pub up: f32,
}

impl Pose {
    /// Returns the place of a camera: the frame whose axes x and y span the camera's planes of equal depth, and the
    /// rest of its map. None: the map is flat, or not finite.
    pub(super) fn new(world_from_camera: &Affine3A) -> Option<(Self, Stretch)> {
        let m = world_from_camera.matrix3;
        let axes = [m.x_axis, m.y_axis, m.z_axis].map(Vec3::from);
        let scale = axes[0].length();
        let even = axes
            .iter()
            .all(|axis| (axis.length() - scale).abs() <= 1e-3 * scale);
        let square = (0..3).all(|i| axes[i].dot(axes[(i + 1) % 3]).abs() <= 1e-3 * sqr(scale));
        let (axes, stretch) = if even && square {
            let stretch = Stretch {
                axes: Stretch::EVEN,
                unit: scale,
            };
            (axes.map(|axis| axis / scale), stretch)
        } else {
            stretched(axes)?
        };
        let [right, up, forward] = axes;
        let is_place = stretch.unit > 0.0 && world_from_camera.is_finite();
        let pose = Self {
            origin: world_from_camera.translation.into(),
            right,
            up,
            forward,
        };
        is_place.then_some((pose, stretch))
    }

    /// Converts a vector from the world to the camera's axes.
    #[inline]
    pub fn to_local(self, v: Vec3) -> Vec3 {
        Vec3::new(self.right.dot(v), self.up.dot(v), self.forward.dot(v))
    }

    /// Converts a vector from the camera's axes to the world.
    #[inline]
    pub fn to_world(self, v: Vec3) -> Vec3 {
        self.right * v.x + self.up * v.y + self.forward * v.z
    }

    /// Returns the axis of the world that is up for who looks through the camera: of those that are level with
    /// the picture the one nearest to its up, as a camera without roll has it however steep it looks;
    /// but where two are level, and it looks steeper than 45 degrees, it cannot be known.
    pub fn vertical(&self) -> Vec3 {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
            let upwards = self.up.dot(axis);
            (axis * upwards.signum(), upwards.abs())
        });
        let is_level = |axis: Vec3| self.right.dot(axis).abs() < 1e-3;
        let rank = |(axis, upwards): &(Vec3, f32)| (is_level(*axis) && *upwards > 0.01, *upwards);
        let highest = axes.iter().max_by(|a, b| {
            let ((a_level, a_up), (b_level, b_up)) = (rank(a), rank(b));
            a_level.cmp(&b_level).then(a_up.total_cmp(&b_up))
        });
        highest.map_or(self.up, |(axis, _)| *axis)
    }

    /// Moves the frame.
    #[must_use]
    pub fn shifted(self, by: Vec3) -> Self {
        Self {
            origin: self.origin + by,
            ..self
        }
    }

    /// Returns the camera turned about the point `pivot`: the world's points keep their distances from it.
    /// About its own origin it looks around; about what it looks at it goes around that, the other
    /// way. It never looks along `vertical`.
    #[must_use]
    pub fn turned(self, pivot: Vec3, vertical: Vec3, turn: Rotation) -> Self {
        // In a mirrored frame rotations go the other way round.
        let hand = self.up.cross(self.forward).dot(self.right).signum();
        let elevation = libm::asinf(self.forward.dot(vertical).clamp(-1.0, 1.0));
        let up = (elevation + turn.up).clamp(-STEEPEST, STEEPEST) - elevation;
        self.rotated(pivot, self.right, -hand * up)
            .rotated(pivot, vertical, hand * turn.right)
    }

    /// Returns the frame rotated by `angle` about the unit vector `axis` through `pivot`, square again
    /// however often it was rotated.
    fn rotated(self, pivot: Vec3, axis: Vec3, angle: f32) -> Self {
        let (sin, cos) = sin_cos(angle);
        // Rodrigues' formula.
        let rotate = |v: Vec3| v * cos + axis.cross(v) * sin + axis * axis.dot(v) * (1.0 - cos);
        let forward = rotate(self.forward).normalize();
        let across = |axis| rotate(axis).reject_from_normalized(forward);
        let right = across(self.right).normalize();
        let up = across(self.up).reject_from_normalized(right).normalize();
        Self {
            origin: pivot + rotate(self.origin - pivot),
            right,
            up,
            forward,
        }
    }
}

/// Splits a camera's axes into a frame and a stretch, by Gram and Schmidt. None: they are flat.
fn stretched([x, y, z]: [Vec3; 3]) -> Option<([Vec3; 3], Stretch)> {
    let right = x.try_normalize()?;
    let up = y.reject_from_normalized(right).try_normalize()?;
    let normal = right.cross(up);
    let unit = normal.dot(z);
    let forward = if unit < 0.0 { -normal } else { normal };
    let in_frame = |v: Vec3| Vec3::new(right.dot(v), up.dot(v), forward.dot(v)) / unit.abs();
    let stretch = Stretch {
        axes: [
            Vec3::X * in_frame(x).x,
            in_frame(y).with_z(0.0),
            in_frame(z).with_z(1.0),
        ],
        unit: unit.abs(),
    };
    let is_solid = stretch.axes.iter().all(|axis| axis.is_finite());
    (is_solid && stretch.area() > 0.0).then_some(([right, up, forward], stretch))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: Vec3 = Vec3::new(1.0, 0.5, -2.0);

    /// Cameras at some distance of the target, level or not, one of them mirrored.
    fn examples() -> [Pose; 3] {
        let frame = |right: Vec3, up: Vec3| {
            let forward = right.cross(up);
            Pose {
                origin: TARGET - forward * 3.0,
                right,
                up,
                forward,
            }
        };
        let level = frame(Vec3::X, Vec3::Y);
        let [right, up] = [0.7, -1.1];
        let tilted = level.turned(TARGET, Vec3::Y, Rotation { right, up });
        let right = -tilted.right;
        [level, tilted, Pose { right, ..tilted }]
    }

    fn distance(a: &Pose, b: &Pose) -> f32 {
        let parts = |p: &Pose| [p.origin, p.right, p.up, p.forward];
        let pairs = parts(a).into_iter().zip(parts(b));
        pairs.map(|(a, b)| a.distance(b)).sum()
    }

    #[test]
    fn going_around_keeps_the_target_in_the_middle_at_its_distance() {
        for start in examples() {
            let mut pose = start;
            for step in 0..1000 {
                let up = if step % 300 < 150 { 0.013 } else { -0.013 };
                pose = pose.turned(TARGET, start.vertical(), Rotation { right: 0.021, up });
                let offset = TARGET - pose.origin;
                assert!((offset.length() - 3.0).abs() < 1e-3, "{offset}");
                assert!(offset.normalize().distance(pose.forward) < 1e-3);
                assert!(pose.right.dot(pose.up).abs() < 1e-5);
                let hand = |p: &Pose| p.right.cross(p.up).dot(p.forward);
                assert!((hand(&pose) - hand(&start)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn a_full_turn_comes_home() {
        for start in examples() {
            let mut pose = start;
            let (right, up) = (2.0 * PI / 90.0, 0.0);
            for _ in 0..90 {
                pose = pose.turned(TARGET, start.vertical(), Rotation { right, up });
            }
            assert!(distance(&pose, &start) < 1e-3, "{pose:?}");
        }
    }

    #[test]
    fn looking_right_brings_the_right_side_to_the_middle() {
        for start in examples() {
            let by =
                |right, up| start.turned(start.origin, start.vertical(), Rotation { right, up });
            assert!(by(0.2, 0.0).forward.dot(start.right) > 0.05);
            assert!(by(0.0, 0.2).forward.dot(start.up) > 0.05);
            assert_eq!(by(0.3, 0.1).origin, start.origin);
        }
    }

    #[test]
    fn no_camera_turns_over() {
        let start = examples()[0];
        let (right, up) = (0.0, 9.0);
        let steep = start.turned(TARGET, Vec3::Y, Rotation { right, up });
        assert!((steep.forward.dot(Vec3::Y) - libm::sinf(STEEPEST)).abs() < 1e-4);
        assert!(steep.up.dot(Vec3::Y) > 0.0);
    }

    #[test]
    fn up_is_an_axis_of_the_world_however_steep_the_camera_looks() {
        for start in examples() {
            assert_eq!(start.vertical(), Vec3::Y);
        }
        let rolled = examples()[0].rotated(Vec3::ZERO, Vec3::Z, 0.3);
        assert_eq!(rolled.vertical(), Vec3::Y);
    }
}
