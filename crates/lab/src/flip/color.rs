//! The colour spaces of FLIP, and distances in them \[Andersson20, §4.1\].
//!
//! With X, Y, Z relative to the white of Rec. 709 (D65):
//!
//! - opponent colours YCxCz: Y' = 116 Y - 16, Cx = 500 (X - Y), Cz = 200 (Y - Z). They are linear in light, so
//!   that a filter of them is a filter of light;
//! - L\*a\*b\*: the same formulas of f(X), f(Y), f(Z), where f is a cube root with a linear toe.

use super::Plane;
use rayon::prelude::*;

/// X, Y and Z (rows) of Rec. 709's red, green and blue with white D65.
const XYZ_OF_RGB: [[f32; 3]; 3] = [
    [0.4123908, 0.3575843, 0.1804808],
    [0.2126390, 0.7151687, 0.0721923],
    [0.0193308, 0.1191948, 0.9505322],
];

/// The inverse of [`XYZ_OF_RGB`].
const RGB_OF_XYZ: [[f32; 3]; 3] = [
    [3.2409699, -1.5373832, -0.4986108],
    [-0.9692436, 1.8759675, 0.0415551],
    [0.0556301, -0.2039770, 1.0569715],
];

/// X, Y and Z of white: the sums of the rows.
const WHITE: [f32; 3] = [0.9504559, 1.0, 1.0890578];

fn product(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Converts linear light to X, Y and Z relative to white.
fn relative_xyz(rgb: [f32; 3]) -> [f32; 3] {
    let xyz = product(&XYZ_OF_RGB, rgb);
    [0, 1, 2].map(|i| xyz[i] / WHITE[i])
}

/// Computes the luminance of linear light; that of white is 1.
pub(super) fn luminance(rgb: [f32; 3]) -> f32 {
    relative_xyz(rgb)[1]
}

/// An image in YCxCz.
pub(super) struct Opponent {
    /// Luminance, linear. Range: `[0, 1]` instead of Y' = 116 Y - 16.
    pub(super) y: Plane,
    /// Red against green.
    pub(super) cx: Plane,
    /// Blue against yellow.
    pub(super) cz: Plane,
}

impl Opponent {
    /// Converts an image of linear light.
    pub(super) fn of(size: [usize; 2], pixels: &[[f32; 3]]) -> Self {
        let plane = |value: fn([f32; 3]) -> f32| {
            let values = pixels.par_iter().map(|&rgb| value(relative_xyz(rgb)));
            Plane::new(size, values.collect())
        };
        Self {
            y: plane(|[_, y, _]| y),
            cx: plane(|[x, y, _]| 500.0 * (x - y)),
            cz: plane(|[_, y, z]| 200.0 * (y - z)),
        }
    }
}

/// Converts luminance, Cx and Cz to linear light, which may lie outside `[0, 1]`.
pub(super) fn rgb_of_opponent([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    product(&RGB_OF_XYZ, [0, 1, 2].map(|i| relative[i] * WHITE[i]))
}

/// Converts linear light to L\*a\*b\* with the Hunt effect: a\* and b\* are scaled by 0.01 L\*, as colours are
/// less visible in the dark \[Andersson20, §4.1\].
pub(super) fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let f = |t: f32| {
        if t > DELTA * DELTA * DELTA {
            libm::cbrtf(t)
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative_xyz(rgb).map(f);
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// Computes HyAB, the distance for large differences of colour: |ΔL| + ‖Δ(a, b)‖ \[Andersson20, §4.1\].
pub(super) fn hyab(p: [f32; 3], q: [f32; 3]) -> f32 {
    let [l, a, b] = [0, 1, 2].map(|i| p[i] - q[i]);
    l.abs() + (a * a + b * b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrices_are_inverse_and_white_maps_to_one() {
        for rgb in [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.3, 0.5, 0.7],
        ] {
            let back = product(&RGB_OF_XYZ, product(&XYZ_OF_RGB, rgb));
            let planes = Opponent::of([1, 1], &[rgb]);
            let from_opponent =
                rgb_of_opponent([planes.y.data[0], planes.cx.data[0], planes.cz.data[0]]);
            for i in 0..3 {
                assert!((back[i] - rgb[i]).abs() < 1e-6, "{back:?} {rgb:?}");
                assert!(
                    (from_opponent[i] - rgb[i]).abs() < 1e-5,
                    "{from_opponent:?}"
                );
            }
        }
        for value in relative_xyz([1.0; 3]) {
            assert!((value - 1.0).abs() < 1e-6, "{value}");
        }
    }

    #[test]
    fn white_and_red_have_their_known_lab() {
        let [l, a, b] = hunt_lab([1.0; 3]);
        assert!((l - 100.0).abs() < 1e-3 && a.abs() < 1e-3 && b.abs() < 1e-3);
        // L*a*b* of sRGB red is (53.24, 80.09, 67.20).
        let [l, a, b] = hunt_lab([1.0, 0.0, 0.0]);
        assert!((l - 53.24).abs() < 0.01, "{l}");
        assert!((a - 0.5324 * 80.09).abs() < 0.02, "{a}");
        assert!((b - 0.5324 * 67.20).abs() < 0.02, "{b}");
    }
}
