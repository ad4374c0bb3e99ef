//! A torture scene and its number of passes.

use crate::statistics::{Replicates, Shown, WHOLE, check_agree, replicates};
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::path::PathSettings;
use bidir_formats::pbrt::{Crop, LoadOptions, Loaded, load};
use std::path::Path;

/// Few pixels with many samples each, so that the mean of a pixel is close to normal.
pub(crate) const RESOLUTION: [u32; 2] = [16, 16];
/// Blocks to compare: the whole film, and every pixel.
pub(crate) const PIXELS: &[usize] = &[WHOLE, 1];
/// Blocks for estimators whose pixels have heavy tails: the whole film, and its quarters.
pub(crate) const QUARTERS: &[usize] = &[WHOLE, 8];

/// A scene, the maximum depth of its file, and the passes of all replicates.
#[derive(Clone, Copy)]
pub(crate) struct Case<'a> {
    shown: Shown<'a>,
    max_depth: u32,
    passes: u64,
    seed: u64,
}

pub(crate) fn open(name: &str) -> Loaded {
    open_part(name, None)
}

pub(crate) fn open_part(name: &str, crop: Option<Crop>) -> Loaded {
    open_at(name, RESOLUTION, crop)
}

/// A scene of the torture suite with a film of this resolution, of which a crop is rendered.
pub(crate) fn open_at(name: &str, resolution: [u32; 2], crop: Option<Crop>) -> Loaded {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenes/torture")
        .join(name);
    let options = LoadOptions {
        resolution: Some(resolution),
        crop,
        ..LoadOptions::default()
    };
    load(&file, &options).expect("the project's scenes are valid")
}

impl<'a> Case<'a> {
    pub(crate) fn new(loaded: &'a Loaded, passes: u64) -> Self {
        Self {
            shown: Shown {
                scene: &loaded.scene,
                view: &loaded.view,
            },
            max_depth: loaded.settings.max_depth,
            passes,
            seed: 0,
        }
    }

    /// Returns the case with another seed, and four times as many passes.
    pub(crate) fn again(self) -> Self {
        Self {
            seed: self.seed + 1,
            ..self.with_effort(4)
        }
    }

    /// Returns the case with `factor` times as many passes, for an estimator of more variance.
    pub(crate) fn with_effort(self, factor: u64) -> Self {
        Self {
            passes: self.passes * factor,
            ..self
        }
    }

    /// Returns the case with one part in `parts` of the passes, for estimators with correlated noise.
    pub(crate) fn with_part(self, parts: u64) -> Self {
        Self {
            passes: self.passes.div_ceil(parts),
            ..self
        }
    }

    /// Renders with settings changed by `change`. The path tracer is cheap and gets more passes.
    pub(crate) fn render(
        &self,
        integrator: IntegratorKind,
        change: impl Fn(&mut Settings),
    ) -> Replicates {
        let path = PathSettings {
            max_depth: Some(self.max_depth),
            ..PathSettings::default()
        };
        let mut settings = Settings {
            path,
            seed: self.seed,
            ..Settings::new(integrator)
        };
        change(&mut settings);
        let passes = match integrator {
            IntegratorKind::Path | IntegratorKind::Light | IntegratorKind::Auto => 2 * self.passes,
            IntegratorKind::Bdpt | IntegratorKind::Lvc => self.passes,
        };
        replicates(self.shown, &settings, passes)
    }

    pub(crate) fn bdpt(&self, change: impl Fn(&mut Settings)) -> Replicates {
        self.render(IntegratorKind::Bdpt, change)
    }

    pub(crate) fn path(&self) -> Replicates {
        self.render(IntegratorKind::Path, |_| ())
    }

    /// Compares the bidirectional path tracer with the path tracer's result.
    #[track_caller]
    pub(crate) fn check_bdpt(&self, reference: &Replicates) {
        check_agree("bdpt", &self.bdpt(|_| ()), reference, PIXELS);
    }

    /// Compares the light tracer with the path tracer's result.
    #[track_caller]
    pub(crate) fn check_light(&self, reference: &Replicates) {
        let light = self.render(IntegratorKind::Light, |_| ());
        check_agree("light", &light, reference, QUARTERS);
    }

    /// Compares all three estimators, and returns the path tracer's result.
    #[track_caller]
    pub(crate) fn check_all(&self) -> Replicates {
        let reference = self.path();
        self.check_bdpt(&reference);
        self.check_light(&reference);
        reference
    }
}
