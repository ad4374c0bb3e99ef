//! The JSON of a glTF file, as far as it is read. Other keys are ignored, as the format demands.

#![expect(
    clippy::struct_field_names,
    reason = "the names are those of the format"
)]

use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

/// An index into one of the file's arrays.
pub(super) type Index = usize;

macro_rules! object {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default, Deserialize)]
        #[serde(default, rename_all = "camelCase")]
        pub(super) struct $name {
            $($(#[$field_doc])* pub(super) $field: $kind,)*
        }
    };
}

object!(
    /// The whole file.
    Root {
        asset: Asset,
        extensions_used: Vec<String>,
        extensions_required: Vec<String>,
        scene: Option<Index>,
        scenes: Vec<SceneObject>,
        nodes: Vec<Node>,
        meshes: Vec<Mesh>,
        accessors: Vec<Accessor>,
        buffer_views: Vec<BufferView>,
        buffers: Vec<Buffer>,
        materials: Vec<Material>,
        textures: Vec<Texture>,
        images: Vec<Image>,
        samplers: Vec<Sampler>,
        cameras: Vec<Camera>,
        skins: Vec<Skin>,
        animations: Vec<IgnoredAny>,
        extensions: RootExtensions,
    }
);
object!(RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    lights: Option<Lights>,
});
object!(Lights { lights: Vec<Light>, });
object!(Asset {
    version: String,
    min_version: Option<String>,
});
object!(SceneObject { nodes: Vec<Index>, });
object!(Node {
    children: Vec<Index>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    mesh: Option<Index>,
    camera: Option<Index>,
    skin: Option<Index>,
    weights: Option<Vec<f32>>,
    extensions: NodeExtensions,
});
object!(NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    light: Option<NodeLight>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    instancing: Option<Instancing>,
});
object!(NodeLight { light: Option<Index>, });
object!(Instancing { attributes: BTreeMap<String, Index>, });
object!(Mesh {
    primitives: Vec<Primitive>,
    weights: Vec<f32>,
});
object!(Primitive {
    attributes: BTreeMap<String, Index>,
    indices: Option<Index>,
    material: Option<Index>,
    mode: Option<u32>,
    targets: Vec<BTreeMap<String, Index>>,
});
object!(Accessor {
    buffer_view: Option<Index>,
    byte_offset: usize,
    component_type: u32,
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<Sparse>,
});
object!(Sparse {
    count: usize,
    indices: SparseIndices,
    values: SparseValues,
});
object!(SparseIndices {
    buffer_view: Index,
    byte_offset: usize,
    component_type: u32,
});
object!(SparseValues {
    buffer_view: Index,
    byte_offset: usize,
});
object!(BufferView {
    buffer: Index,
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
});
object!(Buffer {
    uri: Option<String>,
    byte_length: usize,
});
object!(Skin {
    inverse_bind_matrices: Option<Index>,
    joints: Vec<Index>,
});
object!(Camera {
    #[serde(rename = "type")]
    kind: String,
    perspective: Option<Perspective>,
    orthographic: Option<Orthographic>,
});
object!(Perspective {
    aspect_ratio: Option<f64>,
    yfov: f64,
});
object!(Orthographic {
    xmag: f64,
    ymag: f64,
});
object!(Light {
    #[serde(rename = "type")]
    kind: String,
    color: Option<[f32; 3]>,
    intensity: Option<f32>,
    range: Option<f32>,
    spot: Option<Spot>,
});
object!(Spot {
    inner_cone_angle: Option<f32>,
    outer_cone_angle: Option<f32>,
});
object!(Texture {
    source: Option<Index>,
    sampler: Option<Index>,
    extensions: ImageExtensions,
});
object!(
    /// The images of a texture in the formats of extensions.
    ImageExtensions {
        #[serde(rename = "EXT_texture_webp")]
        webp: Option<OtherImage>,
        #[serde(rename = "KHR_texture_basisu")]
        basisu: Option<OtherImage>,
        #[serde(rename = "EXT_texture_avif")]
        avif: Option<OtherImage>,
        #[serde(rename = "MSFT_texture_dds")]
        dds: Option<OtherImage>,
    }
);
object!(OtherImage {
    source: Option<Index>,
});
object!(Image {
    uri: Option<String>,
    buffer_view: Option<Index>,
});
object!(Sampler {
    mag_filter: Option<u32>,
    wrap_s: Option<u32>,
    wrap_t: Option<u32>,
});
object!(
    /// The use of a texture by a material.
    TextureInfo {
        index: Index,
        tex_coord: usize,
        /// The scale of a normal texture.
        scale: Option<f32>,
        extensions: TextureExtensions,
    }
);
object!(TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<TextureTransform>,
});
object!(TextureTransform {
    offset: Option<[f32; 2]>,
    rotation: f32,
    scale: Option<[f32; 2]>,
    tex_coord: Option<usize>,
});
object!(Material {
    pbr_metallic_roughness: Pbr,
    normal_texture: Option<TextureInfo>,
    occlusion_texture: Option<TextureInfo>,
    emissive_texture: Option<TextureInfo>,
    emissive_factor: Option<[f32; 3]>,
    alpha_mode: Option<String>,
    alpha_cutoff: Option<f32>,
    double_sided: bool,
    extensions: MaterialExtensions,
});
object!(Pbr {
    base_color_factor: Option<[f32; 4]>,
    metallic_factor: Option<f32>,
    roughness_factor: Option<f32>,
    base_color_texture: Option<TextureInfo>,
    metallic_roughness_texture: Option<TextureInfo>,
});
object!(MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    emissive_strength: EmissiveStrength,
    #[serde(rename = "KHR_materials_ior")]
    ior: Ior,
    #[serde(rename = "KHR_materials_specular")]
    specular: Specular,
    #[serde(rename = "KHR_materials_transmission")]
    transmission: Transmission,
    #[serde(rename = "KHR_materials_volume")]
    volume: Volume,
    #[serde(rename = "KHR_materials_clearcoat")]
    clearcoat: Clearcoat,
    #[serde(rename = "KHR_materials_sheen")]
    sheen: Sheen,
    #[serde(rename = "KHR_materials_anisotropy")]
    anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    diffuse_transmission: DiffuseTransmission,
    #[serde(rename = "KHR_materials_unlit")]
    unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_dispersion")]
    dispersion: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_iridescence")]
    iridescence: Option<IgnoredAny>,
});
object!(EmissiveStrength { emissive_strength: Option<f32>, });
object!(Ior { ior: Option<f32>, });
object!(Specular {
    specular_factor: Option<f32>,
    specular_texture: Option<TextureInfo>,
    specular_color_factor: Option<[f32; 3]>,
    specular_color_texture: Option<TextureInfo>,
});
object!(Transmission {
    transmission_factor: f32,
    transmission_texture: Option<TextureInfo>,
});
object!(Volume {
    thickness_factor: f32,
    attenuation_distance: Option<f32>,
    attenuation_color: Option<[f32; 3]>,
});
object!(Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<TextureInfo>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<TextureInfo>,
    clearcoat_normal_texture: Option<TextureInfo>,
});
object!(Sheen {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<TextureInfo>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<TextureInfo>,
});
object!(Anisotropy {
    anisotropy_strength: f32,
    anisotropy_rotation: f32,
    anisotropy_texture: Option<TextureInfo>,
});
object!(DiffuseTransmission {
    diffuse_transmission_factor: f32,
    diffuse_transmission_texture: Option<TextureInfo>,
    diffuse_transmission_color_factor: Option<[f32; 3]>,
    diffuse_transmission_color_texture: Option<TextureInfo>,
});
