//! Tables of TOML with the positions of their entries.
//!
//! Readers first check a [`Section`] for unknown keys, so that the error for a misspelt required key names the
//! misspelt one, not the missing one.

use super::error::{ExperimentError, Fault, Place};
use bidir::names::nearest;
use std::cell::Cell;
use std::fmt::Display;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

type Result<T> = std::result::Result<T, ExperimentError>;

/// The text of a description.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    pub(super) file: &'a Path,
    pub(super) text: &'a str,
    /// The number of bytes that repetitions may still add.
    pub(super) room: &'a Cell<usize>,
}

impl<'a> Source<'a> {
    /// Parses the whole text as a table.
    pub(super) fn parse(self) -> Result<Section<'a>> {
        let table = DeTable::parse(self.text).map_err(|error| {
            let place = error.span().unwrap_or(0..0);
            self.fault(place, error.message().replace('\n', ", "), None)
        })?;
        Ok(Section {
            source: self,
            place: 0..0,
            table: table.into_inner(),
        })
    }

    fn at(self, place: &Range<usize>) -> Place {
        let before = self.text.get(..place.start).unwrap_or(self.text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Place {
            file: self.file.to_owned(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
        }
    }

    /// Returns an error at a place.
    fn fault(self, place: Range<usize>, message: String, hint: Option<String>) -> ExperimentError {
        let place = self.at(&place);
        ExperimentError::Description(Fault {
            place,
            message,
            hint,
        })
    }
}

/// A table.
#[derive(Clone, Debug)]
pub(super) struct Section<'a> {
    pub(super) source: Source<'a>,
    /// The place of the table's head.
    place: Range<usize>,
    /// The entries not yet taken.
    pub(super) table: DeTable<'a>,
}

/// A value with its place.
#[derive(Debug)]
pub(super) struct Entry<'a> {
    source: Source<'a>,
    place: Range<usize>,
    pub(super) value: DeValue<'a>,
}

impl<'a> Section<'a> {
    /// Refuses unknown keys, and suggests the nearest word of `known`. Accepts keys in `old`, but never suggests them.
    pub(super) fn only(&self, known: &str, old: &[&str]) -> Result<()> {
        let is_known = |name: &str| known.split(' ').any(|known| known == name);
        let is_unknown = |name: &str| !is_known(name) && !old.contains(&name);
        let unknown = self.table.keys().filter(|key| is_unknown(key.get_ref()));
        let Some(key) = unknown.min_by_key(|key| key.span().start) else {
            return Ok(());
        };
        let hint = match nearest(key.get_ref(), known.split(' ')) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known keys are {}", known.replace(' ', ", ")),
        };
        let message = format!("there is no key `{}` here", key.get_ref());
        Err(self.source.fault(key.span(), message, Some(hint)))
    }

    /// Takes the value of a key.
    pub(super) fn take(&mut self, key: &str) -> Option<Entry<'a>> {
        self.table
            .remove(key)
            .map(|value| Entry::new(self.source, value))
    }

    /// Reads the value of a key. None: the key is missing.
    pub(super) fn get<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&Entry<'a>) -> Result<T>,
    ) -> Result<Option<T>> {
        self.take(key).map(|entry| read(&entry)).transpose()
    }

    /// Reads a text of a key, without blanks around it. None: the key is missing.
    pub(super) fn text(&mut self, key: &str) -> Result<Option<String>> {
        self.get(key, |entry| entry.text().map(|text| text.trim().to_owned()))
    }

    /// Reads the table of a key, which has only `known` keys. None: the key is missing.
    pub(super) fn nested<T>(
        &mut self,
        key: &str,
        known: &str,
        read: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<Option<T>> {
        let Some(entry) = self.take(key) else {
            return Ok(None);
        };
        let mut section = entry.section()?;
        section.only(known, &[])?;
        read(&mut section).map(Some)
    }

    /// Copies the values of missing keys from another table.
    pub(super) fn fill(&mut self, other: &Self, keys: &str) {
        for (key, value) in &other.table {
            let name = &**key.get_ref();
            if keys.split(' ').any(|key| key == name) && !self.table.contains_key(name) {
                self.table.insert(key.clone(), value.clone());
            }
        }
    }

    /// Takes the value of a key, also by its older name.
    ///
    /// Errors: both names are present.
    pub(super) fn take_renamed(&mut self, key: &str, older: &str) -> Result<Option<Entry<'a>>> {
        match [self.take(key), self.take(older)] {
            [Some(_), Some(old)] => {
                let message = format!("`{older}` is the older name of `{key}`: write one of them");
                Err(old.fault(message))
            }
            [entry, old] => Ok(entry.or(old)),
        }
    }

    /// Takes the value of a required key.
    pub(super) fn need(&mut self, key: &'static str) -> Result<Entry<'a>> {
        self.take(key)
            .ok_or_else(|| self.fault(format!("`{key}` is missing")))
    }

    /// Takes all tables `[[key]]`, or the one `[key]`, each repeated for the combinations in its `for`.
    pub(super) fn sections(&mut self, key: &'static str) -> Result<Vec<Self>> {
        let Some(entry) = self.take(key) else {
            return Ok(Vec::new());
        };
        let sections = match entry.value {
            DeValue::Array(_) => entry.list("a list of tables")?,
            _ => vec![entry],
        };
        let sections = sections.into_iter().map(Entry::section);
        let expanded = sections.map(|section| section?.expanded());
        Ok(expanded.collect::<Result<Vec<_>>>()?.concat())
    }

    /// Returns the keys with their values, in the order of the file.
    pub(super) fn ordered(self) -> Vec<(String, Entry<'a>)> {
        let mut pairs: Vec<_> = self.table.into_iter().collect();
        pairs.sort_by_key(|(key, _)| key.span().start);
        let entry = |value| Entry::new(self.source, value);
        let pairs = pairs.into_iter();
        let pairs = pairs.map(|(key, value)| (key.into_inner().into_owned(), entry(value)));
        pairs.collect()
    }

    /// Returns an error about the whole table.
    pub(super) fn fault(&self, message: impl Into<String>) -> ExperimentError {
        self.source.fault(self.place.clone(), message.into(), None)
    }
}

