//! FLIP: the difference that an observer sees when two images alternate at the same place.
//!
//! For images on a screen \[Andersson20\], with linear channels in [0, 1]:
//!
//! 1. *Colour* (`color`, `contrast`): both images, in opponent colours, are filtered by the contrast
//!    sensitivity of the eye at a given number of pixels per degree; ΔE_c in [0, 1] is a compressed distance
//!    in L\*a\*b\* (§4.1).
//! 2. *Features* (`feature`): edges and points of the luminance give ΔE_f in [0, 1] (§4.2).
//! 3. ΔE = ΔE_c^(1 - ΔE_f) (§4.3): a feature in only one of the images makes a difference of colour more
//!    visible.
//!
//! For HDR images \[Andersson21\], both images are tone-mapped at several exposures (`exposure`), and the error
//! of a pixel is the largest over the exposures.
//!
//! Channels are first clamped to [0, 1], or to positive values for HDR. Filters repeat the border pixels. NaN
//! spreads within the radius of a filter. Errors are in [0, 1]: near 1 for black against white, exactly 0 for
//! equal images.
//!
//! The code follows the formulas of the papers; tests compare it with results of the authors' program.

mod color;
mod contrast;
mod exposure;
mod feature;
mod plane;
#[cfg(test)]
mod tests;

pub use exposure::Exposures;

use crate::image::{Pair, Pixels};
use crate::metric::ErrorMap;
use color::Opponent;
use plane::Plane;
use rayon::prelude::*;

/// The pixels per degree in the authors' program: 0.7 m from a screen 0.7 m wide with 3840 pixels.
///
/// Distance · pixels / width · π/180, which is 67.02.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * std::f64::consts::PI / 180.0;

/// Computes the FLIP error of every pixel on a screen that shows `[0, 1]`. Range of `pixels_per_degree`:
/// positive.
pub fn ldr(pair: &Pair<'_>, pixels_per_degree: f64) -> ErrorMap {
    let shown = |pixels: &Pixels| screen(pixels, |channel| channel);
    let [a, b] = [pair.image(), pair.reference()].map(shown);
    let errors = differences(pair.size(), &a, &b, pixels_per_degree);
    error_map(pair.size(), &errors)
}

/// Computes the HDR-FLIP error of every pixel: the largest over the exposures.
pub fn hdr(pair: &Pair<'_>, pixels_per_degree: f64, exposures: Exposures) -> ErrorMap {
    let mut largest = vec![0.0f32; pair.reference().data.len()];
    for stops in exposures.stops() {
        let scale = libm::exp2(stops) as f32;
        let shown = |pixels: &Pixels| screen(pixels, |channel| exposure::tone_map(channel * scale));
        let [a, b] = [pair.image(), pair.reference()].map(shown);
        let errors = differences(pair.size(), &a, &b, pixels_per_degree);
        for (largest, error) in largest.iter_mut().zip(errors) {
            // Unlike `max`, this keeps a NaN.
            if error > *largest || error.is_nan() {
                *largest = error;
            }
        }
    }
    error_map(pair.size(), &largest)
}

/// Maps an image to a screen. Range: `[0, 1]`, linear.
fn screen(pixels: &Pixels, tone_map: impl Fn(f32) -> f32 + Sync) -> Vec<[f32; 3]> {
    // Unlike `max`, `clamp` keeps a NaN.
    let positive = |channel: f32| channel.clamp(0.0, f32::INFINITY);
    let shown = |pixel: &[f32; 3]| pixel.map(|c| tone_map(positive(c)).clamp(0.0, 1.0));
    pixels.data.par_iter().map(shown).collect()
}

/// Computes ΔE of every pixel of two images on a screen.
fn differences(
    size: [usize; 2],
    a: &[[f32; 3]],
    b: &[[f32; 3]],
    pixels_per_degree: f64,
) -> Vec<f32> {
    let opponent = |pixels: &[[f32; 3]]| Opponent::of(size, pixels);
    let (a, b) = (opponent(a), opponent(b));
    let colors = contrast::color_differences(&a, &b, pixels_per_degree);
    let features = feature::differences(&a.y, &b.y, pixels_per_degree);
    colors
        .par_iter()
        .zip(&features)
        .map(|(&color, &feature)| libm::powf(color, 1.0 - feature)) // [Andersson20, §4.3]
        .collect()
}

fn error_map(size: [usize; 2], errors: &[f32]) -> ErrorMap {
    ErrorMap {
        size,
        data: errors.iter().map(|&error| f64::from(error)).collect(),
    }
}
