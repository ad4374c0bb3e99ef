//! The directives that change the current transformation.

use super::Done;
use crate::pbrt::known;
use crate::pbrt::lexer::{Token, TokenKind, Tokens, not_a_number, parse_float, shorten, too_large};
use crate::pbrt::parser::Parser;
use crate::pbrt::transform::{self, Active, Reason, Transforms};
use crate::source::{Fault, Span};
use glam::{DAffine3, DVec3};

pub(super) fn coordinate_system(parser: &mut Parser, tokens: &mut Tokens<'_>, word: &str) -> Done {
    let (name, span) = tokens.expect_quoted("the name of a coordinate system")?;
    let name = known::normalized(&name);
    let scope = &mut parser.scope;
    let times = scope.state.transforms.times;
    if word == "CoordinateSystem" {
        scope
            .coordinate_systems
            .insert(name, scope.state.transforms);
    } else if let Some(&system) = scope.coordinate_systems.get(&name) {
        scope.state.transforms = Transforms { times, ..system };
    } else {
        let message = format!("unknown coordinate system `{}` is ignored", shorten(&name));
        parser.warn(span, message);
    }
    Ok(())
}

pub(super) fn active_transform(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let token = tokens.expect("`All`, `StartTime` or `EndTime`")?;
    parser.scope.state.active = match token.kind {
        TokenKind::Word("All") => Active::All,
        TokenKind::Word("StartTime") => Active::StartTime,
        TokenKind::Word("EndTime") => Active::EndTime,
        _ => {
            let found = token.describe();
            let message = format!("expected `All`, `StartTime` or `EndTime`, found {found}");
            return Err(Fault::syntax(token.span, message));
        }
    };
    Ok(())
}

pub(super) fn change(parser: &mut Parser, tokens: &mut Tokens<'_>, word: &str, span: Span) -> Done {
    let because = |reason: Reason| Fault::scene(span, format!("`{word}`: {reason}"));
    let change = match word {
        "Identity" => DAffine3::IDENTITY,
        "Transform" | "ConcatTransform" => {
            transform::matrix(&bracketed(tokens)?).map_err(because)?
        }
        "Translate" => DAffine3::from_translation(DVec3::from(numbers(tokens)?)),
        "Scale" => DAffine3::from_scale(DVec3::from(numbers(tokens)?)),
        "Rotate" => {
            let [degrees, x, y, z] = numbers(tokens)?;
            transform::rotate(degrees, DVec3::new(x, y, z)).map_err(because)?
        }
        _ => {
            let [ex, ey, ez, tx, ty, tz, ux, uy, uz] = numbers(tokens)?;
            let (eye, target) = (DVec3::new(ex, ey, ez), DVec3::new(tx, ty, tz));
            let up = DVec3::new(ux, uy, uz);
            transform::look_at(eye, target, up).map_err(because)?
        }
    };
    let replaces = matches!(word, "Identity" | "Transform");
    let state = &mut parser.scope.state;
    let active = state.active;
    state.transforms.change(
        active,
        |current| if replaces { change } else { current * change },
    );
    Ok(())
}

/// Reads exactly `N` numbers without brackets.
pub(super) fn numbers<const N: usize>(tokens: &mut Tokens<'_>) -> Result<[f64; N], Fault> {
    let mut values = [0.0; N];
    for value in &mut values {
        let token = tokens.expect("a number")?;
        *value = number(&token)?;
    }
    Ok(values)
}

/// Reads exactly `N` numbers within brackets.
fn bracketed<const N: usize>(tokens: &mut Tokens<'_>) -> Result<[f64; N], Fault> {
    expect_bracket(tokens, &TokenKind::Open, "`[`")?;
    let values = numbers(tokens)?;
    expect_bracket(tokens, &TokenKind::Close, &format!("`]` after {N} numbers"))?;
    Ok(values)
}

fn expect_bracket(tokens: &mut Tokens<'_>, bracket: &TokenKind<'_>, what: &str) -> Done {
    let token = tokens.expect(what)?;
    if token.kind == *bracket {
        return Ok(());
    }
    let message = format!("expected {what}, found {}", token.describe());
    Err(Fault::syntax(token.span, message))
}

fn number(token: &Token<'_>) -> Result<f64, Fault> {
    let TokenKind::Word(word) = token.kind else {
        return Err(not_a_number(token));
    };
    let value = parse_float(word).ok_or_else(|| not_a_number(token))?;
    if value.is_finite() {
        return Ok(value);
    }
    Err(too_large(word, token.span))
}
