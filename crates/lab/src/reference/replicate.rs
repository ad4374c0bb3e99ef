//! The replicates of an estimator: rendering, writing and continuing their films.

use super::make::Host;
use super::{Error, FILMS, REPLICATES};
use crate::image::Pixels;
use bidir::driver::{Budget, Resources, SessionError, Settings};
use bidir::film::{Film, PassSet};
use formats::film::{FilmFile, FilmHeader, OpenError, Render, Subject};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The time between two writes of a growing film.
const WRITE_EVERY: Duration = Duration::from_secs(300);

/// An estimator that renders replicates.
pub(super) struct Estimator<'a> {
    pub(super) folder: &'a Path,
    pub(super) subject: &'a Subject,
    /// The settings of the first replicate; the seeds of the others follow its seed.
    pub(super) settings: Settings,
    /// The prefix of the names of its films.
    pub(super) name: &'static str,
    /// Passes of each replicate.
    pub(super) passes: u64,
    pub(super) resources: &'a Resources,
}

/// The complete replicates of an estimator.
pub(super) struct Replicates {
    /// All replicates in one film: pass p of replicate r is its pass r · n + p.
    pub(super) film: Film,
    /// The header, with total time and counts, and with the identity of the first replicate.
    pub(super) header: FilmHeader,
    /// The image of each replicate.
    pub(super) pictures: Vec<Pixels>,
}

impl Estimator<'_> {
    /// Returns the path of a replicate's film, which may not exist yet.
    fn film(&self, replicate: u64) -> PathBuf {
        film(self.folder, self.name, replicate)
    }

    /// Renders the missing passes of all replicates. None: the host asked to stop.
    pub(super) fn replicates(&self, host: Host<'_>) -> Result<Option<Replicates>, Error> {
        let mut all: Option<Replicates> = None;
        for replicate in 0..REPLICATES {
            let path = self.film(replicate);
            let settings = Settings {
                seed: self.settings.seed.wrapping_add(replicate),
                ..self.settings.clone()
            };
            let Some(file) = self.replicate(&path, &settings, host)? else {
                return Ok(None);
            };
            let merged = |error| Error::merge(&path, &error);
            let begin = replicate * self.passes;
            let film = moved(&file.film, begin..begin + self.passes).map_err(merged)?;
            let [picture, _] = super::images(file.film.develop());
            all = Some(match all {
                None => Replicates {
                    header: file.header,
                    pictures: vec![picture],
                    film,
                },
                Some(mut all) => {
                    all.film.merge(&film).map_err(merged)?;
                    all.header = all.header.joined(&file.header);
                    all.pictures.push(picture);
                    all
                }
            });
        }
        Ok(all.map(|all| Replicates {
            header: all.header.of(&all.film),
            ..all
        }))
    }

    /// Completes a replicate. None: the host asked to stop; its film is written.
    fn replicate(
        &self,
        path: &Path,
        settings: &Settings,
        host: Host<'_>,
    ) -> Result<Option<FilmFile>, Error> {
        let earlier = self.earlier(path, settings)?;
        if let Some(file) = &earlier {
            let area = self.subject.view.film().crop.area();
            (host.found)(file.header.passes.len() * area);
        }
        match earlier {
            Some(file) if file.header.passes.len() == self.passes => Ok(Some(file)),
            earlier => self.render(path, settings, earlier, host),
        }
    }

    /// Reads the existing film of a replicate, if any.
    ///
    /// Errors: it is damaged, belongs to another render, or has more passes than requested.
    fn earlier(&self, path: &Path, settings: &Settings) -> Result<Option<FilmFile>, Error> {
        if !path.exists() {
            return Ok(None);
        }
        let file = formats::film::read(path)?;
        let checked = self.subject.check(settings, &file.header, 0..self.passes);
        checked.map_err(|error| self.refused(path, error))?;
        Ok(Some(file))
    }

    fn render(
        &self,
        path: &Path,
        settings: &Settings,
        earlier: Option<FilmFile>,
        host: Host<'_>,
    ) -> Result<Option<FilmFile>, Error> {
        let budget = Budget {
            passes: Some(self.passes),
            ..Budget::default()
        };
        let (resources, progress) = (self.resources, host.progress);
        let opened = self
            .subject
            .open(settings, resources, &budget, earlier, progress);
        let mut render = match opened {
            Err(OpenError::Session(SessionError::Stopped)) => return Ok(None),
            opened => opened.map_err(|error| self.refused(path, error))?,
        };
        let (mut written, mut saved) = (render.spent.total, Ok(()));
        let limit = render.run(&budget, progress, &mut |render| {
            if render.spent.total.saturating_sub(written) >= WRITE_EVERY {
                (written, saved) = (render.spent.total, write(path, render));
            }
            saved.is_ok()
        });
        saved?;
        if !render.session.film().passes().is_empty() {
            write(path, &render)?;
        }
        Ok(limit.map(|_| render.into_file()))
    }

    /// Returns the error for a film that cannot be continued, or for a render that cannot begin.
    fn refused(&self, path: &Path, error: OpenError) -> Error {
        match error {
            OpenError::OtherRender(difference) => Error::OtherRender {
                path: path.to_owned(),
                difference,
            },
            OpenError::Beyond(passes) => {
                let most = passes.ranges().last().map_or(0, |range| range.end);
                Error::TooLong {
                    folder: self.folder.to_owned(),
                    found: most.saturating_mul(REPLICATES),
                    requested: self.passes.saturating_mul(REPLICATES),
                }
            }
            OpenError::Merge(error) => Error::merge(path, &error),
            OpenError::Session(error) => error.into(),
        }
    }
}

/// Writes the film of a render.
fn write(path: &Path, render: &Render) -> Result<(), Error> {
    let film = render.session.film();
    Ok(formats::film::write(path, &render.header(), film)?)
}

/// Returns the path of a replicate's film in `folder`; `name` is the estimator's prefix.
pub(super) fn film(folder: &Path, name: &str, replicate: u64) -> PathBuf {
    let name = format!("{name}-{replicate:02}.film");
    folder.join(FILMS).join(name)
}

/// Renumbers the passes of a film.
fn moved(film: &Film, passes: std::ops::Range<u64>) -> Result<Film, bidir::film::MergeError> {
    Film::restore(
        film.settings().clone(),
        film.layers().clone(),
        PassSet::from(passes),
        film.sums().to_vec(),
    )
}
