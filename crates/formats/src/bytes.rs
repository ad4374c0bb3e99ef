//! Reads files as unpacked bytes.

use crate::error::{Error, ErrorKind, Result};
use crate::limits;
use flate2::bufread::MultiGzDecoder;
use std::fs::{File, FileType};
use std::io::Read;
use std::path::Path;

/// The name that stands for standard input.
pub(crate) const STDIN: &str = "-";

/// The bytes of a file.
#[derive(Debug)]
pub(crate) struct FileBytes {
    /// The unpacked bytes.
    pub(crate) bytes: Vec<u8>,
    /// The size on the disk, packed. Unit: bytes.
    pub(crate) stored: u64,
}

/// Reads a file as [`read`] does, or standard input for the name [`STDIN`].
///
/// Only for names that the user gives: a name in a file must not wait for typed input.
pub(crate) fn read_or_stdin(path: &Path, limit: u64) -> Result<FileBytes> {
    if path.as_os_str() == STDIN {
        return read_plain(std::io::stdin().lock(), path, limit);
    }
    read(path, limit)
}

/// Reads a whole file of at most `limit` bytes, and unpacks it if its name ends in `.gz`.
///
/// Errors: among others, a device, whose bytes may have no end, and a packed file that unpacks to
/// more than [`limits::UNPACKED`].
pub(crate) fn read(path: &Path, limit: u64) -> Result<FileBytes> {
    let file = File::open(path).map_err(|error| Error::io(path, "open", &error))?;
    let refuse = |what| {
        let message = format!("cannot read `{}`: it is {what}", path.display());
        Error::naming(path, ErrorKind::Io, message)
    };
    if let Ok(metadata) = file.metadata() {
        if metadata.is_dir() {
            return Err(refuse("a folder"));
        }
        if is_device(metadata.file_type()) {
            return Err(refuse("a device"));
        }
    }
    let stored = read_plain(file, path, limit)?;
    if is_packed(path) {
        unpack(&stored.bytes, path, limit)
    } else {
        Ok(stored)
    }
}

/// Unpacks `stored`, the bytes of the file `path`, as [`read`] does.
pub(crate) fn read_stored(stored: &[u8], path: &Path, limit: u64) -> Result<FileBytes> {
    if is_packed(path) {
        unpack(stored, path, limit)
    } else {
        read_plain(stored, path, limit)
    }
}

fn is_packed(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "gz")
}

#[cfg(unix)]
fn is_device(kind: FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_kind: FileType) -> bool {
    false
}

fn read_plain(reader: impl Read, path: &Path, limit: u64) -> Result<FileBytes> {
    let bytes = read_some(reader, path, limit + 1)?;
    let stored = bytes.len() as u64;
    if stored > limit {
        let message = format!("larger than the limit of {limit} bytes");
        return Err(Error::new(ErrorKind::Limit, message).in_file(path));
    }
    Ok(FileBytes { bytes, stored })
}

/// Unpacks at most `limit` bytes, and at most the allowance of the packed bytes.
fn unpack(packed: &[u8], path: &Path, limit: u64) -> Result<FileBytes> {
    let stored = packed.len() as u64;
    let limit = limit.min(limits::UNPACKED.of(stored));
    let bytes = read_some(MultiGzDecoder::new(packed), path, limit + 1)?;
    if bytes.len() as u64 > limit {
        let message = format!("its {stored} bytes unpack to more than {limit}");
        let error = Error::new(ErrorKind::Limit, message).in_file(path);
        return Err(error.with_hint("unpack it, if its size is right"));
    }
    Ok(FileBytes { bytes, stored })
}

/// Reads all bytes, or the first `most`.
fn read_some(reader: impl Read, path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = reader.take(most).read_to_end(&mut bytes);
    read.map_err(|error| Error::io(path, "read", &error))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;

    #[test]
    fn packed_files_are_unpacked_and_limits_apply_to_unpacked_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("zeros.gz");
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&vec![0; 100_000]).unwrap();
        std::fs::write(&path, encoder.finish().unwrap()).unwrap();
        assert_eq!(read(&path, 100_000).unwrap().bytes, vec![0; 100_000]);
        assert_eq!(read(&path, 99_999).unwrap_err().kind(), ErrorKind::Limit);
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused_and_a_hyphen_names_a_file() {
        let kind = |name: &str| read(Path::new(name), 10).unwrap_err().kind();
        assert_eq!(kind("/dev/zero"), ErrorKind::Io);
        assert_eq!(kind(STDIN), ErrorKind::MissingFile);
    }

    #[test]
    fn a_missing_file_has_its_own_kind_of_error() {
        let error = read(Path::new("no/such/file"), 10).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::MissingFile);
        assert_eq!(
            error.to_string(),
            "cannot open `no/such/file`: no such file"
        );
    }
}
