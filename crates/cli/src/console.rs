//! Talk on stderr and data on stdout.

use crate::args::{ColorArgs, TalkArgs};
use crate::exit::{Exit, Failure};
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::fmt;
use std::io::{ErrorKind, IsTerminal, Write};

/// Whether text may be coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Color {
    On,
    Off,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Display {
    /// A bar that is drawn over.
    Bar,
    /// A line now and then.
    Lines(LineFormat),
    /// Not at all.
    Silent,
}

/// What a line of progress looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LineFormat {
    /// Words.
    Plain,
    /// An object of JSON.
    Ndjson,
    /// Messages of Open Job Description, on stdout.
    OpenJd,
}

impl Display {
    /// Names on the command line.
    pub(crate) const NAMES: [(&'static str, Self); 4] = [
        ("bar", Self::Bar),
        ("plain", Self::Lines(LineFormat::Plain)),
        ("ndjson", Self::Lines(LineFormat::Ndjson)),
        ("openjd", Self::Lines(LineFormat::OpenJd)),
    ];
}

/// What stderr is, and what the user wants of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Console {
    color: Color,
    is_terminal: bool,
}

impl Console {
    /// The console of this process.
    ///
    /// Colour: off by `--no-color`, by a `NO_COLOR` that is not empty, by `TERM=dumb`; else on by
    /// `FORCE_COLOR`; else on where stderr is a terminal.
    pub(crate) fn new(args: ColorArgs) -> Self {
        let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
        let is_dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let is_terminal = std::io::stderr().is_terminal() && !is_dumb;
        let color = if args.no_color || is_set("NO_COLOR") || is_dumb {
            Color::Off
        } else if is_set("FORCE_COLOR") || is_terminal {
            Color::On
        } else {
            Color::Off
        };
        Self { color, is_terminal }
    }

    /// How progress is shown: as it is asked for, but a bar on terminals only.
    pub(crate) fn display(self, args: TalkArgs) -> Display {
        let default = if args.quiet {
            Display::Silent
        } else {
            Display::Bar
        };
        self.on_terminal(args.progress.unwrap_or(default))
    }

    /// How progress is shown that is wanted so: a bar on terminals only.
    pub(crate) fn on_terminal(self, wanted: Display) -> Display {
        match wanted {
            Display::Bar if !self.is_terminal => Display::Lines(LineFormat::Plain),
            display => display,
        }
    }

    /// Tells something odd that does not stop the command.
    pub(crate) fn warning(self, text: impl fmt::Display) {
        say(format_args!("{}: {text}", self.paint("warning", "1;33")));
    }

    /// Tells why the command stops.
    pub(crate) fn failure(self, failure: &Failure) {
        if let Some(diagnostic) = failure.as_diagnostic() {
            say(format_args!(
                "{}: {}",
                self.paint("error", "1;31"),
                self.report(diagnostic)
            ));
        }
        if let Some((message, hint)) = failure.message() {
            say(format_args!("{}: {message}", self.paint("error", "1;31")));
            if let Some(hint) = hint {
                say(format_args!("{}: {hint}", self.paint("hint", "1;36")));
            }
        }
    }

    fn paint(self, word: &str, style: &str) -> String {
        match self.color {
            Color::On => format!("\x1b[{style}m{word}\x1b[0m"),
            Color::Off => word.to_owned(),
        }
    }

    /// The message of a diagnostic with the lines it is about.
    fn report(self, diagnostic: &dyn miette::Diagnostic) -> String {
        let theme = match self.color {
            Color::On => GraphicalTheme::unicode(),
            Color::Off => GraphicalTheme::unicode_nocolor(),
        };
        // Unwrapped, so that `file:line:column` stays in one piece.
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_links(false)
            .with_wrap_lines(false);
        let mut text = String::new();
        match handler.render_report(&mut text, diagnostic) {
            // Only the mark that the theme begins with: the message may begin with a letter like it.
            Ok(()) => text.trim().trim_start_matches("× ").to_owned(),
            Err(_) => diagnostic.to_string(),
        }
    }
}

/// Writes a line to stderr. Where nobody listens there is nobody to tell.
pub(crate) fn say(line: impl fmt::Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Writes data to stdout; a reader that went away has read enough.
pub(crate) fn print(text: &str) -> Result<Exit, Failure> {
    let mut stdout = std::io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::new(
            Exit::InputOutput,
            format!("cannot write to stdout: {error}"),
        )),
        _ => Ok(Exit::Done),
    }
}

/// Writes a value to stdout as JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<Exit, Failure> {
    print(&(json(value)? + "\n"))
}

/// A value as indented JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value)
        .map_err(|error| Failure::new(Exit::RenderFailed, format!("not JSON: {error}")))
}
