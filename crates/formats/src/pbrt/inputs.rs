//! The files that a scene names, including those in parts that are not used or that a substitute replaces.

use super::scene::{Entity, SceneDescription, ShapeDescription};
use std::collections::BTreeSet;
use std::path::PathBuf;

impl SceneDescription {
    /// Returns the files that parameters may name, except the film's, which is an output. Every string
    /// with a dot counts as the name of a file.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        let named: BTreeSet<_> = self.entities().flat_map(strings).collect();
        named.into_iter().map(|name| self.resolve(name)).collect()
    }

    /// Returns all entities whose parameters can name files.
    fn entities(&self) -> impl Iterator<Item = &Entity> {
        let camera = self.camera.iter().map(|camera| &camera.entity);
        let materials = self.materials.iter().filter_map(|m| m.entity.as_ref());
        let textures = self.textures.iter().map(|texture| &texture.entity);
        let media = self.media.iter().map(|medium| &medium.entity);
        let lights = self.lights.iter().map(|light| &light.entity);
        let of_objects = self.objects.iter().flat_map(|object| &object.shapes);
        let shapes = self.shapes.iter().chain(of_objects);
        camera
            .chain(materials)
            .chain(textures)
            .chain(media)
            .chain(lights)
            .chain(shapes.flat_map(of_shape))
    }
}

fn of_shape(shape: &ShapeDescription) -> impl Iterator<Item = &Entity> {
    std::iter::once(&shape.entity).chain(shape.area_light.as_deref())
}

/// Returns the strings of an entity's parameters that may be names of files.
fn strings(entity: &Entity) -> impl Iterator<Item = &str> {
    let parameters = &entity.parameters;
    let all = parameters.explicit.iter().chain(&*parameters.defaults);
    let texts = all.flat_map(|parameter| parameter.values.strings());
    texts.map(String::as_str).filter(|text| text.contains('.'))
}
