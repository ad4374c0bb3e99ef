//! Whose film it is, by the names of this command; what is said is the library's business.

use crate::scene_io::{FilmHeader, LoadedScene};
use bidir::driver::{Settings, Training};
use formats::film::SceneIdentity;

pub(crate) use formats::film::{counts_by_name, is_short, metadata, of_run, untrained};

/// The header of an empty film of the scene that is called `name`.
pub(crate) fn header(
    name: &str,
    loaded: &LoadedScene,
    settings: &Settings,
    training: Option<&Training>,
) -> FilmHeader {
    let scene = SceneIdentity {
        name,
        digest: &loaded.digest,
        film: loaded.scene.film(),
    };
    scene.header(settings, training)
}
