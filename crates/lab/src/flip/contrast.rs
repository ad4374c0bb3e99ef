//! Differences of colour after the eye's spatial filter \[Andersson20, §4.1\].
//!
//! The contrast sensitivity of each opponent channel is a sum of Gaussians of frequency; in space, at
//! the distance d in degrees (Table 1 of the paper),
//!
//!   g(d) = Σ_i a_i √(π / b_i) exp(-π² d² / b_i).
//!
//! | channel | a_1 | b_1 | a_2 | b_2 |
//! |---|---|---|---|---|
//! | Y | 1 | 0.0047 | | |
//! | Cx | 1 | 0.0053 | | |
//! | Cz | 34.1 | 0.04 | 13.5 | 0.025 |
//!
//! The weights g of the pixels are normalised to sum 1; each Gaussian is separable.

use super::color::{Opponent, hunt_lab, hyab, rgb_of_opponent};
use super::{Plane, plane::Kernel};
use rayon::prelude::*;
use std::f64::consts::PI;

/// A term of a sensitivity.
#[derive(Clone, Copy)]
struct Gaussian {
    a: f64,
    b: f64,
}

const Y: [Gaussian; 1] = [Gaussian { a: 1.0, b: 0.0047 }];
const CX: [Gaussian; 1] = [Gaussian { a: 1.0, b: 0.0053 }];
const CZ: [Gaussian; 2] = [
    Gaussian { a: 34.1, b: 0.04 },
    Gaussian { a: 13.5, b: 0.025 },
];

/// Computes ΔE_c of every pixel. Range: `[0, 1]`.
pub(super) fn color_differences(a: &Opponent, b: &Opponent, pixels_per_degree: f64) -> Vec<f32> {
    let seen = |image: &Opponent| -> Vec<[f32; 3]> {
        let y = blurred(&image.y, &Y, pixels_per_degree).data;
        let cx = blurred(&image.cx, &CX, pixels_per_degree).data;
        let cz = blurred(&image.cz, &CZ, pixels_per_degree).data;
        let channels = y.par_iter().zip(&cx).zip(&cz);
        let lab = |((&y, &cx), &cz): ((&f32, &f32), &f32)| {
            hunt_lab(rgb_of_opponent([y, cx, cz]).map(|channel| channel.clamp(0.0, 1.0)))
        };
        channels.map(lab).collect()
    };
    let (a, b) = (seen(a), seen(b));
    let largest = largest_difference();
    a.par_iter()
        .zip(&b)
        .map(|(&a, &b)| redistributed(compressed(hyab(a, b)), largest))
        .collect()
}

/// Filters a channel by the contrast sensitivity of the eye.
fn blurred(plane: &Plane, terms: &[Gaussian], pixels_per_degree: f64) -> Plane {
    // Three standard deviations of the widest term of all, σ = √(b / 2π²) [Andersson20, §4.1].
    let radius = libm::ceil(3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * pixels_per_degree) as usize;
    let gaussian = |b: f64, x: f64| {
        let d = x / pixels_per_degree;
        libm::exp(-PI * PI * d * d / b)
    };
    // In two dimensions, a term sums to its factor times the square of its sum in one dimension.
    let share = |term: &Gaussian| {
        let line: f64 = (-(radius as i64)..=radius as i64)
            .map(|x| gaussian(term.b, x as f64))
            .sum();
        term.a * (PI / term.b).sqrt() * line * line
    };
    let total: f64 = terms.iter().map(share).sum();
    let blur = |term: &Gaussian| {
        let kernel = Kernel::new(radius, |x| gaussian(term.b, x)).normalised();
        let blurred = plane.along_rows(&kernel).along_columns(&kernel);
        blurred.scaled((share(term) / total) as f32)
    };
    let sum = terms.iter().map(blur).reduce(|sum, term| sum.plus(&term));
    sum.expect("a sensitivity has a term")
}

/// Compresses a distance, which gives small differences more weight \[Andersson20, §4.1\].
fn compressed(distance: f32) -> f32 {
    libm::powf(distance, 0.7)
}

/// Computes the compressed distance of green and blue, the largest of all colours on a screen.
fn largest_difference() -> f32 {
    compressed(hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])))
}

/// Maps [0, p_c c_max] to [0, p_t], and the rest to [p_t, 1], linearly: all differences beyond the fraction
/// p_c of the largest are about equally visible \[Andersson20, §4.1\].
fn redistributed(difference: f32, largest: f32) -> f32 {
    const P_C: f32 = 0.4;
    const P_T: f32 = 0.95;
    let knee = P_C * largest;
    if difference < knee {
        difference * P_T / knee
    } else {
        P_T + (difference - knee) / (largest - knee) * (1.0 - P_T)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_keep_constants_and_the_sum_of_a_point() {
        for terms in [&Y[..], &CX, &CZ] {
            let flat = blurred(&Plane::new([30, 30], vec![0.5; 900]), terms, 67.0);
            assert!(flat.data.iter().all(|value| (value - 0.5).abs() < 1e-5));
            let mut point = Plane::new([30, 30], vec![0.0; 900]);
            point.data[15 * 30 + 15] = 1.0;
            let sum: f32 = blurred(&point, terms, 67.0).data.iter().sum();
            assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        }
    }

    #[test]
    fn differences_are_redistributed_from_0_to_1() {
        let largest = largest_difference();
        for (part, expected) in [
            (0.0, 0.0),
            (0.2, 0.475),
            (0.4, 0.95),
            (0.7, 0.975),
            (1.0, 1.0),
        ] {
            let value = redistributed(part * largest, largest);
            assert!((value - expected).abs() < 1e-5, "{part}: {value}");
        }
    }
}
