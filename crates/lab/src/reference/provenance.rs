//! The provenance of a reference, `provenance.json`.

use super::agreement::Agreement;
use super::{Error, LEVEL, PROVENANCE};
use crate::results::Rays;
use crate::seal::{self, Seal, sha256};
use bidir::ESTIMATOR_VERSION;
use bidir::driver::Settings;
use bidir::film::FilmSettings;
use formats::film::SettingsText;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

/// The version of the format of `provenance.json`.
pub const FORMAT: u32 = 2;

/// The provenance of a reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
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
    /// Summarizes the estimator in a line, such as `bdpt, 4096 samples per pixel`, with the settings that differ
    /// from the defaults of the integrator.
    pub fn summary(&self) -> String {
        let defaults = self.defaults();
        let ignored = ["integrator", "max-depth", "sampler", "seed", "aov"];
        let setting = |name: &str| self.settings.get(name).map_or("", String::as_str);
        let named = self.settings.iter().filter(|(name, value)| {
            !ignored.contains(&name.as_str()) && defaults.get(*name) != Some(value)
        });
        let named = named.map(|(name, value)| format!(" --{name} {value}"));
        let named = named.collect::<String>();
        let integrator = setting("integrator");
        format!("{integrator}{named}, {} samples per pixel", self.spp)
    }

    /// Returns the default settings of the estimator's integrator.
    fn defaults(&self) -> BTreeMap<String, String> {
        let integrator = self.settings.get("integrator");
        let integrator = integrator.and_then(|name| name.parse().ok());
        let settings = Settings::new(integrator.unwrap_or_default());
        SettingsText::from(&settings).by_flag()
    }
}

impl Provenance {
    /// Reads `provenance.json` of the reference in `folder`, also if its estimators disagree.
    ///
    /// Errors: it is missing, damaged, not the expected JSON, or has another format.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        #[derive(Deserialize)]
        struct Format {
            format: u32,
        }
        let path = folder.join(PROVENANCE);
        let text = std::fs::read_to_string(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound => Error::Missing(folder.to_owned()),
            _ => Error::io(&path, error),
        })?;
        let damaged = |error: serde_json::Error| Error::damaged(&path, error.to_string());
        if seal::check(&text) == Seal::Broken {
            return Err(Error::damaged(
                &path,
                "its checksum is that of another text",
            ));
        }
        let Format { format } = serde_json::from_str(&text).map_err(damaged)?;
        if format != FORMAT {
            let reason =
                format!("the reference has format {format}; this program reads format {FORMAT}");
            return Err(Error::Refused {
                folder: folder.to_owned(),
                reason,
            });
        }
        if seal::check(&text) == Seal::Missing {
            return Err(Error::damaged(&path, "it has no checksum"));
        }
        serde_json::from_str(&text).map_err(damaged)
    }

    /// Writes `provenance.json` to the reference in `folder`.
    pub(super) fn write(&self, folder: &Path) -> Result<(), Error> {
        let json = serde_json::to_string_pretty(self);
        let json = seal::sealed(&json.expect("it is numbers and texts")) + "\n";
        let path = folder.join(PROVENANCE);
        Ok(formats::file::replace(&path, json.as_bytes())?)
    }

    /// Refuses the reference in `folder` if one of its files is damaged.
    pub(super) fn check_files(&self, folder: &Path) -> Result<(), Error> {
        for (name, sum) in &self.files {
            let path = folder.join(name);
            let bytes = std::fs::read(&path).map_err(|error| match error.kind() {
                ErrorKind::NotFound => Error::damaged(&path, "it is missing"),
                _ => Error::io(&path, error),
            })?;
            if sha256(&bytes) != *sum {
                let reason = format!("it is not the file that {PROVENANCE} describes");
                return Err(Error::damaged(&path, reason));
            }
        }
        Ok(())
    }

    /// Summarizes the estimators and their agreement in a line.
    pub fn summary(&self) -> String {
        let [first, second] = self.estimators.each_ref().map(EstimatorRecord::summary);
        let Agreement { p, level, .. } = &self.agreement;
        let agree = if !self.agreement.decided {
            "cannot be compared"
        } else if self.agreement.agree {
            "agrees"
        } else {
            "does not agree"
        };
        format!("{first}; {agree} with {second} (p = {p:.3}, level {level})")
    }

    /// Refuses the reference in `folder` if no scene can use it: its estimators disagree, or another version of
    /// the estimators made it.
    pub fn check_usable(&self, folder: &Path) -> Result<(), Error> {
        let folder = folder.to_owned();
        let version = self.estimator_version;
        if version != ESTIMATOR_VERSION {
            let reason = format!(
                "stale: made by version {version} of the estimators, this program has \
                 {ESTIMATOR_VERSION}"
            );
            return Err(Error::Refused { folder, reason });
        }
        let Agreement { agree, p, .. } = &self.agreement;
        // Its own level may be less strict.
        if *agree && *p >= LEVEL {
            return Ok(());
        }
        Err(Error::Disagree { folder, p: *p })
    }

    /// Refuses the reference in `folder` unless it belongs to the scene with this digest and to this film.
    pub fn check(&self, folder: &Path, digest: &str, film: &FilmSettings) -> Result<(), Error> {
        let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
        let crop = [left, top, right, bottom];
        let text = |crop: [u32; 4]| crop.map(|edge| edge.to_string()).join(",");
        let reason = if self.scene_digest != digest {
            let (found, expected) = (short(&self.scene_digest), short(digest));
            format!(
                "another scene, or one that has changed since: its digest is {found}, not {expected}"
            )
        } else if self.resolution != film.resolution {
            let ([width, height], [w, h]) = (self.resolution, film.resolution);
            format!("another film: of {width} x {height} pixels, not {w} x {h}")
        } else if self.crop != crop {
            format!("another crop: {}, not {}", text(self.crop), text(crop))
        } else {
            return Ok(());
        };
        let folder = folder.to_owned();
        Err(Error::Refused { folder, reason })
    }
}

/// Returns the first digits of a hash.
fn short(digest: &str) -> &str {
    digest.get(..12).unwrap_or(digest)
}
