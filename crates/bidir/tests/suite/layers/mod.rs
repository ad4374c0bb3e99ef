//! The images that a film keeps beside the picture: known features of a plane, parts that add up, and
//! groups of lights that equal the images of the lights alone.

mod films;
mod groups;
mod lit_room;
mod plane;
mod strategies;

use crate::common::prelude::*;
use bidir::film::{Aov, LayerImage};

/// Everything that is known of the first surface, and how it was rendered but for the time.
pub(crate) const FEATURES: [Aov; 9] = [
    Aov::Albedo,
    Aov::Position,
    Aov::Normal,
    Aov::ShadingNormal,
    Aov::Depth,
    Aov::Coverage,
    Aov::Samples,
    Aov::Variance,
    Aov::Rays,
];

pub(crate) fn settings(integrator: IntegratorKind, layers: Layers) -> Settings {
    Settings {
        layers,
        ..Settings::new(integrator)
    }
}

pub(crate) fn layer<'a>(images: &'a [LayerImage], name: &str, channel: &str) -> &'a LayerImage {
    let is_it = |image: &&LayerImage| image.name == name && image.channels[0] == channel;
    images.iter().find(is_it).expect("the layer is kept")
}
