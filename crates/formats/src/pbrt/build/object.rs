//! Objects and their instances.
//!
//! The shapes of an object with one instance are added to the world. An object with several instances is
//! shared: its shapes are kept once, and rays are transformed to its space. Its shapes that emit are copied
//! to the world for each instance; the format does not define their effect.

use super::Builder;
use super::context::Context;
use crate::import::Group;
use crate::pbrt::scene::{InstanceDescription, ObjectDescription};
use crate::source::Fault;
use glam::DAffine3;

impl Builder<'_> {
    pub(super) fn add_objects(&mut self, context: &mut Context<'_>) -> Result<(), Fault> {
        let description = context.document;
        self.assembly.summary.instances = description.instances.len();
        for instance in &description.instances {
            if instance.transforms.is_animated() {
                let substitute = "its first position is used";
                context.unsupported(instance.span, "a moving object", substitute)?;
            }
        }
        let mut instances = vec![Vec::new(); description.objects.len()];
        for instance in &description.instances {
            instances[instance.object].push(instance);
        }
        for (object, instances) in description.objects.iter().zip(&instances) {
            self.add_object(context, object, instances)?;
        }
        Ok(())
    }

    fn add_object(
        &mut self,
        context: &mut Context<'_>,
        object: &ObjectDescription,
        instances: &[&InstanceDescription],
    ) -> Result<(), Fault> {
        let place = |it: &&InstanceDescription| context.place(&it.transforms);
        let places: Vec<DAffine3> = instances.iter().map(place).collect();
        let mut group = Group::new(&places);
        for shape in &object.shapes {
            if let Some(light) = &shape.area_light {
                let message = "a shape of an object emits: it becomes a light at every instance";
                context.warn(light.span, message);
            }
            if places.is_empty() {
                continue;
            }
            let destination = match shape.area_light {
                Some(_) => group.copied(),
                None => self.assembly.shared(context, &mut group),
            };
            self.add_shape(context, shape, destination)?;
        }
        let span = |i: usize| instances[i].span;
        self.assembly.add_instances(context, &group, span).map(drop)
    }
}
