//! The render space of a scene: world space if `f32` suffices for it, else a space around the visible part.
//!
//! A reader places everything in world space, and a [`Survey`] records it in `f64`. If the resulting
//! [`Layout`] has another space, the reader starts again and places everything in that one, by
//! transformations composed in `f64`: visible points are near the origin when they are rounded.
//!
//! **Origin.** The error of points is about 10⁻⁶ of their distance from the origin (`position_error` of
//! `bidir::shape`), so the origin is moved
//! - to the middle of the bounding box, if the middle is more than [`FAR`] half widths away from the origin;
//! - or else to the camera, if the distance from the origin to the camera is more than [`FAR_FROM_VIEW`]
//!   times the distance from the camera to the nearest vertex.
//!
//! **Unit.** If the distance of the farthest point from the origin is not within 2^±[`RANGE`], the unit is
//! the power of two that scales a large scene to 2^[`RANGE`], and a small one to 1. Then densities per area
//! and squared distances stay in the range of `f32`, also for much smaller details.
//!
//! Shared objects have their own origin, by the same rule for their box.

use bidir::scene::RenderSpace;
use glam::{DAffine3, DVec3};

/// The origin is moved if the middle of the scene is more than this many half widths away. Below it, the
/// error of points is less than 10⁻⁴ of the half width.
const FAR: f64 = 64.0;
/// The origin is moved to the camera if that is farther away than this multiple of the distance from it to
/// the nearest vertex. It is larger than [`FAR`], as the nearest vertex may be an exception.
const FAR_FROM_VIEW: f64 = 1024.0;
/// Scenes whose size is within 2^±RANGE keep their unit.
const RANGE: i32 = 20;

/// The spaces in which a scene is placed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Layout {
    /// The space of shapes outside of objects, of lights and of the camera.
    pub(crate) space: RenderSpace,
    /// The origins of shared objects, each in its own space. Objects beyond the list have the origin 0.
    pub(crate) objects: Vec<DVec3>,
}

impl Layout {
    /// Returns the map from the world to the render space.
    pub(crate) fn render_from_world(&self) -> DAffine3 {
        self.space.from_world()
    }

    /// Returns the origin of a shared object.
    pub(crate) fn object_origin(&self, object: usize) -> DVec3 {
        self.objects.get(object).copied().unwrap_or(DVec3::ZERO)
    }

    /// Computes the layout of a scene and of its objects.
    pub(crate) fn of(scene: &Survey, objects: &[Survey]) -> Self {
        let mut objects: Vec<DVec3> = objects.iter().map(Survey::origin).collect();
        while objects.last() == Some(&DVec3::ZERO) {
            objects.pop();
        }
        Self {
            space: scene.space(),
            objects,
        }
    }
}

/// The bounds of the contents of a space, from which its layout follows.
#[derive(Clone, Debug)]
pub(crate) struct Survey {
    /// The lowest and highest corner of the bounding box. If there is no point, the first is above the second.
    corners: [DVec3; 2],
    eye: Option<DVec3>,
    /// The square of the distance of the nearest point to the eye.
    nearest2: f64,
}

impl Survey {
    /// Returns the survey of an empty space with a camera at `eye`. None: there is no camera, or its position
    /// follows from the scene.
    pub(crate) fn new(eye: Option<DVec3>) -> Self {
        Self {
            corners: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            eye,
            nearest2: f64::INFINITY,
        }
    }

    /// Adds a point.
    #[inline]
    pub(crate) fn include(&mut self, p: DVec3) {
        self.corners = [self.corners[0].min(p), self.corners[1].max(p)];
        if let Some(eye) = self.eye {
            self.nearest2 = self.nearest2.min(eye.distance_squared(p));
        }
    }

    /// Adds the corners of a box mapped by `map`; nothing if the box is empty.
    pub(crate) fn include_box(&mut self, corners: [DVec3; 2], map: &DAffine3) {
        for corner in box_corners(corners) {
            self.include(map.transform_point3(corner));
        }
    }

    /// Returns the lowest and highest corner of the bounding box. None: there is no point.
    pub(crate) fn corners(&self) -> Option<[DVec3; 2]> {
        let [low, high] = self.corners;
        low.cmple(high).all().then_some(self.corners)
    }

    /// Returns half the longest side of the box around every point and the eye; 0 if there is neither.
    pub(crate) fn reach(&self) -> f64 {
        let mut all = Self {
            eye: None,
            ..self.clone()
        };
        self.eye.into_iter().for_each(|eye| all.include(eye));
        all.corners()
            .map_or(0.0, |[low, high]| (high - low).max_element() / 2.0)
    }

    fn space(&self) -> RenderSpace {
        let origin = self.origin();
        RenderSpace {
            origin,
            unit: self.unit(origin),
        }
    }

