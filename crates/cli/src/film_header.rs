//! The headers of film files; their contents are defined in [`formats::film`].

use crate::scene_io::{FilmHeader, LoadedScene};
use bidir::driver::{Settings, Training};
use formats::film::SceneIdentity;

pub(crate) use formats::film::{counts_by_name, metadata, of_run, training_samples, untrained};

/// Returns the header of an empty film of the scene `name`.
pub(crate) fn header(
    name: &str,
    loaded: &LoadedScene,
    settings: &Settings,
    training: Option<&Training>,
) -> FilmHeader {
    let scene = SceneIdentity {
        name,
        digest: &loaded.digest,
        film: loaded.view.film(),
    };
    scene.header(settings, training)
}
