//! Whether two estimators could contradict each other.

use super::Plan;
use bidir::driver::Settings;
use formats::film::{SettingsText, has_influence};
use std::collections::BTreeMap;

impl Plan {
    /// True where the witness is the estimator of the picture but for its seed: it would agree whatever
    /// is wrong with both.
    pub fn is_its_own_witness(&self) -> bool {
        let [picture, witness] = self.estimators.each_ref().map(in_effect);
        picture == witness
    }
}

/// The settings that an estimator depends on but its seed, by name, with what is left to it decided.
fn in_effect(settings: &Settings) -> BTreeMap<String, String> {
    let mut settings = settings.clone();
    settings.decide();
    let mut texts = SettingsText::from(&settings).by_flag();
    texts.retain(|name, _| name != "seed" && has_influence(name, settings.integrator));
    texts
}
