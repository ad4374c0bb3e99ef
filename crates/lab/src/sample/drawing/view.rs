//! Plan and elevation: parallel projections along axes of the world, each onto a panel of the page.

use super::super::view::Place;
use super::shapes::{rectangle, text};
use crate::number::number;
use bidir::camera::Pose;
use bidir::driver::Session;
use bidir::math::{Vec2, Vec3};
use bidir::scene::Scene;

/// The largest size of a panel. Unit: pixels of the page, as for all lengths on it.
pub(super) const LARGEST: Vec2 = Vec2::new(640.0, 480.0);
/// The distance between the panels, which has room for the heading of the lower one.
const GAP: f32 = 36.0;

/// A box in the world: the smallest and the largest coordinates.
type Bounds = [Vec3; 2];

/// A parallel projection onto a panel.
pub(super) struct View<'a> {
    pub(super) scene: &'a Scene,
    right: Vec3,
    up: Vec3,
    /// The depth of the near plane, in front of which the scene is cut away.
    near: f32,
    /// The upper left corner in units of the world.
    min: Vec2,
    /// Width and height in units of the world.
    extent: Vec2,
    /// The upper left corner on the page.
    pub(super) corner: Vec2,
    /// Pixels per unit of the world.
    pub(super) scale: f32,
}

impl<'a> View<'a> {
    /// Returns plan and elevation around the points of a sample, one below the other from `corner`.
    pub(super) fn both(session: &'a Session<'_>, points: &[Vec3], mut corner: Vec2) -> [Self; 2] {
        let scene = session.scene();
        let bounds = scene.bvh().bounds();
        let whole = around(&[bounds.min, bounds.max]);
        let sample = around(points).or(whole).unwrap_or_default();
        let shown = with_surroundings(sample, whole.unwrap_or(sample));
        let [right, up, depth] = axes(&session.view().camera().pose(), sample[1] - sample[0]);
        let mut views = [depth, up].map(|up| Self::new(scene, [right, up], [sample, shown]));
        let scales = views.each_ref().map(|v| (LARGEST / v.extent).min_element());
        for view in &mut views {
            view.scale = scales[0].min(scales[1]);
            view.corner = corner;
            corner.y += view.size().y + GAP;
        }
        views
    }

    /// Returns a view that is not yet placed on the page.
    fn new(scene: &'a Scene, [right, up]: [Vec3; 2], [sample, shown]: [Bounds; 2]) -> Self {
        let flat = |v: Vec3| Vec2::new(right.dot(v), -up.dot(v));
        let [a, b] = shown.map(flat);
        let depths = sample.map(|corner| up.cross(right).dot(corner));
        Self {
            scene,
            right,
            up,
            // Behind the first point of the sample: a ceiling on which it lies is cut away too.
            near: depths[0].min(depths[1]) + 1e-3 * (b - a).abs().max_element(),
            min: a.min(b),
            extent: (b - a).abs(),
            corner: Vec2::ZERO,
            scale: 1.0,
        }
    }

    pub(super) fn size(&self) -> Vec2 {
        self.extent * self.scale
    }

    /// Returns the direction in which the view looks.
    pub(super) fn away(&self) -> Vec3 {
        self.up.cross(self.right)
    }

    /// Returns a point or direction without its depth, in axes to the right and down as on the page.
    fn flat(&self, v: Vec3) -> Vec2 {
        Vec2::new(self.right.dot(v), -self.up.dot(v))
    }

    /// Returns the position of a point on the page.
    fn at(&self, point: Vec3) -> Vec2 {
        self.corner + (self.flat(point) - self.min) * self.scale
    }

    /// Returns the point of the near plane at a position on the page.
    pub(super) fn near_point(&self, at: Vec2) -> Vec3 {
        let flat = (at - self.corner) / self.scale + self.min;
        self.right * flat.x - self.up * flat.y + self.away() * self.near
    }

    /// Returns the position of `place` on the page, or if it is at infinity, the point of the border in its direction
    /// from `from`.
    pub(super) fn seen_from(&self, place: &Place, from: Vec3) -> Vec2 {
        if place.is_infinite {
            self.border(from, place.point)
        } else {
            self.at(place.point)
        }
    }

    /// Returns the position where a line from `point` along `direction` leaves the panel, or if the line is along the
    /// view, the position of `point`.
    pub(super) fn border(&self, point: Vec3, direction: Vec3) -> Vec2 {
        let (from, along) = (self.at(point), self.flat(direction));
        let ends = [self.corner, self.corner + self.size()];
        let axes = (0..2).filter(|&axis| along[axis].abs() > 1e-3);
        let end = |axis: usize| ends[usize::from(along[axis] > 0.0)][axis];
        let lengths = axes.map(|axis| (end(axis) - from[axis]) / along[axis]);
        from + along * lengths.reduce(f32::min).unwrap_or(0.0)
    }

