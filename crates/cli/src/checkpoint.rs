//! The film file of a running render: what it goes on from, and what is written now and then.

use crate::args::LongArgs;
use crate::exit::{Exit, Failure};
use crate::film_header;
use crate::lock::{self, FilmLock};
use crate::scene_io::{self, FilmFile, FilmHeader, Stopping};
use bidir::driver::Session;
use bidir::film::{Film, PassSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A film file that this process alone writes.
#[derive(Debug)]
struct Checkpoint {
    path: PathBuf,
    every: Duration,
    written: Instant,
    /// True where the file is there and can be read.
    is_whole: bool,
    _lock: FilmLock,
}

impl Checkpoint {
    /// The film file that the flags ask for, if any, and the film in it that is gone on from.
    ///
    /// Errors: another process writes the same file; it is there and nothing was said of it; it is
    /// damaged; it is not of the render that `header` describes, or has other passes than `asked`.
    fn open(
        args: &LongArgs,
        header: &FilmHeader,
        asked: Range<u64>,
    ) -> Result<Option<(Self, Option<FilmFile>)>, Failure> {
        let Some(path) = &args.checkpoint else {
            return Ok(None);
        };
        scene_io::check_writable(path)?;
        let path = scene_io::target_of(path);
        let lock = FilmLock::take(&path)?;
        check_existing(&path, args)?;
        let film = if path.exists() && args.resume {
            Some(load(&path, header, asked)?)
        } else {
            None
        };
        let checkpoint = Self {
            // What is damaged shall not push out the whole file before it.
            is_whole: film.is_some() || scene_io::read_film(&path).is_ok(),
            path,
            every: args.checkpoint_every.0,
            written: Instant::now(),
            _lock: lock,
        };
        Ok(Some((checkpoint, film)))
    }

    /// Writes the film, and keeps the file before as FILE.previous.
    fn write(&mut self, header: &FilmHeader, film: &Film) -> Result<(), Failure> {
        // A disk that is full shall not be asked again after every pass.
        self.written = Instant::now();
        if self.is_whole {
            let previous = lock::previous(&self.path);
            return scene_io::write_film_keeping(&self.path, &previous, header, film);
        }
        scene_io::write_film(&self.path, header, film)?;
        self.is_whole = true;
        Ok(())
    }
}

/// Refuses to replace what is there unasked, and what is no film file at all.
fn check_existing(path: &Path, args: &LongArgs) -> Result<(), Failure> {
    let previous = lock::previous(path);
    let name = path.display();
    let failure = |message: String, hint: String| Err(Failure::usage(message).with_hint(hint));
    if !path.exists() {
        if args.restart || !previous.exists() {
            return Ok(());
        }
        let message = format!("{name}: there is none, but the one before it is there");
        let hint = format!(
            "rename {} to go on from it, or begin anew with --restart",
            previous.display()
        );
        return failure(message, hint);
    }
    if args.restart && !scene_io::is_film(path) {
        let message = format!("{name}: not a film file, and so not replaced by one");
        return failure(message, "give --checkpoint another name".into());
    }
    if !args.resume && !args.restart {
        let message = format!("{name}: there is a film file already");
        let hint = "go on from it with --resume, or begin anew with --restart";
        return failure(message, hint.into());
    }
    Ok(())
}

/// What a running render writes to its film file, if it has one.
pub(crate) struct Keeper {
    checkpoint: Option<Checkpoint>,
    header: FilmHeader,
    /// That of the film that was gone on from.
    earlier: Option<FilmHeader>,
    start: Instant,
}

impl Keeper {
    /// Opens the film file that the flags ask for, and gives its film to `session`, which is to
    /// render the passes `asked`.
    ///
    /// Errors: as [`Checkpoint::open`].
    pub(crate) fn open(
        args: &LongArgs,
        header: FilmHeader,
        session: &mut Session<'_>,
        asked: Range<u64>,
    ) -> Result<Self, Failure> {
        let (checkpoint, file) = Checkpoint::open(args, &header, asked)?.unzip();
        let mut earlier = None;
        if let Some(FilmFile { header, film }) = file.flatten() {
            session
                .add_film(film)
                .map_err(|error| Failure::new(Exit::FilmMismatch, error.to_string()))?;
            earlier = Some(header);
        }
        Ok(Self {
            checkpoint,
            header,
            earlier,
            start: Instant::now(),
        })
    }

    /// The name of the film file. None: there is none.
    pub(crate) fn path(&self) -> Option<&Path> {
        Some(&self.checkpoint.as_ref()?.path)
    }

    /// Is it time to write again?
    pub(crate) fn is_due(&self) -> bool {
        let is_due = |file: &Checkpoint| file.written.elapsed() >= file.every;
        self.checkpoint.as_ref().is_some_and(is_due)
    }

    /// Writes what `session` has.
    pub(crate) fn keep(
        &mut self,
        session: &Session<'_>,
        stopping: Stopping,
    ) -> Result<(), Failure> {
        let Some(checkpoint) = &mut self.checkpoint else {
            return Ok(());
        };
        // Nothing was added: what the file says of its passes stays true.
        let passes = session.film().passes();
        if self
            .earlier
            .as_ref()
            .is_some_and(|earlier| earlier.passes == *passes)
        {
            return Ok(());
        }
        let now = film_header::of_run(&self.header, session, self.start.elapsed());
        let all = self
            .earlier
            .as_ref()
            .map_or(now.clone(), |earlier| now.joined(earlier));
        checkpoint.write(&FilmHeader { stopping, ..all }, session.film())
    }
}

/// Reads the film file of a render that goes on.
fn load(path: &Path, header: &FilmHeader, asked: Range<u64>) -> Result<FilmFile, Failure> {
    let previous = lock::previous(path);
    let file = scene_io::read_film(path).map_err(|failure| {
        if previous.exists() {
            with_previous(failure, &previous)
        } else {
            failure
        }
    })?;
    let name = path.display();
    if let Some(difference) = header.difference(&file.header) {
        let message = format!("{name}: the film of another render: {difference}");
        let hint = "render as before, or begin anew with --restart";
        return Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint));
    }
    let others = file.header.passes.difference(&PassSet::from(asked));
    if !others.is_empty() {
        let message = format!("{name}: it has the passes {others}, which are not asked for");
        let hint = "ask for at least the passes that it has, or write to another file";
        return Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint));
    }
    Ok(file)
}

/// Says which film file was written before the one that cannot be read.
fn with_previous(failure: Failure, previous: &Path) -> Failure {
    let hint = format!("the one before it is {}", previous.display());
    failure.with_hint(hint)
}
