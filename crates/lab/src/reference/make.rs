//! Making and extending references.

use super::agreement::{Renders, agreement};
use super::provenance::{EstimatorRecord, FORMAT, Provenance};
use super::replicate::{Estimator, Replicates, film};
use super::{AGAINST, Error, FILMS, PICTURE, PROVENANCE, Plan, REPLICATES, Reference, images};
use crate::image::digest;
use crate::results::Rays;
use crate::seal::sha256;
use bidir::ESTIMATOR_VERSION;
use bidir::driver::{Progress, Resources, Settings};
use bidir::film::{Aov, Layers};
use formats::film::{Developed, FilmHeader, SettingsText, Subject, metadata};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The first seed, far from the seeds that people choose.
const SEEDS: u64 = 1 << 40;
/// The prefixes of the film names of both estimators.
const NAMES: [&str; 2] = ["picture", "against"];

/// The host of [`make`].
#[derive(Clone, Copy)]
pub struct Host<'a> {
    /// Receives progress, may supply a clock, and may ask to stop. After a stop, a later [`make`] continues.
    pub progress: &'a dyn Progress,
    /// Receives the number of samples in existing films.
    pub found: &'a dyn Fn(u64),
}

/// Makes a reference in `folder`, which is created if needed. Continues from existing films, with the same
/// bits as a reference made in a single run.
///
/// A reference whose estimators disagree is also written and returned. None: the host asked to stop; the films
/// are written, and the same call continues.
///
/// Errors: a file cannot be read or written or is damaged; a film in the folder belongs to another render or
/// has more passes than requested; a render cannot start.
pub fn make(
    folder: &Path,
    subject: &Subject,
    plan: &Plan,
    resources: &Resources,
    host: Host<'_>,
) -> Result<Option<Reference>, Error> {
    let films = folder.join(FILMS);
    std::fs::create_dir_all(&films).map_err(|error| Error::io(&films, error))?;
    let replicates = |index: usize| {
        let estimator = Estimator {
            folder,
            subject,
            settings: seeded(&plan.estimators[index], index as u64),
            name: NAMES[index],
            passes: plan.passes(),
            resources,
        };
        estimator.replicates(host)
    };
    let Some(first) = replicates(0)? else {
        return Ok(None);
    };
    let Some(second) = replicates(1)? else {
        return Ok(None);
    };
    finish(folder, subject, plan, [&first, &second]).map(Some)
}

/// Returns the paths of all files of a reference in `folder`, existing or not.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let named = [PICTURE, AGAINST, PROVENANCE].map(|name| folder.join(name));
    named.into_iter().chain(films(folder)).collect()
}

/// Returns the paths of the films of both estimators.
fn films(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let films = NAMES
        .iter()
        .flat_map(|name| (0..REPLICATES).map(move |r| (name, r)));
    films.map(|(name, replicate)| film(folder, name, replicate))
}

/// Removes the provenance and the films of the reference in `folder`, so that the next one starts over.
pub fn clear(folder: &Path) -> Result<(), Error> {
    for path in std::iter::once(folder.join(PROVENANCE)).chain(films(folder)) {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(Error::io(&path, error));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Compares the replicates of both estimators, and writes images and provenance.
fn finish(
    folder: &Path,
    subject: &Subject,
    plan: &Plan,
    made: [&Replicates; 2],
) -> Result<Reference, Error> {
    let wholes = made.map(|replicates| images(replicates.film.develop()));
    let renders = [0, 1].map(|i| Renders {
        replicates: &made[i].pictures,
        whole: &wholes[i],
        passes: made[i].header.passes.len(),
    });
    let agreement = agreement(&renders)
        .ok_or_else(|| Error::damaged(folder, "the films have no pixels, or not one size"))?;
    let mut files = BTreeMap::new();
    for (name, replicates) in [PICTURE, AGAINST].into_iter().zip(made) {
        let path = folder.join(name);
        let (film, metadata) = (&replicates.film, metadata(&replicates.header));
        Developed::new(film).write_exr(&path, film.settings(), &metadata)?;
        let bytes = std::fs::read(&path).map_err(|error| Error::io(&path, error))?;
        files.insert(name.to_owned(), sha256(&bytes));
    }
    let [[picture, variance], _] = wholes;
    let header = &made[0].header;
    let provenance = Provenance {
        format: FORMAT,
        program: formats::film::program(),
        estimator_version: ESTIMATOR_VERSION,
        scene: subject.name.clone(),
        scene_digest: subject.digest.clone(),
        resolution: header.resolution,
        crop: header.crop,
        estimators: [0, 1].map(|i| record(&plan.estimators[i], i as u64, &made[i].header)),
        agreement,
        picture: digest(&[&picture, &variance]),
        files,
    };
    provenance.write(folder)?;
    Ok(Reference {
        folder: folder.to_owned(),
        picture,
        variance,
        provenance,
    })
}

/// Returns `settings` with the seed of the first replicate of estimator number `index`.
fn seeded(settings: &Settings, index: u64) -> Settings {
    let seeds = settings.seed.wrapping_mul(2).wrapping_add(index);
    Settings {
        seed: seeds.wrapping_mul(REPLICATES).wrapping_add(SEEDS),
        layers: Layers::new(&[Aov::Samples, Aov::Variance], &[], 0),
        ..settings.clone()
    }
}

fn record(settings: &Settings, index: u64, header: &FilmHeader) -> EstimatorRecord {
    let mut flags = SettingsText::from(settings).by_flag();
    flags.remove("seed");
    let rays = header.counts.get("rays").cloned().unwrap_or_default();
    let dropped = header.counts.get("dropped").and_then(Value::as_u64);
    EstimatorRecord {
        settings: flags,
        spp: header.passes.len(),
        replicates: REPLICATES,
        seed: settings.seed,
        first_seed: seeded(settings, index).seed,
        seconds: header.seconds,
        rays: serde_json::from_value::<Rays>(rays).unwrap_or_default(),
        dropped: dropped.unwrap_or_default(),
    }
}
