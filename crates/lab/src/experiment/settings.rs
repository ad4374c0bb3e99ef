//! Settings of methods, by the names of the flags of `bidir render`. The experiment sets the seeds.

use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;
use std::collections::BTreeMap;

/// Returns the names of the settings that a method can have.
pub fn names() -> Vec<String> {
    Request::names().filter(|name| name != "seed").collect()
}

/// Returns the message for a setting without effect on an integrator.
pub(super) fn no_effect(name: &str, integrator: IntegratorKind) -> String {
    format!("`{name}` has no effect on the integrator `{integrator}`")
}

/// Returns the settings that an image depends on, except the seed, by the names of flags.
pub fn texts(settings: &Settings) -> BTreeMap<String, String> {
    let request = Request {
        seed: None,
        ..Request::of(settings)
    };
    request.texts()
}
