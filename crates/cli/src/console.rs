//! Messages on stderr and data on stdout: the only place that writes to either.
//!
//! After a failed write, a command that otherwise succeeds fails with the error of the first such write
//! ([`lost`]).
//!
//! Names and texts may come from untrusted files. The functions here write no control characters, except
//! line feeds and tabs of data and the colours of this module. Callers make foreign text [`printable`]
//! before they join it with other lines.

use crate::args::{ColorArgs, TalkArgs};
use crate::exit::{Exit, Failure};
use formats::{is_obeyed, printable, printable_lines};
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::fmt;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::OnceLock;

/// The message of the first write that failed. It is global because the streams are.
static LOST: OnceLock<String> = OnceLock::new();

/// The form of progress reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Display {
    /// A progress bar that is redrawn in place.
    Bar,
    /// A line of text from time to time.
    Plain,
    /// A JSON object from time to time.
    Ndjson,
    /// Messages of Open Job Description, on stdout.
    OpenJd,
    /// No progress.
    Silent,
}

impl Display {
    /// Names on the command line.
    pub(crate) const NAMES: [(&'static str, Self); 4] = [
        ("bar", Self::Bar),
        ("plain", Self::Plain),
        ("ndjson", Self::Ndjson),
        ("openjd", Self::OpenJd),
    ];
}

/// The properties of stderr: colour, and whether it is a terminal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Console {
    is_coloured: bool,
    is_terminal: bool,
}

impl Console {
    /// Returns the console of this process.
    ///
    /// `--no-color`, a `NO_COLOR` that is not empty, or `TERM=dumb` turn colour off; else `FORCE_COLOR`
    /// turns it on; else it is on if stderr is a terminal.
    pub(crate) fn new(args: ColorArgs) -> Self {
        let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
        let is_dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let is_terminal = io::stderr().is_terminal() && !is_dumb;
        let is_plain = args.no_color || is_set("NO_COLOR") || is_dumb;
        Self {
            is_coloured: !is_plain && (is_set("FORCE_COLOR") || is_terminal),
            is_terminal,
        }
    }

    /// Returns the form of progress that the flags request, with plain lines instead of a bar if there is no terminal.
    pub(crate) fn display(self, args: TalkArgs) -> Display {
        match args.progress {
            None if args.quiet => Display::Silent,
            None | Some(Display::Bar) if !self.is_terminal => Display::Plain,
            requested => requested.unwrap_or(Display::Bar),
        }
    }

    /// Writes a warning.
    pub(crate) fn warning(self, text: impl fmt::Display) {
        self.label("warning", "1;33", text);
    }

    /// Writes the error that stops the command, and its hint.
    pub(crate) fn failure(self, failure: &Failure) {
        if let Some(diagnostic) = failure.as_diagnostic() {
            let label = self.paint("error", "1;31");
            return write_line(&format!("{label}: {}", self.report(diagnostic)));
        }
        self.label("error", "1;31", failure.message());
        if let Some(hint) = failure.hint() {
            self.label("hint", "1;36", hint);
        }
    }

    /// Writes a line after a coloured label.
    fn label(self, word: &str, style: &str, text: impl fmt::Display) {
        let (label, text) = (self.paint(word, style), text.to_string());
        write_line(&format!("{label}: {}", printable(&text)));
    }

    fn paint(self, word: &str, style: &str) -> String {
        if self.is_coloured {
            format!("\x1b[{style}m{word}\x1b[0m")
        } else {
            word.to_owned()
        }
    }

    /// Returns the message of a diagnostic with the lines of the file, which are already printable.
    fn report(self, diagnostic: &dyn miette::Diagnostic) -> String {
        let theme = if self.is_coloured {
            GraphicalTheme::unicode()
        } else {
            GraphicalTheme::unicode_nocolor()
        };
        // Lines are not wrapped, so that `file:line:column` stays in one piece.
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_links(false)
            .with_wrap_lines(false);
        let mut text = String::new();
        match handler.render_report(&mut text, diagnostic) {
            // Strip only the theme's mark: a message may begin with `x`.
            Ok(()) => text.trim().trim_start_matches("× ").to_owned(),
            Err(_) => diagnostic.to_string(),
        }
    }
}

/// Writes a line to stderr.
pub(crate) fn say(line: impl fmt::Display) {
    write_line(&printable(&line.to_string()));
}

/// Writes a printable line to stderr. [`lost`] reports an error.
fn write_line(line: &str) {
    let _ = noted("stderr", writeln!(io::stderr().lock(), "{line}"));
}

/// Writes data to stdout. A broken pipe is not an error, as the reader has read enough.
pub(crate) fn print(text: &str) -> Result<Exit, Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(printable_lines(text).as_bytes());
    noted("stdout", written.and_then(|()| stdout.flush()))
}

/// Writes a help text: to stdout if the user asked for it, else to stderr.
pub(crate) fn print_help(text: &clap::Error) -> Result<Exit, Failure> {
    let written = text.print().and_then(|()| io::stdout().flush());
    if text.exit_code() == 0 {
        return noted("stdout", written);
    }
    let _ = noted("stderr", written);
    Ok(Exit::Usage)
}

/// Records an error of writing to a stream, and returns it as a failure.
fn noted(stream: &str, written: io::Result<()>) -> Result<Exit, Failure> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let message = format!("cannot write to {stream}: {error}");
            let _ = LOST.set(message.clone());
            Err(Failure::new(Exit::InputOutput, message))
        }
        _ => Ok(Exit::Done),
    }
}

/// Returns the failure of the first write to stdout or stderr that failed. None: all output arrived.
pub(crate) fn lost() -> Option<Failure> {
    let message = LOST.get()?;
    Some(Failure::new(Exit::InputOutput, message.clone()))
}

/// Writes a value to stdout as JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<Exit, Failure> {
    print(&(ascii_escaped(&json(value)?) + "\n"))
}

/// Escapes all control characters in the strings of JSON; serde escapes only those of C0.
fn ascii_escaped(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        if is_obeyed(c) && c != '\n' {
            for unit in c.encode_utf16(&mut [0; 2]) {
                // Writing to a string cannot fail.
                let _ = fmt::Write::write_fmt(&mut escaped, format_args!("\\u{unit:04x}"));
            }
        } else {
            escaped.push(c);
        }
    }
    escaped
}

/// Returns a value as indented JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value)
        .map_err(|error| Failure::new(Exit::RenderFailed, format!("not JSON: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_in_json_are_escaped_and_strings_stay_equal() {
        let text = "a\x1b\x7f\u{9b}\u{202e}\u{2069}µ\n";
        let escaped = ascii_escaped(&json(&[text]).unwrap());
        assert!(
            !escaped.contains(|c| is_obeyed(c) && c != '\n'),
            "{escaped}"
        );
        assert_eq!(
            serde_json::from_str::<[String; 1]>(&escaped).unwrap(),
            [text]
        );
    }
}
