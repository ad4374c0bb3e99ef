//! A [`Request`] has the settings that a person asks for; [`Settings`] has those that a render uses.
//!
//! A request has an option for each setting; requests of the command line, the environment, a file and a
//! scene lie over each other ([`Request::over`]). Settings have a value for each, which
//! [`Request::apply`] takes from a request or from what suits the integrator, the only place of such
//! defaults being [`Settings::set_integrator`]. [`Request::of`] is the way back: the settings that an image
//! depends on, of which identities of films, attributes of images and records are made.
//!
//! **Adding one**: its type, read and written as text; a field in the settings that use it; its lines in
//! `request.rs`.

mod choice;
mod request;

pub use choice::{Choice, ChoiceError};
pub use request::{Request, RequestError, flag, text};

use crate::film::Layers;
use crate::integrator::{CandidateCount, IntegratorKind, LightStart, LvcSettings, ProposalKind};
use crate::path::{PathRoulette, PathSettings};
use crate::sampler::SamplerKind;
use crate::select::ShadowRays;

/// The settings of a render: with the scene and the passes, they decide every bit of the image.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The estimator.
    pub integrator: IntegratorKind,
    /// Which connections are traced.
    pub shadow_rays: ShadowRays,
    /// How light subpaths are shared, in [`IntegratorKind::Lvc`].
    pub lvc: LvcSettings,
    /// How paths are made and weighted.
    pub path: PathSettings,
    /// The settings above that [`IntegratorKind::Auto`] chooses.
    pub open: Open,
    /// The random numbers.
    pub sampler: SamplerKind,
    /// Other seeds give unrelated images.
    pub seed: u64,
    /// The images that the film keeps beside the picture; they change no bit of it.
    pub layers: Layers,
}

/// The settings that `auto` may change; the others it keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "one for each setting")]
pub struct Open {
    /// [`PathSettings::roulette`].
    pub roulette: bool,
    /// [`Settings::shadow_rays`].
    pub shadow_rays: bool,
    /// [`LvcSettings::candidates`].
    pub candidates: bool,
    /// [`LvcSettings::next_events`].
    pub next_events: bool,
}

impl Default for Settings {
    /// Returns the settings of bidirectional path tracing.
    fn default() -> Self {
        Self::new(IntegratorKind::default())
    }
}

impl Settings {
    /// Returns the settings of an estimator where nothing else is asked for.
    pub fn new(integrator: IntegratorKind) -> Self {
        let mut settings = Self {
            integrator,
            shadow_rays: ShadowRays::All,
            lvc: LvcSettings::default(),
            path: PathSettings::default(),
            open: Open::default(),
            sampler: SamplerKind::default(),
            seed: 0,
            layers: Layers::default(),
        };
        settings.set_integrator(integrator);
        settings
    }

    /// Takes an estimator, with the path roulette, the choice of shadow rays, and the numbers of candidates and light
    /// points that suit it.
    pub fn set_integrator(&mut self, integrator: IntegratorKind) {
        let is_open = integrator == IntegratorKind::Auto;
        self.integrator = integrator;
        self.open = Open {
            roulette: is_open,
            shadow_rays: is_open,
            candidates: is_open,
            next_events: is_open,
        };
        self.path.roulette = integrator.roulette();
        self.shadow_rays = integrator.shadow_rays();
        self.lvc.candidates = CandidateCount::DEFAULT;
        self.lvc.next_events = CandidateCount::NEXT_EVENTS;
    }

    /// Returns true where the estimator learns about connections before the first pass.
    pub(crate) fn learns(&self) -> bool {
        let learns = self.lvc.proposal == ProposalKind::Learned
            || self.lvc.light_start == LightStart::Learned;
        self.integrator == IntegratorKind::Lvc && learns
    }
}

impl IntegratorKind {
    /// Returns the path roulette that suits the estimator: of several scenes the least product of error and
    /// time (docs/performance.md). If every vertex is connected with every other, short walks pay.
    pub fn roulette(self) -> PathRoulette {
        match self {
            Self::Bdpt | Self::Lvc | Self::Auto => PathRoulette::Albedo { start: 0 },
            Self::Path => PathRoulette::Albedo { start: 1 },
            Self::Light => PathRoulette::Albedo { start: 2 },
        }
    }

    /// Returns the choice of shadow rays that suits the estimator, likewise. If many candidates are weighed
    /// for a few rays, those that matter pay.
    pub fn shadow_rays(self) -> ShadowRays {
        match self {
            Self::Path | Self::Light | Self::Bdpt => ShadowRays::All,
            Self::Lvc | Self::Auto => ShadowRays::Budget(6),
        }
    }
}
