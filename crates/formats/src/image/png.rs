//! Writes PNG images for the screen.

use super::exr::not_written;
use super::transfer::srgb_byte;
use crate::error::Result;
use crate::file;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::path::Path;

/// Writes linear colours, encoded by [`encode_png`].
pub fn write_png(path: &Path, size: [usize; 2], pixels: &[[f32; 3]]) -> Result<()> {
    let size = size.map(|side| side as u32);
    let encoded = encode_png(size, pixels).map_err(|error| error.in_file(path))?;
    file::replace(path, &encoded)
}

/// Encodes linear colours as an eight-bit sRGB PNG; values outside `[0, 1]` are clamped.
///
/// Shape: `size[0] · size[1]` pixels, row by row from the top left.
pub fn encode_png(size: [u32; 2], pixels: &[[f32; 3]]) -> Result<Vec<u8>> {
    if pixels.len() as u64 != u64::from(size[0]) * u64::from(size[1]) {
        return Err(not_written("the number of pixels does not match the size"));
    }
    let stored: Vec<u8> = pixels
        .iter()
        .flatten()
        .map(|&linear| srgb_byte(linear))
        .collect();
    let mut encoded = Vec::new();
    PngEncoder::new(&mut encoded)
        .write_image(&stored, size[0], size[1], ExtendedColorType::Rgb8)
        .map_err(not_written)?;
    Ok(encoded)
}
