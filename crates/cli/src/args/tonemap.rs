//! The flags of `bidir tonemap`.

use super::values::named;
use crate::tonemap::Operator;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// An image, and how it is brought to the screen.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  bidir tonemap room.exr -o room.png --exposure 1.5\n  \
    bidir tonemap room.exr -o room.png --operator agx"
)]
pub(crate) struct TonemapArgs {
    /// The image: exr, hdr, pfm, or another one that is read.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) image: PathBuf,
    /// The picture, in eight bits of sRGB.
    #[arg(short, long, value_name = "OUT.png", value_hint = ValueHint::FilePath)]
    pub(crate) output: PathBuf,
    /// Stops that the image is made brighter by: each doubles the light, a negative one halves it.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = stops)]
    #[arg(allow_negative_numbers = true)]
    pub(crate) exposure: f32,
    /// How light of any strength fits on the screen.
    ///
    /// srgb: what is brighter than the screen is clipped, the rest is exact, as in the PNG of
    /// `bidir render`. agx: the base look of AgX, a curve like that of film, where bright colours
    /// fade to white. neutral: the PBR Neutral tone mapper of Khronos, which keeps colours up to
    /// 0.8 and compresses highlights alone.
    #[arg(long, default_value = "srgb", value_parser = named(Operator::NAMES))]
    pub(crate) operator: Operator,
}

/// Reads a number of stops that leaves something to see.
fn stops(text: &str) -> Result<f32, String> {
    let number = text.parse().ok();
    number
        .filter(|stops| (-64.0..=64.0).contains(stops))
        .ok_or_else(|| "expected a number of stops from -64 to 64, such as 1.5".into())
}
