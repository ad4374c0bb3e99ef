//! What a film keeps beside the picture, by name.

use bidir::film::{Aov, Layers};
use serde::{Deserialize, Serialize};

/// [`Layers`] as text.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LayerNames {
    /// The names of [`Aov::NAMES`].
    pub aovs: Vec<String>,
    /// Groups of lights.
    pub light_groups: Vec<String>,
    /// The most vertices of paths whose strategies have images.
    pub strategy_vertices: usize,
}

impl LayerNames {
    /// True where there is the picture alone.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The layers of these names. None: one is not known, or they are not in order.
    pub(super) fn layers(&self) -> Option<Layers> {
        let find = |name: &String| Aov::NAMES.iter().find(|(known, _)| known == name);
        let aovs = self.aovs.iter().map(|name| Some(find(name)?.1));
        let aovs: Vec<_> = aovs.collect::<Option<_>>()?;
        let layers = Layers::new(&aovs, &self.light_groups, self.strategy_vertices);
        (*self == Self::from(&layers)).then_some(layers)
    }
}

impl From<&Layers> for LayerNames {
    fn from(layers: &Layers) -> Self {
        let name = |aov: &Aov| {
            let mut names = Aov::NAMES.iter();
            names
                .find(|(_, known)| known == aov)
                .map(|(name, _)| (*name).to_owned())
        };
        Self {
            aovs: layers.aovs().iter().filter_map(name).collect(),
            light_groups: layers.light_groups().to_vec(),
            strategy_vertices: layers.strategy_vertices(),
        }
    }
}
