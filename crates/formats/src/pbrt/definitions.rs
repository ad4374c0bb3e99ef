//! Names: definitions, uses before a definition, and names that are never defined.

use super::known;
use super::lexer::shorten;
use super::parser::Parser;
use super::scene::{Entity, MaterialDescription, ObjectDescription, TextureKind};
use crate::source::{Fault, Span};

impl Parser {
    /// Returns the material of a name, which may be defined later.
    pub(super) fn material_use(&mut self, name: &str, span: Span) -> usize {
        let materials = &mut self.scene.materials;
        let (index, _) = *self
            .materials
            .entry(known::normalized(name))
            .or_insert_with_key(|name| {
                materials.push(MaterialDescription {
                    name: Some(name.clone()),
                    entity: None,
                });
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
            let message = format!("the material `{}` is defined a second time", shorten(name));
            return Err(Fault::scene(span, message));
        }
        material.entity = Some(entity);
        self.materials
            .insert(known::normalized(name), (index, None));
        Ok(())
    }

    /// Returns the object of a name, which may be defined later.
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
            let message = format!("the object `{}` is defined a second time", shorten(&name));
            return Err(Fault::scene(span, message));
        }
        let index = self.object_use(&name, span);
        self.scene.objects[index].span = span;
        self.objects.insert(name, (index, None));
        self.object = Some(index);
        Ok(())
    }

    /// Registers a texture's name. False: it is defined already.
    pub(super) fn names_texture(&mut self, name: &str, kind: TextureKind) -> bool {
        self.texture_names.insert((kind, name.to_owned()))
    }

    /// Registers a medium's name. False: it is defined already.
    pub(super) fn names_medium(&mut self, name: &str) -> bool {
        self.medium_names.insert(name.to_owned())
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
                let fault = Fault::scene(span, format!("unknown {what} `{}`", shorten(name)));
                return Err(fault.with_nearest(name, defined.map(|(name, _)| name.as_str())));
            }
        }
        Ok(())
    }
}
