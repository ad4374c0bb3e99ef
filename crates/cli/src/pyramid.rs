//! `bidir render --pyramid DIR`: what each strategy (s, t) does, weighted and raw, as layers of one EXR
//! ([`lab::pyramid`]).

use crate::exit::Failure;
use crate::film_header;
use crate::scene_io::FilmHeader;
use bidir::film::Film;
use std::path::{Path, PathBuf};

/// The file of a pyramid in its folder.
pub(crate) fn file(folder: &Path) -> PathBuf {
    folder.join("pyramid.exr")
}

/// Makes the folder of a pyramid where there is none; the one that it is in has to be there.
pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    if folder.is_dir() {
        return Ok(());
    }
    std::fs::create_dir(folder).map_err(|error| Failure::io(folder, "make", &error))
}

/// Writes what `film`, which has this header, keeps of strategies.
pub(crate) fn write(file: &Path, film: &Film, header: &FilmHeader) -> Result<(), Failure> {
    let metadata = film_header::metadata(header);
    let developed = lab::pyramid::developed(film);
    developed.write_exr(file, film.settings(), &metadata)?;
    Ok(())
}
