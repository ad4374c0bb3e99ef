//! `for` and `each`: repetitions of a table of a description.
//!
//! `for = { light = ["direct", "indirect"], n = [1, 2] }` repeats its table for every combination, the
//! first key outermost, and replaces `{light}` and `{n}` in all texts. An element that is itself a table
//! replaces each of its keys: `for.weights = [{ weights = "uniform", error = "rmse_trim" }, …]`.
//! Other text in braces stays unchanged.

use super::error::ExperimentError;
use super::reader::{Entry, Section};
use std::borrow::Cow;
use std::cell::Cell;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

type Result<T> = std::result::Result<T, ExperimentError>;

/// Maximum number of combinations of one key, as texts of a few bytes must not fill the memory.
const MOST: usize = 10_000;

/// Replacement texts by the names of their placeholders.
pub(super) type Binding = Vec<(String, String)>;

impl Section<'_> {
    /// Returns a copy of the table for each combination of its `for`, or without `for`, the table itself.
    pub(super) fn expanded(mut self) -> Result<Vec<Self>> {
        let bindings = self.bindings("for")?;
        bindings.iter().map(|binding| self.bound(binding)).collect()
    }

    /// Reads all combinations of the lists in the key `key`, or without this key, returns a single empty one.
    ///
    /// Errors: a list is empty, or there are more than [`MOST`].
    pub(super) fn bindings(&mut self, key: &str) -> Result<Vec<Binding>> {
        let Some(entry) = self.take(key) else {
            return Ok(vec![Binding::new()]);
        };
        let nothing = entry.fault(format!("`{key}` has an empty list"));
        let too_many = entry.fault(format!("`{key}` makes more than {MOST} combinations"));
        let mut all = vec![Binding::new()];
        for (name, list) in entry.section()?.ordered() {
            let elements = list.list("a list")?;
            let elements = elements.into_iter().map(|element| binding(&name, element));
            let elements = elements.collect::<Result<Vec<_>>>()?;
            if elements.is_empty() {
                return Err(nothing);
            }
            if all.len() * elements.len() > MOST {
                return Err(too_many);
            }
            let with = |binding: &Binding| {
                let more = elements.iter().map(|more| [binding.clone(), more.clone()]);
                more.map(|parts| parts.concat()).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(with).collect();
        }
        Ok(all)
    }

    /// Copies the table and replaces the placeholders of a binding.
    ///
    /// Errors: the copies have more bytes than repetitions may add.
    pub(super) fn bound(&self, binding: &Binding) -> Result<Self> {
        let copying = Copying {
            binding,
            room: self.source.room,
        };
        let table = copying.table(&self.table);
        let too_large = || self.fault("repetition makes this description too large");
        let mut bound = self.clone();
        bound.table = table.ok_or_else(too_large)?;
        Ok(bound)
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

/// Copies values and replaces the placeholders of a binding, while the bytes fit in `room`.
struct Copying<'b> {
    binding: &'b Binding,
    room: &'b Cell<usize>,
}

impl Copying<'_> {
    fn take(&self, bytes: usize) -> Option<()> {
        self.room.set(self.room.get().checked_sub(bytes)?);
        Some(())
    }

    fn table<'a>(&self, table: &DeTable<'a>) -> Option<DeTable<'a>> {
        let pairs = table.iter().map(|(key, value)| {
            self.take(key.get_ref().len())?;
            Some((key.clone(), self.value(value)?))
        });
        pairs.collect()
    }

    fn value<'a>(&self, value: &Spanned<DeValue<'a>>) -> Option<Spanned<DeValue<'a>>> {
        self.take(size_of_val(value))?;
        let copy = match value.get_ref() {
            DeValue::String(text) => DeValue::String(self.text(text)?),
            DeValue::Array(list) => {
                let values = list.iter().map(|one| self.value(one));
                DeValue::Array(values.collect::<Option<_>>()?)
            }
            DeValue::Table(table) => DeValue::Table(self.table(table)?),
            other => other.clone(),
        };
        Some(Spanned::new(value.span(), copy))
    }

    /// Replaces placeholders one after another, also within replacements: each may double the text. None: the text
    /// does not fit in `room`.
    fn text<'a>(&self, text: &Cow<'a, str>) -> Option<Cow<'a, str>> {
        self.take(text.len())?;
        let mut text = text.clone();
        for (name, value) in self.binding {
            let name = format!("{{{name}}}");
            let count = text.matches(&name).count();
            if count > 0 {
                self.take(count.checked_mul(value.len())?)?;
                text = text.replace(&name, value).into();
            }
        }
        Some(text)
    }
}

#[cfg(test)]
mod tests {
    use crate::experiment::Experiment;
    use std::path::Path;

    fn read(method: &str) -> Result<Experiment, String> {
        let head = "[[scene]]\nfile = \"a.pbrt\"\nreference-spp = 1\n[[budget]]\nsamples = 1\n";
        let text = [head, "[[method]]\n", method].concat();
        Experiment::read(&text, Path::new("a.toml")).map_err(|error| error.to_string())
    }

    #[test]
    fn a_table_stands_for_every_combination() {
        let text =
            "for.b = [\"x\", { b = \"y\", c = 3 }]\nfor.a = [1, 2]\nname = \"{b}{a}{c} {d}\"";
        let experiment = read(text).unwrap();
        let names: Vec<_> = experiment.methods.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["x1{c} {d}", "x2{c} {d}", "y13 {d}", "y23 {d}"]);
    }

    #[test]
    fn placeholders_become_numbers() {
        let text = "name = \"a\"\n[[budget]]\nfor.n = [2, 4]\nsamples = \"{n}\"";
        let budgets = read(text).unwrap().budgets;
        let names: Vec<_> = budgets.iter().map(|budget| &*budget.name).collect();
        assert_eq!(names, ["1 spp", "2 spp", "4 spp"]);
    }

    #[test]
    fn copies_are_limited() {
        let numbers: Vec<_> = (0..9000).map(|n| n.to_string()).collect();
        let text = format!(
            "for.a = [{}]\nname = \"{{a}}{}\"",
            numbers.join(", "),
            "x".repeat(9000)
        );
        let error = read(&text).unwrap_err();
        assert!(
            error.ends_with("repetition makes this description too large"),
            "{error}"
        );
    }

    #[test]
    fn texts_that_double_with_each_key_are_limited() {
        let keys = (0..60).map(|i| format!("k{i} = \"{{k{0}}}{{k{0}}}\"", i + 1));
        let element = keys.collect::<Vec<_>>().join(", ");
        let error = read(&format!("for.a = [{{ {element} }}]\nname = \"{{k0}}\"")).unwrap_err();
        let expected = "repetition makes this description too large";
        assert!(error.ends_with(expected), "{error}");
    }
}
