//! The flags of `bidir tonemap`.

use super::values::named;
use crate::tonemap::Operator;
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// The image to convert, and the tone mapping operator.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  bidir tonemap room.exr -o room.png --exposure 1.5\n  \
    bidir tonemap room.exr -o room.png --operator agx"
)]
pub(crate) struct TonemapArgs {
    /// Image: .exr, .hdr, .pfm, .png, .jpg, .tga or .webp.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) image: PathBuf,
    /// Output image, 8-bit sRGB [default: NAME.png].
    #[arg(short, long, value_name = "OUT.png", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,
    /// Exposure in stops: 1 doubles the light, -1 halves it.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = stops)]
    #[arg(allow_negative_numbers = true)]
    pub(crate) exposure: f32,
    /// Tone mapping operator: srgb, agx or neutral.
    ///
    /// srgb: clips values above 1 and keeps all others, as the PNG of `bidir render`. agx: the base
    /// look of AgX, a film-like curve; bright colours fade to white. neutral: Khronos PBR Neutral;
    /// keeps colours up to 0.8 and compresses highlights only.
    #[arg(long, default_value = "srgb", value_parser = named(Operator::NAMES))]
    pub(crate) operator: Operator,
}

/// Reads a number of stops within the range of 32-bit floats.
fn stops(text: &str) -> Result<f32, String> {
    let number = text.parse().ok();
    number
        .filter(|stops| (-64.0..=64.0).contains(stops))
        .ok_or_else(|| "expected a number of stops from -64 to 64, such as 1.5".into())
}
