//! The graphics state, which directives change for later directives.

use super::scene::{AttributeDefaults, ColorSpace, Entity, MediumInterface};
use super::transform::{Active, Transforms};
use crate::source::Span;
use bidir::shape::Orientation;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The graphics state, which blocks save at their beginning and restore at their end.
#[derive(Clone, Debug, Default)]
pub(super) struct GraphicsState {
    pub(super) transforms: Transforms,
    pub(super) active: Active,
    pub(super) color_space: ColorSpace,
    pub(super) orientation: Orientation,
    /// An index into the materials; 0 is the default material.
    pub(super) material: usize,
    pub(super) area_light: Option<Arc<Entity>>,
    pub(super) medium: MediumInterface,
    pub(super) defaults: AttributeDefaults,
}

/// The directive that opened a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Opener {
    Attribute,
    Transform,
    Object,
}

impl Opener {
    /// Returns the directives that open and close such a block.
    pub(super) fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Attribute => ("AttributeBegin", "AttributeEnd"),
            Self::Transform => ("TransformBegin", "TransformEnd"),
            Self::Object => ("ObjectBegin", "ObjectEnd"),
        }
    }
}

/// An open block, with the state to restore at its end.
#[derive(Clone, Debug)]
pub(super) struct OpenBlock {
    pub(super) opener: Opener,
    pub(super) span: Span,
    pub(super) saved: GraphicsState,
}

/// The state of one file and of the files that it includes. An imported file has its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    pub(super) state: GraphicsState,
    pub(super) blocks: Vec<OpenBlock>,
    pub(super) coordinate_systems: BTreeMap<String, Transforms>,
}
