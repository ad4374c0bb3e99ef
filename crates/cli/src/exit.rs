//! Ends of the command: exit codes, and failures with their remedies.

use formats::ErrorKind;
use std::fmt::Write;
use std::path::Path;

/// The end of the command; part of its interface, for scripts and schedulers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// All was done.
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
    /// Stopped early, with a checkpoint to go on from.
    Checkpoint,
    /// Stopped by Ctrl-C; the image has the passes that were finished.
    Interrupted,
    /// Stopped by SIGTERM; as above.
    Terminated,
}

impl Exit {
    /// Every way to end, as the help text lists them.
    const ALL: [(Self, &'static str); 10] = [
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
            Self::Checkpoint,
            "stopped early by a signal; the same command continues from its checkpoint or records",
        ),
        (
            Self::Interrupted,
            "stopped by Ctrl-C; the image has the finished passes",
        ),
        (
            Self::Terminated,
            "stopped by SIGTERM; the image has the finished passes",
        ),
    ];

    /// The number that the shell sees.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::RenderFailed => 1,
            Self::Usage => 2,
            Self::Scene => 3,
            Self::InputOutput => 4,
            Self::FilmMismatch => 5,
            Self::Validation => 6,
            Self::Checkpoint => 75,
            Self::Interrupted => 130,
            Self::Terminated => 143,
        }
    }

    /// The meaning of another program's code, if it has the same ones.
    pub(crate) fn of_code(code: Option<i32>) -> Self {
        let mut all = Self::ALL.into_iter().map(|(exit, _)| exit);
        let found = all.find(|exit| Some(i32::from(exit.code())) == code);
        found.unwrap_or(Self::RenderFailed)
    }

    /// Every exit code with its meaning.
    pub(crate) fn codes() -> impl Iterator<Item = (u8, &'static str)> {
        let all = Self::ALL.into_iter();
        all.map(|(exit, meaning)| (exit.code(), meaning))
    }

    /// The section of the help text.
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

/// The reason why the command cannot go on.
#[derive(Debug)]
pub(crate) struct Failure {
    exit: Exit,
    kind: FailureKind,
}

#[derive(Debug)]
enum FailureKind {
    /// The reason, and a remedy.
    Message {
        message: String,
        hint: Option<String>,
    },
    /// An error that can show its place in a file.
    Diagnostic(Box<dyn miette::Diagnostic + Send + Sync>),
}

impl Failure {
    /// A failure in words.
    pub(crate) fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self {
            exit,
            kind: FailureKind::Message {
                message: message.into(),
                hint: None,
            },
        }
    }

    /// A failure that can show its place in a file.
    pub(crate) fn diagnostic(
        exit: Exit,
        error: impl miette::Diagnostic + Send + Sync + 'static,
    ) -> Self {
        Self {
            exit,
            kind: FailureKind::Diagnostic(Box::new(error)),
        }
    }

    /// The command line is wrong.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// A file cannot be read or written.
    pub(crate) fn io(path: &Path, action: &str, error: &std::io::Error) -> Self {
        Self::new(Exit::InputOutput, formats::cannot(action, path, error))
    }

    /// Adds a remedy.
    pub(crate) fn with_hint(mut self, text: impl Into<String>) -> Self {
        if let FailureKind::Message { hint, .. } = &mut self.kind {
            *hint = Some(text.into());
        }
        self
    }

    /// The exit of the command.
    pub(crate) fn exit(&self) -> Exit {
        self.exit
    }

    /// The message and the hint. None: it is a diagnostic.
    pub(crate) fn message(&self) -> Option<(&str, Option<&str>)> {
        match &self.kind {
            FailureKind::Message { message, hint } => Some((message, hint.as_deref())),
            FailureKind::Diagnostic(_) => None,
        }
    }

    /// The error that can show its place. None: it is in words.
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
