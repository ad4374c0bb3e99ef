//! Images that a film keeps beside the picture, if they are asked for: features that the camera sees ([`Aov`]), and
//! parts of the picture, by light and by strategy. All are sums over passes, so that films with layers merge like any
//! other.
//!
//! A contribution is added to the part of its light's group and to the part of its strategy. The parts of all groups
//! add up to the picture, and so do the parts of all strategies.
//!
//! Strategies may also have **raw** images: C/π without the weight. Each of them estimates the light of all paths of
//! its length that its strategy can make, by this strategy only. Raw images are unbiased, but their variance is
//! unbounded: a strategy has a small weight for paths that it rarely makes, and their raw values are large. They have
//! the same terms as the weighted picture: a connection whose weighted value is zero is never traced, and is in no
//! image. A raw value beyond [`fixed::LARGEST_CONTRIBUTION`](crate::math::fixed::LARGEST_CONTRIBUTION) is left out of
//! the raw image only, and counted ([`LayerCounts`](crate::stats::LayerCounts)).

use crate::names::named;
use crate::strategy::Strategy;
use serde::{Deserialize, Serialize};

/// The number of sums of a pixel of the picture: camera samples, splats and squares of pass totals, each of red,
/// green and blue.
pub(super) const PICTURE_SUMS: usize = 9;
/// The number of sums of a pixel of a part: camera samples and splats, each of red, green and blue.
pub(super) const PART_SUMS: usize = 6;

/// An image beside the picture: a feature of the first surface that camera samples meet, the variance of the picture,
/// or its cost. Film files and the command line use the names in [`NAMES`](Self::NAMES).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Aov {
    /// The approximate fraction of light that the surface scatters: 1 for glass, 0 without a surface.
    Albedo,
    /// The point of the surface. Space: world.
    Position,
    /// The geometric normal, towards the camera. Space: world.
    Normal,
    /// The shading normal, towards the camera. Space: world.
    ShadingNormal,
    /// The distance from the camera along the viewing direction. Space: world.
    Depth,
    /// The fraction of the camera samples that meet a surface. Kept whenever an image is a mean over these samples.
    Coverage,
    /// The number of camera samples.
    Samples,
    /// The variance of the pixel's mean, and this variance divided by the square of the mean.
    Variance,
    /// The time of all samples, without the light subpaths that they share. Unit: seconds. It is the only image whose
    /// bits differ from run to run.
    Time,
    /// The number of rays of all samples, including the light subpaths that belong to one sample only.
    Rays,
}

/// The source of the values of an [`Aov`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AovKind {
    /// A mean over the camera samples that meet a surface; 0 if none does.
    Surface,
    /// A mean over all camera samples.
    Sample,
    /// A sum over all camera samples.
    Cost,
    /// Computed from the sums of the picture.
    Film,
}

/// The layer and channels of an [`Aov`] in an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channels {
    /// The layer's name; empty for channels that stand alone.
    pub layer: &'static str,
    /// The channels' names.
    pub names: &'static [&'static str],
}

const RGB: &[&str] = &["R", "G", "B"];
const XYZ: &[&str] = &["X", "Y", "Z"];

named!(Aov {
    "albedo" => Albedo,
    "position" => Position,
    "normal" => Normal,
    "shading-normal" => ShadingNormal,
    "depth" => Depth,
    "coverage" => Coverage,
    "samples" => Samples,
    "variance" => Variance,
    "time" => Time,
    "rays" => Rays,
});

impl Aov {
    /// Returns the layers and channels in image files, with the names of pbrt-v4's film `gbuffer` if it has them.
    pub fn channels(self) -> &'static [Channels] {
        const fn of(layer: &'static str, names: &'static [&'static str]) -> Channels {
            Channels { layer, names }
        }
        match self {
            Self::Albedo => const { &[of("Albedo", RGB)] },
            Self::Position => const { &[of("P", XYZ)] },
            Self::Normal => const { &[of("N", XYZ)] },
            Self::ShadingNormal => const { &[of("Ns", XYZ)] },
            Self::Depth => const { &[of("", &["Z"])] },
            Self::Coverage => const { &[of("", &["Coverage"])] },
            Self::Samples => const { &[of("", &["Samples"])] },
            Self::Variance => const { &[of("Variance", RGB), of("RelativeVariance", RGB)] },
            Self::Time => const { &[of("", &["Time"])] },
            Self::Rays => const { &[of("", &["Rays"])] },
        }
    }

    /// Returns the number of sums that a pixel has for it; 0 if it is computed from other sums.
    pub fn sums(self) -> usize {
        match self.kind() {
            AovKind::Film => 0,
            _ => self.channels().iter().map(|of| of.names.len()).sum(),
        }
    }

