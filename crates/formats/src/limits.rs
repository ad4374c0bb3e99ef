//! The limits of readers. A test writes them to docs/reference/limits.md.
//!
//! The size of files on the disk bounds memory and time, so that a small file cannot demand much. Features
//! that expand a few bytes to many, such as packed texts, inclusions, subdivision and even images, have an
//! [`Allowance`]: a free part, and more for every byte.

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

/// Unpacked size of a packed file. Numbers as text pack to a tenth, DEFLATE packs to a thousandth at best.
/// Unit: bytes.
pub(crate) const UNPACKED: Allowance = Allowance::new(1 << 24, 64);
/// Size of texts that are included repeatedly. Unit: bytes.
pub(crate) const TEXTS_AGAIN: Allowance = Allowance::new(1 << 26, 16);
/// Number of directives. A text has several bytes for each, unless it is packed or included repeatedly.
pub(crate) const DIRECTIVES: Allowance = Allowance::new(1 << 18, 1);
/// Number of parameters of directives.
pub(crate) const PARAMETERS: Allowance = Allowance::new(1 << 20, 1);
/// Size of meshes, images, spectra and buffers that are read repeatedly. Unit: bytes.
pub(crate) const FILES_AGAIN: Allowance = Allowance::new(1 << 27, 128);
/// Number of primitives of a scene, and of vertices of its meshes; shared objects count once.
pub(crate) const PRIMITIVES: Allowance = Allowance::new(1 << 22, 16);
/// Number of stored shapes; emitting shapes of an object count once for each place.
pub(crate) const SHAPES: Allowance = Allowance::new(1 << 18, 1);
/// Number of mesh instances of a glTF file; in pbrt each has a directive.
pub(crate) const INSTANCES: Allowance = Allowance::new(1 << 18, 1);
/// Number of components that accessors of a glTF file read.
pub(crate) const COMPONENTS: Allowance = Allowance::new(1 << 26, 64);
/// Number of tests of a corner against others, for the concave polygons of a PLY mesh, by its unpacked bytes.
pub(crate) const EARS: Allowance = Allowance::new(1 << 18, 256);
/// Number of values of an image: pixels times channels.
pub(crate) const IMAGE: Allowance = Allowance::new(1 << 26, 128);
/// Number of cells in the bounds of all grids of NanoVDB files, stored or not.
pub(crate) const VOXELS: Allowance = Allowance::new(1 << 25, 64);
/// Number of values of all images of a scene.
pub(crate) const IMAGES: Allowance = Allowance::new(1 << 28, 128);

/// Unpacked size of one text, as places in it are 32-bit numbers. Unit: bytes.
pub(crate) const LONGEST_TEXT: u64 = u32::MAX as u64;
/// Depth of nested inclusions.
pub(crate) const DEEPEST_INCLUSION: usize = 64;
/// Number of all inclusions, each of which may open a file.
pub(crate) const MOST_INCLUSIONS: u64 = 1 << 16;
/// Depth of nested blocks.
pub(crate) const DEEPEST_BLOCK: usize = 1 << 16;
/// Number of parameters of `Attribute` directives for one kind of object; adding one copies all.
pub(crate) const MOST_DEFAULTS: usize = 64;
/// Number of values of these parameters.
pub(crate) const MOST_DEFAULT_VALUES: usize = 4096;
/// Maximum number of clouds, each of which is made of millions of cells.
pub(crate) const MOST_CLOUDS: usize = 32;
/// Number of different warnings, as each one searches the list.
pub(crate) const MOST_WARNINGS: usize = 200;
/// The warning that stands for all further ones.
pub(crate) const FURTHER_WARNINGS: &str = "further warnings, of other kinds";
/// Number of primitives, and of vertices, of a scene of any size, unless the caller sets another limit.
pub(crate) const MOST_PRIMITIVES: u64 = 1 << 28;
/// Number of subdivision steps, each of which quadruples the triangles.
pub(crate) const MOST_LEVELS: u32 = 10;
/// Number of cells of a grid along an axis. A ray may cross all of them, and 32-bit coordinates have to leave
/// enough bits for the position within a cell.
pub(crate) const LONGEST_GRID: usize = 1 << 14;
/// Depth of nested textures.
pub(crate) const DEEPEST_TEXTURE: usize = 32;
/// Number of textures that one texture combines.
pub(crate) const MOST_TEXTURES: usize = 1024;
/// Width and height of a film. Unit: pixels.
pub(crate) const LARGEST_SIDE: u32 = 1 << 16;
/// Unpacked size of a mesh file. Unit: bytes.
pub(crate) const LARGEST_MESH: u64 = 1 << 34;
/// Size of a NanoVDB file. Unit: bytes.
pub(crate) const LARGEST_GRID: u64 = 1 << 33;
/// Size of an image file. Unit: bytes.
pub(crate) const LARGEST_IMAGE: u64 = 1 << 33;
/// Number of values of an image of any size: 2 GiB.
pub(crate) const MOST_NUMBERS: u64 = 1 << 29;
/// Size of a glTF file, and of each file that it names. Unit: bytes.
pub(crate) const LARGEST_GLTF: u64 = 1 << 33;
/// Number of components of a glTF accessor without a buffer view.
pub(crate) const MOST_ZEROS: usize = 1 << 22;
/// Size of a spectrum file. Unit: bytes.
pub(crate) const LARGEST_SPECTRUM: u64 = 1 << 24;
/// Size of a film file. Unit: bytes.
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
            (
                "tests for concave polygons of a PLY mesh",
                EARS,
                "the file, unpacked",
            ),
            ("numbers of an image", IMAGE, "the file"),
            ("cells of NanoVDB grids", VOXELS, "all files"),
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
            ("clouds of noise", MOST_CLOUDS.to_string()),
            ("cells of a grid along an axis", LONGEST_GRID.to_string()),
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
