//! The `"type name" value` lists that follow most directives.

use super::known;
use super::lexer::{
    Token, TokenKind, Tokens, not_a_number, parse_float, parse_integer, shorten, too_large,
};
use super::scene::ColorSpace;
use super::v3;
use crate::source::{Fault, Span};
use std::sync::Arc;

/// The type word of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterType {
    /// `true` or `false`.
    Bool,
    /// An integer of 32 bits.
    Integer,
    /// One number.
    Float,
    /// Two numbers.
    Point2,
    /// Two numbers.
    Vector2,
    /// Three numbers.
    Point3,
    /// Three numbers.
    Vector3,
    /// Three numbers.
    Normal,
    /// Text or a file name.
    String,
    /// The name of a texture.
    Texture,
    /// A colour in the current colour space.
    Rgb,
    /// Pairs of wavelength and value, or the name of a spectrum or of a file with one.
    Spectrum,
    /// A temperature in kelvin.
    Blackbody,
}

impl ParameterType {
    /// All types with their words in files, in the order of the types.
    const ALL: [(Self, &'static str); 13] = [
        (Self::Bool, "bool"),
        (Self::Integer, "integer"),
        (Self::Float, "float"),
        (Self::Point2, "point2"),
        (Self::Vector2, "vector2"),
        (Self::Point3, "point3"),
        (Self::Vector3, "vector3"),
        (Self::Normal, "normal"),
        (Self::String, "string"),
        (Self::Texture, "texture"),
        (Self::Rgb, "rgb"),
        (Self::Spectrum, "spectrum"),
        (Self::Blackbody, "blackbody"),
    ];

    /// Returns the word in files.
    pub const fn word(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// Returns the number of numbers in one value.
    const fn arity(self) -> usize {
        match self {
            Self::Point2 | Self::Vector2 => 2,
            Self::Point3 | Self::Vector3 | Self::Normal | Self::Rgb => 3,
            _ => 1,
        }
    }

    fn empty(self) -> Values {
        match self {
            Self::Bool => Values::Bools(Vec::new()),
            Self::Integer => Values::Integers(Vec::new()),
            Self::String | Self::Texture => Values::Strings(Vec::new()),
            _ => Values::Floats(Vec::new()),
        }
    }
}

/// The values of a parameter, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// The values of `bool`.
    Bools(Vec<bool>),
    /// The values of `integer`.
    Integers(Vec<i32>),
    /// The values of all other types made of numbers.
    Floats(Vec<f32>),
    /// The values of `string`, `texture` and a named `spectrum`.
    Strings(Vec<String>),
}

impl Values {
    /// Returns the number of words in the file.
    pub fn len(&self) -> usize {
        match self {
            Self::Bools(values) => values.len(),
            Self::Integers(values) => values.len(),
            Self::Floats(values) => values.len(),
            Self::Strings(values) => values.len(),
        }
    }

    pub(super) fn bools(&self) -> &[bool] {
        match self {
            Self::Bools(values) => values,
            _ => &[],
        }
    }

    pub(super) fn integers(&self) -> &[i32] {
        match self {
            Self::Integers(values) => values,
            _ => &[],
        }
    }

    pub(super) fn floats(&self) -> &[f32] {
        match self {
            Self::Floats(values) => values,
            _ => &[],
        }
    }

    pub(super) fn strings(&self) -> &[String] {
        match self {
            Self::Strings(values) => values,
            _ => &[],
        }
    }

    /// Returns true for `[ ]`.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// One `"type name" value`.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The type word.
    pub kind: ParameterType,
    /// The name.
    pub name: String,
    /// The values.
    pub values: Values,
    /// The current colour space, in which `rgb` values are given.
    pub color_space: ColorSpace,
    /// The place of the quoted `type name`.
    pub span: Span,
    /// The place of the value with its brackets.
    pub value_span: Span,
}

/// The parameters of one directive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterList {
    /// The parameters of the directive itself. Of two with the same type and name, the last counts.
    pub explicit: Vec<Parameter>,
    /// The parameters of `Attribute` directives, which apply unless the directive itself has them.
    pub defaults: Arc<Vec<Parameter>>,
}

impl ParameterList {
    /// Returns the parameter of this type and name. None: the file has none.
    pub fn get(&self, kind: ParameterType, name: &str) -> Option<&Parameter> {
        let matches = |parameter: &&Parameter| parameter.kind == kind && parameter.name == name;
        let explicit = self.explicit.iter().rev().find(matches);
        explicit.or_else(|| self.defaults.iter().rev().find(matches))
    }
}

