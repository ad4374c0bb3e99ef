//! The provenance of a reference, `provenance.json`.

use super::agreement::Agreement;
use super::{Error, Fault, LEVEL, PROVENANCE, Plan, REPLICATES};
use crate::results::Rays;
use crate::seal::{self, Seal, sha256};
use bidir::ESTIMATOR_VERSION;
use bidir::driver::Settings;
use bidir::film::PixelRect;
use formats::film::{FilmHeader, SettingsText, Subject};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The version of the format of `provenance.json`.
pub const FORMAT: u32 = 2;

/// The provenance of a reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The folder of the reference.
    #[serde(skip)]
    pub folder: PathBuf,
    /// [`FORMAT`].
    pub format: u32,
    /// The program with its version.
    pub program: String,
    /// [`ESTIMATOR_VERSION`] of that program.
    pub estimator_version: u32,
    /// The scene file, as it was named.
    pub scene: String,
    /// The hash of everything read for the scene.
    pub scene_digest: String,
    /// Width and height of the whole film. Unit: pixels.
    pub resolution: [u32; 2],
    /// Left, top, right, bottom of the rendered rectangle, the last two exclusive. Unit: pixels.
    pub crop: [u32; 4],
    /// The estimator of the image, and the estimator of the cross-check.
    pub estimators: [EstimatorRecord; 2],
    /// The test of their agreement.
    pub agreement: Agreement,
    /// The SHA-256 of the image and its variances.
    pub picture: String,
    /// The SHA-256 of the image files, by name.
    pub files: BTreeMap<String, String>,
}

/// The record of one of the two estimators.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimatorRecord {
    /// All settings except the seed, in the notation of flags.
    pub settings: BTreeMap<String, String>,
    /// Samples per pixel, of all replicates together.
    pub spp: u64,
    /// Number of replicates, each with a different seed.
    pub replicates: u64,
    /// The seed of the scene, which determines the seeds of the replicates.
    pub seed: u64,
    /// The seed of the first replicate; the others follow.
    pub first_seed: u64,
    /// Time of rendering and training. Unit: seconds; 0 if the host has no clock.
    pub seconds: f64,
    /// Rays by kind.
    pub rays: Rays,
    /// Dropped contributions: not finite, or too large.
    pub dropped: u64,
}

impl EstimatorRecord {
    /// Makes the record of an estimator from the header of its films.
    pub(super) fn new(plan: &Plan, estimator: usize, header: &FilmHeader) -> Self {
        let own = &plan.estimators[estimator];
        let mut settings = SettingsText::from(own).by_flag();
        settings.remove("seed");
        let rays = Rays::deserialize(&header.counts["rays"]);
        Self {
            settings,
            spp: header.passes.len(),
            replicates: REPLICATES,
            seed: own.seed,
            first_seed: plan.settings(estimator, 0).seed,
            seconds: header.seconds,
            rays: rays.unwrap_or_default(),
            dropped: header.counts["dropped"].as_u64().unwrap_or_default(),
        }
    }

    /// Summarizes the estimator in a line, such as `bdpt, 4096 samples per pixel`, with the settings that differ
    /// from the defaults of the integrator.
    pub fn summary(&self) -> String {
        let setting = |name: &str| self.settings.get(name).map_or("", String::as_str);
        let integrator = setting("integrator");
        let defaults = Settings::new(integrator.parse().unwrap_or_default());
        let defaults = SettingsText::from(&defaults).by_flag();
        let ignored = ["integrator", "max-depth", "sampler", "seed", "aov"];
        let named = self.settings.iter().filter(|(name, value)| {
            !ignored.contains(&name.as_str()) && defaults.get(*name) != Some(value)
        });
        let named = named.map(|(name, value)| format!(" --{name} {value}"));
        let named = named.collect::<String>();
        format!("{integrator}{named}, {} samples per pixel", self.spp)
    }
}

impl Provenance {
    /// Reads the provenance of the reference in `folder`, if its image can be used.
    ///
    /// Errors: a file is missing or damaged; another version of the estimators made it; its estimators disagree.
    /// [`Self::check`] compares it with a scene.
    pub fn load(folder: &Path) -> Result<Self, Error> {
        let provenance = Self::read(folder)?;
        provenance.check_usable()?;
        provenance.check_files()?;
        Ok(provenance)
    }

