//! The estimators, and what stands for each idea: a line adds one.

use super::plan::LightTracing;
use crate::experiment::texts;
use bidir::driver::Settings;
use bidir::settings::Request;

/// Every connection of a pair of subpaths is traced: what gains are over.
pub(super) const BASELINE: &str = "bdpt all";
/// Paths from the camera alone.
pub(super) const PATH: &str = "path";
/// Light subpaths of many samples, with the settings that they have by default.
pub(super) const SHARED: &str = "lvc";
/// What chooses by itself.
pub(super) const AUTO: &str = "auto";
/// What is left out where it misses light paths.
const LIGHT: &str = "light";

/// What a variant is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// It is compared with all others, in equal time and at equal rays.
    Estimator,
    /// It is compared with the one that it is a variant of.
    Idea {
        idea: &'static str,
        /// The name of that one.
        of: &'static str,
    },
}

/// A way to render.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variant {
    pub(super) name: &'static str,
    pub(super) role: Role,
    /// Settings, as flags of `bidir render`; all others have their defaults.
    settings: &'static [(&'static str, &'static str)],
}

const fn estimator(
    name: &'static str,
    settings: &'static [(&'static str, &'static str)],
) -> Variant {
    Variant {
        name,
        role: Role::Estimator,
        settings,
    }
}

const fn variant(
    idea: &'static str,
    of: &'static str,
    name: &'static str,
    settings: &'static [(&'static str, &'static str)],
) -> Variant {
    Variant {
        name,
        role: Role::Idea { idea, of },
        settings,
    }
}

const PROPOSALS: &str = "Proposals, uniform or learnt";
const EMISSION: &str = "Light subpaths start by power instead of learnt probabilities";
const LIGHT_POINTS: &str = "Light points for the first camera vertex and those behind it";
const SUBPATHS: &str = "Samples for each light subpath";
const CANDIDATES: &str = "Candidates for the first camera vertex and those behind it";
const SELECTORS: &str = "Shadow-ray selectors";
const COUNTS: &str = "Sample counts in the weights";
const LIGHTS: &str = "Choice of the light, by power instead of the tree";

/// All variants; a base stands before its variants.
#[rustfmt::skip]
const VARIANTS: &[Variant] = &[
    estimator(BASELINE, &[("integrator", "bdpt"), ("shadow-rays", "all")]),
    estimator(PATH, &[("integrator", "path")]),
    estimator("bdpt", &[("integrator", "bdpt")]),
    estimator(LIGHT, &[("integrator", "light")]),
    estimator(SHARED, &[("integrator", "lvc")]),
    estimator(AUTO, &[("integrator", "auto")]),

    variant(PROPOSALS, SHARED, "lvc uniform", &[("integrator", "lvc"), ("proposal", "uniform")]),
    variant(PROPOSALS, SHARED, "lvc learned", &[("integrator", "lvc"), ("proposal", "learned")]),

    variant(EMISSION, SHARED, "lvc light start by power", &[("integrator", "lvc"), ("light-start", "power")]),

    variant(LIGHT_POINTS, SHARED, "lvc 1 light point", &[("integrator", "lvc"), ("next-events", "1")]),
    variant(LIGHT_POINTS, SHARED, "lvc 4 light points, then 1", &[("integrator", "lvc"), ("next-events", "4,1")]),

    variant(SUBPATHS, SHARED, "lvc 1 sample", &[("integrator", "lvc"), ("samples-per-subpath", "1")]),
    variant(SUBPATHS, SHARED, "lvc 2 samples", &[("integrator", "lvc"), ("samples-per-subpath", "2")]),
    variant(SUBPATHS, SHARED, "lvc 4 samples", &[("integrator", "lvc"), ("samples-per-subpath", "4")]),

    variant(CANDIDATES, SHARED, "lvc 1 candidate", &[("integrator", "lvc"), ("candidates", "1")]),
    variant(CANDIDATES, SHARED, "lvc 2 candidates", &[("integrator", "lvc"), ("candidates", "2")]),
    variant(CANDIDATES, SHARED, "lvc 4, then 1", &[("integrator", "lvc"), ("candidates", "4,1")]),
    variant(CANDIDATES, SHARED, "lvc 8, then 1", &[("integrator", "lvc"), ("candidates", "8,1")]),
    variant(CANDIDATES, SHARED, "lvc 12, then 1", &[("integrator", "lvc"), ("candidates", "12,1")]),
    variant(CANDIDATES, SHARED, "lvc 24, then 1", &[("integrator", "lvc"), ("candidates", "24,1")]),
    variant(CANDIDATES, SHARED, "lvc 12 candidates", &[("integrator", "lvc"), ("candidates", "12")]),
    variant(CANDIDATES, SHARED, "lvc 20, then 3, budget:8", &[("integrator", "lvc"), ("candidates", "20,3"), ("shadow-rays", "budget:8")]),
    variant(CANDIDATES, SHARED, "lvc 24, then 4, budget:10, 1 sample", &[("integrator", "lvc"), ("candidates", "24,4"), ("shadow-rays", "budget:10"), ("samples-per-subpath", "1")]),

    variant(SELECTORS, BASELINE, "bdpt per-light-vertex", &[("integrator", "bdpt"), ("shadow-rays", "per-light-vertex")]),
    variant(SELECTORS, BASELINE, "bdpt per-camera-vertex", &[("integrator", "bdpt"), ("shadow-rays", "per-camera-vertex")]),
    variant(SELECTORS, BASELINE, "bdpt per-pair", &[("integrator", "bdpt"), ("shadow-rays", "per-pair")]),
    variant(SELECTORS, BASELINE, "bdpt ray-roulette", &[("integrator", "bdpt"), ("shadow-rays", "ray-roulette")]),
    variant(SELECTORS, BASELINE, "bdpt budget:1", &[("integrator", "bdpt"), ("shadow-rays", "budget:1")]),
    variant(SELECTORS, BASELINE, "bdpt budget:2", &[("integrator", "bdpt"), ("shadow-rays", "budget:2")]),
    variant(SELECTORS, SHARED, "lvc all", &[("integrator", "lvc"), ("shadow-rays", "all")]),
    variant(SELECTORS, SHARED, "lvc per-camera-vertex", &[("integrator", "lvc"), ("shadow-rays", "per-camera-vertex")]),
    variant(SELECTORS, SHARED, "lvc ray-roulette", &[("integrator", "lvc"), ("shadow-rays", "ray-roulette")]),
    variant(SELECTORS, SHARED, "lvc budget:1", &[("integrator", "lvc"), ("shadow-rays", "budget:1")]),
    variant(SELECTORS, SHARED, "lvc budget:2", &[("integrator", "lvc"), ("shadow-rays", "budget:2")]),
    variant(SELECTORS, SHARED, "lvc budget:4", &[("integrator", "lvc"), ("shadow-rays", "budget:4")]),
    variant(SELECTORS, SHARED, "lvc budget:6", &[("integrator", "lvc"), ("shadow-rays", "budget:6")]),
    variant(SELECTORS, SHARED, "lvc budget:8", &[("integrator", "lvc"), ("shadow-rays", "budget:8")]),

    variant(COUNTS, SHARED, "lvc correlated", &[("integrator", "lvc"), ("mis-count", "correlated")]),
    variant(COUNTS, SHARED, "lvc resampled", &[("integrator", "lvc"), ("mis-count", "resampled")]),

    variant(LIGHTS, PATH, "path by power", &[("integrator", "path"), ("light-choice", "power")]),
    variant(LIGHTS, BASELINE, "bdpt all by power", &[("integrator", "bdpt"), ("shadow-rays", "all"), ("light-choice", "power")]),
    variant(LIGHTS, SHARED, "lvc by power", &[("integrator", "lvc"), ("light-choice", "power")]),
];

