//! The limits of readers. A test writes them to docs/reference/limits.md.
//!
//! Memory and time are bounded by the size of files on the disk, so that a small file cannot demand much.
//! Features that expand a few bytes, such as packed texts, inclusions, subdivision and even images, have
//! an [`Allowance`]: a free part, and more for every byte.

/// A limit that grows with the size of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Allowance {
    /// The limit for files of any size.
    pub(crate) free: u64,
    /// The addition for every byte that the files have on the disk, packed.
    pub(crate) per_byte: u64,
}

impl Allowance {
    const fn new(free: u64, per_byte: u64) -> Self {
        Self { free, per_byte }
    }

    /// Returns the limit for files of `stored` bytes.
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
    use std::{env, fs};

    const PAGE: &str = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/reference/limits.md"
    );
    const BEGIN: &str = "<!-- generated: limits -->\n";
    const END: &str = "<!-- end -->\n";

    fn allowances() -> String {
        let rows = [
            ("bytes that a `.gz` unpacks to", UNPACKED, "the file"),
            ("bytes of texts included again", TEXTS_AGAIN, "all texts"),
            ("directives", DIRECTIVES, "all texts"),
            ("parameters", PARAMETERS, "all texts"),
            ("bytes of other files read again", FILES_AGAIN, "all files"),
            ("primitives, and vertices", PRIMITIVES, "all files"),
            ("shapes", SHAPES, "all files"),
            ("mesh instances of glTF", INSTANCES, "all but images"),
            ("components of glTF accessors", COMPONENTS, "all but images"),
            ("numbers of an image", IMAGE, "the file"),
            ("numbers of all images of a scene", IMAGES, "all files"),
        ];
        let row = |(item, allowance, of): (&str, Allowance, &str)| {
            let Allowance { free, per_byte } = allowance;
            format!("| {item} | {free} | {per_byte} | {of} |\n")
        };
        let head = "| Item | Free | For every byte | Of |\n|---|---|---|---|\n";
        rows.map(row)
            .into_iter()
            .fold(head.into(), |all: String, row| all + &row)
    }

    fn others() -> String {
        let gib = |bytes: u64| format!("{} GiB", (bytes + 1) >> 30);
        let rows = [
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
            ("film file", gib(LARGEST_FILM)),
            ("text of a scene", gib(LONGEST_TEXT)),
            ("mesh file, unpacked", gib(LARGEST_MESH)),
            ("image file", gib(LARGEST_IMAGE)),
            ("file of glTF", gib(LARGEST_GLTF)),
            ("spectrum file", format!("{} MiB", LARGEST_SPECTRUM >> 20)),
            (
                "distinct warnings",
                format!("{MOST_WARNINGS}, then one for all others"),
            ),
        ];
        let row = |(item, limit): (&str, String)| format!("| {item} | {limit} |\n");
        let head = "| Item | Limit |\n|---|---|\n";
        rows.map(row)
            .into_iter()
            .fold(head.into(), |all: String, row| all + &row)
    }

    /// `BIDIR_WRITE_PAGES=1` writes the tables into the page.
    #[test]
    fn the_reference_has_these_limits() {
        let page = fs::read_to_string(PAGE).unwrap();
        let (before, rest) = page.split_once(BEGIN).expect("the page has the mark");
        let (_, after) = rest.split_once(END).expect("the page has the end");
        let tables = format!("{}\n{}", allowances(), others());
        let expected = format!("{before}{BEGIN}{tables}{END}{after}");
        if env::var_os("BIDIR_WRITE_PAGES").is_some() {
            fs::write(PAGE, expected).unwrap();
        } else {
            let how = "BIDIR_WRITE_PAGES=1 cargo test --release -p bidir-formats --lib limits";
            assert!(page == expected, "{PAGE} is stale: {how}");
        }
    }
}
