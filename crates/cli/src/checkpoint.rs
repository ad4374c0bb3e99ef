//! The film file of a running render: continues from it, and writes it at intervals.

use crate::args::LongArgs;
use crate::exit::{Exit, Failure};
use crate::film;
use crate::lock::{self, FilmLock};
use crate::scene_io::{self, FilmFile};
use crate::signals::Signals;
use formats::film::{OpenError, Render};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A film file that is locked for this process.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    /// The name that --checkpoint gives.
    pub(crate) name: PathBuf,
    /// The path of the file, with links resolved.
    path: PathBuf,
    every: Duration,
    written: Instant,
    /// True if the file exists and can be read.
    is_whole: bool,
    _lock: FilmLock,
}

impl Checkpoint {
    /// Opens and locks the film file that the flags name, if any. Returns it with the film to continue from, if any.
    /// It is called before the scene is read, so that errors come early.
    ///
    /// Errors: another process has locked the file; the file exists, without --resume or --restart; it is damaged.
    pub(crate) fn open(args: &LongArgs) -> Result<(Option<Self>, Option<FilmFile>), Failure> {
        let Some(name) = &args.checkpoint else {
            return Ok((None, None));
        };
        formats::file::check_replaceable(name)?;
        let path = scene_io::target_of(name);
        let lock = FilmLock::take(&path)?;
        check_existing(&path, args)?;
        let is_resumed = path.exists() && args.resume;
        let film = is_resumed.then(|| load(&path)).transpose()?;
        let checkpoint = Self {
            // A damaged file must not replace the intact FILE.previous.
            is_whole: film.is_some() || scene_io::read_film(&path).is_ok(),
            name: name.clone(),
            path,
            every: args.checkpoint_every,
            written: Instant::now(),
            _lock: lock,
        };
        Ok((Some(checkpoint), film))
    }

    /// Returns true if the interval between checkpoints has passed.
    pub(crate) fn is_due(&self) -> bool {
        self.written.elapsed() >= self.every
    }

    /// Writes the film of a render, unless it is unchanged, and keeps an intact earlier file as FILE.previous.
    pub(crate) fn write(&mut self, render: &Render) -> Result<(), Failure> {
        if render.is_unchanged() {
            return Ok(());
        }
        // Set before writing, so that a full disk is not tried again after every pass.
        self.written = Instant::now();
        let (header, film) = (render.header(), render.session.film());
        if self.is_whole {
            let previous = lock::previous(&self.path);
            formats::film::write_keeping(&self.path, &previous, &header, film)?;
        } else {
            formats::film::write(&self.path, &header, film)?;
            self.is_whole = true;
        }
        Ok(())
    }
}

/// Returns the failure to continue from the film that the flags name.
pub(crate) fn mismatch(args: &LongArgs, error: &OpenError) -> Failure {
    let target = args.checkpoint.as_deref().map(scene_io::target_of);
    let path = target.unwrap_or_default();
    let name = path.display();
    let (message, hint) = match error {
        OpenError::Beyond(passes) => (
            format!("{name} has the passes {passes}, which this render does not include"),
            "render at least those passes, or write to another file",
        ),
        error => (
            format!("{name} is {error}"),
            "use the earlier settings, or start over with --restart",
        ),
    };
    Failure::new(Exit::FilmMismatch, message).with_hint(hint)
}

/// Ends a command that a signal stopped. Returns a message, with the way to continue if `folder` has finished passes,
/// and the exit. `without` is a flag that would start over.
pub(crate) fn stopped(folder: &Path, without: Option<&str>, signals: &Signals) -> (String, Exit) {
    if !has_passes(folder) {
        return ("stopped before the first pass".to_owned(), signals.ended());
    }
    let without = without.map(|flag| format!(" without {flag}"));
    let (without, folder) = (without.unwrap_or_default(), folder.display());
    let text = format!("stopped: run the same command{without} to continue in {folder}");
    (text, Exit::Checkpoint)
}

/// Returns true if `folder` or a folder below it has finished passes: a film file, or records of an experiment
/// after the first line, which only identifies the experiment.
fn has_passes(folder: &Path) -> bool {
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

/// Refuses to replace an existing file without --resume or --restart, and files of another kind.
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

/// Reads the film file to continue from. The hint of a failure names FILE.previous.
fn load(path: &Path) -> Result<FilmFile, Failure> {
    let previous = lock::previous(path);
    scene_io::read_film(path).map_err(|failure| {
        if previous.exists() {
            failure.with_hint(format!("its previous version is {}", previous.display()))
        } else {
            failure
        }
    })
}
