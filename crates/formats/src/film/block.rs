//! Blocks of pixels, packed by planes: plane b of sum k holds byte b of sum k of every pixel.

use flate2::{Compression, Crc, read::DeflateDecoder, write::DeflateEncoder};
use std::io::{Read, Write};
use std::iter;

/// Number of pixels of a block.
pub(super) const PIXELS: usize = 4096;
/// Size of a sum. Unit: bytes.
const BYTES: usize = size_of::<i128>();
/// Approximate number of bytes that are sampled from a plane to decide how to pack it.
const PROBED: usize = 256;

/// Computes the CRC-32 of `bytes`.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// The packing of a plane. Each plane has two bytes at the beginning of its block: its kind, and a value.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Kind {
    /// All bytes of the plane are the value.
    Uniform = 0,
    /// The bytes are stored as they are, after those of earlier plain planes, as packing would gain little.
    Plain = 1,
    /// The bytes are in the DEFLATE stream at the end, after those of earlier such planes.
    Deflated = 2,
}

/// A block of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packed<'a> {
    /// The checksum of the packed bytes.
    pub(super) checksum: u32,
    /// The packed planes.
    pub(super) bytes: &'a [u8],
}

/// Returns the minimum size of a packed block of pixels with `numbers` sums each. Unit: bytes.
pub(super) fn least_bytes(numbers: usize) -> usize {
    numbers * BYTES * 2
}

/// Packs a block of pixels with `numbers` sums each. Returns the length of the packed bytes, their checksum,
/// and the bytes.
pub(super) fn write(sums: &[i128], numbers: usize) -> Vec<u8> {
    let (mut kinds, mut plain) = (Vec::with_capacity(least_bytes(numbers)), Vec::new());
    let mut deflated = DeflateEncoder::new(Vec::new(), Compression::fast());
    for k in 0..numbers {
        let (first, varying) = uniform_bits(sums, numbers, k);
        for (b, (byte, bits)) in first.into_iter().zip(varying).enumerate() {
            if bits == 0 {
                kinds.extend([Kind::Uniform as u8, byte]);
                continue;
            }
            let plane: Vec<u8> = plane(sums, numbers, k, b).collect();
            if is_dense(&plane) {
                kinds.extend([Kind::Plain as u8, 0]);
                plain.extend(plane);
            } else {
                kinds.extend([Kind::Deflated as u8, 0]);
                deflated.write_all(&plane).expect("memory takes all");
            }
        }
    }
    let stream = deflated.finish().expect("memory takes all");
    let packed = [kinds, plain, stream].concat();
    let length = (packed.len() as u32).to_le_bytes();
    [&length[..], &checksum(&packed).to_le_bytes(), &packed].concat()
}

impl Packed<'_> {
    /// Unpacks the `sums` of a block, `numbers` for each pixel. None: it is damaged.
    pub(super) fn read(&self, numbers: usize, sums: &mut [i128]) -> Option<()> {
        if checksum(self.bytes) != self.checksum {
            return None;
        }
        let pixels = sums.len() / numbers;
        let (kinds, planes) = self.bytes.split_at_checked(least_bytes(numbers))?;
        let kinds: Vec<(Kind, u8)> = kinds.chunks(2).map(kind).collect::<Option<_>>()?;
        let bytes_of = |of| kinds.iter().filter(|(kind, _)| *kind == of).count() * pixels;
        let (plain, deflated) = planes.split_at_checked(bytes_of(Kind::Plain))?;
        let deflated = inflated(deflated, bytes_of(Kind::Deflated))?;
        let (mut plain, mut deflated) = (plain.chunks(pixels), deflated.chunks(pixels));
        sums.fill(0);
        for (plane, &(kind, byte)) in kinds.iter().enumerate() {
            let (k, b) = (plane / BYTES, plane % BYTES);
            match kind {
                Kind::Uniform if byte == 0 => (),
                Kind::Uniform => set_plane(sums, numbers, k, b, iter::repeat(&byte)),
                Kind::Plain => set_plane(sums, numbers, k, b, plain.next()?),
                Kind::Deflated => set_plane(sums, numbers, k, b, deflated.next()?),
            }
        }
        Some(())
    }
}

/// Returns the bytes of the first pixel's sum `k`, and a mask of the bits that differ between pixels.
fn uniform_bits(sums: &[i128], numbers: usize, k: usize) -> ([u8; BYTES], [u8; BYTES]) {
    let first = sums[k];
    let of_number = sums[k..].iter().step_by(numbers);
    let varying = of_number.fold(0, |varying, sum| varying | (sum ^ first));
    (first.to_le_bytes(), varying.to_le_bytes())
}

/// Returns byte `b` of sum `k` of every pixel.
fn plane(sums: &[i128], numbers: usize, k: usize, b: usize) -> impl Iterator<Item = u8> {
    let of_number = sums[k..].iter().step_by(numbers);
    of_number.map(move |sum| (sum >> (8 * b)) as u8)
}

/// Sets byte `b` of sum `k` of every pixel to a byte of `bytes`. The bytes in `sums` have to be 0.
fn set_plane<'a>(
    sums: &mut [i128],
    numbers: usize,
    k: usize,
    b: usize,
    bytes: impl IntoIterator<Item = &'a u8>,
) {
    let of_number = sums[k..].iter_mut().step_by(numbers);
    for (sum, &byte) in of_number.zip(bytes) {
        *sum |= i128::from(byte) << (8 * b);
    }
}

/// Returns true if packing would gain little for its time.
///
/// Two bytes with the frequencies pᵢ are equal with probability Σᵢ pᵢ², which is 1 ∕ 256 for a uniform
/// distribution. At the limit, 32 times that, bytes have at least 3 bits of entropy (Rényi's entropy is
/// at most Shannon's), but few runs, which fast DEFLATE finds: the limit makes films 1 % larger, and
/// halves the time of packing. For n bytes with the counts cᵢ, Σᵢ cᵢ (cᵢ − 1) ∕ (n (n − 1)) estimates the
/// sum.
fn is_dense(plane: &[u8]) -> bool {
    let mut counts = [0_usize; 256];
    let probed = plane.iter().step_by(plane.len().div_ceil(PROBED));
    for &byte in probed.clone() {
        counts[usize::from(byte)] += 1;
    }
    let n = probed.len();
    let equal: usize = counts.iter().map(|c| c * c.saturating_sub(1)).sum();
    256 * equal < 32 * n * (n - 1)
}

fn kind(bytes: &[u8]) -> Option<(Kind, u8)> {
    let kind = match bytes[0] {
        0 => Kind::Uniform,
        1 => Kind::Plain,
        2 => Kind::Deflated,
        _ => return None,
    };
    Some((kind, bytes[1]))
}

/// Inflates `bytes`. None: they do not inflate to `length` bytes.
fn inflated(bytes: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut inflated = Vec::new();
    let most = length as u64 + 1;
    let read = DeflateDecoder::new(bytes)
        .take(most)
        .read_to_end(&mut inflated);
    (read.ok()? == length).then_some(inflated)
}
