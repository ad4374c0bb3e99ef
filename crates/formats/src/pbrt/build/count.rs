//! Counts the shapes and vertices of a scene, and checks the limits before they are made.

use super::Assembly;
use super::context::Context;
use super::emission::AreaEmission;
use super::shape::Geometry;
use crate::pbrt::scene::Entity;
use crate::source::{Fault, Span};
use std::sync::Arc;

impl Assembly<'_> {
    /// Counts a shape with its number of places.
    pub(super) fn count(
        &mut self,
        context: &Context<'_>,
        (geometry, emission): (&Geometry, Option<&AreaEmission>),
        copies: u64,
        span: Span,
    ) -> Result<(), Fault> {
        self.summary.primitives += geometry.primitives() * copies;
        self.vertices += geometry.vertices() * copies;
        context.check_size(self.summary.primitives.max(self.vertices), span)?;
        let parts = emission.map_or(1, |emission| emission.part_count(geometry));
        context.check_shapes(self.summary.shapes as u64 + parts * copies, span)
    }

    /// Reads the emission of a shape. Shapes that follow an `AreaLightSource` share it, and its image.
    pub(super) fn emission(
        &mut self,
        context: &mut Context<'_>,
        entity: &Arc<Entity>,
    ) -> Result<Arc<AreaEmission>, Fault> {
        match &self.last_emission {
            Some((known, emission)) if Arc::ptr_eq(known, entity) => Ok(Arc::clone(emission)),
            _ => {
                let emission = Arc::new(AreaEmission::read(context, entity)?);
                self.last_emission = Some((Arc::clone(entity), Arc::clone(&emission)));
                Ok(emission)
            }
        }
    }
}
