//! The classes of textures: reads their parameters, and builds them.

use super::color::Purpose;
use super::context::Context;
use super::imagemap::ImageSettings;
use super::mapping;
use super::reader::Reader;
use super::texture::{Element, Operand, Textures};
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::{TextureDescription, TextureKind};
use crate::source::Fault;
use bidir::math::Vec3;
use bidir::texture::{
    Bilerp, Cells, Checkerboard, DirectionMix, Dots, Marble, Mix, Noise, NoiseKind, Scale, Texture,
};
use std::sync::Arc;

/// The parameters of a texture, before its images are read and its parts are built.
pub(super) enum Source<T: Element> {
    /// A texture without parts.
    Whole(Texture<T>),
    Image(ImageSettings),
    Scale(Operand<T>, Operand<f32>),
    Mix([Operand<T>; 2], Operand<f32>),
    DirectionMix([Operand<T>; 2], Vec3),
    Checkerboard([Operand<T>; 2], Cells),
    Dots([Operand<T>; 2], bidir::texture::Mapping),
}

/// Maximum number of octaves of noise; further ones are not visible.
const MOST_OCTAVES: u32 = 64;

impl<T: Element> Source<T> {
    /// Reads the parameters of texture number `number`.
    pub(super) fn read(
        textures: &Textures<'_>,
        context: &mut Context<'_>,
        number: usize,
        purpose: Purpose,
    ) -> Result<Self, Fault> {
        let texture = &textures.described[number];
        let mut class = Class {
            textures,
            number,
            texture,
            reader: Reader::new(context, &texture.entity),
            purpose,
        };
        let source = class.source()?;
        match source {
            Some(source) => {
                class.reader.finish()?;
                Ok(source)
            }
            // The parameters of an unsupported class are not checked.
            None => Ok(Self::Whole(Texture::Constant(T::splat(0.5)))),
        }
    }

    /// Builds the texture, its parts first.
    pub(super) fn build(
        self,
        textures: &mut Textures<'_>,
        context: &mut Context<'_>,
        purpose: Purpose,
    ) -> Result<Texture<T>, Fault> {
        Ok(match self {
            Self::Whole(texture) => texture,
            Self::Image(settings) => textures.image(context, &settings)?,
            Self::DirectionMix(parts, direction) => Texture::DirectionMix(Arc::new(DirectionMix {
                textures: pair(textures, context, parts, purpose)?,
                direction,
            })),
            Self::Checkerboard(parts, cells) => Texture::Checkerboard(Arc::new(Checkerboard {
                textures: pair(textures, context, parts, purpose)?,
                cells,
            })),
            Self::Dots(parts, mapping) => Texture::Dots(Arc::new(Dots {
                textures: pair(textures, context, parts, purpose)?,
                mapping,
            })),
            Self::Mix(parts, amount) => Texture::Mix(Arc::new(Mix {
                textures: pair(textures, context, parts, purpose)?,
                amount: textures.resolve(context, amount, Purpose::Unbounded)?,
            })),
            Self::Scale(part, factor) => Texture::Scale(Arc::new(Scale {
                texture: textures.resolve(context, part, purpose)?,
                factor: textures.resolve(context, factor, Purpose::Unbounded)?,
            })),
        })
    }
}

fn pair<T: Element>(
    textures: &mut Textures<'_>,
    context: &mut Context<'_>,
    [first, second]: [Operand<T>; 2],
    purpose: Purpose,
) -> Result<[Texture<T>; 2], Fault> {
    let first = textures.resolve(context, first, purpose)?;
    Ok([first, textures.resolve(context, second, purpose)?])
}

/// A texture whose parameters are being read.
struct Class<'t, 'a, 'c> {
    textures: &'t Textures<'a>,
    number: usize,
    texture: &'a TextureDescription,
    reader: Reader<'t, 'c>,
    purpose: Purpose,
}

