//! Recognises files that are not scenes, and scenes with the ending of another format, so that messages can
//! name the format and say how to import the file.
//!
//! First the bytes decide, then a word of the expected format, then the ending: a scene with an unusual
//! ending is still read.

use crate::error::{Error, ErrorKind, Result};
use crate::files::Files;
use crate::pbrt::is_directive;
use std::path::{Path, PathBuf};

/// Size of the part of a file that is examined. Unit: bytes.
const HEAD: usize = 1 << 16;
/// Size of the part in which a zero byte marks a binary file. Unit: bytes.
const TEXT_HEAD: usize = 1 << 12;

/// A kind of file: its name with an article, the hint how to import it, and its signs.
///
/// A sign is an ending with its dot, or the first bytes of the file, one for each character. `BEGIN…PART` also
/// requires `PART` somewhere after them. Packed formats are recognised only by their endings.
type Kind = (&'static str, &'static str, &'static [&'static str]);

const FORMATS: &str = "bidir reads pbrt-v4 (.pbrt) and glTF 2.0 (.gltf, .glb)";
const EXPORT: &str = "export it as glTF 2.0 (docs/guide/blender.md)";
const BLENDER: &str = "import it into Blender and export it as glTF 2.0 (docs/guide/blender.md)";
const MESH: &str = "name it in a scene: Shape \"plymesh\" \"string filename\" \"FILE\"";
const IMAGES: &str =
    "`bidir view`, `info` and `render` take scenes; `tonemap` and `compare` take images";

/// All kinds that have signs. A file is of the first kind whose first bytes fit, else of the first whose ending fits.
#[rustfmt::skip]
const KINDS: &[Kind] = &[
    ("a binary glTF file", "give it a name that ends in .glb", &["glTF"]),
    ("a glTF file", "give it a name that ends in .gltf",
        &["{…\"asset\"", "{…\"bufferViews\"", "{…\"accessors\""]),
    ("a Tungsten scene", FORMATS, &["{…\"bsdfs\"", "{…\"primitives\""]),
    ("a JSON file", FORMATS, &["{", ".json"]),
    ("a COLLADA file", BLENDER, &["<…<COLLADA", ".dae"]),
    ("a Mitsuba scene", FORMATS, &["<…<scene"]),
    ("an XML file", FORMATS, &["<", ".xml"]),
    ("a Blender file", EXPORT, &["BLENDER", ".blend"]),
    ("an FBX file", BLENDER, &["Kaydara FBX", "; FBX", ".fbx"]),
    ("a USD file", BLENDER,
        &["PXR-USDC", "#usda", "PK\u{3}\u{4}….usd", ".usd", ".usda", ".usdc", ".usdz"]),
    ("a Wavefront OBJ file", BLENDER,
        &["v ", "vn ", "vt ", "mtllib ", "usemtl ", "o ", "g ", ".obj"]),
    ("a 3ds Max file", BLENDER, &[".3ds", ".max"]),
    ("a Cinema 4D file", BLENDER, &[".c4d"]),
    ("an Alembic file", BLENDER, &[".abc"]),
    ("an STL mesh", BLENDER, &[".stl"]),
    ("a SketchUp file", BLENDER, &[".skp"]),
    ("a Maya file", BLENDER, &[".ma", ".mb"]),
    ("a PLY mesh", MESH, &["ply\n", "ply\r\n", ".ply"]),
    ("an image", IMAGES,
        &["\u{89}PNG", "\u{ff}\u{d8}\u{ff}", "v/1\u{1}", "#?R", "PF\n", "Pf\n", "II*\0", "MM\0*",
          ".tga", ".bmp"]),
    ("a film file", "`bidir film develop` makes an image of it", &["BIDIRFLM"]),
    ("a TOML file", "`bidir experiment` takes descriptions of experiments", &[".toml"]),
    ("an archive", "unpack it, and name the scene in it",
        &["PK\u{3}\u{4}", ".zip", ".tar", ".tgz", ".7z"]),
];
const PBRT: Kind = ("a pbrt scene", "give it a name that ends in .pbrt", &[]);
const BINARY: Kind = ("a binary file, not a scene", FORMATS, &[]);
const OTHER: Kind = ("not a scene", FORMATS, &[]);
const NOT_GLTF: Kind = (
    "not a glTF file: it begins with neither `glTF` nor `{`",
    FORMATS,
    &[],
);

