//! The replicates of an estimator: rendering, writing and continuing their films.

use super::make::{Host, Subject};
use super::{Error, FILMS, REPLICATES};
use crate::image::Pixels;
use bidir::driver::{Effort, Resources, Session, SessionError, Settings};
use bidir::film::{Film, PassSet};
use formats::film::{FilmFile, FilmHeader, Stopping};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The time between two writes of a growing film.
const WRITE_EVERY: Duration = Duration::from_secs(300);

/// An estimator that renders replicates.
pub(super) struct Estimator<'a> {
    pub(super) folder: &'a Path,
    pub(super) subject: &'a Subject<'a>,
    /// The settings of the first replicate; the seeds of the others follow its seed.
    pub(super) settings: Settings,
    /// The prefix of the names of its films.
    pub(super) name: &'static str,
    /// Passes of each replicate.
    pub(super) passes: u64,
    pub(super) resources: &'a Resources,
}

/// The replicates of an estimator, complete.
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
            let [picture, _] = super::picture::of(file.film.develop());
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
        let untrained = self.subject.identity().header(settings, None);
        let earlier = self.earlier(path, &untrained)?;
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
    fn earlier(&self, path: &Path, header: &FilmHeader) -> Result<Option<FilmFile>, Error> {
        if !path.exists() {
            return Ok(None);
        }
        let file = formats::film::read(path)?;
        check(path, header, &formats::film::untrained(&file.header))?;
        let passes = &file.header.passes;
        if passes.difference(&PassSet::from(0..self.passes)).is_empty() {
            return Ok(Some(file));
        }
        let most = passes.ranges().last().map_or(0, |range| range.end);
        Err(Error::TooLong {
            folder: self.folder.to_owned(),
            found: most.saturating_mul(REPLICATES),
            requested: self.passes.saturating_mul(REPLICATES),
        })
    }

    /// Starts the session of a replicate. None: the host asked to stop in training.
    fn session(&self, settings: &Settings, host: Host<'_>) -> Result<Option<Session<'_>>, Error> {
        let Subject { scene, view, .. } = self.subject;
        let effort = Effort {
            stop: host.progress.stop(),
            ..Effort::WHOLE
        };
        let settings = settings.clone();
        match Session::with_effort(*scene, view, settings, self.resources, effort) {
            Ok(session) => Ok(Some(session)),
            Err(SessionError::Stopped) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    fn render(
        &self,
        path: &Path,
        settings: &Settings,
        earlier: Option<FilmFile>,
        host: Host<'_>,
    ) -> Result<Option<FilmFile>, Error> {
        let start = host.progress.nanoseconds();
        let since = |start| Duration::from_nanos(host.progress.nanoseconds().saturating_sub(start));
        let Some(mut session) = self.session(settings, host)? else {
            return Ok(None);
        };
        let header = self.subject.identity();
        let header = header.header(settings, session.training());
        let before = earlier.as_ref().map(|file| file.header.clone());
        if let Some(file) = earlier {
            check(path, &header, &file.header)?;
            let added = session.add_film(file.film);
            added.map_err(|error| Error::merge(path, &error))?;
        }
        let write = |session: &Session<'_>, stopping| {
            let run = formats::film::of_run(&header, session, since(start));
            let all = before.as_ref().map_or(run.clone(), |old| run.joined(old));
            let header = FilmHeader { stopping, ..all }.of(session.film());
            formats::film::write(path, &header, session.film()).map(|()| header)
        };
        let mut written = start;
        while session.next_pass() < self.passes {
            if (host.should_end)() || !session.step(host.progress) {
                if !session.film().passes().is_empty() {
                    write(&session, Stopping::Time)?;
                }
                return Ok(None);
            }
            if since(written) >= WRITE_EVERY {
                write(&session, Stopping::Time)?;
                written = host.progress.nanoseconds();
            }
        }
        let header = write(&session, Stopping::Fixed)?;
        let film = session.into_film();
        Ok(Some(FilmFile { header, film }))
    }
}

/// Returns the path of a replicate's film in `folder`; `name` is the estimator's prefix.
pub(super) fn film(folder: &Path, name: &str, replicate: u64) -> PathBuf {
    let name = format!("{name}-{replicate:02}.film");
    folder.join(FILMS).join(name)
}

/// Fails if `found` is the header of another render than `expected`.
fn check(path: &Path, expected: &FilmHeader, found: &FilmHeader) -> Result<(), Error> {
    let difference = expected.difference(found);
    difference.map_or(Ok(()), |difference| {
        let path = path.to_owned();
        Err(Error::OtherRender { path, difference })
    })
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
