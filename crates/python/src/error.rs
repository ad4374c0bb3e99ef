//! Conversion of errors to exceptions of `bidir.errors`.

use formats::{ErrorKind, printable};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;

/// Makes an exception of `bidir.errors` with attributes by name. The message is made [`printable`], as it may
/// reach a terminal unchanged.
fn exception(py: Python<'_>, class: &str, message: &str, attributes: &Bound<'_, PyDict>) -> PyErr {
    let message = printable(message);
    let made = py
        .import("bidir.errors")
        .and_then(|module| module.getattr(class))
        .and_then(|class| class.call((&*message,), Some(attributes)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// Makes an exception of `bidir.errors` without attributes.
pub(crate) fn raise(py: Python<'_>, class: &str, message: &str) -> PyErr {
    exception(py, class, message, &PyDict::new(py))
}

/// Escapes control characters of a text for a terminal.
#[pyfunction]
#[pyo3(name = "printable")]
pub(crate) fn printable_text(text: &str) -> String {
    printable(text).into_owned()
}

/// The attributes of an exception: message, remedy and place.
struct Details<'a> {
    message: &'a str,
    hint: Option<&'a str>,
    file: Option<&'a Path>,
    line: Option<usize>,
    column: Option<usize>,
}

fn detailed(py: Python<'_>, class: &str, text: &str, details: &Details<'_>) -> PyErr {
    let attributes = PyDict::new(py);
    let file = details.file.map(|file| file.display().to_string());
    let set = attributes
        .set_item("reason", details.message)
        .and_then(|()| attributes.set_item("hint", details.hint))
        .and_then(|()| attributes.set_item("file", file))
        .and_then(|()| attributes.set_item("line", details.line))
        .and_then(|()| attributes.set_item("column", details.column));
    match set {
        Ok(()) => exception(py, class, text, &attributes),
        Err(error) => error,
    }
}

/// Converts an error about a file.
pub(crate) fn of_file(py: Python<'_>, error: &formats::Error) -> PyErr {
    let class = match error.kind() {
        ErrorKind::Unsupported => "UnsupportedError",
        ErrorKind::Options => "SettingsError",
        // An error with a place in a scene file is an error of the scene.
        _ if error.has_place() => "SceneError",
        ErrorKind::Syntax | ErrorKind::Scene | ErrorKind::Limit => "SceneError",
        ErrorKind::Data => "DataError",
        ErrorKind::MissingFile => "MissingFileError",
        ErrorKind::Io => "FileError",
        ErrorKind::Memory => "RenderError",
    };
    let details = Details {
        message: error.message(),
        hint: error.hint(),
        file: error.file(),
        line: error.line(),
        column: error.column(),
    };
    detailed(py, class, &error.to_string(), &details)
}

/// Converts an error of an experiment.
pub(crate) fn of_experiment(py: Python<'_>, error: &lab::experiment::ExperimentError) -> PyErr {
    use lab::experiment::ExperimentError;
    if let ExperimentError::File(error) = error {
        return of_file(py, error);
    }
    let fault = match error {
        ExperimentError::Description(fault) | ExperimentError::Absent(fault) => Some(fault),
        _ => None,
    };
    let message = error.to_string();
    let text = match error.hint() {
        Some(hint) => format!("{message}; {hint}"),
        None => message.clone(),
    };
    let details = Details {
        message: fault.map_or(&message, |fault| &fault.message),
        hint: error.hint(),
        file: fault.map(|fault| fault.place.file.as_path()),
        line: fault.map(|fault| fault.place.line),
        column: fault.map(|fault| fault.place.column),
    };
    detailed(py, "ExperimentError", &text, &details)
}
