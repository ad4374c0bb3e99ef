//! A render: its session, its time, and the film that it continues.
//!
//! All hosts (the command, the laboratory, references, the viewer and the Python package) render by one contract.
//!
//! A host gives
//!
//! - a [`Subject`], and settings with every request applied;
//! - itself as [`Progress`]: its clock, which measures all time, and its stop, which ends training or the
//!   running pass. A [`Watch`] is a host that has only these two;
//! - a [`Budget`], and a film to continue, if there is one.
//!
//! [`Subject::open`] refuses a film that does not belong to the render, trains, and adds the film.
//! [`Render::run`] renders pass by pass until the budget is used up, and calls the host after each pass, which may
//! look, save, show, and end the run. A host with an order of its own calls [`Render::step`] instead.
//!
//! A host gets the film with its [`header`](Render::header): time and counts of all runs, and the rule that ended
//! the last one. An interrupted pass adds nothing to the film. So the bits depend only on settings and passes, not on
//! threads, on interruptions, or on the number of runs.

use super::identity::{counts, new, training_samples, untrained};
use super::{FilmFile, FilmHeader, Subject};
use bidir::driver::{
    Budget, Effort, Progress, Resources, Session, SessionError, Settings, Spent, Stop, Stopping,
};
use bidir::film::{FilmError, MergeError, PassSet};
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;

/// A session, and the header of its film with the time and counts of all runs.
pub struct Render {
    /// The session.
    pub session: Session<'static>,
    /// The passes and the time of this run so far.
    pub spent: Spent,
    /// The rule that ends the run. [`Self::reached`] sets it, or a host that calls [`Self::step`].
    pub stopping: Stopping,
    /// The header of an empty film.
    header: FilmHeader,
    /// The joined header of the films that the render continues. None: it begins anew.
    earlier: Option<FilmHeader>,
    /// True if a film that was taken counts the rays of training.
    is_training_counted: bool,
}

/// A host that has a stop and a clock, and ignores progress.
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    /// The stop of the host.
    pub stop: Stop<'a>,
    /// The origin of the host's clock.
    pub start: Instant,
}

impl Progress for Watch<'_> {
    fn advance(&self, _samples: u64) {}

    fn stop(&self) -> Stop<'_> {
        self.stop
    }

    fn nanoseconds(&self) -> u64 {
        u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

/// The limits of training. They do not depend on the number of passes, so that a part of a render is trained as the
/// whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrainingLimits {
    /// The maximum number of samples.
    pub samples: u64,
    /// The time of the render, of which training gets the part [`Effort::PART`]. None: the time of training has no
    /// limit.
    pub time: Option<Duration>,
}

impl TrainingLimits {
    /// Nothing limits training.
    pub const NONE: Self = Self {
        samples: u64::MAX,
        time: None,
    };

    /// Returns the training limits of a render with this time. A render that continues a film repeats the training of
    /// its header `earlier`.
    pub fn new(time: Option<Duration>, earlier: Option<&FilmHeader>) -> Self {
        match earlier {
            None => Self { time, ..Self::NONE },
            Some(earlier) => Self {
                samples: training_samples(earlier).unwrap_or(u64::MAX),
                time: None,
            },
        }
    }
}

/// The reason why a render cannot begin or continue a film.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum OpenError {
    /// The film belongs to another render, with this difference.
    #[error("the film of another render: {0}")]
    OtherRender(String),
    /// The film has these passes, which the budget does not have.
    #[error("it has the passes {0}, which are not asked for")]
    Beyond(PassSet),
    /// The sums of the film cannot be added.
    #[error("{0}")]
    Merge(MergeError),
    /// The session cannot begin.
    #[error("{0}")]
    Session(SessionError),
}

impl Subject {
    /// Begins a render: trains its session.
    ///
    /// Errors: as [`Session::with_effort`].
    pub fn begin(
        &self,
        settings: &Settings,
        resources: &Resources,
        limits: TrainingLimits,
        host: &dyn Progress,
    ) -> Result<Render, SessionError> {
        let begin = host.nanoseconds();
        let part = limits.time.map(|time| time / Effort::PART);
        let effort = Effort {
            samples: limits.samples,
            is_late: &|| part.is_some_and(|part| since(begin, host) >= part),
            stop: host.stop(),
        };
        let scene = Arc::clone(&self.scene);
        let session = Session::with_effort(scene, &self.view, settings.clone(), resources, effort)?;
        Ok(Render {
            header: self.header(settings, session.training()),
            spent: Spent {
                passes: 0,
                total: since(begin, host),
                rendering: Duration::ZERO,
            },
            session,
            stopping: Stopping::Fixed,
            earlier: None,
            is_training_counted: false,
        })
    }

    /// Begins the render of a budget, which continues the film `earlier`.
    ///
    /// Errors: the film belongs to another render, or has passes beyond the budget; the session cannot begin.
    pub fn open(
        &self,
        settings: &Settings,
        resources: &Resources,
        budget: &Budget,
        earlier: Option<FilmFile>,
        host: &dyn Progress,
    ) -> Result<Render, OpenError> {
        let header = earlier.as_ref().map(|file| &file.header);
        header.map_or(Ok(()), |header| {
            self.check(settings, header, budget.range())
        })?;
        let limits = TrainingLimits::new(budget.time, header);
        let begun = self.begin(settings, resources, limits, host);
        let mut render = begun.map_err(OpenError::Session)?;
        earlier.map_or(Ok(()), |file| render.add(file))?;
        render.session.start_at(budget.first);
        Ok(render)
    }

