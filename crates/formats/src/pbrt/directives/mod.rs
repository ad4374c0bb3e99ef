//! Applies directives to the state of the parser.

mod transforms;
mod world;

use super::known;
use super::lexer::{TokenKind, Tokens, shorten};
use super::parameters::Parameter;
use super::parser::Parser;
use super::scene::{CameraDescription, ColorSpace, FilmDescription, OptionDescription};
use super::state::Opener;
use super::transform::{Active, Transforms};
use crate::error::ErrorKind;
use crate::import::opposite;
use crate::limits::{MOST_DEFAULT_VALUES, MOST_DEFAULTS};
use crate::source::{Fault, Span};
use std::sync::Arc;

type Done = Result<(), Fault>;

/// Applies the directive `word`, whose arguments follow in `tokens`.
///
/// `word` is one of [`known::directives`] and stands in a valid block.
pub(super) fn apply(parser: &mut Parser, tokens: &mut Tokens<'_>, word: &str, span: Span) -> Done {
    match word {
        "Include" | "Import" => files(parser, tokens, word),
        "WorldBegin" => {
            world_begin(parser);
            Ok(())
        }
        "AttributeBegin" => parser.open_block(Opener::Attribute, span),
        "AttributeEnd" => parser.close_block(Opener::Attribute, span),
        "TransformBegin" => {
            let message = "`TransformBegin` saves the whole state: write `AttributeBegin`";
            parser.warn(span, message);
            parser.open_block(Opener::Transform, span)
        }
        "TransformEnd" => parser.close_block(Opener::Transform, span),
        "ObjectBegin" | "ObjectEnd" | "ObjectInstance" => world::object(parser, tokens, word, span),
        "Camera" | "Film" | "Sampler" | "Integrator" | "Accelerator" | "PixelFilter" => {
            setting(parser, tokens, word)
        }
        "Option" => option(parser, tokens),
        "ColorSpace" => color_space(parser, tokens),
        "Attribute" => attribute(parser, tokens),
        "ReverseOrientation" => {
            let state = &mut parser.scope.state;
            state.orientation = opposite(state.orientation);
            Ok(())
        }
        "Material" | "MakeNamedMaterial" | "NamedMaterial" => world::material(parser, tokens, word),
        "Texture" => world::texture(parser, tokens),
        "LightSource" => world::light_source(parser, tokens),
        "AreaLightSource" => world::area_light_source(parser, tokens),
        "Shape" => world::shape(parser, tokens),
        "MakeNamedMedium" => world::make_named_medium(parser, tokens),
        "MediumInterface" => world::medium_interface(parser, tokens),
        "CoordinateSystem" | "CoordSysTransform" => {
            transforms::coordinate_system(parser, tokens, word)
        }
        "ActiveTransform" => transforms::active_transform(parser, tokens),
        "TransformTimes" => {
            let [start, end] = transforms::numbers(tokens)?;
            parser.scope.state.transforms.times = [start as f32, end as f32];
            Ok(())
        }
        _ => transforms::change(parser, tokens, word, span),
    }
}

fn files(parser: &mut Parser, tokens: &mut Tokens<'_>, word: &str) -> Done {
    let (name, span) = tokens.expect_quoted("a file name")?;
    if word == "Include" {
        parser.include(&name, span)
    } else {
        parser.import(&name, span)
    }
}

fn world_begin(parser: &mut Parser) {
    let scope = &mut parser.scope;
    let world = Transforms::identity(scope.state.transforms.times);
    scope.state.transforms = world;
    scope.state.active = Active::All;
    scope.coordinate_systems.insert("world".into(), world);
    parser.in_world = true;
}

fn setting(parser: &mut Parser, tokens: &mut Tokens<'_>, word: &str) -> Done {
    let none = Arc::default();
    match word {
        "Camera" => {
            let entity = parser.entity(tokens, &known::CAMERAS, &none)?;
            let transforms = world::placement(parser, entity.span)?;
            let medium = parser.scope.state.medium.clone();
            let systems = &mut parser.scope.coordinate_systems;
            systems.insert("camera".into(), transforms.inverse());
            parser.scene.camera = Some(CameraDescription {
                entity,
                transforms,
                medium,
            });
        }
        "Film" => {
            let entity = parser.entity(tokens, &known::FILMS, &none)?;
            let color_space = parser.scope.state.color_space;
            parser.scene.film = Some(FilmDescription {
                entity,
                color_space,
            });
        }
        "Sampler" => parser.scene.sampler = Some(parser.entity(tokens, &known::SAMPLERS, &none)?),
        "Integrator" => {
            parser.scene.integrator = Some(parser.entity(tokens, &known::INTEGRATORS, &none)?);
        }
        "PixelFilter" => {
            parser.scene.filter = Some(parser.entity(tokens, &known::FILTERS, &none)?);
        }
        _ => parser.scene.accelerator = Some(parser.entity(tokens, &known::ACCELERATORS, &none)?),
    }
    Ok(())
}

fn option(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let (name, span) = tokens.expect_quoted("the name of an option")?;
    let name = name.to_lowercase().replace(['-', '_'], "");
    known::OPTIONS.check(&name, span)?;
    let token = tokens.expect("the option's value")?;
    let value = match token.kind {
        TokenKind::Word(word) => word.to_owned(),
        TokenKind::Quoted(text) => text.into_owned(),
        _ => {
            let message = "expected the option's value without brackets";
            return Err(Fault::syntax(token.span, message));
        }
    };
    parser
        .scene
        .options
        .push(OptionDescription { name, value, span });
    Ok(())
}

fn color_space(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let (name, span) = tokens.expect_quoted("a colour space")?;
    let spaces = [
        ("srgb", ColorSpace::Srgb),
        ("dci-p3", ColorSpace::DciP3),
        ("rec2020", ColorSpace::Rec2020),
        ("aces2065-1", ColorSpace::Aces2065),
    ];
    let Some((_, space)) = spaces
        .iter()
        .find(|(known, _)| name.eq_ignore_ascii_case(known))
    else {
        let known = spaces.map(|(known, _)| known);
        return Err(known::unknown(span, "colour space", &name, known));
    };
    parser.scope.state.color_space = *space;
    Ok(())
}

fn attribute(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let (target, span) = tokens.expect_quoted("the target of an attribute")?;
    let parameters = parser.parameters(tokens)?;
    let defaults = &mut parser.scope.state.defaults;
    let list = match &*target {
        "shape" => &mut defaults.shape,
        "light" => &mut defaults.light,
        "material" => &mut defaults.material,
        "medium" => &mut defaults.medium,
        "texture" => &mut defaults.texture,
        _ => {
            let targets = ["shape", "light", "material", "medium", "texture"];
            let message = format!("unknown target `{}` of an attribute", shorten(&target));
            return Err(Fault::scene(span, message).with_nearest(&target, targets));
        }
    };
    let all = Arc::make_mut(list);
    // Of two parameters with the same type and name, the last counts.
    let same = |a: &Parameter, b: &Parameter| a.kind == b.kind && a.name == b.name;
    all.retain(|old| !parameters.iter().any(|new| same(old, new)));
    all.extend(parameters);
    let values = all.iter().map(|parameter| parameter.values.len());
    if all.len() > MOST_DEFAULTS || values.sum::<usize>() > MOST_DEFAULT_VALUES {
        let message = format!(
            "the attributes of `{target}` are more than {MOST_DEFAULTS} parameters or \
             {MOST_DEFAULT_VALUES} values"
        );
        return Err(Fault::new(ErrorKind::Limit, span, message));
    }
    Ok(())
}
