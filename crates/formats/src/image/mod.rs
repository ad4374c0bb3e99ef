//! Images: reads them as linear numbers in every [`Format`], and writes EXR and PNG.
//!
//! The first bytes of a file decide its format, or if they are not a known mark, the ending of its name.
//!
//! Rows go from top to bottom, whatever the file's order. Eight-bit files are converted from sRGB to
//! linear. For PNG, the caller (such as a scene file) can name another encoding; the header of a QOI says
//! whether it is linear. EXR, HDR and PFM are linear.
//!
//! Decoders of other crates may panic on some bytes; such a panic becomes an [`Error`], and prints nothing.

mod catch;
mod exr;
mod format;
mod layers;
mod pfm;
mod png;
mod raster;
mod transfer;

pub use exr::{ExrImage, ExrLayer, MetadataValue, encode_exr, write_exr};
pub(crate) use format::other_format;
pub use format::{Format, no_output};
pub use layers::{Layers, decode_layers, read_layers, write_layers};
pub use png::{encode_png, write_png};
pub use transfer::Encoding;

use crate::bytes;
use crate::error::{Error, ErrorKind, Result};
use crate::limits;
use catch::catch_silently;
use std::path::Path;

/// An image of linear numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageData {
    /// Number of pixels per row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Number of channels. 1: grey; 3: red, green, blue; 4: these and alpha.
    pub channels: usize,
    /// The numbers row by row from the top left. Shape: `width · height · channels`.
    pub data: Vec<f32>,
}

impl ImageData {
    /// Returns the colours: grey is repeated, alpha is omitted. Shape: `width · height`.
    pub fn rgb(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.data
            .chunks_exact(self.channels.max(1))
            .map(|pixel| match *pixel {
                [r, g, b, ..] => [r, g, b],
                [grey, ..] => [grey; 3],
                [] => [0.0; 3],
            })
    }
}

/// Reads an image. `encoding` applies only to PNG. None: sRGB.
pub fn read(path: &Path, encoding: Option<Encoding>) -> Result<ImageData> {
    let bytes = bytes::read(path, limits::LARGEST_IMAGE)?.bytes;
    decode_file(path, &bytes, encoding)
}

/// Decodes the bytes of an image file; see [`read`].
pub(crate) fn decode_file(
    path: &Path,
    bytes: &[u8],
    encoding: Option<Encoding>,
) -> Result<ImageData> {
    let decoded = Format::of_file(bytes, path).and_then(|format| decode(format, bytes, encoding));
    decoded.map_err(|error| error.in_file(path))
}

/// Decodes an image in memory; see [`read`].
pub fn decode(format: Format, bytes: &[u8], encoding: Option<Encoding>) -> Result<ImageData> {
    let encoding = match format {
        Format::Png => encoding.unwrap_or_default(),
        Format::Hdr => Encoding::Linear,
        Format::Qoi if format::is_linear_qoi(bytes) => Encoding::Linear,
        _ => Encoding::Srgb,
    };
    decode_stored(format, bytes, encoding)
}

/// Decodes an image in memory whose numbers are stored in `encoding`; EXR and PFM are always linear.
pub(crate) fn decode_stored(format: Format, bytes: &[u8], encoding: Encoding) -> Result<ImageData> {
    let decode = || match format {
        Format::Exr => exr::decode(bytes),
        Format::Pfm => pfm::decode(bytes),
        _ => raster::decode(format, bytes, encoding),
    };
    catch_silently(decode).unwrap_or_else(|_| Err(broken("the decoder failed")))
}

fn broken(message: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Data, format!("broken image: {message}"))
}

/// Returns the number of values that count against limits for an image: grey counts as three channels.
pub(crate) fn numbers([width, height]: [u64; 2], channels: u64) -> u64 {
    width.saturating_mul(height).saturating_mul(channels.max(3))
}

/// Refuses a size that is zero or too large for the bytes of the file, before memory is reserved.
fn check_size([width, height]: [u64; 2], channels: u64, bytes: &[u8]) -> Result<()> {
    let numbers = numbers([width, height], channels);
    if numbers == 0 {
        return Err(broken("it has no pixels"));
    }
    let refuse = |message: String| Error::new(ErrorKind::Limit, message);
    let size = format!("an image of {width} × {height} pixels");
    if numbers > limits::MOST_NUMBERS {
        return Err(refuse(format!("{size} is too large")));
    }
    let (stored, per_byte) = (bytes.len() as u64, limits::IMAGE.per_byte);
    if numbers > limits::IMAGE.of(stored) {
        let error = refuse(format!("{size} is too large for a file of {stored} bytes"));
        return Err(error.with_hint(format!(
            "the file is cut, or has fewer than one byte for {per_byte} numbers"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
