//! Names: definitions, uses before a definition, and names that are never defined.

use super::known;
use super::lexer::shorten;
use super::parser::Parser;
use super::scene::{Entity, MaterialDescription, ObjectDescription};
use crate::source::{Fault, Span};

/// Returns the fault of a second definition of a name.
pub(super) fn defined_again(span: Span, what: &str, name: &str) -> Fault {
    let message = format!("the {what} `{}` is defined a second time", shorten(name));
    Fault::scene(span, message)
}

impl Parser {
    /// Returns the index of the material of this name, which may be defined later.
    pub(super) fn material_use(&mut self, name: &str, span: Span) -> usize {
        let materials = &mut self.scene.materials;
        let (index, _) = *self
            .materials
            .entry(known::normalized(name))
            .or_insert_with_key(|name| {
                let (name, entity) = (Some(name.clone()), None);
                materials.push(MaterialDescription { name, entity });
                (materials.len() - 1, Some(span))
            });
        index
    }

    pub(super) fn material_define(
        &mut self,
        name: &str,
        span: Span,
        entity: Entity,
    ) -> Result<(), Fault> {
        let index = self.material_use(name, span);
        let material = &mut self.scene.materials[index];
        if material.entity.is_some() {
            return Err(defined_again(span, "material", name));
        }
        material.entity = Some(entity);
        self.materials
            .insert(known::normalized(name), (index, None));
        Ok(())
    }

    /// Returns the index of the object of this name, which may be defined later.
    pub(super) fn object_use(&mut self, name: &str, span: Span) -> usize {
        let objects = &mut self.scene.objects;
        let (index, _) = *self
            .objects
            .entry(known::normalized(name))
            .or_insert_with_key(|name| {
                objects.push(ObjectDescription {
                    name: name.clone(),
                    shapes: Vec::new(),
                    span,
                });
                (objects.len() - 1, Some(span))
            });
        index
    }

    pub(super) fn object_begin(&mut self, name: &str, span: Span) -> Result<(), Fault> {
        if self.object.is_some() {
            return Err(Fault::scene(span, "an object is defined within an object"));
        }
        let name = known::normalized(name);
        if let Some((_, None)) = self.objects.get(&name) {
            return Err(defined_again(span, "object", &name));
        }
        let index = self.object_use(&name, span);
        self.scene.objects[index].span = span;
        self.objects.insert(name, (index, None));
        self.object = Some(index);
        Ok(())
    }

    /// Refuses names that were used and never defined.
    pub(super) fn check_defined(&self) -> Result<(), Fault> {
        let tables = [("material", &self.materials), ("object", &self.objects)];
        for (what, table) in tables {
            let undefined = table
                .iter()
                .find_map(|(name, &(_, span))| Some((name, span?)));
            if let Some((name, span)) = undefined {
                let defined = table.iter().filter(|(_, (_, span))| span.is_none());
                let names = defined.map(|(name, _)| name.as_str());
                return Err(known::unknown(span, what, name, names));
            }
        }
        Ok(())
    }
}
