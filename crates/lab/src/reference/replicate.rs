//! The replicates of an estimator: each is a render, which continues the film of its file.

use super::agreement::Renders;
use super::{Error, FILMS, Fault, Job, REPLICATES};
use crate::image::Pixels;
use bidir::driver::{Budget, SessionError};
use bidir::film::Film;
use formats::film::{FilmFile, OpenError, Render};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The time between two writes of a growing film.
const WRITE_EVERY: Duration = Duration::from_secs(300);
/// The prefixes of the film names of both estimators.
const NAMES: [&str; 2] = ["picture", "against"];

/// The complete replicates of an estimator.
pub(super) struct Replicates {
    /// All replicates in one film: pass p of replicate r is its pass r · n + p. The header has total time and counts,
    /// and the identity of the first replicate.
    pub(super) file: FilmFile,
    /// Their images.
    pub(super) renders: Renders,
}

impl Job<'_> {
    /// Renders the missing passes of all replicates of an estimator. None: the host asked to stop.
    pub(super) fn replicates(&self, estimator: usize) -> Result<Option<Replicates>, Error> {
        let Some(mut all) = self.replicate(estimator, 0)? else {
            return Ok(None);
        };
        let [first, _] = images(&all.film);
        let mut replicates = vec![first];
        for replicate in 1..REPLICATES {
            let Some(mut file) = self.replicate(estimator, replicate)? else {
                return Ok(None);
            };
            let [picture, _] = images(&file.film);
            replicates.push(picture);
            file.film = file.film.numbered_from(replicate * self.plan.passes());
            let path = film(self.folder, estimator, replicate);
            all.join(&file)
                .map_err(|error| Fault::Damaged.of(&path, error))?;
        }
        let renders = Renders {
            replicates,
            whole: images(&all.film),
            passes: all.film.passes().len(),
        };
        Ok(Some(Replicates { file: all, renders }))
    }

    /// Completes a replicate. None: the host asked to stop; its film is written.
    fn replicate(&self, estimator: usize, replicate: u64) -> Result<Option<FilmFile>, Error> {
        let path = film(self.folder, estimator, replicate);
        let settings = self.plan.settings(estimator, replicate);
        let budget = Budget {
            passes: Some(self.plan.passes()),
            ..Budget::default()
        };
        let refused = |error| self.refused(&path, error);
        let earlier = path.exists().then(|| formats::film::read(&path));
        let earlier = earlier.transpose()?;
        if let Some(FilmFile { header, .. }) = &earlier {
            let checked = self.subject.check(&settings, header, budget.range());
            checked.map_err(refused)?;
            let area = self.subject.view.film().crop.area();
            self.host.resume(header.passes.len() * area);
            if Some(header.passes.len()) == budget.passes {
                return Ok(earlier);
            }
        }
        let (resources, host) = (self.resources, self.host);
        let opened = self
            .subject
            .open(&settings, resources, &budget, earlier, host);
        match opened {
            Err(OpenError::Session(SessionError::Stopped)) => Ok(None),
            opened => self.complete(opened.map_err(refused)?, &budget, &path),
        }
    }

    /// Renders the passes of a budget, and writes the film at intervals and at the end. None: the host asked to stop.
    fn complete(
        &self,
        mut render: Render,
        budget: &Budget,
        path: &Path,
    ) -> Result<Option<FilmFile>, Error> {
        let write =
            |render: &Render| formats::film::write(path, &render.header(), render.session.film());
        let (mut written, mut saved) = (render.spent.total, Ok(()));
        let limit = render.run(budget, self.host, &mut |render| {
            if render.spent.total.saturating_sub(written) >= WRITE_EVERY {
                (written, saved) = (render.spent.total, write(render));
            }
            saved.is_ok()
        });
        saved?;
        if !render.session.film().passes().is_empty() {
            write(&render)?;
        }
        Ok(limit.map(|_| render.into_file()))
    }

    /// Returns the error for a film that cannot be continued, or for a render that cannot begin.
    fn refused(&self, path: &Path, error: OpenError) -> Error {
        match error {
            OpenError::Session(error) => error.into(),
            OpenError::Merge(error) => Fault::Damaged.of(path, error),
            error @ OpenError::OtherRender(_) => Fault::OtherRender.of(path, format!("is {error}")),
            OpenError::Beyond(passes) => {
                let most = passes.ranges().last().map_or(0, |range| range.end);
                let (found, requested) = (most.saturating_mul(REPLICATES), self.plan.rounded_spp());
                let reason = format!(
                    "has {found} samples per pixel already, more than the {requested} requested"
                );
                Fault::TooLong(found).of(self.folder, reason)
            }
        }
    }
}

/// Returns the image of a film, and the variances of its pixels.
fn images(film: &Film) -> [Pixels; 2] {
    let picture = film.develop();
    let size = [picture.width, picture.height];
    [picture.pixels, picture.variance].map(|data| Pixels { size, data })
}

/// Returns the path of a replicate's film in `folder`.
pub(super) fn film(folder: &Path, estimator: usize, replicate: u64) -> PathBuf {
    let name = format!("{}-{replicate:02}.film", NAMES[estimator]);
    folder.join(FILMS).join(name)
}
