//! Reads an entity's parameters, and refuses those that are not read.

use super::context::Context;
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::{Parameter, ParameterType, Values};
use crate::pbrt::scene::Entity;
use crate::source::{Fault, Span};
use crate::text::number;

/// Reads the parameters of one entity. Parameters that are never read are unknown, and are errors when
/// the reader [finishes](Self::finish).
pub(super) struct Reader<'a, 'c> {
    /// Reads the files that parameters name, and takes warnings.
    pub(super) context: &'a mut Context<'c>,
    entity: &'a Entity,
    read: Vec<(ParameterType, &'static str)>,
}

impl<'a, 'c> Reader<'a, 'c> {
    pub(super) fn new(context: &'a mut Context<'c>, entity: &'a Entity) -> Self {
        Self {
            context,
            entity,
            read: Vec::new(),
        }
    }

    /// Returns the place of the entity's type word, for errors about the whole entity.
    pub(super) fn span(&self) -> Span {
        self.entity.span
    }

    /// Returns the parameter of this type and name. None: the file has none.
    pub(super) fn find(
        &mut self,
        kind: ParameterType,
        name: &'static str,
    ) -> Option<&'a Parameter> {
        self.read.push((kind, name));
        self.entity.parameters.get(kind, name)
    }

    pub(super) fn floats(&mut self, kind: ParameterType, name: &'static str) -> Option<&'a [f32]> {
        match &self.find(kind, name)?.values {
            Values::Floats(values) => Some(values),
            _ => None,
        }
    }

    /// Reads a number. None: the file has none.
    pub(super) fn optional_float(&mut self, name: &'static str) -> Result<Option<f32>, Fault> {
        let Some(parameter) = self.find(ParameterType::Float, name) else {
            return Ok(None);
        };
        match &parameter.values {
            Values::Floats(values) => Ok(Some(*single(parameter, values)?)),
            _ => Ok(None),
        }
    }

    pub(super) fn float(&mut self, name: &'static str, default: f32) -> Result<f32, Fault> {
        Ok(self.optional_float(name)?.unwrap_or(default))
    }

    /// Reads a number within `[min, max]`.
    pub(super) fn float_within(
        &mut self,
        name: &'static str,
        default: f32,
        [min, max]: [f32; 2],
    ) -> Result<f32, Fault> {
        let value = self.float(name, default)?;
        if (min..=max).contains(&value) {
            return Ok(value);
        }
        Err(self.out_of_range(ParameterType::Float, name, &number(value), [min, max]))
    }

    fn out_of_range(
        &self,
        kind: ParameterType,
        name: &str,
        value: &str,
        [min, max]: [f32; 2],
    ) -> Fault {
        let parameter = self.entity.parameters.get(kind, name);
        let span = parameter.map_or(self.entity.span, |parameter| parameter.value_span);
        let range = match [min, max] {
            // Subnormal numbers are too small to compute with.
            [f32::MIN_POSITIVE, f32::MAX] => "above 0".to_owned(),
            [min, f32::MAX] => format!("at least {}", number(min)),
            [min, max] => format!("between {} and {}", number(min), number(max)),
        };
        Fault::scene(span, format!("`{name}` is {value}, but must be {range}"))
    }

    pub(super) fn optional_integer(&mut self, name: &'static str) -> Result<Option<i32>, Fault> {
        let Some(parameter) = self.find(ParameterType::Integer, name) else {
            return Ok(None);
        };
        match &parameter.values {
            Values::Integers(values) => Ok(Some(*single(parameter, values)?)),
            _ => Ok(None),
        }
    }

    /// Reads an integer of at least `min`.
    pub(super) fn integer(
        &mut self,
        name: &'static str,
        default: u32,
        min: u32,
    ) -> Result<u32, Fault> {
        match self.optional_integer(name)? {
            None => Ok(default),
            Some(value) => u32::try_from(value)
                .ok()
                .filter(|&value| value >= min)
                .ok_or_else(|| {
                    let range = [min as f32, f32::MAX];
                    self.out_of_range(ParameterType::Integer, name, &value.to_string(), range)
                }),
        }
    }

    pub(super) fn bool(&mut self, name: &'static str, default: bool) -> Result<bool, Fault> {
        let Some(parameter) = self.find(ParameterType::Bool, name) else {
            return Ok(default);
        };
        match &parameter.values {
            Values::Bools(values) => Ok(*single(parameter, values)?),
            _ => Ok(default),
        }
    }

    /// Reads a string. Returns it with its place.
    pub(super) fn string(&mut self, name: &'static str) -> Result<Option<(&'a str, Span)>, Fault> {
        self.one_string(ParameterType::String, name)
    }

    /// Reads the name of a texture. Returns it with its place.
    pub(super) fn texture(&mut self, name: &'static str) -> Result<Option<(&'a str, Span)>, Fault> {
        self.one_string(ParameterType::Texture, name)
    }

    fn one_string(
        &mut self,
        kind: ParameterType,
        name: &'static str,
    ) -> Result<Option<(&'a str, Span)>, Fault> {
        let Some(parameter) = self.find(kind, name) else {
            return Ok(None);
        };
        match &parameter.values {
            Values::Strings(values) => Ok(Some((
                single(parameter, values)?.as_str(),
                parameter.value_span,
            ))),
            _ => Ok(None),
        }
    }

    pub(super) fn point3(
        &mut self,
        name: &'static str,
        default: [f32; 3],
    ) -> Result<[f32; 3], Fault> {
        self.triple(ParameterType::Point3, name, default)
    }

    /// Reads three numbers of a parameter of this type.
    pub(super) fn triple(
        &mut self,
        kind: ParameterType,
        name: &'static str,
        default: [f32; 3],
    ) -> Result<[f32; 3], Fault> {
        let Some(parameter) = self.find(kind, name) else {
            return Ok(default);
        };
        three(parameter)
    }

    /// Warns of a parameter of the format that has no effect here.
    pub(super) fn ignore(&mut self, kind: ParameterType, name: &'static str) {
        if let Some(parameter) = self.find(kind, name) {
            let message = format!("the parameter `{} {name}` has no effect here", kind.word());
            self.context.warn(parameter.span, message);
        }
    }

    /// Refuses a parameter of the format that the renderer does not support.
    pub(super) fn unsupported(
        &mut self,
        kind: ParameterType,
        name: &'static str,
        substitute: &str,
    ) -> Result<(), Fault> {
        let Some(parameter) = self.find(kind, name) else {
            return Ok(());
        };
        let what = format!("the parameter `{} {name}`", kind.word());
        self.context.unsupported(parameter.span, &what, substitute)
    }

    /// Refuses parameters that were not read.
    pub(super) fn finish(self) -> Result<(), Fault> {
        let is_read = |p: &&Parameter| self.read.iter().any(|&(k, n)| k == p.kind && n == p.name);
        let Some(unknown) = self.entity.parameters.explicit.iter().find(|p| !is_read(p)) else {
            return Ok(());
        };
        let (name, word) = (shorten(&unknown.name), unknown.kind.word());
        let types: Vec<&str> = self
            .read
            .iter()
            .filter(|(_, read)| *read == unknown.name)
            .map(|(kind, _)| kind.word())
            .collect();
        if !types.is_empty() {
            let message = format!("`{name}` is not of type `{word}`");
            let hint = format!("write `{} {name}`", types.join(&format!(" {name}` or `")));
            return Err(Fault::scene(unknown.span, message).with_hint(hint));
        }
        let message = format!(
            "unknown parameter `{name}` of `{}`",
            shorten(&self.entity.kind)
        );
        let known = self.read.iter().map(|(_, name)| *name);
        Err(Fault::scene(unknown.span, message).with_nearest(&unknown.name, known))
    }
}

/// Returns the only one of `values`.
pub(super) fn single<'v, T>(parameter: &Parameter, values: &'v [T]) -> Result<&'v T, Fault> {
    match values {
        [value] => Ok(value),
        _ => Err(wrong_count(parameter, values.len())),
    }
}

/// Returns the three numbers of a parameter with one value.
pub(super) fn three(parameter: &Parameter) -> Result<[f32; 3], Fault> {
    match &parameter.values {
        Values::Floats(values) => values
            .as_slice()
            .try_into()
            .map_err(|_| wrong_count(parameter, values.len() / 3)),
        values => Err(wrong_count(parameter, values.len())),
    }
}

fn wrong_count(parameter: &Parameter, count: usize) -> Fault {
    let message = format!("`{}` has one value, found {count}", parameter.name);
    Fault::scene(parameter.value_span, message)
}
