//! Textures.

use super::color::{self, Purpose};
use super::context::Context;
use super::imagemap::{Files, ImageSettings};
use super::reader::Reader;
use crate::pbrt::known;
use crate::pbrt::lexer::shorten;
use crate::pbrt::scene::{TextureDescription, TextureKind};
use crate::source::{Fault, Span};
use bidir::texture::{ColorTexture, FloatTexture};
use std::collections::BTreeMap;

/// The textures of a scene by name.
#[derive(Default)]
pub(super) struct Textures {
    colors: BTreeMap<String, ColorTexture>,
    floats: BTreeMap<String, FloatTexture>,
}

impl Textures {
    /// Builds all textures of the scene.
    pub(super) fn build(context: &mut Context<'_>) -> Result<Self, Fault> {
        let mut textures = Self::default();
        let mut files = Files::default();
        for texture in &context.description.textures {
            match texture.kind {
                TextureKind::Spectrum => {
                    let built = build_color(context, texture, &mut files)?;
                    textures.colors.insert(texture.name.clone(), built);
                }
                TextureKind::Float => {
                    let built = build_float(context, texture, &mut files)?;
                    textures.floats.insert(texture.name.clone(), built);
                }
            }
        }
        Ok(textures)
    }

    /// Reads a colour or the name of a texture. None: where the file gives none.
    pub(super) fn color(
        &self,
        context: &mut Context<'_>,
        reader: &mut Reader<'_>,
        name: &'static str,
        purpose: Purpose,
    ) -> Result<Option<ColorTexture>, Fault> {
        if let Some((texture, span)) = reader.texture(name)? {
            return find(&self.colors, texture, span, "spectrum").map(Some);
        }
        let color = color::read(context, reader, name, purpose)?;
        Ok(color.map(ColorTexture::Constant))
    }

    /// Reads a number or the name of a texture. None: where the file gives none.
    pub(super) fn float(
        &self,
        reader: &mut Reader<'_>,
        name: &'static str,
    ) -> Result<Option<FloatTexture>, Fault> {
        if let Some((texture, span)) = reader.texture(name)? {
            return find(&self.floats, texture, span, "float").map(Some);
        }
        Ok(reader.optional_float(name)?.map(FloatTexture::Constant))
    }
}

fn find<T: Clone>(
    textures: &BTreeMap<String, T>,
    name: &str,
    span: Span,
    kind: &str,
) -> Result<T, Fault> {
    textures
        .get(&known::normalized(name))
        .cloned()
        .ok_or_else(|| {
            let fault = Fault::scene(span, format!("unknown {kind} texture `{}`", shorten(name)));
            fault.with_nearest(name, textures.keys().map(String::as_str))
        })
}

fn build_color(
    context: &mut Context<'_>,
    texture: &TextureDescription,
    files: &mut Files,
) -> Result<ColorTexture, Fault> {
    let mut reader = Reader::new(&texture.entity);
    match texture.entity.kind.as_str() {
        "constant" => {
            let value = color::read(context, &mut reader, "value", Purpose::Albedo)?;
            reader.finish()?;
            Ok(ColorTexture::Constant(value.unwrap_or([1.0; 3])))
        }
        "imagemap" => {
            let settings = ImageSettings::read(context, &mut reader)?;
            reader.finish()?;
            let image = files.color(context, &settings)?;
            Ok(ColorTexture::Image(settings.map(image)))
        }
        class => {
            let what = format!("the texture class `{class}`");
            context.unsupported(texture.entity.span, &what, "grey of 0.5 stands in")?;
            Ok(ColorTexture::Constant([0.5; 3]))
        }
    }
}

fn build_float(
    context: &mut Context<'_>,
    texture: &TextureDescription,
    files: &mut Files,
) -> Result<FloatTexture, Fault> {
    let mut reader = Reader::new(&texture.entity);
    match texture.entity.kind.as_str() {
        "constant" => {
            let value = reader.float("value", 1.0)?;
            reader.finish()?;
            Ok(FloatTexture::Constant(value))
        }
        "imagemap" => {
            let settings = ImageSettings::read(context, &mut reader)?;
            reader.finish()?;
            let image = files.float(context, &settings)?;
            Ok(FloatTexture::Image(settings.map(image)))
        }
        class => {
            let what = format!("the texture class `{class}`");
            context.unsupported(texture.entity.span, &what, "0.5 stands in")?;
            Ok(FloatTexture::Constant(0.5))
        }
    }
}
