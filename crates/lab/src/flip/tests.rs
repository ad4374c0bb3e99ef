//! Comparisons with the authors' program; `tools/flip_check.py` prints its numbers.

use super::*;
use crate::metric::Metric;

const SIZE: [usize; 2] = [40, 24];
const PLACES: [[usize; 2]; 5] = [[0, 0], [39, 0], [5, 17], [20, 12], [33, 23]];

/// Makes an image from the formula of a channel; every value is exact.
fn image(value: impl Fn(i32, i32, i32) -> f64) -> Pixels {
    let [width, height] = SIZE.map(|side| side as i32);
    let pixel = |i: i32| [0, 1, 2].map(|c| value(i % width, i / width, c) as f32);
    Pixels {
        size: SIZE,
        data: (0..width * height).map(pixel).collect(),
    }
}

/// Evaluates stripes whose slope depends on the channel, a quarter as bright in every other block.
fn stripes(x: i32, y: i32, c: i32) -> f64 {
    let value = f64::from((x * (c + 2) + y * (5 - c)) % 32) / 32.0;
    let dark = (x / 8 + y / 6) % 2 == 0;
    if dark { value / 4.0 } else { value }
}

/// Evaluates a noise-like pattern. Range: -8 to 7.
fn noise(x: i32, y: i32, c: i32) -> f64 {
    f64::from((x * x + 3 * y * y + 7 * c + x * y) % 16 - 8)
}

fn on_screen() -> [Pixels; 2] {
    let noisy = |x, y, c| (stripes(x, y, c) + noise(x, y, c) / 64.0).clamp(0.0, 1.0);
    [image(noisy), image(stripes)]
}

fn light() -> [Pixels; 2] {
    let bright = |x: i32, y, c| stripes(x, y, c) * libm::exp2(f64::from((x / 5 + y / 4) % 9 - 3));
    let firefly = |x: i32, y: i32| {
        if (x * 7 + y * 13) % 97 == 0 {
            64.0
        } else {
            0.0
        }
    };
    let noisy = |x, y, c| bright(x, y, c) * (1.0 + noise(x, y, c) / 16.0) + firefly(x, y);
    [image(noisy), image(bright)]
}

/// Compares errors with the mean and some pixels of `flip-evaluator` 1.7.
#[track_caller]
fn check(errors: &ErrorMap, mean: f64, pixels: [f64; 5]) {
    let found = Metric::Flip.pool(errors);
    assert!((found - mean).abs() < 1e-5, "mean {found}, not {mean}");
    for ([x, y], expected) in PLACES.into_iter().zip(pixels) {
        let error = errors.data[y * SIZE[0] + x];
        let is_near = (error - expected).abs() < 1e-4;
        assert!(is_near, "{error} at {x} {y}, not {expected}");
    }
}

#[test]
fn ldr_errors_equal_those_of_the_authors_program() {
    let [a, b] = on_screen();
    let pair = Pair::new(&a, &b).unwrap();
    let pixels = [0.272668, 0.291454, 0.160882, 0.074585, 0.094954];
    check(&ldr(&pair, PIXELS_PER_DEGREE), 0.155453533, pixels);
    let pixels = [0.328296, 0.287730, 0.230429, 0.138711, 0.247383];
    check(&ldr(&pair, 30.0), 0.292924941, pixels);
}

#[test]
fn hdr_errors_equal_those_of_the_authors_program() {
    let [a, b] = light();
    let pair = Pair::new(&a, &b).unwrap();
    let exposures = Exposures::of(&b);
    assert!((exposures.start - -3.6718469).abs() < 1e-4, "{exposures:?}");
    assert!((exposures.stop - 1.9707638).abs() < 1e-4, "{exposures:?}");
    assert_eq!(exposures.count, 6);
    let pixels = [0.989507, 0.292835, 0.179753, 0.116725, 0.284991];
    check(
        &hdr(&pair, PIXELS_PER_DEGREE, exposures),
        0.227117330,
        pixels,
    );
    let pixels = [0.993389, 0.314421, 0.289743, 0.276840, 0.472045];
    check(&hdr(&pair, 30.0, exposures), 0.345471472, pixels);
    let exposures = Exposures {
        start: -3.0,
        stop: 2.0,
        count: 4,
    };
    let pixels = [0.989420, 0.291570, 0.176505, 0.115235, 0.275461];
    check(
        &hdr(&pair, PIXELS_PER_DEGREE, exposures),
        0.219632670,
        pixels,
    );
}

#[test]
fn black_and_white_differ_most_and_equal_images_not_at_all() {
    let (black, white) = (image(|_, _, _| 0.0), image(|_, _, _| 1.0));
    let pair = Pair::new(&white, &black).unwrap();
    assert!(Metric::Flip.value(&pair) > 0.95);
    let [a, _] = on_screen();
    assert!(Metric::Flip.value(&Pair::new(&a, &a).unwrap()) <= 0.0);
}

#[test]
fn a_nan_pixel_gives_nan_and_infinite_or_negative_pixels_a_finite_error() {
    let [mut a, b] = light();
    a.data[100] = [f32::NAN; 3];
    assert!(Metric::FlipHdr.value(&Pair::new(&a, &b).unwrap()).is_nan());
    a.data[100] = [f32::INFINITY, -1.0, 0.0];
    let value = Metric::FlipHdr.value(&Pair::new(&a, &b).unwrap());
    assert!(value > 0.0 && value <= 1.0, "{value}");
    let turned = Pair::new(&b, &a).unwrap();
    assert!(Metric::FlipHdr.value(&turned).is_finite());
}
