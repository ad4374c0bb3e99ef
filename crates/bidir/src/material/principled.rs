//! The principled material, with the factors and textures of glTF 2.0: each value is the product of both.

use super::{NormalMap, unit};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{Bsdf, Principled, PrincipledCoat, PrincipledParameters, Thickness};
use crate::math::{Vec2, Vec3, sqr};
use crate::shape::SurfacePoint;
use crate::spectrum::{Lanes, Rgb};
use crate::texture::{ColorTexture, FloatTexture, RequiredInputs, TexturePoint};

/// A colour times a texture.
#[derive(Clone, Debug)]
pub struct ScaledColor {
    /// The colour.
    pub factor: Rgb,
    /// The texture. None: 1 everywhere.
    pub texture: Option<ColorTexture>,
}

impl ScaledColor {
    /// Makes a constant colour.
    pub const fn constant(factor: Rgb) -> Self {
        Self {
            factor,
            texture: None,
        }
    }

    /// Returns true where the product is black everywhere.
    #[inline]
    fn is_black(&self) -> bool {
        self.factor.iter().all(|&channel| channel <= 0.0)
    }

    /// Returns true where it is 1 everywhere.
    #[inline]
    fn is_white(&self) -> bool {
        let is_one = |channel: &f32| channel.to_bits() == 1f32.to_bits();
        self.texture.is_none() && self.factor.iter().all(is_one)
    }

    fn needs(&self) -> RequiredInputs {
        self.texture
            .as_ref()
            .map_or(RequiredInputs::NOTHING, ColorTexture::needs)
    }

