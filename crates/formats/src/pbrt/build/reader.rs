//! Reads an entity's parameters, and refuses the parameters that nobody read.

use super::context::Context;
use crate::pbrt::known;
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
        Some(self.find(kind, name)?.values.floats())
    }

    /// Reads the only value of a parameter. Returns the value with its place.
    fn one<T>(
        &mut self,
        kind: ParameterType,
        name: &'static str,
        values: fn(&'a Values) -> &'a [T],
    ) -> Result<Option<(&'a T, Span)>, Fault> {
        let Some(parameter) = self.find(kind, name) else {
            return Ok(None);
        };
        let value = single(parameter, values(&parameter.values))?;
        Ok(Some((value, parameter.value_span)))
    }

    /// Reads a number. None: the file has none.
    pub(super) fn optional_float(&mut self, name: &'static str) -> Result<Option<f32>, Fault> {
        let found = self.one(ParameterType::Float, name, Values::floats)?;
        Ok(found.map(|(&value, _)| value))
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
        let found = self.one(ParameterType::Integer, name, Values::integers)?;
        Ok(found.map(|(&value, _)| value))
    }

    /// Reads an integer of at least `min`.
    pub(super) fn integer(
        &mut self,
        name: &'static str,
        default: u32,
        min: u32,
    ) -> Result<u32, Fault> {
        let Some(value) = self.optional_integer(name)? else {
            return Ok(default);
        };
        let valid = u32::try_from(value).ok().filter(|&value| value >= min);
        valid.ok_or_else(|| {
            let range = [min as f32, f32::MAX];
            self.out_of_range(ParameterType::Integer, name, &value.to_string(), range)
        })
    }

    pub(super) fn bool(&mut self, name: &'static str, default: bool) -> Result<bool, Fault> {
        let found = self.one(ParameterType::Bool, name, Values::bools)?;
        Ok(found.map_or(default, |(&value, _)| value))
    }

    /// Reads a string. Returns it with its place.
    pub(super) fn string(&mut self, name: &'static str) -> Result<Option<(&'a str, Span)>, Fault> {
        let found = self.one(ParameterType::String, name, Values::strings)?;
        Ok(found.map(|(text, span)| (text.as_str(), span)))
    }

    /// Reads the name of a texture. Returns it with its place.
    pub(super) fn texture(&mut self, name: &'static str) -> Result<Option<(&'a str, Span)>, Fault> {
        let found = self.one(ParameterType::Texture, name, Values::strings)?;
        Ok(found.map(|(text, span)| (text.as_str(), span)))
    }

    /// Reads a string that names one of `choices`, by default the first; `what` names the kind of choice in the error.
    pub(super) fn choice<T: Copy>(
        &mut self,
        name: &'static str,
        what: &str,
        choices: &[(&str, T)],
    ) -> Result<T, Fault> {
        let Some((word, span)) = self.string(name)? else {
            return Ok(choices[0].1);
        };
        let chosen = choices.iter().find(|(known, _)| *known == word);
        let known = choices.iter().map(|(known, _)| *known);
        chosen
            .map(|&(_, choice)| choice)
            .ok_or_else(|| known::unknown(span, what, word, known))
    }

    /// Returns a fault of the whole entity.
    pub(super) fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::scene(self.span(), message)
    }

    /// Returns the fault of an entity without a parameter that it needs.
    pub(super) fn missing(&self, parameter: &str) -> Fault {
        self.fault(format!("the parameter `{parameter}` is missing"))
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
        self.find(kind, name).map_or(Ok(default), three)
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
    let values = parameter.values.floats();
    let found = values.try_into();
    found.map_err(|_| wrong_count(parameter, values.len() / 3))
}

fn wrong_count(parameter: &Parameter, count: usize) -> Fault {
    let message = format!("`{}` has one value, found {count}", parameter.name);
    Fault::scene(parameter.value_span, message)
}
