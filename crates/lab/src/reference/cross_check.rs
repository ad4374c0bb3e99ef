//! Whether two estimators could contradict each other.

use super::Plan;
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::settings::Request;

impl Plan {
    /// True where the cross_check is, or by `auto` may be, the estimator of the picture but for its seed: it
    /// would agree whatever is wrong with both.
    pub fn is_its_own_cross_check(&self) -> bool {
        let [picture, cross_check] = &self.estimators;
        let may_be = may_become(picture, cross_check) || may_become(cross_check, picture);
        may_be || in_effect(picture) == in_effect(cross_check)
    }
}

/// True where one that may choose takes what the other does.
fn may_become(auto: &Settings, other: &Settings) -> bool {
    auto.integrator == IntegratorKind::Auto && other.integrator != IntegratorKind::Light
}

/// The settings that an estimator depends on, but its seed.
fn in_effect(settings: &Settings) -> Request {
    Request {
        seed: None,
        ..Request::of(settings)
    }
}