    /// Returns the source of its values.
    pub fn kind(self) -> AovKind {
        match self {
            Self::Position | Self::Normal | Self::ShadingNormal | Self::Depth => AovKind::Surface,
            Self::Albedo | Self::Coverage => AovKind::Sample,
            Self::Time | Self::Rays => AovKind::Cost,
            Self::Samples | Self::Variance => AovKind::Film,
        }
    }
}

/// The images that a film keeps beside the picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    aovs: Vec<Aov>,
    light_groups: Vec<String>,
    strategy_vertices: usize,
    strategies: StrategyImages,
}

/// The images of strategies that are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StrategyImages {
    /// Weighted images: parts of the picture.
    #[default]
    Weighted,
    /// Weighted and raw images.
    WeightedAndRaw,
}

impl Layers {
    /// The largest number of vertices of paths whose strategies may have images.
    pub const MOST_STRATEGY_VERTICES: usize = 16;

    /// Makes the layers of `aovs`, in any order; of all `light_groups` of the scene, by name (empty: no such layers);
    /// and of each strategy of paths with at most `strategy_vertices` vertices (0: no such layers; at most
    /// [`Self::MOST_STRATEGY_VERTICES`]).
    pub fn new(aovs: &[Aov], light_groups: &[String], strategy_vertices: usize) -> Self {
        let mut aovs = aovs.to_vec();
        if aovs.iter().any(|aov| aov.kind() == AovKind::Surface) {
            aovs.push(Aov::Coverage);
        }
        aovs.sort_unstable();
        aovs.dedup();
        Self {
            aovs,
            light_groups: light_groups.to_vec(),
            strategy_vertices: strategy_vertices.min(Self::MOST_STRATEGY_VERTICES),
            strategies: StrategyImages::Weighted,
        }
    }

    /// Adds raw images of the strategies that have weighted images.
    #[must_use]
    pub fn with_raw(self) -> Self {
        let strategies = match self.strategy_vertices {
            0 => StrategyImages::Weighted,
            _ => StrategyImages::WeightedAndRaw,
        };
        Self { strategies, ..self }
    }

    /// Returns the images beside the picture, sorted.
    pub fn aovs(&self) -> &[Aov] {
        &self.aovs
    }

    /// Returns the names of the groups of lights that have images, in the order of the scene.
    pub fn light_groups(&self) -> &[String] {
        &self.light_groups
    }

    /// Returns the largest number of vertices of paths whose strategies have images.
    pub fn strategy_vertices(&self) -> usize {
        self.strategy_vertices
    }

    /// Returns the choice of images of strategies.
    pub fn strategy_images(&self) -> StrategyImages {
        self.strategies
    }

    /// Returns true if the film keeps only the picture.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the number of sums of a pixel: of the picture, of features, and of parts.
    pub fn sums(&self) -> usize {
        PICTURE_SUMS + self.features() + PART_SUMS * self.parts()
    }

    /// Returns the number of sums of a pixel for features of camera samples.
    pub fn features(&self) -> usize {
        self.aovs.iter().map(|aov| aov.sums()).sum()
    }

    /// Returns the index of the first sum of `aov` among [`Self::features`]. None: it is not kept.
    pub fn feature(&self, aov: Aov) -> Option<usize> {
        let at = self.aovs.iter().position(|&kept| kept == aov)?;
        Some(self.aovs[..at].iter().map(|aov| aov.sums()).sum())
    }

    /// Returns the number of parts: one for each group of lights; one for each strategy, shorter paths first; one for
    /// all longer paths; and one for each raw image, in the order of strategies.
    pub fn parts(&self) -> usize {
        match self.strategies {
            StrategyImages::Weighted => self.first_raw(),
            StrategyImages::WeightedAndRaw => {
                self.first_raw() + strategies_below(self.strategy_vertices + 1)
            }
        }
    }

    /// Returns the number of weighted parts, which is the index of the first raw part.
    fn first_raw(&self) -> usize {
        let strategies = match self.strategy_vertices {
            0 => 0,
            n => strategies_below(n + 1) + 1,
        };
        self.light_groups.len() + strategies
    }

    /// Returns the index of `strategy` among the strategies that have images. None: it has none.
    #[inline]
    fn strategy(&self, strategy: Strategy) -> Option<usize> {
        let n = usize::from(strategy.s + strategy.t);
        let is_kept = (2..=self.strategy_vertices).contains(&n);
        is_kept.then(|| strategies_below(n) + usize::from(strategy.s))
    }

    /// Returns the part that is the weighted image of `strategy`. None: it has no image of its own.
    #[inline]
    pub fn weighted_part(&self, strategy: Strategy) -> Option<usize> {
        Some(self.light_groups.len() + self.strategy(strategy)?)
    }

    /// Returns the part that is the raw image of `strategy`. None: it has none.
    #[inline]
    pub fn raw_part(&self, strategy: Strategy) -> Option<usize> {
        match self.strategies {
            StrategyImages::Weighted => None,
            StrategyImages::WeightedAndRaw => Some(self.first_raw() + self.strategy(strategy)?),
        }
    }

