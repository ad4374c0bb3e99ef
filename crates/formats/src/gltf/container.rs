//! The parts of a glTF file: the JSON, the binary chunk of a `.glb`, files beside it, and data URIs.

use super::place::{GltfFault, Place};
use crate::error::{Error, ErrorKind, Result};
use crate::files::Files;
use crate::foreign;
use crate::limits::LARGEST_GLTF;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::path::{Path, PathBuf};

/// The first bytes of a `.glb`.
const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: [u8; 4] = *b"JSON";
const BINARY_CHUNK: [u8; 4] = *b"BIN\0";

/// The parts of a file.
#[derive(Debug)]
pub(super) struct Container {
    pub(super) json: String,
    /// The binary chunk.
    pub(super) binary: Option<Vec<u8>>,
}

impl Container {
    /// Returns the size of the JSON and the binary chunk together. Unit: bytes.
    pub(super) fn size(&self) -> u64 {
        let binary = self.binary.as_ref().map_or(0, Vec::len);
        (self.json.len() + binary) as u64
    }
}

/// Reads a `.gltf` or `.glb`, which are distinguished by their first bytes.
pub(super) fn read(path: &Path, files: &Files) -> Result<Container> {
    foreign::check_folder(path, files)?;
    let bytes = files.read(path, LARGEST_GLTF)?.bytes;
    foreign::check_gltf(path, &bytes)?;
    let container = if bytes.starts_with(MAGIC) {
        chunks(&bytes)
    } else {
        let json = text(bytes);
        json.map(|json| Container { json, binary: None })
    };
    container.map_err(|error| error.in_file(path))
}

fn text(mut bytes: Vec<u8>) -> Result<String> {
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    let broken = |error| Error::new(ErrorKind::Syntax, format!("the JSON is not UTF-8: {error}"));
    String::from_utf8(bytes).map_err(broken)
}

fn broken(message: impl Into<String>) -> Error {
    Error::new(
        ErrorKind::Data,
        format!("broken glb file: {}", message.into()),
    )
}

/// Reads four bytes as a number, and returns the rest. None: there are fewer.
fn number(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (number, rest) = bytes.split_first_chunk::<4>()?;
    Some((u32::from_le_bytes(*number) as usize, rest))
}

/// Splits a `.glb` into its chunks: after twelve bytes, each has a length, a name and bytes.
fn chunks(bytes: &[u8]) -> Result<Container> {
    let short = || broken("it ends inside its header");
    let (version, rest) = number(&bytes[MAGIC.len()..]).ok_or_else(short)?;
    if version != 2 {
        let error = Error::new(ErrorKind::Unsupported, format!("glb version {version}"));
        return Err(error.with_hint("convert it to glTF 2.0"));
    }
    let (length, mut rest) = number(rest).ok_or_else(short)?;
    if length > bytes.len() {
        let have = bytes.len();
        return Err(broken(format!(
            "it has {have} of the {length} bytes that its header declares"
        )));
    }
    let (mut json, mut binary) = (None, None);
    while !rest.is_empty() {
        let short = || broken("a chunk ends beyond the end of the file");
        let (size, after) = number(rest).ok_or_else(short)?;
        let (kind, after) = after.split_first_chunk::<4>().ok_or_else(short)?;
        let (data, after) = after.split_at_checked(size).ok_or_else(short)?;
        match *kind {
            JSON_CHUNK if json.is_none() => json = Some(text(data.to_vec())?),
            BINARY_CHUNK if binary.is_none() => binary = Some(data.to_vec()),
            // The format allows unknown chunks.
            _ => {}
        }
        rest = after;
    }
    let json = json.ok_or_else(|| broken("it has no JSON chunk"))?;
    Ok(Container { json, binary })
}

/// The bytes of a URI.
pub(super) struct Resource {
    pub(super) bytes: Vec<u8>,
    /// The file that has the bytes. None: the URI contains them.
    pub(super) file: Option<PathBuf>,
}

/// Reads the resource of `uri`, which is the value at `place`; relative names are of files in `folder`.
pub(super) fn resource(
    folder: &Path,
    uri: &str,
    place: &Place,
    read: impl FnOnce(&Path) -> Result<Vec<u8>>,
) -> Result<Resource, GltfFault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let bytes = data_uri(data, place)?;
        return Ok(Resource { bytes, file: None });
    }
    let Some(path) = file(folder, uri) else {
        let fault = place.fault(
            ErrorKind::Unsupported,
            "a resource on the network is not read",
        );
        return Err(fault.with_hint("save it beside the file"));
    };
    let bytes = read(&path).map_err(|error| GltfFault::from_error(place.clone(), &error))?;
    let file = Some(path);
    Ok(Resource { bytes, file })
}

/// Returns the file that `uri` names. None: it is a data URI or a remote one.
pub(super) fn file(folder: &Path, uri: &str) -> Option<PathBuf> {
    let is_other = uri.starts_with("data:") || uri.contains("://");
    (!is_other).then(|| folder.join(file_of(uri)))
}

fn data_uri(data: &str, place: &Place) -> Result<Vec<u8>, GltfFault> {
    let broken = |message: String| place.fault(ErrorKind::Data, message);
    let (header, payload) = data
        .split_once(',')
        .ok_or_else(|| broken("the data URI has no comma".into()))?;
    if !header.ends_with(";base64") {
        return Err(broken("the data URI is not in base64".into()));
    }
    let decoded = STANDARD.decode(payload.trim());
    decoded.map_err(|error| broken(format!("broken base64: {error}")))
}

/// Converts a relative URI to a file name: decodes escapes such as `%20`, and keeps invalid ones.
fn file_of(uri: &str) -> PathBuf {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| first == b'%');
        let digits = code.and_then(|code| std::str::from_utf8(code).ok());
        let byte = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(byte.unwrap_or(first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    PathBuf::from(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_decoded_to_file_names() {
        for (uri, name) in [
            ("a.bin", "a.bin"),
            ("my%20mesh%2Bb.bin", "my mesh+b.bin"),
            ("100%.bin", "100%.bin"),
            ("a%zz%", "a%zz%"),
            ("%C3%A4.png", "ä.png"),
        ] {
            assert_eq!(file_of(uri), PathBuf::from(name));
        }
    }

    #[test]
    fn data_uris_are_decoded_or_refused() {
        let place = Place::of("buffers", 0);
        let good = data_uri("image/png;base64,AAEC", &place).unwrap();
        assert_eq!(good, vec![0, 1, 2]);
        for bad in ["", "image/png;base64", "text/plain,abc", ";base64,@@@@"] {
            assert_eq!(
                data_uri(bad, &place).unwrap_err().kind,
                ErrorKind::Data,
                "{bad}"
            );
        }
    }

    #[test]
    fn chunks_are_split_and_truncated_ones_refused() {
        let mut glb = b"glTF\x02\0\0\0\x28\0\0\0\x04\0\0\0JSON{}  ".to_vec();
        glb.extend(b"\x04\0\0\0BIN\0\x01\x02\x03\x04\0\0\0\0");
        glb.truncate(36);
        glb[8] = 36;
        let container = chunks(&glb).unwrap();
        assert_eq!(
            (&*container.json, container.binary),
            ("{}  ", Some(vec![1, 2, 3, 4]))
        );
        for length in 4..36 {
            assert!(chunks(&glb[..length]).is_err(), "{length}");
        }
        glb[4] = 1;
        assert_eq!(chunks(&glb).unwrap_err().kind(), ErrorKind::Unsupported);
    }
}