impl<'a> Entry<'a> {
    fn new(source: Source<'a>, value: Spanned<DeValue<'a>>) -> Self {
        Self {
            source,
            place: value.span(),
            value: value.into_inner(),
        }
    }

    /// Returns the place of the value.
    pub(super) fn at(&self) -> Place {
        self.source.at(&self.place)
    }

    /// Returns an error about this value.
    pub(super) fn fault(&self, message: impl Into<String>) -> ExperimentError {
        self.source.fault(self.place.clone(), message.into(), None)
    }

    /// Returns an error about this value, with a remedy if there is one.
    pub(super) fn fault_with<'h>(
        &self,
        message: impl Into<String>,
        hint: impl Into<Option<&'h str>>,
    ) -> ExperimentError {
        let hint = hint.into().map(str::to_owned);
        self.source.fault(self.place.clone(), message.into(), hint)
    }

    /// Reads a table.
    pub(super) fn section(self) -> Result<Section<'a>> {
        match self.value {
            DeValue::Table(table) => Ok(Section {
                source: self.source,
                place: self.place,
                table,
            }),
            _ => Err(self.fault("expected a table")),
        }
    }

    /// Reads a text that is not empty.
    pub(super) fn text(&self) -> Result<&str> {
        match &self.value {
            DeValue::String(text) if !text.trim().is_empty() => Ok(text),
            _ => Err(self.fault("expected a text")),
        }
    }

    /// Reads the value of a flag: a text, or a number as it is written.
    pub(super) fn written(&self) -> Result<&str> {
        match &self.value {
            DeValue::Integer(number) if number.radix() == 10 => Ok(number.as_str()),
            DeValue::Integer(_) => Err(self.fault("expected a decimal number")),
            DeValue::Float(number) => Ok(number.as_str()),
            _ => self.text(),
        }
    }

    /// Reads the elements of a list; `kind` names the elements in the error.
    pub(super) fn list(self, kind: &str) -> Result<Vec<Self>> {
        let fault = self.fault(format!("expected {kind}"));
        let DeValue::Array(array) = self.value else {
            return Err(fault);
        };
        let entries = array.into_iter().map(|value| Self::new(self.source, value));
        Ok(entries.collect())
    }

    /// Reads a finite number.
    pub(super) fn number(&self) -> Result<f64> {
        self.parsed("a number", |number: &f64| number.is_finite())
    }

    /// Reads a finite number above zero.
    pub(super) fn positive(&self) -> Result<f64> {
        let is_positive = |number: &f64| *number > 0.0 && number.is_finite();
        self.parsed("a number above 0", is_positive)
    }

    /// Reads a whole number of at least `least`.
    pub(super) fn whole(&self, least: u64) -> Result<u64> {
        // JSON numbers are exact up to this limit.
        let range = least..1 << 53;
        let expected = format!("a whole number of at least {least}");
        self.parsed(&expected, |number| range.contains(number))
    }

    /// Reads a whole number from 1 to `most`.
    pub(super) fn up_to(&self, most: usize) -> Result<usize> {
        let expected = format!("a whole number from 1 to {most}");
        self.parsed(&expected, |number| (1..=most).contains(number))
    }

    /// Reads a number, which may be written as a text. `expected` names the numbers that are inside.
    pub(super) fn parsed<T: FromStr>(
        &self,
        expected: &str,
        is_inside: impl FnOnce(&T) -> bool,
    ) -> Result<T> {
        let text = match &self.value {
            DeValue::Integer(number) => i128::from_str_radix(number.as_str(), number.radix())
                .ok()
                .map(|number| number.to_string()),
            _ => self.written().ok().map(str::to_owned),
        };
        let number = text.and_then(|text| text.parse().ok()).filter(is_inside);
        number.ok_or_else(|| self.fault(format!("expected {expected}")))
    }

    /// Reads `true` or `false`.
    pub(super) fn truth(&self) -> Result<bool> {
        match self.value {
            DeValue::Boolean(truth) => Ok(truth),
            _ => Err(self.fault("expected true or false")),
        }
    }

    /// Parses a text by `read`. An error gets the place of the text.
    pub(super) fn read<T, E: Display>(
        &self,
        read: impl FnOnce(&str) -> std::result::Result<T, E>,
    ) -> Result<T> {
        read(self.written()?).map_err(|error| self.fault(error.to_string()))
    }
}
