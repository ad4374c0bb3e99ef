//! The flags for layers.

use super::values::{count, named};
use bidir::film::{Aov, Layers};
use clap::{Args, ValueHint};
use lab::pyramid;
use std::path::PathBuf;

/// The layers of the EXR and of film files.
#[derive(Args, Debug)]
#[command(next_help_heading = "Layers")]
pub(crate) struct LayerArgs {
    /// Extra layers: albedo, normal, depth, variance, …, or all.
    ///
    /// First surface: albedo (Albedo.R, G, B), position (P.X, Y, Z), normal (N.X, Y, Z) and
    /// shading-normal (Ns.X, Y, Z) in world space, depth along the view (Z), coverage (Coverage). Noise:
    /// samples (Samples), variance (Variance.R, G, B of each pixel's mean, and RelativeVariance). Cost:
    /// time in seconds (Time), rays (Rays). Layers of time differ from run to run. The default is the
    /// layers of the scene's film: pbrt's `gbuffer` has albedo, position, normal, shading-normal and
    /// variance; any other film has none.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = named(aov_names()))]
    pub(crate) aov: Vec<AovName>,
    /// Denoise with Open Image Denoise; keep the noisy image as a layer.
    ///
    /// Albedo and shading normals guide the filter and become layers too. The noisy image is the layer
    /// Noisy.R, G, B, and the only one in film files. BIDIR_OIDN names the library or its folder;
    /// `pip install pyoidn` installs it.
    #[arg(long)]
    pub(crate) denoise: bool,
    /// One layer per light group; they add up to the image.
    ///
    /// Layers are lightgroup.NAME.R, G, B. pbrt scenes name groups by `Attribute "light" "string
    /// lightgroup" "NAME"`. Lights in no group belong to `environment` if they are at infinity, and else
    /// to `default`.
    #[arg(long)]
    pub(crate) light_groups: bool,
    /// One weighted layer per strategy, for paths of up to N vertices; they add up to the image.
    ///
    /// Layers are sStT.R, G, B, and longer.R, G, B for all longer paths.
    #[arg(long, value_name = "N")]
    #[arg(value_parser = count::<u16>(2..=Layers::MOST_STRATEGY_VERTICES as u64))]
    pub(crate) strategy_layers: Option<u16>,
    /// Write the strategy pyramid: pyramid.exr in this folder.
    ///
    /// It has the layers of --strategy-layers (6 by default) and raw.sStT.R, G, B, the same without
    /// weights: the estimate of each strategy alone. The render prints the rays, blocked rays, mean and
    /// variance of each strategy at the end; --stats has them too. Needs 6.4 KB of memory per pixel at 6
    /// vertices.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) pyramid: Option<PathBuf>,
}

/// A layer, or all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AovName {
    All,
    One(Aov),
}

fn aov_names() -> [(&'static str, AovName); Aov::NAMES.len() + 1] {
    std::array::from_fn(|i| match Aov::NAMES.get(i) {
        Some((name, aov)) => (*name, AovName::One(*aov)),
        None => ("all", AovName::All),
    })
}

impl LayerArgs {
    /// Returns true if the flags request layers that a PNG cannot hold.
    pub(crate) fn need_exr(&self) -> bool {
        let has_strategies = self.strategy_layers.is_some() && self.pyramid.is_none();
        !self.aov.is_empty() || self.light_groups || has_strategies
    }

    /// Returns the layers of a render of a scene with these light groups.
    ///
    /// `own_aovs`: the layers of the scene's film, which apply unless --aov is given.
    pub(crate) fn layers(&self, light_groups: &[String], own_aovs: &[Aov]) -> Layers {
        let requested = self.aov.iter().flat_map(|name| match name {
            AovName::All => Aov::NAMES.map(|(_, aov)| aov).to_vec(),
            AovName::One(aov) => vec![*aov],
        });
        let own = own_aovs.iter().copied().filter(|_| self.aov.is_empty());
        let chosen = requested.chain(own);
        let guides = [Aov::Albedo, Aov::ShadingNormal];
        let aovs = chosen.chain(guides.into_iter().filter(|_| self.denoise));
        let light_groups = if self.light_groups { light_groups } else { &[] };
        let default = self.pyramid.as_ref().map_or(0, |_| pyramid::VERTICES);
        let vertices = self.strategy_layers.unwrap_or(default).into();
        let layers = Layers::new(&aovs.collect::<Vec<_>>(), light_groups, vertices);
        match self.pyramid {
            Some(_) => layers.with_raw(),
            None => layers,
        }
    }
}
