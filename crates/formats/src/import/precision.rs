//! The rounding error of vertices that a file stores as `f32`.
//!
//! The error of a coordinate is half a unit in its last place, which grows with the coordinate. No
//! transformation recovers the lost digits, but small coordinates with a transformation lose none.

use glam::{DMat3, DVec3, Vec3};

/// The largest error without a warning, relative to half the longest side of the mesh.
const NOTICED: f64 = 0.01;
/// The largest error that is rendered, relative to [`Survey::reach`](super::space::Survey::reach).
const ACCEPTED: f64 = 0.25;

/// The error of the vertices of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VertexError {
    /// The largest coordinate in the file.
    coordinate: f32,
    /// The error in the world.
    distance: f64,
    /// The error relative to half the longest side of the mesh.
    part: f64,
}

impl VertexError {
    /// Computes the error of vertices that `linear` maps to the world. None: it is negligible, or the mesh
    /// is a point.
    pub(crate) fn of(positions: &[[f32; 3]], linear: &DMat3) -> Option<Self> {
        let nowhere = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let around =
            |[low, high]: [Vec3; 2], &p: &[f32; 3]| [low.min(p.into()), high.max(p.into())];
        let [low, high] = positions.iter().fold(nowhere, around);
        let size = (high.as_dvec3() - low.as_dvec3()).max_element() / 2.0;
        let coordinate = low.abs().max(high.abs()).max_element();
        let error = f64::from(coordinate.next_up() - coordinate) / 2.0;
        let is_noticed = size > 0.0 && error > NOTICED * size && error.is_finite();
        is_noticed.then(|| Self {
            coordinate,
            distance: error * stretch(linear),
            part: error / size,
        })
    }
}

/// Estimates the largest factor by which a map lengthens vectors: its longest column.
fn stretch(linear: &DMat3) -> f64 {
    let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
    columns.map(DVec3::length).into_iter().fold(0.0, f64::max)
}

/// The errors of all meshes of a scene, each with the place `P` in the file that names the mesh.
#[derive(Clone, Debug)]
pub(crate) struct VertexErrors<P> {
    /// The number of meshes with an error.
    count: usize,
    /// The largest error relative to its mesh.
    worst: Option<(P, VertexError)>,
    /// The largest error in the world.
    longest: Option<(P, VertexError)>,
}

impl<P: Clone> VertexErrors<P> {
    pub(crate) const NONE: Self = Self {
        count: 0,
        worst: None,
        longest: None,
    };

    /// Adds the error of a mesh. None: it is negligible.
    pub(crate) fn add(&mut self, place: &P, error: Option<VertexError>) {
        let Some(error) = error else { return };
        self.count += 1;
        let keep = |known: &mut Option<(P, VertexError)>, size: fn(&VertexError) -> f64| {
            if known
                .as_ref()
                .is_none_or(|(_, known)| size(known) < size(&error))
            {
                *known = Some((place.clone(), error));
            }
        };
        keep(&mut self.worst, |error| error.part);
        keep(&mut self.longest, |error| error.distance);
    }

    /// Returns the place of the mesh whose error is too large to render the scene, and the message; `reach` is
    /// half the size of the scene with the camera. None: no error is too large.
    pub(crate) fn refusal(&self, reach: f64) -> Option<(P, String)> {
        let (place, error) = self.longest.as_ref()?;
        (error.distance > ACCEPTED * reach).then(|| {
            let message = format!(
                "coordinates of {:.2e} as 32-bit floats are off by up to {:.2e}: the whole scene \
                 is {:.2e} wide",
                error.coordinate,
                error.distance,
                2.0 * reach
            );
            (place.clone(), message)
        })
    }

    /// Returns the warning for the mesh with the largest relative error. None: no error is noticeable.
    pub(crate) fn warning(&self) -> Option<(P, String)> {
        let (place, error) = self.worst.as_ref()?;
        let others = match self.count {
            1 => String::new(),
            count => format!("; {count} meshes in all"),
        };
        let message = format!(
            "coordinates of {:.2e} as 32-bit floats are off by up to {:.2e}, {:.0} % of the mesh's \
             size: {HINT}{others}",
            error.coordinate,
            error.distance,
            50.0 * error.part
        );
        Some((place.clone(), message))
    }
}

/// The hint of the warning and of the error.
pub(crate) const HINT: &str = "use small coordinates and a transformation";

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(at: f32) -> [[f32; 3]; 4] {
        [[-1., 0.], [1., 0.], [1., 2.], [-1., 2.]].map(|[x, y]| [at + x, y, 0.0])
    }

    #[test]
    fn errors_that_are_small_for_the_mesh_are_ignored() {
        for at in [0.0, 1.0, 1e3, 1e5] {
            assert_eq!(VertexError::of(&quad(at), &DMat3::IDENTITY), None);
        }
        assert_eq!(VertexError::of(&[[1e9; 3]; 3], &DMat3::IDENTITY), None);
        assert_eq!(VertexError::of(&[], &DMat3::IDENTITY), None);
    }

    #[test]
    fn the_error_is_half_a_step_of_the_largest_coordinate() {
        let scaled = DMat3::from_diagonal(DVec3::new(1.0, 4.0, 2.0));
        let error = VertexError::of(&quad(1e6), &scaled).unwrap();
        assert_eq!((error.part, error.distance), (0.03125, 0.125));
        let mut errors = VertexErrors::NONE;
        errors.add(&1, Some(error));
        errors.add(&2, VertexError::of(&quad(4e6), &DMat3::IDENTITY));
        let (place, message) = errors.warning().unwrap();
        assert_eq!(place, 2);
        assert_eq!(
            message,
            "coordinates of 4.00e6 as 32-bit floats are off by up to 1.25e-1, 6 % of the mesh's \
             size: use small coordinates and a transformation; 2 meshes in all"
        );
    }

    #[test]
    fn a_scene_with_large_errors_is_refused() {
        let mut errors = VertexErrors::NONE;
        errors.add(&1, VertexError::of(&quad(1e7), &DMat3::IDENTITY));
        assert_eq!(errors.refusal(4.0), None);
        let (place, message) = errors.refusal(1.0).unwrap();
        assert_eq!(place, 1);
        assert_eq!(
            message,
            "coordinates of 1.00e7 as 32-bit floats are off by up to 5.00e-1: the whole scene is \
             2.00e0 wide"
        );
    }
}
