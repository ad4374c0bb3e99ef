//! Errors of the command line that are safe for a terminal: control characters are escaped.

use clap::Error;
use clap::error::ContextValue;
use formats::printable;
use std::borrow::Cow;

/// Returns the same error with [`printable`] arguments and values.
pub(super) fn shown(mut error: Error) -> Error {
    let all: Vec<_> = error
        .context()
        .map(|(kind, value)| (kind, value.clone()))
        .collect();
    if !all.iter().any(|(_, value)| is_foreign(value)) {
        return error;
    }
    for (kind, value) in all {
        error.insert(kind, shown_value(value));
    }
    error
}

/// Returns true for a value with control characters, which never comes from clap itself.
fn is_foreign(value: &ContextValue) -> bool {
    let is_changed = |text: &String| matches!(printable(text), Cow::Owned(_));
    match value {
        ContextValue::String(text) => is_changed(text),
        ContextValue::Strings(texts) => texts.iter().any(is_changed),
        _ => false,
    }
}

fn shown_value(value: ContextValue) -> ContextValue {
    let line = |text: String| printable(&text).into_owned();
    match value {
        ContextValue::String(text) => ContextValue::String(line(text)),
        ContextValue::Strings(texts) => {
            ContextValue::Strings(texts.into_iter().map(line).collect())
        }
        // Suggestions repeat the argument between colour codes, which look like those in the argument.
        ContextValue::StyledStrs(texts) => {
            let plain = texts.into_iter().map(|text| line(text.to_string()).into());
            ContextValue::StyledStrs(plain.collect())
        }
        other => other,
    }
}