/// Reads parameters up to the first token that is not a quoted string.
pub(super) fn parse_list(
    tokens: &mut Tokens<'_>,
    color_space: ColorSpace,
) -> Result<Vec<Parameter>, Fault> {
    let mut list = Vec::new();
    while let Some((declaration, span)) = tokens.next_if_quoted()? {
        let (kind, name) = parse_declaration(&declaration, span)?;
        let (values, value_span) = parse_values(tokens, kind, &name)?;
        if !values.len().is_multiple_of(kind.arity()) {
            let (word, arity, count) = (kind.word(), kind.arity(), values.len());
            let message =
                format!("`{word} {name}` takes {arity} numbers a value, found {count} in all");
            return Err(Fault::scene(value_span, message));
        }
        list.push(Parameter {
            kind,
            name,
            values,
            color_space,
            span,
            value_span,
        });
    }
    Ok(list)
}

fn parse_declaration(declaration: &str, span: Span) -> Result<(ParameterType, String), Fault> {
    let mut words = declaration
        .split([' ', '\t', '\r', '\n'])
        .filter(|word| !word.is_empty());
    let (Some(word), Some(name), None) = (words.next(), words.next(), words.next()) else {
        let shown = shorten(declaration);
        let message = format!("expected a parameter `\"type name\"`, found \"{shown}\"");
        return Err(Fault::syntax(span, message));
    };
    if let Some(hint) = v3::type_word(word) {
        let mark = format!("the parameter type `{word}`");
        return Err(v3::fault(span, &mark, hint));
    }
    let Some(&(kind, _)) = ParameterType::ALL.iter().find(|(_, known)| *known == word) else {
        let words = ParameterType::ALL.map(|(_, word)| word);
        let message = format!("unknown parameter type `{}`", shorten(word));
        return Err(Fault::syntax(span, message).with_nearest(word, words));
    };
    if let Some(hint) = v3::parameter(name) {
        return Err(v3::fault(span, &format!("the parameter `{name}`"), hint));
    }
    Ok((kind, known::normalized(name)))
}

fn parse_values(
    tokens: &mut Tokens<'_>,
    kind: ParameterType,
    name: &str,
) -> Result<(Values, Span), Fault> {
    let what = format!("a value of `{} {name}`", kind.word());
    let mut values = kind.empty();
    let first = tokens.expect(&what)?;
    if first.kind != TokenKind::Open {
        push(&mut values, kind, &first)?;
        return Ok((values, first.span));
    }
    let inside = format!("{what} or `]`");
    loop {
        let token = tokens.expect(&inside)?;
        if token.kind == TokenKind::Close {
            return Ok((values, first.span.to(token.span)));
        }
        push(&mut values, kind, &token)?;
    }
}

fn push(values: &mut Values, kind: ParameterType, token: &Token<'_>) -> Result<(), Fault> {
    let span = token.span;
    // A spectrum has numbers or names, which its first value decides.
    let is_quoted = matches!(token.kind, TokenKind::Quoted(_));
    if kind == ParameterType::Spectrum && values.is_empty() && is_quoted {
        *values = Values::Strings(Vec::new());
    }
    match (values, &token.kind) {
        (_, TokenKind::Open) => return Err(Fault::syntax(span, "brackets do not nest")),
        (Values::Floats(values), TokenKind::Word(word)) => {
            let value = parse_float(word).ok_or_else(|| not_a_number(token))? as f32;
            if !value.is_finite() {
                return Err(too_large(word, span));
            }
            values.push(value);
        }
        (Values::Integers(values), TokenKind::Word(word)) => values.push(integer(word, span)?),
        (Values::Bools(values), TokenKind::Word(word)) => {
            let expected = || format!("expected `true` or `false`, found `{}`", shorten(word));
            let value = word.parse().map_err(|_| Fault::syntax(span, expected()))?;
            values.push(value);
        }
        (Values::Bools(_), TokenKind::Quoted(_)) => {
            let hint = "write true or false without quotes";
            return Err(v3::fault(span, "a quoted truth value", hint));
        }
        (Values::Strings(values), TokenKind::Quoted(text)) => values.push(text.to_string()),
        (Values::Strings(_), _) => {
            let message = format!("expected a string in quotes, found {}", token.describe());
            return Err(Fault::syntax(span, message));
        }
        _ => return Err(not_a_number(token)),
    }
    Ok(())
}

fn integer(word: &str, span: Span) -> Result<i32, Fault> {
    parse_integer(word).ok_or_else(|| {
        let message = format!("expected an integer of 32 bits, found `{}`", shorten(word));
        Fault::syntax(span, message)
    })
}
