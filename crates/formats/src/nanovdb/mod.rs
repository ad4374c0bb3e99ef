//! Grids of numbers from NanoVDB files \[Museth21\]: sparse trees of boxes of cells.
//!
//! A file has segments: a header, for each grid a description and its name, and then the grids, plain or deflated.
//! Numbers are little-endian. The bytes are untrusted: every access is checked. The caller counts the cells of a
//! box before it asks for their values.

mod tree;

#[cfg(test)]
pub(crate) mod tests;

use crate::error::{Error, ErrorKind, Result};
use crate::limits;
use flate2::read::ZlibDecoder;
use glam::{DAffine3, DMat3, DVec3};
use std::borrow::Cow;
use std::io::Read;

/// The first bytes of a segment, from older and newer writers.
const MAGIC: [&[u8; 8]; 2] = [b"NanoVDB0", b"NanoVDB2"];
/// The major version whose layout is read.
const MAJOR: u32 = 32;
const HEADER: usize = 16;
const DESCRIPTION: usize = 176;
/// Size of the part of a grid before its tree. Unit: bytes.
const GRID: usize = 672;

/// A box of cells, by the indices of the first and the last cell along each axis, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellBox {
    pub(crate) first: [i32; 3],
    pub(crate) last: [i32; 3],
}

/// A grid of a file.
#[derive(Debug)]
pub(crate) struct Grid {
    bytes: Vec<u8>,
    /// The bounding box of the active cells.
    pub(crate) bounds: CellBox,
    /// The map from cell indices to the file's world space.
    pub(crate) world_from_cells: DAffine3,
}

/// The outcome of a search for a grid.
#[derive(Debug)]
pub(crate) enum Found {
    /// The grid.
    Grid(Grid),
    /// The file has no grid of this name.
    Nothing,
    /// The grid is of a kind that cannot be read, described by a phrase.
    Unsupported(String),
}

/// The bytes of a file, with checked access by offset.
#[derive(Clone, Copy)]
struct Bytes<'b>(&'b [u8]);

/// The description of a grid in a segment.
struct Described<'f> {
    size: u64,
    stored: u64,
    kind: u32,
    class: u32,
    codec: u16,
    name: &'f [u8],
}

impl CellBox {
    /// Returns the number of cells along each axis.
    pub(crate) fn size(&self) -> [u64; 3] {
        std::array::from_fn(|i| (i64::from(self.last[i]) - i64::from(self.first[i]) + 1) as u64)
    }

    /// Returns the number of all cells, at most `u64::MAX`.
    pub(crate) fn count(&self) -> u64 {
        let size = self.size().into_iter();
        size.fold(1, u64::saturating_mul)
    }

    /// Returns the box with one more cell on each side.
    pub(crate) fn grown(&self) -> Self {
        Self {
            first: self.first.map(|n| n.saturating_sub(1)),
            last: self.last.map(|n| n.saturating_add(1)),
        }
    }
}

/// Finds the grid of this name, which has to consist of 32-bit floats.
pub(crate) fn find(file: &[u8], name: &str) -> Result<Found> {
    let bytes = Bytes(file);
    let mut at = 0;
    while at < file.len() {
        let magic = bytes.at::<8>(at)?;
        if !MAGIC.iter().any(|known| **known == magic) {
            return Err(broken("the file is not NanoVDB, or has no header"));
        }
        let version = bytes.u32(at + 8)?;
        if version >> 21 != MAJOR {
            let (major, minor) = (version >> 21, version >> 10 & 0x7ff);
            return Ok(Found::Unsupported(format!("NanoVDB {major}.{minor}")));
        }
        let (count, mut next) = (bytes.u16(at + 12)?, at + HEADER);
        let mut all = Vec::new();
        for _ in 0..count {
            let described = bytes.described(next)?;
            next += DESCRIPTION + described.name.len();
            all.push(described);
        }
        for described in all {
            let stored = usize::try_from(described.stored).ok();
            let end = stored.and_then(|stored| next.checked_add(stored));
            let part = end.and_then(|end| file.get(next..end)).ok_or_else(short)?;
            if text(described.name) == name {
                return grid(&described, part);
            }
            next += part.len();
        }
        at = next;
    }
    Ok(Found::Nothing)
}

/// Returns the part of a name before its first zero byte.
fn text(bytes: &[u8]) -> Cow<'_, str> {
    let end = bytes.iter().position(|&byte| byte == 0);
    String::from_utf8_lossy(&bytes[..end.unwrap_or(bytes.len())])
}

