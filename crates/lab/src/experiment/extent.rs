//! The extent of an experiment: reductions by `--quick` and by flags.

use super::{BudgetSpec, Experiment, ReferenceSpec, is_in};
use crate::results::BudgetKind;
use bidir::names::UnknownName;

/// The extent of a quick run, which checks that an experiment works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quick {
    /// The largest number of seeds.
    pub seeds: u64,
    /// Factor of the sides of images. None: images have at most 64 pixels a side.
    pub size: Option<f64>,
    /// Factor of the samples of budgets and of images of strategies.
    pub samples: f64,
    /// Factor of the rays of budgets.
    pub rays: f64,
    /// Factor of the seconds of budgets.
    pub seconds: f64,
    /// Factor of the samples of references.
    pub references: f64,
}

impl Default for Quick {
    fn default() -> Self {
        let eighth = 0.125;
        Self {
            seeds: 3,
            size: None,
            samples: eighth,
            rays: eighth,
            seconds: eighth,
            references: eighth,
        }
    }
}

impl Quick {
    /// Reduces a size, keeping its aspect ratio.
    fn size(&self, size: [u32; 2]) -> [u32; 2] {
        let factor = self.size.unwrap_or_else(|| {
            let longest = size[0].max(size[1]);
            1.0 / f64::from(longest.div_ceil(64).max(1))
        });
        size.map(|side| ((f64::from(side) * factor + 1e-9) as u32).max(1))
    }

    fn budget(&self, budget: &BudgetSpec) -> BudgetSpec {
        let (factor, pixels) = match budget.kind {
            BudgetKind::Samples => (self.samples, 1.0),
            // Training costs as much as in a full run, but fewer pixels share it.
            BudgetKind::Rays => (self.rays, self.size.map_or(1.0, |side| side * side)),
            BudgetKind::Seconds => (self.seconds, 1.0),
        };
        let amount = budget.amount * factor;
        let is_whole = budget.kind == BudgetKind::Samples;
        BudgetSpec {
            full: budget.full / pixels,
            ..budget.of(if is_whole { amount.ceil() } else { amount })
        }
    }
}

/// Overrides of a description's extent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extent {
    /// The names of the scenes; empty: all.
    pub scenes: Vec<String>,
    /// Width and height of all images. Unit: pixels.
    pub size: Option<[u32; 2]>,
    /// Number of seeds.
    pub seeds: Option<u64>,
    /// Amount of budgets in seconds.
    pub seconds: Option<f64>,
    /// Amount of budgets in rays per pixel.
    pub rays: Option<f64>,
    /// Samples per pixel of rendered references.
    pub reference_spp: Option<u64>,
}

impl Experiment {
    /// Reduces the experiment to the extent of its [`Quick`].
    #[must_use]
    pub fn quick(mut self) -> Self {
        let quick = self.quick;
        self.seeds.count = self.seeds.count.min(quick.seeds);
        for scene in &mut self.scenes {
            let size = scene.size.or(self.size);
            match &mut scene.reference {
                // The size of an existing image is fixed.
                ReferenceSpec::Existing(_) => scene.size = size,
                ReferenceSpec::Of(_) => scene.size = Some(quick.size(size.unwrap_or([64, 48]))),
                ReferenceSpec::Make(recipe) => {
                    scene.size = Some(quick.size(size.unwrap_or([64, 48])));
                    recipe.spp = (recipe.spp as f64 * quick.references).ceil() as u64;
                }
            }
        }
        self.size = None;
        let mut budgets: Vec<BudgetSpec> = Vec::new();
        for budget in self.budgets.iter().map(|budget| quick.budget(budget)) {
            let full = budget.full;
            let is_same = |other: &BudgetSpec| {
                BudgetSpec {
                    full,
                    ..other.clone()
                } == budget
            };
            if !budgets.iter().any(is_same) {
                budgets.push(budget);
            }
        }
        self.budgets = budgets;
        if let Some(pyramid) = &mut self.pyramid {
            pyramid.spp = ((pyramid.spp as f64 * quick.samples).ceil() as u64).max(2);
        }
        self
    }

    /// Applies overrides.
    ///
    /// Errors: a scene name is unknown.
    pub fn within(mut self, extent: &Extent) -> Result<Self, UnknownName> {
        let scenes = self.scene_names();
        let is_unknown = |name: &&String| !scenes.contains(name);
        if let Some(name) = extent.scenes.iter().find(is_unknown) {
            let names: Vec<&str> = scenes.iter().map(String::as_str).collect();
            return Err(UnknownName::new(name, &names));
        }
        self.scenes
            .retain(|scene| is_in(&extent.scenes, &scene.name));
        self.absent
            .retain(|scene| is_in(&extent.scenes, &scene.name));
        for scene in &mut self.scenes {
            scene.size = extent.size.or(scene.size);
            if let ReferenceSpec::Make(recipe) = &mut scene.reference {
                recipe.spp = extent.reference_spp.unwrap_or(recipe.spp);
            }
        }
        self.size = extent.size.or(self.size);
        self.seeds.count = extent.seeds.unwrap_or(self.seeds.count);
        for budget in &mut self.budgets {
            let amount = match budget.kind {
                BudgetKind::Samples => None,
                BudgetKind::Rays => extent.rays,
                BudgetKind::Seconds => extent.seconds,
            };
            if let Some(amount) = amount {
                *budget = budget.of(amount);
            }
        }
        Ok(self)
    }

    /// Returns the names of all scenes, including missing ones.
    pub(super) fn scene_names(&self) -> Vec<String> {
        let there = self.scenes.iter().map(|scene| &scene.name);
        let absent = self.absent.iter().map(|scene| &scene.name);
        there.chain(absent).cloned().collect()
    }
}

impl BudgetSpec {
    /// Returns the budget with another amount, and named by it.
    fn of(&self, amount: f64) -> Self {
        Self {
            methods: self.methods.clone(),
            scenes: self.scenes.clone(),
            ..Self::new(self.kind, amount)
        }
    }
}
