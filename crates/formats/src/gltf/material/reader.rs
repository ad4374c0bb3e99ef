//! Reads one material.

use crate::gltf::document::Context;
use crate::gltf::json::{Material as Described, TextureInfo, Volume};
use crate::gltf::mesh::UvMap;
use crate::gltf::place::{GltfFault, Place};
use crate::gltf::texture::{Change, Lookup, Part, Textures};
use crate::image::Encoding;
use crate::text::number;
use bidir::bsdf::Thickness;
use bidir::light::EmissionSides;
use bidir::material::{
    Anisotropy, Bitangent, Material, NormalMap, PrincipledMaterial, Relief, ScaledColor,
    ScaledFloat,
};
use bidir::math::{Vec2, sin_cos};
use bidir::medium::{Coefficients, HenyeyGreenstein, Medium};
use bidir::scene::Emission;
use bidir::spectrum::Rgb;
use bidir::texture::{ColorTexture, FloatTexture};
use std::sync::Arc;

/// Reads a material and its textures.
pub(super) struct Reader<'a, 'b> {
    pub(super) context: &'a mut Context<'b>,
    pub(super) textures: &'a mut Textures,
    pub(super) described: &'a Described,
    pub(super) place: Place,
    pub(super) baked: UvMap,
}

impl Reader<'_, '_> {
    /// Reads a factor times a colour texture, which is in sRGB.
    fn color(&mut self, factor: Rgb, info: Option<&TextureInfo>) -> Result<ScaledColor, GltfFault> {
        let texture = info
            .map(|info| self.image(info, Encoding::Srgb))
            .transpose()?;
        Ok(ScaledColor { factor, texture })
    }

    fn image(&mut self, info: &TextureInfo, encoding: Encoding) -> Result<ColorTexture, GltfFault> {
        let lookup = Lookup {
            info,
            place: &self.place,
            baked: self.baked,
        };
        self.textures.color(self.context, lookup, encoding)
    }

    /// Reads a factor times one channel of a linear texture.
    fn number(
        &mut self,
        factor: f32,
        info: Option<&TextureInfo>,
        part: Part,
    ) -> Result<ScaledFloat, GltfFault> {
        let texture = info
            .map(|info| self.channel(info, part, Change::Scale(1.0)))
            .transpose()?;
        Ok(ScaledFloat { factor, texture })
    }

    fn channel(
        &mut self,
        info: &TextureInfo,
        part: Part,
        change: Change,
    ) -> Result<FloatTexture, GltfFault> {
        let lookup = Lookup {
            info,
            place: &self.place,
            baked: self.baked,
        };
        self.textures.number(self.context, lookup, part, change)
    }

    /// Builds the material, with its normal map if it has one.
    pub(super) fn material(&mut self, color: [f32; 4]) -> Result<Material, GltfFault> {
        let material = Material::Principled(Arc::new(self.principled(color)?));
        let Some(info) = &self.described.normal_texture else {
            return Ok(material);
        };
        Ok(material.with_relief(Relief::NormalMap(self.normal_map(info)?)))
    }

    fn normal_map(&mut self, info: &TextureInfo) -> Result<NormalMap, GltfFault> {
        Ok(NormalMap {
            texture: self.image(info, Encoding::Linear)?,
            scale: info.scale.unwrap_or(1.0),
            bitangent: Bitangent::AlongV,
        })
    }

    fn principled(&mut self, color: [f32; 4]) -> Result<PrincipledMaterial, GltfFault> {
        let pbr = &self.described.pbr_metallic_roughness;
        let [r, g, b, _] = pbr.base_color_factor.unwrap_or([1.0; 4]);
        let factor = [r * color[0], g * color[1], b * color[2]];
        let rough_metal = pbr.metallic_roughness_texture.as_ref();
        let mut material = PrincipledMaterial {
            color: self.color(factor, pbr.base_color_texture.as_ref())?,
            metallic: self.number(pbr.metallic_factor.unwrap_or(1.0), rough_metal, Part::Blue)?,
            roughness: self.number(
                pbr.roughness_factor.unwrap_or(1.0),
                rough_metal,
                Part::Green,
            )?,
            ..PrincipledMaterial::default()
        };
        self.read_dielectric(&mut material)?;
        self.read_transmission(&mut material)?;
        self.read_layers(&mut material)?;
        self.warn_of_departures();
        Ok(material)
    }