    /// Returns all strategies that have images, in the order of their parts.
    pub fn kept_strategies(&self) -> impl Iterator<Item = Strategy> + use<> {
        let rows = 2..=self.strategy_vertices;
        rows.flat_map(|n| (0..n).map(move |s| Strategy::new(s, n - s)))
    }

    /// Returns the weighted parts that a contribution of `strategy` and of lights in `group` belongs to.
    #[inline]
    pub fn parts_of(&self, strategy: Strategy, group: u32) -> impl Iterator<Item = usize> {
        let groups = self.light_groups.len();
        let of_group = (groups > 0).then_some(group as usize);
        let of_strategy = (self.strategy_vertices > 0).then(|| {
            let part = self.weighted_part(strategy);
            part.unwrap_or(groups + strategies_below(self.strategy_vertices + 1))
        });
        of_group.into_iter().chain(of_strategy)
    }

    /// Returns the names of the layers of all parts: `lightgroup.NAME`, `sStT`, `longer`, and `raw.sStT`.
    pub fn part_names(&self) -> impl Iterator<Item = String> + '_ {
        let groups = (self.light_groups.iter()).map(|name| format!("lightgroup.{name}"));
        let longer = (self.strategy_vertices > 0).then(|| "longer".to_owned());
        let strategies = self.kept_strategies().map(|strategy| strategy.to_string());
        let is_raw = |strategy: &Strategy| self.raw_part(*strategy).is_some();
        let raw = (self.kept_strategies().filter(is_raw)).map(|strategy| format!("raw.{strategy}"));
        groups.chain(strategies).chain(longer).chain(raw)
    }
}

/// Returns the number of strategies of paths with fewer than `n` vertices: Σ_{m=2}^{n-1} m, because a path of m
/// vertices has s = 0 … m-1.
fn strategies_below(n: usize) -> usize {
    (n * n.saturating_sub(1) / 2).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers() -> Layers {
        let groups = ["lamp", "environment"].map(str::to_owned);
        Layers::new(&[Aov::Rays, Aov::Depth, Aov::Albedo], &groups, 4)
    }

    #[test]
    fn images_of_surfaces_bring_their_coverage() {
        let layers = layers();
        let expected = [Aov::Albedo, Aov::Depth, Aov::Coverage, Aov::Rays];
        assert_eq!(layers.aovs(), expected);
        assert_eq!(layers.features(), 6);
        let places = expected.map(|aov| layers.feature(aov));
        assert_eq!(places, [Some(0), Some(3), Some(4), Some(5)]);
        assert_eq!(layers.feature(Aov::Time), None);
    }

    #[test]
    fn every_part_has_a_name_and_a_place() {
        let layers = layers();
        let names: Vec<_> = layers.part_names().collect();
        assert_eq!(names.len(), layers.parts());
        for (s, t) in [(0, 2), (1, 1), (0, 3), (2, 1), (3, 1), (0, 4), (1, 3)] {
            let strategy = Strategy::new(s, t);
            let parts: Vec<_> = layers.parts_of(strategy, 1).collect();
            assert_eq!(names[parts[0]], "lightgroup.environment");
            assert_eq!(names[parts[1]], strategy.to_string());
        }
        let longer: Vec<_> = layers.parts_of(Strategy::new(2, 3), 0).collect();
        assert_eq!(longer, [0, layers.parts() - 1]);
        assert_eq!(names[longer[1]], "longer");
    }

    #[test]
    fn raw_images_follow_all_others() {
        let (weighted, raw) = (layers(), layers().with_raw());
        assert_eq!(raw.parts(), weighted.parts() + 9);
        let names: Vec<_> = raw.part_names().collect();
        assert_eq!(names.len(), raw.parts());
        let others: Vec<_> = weighted.part_names().collect();
        assert!(names.starts_with(&others));
        for strategy in raw.kept_strategies() {
            let part = raw.raw_part(strategy).unwrap();
            assert_eq!(names[part], format!("raw.{strategy}"));
            let part = raw.weighted_part(strategy).unwrap();
            assert_eq!(names[part], strategy.to_string());
            assert_eq!(weighted.raw_part(strategy), None);
        }
        assert_eq!(raw.raw_part(Strategy::new(3, 2)), None);
        assert_eq!(Layers::default().with_raw(), Layers::default());
    }

    #[test]
    fn nothing_is_kept_by_default() {
        let layers = Layers::default();
        assert_eq!((layers.features(), layers.parts()), (0, 0));
        assert_eq!(layers.parts_of(Strategy::new(0, 2), 0).count(), 0);
        assert!(layers.is_empty() && layers.part_names().next().is_none());
    }
}
