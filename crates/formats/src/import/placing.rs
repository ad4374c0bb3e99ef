//! Places meshes, and keeps them within the range of numbers.

use super::space::Survey;
use crate::error::ErrorKind;
use crate::source::Fault;
use bidir::math::Vec3;
use bidir::shape::Orientation;
use glam::{DAffine3, DVec3};

/// Maximum distance from the origin. Up to it, products of squared distances stay finite in `f32`.
const FARTHEST: f64 = 1e12;

/// Refuses a point that is too far from the origin.
pub(crate) fn check_point<P: Clone>(point: DVec3, place: &P) -> Result<(), Fault<P>> {
    if point.is_finite() && point.abs().max_element() <= FARTHEST {
        return Ok(());
    }
    let message = format!("a coordinate is beyond {FARTHEST:e}");
    Err(Fault::new(ErrorKind::Limit, place.clone(), message))
}

/// Rounds the placed vertices of a mesh, and adds them to a survey. Errors: one is too far away.
pub(crate) fn place_vertices<P: Clone>(
    points: impl Iterator<Item = DVec3>,
    survey: &mut Survey,
    place: &P,
) -> Result<Vec<Vec3>, Fault<P>> {
    let rounded = |point: DVec3| {
        check_point(point, place)?;
        survey.include(point);
        Ok(point.as_vec3())
    };
    points.map(rounded).collect()
}

/// Normalises and rounds the normal or tangent of a placed vertex. With length 1, interpolation weights corners as in
/// the file.
pub(crate) fn unit(v: DVec3) -> Vec3 {
    v.normalize_or_zero().as_vec3()
}

/// Returns three numbers of a file as a vector.
pub(crate) fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// Returns the orientation of a mesh under `map`: the opposite of `own` if the map mirrors.
pub(crate) fn mirrored(own: Orientation, map: &DAffine3) -> Orientation {
    let is_mirrored = map.matrix3.determinant() < 0.0;
    if is_mirrored { opposite(own) } else { own }
}

pub(crate) fn opposite(orientation: Orientation) -> Orientation {
    match orientation {
        Orientation::Natural => Orientation::Reversed,
        Orientation::Reversed => Orientation::Natural,
    }
}
