//! The flags of `bidir compare`.

use super::values::{named, positive_number};
use clap::{Args, ValueHint};
use lab::metric::Metric;
use std::path::PathBuf;

/// The images to compare, and the metrics to print.
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
    /// Image and reference; with --reference, only images.
    #[arg(required = true, value_name = "A", value_hint = ValueHint::FilePath)]
    pub(crate) images: Vec<PathBuf>,
    /// Reference for all images: an image, or a folder written by `bidir reference`.
    ///
    /// A folder is refused if it is damaged, comes from another version of the estimators, or if its two
    /// estimators disagree.
    #[arg(long, value_name = "B", value_hint = ValueHint::FilePath)]
    pub(crate) reference: Option<PathBuf>,
    /// Exit with code 6 unless all pixels have the same bits.
    #[arg(long, conflicts_with = "resample")]
    pub(crate) exact: bool,
    /// If sizes differ, average the larger image down to the size of the smaller.
    ///
    /// Each pixel becomes the area-weighted mean of the pixels that it covers. Without this flag,
    /// different sizes are an error.
    #[arg(long)]
    pub(crate) resample: bool,
    /// The metrics beside the usual numbers.
    #[command(flatten)]
    pub(crate) metrics: MetricArgs,
    /// Print JSON with the names of the metrics as keys, and size and resampled.
    ///
    /// The key `z_test` has block (the side of the blocks), pixels and blocks; the latter two have p,
    /// tests (their number), block (left, top, right, bottom), channel, means and deviations. Numbers
    /// that are not finite are null, and so are all numbers if sizes differ. With several images each
    /// number is an object with mean, low, high and values, and the keys images and confidence are added.
    #[arg(long)]
    pub(crate) json: bool,
}

/// The metrics of an image and its reference beside the usual numbers.
#[derive(Args, Debug)]
pub(crate) struct MetricArgs {
    /// Print FLIP too: the difference seen when both images alternate. Takes seconds.
    ///
    /// flip: on a screen that shows [0, 1]. flip_hdr: the largest difference at any exposure between
    /// that of the reference's brightest pixel and that of its median. Both assume 67 pixels per degree;
    /// 0 is no difference, 1 the largest.
    #[arg(long)]
    pub(crate) flip: bool,
    /// Write the error of every pixel: as channel Y of an .exr, or in colours as a .png.
    ///
    /// Colours go from black (no error) through purple and orange to pale yellow (--error-max and
    /// above); green marks pixels that are not a number.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) error_map: Option<PathBuf>,
    /// Metric of --error-map.
    ///
    /// The metric is the mean of its map; rmse is the root of the mean square. Trimmed metrics have the
    /// map of all pixels.
    #[arg(long, default_value = "relmse", requires = "error_map")]
    #[arg(value_parser = named(Metric::NAMES))]
    pub(crate) metric: Metric,
    /// Error that is brightest in the .png of --error-map.
    #[arg(long, value_name = "ERROR", default_value_t = 1.0)]
    #[arg(requires = "error_map")]
    #[arg(value_parser = positive_number)]
    pub(crate) error_max: f64,
}
