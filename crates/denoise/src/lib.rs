//! Denoises pictures by Open Image Denoise 2, which is looked for when it is needed.
//!
//! The library of C is no part of the build: a machine without it builds and runs everything else,
//! and [`Denoiser::load`] fails there with the names that were tried and with what to do about it.
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
//! # What is done
//!
//! The filter `RT` with `hdr` removes the noise of the picture. Guides, which are the albedo and the
//! normal of what each pixel sees, tell it what is texture or edge, and what is noise. Guides of a
//! render are noisy themselves, through depth of field, motion or the pixel filter; so each is
//! denoised by itself first, and the filter is told that its guides are clean (`cleanAux`), as is
//! recommended for final frames [Afra25, documentation, RT filter].
//!
//! # What is promised
//!
//! - A library of another major version is refused: its functions may have other arguments.
//! - What is no number of a picture is brought into range before the filter sees it, see [`Input`].
//! - The processor does it, with at most as many threads as are asked for.
//!
//! Not here: the choice of noise that is left, pictures of several layers, graphics processors.

mod device;
mod error;
mod ffi;
mod find;

pub use error::DenoiseError;
pub use find::{VARIABLE, names};

use device::{Device, Image};
use std::path::Path;

/// A picture with noise, and what guides the filter.
///
/// Numbers that are not finite are taken as 0, as no number tells how bright they are; others are
/// brought into range: the colour to what is not negative, albedo to `[0, 1]`, normals to `[-1, 1]`.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Width and height. Unit: pixels.
    pub size: [usize; 2],
    /// Linear light, red, green and blue. Shape: `size[0] · size[1]`, row by row.
    pub color: &'a [[f32; 3]],
    /// The share of light that the surface of each pixel reflects. Shape: that of `color`.
    pub albedo: Option<&'a [[f32; 3]]>,
    /// The normal of that surface, in any frame. Shape: that of `color`. The filter takes it only
    /// together with `albedo`.
    pub normal: Option<&'a [[f32; 3]]>,
}

/// Open Image Denoise, ready to be used.
#[derive(Debug)]
pub struct Denoiser {
    device: Device,
}

impl Denoiser {
    /// Loads the library that [`VARIABLE`] names, or one that the system finds by [`names`].
    ///
    /// `threads` is the most that it takes; 0 leaves that to the library. Once loaded, the library
    /// stays until the process ends.
    ///
    /// Errors: there is none; the one that was found or named is no such library, or of another
    /// version; it does not run on this processor. A variable that is set is never passed over.
    pub fn load(threads: usize) -> Result<Self, DenoiseError> {
        let named = std::env::var_os(VARIABLE).filter(|value| !value.is_empty());
        Self::load_named(named.as_deref().map(Path::new), threads)
    }

    /// The same as [`load`](Self::load), with a file or folder in place of the variable.
    pub fn load_named(named: Option<&Path>, threads: usize) -> Result<Self, DenoiseError> {
        let found = find::find(named)?;
        let device = Device::new(&found, threads)?;
        Ok(Self { device })
    }

    /// The library's version, such as `2.3.1`.
    pub fn version(&self) -> String {
        self.device.version().map(|part| part.to_string()).join(".")
    }

    /// The picture without its noise. Shape: that of the input's colour.
    ///
    /// Errors: an image has another size than it should; normals without albedo; the library's own.
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

/// Fails where an image does not fit to the size, or the guides do not fit together.
fn check(input: &Input<'_>) -> Result<(), DenoiseError> {
    let [width, height] = input.size;
    // The library stores sides in 32 bits with a sign.
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

/// A copy with every number in `[low, high]`, and 0 for what is not finite.
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
    fn sizes_that_wrap_around_are_refused() {
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
    fn numbers_are_brought_into_range() {
        let pixels = [
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY],
            [-2.0, 0.5, 2.0],
        ];
        assert_eq!(in_range(&pixels, [0.0, 1.0]), [[0.0; 3], [0.0, 0.5, 1.0]]);
        assert_eq!(in_range(&pixels, [-1.0, 1.0]), [[0.0; 3], [-1.0, 0.5, 1.0]]);
    }
}
