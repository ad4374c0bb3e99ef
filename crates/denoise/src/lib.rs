//! Denoises images with Open Image Denoise 2, which is loaded at run time.
//!
//! The C library is not part of the build: a machine without it builds and runs everything else, and
//! [`Denoiser::load`] fails there with the tried names and a remedy.
//!
//! ```no_run
//! use bidir_denoise::{Denoiser, Input};
//!
//! let color = vec![[0.5_f32, 0.4, 0.3]; 640 * 480];
//! let denoiser = Denoiser::load(0)?;
//! let input = Input { size: [640, 480], color: &color, albedo: None, normal: None };
//! let clean = denoiser.denoise(&input)?;
//! assert_eq!(clean.len(), color.len());
//! # Ok::<(), bidir_denoise::DenoiseError>(())
//! ```
//!
//! # Method
//!
//! The filter `RT` with `hdr` removes the noise. The guides, albedo and normal of each pixel's surface, help
//! it to distinguish texture and edges from noise. Rendered guides are noisy themselves, through depth of
//! field, motion or the pixel filter; each is therefore denoised separately first, and the flag `cleanAux`
//! declares them clean, as recommended for final frames [Afra25, documentation, RT filter].
//!
//! # Guarantees
//!
//! - A library of another major version is refused, since its functions may have other arguments.
//! - Only finite numbers in range reach the filter, see [`Input`].
//! - The filter runs on the CPU, with at most the given number of threads.
//!
//! Not supported: partial denoising, images with several layers, GPUs.

mod device;
mod error;
mod ffi;
mod find;

pub use error::DenoiseError;
pub use find::{VARIABLE, names};

use device::{Device, Image};
use std::path::Path;

/// A noisy image, and the guides of the filter.
///
/// Numbers that are not finite count as 0; others are clamped: the colour to at least 0, albedo to `[0, 1]`,
/// normals to `[-1, 1]`.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Width and height. Unit: pixels.
    pub size: [usize; 2],
    /// Linear light, red, green and blue. Shape: `size[0] · size[1]`, row by row.
    pub color: &'a [[f32; 3]],
    /// The albedo of each pixel's surface. Shape: as `color`.
    pub albedo: Option<&'a [[f32; 3]]>,
    /// The normal of each pixel's surface, in any frame. Shape: as `color`. It requires `albedo`.
    pub normal: Option<&'a [[f32; 3]]>,
}

/// A loaded Open Image Denoise.
#[derive(Debug)]
pub struct Denoiser {
    device: Device,
}

impl Denoiser {
    /// Loads the library that [`VARIABLE`] names, or else one that the system finds by [`names`].
    ///
    /// The library uses at most `threads` threads; 0 leaves the number to it. It stays loaded until the
    /// process ends.
    ///
    /// Errors: there is no library; it is another library or version; it does not run on this processor. If the
    /// variable is set, no other library is tried.
    pub fn load(threads: usize) -> Result<Self, DenoiseError> {
        let named = std::env::var_os(VARIABLE).filter(|value| !value.is_empty());
        Self::load_named(named.as_deref().map(Path::new), threads)
    }

    /// Loads the library as [`load`](Self::load) does, with a file or folder in place of the variable.
    pub fn load_named(named: Option<&Path>, threads: usize) -> Result<Self, DenoiseError> {
        let found = find::find(named)?;
        let device = Device::new(&found, threads)?;
        Ok(Self { device })
    }

    /// Returns the library's version, such as `2.3.1`.
    pub fn version(&self) -> String {
        self.device.version().map(|part| part.to_string()).join(".")
    }

