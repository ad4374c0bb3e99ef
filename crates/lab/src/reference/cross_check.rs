//! A check that the two estimators of a reference differ.

use super::Plan;
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;

impl Plan {
    /// Returns true if both estimators are equal except for their seeds, or may become equal by `auto`: such
    /// a cross-check cannot detect an error.
    pub fn is_its_own_cross_check(&self) -> bool {
        let [picture, cross_check] = &self.estimators;
        let may_be = may_become(picture, cross_check) || may_become(cross_check, picture);
        may_be || in_effect(picture) == in_effect(cross_check)
    }
}

/// Returns true if `auto` may choose the integrator of the other.
fn may_become(auto: &Settings, other: &Settings) -> bool {
    auto.integrator == IntegratorKind::Auto && other.integrator != IntegratorKind::Light
}

/// Returns the settings that an estimator depends on, except its seed.
fn in_effect(settings: &Settings) -> Request {
    Request {
        seed: None,
        ..Request::of(settings)
    }
}
