//! The contents of a scene's text as plain data, without meshes and images.

use super::parameters::{Parameter, ParameterList};
use super::transform::Transforms;
use crate::files::Files;
use crate::import::Warning;
use crate::source::{SourceMap, Span};
use bidir::shape::Orientation;
use std::path::PathBuf;
use std::sync::Arc;

/// A parsed scene.
///
/// References are valid indices into the vectors here. Every item has its place in the text, so that errors
/// during building have file, line and column.
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    /// The texts that spans point into.
    pub sources: SourceMap,
    /// The source of files.
    pub files: Files,
    /// The files of the texts, under each name by which they were requested.
    pub texts: Vec<PathBuf>,
    /// The size of these files on the disk, packed, each counted once. Unit: bytes.
    pub stored: u64,
    /// The folder of the top-level file, to which relative file names refer.
    pub folder: PathBuf,
    /// The camera. None, here and below: the file has no such directive.
    pub camera: Option<CameraDescription>,
    /// The film.
    pub film: Option<FilmDescription>,
    /// The sampler.
    pub sampler: Option<Entity>,
    /// The integrator.
    pub integrator: Option<Entity>,
    /// The pixel filter.
    pub filter: Option<Entity>,
    /// The acceleration structure.
    pub accelerator: Option<Entity>,
    /// The `Option` directives.
    pub options: Vec<OptionDescription>,
    /// The materials. The first is the default material.
    pub materials: Vec<MaterialDescription>,
    /// The textures.
    pub textures: Vec<TextureDescription>,
    /// The participating media.
    pub media: Vec<MediumDescription>,
    /// The light sources that are not shapes.
    pub lights: Vec<LightDescription>,
    /// The shapes outside of objects.
    pub shapes: Vec<ShapeDescription>,
    /// The objects.
    pub objects: Vec<ObjectDescription>,
    /// The instances of objects.
    pub instances: Vec<InstanceDescription>,
    /// The warnings.
    pub warnings: Vec<Warning>,
}

/// A type word in quotes and its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Entity {
    /// The type word.
    pub kind: String,
    /// Its parameters.
    pub parameters: ParameterList,
    /// The place of the type word with its quotes.
    pub span: Span,
}

/// A colour space of the format. Values are linear in all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorSpace {
    /// Rec. 709 primaries.
    #[default]
    Srgb,
    /// DCI-P3 primaries with D65.
    DciP3,
    /// Rec. 2020 primaries.
    Rec2020,
    /// ACES 2065-1 (AP0).
    Aces2065,
}

/// The camera and its transformation.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDescription {
    /// Type and parameters.
    pub entity: Entity,
    /// Camera from world.
    pub transforms: Transforms,
    /// The media of the camera; the outside one surrounds it.
    pub medium: MediumInterface,
}

/// The film.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmDescription {
    /// Type and parameters.
    pub entity: Entity,
    /// The colour space of the image.
    pub color_space: ColorSpace,
}

/// An `Option`.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionDescription {
    /// The name in lower case, without `-` and `_`.
    pub name: String,
    /// The value as the file has it; strings without their quotes.
    pub value: String,
    /// The name with its quotes.
    pub span: Span,
}

/// A material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialDescription {
    /// The name. None: the material comes from a `Material` directive.
    pub name: Option<String>,
    /// Type and parameters. None: this is the default material.
    pub entity: Option<Entity>,
}

/// The type of a texture's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TextureKind {
    /// Numbers.
    Float,
    /// Colours.
    Spectrum,
}

impl TextureKind {
    /// Returns the word in files.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Float => "float",
            Self::Spectrum => "spectrum",
        }
    }
}

/// A texture.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureDescription {
    /// The name: numbers and colours have separate name spaces.
    pub name: String,
    /// The type of its values.
    pub kind: TextureKind,
    /// Class and parameters.
    pub entity: Entity,
    /// World from texture space.
    pub transforms: Transforms,
}

/// A participating medium.
#[derive(Clone, Debug, PartialEq)]
pub struct MediumDescription {
    /// The name; its place is the span of [`entity`](Self::entity).
    pub name: String,
    /// Type and parameters.
    pub entity: Entity,
    /// World from medium space.
    pub transforms: Transforms,
}

/// A light source that is not a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct LightDescription {
    /// Type and parameters.
    pub entity: Entity,
    /// World from light space.
    pub transforms: Transforms,
}

/// A shape.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeDescription {
    /// Type and parameters.
    pub entity: Entity,
    /// World space from object space; for a shape of an object, instance space from object space.
    pub transforms: Transforms,
    /// The orientation, which `ReverseOrientation` turns.
    pub orientation: Orientation,
    /// An index into [`SceneDescription::materials`].
    pub material: usize,
    /// The emission. None: the shape does not emit.
    pub area_light: Option<Arc<Entity>>,
    /// The media on its sides.
    pub medium: MediumInterface,
}

/// A named collection of shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectDescription {
    /// Its name.
    pub name: String,
    /// The shapes.
    pub shapes: Vec<ShapeDescription>,
    /// The name with its quotes.
    pub span: Span,
}

/// An instance of an object.
#[derive(Clone, Debug, PartialEq)]
pub struct InstanceDescription {
    /// An index into [`SceneDescription::objects`].
    pub object: usize,
    /// World from instance.
    pub transforms: Transforms,
    /// The name with its quotes.
    pub span: Span,
}

/// The media on the two sides of a surface. None: vacuum.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MediumInterface {
    /// The medium on the side away from the normal.
    pub inside: Option<MediumReference>,
    /// The medium on the side of the normal.
    pub outside: Option<MediumReference>,
}

/// The name of a medium; it may be defined later.
#[derive(Clone, Debug, PartialEq)]
pub struct MediumReference {
    /// The name.
    pub name: Arc<str>,
    /// The name with its quotes.
    pub span: Span,
}

/// The parameters of `Attribute` directives, by target.
#[derive(Clone, Debug, Default)]
pub(super) struct AttributeDefaults {
    pub(super) shape: Arc<Vec<Parameter>>,
    pub(super) light: Arc<Vec<Parameter>>,
    pub(super) material: Arc<Vec<Parameter>>,
    pub(super) medium: Arc<Vec<Parameter>>,
    pub(super) texture: Arc<Vec<Parameter>>,
}