    /// Returns the denoised image. Shape: as the input's colour.
    ///
    /// Errors: an image has the wrong size; normals are given without albedo; the library fails.
    pub fn denoise(&self, input: &Input<'_>) -> Result<Vec<[f32; 3]>, DenoiseError> {
        check(input)?;
        let mut color = in_range(input.color, [0.0, f32::MAX]);
        if color.is_empty() {
            return Ok(color);
        }
        let mut albedo = input.albedo.map(|albedo| in_range(albedo, [0.0, 1.0]));
        let mut normal = input.normal.map(|normal| in_range(normal, [-1.0, 1.0]));
        let mut guides = Vec::new();
        for (name, guide) in [(c"albedo", &mut albedo), (c"normal", &mut normal)] {
            let Some(pixels) = guide else { continue };
            let mut guide = Image { name, pixels };
            self.device.filter(input.size, &mut guide, &mut [], &[])?;
            guides.push(guide);
        }
        let mut image = Image {
            name: c"color",
            pixels: &mut color,
        };
        let flags = [c"hdr", c"cleanAux"];
        let flags = &flags[..if guides.is_empty() { 1 } else { 2 }];
        self.device
            .filter(input.size, &mut image, &mut guides, flags)?;
        Ok(color)
    }
}

/// Fails if an image does not fit the size, or normals are given without albedo.
fn check(input: &Input<'_>) -> Result<(), DenoiseError> {
    let [width, height] = input.size;
    // The library stores sides in signed 32-bit integers.
    let fits = [width, height]
        .iter()
        .all(|&side| i32::try_from(side).is_ok());
    let expected = width.checked_mul(height).filter(|_| fits);
    let images = [
        ("colour", Some(input.color)),
        ("albedo", input.albedo),
        ("normal", input.normal),
    ];
    for (image, pixels) in images {
        if let Some(pixels) = pixels
            && Some(pixels.len()) != expected
        {
            return Err(DenoiseError::Size {
                image,
                pixels: pixels.len(),
                size: input.size,
            });
        }
    }
    if input.normal.is_some() && input.albedo.is_none() {
        return Err(DenoiseError::NormalAlone);
    }
    Ok(())
}

/// Copies pixels, clamps numbers to `[low, high]`, and replaces those that are not finite by 0.
fn in_range(pixels: &[[f32; 3]], [low, high]: [f32; 2]) -> Vec<[f32; 3]> {
    let in_range = |number: f32| {
        if number.is_finite() {
            number.clamp(low, high)
        } else {
            0.0
        }
    };
    pixels.iter().map(|pixel| pixel.map(in_range)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check_refused(input: &Input<'_>, expected: &str) {
        assert_eq!(check(input).unwrap_err().to_string(), expected);
    }

    #[test]
    fn images_of_another_size_and_normals_alone_are_refused() {
        let pixels = [[0.5; 3]; 6];
        let input = Input {
            size: [3, 2],
            color: &pixels,
            albedo: Some(&pixels),
            normal: Some(&pixels),
        };
        assert!(check(&input).is_ok());
        let color = &pixels[..5];
        check_refused(
            &Input { color, ..input },
            "the colour has 5 pixels, not 3 x 2",
        );
        let short = Some(color);
        check_refused(
            &Input {
                albedo: short,
                ..input
            },
            "the albedo has 5 pixels, not 3 x 2",
        );
        check_refused(
            &Input {
                normal: short,
                ..input
            },
            "the normal has 5 pixels, not 3 x 2",
        );
        let albedo = None;
        check_refused(
            &Input { albedo, ..input },
            "normals can guide only together with albedo",
        );
    }

    #[test]
    fn sizes_that_overflow_are_refused() {
        for size in [[usize::MAX, 2], [1 << 63, 2], [1 << 33, 0]] {
            let input = Input {
                size,
                color: &[],
                albedo: None,
                normal: None,
            };
            assert!(check(&input).is_err(), "{size:?}");
        }
    }

    #[test]
    fn numbers_are_clamped_and_those_that_are_not_finite_become_zero() {
        let pixels = [
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY],
            [-2.0, 0.5, 2.0],
        ];
        assert_eq!(in_range(&pixels, [0.0, 1.0]), [[0.0; 3], [0.0, 0.5, 1.0]]);
        assert_eq!(in_range(&pixels, [-1.0, 1.0]), [[0.0; 3], [-1.0, 0.5, 1.0]]);
    }
}