    fn origin(&self) -> DVec3 {
        let Some([low, high]) = self.corners() else {
            return DVec3::ZERO;
        };
        let (centre, half) = ((low + high) / 2.0, (high - low).max_element() / 2.0);
        let is_beyond = |p: DVec3, distance: f64| p.abs().max_element() > distance;
        let near = self.nearest2.sqrt();
        match self.eye {
            _ if is_beyond(centre, FAR * half) => rounded(centre, half),
            Some(eye) if is_beyond(eye, FAR_FROM_VIEW * near) => rounded(eye, near),
            _ => DVec3::ZERO,
        }
    }

    fn unit(&self, origin: DVec3) -> f64 {
        let corners = self.corners().into_iter().flatten();
        let distances = corners
            .chain(self.eye)
            .map(|p| (p - origin).abs().max_element());
        let farthest = distances.fold(0.0, f64::max);
        if farthest == 0.0 || !farthest.is_finite() {
            return 1.0;
        }
        match libm::ilogb(farthest) {
            exponent if exponent > RANGE => libm::exp2(f64::from(exponent - RANGE)),
            exponent if exponent < -RANGE => libm::exp2(f64::from(exponent)),
            _ => 1.0,
        }
    }
}

/// Returns the corners of a box; none if it is empty.
pub(crate) fn box_corners(corners: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    let count = if corners[0].cmple(corners[1]).all() {
        8
    } else {
        0
    };
    (0..count).map(move |i: usize| {
        DVec3::from_array(std::array::from_fn(|axis| corners[i >> axis & 1][axis]))
    })
}

/// Rounds `p` to a multiple of a power of two below `size`, so that its differences to coordinates with few
/// digits are exact.
fn rounded(p: DVec3, size: f64) -> DVec3 {
    if size == 0.0 {
        return p;
    }
    let step = libm::exp2(f64::from(libm::ilogb(size)));
    (p / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;

    fn survey(eye: DVec3, points: &[DVec3]) -> Survey {
        let mut survey = Survey::new(Some(eye));
        for &p in points {
            survey.include(p);
        }
        survey
    }

    #[track_caller]
    fn check(survey: &Survey, origin: [f64; 3], unit: f64) {
        let expected = RenderSpace {
            origin: origin.into(),
            unit,
        };
        assert_eq!(survey.space(), expected);
    }

    #[test]
    fn a_scene_near_the_origin_stays_there() {
        let room = [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 2.0)];
        check(&survey(DVec3::new(0.0, 1.0, -4.0), &room), [0.0; 3], 1.0);
        let moved = room.map(|p| p + DVec3::X * 60.0);
        check(&survey(DVec3::X * 60.0, &moved), [0.0; 3], 1.0);
        check(&survey(DVec3::ZERO, &[]), [0.0; 3], 1.0);
    }

    #[test]
    fn a_distant_room_is_rendered_around_its_middle() {
        let room = [
            DVec3::new(1e7 - 1.0, 0.0, 0.0),
            DVec3::new(1e7 + 1.0, 2.0, 2.0),
        ];
        check(&survey(DVec3::ZERO, &room), [1e7, 1.0, 1.0], 8.0);
        check(&survey(DVec3::X * 1e7, &room), [1e7, 1.0, 1.0], 1.0);
    }

    #[test]
    fn a_room_on_a_wide_plane_is_rendered_around_the_camera() {
        let mut points = vec![DVec3::splat(-1e6), DVec3::splat(1e6)];
        points.push(DVec3::new(5e5, 1.0, 0.0));
        check(
            &survey(DVec3::new(5e5, 3.0, 0.25), &points),
            [5e5, 4.0, 0.0],
            1.0,
        );
    }

    #[test]
    fn the_unit_follows_the_size() {
        for (size, unit) in [
            (1e6, 1.0),
            (1e9, 512.0),
            (1e-6, 1.0),
            (1e-12, libm::exp2(-40.0)),
        ] {
            let points = [DVec3::splat(-size), DVec3::splat(size)];
            check(&survey(DVec3::ZERO, &points), [0.0; 3], unit);
        }
    }

    #[test]
    fn objects_far_from_their_origin_get_another_one() {
        let [near, far] = [0.0, 1e5].map(|x| {
            let mut survey = Survey::new(None);
            survey.include_box(
                [DVec3::X * x, DVec3::X * x + DVec3::ONE],
                &DAffine3::IDENTITY,
            );
            survey
        });
        let layout = Layout::of(&Survey::new(None), &[far, near]);
        assert_eq!(layout.objects, [DVec3::new(1e5 + 0.5, 0.5, 0.5)]);
        assert_eq!(layout.object_origin(1), DVec3::ZERO);
    }
}
