//! Lamps: the lights of a scene with their places in its file.

use bidir::light::Light;
use bidir::scene::Scene;
use std::ops::Range;

/// Maximum number of lamps with a place, because the time to find a place is proportional to the length of the text.
const MOST: usize = 3;

/// A lamp of a file that no ray can hit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lamp {
    /// The place of the lamp in the file, as `file:line:column`.
    pub place: String,
    /// The index of the lamp's first light.
    pub light: u32,
}

/// The place of a lamp, and the indices of its lights: several if it has several parts, none if it has no triangle.
pub(crate) type Placed<P> = (P, Range<u32>);

/// Returns the first lamps, at most [`MOST`], that have a light no ray can hit, each with its place as `text` writes
/// it.
pub(crate) fn unhittable<P>(
    scene: &Scene,
    lamps: &[Placed<P>],
    text: impl Fn(&P) -> String,
) -> Vec<Lamp> {
    let is_delta = |light: u32| scene.lights()[light as usize].is_delta();
    let found = lamps
        .iter()
        .filter(|(_, lights)| lights.clone().any(is_delta));
    let lamp = |(place, lights): &Placed<P>| Lamp {
        place: text(place),
        light: lights.start,
    };
    found.take(MOST).map(lamp).collect()
}

/// Returns the warning that the lamp with these lights gives no light. None: it gives light.
pub(crate) fn dark_warning(scene: &Scene, lights: Range<u32>) -> Option<String> {
    let lights = &scene.lights()[lights.start as usize..lights.end as usize];
    let context = scene.light_context();
    let kind = lights.first().map_or("area", Light::kind);
    let is_dark = |light: &Light| light.power(&context) <= 0.0;
    if !lights.iter().all(is_dark) {
        return None;
    }
    let has_no_area = |light: &Light| matches!(light, Light::Area(light) if !light.has_area());
    let lacks = if lights.iter().all(has_no_area) {
        "area"
    } else {
        "power"
    };
    Some(format!(
        "the {kind} light has no {lacks}: it adds nothing to the image"
    ))
}
