//! Blocks of pixels: sums as planes of bytes, packed.

use flate2::{Compression, Crc, read::DeflateDecoder, write::DeflateEncoder};
use std::io::{Read, Write};

/// Pixels of a block.
pub(super) const PIXELS: usize = 4096;
/// How many bytes a byte of DEFLATE stands for at most: two bits can copy 258.
pub(super) const MOST_EXPANSION: usize = 1032;
/// Bytes of a sum.
const BYTES: usize = size_of::<i128>();
/// Pixels that are transposed at a time: in the nearest cache, with rows of whole cache lines.
const TILE: usize = 64;

/// CRC-32.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// A block of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packed<'a> {
    /// Of what is unpacked.
    pub(super) checksum: u32,
    /// The planes, deflated.
    pub(super) bytes: &'a [u8],
}

/// The bytes of a block of pixels with `numbers` sums each.
pub(super) fn write(sums: &[i128], numbers: usize) -> Vec<u8> {
    let planes = to_planes(sums, numbers);
    let mut encoder = DeflateEncoder::new(vec![0; 8], Compression::fast());
    let packed = encoder.write_all(&planes).and_then(|()| encoder.finish());
    let mut block = packed.expect("writing to memory cannot fail");
    let length = block.len() as u32 - 8;
    block[..4].copy_from_slice(&length.to_le_bytes());
    block[4..8].copy_from_slice(&checksum(&planes).to_le_bytes());
    block
}

impl Packed<'_> {
    /// Unpacks the `sums` of a block, `numbers` for each pixel. None: it is damaged.
    pub(super) fn read(&self, numbers: usize, sums: &mut [i128]) -> Option<()> {
        let mut planes = Vec::new();
        let length = size_of_val(sums);
        let unpacked = DeflateDecoder::new(self.bytes)
            .take(length as u64 + 1)
            .read_to_end(&mut planes);
        let fine = unpacked.ok()? == length && checksum(&planes) == self.checksum;
        fine.then(|| from_planes(&planes, numbers, sums))
    }
}

/// Byte b of sum k of every pixel is in plane k · [`BYTES`] + b.
fn to_planes(sums: &[i128], numbers: usize) -> Vec<u8> {
    let pixels = sums.len() / numbers;
    let mut planes = vec![0; sums.len() * BYTES];
    for (k, planes) in planes.chunks_exact_mut(pixels * BYTES).enumerate() {
        for first in (0..pixels).step_by(TILE) {
            let end = pixels.min(first + TILE);
            let mut tile = [[0; BYTES]; TILE];
            for (bytes, pixel) in tile.iter_mut().zip(first..end) {
                *bytes = sums[pixel * numbers + k].to_le_bytes();
            }
            for (b, plane) in planes.chunks_exact_mut(pixels).enumerate() {
                for (byte, bytes) in plane[first..end].iter_mut().zip(&tile) {
                    *byte = bytes[b];
                }
            }
        }
    }
    planes
}

/// The inverse of [`to_planes`].
fn from_planes(planes: &[u8], numbers: usize, sums: &mut [i128]) {
    let pixels = sums.len() / numbers;
    for (k, planes) in planes.chunks_exact(pixels * BYTES).enumerate() {
        for first in (0..pixels).step_by(TILE) {
            let end = pixels.min(first + TILE);
            let mut tile = [[0; BYTES]; TILE];
            for (b, plane) in planes.chunks_exact(pixels).enumerate() {
                for (bytes, &byte) in tile.iter_mut().zip(&plane[first..end]) {
                    bytes[b] = byte;
                }
            }
            for (&bytes, pixel) in tile.iter().zip(first..end) {
                sums[pixel * numbers + k] = i128::from_le_bytes(bytes);
            }
        }
    }
}