    /// Reads `provenance.json` of the reference in `folder`, also if its estimators disagree.
    ///
    /// Errors: it is missing, damaged, not the expected JSON, or has another format.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(PROVENANCE);
        let text = std::fs::read_to_string(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound => {
                let reason = format!("is not a reference: it has no {PROVENANCE}");
                Fault::Missing.of(folder, reason)
            }
            _ => formats::Error::io(&path, "read", &error).into(),
        })?;
        let seal = seal::check(&text);
        if seal == Seal::Broken {
            return Err(Fault::Damaged.of(&path, "its checksum is that of another text"));
        }
        let damaged = |error: serde_json::Error| Fault::Damaged.of(&path, error);
        let json: Value = serde_json::from_str(&text).map_err(damaged)?;
        match json["format"].as_u64() {
            Some(format) if format != u64::from(FORMAT) => {
                let reason = "the reference has format";
                let reason = format!("{reason} {format}; this program reads format {FORMAT}");
                Err(Fault::Refused.of(folder, reason))
            }
            _ if seal == Seal::Missing => Err(Fault::Damaged.of(&path, "it has no checksum")),
            _ => Ok(Self {
                folder: folder.to_owned(),
                ..serde_json::from_value(json).map_err(damaged)?
            }),
        }
    }

    /// Writes `provenance.json` to the folder.
    pub(super) fn write(&self) -> Result<(), Error> {
        let json = serde_json::to_string_pretty(self);
        let json = seal::sealed(&json.expect("it is numbers and texts")) + "\n";
        let path = self.folder.join(PROVENANCE);
        Ok(formats::file::replace(&path, json.as_bytes())?)
    }

    /// Refuses the reference if one of its images is damaged.
    fn check_files(&self) -> Result<(), Error> {
        for (name, sum) in &self.files {
            let path = self.folder.join(name);
            let bytes = std::fs::read(&path).map_err(|error| match error.kind() {
                ErrorKind::NotFound => Fault::Damaged.of(&path, "it is missing"),
                _ => formats::Error::io(&path, "read", &error).into(),
            })?;
            if sha256(&bytes) != *sum {
                let reason = format!("it is not the file that {PROVENANCE} describes");
                return Err(Fault::Damaged.of(&path, reason));
            }
        }
        Ok(())
    }

    /// Summarizes the estimators and their agreement in a line.
    pub fn summary(&self) -> String {
        let [first, second] = self.estimators.each_ref().map(EstimatorRecord::summary);
        let Agreement { p, level, .. } = &self.agreement;
        let agrees = match (self.agreement.decided, self.agreement.agree) {
            (false, _) => "cannot be compared",
            (true, true) => "agrees",
            (true, false) => "does not agree",
        };
        format!("{first}; {agrees} with {second} (p = {p:.3}, level {level})")
    }

    /// Refuses the reference if no scene can use it: its estimators disagree, or another version of the estimators
    /// made it.
    fn check_usable(&self) -> Result<(), Error> {
        let version = self.estimator_version;
        if version != ESTIMATOR_VERSION {
            let reason = format!(
                "stale: made by version {version} of the estimators, this program has \
                 {ESTIMATOR_VERSION}"
            );
            return Err(Fault::Refused.of(&self.folder, reason));
        }
        let Agreement { agree, p, .. } = self.agreement;
        // Its own level may be less strict.
        if agree && p >= LEVEL {
            return Ok(());
        }
        let folder = self.folder.clone();
        Err(Error::Disagree { folder, p })
    }

    /// Refuses the reference unless it is of this scene and of its film.
    pub fn check(&self, subject: &Subject) -> Result<(), Error> {
        let film = subject.view.film();
        let PixelRect { min, max } = film.crop;
        let size = |[width, height]: [u32; 2]| format!("{width} x {height}");
        let crop = |edges: [u32; 4]| edges.map(|edge| edge.to_string()).join(",");
        let crops = [self.crop, [min[0], min[1], max[0], max[1]]].map(crop);
        let digests = [self.scene_digest.clone(), subject.digest.clone()];
        let parts = [
            (
                "another scene, or one that has changed since: its digest is",
                digests,
            ),
            (
                "another size:",
                [self.resolution, film.resolution].map(size),
            ),
            ("another crop:", crops),
        ];
        let mut parts = parts.iter();
        match parts.find(|(_, [found, expected])| found != expected) {
            None => Ok(()),
            // The first digits of a digest suffice.
            Some((what, [found, expected])) => {
                let reason = format!("{what} {found:.32}, not {expected:.32}");
                Err(Fault::Refused.of(&self.folder, reason))
            }
        }
    }
}
