//! The film file of a running render: continues from it, and writes it at intervals.

use crate::args::LongArgs;
use crate::exit::{Exit, Failure};
use crate::film;
use crate::lock::{self, FilmLock};
use crate::scene_io::{self, FilmFile, FilmHeader};
use bidir::film::{Film, PassSet};
use formats::film::Render;
use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A film file that is locked for this process.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    /// The name given by --checkpoint.
    name: PathBuf,
    /// The file itself, if the name is a link.
    path: PathBuf,
    every: Duration,
    written: Instant,
    /// True if the file exists and can be read.
    is_whole: bool,
    /// The film to continue from, until the session takes it.
    film: Option<FilmFile>,
    _lock: FilmLock,
}

impl Checkpoint {
    /// Opens and locks the film file that the flags name, if any. It needs no scene, so that errors come
    /// before one is read.
    ///
    /// Errors: another process has locked the file; it exists, without --resume or --restart; it is damaged.
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
            // A damaged file must not replace the intact FILE.previous.
            is_whole: film.is_some() || scene_io::read_film(&path).is_ok(),
            name: name.clone(),
            path,
            every: args.checkpoint_every.0,
            written: Instant::now(),
            film,
            _lock: lock,
        }))
    }

    /// Returns true if the render continues from passes in the file.
    pub(crate) fn is_resumed(&self) -> bool {
        self.film.is_some()
    }

    /// Returns the header of the film to continue from. None: the render starts anew.
    pub(crate) fn earlier(&self) -> Option<&FilmHeader> {
        self.film.as_ref().map(|file| &file.header)
    }

    /// Checks before training that the film to continue from, if any, belongs to the render of `header` and
    /// has only passes in `requested`.
    pub(crate) fn check(&self, header: &FilmHeader, requested: Range<u64>) -> Result<(), Failure> {
        let Some(file) = &self.film else {
            return Ok(());
        };
        self.check_render(header, &formats::film::untrained(&file.header))?;
        let others = file.header.passes.difference(&PassSet::from(requested));
        if others.is_empty() {
            return Ok(());
        }
        let name = self.path.display();
        let message = format!("{name} has the passes {others}, which this render does not include");
        let hint = "render at least those passes, or write to another file";
        Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint))
    }

    /// Checks that `in_file` is a header of the same render as `expected`.
    fn check_render(&self, expected: &FilmHeader, in_file: &FilmHeader) -> Result<(), Failure> {
        let places = ["in this render", "in the film"];
        let Some(difference) = expected.difference_between(in_file, places) else {
            return Ok(());
        };
        let name = self.path.display();
        let message = format!("{name} is the film of another render: {difference}");
        let hint = "use the earlier settings, or start over with --restart";
        Err(Failure::new(Exit::FilmMismatch, message).with_hint(hint))
    }

    /// Writes the film, and keeps an intact earlier file as FILE.previous.
    fn write(&mut self, header: &FilmHeader, film: &Film) -> Result<(), Failure> {
        // Set before writing, so that a full disk is not tried again after every pass.
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

/// Returns true if `folder` or one below it has finished passes: a film file, or records of an experiment
/// beyond their first line, which only identifies the experiment.
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

/// Writes the film file of a running render, if it has one.
pub(crate) struct CheckpointWriter(Option<Checkpoint>);

impl CheckpointWriter {
    /// Adds the film to continue from to `render`.
    ///
    /// Errors: the film belongs to another render.
    pub(crate) fn new(
        mut checkpoint: Option<Checkpoint>,
        render: &mut Render<'_>,
    ) -> Result<Self, Failure> {
        if let Some(checkpoint) = &mut checkpoint
            && let Some(file) = checkpoint.film.take()
        {
            checkpoint.check_render(render.empty(), &file.header)?;
            let added = render.add(file);
            added.map_err(|error| Failure::new(Exit::FilmMismatch, error.to_string()))?;
        }
        Ok(Self(checkpoint))
    }

    /// Returns the name of the film file as given by --checkpoint. None: there is none.
    pub(crate) fn path(&self) -> Option<&Path> {
        Some(&self.0.as_ref()?.name)
    }

    /// Returns true if the interval between checkpoints has passed.
    pub(crate) fn is_due(&self) -> bool {
        let is_due = |file: &Checkpoint| file.written.elapsed() >= file.every;
        self.0.as_ref().is_some_and(is_due)
    }

    /// Writes the film of `render` with this header, unless it is unchanged.
    pub(crate) fn write(
        &mut self,
        render: &Render<'_>,
        header: &FilmHeader,
    ) -> Result<(), Failure> {
        match &mut self.0 {
            Some(file) if !render.is_unchanged() => file.write(header, render.session.film()),
            _ => Ok(()),
        }
    }
}

/// Reads the film file to continue from. The hint of a failure names the previous version.
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
