//! Settings of methods, under the names of the flags of `bidir render`. Seeds are the experiment's.

use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
use std::collections::BTreeMap;

/// The names of the settings that a method may have.
pub fn names() -> Vec<String> {
    Request::names().filter(|name| name != "seed").collect()
}

/// The message for a setting without effect on an integrator.
pub(super) fn no_effect(name: &str, integrator: IntegratorKind) -> String {
    format!("`{name}` has no effect on the integrator `{integrator}`")
}

/// The settings that an image depends on, but its seed, by the names of flags.
pub fn texts(settings: &Settings) -> BTreeMap<String, String> {
    let request = Request {
        seed: None,
        ..Request::of(settings)
    };
    request.texts()
}
