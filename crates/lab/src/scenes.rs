//! The scenes of built-in experiments, embedded in the program.

use formats::scene::{Files, InMemory};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The name of a file in `scenes/`, and its bytes.
type File = (&'static str, &'static [u8]);

macro_rules! files {
    ($folder:literal $ending:literal $($name:literal)*) => {
        [$((
            concat!($folder, $name, $ending),
            include_bytes!(concat!("../../../scenes/", $folder, $name, $ending)).as_slice(),
        )),*]
    };
}

/// The scenes, and all files that they read.
const SCENES: [File; 4] = files!["" ".pbrt"
    "room-direct" "room-indirect" "apartment" "apartment-dark"
];
const PARTS: [File; 3] = files!["parts/" ".pbrt"
    "apartment-rooms" "materials" "room-furniture"
];
const MESHES: [File; 71] = files!["meshes/" ".ply"
    "apartment-casings" "apartment-hall-wall" "apartment-kitchen-wall" "apartment-living-wall"
    "apartment-skirting" "armchair-feet" "armchair-frame" "armchair-seat" "bed-blanket"
    "bed-fold" "bed-frame" "bed-mattress" "bed-pillows" "bench-pad" "bookcase-2-book-blue"
    "bookcase-2-book-cream" "bookcase-2-book-green" "bookcase-2-book-ochre"
    "bookcase-2-book-plum" "bookcase-2-book-red" "bookcase-2-case" "bookcase-book-blue"
    "bookcase-book-cream" "bookcase-book-green" "bookcase-book-ochre" "bookcase-book-plum"
    "bookcase-book-red" "bookcase-case" "chair-frame" "chair-pad" "clay-vase-clay"
    "cupboard-high-knobs" "cupboard-low-knobs" "curtain-left-cloth" "curtain-right-cloth"
    "desk-lamp-arm" "desk-lamp-shade" "desk-wood" "door-handle" "glass-vase-glass"
    "globe-mount-mount" "half-door-handle" "kitchen-table-wood" "low-table-wood"
    "metal-bowl-metal" "night-table-wood" "pendant-lining" "pendant-rose" "pendant-shade"
    "pillow-cover" "plant-leaves" "plant-pot" "plant-stems" "room-rail-rail" "round-table-foot"
    "round-table-top" "sofa-feet" "sofa-frame" "sofa-seat" "stool-legs" "stool-seat"
    "table-lamp-foot" "table-lamp-shade" "tray-candle" "tray-tray" "uplighter-bowl"
    "uplighter-lining" "uplighter-stand" "wardrobe-doors" "wardrobe-knobs" "worktop-slab"
];

/// The folder at the beginning of the names of the scenes.
const FOLDER: &str = "scenes";

/// Returns the embedded scenes, without access to the disk.
pub(crate) fn files() -> Files {
    let embedded = SCENES.into_iter().chain(PARTS).chain(MESHES);
    let files = embedded.map(|(name, bytes)| (path(name), Arc::from(bytes)));
    Files::only(files.collect::<InMemory>())
}

fn path(name: &str) -> PathBuf {
    Path::new(FOLDER).join(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use formats::pbrt::{LoadOptions, load};
    use formats::scene::load_from;

    #[test]
    fn the_scenes_need_no_other_files() {
        let options = LoadOptions {
            resolution: Some([4, 3]),
            ..LoadOptions::default()
        };
        for (name, _) in SCENES {
            let loaded = load_from(&path(name), &options, &files()).unwrap();
            assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
            let there = load(&root.join(path(name)), &options).unwrap();
            assert_eq!(loaded.digest.to_string(), there.digest.to_string());
        }
    }
}
