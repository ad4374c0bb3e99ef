//! From where a drawing looks: from above and from the side, along axes of the world.

use bidir::camera::Pose;
use bidir::math::{Vec2, Vec3};

/// A box in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub(super) min: Vec3,
    pub(super) max: Vec3,
}

impl Extent {
    /// The smallest box around `points`. None: there are none that are finite.
    pub(super) fn of(points: &[Vec3]) -> Option<Self> {
        let finite = points.iter().filter(|point| point.is_finite());
        let boxes = finite.map(|&point| Self {
            min: point,
            max: point,
        });
        boxes.reduce(|a, b| Self {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        })
    }

    pub(super) fn size(&self) -> Vec3 {
        self.max - self.min
    }

    /// What it grows to when it takes in what is near of `other`: at most `margin` on each side.
    pub(super) fn grown_into(&self, other: &Self, margin: f32) -> Self {
        let margin = Vec3::splat(margin);
        Self {
            min: other.min.max(self.min - margin).min(self.min),
            max: other.max.min(self.max + margin).max(self.max),
        }
    }

    /// The same, wider by `margin` on each side.
    pub(super) fn widened(&self, margin: f32) -> Self {
        Self {
            min: self.min - margin,
            max: self.max + margin,
        }
    }
}

/// An axis of the world, in one of its two directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    index: usize,
    is_reversed: bool,
}

impl Axis {
    /// Axis number `index`, as `direction` goes along it.
    fn along(index: usize, direction: Vec3) -> Self {
        Self {
            index,
            is_reversed: direction[index] < -1e-6,
        }
    }

    /// The one that is nearest to `direction`.
    fn nearest(direction: Vec3) -> Self {
        let lengths = direction.abs();
        let longest = (0..3).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b]));
        Self::along(longest.unwrap_or(2), direction)
    }

    pub(super) fn direction(self) -> Vec3 {
        let unit = Vec3::AXES[self.index];
        if self.is_reversed { -unit } else { unit }
    }

    /// Its letter with an arrow to where its numbers grow, given the arrows along it and against it.
    pub(super) fn label(self, [along, against]: [&str; 2]) -> String {
        let letter = ["x", "y", "z"][self.index];
        let arrow = if self.is_reversed { against } else { along };
        format!("{letter} {arrow}")
    }
}

/// A parallel view along an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) title: &'static str,
    pub(super) right: Axis,
    pub(super) up: Axis,
    /// The direction in which it looks.
    pub(super) away: Vec3,
}

impl View {
    /// From above, and from the side that shows `extent` widest, as far as possible in the direction
    /// in which the camera looks. Both have the same axis to the right.
    ///
    /// Above is where the axis of the world points that is nearest to the camera's up.
    pub(super) fn both(pose: &Pose, extent: &Extent) -> [Self; 2] {
        let up = Axis::nearest(pose.up);
        let [a, b] = [(up.index + 1) % 3, (up.index + 2) % 3];
        let size = extent.size();
        let depth = if size[a] < size[b] { a } else { b };
        let depth = Axis::along(depth, pose.forward);
        let right = Axis::nearest(depth.direction().cross(up.direction()));
        [
            Self {
                title: "From above",
                right,
                up: depth,
                away: -up.direction(),
            },
            Self {
                title: "From the side",
                right,
                up,
                away: depth.direction(),
            },
        ]
    }

    /// A point, or a direction, as it is seen: to the right and up.
    pub(super) fn project(&self, point: Vec3) -> Vec2 {
        Vec2::new(
            self.right.direction().dot(point),
            self.up.direction().dot(point),
        )
    }

    /// Lower left and upper right corner of a box.
    pub(super) fn window(&self, extent: &Extent) -> [Vec2; 2] {
        let corners = [extent.min, extent.max].map(|corner| self.project(corner));
        [corners[0].min(corners[1]), corners[0].max(corners[1])]
    }

    /// The point of the world that is seen at `seen`, at `depth`.
    pub(super) fn place(&self, seen: Vec2, depth: f32) -> Vec3 {
        self.right.direction() * seen.x + self.up.direction() * seen.y + self.away * depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(up: Vec3, forward: Vec3) -> Pose {
        let camera = bidir::math::Affine3A::from_mat3(bidir::math::Mat3::from_cols(
            up.cross(forward),
            up,
            forward,
        ));
        let mapping = bidir::camera::SphericalMapping::EqualArea;
        let camera = bidir::camera::Spherical::new(&camera, Vec2::ONE, mapping);
        bidir::camera::Camera::Spherical(camera.unwrap()).pose()
    }

    #[test]
    fn views_look_along_the_camera_from_where_paths_are_widest() {
        let extent = Extent {
            min: Vec3::ZERO,
            max: Vec3::new(5.0, 2.0, 1.0),
        };
        let [plan, elevation] = View::both(&pose(Vec3::Y, -Vec3::Z), &extent);
        assert_eq!(elevation.away, -Vec3::Z);
        assert_eq!(elevation.right.direction(), Vec3::X);
        assert_eq!(plan.away, -Vec3::Y);
        assert_eq!(plan.up.direction(), -Vec3::Z);
        assert_eq!(plan.up.label(["↑", "↓"]), "z ↓");
        for view in [plan, elevation] {
            let [right, up] = [view.right, view.up].map(Axis::direction);
            assert_eq!(
                up.cross(right),
                view.away,
                "what is right is seen at the right"
            );
        }
    }

    #[test]
    fn a_tilted_camera_does_not_tilt_the_drawing() {
        let up = Vec3::new(0.1, -0.5, 0.8).normalize();
        let forward = up.any_orthonormal_vector();
        let extent = Extent::of(&[Vec3::ZERO, Vec3::new(1.0, 2.0, 1.0)]).unwrap();
        let [plan, elevation] = View::both(&pose(up, forward), &extent);
        assert_eq!(elevation.up.direction(), Vec3::Z);
        assert_eq!(plan.right.direction().abs(), Vec3::Y);
    }

    #[test]
    fn what_is_far_of_a_scene_is_left_out() {
        let paths = Extent::of(&[Vec3::ZERO, Vec3::ONE]).unwrap();
        let scene = Extent::of(&[Vec3::new(-0.2, -50.0, 0.5), Vec3::splat(1.1)]).unwrap();
        let grown = paths.grown_into(&scene, 0.5);
        assert_eq!(grown.min, Vec3::new(-0.2, -0.5, 0.0));
        assert_eq!(grown.max, Vec3::splat(1.1));
    }
}
