//! The flags of `bidir compare`.

use super::values::{named, positive_number};
use clap::{Args, ValueHint};
use lab::metric::Metric;
use std::path::PathBuf;

/// What is compared, and what is told.
#[derive(Args, Debug)]
#[command(
    override_usage = "bidir compare [OPTIONS] A B\n       \
        bidir compare [OPTIONS] A... --reference B",
    after_help = "Examples:\n  bidir compare out.exr reference.exr --flip\n  \
        bidir compare seed-*.exr --reference reference.exr --json\n  \
        bidir compare out.exr reference.exr --error-map out.png --metric flip_hdr\n  \
        bidir compare room.exr --reference room.reference\n  \
        bidir compare a.exr b.exr --exact"
)]
pub(crate) struct CompareArgs {
    /// Image and reference; with --reference, images alone.
    #[arg(required = true, value_name = "A", value_hint = ValueHint::FilePath)]
    pub(crate) images: Vec<PathBuf>,
    /// What all images are compared with: an image, or a folder of `bidir reference`.
    ///
    /// A reference that is damaged, of another version of the estimators, or whose estimators
    /// disagree is refused.
    #[arg(long, value_name = "B", value_hint = ValueHint::FilePath)]
    pub(crate) reference: Option<PathBuf>,
    /// Exit with 6 unless every pixel of all has the same bits.
    #[arg(long, conflicts_with = "resample")]
    pub(crate) exact: bool,
    /// Where sizes differ, average the image of more pixels down to the size of the other.
    ///
    /// Each pixel is the mean of what it covers, weighted by area. Without this, different sizes are
    /// an error.
    #[arg(long)]
    pub(crate) resample: bool,
    /// What is computed.
    #[command(flatten)]
    pub(crate) metrics: MetricArgs,
    /// Print JSON with the names of the numbers as keys, and size and resampled.
    ///
    /// The test of noise is the key `z_test`, with block (the side of the blocks), pixels and blocks,
    /// each with p, tests (their number), block (left, top, right, bottom), channel, means and
    /// deviations. Numbers that are not finite are null, as are all numbers where sizes differ. With several
    /// images a number is an object with mean, low, high and values, and there are the keys images
    /// and confidence.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What is computed of an image and its reference, beside the usual numbers.
#[derive(Args, Debug)]
pub(crate) struct MetricArgs {
    /// Print FLIP too, which takes seconds: the difference seen when both images alternate.
    ///
    /// flip: on a screen that shows [0, 1]. `flip_hdr`: the largest difference at any exposure from the
    /// one for the brightest pixel of the reference to the one for its median. Both for 67 pixels per
    /// degree; 0 is no difference, 1 the largest.
    #[arg(long)]
    pub(crate) flip: bool,
    /// Write the error of every pixel: as it is to FILE.exr, channel Y, or in colours to FILE.png.
    ///
    /// The colours of a PNG go from black, no error, by purple and orange to pale yellow, which is
    /// --error-max and above; green is no number.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) error_map: Option<PathBuf>,
    /// The error that --error-map has.
    ///
    /// A metric of this name is the mean over its map, and rmse the root of the mean square. Trimmed
    /// metrics have the map of all pixels.
    #[arg(long, default_value = "relmse", requires = "error_map")]
    #[arg(value_parser = named(Metric::NAMES))]
    pub(crate) metric: Metric,
    /// The error that is brightest in the PNG of --error-map.
    #[arg(
        long,
        value_name = "ERROR",
        default_value_t = 1.0,
        requires = "error_map"
    )]
    #[arg(value_parser = positive_number)]
    pub(crate) error_max: f64,
}
