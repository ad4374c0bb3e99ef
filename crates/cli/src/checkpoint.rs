//! The film file of a running render: what it goes on from, and what is written now and then.

use crate::args::LongArgs;
use crate::exit::{Exit, Failure};
use crate::film;
use crate::film_header;
use crate::lock::{self, FilmLock};
use crate::scene_io::{self, FilmFile, FilmHeader, Stopping};
use bidir::driver::Session;
use bidir::film::{Film, PassSet};
use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A film file that this process alone writes.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    /// The name that was asked for.
    name: PathBuf,
    /// The file that it stands for, where it is a link.
    path: PathBuf,
    every: Duration,
    written: Instant,
    /// True where the file is there and can be read.
    is_whole: bool,
    /// The film that the render continues, until the session has it.
    film: Option<FilmFile>,
    _lock: FilmLock,
}

impl Checkpoint {
    /// The film file that the flags ask for, if any. It needs no scene: what is wrong is told before
    /// one is read.
    ///
    /// Errors: another process writes the same file; it is there and nothing was said of it; it is
    /// damaged.
    pub(crate) fn open(args: &LongArgs) -> Result<Option<Self>, Failure> {
        let Some(name) = &args.checkpoint else {
            return Ok(None);
        };
        formats::file::check_replaceable(name)?;
        let path = scene_io::target_of(name);
        let lock = FilmLock::take(&path)?;
        check_existing(&path, args)?;
        let film = if path.exists() && args.resume {
            Some(load(&path)?)
        } else {
            None
        };
        Ok(Some(Self {
            // A damaged file does not replace the whole one before it.
            is_whole: film.is_some() || scene_io::read_film(&path).is_ok(),
            name: name.clone(),
            path,
            every: args.checkpoint_every.0,
            written: Instant::now(),
            film,
            _lock: lock,
        }))
    }

    /// True where there are passes from before.
    pub(crate) fn is_resumed(&self) -> bool {
        self.film.is_some()
    }

    /// The header of the film that is gone on from. None: there is none.
    pub(crate) fn earlier(&self) -> Option<&FilmHeader> {
        self.film.as_ref().map(|file| &file.header)
    }

    /// Checks before training whether the film that is gone on from, if any, can be that of the
    /// render that `header` describes, and has none but the passes `asked`.
    pub(crate) fn check(&self, header: &FilmHeader, asked: Range<u64>) -> Result<(), Failure> {
        let Some(file) = &self.film else {
            return Ok(());
        };
        self.check_render(header, &film_header::untrained(&file.header))?;
        let others = file.header.passes.difference(&PassSet::from(asked));
        if others.is_empty() {
            return Ok(());
        }
        let name = self.path.display();
        let message = format!("{name} has the passes {others}, which this render does not include");
        let hint = "render at least those passes, or write to another file";
        Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint))
    }

    /// Fails where `found` is the header of another render than `expected`.
    fn check_render(&self, expected: &FilmHeader, found: &FilmHeader) -> Result<(), Failure> {
        let places = ["in this render", "in the film"];
        let Some(difference) = expected.difference_between(found, places) else {
            return Ok(());
        };
        let name = self.path.display();
        let message = format!("{name} is the film of another render: {difference}");
        let hint = "use the settings of before, or start over with --restart";
        Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint))
    }

    /// Writes the film, and keeps the file before as FILE.previous.
    fn write(&mut self, header: &FilmHeader, film: &Film) -> Result<(), Failure> {
        // Set first: a full disk is not tried again after every pass.
        self.written = Instant::now();
        if self.is_whole {
            let previous = lock::previous(&self.path);
            formats::film::write_keeping(&self.path, &previous, header, film)?;
        } else {
            formats::film::write(&self.path, header, film)?;
            self.is_whole = true;
        }
        Ok(())
    }
}

