//! Materials: scattering, emission and coverage of surfaces.

mod reader;

use super::document::Context;
use super::json::{Material as Described, TextureInfo};
use super::mesh::UvMap;
use super::place::{GltfFault, Place};
use super::texture::{Textures, uv_map};
use crate::import::{Skin, VolumeContent};
use bidir::material::Material;
use bidir::medium::{Medium, MediumId, MediumSides};
use bidir::scene::{Emission, MaterialId, SceneBuilder, Volume};
use bidir::texture::FloatTexture;
use reader::Reader;
use std::collections::BTreeMap;

/// A built material for shapes.
#[derive(Clone, Debug)]
pub(super) struct Built {
    pub(super) id: MaterialId,
    pub(super) emission: Option<Emission>,
    /// The contents of the volume inside. None: surfaces are opaque, or thin walls.
    pub(super) content: Option<VolumeContent>,
    /// The coverage of the surface. None: it is opaque.
    pub(super) coverage: Option<FloatTexture>,
    /// The map from texture coordinates to the parameters of meshes.
    pub(super) uv: UvMap,
}

impl Built {
    /// Returns the surface of a shape with this material, which belongs to the family of this number.
    pub(super) fn skin(&self, family: usize) -> Skin<'_> {
        let medium = self.content.map(|content| content.volume.medium);
        Skin {
            material: Some(self.id),
            coverage: self.coverage.as_ref(),
            media: MediumSides {
                inside: medium.unwrap_or_default(),
                ..MediumSides::VACUUM
            },
            content: self.content.map(|content| (content, family)),
        }
    }
}

/// The index of a primitive's material, and the bits of the factor that its vertices have on the base colour.
type Key = (Option<usize>, [u32; 4]);

/// The materials in use.
#[derive(Default)]
pub(super) struct Materials {
    built: BTreeMap<Key, Built>,
    textures: Textures,
}

impl Materials {
    /// Returns material number `index`, or the default material, with its base colour times `color`.
    pub(super) fn get(
        &mut self,
        context: &mut Context<'_>,
        builder: &mut SceneBuilder,
        index: Option<usize>,
        user: &Place,
        color: [f32; 4],
    ) -> Result<Built, GltfFault> {
        let key = (index, color.map(f32::to_bits));
        if let Some(built) = self.built.get(&key) {
            return Ok(built.clone());
        }
        let default = Described::default();
        let described = match index {
            None => &default,
            Some(index) => {
                let place = user.key("material");
                place.find(&context.document.root.materials, index, "material")?
            }
        };
        let place = index.map_or(user.clone(), |index| Place::of("materials", index));
        let mut reader = Reader {
            baked: baked(described),
            context,
            textures: &mut self.textures,
            described,
            place,
        };
        let material = reader.material(color)?;
        let inside = reader.inside()?;
        let ior = reader.index();
        let thin = inside.is_some().then(|| material.clone().into_thin());
        let id = builder.material(material);
        let content = inside.zip(thin);
        let built = Built {
            id,
            content: content.map(|(medium, thin)| content_of(builder, ior, medium, thin)),
            emission: reader.emission()?,
            coverage: reader.coverage(color[3])?,
            uv: reader.baked,
        };
        self.built.insert(key, built.clone());
        Ok(built)
    }

    /// Returns the number of materials.
    pub(super) fn count(&self) -> usize {
        self.built.len()
    }
}

/// Returns the contents of a volume with this index of refraction and medium. No medium: it is clear.
fn content_of(
    builder: &mut SceneBuilder,
    index: f32,
    medium: Option<Medium>,
    thin: Material,
) -> VolumeContent {
    let medium = medium.map_or(MediumId::VACUUM, |medium| builder.medium(medium));
    VolumeContent {
        volume: Volume {
            index,
            medium,
            priority: 0,
        },
        thin: Some(builder.material(thin)),
        warning: "the mesh encloses nothing: it is a thin wall, without a volume",
    }
}

/// Returns the textures of a material, the one whose coordinates matter most first.
fn infos(described: &Described) -> Vec<&TextureInfo> {
    let (pbr, extensions) = (&described.pbr_metallic_roughness, &described.extensions);
    let (coat, sheen) = (&extensions.clearcoat, &extensions.sheen);
    let (specular, diffuse) = (&extensions.specular, &extensions.diffuse_transmission);
    let anisotropy = extensions.anisotropy.as_ref();
    let all = [
        pbr.base_color_texture.as_ref(),
        pbr.metallic_roughness_texture.as_ref(),
        described.normal_texture.as_ref(),
        specular.specular_texture.as_ref(),
        specular.specular_color_texture.as_ref(),
        coat.clearcoat_texture.as_ref(),
        coat.clearcoat_roughness_texture.as_ref(),
        coat.clearcoat_normal_texture.as_ref(),
        sheen.sheen_color_texture.as_ref(),
        sheen.sheen_roughness_texture.as_ref(),
        extensions.transmission.transmission_texture.as_ref(),
        diffuse.diffuse_transmission_texture.as_ref(),
        diffuse.diffuse_transmission_color_texture.as_ref(),
        anisotropy.and_then(|anisotropy| anisotropy.anisotropy_texture.as_ref()),
        described.emissive_texture.as_ref(),
    ];
    all.into_iter().flatten().collect()
}

/// Returns the map from texture coordinates to the parameters of meshes: the one that tangents follow, else the one
/// that all textures share, else the coordinate set of the first texture.
fn baked(described: &Described) -> UvMap {
    if let Some(map) = map_of_tangents(described) {
        return map;
    }
    let mut maps = infos(described).into_iter().map(uv_map);
    let Some(first) = maps.next() else {
        return UvMap::IDENTITY;
    };
    if maps.all(|map| map == first) {
        first
    } else {
        first.untransformed()
    }
}

/// Returns the map of the texture coordinates that tangents follow: those of the first texture that is given in the
/// tangent frame, or for uniform anisotropy those of the file. None: nothing depends on tangents, or that texture has
/// other coordinates than the first texture.
fn map_of_tangents(described: &Described) -> Option<UvMap> {
    let first = uv_map(infos(described).first()?);
    let extensions = &described.extensions;
    let anisotropy = extensions.anisotropy.as_ref();
    let in_frames = [
        described.normal_texture.as_ref(),
        extensions.clearcoat.clearcoat_normal_texture.as_ref(),
        anisotropy.and_then(|anisotropy| anisotropy.anisotropy_texture.as_ref()),
    ];
    let own = in_frames.into_iter().flatten().map(uv_map).next();
    let plain = anisotropy.map(|_| first.untransformed());
    let map = own.filter(|map| map.set == first.set).or(plain)?;
    Some(if map.is_regular() {
        map
    } else {
        map.untransformed()
    })
}
