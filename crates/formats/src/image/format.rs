//! The formats of images, recognised by the first bytes of a file or the ending of its name.

use crate::error::{Error, ErrorKind, Result};
use image::ImageFormat;
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

/// A readable format, its name in the `image` crate, the endings of its files, and the marks at their beginning.
type Known = (
    Format,
    ImageFormat,
    &'static [&'static str],
    &'static [&'static [u8]],
);

/// All readable formats. Targa has no mark, and that of WebP is not at the beginning.
#[rustfmt::skip]
const ALL: [Known; 11] = [
    (Format::Bmp, ImageFormat::Bmp, &["bmp"], &[b"BM"]),
    (Format::Exr, ImageFormat::OpenExr, &["exr"], &[b"\x76\x2f\x31\x01"]),
    (Format::Gif, ImageFormat::Gif, &["gif"], &[b"GIF8"]),
    (Format::Hdr, ImageFormat::Hdr, &["hdr", "pic"], &[b"#?"]),
    (Format::Jpeg, ImageFormat::Jpeg, &["jpg", "jpeg"], &[b"\xff\xd8\xff"]),
    (Format::Pfm, ImageFormat::Pnm, &["pfm"], &[b"PF\n", b"Pf\n", b"PF ", b"Pf "]),
    (Format::Png, ImageFormat::Png, &["png"], &[b"\x89PNG"]),
    (Format::Qoi, ImageFormat::Qoi, &["qoi"], &[b"qoif"]),
    (Format::Tga, ImageFormat::Tga, &["tga"], &[]),
    (Format::Tiff, ImageFormat::Tiff, &["tif", "tiff"], &[b"II*\0", b"MM\0*"]),
    (Format::WebP, ImageFormat::WebP, &["webp"], &[]),
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
        let mut all = ALL.iter();
        let known = all.find(|(_, _, endings, _)| endings.contains(&&*extension));
        known.map(|&(format, ..)| format)
    }

    /// Returns the name of the format in the `image` crate.
    pub(super) fn decoder(self) -> ImageFormat {
        ALL[self as usize].1
    }

    /// Returns the format by the first bytes of a file. None: they are not a known mark.
    pub fn of_bytes(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
            return Some(Self::WebP);
        }
        let has = |marks: &[&[u8]]| marks.iter().any(|mark| bytes.starts_with(mark));
        let known = ALL.iter().find(|(.., marks)| has(marks));
        known.map(|&(format, ..)| format)
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

/// Returns the error of an output whose name has another ending than those of output images.
pub fn no_output(path: &Path) -> Error {
    let name = path.display();
    let message = format!("cannot write `{name}`: output images are .exr or .png");
    Error::new(ErrorKind::Options, message)
}

/// Returns true for a QOI file whose numbers are linear: the last byte of its header says so.
pub(super) fn is_linear_qoi(bytes: &[u8]) -> bool {
    bytes.get(13) == Some(&1)
}
