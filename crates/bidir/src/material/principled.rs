//! The principled material: factors and textures as glTF 2.0 has them, each value the product of both.

use super::unit;
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{Bsdf, Principled, PrincipledCoat, PrincipledParameters, Wall};
use crate::math::{Vec2, sin_cos, sqr};
use crate::spectrum::{ColorModel, Rgb, Wavelengths};
use crate::texture::{ColorTexture, FloatTexture};

/// A colour times a texture.
#[derive(Clone, Debug)]
pub struct ScaledColor {
    /// The colour.
    pub factor: Rgb,
    /// The texture. None: 1 everywhere.
    pub texture: Option<ColorTexture>,
}

impl ScaledColor {
    /// The same everywhere.
    pub const fn constant(factor: Rgb) -> Self {
        Self {
            factor,
            texture: None,
        }
    }

    /// The product at `uv`.
    #[inline]
    pub fn eval(&self, uv: Vec2) -> Rgb {
        match &self.texture {
            None => self.factor,
            Some(texture) => {
                let texel = texture.eval(uv);
                std::array::from_fn(|i| self.factor[i] * texel[i])
            }
        }
    }
}

/// A number times a texture.
#[derive(Clone, Debug)]
pub struct ScaledFloat {
    /// The number.
    pub factor: f32,
    /// The texture. None: 1 everywhere.
    pub texture: Option<FloatTexture>,
}

impl ScaledFloat {
    /// The same everywhere.
    pub const fn constant(factor: f32) -> Self {
        Self {
            factor,
            texture: None,
        }
    }

    /// The product at `uv`.
    #[inline]
    pub fn eval(&self, uv: Vec2) -> f32 {
        let texel = self
            .texture
            .as_ref()
            .map_or(1.0, |texture| texture.eval(uv));
        self.factor * texel
    }

    #[inline]
    fn share(&self, uv: Vec2) -> f32 {
        self.eval(uv).clamp(0.0, 1.0)
    }
}

/// How much longer facets' highlights are in one direction.
#[derive(Clone, Debug)]
pub struct Anisotropy {
    /// 0: not at all. Range: `[0, 1]`.
    pub strength: f32,
    /// The angle from the tangent to the direction that highlights stretch in. Unit: radians.
    pub rotation: f32,
    /// The direction in the first two channels, 0.5 standing for 0, and what strength is scaled by in
    /// the third. None: (1, 0) and 1.
    pub texture: Option<ColorTexture>,
}

impl Anisotropy {
    /// Strength, and the direction as cosine and sine.
    #[inline]
    fn eval(&self, uv: Vec2) -> (f32, Vec2) {
        let (sin, cos) = sin_cos(self.rotation);
        let Some(texture) = &self.texture else {
            return (self.strength, Vec2::new(cos, sin));
        };
        let [x, y, scale] = texture.eval(uv);
        let direction = Vec2::new(2.0 * x - 1.0, 2.0 * y - 1.0).normalize_or(Vec2::X);
        let turned = Vec2::new(
            direction.x * cos - direction.y * sin,
            direction.x * sin + direction.y * cos,
        );
        (self.strength * scale.clamp(0.0, 1.0), turned)
    }
}

/// Metal, plastic, glass and cloth by the parameters of glTF.
#[derive(Clone, Debug)]
pub struct PrincipledMaterial {
    /// The base colour.
    pub color: ScaledColor,
    /// The share of metal.
    pub metallic: ScaledFloat,
    /// Perceived roughness, the square root of slopes.
    pub roughness: ScaledFloat,
    /// Brushed metal and the like.
    pub anisotropy: Anisotropy,
    /// The index of refraction of what is no metal; 0: it reflects all light.
    pub ior: f32,
    /// What its reflectance is scaled by.
    pub specular: ScaledFloat,
    /// What its reflectance along the normal is scaled by, beside.
    pub specular_color: ScaledColor,
    /// The share of it that is transparent.
    pub transmission: ScaledFloat,
    /// What lies behind the transparent part.
    pub wall: Wall,
    /// The share of the rest that lets light through diffusely.
    pub diffuse_transmission: ScaledFloat,
    /// The colour of that.
    pub diffuse_transmission_color: ScaledColor,
    /// How much of the surface a clear coat covers.
    pub coat: ScaledFloat,
    /// The perceived roughness of the coat.
    pub coat_roughness: ScaledFloat,
    /// The colour of the sheen.
    pub sheen: ScaledColor,
    /// The perceived roughness of the sheen.
    pub sheen_roughness: ScaledFloat,
}

