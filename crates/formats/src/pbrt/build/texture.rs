//! Textures: built when a material asks for them, as what it needs them for.

use super::color::{self, Purpose};
use super::context::Context;
use super::imagemap::{Files, ImageSettings};
use super::reader::Reader;
use crate::pbrt::known;
use crate::pbrt::lexer::shorten;
use crate::pbrt::scene::{SceneDescription, TextureDescription, TextureKind};
use crate::source::{Fault, Span};
use bidir::spectrum::Rgb;
use bidir::texture::{ColorTexture, FloatTexture};
use std::collections::{BTreeMap, BTreeSet};

/// What makes a texture different from all others.
type Key<'a> = (TextureKind, &'a str);

/// The textures of a scene.
pub(super) struct Textures<'a> {
    described: BTreeMap<Key<'a>, &'a TextureDescription>,
    asked: BTreeSet<Key<'a>>,
    /// Those that are built already, by name; colours are checked for each purpose.
    colors: BTreeMap<(&'a str, Purpose), ColorTexture>,
    floats: BTreeMap<&'a str, FloatTexture>,
    files: Files,
}

impl<'a> Textures<'a> {
    /// The textures of a description, none of which is built.
    pub(super) fn new(description: &'a SceneDescription) -> Self {
        let textures = description.textures.iter();
        Self {
            described: textures.map(|texture| (key(texture), texture)).collect(),
            asked: BTreeSet::new(),
            colors: BTreeMap::new(),
            floats: BTreeMap::new(),
            files: Files::default(),
        }
    }

    /// Reads a colour or the name of a texture. None: where the file gives none.
    pub(super) fn color(
        &mut self,
        context: &mut Context<'_>,
        reader: &mut Reader<'_>,
        name: &'static str,
        purpose: Purpose,
    ) -> Result<Option<ColorTexture>, Fault> {
        let Some((name, span)) = reader.texture(name)? else {
            let color = color::read(context, reader, name, purpose)?;
            return Ok(color.map(ColorTexture::Constant));
        };
        let texture = self.find(TextureKind::Spectrum, name, span)?;
        let key = (texture.name.as_str(), purpose);
        if let Some(built) = self.colors.get(&key) {
            return Ok(Some(built.clone()));
        }
        let built = match read_color(context, texture, purpose)? {
            Source::Constant(color) => ColorTexture::Constant(color),
            Source::Image(settings) => {
                ColorTexture::Image(settings.map(self.files.color(context, &settings)?))
            }
        };
        self.colors.insert(key, built.clone());
        Ok(Some(built))
    }

    /// Reads a number or the name of a texture. None: where the file gives none.
    pub(super) fn float(
        &mut self,
        context: &mut Context<'_>,
        reader: &mut Reader<'_>,
        name: &'static str,
    ) -> Result<Option<FloatTexture>, Fault> {
        let Some((name, span)) = reader.texture(name)? else {
            return Ok(reader.optional_float(name)?.map(FloatTexture::Constant));
        };
        let texture = self.find(TextureKind::Float, name, span)?;
        let key = texture.name.as_str();
        if let Some(built) = self.floats.get(key) {
            return Ok(Some(built.clone()));
        }
        let built = match read_float(context, texture)? {
            Source::Constant(number) => FloatTexture::Constant(number),
            Source::Image(settings) => {
                FloatTexture::Image(settings.map(self.files.float(context, &settings)?))
            }
        };
        self.floats.insert(key, built.clone());
        Ok(Some(built))
    }

    fn find(
        &mut self,
        kind: TextureKind,
        name: &str,
        span: Span,
    ) -> Result<&'a TextureDescription, Fault> {
        let normalized = known::normalized(name);
        if let Some(&texture) = self.described.get(&(kind, &*normalized)) {
            self.asked.insert(key(texture));
            return Ok(texture);
        }
        let word = match kind {
            TextureKind::Float => "float",
            TextureKind::Spectrum => "spectrum",
        };
        let fault = Fault::scene(span, format!("unknown {word} texture `{}`", shorten(name)));
        let of_kind = self.described.keys().filter(|(known, _)| *known == kind);
        Err(fault.with_nearest(name, of_kind.map(|&(_, name)| name)))
    }

    /// Looks through the parameters of the textures that no material asked for. No image is read.
    pub(super) fn check_unused(&self, context: &mut Context<'_>) -> Result<(), Fault> {
        for texture in &context.description.textures {
            if self.asked.contains(&key(texture)) {
                continue;
            }
            context.unused(|context| match texture.kind {
                TextureKind::Float => read_float(context, texture).map(drop),
                TextureKind::Spectrum => read_color(context, texture, Purpose::Unbounded).map(drop),
            })?;
        }
        Ok(())
    }
}

fn key(texture: &TextureDescription) -> Key<'_> {
    (texture.kind, &texture.name)
}

/// What a texture's parameters say: a value, or where an image is and how it is looked up.
enum Source<T> {
    Constant(T),
    Image(ImageSettings),
}

fn read_color(
    context: &mut Context<'_>,
    texture: &TextureDescription,
    purpose: Purpose,
) -> Result<Source<Rgb>, Fault> {
    read(context, texture, [0.5; 3], |context, reader| {
        let value = color::read(context, reader, "value", purpose)?;
        Ok(value.unwrap_or([1.0; 3]))
    })
}

fn read_float(
    context: &mut Context<'_>,
    texture: &TextureDescription,
) -> Result<Source<f32>, Fault> {
    read(context, texture, 0.5, |_, reader| {
        reader.float("value", 1.0)
    })
}

/// Reads a texture's parameters, those of a constant by `read_constant`; `grey` is what stands in.
fn read<T>(
    context: &mut Context<'_>,
    texture: &TextureDescription,
    grey: T,
    read_constant: impl FnOnce(&mut Context<'_>, &mut Reader<'_>) -> Result<T, Fault>,
) -> Result<Source<T>, Fault> {
    let mut reader = Reader::new(&texture.entity);
    let source = match texture.entity.kind.as_str() {
        "constant" => Source::Constant(read_constant(context, &mut reader)?),
        "imagemap" => Source::Image(ImageSettings::read(context, &mut reader)?),
        class => {
            let what = format!("the texture class `{class}`");
            context.unsupported(texture.entity.span, &what, "0.5 stands in")?;
            return Ok(Source::Constant(grey));
        }
    };
    reader.finish()?;
    Ok(source)
}
