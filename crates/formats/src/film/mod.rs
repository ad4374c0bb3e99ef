//! Film files: the exact sums of a render on disk, to continue, merge and develop.
//!
//! A file is one header and the sums of all pixels in row order:
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `BIDIRFLM` |
//! | 4 | version of the format, 3 |
//! | 4 | length of the header |
//! | … | the header, JSON ([`FilmHeader`]) |
//! | 4 | checksum of all bytes before it |
//! | … | blocks of 4096 pixels, the last one shorter: length of the packed bytes, their checksum, the bytes |
//! | 8 | `BIDIREND` |
//!
//! Numbers are little-endian, checksums CRC-32. Sums are 128-bit two's complements, in the order of
//! [`Film::sums`]; their number per pixel follows from the header's layers. A block is packed by planes of
//! bytes: first the lowest byte of the first sum of every pixel, then the second byte, and so on to the
//! highest byte of the last sum. Most planes repeat one byte, and some are so dense that packing would
//! gain little. A packed block is
//!
//! | bytes | what |
//! |---|---|
//! | 2 for each plane | 0 and the repeated byte; 1, 0 for a dense plane; 2, 0 for any other |
//! | 1 for each pixel of each dense plane | the dense planes |
//! | … | the other planes, DEFLATE |
//!
//! Sums are not normalised: equal films have equal files except for the header, and the sums of two files
//! with different passes add up to those of the merged file.

mod block;
mod developed;
mod header;
mod identity;
mod layers;
mod render;
mod settings;
#[cfg(test)]
mod tests;

pub use bidir::driver::Stopping;
pub use developed::Developed;
pub use header::{FilmHeader, scene_name};
pub use identity::{Subject, counts_by_name, metadata, program};
pub use layers::LayerNames;
pub use render::{OpenError, Render, TrainingLimits, Watch};
pub use settings::SettingsText;

use crate::bytes;
use crate::error::{Error, ErrorKind, Result};
use crate::{file, limits};
use bidir::driver::Resources;
use bidir::film::{Film, Layers, MergeError};
use block::Packed;
use rayon::prelude::*;
use std::fs::File;
use std::io::Read;
use std::path::Path;

const MAGIC: &[u8; 8] = b"BIDIRFLM";
const END: &[u8; 8] = b"BIDIREND";
const VERSION: u32 = 3;
/// Maximum size of a film: the memory of a render. Unit: bytes.
const LARGEST_FILM: u64 = Resources::DEFAULT_FILM_MEMORY;
/// Number of blocks that are packed at once, which bounds the additional memory.
const AT_ONCE: usize = 64;
/// Size of the part before the header. Unit: bytes.
const PREAMBLE: usize = 16;

/// A film file in memory.
#[derive(Clone, Debug)]
pub struct FilmFile {
    /// The description of the render.
    pub header: FilmHeader,
    /// The sums, with the header's geometry and passes. Its filter is the default one, so that films can be
    /// added to it, but no samples.
    pub film: Film,
}

impl FilmFile {
    /// Adds a film of the same render with other passes.
    ///
    /// Errors: `other` belongs to another render, or has passes that this film has already.
    pub fn merge(&mut self, other: &Self) -> std::result::Result<(), OpenError> {
        if let Some(difference) = other.header.difference(&self.header) {
            return Err(OpenError::OtherRender(difference));
        }
        self.join(other).map_err(OpenError::Merge)
    }

    /// Adds a film with other passes, also of another render, such as one with another seed. Keeps the identity.
    ///
    /// Errors: `other` shows other pixels or layers, or has passes that this film has already.
    pub fn join(&mut self, other: &Self) -> std::result::Result<(), MergeError> {
        self.film.merge(&other.film)?;
        self.header = self.header.joined(&other.header).of(&self.film);
        Ok(())
    }
}

/// Writes a film file atomically.
///
/// Passes and geometry in `header` are replaced by those of `film`.
///
/// Errors: the file cannot be written.
pub fn write(path: &Path, header: &FilmHeader, film: &Film) -> Result<()> {
    file::replace(path, &encode(header, film)?)
}

/// Writes a film file as [`write()`] does, and renames an existing one to `previous`.
pub fn write_keeping(path: &Path, previous: &Path, header: &FilmHeader, film: &Film) -> Result<()> {
    file::replace_keeping(path, previous, &encode(header, film)?)
}

/// Returns true if a file begins like a film file, even if it is damaged.
pub fn is_film(path: &Path) -> bool {
    let mut first = [0; MAGIC.len()];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut first));
    read.is_ok() && first == *MAGIC
}

/// Reads a film file.
///
/// Errors: the file cannot be read, or is not an intact film file of this version.
pub fn read(path: &Path) -> Result<FilmFile> {
    let bytes = bytes::read_or_stdin(path, limits::LARGEST_FILM)?.bytes;
    decode(&bytes).map_err(|error| error.in_file(path))
}

