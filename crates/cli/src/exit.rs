//! Exit codes, and failures with hints.

use formats::ErrorKind;
use std::fmt::Write;
use std::path::Path;

/// The exit of the command. Its code is part of the interface for scripts and schedulers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// The command succeeded.
    Done,
    /// The render failed.
    RenderFailed,
    /// The command line is wrong.
    Usage,
    /// The scene is wrong.
    Scene,
    /// A file cannot be read or written.
    InputOutput,
    /// A film file belongs to another render.
    FilmMismatch,
    /// A check did not hold.
    Validation,
    /// The time ended before a pass was complete.
    NoPass,
    /// Stopped early, with a checkpoint to continue from.
    Checkpoint,
    /// Stopped by Ctrl-C; the image has the complete passes.
    Interrupted,
    /// Stopped by SIGTERM; the image has the complete passes.
    Terminated,
}

impl Exit {
    /// Every exit with its meaning, in the order of the help text.
    const ALL: [(Self, &'static str); 11] = [
        (Self::Done, "success"),
        (Self::RenderFailed, "the render failed"),
        (
            Self::Usage,
            "the command line is wrong, or its crop is outside the image",
        ),
        (
            Self::Scene,
            "the scene or the experiment is wrong, or the scene or film is too large for memory",
        ),
        (
            Self::InputOutput,
            "a file cannot be read or written, an output would replace an input or another output, a port \
             is taken, images differ in size, or a library is missing",
        ),
        (
            Self::FilmMismatch,
            "a file belongs to another render or experiment, or a film has the same passes",
        ),
        (
            Self::Validation,
            "a check failed (`render --strict`, `compare --exact`, `missing`, `reference`), or a reference \
             is refused",
        ),
        (
            Self::NoPass,
            "no pass was complete when `render --time` ended; nothing was written",
        ),
        (
            Self::Checkpoint,
            "stopped early by a signal; the same command continues from its checkpoint or records",
        ),
        (
            Self::Interrupted,
            "stopped by Ctrl-C; the image has the complete passes",
        ),
        (
            Self::Terminated,
            "stopped by SIGTERM; the image has the complete passes",
        ),
    ];

    /// Returns the exit code.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::RenderFailed => 1,
            Self::Usage => 2,
            Self::Scene => 3,
            Self::InputOutput => 4,
            Self::FilmMismatch => 5,
            Self::Validation => 6,
            Self::NoPass => 7,
            Self::Checkpoint => 75,
            Self::Interrupted => 130,
            Self::Terminated => 143,
        }
    }

    /// Returns the exit that has this code; `RenderFailed` for a code that no exit has.
    pub(crate) fn of_code(code: Option<i32>) -> Self {
        let mut all = Self::ALL.into_iter().map(|(exit, _)| exit);
        let exit = all.find(|exit| Some(i32::from(exit.code())) == code);
        exit.unwrap_or(Self::RenderFailed)
    }

    /// Returns every exit code with its meaning.
    pub(crate) fn codes() -> impl Iterator<Item = (u8, &'static str)> {
        let all = Self::ALL.into_iter();
        all.map(|(exit, meaning)| (exit.code(), meaning))
    }

    /// Returns the section on exit codes of the help text.
    pub(crate) fn help() -> String {
        let mut text = String::from("Exit codes:\n");
        for (exit, meaning) in Self::ALL {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {:>3}  {meaning}", exit.code());
        }
        text.pop();
        text
    }
}

/// The error that ends a command.
#[derive(Debug)]
pub(crate) struct Failure {
    exit: Exit,
    kind: FailureKind,
}

#[derive(Debug)]
enum FailureKind {
    /// A message, and a hint that says what to do.
    Message {
        message: String,
        hint: Option<String>,
    },
    /// An error that shows its place in a file.
    Diagnostic(Box<dyn miette::Diagnostic + Send + Sync>),
}

impl Failure {
    /// Returns a failure with a message.
    pub(crate) fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self {
            exit,
            kind: FailureKind::Message {
                message: message.into(),
                hint: None,
            },
        }
    }

    /// Returns a failure that shows its place in a file.
    pub(crate) fn diagnostic(
        exit: Exit,
        error: impl miette::Diagnostic + Send + Sync + 'static,
    ) -> Self {
        Self {
            exit,
            kind: FailureKind::Diagnostic(Box::new(error)),
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

    /// Adds a hint, unless the failure is a diagnostic.
    pub(crate) fn with_hint(mut self, text: impl Into<String>) -> Self {
        if let FailureKind::Message { hint, .. } = &mut self.kind {
            *hint = Some(text.into());
        }
        self
    }

    /// Returns the exit of the command.
    pub(crate) fn exit(&self) -> Exit {
        self.exit
    }

    /// Returns the message and the hint. None: the failure is a diagnostic.
    pub(crate) fn message(&self) -> Option<(&str, Option<&str>)> {
        match &self.kind {
            FailureKind::Message { message, hint } => Some((message, hint.as_deref())),
            FailureKind::Diagnostic(_) => None,
        }
    }

    /// Returns the error that shows its place. None: the failure is a message.
    pub(crate) fn as_diagnostic(&self) -> Option<&dyn miette::Diagnostic> {
        match &self.kind {
            FailureKind::Diagnostic(error) => Some(&**error),
            FailureKind::Message { .. } => None,
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_differ_and_are_in_the_help() {
        let mut codes: Vec<u8> = Exit::ALL.iter().map(|(exit, _)| exit.code()).collect();
        let help = Exit::help();
        assert!(
            codes
                .iter()
                .all(|code| help.contains(&format!("{code:>3}  ")))
        );
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), Exit::ALL.len());
    }
}
