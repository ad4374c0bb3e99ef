//! Reads all formats of images except PFM and EXR, by the `image` crate.

use super::{Encoding, Format, ImageData, broken, check_size};
use crate::error::Result;
use crate::limits;
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};
use std::io::Cursor;

pub(super) fn decode(format: Format, bytes: &[u8], encoding: Encoding) -> Result<ImageData> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format.decoder());
    let mut own = Limits::default();
    // This bounds packed chunks beside the pixels, such as colour profiles.
    own.max_alloc = Some(limits::UNPACKED.of(bytes.len() as u64));
    reader.limits(own);
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let channels = decoder.color_type().channel_count();
    check_size([width.into(), height.into()], channels.into(), bytes)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(broken)?;
    let (channels, data) = linear(decoded, encoding);
    // Alpha is kept only for colours, and only in formats that programs for textures write it in.
    let has_alpha = matches!(
        format,
        Format::Png | Format::Qoi | Format::Tiff | Format::WebP
    );
    let kept = match channels {
        2 => 1,
        4 if !has_alpha => 3,
        channels => channels,
    };
    let kept_data = match kept {
        all if all == channels => data,
        kept => {
            let pixels = data.chunks_exact(channels);
            pixels.flat_map(|pixel| &pixel[..kept]).copied().collect()
        }
    };
    Ok(ImageData {
        width: width as usize,
        height: height as usize,
        channels: kept,
        data: kept_data,
    })
}

/// Returns the number of channels and the linear values.
fn linear(decoded: DynamicImage, encoding: Encoding) -> (usize, Vec<f32>) {
    let channels = usize::from(decoded.color().channel_count());
    let bytes = |stored: &[u8]| to_linear(stored, u8::MAX.into(), encoding);
    let words = |stored: &[u16]| to_linear(stored, u16::MAX, encoding);
    let data = match decoded {
        DynamicImage::ImageLuma8(image) => bytes(&image),
        DynamicImage::ImageLumaA8(image) => bytes(&image),
        DynamicImage::ImageRgb8(image) => bytes(&image),
        DynamicImage::ImageRgba8(image) => bytes(&image),
        DynamicImage::ImageLuma16(image) => words(&image),
        DynamicImage::ImageLumaA16(image) => words(&image),
        DynamicImage::ImageRgb16(image) => words(&image),
        DynamicImage::ImageRgba16(image) => words(&image),
        DynamicImage::ImageRgb32F(image) => image.into_raw(),
        // Also kinds that the crate may add.
        other => return (4, other.into_rgba32f().into_raw()),
    };
    (channels, data)
}

fn to_linear<T: Copy + Into<usize>>(stored: &[T], max: u16, encoding: Encoding) -> Vec<f32> {
    let table = encoding.table(max);
    stored.iter().map(|&value| table[value.into()]).collect()
}
