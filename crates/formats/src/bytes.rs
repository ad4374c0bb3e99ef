//! Files as bytes: unpacked on the way in, replaced as a whole on the way out.

use crate::error::{Error, ErrorKind, Result};
use flate2::bufread::MultiGzDecoder;
use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

/// The name that stands for standard input.
pub(crate) const STDIN: &str = "-";

/// Reads a whole file of at most `limit` bytes, unpacked where its name ends in `.gz`.
pub(crate) fn read(path: &Path, limit: u64) -> Result<Vec<u8>> {
    if path.as_os_str() == STDIN {
        return read_to_limit(std::io::stdin().lock(), path, limit);
    }
    let file = File::open(path).map_err(|error| Error::io(path, "open", &error))?;
    if path.extension().is_some_and(|extension| extension == "gz") {
        read_to_limit(MultiGzDecoder::new(BufReader::new(file)), path, limit)
    } else {
        read_to_limit(file, path, limit)
    }
}

fn read_to_limit(reader: impl Read, path: &Path, limit: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = reader.take(limit + 1).read_to_end(&mut bytes);
    read.map_err(|error| Error::io(path, "read", &error))?;
    if bytes.len() as u64 > limit {
        let message = format!("larger than the limit of {limit} bytes");
        return Err(Error::new(ErrorKind::Limit, message).in_file(path));
    }
    Ok(bytes)
}

/// Writes a file so that at any moment its name stands for the old bytes or the new, never a part.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    replace(path, bytes).map_err(|error| Error::io(path, "write", &error))
}

fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".bidir-");
    // A temporary file is private unless told otherwise; an image is as public as any new file.
    #[cfg(unix)]
    let public = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(public);
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};

    #[test]
    fn packed_files_are_unpacked_and_limits_hold_for_what_comes_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("zeros.gz");
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&vec![0; 100_000]).unwrap();
        write(&path, &encoder.finish().unwrap()).unwrap();
        assert_eq!(read(&path, 100_000).unwrap(), vec![0; 100_000]);
        assert_eq!(read(&path, 99_999).unwrap_err().kind(), ErrorKind::Limit);
    }

    #[test]
    fn a_missing_file_is_told_apart() {
        let error = read(Path::new("no/such/file"), 10).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::MissingFile);
        assert_eq!(error.to_string(), "no/such/file: cannot open: no such file");
    }

    #[test]
    fn writing_replaces_and_leaves_nothing_else_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        write(&path, b"old").unwrap();
        write(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
