//! The numbers of each strategy of a render.

use bidir::driver::Session;
use bidir::film::Film;
use bidir::path::Strategy;
use bidir::spectrum::luminance;
use bidir::stats::StrategyCounts;

/// The numbers of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// The strategy.
    pub strategy: Strategy,
    /// The counts of its contributions, by their fate.
    pub counts: StrategyCounts,
    /// The numbers of its images. None: the film keeps no images of it.
    pub images: Option<ImageFigures>,
}

/// The numbers of the images of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageFigures {
    /// The mean luminance of the weighted image.
    pub mean: f64,
    /// The variance of a pixel of the weighted image in one pass, averaged over pixels. None: fewer than
    /// two passes, or none of them in this session.
    pub variance: Option<f64>,
    /// The mean luminance of the raw image. None: the film has none.
    pub raw_mean: Option<f64>,
    /// The number of values in the weighted image that are too large for the raw one.
    pub raw_dropped: u64,
}

impl Figures {
    /// Returns the numbers of all strategies with counts, shorter paths first.
    pub fn all(session: &Session<'_>) -> Vec<Self> {
        let moments: Vec<_> = session.strategy_moments().collect();
        let (film, stats) = (session.film(), session.stats());
        let rows = stats.strategies.rows().map(|(strategy, counts)| {
            let found = moments.iter().find(|found| found.strategy == strategy);
            let images = found.map(|found| ImageFigures {
                mean: found.mean,
                variance: found.variance,
                raw_mean: film.layers().raw_part(strategy).map(|raw| mean(film, raw)),
                raw_dropped: stats.strategy_images.get(strategy).raw_dropped,
            });
            Self {
                strategy,
                counts,
                images,
            }
        });
        rows.collect()
    }

    /// Returns the fraction of traced shadow rays that are blocked. None: no ray was traced.
    pub fn blocked_share(&self) -> Option<f64> {
        let StrategyCounts {
            traced, blocked, ..
        } = self.counts;
        (traced > 0).then(|| blocked as f64 / traced as f64)
    }
}

/// Returns the mean luminance of a part of a film's picture.
pub(super) fn mean(film: &Film, part: usize) -> f64 {
    mean_of(film, film.part_pixels(part))
}

/// Returns the mean luminance of an image with the pixels of a film's crop.
pub(super) fn mean_of(film: &Film, pixels: impl Iterator<Item = [f32; 3]>) -> f64 {
    let sum: f64 = pixels.map(|pixel| f64::from(luminance(pixel))).sum();
    sum / film.settings().crop.area().max(1) as f64
}
