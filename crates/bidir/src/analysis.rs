//! Light paths that estimators miss: paths that none of their strategies makes, and paths that only hits by chance
//! find.
//!
//! In Heckbert's words, with S for a Dirac scattering, D for any other, L for a light and E for the
//! camera \[Heckbert90\]: a connection needs two neighbours without S. A light that no ray can hit, a
//! point or a direction, is therefore never seen along L S+ E nor, by a bidirectional estimator,
//! along L S+ D S+ E; next-event estimation alone already loses L S+ D. Lights that rays can hit are
//! found there by hits alone, the rarer the smaller the light is.

mod lists;

pub(crate) use lists::no_path;
pub use lists::{LostLight, lost_light};

use crate::integrator::IntegratorKind;
use crate::light::Light;
use crate::material::Material;
use crate::path::PathSettings;
use crate::scene::Scene;
use crate::view::View;

/// Light paths of a scene that an estimator does not make, or makes by chance only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlindSpot {
    /// L S+ D of lights that no ray hits.
    Caustics,
    /// L S+ E and L S+ D S+ E of lights that no ray hits.
    CausticsSeenBySpecular,
    /// S E: light that is seen in mirrors or through clear glass.
    SeenBySpecular,
    /// L E of a sky, seen by an orthographic camera.
    Sky,
    /// Endless media that emit.
    EndlessGlow,
    /// L S+ D of lights that rays can hit, only by hits.
    ChanceCaustics,
    /// L S+ D S+ E of lights that rays can hit, only by hits.
    ChanceCausticsSeenBySpecular,
}

impl BlindSpot {
    /// Returns true if the light is missing from pictures, not only noisy.
    pub const fn is_missing(self) -> bool {
        match self {
            Self::Caustics
            | Self::CausticsSeenBySpecular
            | Self::SeenBySpecular
            | Self::Sky
            | Self::EndlessGlow => true,
            Self::ChanceCaustics | Self::ChanceCausticsSeenBySpecular => false,
        }
    }

    /// Returns true if the missing paths may begin on `light`.
    pub fn concerns(self, light: &Light) -> bool {
        match self {
            Self::Caustics | Self::CausticsSeenBySpecular => light.is_delta(),
            Self::ChanceCaustics | Self::ChanceCausticsSeenBySpecular => !light.is_delta(),
            Self::Sky => matches!(light, Light::Infinite(_)),
            Self::EndlessGlow => light.is_endless(),
            Self::SeenBySpecular => true,
        }
    }

    /// Returns the least number of vertices of these paths.
    const fn shortest(self) -> usize {
        match self {
            Self::Sky | Self::EndlessGlow => 2,
            Self::CausticsSeenBySpecular | Self::SeenBySpecular => 3,
            Self::Caustics | Self::ChanceCaustics => 4,
            Self::ChanceCausticsSeenBySpecular => 5,
        }
    }

    /// Returns the estimators and strategies that find this light, as a clause.
    pub const fn remedy(self) -> &'static str {
        match self {
            Self::Caustics => "`light`, `bdpt`, `lvc` and `auto` find it by strategy t1",
            Self::CausticsSeenBySpecular => "no strategy finds it unless the lights have a size",
            Self::SeenBySpecular => {
                "`path`, `bdpt`, `lvc` and `auto` find it by strategies s0 and s1"
            }
            Self::Sky
            | Self::EndlessGlow
            | Self::ChanceCaustics
            | Self::ChanceCausticsSeenBySpecular => {
                "`path`, `bdpt`, `lvc` and `auto` find it by strategy s0"
            }
        }
    }

    /// Returns the blind spot, as a phrase.
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
            Self::EndlessGlow => "the light of media that glow and have no end",
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

/// Returns the blind spots of an estimator with all its strategies, in a scene. A material that is specular at a few
/// points only, or may be by the bounds of its textures, counts as mirrors and clear glass do.
pub fn blind_spots(scene: &Scene, view: &View, integrator: IntegratorKind) -> Vec<BlindSpot> {
    let lights = scene.lights();
    let has_specular = scene.materials_of_surfaces().any(Material::may_be_specular);
    let spots: &[BlindSpot] = match integrator {
        IntegratorKind::Path => &[BlindSpot::Caustics, BlindSpot::ChanceCaustics],
        IntegratorKind::Bdpt | IntegratorKind::Lvc | IntegratorKind::Auto => &[
            BlindSpot::CausticsSeenBySpecular,
            BlindSpot::ChanceCausticsSeenBySpecular,
        ],
        IntegratorKind::Light => &[
            BlindSpot::SeenBySpecular,
            BlindSpot::Sky,
            BlindSpot::EndlessGlow,
        ],
    };
    let is_parallel = view.camera().is_parallel();
    let is_there = |spot: &BlindSpot| {
        let is_possible = match spot {
            BlindSpot::Sky => is_parallel,
            BlindSpot::EndlessGlow => true,
            _ => has_specular,
        };
        is_possible && lights.iter().any(|light| spot.concerns(light))
    };
    spots.iter().copied().filter(is_there).collect()
}

/// Returns the light that is missing from images of `integrator` with paths as long as `settings` allow: those of its
/// [`blind_spots`] that are not made at all.
pub fn missing_light(
    scene: &Scene,
    view: &View,
    integrator: IntegratorKind,
    settings: &PathSettings,
) -> Vec<BlindSpot> {
    let mut spots = blind_spots(scene, view, integrator);
    spots.retain(|spot| spot.is_missing() && spot.shortest() <= settings.max_vertices());
    spots
}

#[cfg(test)]
mod tests;
