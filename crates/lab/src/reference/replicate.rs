//! The replicates of an estimator: rendering, writing and continuing their films.

use super::make::Host;
use super::{Error, FILMS, REPLICATES};
use crate::image::Pixels;
use bidir::driver::{Effort, Resources, SessionError, Settings};
use bidir::film::{Film, PassSet};
use formats::film::{FilmFile, FilmHeader, Render, Stopping, Subject};
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
        let untrained = self.subject.header(settings, None);
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

    fn render(
        &self,
        path: &Path,
        settings: &Settings,
        earlier: Option<FilmFile>,
        host: Host<'_>,
    ) -> Result<Option<FilmFile>, Error> {
        let start = host.progress.nanoseconds();
        let since = |start| Duration::from_nanos(host.progress.nanoseconds().saturating_sub(start));
        let effort = Effort {
            stop: host.progress.stop(),
            ..Effort::WHOLE
        };
        let begun = self.subject.begin(settings, self.resources, effort);
        let mut render = match begun {
            Err(SessionError::Stopped) => return Ok(None),
            begun => begun?,
        };
        if let Some(file) = earlier {
            let continued = render.add(file);
            continued.map_err(|error| Error::continued(path, error))?;
        }
        let mut written = start;
        while render.session.next_pass() < self.passes {
            if (host.should_end)() || !render.session.step(host.progress) {
                if !render.session.film().passes().is_empty() {
                    write(path, &render, since(start))?;
                }
                return Ok(None);
            }
            if since(written) >= WRITE_EVERY {
                write(path, &render, since(start))?;
                written = host.progress.nanoseconds();
            }
        }
        let file = render.into_file(since(start), Stopping::Fixed);
        formats::film::write(path, &file.header, &file.film)?;
        Ok(Some(file))
    }
}

/// Writes the film of a render that may be interrupted, which took `time` so far.
fn write(path: &Path, render: &Render<'_>, time: Duration) -> Result<(), Error> {
    let header = render.header(time, Stopping::Time);
    Ok(formats::film::write(path, &header, render.session.film())?)
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
