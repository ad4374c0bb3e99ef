//! `bidir tonemap`: converts linear light to an image for the screen.
//!
//! out = sRGB(operator(2^stops · in)). An operator maps linear Rec. 709 to linear Rec. 709 in
//! [0, 1]; every PNG of this program has the transfer curve of sRGB. Values are clamped before an
//! operator is applied: negative channels and NaN become 0, infinity the largest finite number.

mod agx;
mod neutral;

use crate::args::TonemapArgs;
use crate::console::say;
use crate::exit::{Exit, Failure};
use crate::output;
use crate::scene_io::{self, Format};

/// A tone mapping operator, which maps light of any strength to [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    /// Clips.
    Srgb,
    /// The base look of AgX.
    Agx,
    /// PBR Neutral, by Khronos.
    Neutral,
}

impl Operator {
    /// Names on the command line.
    pub(crate) const NAMES: [(&'static str, Self); 3] = [
        ("srgb", Self::Srgb),
        ("agx", Self::Agx),
        ("neutral", Self::Neutral),
    ];

    /// Maps a colour to the screen.
    ///
    /// Range: finite and not negative; the result is in `[0, 1]`, linear.
    fn apply(self, color: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Srgb => color.map(|channel| channel.min(1.0)),
            Self::Agx => agx::apply(color),
            Self::Neutral => neutral::apply(color),
        }
    }
}

/// Tone maps an image file.
pub(crate) fn run(args: &TonemapArgs) -> Result<Exit, Failure> {
    let default = || output::named_after(&args.image, ".png");
    let written = &args.output.clone().unwrap_or_else(default);
    // The output is always a PNG.
    output::check_image("--output", written, &[Format::Png], [&args.image])?;
    let mut image = scene_io::read_image(&args.image)?;
    let scale = libm::exp2f(args.exposure);
    for color in &mut image.data {
        *color = args
            .operator
            .apply(color.map(|channel| expose(channel, scale)));
    }
    formats::image::write_png(written, image.size, &image.data)?;
    say(format_args!("wrote {}", written.display()));
    Ok(Exit::Done)
}

/// Scales a channel and clamps it to the range of operators. Range: finite and not negative.
fn expose(channel: f32, scale: f32) -> f32 {
    let exposed = channel * scale;
    if exposed.is_nan() {
        return 0.0;
    }
    exposed.clamp(0.0, f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns greys from black to the largest number.
    fn ramp() -> impl Iterator<Item = f32> {
        let stops = (-1600..=4000).map(|step| libm::exp2f(step as f32 / 80.0));
        [0.0].into_iter().chain(stops).chain([f32::MAX])
    }

    #[test]
    fn greys_stay_in_order_and_on_the_screen() {
        for (name, operator) in Operator::NAMES {
            let mut last = [0.0; 3];
            for grey in ramp() {
                let color = operator.apply([grey; 3]);
                for (channel, last) in color.iter().zip(last) {
                    // The matrices of AgX have digits enough for ten bits.
                    assert!((0.0..=1.0).contains(channel), "{name} {grey} {color:?}");
                    assert!(*channel >= last - 1e-6, "{name} {grey} {color:?}");
                }
                last = color;
            }
            assert!(
                last.iter().all(|channel| *channel > 0.99),
                "{name} {last:?}"
            );
        }
    }

    #[test]
    fn black_stays_black() {
        for (name, operator) in Operator::NAMES {
            assert_eq!(operator.apply([0.0; 3]).map(f32::to_bits), [0; 3], "{name}");
        }
    }

    #[test]
    fn every_colour_lands_on_the_screen() {
        let values = [0.0, 1e-30, 0.01, 0.18, 0.7, 1.0, 3.0, 100.0, 1e9, f32::MAX];
        for (name, operator) in Operator::NAMES {
            for color in (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100].map(|i| values[i])) {
                let shown = operator.apply(color);
                let on_screen = shown.iter().all(|channel| (0.0..=1.0).contains(channel));
                assert!(on_screen, "{name} {color:?} {shown:?}");
            }
        }
    }

    #[test]
    fn negative_and_infinite_channels_are_clamped() {
        for (channel, expected) in [
            (f32::NAN, 0.0),
            (-1.0, 0.0),
            (f32::NEG_INFINITY, 0.0),
            (f32::INFINITY, f32::MAX),
            (f32::MAX, f32::MAX),
            (0.25, 0.5),
        ] {
            assert_eq!(
                expose(channel, 2.0).to_bits(),
                f32::to_bits(expected),
                "{channel}"
            );
        }
    }
}
