//! Blocks of pixels: sums as planes of bytes, packed.

use flate2::{Compression, Crc, read::DeflateDecoder, write::DeflateEncoder};
use std::io::{Read, Write};
use std::iter;

/// Pixels of a block.
pub(super) const PIXELS: usize = 4096;
/// Bytes of a sum.
const BYTES: usize = size_of::<i128>();
/// About how many bytes of a plane are looked at to see how it packs.
const PROBED: usize = 256;

/// CRC-32.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// How a plane is packed. Each has two bytes at the beginning of its block: this, and a byte.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Kind {
    /// All of it is the byte.
    Uniform = 0,
    /// Its bytes follow, after those of such planes before it: packing would gain little.
    Plain = 1,
    /// It is in the stream of DEFLATE at the end, after such planes before it.
    Deflated = 2,
}

/// A block of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packed<'a> {
    /// Of the packed bytes.
    pub(super) checksum: u32,
    /// The planes.
    pub(super) bytes: &'a [u8],
}

/// The fewest bytes of a packed block of pixels with `numbers` sums each.
pub(super) fn least_bytes(numbers: usize) -> usize {
    numbers * BYTES * 2
}

/// The bytes of a block of pixels with `numbers` sums each: the length and the checksum of what is
/// packed, and that.
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
    let deflated = deflated.finish().expect("memory takes all");
    let packed = [kinds, plain, deflated].concat();
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
        let bytes_of = |wanted| kinds.iter().filter(|(kind, _)| *kind == wanted).count() * pixels;
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

/// The bytes of a pixel's sum `k`, and the bits that are not the same in all pixels'.
fn uniform_bits(sums: &[i128], numbers: usize, k: usize) -> ([u8; BYTES], [u8; BYTES]) {
    let first = sums[k];
    let of_number = sums[k..].iter().step_by(numbers);
    let varying = of_number.fold(0, |varying, sum| varying | (sum ^ first));
    (first.to_le_bytes(), varying.to_le_bytes())
}

/// Byte `b` of sum `k` of every pixel.
fn plane(sums: &[i128], numbers: usize, k: usize, b: usize) -> impl Iterator<Item = u8> {
    let of_number = sums[k..].iter().step_by(numbers);
    of_number.map(move |sum| (sum >> (8 * b)) as u8)
}

/// Sets byte `b` of sum `k` of every pixel, which is 0 so far.
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

/// True where packing would gain little for its time.
///
/// Of bytes with the frequencies pᵢ two are equal with the probability Σᵢ pᵢ², which is 1 ∕ 256 where
/// all are as likely. With 32 times that they have 3 bits of 8 at least (Rényi's entropy is no more
/// than Shannon's), but few runs, which is what fast DEFLATE finds: films are 1 % larger for this limit
/// than without, and packed in half of the time. Of n bytes with the counts cᵢ,
/// Σᵢ cᵢ (cᵢ − 1) ∕ (n (n − 1)) estimates the sum.
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

/// What `bytes` inflate to. None: not to so many bytes.
fn inflated(bytes: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut inflated = Vec::new();
    let most = length as u64 + 1;
    let read = DeflateDecoder::new(bytes)
        .take(most)
        .read_to_end(&mut inflated);
    (read.ok()? == length).then_some(inflated)
}
