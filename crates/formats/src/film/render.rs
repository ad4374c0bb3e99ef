//! A render whose film can be continued: its session, and the header of its film.

use super::identity::{new, of_run};
use super::{FilmFile, FilmHeader, Stopping, Subject};
use bidir::driver::{Effort, Resources, Session, SessionError, Settings};
use bidir::film::{FilmError, MergeError};
use serde_json::Value;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

/// A session with the header of its film, which has time and counts of all runs.
pub struct Render<'a> {
    /// The session.
    pub session: Session<'a>,
    /// The header of an empty film.
    header: FilmHeader,
    /// The joined header of the films that the render continues. None: it begins anew.
    earlier: Option<FilmHeader>,
    /// True if a film that was taken counts the rays of training.
    is_training_counted: bool,
}

/// The reason why a render cannot continue a film.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ContinueError {
    /// It is the film of another render, with this difference.
    OtherRender(String),
    /// Its sums cannot be added.
    Merge(MergeError),
}

impl fmt::Display for ContinueError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherRender(difference) => write!(f, "the film of another render: {difference}"),
            Self::Merge(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ContinueError {}

impl Subject {
    /// Begins a render: trains its session.
    ///
    /// Errors: as [`Session::with_effort`].
    pub fn begin(
        &self,
        settings: &Settings,
        resources: &Resources,
        effort: Effort<'_>,
    ) -> Result<Render<'static>, SessionError> {
        let scene = Arc::clone(&self.scene);
        let session = Session::with_effort(scene, &self.view, settings.clone(), resources, effort)?;
        let header = self.header(settings, session.training());
        Ok(Render::new(session, header))
    }
}

impl<'a> Render<'a> {
    /// Begins anew; `header` is that of an empty film.
    pub fn new(session: Session<'a>, header: FilmHeader) -> Self {
        Self {
            session,
            header,
            earlier: None,
            is_training_counted: false,
        }
    }

    /// Adds a setting of the host to the identity of the film.
    #[must_use]
    pub fn identified_by(mut self, name: &str, value: String) -> Self {
        let mut settings = std::mem::take(&mut self.header.settings);
        settings.insert(name.to_owned(), value);
        self.header = new(&self.header.scene, settings);
        self
    }

    /// Returns the header of an empty film.
    pub fn empty(&self) -> &FilmHeader {
        &self.header
    }

    /// Adds a film of the same render, whose passes are not rendered again.
    ///
    /// Errors: it belongs to another render, or has passes that are here already.
    pub fn add(&mut self, file: FilmFile) -> Result<(), ContinueError> {
        let FilmFile { header, film } = file;
        if let Some(difference) = self.header.difference(&header) {
            return Err(ContinueError::OtherRender(difference));
        }
        self.session.add_film(film).map_err(ContinueError::Merge)?;
        let earlier = self.earlier.take();
        self.earlier = Some(match earlier {
            Some(earlier) => earlier.joined(&header),
            None => header,
        });
        Ok(())
    }

    /// Returns true if the film is the one that the render continues, with no pass more.
    pub fn is_unchanged(&self) -> bool {
        let passes = self.session.film().passes();
        let earlier = self.earlier.as_ref();
        earlier.is_some_and(|earlier| earlier.passes == *passes)
    }

    /// Returns the header of the film so far. `time` and `stopping` are those of this run. That of a film without a
    /// further pass stays as it was, so that its file does.
    pub fn header(&self, time: Duration, stopping: Stopping) -> FilmHeader {
        let all = match &self.earlier {
            Some(earlier) if self.is_unchanged() => return earlier.clone(),
            Some(earlier) => self.of_run(time).joined(earlier),
            None => self.of_run(time),
        };
        FilmHeader { stopping, ..all }.of(self.session.film())
    }

    /// Returns the header with time and counts of this run alone.
    fn of_run(&self, time: Duration) -> FilmHeader {
        let mut header = of_run(&self.header, &self.session, time);
        if self.is_training_counted
            && let Some(training) = header.counts.pointer_mut("/rays/training")
        {
            *training = Value::from(0);
        }
        header
    }

    /// Takes the film; the session goes on with an empty one, and does not count its training again.
    ///
    /// Errors: the system does not have the memory of another film; the render is as before.
    pub fn take(&mut self, time: Duration, stopping: Stopping) -> Result<FilmFile, FilmError> {
        let header = self.header(time, stopping);
        let (film, _) = self.session.take_film()?;
        self.earlier = None;
        self.is_training_counted = true;
        Ok(FilmFile { header, film })
    }

    /// Ends the render.
    pub fn into_file(self, time: Duration, stopping: Stopping) -> FilmFile {
        let header = self.header(time, stopping);
        let film = self.session.into_film();
        FilmFile { header, film }
    }
}
