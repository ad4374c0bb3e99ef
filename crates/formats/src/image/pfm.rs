//! Portable float maps.

use super::{ImageData, broken, check_size};
use crate::error::Result;
use std::str::FromStr;

/// Decodes `PF` or `Pf`, width and height, a scale whose sign is the byte order, then rows from the bottom.
pub(super) fn decode(bytes: &[u8]) -> Result<ImageData> {
    let mut rest = bytes;
    let channels = match word(&mut rest) {
        Some("PF") => 3,
        Some("Pf") => 1,
        _ => return Err(broken("it does not begin with PF or Pf")),
    };
    let width: usize = number(&mut rest, "width")?;
    let height: usize = number(&mut rest, "height")?;
    let scale: f32 = number(&mut rest, "scale")?;
    if !scale.is_normal() {
        return Err(broken("no scale"));
    }
    check_size([width as u64, height as u64], channels as u64, bytes)?;
    let row = width * channels;
    let (numbers, _) = rest.as_chunks::<4>();
    if numbers.len() < row * height {
        return Err(broken("it is too short for its size"));
    }
    let read = if scale < 0.0 {
        f32::from_le_bytes
    } else {
        f32::from_be_bytes
    };
    let rows = numbers[..row * height].chunks_exact(row).rev();
    let data = rows
        .flatten()
        .map(|&bytes| read(bytes) * scale.abs())
        .collect();
    Ok(ImageData {
        width,
        height,
        channels,
        data,
    })
}

fn number<T: FromStr>(rest: &mut &[u8], name: &str) -> Result<T> {
    let number = word(rest).and_then(|word| word.parse().ok());
    number.ok_or_else(|| broken(format!("no {name}")))
}

/// Takes the next word and only one byte of white space after it, as binary numbers may follow.
fn word<'b>(rest: &mut &'b [u8]) -> Option<&'b str> {
    let trimmed = rest.trim_ascii_start();
    let end = trimmed.iter().position(u8::is_ascii_whitespace)?;
    *rest = &trimmed[end + 1..];
    std::str::from_utf8(&trimmed[..end]).ok()
}
