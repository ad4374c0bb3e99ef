//! The formats of images, recognised by the first bytes of a file or the ending of its name.

use crate::error::{Error, ErrorKind, Result};
use std::path::Path;

/// A readable format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Windows bitmap.
    Bmp,
    /// OpenEXR.
    Exr,
    /// GIF; of an animation the first image.
    Gif,
    /// Radiance RGBE.
    Hdr,
    /// JPEG.
    Jpeg,
    /// Portable float map.
    Pfm,
    /// Portable Network Graphics, 8 or 16 bits.
    Png,
    /// Quite OK Image.
    Qoi,
    /// Targa.
    Tga,
    /// Tagged image file format.
    Tiff,
    /// WebP, lossy and lossless; of an animation the first image.
    WebP,
}

/// The marks of readable formats at the beginning of a file. Targa has none.
const MARKS: [(&[u8], Format); 13] = [
    (b"\x89PNG", Format::Png),
    (b"\xff\xd8\xff", Format::Jpeg),
    (b"\x76\x2f\x31\x01", Format::Exr),
    (b"#?", Format::Hdr),
    (b"PF\n", Format::Pfm),
    (b"Pf\n", Format::Pfm),
    (b"PF ", Format::Pfm),
    (b"Pf ", Format::Pfm),
    (b"GIF8", Format::Gif),
    (b"qoif", Format::Qoi),
    (b"II*\0", Format::Tiff),
    (b"MM\0*", Format::Tiff),
    (b"BM", Format::Bmp),
];

/// The marks of formats that cannot be read, each after its offset in bytes.
const OTHER_MARKS: [(usize, &[u8], &str); 10] = [
    (0, b"\xabKTX 20", "a KTX2 file"),
    (0, b"\xabKTX 11", "a KTX file"),
    (0, b"DDS ", "a DDS file"),
    (0, b"8BPS", "a Photoshop file"),
    (0, b"\0\0\0\x0cjP  ", "a JPEG 2000 file"),
    (0, b"\0\0\0\x0cJXL ", "a JPEG XL file"),
    (0, b"\xff\x0a", "a JPEG XL file"),
    (4, b"ftypavif", "an AVIF file"),
    (4, b"ftypheic", "a HEIC file"),
    (4, b"ftypmif1", "a HEIF file"),
];

impl Format {
    /// Returns the format by the ending of a file's name. None: the ending is unknown.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match extension.as_str() {
            "bmp" => Self::Bmp,
            "exr" => Self::Exr,
            "gif" => Self::Gif,
            "hdr" | "pic" => Self::Hdr,
            "jpg" | "jpeg" => Self::Jpeg,
            "pfm" => Self::Pfm,
            "png" => Self::Png,
            "qoi" => Self::Qoi,
            "tga" => Self::Tga,
            "tif" | "tiff" => Self::Tiff,
            "webp" => Self::WebP,
            _ => return None,
        })
    }

    /// Returns the format by the first bytes of a file. None: they are not a known mark.
    pub fn of_bytes(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
            return Some(Self::WebP);
        }
        let known = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark));
        known.map(|&(_, format)| format)
    }

    /// Returns the format of a file: by its bytes, else by its name, as Targa files have no mark.
    pub(super) fn of_file(bytes: &[u8], path: &Path) -> Result<Self> {
        let known = Self::of_bytes(bytes);
        let named = || Self::of(path).filter(|_| other_format(bytes).is_none());
        known.or_else(named).ok_or_else(|| {
            let message = match other_format(bytes) {
                Some(name) => format!("{name} is not read"),
                None => "unknown image format".into(),
            };
            Error::new(ErrorKind::Unsupported, message).with_hint(USE)
        })
    }
}

/// The hint for images in other formats.
const USE: &str = "use exr, hdr, pfm, png, jpg, tga, webp, bmp, gif, qoi or tiff";

/// Returns the name of a format that is known, but not read.
pub(crate) fn other_format(bytes: &[u8]) -> Option<&'static str> {
    let has = |at: usize, mark: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(mark));
    let known = OTHER_MARKS.iter().find(|(at, mark, _)| has(*at, mark));
    known.map(|&(.., name)| name)
}

/// Returns true for a QOI file whose numbers are linear: the last byte of its header says so.
pub(super) fn is_linear_qoi(bytes: &[u8]) -> bool {
    bytes.get(13) == Some(&1)
}
