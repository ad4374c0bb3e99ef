//! Builds textures for their first use, once for each [`Purpose`].
//!
//! The code is generic over [`Element`], a number or a colour. Unused textures are checked: that reads their
//! parameters, but no images.

use super::color::{self, Purpose};
use super::context::Context;
use super::imagemap::{self, ImageSettings, Key};
use super::reader::Reader;
use super::texture_class;
use crate::error::ErrorKind;
use crate::image::ImageData;
use crate::import::Images;
use crate::limits::{DEEPEST_TEXTURE, MOST_TEXTURES};
use crate::pbrt::known;
use crate::pbrt::lexer::shorten;
use crate::pbrt::scene::{SceneDescription, TextureDescription, TextureKind};
use crate::source::{Fault, Span};
use bidir::spectrum::Rgb;
use bidir::texture::{ColorTexture, FloatTexture, ImageMap, Texture, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The built textures by number and purpose. The purpose determines the valid values.
type Built<T> = BTreeMap<(usize, Purpose), Texture<T>>;

/// The textures of a scene.
pub(super) struct Textures<'a> {
    pub(super) described: &'a [TextureDescription],
    /// The number of each texture by kind and name.
    names: BTreeMap<(TextureKind, &'a str), usize>,
    used: BTreeSet<usize>,
    colors: Built<Rgb>,
    floats: Built<f32>,
    /// The depth of nested textures that are being built.
    depth: usize,
    /// True while unused textures are checked: then constants stand for images and parts.
    is_checking: bool,
    images: Images<Key, 3>,
    images_of_numbers: Images<Key, 1>,
}

/// A number or a colour.
pub(super) trait Element: Value + 'static {
    /// The kind of textures with such values.
    const KIND: TextureKind;

    /// Returns the same number in every channel.
    fn splat(value: f32) -> Self;

    /// Reads a constant. None: the file has none.
    fn read(
        reader: &mut Reader<'_, '_>,
        name: &'static str,
        purpose: Purpose,
    ) -> Result<Option<Self>, Fault>;

    /// Reads an image.
    fn image(
        textures: &mut Textures<'_>,
        context: &mut Context<'_>,
        settings: &ImageSettings,
    ) -> Result<Self::Map, Fault>;

    fn built<'t>(textures: &'t mut Textures<'_>) -> &'t mut Built<Self>;
}

impl Element for f32 {
    const KIND: TextureKind = TextureKind::Float;

    fn splat(value: f32) -> Self {
        value
    }

    fn read(
        reader: &mut Reader<'_, '_>,
        name: &'static str,
        _: Purpose,
    ) -> Result<Option<Self>, Fault> {
        reader.optional_float(name)
    }

    fn image(
        textures: &mut Textures<'_>,
        context: &mut Context<'_>,
        settings: &ImageSettings,
    ) -> Result<ImageMap<1>, Fault> {
        settings.map(context, &mut textures.images_of_numbers, imagemap::numbers)
    }

    fn built<'t>(textures: &'t mut Textures<'_>) -> &'t mut Built<Self> {
        &mut textures.floats
    }
}

impl Element for Rgb {
    const KIND: TextureKind = TextureKind::Spectrum;

    fn splat(value: f32) -> Self {
        [value; 3]
    }

    fn read(
        reader: &mut Reader<'_, '_>,
        name: &'static str,
        purpose: Purpose,
    ) -> Result<Option<Self>, Fault> {
        color::read(reader, name, purpose)
    }

    fn image(
        textures: &mut Textures<'_>,
        context: &mut Context<'_>,
        settings: &ImageSettings,
    ) -> Result<ImageMap<3>, Fault> {
        let texels = |data: &ImageData| data.rgb().collect();
        settings.map(context, &mut textures.images, texels)
    }

    fn built<'t>(textures: &'t mut Textures<'_>) -> &'t mut Built<Self> {
        &mut textures.colors
    }
}

impl<'a> Textures<'a> {
    /// Returns the textures of a description, none of which is built yet.
    pub(super) fn new(description: &'a SceneDescription) -> Self {
        let numbered = description.textures.iter().enumerate();
        let names = numbered.map(|(i, texture)| ((texture.kind, texture.name.as_str()), i));
        Self {
            described: &description.textures,
            names: names.collect(),
            used: BTreeSet::new(),
            colors: BTreeMap::new(),
            floats: BTreeMap::new(),
            depth: 0,
            is_checking: false,
            images: Images::default(),
            images_of_numbers: Images::default(),
        }
    }

    /// Reads a number or the name of a texture. None: the file has none.
    pub(super) fn float(
        &mut self,
        reader: &mut Reader<'_, '_>,
        name: &'static str,
    ) -> Result<Option<FloatTexture>, Fault> {
        self.get(reader, name, Purpose::Unbounded)
    }

