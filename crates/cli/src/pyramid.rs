//! `bidir render --pyramid DIR`: the image of each strategy (s, t), weighted and raw, as layers of one EXR
//! ([`lab::pyramid`]).

use crate::exit::Failure;
use crate::scene_io::FilmHeader;
use bidir::film::Film;
use std::path::{Path, PathBuf};

/// Returns the file of a pyramid in its folder.
pub(crate) fn file(folder: &Path) -> PathBuf {
    folder.join("pyramid.exr")
}

/// Creates the folder of a pyramid if it does not exist; its parent has to exist.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        return Ok(());
    }
    std::fs::create_dir(folder).map_err(|error| Failure::io(folder, "make", &error))
}

/// Writes the images of strategies that `film` keeps; `header` is its header.
pub(crate) fn write(file: &Path, film: &Film, header: &FilmHeader) -> Result<(), Failure> {
    let metadata = formats::film::metadata(header);
    let developed = lab::pyramid::developed(film);
    developed.write_exr(file, film.settings(), &metadata)?;
    Ok(())
}
