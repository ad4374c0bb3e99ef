//! The parsers of `formats`, each by the door that users have.
//!
//! A result is thrown away, but its error is told first: messages are made of what was read, too.

use bidir::settings::Request;
use flate2::{Crc, read::DeflateDecoder};
use formats::image::{self, Format};
use formats::pbrt::{self, LoadOptions};
use formats::{film, gltf, ply};
use std::fs;
use std::io::Read;
use std::path::PathBuf;
use std::sync::LazyLock;
use tempfile::TempDir;

/// A folder that is empty but for what [`spectrum`] puts there.
static FOLDER: LazyLock<TempDir> =
    LazyLock::new(|| tempfile::tempdir().expect("temporary files can be made"));

fn tell<T>(result: formats::Result<T>) {
    if let Err(error) = result {
        let _ = error.to_string();
    }
}

/// A scene in the format of pbrt-v4, whose files are not there: parsed, then built as it is and with
/// stand-ins for what is not supported.
pub fn pbrt(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    build(text, &[false, true]);
}

/// Builds a scene once for each of these values of `LoadOptions::lenient`.
fn build(text: &str, lenient: &[bool]) {
    let description = match pbrt::parse_text("scene", text) {
        Ok(description) => description,
        Err(error) => return tell::<()>(Err(error)),
    };
    for &lenient in lenient {
        tell(pbrt::build(&description, &options(lenient)));
    }
}

fn options(lenient: bool) -> LoadOptions {
    LoadOptions {
        lenient,
        resolution: Some([4, 3]),
        most_primitives: Some(1 << 14),
        ..LoadOptions::default()
    }
}

/// A scene in glTF, as JSON or as what a `.glb` holds, as it is and with stand-ins.
pub fn gltf(bytes: &[u8]) {
    static FILE: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("scene.gltf"));
    fs::write(&*FILE, bytes).expect("a temporary file can be written");
    for lenient in [false, true] {
        tell(gltf::load(&FILE, &options(lenient)));
    }
}

/// A mesh.
pub fn ply(bytes: &[u8]) {
    tell(ply::parse(bytes));
}

/// An image: the first byte says in which format, and the others are the file.
pub fn image(bytes: &[u8]) {
    let Some((format, file)) = bytes.split_first() else {
        return;
    };
    match format {
        b'p' => tell(image::decode(Format::Png, file, None)),
        b'j' => tell(image::decode(Format::Jpeg, file, None)),
        b'w' => tell(image::decode(Format::WebP, file, None)),
        b't' => tell(image::decode(Format::Tga, file, None)),
        b'h' => tell(image::decode(Format::Hdr, file, None)),
        b'f' => tell(image::decode(Format::Pfm, file, None)),
        b'b' => tell(image::decode(Format::Bmp, file, None)),
        b'g' => tell(image::decode(Format::Gif, file, None)),
        b'q' => tell(image::decode(Format::Qoi, file, None)),
        b'i' => tell(image::decode(Format::Tiff, file, None)),
        b'l' => tell(image::decode_layers(file)),
        _ => tell(image::decode(Format::Exr, file, None)),
    }
}

/// A film file, as it is and with the checksums that its bytes should have: else nothing behind them
/// would be reached.
pub fn film(bytes: &[u8]) {
    for bytes in [bytes, &with_checksums(bytes)] {
        match film::decode(bytes) {
            Ok(file) => {
                let header = &file.header;
                let _ = Request::read(&header.settings);
                let _ = (film::metadata(header), header.joined(header));
            }
            Err(error) => tell::<()>(Err(error)),
        }
    }
}

/// The same film file, with the checksum of its header and of each block replaced by the right one.
fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    const PREAMBLE: usize = 16;
    let mut repaired = bytes.to_vec();
    let number = |bytes: &[u8], at: usize| {
        let bytes = bytes.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes) as usize)
    };
    let mut put = |at: usize, of: &[u8]| {
        let mut crc = Crc::new();
        crc.update(of);
        let place = repaired.get_mut(at..at + 4)?;
        place.copy_from_slice(&crc.sum().to_le_bytes());
        Some(())
    };
    let mut repair = || {
        let mut at = PREAMBLE + number(bytes, PREAMBLE - 4)?;
        put(at, bytes.get(..at)?)?;
        at += 4;
        loop {
            let packed = number(bytes, at)?;
            let block = bytes.get(at + 8..at + 8 + packed)?;
            let mut planes = Vec::new();
            // What is broken has no right checksum.
            let _ = DeflateDecoder::new(block)
                .take(1 << 24)
                .read_to_end(&mut planes);
            put(at + 4, &planes)?;
            at += 8 + packed;
        }
    };
    let _: Option<()> = repair();
    repaired
}

/// A file with a spectrum, as the colour of a light, of a surface, and as the index of a metal.
pub fn spectrum(bytes: &[u8]) {
    static FILE: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("lamp.spd"));
    fs::write(&*FILE, bytes).expect("a temporary file can be written");
    let name = FILE.to_str().expect("temporary files have plain names");
    for (kind, parameter) in [
        ("LightSource \"point\"", "I"),
        ("Material \"diffuse\"", "reflectance"),
        ("Material \"conductor\"", "eta"),
        ("Material \"dielectric\"", "eta"),
    ] {
        let text = format!(
            "PixelFilter \"box\" WorldBegin {kind} \"spectrum {parameter}\" \"{name}\" Shape \"sphere\""
        );
        build(&text, &[false]);
    }
}

/// A file with grids of densities and temperatures, as the smoke of a scene.
pub fn nanovdb(bytes: &[u8]) {
    static FILE: LazyLock<PathBuf> = LazyLock::new(|| FOLDER.path().join("smoke.nvdb"));
    fs::write(&*FILE, bytes).expect("a temporary file can be written");
    let name = FILE.to_str().expect("temporary files have plain names");
    let text = format!(
        "PixelFilter \"box\" WorldBegin MakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" \"{name}\" \
         MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\""
    );
    build(&text, &[false, true]);
}
