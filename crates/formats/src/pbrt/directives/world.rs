//! The directives that define the world: objects, materials, textures, lights, shapes and media.

use super::Done;
use crate::pbrt::definitions::defined_again;
use crate::pbrt::known;
use crate::pbrt::lexer::{Token, TokenKind, Tokens};
use crate::pbrt::parameters::{Parameter, ParameterList, ParameterType};
use crate::pbrt::parser::Parser;
use crate::pbrt::scene::{
    Entity, InstanceDescription, LightDescription, MaterialDescription, MediumDescription,
    MediumInterface, MediumReference, ShapeDescription, TextureDescription, TextureKind,
};
use crate::pbrt::state::Opener;
use crate::pbrt::transform::{self, Transforms};
use crate::source::{Fault, Span};
use std::sync::Arc;

pub(super) fn object(parser: &mut Parser, tokens: &mut Tokens<'_>, word: &str, span: Span) -> Done {
    if word == "ObjectEnd" {
        parser.close_block(Opener::Object, span)?;
        parser.object = None;
        return Ok(());
    }
    let (name, name_span) = tokens.expect_quoted("the name of an object")?;
    if word == "ObjectBegin" {
        parser.object_begin(&name, name_span)?;
        parser.open_block(Opener::Object, span)?;
        return Ok(());
    }
    if parser.object.is_some() {
        let message = "an object is placed within an object";
        return Err(Fault::scene(name_span, message));
    }
    let object = parser.object_use(&name, name_span);
    let transforms = placement(parser, span)?;
    parser.scene.instances.push(InstanceDescription {
        object,
        transforms,
        span: name_span,
    });
    Ok(())
}

/// Returns the current transformation, which has to be invertible.
pub(super) fn placement(parser: &Parser, span: Span) -> Result<Transforms, Fault> {
    let transforms = parser.scope.state.transforms;
    if transform::is_invertible(&transforms.start) && transform::is_invertible(&transforms.end) {
        return Ok(transforms);
    }
    Err(
        Fault::scene(span, "the current transformation is not invertible")
            .with_hint("look for a scale by zero or numbers out of range"),
    )
}

pub(super) fn material(parser: &mut Parser, tokens: &mut Tokens<'_>, word: &str) -> Done {
    let defaults = Arc::clone(&parser.scope.state.defaults.material);
    match word {
        "Material" => {
            let entity = Some(parser.entity(tokens, &known::MATERIALS, &defaults)?);
            let material = MaterialDescription { name: None, entity };
            parser.scene.materials.push(material);
            parser.scope.state.material = parser.scene.materials.len() - 1;
        }
        "NamedMaterial" => {
            let (name, span) = tokens.expect_quoted("the name of a material")?;
            parser.scope.state.material = parser.material_use(&name, span);
        }
        _ => {
            let (name, span) = tokens.expect_quoted("the name of a material")?;
            let explicit = parser.parameters(tokens)?;
            let entity = typed_entity(explicit, defaults, span, &known::MATERIALS)?;
            parser.material_define(&name, span, entity)?;
        }
    }
    Ok(())
}

/// Returns the entity whose type word is the parameter `"string type"`.
fn typed_entity(
    mut explicit: Vec<Parameter>,
    defaults: Arc<Vec<Parameter>>,
    span: Span,
    names: &known::Names,
) -> Result<Entity, Fault> {
    let is_type = |p: &Parameter| p.kind == ParameterType::String && p.name == "type";
    let Some(parameter) = explicit.iter().rfind(|p| is_type(p)) else {
        return Err(Fault::scene(span, "the parameter `string type` is missing"));
    };
    let span = parameter.value_span;
    let [kind] = parameter.values.strings() else {
        return Err(Fault::scene(span, "`string type` has one value"));
    };
    let kind = kind.clone();
    names.check(&kind, span)?;
    explicit.retain(|p| !is_type(p));
    Ok(Entity {
        kind,
        parameters: ParameterList { explicit, defaults },
        span,
    })
}

pub(super) fn texture(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let (name, name_span) = tokens.expect_quoted("the name of a texture")?;
    let name = known::normalized(&name);
    let (kind, kind_span) = tokens.expect_quoted("`float` or `spectrum`")?;
    known::TEXTURE_KINDS.check(&kind, kind_span)?;
    let kind = if kind == "float" {
        TextureKind::Float
    } else {
        TextureKind::Spectrum
    };
    let defaults = Arc::clone(&parser.scope.state.defaults.texture);
    let entity = parser.entity(tokens, &known::TEXTURES, &defaults)?;
    if !parser.texture_names.insert((kind, name.clone())) {
        return Err(defined_again(name_span, "texture", &name));
    }
    let transforms = placement(parser, entity.span)?;
    parser.scene.textures.push(TextureDescription {
        name,
        kind,
        entity,
        transforms,
    });
    Ok(())
}

pub(super) fn light_source(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let defaults = Arc::clone(&parser.scope.state.defaults.light);
    let entity = parser.entity(tokens, &known::LIGHTS, &defaults)?;
    let transforms = placement(parser, entity.span)?;
    parser
        .scene
        .lights
        .push(LightDescription { entity, transforms });
    Ok(())
}

pub(super) fn area_light_source(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    // An empty name switches emission off.
    if matches!(tokens.peek()?, Some(Token { kind: TokenKind::Quoted(name), .. }) if name.is_empty())
    {
        tokens.next()?;
        parser.parameters(tokens)?;
        parser.scope.state.area_light = None;
        return Ok(());
    }
    let defaults = Arc::clone(&parser.scope.state.defaults.light);
    let entity = parser.entity(tokens, &known::AREA_LIGHTS, &defaults)?;
    parser.scope.state.area_light = Some(Arc::new(entity));
    Ok(())
}

pub(super) fn shape(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let defaults = Arc::clone(&parser.scope.state.defaults.shape);
    let entity = parser.entity(tokens, &known::SHAPES, &defaults)?;
    let transforms = placement(parser, entity.span)?;
    let state = &parser.scope.state;
    let shape = ShapeDescription {
        entity,
        transforms,
        orientation: state.orientation,
        material: state.material,
        area_light: state.area_light.clone(),
        medium: state.medium.clone(),
    };
    match parser.object {
        Some(object) => parser.scene.objects[object].shapes.push(shape),
        None => parser.scene.shapes.push(shape),
    }
    Ok(())
}

pub(super) fn make_named_medium(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let (name, span) = tokens.expect_quoted("the name of a medium")?;
    let name = known::normalized(&name);
    let explicit = parser.parameters(tokens)?;
    let defaults = Arc::clone(&parser.scope.state.defaults.medium);
    let entity = typed_entity(explicit, defaults, span, &known::MEDIA)?;
    if !parser.medium_names.insert(name.clone()) {
        return Err(defined_again(span, "medium", &name));
    }
    let transforms = placement(parser, span)?;
    parser.scene.media.push(MediumDescription {
        name,
        entity,
        transforms,
    });
    Ok(())
}

pub(super) fn medium_interface(parser: &mut Parser, tokens: &mut Tokens<'_>) -> Done {
    let reference = |(name, span): (std::borrow::Cow<'_, str>, Span)| {
        (!name.is_empty()).then(|| MediumReference {
            name: known::normalized(&name).into(),
            span,
        })
    };
    let inside = reference(tokens.expect_quoted("the name of a medium")?);
    let outside = tokens
        .next_if_quoted()?
        .map_or_else(|| inside.clone(), reference);
    parser.scope.state.medium = MediumInterface { inside, outside };
    Ok(())
}
