//! The flags that ask for images beside the picture.

use super::values::named;
use bidir::film::{Aov, Layers};
use clap::{Args, ValueHint};
use lab::pyramid;
use std::path::PathBuf;

/// Images beside the picture, as layers of the EXR and of film files.
#[derive(Args, Debug)]
#[command(next_help_heading = "Layers")]
pub(crate) struct LayerArgs {
    /// Images to write beside the picture, separated by commas.
    ///
    /// What the first surface is like: albedo (Albedo.R, G, B), position (P.X, Y, Z), normal (N.X, Y,
    /// Z), shading-normal (Ns.X, Y, Z), in world space, depth along the view (Z), coverage (Coverage).
    /// How certain the picture is: samples (Samples), variance (Variance.R, G, B of a pixel's mean, and
    /// RelativeVariance). What it cost: time in seconds (Time), rays (Rays). Images of time differ
    /// from run to run. Unless given, those of the scene's film: the film `gbuffer` has albedo,
    /// position, normal, shading-normal and variance.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = named(aov_names()))]
    pub(crate) aov: Vec<AovName>,
    /// Take the noise out of the picture with Open Image Denoise, guided by albedo and shading normals.
    ///
    /// The picture as it was rendered is kept as Noisy.R, G, B, and in film files. The library is
    /// looked for when the program runs: BIDIR_OIDN names it, or a folder that has it.
    #[arg(long)]
    pub(crate) denoise: bool,
    /// Write an image of each group of lights: lightgroup.NAME.R, G, B. They add up to the picture.
    ///
    /// Scenes name groups by `Attribute "light" "string lightgroup" "NAME"`. Lights at infinity that
    /// are in no group are in `environment`, all others in `default`.
    #[arg(long)]
    pub(crate) light_groups: bool,
    /// Write an image of what each strategy adds, weighted, to paths of at most N vertices: sStT.R, G,
    /// B; and one of all longer paths, longer.R, G, B. They add up to the picture.
    #[arg(long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u16).range(2..=Layers::MOST_STRATEGY_VERTICES as i64))]
    pub(crate) strategy_layers: Option<u16>,
    /// Show what each strategy (s, t) does, in this folder: pyramid.exr, weighted.png, raw.png.
    ///
    /// pyramid.exr has the layers of --strategy-layers (6 where it is not given), and raw.sStT.R, G,
    /// B: the same without the strategy's weight, which is what it would show alone, however noisy.
    /// The others are contact sheets with a row for each length of paths. Rays, blocked rays, mean and
    /// variance of each strategy are told at the end, and are in --stats. Paths of 6 vertices take 6.4
    /// KB of memory for each pixel.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) pyramid: Option<PathBuf>,
}

/// An image to write, or all of them.
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
    /// True where images are asked for that no picture for the screen has room for.
    pub(crate) fn need_exr(&self) -> bool {
        let has_strategies = self.strategy_layers.is_some() && self.pyramid.is_none();
        !self.aov.is_empty() || self.light_groups || has_strategies
    }

    /// The layers that are asked for, in a scene with these groups of lights, whose film has images
    /// of its own.
    pub(crate) fn layers(&self, light_groups: &[String], own_aovs: &[Aov]) -> Layers {
        let asked = self.aov.iter().flat_map(|name| match name {
            AovName::All => Aov::NAMES.map(|(_, aov)| aov).to_vec(),
            AovName::One(aov) => vec![*aov],
        });
        let own = own_aovs.iter().copied().filter(|_| self.aov.is_empty());
        let aovs = asked.chain(own);
        let guides = [Aov::Albedo, Aov::ShadingNormal];
        let aovs = aovs.chain(guides.into_iter().filter(|_| self.denoise));
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
