//! Whether two estimators could contradict each other.

use super::Plan;
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use formats::film::{SettingsText, has_influence};
use std::collections::BTreeMap;

impl Plan {
    /// True where the witness is, or by `auto` may be, the estimator of the picture but for its seed: it
    /// would agree whatever is wrong with both.
    pub fn is_its_own_witness(&self) -> bool {
        let [picture, witness] = &self.estimators;
        let may_be = may_become(picture, witness) || may_become(witness, picture);
        may_be || in_effect(picture) == in_effect(witness)
    }
}

/// True where one that may choose takes what the other does.
fn may_become(auto: &Settings, other: &Settings) -> bool {
    auto.integrator == IntegratorKind::Auto && other.integrator != IntegratorKind::Light
}

/// The settings that an estimator depends on but its seed, by name, with what is left to it decided.
fn in_effect(settings: &Settings) -> BTreeMap<String, String> {
    let mut settings = settings.clone();
    settings.decide();
    let mut texts = SettingsText::from(&settings).by_flag();
    texts.retain(|name, _| name != "seed" && has_influence(name, settings.integrator));
    texts
}