/// Encodes a film file; see [`write()`].
///
/// Errors: the system does not have the memory.
pub fn encode(header: &FilmHeader, film: &Film) -> Result<Vec<u8>> {
    let json = header.of(film).to_json();
    let numbers = film.layers().sums();
    let mut bytes = Vec::new();
    reserve(&mut bytes, PREAMBLE + json.len() + 7 * film.sums().len())?;
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&(json.len() as u32).to_le_bytes());
    bytes.extend_from_slice(json.as_bytes());
    let checksum = block::checksum(&bytes);
    bytes.extend_from_slice(&checksum.to_le_bytes());
    for sums in film.sums().chunks(block::PIXELS * numbers * AT_ONCE) {
        let pixels = sums.par_chunks(block::PIXELS * numbers);
        let blocks: Vec<_> = pixels.map(|sums| block::write(sums, numbers)).collect();
        for block in blocks {
            reserve(&mut bytes, block.len())?;
            bytes.extend(block);
        }
    }
    reserve(&mut bytes, END.len())?;
    bytes.extend_from_slice(END);
    Ok(bytes)
}

/// Reserves memory for `more` bytes.
fn reserve(bytes: &mut Vec<u8>, more: usize) -> Result<()> {
    bytes.try_reserve(more).map_err(|_| {
        let count = bytes.len().saturating_add(more);
        Error::memory("the film file", count as u64)
    })
}

/// Decodes a film file in memory; see [`read`].
pub fn decode(bytes: &[u8]) -> Result<FilmFile> {
    let mut rest = bytes;
    if take(&mut rest, MAGIC.len())? != MAGIC {
        return Err(broken("not a film file")
            .with_hint("film files are made by `bidir render --checkpoint`"));
    }
    let version = take_u32(&mut rest)?;
    if version != VERSION {
        let message =
            format!("the film has format version {version}; this program reads version {VERSION}");
        return Err(broken(message));
    }
    let length = take_u32(&mut rest)? as usize;
    let json = take(&mut rest, length)?;
    if take_u32(&mut rest)? != block::checksum(&bytes[..PREAMBLE + length]) {
        return Err(broken("damaged: the header's checksum is wrong"));
    }
    let header = FilmHeader::from_json(json)?;
    let (settings, layers) = (header.film_settings(), header.layers()?);
    if Film::memory(&settings, &layers) > LARGEST_FILM {
        let area = settings.crop.area();
        let message = format!("a film of {area} pixels with its layers needs too much memory");
        return Err(Error::new(ErrorKind::Limit, message));
    }
    let sums = take_sums(&mut rest, settings.crop.area(), &layers)?;
    if rest != END {
        return Err(broken("damaged: the end is missing"));
    }
    let film = Film::restore(settings, layers, header.passes.clone(), sums)
        .map_err(|error| broken(error.to_string()))?;
    Ok(FilmFile { header, film })
}

/// Takes the blocks of `area` pixels from `rest`, and unpacks them on all threads.
fn take_sums(rest: &mut &[u8], area: u64, layers: &Layers) -> Result<Vec<i128>> {
    let count = area.div_ceil(block::PIXELS as u64);
    let blocks = (0..count)
        .map(|_| take_block(rest))
        .collect::<Result<Vec<_>>>()?;
    let numbers = layers.sums();
    let length = area as usize * numbers;
    // Memory is reserved only if the file has enough bytes to fill it.
    let least = block::least_bytes(numbers);
    if blocks.iter().any(|packed| packed.bytes.len() < least) {
        return Err(broken("damaged: it is shorter than any film of its size"));
    }
    let mut sums = bidir::film::filled(length, || 0).map_err(|_| {
        let bytes = length.saturating_mul(size_of::<i128>());
        Error::memory("the film", bytes as u64)
    })?;
    let packed = sums.par_chunks_mut(block::PIXELS * numbers).zip(&blocks);
    let read = packed.map(|(sums, packed)| packed.read(numbers, sums));
    let unpacked: Vec<_> = read.collect();
    match unpacked.iter().position(Option::is_none) {
        None => Ok(sums),
        Some(damaged) => Err(broken(format!(
            "damaged: the checksum of the pixels from {} on is wrong",
            damaged * block::PIXELS
        ))),
    }
}

fn take_block<'a>(rest: &mut &'a [u8]) -> Result<Packed<'a>> {
    let packed = take_u32(rest)? as usize;
    Ok(Packed {
        checksum: take_u32(rest)?,
        bytes: take(rest, packed)?,
    })
}

/// Takes the next `count` bytes.
fn take<'a>(rest: &mut &'a [u8], count: usize) -> Result<&'a [u8]> {
    let (bytes, after) = rest
        .split_at_checked(count)
        .ok_or_else(|| broken("damaged: the file ends too early"))?;
    *rest = after;
    Ok(bytes)
}

fn take_u32(rest: &mut &[u8]) -> Result<u32> {
    let bytes = take(rest, 4)?;
    Ok(u32::from_le_bytes(bytes.try_into().expect("four bytes")))
}

fn broken(message: impl Into<String>) -> Error {
    Error::new(ErrorKind::Data, message)
}
