//! Lights of KHR_lights_punctual. Photometric units are used as radiometric ones, as everywhere in the
//! file: candela as radiant intensity, lux as irradiance.

use super::document::Context;
use super::json::Light as Described;
use super::node::Nodes;
use super::place::{GltfFault, Place};
use crate::import::check_point;
use bidir::light::{DistantLight, Light, PointLight, SpotLight};
use bidir::math::Vec3;
use glam::{DAffine3, DVec3};

/// Builds the lights of the scene with their places, in the order of its nodes.
pub(super) fn all(
    context: &mut Context<'_>,
    nodes: &Nodes,
) -> Result<Vec<(Place, Light)>, GltfFault> {
    let document = context.document;
    let mut lights = Vec::new();
    for &index in &nodes.order {
        let node = &document.root.nodes[index];
        let Some(named) = node.extensions.light.as_ref().and_then(|light| light.light) else {
            continue;
        };
        let place = Place::of("nodes", index).extension("KHR_lights_punctual");
        let render_from_node = nodes.render_from_node[index].unwrap_or(DAffine3::IDENTITY);
        let light = build(context, named, &place, &render_from_node)?;
        lights.push((place, light));
    }
    Ok(lights)
}

fn build(
    context: &mut Context<'_>,
    index: usize,
    user: &Place,
    render_from_node: &DAffine3,
) -> Result<Light, GltfFault> {
    let lights = context.document.root.extensions.lights.as_ref();
    let all = lights.map_or(&[][..], |lights| &lights.lights);
    let described = user.find(all, index, "light")?;
    let place = Place::TOP
        .extension("KHR_lights_punctual")
        .key("lights")
        .index(index);
    let power = power(described, &place)?;
    let intensity = power.map(|channel| context.layout.space.intensity(channel));
    if described.range.is_some() {
        context.warn(
            place.clone(),
            "the `range` of a light has no effect: light falls off with the square of the distance",
        );
    }
    let position = render_from_node.translation.as_vec3();
    let ahead = render_from_node.transform_vector3(DVec3::NEG_Z);
    let axis = ahead.normalize_or(DVec3::NEG_Z).as_vec3();
    check_point(render_from_node.translation, user)?;
    match described.kind.as_str() {
        "directional" => Ok(Light::Distant(DistantLight {
            to_light: -axis,
            irradiance: power.into(),
        })),
        "point" => Ok(Light::Point(PointLight {
            position,
            intensity: intensity.into(),
        })),
        "spot" => spot(described, &place, position, axis, intensity).map(Light::Spot),
        other => {
            let fault = place
                .key("type")
                .scene(format!("unknown light type `{other}`"));
            Err(fault.with_nearest(other, ["directional", "point", "spot"]))
        }
    }
}

/// Returns the intensity or irradiance in each channel.
fn power(described: &Described, place: &Place) -> Result<[f32; 3], GltfFault> {
    let intensity = described.intensity.unwrap_or(1.0);
    let color = described.color.unwrap_or([1.0; 3]);
    let power = color.map(|channel| channel * intensity);
    let is_light = |channel: &f32| channel.is_finite() && *channel >= 0.0;
    if power.iter().all(is_light) {
        return Ok(power);
    }
    Err(place.scene(format!("the intensity {power:?} is invalid")))
}

fn spot(
    described: &Described,
    place: &Place,
    position: Vec3,
    axis: Vec3,
    intensity: [f32; 3],
) -> Result<SpotLight, GltfFault> {
    let cone = described.spot.as_ref();
    let inner = cone.and_then(|cone| cone.inner_cone_angle).unwrap_or(0.0);
    let given = cone.and_then(|cone| cone.outer_cone_angle);
    let outer = given.unwrap_or(std::f32::consts::FRAC_PI_4);
    if !(inner >= 0.0 && inner <= outer && outer > 1e-4 && outer < 1.58) {
        let message =
            format!("the cone angles {inner} and {outer} are invalid: 0 <= inner < outer <= pi/2");
        return Err(place.key("spot").scene(message));
    }
    Ok(SpotLight::squared(
        position,
        axis,
        intensity,
        [inner, outer],
    ))
}
