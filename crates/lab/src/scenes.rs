//! The scenes of built-in experiments, embedded in the program.

use formats::scene::{Files, InMemory};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The name of a file in `scenes/`, and its bytes.
type File = (&'static str, &'static [u8]);

macro_rules! files {
    ($($name:literal)*) => {
        &[$(($name, include_bytes!(concat!("../../../scenes/", $name)))),*]
    };
}

/// The scenes, and all files that they read.
#[rustfmt::skip]
const FILES: &[File] = files![
    "room-direct.pbrt"
    "room-indirect.pbrt"
    "apartment.pbrt"
    "apartment-dark.pbrt"
    "parts/apartment-rooms.pbrt"
    "parts/materials.pbrt"
    "parts/room-furniture.pbrt"
    "meshes/apartment-casings.ply"
    "meshes/apartment-hall-wall.ply"
    "meshes/apartment-kitchen-wall.ply"
    "meshes/apartment-living-wall.ply"
    "meshes/apartment-skirting.ply"
    "meshes/armchair-feet.ply"
    "meshes/armchair-frame.ply"
    "meshes/armchair-seat.ply"
    "meshes/bed-blanket.ply"
    "meshes/bed-fold.ply"
    "meshes/bed-frame.ply"
    "meshes/bed-mattress.ply"
    "meshes/bed-pillows.ply"
    "meshes/bench-pad.ply"
    "meshes/bookcase-2-book-blue.ply"
    "meshes/bookcase-2-book-cream.ply"
    "meshes/bookcase-2-book-green.ply"
    "meshes/bookcase-2-book-ochre.ply"
    "meshes/bookcase-2-book-plum.ply"
    "meshes/bookcase-2-book-red.ply"
    "meshes/bookcase-2-case.ply"
    "meshes/bookcase-book-blue.ply"
    "meshes/bookcase-book-cream.ply"
    "meshes/bookcase-book-green.ply"
    "meshes/bookcase-book-ochre.ply"
    "meshes/bookcase-book-plum.ply"
    "meshes/bookcase-book-red.ply"
    "meshes/bookcase-case.ply"
    "meshes/chair-frame.ply"
    "meshes/chair-pad.ply"
    "meshes/clay-vase-clay.ply"
    "meshes/cupboard-high-knobs.ply"
    "meshes/cupboard-low-knobs.ply"
    "meshes/curtain-left-cloth.ply"
    "meshes/curtain-right-cloth.ply"
    "meshes/desk-lamp-arm.ply"
    "meshes/desk-lamp-shade.ply"
    "meshes/desk-wood.ply"
    "meshes/door-handle.ply"
    "meshes/glass-vase-glass.ply"
    "meshes/globe-mount-mount.ply"
    "meshes/half-door-handle.ply"
    "meshes/kitchen-table-wood.ply"
    "meshes/low-table-wood.ply"
    "meshes/metal-bowl-metal.ply"
    "meshes/night-table-wood.ply"
    "meshes/pendant-lining.ply"
    "meshes/pendant-rose.ply"
    "meshes/pendant-shade.ply"
    "meshes/pillow-cover.ply"
    "meshes/plant-leaves.ply"
    "meshes/plant-pot.ply"
    "meshes/plant-stems.ply"
    "meshes/room-rail-rail.ply"
    "meshes/round-table-foot.ply"
    "meshes/round-table-top.ply"
    "meshes/sofa-feet.ply"
    "meshes/sofa-frame.ply"
    "meshes/sofa-seat.ply"
    "meshes/stool-legs.ply"
    "meshes/stool-seat.ply"
    "meshes/table-lamp-foot.ply"
    "meshes/table-lamp-shade.ply"
    "meshes/tray-candle.ply"
    "meshes/tray-tray.ply"
    "meshes/uplighter-bowl.ply"
    "meshes/uplighter-lining.ply"
    "meshes/uplighter-stand.ply"
    "meshes/wardrobe-doors.ply"
    "meshes/wardrobe-knobs.ply"
    "meshes/worktop-slab.ply"
];

/// The folder at the beginning of their names.
const FOLDER: &str = "scenes";

/// Returns the embedded scenes, without access to the disk.
pub(crate) fn files() -> Files {
    let files = FILES.iter();
    let files = files.map(|(name, bytes)| (path(name), Arc::from(*bytes)));
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
        for (name, _) in FILES.iter().filter(|(name, _)| !name.contains('/')) {
            let loaded = load_from(&path(name), &options, &files()).unwrap();
            assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
            let there = load(&root.join(path(name)), &options).unwrap();
            assert_eq!(loaded.digest.to_string(), there.digest.to_string());
        }
    }
}
