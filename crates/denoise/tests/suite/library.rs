//! Tests that need Open Image Denoise; without it they are skipped.

#![allow(clippy::print_stderr, reason = "a test reports why it is skipped")]

use bidir_denoise::{DenoiseError, Denoiser, Input};

const SIZE: [usize; 2] = [160, 96];

/// Loads the library. None, with the reason on stderr: there is none. An unusable library fails the test.
fn denoiser(threads: usize) -> Option<Denoiser> {
    match Denoiser::load(threads) {
        Ok(denoiser) => Some(denoiser),
        Err(error @ DenoiseError::NotFound { .. }) => {
            eprintln!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Returns a pseudorandom number in [0, 1).
fn random(index: usize) -> f32 {
    let mut bits = (index as u32).wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
    bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    ((bits ^ (bits >> 16)) >> 8) as f32 / (1 << 24) as f32
}

/// Makes a noise-free image of two surfaces that meet in slanted edges.
fn bands(one: [f32; 3], other: [f32; 3]) -> Vec<[f32; 3]> {
    let [width, height] = SIZE;
    let pixels = (0..width * height).map(|pixel| {
        let (x, y) = (pixel % width, pixel / width);
        if (2 * x + y) / 24 % 2 == 0 {
            one
        } else {
            other
        }
    });
    pixels.collect()
}

/// Multiplies each channel by 1 - `amount` + `amount` · X, where X is exponential with mean 1: noise with
/// bright outliers, as in renders.
fn noisy(image: &[[f32; 3]], amount: f32, seed: usize) -> Vec<[f32; 3]> {
    let numbers = image.iter().flatten().enumerate().map(|(index, number)| {
        let exponential = -libm::logf(1.0 - random(index + seed));
        number * (1.0 - amount + amount * exponential)
    });
    let numbers: Vec<f32> = numbers.collect();
    numbers.as_chunks::<3>().0.to_vec()
}

/// Computes the root mean square difference.
fn error(image: &[[f32; 3]], truth: &[[f32; 3]]) -> f32 {
    let pairs = image.as_flattened().iter().zip(truth.as_flattened());
    let sum: f32 = pairs.map(|(a, b)| (a - b) * (a - b)).sum();
    (sum / truth.as_flattened().len() as f32).sqrt()
}

/// Returns image, albedo and normals without noise.
fn truth() -> [Vec<[f32; 3]>; 3] {
    [
        bands([0.9, 0.6, 0.3], [0.5, 0.4, 0.4]),
        bands([0.8, 0.5, 0.2], [0.3, 0.3, 0.3]),
        bands([0.0, 0.6, 0.8], [-1.0, 0.0, 0.0]),
    ]
}

#[test]
fn denoising_reduces_the_error_and_guides_reduce_it_further() {
    let Some(denoiser) = denoiser(0) else { return };
    assert!(denoiser.version().starts_with("2."));
    let [truth, albedo, normal] = truth();
    let mut sums = [0.0; 4];
    for seed in 0..4 {
        let color = noisy(&truth, 1.0, seed << 22);
        let albedo = noisy(&albedo, 0.1, (seed << 22) + (1 << 20));
        let normal = noisy(&normal, 0.1, (seed << 22) + (1 << 21));
        let plain = Input {
            size: SIZE,
            color: &color,
            albedo: None,
            normal: None,
        };
        let by_albedo = Input {
            albedo: Some(&albedo),
            ..plain
        };
        let by_both = Input {
            normal: Some(&normal),
            ..by_albedo
        };
        sums[0] += error(&color, &truth);
        for (sum, input) in sums[1..].iter_mut().zip([plain, by_albedo, by_both]) {
            *sum += error(&denoiser.denoise(&input).unwrap(), &truth);
        }
    }
    let [noisy, plain, by_albedo, by_both] = sums;
    println!("the errors are {sums:?}");
    assert!(plain < noisy / 4.0, "{sums:?}");
    assert!(by_albedo < 0.9 * plain, "{sums:?}");
    assert!(by_both < 0.9 * plain, "{sums:?}");
}

#[test]
fn the_output_does_not_depend_on_the_number_of_threads() {
    let [truth, albedo, normal] = truth();
    let color = noisy(&truth, 1.0, 7);
    let input = Input {
        size: SIZE,
        color: &color,
        albedo: Some(&albedo),
        normal: Some(&normal),
    };
    let Some(first) = denoiser(1) else { return };
    let first = first.denoise(&input).unwrap();
    for threads in [1, 2, 0] {
        let again = denoiser(threads).unwrap();
        assert_eq!(again.denoise(&input).unwrap(), first, "{threads}");
        assert_eq!(again.denoise(&input).unwrap(), first, "{threads}");
    }
}

#[test]
fn pixels_that_are_not_finite_do_not_spread() {
    let Some(denoiser) = denoiser(0) else { return };
    let [truth, albedo, normal] = truth();
    let [mut color, mut albedo, mut normal] = [truth.clone(), albedo, normal];
    for pixel in [0, 777, 5000, 5001] {
        color[pixel] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        albedo[pixel] = [f32::NAN; 3];
        normal[pixel] = [f32::INFINITY; 3];
    }
    let input = Input {
        size: SIZE,
        color: &color,
        albedo: Some(&albedo),
        normal: Some(&normal),
    };
    let denoised = denoiser.denoise(&input).unwrap();
    assert!(
        denoised
            .as_flattened()
            .iter()
            .all(|channel| channel.is_finite())
    );
    assert!(error(&denoised, &truth) < 0.05);
}

#[test]
fn images_of_any_size_are_denoised() {
    let Some(denoiser) = denoiser(0) else { return };
    for size in [[0, 0], [1, 1], [1, 7], [513, 3]] {
        let color = vec![[0.25; 3]; size[0] * size[1]];
        let input = Input {
            size,
            color: &color,
            albedo: Some(&color),
            normal: None,
        };
        let denoised = denoiser.denoise(&input).unwrap();
        assert_eq!(denoised.len(), color.len());
        let numbers = denoised.as_flattened();
        assert!(numbers.iter().all(|number| (0.0..1.0).contains(number)));
    }
}
