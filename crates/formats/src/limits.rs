//! The limits of what is read. docs/reference/limits.md has the same table for users, which a test
//! compares.
//!
//! Memory and time follow the bytes that files have on the disk, so that a small file cannot ask for
//! much. What a few bytes may stand for, such as packed texts, inclusions, subdivision and even
//! images, has an [`Allowance`]: a part that is free, and so much more for every byte.

/// How much files of a given size may stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Allowance {
    /// For files of any size.
    pub(crate) free: u64,
    /// More for every byte that the files have on the disk, packed.
    pub(crate) per_byte: u64,
}

impl Allowance {
    const fn new(free: u64, per_byte: u64) -> Self {
        Self { free, per_byte }
    }

    /// How much files of `stored` bytes may stand for.
    pub(crate) const fn of(self, stored: u64) -> u64 {
        self.free
            .saturating_add(self.per_byte.saturating_mul(stored))
    }
}

/// Bytes that a packed file unpacks to. Numbers as text pack to a tenth, DEFLATE ends at a thousandth.
pub(crate) const UNPACKED: Allowance = Allowance::new(1 << 24, 64);
/// Bytes of texts that are included again.
pub(crate) const TEXTS_AGAIN: Allowance = Allowance::new(1 << 26, 16);
/// Directives, which a text has several bytes for unless it is packed or included again.
pub(crate) const DIRECTIVES: Allowance = Allowance::new(1 << 18, 1);
/// Parameters of directives.
pub(crate) const PARAMETERS: Allowance = Allowance::new(1 << 20, 1);
/// Bytes of meshes, images, spectra and buffers that are read again.
pub(crate) const FILES_AGAIN: Allowance = Allowance::new(1 << 27, 128);
/// Primitives of a scene, and vertices of its meshes; those of shared objects count once.
pub(crate) const PRIMITIVES: Allowance = Allowance::new(1 << 22, 16);
/// Shapes, counted as they are kept: those that emit once for each place.
pub(crate) const SHAPES: Allowance = Allowance::new(1 << 18, 1);
/// Mesh instances of a glTF file; in pbrt each has a directive.
pub(crate) const INSTANCES: Allowance = Allowance::new(1 << 18, 1);
/// Components that are read by accessors of a glTF file.
pub(crate) const COMPONENTS: Allowance = Allowance::new(1 << 26, 64);
/// Numbers of an image: pixels times channels.
pub(crate) const IMAGE: Allowance = Allowance::new(1 << 26, 128);
/// Numbers of all images of a scene.
pub(crate) const IMAGES: Allowance = Allowance::new(1 << 28, 128);

