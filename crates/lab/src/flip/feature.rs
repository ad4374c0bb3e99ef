//! Differences of edges and points between two images \[Andersson20, §4.2\].
//!
//! The detectors are the first and second derivatives of a Gaussian with σ = w / 2, where w = 0.082 degrees
//! is the width of an edge; along x, before normalisation,
//!
//!   edge: -x G(x, y),   point: (x² / σ² - 1) G(x, y),
//!
//! and along y likewise. Positive weights are normalised to sum 1, negative ones to -1; since the signs
//! depend on one coordinate only, each dimension is normalised separately. The strength of a feature is the
//! length of the vector of both responses, and
//!
//!   ΔE_f = (max(|edge_a - edge_b|, |point_a - point_b|) / √2)^½.

use super::Plane;
use super::plane::Kernel;
use rayon::prelude::*;

/// The width of an edge. Unit: degrees.
const WIDTH: f64 = 0.082;

/// The filters for a number of pixels per degree.
struct Detectors {
    smooth: Kernel,
    edge: Kernel,
    point: Kernel,
}

impl Detectors {
    fn new(pixels_per_degree: f64) -> Self {
        let sigma = 0.5 * WIDTH * pixels_per_degree;
        let radius = libm::ceil(3.0 * sigma) as usize;
        let gaussian = move |x: f64| libm::exp(-x * x / (2.0 * sigma * sigma));
        let kernel = |value: &dyn Fn(f64) -> f64| Kernel::new(radius, value).normalised();
        Self {
            smooth: kernel(&gaussian),
            edge: kernel(&|x| -x * gaussian(x)),
            point: kernel(&|x| (x * x / (sigma * sigma) - 1.0) * gaussian(x)),
        }
    }

    /// Computes the strengths of edges and of points at every pixel.
    fn features(&self, luminance: &Plane) -> [Vec<f32>; 2] {
        let smooth_rows = luminance.along_rows(&self.smooth);
        let smooth_columns = luminance.along_columns(&self.smooth);
        [&self.edge, &self.point].map(|kernel| {
            let x = smooth_columns.along_rows(kernel).data;
            let y = smooth_rows.along_columns(kernel).data;
            let length = |(x, y): (&f32, &f32)| (x * x + y * y).sqrt();
            x.par_iter().zip(&y).map(length).collect()
        })
    }
}

/// Computes ΔE_f of every pixel from the luminance of two images. Range: `[0, 1]`.
pub(super) fn differences(a: &Plane, b: &Plane, pixels_per_degree: f64) -> Vec<f32> {
    let detectors = Detectors::new(pixels_per_degree);
    let [a_edges, a_points] = detectors.features(a);
    let [b_edges, b_points] = detectors.features(b);
    let edges = a_edges.par_iter().zip(&b_edges);
    let points = a_points.par_iter().zip(&b_points);
    let difference = |((a_edge, b_edge), (a_point, b_point)): ((&f32, &f32), (&f32, &f32))| {
        let largest = (a_edge - b_edge).abs().max((a_point - b_point).abs());
        (largest * std::f32::consts::FRAC_1_SQRT_2).sqrt()
    };
    edges.zip(points).map(difference).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the largest error between a black image and one that is 1 inside a region.
    fn largest(inside: impl Fn(usize, usize) -> bool) -> f32 {
        let value = |i: usize| f32::from(u8::from(inside(i % 64, i / 64)));
        let image = Plane::new([64, 64], (0..64 * 64).map(value).collect());
        let flat = Plane::new([64, 64], vec![0.0; 64 * 64]);
        let errors = differences(&image, &flat, 67.0);
        errors.into_iter().fold(0.0, f32::max)
    }

    /// An edge from 0 to 1 has the response 1, slightly less half a pixel beside it.
    #[test]
    fn edges_in_both_directions_have_the_same_error() {
        let (x, y) = (largest(|x, _| x < 32), largest(|_, y| y < 32));
        assert!((x - y).abs() < 1e-6, "{x} {y}");
        let expected = std::f32::consts::FRAC_1_SQRT_2.sqrt();
        assert!(x > 0.9 * expected && x <= expected + 1e-6, "{x} {expected}");
    }

    #[test]
    fn points_have_an_error_and_equal_images_none() {
        assert!(largest(|x, y| x == 32 && y == 32) > 0.1);
        assert!(largest(|_, _| false).abs() < 1e-6);
    }
}
