//! The errors of building a scene.

use crate::medium::MediumId;
use thiserror::Error;

/// The reasons why a scene cannot be built.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    /// A triangle refers to a vertex that its mesh does not have.
    #[error("triangle {triangle} refers to vertex {vertex}, but the mesh has {vertices} vertices")]
    VertexIndex {
        /// The shape, in the order of addition.
        shape: usize,
        /// The triangle of the mesh.
        triangle: usize,
        /// The vertex it refers to.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A mesh has normals, tangents or parameters, but not one per vertex.
    #[error("the mesh has {vertices} vertices, but {count} {what}")]
    AttributeCount {
        /// The shape, in the order of addition.
        shape: usize,
        /// The number of vertices.
        vertices: usize,
        /// The number of values.
        count: usize,
        /// The name of the attribute.
        what: &'static str,
    },
    /// A coordinate is NaN or infinite, or a size overflows.
    #[error("a coordinate of the shape is not finite")]
    NotFinite {
        /// The shape, in the order of addition.
        shape: usize,
    },
    /// An instance has a map without inverse, or nearly without, or reaches too far.
    #[error(
        "the transformation of the instance has no inverse, or nearly none, or reaches too far"
    )]
    Instance {
        /// The instance, in the order of addition.
        instance: usize,
    },
    /// There are more media than [`MediumId`] can number. can name.
    #[error("the scene has {count} media; at most {most} are possible", most = MediumId::MOST)]
    TooManyMedia {
        /// How many.
        count: usize,
    },
    /// The intersector refuses the scene: too many primitives, or instructions that the machine lacks.
    #[error("the scene cannot be traced: {0}")]
    Intersector(String),
}

impl SceneError {
    /// Returns the shape at fault, in the order of addition.
    pub fn shape(&self) -> Option<usize> {
        match self {
            Self::VertexIndex { shape, .. }
            | Self::AttributeCount { shape, .. }
            | Self::NotFinite { shape } => Some(*shape),
            Self::Instance { .. } | Self::TooManyMedia { .. } | Self::Intersector(_) => None,
        }
    }
}
