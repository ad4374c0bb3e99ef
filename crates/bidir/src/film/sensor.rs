//! The response of a sensor to light before the film sums it: balance · RGB, limited.

use crate::math::{Mat3, Vec3};
use crate::spectrum::Rgb;

/// The response of a film to light. The default is the identity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// White balance: the matrix that multiplies linear Rec. 709. None: the identity.
    pub balance: Option<Mat3>,
    /// The largest value that a channel may have in one camera sample, or in one contribution to the light image,
    /// before exposure. Brighter colours are scaled down, so that they keep their hue. None: there is no limit.
    ///
    /// A limit removes light, and removes more of it if the estimator is noisier. Hence pictures of different
    /// estimators differ, and the parts of a picture do not add up to it.
    pub limit: Option<f32>,
}

impl Sensor {
    /// Returns the response to a sample.
    #[inline]
    pub fn respond(&self, light: Rgb) -> Rgb {
        let balanced = match &self.balance {
            Some(balance) => (*balance * Vec3::from(light)).into(),
            None => light,
        };
        match self.limit {
            Some(limit) => limited(balanced, limit),
            None => balanced,
        }
    }
}

#[inline]
fn limited(value: Rgb, limit: f32) -> Rgb {
    let largest = value.iter().copied().fold(0.0, f32::max);
    if largest > limit {
        value.map(|channel| channel * (limit / largest))
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_balanced_and_then_cut() {
        let light = [1.0, 2.0, 4.0];
        let bits = |color: Rgb| color.map(f32::to_bits);
        assert_eq!(bits(Sensor::default().respond(light)), bits(light));
        let sensor = Sensor {
            balance: Some(Mat3::from_diagonal(Vec3::new(4.0, 1.0, 0.5))),
            limit: Some(3.0),
        };
        assert_eq!(bits(sensor.respond(light)), bits([3.0, 1.5, 1.5]));
        let dim = sensor.respond([0.5, 0.5, 0.5]);
        assert_eq!(bits(dim), bits([2.0, 0.5, 0.25]));
    }
}