    /// Checks before training that a film belongs to the render with these settings, and has only passes in
    /// `requested`.
    pub fn check(
        &self,
        settings: &Settings,
        film: &FilmHeader,
        requested: Range<u64>,
    ) -> Result<(), OpenError> {
        check_same(&self.header(settings, None), &untrained(film))?;
        let others = film.passes.difference(&PassSet::from(requested));
        if others.is_empty() {
            return Ok(());
        }
        Err(OpenError::Beyond(others))
    }
}

impl Render {
    /// Adds a setting of the host to the identity of the film.
    #[must_use]
    pub fn identified_by(mut self, name: &str, value: String) -> Self {
        let mut settings = std::mem::take(&mut self.header.settings);
        settings.insert(name.to_owned(), value);
        self.header = new(&self.header.scene, settings);
        self
    }

    /// Returns the identity of the render's films.
    pub fn identity(&self) -> &str {
        &self.header.identity
    }

    /// Adds a film of the same render, whose passes are not rendered again.
    ///
    /// Errors: the film belongs to another render, or has passes that this one has already.
    pub fn add(&mut self, file: FilmFile) -> Result<(), OpenError> {
        let FilmFile { header, film } = file;
        check_same(&self.header, &header)?;
        self.session.add_film(film).map_err(OpenError::Merge)?;
        let earlier = self.earlier.take();
        self.earlier = Some(match earlier {
            Some(earlier) => earlier.joined(&header),
            None => header,
        });
        Ok(())
    }

    /// Renders the next pass. Returns false if the host asked to stop; then the film does not get the pass.
    pub fn step(&mut self, host: &dyn Progress) -> bool {
        self.pass(&mut host.nanoseconds(), host)
    }

    /// Renders the next pass, adds the time since `last`, a reading of the host's clock, and sets `last` to the reading
    /// after the pass.
    fn pass(&mut self, last: &mut u64, host: &dyn Progress) -> bool {
        let is_done = self.session.step(host);
        let time = since(*last, host);
        *last += time.as_nanos() as u64;
        self.spent.total += time;
        if is_done {
            self.spent.rendering += time;
            self.spent.passes += 1;
        }
        is_done
    }

    /// Returns the rule of the budget that ends the render before its next pass, which becomes that of its end. None:
    /// another pass follows.
    pub fn reached(&mut self, budget: &Budget) -> Option<Stopping> {
        let rule = budget.reached(&self.session, self.spent);
        self.stopping = rule.unwrap_or(Stopping::Time);
        rule
    }

    /// Renders pass by pass until the budget is used up, and returns its rule. None: the host asked to stop, or
    /// `goes_on` returned false, which is called after each pass, and whose time counts in that of the next one.
    ///
    /// A stop has no effect on a render that is complete. The first pass is not begun after the time.
    pub fn run(
        &mut self,
        budget: &Budget,
        host: &dyn Progress,
        goes_on: &mut dyn FnMut(&Self) -> bool,
    ) -> Option<Stopping> {
        let mut last = host.nanoseconds();
        loop {
            if let Some(rule) = self.reached(budget) {
                return Some(rule);
            }
            let is_over = budget.time.is_some_and(|time| self.spent.total >= time);
            if is_over || host.stop().is_asked() || !self.pass(&mut last, host) || !goes_on(self) {
                return None;
            }
        }
    }

    /// Returns true if the film is the one that the render continues, with no pass more.
    pub fn is_unchanged(&self) -> bool {
        let passes = self.session.film().passes();
        let earlier = self.earlier.as_ref();
        earlier.is_some_and(|earlier| earlier.passes == *passes)
    }

    /// Returns the header of the film so far. If no pass was added, returns the header that was read, so that the
    /// file of the film does not change.
    pub fn header(&self) -> FilmHeader {
        let all = match &self.earlier {
            Some(earlier) if self.is_unchanged() => return earlier.clone(),
            Some(earlier) => self.of_run().joined(earlier),
            None => self.of_run(),
        };
        let stopping = self.stopping;
        FilmHeader { stopping, ..all }.of(self.session.film())
    }

    /// Returns the header with the time and counts of only this run.
    fn of_run(&self) -> FilmHeader {
        let trained = self.session.training();
        let training = trained.filter(|_| !self.is_training_counted);
        FilmHeader {
            seconds: self.spent.total.as_secs_f64(),
            counts: counts(self.session.stats(), training),
            ..self.header.clone()
        }
    }

    /// Copies the film.
    ///
    /// Errors: the system does not have the memory of another film.
    pub fn file(&self) -> Result<FilmFile, FilmError> {
        let film = self.session.film().try_clone()?;
        Ok(FilmFile {
            header: self.header(),
            film,
        })
    }

    /// Takes the film, and leaves an empty one, whose counts will not contain the training again.
    ///
    /// Errors: the system does not have the memory of another film. Then the render is unchanged.
    pub fn take(&mut self) -> Result<FilmFile, FilmError> {
        let header = self.header();
        let (film, _) = self.session.take_film()?;
        self.earlier = None;
        self.is_training_counted = true;
        self.spent = Spent::default();
        Ok(FilmFile { header, film })
    }

    /// Ends the render.
    pub fn into_file(self) -> FilmFile {
        let header = self.header();
        let film = self.session.into_film();
        FilmFile { header, film }
    }
}

/// Checks that `in_film` is a header of the same render as `expected`.
fn check_same(expected: &FilmHeader, in_film: &FilmHeader) -> Result<(), OpenError> {
    let places = ["in this render", "in the film"];
    let difference = expected.difference_between(in_film, places);
    difference.map_or(Ok(()), |difference| Err(OpenError::OtherRender(difference)))
}

/// Returns the time since the reading `begin` of the host's clock.
fn since(begin: u64, host: &dyn Progress) -> Duration {
    Duration::from_nanos(host.nanoseconds().saturating_sub(begin))
}