/// Bytes of one text, unpacked: places in it are 32-bit numbers.
pub(crate) const LONGEST_TEXT: u64 = u32::MAX as u64;
/// Files within files within files.
pub(crate) const DEEPEST_INCLUSION: usize = 64;
/// Inclusions in all: each may ask the system for a file.
pub(crate) const MOST_INCLUSIONS: u64 = 1 << 16;
/// Blocks within blocks.
pub(crate) const DEEPEST_BLOCK: usize = 1 << 16;
/// Parameters that `Attribute` directives give one kind of object; all are copied where one is added.
pub(crate) const MOST_DEFAULTS: usize = 64;
/// Values of these parameters.
pub(crate) const MOST_DEFAULT_VALUES: usize = 4096;
/// Warnings that differ: the list is searched for each.
pub(crate) const MOST_WARNINGS: usize = 200;
/// The one warning for all others.
pub(crate) const FURTHER_WARNINGS: &str = "further warnings, of other kinds";
/// Primitives, and vertices, of a scene of any size, unless the caller says otherwise.
pub(crate) const MOST_PRIMITIVES: u64 = 1 << 28;
/// Steps of subdivision: each makes four triangles of one.
pub(crate) const MOST_LEVELS: u32 = 10;
/// Textures within textures.
pub(crate) const DEEPEST_TEXTURE: usize = 32;
/// Textures that one texture combines.
pub(crate) const MOST_TEXTURES: usize = 1024;
/// Pixels of a film in either direction.
pub(crate) const LARGEST_SIDE: u32 = 1 << 16;
/// Bytes of a mesh file, unpacked.
pub(crate) const LARGEST_MESH: u64 = 1 << 34;
/// Bytes of an image file.
pub(crate) const LARGEST_IMAGE: u64 = 1 << 33;
/// Numbers of an image of any size: 2 GiB.
pub(crate) const MOST_NUMBERS: u64 = 1 << 29;
/// Bytes of a glTF file, and of each file that it names.
pub(crate) const LARGEST_GLTF: u64 = 1 << 33;
/// Components of a glTF accessor that has no bytes of its own.
pub(crate) const MOST_ZEROS: usize = 1 << 22;
/// Bytes of a file of a spectrum.
pub(crate) const LARGEST_SPECTRUM: u64 = 1 << 24;
/// Bytes of a film file.
pub(crate) const LARGEST_FILM: u64 = 1 << 36;

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = include_str!("../../../docs/reference/limits.md");

    #[track_caller]
    fn check(row: &str) {
        assert!(PAGE.lines().any(|line| line.starts_with(row)), "{row}");
    }

    #[test]
    fn the_reference_has_every_allowance() {
        for (item, Allowance { free, per_byte }) in [
            ("bytes that a `.gz` unpacks to", UNPACKED),
            ("bytes of texts included again", TEXTS_AGAIN),
            ("directives", DIRECTIVES),
            ("parameters", PARAMETERS),
            (
                "bytes of meshes, images, spectra and buffers read again",
                FILES_AGAIN,
            ),
            ("primitives, and vertices", PRIMITIVES),
            ("shapes", SHAPES),
            ("mesh instances of glTF", INSTANCES),
            ("components read by accessors of glTF", COMPONENTS),
            ("numbers of an image: pixels × channels, at least 3", IMAGE),
            ("numbers of all images of a scene", IMAGES),
        ] {
            check(&format!("| {item} | {free} | {per_byte} |"));
        }
    }

    #[test]
    fn the_reference_has_every_other_limit() {
        let gib = |bytes: u64| (bytes + 1) >> 30;
        for (item, limit) in [
            (
                "inclusions",
                format!("{MOST_INCLUSIONS}, nested {DEEPEST_INCLUSION} deep"),
            ),
            ("nested blocks", DEEPEST_BLOCK.to_string()),
            (
                "parameters of `Attribute`, per kind of object",
                format!("{MOST_DEFAULTS}, with {MOST_DEFAULT_VALUES} values"),
            ),
            (
                "textures within a texture",
                format!("{DEEPEST_TEXTURE} deep, {MOST_TEXTURES} in all"),
            ),
            ("steps of `loopsubdiv`", MOST_LEVELS.to_string()),
            (
                "primitives, and vertices, of any scene",
                MOST_PRIMITIVES.to_string(),
            ),
            (
                "zeros of a glTF accessor without bytes",
                MOST_ZEROS.to_string(),
            ),
            ("numbers of any image", MOST_NUMBERS.to_string()),
            ("film of a scene", format!("{LARGEST_SIDE} pixels per side")),
            ("film file", format!("{} GiB, and", gib(LARGEST_FILM))),
            ("text of a scene", format!("{} GiB", gib(LONGEST_TEXT))),
            ("mesh file, unpacked", format!("{} GiB", gib(LARGEST_MESH))),
            (
                "image file, file of glTF",
                format!("{} GiB", gib(LARGEST_IMAGE.min(LARGEST_GLTF))),
            ),
            ("spectrum file", format!("{} MiB", LARGEST_SPECTRUM >> 20)),
            ("distinct warnings", format!("{MOST_WARNINGS}, then")),
        ] {
            check(&format!("| {item} | {limit}"));
        }
    }
}
