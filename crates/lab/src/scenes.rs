//! Where the scenes of built-in experiments are.
//!
//! Those of the project are kept in the program, so that it alone is enough: [`unpack`] writes them
//! into a folder. Those made by others lie in `pbrt-v4/` of a folder that somebody has.

use crate::experiment::{ReferenceSpec, SceneSpec};
use std::path::{Path, PathBuf};

/// A file of `scenes/` with its bytes.
type File = (&'static str, &'static [u8]);

macro_rules! files {
    ($($name:literal)*) => {
        &[$(($name, include_bytes!(concat!("../../../scenes/", $name)))),*]
    };
}

/// The scenes, and all that they read.
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

/// Writes the scenes into a folder, which is made where there is none.
pub(crate) fn unpack(folder: &Path) -> std::io::Result<()> {
    for (name, bytes) in FILES {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(folder))?;
        // What another run wrote is the same.
        if std::fs::read(&path).is_ok_and(|there| there == *bytes) {
            continue;
        }
        std::fs::write(&path, bytes)?;
    }
    Ok(())
}

/// Where a scene is after [`unpack`].
pub(crate) fn path(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.pbrt"))
}

/// Where a scene made by others is, in the folder that has them.
pub(crate) fn path_of_others(folder: &Path, name: &str) -> PathBuf {
    path(&folder.join("pbrt-v4").join(name), name)
}

/// A scene of an experiment, whose images have the experiment's size.
pub(crate) fn spec(name: &str, path: PathBuf, reference: ReferenceSpec) -> SceneSpec {
    let file = path.file_name().unwrap_or_default();
    SceneSpec {
        name: name.to_owned(),
        file: file.to_string_lossy().into_owned(),
        path,
        size: None,
        reference,
        places: [None, None],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use formats::pbrt::{LoadOptions, load};

    #[test]
    fn the_scenes_need_no_other_files() {
        let folder = tempfile::tempdir().unwrap();
        unpack(folder.path()).unwrap();
        unpack(folder.path()).unwrap();
        for name in [
            "room-direct",
            "room-indirect",
            "apartment",
            "apartment-dark",
        ] {
            let options = LoadOptions {
                resolution: Some([4, 3]),
                ..LoadOptions::default()
            };
            let loaded = load(&path(folder.path(), name), &options).unwrap();
            assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
            let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
            let here = load(&path(&own, name), &options).unwrap();
            assert_eq!(loaded.digest.to_string(), here.digest.to_string());
        }
    }
}