/// Opens the grid whose stored bytes are `part`.
fn grid(described: &Described<'_>, part: &[u8]) -> Result<Found> {
    const FLOATS: u32 = 1;
    const UNKNOWN: u32 = 0;
    const FOG: u32 = 2;
    let unsupported = |what: &str| {
        let name = text(described.name);
        Ok(Found::Unsupported(format!("the grid `{name}` of {what}")))
    };
    if described.kind != FLOATS {
        return unsupported("other cells than 32-bit numbers");
    }
    if ![UNKNOWN, FOG].contains(&described.class) {
        return unsupported("a surface, or of anything else but fog");
    }
    let Some(bytes) = unpack(described, part)? else {
        return unsupported("another codec than zip");
    };
    let view = Bytes(&bytes);
    let place = |at: usize, i: usize| view.f64(at + 8 * i);
    // Rows in the file.
    let mut rows = [0.0; 9];
    for (i, number) in rows.iter_mut().enumerate() {
        *number = place(384, i)?;
    }
    let translation = DVec3::new(place(528, 0)?, place(528, 1)?, place(528, 2)?);
    let matrix = DMat3::from_cols_array(&rows).transpose();
    let bounds = tree::bounds(view)?;
    Ok(Found::Grid(Grid {
        bounds,
        world_from_cells: DAffine3::from_mat3_translation(matrix, translation),
        bytes,
    }))
}

/// Returns the bytes of a grid, which are stored plain or deflated. None: another codec packed them.
fn unpack(described: &Described<'_>, part: &[u8]) -> Result<Option<Vec<u8>>> {
    const PLAIN: u16 = 0;
    const DEFLATED: u16 = 1;
    match described.codec {
        PLAIN => Ok(Some(part.to_vec())),
        DEFLATED => {
            let packed = part.get(8..).ok_or_else(short)?;
            let limit = limits::UNPACKED.of(part.len() as u64).min(described.size);
            let mut bytes = Vec::new();
            let read = ZlibDecoder::new(packed).take(limit).read_to_end(&mut bytes);
            read.map_err(|error| broken(&format!("a grid cannot be unpacked: {error}")))?;
            if (bytes.len() as u64) < described.size {
                let message = format!("a grid unpacks to less, or more than {limit} bytes");
                return Err(Error::new(ErrorKind::Limit, message));
            }
            Ok(Some(bytes))
        }
        _ => Ok(None),
    }
}

impl Grid {
    /// Returns the values of the cells of a box, x fastest, or the background where the file has none. The caller has
    /// to count the cells before.
    pub(crate) fn values(&self, within: CellBox) -> Result<Vec<f32>> {
        tree::values(Bytes(&self.bytes), within)
    }
}

impl<'b> Bytes<'b> {
    fn slice(self, at: usize, count: usize) -> Result<&'b [u8]> {
        let end = at.checked_add(count);
        end.and_then(|end| self.0.get(at..end)).ok_or_else(short)
    }

    fn at<const N: usize>(self, at: usize) -> Result<[u8; N]> {
        let bytes = self.slice(at, N)?;
        bytes.try_into().map_err(|_| short())
    }

    fn u16(self, at: usize) -> Result<u16> {
        self.at(at).map(u16::from_le_bytes)
    }

    fn u32(self, at: usize) -> Result<u32> {
        self.at(at).map(u32::from_le_bytes)
    }

    fn u64(self, at: usize) -> Result<u64> {
        self.at(at).map(u64::from_le_bytes)
    }

    fn f32(self, at: usize) -> Result<f32> {
        self.at(at).map(f32::from_le_bytes)
    }

    fn f64(self, at: usize) -> Result<f64> {
        self.at(at).map(f64::from_le_bytes)
    }

    /// Returns the three indices of a cell, which are stored at the offset `at`.
    fn cell(self, at: usize) -> Result<[i32; 3]> {
        let number = |i: usize| self.at(at + 4 * i).map(i32::from_le_bytes);
        Ok([number(0)?, number(1)?, number(2)?])
    }

    /// Returns the offset that is stored at `at`, relative to `origin`, as an offset in the file.
    fn place(self, origin: usize, at: usize) -> Result<usize> {
        let offset = usize::try_from(i64::from_le_bytes(self.at(at)?)).ok();
        let place = offset.and_then(|offset| origin.checked_add(offset));
        place
            .filter(|&place| place < self.0.len())
            .ok_or_else(short)
    }

    fn described(self, at: usize) -> Result<Described<'b>> {
        let length = self.u32(at + 136)? as usize;
        Ok(Described {
            size: self.u64(at)?,
            stored: self.u64(at + 8)?,
            kind: self.u32(at + 32)?,
            class: self.u32(at + 36)?,
            codec: self.u16(at + 168)?,
            name: self.slice(at + DESCRIPTION, length)?,
        })
    }
}

fn broken(message: &str) -> Error {
    Error::new(ErrorKind::Data, message)
}

fn short() -> Error {
    broken("the file ends within a grid, or a place in it lies outside")
}