    /// Reads the index of refraction, specular reflectance and anisotropy.
    fn read_dielectric(&mut self, material: &mut PrincipledMaterial) -> Result<(), GltfFault> {
        let extensions = &self.described.extensions;
        let ior = extensions.ior.ior.unwrap_or(1.5);
        if !(ior == 0.0 || (1.0..=100.0).contains(&ior)) {
            let ior = number(ior);
            let message = format!("the index of refraction {ior} is neither 0 nor at least 1");
            return Err(self.place.extension("KHR_materials_ior").scene(message));
        }
        material.ior = ior;
        let specular = &extensions.specular;
        let (factor, texture) = (specular.specular_factor, &specular.specular_texture);
        material.specular = self.number(factor.unwrap_or(1.0), texture.as_ref(), Part::Alpha)?;
        let color = specular.specular_color_factor.unwrap_or([1.0; 3]);
        material.specular_color = self.color(color, specular.specular_color_texture.as_ref())?;
        if let Some(anisotropy) = &extensions.anisotropy {
            let info = anisotropy.anisotropy_texture.as_ref();
            let texture = info.map(|info| self.image(info, Encoding::Linear));
            let (sin, cos) = sin_cos(anisotropy.anisotropy_rotation);
            material.anisotropy = Anisotropy {
                strength: anisotropy.anisotropy_strength.clamp(0.0, 1.0),
                direction: Vec2::new(cos, sin),
                texture: texture.transpose()?,
            };
        }
        Ok(())
    }

    fn read_transmission(&mut self, material: &mut PrincipledMaterial) -> Result<(), GltfFault> {
        let extensions = &self.described.extensions;
        let transmission = &extensions.transmission;
        let texture = transmission.transmission_texture.as_ref();
        material.transmission =
            self.number(transmission.transmission_factor, texture, Part::Red)?;
        let diffuse = &extensions.diffuse_transmission;
        let factor = diffuse.diffuse_transmission_factor;
        let texture = diffuse.diffuse_transmission_texture.as_ref();
        material.diffuse_transmission = self.number(factor, texture, Part::Alpha)?;
        let color = diffuse
            .diffuse_transmission_color_factor
            .unwrap_or([1.0; 3]);
        let texture = diffuse.diffuse_transmission_color_texture.as_ref();
        material.diffuse_transmission_color = self.color(color, texture)?;
        if self.volume().is_some() {
            material.thickness = Thickness::Solid;
        }
        Ok(())
    }

    /// Returns the volume of the material. None: it is a thin wall.
    fn volume(&self) -> Option<&Volume> {
        let volume = &self.described.extensions.volume;
        (volume.thickness_factor > 0.0).then_some(volume)
    }

    /// Returns the index of refraction inside.
    pub(super) fn index(&self) -> f32 {
        let ior = self.described.extensions.ior.ior.unwrap_or(1.5);
        if ior > 0.0 { ior } else { 1.0 }
    }

    /// Reads the medium inside, whose transmittance over `attenuationDistance` is `attenuationColor`. Some(None): the
    /// inside is clear. None: there is no volume, or no light gets in.
    #[expect(clippy::option_option, reason = "a volume may be clear")]
    pub(super) fn inside(&self) -> Result<Option<Option<Medium>>, GltfFault> {
        let extensions = &self.described.extensions;
        let is_open = extensions.transmission.transmission_factor > 0.0
            || extensions.diffuse_transmission.diffuse_transmission_factor > 0.0;
        let Some(volume) = self.volume().filter(|_| is_open) else {
            return Ok(None);
        };
        let place = self.place.extension("KHR_materials_volume");
        let color = volume.attenuation_color.unwrap_or([1.0; 3]);
        if !color.iter().all(|channel| (0.0..=1.0).contains(channel)) {
            let message = format!("the colour {color:?} is not within 0 and 1");
            return Err(place.key("attenuationColor").scene(message));
        }
        let distance = volume.attenuation_distance.unwrap_or(f32::INFINITY);
        if distance <= 0.0 {
            let message = format!("the distance {} is not above 0", number(distance));
            return Err(place.key("attenuationDistance").scene(message));
        }
        let is_clear = distance == f32::INFINITY || color.iter().all(|&channel| channel >= 1.0);
        if is_clear {
            return Ok(Some(None));
        }
        let unit = self.context.layout.space.unit;
        let absorption = color.map(|channel| (absorption(channel, distance) * unit) as f32);
        let coefficients = Coefficients::new(absorption, [0.0; 3]).ok_or_else(|| {
            let message = format!("the distance {} is too small", number(distance));
            place.key("attenuationDistance").scene(message)
        })?;
        let medium = Medium::homogeneous(coefficients, HenyeyGreenstein::ISOTROPIC);
        Ok(Some(Some(medium)))
    }

