//! Places in the JSON, told as `meshes[3].primitives[0]`, and what is wrong there.

use crate::error::{Error, ErrorKind};
use crate::source::{Fault, FileId, SourceMap, Span};
use bidir::names::nearest;
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::fmt;

/// A value of the JSON, by the way to it from the top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Place(Vec<Step>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Key(String),
    Index(usize),
}

impl Place {
    /// All of the file.
    pub(super) const TOP: Self = Self(Vec::new());

    /// Element `index` of the top array `name`.
    pub(super) fn of(name: &str, index: usize) -> Self {
        Self::TOP.key(name).index(index)
    }

    /// The value of `name` in this object.
    pub(super) fn key(&self, name: &str) -> Self {
        self.then(Step::Key(name.to_owned()))
    }

    /// An element of this array.
    pub(super) fn index(&self, index: usize) -> Self {
        self.then(Step::Index(index))
    }

    fn then(&self, step: Step) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }

    pub(super) fn fault(&self, kind: ErrorKind, message: impl Into<String>) -> GltfFault {
        GltfFault {
            place: self.clone(),
            kind,
            message: message.into(),
            hint: None,
        }
    }

    /// Something that means nothing valid.
    pub(super) fn scene(&self, message: impl Into<String>) -> GltfFault {
        self.fault(ErrorKind::Scene, message)
    }

    /// Where the value stands in `text`; where it is left out, that of the innermost value around it.
    pub(super) fn span(&self, file: FileId, text: &str) -> Span {
        let mut value = text;
        for step in &self.0 {
            let Some(next) = step.of(value) else { break };
            value = next;
        }
        let start = value.as_ptr() as usize - text.as_ptr() as usize;
        // An object of a hundred lines is marked where it begins.
        let marked = value.find('\n').unwrap_or(value.len());
        Span::new(file, start..start + marked)
    }
}

impl Step {
    /// The text of the value within the JSON text `value`.
    fn of<'a>(&self, value: &'a str) -> Option<&'a str> {
        let raw: &RawValue = match self {
            Self::Key(name) => {
                let object: BTreeMap<String, &RawValue> = serde_json::from_str(value).ok()?;
                object.get(name).copied()?
            }
            Self::Index(index) => {
                let array: Vec<&RawValue> = serde_json::from_str(value).ok()?;
                array.get(*index).copied()?
            }
        };
        Some(raw.get())
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(name) if i > 0 => write!(f, ".{name}")?,
                Step::Key(name) => f.write_str(name)?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// Something wrong at a place.
#[derive(Debug)]
pub(super) struct GltfFault {
    place: Place,
    pub(super) kind: ErrorKind,
    message: String,
    hint: Option<String>,
}

impl GltfFault {
    /// What went wrong with another file, or with bytes within this one.
    pub(super) fn from_error(place: &Place, error: &Error) -> Self {
        place.fault(error.kind(), error.to_string())
    }

    pub(super) fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Adds the nearest of `known` to `name` as a hint, where one is near.
    pub(super) fn with_nearest<'a>(
        self,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        match nearest(name, known) {
            Some(known) => self.with_hint(format!("did you mean `{known}`?")),
            None => self,
        }
    }

    /// The error with line and column.
    pub(super) fn in_text(self, sources: &SourceMap, file: FileId) -> Error {
        let text = sources.text(file);
        let span = self.place.span(file, &text);
        let fault = Fault::new(self.kind, span, describe(&self.place, &self.message));
        sources.error(match self.hint {
            Some(hint) => fault.with_hint(hint),
            None => fault,
        })
    }
}

/// A message with the place before it.
pub(super) fn describe(place: &Place, message: &str) -> String {
    if *place == Place::TOP {
        message.to_owned()
    } else {
        format!("{place}: {message}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn places_are_found_in_the_text() {
        let text = "{\n \"meshes\": [ {}, {\"name\": \"a\",\n  \"primitives\": [7, 8]} ]\n}";
        let mut sources = SourceMap::default();
        let file = sources.add(Path::new("a.gltf"), text.into()).unwrap();
        let check = |place: Place, line, column, name: &str| {
            let found = sources.line_and_column(place.span(file, text));
            assert_eq!((found, &*place.to_string()), ((line, column), name));
        };
        let mesh = Place::of("meshes", 1);
        let primitives = mesh.key("primitives");
        check(Place::TOP, 1, 1, "");
        check(mesh.clone(), 2, 18, "meshes[1]");
        check(primitives.index(1), 3, 21, "meshes[1].primitives[1]");
        // What is left out is told where it should be.
        check(mesh.key("weights"), 2, 18, "meshes[1].weights");
    }
}
