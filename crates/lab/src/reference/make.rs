//! Making and extending references.

use super::agreement::Agreement;
use super::provenance::{EstimatorRecord, FORMAT, Provenance};
use super::replicate::{Replicates, film};
use super::{AGAINST, Error, FILMS, Fault, PICTURE, PROVENANCE, Plan, REPLICATES};
use crate::image::digest;
use crate::seal::sha256;
use bidir::ESTIMATOR_VERSION;
use bidir::driver::{Progress, Resources};
use formats::film::{Developed, Subject, metadata};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A reference to make.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// Its folder, which is created if needed.
    pub folder: &'a Path,
    /// The scene.
    pub subject: &'a Subject,
    /// The settings.
    pub plan: &'a Plan,
    /// The resources.
    pub resources: &'a Resources,
    /// Receives progress, may supply a clock, and may ask to stop.
    pub host: &'a dyn Progress,
}

impl Job<'_> {
    /// Makes the reference. Continues from existing films, with the same bits as a reference made in a single run.
    ///
    /// A reference whose estimators disagree is also written and returned. None: the host asked to stop; the films
    /// are written, and the same call continues.
    ///
    /// Errors: a file cannot be read or written or is damaged; a film in the folder belongs to another render or
    /// has more passes than requested; a render cannot start.
    pub fn make(&self) -> Result<Option<Provenance>, Error> {
        let films = self.folder.join(FILMS);
        std::fs::create_dir_all(&films)
            .map_err(|error| formats::Error::io(&films, "make", &error))?;
        let Some(first) = self.replicates(0)? else {
            return Ok(None);
        };
        let Some(second) = self.replicates(1)? else {
            return Ok(None);
        };
        self.finish([first, second]).map(Some)
    }

    /// Compares the replicates of both estimators, and writes images and provenance.
    fn finish(&self, made: [Replicates; 2]) -> Result<Provenance, Error> {
        let agreement = Agreement::of(made.each_ref().map(|made| &made.renders));
        let no_pixels =
            || Fault::Damaged.of(self.folder, "the films have no pixels, or not one size");
        let agreement = agreement.ok_or_else(no_pixels)?;
        let mut files = BTreeMap::new();
        for (name, Replicates { file, .. }) in [PICTURE, AGAINST].into_iter().zip(&made) {
            let film = file.film.settings();
            let bytes = Developed::new(&file.film).encode_exr(film, &metadata(&file.header))?;
            formats::file::replace(&self.folder.join(name), &bytes)?;
            files.insert(name.to_owned(), sha256(&bytes));
        }
        let [first, second] = made;
        let headers = [first.file.header, second.file.header];
        let [picture, variance] = &first.renders.whole;
        let provenance = Provenance {
            folder: self.folder.to_owned(),
            format: FORMAT,
            program: formats::film::program(),
            estimator_version: ESTIMATOR_VERSION,
            scene: self.subject.name.clone(),
            scene_digest: self.subject.digest.clone(),
            resolution: headers[0].resolution,
            crop: headers[0].crop,
            estimators: [0, 1].map(|i| EstimatorRecord::new(self.plan, i, &headers[i])),
            agreement,
            picture: digest(&[picture, variance]),
            files,
        };
        provenance.write()?;
        Ok(provenance)
    }
}

/// Returns the paths of all files of a reference in `folder`, existing or not.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let named = [PICTURE, AGAINST, PROVENANCE].map(|name| folder.join(name));
    let replicates = (0..2).flat_map(|i| (0..REPLICATES).map(move |r| (i, r)));
    let films = replicates.map(|(estimator, replicate)| film(folder, estimator, replicate));
    named.into_iter().chain(films).collect()
}

/// Removes the files of the reference in `folder`, so that the next one starts over.
pub fn clear(folder: &Path) -> Result<(), Error> {
    for path in files(folder).iter().filter(|path| path.exists()) {
        std::fs::remove_file(path).map_err(|error| formats::Error::io(path, "remove", &error))?;
    }
    Ok(())
}