    /// Reads coat and sheen.
    fn read_layers(&mut self, material: &mut PrincipledMaterial) -> Result<(), GltfFault> {
        let extensions = &self.described.extensions;
        let coat = &extensions.clearcoat;
        let texture = coat.clearcoat_texture.as_ref();
        material.coat = self.number(coat.clearcoat_factor, texture, Part::Red)?;
        let factor = coat.clearcoat_roughness_factor;
        let texture = coat.clearcoat_roughness_texture.as_ref();
        material.coat_roughness = self.number(factor, texture, Part::Green)?;
        let normals = coat.clearcoat_normal_texture.as_ref();
        material.coat_normal = normals.map(|info| self.normal_map(info)).transpose()?;
        let sheen = &extensions.sheen;
        let texture = sheen.sheen_color_texture.as_ref();
        material.sheen = self.color(sheen.sheen_color_factor, texture)?;
        let texture = sheen.sheen_roughness_texture.as_ref();
        material.sheen_roughness =
            self.number(sheen.sheen_roughness_factor, texture, Part::Alpha)?;
        Ok(())
    }

    /// Warns of optional features of the material that the renderer does not support.
    fn warn_of_departures(&mut self) {
        let extensions = &self.described.extensions;
        let departures = [
            (&extensions.unlit, "an unlit material is lit like any other"),
            (
                &extensions.dispersion,
                "dispersion has no effect: glass refracts all colours alike",
            ),
            (&extensions.iridescence, "iridescence has no effect"),
        ];
        for (extension, message) in departures {
            if extension.is_some() {
                self.context.warn(self.place.clone(), message);
            }
        }
    }

    pub(super) fn emission(&mut self) -> Result<Option<Emission>, GltfFault> {
        let given = &self.described.extensions.emissive_strength;
        let strength = given.emissive_strength.unwrap_or(1.0);
        let factor = self.described.emissive_factor.unwrap_or_default();
        let radiance = factor.map(|channel| channel * strength);
        let is_radiance = |channel: &f32| channel.is_finite() && *channel >= 0.0;
        if !radiance.iter().all(is_radiance) {
            let message = format!("the emission {radiance:?} is invalid");
            return Err(self.place.key("emissiveFactor").scene(message));
        }
        if radiance.iter().all(|&channel| channel <= 0.0) {
            return Ok(None);
        }
        let info = self.described.emissive_texture.as_ref();
        let image = info.map(|info| self.image(info, Encoding::Srgb));
        let pattern = image.transpose()?;
        // Lamps cost time even if they are dark, so a black image makes no lamp.
        if pattern.as_ref().is_some_and(is_black) {
            return Ok(None);
        }
        let sides = if self.described.double_sided {
            EmissionSides::Both
        } else {
            EmissionSides::Front
        };
        Ok(Some(Emission {
            radiance: radiance.into(),
            pattern,
            sides,
        }))
    }

    /// Returns the coverage of the surface; `vertex` is the alpha of its vertices.
    pub(super) fn coverage(&mut self, vertex: f32) -> Result<Option<FloatTexture>, GltfFault> {
        let pbr = &self.described.pbr_metallic_roughness;
        let factor = pbr.base_color_factor.map_or(1.0, |color| color[3]) * vertex;
        let change = match self.described.alpha_mode.as_deref() {
            None | Some("OPAQUE") => return Ok(None),
            Some("BLEND") => Change::Scale(factor),
            Some("MASK") => Change::Cut {
                factor,
                cutoff: self.described.alpha_cutoff.unwrap_or(0.5),
            },
            Some(other) => {
                let place = self.place.key("alphaMode");
                let fault = place.scene(format!("unknown alpha mode `{other}`"));
                return Err(fault.with_nearest(other, ["OPAQUE", "MASK", "BLEND"]));
            }
        };
        match &pbr.base_color_texture {
            None => Ok(Some(FloatTexture::Constant(change.apply(1.0)))),
            Some(info) => self.channel(info, Part::Alpha, change).map(Some),
        }
    }
}

/// Returns σ_a = -ln(part) / distance, for a transmittance `part` of at least 10⁻³⁸.
fn absorption(part: f32, distance: f32) -> f64 {
    -libm::log(part.max(f32::MIN_POSITIVE).into()) / f64::from(distance)
}

/// Returns true for an image of black texels.
fn is_black(texture: &ColorTexture) -> bool {
    let ColorTexture::Image(map) = texture else {
        return false;
    };
    let mut channels = map.image.texels().iter().flatten();
    channels.all(|&channel| channel <= 0.0)
}
