//! `for` and `each`: one table of a description stands for several.
//!
//! `for = { light = ["direct", "indirect"], n = [1, 2] }` repeats its table for every combination, the
//! first key outermost, and replaces `{light}` and `{n}` in all texts. An element that is a table itself
//! replaces each of its keys: `for.weights = [{ weights = "uniform", error = "rmse_trim" }, …]`.
//! Text in braces that no key names stays as it is.

use super::error::ExperimentError;
use super::reader::{Entry, Section};
use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

type Result<T> = std::result::Result<T, ExperimentError>;

/// Texts by the names that stand for them.
pub(super) type Binding = Vec<(String, String)>;

impl Section<'_> {
    /// The tables that this one stands for: itself, where it has no `for`.
    pub(super) fn expanded(mut self) -> Result<Vec<Self>> {
        let bindings = self.bindings("for")?;
        Ok(bindings.iter().map(|binding| self.bound(binding)).collect())
    }

    /// Every combination that the key `key` lists; a single empty one where there is no such key.
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

    /// A copy with the texts of a binding in place of their names.
    pub(super) fn bound(&self, binding: &Binding) -> Self {
        let mut bound = self.clone();
        bound.table = bound_table(&self.table, binding);
        bound
    }
}

/// The texts that an element of a list stands for.
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