impl Variant {
    /// What it wants otherwise than the scene.
    pub(super) fn changes(&self) -> Request {
        let mut changes = Request::default();
        for (name, value) in self.settings {
            let set = changes.set(name, value);
            debug_assert!(set.is_ok(), "{name} {value}: {set:?}");
        }
        changes
    }

    /// The first variant with the same settings, where defaults are what nobody sets: what stands for it
    /// in the records.
    pub(super) fn rendered(&self) -> &'static Self {
        let settings = |variant: &Self| texts(&variant.changes().apply(&Settings::default()));
        let own = settings(self);
        let first = VARIANTS.iter().find(|variant| settings(variant) == own);
        first.expect("a variant has its own settings")
    }
}

/// All estimators.
pub(super) fn estimators() -> impl Iterator<Item = &'static Variant> {
    let variants = VARIANTS.iter();
    variants.filter(|variant| variant.role == Role::Estimator)
}

/// All ideas, in order.
pub(super) fn ideas() -> Vec<&'static str> {
    let mut ideas: Vec<_> = VARIANTS.iter().filter_map(Variant::idea).collect();
    ideas.dedup();
    ideas
}

/// The variants of an idea, each with the name of the one that it is a variant of.
pub(super) fn of_idea(wanted: &str) -> impl Iterator<Item = (&'static Variant, &'static str)> {
    VARIANTS
        .iter()
        .filter_map(move |variant| match variant.role {
            Role::Idea { idea, of } if idea == wanted => Some((variant, of)),
            _ => None,
        })
}

impl Variant {
    fn idea(&self) -> Option<&'static str> {
        match self.role {
            Role::Idea { idea, .. } => Some(idea),
            Role::Estimator => None,
        }
    }
}

/// What is rendered in a scene: nothing twice, and nothing that misses light paths.
pub(super) fn rendered(light: LightTracing) -> impl Iterator<Item = &'static Variant> {
    let is_first = |variant: &&Variant| variant.rendered().name == variant.name;
    let sees_all =
        move |variant: &&Variant| variant.name != LIGHT || light == LightTracing::Complete;
    VARIANTS.iter().filter(is_first).filter(sees_all)
}

/// In words, which variants have the settings of an earlier one.
pub(super) fn aliases() -> Vec<String> {
    let others = VARIANTS.iter().filter_map(|variant| {
        let rendered = variant.rendered().name;
        (rendered != variant.name).then(|| format!("{} is {rendered}", variant.name))
    });
    others.collect()
}