/// Refuses a folder instead of a scene file, and suggests a scene in the folder.
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
    let is_scene = |path: &PathBuf| [".pbrt", ".gltf", ".glb"].contains(&&*ending(path));
    scenes.filter(is_scene).min()
}

/// Refuses a file that is not pbrt text. Text that may be intended as pbrt passes.
pub(crate) fn check_pbrt(path: &Path, bytes: &[u8]) -> Result<()> {
    let head = Head::new(bytes);
    let word = head.first_word();
    let ending = ending(path);
    let is_pbrt = path.as_os_str() == "-" || ending == ".pbrt" || is_directive(word);
    // The parser reports misspelt directives with their places.
    let is_prose = !is_pbrt && !word.is_empty() && !head.0.contains("WorldBegin");
    let kind = head
        .kind()
        .or_else(|| kind_of(|sign| !is_pbrt && sign == ending))
        .or_else(|| head.is_binary().then_some(BINARY))
        .or_else(|| is_prose.then_some(OTHER));
    kind.map_or(Ok(()), |kind| Err(refusal(path, kind)))
}

/// Refuses a file that is neither text nor binary glTF.
pub(crate) fn check_gltf(path: &Path, bytes: &[u8]) -> Result<()> {
    let head = Head::new(bytes);
    if head.0.starts_with("glTF") || head.content().starts_with(['{', '[']) {
        return Ok(());
    }
    let kind = head
        .kind()
        .or_else(|| is_directive(head.first_word()).then_some(PBRT))
        .or_else(|| head.is_binary().then_some(BINARY));
    Err(refusal(path, kind.unwrap_or(NOT_GLTF)))
}

fn refusal(path: &Path, (name, hint, _): Kind) -> Error {
    let message = format!("`{}` is {name}", path.display());
    Error::naming(path, ErrorKind::Syntax, message).with_hint(hint)
}

/// Returns the ending with its dot in lower case, without `.gz`; empty where there is none.
fn ending(path: &Path) -> String {
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let plain = name.strip_suffix(".gz").unwrap_or(&name);
    plain.rfind('.').map_or("", |dot| &plain[dot..]).to_owned()
}

fn kind_of(has: impl Fn(&str) -> bool) -> Option<Kind> {
    let of_file = |kind: &&Kind| kind.2.iter().any(|sign| has(sign));
    KINDS.iter().find(of_file).copied()
}

/// The first bytes of a file, each as a character.
struct Head(String);

impl Head {
    fn new(bytes: &[u8]) -> Self {
        Self(bytes.iter().take(HEAD).map(|&b| char::from(b)).collect())
    }

    /// Returns the part after a byte order mark and comments of pbrt.
    fn content(&self) -> &str {
        let mut rest = self.0.trim_start_matches("\u{ef}\u{bb}\u{bf}").trim_start();
        while rest.starts_with('#') {
            rest = rest
                .split_once('\n')
                .map_or("", |(_, rest)| rest)
                .trim_start();
        }
        rest
    }

    fn first_word(&self) -> &str {
        let mut words = self.content().split([' ', '\t', '\r', '\n', '"', '[']);
        words.next().unwrap_or_default()
    }

    /// Returns the kind of file that begins like this.
    fn kind(&self) -> Option<Kind> {
        kind_of(|sign| {
            let (begin, part) = sign.split_once('…').unwrap_or((sign, ""));
            let begins = self.0.starts_with(begin) || self.content().starts_with(begin);
            begins && !begin.starts_with('.') && self.0.contains(part)
        })
    }

    fn is_binary(&self) -> bool {
        // UTF-16 text, which has zero bytes, has its own message.
        let is_utf16 = self.0.starts_with("\u{ff}\u{fe}") || self.0.starts_with("\u{fe}\u{ff}");
        !is_utf16 && self.0.chars().take(TEXT_HEAD).any(|c| c == '\0')
    }
}

#[cfg(test)]
mod tests;
