//! The choice of the shadow rays that are traced.
//!
//! All connections of a sample are [`Candidate`]s: their terms, before visibility. A
//! [`Selector`] gives each an inclusion probability π and draws; the chosen ones are traced and
//! count value·v/π. With π > 0 wherever the value is not zero, and with π a function of the
//! candidates alone, the sum keeps its expectation Σ value·v, whatever the rule
//! (docs/derivations/shadow-ray-selection.md): the weights, and so the densities, of the strategies do not change.
//!
//! The value of a chosen candidate is divided by its own π; the sum of the group is never used in
//! its place, which would be biased for coloured light. s = 0 needs no ray and t = 1 belongs to other
//! pixels: neither is a candidate.
//!
//! **Adding one**: a file, and a variant of [`ShadowRays`] with its name.

mod budget;
mod grouped;
mod simple;

pub use budget::Budget;
pub use grouped::{Group, OnePerGroup};
pub use simple::{All, RayRoulette};

use crate::contribution::Term;
use crate::locus::Locus;
use crate::names::as_text;
use crate::path::Subpaths;
use crate::sampler::{Dimension, Purpose, SampleStream};
use std::fmt;
use std::str::FromStr;

/// A connection that may be traced.
#[derive(Clone, Copy, Debug, Default)]
pub struct Candidate {
    /// Its term; s ≥ 1 and t ≥ 2.
    pub term: Term,
    /// The score that candidates are compared by: the mean of the lanes of C w, times an estimate of the mean of T,
    /// times the square root of the estimated visibility. Positive.
    pub score: f32,
    /// The numbers of its light vertex and of its camera vertex among those of a batch.
    pub vertices: [u32; 2],
    /// The number of its light vertex in the sample, by which `per-light-vertex` groups; 0 for all light points of
    /// next-event estimation.
    pub light_vertex: u32,
}

const _: () = assert!(size_of::<Candidate>() == 48);

impl Candidate {
    /// Returns the ends of its shadow ray; `light` and `camera` have its vertices.
    #[inline]
    pub(crate) fn ends(&self, light: &Subpaths, camera: &Subpaths) -> [Locus; 2] {
        let [z, y] = self.vertices.map(|vertex| vertex as usize);
        [light.vertices()[z].locus, camera.vertices()[y].locus]
    }
}

/// A candidate that is traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chosen {
    /// Its number among the candidates.
    pub candidate: u32,
    /// The probability π with which it was included.
    pub prob: f64,
}

/// The random numbers of a selection.
#[derive(Clone, Copy)]
pub struct Draws<'a>(pub &'a SampleStream);

impl Draws<'_> {
    /// Returns draw number `i`, of 48 bits: probabilities span more orders than 24 bits can tell apart.
    /// Range: `[0, 1)`.
    #[inline]
    pub fn get(&self, i: usize) -> f64 {
        let u = self.0.get_2d(Dimension::at(i, Purpose::Select));
        f64::from(u.x) + f64::from(u.y) / 16_777_216.0
    }
}

/// A rule that chooses shadow rays. One call serves a whole sample.
pub trait Selector: Sync + Send {
    /// Appends the chosen `candidates` to `chosen`, each at most once, with its inclusion probability.
    fn select(&self, candidates: &[Candidate], draws: Draws<'_>, chosen: &mut Vec<Chosen>);

    /// Returns π of each of `candidates`, chosen or not, to inspect a selection.
    fn probabilities(&self, candidates: &[Candidate]) -> Vec<f64>;
}

/// The rules by name, with their settings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ShadowRays {
    /// Every candidate.
    #[default]
    All,
    /// One candidate of each light vertex: optimisation 1 of \[Lafortune95\]. Vertices of a light cache are seldom
    /// drawn twice in a sample, so that nearly all of their candidates are traced.
    PerLightVertex,
    /// One candidate of each camera vertex: optimisation 2 of \[Lafortune95\].
    PerCameraVertex,
    /// One candidate of each pair of subpaths: optimisation 3 of \[Lafortune95\].
    PerPair,
    /// Russian roulette for each candidate, with a threshold that is this fraction of the image's mean luminance,
    /// which training estimates [Veach97, §10.4.1].
    RayRoulette(f32),
    /// This many rays for each pair of subpaths.
    Budget(u32),
}

