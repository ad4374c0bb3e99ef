//! How a reference was made, as `provenance.json` has it.

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
/// The version before, without checksums.
pub(super) const UNSEALED: u32 = 1;

/// How a reference was made.
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
    /// The hash of everything that was read for the scene.
    pub scene_digest: String,
    /// Width and height of the whole film. Unit: pixels.
    pub resolution: [u32; 2],
    /// Left, top, right, bottom of what was rendered, the last two exclusive. Unit: pixels.
    pub crop: [u32; 4],
    /// The estimator of the picture, and the one that it has to agree with.
    pub estimators: [EstimatorRecord; 2],
    /// Whether they agree.
    pub agreement: Agreement,
    /// The SHA-256 of the picture and its variances.
    pub picture: String,
    /// The SHA-256 of the files beside it, by their names.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
}

/// What one of the two estimators did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EstimatorRecord {
    /// All settings, as flags write them, but the seed.
    pub settings: BTreeMap<String, String>,
    /// Samples per pixel, of all replicates together.
    pub spp: u64,
    /// Renders with seeds of their own.
    pub replicates: u64,
    /// The seed that was asked for; the replicates' seeds are functions of it.
    pub seed: u64,
    /// The seed of the first replicate; the others follow.
    pub first_seed: u64,
    /// Time of rendering and training. Unit: seconds; 0 where the host has no clock.
    pub seconds: f64,
    /// Rays by kind.
    pub rays: Rays,
    /// Contributions that were not finite or too large, and dropped.
    pub dropped: u64,
}

impl EstimatorRecord {
    /// In a line, such as `bdpt, 4096 samples per pixel`: the settings that are not the usual ones
    /// of the integrator are named.
    pub fn summary(&self) -> String {
        let usual = self.usual();
        let ignored = ["integrator", "max-depth", "sampler", "seed", "aov"];
        let setting = |name: &str| self.settings.get(name).map_or("", String::as_str);
        let named = self.settings.iter().filter(|(name, value)| {
            !ignored.contains(&name.as_str()) && usual.get(*name) != Some(value)
        });
        let named = named.map(|(name, value)| format!(" --{name} {value}"));
        let named = named.collect::<String>();
        let integrator = setting("integrator");
        format!("{integrator}{named}, {} samples per pixel", self.spp)
    }

    /// What its integrator does where nothing else is said.
    fn usual(&self) -> BTreeMap<String, String> {
        let integrator = self.settings.get("integrator");
        let integrator = integrator.and_then(|name| name.parse().ok());
        let settings = Settings::new(integrator.unwrap_or_default());
        SettingsText::from(&settings).by_flag()
    }
}

impl Provenance {
    /// Reads `provenance.json` of the reference in `folder`, whatever it says.
    ///
    /// Errors: it is not there, is damaged, is no such JSON, or has another format.
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
        if ![FORMAT, UNSEALED].contains(&format) {
            let reason =
                format!("the reference has format {format}; this program reads format {FORMAT}");
            return Err(Error::Refused {
                folder: folder.to_owned(),
                reason,
            });
        }
        if format != UNSEALED && seal::check(&text) == Seal::Missing {
            return Err(Error::damaged(&path, "it has no checksum"));
        }
        serde_json::from_str(&text).map_err(damaged)
    }

    /// Writes it to the reference in `folder`.
    pub(super) fn write(&self, folder: &Path) -> Result<(), Error> {
        let json = serde_json::to_string_pretty(self);
        let json = seal::sealed(&json.expect("it is numbers and texts")) + "\n";
        let path = folder.join(PROVENANCE);
        Ok(formats::file::replace(&path, json.as_bytes())?)
    }

    /// Refuses the reference in `folder` where one of its files is not as it was written.
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

    /// How it was made, in words.
    pub fn summary(&self) -> String {
        let [first, second] = self.estimators.each_ref().map(EstimatorRecord::summary);
        let Agreement { p, level, .. } = &self.agreement;
        let agree = if self.agreement.agree {
            "agrees"
        } else {
            "does not agree"
        };
        format!("{first}; {agree} with {second} (p = {p:.3}, level {level})")
    }

    /// Refuses the reference in `folder` where nothing should be measured against it, whatever the
    /// scene: its estimators disagree, or another version of them made it.
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
        // A reference of a laxer level is no reference here.
        if *agree && *p >= LEVEL {
            return Ok(());
        }
        Err(Error::Disagree { folder, p: *p })
    }

    /// Refuses the reference in `folder` for another scene than the one with this digest, and for
    /// another film.
    pub fn check(&self, folder: &Path, digest: &str, film: &FilmSettings) -> Result<(), Error> {
        let difference = self.difference(digest, film);
        difference.map_or(Ok(()), |reason| {
            let folder = folder.to_owned();
            Err(Error::Refused { folder, reason })
        })
    }

    /// Why it is not of the scene with this digest and film. None: it is.
    fn difference(&self, digest: &str, film: &FilmSettings) -> Option<String> {
        if self.scene_digest != digest {
            let (found, wanted) = (short(&self.scene_digest), short(digest));
            return Some(format!(
                "another scene, or one that has changed since: its digest is {found}, not {wanted}"
            ));
        }
        let ([width, height], [w, h]) = (self.resolution, film.resolution);
        if self.resolution != film.resolution {
            return Some(format!(
                "another film: of {width} x {height} pixels, not {w} x {h}"
            ));
        }
        let ([left, top], [right, bottom]) = (film.crop.min, film.crop.max);
        let wanted = [left, top, right, bottom];
        let text = |crop: [u32; 4]| crop.map(|edge| edge.to_string()).join(",");
        let (crop, asked) = (text(self.crop), text(wanted));
        (self.crop != wanted).then(|| format!("another crop: {crop}, not {asked}"))
    }
}

/// The beginning of a hash.
fn short(digest: &str) -> &str {
    digest.get(..12).unwrap_or(digest)
}
