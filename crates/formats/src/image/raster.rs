//! Reads images by the `image` crate: all but PFM and EXR.

use super::{Encoding, Format, ImageData, broken, check_size};
use crate::error::Result;
use crate::limits;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

pub(super) fn decode(format: Format, bytes: &[u8], encoding: Encoding) -> Result<ImageData> {
    let known = match format {
        Format::Bmp => ImageFormat::Bmp,
        Format::Gif => ImageFormat::Gif,
        Format::Hdr => ImageFormat::Hdr,
        Format::Png => ImageFormat::Png,
        Format::Qoi => ImageFormat::Qoi,
        Format::Tga => ImageFormat::Tga,
        Format::Tiff => ImageFormat::Tiff,
        Format::WebP => ImageFormat::WebP,
        _ => ImageFormat::Jpeg,
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), known);
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
    let data = if kept == channels {
        data
    } else {
        keep_channels(&data, channels, kept)
    };
    Ok(ImageData {
        width: width as usize,
        height: height as usize,
        channels: kept,
        data,
    })
}

/// Returns the number of channels and the linear values.
fn linear(decoded: DynamicImage, encoding: Encoding) -> (usize, Vec<f32>) {
    let channels = usize::from(decoded.color().channel_count());
    let data = match decoded {
        DynamicImage::ImageLuma8(image) => bytes_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageLumaA8(image) => bytes_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageRgb8(image) => bytes_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageRgba8(image) => bytes_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageLuma16(image) => words_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageLumaA16(image) => words_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageRgb16(image) => words_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageRgba16(image) => words_to_linear(&image.into_raw(), encoding),
        DynamicImage::ImageRgb32F(image) => image.into_raw(),
        // Also kinds that the crate may add.
        other => return (4, other.into_rgba32f().into_raw()),
    };
    (channels, data)
}

fn bytes_to_linear(stored: &[u8], encoding: Encoding) -> Vec<f32> {
    let table = encoding.table(u8::MAX.into());
    stored
        .iter()
        .map(|&byte| table[usize::from(byte)])
        .collect()
}

fn words_to_linear(stored: &[u16], encoding: Encoding) -> Vec<f32> {
    let table = encoding.table(u16::MAX);
    stored
        .iter()
        .map(|&word| table[usize::from(word)])
        .collect()
}

fn keep_channels(data: &[f32], channels: usize, kept: usize) -> Vec<f32> {
    data.chunks_exact(channels)
        .flat_map(|pixel| &pixel[..kept])
        .copied()
        .collect()
}
