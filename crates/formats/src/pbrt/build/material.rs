//! Materials.
//!
//! A mixture names its parts, which are built before it; a cycle of mixtures is an error.

use super::color::Purpose;
use super::context::Context;
use super::media::{self, Recipe};
use super::reader::Reader;
use super::spectral;
use super::texture::Textures;
use crate::pbrt::known;
use crate::pbrt::lexer::shorten;
use crate::pbrt::parameters::ParameterType;
use crate::pbrt::scene::MaterialDescription;
use crate::source::{Fault, Span};
use bidir::bsdf::FacetScattering;
use bidir::material::{
    Bitangent, CLEAR, CoatSettings, CoatedConductorMaterial, CoatedDiffuseMaterial, ConductorIndex,
    Material, Mixture, NormalMap, Relief, Roughness, RoughnessMapping,
};
use bidir::scene::RenderSpace;
use bidir::spectrum::{Metal, RefractiveIndex};
use bidir::texture::{ColorTexture, FloatTexture, Mix, Scale};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A material, with its coverage of the surface and the contents of the volume inside.
pub(super) struct Built {
    pub(super) material: Material,
    /// The part of the surface that has the material. Rays pass through the rest, which is the `interface` of a
    /// mixture. None: all of the surface.
    pub(super) coverage: Option<FloatTexture>,
    /// The medium within the surface.
    pub(super) content: Option<Recipe>,
    /// The priority and the index of refraction of the volume inside. None: the file gives no priority, and the index
    /// is the ratio of inside to outside.
    pub(super) filling: Option<(i32, f32)>,
}

impl From<Material> for Built {
    fn from(material: Material) -> Self {
        Self {
            material,
            coverage: None,
            content: None,
            filling: None,
        }
    }
}

/// Builds the materials of a description one by one.
pub(super) struct Materials<'a> {
    described: &'a [MaterialDescription],
    /// The named materials by name.
    named: BTreeMap<&'a str, usize>,
    /// The materials in construction, the innermost last, to find cycles of mixtures.
    open: Vec<usize>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(described: &'a [MaterialDescription]) -> Self {
        let named = described.iter().enumerate();
        Self {
            named: named
                .filter_map(|(index, material)| Some((material.name.as_deref()?, index)))
                .collect(),
            described,
            open: Vec::new(),
        }
    }

    /// Builds material number `index`. A material without an entity is the default material.
    ///
    /// None: the surface is not visible, and all rays pass through it, also shadow rays. Its shapes do not emit,
    /// and can be left out if they bound no medium.
    pub(super) fn build(
        &mut self,
        context: &mut Context<'_>,
        textures: &mut Textures<'_>,
        index: usize,
    ) -> Result<Option<Built>, Fault> {
        let described = self.described;
        let Some(entity) = described[index].entity.as_ref() else {
            return Ok(Some(grey().into()));
        };
        let mut parameters = Parameters {
            textures,
            reader: Reader::new(context, entity),
        };
        let mut content = None;
        let material = match entity.kind.as_str() {
            "diffuse" => Material::Diffuse {
                reflectance: parameters.albedo("reflectance", 0.5)?,
            },
            "diffusetransmission" => parameters.diffuse_transmission()?,
            "conductor" => parameters.conductor()?,
            "dielectric" => {
                let eta = spectral::read_eta(&mut parameters.reader, "eta", GLASS)?;
                parameters.dielectric(eta)?
            }
            "thindielectric" => Material::ThinDielectric {
                eta: spectral::read_eta(&mut parameters.reader, "eta", GLASS)?,
            },
            "coateddiffuse" => parameters.coated_diffuse()?,
            "coatedconductor" => parameters.coated_conductor()?,
            "subsurface" => {
                let eta = spectral::read_eta(&mut parameters.reader, "eta", WATER)?;
                let constant = eta.at_d_line();
                let surface = parameters.dielectric(eta)?;
                content = Some(media::subsurface::read(&mut parameters.reader, constant)?);
                surface
            }
            "mix" => {
                let material = self.mix(&mut parameters, index)?;
                parameters.reader.finish()?;
                return Ok(material);
            }
            "interface" | "none" | "" => {
                parameters.reader.finish()?;
                return Ok(None);
            }
            kind => return parameters.substitute(kind).map(|grey| Some(grey.into())),
        };
        let filling = match &material {
            Material::Dielectric { eta, .. } => {
                let priority = parameters.reader.optional_integer("priority")?;
                priority.map(|priority| (priority, eta.at_d_line()))
            }
            _ => None,
        };
        let relief = parameters.relief()?;
        parameters.reader.finish()?;
        let material = match relief {
            Some(relief) => material.with_relief(relief),
            None => material,
        };
        Ok(Some(Built {
            content,
            filling,
            ..material.into()
        }))
    }

    /// Builds a mixture. None: no part of it is visible.
    fn mix(
        &mut self,
        from: &mut Parameters<'_, '_, '_>,
        index: usize,
    ) -> Result<Option<Built>, Fault> {
        let amount = from.float("amount", 0.5)?;
        let reader = &mut from.reader;
        let Some(parameter) = reader.find(ParameterType::String, "materials") else {
            return Err(reader.missing("string materials"));
        };
        let (names, span) = (parameter.values.strings(), parameter.value_span);
        let [first, second] = names else {
            let message = format!("`materials` has two names, found {}", names.len());
            return Err(Fault::scene(span, message));
        };
        self.open.push(index);
        let parts = [first, second].map(|name| self.part(from, name, span));
        self.open.pop();
        let [first, second] = parts;
        match (first?, second?) {
            (None, None) => Ok(None),
            (Some(first), None) => Ok(Some(first.covering(inverted(amount)))),
            (None, Some(second)) => Ok(Some(second.covering(amount))),
            (Some(first), Some(second)) => {
                mixed(from.reader.context, span, [first, second], amount).map(Some)
            }
        }
    }

    /// Builds the part `name` of a mixture.
    fn part(
        &mut self,
        from: &mut Parameters<'_, '_, '_>,
        name: &str,
        span: Span,
    ) -> Result<Option<Built>, Fault> {
        let Some(&index) = self.named.get(&*known::normalized(name)) else {
            let known = self.named.keys().copied();
            return Err(known::unknown(span, "material", name, known));
        };
        if self.open.contains(&index) {
            let message = format!("the mixture `{}` is a part of itself", shorten(name));
            return Err(Fault::scene(span, message));
        }
        if self.open.len() >= DEEPEST {
            let message = format!("mixtures are nested deeper than {DEEPEST}");
            return Err(Fault::scene(span, message));
        }
        let mut part = self.build(from.reader.context, from.textures, index)?;
        let Some(built) = &mut part else {
            return Ok(None);
        };
        let context = &mut *from.reader.context;
        if built.content.take().is_some() {
            let what = "a mixture with a material `subsurface`";
            context.unsupported(span, what, "its part is clear glass")?;
        }
        if built.filling.take().is_some() {
            let what = "a mixture with a material that has a `priority`";
            context.unsupported(span, what, "its part has none")?;
        }
        Ok(part)
    }
}

