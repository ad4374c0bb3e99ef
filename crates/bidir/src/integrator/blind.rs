//! What estimators cannot see: light paths that none of their strategies makes, and those that only
//! chance finds.
//!
//! In Heckbert's words, with S for a Dirac scattering, D for any other, L for a light and E for the
//! camera \[Heckbert90\]: a connection needs two neighbours without S. A light that no ray can hit, a
//! point or a direction, is therefore never seen along L S+ E nor, by a bidirectional estimator,
//! along L S+ D S+ E; next-event estimation alone already loses L S+ D. Lights that rays can hit are
//! found there by hits alone, the rarer the smaller the light is.

mod lists;

pub(crate) use lists::no_path;
pub use lists::{LostLight, lost_light};

use super::IntegratorKind;
use crate::camera::Camera;
use crate::light::Light;
use crate::material::Material;
use crate::scene::Scene;

/// Light paths of a scene that an estimator does not make, or makes by chance only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlindSpot {
    /// L S+ D of lights that no ray hits.
    Caustics,
    /// L S+ E and L S+ D S+ E of lights that no ray hits.
    CausticsSeenBySpecular,
    /// S E: whatever is seen in mirrors or through clear glass.
    SeenBySpecular,
    /// L E of a sky that parallel rays see.
    Sky,
    /// L S+ D of lights that rays hit: by hits alone.
    ChanceCaustics,
    /// L S+ D S+ E of lights that rays hit: by hits alone.
    ChanceCausticsSeenBySpecular,
}

impl BlindSpot {
    /// True where the light is missing from pictures, and not only noisy.
    pub const fn is_missing(self) -> bool {
        match self {
            Self::Caustics | Self::CausticsSeenBySpecular | Self::SeenBySpecular | Self::Sky => {
                true
            }
            Self::ChanceCaustics | Self::ChanceCausticsSeenBySpecular => false,
        }
    }

    /// What it is, as a phrase.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Caustics => "caustics of point, spot, distant and hidden lights (L S+ D)",
            Self::CausticsSeenBySpecular => {
                "point, spot, distant and hidden lights seen in mirrors or clear glass (L S+ E), \
                 and \
                 their caustics seen there (L S+ D S+ E)"
            }
            Self::SeenBySpecular => "everything seen in mirrors or through clear glass (S E)",
            Self::Sky => "the sky in view of a camera with parallel rays (L E)",
            Self::ChanceCaustics => {
                "caustics (L S+ D): only camera paths that hit the light find them"
            }
            Self::ChanceCausticsSeenBySpecular => {
                "caustics seen in mirrors or through clear glass (L S+ D S+ E): only camera \
                 paths that \
                 hit the light find them"
            }
        }
    }
}

/// The blind spots of an estimator with all its strategies, in a scene. What is specular at a few points
/// only, or may be by the bounds of its textures, counts as mirrors and clear glass do.
pub fn blind_spots(scene: &Scene, integrator: IntegratorKind) -> Vec<BlindSpot> {
    let lights = scene.lights();
    let has_specular = scene.materials_of_surfaces().any(Material::may_be_specular);
    let of_specular: &[(bool, BlindSpot)] = match integrator {
        IntegratorKind::Path => &[
            (true, BlindSpot::Caustics),
            (false, BlindSpot::ChanceCaustics),
        ],
        IntegratorKind::Bdpt | IntegratorKind::Lvc | IntegratorKind::Auto => &[
            (true, BlindSpot::CausticsSeenBySpecular),
            (false, BlindSpot::ChanceCausticsSeenBySpecular),
        ],
        IntegratorKind::Light => &[],
    };
    let has_light = |is_delta| lights.iter().any(|light| light.is_delta() == is_delta);
    let mut spots: Vec<_> = of_specular
        .iter()
        .filter(|(is_delta, _)| has_specular && has_light(*is_delta))
        .map(|(_, spot)| *spot)
        .collect();
    if integrator == IntegratorKind::Light {
        let has_sky = lights
            .iter()
            .any(|light| matches!(light, Light::Infinite(_)));
        let is_parallel = matches!(scene.camera(), Camera::Orthographic(_));
        spots.extend(has_specular.then_some(BlindSpot::SeenBySpecular));
        spots.extend((has_sky && is_parallel).then_some(BlindSpot::Sky));
    }
    spots
}

#[cfg(test)]
mod tests;
