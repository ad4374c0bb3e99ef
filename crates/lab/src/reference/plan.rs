//! The two estimators of a reference.

use super::{Error, Fault, Provenance, REPLICATES};
use bidir::driver::Settings;
use bidir::film::{Aov, Layers};
use bidir::integrator::IntegratorKind;
use bidir::sampler::SamplerKind;
use bidir::settings::Request;

/// The first seed, far from the seeds that people choose.
const SEEDS: u64 = 1 << 40;

/// The settings of a reference.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The estimator of the image, and the estimator of the cross-check. Their layers are ignored.
    pub estimators: [Settings; 2],
    /// Samples per pixel of each estimator, including existing ones. Rounded up to a multiple of [`REPLICATES`].
    pub spp: u64,
}

impl Plan {
    /// Makes the plan of a reference of a scene with these settings. By default, bidirectional path tracing with
    /// all strategies renders the image, and path tracing cross-checks it, both with the independent sampler and
    /// with the maximum depth and seed of `scene`; `requests` change the estimators.
    pub fn new(scene: &Settings, spp: u64, requests: [&Request; 2]) -> Self {
        let of = |integrator, request: &Request| {
            let mut settings = Settings {
                sampler: SamplerKind::Independent,
                seed: scene.seed,
                ..Settings::new(integrator)
            };
            settings.path.max_depth = scene.path.max_depth;
            request.apply(&settings)
        };
        let [picture, cross_check] = requests;
        Self {
            estimators: [
                of(IntegratorKind::Bdpt, picture),
                of(IntegratorKind::Path, cross_check),
            ],
            spp,
        }
    }

    /// Makes the plan that adds `more` samples per pixel to a reference.
    ///
    /// Errors: the reference has settings that this program does not know.
    pub fn extended(provenance: &Provenance, more: u64) -> Result<Self, Error> {
        let [first, second] = provenance.estimators.each_ref().map(|record| {
            let mut request = Request::read(&record.settings)?;
            request.seed = Some(record.seed);
            Some(request.apply(&Settings::default()))
        });
        let estimators = first.zip(second).ok_or_else(|| {
            let reason = "has settings that this program does not know";
            Fault::OtherRender.of(&provenance.folder, reason)
        })?;
        Ok(Self {
            estimators: estimators.into(),
            spp: provenance.estimators[0].spp.saturating_add(more),
        })
    }

    /// Returns the number of passes of each replicate.
    pub(super) fn passes(&self) -> u64 {
        self.spp.div_ceil(REPLICATES).max(1)
    }

    /// Returns the settings of a replicate of an estimator, which differ in their seeds. They ask for the layers of
    /// the image.
    pub(super) fn settings(&self, estimator: usize, replicate: u64) -> Settings {
        let settings = &self.estimators[estimator];
        let number = settings.seed.wrapping_mul(2).wrapping_add(estimator as u64);
        let first = number.wrapping_mul(REPLICATES).wrapping_add(SEEDS);
        Settings {
            seed: first.wrapping_add(replicate),
            layers: Layers::new(&[Aov::Samples, Aov::Variance], &[], 0),
            ..settings.clone()
        }
    }

    /// Returns the samples per pixel of each estimator, rounded up.
    pub fn rounded_spp(&self) -> u64 {
        self.passes().saturating_mul(REPLICATES)
    }

    /// Returns true if both estimators are equal except for their seeds, or may become equal by `auto`: such
    /// a cross-check cannot detect an error.
    pub fn is_its_own_cross_check(&self) -> bool {
        let [picture, cross_check] = &self.estimators;
        let may_become = |auto: &Settings, other: &Settings| {
            auto.integrator == IntegratorKind::Auto && other.integrator != IntegratorKind::Light
        };
        let without_seed = |settings: &Settings| Request {
            seed: None,
            ..Request::of(settings)
        };
        may_become(picture, cross_check)
            || may_become(cross_check, picture)
            || without_seed(picture) == without_seed(cross_check)
    }
}