    /// Returns the empty panel with its heading: the title, the size, and the directions of the axes.
    pub(super) fn panel(&self, title: &str) -> String {
        let [width, height] = self.extent.to_array().map(|x| number(f64::from(x)));
        let [right, up] = [self.right, self.up].map(axis_name);
        let title = format!("{title}: {width} \u{d7} {height}, {right} to the right, {up} up");
        text(self.corner - Vec2::Y * 8.0, "heading", &title)
            + &rectangle(self.corner, self.size(), "paper")
    }
}

/// Returns the smallest box around the finite points. None: there are none.
fn around(points: &[Vec3]) -> Option<Bounds> {
    let finite = points.iter().filter(|point| point.is_finite());
    let boxes = finite.map(|point| [*point; 2]);
    boxes.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// Returns the box of a sample, widened by the near part of the scene. The whole of a scene with a large ground
/// would leave no room for the sample.
fn with_surroundings(sample: Bounds, scene: Bounds) -> Bounds {
    let sizes = [sample, scene].map(|[min, max]| (max - min).max_element());
    let size = sizes.into_iter().find(|size| *size > 0.0).unwrap_or(1.0);
    let (reach, margin) = (0.5 * size, 0.05 * size);
    [
        scene[0].max(sample[0] - reach).min(sample[0]) - margin,
        scene[1].min(sample[1] + reach).max(sample[1]) + margin,
    ]
}

/// Returns three axes of the world: right in both views; up; and away from the viewer in the elevation. The elevation
/// shows the wider side of a sample of this size, and looks as far as possible in the direction of the camera.
fn axes(pose: &Pose, size: Vec3) -> [Vec3; 3] {
    let up = pose.up.abs().max_position();
    let [a, b] = [(up + 1) % 3, (up + 2) % 3];
    let depth = if size[a] < size[b] { a } else { b };
    // Errors of rounding do not turn an axis.
    let towards = |axis: usize, v: Vec3| Vec3::AXES[axis] * (v[axis] + 1e-6).signum();
    let (up, depth) = (towards(up, pose.up), towards(depth, pose.forward));
    [depth.cross(up), up, depth]
}

fn axis_name(axis: Vec3) -> String {
    let signs = ["", "\u{2212}"];
    let letter = ["x", "y", "z"][axis.abs().max_position()];
    format!("{}{letter}", signs[usize::from(axis.element_sum() < 0.0)])
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::{CAMERAS, scene};
    use super::*;
    use bidir::camera::{Camera, Spherical, SphericalMapping};
    use bidir::math::{Affine3A, Mat3};

    fn pose(up: Vec3, forward: Vec3) -> Pose {
        let camera = Mat3::from_cols(up.cross(forward), up, forward);
        let mapping = SphericalMapping::EqualArea;
        let camera = Spherical::new(&Affine3A::from_mat3(camera), Vec2::ONE, mapping);
        Camera::Spherical(camera.unwrap()).pose()
    }

    #[test]
    fn views_look_along_the_camera_from_where_paths_are_widest() {
        let [right, up, depth] = axes(&pose(Vec3::Y, -Vec3::Z), Vec3::new(5.0, 2.0, 1.0));
        assert_eq!([right, up, depth], [Vec3::X, Vec3::Y, -Vec3::Z]);
        assert_eq!(axis_name(depth), "\u{2212}z");
        let scene = scene(CAMERAS[0]).scene;
        let boxes = [[Vec3::ZERO, Vec3::ONE]; 2];
        let [plan, elevation] = [depth, up].map(|up| View::new(&scene, [right, up], boxes));
        assert_eq!((plan.away(), elevation.away()), (-up, depth));
    }

    #[test]
    fn a_tilted_camera_does_not_tilt_the_drawing() {
        let up = Vec3::new(0.1, -0.5, 0.8).normalize();
        let forward = up.any_orthonormal_vector();
        let [right, up, _] = axes(&pose(up, forward), Vec3::new(1.0, 2.0, 1.0));
        assert_eq!((right.abs(), up), (Vec3::Y, Vec3::Z));
    }

    #[test]
    fn what_is_far_of_a_scene_is_left_out() {
        let paths = around(&[Vec3::ZERO, Vec3::ONE, Vec3::NAN]).unwrap();
        let scene = [Vec3::new(-0.2, -50.0, 0.5), Vec3::splat(1.1)];
        let [min, max] = with_surroundings(paths, scene);
        assert_eq!(min, Vec3::new(-0.2, -0.5, 0.0) - 0.05);
        assert_eq!(max, Vec3::splat(1.1) + 0.05);
    }
}
