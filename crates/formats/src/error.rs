use crate::file::folder_of;
use crate::source::Excerpt;
use crate::text::printable;
use std::fmt;
use std::path::{Path, PathBuf};

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// An error of reading or writing a file: a message, its place, and a hint.
///
/// Its text is `file:line:column: message; hint`. As a [`miette::Diagnostic`] it also shows the lines of
/// the file with a mark under the place. Both are [`printable`].
#[derive(Debug)]
pub struct Error(Box<Details>);

/// The contents of an error, boxed to keep results small.
#[derive(Debug)]
struct Details {
    kind: ErrorKind,
    message: String,
    hint: Option<String>,
    at: FilePlace,
    /// True if the message contains the file's name, so that the text does not begin with it.
    names_file: bool,
}

/// A place in a file, for errors that are found after it was read.
#[derive(Clone, Debug, Default)]
pub struct FilePlace {
    file: Option<PathBuf>,
    place: Option<Place>,
    /// The path of a value in a JSON file, such as `meshes[3]`.
    value: Option<String>,
}

impl FilePlace {
    /// Returns an error about this place.
    pub fn error(&self, kind: ErrorKind, message: impl Into<String>) -> Error {
        let mut error = Error::new(kind, message);
        error.0.at.clone_from(self);
        error
    }
}

/// The place of an error in a text.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// The line, counted from 1.
    pub(crate) line: usize,
    /// The column in characters, counted from 1.
    pub(crate) column: usize,
    /// The lines around the place. None: they are not shown.
    pub(crate) excerpt: Option<Excerpt>,
}

/// The kind of an [`Error`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The scene's text does not follow the format's grammar.
    Syntax,
    /// The scene is well-formed but not valid.
    Scene,
    /// The renderer does not support a feature of the format.
    Unsupported,
    /// A mesh or an image is broken.
    Data,
    /// The caller's options do not fit the scene.
    Options,
    /// A file does not exist.
    MissingFile,
    /// The system cannot read or write a file.
    Io,
    /// Something exceeds a limit of size or depth.
    Limit,
    /// The system does not have enough memory.
    Memory,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        let message = message.into();
        Self(Box::new(Details {
            kind,
            message,
            hint: None,
            at: FilePlace::default(),
            names_file: false,
        }))
    }

    /// Returns the error for `what` if the system refuses it `bytes` bytes of memory.
    pub(crate) fn memory(what: &str, bytes: u64) -> Self {
        let message =
            format!("{what} needs {bytes} bytes of memory, which the system does not have");
        Self::new(ErrorKind::Memory, message)
    }

    /// Returns a system error for `file`; a missing file has its own kind.
    pub fn io(file: &Path, action: &str, error: &std::io::Error) -> Self {
        let kind = match error.kind() {
            std::io::ErrorKind::NotFound => ErrorKind::MissingFile,
            _ => ErrorKind::Io,
        };
        Self::naming(file, kind, cannot(action, file, error))
    }

    /// Returns an error about the whole of `file`, whose name is part of `message`.
    pub(crate) fn naming(file: &Path, kind: ErrorKind, message: impl Into<String>) -> Self {
        let mut error = Self::new(kind, message).in_file(file);
        error.0.names_file = true;
        error
    }

    pub(crate) fn in_file(mut self, file: &Path) -> Self {
        self.0.at.file = Some(file.to_owned());
        self
    }

    pub(crate) fn at(mut self, place: Place) -> Self {
        self.0.at.place = Some(place);
        self
    }

    pub(crate) fn at_value(mut self, value: String) -> Self {
        self.0.at.value = Some(value);
        self
    }

    /// Adds a hint, which says what to do.
    #[must_use]
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.0.hint = Some(hint.into());
        self
    }

    /// Adds the kind and number of the part of the file that the error is about to the message.
    pub(crate) fn of(mut self, part: &str, index: usize) -> Self {
        self.0.message = format!("{part} {index}: {}", self.0.message);
        self
    }

    /// Returns the place of the error.
    pub(crate) fn into_place(self) -> FilePlace {
        self.0.at
    }

    /// Returns the kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Returns the message without the place and the hint.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// Returns the hint, which says what to do. None: there is none.
    pub fn hint(&self) -> Option<&str> {
        self.0.hint.as_deref()
    }

    /// Returns the file that the error is about.
    pub fn file(&self) -> Option<&Path> {
        self.0.at.file.as_deref()
    }

    /// True where the error is at a place within its file, not about the file as a whole.
    pub fn has_place(&self) -> bool {
        self.0.at.place.is_some() || self.0.at.value.is_some()
    }

    /// Returns the line, counted from 1. None: the file is binary, or the error is about the whole file.
    pub fn line(&self) -> Option<usize> {
        self.0.at.place.as_ref().map(|place| place.line)
    }

    /// Returns the column in characters, counted from 1. None: as for [`line`](Self::line).
    pub fn column(&self) -> Option<usize> {
        self.0.at.place.as_ref().map(|place| place.column)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let FilePlace { file, place, value } = &self.0.at;
        if let Some(file) = file.as_ref().filter(|_| !self.0.names_file) {
            write!(f, "{}:", printable(&file.to_string_lossy()))?;
            if let Some(place) = place {
                write!(f, "{}:{}:", place.line, place.column)?;
            }
            f.write_str(" ")?;
        }
        if let Some(value) = value {
            write!(f, "{}: ", printable(value))?;
        }
        f.write_str(&printable(self.message()))?;
        match self.hint() {
            Some(hint) => write!(f, "; {}", printable(hint)),
            None => Ok(()),
        }
    }
}

impl std::error::Error for Error {}

/// Returns the message for a system error with a file: "cannot open `room.pbrt`: no such file".
pub fn cannot(action: &str, file: &Path, error: &std::io::Error) -> String {
    use std::io::ErrorKind::{FileTooLarge, IsADirectory, NotFound, PermissionDenied, StorageFull};
    let reason = match error.kind() {
        // Writing creates the file, but not its folder; some folders of the system take no files.
        NotFound if action == "write" && !folder_of(file).is_dir() => "no such folder".to_owned(),
        NotFound if action != "write" => "no such file".to_owned(),
        IsADirectory => "it is a folder".to_owned(),
        PermissionDenied => "permission denied".to_owned(),
        StorageFull => "the disk is full".to_owned(),
        FileTooLarge => "it would be larger than the system allows".to_owned(),
        _ => {
            let text = error.to_string();
            let reason = text.split(" (os error").next();
            reason.unwrap_or_default().to_owned()
        }
    };
    format!("cannot {action} `{}`: {reason}", file.display())
}

impl miette::Diagnostic for Error {
    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        let excerpt = self.0.at.place.as_ref()?.excerpt.as_ref()?;
        Some(excerpt)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        let excerpt = self.0.at.place.as_ref()?.excerpt.as_ref()?;
        // The mark has no label, and `help` is not used: the message contains everything.
        let label = miette::LabeledSpan::new_with_span(None, excerpt.marked());
        Some(Box::new(std::iter::once(label)))
    }
}
