//! `bidir render --pyramid DIR`: the image of each strategy (s, t), weighted and raw, as layers of one EXR
//! and as contact sheets ([`lab::pyramid`]).

use crate::exit::Failure;
use crate::film_header;
use crate::scene_io::{self, Developed, FilmHeader};
use bidir::film::{Film, LayerImage};
use lab::pyramid::{self, Kind};
use std::path::{Path, PathBuf};

/// The files of a pyramid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Files {
    exr: PathBuf,
    weighted: PathBuf,
    raw: PathBuf,
}

impl Files {
    /// Returns the files in `folder`.
    pub(crate) fn new(folder: &Path) -> Self {
        let [exr, weighted, raw] =
            ["pyramid.exr", "weighted.png", "raw.png"].map(|name| folder.join(name));
        Self { exr, weighted, raw }
    }

    /// Returns all files.
    pub(crate) fn all(&self) -> [&PathBuf; 3] {
        [&self.exr, &self.weighted, &self.raw]
    }
}

/// Creates the folder of a pyramid if it does not exist; its parent has to exist.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        return Ok(());
    }
    std::fs::create_dir(folder).map_err(|error| Failure::io(folder, "make", &error))
}

/// Writes the images of strategies in `film`, which has this header.
pub(crate) fn write(files: &Files, film: &Film, header: &FilmHeader) -> Result<(), Failure> {
    let metadata = film_header::metadata(header);
    scene_io::write_exr(&files.exr, film.settings(), &developed(film), &metadata)?;
    let scene = header.scene_name();
    for (path, kind) in [(&files.weighted, Kind::Weighted), (&files.raw, Kind::Raw)] {
        scene_io::write_screen(path, &pyramid::sheet(film, kind, &scene))?;
    }
    Ok(())
}

/// Returns the picture with the images of strategies as its only layers.
fn developed(film: &Film) -> Developed {
    let layers = film.layers();
    let names = layers.part_names().enumerate();
    let images = names.skip(layers.light_groups().len());
    let images = images.map(|(part, name)| LayerImage {
        name,
        channels: &["R", "G", "B"],
        data: film.part_pixels(part).flatten().collect(),
    });
    Developed {
        picture: film.develop(),
        layers: images.collect(),
    }
}