    /// Returns the product at a point.
    #[inline]
    pub fn eval(&self, at: &TexturePoint) -> Rgb {
        match &self.texture {
            None => self.factor,
            Some(texture) => {
                let texel = texture.eval(at);
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
    /// Makes a constant number.
    pub const fn constant(factor: f32) -> Self {
        Self {
            factor,
            texture: None,
        }
    }

    /// Returns the product at a point.
    #[inline]
    pub fn eval(&self, at: &TexturePoint) -> f32 {
        let texel = self
            .texture
            .as_ref()
            .map_or(1.0, |texture| texture.eval(at));
        self.factor * texel
    }

    fn needs(&self) -> RequiredInputs {
        self.texture
            .as_ref()
            .map_or(RequiredInputs::NOTHING, FloatTexture::needs)
    }

    /// Returns the product, clamped to 0 to 1. If the number is 0, the texture is not looked up.
    #[inline]
    fn fraction(&self, at: &TexturePoint) -> f32 {
        if self.factor == 0.0 {
            return 0.0;
        }
        self.eval(at).clamp(0.0, 1.0)
    }
}

/// The stretch of highlights along one direction.
#[derive(Clone, Debug)]
pub struct Anisotropy {
    /// 0: not at all. Range: `[0, 1]`.
    pub strength: f32,
    /// The direction along which highlights stretch: cosine and sine of its angle from the tangent towards the side
    /// of ∂p/∂v.
    pub direction: Vec2,
    /// The direction in the first two channels, where 0.5 stands for 0, and the factor of `strength` in the third.
    /// None: (1, 0) and 1.
    pub texture: Option<ColorTexture>,
}

impl Anisotropy {
    /// Returns the strength, and the direction as cosine and sine in the shading frame, whose y is on the side of
    /// ∂p/∂v or opposite to it.
    #[inline]
    fn eval(&self, at: &TexturePoint) -> (f32, Vec2) {
        let on_surface = |[x, y]: [f32; 2]| Vec2::new(x, y * at.handedness.sign());
        let Some(texture) = self.texture.as_ref().filter(|_| self.strength > 0.0) else {
            return (self.strength, on_surface(self.direction.to_array()));
        };
        let [x, y, scale] = texture.eval(at);
        let direction = Vec2::new(2.0 * x - 1.0, 2.0 * y - 1.0).normalize_or(Vec2::X);
        let turned = self.direction.rotate(direction);
        (
            self.strength * scale.clamp(0.0, 1.0),
            on_surface(turned.to_array()),
        )
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
    /// The anisotropy of highlights, as of brushed metal.
    pub anisotropy: Anisotropy,
    /// The index of refraction of the part that is not metal; 0: this part reflects all light.
    pub ior: f32,
    /// The factor of the reflectance of the part that is not metal.
    pub specular: ScaledFloat,
    /// A further factor of that reflectance along the normal.
    pub specular_color: ScaledColor,
    /// The share of the part that is not metal that is transparent.
    pub transmission: ScaledFloat,
    /// The medium behind the transparent part.
    pub thickness: Thickness,
    /// The share of the opaque rest that transmits light diffusely.
    pub diffuse_transmission: ScaledFloat,
    /// The colour of diffuse transmission.
    pub diffuse_transmission_color: ScaledColor,
    /// The fraction of the surface that a clear coat covers.
    pub coat: ScaledFloat,
    /// The perceived roughness of the coat.
    pub coat_roughness: ScaledFloat,
    /// The normals of the coat. None: those of the mesh, whatever relief the base has.
    pub coat_normal: Option<NormalMap>,
    /// The colour of the sheen.
    pub sheen: ScaledColor,
    /// The perceived roughness of the sheen.
    pub sheen_roughness: ScaledFloat,
}

impl Default for PrincipledMaterial {
    /// Returns the defaults of glTF: white rough metal.
    fn default() -> Self {
        let [black, white] = [0.0, 1.0].map(|value| ScaledColor::constant([value; 3]));
        let [zero, one] = [0.0, 1.0].map(ScaledFloat::constant);
        Self {
            color: white.clone(),
            metallic: one.clone(),
            roughness: one.clone(),
            anisotropy: Anisotropy {
                strength: 0.0,
                direction: Vec2::X,
                texture: None,
            },
            ior: 1.5,
            specular: one,
            specular_color: white.clone(),
            transmission: zero.clone(),
            thickness: Thickness::ThinWalled,
            diffuse_transmission: zero.clone(),
            diffuse_transmission_color: white,
            coat: zero.clone(),
            coat_roughness: zero.clone(),
            coat_normal: None,
            sheen: black,
            sheen_roughness: zero,
        }
    }
}

impl PrincipledMaterial {
    /// Returns the normal of the coat. None: there is no coat.
    pub(super) fn coat_normal(&self, surface: &SurfacePoint, at: &TexturePoint) -> Option<Vec3> {
        let map = self.coat_normal.as_ref();
        let normal = || map.map_or(surface.shading.z, |map| map.front(surface, at));
        (self.coat.factor > 0.0).then(normal)
    }

    /// Returns the slopes along the grain and across it, and the direction of the grain.
    #[inline]
    fn facets(&self, at: &TexturePoint) -> (Ggx, Vec2) {
        let across = sqr(self.roughness.fraction(at));
        let (strength, grain) = self.anisotropy.eval(at);
        let along = across + (1.0 - across) * sqr(strength);
        (Ggx::new(along, across), grain)
    }

    #[inline]
    fn coat(&self, at: &TexturePoint) -> PrincipledCoat {
        let cover = self.coat.fraction(at);
        let alpha = if cover > 0.0 {
            sqr(self.coat_roughness.fraction(at))
        } else {
            0.0
        };
        PrincipledCoat { cover, alpha }
    }

    pub(super) fn needs(&self) -> RequiredInputs {
        let colors = [
            &self.color,
            &self.specular_color,
            &self.diffuse_transmission_color,
            &self.sheen,
        ];
        let numbers = [
            &self.metallic,
            &self.roughness,
            &self.specular,
            &self.transmission,
            &self.diffuse_transmission,
            &self.coat,
            &self.coat_roughness,
            &self.sheen_roughness,
        ];
        let has_sides = self.coat_normal.is_some() || self.anisotropy.strength > 0.0;
        let sides = if has_sides {
            RequiredInputs::ALL
        } else {
            RequiredInputs::NOTHING
        };
        let grain = self.anisotropy.texture.as_ref();
        (colors.into_iter().map(ScaledColor::needs))
            .chain(numbers.into_iter().map(ScaledFloat::needs))
            .chain(grain.map(ColorTexture::needs))
            .fold(sides, RequiredInputs::and)
    }

    /// Returns the scattering at a point. Textures of parts that the material lacks are not looked up.
    pub(super) fn bsdf(&self, at: &TexturePoint, lanes: Lanes) -> Bsdf {
        let albedo = |of: &ScaledColor| lanes.albedo(unit(of.eval(at)));
        let (ggx, grain) = self.facets(at);
        let mut parameters = PrincipledParameters {
            metallic: self.metallic.fraction(at),
            grain,
            ior: self.ior,
            specular: self.specular.fraction(at),
            transmission: self.transmission.fraction(at),
            thickness: self.thickness,
            diffuse_transmission: self.diffuse_transmission.fraction(at),
            coat: self.coat(at),
            ..PrincipledParameters::plain(albedo(&self.color), ggx)
        };
        if !self.specular_color.is_white() {
            let tint = self.specular_color.eval(at);
            parameters.specular_color = lanes.unbounded(tint);
        }
        if parameters.diffuse_transmission > 0.0 {
            parameters.diffuse_transmission_color = albedo(&self.diffuse_transmission_color);
        }
        if !self.sheen.is_black() {
            parameters.sheen = albedo(&self.sheen);
            parameters.sheen_alpha = sqr(self.sheen_roughness.fraction(at));
        }
        Bsdf::Principled(Principled::new(&parameters))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Handedness;

    #[test]
    fn highlights_stretch_along_the_direction_of_the_grain() {
        let texture = ColorTexture::Constant([0.5, 1.0, 0.5]);
        let anisotropy = |texture| Anisotropy {
            strength: 0.8,
            direction: Vec2::Y,
            texture,
        };
        let check = |anisotropy: Anisotropy, strength: f32, direction: Vec2| {
            let (found, grain) = anisotropy.eval(&TexturePoint::of_parameters(Vec2::ZERO));
            assert!((found - strength).abs() < 1e-6 && grain.distance(direction) < 1e-6);
        };
        check(anisotropy(None), 0.8, Vec2::Y);
        check(anisotropy(Some(texture)), 0.4, -Vec2::X);
    }

    /// With mirrored parameters it is on the other side of the tangent.
    #[test]
    fn the_grain_is_mirrored_with_the_parameters() {
        let direction = Vec2::new(0.6, 0.8);
        let mirrored = TexturePoint {
            handedness: Handedness::Left,
            ..TexturePoint::of_parameters(Vec2::ZERO)
        };
        for texture in [None, Some(ColorTexture::Constant([1.0, 0.5, 1.0]))] {
            let anisotropy = Anisotropy {
                strength: 0.8,
                direction,
                texture,
            };
            let (_, grain) = anisotropy.eval(&mirrored);
            assert!(grain.distance(Vec2::new(0.6, -0.8)) < 1e-6, "{grain}");
        }
    }

    #[test]
    fn values_are_the_product_of_factor_and_texture() {
        let color = ScaledColor {
            factor: [0.5, 1.0, 2.0],
            texture: Some(ColorTexture::Constant([0.5, 0.25, 0.5])),
        };
        let at = TexturePoint::of_parameters(Vec2::ZERO);
        let found = color.eval(&at).map(f32::to_bits);
        assert_eq!(found, [0.25f32, 0.25, 1.0].map(f32::to_bits));
        let number = ScaledFloat {
            factor: 3.0,
            texture: Some(FloatTexture::Constant(0.5)),
        };
        assert_eq!(number.fraction(&at).to_bits(), 1.0f32.to_bits());
    }
}
