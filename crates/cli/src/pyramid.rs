//! `bidir render --pyramid DIR`: what each strategy (s, t) does, weighted and raw, as layers of one
//! EXR and as contact sheets ([`lab::pyramid`]).

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
    /// The files in `folder`.
    pub(crate) fn new(folder: &Path) -> Self {
        let [exr, weighted, raw] =
            ["pyramid.exr", "weighted.png", "raw.png"].map(|name| folder.join(name));
        Self { exr, weighted, raw }
    }

    /// All of them.
    pub(crate) fn all(&self) -> [&PathBuf; 3] {
        [&self.exr, &self.weighted, &self.raw]
    }
}

/// Makes the folder of a pyramid where there is none; the one that it is in has to be there.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        return Ok(());
    }
    std::fs::create_dir(folder).map_err(|error| Failure::io(folder, "make", &error))
}

/// Writes what `film`, which has this header, keeps of strategies.
pub(crate) fn write(files: &Files, film: &Film, header: &FilmHeader) -> Result<(), Failure> {
    let metadata = film_header::metadata(header);
    developed(film).write_exr(&files.exr, film.settings(), &metadata)?;
    let scene = header.scene_name();
    for (path, kind) in [(&files.weighted, Kind::Weighted), (&files.raw, Kind::Raw)] {
        scene_io::write_screen(path, &pyramid::sheet(film, kind, &scene))?;
    }
    Ok(())
}

/// The picture with the images of strategies alone.
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
