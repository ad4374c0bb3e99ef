//! The current transformation and the directives that change it.

use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

/// Transformations at the two ends of the shutter's interval: equal if nothing moves.
///
/// They are `f64`, so that chains of rotations and translations are rounded to `f32` only once, at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transforms {
    /// The transformation at the first time.
    pub start: DAffine3,
    /// The transformation at the second time.
    pub end: DAffine3,
    /// The two times.
    pub times: [f32; 2],
}

impl Default for Transforms {
    fn default() -> Self {
        Self {
            start: DAffine3::IDENTITY,
            end: DAffine3::IDENTITY,
            times: [0.0, 1.0],
        }
    }
}

impl Transforms {
    /// Returns true if the two ends differ.
    pub fn is_animated(&self) -> bool {
        self.start != self.end
    }

    pub(super) fn identity(times: [f32; 2]) -> Self {
        Self {
            times,
            ..Self::default()
        }
    }

    pub(crate) fn inverse(self) -> Self {
        Self {
            start: self.start.inverse(),
            end: self.end.inverse(),
            ..self
        }
    }

    /// Changes the ends that are `active`.
    pub(super) fn change(&mut self, active: Active, f: impl Fn(DAffine3) -> DAffine3) {
        if active != Active::EndTime {
            self.start = f(self.start);
        }
        if active != Active::StartTime {
            self.end = f(self.end);
        }
    }
}

/// The ends of the interval that transform directives change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Active {
    #[default]
    All,
    StartTime,
    EndTime,
}

/// The reason why a transformation is not valid.
pub(super) type Reason = &'static str;

/// Returns the rotation by `degrees` about an axis, by Rodrigues' formula: v′ = c v + (1 − c)(a·v) a + s a × v.
pub(super) fn rotate(degrees: f64, axis: DVec3) -> Result<DAffine3, Reason> {
    let axis = axis
        .try_normalize()
        .ok_or("the axis of a rotation must not be zero")?;
    let radians = degrees.to_radians();
    let (sin, cos) = (libm::sin(radians), libm::cos(radians));
    let column = |v: DVec3| cos * v + (1.0 - cos) * axis.dot(v) * axis + sin * axis.cross(v);
    let matrix = DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
    Ok(DAffine3::from_mat3(matrix))
}

/// Returns camera from world for a camera at `eye`, with +z towards `target`, +y up, +x to the right.
///
/// This camera space is left-handed.
pub(super) fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Result<DAffine3, Reason> {
    let forward = (target - eye)
        .try_normalize()
        .ok_or("the eye must not be at the target")?;
    let parallel = "the up vector must not be zero or parallel to the view";
    let up = up.try_normalize().ok_or(parallel)?;
    let across = up.cross(forward);
    // The vectors have unit length: 1e-9 is far below any intended angle.
    let right = if across.length() > 1e-9 {
        across.normalize()
    } else {
        return Err(parallel);
    };
    let frame = DMat3::from_cols(right, forward.cross(right), forward);
    Ok(DAffine3::from_mat3_translation(frame, eye).inverse())
}

/// Reads a matrix of sixteen numbers, column by column.
pub(super) fn matrix(numbers: &[f64; 16]) -> Result<DAffine3, Reason> {
    let matrix = DMat4::from_cols_array(numbers);
    let bottom = matrix.row(3);
    if bottom.truncate() != DVec3::ZERO || bottom.w == 0.0 {
        return Err(
            "the numbers 4, 8 and 12 of a matrix must be 0 and its last must not: perspective is \
             not allowed",
        );
    }
    let column = |column: DVec4| column.truncate() / bottom.w;
    let linear = DMat3::from_cols(
        column(matrix.x_axis),
        column(matrix.y_axis),
        column(matrix.z_axis),
    );
    Ok(DAffine3::from_mat3_translation(
        linear,
        column(matrix.w_axis),
    ))
}

/// Returns true if a transformation has a finite inverse.
pub(super) fn is_invertible(transform: &DAffine3) -> bool {
    let determinant = transform.matrix3.determinant();
    transform.is_finite() && determinant.is_normal() && transform.inverse().is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check_maps(transform: DAffine3, from: [f64; 3], to: [f64; 3]) {
        let mapped = transform.transform_point3(from.into());
        assert!(
            mapped.abs_diff_eq(to.into(), 1e-12),
            "{from:?} → {mapped}, not {to:?}"
        );
    }

    #[test]
    fn rotations_follow_the_right_hand_rule() {
        check_maps(rotate(90.0, DVec3::Z).unwrap(), [1., 0., 0.], [0., 1., 0.]);
        check_maps(
            rotate(-90.0, DVec3::X * 7.0).unwrap(),
            [0., 1., 0.],
            [0., 0., -1.],
        );
        check_maps(
            rotate(120.0, DVec3::ONE).unwrap(),
            [1., 2., 3.],
            [3., 1., 2.],
        );
        assert!(rotate(1.0, DVec3::ZERO).is_err());
    }

    #[test]
    fn the_camera_looks_along_z_with_x_to_the_right() {
        let camera = look_at(
            DVec3::new(278., 273., -800.),
            DVec3::new(278., 273., 0.),
            DVec3::Y,
        );
        let camera = camera.unwrap();
        check_maps(camera, [278., 273., -800.], [0., 0., 0.]);
        check_maps(camera, [278., 273., -700.], [0., 0., 100.]);
        check_maps(camera, [279., 274., -800.], [1., 1., 0.]);
        assert!(look_at(DVec3::ZERO, DVec3::Y, DVec3::Y * -3.0).is_err());
        assert!(look_at(DVec3::Y, DVec3::Y, DVec3::X).is_err());
    }

    #[test]
    fn matrices_are_read_by_columns() {
        let mut numbers = [
            1., 2., 3., 0., 4., 5., 6., 0., 7., 8., 10., 0., 11., 12., 13., 1.,
        ];
        check_maps(matrix(&numbers).unwrap(), [0., 0., 0.], [11., 12., 13.]);
        check_maps(matrix(&numbers).unwrap(), [1., 0., 0.], [12., 14., 16.]);
        numbers[3] = 0.5;
        assert!(matrix(&numbers).is_err());
    }
}
