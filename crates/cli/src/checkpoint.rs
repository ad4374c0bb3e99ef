//! The film file of a running render: what it goes on from, and what is written now and then.

use crate::args::LongArgs;
use crate::exit::{Exit, Failure};
use crate::film_header;
use crate::scene_io::{self, FilmFile, FilmHeader, Stopping};
use bidir::driver::Session;
use bidir::film::Film;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A film file that this process alone writes.
#[derive(Debug)]
struct Checkpoint {
    path: PathBuf,
    every: Duration,
    written: Instant,
    /// Locked as long as it lives; the system unlocks it where the process is killed.
    _lock: File,
}

impl Checkpoint {
    /// The film file that the flags ask for, if any, and the film in it that is gone on from.
    ///
    /// Errors: another process writes the same file; it is there and nothing was said of it; it is
    /// damaged; it is not of the render that `header` describes.
    fn open(
        args: &LongArgs,
        header: &FilmHeader,
    ) -> Result<Option<(Self, Option<FilmFile>)>, Failure> {
        let Some(path) = &args.checkpoint else {
            return Ok(None);
        };
        scene_io::check_writable(path)?;
        let lock = lock(path)?;
        let film = match (path.exists(), args.resume, args.restart) {
            (true, true, _) => Some(load(path, header)?),
            (true, false, false) => {
                let message = format!("{}: there is a film file already", path.display());
                let hint = "go on from it with --resume, or begin anew with --restart";
                return Err(Failure::usage(message).with_hint(hint));
            }
            _ => None,
        };
        let checkpoint = Self {
            path: path.clone(),
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
        keep_previous(&self.path)?;
        scene_io::write_film(&self.path, header, film)
    }
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
    /// Opens the film file that the flags ask for, and gives its film to `session`.
    ///
    /// Errors: as [`Checkpoint::open`].
    pub(crate) fn open(
        args: &LongArgs,
        header: FilmHeader,
        session: &mut Session<'_>,
    ) -> Result<Self, Failure> {
        let (checkpoint, file) = Checkpoint::open(args, &header)?.unzip();
        let file = file.flatten();
        if let Some(file) = &file {
            session
                .add_film(&file.film)
                .map_err(|error| Failure::new(Exit::FilmMismatch, error.to_string()))?;
        }
        Ok(Self {
            checkpoint,
            header,
            earlier: file.map(|file| file.header),
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
        let now = film_header::of_run(&self.header, session, self.start.elapsed());
        let all = self
            .earlier
            .as_ref()
            .map_or(now.clone(), |earlier| now.joined(earlier));
        checkpoint.write(&FilmHeader { stopping, ..all }, session.film())
    }
}

/// Reads the film file of a render that goes on.
fn load(path: &Path, header: &FilmHeader) -> Result<FilmFile, Failure> {
    let previous = beside(path, ".previous");
    let file = scene_io::read_film(path).map_err(|failure| {
        if previous.exists() {
            with_previous(failure, &previous)
        } else {
            failure
        }
    })?;
    match header.difference(&file.header) {
        None => Ok(file),
        Some(difference) => {
            let message = format!(
                "{}: the film of another render: {difference}",
                path.display()
            );
            let hint = "render as before, or begin anew with --restart";
            Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint))
        }
    }
}

/// Says which film file was written before the one that cannot be read.
fn with_previous(failure: Failure, previous: &Path) -> Failure {
    let hint = format!("the one before it is {}", previous.display());
    failure.with_hint(hint)
}

/// A name beside `path`.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Gives the file a second name, which stays when the first is given to new bytes.
fn keep_previous(path: &Path) -> Result<(), Failure> {
    if !path.exists() {
        return Ok(());
    }
    let previous = beside(path, ".previous");
    let _ = std::fs::remove_file(&previous);
    std::fs::hard_link(path, &previous)
        .or_else(|_| std::fs::copy(path, &previous).map(drop))
        .map_err(|error| Failure::io(&previous, "write", &error))
}

/// Keeps other processes from writing the same film file.
fn lock(path: &Path) -> Result<File, Failure> {
    let name = beside(path, ".lock");
    let file = File::create(&name).map_err(|error| Failure::io(&name, "write", &error))?;
    // Some file systems cannot lock; names of temporary files keep writers apart even there.
    if !matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        return Ok(file);
    }
    let message = format!(
        "{}: another process is writing this film file",
        path.display()
    );
    let hint = "let each process have its own --checkpoint, and merge them";
    Err(Failure::new(Exit::InputOutput, message).with_hint(hint))
}