impl Built {
    /// Returns the material with its coverage times `part`.
    fn covering(self, part: FloatTexture) -> Self {
        Self {
            coverage: all_of(self.coverage, Some(part)),
            ..self
        }
    }
}

/// Returns 1 - `amount`.
fn inverted(amount: FloatTexture) -> FloatTexture {
    FloatTexture::Mix(Arc::new(Mix {
        textures: [1.0, 0.0].map(FloatTexture::Constant),
        amount,
    }))
}

/// Mixes two materials, neither of which is an `interface`, although their parts may be.
///
/// With coverages c₁ and c₂ and the amount a, the coverage is c = (1 - a) c₁ + a c₂; the second material has the part
/// a c₂ / c of it.
fn mixed(
    context: &mut Context<'_>,
    span: Span,
    parts: [Built; 2],
    amount: FloatTexture,
) -> Result<Built, Fault> {
    let [c1, c2] = parts.each_ref().map(|part| match &part.coverage {
        None => Some(1.0),
        Some(coverage) => constant(coverage),
    });
    let is_whole = parts.iter().all(|part| part.coverage.is_none());
    let materials = parts.map(|part| part.material);
    let mixture = |amount| Material::Mix(Arc::new(Mixture { materials, amount }));
    if is_whole {
        return Ok(mixture(amount).into());
    }
    let (Some(c1), Some(c2), Some(a)) = (c1, c2, constant(&amount)) else {
        let what = "a mixture of a textured mixture with `interface`";
        context.unsupported(span, what, "all of it is a surface")?;
        return Ok(mixture(amount).into());
    };
    let covered = (1.0 - a) * c1 + a * c2;
    let of_second = if covered > 0.0 { a * c2 / covered } else { 0.0 };
    let built = Built::from(mixture(FloatTexture::Constant(of_second)));
    Ok(built.covering(FloatTexture::Constant(covered)))
}

