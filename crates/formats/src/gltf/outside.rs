//! The camera of a scene without one, and the environment of a scene without light.
//!
//! The front of an asset is +z. A flat scene, or one whose surfaces are edge-on from there, gets another
//! viewpoint. The light comes from behind the viewer, so that a surface of any colour differs from the
//! background.

use super::view::looking;
use crate::import::box_corners;
use bidir::light::InfiniteLight;
use bidir::math::{Affine3A, Mat3, Vec2, Vec3, square_to_direction};
use bidir::texture::Image;
use glam::{DAffine3, DMat3, DVec3};

/// A direction from which a scene may be seen.
pub(super) struct Viewpoint {
    /// The direction from the scene to the viewer, not normalised.
    to_viewer: DVec3,
    up: DVec3,
    /// The viewpoint's name in messages, such as "above it".
    pub(super) name: &'static str,
}

const fn viewpoint(to_viewer: DVec3, up: DVec3, name: &'static str) -> Viewpoint {
    Viewpoint {
        to_viewer,
        up,
        name,
    }
}

/// The viewpoints in order of preference. Every plane is visible from one of the last three.
const VIEWPOINTS: [Viewpoint; 4] = [
    viewpoint(DVec3::Z, DVec3::Y, "in front of it"),
    viewpoint(DVec3::new(0.5, 0.7, 1.0), DVec3::Y, "above its front"),
    viewpoint(DVec3::Y, DVec3::NEG_Z, "above it"),
    viewpoint(DVec3::X, DVec3::Y, "beside it"),
];

/// The least projected area, relative to the largest among all viewpoints.
const ENOUGH: f64 = 0.25;
/// The size of the view relative to the scene.
const MARGIN: f64 = 1.05;

/// The extent of a scene: its box, and its projected areas.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// The corners of a box around all triangles.
    corners: [Vec3; 2],
    /// Σ a n nᵀ over triangles of area a and normal n.
    areas: DMat3,
}

impl Extent {
    /// The extent of an empty scene.
    pub(super) const NONE: Self = Self {
        corners: [Vec3::INFINITY, Vec3::NEG_INFINITY],
        areas: DMat3::ZERO,
    };

    /// Computes the extent of triangles.
    pub(super) fn of(points: &[Vec3], triangles: impl Iterator<Item = [Vec3; 3]>) -> Self {
        let widened = |[low, high]: [Vec3; 2], &p: &Vec3| [low.min(p), high.max(p)];
        let mut extent = Self::NONE;
        extent.corners = points.iter().fold(extent.corners, widened);
        for [a, b, c] in triangles {
            let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
            let area = (b - a).cross(c - a) / 2.0;
            extent.add_areas(outer(area) * area.length_recip().min(f64::MAX));
        }
        extent
    }

    /// Adds another extent mapped by `map`. The box contains the mapped one; areas are exact if `map` is a
    /// similarity.
    pub(super) fn include(&mut self, other: &Self, map: &DAffine3) {
        for corner in box_corners(other.corners.map(Vec3::as_dvec3)) {
            let corner = map.transform_point3(corner).as_vec3();
            if corner.is_finite() {
                self.corners = [self.corners[0].min(corner), self.corners[1].max(corner)];
            }
        }
        let m = map.matrix3;
        let determinant = m.determinant();
        let cofactors = m.inverse().transpose() * determinant;
        let length = libm::cbrt(determinant.abs());
        let areas = cofactors * other.areas * cofactors.transpose();
        self.add_areas(areas * (length * length).recip());
    }

    fn add_areas(&mut self, areas: DMat3) {
        if areas.is_finite() {
            self.areas += areas;
        }
    }

    /// Returns the centre of the box, and half its size. None: the scene is empty.
    fn centre_and_half(&self) -> Option<(DVec3, DVec3)> {
        let [low, high] = self.corners.map(Vec3::as_dvec3);
        let is_something = low.cmple(high).all();
        is_something.then(|| ((low + high) / 2.0, (high - low) / 2.0))
    }

    /// Returns the first viewpoint from which enough of the box and of the surfaces is visible.
    pub(super) fn viewpoint(&self) -> &'static Viewpoint {
        let half = self.centre_and_half().map_or(DVec3::ONE, |(_, half)| half);
        let sides = DVec3::new(half.y * half.z, half.x * half.z, half.x * half.y);
        let directions = VIEWPOINTS
            .each_ref()
            .map(|point| point.to_viewer.normalize());
        let box_areas = directions.map(|d| d.abs().dot(sides));
        // The root mean square, as the signs of normals do not matter.
        let surfaces = directions.map(|d| d.dot(self.areas * d).max(0.0).sqrt());
        let is_enough =
            |areas: [f64; 4], i: usize| areas[i] >= ENOUGH * areas.into_iter().fold(0.0, f64::max);
        let is_seen = |&i: &usize| is_enough(box_areas, i) && is_enough(surfaces, i);
        let first = (0..VIEWPOINTS.len()).find(is_seen).unwrap_or(1);
        &VIEWPOINTS[first]
    }
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

impl Viewpoint {
    /// Returns the frame of a camera in this direction that has the box of `extent` in view; `half` is half the size
    /// of its view at distance 1.
    pub(super) fn camera(&self, extent: &Extent, half: DVec3) -> Affine3A {
        let (centre, size) = extent
            .centre_and_half()
            .unwrap_or((DVec3::ZERO, DVec3::ONE));
        let to_viewer = self.to_viewer.normalize();
        let right = self.up.cross(to_viewer).normalize();
        let up = to_viewer.cross(right);
        let distance_of = |i: usize| {
            let signs = DVec3::from_array(std::array::from_fn(|axis| [-1.0, 1.0][i >> axis & 1]));
            let corner = signs * size;
            let [x, y, z] = [right, up, to_viewer].map(|axis| corner.dot(axis));
            (x.abs() / half.x).max(y.abs() / half.y) * MARGIN + z
        };
        let distance = (0..8).map(distance_of).fold(1e-6, f64::max);
        looking(centre + to_viewer * distance, -to_viewer, up)
    }
}

/// Number of texels of the environment in either direction.
const TEXELS: usize = 128;
/// The radiance that is added in all directions.
const BACKGROUND: f32 = 0.25;
/// The direction of the most radiance, in the space of the camera: over the viewer's left shoulder.
const KEY: Vec3 = Vec3::new(-0.4, 0.7, -1.0);

/// Returns an environment with soft light from behind and above the viewer: its radiance is max(cos θ, 0) +
/// [`BACKGROUND`], with θ from the direction [`KEY`].
///
/// A white diffuse surface that faces the light has radiance 0.92.
pub(super) fn surroundings(world_from_camera: &Affine3A) -> InfiniteLight {
    let key = world_from_camera
        .transform_vector3(KEY)
        .normalize_or(Vec3::Z);
    let centre = |i: usize| (i as f32 + 0.5) / TEXELS as f32;
    let texel = |i: usize| {
        let at = Vec2::new(centre(i % TEXELS), centre(i / TEXELS));
        [BACKGROUND + square_to_direction(at).dot(key).max(0.0); 3]
    };
    let image = Image::new(TEXELS, (0..TEXELS * TEXELS).map(texel).collect());
    let texels = image.expect("it has texels in whole rows");
    InfiniteLight::image(texels, 1.0, Mat3::IDENTITY)
}
