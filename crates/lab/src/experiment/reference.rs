//! What images are compared with: an image that is there, or one that is rendered once and kept.

use super::ReferenceSpec;
use super::cell::write_image;
use super::error::ExperimentError;
use super::journal::hash;
use super::names::file_name;
use super::run::{Event, Observer, Setup};
use super::settings::{Changes, texts};
use super::stage::{Reference, Stage};
use crate::image::Pixels;
use bidir::ESTIMATOR_VERSION;
use bidir::driver::Settings;
use bidir::integrator::IntegratorKind;
use bidir::sampler::SamplerKind;
use bidir::select::ShadowRays;
use std::path::Path;

type Result<T> = std::result::Result<T, ExperimentError>;

/// The seed of references, which no experiment has: seeds are below 2⁵³.
const SEED: u64 = u64::MAX;

/// The reference of a scene. None: the observer stopped its render.
pub(super) fn obtain(
    stage: &Stage<'_>,
    setup: &Setup,
    threads: usize,
    observer: &mut dyn Observer,
) -> Result<Option<Reference>> {
    match &stage.spec.reference {
        ReferenceSpec::Image(path) => Ok(Some(Reference {
            pixels: read(path, stage)?,
            words: format!("the image {}", path.display()),
            image: None,
        })),
        ReferenceSpec::Render { spp, changes } => {
            let plan = Plan::new(stage, *spp, changes);
            let path = setup.folder.join(&plan.file);
            if !path.exists() && !plan.render(stage, &path, threads, observer)? {
                return Ok(None);
            }
            Ok(Some(Reference {
                pixels: read(&path, stage)?,
                words: plan.words(),
                image: Some(plan.file),
            }))
        }
    }
}

/// Reads an image, which has the size of the scene's.
fn read(path: &Path, stage: &Stage<'_>) -> Result<Pixels> {
    let pixels = Pixels::from(&formats::image::read(path, None)?);
    if pixels.size != stage.size() {
        return Err(ExperimentError::Size {
            path: path.to_owned(),
            scene: stage.spec.name.clone(),
            found: pixels.size,
            expected: stage.size(),
        });
    }
    Ok(pixels)
}

/// What a reference is rendered with.
struct Plan {
    settings: Settings,
    spp: u64,
    /// Its file, relative to the folder of the results: another reference has another name.
    file: String,
}

impl Plan {
    fn new(stage: &Stage<'_>, spp: u64, changes: &Changes) -> Self {
        let mut settings = changes.apply(&stage.settings);
        settings.integrator = IntegratorKind::Bdpt;
        settings.shadow_rays = ShadowRays::All;
        settings.sampler = SamplerKind::Sobol;
        settings.seed = SEED;
        let [width, height] = stage.size();
        let identity = format!(
            "{} {width}x{height} {spp} {ESTIMATOR_VERSION} {:?}",
            stage.digest,
            texts(&settings)
        );
        let hash = hash(&identity);
        let name = file_name(&stage.spec.name);
        let file = format!("references/{name}-{}.exr", &hash[..12]);
        Self {
            settings,
            spp,
            file,
        }
    }

    fn words(&self) -> String {
        let texts = texts(&self.settings);
        format!(
            "bdpt with {} samples per pixel, all shadow rays, strategies {}, max-depth {}",
            self.spp, texts["strategies"], texts["max-depth"]
        )
    }

    /// Renders and writes the image. False: it was stopped.
    fn render(
        &self,
        stage: &Stage<'_>,
        path: &Path,
        threads: usize,
        observer: &mut dyn Observer,
    ) -> Result<bool> {
        let mut session = stage.session(self.settings.clone(), threads)?;
        while session.next_pass() < self.spp {
            if observer.should_stop() {
                return Ok(false);
            }
            observer.tell(Event::Reference {
                scene: &stage.spec.name,
                passes: session.next_pass(),
                of: self.spp,
            });
            session.step(&());
        }
        write_image(path, &session.film().develop())?;
        Ok(true)
    }
}
