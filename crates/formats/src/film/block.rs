//! Blocks of pixels: sums as planes of bytes, packed.

use bidir::film::PixelSums;
use flate2::{Compression, Crc, read::DeflateDecoder, write::DeflateEncoder};
use std::io::{Read, Write};

/// Pixels of a block.
pub(super) const PIXELS: usize = 4096;
/// Bytes of a pixel.
const BYTES: usize = PixelSums::NUMBERS * 16;

/// CRC-32.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// Appends a block.
pub(super) fn write(pixels: &[PixelSums], bytes: &mut Vec<u8>) {
    let planes = to_planes(pixels);
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
    let packed = encoder.write_all(&planes).and_then(|()| encoder.finish());
    let packed = packed.expect("writing to memory cannot fail");
    bytes.extend_from_slice(&(packed.len() as u32).to_le_bytes());
    bytes.extend_from_slice(&checksum(&planes).to_le_bytes());
    bytes.extend_from_slice(&packed);
}

/// Appends the `count` pixels of a block. None: it is damaged.
pub(super) fn read(
    packed: &[u8],
    expected: u32,
    count: usize,
    pixels: &mut Vec<PixelSums>,
) -> Option<()> {
    let mut planes = Vec::new();
    let length = count * BYTES;
    let unpacked = DeflateDecoder::new(packed)
        .take(length as u64 + 1)
        .read_to_end(&mut planes);
    let fine = unpacked.ok()? == length && checksum(&planes) == expected;
    fine.then(|| pixels.extend((0..count).map(|i| from_planes(&planes, count, i))))
}

/// Byte k of all pixels stands together.
fn to_planes(pixels: &[PixelSums]) -> Vec<u8> {
    let mut planes = vec![0; pixels.len() * BYTES];
    for (i, pixel) in pixels.iter().enumerate() {
        let bytes = pixel.to_array().into_iter().flat_map(i128::to_le_bytes);
        for (k, byte) in bytes.enumerate() {
            planes[k * pixels.len() + i] = byte;
        }
    }
    planes
}

/// Pixel `i` of `count`.
fn from_planes(planes: &[u8], count: usize, i: usize) -> PixelSums {
    let number = |n: usize| {
        let byte = |k: usize| planes[(n * 16 + k) * count + i];
        i128::from_le_bytes(std::array::from_fn(byte))
    };
    PixelSums::from_array(std::array::from_fn(number))
}
