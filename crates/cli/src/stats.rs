//! What a render counted and measured: as JSON, as attributes of the image, and as a line to read.

use crate::args;
use crate::scene_io::MetadataValue;
use crate::settings::{Budget, SettingsText};
use bidir::driver::{Session, Settings};
use bidir::film::Film;
use bidir::stats::{Dropped, RayCounts, Stats};
use serde::Serialize;
use std::path::Path;
use std::time::Duration;

/// The version of the program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Clock readings of a render.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times {
    /// Reading and building the scene.
    pub(crate) load: Duration,
    /// Training and rendering.
    pub(crate) render: Duration,
}

/// Everything that is told about a render.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Report {
    version: &'static str,
    scene: String,
    resolution: [u32; 2],
    /// Left, top, right and bottom (exclusive) of what was rendered.
    crop: [u32; 4],
    settings: SettingsText,
    budget: BudgetReport,
    threads: usize,
    isa: String,
    spp: u64,
    seconds: f64,
    load_seconds: f64,
    samples: u64,
    samples_per_second: f64,
    rays: RayReport,
    connection_rays_per_sample: f64,
    connection_blocked: u64,
    light_image_blocked: u64,
    candidates: u64,
    training: Option<TrainingReport>,
    dropped: u64,
    dropped_list: Vec<DroppedReport>,
    film_bytes: u64,
    bvh_bytes: usize,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct BudgetReport {
    spp: Option<u64>,
    seconds: Option<f64>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct RayReport {
    camera: u64,
    light: u64,
    connection: u64,
    light_image: u64,
    /// The sum of those above.
    total: u64,
    /// Not in the sum.
    training: u64,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct TrainingReport {
    samples: u64,
    mean_luminance: f32,
}

#[derive(Clone, Debug, Serialize)]
struct DroppedReport {
    pass: u64,
    pixel: [u32; 2],
    strategy: String,
}

impl Report {
    /// The report of what `session` rendered so far of the scene that is called `scene`.
    pub(crate) fn new(
        scene: String,
        session: &Session<'_>,
        settings: &Settings,
        budget: Budget,
        times: Times,
        bvh: &accel::Bvh,
    ) -> Self {
        let (stats, film) = (session.stats(), session.film().settings());
        let seconds = times.render.as_secs_f64();
        let training = session.training();
        Self {
            version: VERSION,
            scene,
            resolution: film.resolution,
            crop: [
                film.crop.min[0],
                film.crop.min[1],
                film.crop.max[0],
                film.crop.max[1],
            ],
            settings: SettingsText::from(settings),
            budget: BudgetReport {
                spp: budget.passes,
                seconds: budget.time.map(|time| time.as_secs_f64()),
            },
            threads: session.threads(),
            isa: bvh.isa().to_string(),
            spp: session.film().passes(),
            seconds,
            load_seconds: times.load.as_secs_f64(),
            samples: stats.samples,
            samples_per_second: stats.samples as f64 / seconds,
            rays: RayReport::new(
                stats.rays,
                training.map_or(0, |training| training.rays.total()),
            ),
            connection_rays_per_sample: per_sample(stats.rays.connection, stats),
            connection_blocked: stats.connections_blocked,
            light_image_blocked: stats.light_image_blocked,
            candidates: stats.candidates,
            training: training.map(|training| TrainingReport {
                samples: training.samples,
                mean_luminance: training.mean_luminance,
            }),
            dropped: stats.dropped,
            dropped_list: stats.dropped_list.iter().map(DroppedReport::from).collect(),
            film_bytes: film.crop.area() * Film::BYTES_PER_PIXEL,
            bvh_bytes: bvh.memory_bytes(),
        }
    }

    /// The attributes of the image: pbrt's where it has such, else our own.
    pub(crate) fn metadata(&self) -> Vec<(String, MetadataValue)> {
        let number = |number: u64| i32::try_from(number).unwrap_or(i32::MAX);
        let settings = &self.settings;
        let own = [
            ("version", self.version.to_owned()),
            ("scene", file_name(&self.scene)),
            ("integrator", settings.integrator.to_owned()),
            ("shadow-rays", settings.shadow_rays.clone()),
            ("mis", settings.mis.to_owned()),
            ("strategies", settings.strategies.clone()),
            ("light-point", settings.light_point.to_owned()),
            ("path-roulette", settings.path_roulette.clone()),
            ("max-depth", {
                let none = || "none".to_owned();
                settings
                    .max_depth
                    .map_or_else(none, |depth| depth.to_string())
            }),
            ("sampler", settings.sampler.to_owned()),
            ("seed", settings.seed.to_string()),
            ("passes", self.spp.to_string()),
            ("rays", self.rays.total.to_string()),
            ("rays.connection", self.rays.connection.to_string()),
            ("dropped", self.dropped.to_string()),
        ];
        let pbrt = [
            (
                "samplesPerPixel".to_owned(),
                MetadataValue::Integer(number(self.spp)),
            ),
            (
                "renderTimeSeconds".to_owned(),
                MetadataValue::Float(self.seconds as f32),
            ),
        ];
        let own = own.map(|(name, value)| (format!("bidir/{name}"), MetadataValue::Text(value)));
        pbrt.into_iter().chain(own).collect()
    }

    /// A line to read at the end.
    pub(crate) fn summary(&self) -> String {
        let ray = |count: u64| count as f64 / self.samples.max(1) as f64;
        let RayReport {
            camera,
            light,
            connection,
            light_image,
            ..
        } = self.rays;
        format!(
            "{} spp in {}, {} samples/s; rays per sample: {:.2} camera, {:.2} light, \
             {:.2} connection, {:.2} light image",
            self.spp,
            args::Duration(Duration::from_secs_f64(self.seconds)),
            short(self.samples_per_second),
            ray(camera),
            ray(light),
            ray(connection),
            ray(light_image),
        )
    }

    /// What is said of contributions that were dropped. None: there were none.
    pub(crate) fn warning(&self) -> Option<String> {
        let first = self.dropped_list.first()?;
        let [x, y] = first.pixel;
        Some(format!(
            "{} contributions were not finite or too large, and were dropped; the first by {}, \
             repeat it with --replay {x},{y},{}",
            self.dropped, first.strategy, first.pass
        ))
    }
}

/// The name of a file without its folders, which are of no interest to others.
fn file_name(path: &str) -> String {
    let name = Path::new(path).file_name();
    name.map_or_else(
        || path.to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

fn per_sample(count: u64, stats: &Stats) -> f64 {
    count as f64 / stats.samples.max(1) as f64
}

/// Three digits with a letter for thousands, millions or billions.
fn short(number: f64) -> String {
    let units = [(1e9, " G"), (1e6, " M"), (1e3, " k")];
    let (unit, letter) = units
        .into_iter()
        .find(|(unit, _)| number >= *unit)
        .unwrap_or((1.0, ""));
    let scaled = number / unit;
    let digits = if scaled < 10.0 {
        2
    } else {
        usize::from(scaled < 100.0)
    };
    format!("{scaled:.digits$}{letter}")
}

impl RayReport {
    fn new(rays: RayCounts, training: u64) -> Self {
        Self {
            camera: rays.camera,
            light: rays.light,
            connection: rays.connection,
            light_image: rays.light_image,
            total: rays.total(),
            training,
        }
    }
}

impl From<&Dropped> for DroppedReport {
    fn from(dropped: &Dropped) -> Self {
        Self {
            pass: dropped.pass,
            pixel: dropped.pixel,
            strategy: dropped.strategy.to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_shortly() {
        assert_eq!(short(12.34), "12.3");
        assert_eq!(short(1234.0), "1.23 k");
        assert_eq!(short(123_456_789.0), "123 M");
        assert_eq!(short(0.0), "0.00");
    }
}
