//! The layers of a film by name.

use bidir::film::{Aov, Layers, StrategyImages};
use serde::{Deserialize, Serialize};

/// [`Layers`] as text.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LayerNames {
    /// The names of [`Aov::NAMES`].
    pub aovs: Vec<String>,
    /// Groups of lights.
    pub light_groups: Vec<String>,
    /// The maximum number of vertices of paths whose strategies have images.
    pub strategy_vertices: usize,
    /// The kinds of images of these strategies.
    #[serde(default, skip_serializing_if = "is_weighted")]
    pub strategy_images: StrategyImages,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks by reference")]
fn is_weighted(images: &StrategyImages) -> bool {
    *images == StrategyImages::Weighted
}

impl LayerNames {
    /// Returns true if the film has no layers.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the layers with these names. None: a name is unknown, or the names are not in order.
    pub(super) fn layers(&self) -> Option<Layers> {
        let find = |name: &String| Aov::NAMES.iter().find(|(known, _)| known == name);
        let found = self.aovs.iter().map(|name| Some(find(name)?.1));
        let aovs: Vec<_> = found.collect::<Option<_>>()?;
        let weighted = Layers::new(&aovs, &self.light_groups, self.strategy_vertices);
        let layers = match self.strategy_images {
            StrategyImages::Weighted => weighted,
            StrategyImages::WeightedAndRaw => weighted.with_raw(),
        };
        (*self == Self::from(&layers)).then_some(layers)
    }
}

impl From<&Layers> for LayerNames {
    fn from(layers: &Layers) -> Self {
        let names = layers.aovs().iter().map(|aov| aov.name().to_owned());
        Self {
            aovs: names.collect(),
            light_groups: layers.light_groups().to_vec(),
            strategy_vertices: layers.strategy_vertices(),
            strategy_images: layers.strategy_images(),
        }
    }
}