impl ShadowRays {
    /// The default threshold of `ray-roulette`, as a fraction of the mean luminance.
    pub const DEFAULT_ROULETTE: f32 = 0.1;

    /// The rules that are written without a number.
    const PLAIN: [(&'static str, Self); 5] = [
        ("all", Self::All),
        ("per-light-vertex", Self::PerLightVertex),
        ("per-camera-vertex", Self::PerCameraVertex),
        ("per-pair", Self::PerPair),
        ("ray-roulette", Self::RayRoulette(Self::DEFAULT_ROULETTE)),
    ];

    /// Makes the rule; it uses the image's mean luminance only if it [`needs_mean`](Self::needs_mean).
    pub fn selector(self, mean_luminance: f32) -> Box<dyn Selector> {
        let one_per = |group| Box::new(OnePerGroup { group });
        match self {
            Self::All => Box::new(All),
            Self::PerLightVertex => one_per(Group::LightVertex),
            Self::PerCameraVertex => one_per(Group::CameraVertex),
            Self::PerPair => one_per(Group::Pair),
            Self::RayRoulette(part) => Box::new(RayRoulette::new(part, mean_luminance)),
            Self::Budget(rays) => Box::new(Budget { rays }),
        }
    }

    /// Returns the least score at which `ray-roulette` always traces a candidate, given the image's mean luminance.
    /// None: it is another rule.
    pub fn threshold(self, mean_luminance: f32) -> Option<f32> {
        match self {
            Self::RayRoulette(part) => Some(RayRoulette::new(part, mean_luminance).threshold),
            _ => None,
        }
    }

    /// Returns true where the rule needs the mean luminance of a training render.
    pub fn needs_mean(self) -> bool {
        matches!(self, Self::RayRoulette(_))
    }
}

as_text!(ShadowRays);

impl fmt::Display for ShadowRays {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RayRoulette(part) => write!(f, "ray-roulette:{part}"),
            Self::Budget(rays) => write!(f, "budget:{rays}"),
            plain => {
                let named = Self::PLAIN.iter().find(|(_, rule)| rule == plain);
                f.write_str(named.map_or("", |(name, _)| name))
            }
        }
    }
}

/// The reasons why a rule cannot be read.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum ShadowRaysError {
    /// There is no such rule.
    #[error(
        "there is no rule `{0}`: expected `all`, `per-light-vertex`, `per-camera-vertex`, \
         `per-pair`, `ray-roulette[:T]` (T above 0, relative to the image's mean), `budget:K` \
         (K rays, at least 1)"
    )]
    Unknown(String),
    /// The rule has a number.
    #[error("`budget` needs a number of rays, such as budget:4")]
    NoBudget,
}

impl FromStr for ShadowRays {
    type Err = ShadowRaysError;

    fn from_str(text: &str) -> Result<Self, ShadowRaysError> {
        let plain = Self::PLAIN.into_iter().find(|(name, _)| *name == text);
        let rule = match (plain, text.split_once(':')) {
            (Some((_, rule)), _) => Some(rule),
            (None, None) if text == "budget" => return Err(ShadowRaysError::NoBudget),
            (None, Some(("ray-roulette", part))) => {
                let part = part.parse().ok();
                let part = part.filter(|part: &f32| part.is_finite() && *part > 0.0);
                part.map(Self::RayRoulette)
            }
            (None, Some(("budget", rays))) => {
                let rays = rays.parse().ok().filter(|&rays: &u32| rays > 0);
                rays.map(Self::Budget)
            }
            _ => None,
        };
        rule.ok_or_else(|| ShadowRaysError::Unknown(text.to_owned()))
    }
}

#[cfg(test)]
mod tests;
