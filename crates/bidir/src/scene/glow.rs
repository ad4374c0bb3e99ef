//! Media of a scene that emit light.

use super::{Scene, Surface};
use crate::light::{Light, LightPoint, VolumeLight};
use crate::medium::{Medium, MediumId};
use crate::shape::Shape;
use accel::Aabb;

/// The parts of an unfinished scene that determine where media are.
pub(super) struct Surroundings<'a> {
    pub(super) shapes: &'a [Shape],
    pub(super) surfaces: &'a [Surface],
    /// The shapes of each object.
    pub(super) objects: &'a [Vec<usize>],
    /// A box around everything.
    pub(super) bounds: Aabb,
}

impl Surroundings<'_> {
    /// Makes the distributions of points of all media that are lights.
    pub(super) fn place_glows(&self, lights: &mut [Light], media: &[Medium]) {
        for light in lights {
            if let Light::Volume(volume) = light {
                let id = volume.medium();
                let medium = id.index().and_then(|index| media.get(index));
                if let Some(medium) = medium {
                    *volume = VolumeLight::new(id, medium, self.bounds_of(id));
                }
            }
        }
    }

    /// Returns a box around the shapes that bound the medium. None: there are none.
    fn bounds_of(&self, id: MediumId) -> Option<Aabb> {
        let ends_at = |&shape: &usize| {
            let sides = self.surfaces[shape].sides;
            sides.is_some_and(|sides| sides.outside == id || sides.inside == id)
        };
        if self.objects.iter().flatten().any(ends_at) {
            return Some(self.bounds);
        }
        let shapes = (0..self.shapes.len()).filter(ends_at);
        let boxes = shapes.flat_map(|shape| {
            let shape = &self.shapes[shape];
            (0..shape.primitive_count()).map(|i| shape.primitive(i).bounds())
        });
        boxes.reduce(Aabb::union)
    }
}

/// Returns the index of the light of each medium. None: the medium emits nothing.
pub(super) fn lights_of(media: &[Medium], lights: &[Light]) -> Vec<Option<u32>> {
    let mut glows = vec![None; media.len()];
    for (number, light) in lights.iter().enumerate() {
        if let Light::Volume(volume) = light
            && let Some(glow) = volume.medium().index().and_then(|i| glows.get_mut(i))
        {
            *glow = Some(number as u32);
        }
    }
    glows
}

impl Scene {
    /// Marks the light of the medium around everything as endless.
    pub(super) fn note_endless_glow(&mut self) {
        let around = self.around;
        let (Some(light), Some(index)) = (self.glow(around), around.index()) else {
            return;
        };
        if let Light::Volume(volume) = &mut self.lights[light as usize] {
            volume.set_around(&self.media[index]);
        }
    }

    /// Returns the index of the light of a medium. None: it emits nothing.
    #[inline]
    pub(crate) fn glow(&self, id: MediumId) -> Option<u32> {
        self.glows[id.index()?]
    }

    /// Returns true if the light exists at its point `at`: an emitting medium ends where another begins.
    #[inline]
    pub(crate) fn is_lit(&self, light: &Light, at: &LightPoint) -> bool {
        match light {
            Light::Volume(light) => self.medium_at(at.locus.point) == light.medium(),
            _ => true,
        }
    }
}
