//! Places in the JSON, written as `meshes[3].primitives[0]`, and faults there.

use crate::error::ErrorKind;
use crate::source::Fault;
use std::fmt;

/// An error at a place in the JSON.
pub(super) type GltfFault = Fault<Place>;

/// The path of a value in the JSON, from the top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Place(Vec<Step>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Key(String),
    Index(usize),
}

impl Place {
    /// The whole file.
    pub(super) const TOP: Self = Self(Vec::new());

    /// Returns the place of element `index` of the top array `name`.
    pub(super) fn of(name: &str, index: usize) -> Self {
        Self::TOP.key(name).index(index)
    }

    /// Returns the place of the value `name` in this object.
    pub(super) fn key(&self, name: &str) -> Self {
        self.then(Step::Key(name.to_owned()))
    }

    /// Returns the place of an element of this array.
    pub(super) fn index(&self, index: usize) -> Self {
        self.then(Step::Index(index))
    }

    fn then(&self, step: Step) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }

    pub(super) fn fault(&self, kind: ErrorKind, message: impl Into<String>) -> GltfFault {
        GltfFault::new(kind, self.clone(), message)
    }

    /// Returns the element of `all` whose index is the value at this place; `what` names the kind of element in the
    /// error.
    pub(super) fn find<'a, T>(
        &self,
        all: &'a [T],
        index: usize,
        what: &str,
    ) -> Result<&'a T, GltfFault> {
        all.get(index).ok_or_else(|| {
            let count = all.len();
            self.scene(format!("there is no {what} {index}: the file has {count}"))
        })
    }

    /// Returns the place of an extension of this object.
    pub(super) fn extension(&self, name: &str) -> Self {
        self.key("extensions").key(name)
    }

    /// Returns the fault of an invalid value at this place.
    pub(super) fn scene(&self, message: impl Into<String>) -> GltfFault {
        self.fault(ErrorKind::Scene, message)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_written_as_the_way_to_it() {
        let primitives = Place::of("meshes", 1).key("primitives");
        assert_eq!(primitives.index(2).to_string(), "meshes[1].primitives[2]");
        assert_eq!(Place::TOP.key("asset").to_string(), "asset");
        assert_eq!(Place::TOP.to_string(), "");
    }
}