impl Class<'_, '_, '_> {
    /// Reads the parameters of the class. None: the class is not supported and replaced.
    fn source<T: Element>(&mut self) -> Result<Option<Source<T>>, Fault> {
        let class = self.texture.entity.kind.as_str();
        Ok(Some(match class {
            "constant" => Source::Whole(Texture::Constant(self.value("value", 1.0)?)),
            "imagemap" => Source::Image(ImageSettings::read(self.texture, &mut self.reader)?),
            "scale" => Source::Scale(self.part("tex", 1.0)?, self.part("scale", 1.0)?),
            "mix" => Source::Mix(self.two()?, self.part("amount", 0.5)?),
            "directionmix" => {
                let reader = &mut self.reader;
                let direction = mapping::direction(self.texture, reader, "dir", Vec3::Y)?;
                Source::DirectionMix(self.two()?, direction)
            }
            "bilerp" => Source::Whole(self.bilerp()?),
            "checkerboard" => {
                let parts = [self.part("tex1", 1.0)?, self.part("tex2", 0.0)?];
                Source::Checkerboard(parts, self.cells()?)
            }
            "dots" => {
                let parts = [self.part("outside", 0.0)?, self.part("inside", 1.0)?];
                let mapping = mapping::read(self.texture, &mut self.reader)?;
                Source::Dots(parts, mapping)
            }
            "fbm" | "wrinkled" | "windy" => Source::Whole(self.noise::<T>(class)?),
            "marble" => Source::Whole(self.marble::<T>()?),
            class => {
                let what = format!("the texture class `{class}`");
                let span = self.texture.entity.span;
                (self.reader.context).unsupported(span, &what, "0.5 is used instead")?;
                return Ok(None);
            }
        }))
    }

    fn value<T: Element>(&mut self, name: &'static str, default: f32) -> Result<T, Fault> {
        let value = T::read(&mut self.reader, name, self.purpose)?;
        Ok(value.unwrap_or(T::splat(default)))
    }

    fn part<T: Element>(&mut self, name: &'static str, default: f32) -> Result<Operand<T>, Fault> {
        let operand = self
            .textures
            .operand(&mut self.reader, name, self.purpose)?;
        if let Some(Operand::<T>::Texture(part)) = operand {
            let parameters = &self.texture.entity.parameters;
            let parameter = parameters.get(ParameterType::Texture, name);
            let span = parameter.map_or(self.texture.entity.span, |named| named.value_span);
            self.textures.check_order(part, self.number, span)?;
        }
        Ok(operand.unwrap_or(Operand::Value(T::splat(default))))
    }

    fn two<T: Element>(&mut self) -> Result<[Operand<T>; 2], Fault> {
        Ok([self.part("tex1", 0.0)?, self.part("tex2", 1.0)?])
    }

    fn bilerp<T: Element>(&mut self) -> Result<Texture<T>, Fault> {
        // The first digit is u.
        let corners = [
            self.value("v00", 0.0)?,
            self.value("v10", 0.0)?,
            self.value("v01", 1.0)?,
            self.value("v11", 1.0)?,
        ];
        let mapping = mapping::read(self.texture, &mut self.reader)?;
        Ok(Texture::Bilerp(Arc::new(Bilerp { corners, mapping })))
    }

    fn cells(&mut self) -> Result<Cells, Fault> {
        match self.reader.integer("dimension", 2, 0)? {
            2 => mapping::read(self.texture, &mut self.reader).map(Cells::Plane),
            3 => mapping::space(self.reader.context, self.texture).map(Cells::Space),
            dimension => {
                let message = format!("a checkerboard has 2 or 3 dimensions, not {dimension}");
                Err(self.reader.fault(message))
            }
        }
    }

    /// Refuses a class whose values are only of another kind.
    fn expect(&self, kind: TextureKind) -> Result<(), Fault> {
        if self.texture.kind == kind {
            return Ok(());
        }
        let (class, word) = (&self.texture.entity.kind, kind.word());
        let message = format!("a texture of class `{class}` is of type `{word}`");
        Err(self.reader.fault(message))
    }

    fn noise<T: Element>(&mut self, class: &str) -> Result<Texture<T>, Fault> {
        self.expect(TextureKind::Float)?;
        let kind = match class {
            "windy" => NoiseKind::Windy,
            class => {
                let (octaves, roughness) = self.octaves()?;
                match class {
                    "fbm" => NoiseKind::Fbm { octaves, roughness },
                    _ => NoiseKind::Wrinkled { octaves, roughness },
                }
            }
        };
        let space = mapping::space(self.reader.context, self.texture)?;
        Ok(Texture::Noise(Arc::new(Noise { kind, space })))
    }

    fn marble<T: Element>(&mut self) -> Result<Texture<T>, Fault> {
        self.expect(TextureKind::Spectrum)?;
        let (octaves, roughness) = self.octaves()?;
        Ok(Texture::Marble(Arc::new(Marble {
            octaves,
            roughness,
            scale: self.reader.float("scale", 1.0)?,
            variation: self.reader.float("variation", 0.2)?,
            space: mapping::space(self.reader.context, self.texture)?,
        })))
    }

    fn octaves(&mut self) -> Result<(u32, f32), Fault> {
        let octaves = self.reader.integer("octaves", 8, 0)?;
        if octaves > MOST_OCTAVES {
            let message = format!("only the first {MOST_OCTAVES} octaves of the noise are used");
            self.reader.context.warn(self.reader.span(), message);
        }
        let roughness = self.reader.float("roughness", 0.5)?;
        Ok((octaves.min(MOST_OCTAVES), roughness))
    }
}