impl Default for PrincipledMaterial {
    /// What a glTF material is that says nothing: white rough metal.
    fn default() -> Self {
        let [black, white] = [0.0, 1.0].map(|value| ScaledColor::constant([value; 3]));
        let [zero, one] = [0.0, 1.0].map(ScaledFloat::constant);
        Self {
            color: white.clone(),
            metallic: one.clone(),
            roughness: one.clone(),
            anisotropy: Anisotropy {
                strength: 0.0,
                rotation: 0.0,
                texture: None,
            },
            ior: 1.5,
            specular: one,
            specular_color: white.clone(),
            transmission: zero.clone(),
            wall: Wall::Thin,
            diffuse_transmission: zero.clone(),
            diffuse_transmission_color: white,
            coat: zero.clone(),
            coat_roughness: zero.clone(),
            sheen: black,
            sheen_roughness: zero,
        }
    }
}

impl PrincipledMaterial {
    /// Slopes along the grain and across, and where the grain points.
    #[inline]
    fn facets(&self, uv: Vec2) -> (Ggx, Vec2) {
        let across = sqr(self.roughness.share(uv));
        let (strength, grain) = self.anisotropy.eval(uv);
        let along = across + (1.0 - across) * sqr(strength);
        (Ggx::new(along, across), grain)
    }

    pub(super) fn bsdf(&self, uv: Vec2, color: ColorModel, wavelengths: &Wavelengths) -> Bsdf {
        let albedo = |of: &ScaledColor| color.albedo(unit(of.eval(uv)), wavelengths);
        let (ggx, grain) = self.facets(uv);
        Bsdf::Principled(Principled::new(&PrincipledParameters {
            color: albedo(&self.color),
            metallic: self.metallic.share(uv),
            ggx,
            grain,
            ior: self.ior,
            specular: self.specular.share(uv),
            specular_color: color.unbounded(self.specular_color.eval(uv), wavelengths),
            transmission: self.transmission.share(uv),
            wall: self.wall,
            diffuse_transmission: self.diffuse_transmission.share(uv),
            diffuse_transmission_color: albedo(&self.diffuse_transmission_color),
            coat: PrincipledCoat {
                cover: self.coat.share(uv),
                alpha: sqr(self.coat_roughness.share(uv)),
            },
            sheen: albedo(&self.sheen),
            sheen_alpha: sqr(self.sheen_roughness.share(uv)),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn highlights_stretch_along_the_direction_of_the_grain() {
        let quarter = std::f32::consts::FRAC_PI_2;
        let texture = ColorTexture::Constant([0.5, 1.0, 0.5]);
        let anisotropy = |texture| Anisotropy {
            strength: 0.8,
            rotation: quarter,
            texture,
        };
        let check = |anisotropy: Anisotropy, strength: f32, direction: Vec2| {
            let (found, grain) = anisotropy.eval(Vec2::ZERO);
            assert!((found - strength).abs() < 1e-6 && grain.distance(direction) < 1e-6);
        };
        check(anisotropy(None), 0.8, Vec2::Y);
        check(anisotropy(Some(texture)), 0.4, -Vec2::X);
    }

    #[test]
    fn values_are_the_product_of_factor_and_texture() {
        let color = ScaledColor {
            factor: [0.5, 1.0, 2.0],
            texture: Some(ColorTexture::Constant([0.5, 0.25, 0.5])),
        };
        let found = color.eval(Vec2::ZERO).map(f32::to_bits);
        assert_eq!(found, [0.25f32, 0.25, 1.0].map(f32::to_bits));
        let number = ScaledFloat {
            factor: 3.0,
            texture: Some(FloatTexture::Constant(0.5)),
        };
        assert_eq!(number.share(Vec2::ZERO).to_bits(), 1.0f32.to_bits());
    }
}