/// Returns the value of a constant texture, clamped to `[0, 1]`. None: the texture is not constant.
fn constant(texture: &FloatTexture) -> Option<f32> {
    match texture {
        FloatTexture::Constant(value) => Some(value.clamp(0.0, 1.0)),
        FloatTexture::Scale(scale) => Some(constant(&scale.texture)? * constant(&scale.factor)?),
        FloatTexture::Mix(mix) => {
            let [first, second] = mix.textures.each_ref().map(constant);
            let amount = constant(&mix.amount)?;
            Some((1.0 - amount) * first? + amount * second?)
        }
        _ => None,
    }
}

/// Maximum depth of mixtures, as each level doubles the number of materials.
const DEEPEST: usize = 8;

fn grey() -> Material {
    Material::Diffuse {
        reflectance: ColorTexture::Constant([0.5; 3]),
    }
}

/// Converts heights from world units to the unit of `space`.
fn in_space(height: FloatTexture, space: &RenderSpace) -> FloatTexture {
    if *space == RenderSpace::WORLD {
        return height;
    }
    scaled(height, FloatTexture::Constant((1.0 / space.unit) as f32))
}

/// Returns the product of two textures.
fn scaled(texture: FloatTexture, factor: FloatTexture) -> FloatTexture {
    FloatTexture::Scale(Arc::new(Scale { texture, factor }))
}

/// Returns the product of two coverages. None: opaque.
pub(super) fn all_of(
    first: Option<FloatTexture>,
    second: Option<FloatTexture>,
) -> Option<FloatTexture> {
    match (first, second) {
        (Some(texture), Some(factor)) => Some(scaled(texture, factor)),
        (first, second) => first.or(second),
    }
}

/// The default index of refraction.
const GLASS: f32 = 1.5;
/// The default index of refraction of `subsurface`.
const WATER: f32 = 1.33;

/// The names of roughness parameters: for both directions, along u, along v.
const SURFACE: [&str; 3] = ["roughness", "uroughness", "vroughness"];
/// The names of the roughness parameters of a layer's interface.
const INTERFACE: [&str; 3] = [
    "interface.roughness",
    "interface.uroughness",
    "interface.vroughness",
];
/// The names of the roughness parameters of the metal under a layer.
const METAL: [&str; 3] = [
    "conductor.roughness",
    "conductor.uroughness",
    "conductor.vroughness",
];

/// The parameters of a material, with the textures that they may name.
struct Parameters<'a, 'd, 'c> {
    textures: &'a mut Textures<'d>,
    reader: Reader<'a, 'c>,
}

