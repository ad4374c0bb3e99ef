//! Exit codes, and failures with hints.

use formats::ErrorKind;
use miette::Diagnostic;
use std::path::Path;

/// The exit of the command. Its code is part of the interface for scripts and schedulers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Exit {
    /// The command succeeded.
    Done = 0,
    /// The render failed.
    RenderFailed = 1,
    /// The command line is wrong.
    Usage = 2,
    /// The scene is wrong.
    Scene = 3,
    /// A file cannot be read or written.
    InputOutput = 4,
    /// A film file belongs to another render.
    FilmMismatch = 5,
    /// A check failed.
    Validation = 6,
    /// The time ended before a pass was complete.
    NoPass = 7,
    /// Stopped early, with a checkpoint to continue from.
    Checkpoint = 75,
    /// Stopped by Ctrl-C; the image has the complete passes.
    Interrupted = 130,
    /// Stopped by SIGTERM; the image has the complete passes.
    Terminated = 143,
}

/// The meanings of [`Exit::ALL`].
const MEANINGS: [&str; Exit::ALL.len()] = [
    "success",
    "the render failed",
    "the command line is wrong, or its crop is outside the image",
    "the scene or the experiment is wrong, or the scene or film is too large for memory",
    "a file cannot be read or written, an output would replace an input or another output, a port is taken, \
     images differ in size, or a library is missing",
    "a file belongs to another render or experiment, or a film has the same passes",
    "a check failed (`render --strict`, `compare --exact`, `missing`, `reference`), or a reference is refused",
    "no pass was complete when `render --time` ended; nothing was written",
    "stopped early by a signal; the same command continues from its checkpoint or records",
    "stopped by Ctrl-C; the image has the complete passes",
    "stopped by SIGTERM; the image has the complete passes",
];

impl Exit {
    /// Every exit, in the order of the help text.
    const ALL: [Self; 11] = [
        Self::Done,
        Self::RenderFailed,
        Self::Usage,
        Self::Scene,
        Self::InputOutput,
        Self::FilmMismatch,
        Self::Validation,
        Self::NoPass,
        Self::Checkpoint,
        Self::Interrupted,
        Self::Terminated,
    ];

    /// Returns the exit code.
    pub(crate) fn code(self) -> u8 {
        self as u8
    }

    /// Returns the exit that has this code; `RenderFailed` for a code that no exit has.
    pub(crate) fn of_code(code: Option<i32>) -> Self {
        let mut all = Self::ALL.into_iter();
        let exit = all.find(|exit| Some(i32::from(exit.code())) == code);
        exit.unwrap_or(Self::RenderFailed)
    }

    /// Returns every exit code with its meaning.
    pub(crate) fn codes() -> impl Iterator<Item = (u8, &'static str)> {
        Self::ALL.into_iter().map(Self::code).zip(MEANINGS)
    }

    /// Returns the section on exit codes of the help text.
    pub(crate) fn help() -> String {
        let lines = Self::codes().map(|(code, meaning)| format!("\n  {code:>3}  {meaning}"));
        "Exit codes:".to_owned() + &lines.collect::<String>()
    }
}

/// The error that ends a command.
#[derive(Debug)]
pub(crate) struct Failure {
    exit: Exit,
    message: String,
    /// The remedy.
    hint: Option<String>,
    /// The error with its place in a file, shown in place of message and hint.
    diagnostic: Option<Box<dyn Diagnostic + Send + Sync>>,
}

impl Failure {
    /// Returns a failure with a message.
    pub(crate) fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self {
            exit,
            message: message.into(),
            hint: None,
            diagnostic: None,
        }
    }

    /// Returns a failure that shows its place in a file.
    pub(crate) fn diagnostic(exit: Exit, error: impl Diagnostic + Send + Sync + 'static) -> Self {
        let message = error.to_string();
        Self {
            diagnostic: Some(Box::new(error)),
            ..Self::new(exit, message)
        }
    }

    /// Returns a failure of the command line.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// Returns a failure to read or write a file.
    pub(crate) fn io(path: &Path, action: &str, error: &std::io::Error) -> Self {
        Self::new(Exit::InputOutput, formats::cannot(action, path, error))
    }

    /// Adds a hint. A diagnostic does not show it.
    pub(crate) fn with_hint(self, text: impl Into<String>) -> Self {
        Self {
            hint: Some(text.into()),
            ..self
        }
    }

    /// Returns the exit of the command.
    pub(crate) fn exit(&self) -> Exit {
        self.exit
    }

    /// Returns the message.
    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// Returns the hint. None: there is none.
    pub(crate) fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Returns the error that shows its place. None: the failure is a message.
    pub(crate) fn as_diagnostic(&self) -> Option<&dyn Diagnostic> {
        self.diagnostic
            .as_deref()
            .map(|error| error as &dyn Diagnostic)
    }
}

/// An error with a file, other than a scene.
impl From<formats::Error> for Failure {
    fn from(error: formats::Error) -> Self {
        let exit = match error.kind() {
            ErrorKind::Memory => Exit::Scene,
            _ => Exit::InputOutput,
        };
        Self::new(exit, error.to_string())
    }
}