    /// Reads a normal map as colours between 0 and 1. None: the file has none.
    pub(super) fn normals(
        &mut self,
        reader: &mut Reader<'_, '_>,
        name: &'static str,
    ) -> Result<Option<ColorTexture>, Fault> {
        let Some((file, span)) = reader.string(name)? else {
            return Ok(None);
        };
        let settings = ImageSettings::of_normals(reader.context, file, span);
        self.image(reader.context, &settings).map(Some)
    }

    /// Reads a value for a purpose, or the name of a texture. None: the file has none.
    pub(super) fn get<T: Element>(
        &mut self,
        reader: &mut Reader<'_, '_>,
        name: &'static str,
        purpose: Purpose,
    ) -> Result<Option<Texture<T>>, Fault> {
        let Some((texture, span)) = reader.texture(name)? else {
            return Ok(T::read(reader, name, purpose)?.map(Texture::Constant));
        };
        let number = self.find(T::KIND, texture, span)?;
        self.texture(reader.context, number, purpose).map(Some)
    }

    /// Returns the number of the texture of this name; `span` is its place.
    pub(super) fn find(&self, kind: TextureKind, name: &str, span: Span) -> Result<usize, Fault> {
        let normalized = known::normalized(name);
        if let Some(&number) = self.names.get(&(kind, &*normalized)) {
            return Ok(number);
        }
        let of_kind = self.names.keys().filter(|(known, _)| *known == kind);
        let names = of_kind.map(|&(_, name)| name);
        let what = format!("{} texture", kind.word());
        Err(known::unknown(span, &what, name, names))
    }

    /// Refuses a part that is built after texture number `user`. The order is: images, then textures of numbers,
    /// then of colours, each in the order of the file.
    pub(super) fn check_order(&self, part: usize, user: usize, span: Span) -> Result<(), Fault> {
        let (part_of, user_of) = (&self.described[part], &self.described[user]);
        let is_image = matches!(part_of.entity.kind.as_str(), "imagemap" | "ptex");
        if is_image || part_of.kind != user_of.kind || part < user {
            return Ok(());
        }
        let name = shorten(&part_of.name);
        let message = format!("the texture `{name}` is used before it is defined");
        let hint = "only an `imagemap` may stand below the textures that use it";
        Err(Fault::scene(span, message).with_hint(hint))
    }

    /// Returns texture number `number`, and builds it for its first use. All numbers have one purpose.
    pub(super) fn texture<T: Element>(
        &mut self,
        context: &mut Context<'_>,
        number: usize,
        purpose: Purpose,
    ) -> Result<Texture<T>, Fault> {
        if self.is_checking {
            return Ok(Texture::Constant(T::splat(0.0)));
        }
        let key = match T::KIND {
            TextureKind::Float => (number, Purpose::Unbounded),
            TextureKind::Spectrum => (number, purpose),
        };
        if let Some(known) = T::built(self).get(&key) {
            return Ok(known.clone());
        }
        self.used.insert(number);
        self.depth += 1;
        let result = self.build::<T>(context, number, key.1);
        self.depth -= 1;
        let built = result?;
        T::built(self).insert(key, built.clone());
        Ok(built)
    }

    fn build<T: Element>(
        &mut self,
        context: &mut Context<'_>,
        number: usize,
        purpose: Purpose,
    ) -> Result<Texture<T>, Fault> {
        let span = self.described[number].entity.span;
        let too = |message| Err(Fault::new(ErrorKind::Limit, span, message));
        if self.depth > DEEPEST_TEXTURE {
            return too(format!("textures are nested deeper than {DEEPEST_TEXTURE}"));
        }
        let built = texture_class::build(self, context, number, purpose)?;
        if built.size() > MOST_TEXTURES {
            return too(format!("the texture is made of more than {MOST_TEXTURES}"));
        }
        Ok(built)
    }

    pub(super) fn image<T: Element>(
        &mut self,
        context: &mut Context<'_>,
        settings: &ImageSettings,
    ) -> Result<Texture<T>, Fault> {
        if self.is_checking {
            return Ok(Texture::Constant(T::splat(0.0)));
        }
        let map = T::image(self, context, settings)?;
        Ok(Texture::Image(Arc::new(map)))
    }

    /// Checks the parameters of unused textures. Reads no images.
    pub(super) fn check_unused(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        self.is_checking = true;
        for (number, texture) in self.described.iter().enumerate() {
            if self.used.contains(&number) {
                continue;
            }
            let any = Purpose::Unbounded;
            context.unused(|context| match texture.kind {
                TextureKind::Float => self.build::<f32>(context, number, any).map(drop),
                TextureKind::Spectrum => self.build::<Rgb>(context, number, any).map(drop),
            })?;
        }
        Ok(())
    }
}
