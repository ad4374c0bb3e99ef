//! The stages of a batch: each takes arrays that others left in it, and leaves arrays.

mod connect;
mod diffuse;
mod direct;
mod light_ends;
mod light_image;
mod media;
mod pairs;
mod trace;
mod walk;

pub(super) use connect::connect;
pub(super) use direct::direct;
pub(super) use light_ends::{LightEnds, draw_cached, next_events, own_light};
pub(super) use light_image::{Weighting, lens_vertex, light_image};
pub(super) use media::TracedShadow;
pub(super) use trace::{select, shadow_rays};
pub(crate) use walk::camera_ray;
pub(super) use walk::{hits, sum_camera, sum_light, walk_camera, walk_light};
