//! Whether two estimators could contradict each other.

use super::Plan;
use bidir::driver::Settings;
use bidir::integrator::{Candidates, IntegratorKind};
use bidir::path::PathRoulette;
use bidir::select::ShadowRays;
use formats::film::SettingsText;
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
    let kind = settings.integrator;
    let (usual, mut settings) = (Settings::default(), settings.clone());
    if settings.path.roulette == PathRoulette::Suited {
        settings.path.roulette = kind.roulette();
    }
    if settings.shadow_rays == ShadowRays::Suited {
        settings.shadow_rays = kind.shadow_rays();
    }
    if settings.lvc.candidates == Candidates::Suited {
        settings.lvc.candidates = kind.candidates();
    }
    if !matches!(kind, IntegratorKind::Lvc | IntegratorKind::Auto) {
        settings.lvc = usual.lvc;
    }
    if !kind.has_candidates() {
        settings.shadow_rays = usual.shadow_rays;
        settings.path.strategies = usual.path.strategies;
        settings.path.light_point = usual.path.light_point;
    }
    if kind == IntegratorKind::Light {
        settings.path.mis = usual.path.mis;
        settings.path.light_choice = usual.path.light_choice;
    }
    settings.layers = usual.layers;
    settings.seed = 0;
    SettingsText::from(&settings).by_flag()
}