/// True where `folder`, or one below it, has finished passes: in a film file, or as a record of an
/// experiment, whose first line says only whose the others are.
pub(crate) fn has_passes(folder: &Path) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).any(|path| {
        if path.is_dir() && !path.is_symlink() {
            return has_passes(&path);
        }
        match path.extension().and_then(OsStr::to_str) {
            Some("film") => true,
            Some("ndjson") => std::fs::read(&path).is_ok_and(|text| {
                let ends = text.iter().filter(|byte| **byte == b'\n');
                ends.count() > 1
            }),
            _ => false,
        }
    })
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
        let message = format!("{name} does not exist, but its previous version does");
        let hint = format!(
            "rename {} to continue from it, or start over with --restart",
            previous.display()
        );
        return failure(message, hint);
    }
    if args.restart && !scene_io::is_film(path) {
        return Err(film::not_a_film(path, "--checkpoint"));
    }
    if !args.resume && !args.restart {
        let message = format!("{name} exists already");
        let hint = "continue it with --resume, or start over with --restart";
        return failure(message, hint.into());
    }
    Ok(())
}

/// Writes the film file of a running render, if it has one.
pub(crate) struct Keeper {
    checkpoint: Option<Checkpoint>,
    header: FilmHeader,
    /// That of the film that was gone on from.
    earlier: Option<FilmHeader>,
    start: Instant,
}

impl Keeper {
    /// Gives the film that is gone on from to `session`, which is that of `header` and began, with
    /// its training, at `start`.
    ///
    /// Errors: the film is of another render.
    pub(crate) fn new(
        mut checkpoint: Option<Checkpoint>,
        header: FilmHeader,
        session: &mut Session<'_>,
        start: Instant,
    ) -> Result<Self, Failure> {
        let mut earlier = None;
        if let Some(checkpoint) = &mut checkpoint
            && let Some(file) = checkpoint.film.take()
        {
            checkpoint.check_render(&header, &file.header)?;
            let FilmFile { header, film } = file;
            session
                .add_film(film)
                .map_err(|error| Failure::new(Exit::FilmMismatch, error.to_string()))?;
            earlier = Some(header);
        }
        Ok(Self {
            checkpoint,
            header,
            earlier,
            start,
        })
    }

    /// The name of the film file, as it was asked for. None: there is none.
    pub(crate) fn path(&self) -> Option<&Path> {
        Some(&self.checkpoint.as_ref()?.name)
    }

    /// Is it time to write again?
    pub(crate) fn is_due(&self) -> bool {
        let is_due = |file: &Checkpoint| file.written.elapsed() >= file.every;
        self.checkpoint.as_ref().is_some_and(is_due)
    }

    /// The header of what `session` has, for its film file and for its image: time and counts are
    /// those of all runs, but how the number of passes was decided is what the last run says.
    pub(crate) fn header(&self, session: &Session<'_>, stopping: Stopping) -> FilmHeader {
        if let Some(earlier) = self.unchanged(session) {
            return earlier.clone();
        }
        let now = film_header::of_run(&self.header, session, self.start.elapsed());
        let earlier = self.earlier.as_ref();
        let all = earlier.map_or(now.clone(), |earlier| now.joined(earlier));
        FilmHeader { stopping, ..all }.of(session.film())
    }

    /// The header of the film that was gone on from, where nothing was added to it: what its file
    /// says stays true.
    fn unchanged(&self, session: &Session<'_>) -> Option<&FilmHeader> {
        let passes = session.film().passes();
        let earlier = self.earlier.as_ref();
        earlier.filter(|earlier| earlier.passes == *passes)
    }

    /// Writes what `session` has, with this header.
    pub(crate) fn keep(
        &mut self,
        session: &Session<'_>,
        header: &FilmHeader,
    ) -> Result<(), Failure> {
        if self.unchanged(session).is_some() {
            return Ok(());
        }
        let checkpoint = self.checkpoint.as_mut();
        checkpoint.map_or(Ok(()), |file| file.write(header, session.film()))
    }
}

/// Reads the film file of a render that goes on.
fn load(path: &Path) -> Result<FilmFile, Failure> {
    let previous = lock::previous(path);
    scene_io::read_film(path).map_err(|failure| {
        if previous.exists() {
            // Says which film file was written before the one that cannot be read.
            failure.with_hint(format!("its previous version is {}", previous.display()))
        } else {
            failure
        }
    })
}
