//! Recognises files of other programs by their first bytes and endings, so that messages name them and how
//! to import them.
//!
//! The bytes take precedence, then a word of the expected format, then the ending: a scene with an
//! unusual ending is still read.

use crate::error::{Error, ErrorKind, Result};
use crate::files::Files;
use crate::pbrt::is_directive;
use std::path::{Path, PathBuf};

/// Size of the part of a file that is examined. Unit: bytes.
const HEAD: usize = 1 << 16;
/// Size of the part in which a zero byte marks a binary file. Unit: bytes.
const TEXT_HEAD: usize = 1 << 12;

/// A kind of file that is not a scene, with a hint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kind {
    /// The name with its article.
    name: &'static str,
    hint: Hint,
}

/// The hint how to import a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hint {
    /// A text.
    Text(&'static str),
    /// Rename the file to this ending.
    Rename(&'static str),
    /// Use one of the formats of scenes.
    Formats,
}

const FORMATS: &str = "bidir reads pbrt-v4 (.pbrt) and glTF 2.0 (.gltf, .glb)";

const BLENDER: Kind = with_text(
    "a Blender file",
    "export it as glTF 2.0 (docs/guide/blender.md)",
);
const FBX: Kind = by_blender("an FBX file");
const USD: Kind = by_blender("a USD file");
const OBJ: Kind = by_blender("a Wavefront OBJ file");
const COLLADA: Kind = by_blender("a COLLADA file");
const MITSUBA: Kind = other("a Mitsuba scene");
const TUNGSTEN: Kind = other("a Tungsten scene");
const XML: Kind = other("an XML file");
const JSON: Kind = other("a JSON file");
const PLY: Kind = with_text(
    "a PLY mesh",
    "name it in a scene: Shape \"plymesh\" \"string filename\" \"FILE\"",
);
const IMAGE: Kind = with_text(
    "an image",
    "`bidir view`, `info` and `render` take scenes; `tonemap` and `compare` take images",
);
const FILM: Kind = with_text("a film file", "`bidir film develop` makes an image of it");
const ARCHIVE: Kind = with_text("an archive", "unpack it, and name the scene in it");
const EXPERIMENT: Kind = with_text(
    "a TOML file",
    "`bidir experiment` takes descriptions of experiments",
);
const GLB: Kind = misnamed("a binary glTF file", "glb");
const GLTF: Kind = misnamed("a glTF file", "gltf");
const PBRT: Kind = misnamed("a pbrt scene", "pbrt");
const BINARY: Kind = other("a binary file, not a scene");
const OTHER: Kind = other("not a scene");

const fn kind(name: &'static str, hint: Hint) -> Kind {
    Kind { name, hint }
}

const fn with_text(name: &'static str, hint: &'static str) -> Kind {
    kind(name, Hint::Text(hint))
}

/// A scene of another format that Blender reads.
const fn by_blender(name: &'static str) -> Kind {
    let hint = "import it into Blender and export it as glTF 2.0 (docs/guide/blender.md)";
    with_text(name, hint)
}

/// A scene or file without a way to import it.
const fn other(name: &'static str) -> Kind {
    kind(name, Hint::Formats)
}

/// A scene with the ending of another format.
const fn misnamed(name: &'static str, ending: &'static str) -> Kind {
    kind(name, Hint::Rename(ending))
}

/// First bytes that identify a format.
const MAGIC: [(&[u8], Kind); 18] = [
    (b"glTF", GLB),
    (b"BLENDER", BLENDER),
    (b"Kaydara FBX", FBX),
    (b"; FBX", FBX),
    (b"PXR-USDC", USD),
    (b"#usda", USD),
    (b"BIDIRFLM", FILM),
    (b"\x89PNG", IMAGE),
    (b"\xff\xd8\xff", IMAGE),
    (b"\x76\x2f\x31\x01", IMAGE),
    (b"#?R", IMAGE),
    (b"PF\n", IMAGE),
    (b"Pf\n", IMAGE),
    (b"II*\0", IMAGE),
    (b"MM\0*", IMAGE),
    (b"ply\n", PLY),
    (b"ply\r\n", PLY),
    (b"PK\x03\x04", ARCHIVE),
];

/// Endings of files that are not scenes. Packed files have no identifying first bytes.
const ENDINGS: [(&str, Kind); 26] = [
    ("blend", BLENDER),
    ("fbx", FBX),
    ("usd", USD),
    ("usda", USD),
    ("usdc", USD),
    ("usdz", USD),
    ("obj", OBJ),
    ("dae", COLLADA),
    ("xml", XML),
    ("json", JSON),
    ("3ds", by_blender("a 3ds Max file")),
    ("max", by_blender("a 3ds Max file")),
    ("c4d", by_blender("a Cinema 4D file")),
    ("abc", by_blender("an Alembic file")),
    ("stl", by_blender("an STL mesh")),
    ("skp", by_blender("a SketchUp file")),
    ("ma", by_blender("a Maya file")),
    ("mb", by_blender("a Maya file")),
    ("ply", PLY),
    ("toml", EXPERIMENT),
    ("zip", ARCHIVE),
    ("tar", ARCHIVE),
    ("tgz", ARCHIVE),
    ("7z", ARCHIVE),
    ("tga", IMAGE),
    ("bmp", IMAGE),
];

/// Refuses a folder in the place of a scene, and suggests a scene in it.
pub(crate) fn check_folder(path: &Path, files: &Files) -> Result<()> {
    if !files.is_folder(path) {
        return Ok(());
    }
    let message = format!("`{}` is a folder", path.display());
    let error = Error::naming(path, ErrorKind::Io, message);
    Err(match first_scene(path) {
        Some(scene) => error.with_hint(format!("name a scene in it, such as {}", scene.display())),
        None => error.with_hint("name a scene: .pbrt, .gltf or .glb"),
    })
}

/// Returns the first scene of a folder in the order of names.
fn first_scene(folder: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let scenes = entries.map(|entry| entry.path());
    let is_scene = |path: &PathBuf| {
        ending(path).is_some_and(|ending| ["pbrt", "gltf", "glb"].contains(&&*ending))
    };
    scenes.filter(is_scene).min()
}

/// Refuses a file that is not pbrt text. Text that may be intended as pbrt passes.
pub(crate) fn check_pbrt(path: &Path, bytes: &[u8]) -> Result<()> {
    let head = &bytes[..bytes.len().min(HEAD)];
    let text = String::from_utf8_lossy(head);
    let first = first_word(&text);
    let ending = ending(path);
    let is_named_pbrt = path.as_os_str() == "-" || ending.as_deref() == Some("pbrt");
    let kind = by_magic(head, ending.as_deref()).or_else(|| by_text(&text, ending.as_deref()));
    let is_other = !is_named_pbrt && !first.is_some_and(is_directive);
    // The parser reports misspelt directives with their places.
    let is_prose = is_other && first.is_some() && !text.contains("WorldBegin");
    let by_ending = || by_ending(ending.as_deref()).filter(|_| is_other);
    let kind = kind.or_else(by_ending);
    let kind = kind.or_else(|| is_binary(head).then_some(BINARY));
    let kind = kind.or_else(|| is_prose.then_some(OTHER));
    kind.map_or(Ok(()), |kind| Err(refusal(path, kind)))
}

/// Refuses a file that is neither text nor binary glTF.
pub(crate) fn check_gltf(path: &Path, bytes: &[u8]) -> Result<()> {
    let head = &bytes[..bytes.len().min(HEAD)];
    let text = String::from_utf8_lossy(head);
    let text = text.trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n']);
    if head.starts_with(b"glTF") || text.starts_with(['{', '[']) {
        return Ok(());
    }
    let kind = by_magic(head, None).or_else(|| by_text(text, None));
    let kind = kind.or_else(|| first_word(text).is_some_and(is_directive).then_some(PBRT));
    let kind = kind.or_else(|| is_binary(head).then_some(BINARY));
    let otherwise = match text {
        "" => "an empty file",
        _ => "not a glTF file: it begins with neither `glTF` nor `{`",
    };
    Err(refusal(path, kind.unwrap_or(other(otherwise))))
}

fn refusal(path: &Path, kind: Kind) -> Error {
    let message = format!("`{}` is {}", path.display(), kind.name);
    let error = Error::naming(path, ErrorKind::Syntax, message);
    match kind.hint {
        Hint::Text(hint) => error.with_hint(hint),
        Hint::Formats => error.with_hint(FORMATS),
        Hint::Rename(_) if path.as_os_str() == "-" => error.with_hint("save it as a file"),
        Hint::Rename(ending) => {
            let name = path.with_extension(ending);
            error.with_hint(format!("name it {}", name.display()))
        }
    }
}

/// Returns the ending in lower case, without `.gz`.
fn ending(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    Some(name.rsplit_once('.')?.1.to_owned())
}

fn by_magic(head: &[u8], ending: Option<&str>) -> Option<Kind> {
    let (_, kind) = MAGIC.iter().find(|(magic, _)| head.starts_with(magic))?;
    // A packed USD scene is a zip archive.
    if *kind == ARCHIVE && ending == Some("usdz") {
        return Some(USD);
    }
    Some(*kind)
}

fn by_ending(ending: Option<&str>) -> Option<Kind> {
    let ending = ending?;
    let entry = ENDINGS.iter().find(|(known, _)| *known == ending);
    entry.map(|(_, kind)| *kind)
}

/// Recognises XML, JSON and OBJ by their first characters.
fn by_text(text: &str, ending: Option<&str>) -> Option<Kind> {
    let text = text.trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n']);
    match text.chars().next()? {
        '<' => Some(xml(text, ending)),
        '{' => Some(json(text)),
        _ => {
            let is_obj = |word| matches!(word, "v" | "vn" | "vt" | "mtllib" | "usemtl" | "o" | "g");
            first_word(text).is_some_and(is_obj).then_some(OBJ)
        }
    }
}

fn xml(text: &str, ending: Option<&str>) -> Kind {
    if text.contains("<COLLADA") || ending == Some("dae") {
        COLLADA
    } else if text.contains("<scene") {
        MITSUBA
    } else {
        XML
    }
}

fn json(text: &str) -> Kind {
    let has = |keys: &[&str]| keys.iter().any(|key| text.contains(key));
    if has(&["\"asset\"", "\"bufferViews\"", "\"accessors\""]) {
        GLTF
    } else if has(&["\"bsdfs\"", "\"primitives\""]) {
        TUNGSTEN
    } else {
        JSON
    }
}

/// Returns the first word outside of pbrt comments.
fn first_word(text: &str) -> Option<&str> {
    let lines = text.trim_start_matches('\u{feff}').lines();
    let mut lines = lines.map(str::trim).filter(|line| !line.starts_with('#'));
    let line = lines.find(|line| !line.is_empty())?;
    line.split([' ', '\t', '"', '[']).next()
}

fn is_binary(head: &[u8]) -> bool {
    // UTF-16 text, which has zero bytes, has its own message.
    let is_utf16 = head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]);
    !is_utf16 && head[..head.len().min(TEXT_HEAD)].contains(&0)
}

#[cfg(test)]
mod tests;
