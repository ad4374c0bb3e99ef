//! The classes of textures: reads their parameters, and builds them.

use super::color::Purpose;
use super::context::Context;
use super::imagemap::ImageSettings;
use super::mapping;
use super::reader::Reader;
use super::texture::{Element, Textures};
use crate::pbrt::scene::{TextureDescription, TextureKind};
use crate::source::Fault;
use bidir::math::Vec3;
use bidir::texture::{
    Bilerp, Cells, Checkerboard, DirectionMix, Dots, Marble, Mix, Noise, NoiseKind, Scale, Texture,
};
use std::sync::Arc;

/// Maximum number of octaves of noise; further ones are not visible.
const MOST_OCTAVES: u32 = 64;

/// Reads the parameters of texture number `number`, and builds it, its parts first.
pub(super) fn build<T: Element>(
    textures: &mut Textures<'_>,
    context: &mut Context<'_>,
    number: usize,
    purpose: Purpose,
) -> Result<Texture<T>, Fault> {
    let texture = &textures.described[number];
    let mut class = Class {
        textures,
        number,
        texture,
        reader: Reader::new(context, &texture.entity),
        purpose,
    };
    let Some(built) = class.texture()? else {
        return Ok(Texture::Constant(T::splat(0.5)));
    };
    class.reader.finish()?;
    Ok(built)
}

/// A texture whose parameters are being read.
struct Class<'t, 'a, 'c> {
    textures: &'t mut Textures<'a>,
    number: usize,
    texture: &'a TextureDescription,
    reader: Reader<'t, 'c>,
    purpose: Purpose,
}

impl Class<'_, '_, '_> {
    /// Builds a texture of the class. None: the class is not supported and replaced.
    fn texture<T: Element>(&mut self) -> Result<Option<Texture<T>>, Fault> {
        let class = self.texture.entity.kind.as_str();
        Ok(Some(match class {
            "constant" => Texture::Constant(self.value("value", 1.0)?),
            "imagemap" => {
                let settings = ImageSettings::read(self.texture, &mut self.reader)?;
                self.textures.image(self.reader.context, &settings)?
            }
            "scale" => Texture::Scale(Arc::new(Scale {
                texture: self.part("tex", 1.0)?,
                factor: self.part("scale", 1.0)?,
            })),
            "mix" => Texture::Mix(Arc::new(Mix {
                textures: self.two()?,
                amount: self.part("amount", 0.5)?,
            })),
            "directionmix" => {
                let reader = &mut self.reader;
                let direction = mapping::direction(self.texture, reader, "dir", Vec3::Y)?;
                let textures = self.two()?;
                Texture::DirectionMix(Arc::new(DirectionMix {
                    textures,
                    direction,
                }))
            }
            "bilerp" => self.bilerp()?,
            "checkerboard" => Texture::Checkerboard(Arc::new(Checkerboard {
                textures: [self.part("tex1", 1.0)?, self.part("tex2", 0.0)?],
                cells: self.cells()?,
            })),
            "dots" => Texture::Dots(Arc::new(Dots {
                textures: [self.part("outside", 0.0)?, self.part("inside", 1.0)?],
                mapping: mapping::read(self.texture, &mut self.reader)?,
            })),
            "fbm" | "wrinkled" | "windy" => self.noise::<T>(class)?,
            "marble" => self.marble::<T>()?,
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

    /// Reads a value or the name of a texture, which stands before this one.
    fn part<T: Element>(&mut self, name: &'static str, default: f32) -> Result<Texture<T>, Fault> {
        let Some((texture, span)) = self.reader.texture(name)? else {
            return self.value(name, default).map(Texture::Constant);
        };
        let part = self.textures.find(T::KIND, texture, span)?;
        self.textures.check_order(part, self.number, span)?;
        self.textures
            .texture(self.reader.context, part, self.purpose)
    }

    fn two<T: Element>(&mut self) -> Result<[Texture<T>; 2], Fault> {
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
