//! `for` and `each`: repetitions of a table of a description.
//!
//! `for = { light = ["direct", "indirect"], n = [1, 2] }` repeats its table for every combination, the
//! first key outermost, and replaces `{light}` and `{n}` in all texts. An element that is itself a table
//! replaces each of its keys: `for.weights = [{ weights = "uniform", error = "rmse_trim" }, …]`.
//! Other text in braces stays unchanged.

use super::error::ExperimentError;
use super::reader::{Entry, Section};
use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

type Result<T> = std::result::Result<T, ExperimentError>;

/// Replacement texts by the names of their placeholders.
pub(super) type Binding = Vec<(String, String)>;

impl Section<'_> {
    /// Expands `for`; without it, returns the table itself.
    pub(super) fn expanded(mut self) -> Result<Vec<Self>> {
        let bindings = self.bindings("for")?;
        Ok(bindings.iter().map(|binding| self.bound(binding)).collect())
    }

    /// Reads all combinations listed in the key `key`; without it, returns a single empty one.
    pub(super) fn bindings(&mut self, key: &str) -> Result<Vec<Binding>> {
        let Some(entry) = self.take(key) else {
            return Ok(vec![Binding::new()]);
        };
        let mut all = vec![Binding::new()];
        for (name, list) in entry.section()?.ordered() {
            let elements = list.list("a list")?;
            let elements = elements.into_iter().map(|element| binding(&name, element));
            let elements = elements.collect::<Result<Vec<_>>>()?;
            let with = |binding: &Binding| {
                let more = elements.iter().map(|more| [binding.clone(), more.clone()]);
                more.map(|parts| parts.concat()).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(with).collect();
        }
        Ok(all)
    }

    /// Copies the table and replaces the placeholders of a binding.
    pub(super) fn bound(&self, binding: &Binding) -> Self {
        let mut bound = self.clone();
        bound.table = bound_table(&self.table, binding);
        bound
    }
}

/// Reads the replacement texts of an element of a list.
fn binding(name: &str, element: Entry<'_>) -> Result<Binding> {
    if !matches!(element.value, DeValue::Table(_)) {
        return Ok(vec![(name.to_owned(), element.written()?.to_owned())]);
    }
    let parts = element.section()?.ordered().into_iter();
    let parts = parts.map(|(name, value)| Ok((name, value.written()?.to_owned())));
    parts.collect()
}

fn bound_table<'a>(table: &DeTable<'a>, binding: &Binding) -> DeTable<'a> {
    let pairs = table.iter();
    let pairs = pairs.map(|(key, value)| (key.clone(), bound_value(value, binding)));
    pairs.collect()
}

fn bound_value<'a>(value: &Spanned<DeValue<'a>>, binding: &Binding) -> Spanned<DeValue<'a>> {
    let bound = match value.get_ref() {
        DeValue::String(text) => DeValue::String(bound_text(text, binding)),
        DeValue::Array(list) => {
            DeValue::Array(list.iter().map(|one| bound_value(one, binding)).collect())
        }
        DeValue::Table(table) => DeValue::Table(bound_table(table, binding)),
        other => other.clone(),
    };
    Spanned::new(value.span(), bound)
}

fn bound_text<'a>(text: &Cow<'a, str>, binding: &Binding) -> Cow<'a, str> {
    let mut text = text.clone();
    for (name, value) in binding {
        let name = format!("{{{name}}}");
        if text.contains(&name) {
            text = text.replace(&name, value).into();
        }
    }
    text
}