impl Parameters<'_, '_, '_> {
    /// Reads a number or the name of a texture.
    fn float(&mut self, name: &'static str, default: f32) -> Result<FloatTexture, Fault> {
        let given = self.textures.float(&mut self.reader, name)?;
        Ok(given.unwrap_or(FloatTexture::Constant(default)))
    }

    /// Reads a colour between 0 and 1 or the name of a texture. None: the file has none.
    fn optional_albedo(&mut self, name: &'static str) -> Result<Option<ColorTexture>, Fault> {
        self.textures.get(&mut self.reader, name, Purpose::Albedo)
    }

    /// Reads a colour between 0 and 1 or the name of a texture; by default it is grey.
    fn albedo(&mut self, name: &'static str, default: f32) -> Result<ColorTexture, Fault> {
        let given = self.optional_albedo(name)?;
        Ok(given.unwrap_or(ColorTexture::Constant([default; 3])))
    }

    /// Reads the normal map, or else the bump map, which is a texture of heights.
    fn relief(&mut self) -> Result<Option<Relief>, Fault> {
        let height = self.textures.float(&mut self.reader, "displacement")?;
        let normals = self.textures.normals(&mut self.reader, "normalmap")?;
        if let Some(texture) = normals {
            return Ok(Some(Relief::NormalMap(NormalMap {
                texture,
                scale: 1.0,
                bitangent: Bitangent::RightHanded,
            })));
        }
        let space = &self.reader.context.layout.space;
        Ok(height.map(|height| Relief::Displacement(in_space(height, space))))
    }

    fn diffuse_transmission(&mut self) -> Result<Material, Fault> {
        Ok(Material::DiffuseTransmission {
            reflectance: self.albedo("reflectance", 0.25)?,
            transmittance: self.albedo("transmittance", 0.25)?,
            scale: self.reader.float_within("scale", 1.0, [0.0, f32::MAX])?,
        })
    }

    fn conductor(&mut self) -> Result<Material, Fault> {
        Ok(Material::Conductor {
            index: self.conductor_index("eta", "k")?,
            roughness: self.roughness(&SURFACE)?,
            scattering: self.facet_scattering()?,
        })
    }

    /// Reads whether facets scatter light once or several times, a parameter that pbrt-v4 does not have.
    fn facet_scattering(&mut self) -> Result<FacetScattering, Fault> {
        Ok(if self.reader.bool("multiscatter", false)? {
            FacetScattering::Multiple
        } else {
            FacetScattering::Single
        })
    }

    /// Reads the complex index of refraction of a metal; `eta` and `k` are the names of its parts.
    fn conductor_index(
        &mut self,
        eta: &'static str,
        k: &'static str,
    ) -> Result<ConductorIndex, Fault> {
        if let Some(reflectance) = self.optional_albedo("reflectance")? {
            let kinds = [
                ParameterType::Texture,
                ParameterType::Spectrum,
                ParameterType::Rgb,
            ];
            let reader = &mut self.reader;
            let mut is_given = |name| kinds.iter().any(|&kind| reader.find(kind, name).is_some());
            if is_given(eta) || is_given(k) {
                let message =
                    format!("a conductor has `reflectance` or `{eta}` and `{k}`, not both");
                return Err(self.reader.fault(message));
            }
            return Ok(ConductorIndex::Reflectance(reflectance));
        }
        if let Some(metal) = spectral::read_metal(&mut self.reader, eta, k)? {
            return Ok(ConductorIndex::Measured(metal.into()));
        }
        let copper = Metal::named("Cu").map(|copper| copper.channels());
        let [of_copper, k_of_copper] = copper.unwrap_or([[1.0; 3], [0.0; 3]]);
        let mut part = |name, copper| -> Result<ColorTexture, Fault> {
            let reader = &mut self.reader;
            let given = self.textures.get(reader, name, Purpose::Unbounded)?;
            Ok(given.unwrap_or(ColorTexture::Constant(copper)))
        };
        Ok(ConductorIndex::Complex {
            eta: part(eta, of_copper)?,
            k: part(k, k_of_copper)?,
        })
    }

    /// Reads the surface of a dielectric with this index of refraction.
    fn dielectric(&mut self, eta: RefractiveIndex) -> Result<Material, Fault> {
        Ok(Material::Dielectric {
            eta,
            roughness: self.roughness(&SURFACE)?,
            scattering: self.facet_scattering()?,
        })
    }

    fn coated_diffuse(&mut self) -> Result<Material, Fault> {
        let reflectance = self.albedo("reflectance", 0.5)?;
        let coat = self.coat("eta", &SURFACE)?;
        let material = CoatedDiffuseMaterial::new(coat, reflectance);
        Ok(Material::CoatedDiffuse(material))
    }

    fn coated_conductor(&mut self) -> Result<Material, Fault> {
        let index = self.conductor_index("conductor.eta", "conductor.k")?;
        let of_metal = self.roughness(&METAL)?;
        let coat = self.coat("interface.eta", &INTERFACE)?;
        let material = CoatedConductorMaterial::new(coat, index, of_metal);
        Ok(Material::CoatedConductor(material))
    }

    /// Reads a coat; `eta` and `roughness` are the names of its parameters.
    fn coat(
        &mut self,
        eta: &'static str,
        roughness: &[&'static str; 3],
    ) -> Result<CoatSettings, Fault> {
        let thickness = self.float("thickness", 0.01)?;
        let albedo = self.optional_albedo("albedo")?;
        let g = self.float("g", 0.0)?;
        self.reader.ignore(ParameterType::Integer, "maxdepth");
        self.reader.ignore(ParameterType::Integer, "nsamples");
        Ok(CoatSettings {
            eta: spectral::read_eta(&mut self.reader, eta, GLASS)?.at_d_line(),
            roughness: self.roughness(roughness)?,
            thickness,
            albedo: albedo.unwrap_or(CLEAR),
            g,
        })
    }

    fn roughness(&mut self, [both, u, v]: &[&'static str; 3]) -> Result<Roughness, Fault> {
        let both = self.float(both, 0.0)?;
        let u = self.textures.float(&mut self.reader, u)?;
        let v = self.textures.float(&mut self.reader, v)?;
        let mapping = if self.reader.bool("remaproughness", true)? {
            RoughnessMapping::SquareRoot
        } else {
            RoughnessMapping::Identity
        };
        Ok(Roughness {
            u: u.unwrap_or_else(|| both.clone()),
            v: v.unwrap_or(both),
            mapping,
        })
    }

    /// Returns the substitute of a material that is not supported. Does not check its parameters.
    fn substitute(&mut self, kind: &str) -> Result<Material, Fault> {
        let span = self.reader.span();
        let what = format!("the material `{kind}`");
        let substitute = "`diffuse` with reflectance 0.5 is used instead";
        (self.reader.context).unsupported(span, &what, substitute)?;
        Ok(grey())
    }
}
